//! Parallelograms.

use super::{ShapeError, check_points, planar};
use crate::Aabb;
use crate::query::{Projected, Query, RawHit};
use crate::ray::ExactPoint;
use etalon_optics::Vec3;

/// A parallelogram, seen by rays from both sides; its outward side is the one to which a × b points.
#[derive(Clone, Debug, PartialEq)]
pub struct Parallelogram {
    corner: Vec3<f64>,
    a: Vec3<f64>,
    b: Vec3<f64>,
    /// Unit normal and largest extent of the bounds: every hit asks for them.
    normal: Vec3<f64>,
    extent: f64,
}

impl Parallelogram {
    /// A parallelogram with one corner at `corner` (m) and the edges `a` and `b` (m) leaving it.
    ///
    /// # Errors
    /// If a number is not finite or out of range, or the edges are parallel or zero, before or after the corners
    /// `corner` + `a` and `corner` + `b` are rounded.
    pub fn new(corner: Vec3<f64>, a: Vec3<f64>, b: Vec3<f64>) -> Result<Self, ShapeError> {
        check_points(&[corner, a, b])?;
        let mut shape = Self { corner, a, b, normal: Vec3::ZERO, extent: 0.0 };
        check_points(&shape.corners())?;
        let cross = shape.cross();
        if cross == Vec3::ZERO {
            return Err(ShapeError::NoArea);
        }
        shape.extent = shape.bounds().extent().max_component();
        if shape.extent < super::MIN_LENGTH {
            return Err(ShapeError::OutOfRange);
        }
        shape.normal = planar::unit(cross);
        Ok(shape)
    }

    /// The corner that the edges leave, m.
    pub fn corner(&self) -> Vec3<f64> {
        self.corner
    }

    /// The edges, m.
    pub fn edges(&self) -> [Vec3<f64>; 2] {
        [self.a, self.b]
    }

    /// The corners in turn, rounded: the shape that rays meet.
    pub fn corners(&self) -> [Vec3<f64>; 4] {
        let (pa, pb) = (self.corner + self.a, self.corner + self.b);
        [self.corner, pa, pa + self.b, pb]
    }

    /// Unit normal on the outward side.
    pub fn normal(&self) -> Vec3<f64> {
        self.normal
    }

    /// Area of one side, m².
    pub fn area(&self) -> f64 {
        self.cross().length()
    }

    /// The smallest box around the corners.
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.corners())
    }

    fn cross(&self) -> Vec3<f64> {
        planar::edge_cross(self.corner, self.corner + self.a, self.corner + self.b)
    }

    /// As [`Triangle`](super::Triangle)'s test, with four edges: watertight where corners coincide with those of
    /// neighbours.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64) -> Option<RawHit> {
        let [c0, c1, c2, c3] = self.corners();
        // Written out: `map` over an array is not inlined, and this is the hot path of every flat wall.
        let p = [query.project(c0), query.project(c1), query.project(c2), query.project(c3)];
        let e = [p[0].edge(p[1]), p[1].edge(p[2]), p[2].edge(p[3]), p[3].edge(p[0])];
        if e.iter().any(|&e| e < 0.0) && e.iter().any(|&e| e > 0.0) {
            return None;
        }
        let det = 0.5 * ((e[0] + e[2]) + (e[1] + e[3]));
        if det == 0.0 || det.is_nan() {
            return None;
        }
        // o = p₀ + u·(p₁ − p₀) + v·(p₃ − p₀), solved by Cramer's rule.
        // The edges have decided that the point is inside; against their mean a parameter may err by a few roundoffs.
        let (u, v) = ((e[3] / det).clamp(0.0, 1.0), (e[0] / det).clamp(0.0, 1.0));
        let t = p[0].z + (u * (p[1].z - p[0].z) + v * (p[3].z - p[0].z));
        let mut hit = RawHit { t, uv: [u, v] };
        let largest = |v: [f64; 4]| v[0].max(v[1]).max(v[2].max(v[3]));
        let magnitude = largest([p[0].magnitude, p[1].magnitude, p[2].magnitude, p[3].magnitude]);
        let extent = |q: &Projected| q.x.abs().max(q.y.abs());
        let extent = largest([extent(&p[0]), extent(&p[1]), extent(&p[2]), extent(&p[3])]);
        let depth = largest([p[0].z, p[1].z, p[2].z, p[3].z]) + largest([-p[0].z, -p[1].z, -p[2].z, -p[3].z]);
        if !planar::is_determined(magnitude, extent, depth, (t * det).abs(), det.abs()) {
            let (a, b) = (self.corner + self.a, self.corner + self.b);
            hit = planar::refine(query, self.corner, a, b, self.bounds(), hit, 2.0);
        }
        (0.0 < hit.t && hit.t < t_max).then_some(hit)
    }

    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        planar::surface(p, self.corner, self.normal, self.extent)
    }
}
