//! A pane too thin to see its thickness, on both sides the same medium: light passes straight on or is mirrored, after any
//! number of internal reflections, added without interference ([`mueller::pane`]). Between its two faces s and p go their own
//! ways: a pane is one surface, which treats the light that it is given as unpolarised, but not what is within it.

use super::{BsdfSample, Properties};
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
use etalon_optics::{Lanes, RefractiveIndex, Vec3};

/// A thin pane.
#[derive(Clone, Debug)]
pub struct ThinDielectric {
    index: RefractiveIndex,
    /// Index by which reflection or transmission is chosen, so that every wavelength chooses alike.
    reference: f64,
}

impl ThinDielectric {
    /// A pane of this index relative to what surrounds it.
    pub fn new(index: RefractiveIndex, range_nm: [f64; 2]) -> Self {
        let reference = index.eval(0.5 * (range_nm[0] + range_nm[1]));
        Self { index, reference }
    }

    /// See [`Properties`]. Its index is relative to any medium.
    pub(super) fn properties() -> Properties {
        Properties::pane("a thin pane")
    }

    /// What the pane does to polarised light that meets it at the cosine `cos`.
    pub(super) fn mueller(&self, wavelength_nm: f64, cos: f64, reflects: bool) -> Matrix {
        let pane = mueller::pane(cos, self.index.eval(wavelength_nm));
        if reflects { pane.reflection } else { pane.transmission }
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        wo: Vec3<f64>,
        u: f64,
    ) -> Option<BsdfSample<N>> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos = n.dot(wo).abs().min(1.0);
        let reflects = u < mueller::pane(cos, self.reference).reflectance;
        let share = |index: f64| {
            let pane = mueller::pane(cos, index);
            if reflects { pane.reflectance } else { pane.transmittance }
        };
        let probability = share(self.reference);
        Some(BsdfSample {
            wi: if reflects { wo.reflected_about(n).renormalized() } else { -wo },
            weight: Lanes::from_fn(|lane| share(self.index.eval(lambda_nm[lane])) / probability),
            density: Density::Delta,
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}
