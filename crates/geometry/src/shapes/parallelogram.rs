//! Parallelograms.

use super::{ShapeError, check_points, planar};
use crate::query::{Query, RawHit};
use crate::{Aabb, PrimitiveId, SurfacePoint};
use etalon_optics::{Real, Vec3};

/// A parallelogram, seen by rays from both sides; its outward side is the one to which a × b points.
#[derive(Clone, Debug, PartialEq)]
pub struct Parallelogram {
    corner: Vec3<f64>,
    a: Vec3<f64>,
    b: Vec3<f64>,
}

impl Parallelogram {
    /// A parallelogram with one corner at `corner` (m) and the edges `a` and `b` (m) leaving it.
    ///
    /// # Errors
    /// If a number is not finite or out of range, or the edges are parallel or zero, before or after the corners
    /// `corner` + `a` and `corner` + `b` are rounded.
    pub fn new(corner: Vec3<f64>, a: Vec3<f64>, b: Vec3<f64>) -> Result<Self, ShapeError> {
        check_points(&[corner, a, b])?;
        let shape = Self { corner, a, b };
        check_points(&shape.corners())?;
        if shape.cross() == Vec3::ZERO {
            return Err(ShapeError::NoArea);
        }
        if shape.bounds().extent().max_component() < super::MIN_LENGTH {
            return Err(ShapeError::OutOfRange);
        }
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
        planar::unit(self.cross())
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
        let p = self.corners().map(|corner| query.project(corner));
        let e = [p[0].edge(p[1]), p[1].edge(p[2]), p[2].edge(p[3]), p[3].edge(p[0])];
        if e.iter().any(|&e| e < 0.0) && e.iter().any(|&e| e > 0.0) {
            return None;
        }
        let det = 0.5 * ((e[0] + e[2]) + (e[1] + e[3]));
        if det == 0.0 || det.is_nan() {
            return None;
        }
        // o = p₀ + u·(p₁ − p₀) + v·(p₃ − p₀), solved by Cramer's rule.
        let (u, v) = (e[3] / det, e[0] / det);
        let t = p[0].z + (u * (p[1].z - p[0].z) + v * (p[3].z - p[0].z));
        let mut hit = RawHit { t, uv: [u, v] };
        let fold =
            |f: fn(f64, f64) -> f64, start: f64, g: fn(&crate::query::Projected) -> f64| p.iter().map(g).fold(start, f);
        let magnitude = fold(f64::max, 0.0, |p| p.magnitude);
        let extent = fold(f64::max, 0.0, |p| p.x.abs().max(p.y.abs()));
        let depth = fold(f64::max, f64::NEG_INFINITY, |p| p.z) - fold(f64::min, f64::INFINITY, |p| p.z);
        if !planar::is_determined(magnitude, extent, depth, (t * det).abs(), det.abs()) {
            let (a, b) = (self.corner + self.a, self.corner + self.b);
            hit = planar::refine(query, self.corner, a, b, self.bounds(), hit, 2.0);
        }
        (0.0 < hit.t && hit.t < t_max).then_some(hit)
    }

    #[inline]
    pub(crate) fn surface<R: Real>(&self, p: Vec3<f64>, id: PrimitiveId) -> SurfacePoint<R> {
        planar::surface(p, self.corner, self.normal(), self.bounds().extent().max_component(), id)
    }
}
