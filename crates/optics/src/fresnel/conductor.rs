//! Reflection at the surface of an absorbing medium.

use crate::Real;

/// Reflected shares of power at the surface of an absorbing medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConductorFresnel<R> {
    /// Of light polarised perpendicular (s) to the plane of incidence.
    pub reflectance_s: R,
    /// Of light polarised parallel (p) to the plane of incidence.
    pub reflectance_p: R,
    /// Of unpolarised light: the mean of the two.
    pub reflectance: R,
}

/// Fresnel's equations for incidence at `cos_i` in [0, 1] on a medium of complex index `n` + i`k`, both relative to the
/// (transparent) medium of incidence; n above 0, k at least 0.
///
/// With (a + ib)² = (n + ik)² − sin²: R_s = ((a − c)² + b²)/((a + c)² + b²) and
/// R_p = R_s·((a·c − s²)² + b²c²)/((a·c + s²)² + b²c²), s² = sin² (Born & Wolf, *Principles of Optics*, §14.2). The smaller
/// of a² and b² is found as n²k² over the larger, not as a difference.
#[inline]
pub fn conductor<R: Real>(cos_i: R, n: R, k: R) -> ConductorFresnel<R> {
    let c = cos_i;
    let sin2 = (R::ONE - c) * (R::ONE + c);
    let nk = n * k;
    let t = (n - k) * (n + k) - sin2;
    let four_n2k2 = R::TWO * nk * (R::TWO * nk);
    let larger = R::HALF * ((t * t + four_n2k2).sqrt() + t.abs());
    let smaller = if nk == R::ZERO { R::ZERO } else { nk * (nk / larger) };
    let (a2, b2) = if t < R::ZERO { (smaller, larger) } else { (larger, smaller) };
    let a = a2.sqrt();
    let ratio = |x: R, y: R, z: R| ((x - y) * (x - y) + z) / ((x + y) * (x + y) + z);
    // Without an interface the equations are 0/0 at grazing incidence. Chosen last, so that a loop over lanes is vectorised.
    let reflectance_s = if n == R::ONE && k == R::ZERO { R::ZERO } else { ratio(a, c, b2) };
    let of_p = ratio(a * c, sin2, b2 * (c * c));
    let reflectance_p = if reflectance_s == R::ZERO { R::ZERO } else { reflectance_s * of_p };
    ConductorFresnel { reflectance_s, reflectance_p, reflectance: R::HALF * (reflectance_s + reflectance_p) }
}
