//! What flat lights share: uniform points of the surface, seen as directions.

use super::{LightSample, Target};
use crate::mis::Density;
use crate::warp::concentric_disk;
use etalon_geometry::{Aabb, SurfaceId};
use etalon_optics::Vec3;

/// The density in sr⁻¹ of the direction `wi` from `from` when points are uniform on a flat light of this `area`, through
/// `point` with unit normal `n`: d²/(|cos| A), with d = h/|cos| from the height h over the plane.
#[inline(always)]
pub(super) fn density(from: Vec3<f64>, wi: Vec3<f64>, point: Vec3<f64>, n: Vec3<f64>, area: f64) -> f64 {
    let height = (point - from).dot(n);
    let cos = wi.dot(n).abs();
    let distance = height.abs() / cos;
    distance * distance / (cos * area)
}

/// A flat light as far as its points and their densities depend on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    /// A corner, and the edges that leave it.
    pub corner: Vec3<f64>,
    /// See above.
    pub edges: [Vec3<f64>; 2],
    /// Unit normal.
    pub normal: Vec3<f64>,
    /// Area of one side.
    pub area: f64,
    /// Whether it is a triangle: the half of the parallelogram on the corner's side.
    pub half: bool,
    /// Whether the side that the normal points into emits.
    pub front: bool,
    /// Whether the other side emits.
    pub back: bool,
}

/// A direction toward a point of a flat light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// The point.
    pub point: Vec3<f64>,
    /// Unit vector toward it.
    pub wi: Vec3<f64>,
    /// Density of that, sr⁻¹.
    pub density: f64,
    /// False edge-on, and where the light does not emit toward the reference point: the rest then means nothing.
    pub lit: bool,
}

impl Flat {
    /// The box that it fills.
    pub(super) fn bounds(&self) -> Aabb {
        let [a, b] = self.edges.map(|edge| self.corner + edge);
        let far = if self.half { a } else { a + self.edges[1] };
        Aabb::of_points([self.corner, a, b, far])
    }

    /// The uniform point for `u` in [0, 1)², seen from `from`; without branches, so that a loop over points is vectorised.
    #[inline(always)]
    pub(crate) fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Aim {
        // Heitz 2019, *A Low-Distortion Map Between Triangle and Square*: the square folded along its diagonal.
        let above = u[1] > u[0];
        let half = 0.5 * if above { u[0] } else { u[1] };
        let folded = if above { [half, u[1] - half] } else { [u[0] - half, half] };
        let (s, t) = if self.half { (folded[0], folded[1]) } else { (u[0], u[1]) };
        self.seen(from, self.corner + self.edges[0] * s + self.edges[1] * t)
    }

    /// The uniform point for `u` in [0, 1)² of the disk whose middle is the corner and whose radii along the frame's axes are the
    /// edges, seen from `from`; without branches.
    #[inline(always)]
    pub(crate) fn aim_at_disk(&self, from: Vec3<f64>, u: [f64; 2]) -> Aim {
        let [x, y] = concentric_disk(u);
        self.seen(from, self.corner + self.edges[0] * x + self.edges[1] * y)
    }

    /// A point of the light, seen from `from`.
    #[inline(always)]
    fn seen(&self, from: Vec3<f64>, point: Vec3<f64>) -> Aim {
        let toward = point - from;
        let distance = toward.length();
        let wi = toward / distance;
        let density = density(from, wi, self.corner, self.normal, self.area);
        let emits = if self.normal.dot(-toward) > 0.0 { self.front } else { self.back };
        // In the plane of the light up to rounding, the density is infinite and the light's share zero.
        let lit =
            (distance != 0.0) & (toward.dot(self.normal) != 0.0) & emits & (density > 0.0) & (density < f64::INFINITY);
        Aim { point, wi, density, lit }
    }

    /// A uniform point as a sample of the light of this surface.
    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2], surface: SurfaceId) -> Option<LightSample> {
        self.aim(from, u).sample(surface)
    }
}

impl Aim {
    /// As a sample of the light of this surface.
    #[inline(always)]
    pub(crate) fn sample(&self, surface: SurfaceId) -> Option<LightSample> {
        let Self { point, wi, density, lit } = *self;
        lit.then_some(LightSample {
            colour: None,
            wi,
            density: Density::SolidAngle(density),
            target: Target::Point(point),
            surface,
            scale: 1.0,
        })
    }
}
