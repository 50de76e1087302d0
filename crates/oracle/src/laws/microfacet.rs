//! Directional albedos of rough surfaces, by quadrature over the normals of their facets.
//!
//! Written from the definitions (Walter et al. 2007; Heitz 2014) in the variables that no sampler uses: the slope of the facet
//! and its azimuth. ∫ f cos θ_i dω_i becomes ∫ D(h) (o·h)/cos θ_o · [R G(o, r) + T G(o, t)] dω_h, n² taken out, with r and t the
//! directions that a facet of normal h reflects and refracts o into.

use std::f64::consts::PI;

use super::fresnel_exact;
use crate::vector::{Vec3, add, dot, scale};

/// How facets hide each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// Smith's, correlated in height for reflection, G₁G₁ for refraction.
    Correlated,
    /// Smith's G₁G₁ for both.
    Separable,
}

/// What becomes of light that meets one facet, as shares of what arrives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleScattering {
    /// Reflected.
    pub reflected: f64,
    /// Refracted.
    pub refracted: f64,
}

/// Smith's Λ for GGX facets of width `alpha`.
fn lambda(alpha: f64, w: Vec3) -> f64 {
    let tan2 = (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2]);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Steps in slope and in azimuth of the rule for [`ggx_albedo`].
const STEPS: usize = 640;

/// Shares of light from the cosine `mu` that GGX facets of width `alpha` reflect and refract, for the relative index `eta`;
/// `None` stands for facets that reflect everything. To about 1e-5, by midpoints: total reflection and the horizon leave kinks, for which no
/// rule of a higher order gains.
#[must_use]
pub fn ggx_albedo(alpha: f64, mu: f64, eta: Option<f64>, masking: Masking) -> SingleScattering {
    let o = [(1.0 - mu * mu).sqrt(), 0.0, mu];
    let lambda_o = lambda(alpha, o);
    let together = |w: Vec3, reflection: bool| {
        let other = lambda(alpha, w);
        match masking {
            Masking::Correlated if reflection => 1.0 / (1.0 + lambda_o + other),
            Masking::Correlated | Masking::Separable => 1.0 / ((1.0 + lambda_o) * (1.0 + other)),
        }
    };
    let mut sum = SingleScattering { reflected: 0.0, refracted: 0.0 };
    for (h, weight) in facets(alpha) {
        let c = dot(o, h);
        if c <= 0.0 {
            continue;
        }
        let seen = weight * c / (mu * h[2]);
        let fresnel = eta.map(|eta| (eta, fresnel_exact(c.min(1.0), eta)));
        let r = add(scale(2.0 * c, h), scale(-1.0, o));
        if r[2] > 0.0 {
            sum.reflected += seen * fresnel.map_or(1.0, |(_, f)| f.reflectance()) * together(r, true);
        }
        let Some((eta, fresnel)) = fresnel else { continue };
        let square = 1.0 - (1.0 - c * c) / (eta * eta);
        if square > 0.0 {
            let t = add(scale(-1.0 / eta, o), scale(c / eta - square.sqrt(), h));
            if t[2] < 0.0 {
                sum.refracted += seen * fresnel.transmittance() * together(t, false);
            }
        }
    }
    sum
}

/// Normals of facets on one side of the plane of incidence with the share of the surface, projected, that each stands for; together 1.
///
/// tan²θ = α²x/(1 − x) spreads D cos θ dω evenly over x in [0, 1] and the azimuth, and x = 1 − y⁴ spreads the steepest facets out, which grazing
/// light sees as 1/√(1 − x).
fn facets(alpha: f64) -> impl Iterator<Item = (Vec3, f64)> {
    let step = |i: usize| (i as f64 + 0.5) / STEPS as f64;
    (0..STEPS * STEPS).map(move |i| {
        let (y, phi) = (step(i % STEPS), step(i / STEPS) * PI);
        let rest = y.powi(4);
        let tan2 = alpha * alpha * (1.0 - rest) / rest;
        let cos = 1.0 / (1.0 + tan2).sqrt();
        let sin = tan2.sqrt() * cos;
        ([sin * phi.cos(), sin * phi.sin(), cos], 4.0 * y.powi(3) / (STEPS * STEPS) as f64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nearly smooth facets return what a plane does; the least width of the quadrature's own grid is far below its effect.
    #[test]
    fn narrow_facets_reflect_as_a_plane_does() {
        for mu in [0.9, 0.4] {
            let plane = fresnel_exact(mu, 1.5);
            let facets = ggx_albedo(1e-3, mu, Some(1.5), Masking::Correlated);
            // Of the order of α.
            assert!((facets.reflected - plane.reflectance()).abs() < 5e-3, "{mu}: {facets:?}");
            assert!((facets.refracted - plane.transmittance()).abs() < 5e-3, "{mu}: {facets:?}");
        }
    }

    /// What a direction sees of all facets together is itself: ∫ G₁ (o·h)⁺ D dω = cos θ_o (Heitz 2014, equation (16)), at any angle, however
    /// steep the facets that it sees are.
    #[test]
    fn facets_fill_what_sees_them() {
        for alpha in [0.03, 0.3, 1.0] {
            for mu in [1.0, 0.3, 0.02] {
                let o = [(1.0_f64 - mu * mu).sqrt(), 0.0, mu];
                let whole: f64 = facets(alpha).map(|(h, weight)| weight * dot(o, h).max(0.0) / h[2]).sum();
                let whole = whole / (mu * (1.0 + lambda(alpha, o)));
                assert!((whole - 1.0).abs() < 2e-5, "α {alpha} µ {mu}: {whole}");
            }
        }
    }

    /// From inside glass, where most facets reflect totally: what is lost by a rule of 2500² midpoints of its own, in another language, which
    /// 1000² confirm to 1e-6.
    #[test]
    fn losses_at_grazing_angles_have_known_values() {
        for (alpha, mu, eta, lost) in [
            (0.2, 0.02, None, 0.032345),
            (0.1, 0.05, None, 0.088238),
            (1.0, 0.9, Some(1.5), 0.137822),
            (0.1, 0.2, Some(1.0 / 1.5), 0.106032),
            (0.3, 0.1, Some(1.0 / 1.5), 0.219408),
        ] {
            let found = ggx_albedo(alpha, mu, eta, Masking::Correlated);
            let read = 1.0 - found.reflected - found.refracted;
            assert!((read - lost).abs() < 1e-5, "α {alpha} µ {mu} η {eta:?}: {read} is not {lost}");
        }
    }

    /// At normal incidence on mirrors the integral of the separable form is elementary in x up to one dimension: reflection
    /// turns 2θ, so G₁ of the reflected direction is known; done here by Simpson's rule.
    #[test]
    fn normal_incidence_is_a_single_integral() {
        let alpha: f64 = 0.6;
        let n = 200_000;
        let mut sum = 0.0;
        for i in 0..n {
            let x = (f64::from(i) + 0.5) / f64::from(n);
            let tan = alpha * (x / (1.0 - x)).sqrt();
            let theta = tan.atan();
            if 2.0 * theta < 0.5 * PI {
                let tan2 = (2.0 * theta).tan().powi(2);
                sum += 2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt()) / f64::from(n);
            }
        }
        let found = ggx_albedo(alpha, 1.0, None, Masking::Separable);
        // The rule errs by the kink at the horizon, 1/n, and the other by its own 1e-5.
        assert!((found.reflected - sum).abs() < 2e-5, "{} is not {sum}", found.reflected);
        // With Λ(o) = 0 both forms are the same.
        let other = ggx_albedo(alpha, 1.0, None, Masking::Correlated);
        assert!((found.reflected - other.reflected).abs() < 1e-6);
    }
}
