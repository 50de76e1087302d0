//! Rough metal: GGX facets of Fresnel's reflectance, and what light that meets several facets adds.
//!
//! f = F(wo·h) D(h) G₂/(4 cos θ_o cos θ_i) + F_ms (1 − E(µ_o))(1 − E(µ_i))/(π(1 − E_avg)) with
//! F_ms = F_avg² E_avg/(1 − F_avg(1 − E_avg)): Kulla & Conty 2017, with the colour of the series of bounces, the first of
//! which cannot escape. E is the albedo of the same facets if they reflected everything.

use super::albedo::{self, Azimuths, LossTable};
use super::film::PathFilm;
use super::metal::{OfMetal, PathMetal};
use super::microfacet::{Distribution, MEAN_ERROR, gauss_rule, mean_over_facets};
use super::table_store::Tabulated;
use super::{Drawn, Properties, Shading};
use crate::polarisation::mueller::{self, Matrix};
use etalon_optics::fresnel::Amplitudes;
use etalon_optics::{Complex, Lanes, Vec3, fresnel};
use etalon_scene::Microfacets;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// Rough metal.
#[derive(Clone, Debug)]
pub struct RoughConductor {
    metal: PathMetal,
    film: Option<PathFilm>,
    distribution: Distribution,
    compensation: Option<Box<Compensation>>,
}

#[derive(Clone, Debug)]
struct Compensation {
    loss: Arc<LossTable>,
    /// F_ms/(π(1 − E_avg)), unless it is to be computed where it is needed: each place has another film then, or another metal beneath
    /// it.
    factor: Option<OfMetal>,
    /// 1 − E_avg.
    missing: f64,
}

impl Compensation {
    /// F_ms/(π(1 − E_avg)) of facets that reflect `reflectance` at a cosine.
    fn several(missing: f64, rule: &[(f64, f64)], reflectance: impl Fn(f64) -> f64) -> f64 {
        let mean: f64 = rule.iter().map(|(mu, w)| 2.0 * w * mu * reflectance(*mu)).sum();
        let several = mean * mean * (1.0 - missing) / (1.0 - mean * missing);
        if missing > 0.0 { several * FRAC_1_PI / missing } else { 0.0 }
    }
}

impl RoughConductor {
    /// A metal, perhaps coated, with or without the light that meets several facets.
    pub fn new(
        metal: PathMetal,
        film: Option<PathFilm>,
        facets: &Microfacets,
        compensated: bool,
        range_nm: [f64; 2],
    ) -> Self {
        let distribution = Distribution::new(facets);
        let compensation = compensated.then(|| {
            let loss = albedo::shared(Tabulated::Mirrors, &distribution, [1.0, 1.0], || {
                let lost = |wo, _| mean_over_facets(&distribution, wo, None, |facet| 1.0 - facet.mirrored);
                LossTable::new(Azimuths::of(&distribution), [1.0, 1.0], MEAN_ERROR, lost)
            });
            let missing = loss.average(1.0);
            let rule = gauss_rule(24);
            let factor = match &film {
                None => Some(OfMetal::new(&metal, range_nm, |n, k| {
                    Compensation::several(missing, &rule, |mu| fresnel::conductor(mu, n, k).reflectance)
                })),
                Some(film) if !film.varies() => OfMetal::by_wavelength(&metal, range_nm, |nm, n, k| {
                    Compensation::several(missing, &rule, |mu| on_metal(film, nm, mu, (n, k), [0.0; 2]).power())
                }),
                Some(_) => None,
            };
            Box::new(Compensation { loss, factor, missing })
        });
        Self { metal, film, distribution, compensation }
    }

    /// See [`Properties`]. Its tables are made for vacuum.
    pub(super) fn properties(facets: &Microfacets) -> Properties {
        Properties::of_facets(facets)
    }

    /// What a facet reflects at a cosine.
    fn reflectance(&self, wavelength_nm: f64, cos: f64, (n, k): (f64, f64), uv: [f64; 2]) -> f64 {
        match &self.film {
            Some(film) => on_metal(film, wavelength_nm, cos, (n, k), uv).power(),
            None => fresnel::conductor(cos, n, k).reflectance,
        }
    }

    /// [`Compensation::factor`] at a place.
    fn several(&self, compensation: &Compensation, wavelength_nm: f64, index: (f64, f64), uv: [f64; 2]) -> f64 {
        match &compensation.factor {
            Some(factor) => factor.eval(wavelength_nm, index.1),
            None => Compensation::several(compensation.missing, &COARSE_RULE, |mu| {
                self.reflectance(wavelength_nm, mu, index, uv)
            }),
        }
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
        let Some(facing) = self.distribution.facing(at, n, wo) else { return (Lanes::ZERO, Lanes::ZERO) };
        let (wo, wi) = (facing.wo, facing.local(wi));
        if wi.z <= 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let single = self.distribution.reflection(wo, wi);
        let loss = self.loss(wo);
        let several = loss * self.loss(wi);
        let index = self.metal.lanes(lambda_nm, at.texture_point());
        let mut f = match &self.film {
            // All lanes at once.
            None => Lanes::from_fn(|lane| fresnel::conductor(single.cos, index[lane].0, index[lane].1).reflectance),
            Some(_) => Lanes::from_fn(|lane| self.reflectance(lambda_nm[lane], single.cos, index[lane], at.uv)),
        } * single.term;
        if let Some(compensation) = &self.compensation {
            f += Lanes::from_fn(|lane| several * self.several(compensation, lambda_nm[lane], index[lane], at.uv));
        }
        let f_cos = f * wi.z;
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
        let facing = self.distribution.facing(at, n, wo)?;
        let (wo, wi) = (facing.wo, facing.local(wi));
        let single = self.distribution.reflection(wo, wi);
        let several = self.loss(wo) * self.loss(wi);
        let index = self.metal.lanes(lambda_nm, at.texture_point());
        Some(std::array::from_fn(|lane| {
            let (nm, (eta, k)) = (lambda_nm[lane], index[lane]);
            let facet = self.reflectance(nm, single.cos, (eta, k), at.uv) * single.term;
            let forgotten = match &self.compensation {
                Some(compensation) => several * self.several(compensation, nm, (eta, k), at.uv),
                None => 0.0,
            };
            let matrix = match &self.film {
                Some(film) => mueller::of_waves(&on_metal(film, nm, single.cos, (eta, k), at.uv)),
                None => mueller::conductor_reflection(single.cos, eta, k),
            };
            mueller::mixed([(facet, matrix), (forgotten, mueller::DEPOLARISER)])
        }))
    }

    pub(super) fn draw<const N: usize>(
        &self,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        let facing = self.distribution.facing(at, n, wo)?;
        let [u_lobe, u1, u2] = u;
        let wi = match &self.compensation {
            Some(compensation) if u_lobe < compensation.loss.eval(facing.wo, 1.0) => compensation.loss.sample([u1, u2]),
            _ => facing.wo.reflected_about(self.distribution.visible_normal(facing.wo, [u1, u2])),
        };
        let wi = facing.world(wi);
        Drawn::reflected(wi, facing.local(wi).z)
    }
}

/// What a film on a metal of n + ik in vacuum reflects.
fn on_metal(film: &PathFilm, wavelength_nm: f64, cos: f64, (n, k): (f64, f64), uv: [f64; 2]) -> Amplitudes {
    film.fresnel(wavelength_nm, cos, (1.0, Complex::new(n, k)), true, uv).reflection
}

/// Gauss's rule of four points on [0, 1], nodes and weights: what is computed at each place takes no more.
const COARSE_RULE: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_13, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_29, 0.173_927_422_568_726_93),
];
