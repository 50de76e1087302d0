//! A point that radiates the same intensity in every direction: irradiance I·cos/d².

use super::{LightSample, Target};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::PrimitiveId;
use etalon_optics::Vec3;

/// A point light.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Position, m.
    pub position: Vec3<f64>,
    /// Radiant intensity, W·sr⁻¹·nm⁻¹.
    pub intensity: PathSpectrum,
}

impl PointLight {
    pub(super) fn sample(&self, from: Vec3<f64>) -> Option<LightSample> {
        let toward = self.position - from;
        let distance_squared = toward.length_squared();
        // A light exactly on the surface it lights has no direction.
        (distance_squared > 0.0).then(|| LightSample {
            wi: toward / distance_squared.sqrt(),
            density: Density::Delta,
            target: Target::Point(self.position),
            primitive: PrimitiveId::NONE,
            scale: 1.0 / distance_squared,
        })
    }
}
