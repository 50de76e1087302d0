//! An emitting disk, sampled uniformly by area.

use super::planar::Flat;
use super::{Emitter, LightSample, planar};
use crate::warp::concentric_disk;
use etalon_geometry::Disk;
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

    pub(super) fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        planar::density(from, wi, self.shape.centre(), self.shape.normal(), self.area())
    }

    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        let [x, y] = concentric_disk(u);
        let frame = Frame::from_normal(self.shape.normal());
        let radius = self.shape.radius();
        let point = self.shape.centre() + frame.s * (radius * x) + frame.t * (radius * y);
        let Emitter { front, back, surface, .. } = self.emitter;
        let (corner, normal, area) = (self.shape.centre(), frame.n, self.area());
        Flat { corner, edges: [frame.s, frame.t], normal, area, half: false, front, back }
            .seen(from, point)
            .sample(surface)
    }
}
