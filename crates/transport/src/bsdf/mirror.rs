//! Ideal mirror on both sides: the same reflectance at every angle.

use super::{BsdfSample, Properties};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use crate::texture::{PathTexture, TexturePoint};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::SpectrumTexture;

/// Ideal mirror.
#[derive(Clone, Debug)]
pub struct Mirror {
    reflectance: PathTexture,
}

impl Mirror {
    /// A mirror of this reflectance, in [0, 1].
    pub fn new(reflectance: PathTexture) -> Self {
        Self { reflectance }
    }

    /// See [`Properties`].
    pub(super) fn properties(reflectance: &SpectrumTexture) -> Properties {
        Properties { dark: reflectance.is_zero(), ..Properties::mirror("a mirror") }
    }

    /// The reflectance, if it is the same everywhere.
    pub(crate) fn uniform(&self) -> Option<&PathSpectrum> {
        self.reflectance.uniform()
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        place: TexturePoint,
        wo: Vec3<f64>,
    ) -> Option<BsdfSample<N>> {
        Some(BsdfSample {
            // Kept at unit length, so that ten thousand reflections do not drift (hard case 33).
            wi: wo.reflected_about(n).renormalized(),
            weight: self.reflectance.lanes(lambda_nm, place),
            density: Density::Delta,
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}
