//! What shadow rays aim at of a sky that paths run into as well (Karlík, Šik, Vévoda, Skřivan and Křivánek, *MIS Compensation: Optimizing
//! Sampling Techniques in Multiple Importance Sampling*, ACM Transactions on Graphics 38(6), 2019).
//!
//! Directions from a BSDF find the faint parts of a sky well. Shadow rays find the sun. If they are drawn by the whole luminance, many of them
//! go where the BSDF's directions are as good. So they are drawn by what the luminance is above its mean over all directions. Elsewhere their
//! density is 0, and what a path runs into there has the MIS weight 1: the sum stays the same.

use crate::light::LightSampling;
use etalon_geometry::warp::uniform_sphere;
use etalon_optics::{Real, Vec3};
use std::f64::consts::PI;

/// Below this share of the light a sky is as good as constant, and the luminance itself is drawn from.
const LEAST_SHARE: f64 = 1e-3;

/// The part of a luminance that directions are drawn by.
#[derive(Clone, Copy, Debug)]
pub(in crate::light) struct AboveMean {
    /// What the luminance is above this.
    floor: f64,
    /// ∫ of that part over all directions, sr.
    pub part: f64,
    /// ∫ of the luminance over all directions, sr.
    pub whole: f64,
}

impl AboveMean {
    /// `integral` of the part above a floor. Where shadow rays alone find light, the floor is 0.
    pub(super) fn new(sampling: LightSampling, integral: impl Fn(Self) -> f64) -> Self {
        let all = Self { floor: 0.0, part: 0.0, whole: 0.0 };
        let whole = integral(all);
        let all = Self { part: whole, whole, ..all };
        if sampling != LightSampling::Mis {
            return all;
        }
        let above = Self { floor: whole / (4.0 * PI), ..all };
        let part = integral(above);
        if part > LEAST_SHARE * whole { Self { part, ..above } } else { all }
    }

    /// The part of a luminance.
    #[inline(always)]
    pub(super) fn of(&self, luminance: f64) -> f64 {
        (luminance - self.floor).max(0.0)
    }

    /// The density of a direction in which the part is `part`, sr⁻¹.
    #[inline(always)]
    pub(super) fn density(&self, part: f64) -> f64 {
        part / self.part
    }

    /// The share of directions that are drawn evenly where all of the sky is to be reached. The density is then proportional to the larger of the
    /// luminance and its mean, up to how the luminance is interpolated.
    fn even_share(&self) -> f64 {
        if self.floor == 0.0 { 0.0 } else { self.whole / (self.whole + self.part) }
    }

    /// The direction that `u` in [0, 1)² draws to reach all of the sky. `toward_part` draws one toward the part.
    pub(in crate::light) fn draw_all(
        &self,
        [u, v]: [f64; 2],
        toward_part: impl FnOnce([f64; 2]) -> Vec3<f64>,
    ) -> Vec3<f64> {
        let share = self.even_share();
        match u < share {
            true => uniform_sphere([u / share, v]),
            // Rounding may reach 1.
            false => toward_part([((u - share) / (1.0 - share)).min(f64::ONE_MINUS_EPSILON), v]),
        }
    }

    /// The density of [`AboveMean::draw_all`] in a direction, sr⁻¹, where `toward_part` has `density`.
    pub(in crate::light) fn density_of_all(&self, density: f64) -> f64 {
        let share = self.even_share();
        share / (4.0 * PI) + (1.0 - share) * density
    }
}
