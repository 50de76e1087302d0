//! A surface that reflects on one side and is black on the other, as a plain diffuse surface is in Mitsuba.

use super::{Bsdf, Drawn, Lobe, Properties, Shading};
use crate::polarisation::mueller::Matrix;
use etalon_optics::{Lanes, Vec3};
use etalon_scene::Side;

/// A BSDF on one side of a surface. It reflects only: a direction of light on the other side has no value in any case.
#[derive(Clone, Debug)]
pub struct OneSided {
    bsdf: Box<Bsdf>,
    side: Side,
}

impl OneSided {
    /// `bsdf` on this side.
    pub fn new(bsdf: Bsdf, side: Side) -> Self {
        Self { bsdf: Box::new(bsdf), side }
    }

    /// See [`Properties`]: those of what reflects.
    pub(super) fn properties(of: Properties) -> Properties {
        of
    }

    /// Whether a viewer sees the side that reflects.
    fn is_seen(&self, n: Vec3<f64>, wo: Vec3<f64>) -> bool {
        let cos = n.dot(wo);
        match self.side {
            Side::Front => cos > 0.0,
            Side::Back => cos < 0.0,
        }
    }

    /// What it does on the side that reflects.
    pub(super) fn bsdf_mut(&mut self) -> &mut Bsdf {
        &mut self.bsdf
    }

    /// What a viewer sees of it, on the side that reflects.
    pub(super) fn seen(&self, n: Vec3<f64>, wo: Vec3<f64>) -> Option<&Bsdf> {
        self.is_seen(n, wo).then_some(&self.bsdf)
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        match self.is_seen(n, wo) {
            true => self.bsdf.eval_around(lambda_nm, n, at, wo, wi),
            false => (Lanes::ZERO, Lanes::ZERO),
        }
    }

    pub(super) fn draw<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        self.is_seen(n, wo).then(|| self.bsdf.draw_around(lambda_nm, n, at, wo, u))?
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

    /// See [`Bsdf::prepare_polarisation`].
    pub(super) fn prepare_polarisation(&mut self) {
        self.bsdf.prepare_polarisation();
    }
}
