//! Parallel light: irradiance E on a plane at right angles to it.

use super::{LightSample, LightSource, Source, Target};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::SurfaceId;
use etalon_optics::Vec3;
use std::f64::consts::PI;

/// Parallel light.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit vector toward the light.
    pub toward: Vec3<f64>,
    /// Irradiance on a plane at right angles to the light, W·m⁻²·nm⁻¹.
    pub irradiance: PathSpectrum,
}

impl LightSource for DirectionalLight {
    fn sample(&self, _from: Vec3<f64>, _u: [f64; 2], _time: f64) -> Option<LightSample> {
        Some(LightSample {
            colour: None,
            wi: self.toward,
            density: Density::Delta,
            target: Target::Infinity,
            surface: SurfaceId::NONE,
            scale: 1.0,
        })
    }

    fn source(&self) -> Option<Source> {
        Some(Source::Direction(self.toward))
    }

    fn spectrum(&self) -> &PathSpectrum {
        &self.irradiance
    }

    fn power_factor(&self, scene_radius: f64) -> f64 {
        PI * scene_radius * scene_radius
    }
}
