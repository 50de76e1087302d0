//! Directional albedos of rough surfaces, by quadrature over the normals of their facets.
//!
//! Written from the definitions (Walter et al. 2007; Heitz 2014) in the variables that no sampler uses: the slope of the facet
//! and its azimuth. ∫ f cos θ_i dω_i becomes ∫ D(h) (o·h)/cos θ_o · [R G(o, r) + T G(o, t)] dω_h, n² taken out, with r and t the
//! directions that a facet of normal h reflects and refracts o into.

use std::f64::consts::PI;

use super::fresnel_exact;
use crate::vector::{Vec3, add, dot, normalize, scale};

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

/// Smith's Λ for GGX facets of widths `alpha` along x and y.
fn lambda(alpha: [f64; 2], w: Vec3) -> f64 {
    0.5 * ((1.0 + stretched_tangent2(alpha, w)).sqrt() - 1.0)
}

/// Smith's Λ for Beckmann's facets (Walter et al. 2007, equation (26) without their approximation; Heitz 2014, equation (72)).
fn beckmann_lambda(alpha: [f64; 2], w: Vec3) -> f64 {
    let a = 1.0 / stretched_tangent2(alpha, w).sqrt();
    if a > 20.0 {
        return 0.0;
    }
    0.5 * ((-a * a).exp() / (a * PI.sqrt()) - statrs::function::erf::erfc(a))
}

/// The squared tangent of the angle of `w` to the normal, each axis stretched by its width.
fn stretched_tangent2(alpha: [f64; 2], w: Vec3) -> f64 {
    ((alpha[0] * w[0]).powi(2) + (alpha[1] * w[1]).powi(2)) / (w[2] * w[2])
}

/// Steps in slope and in azimuth of the rule for [`ggx_albedo`].
const STEPS: usize = 640;

/// Shares of light from the cosine `mu` that GGX facets of width `alpha` reflect and refract, for the relative index `eta`;
/// `None` stands for facets that reflect everything. To about 1e-5, by midpoints: total reflection and the horizon leave kinks, for which no
/// rule of a higher order gains.
#[must_use]
pub fn ggx_albedo(alpha: f64, mu: f64, eta: Option<f64>, masking: Masking) -> SingleScattering {
    // In its own plane of incidence a direction sees both halves of all azimuths alike.
    let (widths, o) = ([alpha; 2], [(1.0 - mu * mu).sqrt(), 0.0, mu]);
    albedo(&|w| lambda(widths, w), o, facets(widths, PI, ggx_slope2), (eta, shares_of(eta)), masking)
}

/// The same of coated facets, which reflect and transmit the shares that a function of the cosine says; without `eta` they only reflect.
#[must_use]
pub fn coated_ggx_albedo(alpha: f64, mu: f64, eta: Option<f64>, shares: impl Fn(f64) -> [f64; 2]) -> SingleScattering {
    let (widths, o) = ([alpha; 2], [(1.0 - mu * mu).sqrt(), 0.0, mu]);
    albedo(&|w| lambda(widths, w), o, facets(widths, PI, ggx_slope2), (eta, shares), Masking::Correlated)
}

/// What bare facets reflect and transmit.
fn shares_of(eta: Option<f64>) -> impl Fn(f64) -> [f64; 2] {
    move |cos| match eta {
        None => [1.0, 0.0],
        Some(eta) => {
            let fresnel = fresnel_exact(cos, eta);
            [fresnel.reflectance(), fresnel.transmittance()]
        }
    }
}

/// The same for facets of widths `alpha` along x and y, and light from the direction `o`.
#[must_use]
pub fn anisotropic_ggx_albedo(alpha: [f64; 2], o: Vec3, eta: Option<f64>, masking: Masking) -> SingleScattering {
    albedo(&|w| lambda(alpha, w), o, facets(alpha, 2.0 * PI, ggx_slope2), (eta, shares_of(eta)), masking)
}

/// The same for Beckmann's facets.
#[must_use]
pub fn beckmann_albedo(alpha: [f64; 2], o: Vec3, eta: Option<f64>, masking: Masking) -> SingleScattering {
    albedo(&|w| beckmann_lambda(alpha, w), o, facets(alpha, 2.0 * PI, beckmann_slope2), (eta, shares_of(eta)), masking)
}

/// The BRDF of GGX facets of widths `alpha` along x and y that reflect everything: D G/(4 cos θ_o cos θ_i) with Smith's masking, correlated
/// in height (Heitz 2014, equations (85) and (99)), in sr⁻¹, for directions on the side of +z.
#[must_use]
pub fn anisotropic_ggx_mirrors(alpha: [f64; 2], o: Vec3, i: Vec3) -> f64 {
    let h = normalize(add(o, i));
    let slope2 = (h[0] / alpha[0]).powi(2) + (h[1] / alpha[1]).powi(2);
    let density = 1.0 / (PI * alpha[0] * alpha[1] * h[2].powi(4) * (1.0 + slope2 / (h[2] * h[2])).powi(2));
    density / (1.0 + lambda(alpha, o) + lambda(alpha, i)) / (4.0 * o[2] * i[2])
}

/// The same of Beckmann's facets, of either masking: D = e^(−x²/α_x² − y²/α_y²)/(π α_x α_y cos⁴θ_h) of the slopes x and y.
#[must_use]
pub fn beckmann_mirrors(alpha: [f64; 2], o: Vec3, i: Vec3, masking: Masking) -> f64 {
    let h = normalize(add(o, i));
    let slope2 = ((h[0] / alpha[0]).powi(2) + (h[1] / alpha[1]).powi(2)) / (h[2] * h[2]);
    let density = (-slope2).exp() / (PI * alpha[0] * alpha[1] * h[2].powi(4));
    let (of_o, of_i) = (beckmann_lambda(alpha, o), beckmann_lambda(alpha, i));
    let hidden = match masking {
        Masking::Correlated => 1.0 + of_o + of_i,
        Masking::Separable => (1.0 + of_o) * (1.0 + of_i),
    };
    density / hidden / (4.0 * o[2] * i[2])
}

fn albedo(
    lambda: &dyn Fn(Vec3) -> f64,
    o: Vec3,
    facets: impl Iterator<Item = (Vec3, f64)>,
    (eta, shares): (Option<f64>, impl Fn(f64) -> [f64; 2]),
    masking: Masking,
) -> SingleScattering {
    let mu = o[2];
    let lambda_o = lambda(o);
    let together = |w: Vec3, reflection: bool| {
        let other = lambda(w);
        match masking {
            Masking::Correlated if reflection => 1.0 / (1.0 + lambda_o + other),
            Masking::Correlated | Masking::Separable => 1.0 / ((1.0 + lambda_o) * (1.0 + other)),
        }
    };
    let mut sum = SingleScattering { reflected: 0.0, refracted: 0.0 };
    for (h, weight) in facets {
        let c = dot(o, h);
        if c <= 0.0 {
            continue;
        }
        let seen = weight * c / (mu * h[2]);
        let [reflected, refracted] = shares(c.min(1.0));
        let r = add(scale(2.0 * c, h), scale(-1.0, o));
        if r[2] > 0.0 {
            sum.reflected += seen * reflected * together(r, true);
        }
        let Some(eta) = eta else { continue };
        let square = 1.0 - (1.0 - c * c) / (eta * eta);
        if square > 0.0 {
            let t = add(scale(-1.0 / eta, o), scale(c / eta - square.sqrt(), h));
            if t[2] < 0.0 {
                sum.refracted += seen * refracted * together(t, false);
            }
        }
    }
    sum
}

/// Normals of facets of the azimuths up to `turn` with the share of the surface, projected, that each stands for; together 1.
///
/// Slopes are those of width 1, stretched by the widths: `slope2` spreads D cos θ dω evenly over x in [0, 1] and the azimuth, and x = 1 − y⁴
/// spreads the steepest facets out, which grazing light sees as 1/√(1 − x) of GGX.
fn facets(alpha: [f64; 2], turn: f64, slope2: fn(f64) -> f64) -> impl Iterator<Item = (Vec3, f64)> {
    let step = |i: usize| (i as f64 + 0.5) / STEPS as f64;
    (0..STEPS * STEPS).map(move |i| {
        let (y, phi) = (step(i % STEPS), step(i / STEPS) * turn);
        let tan = slope2(y.powi(4)).sqrt();
        let slope = [alpha[0] * tan * phi.cos(), alpha[1] * tan * phi.sin()];
        (normalize([slope[0], slope[1], 1.0]), 4.0 * y.powi(3) / (STEPS * STEPS) as f64)
    })
}

/// The squared slope that the share `rest` of GGX's facets of width 1 exceeds: 1/(1 + tan²θ).
fn ggx_slope2(rest: f64) -> f64 {
    (1.0 - rest) / rest
}

/// The same of Beckmann's facets, e^(−tan²θ).
fn beckmann_slope2(rest: f64) -> f64 {
    -rest.ln()
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
                let whole: f64 =
                    facets([alpha; 2], PI, ggx_slope2).map(|(h, weight)| weight * dot(o, h).max(0.0) / h[2]).sum();
                let whole = whole / (mu * (1.0 + lambda([alpha; 2], o)));
                assert!((whole - 1.0).abs() < 2e-5, "α {alpha} µ {mu}: {whole}");
            }
        }
    }

    /// Of two widths as of one; and a surface turned by a quarter has its widths exchanged.
    #[test]
    fn facets_of_two_widths_fill_what_sees_them() {
        for (alpha, mu, phi) in [([0.05, 0.5], 0.3, 0.4_f64), ([1.0, 0.2], 0.05, 1.3), ([0.1, 0.9], 0.9, 2.0)] {
            let s = (1.0_f64 - mu * mu).sqrt();
            let o = [s * phi.cos(), s * phi.sin(), mu];
            let whole: f64 =
                facets(alpha, 2.0 * PI, ggx_slope2).map(|(h, weight)| weight * dot(o, h).max(0.0) / h[2]).sum();
            let whole = whole / (mu * (1.0 + lambda(alpha, o)));
            assert!((whole - 1.0).abs() < 5e-5, "α {alpha:?} µ {mu}: {whole}");
            let [a, b] = [(alpha, o), ([alpha[1], alpha[0]], [-o[1], o[0], o[2]])]
                .map(|(alpha, o)| anisotropic_ggx_albedo(alpha, o, None, Masking::Correlated).reflected);
            assert!((a - b).abs() < 2e-5, "α {alpha:?} µ {mu}: {a} {b}");
        }
        let (one, two) = (
            ggx_albedo(0.3, 0.4, Some(1.5), Masking::Correlated),
            anisotropic_ggx_albedo([0.3; 2], [0.0, -(1.0_f64 - 0.16).sqrt(), 0.4], Some(1.5), Masking::Correlated),
        );
        assert!((one.reflected - two.reflected).abs() < 1e-5 && (one.refracted - two.refracted).abs() < 1e-5);
    }

    /// The albedo once more, from the BRDF itself over directions of light.
    #[test]
    fn the_brdf_of_two_widths_has_the_albedo_of_its_facets() {
        let alpha = [0.3, 0.7];
        for (mu, phi) in [(0.8, 0.3_f64), (0.4, 1.2)] {
            let s = (1.0_f64 - mu * mu).sqrt();
            let o = [s * phi.cos(), s * phi.sin(), mu];
            let steps = 1000;
            let place = |k: usize| (k as f64 + 0.5) / steps as f64;
            let of = |k: usize| {
                let (z, turn) = (place(k % steps), 2.0 * PI * place(k / steps));
                let s = (1.0 - z * z).sqrt();
                anisotropic_ggx_mirrors(alpha, o, [s * turn.cos(), s * turn.sin(), z]) * z
            };
            let sum = (0..steps * steps).map(of).sum::<f64>() * 2.0 * PI / (steps * steps) as f64;
            let albedo = anisotropic_ggx_albedo(alpha, o, None, Masking::Correlated).reflected;
            assert!((sum - albedo).abs() < 1e-4, "{mu} {phi}: {sum} {albedo}");
        }
    }

    /// What a direction sees of all of Beckmann's facets is itself, and their BRDF over directions of light has the albedo of the facets.
    #[test]
    fn beckmann_s_facets_fill_what_sees_them_and_reflect_what_they_are_seen_to() {
        for (alpha, mu, phi) in [([0.3, 0.3], 0.7, 0.0_f64), ([0.3, 0.7], 0.4, 1.2), ([0.9, 0.2], 0.1, 0.5)] {
            let s = (1.0_f64 - mu * mu).sqrt();
            let o = [s * phi.cos(), s * phi.sin(), mu];
            let seen = |(h, weight): (Vec3, f64)| weight * dot(o, h).max(0.0) / h[2];
            let whole: f64 = facets(alpha, 2.0 * PI, beckmann_slope2).map(seen).sum();
            let whole = whole / (mu * (1.0 + beckmann_lambda(alpha, o)));
            assert!((whole - 1.0).abs() < 5e-5, "α {alpha:?} µ {mu}: {whole}");
            let steps = 1000;
            let place = |k: usize| (k as f64 + 0.5) / steps as f64;
            for masking in [Masking::Correlated, Masking::Separable] {
                let of = |k: usize| {
                    let (z, turn) = (place(k % steps), 2.0 * PI * place(k / steps));
                    let s = (1.0 - z * z).sqrt();
                    beckmann_mirrors(alpha, o, [s * turn.cos(), s * turn.sin(), z], masking) * z
                };
                let sum = (0..steps * steps).map(of).sum::<f64>() * 2.0 * PI / (steps * steps) as f64;
                let albedo = beckmann_albedo(alpha, o, None, masking).reflected;
                assert!((sum - albedo).abs() < 1e-4, "{mu} {phi} {masking:?}: {sum} {albedo}");
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
