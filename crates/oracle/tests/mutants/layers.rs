//! Panes and plastic, and what goes wrong in them.

use std::f64::consts::PI;

use etalon_oracle::{
    laws::fresnel_exact,
    subjects::{DeltaLobe, Density, Scattered, Scatters},
    truths::walsh_reflectance,
};

use crate::bsdf::{accepted, rejected};
use crate::vector::{Vec3, times, unit};

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

#[test]
fn right_layers_are_accepted_and_wrong_ones_rejected() {
    accepted(&Pane { fault: "" }, 1);
    accepted(&Plastic { fault: "" }, 2);
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
}
