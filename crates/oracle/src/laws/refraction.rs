//! Snell's law, total internal reflection and the mirror: where a ray goes at a smooth interface.

use crate::{
    Uniform, Verdict,
    double_double::DoubleDouble,
    vector::{
        Vec3, add, distance_max, dot, frame, is_finite, length, normalize, representable, representable_scalar, scale,
        sub,
    },
};

/// Error allowed in a refracted or reflected direction, in units of the subject's epsilon: the input's own rounding
/// contributes about 3, a dot product and a square root each about 4, times an index ratio of up to 4.
const DIRECTION_BOUND: f64 = 32.0;

/// Half width, in epsilons of sin²θₜ, of the band around the critical angle in which rounding may decide either way.
const CRITICAL_BAND: f64 = 32.0;

/// A ray at a smooth interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Unit direction of travel towards the interface.
    pub direction: [f64; 3],
    /// Unit normal on the side the ray comes from: `direction · normal < 0`.
    pub normal: [f64; 3],
    /// n_transmitted / n_incident along the direction of travel.
    pub eta: f64,
}

impl Crossing {
    /// sin²θₜ − 1 in high precision: below 0 the ray is refracted, above 0 totally reflected.
    #[must_use]
    pub fn beyond_critical(&self) -> f64 {
        let exact = |a: Vec3, b: Vec3| {
            (0..3).fold(DoubleDouble::ZERO, |sum, i| sum + DoubleDouble::from(a[i]) * DoubleDouble::from(b[i]))
        };
        let cosine = exact(self.direction, self.normal);
        let lengths = exact(self.direction, self.direction) * exact(self.normal, self.normal);
        // Directions are unit only to rounding; the sine of the angle between them is independent of their lengths.
        let sine_squared = DoubleDouble::ONE - cosine.squared() / lengths;
        (sine_squared / DoubleDouble::from(self.eta).squared() - DoubleDouble::ONE).to_f64()
    }

    /// A random crossing: any orientation, angle of incidence by `cosine`, rounded to what the subject can represent.
    fn random(numbers: &mut Uniform, cosine: f64, eta: f64, epsilon: f64) -> Self {
        let normal = normalize(representable(numbers.direction(), epsilon));
        let (s, t) = frame(normal);
        let (sin_phi, cos_phi) = numbers.between(0.0, std::f64::consts::TAU).sin_cos();
        let tangent = add(scale(cos_phi, s), scale(sin_phi, t));
        let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
        Self {
            direction: representable(sub(scale(sine, tangent), scale(cosine, normal)), epsilon),
            normal: representable(normal, epsilon),
            eta: representable_scalar(eta, epsilon),
        }
    }
}

/// Snell's law for one ray: n₁·sinθ₁ = n₂·sinθ₂ in the plane of incidence, on the far side, of unit length.
///
/// The test is the vector form, the tangential part of n·direction is continuous, which has no ill-conditioned angle:
/// |d∥ − η·d′∥| ≤ 32·ε·max(1, η). `None` is total internal reflection and must be what the angle says; within 32 ε of the
/// critical angle in sin²θₜ either answer is accepted.
pub fn snell(crossing: &Crossing, refracted: Option<[f64; 3]>, epsilon: f64) -> Verdict {
    const LAW: &str = "refraction obeys Snell's law";
    let beyond = crossing.beyond_critical();
    let undecidable = beyond.abs() <= CRITICAL_BAND * epsilon * (1.0 + 1.0 / (crossing.eta * crossing.eta));
    let Some(out) = refracted else {
        let story = format!("{crossing:?} was called total reflection, sin²θₜ − 1 = {beyond:e}");
        return if beyond > 0.0 || undecidable {
            Verdict::bounded(LAW, 0.0, DIRECTION_BOUND * epsilon, story)
        } else {
            Verdict::broken(LAW, story)
        };
    };
    if !is_finite(out) {
        return Verdict::broken(LAW, format!("{crossing:?} gave the direction {out:?}"));
    }
    if beyond > 0.0 && !undecidable {
        let story = format!("{crossing:?} is totally reflected (sin²θₜ − 1 = {beyond:e}) but was refracted to {out:?}");
        return Verdict::broken(LAW, story);
    }
    let normal = normalize(crossing.normal);
    let tangential = |v: Vec3| sub(v, scale(dot(v, normal), normal));
    let scale_of_error = crossing.eta.max(1.0);
    let bend = distance_max(tangential(crossing.direction), scale(crossing.eta, tangential(out))) / scale_of_error;
    // A direction of length 1 + δ refracts to one of length 1 + δ/η².
    let stretch = (length(out) - 1.0).abs() / (1.0 / (crossing.eta * crossing.eta)).max(1.0);
    // On the far side; exactly in the surface only at the critical angle, where rounding may lift it by √ε.
    let wrong_side = (dot(out, normal) - if undecidable { 8.0 * epsilon.sqrt() } else { 0.0 }).max(0.0);
    let error = [bend, stretch, wrong_side].into_iter().fold(0.0, f64::max);
    let evidence = format!(
        "{crossing:?} refracted to {out:?}: tangential mismatch {bend:.2e}, length (conditioned) off {stretch:.2e}, back on the incident \
         side by {wrong_side:.2e}"
    );
    Verdict::bounded(LAW, error, DIRECTION_BOUND * epsilon, evidence)
}

/// Snell's law over 4000 random orientations, ratios of indices from 1/4 to 4 and angles from normal incidence to 1e-6 rad
/// short of grazing, index matching included.
///
/// The subject gets (unit direction of travel, unit normal on the incident side, η = n_transmitted/n_incident) and answers
/// the unit refracted direction, or `None` for total internal reflection.
pub fn snell_sweep(
    mut refract: impl FnMut([f64; 3], [f64; 3], f64) -> Option<[f64; 3]>,
    epsilon: f64,
    seed: u64,
) -> Verdict {
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..4000).map(|i| {
        let eta = match i % 4 {
            0 => 1.0,
            1 => 1.0 + numbers.log_between(1e-6, 1e-1),
            _ => numbers.log_between(0.25, 4.0),
        };
        let cosine = match i % 3 {
            0 => numbers.log_between(1e-6, 1.0),
            1 => 1.0 - numbers.log_between(1e-12, 1.0),
            _ => numbers.number().max(1e-6),
        };
        let crossing = Crossing::random(&mut numbers, cosine, eta, epsilon);
        snell(&crossing, refract(crossing.direction, crossing.normal, crossing.eta), epsilon)
    });
    Verdict::worst_of("refraction obeys Snell's law", verdicts)
}

/// Total internal reflection: never below the critical angle, always above it, never a NaN, never from the thinner medium.
///
/// 3000 rays straddle the critical angle with sin²θₜ − 1 log-uniform from ±1e-1 down to ±64 ε (the narrowest that rounding
/// of the inputs lets anyone decide). The subject is that of [`snell_sweep`].
pub fn total_internal_reflection(
    mut refract: impl FnMut([f64; 3], [f64; 3], f64) -> Option<[f64; 3]>,
    epsilon: f64,
    seed: u64,
) -> Verdict {
    const LAW: &str = "total internal reflection begins exactly at the critical angle";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..3000).map(|i| {
        let eta: f64 = if i % 3 == 2 { numbers.log_between(1.0, 4.0) } else { numbers.log_between(0.25, 0.995) };
        // Twice the band in which either answer would be right.
        let narrowest = 2.0 * CRITICAL_BAND * epsilon * (1.0 + 1.0 / (eta * eta));
        let offset = numbers.log_between(narrowest, 0.1);
        let target = (eta * eta * if i % 2 == 0 { 1.0 - offset } else { 1.0 + offset }).min(1.0 - 1e-9);
        let cosine = if eta >= 1.0 { numbers.log_between(1e-6, 1.0) } else { (1.0 - target).sqrt() };
        let crossing = Crossing::random(&mut numbers, cosine, eta, epsilon);
        let beyond = crossing.beyond_critical();
        let out = refract(crossing.direction, crossing.normal, crossing.eta);
        if out.is_some_and(|d| !is_finite(d)) {
            return Verdict::broken(LAW, format!("{crossing:?}, sin²θₜ − 1 = {beyond:e}, gave {out:?}"));
        }
        let wrong = out.is_none() != (beyond > 0.0);
        let evidence = format!(
            "{crossing:?}, sin²θₜ − 1 = {beyond:e}, was {}",
            if out.is_none() { "totally reflected" } else { "refracted" }
        );
        // The error of a wrong answer is how far it is from the angle at which it would be right.
        Verdict::bounded(LAW, if wrong { beyond.abs() } else { 0.0 }, 0.5 * narrowest, evidence)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// The law of reflection: the tangential part is kept, the normal part is turned round, the length is 1.
///
/// The subject gets (unit direction of travel, unit normal on the incident side) and answers the reflected direction.
pub fn mirror_reflection(mut reflect: impl FnMut([f64; 3], [f64; 3]) -> [f64; 3], epsilon: f64, seed: u64) -> Verdict {
    const LAW: &str = "a mirror keeps the tangential part and turns the normal part round";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..2000).map(|_| {
        let cosine = numbers.log_between(1e-6, 1.0);
        let crossing = Crossing::random(&mut numbers, cosine, 1.0, epsilon);
        let out = reflect(crossing.direction, crossing.normal);
        let normal = normalize(crossing.normal);
        let expected = sub(crossing.direction, scale(2.0 * dot(crossing.direction, normal), normal));
        let error = distance_max(out, expected);
        Verdict::bounded(LAW, error, DIRECTION_BOUND * epsilon, format!("{crossing:?} reflected to {out:?}"))
    });
    Verdict::worst_of(LAW, verdicts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refract(direction: Vec3, normal: Vec3, eta: f64) -> Option<Vec3> {
        let cosine = -dot(direction, normal);
        let square = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
        (square >= 0.0).then(|| add(scale(1.0 / eta, direction), scale(cosine / eta - square.sqrt(), normal)))
    }

    #[test]
    fn the_textbook_formula_passes() {
        for seed in 0..20 {
            snell_sweep(refract, f64::EPSILON, seed).assert();
            total_internal_reflection(refract, f64::EPSILON, seed).assert();
            mirror_reflection(|d, n| sub(d, scale(2.0 * dot(d, n), n)), f64::EPSILON, seed).assert();
        }
    }

    #[test]
    fn the_textbook_formula_in_single_precision_passes_at_single_precision() {
        let single = |direction: Vec3, normal: Vec3, eta: f64| {
            let (d, n, eta) = (direction.map(|x| x as f32), normal.map(|x| x as f32), eta as f32);
            let cosine = -(d[0] * n[0] + d[1] * n[1] + d[2] * n[2]);
            let square = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
            let along = |i: usize| f64::from(d[i] / eta + n[i] * (cosine / eta - square.sqrt()));
            (square >= 0.0).then(|| [along(0), along(1), along(2)])
        };
        for seed in 0..20 {
            snell_sweep(single, super::super::SINGLE, seed).assert();
            total_internal_reflection(single, super::super::SINGLE, seed).assert();
        }
        assert!(!snell_sweep(single, f64::EPSILON, 0).pass, "single precision is seen at double precision's bound");
    }

    #[test]
    fn the_published_formula_with_the_wrong_sign_is_rejected() {
        // K = η′D + (η′(N·D) − √(1 − η′²(1 − (N·D)²)))N with η′ = n_incident/n_transmitted.
        let published = |d: Vec3, n: Vec3, eta: f64| {
            let (ri, cosine) = (1.0 / eta, dot(n, d));
            let root = (1.0 - ri * ri * (1.0 - cosine * cosine)).sqrt();
            Some(add(scale(ri, d), scale(ri * cosine - root, n)))
        };
        let verdict = snell_sweep(published, f64::EPSILON, 1);
        assert!(!verdict.pass);
        assert!(!total_internal_reflection(published, f64::EPSILON, 1).pass, "its NaN is seen");
        // At η = 1 it bends a ray that nothing should bend: visible on a single ray.
        let crossing = Crossing { direction: [0.6, 0.0, -0.8], normal: [0.0, 0.0, 1.0], eta: 1.0 };
        assert!(!snell(&crossing, published(crossing.direction, crossing.normal, 1.0), f64::EPSILON).pass);
    }

    #[test]
    fn a_wrong_sign_of_the_radicand_is_rejected() {
        let inverted = |d: Vec3, n: Vec3, eta: f64| {
            let cosine = -dot(d, n);
            let square = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
            (square < 0.0).then(|| add(scale(1.0 / eta, d), scale(cosine / eta - square.abs().sqrt(), n)))
        };
        assert!(!total_internal_reflection(inverted, f64::EPSILON, 1).pass);
        assert!(!snell_sweep(inverted, f64::EPSILON, 1).pass);
        let never = |d: Vec3, n: Vec3, eta: f64| {
            let cosine = -dot(d, n);
            let square = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0);
            Some(normalize(add(scale(1.0 / eta, d), scale(cosine / eta - square.sqrt(), n))))
        };
        assert!(!total_internal_reflection(never, f64::EPSILON, 1).pass, "a clamped radicand is seen");
    }

    #[test]
    fn the_inverted_ratio_is_rejected() {
        assert!(!snell_sweep(|d, n, eta| refract(d, n, 1.0 / eta), f64::EPSILON, 1).pass);
    }
}
