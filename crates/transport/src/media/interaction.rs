//! Where a medium scatters a path.

use super::medium::Medium;
use etalon_geometry::{SurfaceId, SurfacePoint};
use etalon_optics::Vec3;

/// A point of a medium where a path is scattered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MediumInteraction<'a> {
    /// A point of no surface, which rays leave as it is.
    pub point: SurfacePoint<f64>,
    /// Toward where the path came from; a unit vector.
    pub wo: Vec3<f64>,
    pub medium: &'a Medium,
}

impl<'a> MediumInteraction<'a> {
    pub(crate) fn new(position: Vec3<f64>, time: f64, wo: Vec3<f64>, medium: &'a Medium) -> Self {
        let (surface, normal) = (SurfaceId::NONE, Vec3::ZERO);
        Self { point: SurfacePoint { position, position_error: 0.0, normal, surface, label: 0, time }, wo, medium }
    }
}
