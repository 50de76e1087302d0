//! Smooth metal: Fresnel reflection from a complex refractive index n + ik, relative to the medium it stands in (vacuum, if
//! media are not tracked), s and p averaged.

use super::BsdfSample;
use crate::media::Interface;
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
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

    /// n and k relative to the medium in front of the metal.
    fn relative_index(&self, wavelength_nm: f64, interface: Option<Interface<'_>>) -> (f64, f64) {
        let (n, k) = self.index.eval(wavelength_nm);
        let around = interface.map_or(1.0, |media| media.incident.eval(wavelength_nm));
        (n / around, k / around)
    }

    /// What reflection at the cosine `cos` does to polarised light.
    pub(super) fn mueller(&self, wavelength_nm: f64, cos: f64, interface: Option<Interface<'_>>) -> Matrix {
        let (n, k) = self.relative_index(wavelength_nm, interface);
        mueller::conductor_reflection(cos, n, k)
    }

    pub(super) fn sample<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        wo: Vec3<f64>,
        interface: Option<Interface<'_>>,
    ) -> Option<BsdfSample<R, N>> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos_o = n.dot(wo).abs().min(1.0);
        Some(BsdfSample {
            wi: wo.reflected_about(n).renormalized(),
            weight: Lanes::from_fn(|lane| {
                let (n, k) = self.relative_index(lambda_nm[lane], interface);
                R::from_f64(fresnel::conductor(cos_o, n, k).reflectance)
            }),
            density: Density::Delta,
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}
