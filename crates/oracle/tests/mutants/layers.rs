//! Panes, plastic and rough glass, and what goes wrong in them.

use std::f64::consts::PI;

use etalon_oracle::{
    laws::fresnel_exact,
    subjects::{DeltaLobe, Density, Scattered, Scatters},
    truths::walsh_reflectance,
};

use crate::bsdf::{accepted, rejected};
use crate::vector::{Vec3, dot, plus, times, unit};

fn reflectance(cosine: f64, eta: f64) -> f64 {
    if eta < 1.0 && cosine * cosine <= 1.0 - eta * eta {
        1.0
    } else {
        fresnel_exact(cosine.min(1.0), eta).reflectance()
    }
}

fn below(v: Vec3) -> Vec3 {
    times(-1.0, v)
}

/// A thin pane: 2R/(1 + R) comes back and the rest goes straight on.
struct Pane {
    fault: &'static str,
}

impl Scatters for Pane {
    fn f(&self, _: Vec3, _: Vec3, _: f64) -> f64 {
        0.0
    }

    fn pdf(&self, _: Vec3, _: Vec3, _: f64) -> f64 {
        0.0
    }

    fn deltas(&self, wo: Vec3, _: f64) -> Vec<DeltaLobe> {
        let face = reflectance(wo[2].abs(), 1.5);
        let r = 2.0 * face / (1.0 + face);
        let t = if self.fault == "one face alone transmits" { 1.0 - face } else { 1.0 - r };
        let through = match self.fault {
            "passed light stays bent" => unit([-wo[0] / 1.5, -wo[1] / 1.5, -wo[2]]),
            _ => below(wo),
        };
        vec![
            DeltaLobe { wi: [-wo[0], -wo[1], wo[2]], weight: r, probability: r },
            DeltaLobe { wi: through, weight: t, probability: 1.0 - r },
        ]
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let lobes = self.deltas(wo, wavelength_nm);
        let first = match self.fault {
            "chosen by one face, weighed as by both" => reflectance(wo[2].abs(), 1.5),
            _ => lobes[0].probability,
        };
        let lobe = lobes[usize::from(u[0] >= first)];
        Some(Scattered {
            wi: lobe.wi,
            weight: lobe.weight / lobe.probability,
            density: Density::Delta(lobe.probability),
        })
    }
}

/// A diffuse ground of albedo ρ under a smooth coat of index 1.5.
struct Plastic {
    fault: &'static str,
}

const COAT: f64 = 1.5;
const GROUND: f64 = 0.9;

impl Plastic {
    /// Share of the coat in the choice of lobe.
    fn share(wo: Vec3) -> f64 {
        let coat = reflectance(wo[2].abs(), COAT);
        coat / (coat + (1.0 - coat) * GROUND)
    }
}

impl Scatters for Plastic {
    fn f(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] * wi[2] <= 0.0 {
            return 0.0;
        }
        let passed = |w: Vec3| 1.0 - reflectance(w[2].abs(), COAT);
        let n2 = if self.fault == "the cone inside taken for a hemisphere" { 1.0 } else { COAT * COAT };
        // What leaves the ground and comes back to it, by étendue.
        let inside = 1.0 - (1.0 - walsh_reflectance(COAT)) / (COAT * COAT);
        let twice = if self.fault == "the coat passed once" { passed(wo) } else { passed(wo) * passed(wi) };
        twice * GROUND / (PI * n2 * (1.0 - GROUND * inside))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] * wi[2] <= 0.0 {
            return 0.0;
        }
        let ground = if self.fault == "lobes not shared out" { 1.0 } else { 1.0 - Self::share(wo) };
        ground * wi[2].abs() / PI
    }

    fn deltas(&self, wo: Vec3, _: f64) -> Vec<DeltaLobe> {
        let weight = reflectance(wo[2].abs(), COAT);
        vec![DeltaLobe { wi: [-wo[0], -wo[1], wo[2]], weight, probability: Self::share(wo) }]
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let coat = self.deltas(wo, wavelength_nm)[0];
        if u[2] < coat.probability {
            let weight = if self.fault == "the coat's weight not divided" {
                coat.weight
            } else {
                coat.weight / coat.probability
            };
            return Some(Scattered { wi: coat.wi, weight, density: Density::Delta(coat.probability) });
        }
        let (r, phi) = (u[0].sqrt(), 2.0 * PI * u[1]);
        let wi = [r * phi.cos(), r * phi.sin(), (1.0 - u[0]).sqrt().copysign(wo[2])];
        let density = self.pdf(wo, wi, wavelength_nm);
        let weight = self.f(wo, wi, wavelength_nm) * wi[2].abs() / density;
        Some(Scattered { wi, weight, density: Density::SolidAngle(density) })
    }
}

/// Rough interface to an index of 1.5 below: GGX facets, G₁G₁, normals drawn from D·cos (Walter et al. 2007).
struct RoughGlass {
    fault: &'static str,
}

const INSIDE: f64 = 1.5;
const ALPHA: f64 = 0.4;

/// A pair of directions on an interface: their facet, (n_o wo·h + n_i wi·h)², the indices and Fresnel's R.
struct Facet {
    h: Vec3,
    square: f64,
    n_o: f64,
    n_i: f64,
    crosses: bool,
    r: f64,
}

impl RoughGlass {
    fn facet(&self, wo: Vec3, wi: Vec3) -> Option<Facet> {
        let crosses = wo[2] * wi[2] < 0.0;
        let (n_o, far) = if wo[2] > 0.0 { (1.0, INSIDE) } else { (INSIDE, 1.0) };
        let n_i = if crosses { far } else { n_o };
        let sum = match self.fault {
            "half vector without the indices" => plus(wo, 1.0, wi),
            _ => plus(times(n_o, wo), n_i, wi),
        };
        let square = dot(sum, sum);
        if wo[2] == 0.0 || wi[2] == 0.0 || square == 0.0 {
            return None;
        }
        // On the side of `wo`.
        let h = times(1.0 / square.sqrt(), sum);
        let h = if h[2] * wo[2] < 0.0 { below(h) } else { h };
        let seen = dot(wo, h) > 0.0 && (dot(wi, h) > 0.0) != crosses;
        let r = match self.fault {
            "Fresnel by the mean normal" => reflectance(wo[2].abs(), far / n_o),
            // From above, where no critical angle magnifies roundings.
            _ if crosses => reflectance(dot(if wo[2] > 0.0 { wo } else { wi }, h).abs(), INSIDE),
            _ => reflectance(dot(wo, h), far / n_o),
        };
        seen.then_some(Facet { h, square, n_o, n_i, crosses, r })
    }

    fn d(h: Vec3) -> f64 {
        let t = h[2] * h[2] * (ALPHA * ALPHA - 1.0) + 1.0;
        ALPHA * ALPHA / (PI * t * t)
    }

    fn g1(w: Vec3) -> f64 {
        let tan2 = (1.0 - w[2] * w[2]).max(0.0) / (w[2] * w[2]);
        2.0 / (1.0 + (1.0 + ALPHA * ALPHA * tan2).sqrt())
    }
}

impl Scatters for RoughGlass {
    fn f(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        let Some(Facet { h, square, n_o, n_i, crosses, r }) = self.facet(wo, wi) else { return 0.0 };
        let common = Self::d(h) * Self::g1(wo) * Self::g1(wi) / (wo[2] * wi[2]).abs();
        if !crosses {
            return r * common / 4.0;
        }
        let (o, i) = (dot(wo, h), dot(wi, h));
        let n2 = match self.fault {
            "no n squared" => 1.0,
            "n squared the wrong way" => n_i * n_i,
            _ => n_o * n_o,
        };
        (1.0 - r) * common * n2 * (o * i).abs() / square
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        let Some(Facet { h, square, n_i, crosses, r, .. }) = self.facet(wo, wi) else { return 0.0 };
        let (o, i) = (dot(wo, h), dot(wi, h));
        let facets = Self::d(h) * h[2].abs();
        if !crosses {
            r * facets / (4.0 * o)
        } else if self.fault == "the Jacobian of reflection" {
            (1.0 - r) * facets / (4.0 * o)
        } else {
            (1.0 - r) * facets * n_i * n_i * i.abs() / square
        }
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let cos2 = (1.0 - u[0]) / (1.0 + (ALPHA * ALPHA - 1.0) * u[0]);
        let (cosine, sine) = (cos2.sqrt(), (1.0 - cos2).max(0.0).sqrt());
        let phi = 2.0 * PI * u[1];
        let h = [sine * phi.cos(), sine * phi.sin(), cosine.copysign(wo[2])];
        let eta = if wo[2] > 0.0 { INSIDE } else { 1.0 / INSIDE };
        let c = dot(wo, h);
        if c <= 0.0 {
            return None;
        }
        let wi = if u[2] < reflectance(c, eta) {
            plus(times(2.0 * c, h), -1.0, wo)
        } else {
            let cos_t = (1.0 - (1.0 - c * c) / (eta * eta)).max(0.0).sqrt();
            unit(plus(times(c / eta - cos_t, h), -1.0 / eta, wo))
        };
        let reflected = u[2] < reflectance(c, eta);
        if (wi[2] * wo[2] > 0.0) != reflected {
            return None;
        }
        let density = self.pdf(wo, wi, wavelength_nm);
        let weight = self.f(wo, wi, wavelength_nm) * wi[2].abs() / density;
        (density > 0.0).then_some(Scattered { wi, weight, density: Density::SolidAngle(density) })
    }

    fn index(&self, above: bool, _: f64) -> f64 {
        if above { 1.0 } else { INSIDE }
    }
}

#[test]
fn right_layers_are_accepted_and_wrong_ones_rejected() {
    accepted(&Pane { fault: "" }, 1);
    accepted(&Plastic { fault: "" }, 2);
    accepted(&RoughGlass { fault: "" }, 3);
    for fault in ["one face alone transmits", "passed light stays bent", "chosen by one face, weighed as by both"] {
        rejected(&Pane { fault }, fault);
    }
    for fault in [
        "the cone inside taken for a hemisphere",
        "the coat passed once",
        "lobes not shared out",
        "the coat's weight not divided",
    ] {
        rejected(&Plastic { fault }, fault);
    }
    for fault in [
        "half vector without the indices",
        "Fresnel by the mean normal",
        "no n squared",
        "n squared the wrong way",
        "the Jacobian of reflection",
    ] {
        rejected(&RoughGlass { fault }, fault);
    }
}
