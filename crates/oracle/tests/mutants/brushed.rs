//! Brushed metal, whose GGX facets have two widths, and what goes wrong in it.

use std::f64::consts::PI;

use etalon_oracle::{
    laws::{Masking, anisotropic_ggx_albedo, anisotropic_ggx_mirrors},
    subjects::{Density, Scattered, Scatters},
};

use crate::bsdf::{accepted, rejected};
use crate::vector::{Vec3, dot, plus, times, unit};

const ALPHA: [f64; 2] = [0.2, 0.6];
/// Cosine and sine of the angle of the grain from x.
const GRAIN: [f64; 2] = [0.8, 0.6];

/// Facets that reflect everything; light that meets a second one is lost.
struct Brushed {
    fault: &'static str,
}

/// A direction in the frame of the grain, and back.
fn along_grain(v: Vec3, [cos, sin]: [f64; 2]) -> Vec3 {
    [cos * v[0] + sin * v[1], cos * v[1] - sin * v[0], v[2]]
}

fn exchanged([u, v]: [f64; 2]) -> [f64; 2] {
    [v, u]
}

impl Brushed {
    fn is(&self, fault: &str) -> bool {
        self.fault == fault
    }

    /// The grain as the value, the density or the drawing of directions takes it.
    fn grain(&self, forgets: &str) -> [f64; 2] {
        if self.is(forgets) { [1.0, 0.0] } else { GRAIN }
    }

    fn widths(&self, exchanges: &str) -> [f64; 2] {
        if self.is(exchanges) { exchanged(ALPHA) } else { ALPHA }
    }
}

impl Scatters for Brushed {
    fn f(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] <= 0.0 || wi[2] <= 0.0 {
            return 0.0;
        }
        let grain = self.grain("the value forgets the rotation");
        let (o, i) = (along_grain(wo, grain), along_grain(wi, grain));
        let f = anisotropic_ggx_mirrors(self.widths("the value has the widths exchanged"), o, i);
        let normalised = if self.is("density over α_u² instead of α_u α_v") { ALPHA[1] / ALPHA[0] } else { 1.0 };
        f * normalised
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: f64) -> f64 {
        if wo[2] <= 0.0 || wi[2] <= 0.0 {
            return 0.0;
        }
        let grain = self.grain("the density forgets the rotation");
        let (o, i) = (along_grain(wo, grain), along_grain(wi, grain));
        let alpha = self.widths("the density has the widths exchanged");
        let h = unit(plus(o, 1.0, i));
        let e = (h[0] / alpha[0]).powi(2) + (h[1] / alpha[1]).powi(2) + h[2] * h[2];
        let d = 1.0 / (PI * alpha[0] * alpha[1] * e * e);
        let stretch = ((alpha[0] * o[0]).powi(2) + (alpha[1] * o[1]).powi(2) + o[2] * o[2]).sqrt();
        // G₁ D (o·h)/cos θ_o, over the Jacobian of the reflection, 4 o·h.
        let visible = 2.0 * d * dot(o, h) / (o[2] + stretch);
        let jacobian = if self.is("the Jacobian of the reflection is 4") { 4.0 } else { 4.0 * dot(o, h) };
        visible / jacobian
    }

    fn sample(&self, wo: Vec3, u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        if wo[2] <= 0.0 {
            return None;
        }
        let grain = self.grain("directions are drawn without the rotation");
        let alpha = self.widths("directions are drawn with the widths exchanged");
        let o = along_grain(wo, grain);
        let image = unit([alpha[0] * o[0], alpha[1] * o[1], o[2]]);
        let (phi, z) = (2.0 * PI * u[0], (1.0 - u[1]) * (1.0 + image[2]) - image[2]);
        let s = (1.0 - z * z).max(0.0).sqrt();
        let cap = plus([s * phi.cos(), s * phi.sin(), z], 1.0, image);
        // Normals are stretched as the slopes are: by the widths, not against them.
        let h = match self.is("normals are stretched as places are") {
            true => unit([cap[0] / alpha[0], cap[1] / alpha[1], cap[2]]),
            false => unit([alpha[0] * cap[0], alpha[1] * cap[1], cap[2]]),
        };
        let i = plus(times(-1.0, o), 2.0 * dot(o, h), h);
        let wi = along_grain(i, [grain[0], -grain[1]]);
        if wi[2] <= 0.0 {
            return None;
        }
        let density = self.pdf(wo, wi, wavelength_nm);
        let weight = self.f(wo, wi, wavelength_nm) * wi[2] / density;
        Some(Scattered { wi, weight, density: Density::SolidAngle(density) })
    }
}

#[test]
fn right_brushed_metal_is_accepted_and_wrong_one_rejected() {
    accepted(&Brushed { fault: "" }, 1);
    for fault in [
        "the density forgets the rotation",
        "the density has the widths exchanged",
        "the Jacobian of the reflection is 4",
        "directions are drawn without the rotation",
        "directions are drawn with the widths exchanged",
        "normals are stretched as places are",
        "density over α_u² instead of α_u α_v",
    ] {
        rejected(&Brushed { fault }, fault);
    }
}

/// Laws cannot tell one grain from another: an independent quadrature does.
#[test]
fn albedos_tell_which_way_the_grain_runs() {
    let wo = unit([0.9, 0.1, 0.3]);
    let albedo = |fault: &'static str| {
        let subject = Brushed { fault };
        let steps = 400;
        let place = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let of = |k: u32| {
            let (z, phi) = (place(k % steps), 2.0 * PI * place(k / steps));
            let s = (1.0 - z * z).sqrt();
            subject.f(wo, [s * phi.cos(), s * phi.sin(), z], 550.0) * z
        };
        (0..steps * steps).map(of).sum::<f64>() * 2.0 * PI / f64::from(steps * steps)
    };
    let truth = anisotropic_ggx_albedo(ALPHA, along_grain(wo, GRAIN), None, Masking::Correlated).reflected;
    // The grid of directions.
    assert!((albedo("") - truth).abs() < 1e-3, "{} is not {truth}", albedo(""));
    for fault in ["the value forgets the rotation", "the value has the widths exchanged"] {
        assert!((albedo(fault) - truth).abs() > 0.01, "{fault}: {}", albedo(fault));
    }
}
