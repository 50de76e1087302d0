//! Smooth metal: Fresnel reflection from a complex refractive index n + ik, relative to the medium it stands in (vacuum, if
//! media are not tracked), s and p averaged.

use super::BsdfSample;
use crate::media::Interface;
use crate::mis::Density;
use etalon_optics::{ComplexIndex, Lanes, Real, Vec3, fresnel};

/// Smooth metal.
#[derive(Clone, Debug)]
pub struct Conductor {
    index: ComplexIndex,
}

impl Conductor {
    /// A metal of this refractive index.
    pub fn new(index: ComplexIndex) -> Self {
        Self { index }
    }

    pub(super) fn sample<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<R>,
        wo: Vec3<R>,
        interface: Option<Interface<'_>>,
    ) -> Option<BsdfSample<R, N>> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos_o = n.dot(wo).abs().min(R::ONE);
        Some(BsdfSample {
            wi: wo.reflected_about(n).renormalized(),
            weight: Lanes::from_fn(|lane| {
                let (eta, k) = self.index.eval(lambda_nm[lane]);
                let around = interface.map_or(1.0, |media| media.incident.eval(lambda_nm[lane]));
                fresnel::conductor(cos_o, R::from_f64(eta / around), R::from_f64(k / around)).reflectance
            }),
            density: Density::Delta,
            lane_density: Lanes::ONE,
            eta: R::ONE,
        })
    }
}
