//! Diffuse reflection and diffuse transmission, alike on both sides: leaves, paper, cloth, lampshades.
//!
//! f = ρ/π on the side of `wo` and τ/π on the other, with ρ + τ ≤ 1: the leaf of canopy models (J. Ross 1981, *The Radiation Regime and
//! Architecture of Plant Stands*). The side is chosen in proportion to the sums of ρ and of τ over the lanes: so each lane finds light
//! wherever its own goes. The direction is drawn in proportion to the cosine.

use super::lambert::{density, direction, toward};
use super::{BsdfSample, Properties};
use crate::mis::Density;
use crate::texture::{PathTexture, TexturePoint};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::SpectrumTexture;

/// Diffuse reflection and transmission.
#[derive(Clone, Debug)]
pub struct Translucent {
    reflectance: PathTexture,
    transmittance: PathTexture,
}

impl Translucent {
    /// A sheet of these shares, which add up to at most 1.
    pub fn new(reflectance: PathTexture, transmittance: PathTexture) -> Self {
        Self { reflectance, transmittance }
    }

    /// See [`Properties`].
    pub(super) fn properties(reflectance: &SpectrumTexture, transmittance: &SpectrumTexture) -> Properties {
        Properties { dark: reflectance.is_zero() && transmittance.is_zero(), ..Properties::SOLID_ANGLE }
    }

    /// Shares of light that come back and that pass, and the probability with which the former is chosen.
    fn shares<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        place: TexturePoint,
    ) -> (Lanes<f64, N>, Lanes<f64, N>, f64) {
        let [reflected, transmitted] =
            [&self.reflectance, &self.transmittance].map(|texture| texture.lanes::<N>(lambda_nm, place));
        let (back, both) = (reflected.sum(), reflected.sum() + transmitted.sum());
        (reflected, transmitted, if both > 0.0 { back / both } else { 0.0 })
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        place: TexturePoint,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let (cos_o, cos_i) = (n.dot(wo), n.dot(wi));
        if cos_o == 0.0 || cos_i == 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let (reflected, transmitted, back) = self.shares(lambda_nm, place);
        let reflects = (cos_o > 0.0) == (cos_i > 0.0);
        let (share, probability) = if reflects { (reflected, back) } else { (transmitted, 1.0 - back) };
        let cosine = density(cos_i.abs());
        (share * cosine, Lanes::splat(probability * cosine))
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        place: TexturePoint,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<BsdfSample<N>> {
        let (reflected, transmitted, back) = self.shares(lambda_nm, place);
        let reflects = u[0] < back;
        let (share, probability) = if reflects { (reflected, back) } else { (transmitted, 1.0 - back) };
        let n = toward(n, wo);
        let n = if reflects { n } else { -n };
        let (wi, cos) = direction(n, n, [u[1], u[2]]);
        (cos > 0.0).then(|| BsdfSample {
            wi,
            weight: share / probability,
            density: Density::SolidAngle(probability * density(cos)),
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}
