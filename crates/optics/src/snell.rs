//! Snell's law: directions of refraction.

use crate::fresnel::refracted_cosine;
use crate::{Real, Vec3};

/// The refracted direction of `wi` at an interface of unit normal `n`, or `None` under total internal reflection.
///
/// `wi` is a unit vector that leaves the surface on the side light comes from (in a path traced from the camera: the side
/// the path comes from); the result is a unit vector that leaves the surface on the other side. `eta` = n_t/n_i is the
/// index behind the interface over the index on the side of `wi`. The normal may point to either side.
///
/// Computed in `f64` whatever `R` is: near the critical angle and at grazing exit the cosine of an f32 product of vectors is
/// not good enough. At `eta` = 1 the result is −`wi`, bit for bit.
#[inline]
pub fn refract<R: Real>(wi: Vec3<R>, n: Vec3<R>, eta: R) -> Option<Vec3<R>> {
    refract_f64(wi.to_f64(), n.to_f64(), eta.to_f64()).map(Vec3::cast)
}

#[inline]
fn refract_f64(wi: Vec3<f64>, n: Vec3<f64>, eta: f64) -> Option<Vec3<f64>> {
    let cos = wi.dot(n);
    let (n, cos_i) = if cos < 0.0 { (-n, -cos) } else { (n, cos) };
    // Rounding may carry the product of two unit vectors past 1.
    let cos_i = cos_i.min(1.0);
    refracted_cosine(cos_i, eta).map(|cos_t| refract_with_cosines(wi, n, eta, cos_i, cos_t))
}

/// [`refract`] where the cosines are known already: `cos_i` = `wi`·`n`, at least 0, and `cos_t` from
/// [`refracted_cosine`] or [`crate::fresnel::dielectric`] of the same arguments.
///
/// ω_t = −ω_i/n + (c/n − c_t)·n⃗, with the difference in the form (1 − n²)/(n·(c + n·c_t)), which does not cancel near n = 1.
#[inline(always)]
pub fn refract_with_cosines<R: Real>(wi: Vec3<R>, n: Vec3<R>, eta: R, cos_i: R, cos_t: R) -> Vec3<R> {
    let along = (R::ONE - eta) * (R::ONE + eta) / (eta * (cos_i + eta * cos_t));
    let refracted = n * along - wi / eta;
    // A choice without a branch, so that a loop over interfaces is vectorised.
    let nothing = eta == R::ONE;
    let choose = |a: R, b: R| if nothing { a } else { b };
    Vec3::new(choose(-wi.x, refracted.x), choose(-wi.y, refracted.y), choose(-wi.z, refracted.z))
}
