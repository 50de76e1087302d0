//! Triangles.

use super::{ShapeError, check_points, planar};
use crate::query::{Projected, Query, RawHit, larger};
use crate::{Aabb, PrimitiveId, SurfacePoint};
use etalon_optics::{Real, Vec3};

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
    pub fn normal(&self) -> Vec3<f64> {
        planar::unit(self.cross())
    }

    /// Area of one side, m².
    pub fn area(&self) -> f64 {
        0.5 * self.cross().length()
    }

    /// The smallest box around the triangle.
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points([self.a, self.b, self.c])
    }

    fn cross(&self) -> Vec3<f64> {
        planar::edge_cross(self.a, self.b, self.c)
    }

    fn size(&self) -> f64 {
        self.bounds().extent().max_component()
    }

    /// Watertight intersection (Woop, Benthin & Wald 2013) in `f64`: every point of a closed mesh is met by at least one
    /// of the triangles around it.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64) -> Option<RawHit> {
        let projected = self.vertices().map(|v| query.project(v));
        Self::intersect_projected(projected, || self.vertices(), query, t_max)
    }

    /// [`Triangle::intersect`] of three projected vertices.
    #[inline(always)]
    pub(crate) fn intersect_projected(
        [a, b, c]: [Projected; 3],
        vertices: impl FnOnce() -> [Vec3<f64>; 3],
        query: &Query,
        t_max: f64,
    ) -> Option<RawHit> {
        let (u, v, w) = (c.edge(b), a.edge(c), b.edge(a));
        // Inclusive: an edge that passes through the ray as far as rounding tells belongs to both its triangles.
        let outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        if outside {
            return None;
        }
        let det = (u + v) + w;
        // Zero: seen edge-on, its outline is covered by its neighbours. NaN: an origin out of reach.
        if det == 0.0 || det.is_nan() {
            return None;
        }
        let t_det = (u * a.z + v * b.z) + w * c.z;
        let mut hit = RawHit { t: t_det / det, uv: [v / det, w / det] };
        let magnitude = larger(larger(a.magnitude, b.magnitude), c.magnitude);
        let side = |p: Projected| larger(p.x.abs(), p.y.abs());
        let extent = larger(larger(side(a), side(b)), side(c));
        let depth = larger(larger(a.z, b.z), c.z) + larger(larger(-a.z, -b.z), -c.z);
        if !planar::is_determined(magnitude, extent, depth, t_det.abs(), det.abs()) {
            let vertices = vertices();
            hit = planar::refine(query, vertices[0], vertices[1], vertices[2], Aabb::of_points(vertices), hit, 1.0);
        }
        (0.0 < hit.t && hit.t < t_max).then_some(hit)
    }

    #[inline]
    pub(crate) fn surface<R: Real>(&self, p: Vec3<f64>, id: PrimitiveId) -> SurfacePoint<R> {
        planar::surface(p, self.a, self.normal(), self.size(), id)
    }
}
