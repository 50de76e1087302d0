//! Rough glass, and what goes wrong in it.

use std::f64::consts::PI;

use etalon_oracle::{
    laws::{self, fresnel_exact},
    subjects::{Density, Scattered, Scatters},
};

use crate::bsdf::{accepted, rejected};
use crate::vector::{Vec3, dot, plus, times, unit};

/// GGX facets of glass, index `n` below and 1 above: reflection and refraction at each facet by Fresnel's equations, shadowing of
/// both directions each by itself, facets drawn from D·cos (Walter et al. 2007). Light that a facet sends into another is lost.
struct RoughGlass {
    n: f64,
    alpha: f64,
    fault: &'static str,
}

impl RoughGlass {
    /// Index on the side of a direction.
    fn side(&self, w: Vec3) -> f64 {
        self.index(w[2] > 0.0, 550.0)
    }

    /// D of a facet on either side.
    fn d(&self, h: Vec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        let t = h[2] * h[2] * (a2 - 1.0) + 1.0;
        a2 / (PI * t * t)
    }

    fn g1(&self, w: Vec3) -> f64 {
        let tan2 = (1.0 - w[2] * w[2]).max(0.0) / (w[2] * w[2]);
        2.0 / (1.0 + (1.0 + self.alpha * self.alpha * tan2).sqrt())
    }

    fn g(&self, wo: Vec3, wi: Vec3) -> f64 {
        match self.fault {
            "shadowing of wo only" => self.g1(wo),
            _ => self.g1(wo) * self.g1(wi),
        }
    }

    /// What a facet reflects, and where it refracts to.
    fn facet(&self, wo: Vec3, h: Vec3) -> (f64, Option<Vec3>) {
        let eta = if (wo[2] > 0.0) != (self.fault == "eta upside down") { self.n } else { 1.0 / self.n };
        let cos = dot(wo, h).min(1.0);
        let cos2_t = 1.0 - (1.0 - cos * cos) / (eta * eta);
        if cos2_t <= 0.0 {
            return (1.0, None);
        }
        let cos_f = if self.fault == "Fresnel at the surface's normal" { wo[2].abs() } else { cos };
        let total = eta < 1.0 && 1.0 - cos_f * cos_f >= eta * eta;
        let reflectance = match self.fault {
            "Schlick" => {
                let r0 = ((self.n - 1.0) / (self.n + 1.0)).powi(2);
                r0 + (1.0 - r0) * (1.0 - cos).powi(5)
            }
            _ if total => 1.0,
            _ => fresnel_exact(cos_f, eta).reflectance(),
        };
        (reflectance, Some(unit(plus(times(cos / eta - cos2_t.sqrt(), h), -1.0 / eta, wo))))
    }

    /// The facet that turns `wo` into `wi`, on the side of `wo`.
    fn half(&self, wo: Vec3, wi: Vec3) -> Option<Vec3> {
        let h = if wo[2] * wi[2] > 0.0 || self.fault == "half vector of reflection" {
            unit(plus(wo, 1.0, wi))
        } else {
            unit(plus(times(self.side(wo), wo), self.side(wi), wi))
        };
        let h = if h[2] * wo[2] < 0.0 { times(-1.0, h) } else { h };
        let right = dot(wo, h) > 0.0 && dot(wi, h) * wo[2] * wi[2] > 0.0;
        right.then_some(h)
    }

    /// Share of the light that a facet sends from one direction to the other, from its cosine with `wo` alone, as one writes it.
    fn share(&self, wo: Vec3, wi: Vec3, h: Vec3) -> f64 {
        let reflectance = self.facet(wo, h).0;
        if wo[2] * wi[2] > 0.0 { reflectance } else { 1.0 - reflectance }
    }

    /// dω of the facet over dω of `wi`.
    fn jacobian(&self, wo: Vec3, wi: Vec3, h: Vec3) -> f64 {
        if wo[2] * wi[2] > 0.0 || self.fault == "Jacobian of reflection" {
            return 1.0 / (4.0 * dot(wo, h));
        }
        let (n_o, n_i) = (self.side(wo), self.side(wi));
        let sum = n_o * dot(wo, h) + n_i * dot(wi, h);
        dot(wi, h).abs() * n_i * n_i / (sum * sum)
    }
}

impl Scatters for RoughGlass {
    fn f(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        let Some(h) = self.half(wo, wi) else { return 0.0 };
        let seen = if self.fault == "cosines kept from zero" { wi[2].abs().max(0.02) } else { wi[2].abs() };
        let power = self.share(wo, wi, h) * self.d(h) * self.g(wo, wi) * dot(wo, h) * self.jacobian(wo, wi, h)
            / (wo[2].abs() * seen);
        let ratio = match self.fault {
            "no n squared" => 1.0,
            "n squared the wrong way" => self.side(wi) / self.side(wo),
            _ => self.side(wo) / self.side(wi),
        };
        let slip = if self.fault == "a billionth more one way" { 1.0 + 1e-9 * wo[2].abs() } else { 1.0 };
        slip * power * ratio * ratio
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        let Some(h) = self.half(wo, wi) else { return 0.0 };
        let share = if self.fault == "density without the choice" { 1.0 } else { self.share(wo, wi, h) };
        share * self.d(h) * h[2].abs() * self.jacobian(wo, wi, h)
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let alpha = if self.fault == "facets drawn rougher than they are" { 1.05 * self.alpha } else { self.alpha };
        let cos2 = (1.0 - u[0]) / (1.0 + (alpha * alpha - 1.0) * u[0]);
        let (cosine, sine) = (cos2.sqrt(), (1.0 - cos2).max(0.0).sqrt());
        let phi = 2.0 * PI * u[1];
        let h = [sine * phi.cos(), sine * phi.sin(), cosine.copysign(wo[2])];
        if dot(wo, h) <= 0.0 {
            return None;
        }
        let (reflectance, refracted) = self.facet(wo, h);
        let reflects = u[2] < if self.fault == "reflected by a fair coin" { 0.5 } else { reflectance };
        let wi = if reflects { plus(times(2.0 * dot(wo, h), h), -1.0, wo) } else { refracted? };
        if reflects != (wo[2] * wi[2] > 0.0) {
            return None;
        }
        let density = self.pdf(wo, wi, wavelength_nm);
        let weight = self.f(wo, wi, wavelength_nm) * wi[2].abs() / density;
        Some(Scattered { wi, weight, density: Density::SolidAngle(density) })
    }

    fn index(&self, above: bool, _: f64) -> f64 {
        if above { 1.0 } else { self.n }
    }
}

#[test]
fn right_rough_glass_is_accepted() {
    accepted(&RoughGlass { n: 1.5, alpha: 0.5, fault: "" }, 1);
    accepted(&RoughGlass { n: 1.33, alpha: 0.3, fault: "" }, 2);
}

#[test]
fn wrong_rough_glass_is_rejected() {
    for fault in [
        "shadowing of wo only",
        "eta upside down",
        "Fresnel at the surface's normal",
        "half vector of reflection",
        "Jacobian of reflection",
        "no n squared",
        "n squared the wrong way",
        "density without the choice",
        "Schlick",
        "facets drawn rougher than they are",
        "reflected by a fair coin",
        "cosines kept from zero",
    ] {
        rejected(&RoughGlass { n: 1.5, alpha: 0.5, fault }, fault);
    }
}

/// What excuses rounding where f is steep excuses nothing else: an asymmetry of a billionth, and one at grazing angles alone.
#[test]
fn reciprocity_allows_for_rounding_and_for_nothing_else() {
    for seed in 1..9 {
        let reciprocal = |fault| laws::is_reciprocal(&RoughGlass { n: 1.5, alpha: 0.5, fault }, seed);
        reciprocal("").assert();
        for fault in ["a billionth more one way", "cosines kept from zero", "shadowing of wo only", "no n squared"] {
            let verdict = reciprocal(fault);
            assert!(!verdict.pass, "\"{fault}\" survived: {verdict}");
        }
    }
}

#[test]
#[ignore = "a hundred whole suites take minutes; run by hand when laws change"]
fn right_rough_glass_raises_no_false_alarm_in_a_hundred_seeds() {
    for seed in 1000..1100 {
        accepted(&RoughGlass { n: 1.5, alpha: 0.5, fault: "" }, seed);
    }
}
