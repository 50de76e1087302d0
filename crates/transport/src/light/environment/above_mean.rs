//! What shadow rays aim at of a sky that paths run into as well (Karlík, Šik, Vévoda, Skřivan and Křivánek, *MIS Compensation: Optimizing
//! Sampling Techniques in Multiple Importance Sampling*, ACM Transactions on Graphics 38(6), 2019).
//!
//! Directions from a BSDF find the faint parts of a sky well. Shadow rays find the sun. If they are drawn by the whole luminance, many of them
//! go where the BSDF's directions are as good. So they are drawn by what the luminance is above its mean over all directions. Elsewhere their
//! density is 0, and what a path runs into there has the MIS weight 1: the sum stays the same.

use crate::light::LightSampling;
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

    /// The share of the light from a direction that is the part, as the density interpolates it.
    pub(in crate::light) fn share(&self, Brightness { density, luminance }: Brightness) -> f64 {
        // Within a cell the density is interpolated otherwise than the luminance.
        if density > 0.0 { (density * self.part / luminance).min(1.0) } else { 0.0 }
    }
}

/// How bright a sky is in a direction, to shadow rays.
#[derive(Clone, Copy, Debug)]
pub struct Brightness {
    /// The density with which they are drawn in this direction, sr⁻¹.
    pub density: f64,
    /// Its luminance, to the scale of the sky's.
    pub luminance: f64,
}
