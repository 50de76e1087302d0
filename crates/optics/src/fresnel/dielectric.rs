//! Reflection and transmission at the interface of two transparent media.

use crate::Real;

/// Reflection and transmission where there is a refracted ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricFresnel<R> {
    /// Amplitude ratio of the reflected wave polarised perpendicular (s) to the plane of incidence.
    pub r_s: R,
    /// Amplitude ratio of the reflected wave polarised parallel (p) to the plane of incidence, with the sign convention
    /// in which r_p = −r_s at normal incidence.
    pub r_p: R,
    /// Reflected share of unpolarised power, (r_s² + r_p²)/2.
    pub reflectance: R,
    /// Transmitted share of unpolarised power.
    pub transmittance: R,
    /// Cosine of the angle of refraction, in [0, 1].
    pub cos_t: R,
}

/// The reflectance of [`dielectric`] and its cosine of refraction, bit for bit, without branches, so that a loop over interfaces is
/// vectorised. Under total internal reflection the reflectance is 1 and the cosine means nothing.
#[inline(always)]
pub fn dielectric_reflectance(cos_i: f64, eta: f64) -> (f64, f64) {
    let (n, c) = (eta, cos_i);
    let (plain, exact) = (normal_component_squared_plain(c, n), normal_component_squared_exact(c, n));
    let w = if keeps_its_bits(plain, c) { plain } else { exact };
    let refracts = w > 0.0;
    let cos_t = w.sqrt() / n;
    let k = c + n * cos_t;
    let l = n * c + cos_t;
    let n2_minus_1 = (n - 1.0) * (n + 1.0);
    let sin2 = (1.0 - c) * (1.0 + c);
    let (below, above) = (c * c - sin2 / (n * n), cos_t * cos_t - sin2);
    let brewster = if n > 1.0 { below } else { above };
    let r_s = -n2_minus_1 / (k * k);
    let r_p = n2_minus_1 * brewster / (l * l);
    let reflectance = 0.5 * (r_s * r_s + r_p * r_p);
    let reflectance = if refracts { reflectance } else { 1.0 };
    let nothing = n == 1.0;
    (if nothing { 0.0 } else { reflectance }, if nothing { c } else { cos_t })
}

/// c² + n² − 1 as it stands.
#[inline(always)]
fn normal_component_squared_plain(c: f64, n: f64) -> f64 {
    c * c + (n - 1.0) * (n + 1.0)
}

/// Whether no more than three bits of it cancel.
#[inline(always)]
fn keeps_its_bits(plain: f64, c: f64) -> bool {
    plain.abs() > 0.125 * c * c
}

/// The same where n² + c² is near 1, by sums and products of two terms.
#[inline(always)]
fn normal_component_squared_exact(c: f64, n: f64) -> f64 {
    let (c2, c2_error) = exact_square(c);
    let (n2, n2_error) = exact_square(n);
    // n² − 1 and the sum are both exact to their two-term forms.
    let (head, head_error) = exact_sum(n2, -1.0);
    let (sum, sum_error) = exact_sum(head, c2);
    sum + (((sum_error + head_error) + c2_error) + n2_error)
}

/// c² + n² − 1 for 0 ≤ c ≤ 1 and n > 0, to a few roundoffs of the result even where it cancels; its square root is n·cos_t.
#[inline(always)]
fn normal_component_squared<R: Real>(cos_i: R, eta: R) -> f64 {
    let (c, n) = (cos_i.to_f64(), eta.to_f64());
    let plain = normal_component_squared_plain(c, n);
    // From f32 the products c² and (n − 1)(n + 1) are exact in f64 unless n is far from 1, where nothing cancels. From
    // f64 they are rounded, which matters once more than three bits cancel.
    if size_of::<R>() == 4 || keeps_its_bits(plain, c) {
        return plain;
    }
    normal_component_squared_exact(c, n)
}

/// a² as an unevaluated sum of two numbers, exactly (Veltkamp's splitting and Dekker's product; no fused operation).
#[inline(always)]
fn exact_square(a: f64) -> (f64, f64) {
    let t = 134_217_729.0 * a;
    let high = t - (t - a);
    let low = a - high;
    let square = a * a;
    (square, ((high * high - square) + 2.0 * high * low) + low * low)
}

/// a + b as an unevaluated sum of two numbers, exactly (Knuth).
#[inline(always)]
fn exact_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let bb = sum - a;
    (sum, (a - (sum - bb)) + (b - bb))
}

/// The cosine of the angle of refraction for incidence at `cos_i` in [0, 1] and the relative index `eta` = n_t/n_i above 0;
/// `None` under total internal reflection, the critical angle included.
///
/// cos_t² = ((n² − 1) + c²)/n² to 4ε (ε twice the unit roundoff) for any pair of arguments, one unit in the last place from
/// the critical angle too; at `eta` = 1 it is `cos_i`, bit for bit.
#[inline]
pub fn refracted_cosine<R: Real>(cos_i: R, eta: R) -> Option<R> {
    if eta == R::ONE {
        return Some(cos_i);
    }
    let w = normal_component_squared(cos_i, eta);
    (w > 0.0).then(|| R::from_f64(w.sqrt() / eta.to_f64()))
}

/// Fresnel's equations for incidence at `cos_i` in [0, 1] from a medium of index n_i into one of n_t, with
/// `eta` = n_t/n_i above 0; `None` under total internal reflection, where everything is reflected.
///
/// With n = eta, c = cos_i, s² = 1 − c², k = c + n·c_t and l = n·c + c_t, the textbook differences are rewritten so that
/// nothing cancels near n = 1, grazing incidence or the critical angle: r_s = (1 − n²)/k²,
/// r_p = (n² − 1)(c² − s²/n²)/l² for n > 1 and (n² − 1)(c_t² − s²)/l² for n < 1 (the same number; each is the form whose
/// rounding errors stay below a few ε on its side), T = 2·n·c·c_t·(1/k² + 1/l²).
/// Only r_p, where it passes through zero at Brewster's angle, is accurate absolutely and not relatively.
#[inline]
pub fn dielectric<R: Real>(cos_i: R, eta: R) -> Option<DielectricFresnel<R>> {
    if eta == R::ONE {
        let (r_s, r_p, reflectance) = (R::ZERO, R::ZERO, R::ZERO);
        return Some(DielectricFresnel { r_s, r_p, reflectance, transmittance: R::ONE, cos_t: cos_i });
    }
    let cos_t = refracted_cosine(cos_i, eta)?;
    let (n, c) = (eta, cos_i);
    let k = c + n * cos_t;
    let l = n * c + cos_t;
    let n2_minus_1 = (n - R::ONE) * (n + R::ONE);
    let sin2 = (R::ONE - c) * (R::ONE + c);
    let brewster = if n > R::ONE { c * c - sin2 / (n * n) } else { cos_t * cos_t - sin2 };
    let r_s = -n2_minus_1 / (k * k);
    let r_p = n2_minus_1 * brewster / (l * l);
    let reflectance = R::HALF * (r_s * r_s + r_p * r_p);
    let transmittance = R::TWO * n * c * cos_t * (R::ONE / (k * k) + R::ONE / (l * l));
    Some(DielectricFresnel { r_s, r_p, reflectance, transmittance, cos_t })
}
