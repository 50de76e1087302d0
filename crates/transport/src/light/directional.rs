//! Parallel light: irradiance E on a plane at right angles to it.

use super::{LightSample, Target};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::SurfaceId;
use etalon_optics::Vec3;

/// Parallel light.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit vector toward the light.
    pub toward: Vec3<f64>,
    /// Irradiance on a plane at right angles to the light, W·m⁻²·nm⁻¹.
    pub irradiance: PathSpectrum,
}

impl DirectionalLight {
    pub(super) fn sample(&self) -> LightSample {
        LightSample {
            colour: None,
            wi: self.toward,
            density: Density::Delta,
            target: Target::Infinity,
            surface: SurfaceId::NONE,
            scale: 1.0,
        }
    }
}
