//! What shadow rays aim at of a sky that paths run into as well (Karlík, Šik, Vévoda, Skřivan and Křivánek, *MIS Compensation: Optimizing
//! Sampling Techniques in Multiple Importance Sampling*, ACM Transactions on Graphics 38(6), 2019).
//!
//! Directions from a BSDF find the faint parts of a sky well. Shadow rays find the sun. If they are drawn by the whole luminance, many of them
//! go where the BSDF's directions are as good. So they are drawn by what the luminance is above its mean over all directions. Elsewhere their
//! density is 0, and what a path runs into there has the MIS weight 1: the sum stays the same.

use crate::light::LightSampling;
use etalon_optics::Real;
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
        let above = |floor, whole| {
            let above = Self { floor, part: 0.0, whole };
            Self { part: integral(above), ..above }
        };
        let all = above(0.0, 0.0);
        let all = Self { whole: all.part, ..all };
        let some = above(all.whole / (4.0 * PI), all.whole);
        if sampling == LightSampling::Mis && some.part > LEAST_SHARE * all.whole { some } else { all }
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

    /// The share of evenly drawn directions with which directions reach all of the sky. Together their density is that of the larger of the
    /// luminance and its mean, up to how the luminance is interpolated.
    fn even_share(&self) -> f64 {
        if self.floor == 0.0 { 0.0 } else { self.whole / (self.whole + self.part) }
    }

    /// Whether `u` draws an even direction where all of the sky is to be reached; and the number that is left of it.
    pub(in crate::light) fn choose_even(&self, u: f64) -> (bool, f64) {
        let share = self.even_share();
        match u < share {
            true => (true, u / share),
            // Rounding may reach 1.
            false => (false, ((u - share) / (1.0 - share)).min(f64::ONE_MINUS_EPSILON)),
        }
    }

    /// The density of such a direction, sr⁻¹, if directions toward the part have `density`.
    pub(in crate::light) fn density_of_all(&self, density: f64) -> f64 {
        let share = self.even_share();
        share / (4.0 * PI) + (1.0 - share) * density
    }
}
