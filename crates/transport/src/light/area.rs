//! An area light: a shape whose surface emits. How directions toward a shape are drawn is a property of the shape
//! ([`ShapeSampler`]); which of its sides emit is the light's.

use super::tree::LightBounds;
use super::{LightSample, LightSource, Target};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::{DirectionDensity, Primitive, ShapeSample, ShapeSampler, SurfaceId};
use etalon_optics::Vec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// A shape whose surface emits.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Its shape.
    pub shape: ShapeSampler,
    /// What it emits.
    pub emitter: Emitter,
}

/// What every emitting surface has: its radiance, its emitting sides and where it is.
#[derive(Clone, Debug)]
pub struct Emitter {
    /// Emitted radiance, W·m⁻²·sr⁻¹·nm⁻¹.
    pub radiance: Arc<PathSpectrum>,
    /// Whether the side that the normal points into emits.
    pub front: bool,
    /// Whether the other side emits.
    pub back: bool,
    /// The surface.
    pub surface: SurfaceId,
    /// Where an image says what it emits.
    pub image: Option<ImageOf>,
}

/// An image of what an emitting surface emits, of which `radiance` is the white.
#[derive(Clone, Copy, Debug)]
pub struct ImageOf {
    /// The number of the object that has it.
    pub object: u32,
    /// About the mean luminance of its colours over the surface, which only decides how often the surface is aimed at.
    pub mean: f64,
}

impl Emitter {
    /// Whether the front or the back emits.
    #[inline]
    pub(crate) fn emits(&self, front: bool) -> bool {
        if front { self.front } else { self.back }
    }

    /// A sample of the shape as one of the light; `None` where the side that is seen is dark.
    #[inline]
    pub(super) fn sample(&self, sample: &ShapeSample) -> Option<LightSample> {
        let lit = sample.valid && self.emits(sample.front);
        lit.then(|| LightSample::on_surface(sample.point, sample.wi, sample.density, self.surface))
    }

    /// The density of a direction that meets the shape: zero where the side that is seen first is dark, toward which no direction is
    /// drawn.
    #[inline]
    pub(super) fn density(&self, of_shape: &DirectionDensity) -> f64 {
        if self.emits(of_shape.front) { of_shape.density } else { 0.0 }
    }

    /// What the spectrum and the area are to be multiplied by for what all sides emit.
    fn brightness(&self) -> f64 {
        let sides = f64::from(u8::from(self.front)) + f64::from(u8::from(self.back));
        sides * self.image.map_or(1.0, |image| image.mean)
    }
}

impl LightSample {
    /// A direction toward a point of a surface.
    #[inline(always)]
    pub(crate) fn on_surface(point: Vec3<f64>, wi: Vec3<f64>, density: f64, surface: SurfaceId) -> Self {
        let (density, target) = (Density::SolidAngle(density), Target::Point(point));
        Self { wi, density, target, surface, scale: 1.0, colour: None }
    }
}

impl AreaLight {
    /// A light of this shape; `None` if it is an instance.
    pub fn new(shape: &Primitive, emitter: Emitter) -> Option<Self> {
        Some(Self { shape: shape.sampler()?, emitter })
    }
}

impl LightSource for AreaLight {
    fn sample(&self, from: Vec3<f64>, u: [f64; 2], _time: f64) -> Option<LightSample> {
        self.emitter.sample(&self.shape.sample(from, u))
    }

    fn density(&self, from: Vec3<f64>, wi: Vec3<f64>, _time: f64) -> f64 {
        self.emitter.density(&self.shape.density(from, wi))
    }

    fn spectrum(&self) -> &PathSpectrum {
        &self.emitter.radiance
    }

    fn emitter(&self) -> Option<&Emitter> {
        Some(&self.emitter)
    }

    fn bounds(&self) -> Option<LightBounds> {
        let normal = self.shape.normal();
        Some(LightBounds {
            bounds: self.shape.bounds(),
            axis: normal.map_or(Vec3::new(1.0, 0.0, 0.0), |n| if self.emitter.front { n } else { -n }),
            // Normals of what is curved point everywhere.
            cos_normals: if normal.is_some() { 1.0 } else { -1.0 },
            cos_shines: 0.0,
            both_sides: self.emitter.front && self.emitter.back,
            power: 1.0,
        })
    }

    fn power_factor(&self, _scene_radius: f64) -> f64 {
        self.emitter.brightness() * PI * self.shape.area()
    }
}
