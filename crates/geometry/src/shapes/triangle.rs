//! Triangles.

use super::{PlanarSampler, ShapeError, ShapeMap, check_points, oriented, planar};
use crate::Aabb;
use crate::query::{Projection, Query, exact_edge};
use crate::ray::{ExactPoint, RawHit};
use crate::vec4::{Axis, Four, Plain4, larger};
use etalon_optics::Vec3;

/// A triangle, seen by rays from both sides; its outward side is the one from which a, b, c turn counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    a: Vec3<f64>,
    b: Vec3<f64>,
    c: Vec3<f64>,
}

impl Triangle {
    /// A triangle of three vertices, m.
    ///
    /// # Errors
    /// If a coordinate is not finite or out of range, or the triangle has no area.
    pub fn new(a: Vec3<f64>, b: Vec3<f64>, c: Vec3<f64>) -> Result<Self, ShapeError> {
        check_points(&[a, b, c])?;
        let triangle = Self { a, b, c };
        let cross = triangle.cross();
        if cross == Vec3::ZERO {
            return Err(ShapeError::NoArea);
        }
        if triangle.size() < super::MIN_LENGTH {
            return Err(ShapeError::OutOfRange);
        }
        Ok(triangle)
    }

    /// The vertices, m.
    pub fn vertices(&self) -> [Vec3<f64>; 3] {
        [self.a, self.b, self.c]
    }

    /// Unit normal on the outward side.
    #[inline]
    pub fn normal(&self) -> Vec3<f64> {
        planar::unit(self.cross())
    }

    /// Area of one side, m².
    pub fn area(&self) -> f64 {
        0.5 * self.cross().length()
    }

    /// The smallest box around the triangle.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points([self.a, self.b, self.c])
    }

    /// Its uniform points.
    pub(crate) fn sampler(&self) -> PlanarSampler {
        let edges = [self.b - self.a, self.c - self.a];
        PlanarSampler { corner: self.a, edges, normal: self.normal(), area: self.area(), half: true }
    }

    /// Its image.
    pub(crate) fn mapped(&self, map: &impl ShapeMap) -> Result<Self, ShapeError> {
        let [a, b, c] = self.vertices().map(|p| map.point(p));
        let (b, c) = oriented(map, b, c);
        Self::new(a, b, c)
    }

    #[inline]
    fn cross(&self) -> Vec3<f64> {
        planar::edge_cross(self.a, self.b, self.c)
    }

    #[inline]
    fn size(&self) -> f64 {
        self.bounds().extent().max_component()
    }

    /// Watertight intersection (Woop, Benthin & Wald 2013) in `f64`: every point of a closed mesh is met by at least one
    /// of the triangles around it.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64) -> Option<RawHit> {
        let lanes = self.lanes((), query.projection.axes());
        Self::intersect_lanes::<Plain4>((), lanes, &query.projection, || (self, *query), t_max)
    }

    /// Lanes of the vertices' coordinates in the order of `axes`; the fourth lane repeats the third.
    #[inline(always)]
    pub(crate) fn lanes<F: Four>(&self, token: F::Token, [kx, ky, kz]: [Axis; 3]) -> [F; 3] {
        let (kx, ky, kz) = (kx as usize, ky as usize, kz as usize);
        let [a, b, c] = [self.a.to_array(), self.b.to_array(), self.c.to_array()];
        [
            F::new(token, [a[kx], b[kx], c[kx], c[kx]]),
            F::new(token, [a[ky], b[ky], c[ky], c[ky]]),
            F::new(token, [a[kz], b[kz], c[kz], c[kz]]),
        ]
    }

    /// [`Triangle::intersect`] with the result of [`Triangle::lanes`], for the triangle and the query themselves where that does
    /// not suffice.
    #[inline(always)]
    pub(crate) fn intersect_lanes<'a, F: Four>(
        token: F::Token,
        lanes: [F; 3],
        projection: &Projection,
        in_full: impl FnOnce() -> (&'a Self, Query),
        t_max: f64,
    ) -> Option<RawHit> {
        let ([x, y, z], magnitudes) = projection.project(token, lanes);
        // (c, a, b) × (b, c, a)
        let (px, py) = (x.turned(), y.turned());
        let (qx, qy) = (px.turned(), py.turned());
        let edges = px * qy - py * qx;
        let [mut u, mut v, mut w, _] = edges.to_array();
        let [below, above] = edges.signs().map(|lanes| lanes & 0b111);
        // Inclusive: an edge that passes through the ray as far as rounding tells belongs to both its triangles.
        let mut outside = below != 0 && above != 0;
        if below | above != 0b111 {
            let (x, y) = (x.to_array(), y.to_array());
            let edge = |p: usize, q: usize, area: f64| {
                if area == 0.0 { exact_edge([x[p], y[p]], [x[q], y[q]]) } else { area }
            };
            (u, v, w) = (edge(2, 1, u), edge(0, 2, v), edge(1, 0, w));
            outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        }
        if outside {
            return None;
        }
        let det = (u + v) + w;
        // Zero: seen edge-on, its outline is covered by its neighbours. NaN: an origin out of reach.
        if det == 0.0 || det.is_nan() {
            return None;
        }
        let [za, zb, zc, _] = z.to_array();
        let t_det = (u * za + v * zb) + w * zc;
        // Numbers, not a hit: what a function that is called writes to lies in memory, and what is made of it.
        let (mut t, mut uv) = (t_det / det, (v / det, w / det));
        let extent = x.abs().max(y.abs()).largest();
        let depth = larger(larger(za, zb), zc) + larger(larger(-za, -zb), -zc);
        if !planar::is_determined(magnitudes.largest(), extent, depth, t_det.abs(), det.abs()) {
            let (&Self { a, b, c }, query) = in_full();
            let hit = RawHit { t, uv: [uv.0, uv.1] };
            let refined = planar::refine(&query, a, b, c, Aabb::of_points([a, b, c]), hit, 1.0);
            (t, uv) = (refined.t, (refined.uv[0], refined.uv[1]));
        }
        (0.0 < t && t < t_max).then_some(RawHit { t, uv: [uv.0, uv.1] })
    }

    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        let (point, normal, size) = self.plane();
        planar::surface(p, point, normal, size)
    }

    /// See [`Primitive::plane`](super::Primitive::plane).
    #[inline]
    pub(crate) fn plane(&self) -> (Vec3<f64>, Vec3<f64>, f64) {
        (self.a, self.normal(), self.size())
    }
}
