//! The Beckmann distribution: slopes of facets as of a Gaussian random surface, with the density e^(−t²)/(π α_x α_y), t their length in widths
//! (Beckmann & Spizzichino 1963; Walter et al. 2007, equation (25)).

use etalon_optics::{Real, Vec3, exp_neg, neg_ln, scaled_erfc};
use std::f64::consts::{FRAC_1_PI, FRAC_2_SQRT_PI};

/// 1/√π.
const FRAC_1_SQRT_PI: f64 = 0.5 * FRAC_2_SQRT_PI;
/// Beyond this e^(−t²) is no number that a path needs, and a slope may be infinite.
const MOST_SQUARE: f64 = 700.0;
/// No slope is drawn that is steeper, in widths: e^(−42) of them are.
const STEEPEST: f64 = 6.5;
/// Newton's steps that draw a slope: five or six on the mean; each that leaves the bracket halves it instead.
const MOST_STEPS: usize = 60;

/// Density of facet normals over that of slopes of the length `square`^½ in widths, at the cosine `z` of the normal: e^(−t²)/z⁴.
pub(super) fn density(square: f64, z: f64) -> f64 {
    if square > MOST_SQUARE { 0.0 } else { exp_neg(square) / (z * z * z * z) }
}

/// The density of slopes of this length, squared, over GGX's.
#[inline]
pub(super) fn over_ggx(square: f64) -> f64 {
    if square > MOST_SQUARE { 0.0 } else { exp_neg(square) * (1.0 + square) * (1.0 + square) }
}

/// S = c·erf(c/s) + s·e^(−(c/s)²)/√π of a direction of the cosine c ≥ 0 that sees slopes of the width s: Smith's masking is G₁ = 2c/(c + S).
#[inline]
pub(super) fn stretch(c: f64, s: f64) -> f64 {
    let a = c / s;
    let tail = exp_neg(a * a);
    c * (1.0 - tail * scaled_erfc(a)) + s * tail * FRAC_1_SQRT_PI
}

/// Slopes up to `x` as a direction of the cosine `c` and sine `s` sees them, c·(1 + erf x)/2 + s·e^(−x²)/(2√π), and their density at `x`.
///
/// With x = c/s, where facets turn their backs, it is (c + S)/2.
fn seen_below(x: f64, c: f64, s: f64) -> (f64, f64) {
    let gauss = exp_neg(x * x);
    let tail = gauss * scaled_erfc(x.abs());
    let below = if x < 0.0 { tail } else { 2.0 - tail };
    (0.5 * (c * below + s * gauss * FRAC_1_SQRT_PI), (c - x * s) * gauss * FRAC_1_SQRT_PI)
}

/// A slope along a direction of the cosine `c` and sine `s`, of width 1, such that the share `u` of all that it sees lie below (Heitz & d'Eon
/// 2014). What `u` says is met to 1e-13.
fn visible_slope(c: f64, s: f64, u: f64) -> f64 {
    let (mut low, mut high) = (-STEEPEST, (c / s).min(STEEPEST));
    let all = seen_below(high, c, s).0;
    // As along the normal, by the approximation of Winitzki (2008), and as at grazing angles.
    let (odd, a) = (2.0 * u - 1.0, 0.147);
    let log = -neg_ln((1.0 - odd * odd).max(1e-16));
    let half = FRAC_2_SQRT_PI * FRAC_2_SQRT_PI / (2.0 * a) + 0.5 * log;
    let upright = (((half * half - log / a).sqrt_nonnegative() - half).sqrt_nonnegative()).copysign(odd);
    let grazing = -neg_ln(u.max(1e-18)).sqrt();
    let mut x = (grazing + c * c * (upright - grazing)).clamp(low, high);
    for _ in 0..MOST_STEPS {
        let (below, density) = seen_below(x, c, s);
        let excess = below - u * all;
        if excess.abs() <= 1e-13 * all {
            break;
        }
        if excess > 0.0 {
            high = x
        } else {
            low = x
        }
        let next = x - excess / density;
        // Not a number, or beyond what is known: half way.
        x = if low < next && next < high { next } else { 0.5 * (low + high) };
    }
    x
}

/// The normal of a facet of width 1 that the unit vector `w` (z > 0) sees, to any length.
pub(super) fn visible_normal(w: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
    let s = (w.x * w.x + w.y * w.y).sqrt();
    let (cos_phi, sin_phi) = if s > 0.0 { (w.x / s, w.y / s) } else { (1.0, 0.0) };
    // Across the direction slopes are seen as they are.
    let (along, across) = (visible_slope(w.z, s, u[0]), visible_slope(1.0, 0.0, u[1]));
    Vec3::new(across * sin_phi - along * cos_phi, -along * sin_phi - across * cos_phi, 1.0)
}

/// D of facets of the widths `alpha` whose normal is `h`.
pub(super) fn of_normal(alpha: [f64; 2], h: Vec3<f64>) -> f64 {
    let [x, y] = [h.x / alpha[0], h.y / alpha[1]];
    density((x * x + y * y) / (h.z * h.z), h.z) * FRAC_1_PI / (alpha[0] * alpha[1])
}
