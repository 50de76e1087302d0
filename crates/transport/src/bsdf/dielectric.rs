//! Smooth interface between two transparent media: the Fresnel equations choose between reflection and refraction.
//!
//! Where the index depends on wavelength, the hero alone keeps the refracted direction: another lane's light would have
//! gone elsewhere. Reflection is shared by all lanes, each with its own probability of having chosen it, which the
//! balance heuristic over lanes needs (Wilkie et al. 2014, eq. 5).

use super::BsdfSample;
use crate::compiled;
use crate::media::Interface;
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
use etalon_optics::{Lanes, Real, RefractiveIndex, Vec3, fresnel, snell};

/// Smooth interface of two transparent media.
#[derive(Clone, Debug)]
pub struct Dielectric {
    interior: RefractiveIndex,
    exterior: RefractiveIndex,
    dispersive: bool,
}

impl Dielectric {
    /// An interface with `interior` behind the outward normal and `exterior` before it.
    pub fn new(interior: RefractiveIndex, exterior: RefractiveIndex) -> Self {
        let dispersive = interior.is_dispersive() || exterior.is_dispersive();
        Self { interior, exterior, dispersive }
    }

    /// n_transmitted / n_incident for a path that arrives on the outside, or on the inside.
    fn eta(&self, lambda_nm: f64, from_outside: bool, interface: Option<Interface<'_>>) -> f64 {
        if let Some(media) = interface {
            return media.transmitted.eval(lambda_nm) / media.incident.eval(lambda_nm);
        }
        let (inside, outside) = (self.interior.eval(lambda_nm), self.exterior.eval(lambda_nm));
        if from_outside { inside / outside } else { outside / inside }
    }

    /// What the interface does to polarised light that it turns at the cosine `cos`: seen from outside or not, reflected or not.
    pub(super) fn mueller(
        &self,
        wavelength_nm: f64,
        cos: f64,
        (from_outside, reflects): (bool, bool),
        interface: Option<Interface<'_>>,
    ) -> Matrix {
        let eta = self.eta(wavelength_nm, from_outside, interface);
        match fresnel::refracted_cosine(cos, eta) {
            Some(cos_t) if !reflects => mueller::dielectric_transmission(cos, eta, cos_t),
            _ => mueller::dielectric_reflection(cos, eta),
        }
    }

    pub(super) fn sample<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        wo: Vec3<f64>,
        u: f64,
        interface: Option<Interface<'_>>,
    ) -> Option<BsdfSample<R, N>> {
        let from_outside = n.dot(wo) > 0.0;
        let n = if from_outside { n } else { -n };
        // Rounding may carry the product of two unit vectors past 1.
        let cos_o = n.dot(wo).min(1.0);
        let dispersive = compiled::DISPERSION
            && match interface {
                Some(media) => media.incident.is_dispersive() || media.transmitted.is_dispersive(),
                None => self.dispersive,
            };
        // Whether a wavelength is reflected for certain, or how likely and, if it is not, where it goes.
        let at = |lane: usize| {
            let eta = self.eta(lambda_nm[lane], from_outside, interface);
            (eta, fresnel::dielectric(cos_o, eta))
        };
        let (eta, hero) = at(0);
        let reflectance = hero.map_or(1.0, |f| f.reflectance);

        if u < reflectance {
            let lane_density = if dispersive {
                Lanes::from_fn(|lane| match lane {
                    0 => R::ONE,
                    _ => R::from_f64(at(lane).1.map_or(1.0, |f| f.reflectance) / reflectance),
                })
            } else {
                Lanes::ONE
            };
            return Some(BsdfSample {
                wi: wo.reflected_about(n).renormalized(),
                weight: lane_density,
                density: Density::Delta,
                lane_density,
                eta: 1.0,
            });
        }
        let wi = snell::refract_with_cosines(wo, n, eta, cos_o, hero?.cos_t);
        let lane_density = if dispersive { Lanes::ONE.hero_only() } else { Lanes::ONE };
        Some(BsdfSample {
            wi,
            // T/(1 − R) = 1 in exact arithmetic; radiance is compressed into the denser medium, or spread from it.
            weight: lane_density / R::from_f64(eta * eta),
            density: Density::Delta,
            lane_density,
            eta,
        })
    }
}
