//! Smooth metal: Fresnel reflection from a complex refractive index n + ik, seen from vacuum, s and p averaged.

use super::BsdfSample;
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
    ) -> Option<BsdfSample<R, N>> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos_o = n.dot(wo).abs().min(R::ONE);
        Some(BsdfSample {
            wi: wo.reflected_about(n).renormalized(),
            weight: Lanes::from_fn(|lane| {
                let (eta, k) = self.index.eval(lambda_nm[lane]);
                fresnel::conductor(cos_o, R::from_f64(eta), R::from_f64(k)).reflectance
            }),
            density: Density::Delta,
            lane_density: Lanes::ONE,
            eta: R::ONE,
        })
    }
}
