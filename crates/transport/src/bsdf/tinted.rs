//! A metal, an interface or a pane with a tint. What it reflects is multiplied by one share, what it passes by another. A share depends on the
//! wavelength and the place alone. An example is the coloured skin of a bulb.
//!
//! With factors of at most 1 it gains no energy, and what was reciprocal stays so: light crosses it either way by the same factor.

use super::{Bsdf, BsdfSample, Drawn, Lobe, Properties, Shading};
use crate::polarisation::mueller::Matrix;
use crate::texture::PathTexture;
use etalon_optics::{Lanes, Vec3};

/// Another BSDF times factors.
#[derive(Clone, Debug)]
pub struct Tinted {
    bsdf: Box<Bsdf>,
    reflected: PathTexture,
    transmitted: PathTexture,
}

impl Tinted {
    /// `bsdf`, of whose light these shares are left.
    pub fn new(bsdf: Bsdf, reflected: PathTexture, transmitted: PathTexture) -> Self {
        Self { bsdf: Box::new(bsdf), reflected, transmitted }
    }

    /// See [`Properties`].
    pub(super) fn properties(of: Properties) -> Properties {
        of
    }

    /// What is tinted.
    pub(super) fn bsdf(&self) -> &Bsdf {
        &self.bsdf
    }

    /// The same, to be changed.
    pub(super) fn bsdf_mut(&mut self) -> &mut Bsdf {
        &mut self.bsdf
    }

    fn tint<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        (wo, wi): (Vec3<f64>, Vec3<f64>),
    ) -> Lanes<f64, N> {
        let reflects = (n.dot(wo) > 0.0) == (n.dot(wi) > 0.0);
        let texture = if reflects { &self.reflected } else { &self.transmitted };
        texture.lanes(lambda_nm, at.texture_point())
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let (f_cos, density) = self.bsdf.eval_around(lambda_nm, n, at, wo, wi);
        (f_cos * self.tint(lambda_nm, n, at, (wo, wi)), density)
    }

    pub(super) fn draw<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        Some(match self.bsdf.draw_around(lambda_nm, n, at, wo, u)? {
            Drawn::Sample(sample) => {
                let weight = sample.weight * self.tint(lambda_nm, n, at, (wo, sample.wi));
                Drawn::Sample(BsdfSample { weight, ..sample })
            }
            drawn @ Drawn::Direction(..) => drawn,
        })
    }

    pub(super) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        directions: (Vec3<f64>, Vec3<f64>, Vec3<f64>),
        lobe: Lobe,
    ) -> Option<[Matrix; N]> {
        self.bsdf.mueller_around(lambda_nm, n, at, directions, lobe)
    }
}
