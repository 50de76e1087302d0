//! Directional albedos of rough surfaces, by quadrature over the normals of their facets.
//!
//! Written from the definitions (Walter et al. 2007; Heitz 2014) in the variables that no sampler uses: the slope of the facet
//! and its azimuth. ∫ f cos θ_i dω_i becomes ∫ D(h) (o·h)/cos θ_o · [R G(o, r) + T G(o, t)] dω_h, n² taken out, with r and t the
//! directions that a facet of normal h reflects and refracts o into.

use std::f64::consts::PI;

use super::fresnel_exact;
use crate::{
    quadrature::rectangle,
    vector::{Vec3, add, dot, scale},
};

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

/// Shares of light from the cosine `mu` that GGX facets of width `alpha` reflect and refract, for the relative index `eta`;
/// `None` stands for facets that reflect everything. To about 1e-6.
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
    // tan²θ = α² x/(1 − x) spreads D cos θ dω evenly over x in [0, 1] and the azimuth: D cos θ dω = dx dφ/2π.
    let integral = |refracted: bool| {
        let integrand = |x: f64, phi: f64| {
            let tan2 = alpha * alpha * x / (1.0 - x);
            let cos = 1.0 / (1.0 + tan2).sqrt();
            let sin = tan2.sqrt() * cos;
            let h = [sin * phi.cos(), sin * phi.sin(), cos];
            let c = dot(o, h);
            if c <= 0.0 {
                return 0.0;
            }
            let fresnel = eta.map(|eta| (eta, fresnel_exact(c.min(1.0), eta)));
            let facet = if refracted {
                let Some((eta, fresnel)) = fresnel else { return 0.0 };
                let square = 1.0 - (1.0 - c * c) / (eta * eta);
                if square <= 0.0 {
                    return 0.0;
                }
                let t = add(scale(-1.0 / eta, o), scale(c / eta - square.sqrt(), h));
                if t[2] >= 0.0 { 0.0 } else { fresnel.transmittance() * together(t, false) }
            } else {
                let r = add(scale(2.0 * c, h), scale(-1.0, o));
                let reflectance = fresnel.map_or(1.0, |(_, f)| f.reflectance());
                if r[2] <= 0.0 { 0.0 } else { reflectance * together(r, true) }
            };
            facet * c / (mu * cos) / PI
        };
        // In cells from the start: a sliver of refracting facets would escape a first look at the whole.
        let part = |i: usize| [(i % 4) as f64 / 4.0, (i % 4 + 1) as f64 / 4.0];
        (0..16).map(|i| rectangle(integrand, part(i), part(i / 4).map(|v| v * PI), 1e-7, 40_000).value).sum()
    };
    SingleScattering { reflected: integral(false), refracted: integral(true) }
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
        // The rule errs by the kink at the horizon, 1/n, and the quadrature by its own 1e-6.
        assert!((found.reflected - sum).abs() < 1e-5, "{} is not {sum}", found.reflected);
        // With Λ(o) = 0 both forms are the same.
        let other = ggx_albedo(alpha, 1.0, None, Masking::Correlated);
        assert!((found.reflected - other.reflected).abs() < 1e-6);
    }
}
