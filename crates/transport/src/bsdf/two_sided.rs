//! A surface whose sides differ; where one is black it reflects on the other alone, as a plain diffuse surface does in Mitsuba.

use super::{Blend, Bsdf, Drawn, Lobe, Properties, Shading};
use crate::polarisation::mueller::Matrix;
use etalon_optics::{Lanes, Vec3};

/// Two BSDFs, of which a viewer sees one. They reflect only: a direction of light on the other side has no value in any case.
#[derive(Clone, Debug)]
pub struct TwoSided {
    front: Box<Bsdf>,
    back: Box<Bsdf>,
}

impl TwoSided {
    /// The one on the side that the surface normal points into, and the other.
    pub fn new(front: Bsdf, back: Bsdf) -> Self {
        let [front, back] = [front, back].map(Box::new);
        Self { front, back }
    }

    /// See [`Properties`]: what either has.
    pub(super) fn properties(sides: [Properties; 2]) -> Properties {
        Blend::properties(sides)
    }

    /// Both sides.
    pub(super) fn sides_mut(&mut self) -> [&mut Bsdf; 2] {
        [&mut self.front, &mut self.back]
    }

    /// What a viewer sees of it.
    pub(super) fn seen(&self, n: Vec3<f64>, wo: Vec3<f64>) -> &Bsdf {
        if n.dot(wo) > 0.0 { &self.front } else { &self.back }
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        self.seen(n, wo).eval_around(lambda_nm, n, at, wo, wi)
    }

    pub(super) fn draw<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        self.seen(n, wo).draw_around(lambda_nm, n, at, wo, u)
    }

    pub(super) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        directions: (Vec3<f64>, Vec3<f64>, Vec3<f64>),
        lobe: Lobe,
    ) -> Option<[Matrix; N]> {
        self.seen(n, directions.0).mueller_around(lambda_nm, n, at, directions, lobe)
    }

    /// See [`Bsdf::prepare_polarisation`].
    pub(super) fn prepare_polarisation(&mut self) {
        self.sides_mut().into_iter().for_each(Bsdf::prepare_polarisation);
    }
}
