//! An emitting sphere. From outside, directions are uniform in the cone it fills; from inside, over the whole sphere.

use super::{Emitter, LightSample, Target};
use crate::mis::Density;
use crate::warp::{uniform_cone, uniform_sphere};
use etalon_geometry::Sphere;
use etalon_optics::{Frame, Vec3};
use std::f64::consts::PI;

/// An emitting sphere.
#[derive(Clone, Debug)]
pub struct SphereLight {
    shape: Sphere,
    /// What it emits.
    pub emitter: Emitter,
}

/// How the sphere looks from a reference point: the one predicate that sampling and density share.
enum View {
    Outside {
        /// Toward the centre, unit.
        axis: Vec3<f64>,
        /// Distance of the centre, m.
        distance: f64,
        /// 1 − cos of the cone's half angle.
        one_minus_cos: f64,
    },
    Inside,
}

impl SphereLight {
    /// A light of this shape.
    pub fn new(shape: Sphere, emitter: Emitter) -> Self {
        Self { shape, emitter }
    }

    /// Surface area, m².
    pub fn area(&self) -> f64 {
        self.shape.area()
    }

    fn view(&self, from: Vec3<f64>) -> View {
        let toward = self.shape.centre() - from;
        let distance = toward.length();
        if distance <= self.shape.radius() {
            return View::Inside;
        }
        let sin = self.shape.radius() / distance;
        // cos = √(1 − s²) and 1 − cos = s²/(1 + cos), both without cancellation (hard cases 25, 26).
        let cos = ((distance - self.shape.radius()) * (distance + self.shape.radius())).sqrt() / distance;
        View::Outside { axis: toward / distance, distance, one_minus_cos: sin * sin / (1.0 + cos) }
    }

    /// Zero where [`SphereLight::sample`] finds that the side it sees is dark.
    pub(super) fn density(&self, from: Vec3<f64>) -> f64 {
        match self.view(from) {
            View::Outside { one_minus_cos, .. } if self.emitter.front => 1.0 / (2.0 * PI * one_minus_cos),
            View::Inside if self.emitter.back => 1.0 / (4.0 * PI),
            View::Outside { .. } | View::Inside => 0.0,
        }
    }

    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> Option<LightSample> {
        let (wi, t) = match self.view(from) {
            View::Outside { axis, distance, one_minus_cos } => {
                if !self.emitter.front {
                    return None;
                }
                let local = uniform_cone(u, one_minus_cos);
                let wi = Frame::from_normal(axis).to_world(local).renormalized();
                // The nearer root of |t·wi − toward| = radius, as c/q.
                let b = distance * local.z;
                let sin_squared = local.x * local.x + local.y * local.y;
                let half_chord = self.shape.radius() * self.shape.radius() - distance * distance * sin_squared;
                let power_of_point = (distance - self.shape.radius()) * (distance + self.shape.radius());
                // The rim itself may round to a chord just below zero; there the chord is zero.
                (wi, power_of_point / (b + half_chord.max(0.0).sqrt()))
            }
            View::Inside => {
                if !self.emitter.back {
                    return None;
                }
                let wi = uniform_sphere(u);
                let toward = self.shape.centre() - from;
                let b = wi.dot(toward);
                let depth =
                    ((self.shape.radius() - toward.length()) * (self.shape.radius() + toward.length())).max(0.0);
                let root = (b * b + depth).sqrt();
                let t = if b >= 0.0 { b + root } else { depth / (root - b) };
                (wi, t)
            }
        };
        // From a point on the sphere itself half of all directions leave it at once.
        (t > 0.0).then(|| LightSample {
            wi,
            density: Density::SolidAngle(self.density(from)),
            target: Target::Point(from + wi * t),
            surface: self.emitter.surface,
            scale: 1.0,
        })
    }
}
