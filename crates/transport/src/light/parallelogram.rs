//! An emitting parallelogram, sampled uniformly by area.
//!
//! Sampling a rectangle by solid angle (Ureña et al. 2013) was measured on the published Cornell box: 4.5 % less error
//! for 12 % fewer paths, so the plain form stays; near lights are covered by the BSDF's share of MIS.

use super::planar::Flat;
use super::{Emitter, LightSample, planar};
use etalon_geometry::Parallelogram;
use etalon_optics::Vec3;

/// An emitting parallelogram.
#[derive(Clone, Debug)]
pub struct ParallelogramLight {
    shape: Parallelogram,
    normal: Vec3<f64>,
    area: f64,
    /// What it emits.
    pub emitter: Emitter,
}

impl ParallelogramLight {
    /// A light of this shape.
    pub fn new(shape: Parallelogram, emitter: Emitter) -> Self {
        Self { normal: shape.normal(), area: shape.area(), shape, emitter }
    }

    /// Surface area of one side, m².
    pub fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        planar::density(from, wi, self.shape.corner(), self.normal, self.area)
    }

    /// The light as far as its points and their densities depend on it.
    #[inline]
    pub(crate) fn flat(&self) -> Flat {
        Flat {
            corner: self.shape.corner(),
            edges: self.shape.edges(),
            normal: self.normal,
            area: self.area,
            half: false,
            front: self.emitter.front,
            back: self.emitter.back,
        }
    }

    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        self.flat().sample(from, u, self.emitter.surface)
    }
}
