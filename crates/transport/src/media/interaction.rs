//! Where a medium scatters a path.

use super::medium::Medium;
use super::{MediumStack, Way};
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
    /// The media that hold it.
    pub stack: MediumStack<'a>,
    /// The way through the medium on which it lies, and how far along it.
    pub way: Way,
    pub distance: f64,
    /// The density with which the path is scattered there, the mean over the lanes, per unit of the frame; 0 where no lamp lights parts of ways.
    pub density: f64,
    /// The share of what connections find from here that counts; the rest is found from places that are chosen in beams behind mirrors and
    /// glass.
    pub share_of_connections: f64,
}

/// A point of no surface.
pub(crate) fn free_point(position: Vec3<f64>, time: f64) -> SurfacePoint<f64> {
    let (surface, normal) = (SurfaceId::NONE, Vec3::ZERO);
    SurfacePoint { position, position_error: 0.0, normal, surface, label: 0, time }
}
