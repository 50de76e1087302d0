//! BSDFs: Lambert, mirror, dielectric, rough metal, and what goes wrong in them.

use std::f64::consts::PI;

use etalon_oracle::{
    laws,
    subjects::{DeltaLobe, Density, Scattered, Scatters},
    suite,
};

use crate::vector::{Vec3, dot, plus, times, unit};

fn on_disk(u: f64, v: f64) -> (f64, f64) {
    let (r, phi) = (u.sqrt(), 2.0 * PI * v);
    (r * phi.cos(), r * phi.sin())
}

/// Ideal diffuse reflection on both sides.
pub(crate) struct Lambert {
    pub albedo: f64,
    pub fault: &'static str,
}

impl Scatters for Lambert {
    fn f(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] * wi[2] <= 0.0 && self.fault != "leaks through" {
            return 0.0;
        }
        match self.fault {
            "no division by pi" => self.albedo,
            "half pi" => self.albedo * 2.0 / PI,
            "depends on wo" => self.albedo / PI * (1.0 + 0.1 * wo[2].abs()),
            // Reciprocal, and of the same albedo.
            "prefers an azimuth" => self.albedo / PI * (1.0 + 0.1 * (wo[0] * wi[0] - wo[1] * wi[1])),
            _ => self.albedo / PI,
        }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] * wi[2] <= 0.0 {
            return 0.0;
        }
        match self.fault {
            "pdf of the uniform hemisphere" | "weight with the wrong pdf" => 1.0 / (2.0 * PI),
            "pdf without pi" => wi[2].abs(),
            "pdf of wo" => wo[2].abs() / PI,
            "pdf at 1 % too much" => 1.01 * wi[2].abs() / PI,
            _ => wi[2].abs() / PI,
        }
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        if self.fault == "absorbs without saying" && u[2] < 0.01 {
            return None;
        }
        let (x, y) = on_disk(u[0], u[1]);
        let (x, y) = if self.fault == "radius without the root" { (x * u[0].sqrt(), y * u[0].sqrt()) } else { (x, y) };
        let z = (1.0 - x * x - y * y).max(1e-12).sqrt();
        let wi = [x, y, if wo[2] < 0.0 && self.fault != "always upward" { -z } else { z }];
        let density = self.pdf(wo, wi, wavelength_nm);
        let weight = match self.fault {
            "cosine dropped" => self.f(wo, wi, wavelength_nm) / density,
            "weight with the wrong pdf" => self.albedo,
            "cosine twice" => self.albedo * z,
            _ => self.f(wo, wi, wavelength_nm) * z / density,
        };
        Some(Scattered { wi, weight, density: Density::SolidAngle(density) })
    }
}

/// Smooth interface, index `n` below and 1 above.
pub(crate) struct Dielectric {
    pub n: f64,
    pub fault: &'static str,
}

impl Dielectric {
    /// R, the cosine of refraction and n_transmitted/n_incident.
    fn split(&self, wo: Vec3) -> (f64, f64, f64) {
        let eta = if (wo[2] > 0.0) != (self.fault == "eta upside down") { self.n } else { 1.0 / self.n };
        let c = wo[2].abs();
        let square = 1.0 - (1.0 - c * c) / (eta * eta);
        if square <= 0.0 {
            return (if self.fault == "total reflection loses light" { 0.9 } else { 1.0 }, 0.0, eta);
        }
        let ct = square.sqrt();
        let r_s = (c - eta * ct) / (c + eta * ct);
        let r_p = (eta * c - ct) / (eta * c + ct);
        let r = match self.fault {
            "Schlick" => {
                let r0 = ((self.n - 1.0) / (self.n + 1.0)).powi(2);
                r0 + (1.0 - r0) * (1.0 - c).powi(5)
            }
            _ => 0.5 * (r_s * r_s + r_p * r_p),
        };
        (r, ct, eta)
    }
}

impl Scatters for Dielectric {
    fn f(&self, _: Vec3, _: Vec3, _: f64) -> f64 {
        0.0
    }

    fn pdf(&self, _: Vec3, _: Vec3, _: f64) -> f64 {
        0.0
    }

    fn deltas(&self, wo: Vec3, _: f64) -> Vec<DeltaLobe> {
        let (r, ct, eta) = self.split(wo);
        let mut lobes = vec![DeltaLobe { wi: [-wo[0], -wo[1], wo[2]], weight: r, probability: r }];
        if r < 1.0 && ct > 0.0 {
            let bend = if self.fault == "not bent" { 1.0 } else { 1.0 / eta };
            let depth = if self.fault == "not bent" { wo[2].abs() } else { ct };
            let wi = [-wo[0] * bend, -wo[1] * bend, -depth * wo[2].signum()];
            let scaled = match self.fault {
                "no n squared" => 1.0,
                "n squared the wrong way" => eta * eta,
                _ => 1.0 / (eta * eta),
            };
            let t = if self.fault == "transmits all" { 1.0 } else { 1.0 - r };
            lobes.push(DeltaLobe { wi, weight: t * scaled, probability: 1.0 - r });
        }
        lobes
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let lobes = self.deltas(wo, wavelength_nm);
        let chosen = match self.fault {
            "lobes by a fair coin, weighed as by R" => usize::from(lobes.len() > 1 && u[0] < 0.5),
            _ => usize::from(lobes.len() > 1 && u[0] >= lobes[0].probability),
        };
        let lobe = lobes[chosen];
        let weight = match self.fault {
            "weight not divided by the probability" => lobe.weight,
            _ => lobe.weight / lobe.probability,
        };
        Some(Scattered { wi: lobe.wi, weight, density: Density::Delta(lobe.probability) })
    }

    fn index(&self, above: bool, _: f64) -> f64 {
        if above { 1.0 } else { self.n }
    }
}

/// Isotropic GGX reflection, R = 1, Smith's height-correlated shadowing, normals drawn from D·cos (Walter et al. 2007).
pub(crate) struct Rough {
    pub alpha: f64,
    pub fault: &'static str,
}

impl Rough {
    fn d(&self, h: Vec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        let t = h[2] * h[2] * (a2 - 1.0) + 1.0;
        a2 / (PI * t * t)
    }

    fn lambda(&self, w: Vec3) -> f64 {
        let tan2 = (1.0 - w[2] * w[2]).max(0.0) / (w[2] * w[2]);
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }
}

impl Scatters for Rough {
    fn f(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] <= 0.0 || wi[2] <= 0.0 {
            return 0.0;
        }
        let h = unit(plus(wo, 1.0, wi));
        let g = match self.fault {
            "no shadowing" => 1.0,
            "shadowing of wo only" => 1.0 / (1.0 + self.lambda(wo)),
            _ => 1.0 / (1.0 + self.lambda(wo) + self.lambda(wi)),
        };
        self.d(h) * g / (4.0 * wo[2] * wi[2])
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] <= 0.0 || wi[2] <= 0.0 {
            return 0.0;
        }
        let h = unit(plus(wo, 1.0, wi));
        match self.fault {
            "no Jacobian of the half vector" => self.d(h) * h[2],
            "density of h without its cosine" => self.d(h) / (4.0 * dot(wo, h)),
            _ => self.d(h) * h[2] / (4.0 * dot(wo, h)),
        }
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let cos2 = (1.0 - u[0]) / (1.0 + (self.alpha * self.alpha - 1.0) * u[0]);
        let (cosine, sine) = (cos2.sqrt(), (1.0 - cos2).max(0.0).sqrt());
        let phi = 2.0 * PI * u[1];
        let h = [sine * phi.cos(), sine * phi.sin(), cosine];
        let wi = plus(times(2.0 * dot(wo, h), h), -1.0, wo);
        if wo[2] <= 0.0 || wi[2] <= 0.0 {
            return None;
        }
        let density = self.pdf(wo, wi, wavelength_nm);
        let weight = self.f(wo, wi, wavelength_nm) * wi[2] / density;
        Some(Scattered { wi, weight, density: Density::SolidAngle(density) })
    }

    fn two_sided(&self) -> bool {
        false
    }
}

pub(crate) fn accepted(subject: &dyn Scatters, seed: u64) {
    for verdict in suite::scatters(subject, seed) {
        verdict.assert();
    }
}

pub(crate) fn rejected(subject: &dyn Scatters, fault: &str) {
    let broken = suite::scatters_law_by_law(subject, 1).any(|verdict| !verdict.pass);
    assert!(broken, "the mutant \"{fault}\" survived");
}

#[test]
fn right_bsdfs_are_accepted() {
    accepted(&Lambert { albedo: 0.7, fault: "" }, 1);
    accepted(&Lambert { albedo: 1.0, fault: "" }, 2);
    accepted(&Dielectric { n: 1.5, fault: "" }, 3);
    accepted(&Dielectric { n: 1.0001, fault: "" }, 4);
    accepted(&Rough { alpha: 0.5, fault: "" }, 5);
    accepted(&Rough { alpha: 0.1, fault: "" }, 6);
}

#[test]
fn wrong_lamberts_are_rejected() {
    for fault in [
        "leaks through",
        "no division by pi",
        "half pi",
        "depends on wo",
        "pdf of the uniform hemisphere",
        "weight with the wrong pdf",
        "pdf without pi",
        "pdf of wo",
        "pdf at 1 % too much",
        "absorbs without saying",
        "radius without the root",
        "always upward",
        "cosine dropped",
        "cosine twice",
    ] {
        rejected(&Lambert { albedo: 1.0, fault }, fault);
    }
}

#[test]
fn what_prefers_an_azimuth_has_a_grain() {
    let isotropic = |fault| laws::is_isotropic(&Lambert { albedo: 0.7, fault }, 1);
    isotropic("").assert();
    assert!(!isotropic("prefers an azimuth").pass);
    laws::is_isotropic(&Rough { alpha: 0.1, fault: "" }, 2).assert();
}

#[test]
fn wrong_dielectrics_are_rejected() {
    for fault in [
        "eta upside down",
        "total reflection loses light",
        "Schlick",
        "not bent",
        "no n squared",
        "n squared the wrong way",
        "transmits all",
        "lobes by a fair coin, weighed as by R",
        "weight not divided by the probability",
    ] {
        rejected(&Dielectric { n: 1.5, fault }, fault);
    }
}

#[test]
fn wrong_rough_metals_are_rejected() {
    for fault in
        ["no shadowing", "shadowing of wo only", "no Jacobian of the half vector", "density of h without its cosine"]
    {
        rejected(&Rough { alpha: 0.5, fault }, fault);
    }
}

#[test]
#[ignore = "a hundred whole suites take minutes; run by hand when laws change"]
fn right_bsdfs_raise_no_false_alarm_in_a_hundred_seeds() {
    for seed in 1000..1100 {
        accepted(&Lambert { albedo: 0.7, fault: "" }, seed);
        accepted(&Dielectric { n: 1.5, fault: "" }, seed);
        accepted(&Rough { alpha: 0.5, fault: "" }, seed);
    }
}
