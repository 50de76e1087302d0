//! An emitting cylinder: a point uniform on its area gives the direction, and the direction the point that is seen. No sample
//! is lost on points that hide behind others, and the density of a direction is the sum over all the points that give it.

use super::{Emitter, LightSample, Target};
use crate::mis::Density;
use crate::warp::concentric_disk;
use etalon_geometry::{Aabb, Cylinder, Geometry, Ray, SurfacePoint};
use etalon_optics::{Frame, Vec3};
use std::sync::Arc;

/// An emitting cylinder.
#[derive(Clone, Debug)]
pub struct CylinderLight {
    shape: Cylinder,
    /// The shape alone: which of its points a direction meets first.
    alone: Arc<Geometry>,
    /// What it emits.
    pub emitter: Emitter,
}

impl CylinderLight {
    /// A light of this shape.
    ///
    /// # Errors
    /// None: one shape can always be built.
    pub fn new(shape: Cylinder, emitter: Emitter) -> Result<Self, etalon_geometry::GeometryError> {
        let alone = Arc::new(Geometry::build(vec![shape.clone().into()])?);
        Ok(Self { shape, alone, emitter })
    }

    /// Area of its outside, m².
    pub fn area(&self) -> f64 {
        self.shape.area()
    }

    /// The point that a direction meets first, and the density of the direction: the sum of d²/(|cos|·A) over the points
    /// that it meets, which for a cylinder are two at most.
    fn seen(&self, from: Vec3<f64>, wi: Vec3<f64>) -> Option<(SurfacePoint<f64>, f64)> {
        let ray = Ray::free(from, wi);
        let share = |point: &SurfacePoint<f64>| {
            let toward = point.position - from;
            toward.length_squared() / (wi.dot(point.normal).abs() * self.area())
        };
        let first = self.alone.surface(&ray, &self.alone.closest_hit(&ray)?);
        let mut density = share(&first);
        let on = first.spawn(wi);
        if let Some(hit) = self.alone.closest_hit(&on) {
            density += share(&self.alone.surface(&on, &hit));
        }
        Some((first, density))
    }

    /// Zero where `wi` meets nothing, or first a side that is dark.
    pub(super) fn bounds(&self) -> Aabb {
        self.shape.bounds()
    }

    pub(super) fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        match self.seen(from, wi) {
            Some((first, density)) if self.emitter.emits_along(first.normal, -wi) => density,
            _ => 0.0,
        }
    }

    /// The square of the distance of a uniform point of the unit disk from its middle is uniform too, and independent of its
    /// direction: the one chooses the height or the place on a cap, the other the place around the axis.
    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        let [x, y] = concentric_disk(u);
        let squared = x * x + y * y;
        let around = if squared > 0.0 {
            let r = squared.sqrt();
            [x / r, y / r]
        } else {
            [1.0, 0.0]
        };
        let (radius, half_length) = (self.shape.radius(), self.shape.half_length());
        let cap_share = if self.shape.is_capped() { 0.5 * radius / (2.0 * half_length + radius) } else { 0.0 };
        let wall_share = 1.0 - 2.0 * cap_share;
        let (reach, height) = if squared < wall_share {
            (radius, half_length * (2.0 * squared / wall_share - 1.0))
        } else {
            // The last step may round to just above 1.
            let rest = (squared - wall_share) / cap_share;
            let (side, rest) = if rest < 1.0 { (-1.0, rest) } else { (1.0, (rest - 1.0).min(1.0)) };
            (radius * rest.sqrt(), half_length * side)
        };
        let frame = Frame::from_normal(self.shape.axis());
        let point = self.shape.centre() + (frame.s * around[0] + frame.t * around[1]) * reach + frame.n * height;
        let toward = point - from;
        let distance = toward.length();
        if distance == 0.0 {
            return None;
        }
        let wi = toward / distance;
        let (first, density) = self.seen(from, wi)?;
        if !self.emitter.emits_along(first.normal, -wi) {
            return None;
        }
        // Along the surface up to rounding, the density is infinite and the light's share zero.
        (density > 0.0 && density.is_finite()).then_some(LightSample {
            colour: None,
            wi,
            density: Density::SolidAngle(density),
            target: Target::Point(first.position),
            surface: self.emitter.surface,
            scale: 1.0,
        })
    }
}
