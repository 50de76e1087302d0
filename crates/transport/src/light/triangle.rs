//! An emitting triangle, sampled uniformly by area.

use super::{Emitter, LightSample, planar};
use etalon_geometry::Triangle;
use etalon_optics::Vec3;

/// An emitting triangle.
#[derive(Clone, Debug)]
pub struct TriangleLight {
    shape: Triangle,
    normal: Vec3<f64>,
    area: f64,
    /// What it emits.
    pub emitter: Emitter,
}

impl TriangleLight {
    /// A light of this shape.
    pub fn new(shape: Triangle, emitter: Emitter) -> Self {
        Self { normal: shape.normal(), area: shape.area(), shape, emitter }
    }

    /// Surface area of one side, m².
    pub fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        planar::density(from, wi, self.shape.vertices()[0], self.normal, self.area)
    }

    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        // Heitz 2019, *A Low-Distortion Map Between Triangle and Square*: the square folded along its diagonal.
        let (s, t) = if u[1] > u[0] { (0.5 * u[0], u[1] - 0.5 * u[0]) } else { (u[0] - 0.5 * u[1], 0.5 * u[1]) };
        let [a, b, c] = self.shape.vertices();
        let point = a + (b - a) * s + (c - a) * t;
        planar::sample(from, point, self.normal, &self.emitter, |wi| self.density(from, wi))
    }
}
