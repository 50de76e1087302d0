//! Parallelograms.

use super::{PlanarSampler, ShapeError, ShapeMap, check_points, oriented, planar};
use crate::Aabb;
use crate::query::{Projection, Query, exact_edge};
use crate::ray::{ExactPoint, RawHit};
use crate::vec4::{Four, Plain4, larger};
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

    /// Its uniform points.
    pub(crate) fn sampler(&self) -> PlanarSampler {
        let edges = [self.a, self.b];
        PlanarSampler { corner: self.corner, edges, normal: self.normal, area: self.area(), half: false }
    }

    /// Its image.
    pub(crate) fn mapped(&self, map: &impl ShapeMap) -> Result<Self, ShapeError> {
        let (a, b) = oriented(map, map.vector(self.a), map.vector(self.b));
        Self::new(map.point(self.corner), a, b)
    }

    fn cross(&self) -> Vec3<f64> {
        planar::edge_cross(self.corner, self.corner + self.a, self.corner + self.b)
    }

    /// As [`Triangle`](super::Triangle)'s test, with four edges: watertight where corners coincide with those of
    /// neighbours.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64) -> Option<RawHit> {
        self.intersect_lanes::<Plain4>((), &query.projection, || *query, t_max)
    }

    /// [`Parallelogram::intersect`] by the projection of a query, which is asked for where that does not suffice.
    #[inline(always)]
    pub(crate) fn intersect_lanes<F: Four>(
        &self,
        token: F::Token,
        projection: &Projection,
        query: impl FnOnce() -> Query,
        t_max: f64,
    ) -> Option<RawHit> {
        let [c0, c1, c2, c3] = self.corners().map(Vec3::to_array);
        let row = |k: usize| F::new(token, [c0[k], c1[k], c2[k], c3[k]]);
        let [kx, ky, kz] = projection.axes().map(|k| k as usize);
        let ([x, y, z], magnitudes) = projection.project(token, [row(kx), row(ky), row(kz)]);
        let mut e = (x * y.next() - y * x.next()).to_array();
        if e.contains(&0.0) {
            let (x, y) = (x.to_array(), y.to_array());
            for i in 0..4 {
                if e[i] == 0.0 {
                    e[i] = exact_edge([x[i], y[i]], [x[(i + 1) % 4], y[(i + 1) % 4]]);
                }
            }
        }
        let [e0, e1, e2, e3] = e;
        let some_below = e0 < 0.0 || e1 < 0.0 || e2 < 0.0 || e3 < 0.0;
        let some_above = e0 > 0.0 || e1 > 0.0 || e2 > 0.0 || e3 > 0.0;
        if some_below && some_above {
            return None;
        }
        let det = 0.5 * ((e0 + e2) + (e1 + e3));
        if det == 0.0 || det.is_nan() {
            return None;
        }
        // o = p₀ + u·(p₁ − p₀) + v·(p₃ − p₀), solved by Cramer's rule.
        // The edges have decided that the point is inside; against their mean a parameter may err by a few roundoffs.
        let (u, v) = ((e3 / det).clamp(0.0, 1.0), (e0 / det).clamp(0.0, 1.0));
        let [z0, z1, z2, z3] = z.to_array();
        let t = z0 + (u * (z1 - z0) + v * (z3 - z0));
        let mut hit = RawHit { t, uv: [u, v] };
        let extent = x.abs().max(y.abs()).largest();
        let depth = larger(larger(z0, z1), larger(z2, z3)) + larger(larger(-z0, -z1), larger(-z2, -z3));
        if !planar::is_determined(magnitudes.largest(), extent, depth, (t * det).abs(), det.abs()) {
            let (a, b) = (self.corner + self.a, self.corner + self.b);
            hit = planar::refine(&query(), self.corner, a, b, self.bounds(), hit, 2.0);
        }
        (0.0 < hit.t && hit.t < t_max).then_some(hit)
    }

    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        planar::surface(p, self.corner, self.normal, self.extent)
    }

    /// See [`Primitive::plane`](super::Primitive::plane).
    pub(crate) fn plane(&self) -> (Vec3<f64>, Vec3<f64>, f64) {
        (self.corner, self.normal, self.extent)
    }
}
