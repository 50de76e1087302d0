//! Rough diffuse reflection on both sides: EON, the energy-conserving Oren–Nayar of Portsmouth, Kutz & Hill 2024 (*EON: A
//! practical energy-preserving rough diffuse BRDF*), on the single scattering of Fujii's improved Oren–Nayar.
//!
//! f = ρA/π·(1 + r·s/t) + ρ_ms/π·(1 − E(µ_o))(1 − E(µ_i))/(1 − E_avg), with s = ω_o·ω_i − µ_oµ_i, t = max(µ_o, µ_i) where s > 0
//! and 1 elsewhere, A = 1/(1 + r(1/2 − 2/3π)) and ρ_ms = ρ²E_avg/(1 − ρ(1 − E_avg)). E is the albedo of the first term for
//! ρ = 1. At ρ = 1 all light comes back, at r = 0 it is Lambert's.

use super::albedo::{Azimuths, LossTable};
use super::microfacet::Facing;
use super::{Drawn, Properties};
use crate::texture::{PathTexture, TexturePoint};
use crate::warp::cosine_hemisphere;
use etalon_optics::{Lanes, Vec3};
use etalon_scene::SpectrumTexture;
use std::f64::consts::{FRAC_1_PI, PI};

/// Rough diffuse reflection.
#[derive(Clone, Debug)]
pub struct OrenNayar {
    reflectance: PathTexture,
    roughness: f64,
    scale: f64,
    loss: Box<LossTable>,
}

impl OrenNayar {
    /// A surface of this albedo parameter, and of a roughness in [0, 1].
    pub fn new(reflectance: PathTexture, roughness: f64) -> Self {
        let scale = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * roughness);
        let loss =
            Box::new(LossTable::new(Azimuths::All, [1.0, 1.0], 1e-5, |wo, _| 1.0 - albedo(roughness, scale, wo.z)));
        Self { reflectance, roughness, scale, loss }
    }

    /// See [`Properties`].
    pub(super) fn properties(reflectance: &SpectrumTexture) -> Properties {
        Properties { dark: reflectance.is_zero(), ..Properties::SOLID_ANGLE }
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        place: TexturePoint,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let Some(facing) = Facing::new(n, wo) else { return (Lanes::ZERO, Lanes::ZERO) };
        let (wo, wi) = (facing.wo, facing.local(wi));
        if wi.z <= 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let s = wo.x * wi.x + wo.y * wi.y;
        let t = if s > 0.0 { wo.z.max(wi.z) } else { 1.0 };
        let single = self.scale * (1.0 + self.roughness * s / t);
        let mean_loss = self.loss.average(1.0);
        let several = if mean_loss > 0.0 { self.loss.eval(wo, 1.0) * self.loss.eval(wi, 1.0) / mean_loss } else { 0.0 };
        let pdf = wi.z * FRAC_1_PI;
        let reflectance: Lanes<f64, N> = self.reflectance.lanes(lambda_nm, place);
        let f_cos = Lanes::from_fn(|lane| {
            let rho = reflectance[lane];
            let again = rho * rho * (1.0 - mean_loss) / (1.0 - rho * mean_loss);
            (rho * single + again * several) * pdf
        });
        (f_cos, Lanes::splat(pdf))
    }

    pub(super) fn draw<const N: usize>(n: Vec3<f64>, wo: Vec3<f64>, u: [f64; 2]) -> Option<Drawn<N>> {
        let facing = Facing::new(n, wo)?;
        let wi = facing.world(cosine_hemisphere(u));
        Drawn::reflected(wi, facing.local(wi).z)
    }
}

/// Albedo of the single scattering of a white surface: A(1 + r·G(µ)/π), G = sin θ(θ − sin θ cos θ) + ⅔(tan θ(1 − sin³θ) − sin θ).
pub(super) fn albedo(roughness: f64, scale: f64, mu: f64) -> f64 {
    let (theta, sin) = (mu.acos(), ((1.0 - mu) * (1.0 + mu)).sqrt());
    let g = sin * (theta - sin * mu) + 2.0 / 3.0 * (sin / mu * (1.0 - sin * sin * sin) - sin);
    scale * (1.0 + roughness * FRAC_1_PI * g)
}
