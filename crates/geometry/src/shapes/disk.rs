//! Flat disks.

use super::{DirectionDensity, PlanarSampler, ShapeError, ShapeMap, ShapeSample, check_points, check_radius, planar};
use crate::Aabb;
use crate::query::Query;
use crate::ray::{ExactPoint, RawHit};
use etalon_optics::{Frame, Real, Vec3};

/// A flat disk, seen by rays from both sides; its outward side is the one to which the normal points.
#[derive(Clone, Debug, PartialEq)]
pub struct Disk {
    centre: Vec3<f64>,
    normal: Vec3<f64>,
    radius: f64,
}

impl Disk {
    /// A disk about `centre` (m) of `radius` (m), perpendicular to `normal` (of any length but zero).
    ///
    /// # Errors
    /// If a number is not finite or out of range, the normal is zero, or the radius is not positive.
    pub fn new(centre: Vec3<f64>, normal: Vec3<f64>, radius: f64) -> Result<Self, ShapeError> {
        check_points(&[centre, normal])?;
        check_radius(radius)?;
        let magnitude = normal.abs().max_component();
        if magnitude == 0.0 {
            return Err(ShapeError::NoArea);
        }
        Ok(Self { centre, normal: (normal / magnitude).normalized(), radius })
    }

    /// Centre, m.
    pub fn centre(&self) -> Vec3<f64> {
        self.centre
    }

    /// Unit normal on the outward side.
    pub fn normal(&self) -> Vec3<f64> {
        self.normal
    }

    /// Radius, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Area of one side, m².
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * self.radius * self.radius
    }

    /// A box around the disk, rounded outward.
    pub fn bounds(&self) -> Aabb {
        let n = self.normal;
        // The half extent along x is r·√(1 − x²) = r·√(y² + z²), which does not cancel.
        let half = Vec3::new(n.y * n.y + n.z * n.z, n.z * n.z + n.x * n.x, n.x * n.x + n.y * n.y);
        let reach = |s: f64| s.sqrt() * self.radius * (1.0 + 8.0 * f64::UNIT_ROUNDOFF);
        let half = Vec3::new(reach(half.x), reach(half.y), reach(half.z));
        let (lower, upper) = (self.centre - half, self.centre + half);
        Aabb {
            min: Vec3::new(lower.x.next_down(), lower.y.next_down(), lower.z.next_down()),
            max: Vec3::new(upper.x.next_up(), upper.y.next_up(), upper.z.next_up()),
        }
    }

    /// Three corners of a square around the disk: one, and its neighbours.
    pub(crate) fn square(&self) -> [Vec3<f64>; 3] {
        let frame = Frame::from_normal(self.normal);
        // The frame's vectors err by a few roundoffs.
        let r = self.radius * (1.0 + 64.0 * f64::UNIT_ROUNDOFF);
        let (s, t) = (frame.s * r, frame.t * r);
        [self.centre - s - t, self.centre + s - t, self.centre - s + t]
    }

    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64) -> Option<RawHit> {
        let to_centre = self.centre - query.origin;
        let t = to_centre.dot(self.normal) / query.direction.dot(self.normal);
        // False for the NaN and the infinities of a parallel ray.
        let ahead = 0.0 < t && t < t_max && t < f64::INFINITY;
        if !ahead {
            return None;
        }
        let from_centre = query.direction * t - to_centre;
        (from_centre.length_squared() <= self.radius * self.radius).then_some(RawHit { t, uv: [0.0; 2] })
    }

    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        planar::surface(p, self.centre, self.normal, self.radius)
    }

    /// Its uniform points: of [`PlanarSampler::sample_disk`].
    #[inline]
    pub fn sampler(&self) -> PlanarSampler {
        let frame = Frame::from_normal(self.normal);
        let edges = [frame.s * self.radius, frame.t * self.radius];
        PlanarSampler { corner: self.centre, edges, normal: self.normal, area: self.area(), half: false }
    }

    /// A direction toward a uniform point.
    #[inline]
    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> ShapeSample {
        self.sampler().sample_disk(from, u)
    }

    #[inline]
    pub(super) fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> DirectionDensity {
        self.sampler().density(from, wi)
    }

    /// Its image under a similarity.
    pub(crate) fn mapped(&self, map: &impl ShapeMap) -> Result<Self, ShapeError> {
        Self::new(map.point(self.centre), map.normal(self.normal), map.length(self.radius))
    }
}
