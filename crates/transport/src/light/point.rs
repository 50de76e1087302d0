//! A point that radiates the same intensity in every direction: irradiance I·cos/d².

use super::{LightSample, Target};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::SurfaceId;
use etalon_optics::Vec3;

/// A point light.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Position.
    pub position: Vec3<f64>,
    /// Radiant intensity, W·sr⁻¹·nm⁻¹.
    pub intensity: PathSpectrum,
    /// Units of length in a metre, a power of two.
    pub per_m: f64,
}

impl PointLight {
    pub(super) fn sample(&self, from: Vec3<f64>) -> Option<LightSample> {
        let toward = self.position - from;
        let distance_squared = toward.length_squared();
        // A light exactly on the surface it lights has no direction.
        (distance_squared > 0.0).then(|| LightSample {
            colour: None,
            wi: toward / distance_squared.sqrt(),
            density: Density::Delta,
            target: Target::Point(self.position),
            surface: SurfaceId::NONE,
            scale: self.per_m * self.per_m / distance_squared,
        })
    }
}
