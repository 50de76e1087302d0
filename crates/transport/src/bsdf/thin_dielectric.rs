//! A pane too thin to see its thickness, on both sides the same medium: light passes straight on or is mirrored, after any
//! number of internal reflections. With R of one face, R + T²R + T²R³ + … = 2R/(1 + R) is reflected and the rest transmitted,
//! added without interference.

use super::BsdfSample;
use crate::mis::Density;
use etalon_optics::{Lanes, Real, RefractiveIndex, Vec3, fresnel};

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

    pub(super) fn sample<R: Real, const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        wo: Vec3<f64>,
        u: f64,
    ) -> Option<BsdfSample<R, N>> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos = n.dot(wo).abs().min(1.0);
        let reflects = u < pane(cos, self.reference)[0];
        let side = usize::from(!reflects);
        let share = |index: f64| pane(cos, index)[side];
        let probability = share(self.reference);
        Some(BsdfSample {
            wi: if reflects { wo.reflected_about(n).renormalized() } else { -wo },
            weight: Lanes::from_fn(|lane| R::from_f64(share(self.index.eval(lambda_nm[lane])) / probability)),
            density: Density::Delta,
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}

/// Shares of light that a pane reflects and transmits: 2R/(1 + R) and T/(1 + R).
fn pane(cos: f64, index: f64) -> [f64; 2] {
    // From a pane that is thinner optically than what surrounds it, total reflection returns all.
    let Some(f) = fresnel::dielectric(cos, index) else { return [1.0, 0.0] };
    let both = 1.0 + f.reflectance;
    [2.0 * f.reflectance / both, f.transmittance / both]
}
