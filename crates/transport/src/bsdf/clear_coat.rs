//! The clear coat of a [principled](super::principled) surface: facets of the distribution of Trowbridge and Reitz with the exponent 1, whose
//! tails are longer than those of GGX.
//!
//! D(h) = (α² − 1)/(π ln α² (1 + (α² − 1) cos² θ_h)), and ∫ D cos θ_h dω = 1. Facets are drawn with the density D cos θ_h:
//! sin² θ_h = α² (α^(−2u) − 1)/(1 − α²).
//!
//! # Source
//!
//! B. Burley 2012, *Physically Based Shading at Disney*, SIGGRAPH course notes, appendix B.

use etalon_optics::{Real, Vec3, exp_neg, neg_ln, one_minus_exp_neg};
use std::f64::consts::FRAC_1_PI;

/// Facets of one width.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClearCoat {
    /// 1 − α².
    rest: f64,
    /// −ln α².
    log: f64,
}

/// The width by which facets of every coat hide each other.
const MASKING: f64 = 0.25;

impl ClearCoat {
    /// Facets of the width `alpha`, above 0 and below 1.
    pub(super) fn new(alpha: f64) -> Self {
        Self { rest: (1.0 - alpha) * (1.0 + alpha), log: 2.0 * neg_ln(alpha) }
    }

    /// D of facets at a cosine to the normal, sr⁻¹.
    fn density(&self, cos: f64) -> f64 {
        // 1 − (1 − α²)(1 − s²), which does not cancel: s² is the sine's square.
        FRAC_1_PI * self.rest / (self.log * (1.0 - self.rest + self.rest * (1.0 - cos) * (1.0 + cos)))
    }

    /// D G₁ G₁ of reflection between two directions on the side of the normal, and the density in sr⁻¹ with which [`ClearCoat::sample`] leads
    /// to one of them. `cos` is the cosine between each of them and the facet's normal.
    pub(super) fn reflection(&self, wo: Vec3<f64>, wi: Vec3<f64>, cos: f64) -> [f64; 2] {
        let of_normal = (0.5 * (wo.z + wi.z) / cos).min(1.0);
        let d = self.density(of_normal);
        let shown = |z: f64| 2.0 * z / (z + (z * z + MASKING * MASKING * (1.0 - z * z)).sqrt_nonnegative());
        [d * shown(wo.z) * shown(wi.z), d * of_normal / (4.0 * cos)]
    }

    /// The direction from which a facet drawn by `u` reflects light to `wo`; below the surface the light is lost.
    pub(super) fn sample(&self, wo: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
        let x = u[1] * self.log;
        let sin2 = (1.0 - self.rest) * one_minus_exp_neg(x) / (exp_neg(x) * self.rest);
        let (sin_phi, cos_phi) = f64::sin_cos_turns(u[0]);
        let (sin, cos) = (sin2.sqrt_nonnegative(), (1.0 - sin2).sqrt_nonnegative());
        wo.reflected_about(Vec3::new(sin * cos_phi, sin * sin_phi, cos))
    }
}
