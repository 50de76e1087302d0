//! Rough metal: GGX facets of Fresnel's reflectance, and what light that meets several facets adds.
//!
//! f = F(wo·h) D(h) G₂/(4 cos θ_o cos θ_i) + F_ms (1 − E(µ_o))(1 − E(µ_i))/(π(1 − E_avg)) with
//! F_ms = F_avg² E_avg/(1 − F_avg(1 − E_avg)): Kulla & Conty 2017, with the colour of the series of bounces, the first of
//! which cannot escape. E is the albedo of the same facets if they reflected everything.

use super::albedo::{self, Azimuths, LossTable, Tabulated};
use super::metal::{OfMetal, PathMetal};
use super::microfacet::{Ggx, MEAN_ERROR, gauss_rule, mean_over_facets};
use super::{BsdfSample, Properties, Shading};
use crate::polarisation::mueller::{self, Matrix};
use etalon_optics::{Lanes, Vec3, fresnel};
use etalon_scene::Microfacets;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// Rough metal.
#[derive(Clone, Debug)]
pub struct RoughConductor {
    metal: PathMetal,
    ggx: Ggx,
    compensation: Option<Box<Compensation>>,
}

#[derive(Clone, Debug)]
struct Compensation {
    loss: Arc<LossTable>,
    /// F_ms/(π(1 − E_avg)).
    factor: OfMetal,
}

impl RoughConductor {
    /// A metal with or without the light that meets several facets.
    pub fn new(metal: PathMetal, facets: &Microfacets, compensated: bool, range_nm: [f64; 2]) -> Self {
        let ggx = Ggx::new(facets);
        let compensation = compensated.then(|| {
            let loss = albedo::shared(Tabulated::Mirrors, &ggx, [1.0, 1.0], || {
                let lost = |wo, _| mean_over_facets(&ggx, wo, None, |facet| 1.0 - facet.mirrored);
                LossTable::new(Azimuths::of(&ggx), [1.0, 1.0], MEAN_ERROR, lost)
            });
            let missing = loss.average(1.0);
            let rule = gauss_rule(24);
            let factor = OfMetal::new(&metal, range_nm, |n, k| {
                let mean: f64 =
                    rule.iter().map(|(mu, w)| 2.0 * w * mu * fresnel::conductor(*mu, n, k).reflectance).sum();
                let several = mean * mean * (1.0 - missing) / (1.0 - mean * missing);
                if missing > 0.0 { several * FRAC_1_PI / missing } else { 0.0 }
            });
            Box::new(Compensation { loss, factor })
        });
        Self { metal, ggx, compensation }
    }

    /// See [`Properties`]. Its tables are made for vacuum.
    pub(super) fn properties(facets: &Microfacets) -> Properties {
        Properties::of_facets(facets)
    }

    fn loss(&self, w: Vec3<f64>) -> f64 {
        self.compensation.as_ref().map_or(0.0, |c| c.loss.eval(w, 1.0))
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let Some(facing) = self.ggx.facing(at, n, wo) else { return (Lanes::ZERO, Lanes::ZERO) };
        let (wo, wi) = (facing.wo, facing.local(wi));
        if wi.z <= 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let single = self.ggx.reflection(wo, wi);
        let loss = self.loss(wo);
        let several = loss * self.loss(wi);
        let index = self.metal.lanes(lambda_nm, at.uv);
        let f_cos = Lanes::from_fn(|lane| {
            let (eta, k) = index[lane];
            let mut f = fresnel::conductor(single.cos, eta, k).reflectance * single.term;
            if let Some(compensation) = &self.compensation {
                f += several * compensation.factor.eval(lambda_nm[lane], k);
            }
            f * wi.z
        });
        let diffuse = self.compensation.as_ref().map_or(0.0, |c| c.loss.density(wi.z));
        let density = (1.0 - loss) * single.density + loss * diffuse;
        (f_cos, Lanes::splat(density))
    }

    /// What it does to polarised light: its facets reflect as smooth metal does, light that meets several forgets.
    pub(super) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> Option<[Matrix; N]> {
        let facing = self.ggx.facing(at, n, wo)?;
        let (wo, wi) = (facing.wo, facing.local(wi));
        let single = self.ggx.reflection(wo, wi);
        let several = self.loss(wo) * self.loss(wi);
        let index = self.metal.lanes(lambda_nm, at.uv);
        Some(std::array::from_fn(|lane| {
            let (eta, k) = index[lane];
            let facet = fresnel::conductor(single.cos, eta, k).reflectance * single.term;
            let forgotten = self.compensation.as_ref().map_or(0.0, |c| several * c.factor.eval(lambda_nm[lane], k));
            mueller::mixed([
                (facet, mueller::conductor_reflection(single.cos, eta, k)),
                (forgotten, mueller::DEPOLARISER),
            ])
        }))
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<BsdfSample<N>> {
        let facing = self.ggx.facing(at, n, wo)?;
        let [u_lobe, u1, u2] = u;
        let wi = match &self.compensation {
            Some(compensation) if u_lobe < compensation.loss.eval(facing.wo, 1.0) => compensation.loss.sample([u1, u2]),
            _ => facing.wo.reflected_about(self.ggx.visible_normal(facing.wo, [u1, u2])),
        };
        let wi = facing.world(wi);
        // Of the direction as it came out, rounding included: below the surface the light is lost.
        let (f_cos, density) = self.eval(lambda_nm, n, at, wo, wi);
        BsdfSample::scattered(wi, f_cos, density, 1.0)
    }
}
