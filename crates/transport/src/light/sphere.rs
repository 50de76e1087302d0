//! An emitting sphere. From outside, directions are uniform in the cone it fills; from inside, over the whole sphere.

use super::{Aim, Emitter, LightSample, Target};
use crate::mis::Density;
use crate::warp::{uniform_cone, uniform_sphere};
use etalon_geometry::{Aabb, Sphere};
use etalon_optics::{Frame, Real, Vec3};
use std::f64::consts::PI;

/// An emitting sphere.
#[derive(Clone, Debug)]
pub struct SphereLight {
    shape: Sphere,
    /// What it emits.
    pub emitter: Emitter,
}

/// A sphere as far as the directions toward it depend on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    /// Centre, m.
    pub centre: Vec3<f64>,
    /// Radius, m.
    pub radius: f64,
    /// Whether its outside emits.
    pub front: bool,
}

/// How a sphere looks from a point outside.
struct View {
    /// Toward the centre, unit.
    axis: Vec3<f64>,
    /// Distance of the centre, m.
    distance: f64,
    /// 1 − cos of the half angle of the cone that it fills.
    one_minus_cos: f64,
}

impl Round {
    /// Whether a point is outside: the one predicate that sampling and density share.
    #[inline(always)]
    pub(crate) fn is_outside(&self, from: Vec3<f64>) -> bool {
        (self.centre - from).length() > self.radius
    }

    /// As seen from outside.
    #[inline(always)]
    fn view(&self, from: Vec3<f64>) -> View {
        let toward = self.centre - from;
        let distance = toward.length();
        let sin = self.radius / distance;
        // cos = √(1 − s²) and 1 − cos = s²/(1 + cos), both without cancellation (hard cases 25, 26).
        let cos = ((distance - self.radius) * (distance + self.radius)).sqrt() / distance;
        View { axis: toward / distance, distance, one_minus_cos: sin * sin / (1.0 + cos) }
    }

    /// The direction for `u` in [0, 1)², uniform in the cone that the sphere fills as seen from `from`, a point outside; without
    /// branches, so that a loop over points is vectorised.
    #[inline(always)]
    pub(crate) fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Aim {
        let View { axis, distance, one_minus_cos } = self.view(from);
        let local = uniform_cone(u, one_minus_cos);
        let wi = Frame::from_normal(axis).to_world(local).renormalized();
        // The nearer root of |t·wi − toward| = radius, as c/q.
        let b = distance * local.z;
        let sin_squared = local.x * local.x + local.y * local.y;
        let half_chord = self.radius * self.radius - distance * distance * sin_squared;
        let power_of_point = (distance - self.radius) * (distance + self.radius);
        // The rim itself may round to a chord just below zero; there the chord is zero.
        let t = power_of_point / (b + half_chord.sqrt_nonnegative());
        Aim { point: from + wi * t, wi, density: cone_density(one_minus_cos), lit: self.front & (t > 0.0) }
    }
}

impl Round {
    /// The density of the direction `wi` where [`Round::aim`] draws directions from `from`, a point outside, sr⁻¹: zero beyond the
    /// cone.
    #[inline(always)]
    pub(crate) fn density_of(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        if self.is_met(from, wi) { cone_density(self.view(from).one_minus_cos) } else { 0.0 }
    }

    /// Whether a ray from outside meets it.
    #[inline(always)]
    pub(crate) fn is_met(&self, from: Vec3<f64>, wi: Vec3<f64>) -> bool {
        let toward = self.centre - from;
        let along = toward.dot(wi);
        let across = toward - wi * along;
        (along > 0.0) & (across.length_squared() < self.radius * self.radius)
    }
}

/// Density of directions uniform in a cone, sr⁻¹.
#[inline(always)]
fn cone_density(one_minus_cos: f64) -> f64 {
    1.0 / (2.0 * PI * one_minus_cos)
}

impl SphereLight {
    /// A light of this shape.
    pub fn new(shape: Sphere, emitter: Emitter) -> Self {
        Self { shape, emitter }
    }

    pub(super) fn bounds(&self) -> Aabb {
        self.shape.bounds()
    }

    /// Surface area, m².
    pub fn area(&self) -> f64 {
        self.shape.area()
    }

    /// As seen from outside.
    #[inline]
    pub(crate) fn round(&self) -> Round {
        Round { centre: self.shape.centre(), radius: self.shape.radius(), front: self.emitter.front }
    }

    /// Zero where [`SphereLight::sample`] finds that the side it sees is dark.
    pub(super) fn density(&self, from: Vec3<f64>) -> f64 {
        let round = self.round();
        match round.is_outside(from) {
            true if self.emitter.front => cone_density(round.view(from).one_minus_cos),
            false if self.emitter.back => 1.0 / (4.0 * PI),
            _ => 0.0,
        }
    }

    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        let round = self.round();
        if round.is_outside(from) {
            return round.aim(from, u).sample(self.emitter.surface);
        }
        if !self.emitter.back {
            return None;
        }
        let wi = uniform_sphere(u);
        let toward = self.shape.centre() - from;
        let b = wi.dot(toward);
        let depth = ((self.shape.radius() - toward.length()) * (self.shape.radius() + toward.length())).max(0.0);
        let root = (b * b + depth).sqrt();
        let t = if b >= 0.0 { b + root } else { depth / (root - b) };
        // From a point on the sphere itself half of all directions leave it at once.
        (t > 0.0).then(|| LightSample {
            colour: None,
            wi,
            density: Density::SolidAngle(self.density(from)),
            target: Target::Point(from + wi * t),
            surface: self.emitter.surface,
            scale: 1.0,
        })
    }
}
