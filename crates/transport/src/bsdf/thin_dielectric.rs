//! A pane too thin to see its thickness, on both sides the same medium: light passes straight on or is mirrored, after any
//! number of internal reflections, added without interference ([`mueller::pane`]). Between its two faces s and p go their own
//! ways: a pane is one surface, which treats the light that it is given as unpolarised, but not what is within it.
//!
//! A thin film may coat both faces. Then each wavelength has a probability of reflection of its own, by which the hero chooses.

use super::film::{PathFilm, PowerShares, chosen};
use super::{BsdfSample, Properties};
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix, Pane};
use etalon_optics::{Complex, Lanes, RefractiveIndex, Vec3, fresnel};

/// A thin pane.
#[derive(Clone, Debug)]
pub struct ThinDielectric {
    index: RefractiveIndex,
    /// Index by which reflection or transmission is chosen, so that every wavelength chooses alike.
    reference: f64,
    film: Option<PathFilm>,
}

impl ThinDielectric {
    /// A pane of this index relative to what surrounds it, perhaps coated on both faces.
    pub fn new(index: RefractiveIndex, film: Option<PathFilm>, range_nm: [f64; 2]) -> Self {
        let reference = index.eval(0.5 * (range_nm[0] + range_nm[1]));
        Self { index, reference, film }
    }

    /// What a pane with a film does.
    fn coated(&self, film: &PathFilm, wavelength_nm: f64, cos: f64, uv: [f64; 2]) -> Pane {
        let n = self.index.eval(wavelength_nm);
        let outer = film.fresnel(wavelength_nm, cos, (1.0, Complex::real(n)), true, uv);
        let Some(cos_t) = fresnel::refracted_cosine(cos, n) else {
            let reflection = mueller::of_waves(&outer.reflection);
            let reflectance = outer.reflection.power();
            return Pane { reflectance, transmittance: 0.0, reflection, transmission: mueller::IDENTITY };
        };
        let inner = film.fresnel_leaving(wavelength_nm, (cos_t, cos), n, uv);
        mueller::coated_pane(&outer, &inner)
    }

    /// See [`Properties`]. Its index is relative to any medium.
    pub(super) fn properties() -> Properties {
        Properties { passes_straight: true, ..Properties::pane("a thin pane") }
    }

    /// What the pane does to polarised light that meets it at the cosine `cos`.
    pub(super) fn mueller(&self, wavelength_nm: f64, (cos, uv): (f64, [f64; 2]), reflects: bool) -> Matrix {
        let pane = match &self.film {
            Some(film) => self.coated(film, wavelength_nm, cos, uv),
            None => mueller::pane(cos, self.index.eval(wavelength_nm)),
        };
        if reflects { pane.reflection } else { pane.transmission }
    }

    /// The probability of reflection at a wavelength.
    pub(super) fn reflection_probability(
        &self,
        wavelength_nm: f64,
        (n, uv): (Vec3<f64>, [f64; 2]),
        wo: Vec3<f64>,
    ) -> f64 {
        let cos = n.dot(wo).abs().min(1.0);
        let Some(film) = &self.film else { return mueller::pane(cos, self.reference).reflectance };
        let pane = self.coated(film, wavelength_nm, cos, uv);
        PowerShares { reflected: pane.reflectance, transmitted: pane.transmittance }.reflection_probability()
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        (n, uv): (Vec3<f64>, [f64; 2]),
        wo: Vec3<f64>,
        u: f64,
    ) -> Option<BsdfSample<N>> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos = n.dot(wo).abs().min(1.0);
        if let Some(film) = &self.film {
            let shares = lambda_nm.0.map(|nm| {
                let pane = self.coated(film, nm, cos, uv);
                PowerShares { reflected: pane.reflectance, transmitted: pane.transmittance }
            });
            let reflects = u < shares[0].reflection_probability();
            let (weight, lane_density) = chosen(&shares, reflects);
            let wi = if reflects { wo.reflected_about(n).renormalized() } else { -wo };
            return Some(BsdfSample { wi, weight, density: Density::Delta, lane_density, eta: 1.0 });
        }
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
