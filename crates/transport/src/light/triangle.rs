//! An emitting triangle, sampled uniformly by area.

use super::planar::Flat;
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

    /// The light as far as its points and their densities depend on it.
    #[inline]
    pub(crate) fn flat(&self) -> Flat {
        let [a, b, c] = self.shape.vertices();
        Flat {
            corner: a,
            edges: [b - a, c - a],
            normal: self.normal,
            area: self.area,
            half: true,
            front: self.emitter.front,
            back: self.emitter.back,
        }
    }

    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        self.flat().sample(from, u, self.emitter.surface)
    }
}
