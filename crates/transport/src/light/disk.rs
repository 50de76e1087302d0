//! An emitting disk, sampled uniformly by area.

use super::planar::Flat;
use super::{Emitter, LightSample, planar};
use etalon_geometry::{Aabb, Disk};
use etalon_optics::{Frame, Vec3};

/// An emitting disk.
#[derive(Clone, Debug)]
pub struct DiskLight {
    shape: Disk,
    /// What it emits.
    pub emitter: Emitter,
}

impl DiskLight {
    /// A light of this shape.
    pub fn new(shape: Disk, emitter: Emitter) -> Self {
        Self { shape, emitter }
    }

    /// Surface area of one side, m².
    pub fn area(&self) -> f64 {
        self.shape.area()
    }

    pub(super) fn bounds(&self) -> Aabb {
        self.shape.bounds()
    }

    pub(super) fn normal(&self) -> Vec3<f64> {
        self.shape.normal()
    }

    pub(super) fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        planar::density(from, wi, self.shape.centre(), self.shape.normal(), self.area())
    }

    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        self.flat().aim_at_disk(from, u).sample(self.emitter.surface)
    }

    /// See [`super::Light::disk`].
    pub(super) fn flat(&self) -> Flat {
        let Emitter { front, back, .. } = self.emitter;
        let frame = Frame::from_normal(self.shape.normal());
        let radius = self.shape.radius();
        let edges = [frame.s * radius, frame.t * radius];
        Flat { corner: self.shape.centre(), edges, normal: frame.n, area: self.area(), half: false, front, back }
    }
}
