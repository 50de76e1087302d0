//! A point that radiates the same intensity in every direction: irradiance I·cos/d².

use super::tree::LightBounds;
use super::{LightSample, LightSource, Target};
use crate::frame::SceneFrame;
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::{Aabb, SurfaceId};
use etalon_optics::Vec3;
use std::f64::consts::PI;

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
    /// At a point of the world, in the frame.
    pub(super) fn new(position_m: [f64; 3], intensity: PathSpectrum, frame: &SceneFrame) -> Self {
        Self { position: frame.point(Vec3::from_array(position_m)), intensity, per_m: frame.per_m() }
    }
}

impl LightSource for PointLight {
    fn sample(&self, from: Vec3<f64>, _u: [f64; 2], _time: f64) -> Option<LightSample> {
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

    fn spectrum(&self) -> &PathSpectrum {
        &self.intensity
    }

    fn position(&self) -> Option<Vec3<f64>> {
        Some(self.position)
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(LightBounds {
            bounds: Aabb { min: self.position, max: self.position },
            axis: Vec3::new(1.0, 0.0, 0.0),
            cos_normals: -1.0,
            cos_shines: 0.0,
            both_sides: false,
            power: 1.0,
        })
    }

    fn power_factor(&self, _scene_radius: f64) -> f64 {
        4.0 * PI * self.per_m * self.per_m
    }
}
