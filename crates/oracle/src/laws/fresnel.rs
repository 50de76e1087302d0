//! Fresnel's equations for a smooth dielectric interface: energy, accuracy, Stokes' relations, Brewster, total reflection.
//!
//! Born & Wolf, *Principles of Optics*, §1.5.2. The exact values come from double-double arithmetic.

use crate::{Uniform, Verdict, double_double::DoubleDouble, vector::representable_scalar};

/// Error allowed in units of epsilon times the condition number of the quantity: about a dozen rounded operations.
const ROUNDINGS: f64 = 16.0;

/// Share of the power that an interface reflects and transmits, for the two linear polarisations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FresnelPowers {
    /// Reflectance, electric field perpendicular to the plane of incidence.
    pub r_s: f64,
    /// Reflectance, electric field in the plane of incidence.
    pub r_p: f64,
    /// Transmittance (of power, so with the factor n·cosθₜ/cosθᵢ), perpendicular.
    pub t_s: f64,
    /// Transmittance (of power), in the plane.
    pub t_p: f64,
}

impl FresnelPowers {
    /// Reflectance for unpolarised light.
    #[must_use]
    pub const fn reflectance(&self) -> f64 {
        0.5 * (self.r_s + self.r_p)
    }

    /// Transmittance for unpolarised light.
    #[must_use]
    pub const fn transmittance(&self) -> f64 {
        0.5 * (self.t_s + self.t_p)
    }
}

/// The exact powers, correctly rounded for all practical purposes, for a cosine of incidence in [0, 1] and
/// η = n_transmitted/n_incident.
#[must_use]
pub fn fresnel_exact(cosine: f64, eta: f64) -> FresnelPowers {
    let (c, n) = (DoubleDouble::from(cosine), DoubleDouble::from(eta));
    let n2 = n.squared();
    // (n·cosθₜ)² = n² − 1 + c².
    let g2 = n2 - DoubleDouble::ONE + c.squared();
    if g2.is_negative() {
        return FresnelPowers { r_s: 1.0, r_p: 1.0, t_s: 0.0, t_p: 0.0 };
    }
    let g = g2.sqrt();
    if (c + g).to_f64() == 0.0 {
        return FresnelPowers { r_s: 0.0, r_p: 0.0, t_s: 1.0, t_p: 1.0 };
    }
    let power = |a: DoubleDouble, b: DoubleDouble| {
        // 4ab/(a + b)² is (1 − r)(1 + r): of 32 digits the difference leaves enough.
        let r = (a - b) / (a + b);
        let transmitted = (DoubleDouble::ONE - r) * (DoubleDouble::ONE + r);
        (r.squared().to_f64(), transmitted.to_f64())
    };
    let ((r_s, t_s), (r_p, t_p)) = (power(c, g), power(n2 * c, g));
    FresnelPowers { r_s, r_p, t_s, t_p }
}

/// Condition number of n² − 1 + c²: 1 from the thinner side, growing towards the critical angle from the denser one.
fn conditioning(cosine: f64, eta: f64) -> f64 {
    let (excess, square) = ((eta - 1.0) * (eta + 1.0), cosine * cosine);
    if excess + square == 0.0 { 1.0 } else { (excess.abs() + square) / (excess + square).abs() }
}

/// Angles and index ratios that ordinary and careless formulas disagree on: grazing down to cos 1e-7, ratios down to
/// 1 + 1e-7 and exactly 1, and the ordinary middle; `count` of them.
fn hard_inputs(count: usize, epsilon: f64, seed: u64) -> impl Iterator<Item = (f64, f64)> {
    let mut numbers = Uniform::new(seed);
    (0..count).map(move |i| {
        let cosine = match i % 3 {
            0 => numbers.log_between(1e-7, 1.0),
            1 => numbers.number(),
            _ => 1.0 - numbers.log_between(1e-9, 0.5),
        };
        let eta = match (i / 3) % 4 {
            0 => numbers.log_between(1.0, 4.0),
            1 => 1.0 + numbers.log_between(1e-7, 1e-2),
            2 if i % 60 == 6 => 1.0,
            2 => 1.5,
            _ => numbers.log_between(0.25, 1.0),
        };
        (representable_scalar(cosine, epsilon), representable_scalar(eta, epsilon))
    })
}

/// R + T = 1 for each polarisation, and every power within [0, 1], to 16 ε.
pub fn fresnel_conserves_energy(
    mut subject: impl FnMut(f64, f64) -> FresnelPowers,
    epsilon: f64,
    seed: u64,
) -> Verdict {
    const LAW: &str = "what an interface does not reflect it transmits: R + T = 1";
    let verdicts = hard_inputs(3000, epsilon, seed).map(|(cosine, eta)| {
        let powers = subject(cosine, eta);
        let outside = [powers.r_s, powers.r_p, powers.t_s, powers.t_p]
            .into_iter()
            .map(|x| if x.is_nan() { f64::NAN } else { (-x).max(x - 1.0).max(0.0) })
            .fold(0.0, |worst, x| if x.is_nan() { f64::NAN } else { f64::max(worst, x) });
        let missing = (powers.r_s + powers.t_s - 1.0).abs().max((powers.r_p + powers.t_p - 1.0).abs());
        let error = if outside.is_nan() { f64::NAN } else { missing.max(outside) };
        Verdict::bounded(LAW, error, ROUNDINGS * epsilon, format!("cos {cosine:e}, η {eta:.17}: {powers:?}"))
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Every power within 16 ε *relative* of the exact one, times the condition number of the quantity at that input (towards
/// the critical angle, and of r_p towards Brewster's angle).
///
/// This sees 1 − R used for T (off 1.6 % at cos 1e-6 in f32) and c − n·cosθₜ used for r near n = 1 (off 46 % at 1 + 1e-7).
pub fn fresnel_is_accurate(mut subject: impl FnMut(f64, f64) -> FresnelPowers, epsilon: f64, seed: u64) -> Verdict {
    const LAW: &str = "Fresnel's powers are accurate to a few roundings";
    let verdicts = hard_inputs(3000, epsilon, seed).filter_map(|(cosine, eta)| {
        let exact = fresnel_exact(cosine, eta);
        let condition = conditioning(cosine, eta);
        if condition * epsilon * ROUNDINGS > 0.1 {
            // So near the critical angle that no digit survives; total reflection is another law's business.
            return None;
        }
        let product = cosine * cosine * (eta * eta + 1.0);
        let brewster = (product + 1.0) / (product - 1.0).abs().max(f64::MIN_POSITIVE);
        let got = subject(cosine, eta);
        let relative = |value: f64, exact: f64, condition: f64| {
            if value == exact { 0.0 } else { (value - exact).abs() / (exact * condition) }
        };
        // Near Brewster's angle r_p is judged in amplitude: its square has no relative accuracy left to ask for.
        let r_p = if brewster > 100.0 {
            (got.r_p.sqrt() - exact.r_p.sqrt()).abs() / condition
        } else {
            relative(got.r_p, exact.r_p, 2.0 * condition * brewster)
        };
        let errors = [
            relative(got.r_s, exact.r_s, 2.0 * condition),
            r_p,
            relative(got.t_s, exact.t_s, condition),
            relative(got.t_p, exact.t_p, condition),
        ];
        let error = errors.into_iter().fold(0.0, |worst, x| if x.is_nan() { f64::NAN } else { f64::max(worst, x) });
        let evidence = format!("cos {cosine:e}, η {eta:.17}: {got:?}, exactly {exact:?}");
        Some(Verdict::bounded(LAW, error, ROUNDINGS * epsilon, evidence))
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Stokes' relation for powers: the interface reflects and transmits the same share from either side at conjugate angles.
///
/// Bound 16 ε·(4 + n²/cos²θ): the conjugate angle is itself rounded and the other side's conditioning is n²/cos²θ.
pub fn fresnel_obeys_stokes(mut subject: impl FnMut(f64, f64) -> FresnelPowers, epsilon: f64, seed: u64) -> Verdict {
    const LAW: &str = "an interface reflects the same share from either side at conjugate angles";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..2000).map(|_| {
        let cosine = representable_scalar(numbers.between(0.05, 1.0), epsilon);
        let eta = representable_scalar(numbers.log_between(1.0, 4.0), epsilon);
        let square = (eta * eta - (1.0 - cosine) * (1.0 + cosine)).sqrt() / eta;
        let (conjugate, inverse) =
            (representable_scalar(square.min(1.0), epsilon), representable_scalar(1.0 / eta, epsilon));
        let (one, other) = (subject(cosine, eta), subject(conjugate, inverse));
        let differences =
            [one.r_s - other.r_s, one.r_p - other.r_p, one.t_s - other.t_s, one.t_p - other.t_p].map(f64::abs);
        let error =
            differences.into_iter().fold(0.0, |worst, x| if x.is_nan() { f64::NAN } else { f64::max(worst, x) });
        let bound = ROUNDINGS * epsilon * (4.0 + (eta / cosine).powi(2));
        let evidence = format!("cos {cosine:e} at η {eta}: {one:?}; cos {conjugate:e} at 1/η: {other:?}");
        Verdict::bounded(LAW, error, bound, evidence)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Stokes' relations for amplitudes: r′ = −r and t·t′ = 1 − r² for both polarisations at conjugate angles.
///
/// The subject maps (cos of incidence, η) to the amplitude coefficients `[r_s, r_p, t_s, t_p]` of the electric field
/// (Born & Wolf's signs: r_p = (n²c − g)/(n²c + g) with g = n·cosθₜ). Bound as in [`fresnel_obeys_stokes`].
pub fn stokes_amplitudes(mut subject: impl FnMut(f64, f64) -> [f64; 4], epsilon: f64, seed: u64) -> Verdict {
    const LAW: &str = "Stokes' relations: r′ = −r and t·t′ = 1 − r²";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..2000).map(|_| {
        let cosine = representable_scalar(numbers.between(0.05, 1.0), epsilon);
        let eta = representable_scalar(numbers.log_between(1.0, 4.0), epsilon);
        let conjugate = (eta * eta - (1.0 - cosine) * (1.0 + cosine)).sqrt() / eta;
        let here = subject(cosine, eta);
        let there =
            subject(representable_scalar(conjugate.min(1.0), epsilon), representable_scalar(1.0 / eta, epsilon));
        let errors = [
            here[0] + there[0],
            here[1] + there[1],
            here[2] * there[2] - (1.0 - here[0] * here[0]),
            here[3] * there[3] - (1.0 - here[1] * here[1]),
        ];
        let error =
            errors.into_iter().fold(0.0, |worst, x| if x.is_nan() { f64::NAN } else { f64::max(worst, x.abs()) });
        let bound = ROUNDINGS * epsilon * (4.0 + (eta / cosine).powi(2));
        Verdict::bounded(LAW, error, bound, format!("cos {cosine:e}, η {eta}: {here:?}, conjugate {there:?}"))
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Brewster's angle: r_p vanishes at tanθ = n, to 16 ε in amplitude; and normal incidence reflects ((n − 1)/(n + 1))² in
/// both polarisations.
pub fn fresnel_obeys_brewster(mut subject: impl FnMut(f64, f64) -> FresnelPowers, epsilon: f64, seed: u64) -> Verdict {
    const LAW: &str = "nothing in the plane of incidence is reflected at Brewster's angle";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..1000).map(|_| {
        let eta = representable_scalar(numbers.log_between(0.25, 4.0), epsilon);
        let cosine = representable_scalar(1.0 / eta.hypot(1.0), epsilon);
        let at_brewster = subject(cosine, eta).r_p.abs().sqrt();
        // The angle's own rounding, as large as ε·cosine, moves r_p by its slope there, at most n²/2 or 1/(2n²).
        let slope = (eta * eta).max(1.0 / (eta * eta));
        let normal = subject(1.0, eta);
        let amplitude = ((eta - 1.0) / (eta + 1.0)).abs();
        let off_normal = (normal.r_s.sqrt() - amplitude).abs().max((normal.r_p.sqrt() - amplitude).abs());
        let error =
            if at_brewster.is_nan() || off_normal.is_nan() { f64::NAN } else { (at_brewster / slope).max(off_normal) };
        let evidence =
            format!("η {eta}: |r_p| {at_brewster:.2e} at Brewster's angle, off by {off_normal:.2e} at normal");
        Verdict::bounded(LAW, error, ROUNDINGS * epsilon, evidence)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Beyond the critical angle everything is reflected: R exactly 1 and T exactly 0; and R rises to 1 continuously towards
/// it, as 1 − R ∝ cosθₜ does, down to 1e-12 (f32: 1e-5) in cos²θₜ.
pub fn fresnel_reflects_totally(
    mut subject: impl FnMut(f64, f64) -> FresnelPowers,
    epsilon: f64,
    seed: u64,
) -> Verdict {
    const LAW: &str = "beyond the critical angle everything is reflected, and R reaches 1 without a jump";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..2000).map(|i| {
        let eta = representable_scalar(numbers.log_between(0.25, 0.99), epsilon);
        let critical_square = (1.0 - eta) * (1.0 + eta);
        let offset = numbers.log_between(64.0 * epsilon, 1e-2);
        let square = critical_square * if i % 2 == 0 { 1.0 - offset } else { 1.0 + offset };
        let cosine = representable_scalar(square.sqrt(), epsilon);
        let (got, exact) = (subject(cosine, eta), fresnel_exact(cosine, eta));
        let got_all = [got.r_s, got.r_p, got.t_s, got.t_p];
        let exact_all = [exact.r_s, exact.r_p, exact.t_s, exact.t_p];
        let total = exact.t_s == 0.0;
        // T ∝ √(cos²θₜ): an error of ε in the square is an error of ε/(2√…) in T, relative to T's slope of about 4/η.
        let root = (conditioning(cosine, eta) * critical_square).recip().sqrt();
        let bound = if total { 0.0 } else { ROUNDINGS * epsilon * (4.0 / (eta * eta)) * (1.0 + 1.0 / root) };
        let error = got_all
            .iter()
            .zip(exact_all)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, |worst, x| if x.is_nan() { f64::NAN } else { f64::max(worst, x) });
        Verdict::bounded(LAW, error, bound, format!("cos {cosine:e}, η {eta}: {got:?}, exactly {exact:?}"))
    });
    Verdict::worst_of(LAW, verdicts)
}

#[cfg(test)]
mod tests {
    use super::{super::SINGLE, *};

    /// The forms without cancellation, independent of the exact evaluation above.
    macro_rules! careful {
        ($name:ident, $scalar:ty) => {
            fn $name(c: f64, n: f64) -> FresnelPowers {
                let (c, n) = (c as $scalar, n as $scalar);
                let excess = (n - 1.0) * (n + 1.0);
                let g2 = excess + c * c;
                if g2 < 0.0 {
                    return FresnelPowers { r_s: 1.0, r_p: 1.0, t_s: 0.0, t_p: 0.0 };
                }
                let g = g2.sqrt();
                let (k, l) = (c + g, n * c + g / n);
                if k == 0.0 {
                    return FresnelPowers { r_s: 0.0, r_p: 0.0, t_s: 1.0, t_p: 1.0 };
                }
                let r_s = -excess / (k * k);
                let r_p = excess * (c * c * (n * n + 1.0) - 1.0) / (n * n * l * l);
                let powers = [r_s * r_s, r_p * r_p, 4.0 * c * g / (k * k), 4.0 * c * g / (l * l)];
                let [r_s, r_p, t_s, t_p] = powers.map(f64::from);
                FresnelPowers { r_s, r_p, t_s, t_p }
            }
        };
    }
    careful!(careful, f64);
    careful!(careful_single, f32);

    fn textbook(c: f64, n: f64) -> FresnelPowers {
        let ct = (1.0 - (1.0 - c * c) / (n * n)).max(0.0).sqrt();
        let (r_s, r_p) = ((c - n * ct) / (c + n * ct), (n * c - ct) / (n * c + ct));
        FresnelPowers { r_s: r_s * r_s, r_p: r_p * r_p, t_s: 1.0 - r_s * r_s, t_p: 1.0 - r_p * r_p }
    }

    #[test]
    fn exact_powers_have_their_textbook_values() {
        let normal = fresnel_exact(1.0, 1.5);
        assert!((normal.r_s - 0.04).abs() < 1e-16 && (normal.t_p - 0.96).abs() < 1e-16);
        let oblique = fresnel_exact(std::f64::consts::FRAC_1_SQRT_2, 1.5);
        // At 45° r_s = (1 − √(2n² − 1))/(1 + √(2n² − 1)), and R_p = R_s² (a known identity).
        assert!((oblique.r_s - ((1.0 - 3.5_f64.sqrt()) / (1.0 + 3.5_f64.sqrt())).powi(2)).abs() < 1e-15, "{oblique:?}");
        assert!((oblique.r_p - oblique.r_s * oblique.r_s).abs() < 1e-15);
    }

    #[test]
    fn forms_without_cancellation_pass_in_both_precisions() {
        for seed in 0..10 {
            for (epsilon, subject) in
                [(f64::EPSILON, careful as fn(f64, f64) -> FresnelPowers), (SINGLE, careful_single)]
            {
                fresnel_conserves_energy(subject, epsilon, seed).assert();
                fresnel_is_accurate(subject, epsilon, seed).assert();
                fresnel_obeys_stokes(subject, epsilon, seed).assert();
                fresnel_obeys_brewster(subject, epsilon, seed).assert();
                fresnel_reflects_totally(subject, epsilon, seed).assert();
            }
        }
    }

    #[test]
    fn the_textbook_form_is_seen_to_cancel() {
        assert!(!fresnel_is_accurate(textbook, f64::EPSILON, 1).pass);
    }

    #[test]
    fn swapped_polarisations_are_seen() {
        let swapped = |c: f64, n: f64| {
            let p = careful(c, n);
            FresnelPowers { r_s: p.r_p, r_p: p.r_s, t_s: p.t_p, t_p: p.t_s }
        };
        assert!(!fresnel_obeys_brewster(swapped, f64::EPSILON, 1).pass);
        assert!(!fresnel_is_accurate(swapped, f64::EPSILON, 1).pass);
    }

    #[test]
    fn an_approximation_by_schlick_is_seen() {
        let schlick = |c: f64, n: f64| {
            let r0 = ((n - 1.0) / (n + 1.0)).powi(2);
            let r = r0 + (1.0 - r0) * (1.0 - c).powi(5);
            FresnelPowers { r_s: r, r_p: r, t_s: 1.0 - r, t_p: 1.0 - r }
        };
        fresnel_conserves_energy(schlick, f64::EPSILON, 1).assert();
        for law in [fresnel_is_accurate, fresnel_obeys_stokes, fresnel_obeys_brewster, fresnel_reflects_totally] {
            assert!(!law(schlick, f64::EPSILON, 1).pass);
        }
    }

    #[test]
    fn amplitudes_obey_stokes_and_a_lost_sign_is_seen() {
        let amplitudes = |c: f64, n: f64| {
            let g = ((n - 1.0) * (n + 1.0) + c * c).sqrt();
            let (k, l) = (c + g, n * n * c + g);
            [(c - g) / k, (n * n * c - g) / l, 2.0 * c / k, 2.0 * n * c / l]
        };
        stokes_amplitudes(amplitudes, f64::EPSILON, 1).assert();
        assert!(!stokes_amplitudes(|c, n| amplitudes(c, n).map(f64::abs), f64::EPSILON, 1).pass);
        let powers_not_amplitudes = |c: f64, n: f64| {
            let a = amplitudes(c, n);
            [a[0], a[1], 1.0 - a[0] * a[0], 1.0 - a[1] * a[1]]
        };
        assert!(!stokes_amplitudes(powers_not_amplitudes, f64::EPSILON, 1).pass);
    }
}
