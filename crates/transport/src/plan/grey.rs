//! Scenes in which one number stands for all wavelengths: every surface is grey, and all light has one spectrum.
//!
//! Radiance anywhere is then that spectrum times a number, which one lane finds; and the film's colour is the spectrum's
//! own, known before any path is traced. No colour noise is left.

use super::evidence::sources;
use etalon_optics::Spectrum;
use etalon_optics::colour::{cie_y_integral_nm, colour_matching};
use etalon_optics::spectrum::{simpson, whole_nm};
use etalon_scene::Scene;

/// What the one lane means for the film.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OneLaneFilm {
    /// The wavelength at which paths are traced, nm: where the light is strongest.
    pub wavelength_nm: f64,
    /// CIE XYZ of the spectrum of all light, over its value at that wavelength.
    pub xyz_of_unit: [f64; 3],
    /// The spectrum of all light, and its value at that wavelength.
    shape: Spectrum,
    value: f64,
}

impl OneLaneFilm {
    /// Of a scene whose light all has the spectrum of its first lamp.
    pub(crate) fn new(scene: &Scene) -> Self {
        let range_nm = scene.integrator.wavelength_range_nm;
        let sources = sources(scene);
        // Where nothing shines the picture is black, whatever the shape.
        let shape = sources.first().map_or(&Spectrum::ONE, |(_, spectrum)| *spectrum);
        let mut strongest = (range_nm[0], 0.0);
        for nm in whole_nm(range_nm).chain(shape.kinks_nm(range_nm)) {
            let value = shape.eval(nm);
            if value > strongest.1 {
                strongest = (nm, value);
            }
        }
        let (wavelength_nm, value) = strongest;
        let unit = if value > 0.0 { xyz_over(shape, range_nm).map(|v| v / value) } else { [0.0; 3] };
        Self { wavelength_nm, xyz_of_unit: unit, shape: shape.clone(), value }
    }

    /// Mean over a range of wavelengths, nm, of the spectrum of all light over its value at the lane's wavelength. Exact where
    /// the spectrum is linear between its rows and whole nanometres; see [`xyz_over`].
    pub(crate) fn mean_of_unit(&self, range_nm: [f64; 2]) -> f64 {
        if self.value == 0.0 {
            return 0.0;
        }
        integral(&self.shape, range_nm, 1.0, |_| [1.0])[0] / (range_nm[1] - range_nm[0]) / self.value
    }
}

/// Whether two spectra are multiples of each other within a range.
///
/// Compared at whole nanometres and at the rows of both tables: between them, tables are linear, and two spectra of
/// another kind that agree at hundreds of points are the same. The tolerance is the rounding of the spectra's own formulas.
pub(super) fn same_shape(a: &Spectrum, b: &Spectrum, range_nm: [f64; 2]) -> bool {
    const ROUNDING: f64 = 1e-12;
    let largest = |s: &Spectrum| whole_nm(range_nm).map(|nm| s.eval(nm)).fold(0.0, f64::max);
    let (largest_a, largest_b) = (largest(a), largest(b));
    if largest_a == 0.0 || largest_b == 0.0 {
        return largest_a == largest_b;
    }
    whole_nm(range_nm)
        .chain(a.kinks_nm(range_nm))
        .chain(b.kinks_nm(range_nm))
        .all(|nm| (a.eval(nm) / largest_a - b.eval(nm) / largest_b).abs() <= ROUNDING)
}

/// ∫ S·(x̄, ȳ, z̄) dλ over the range, divided by ∫ȳ: exact where the spectrum is linear between its rows and whole
/// nanometres, since the product is then quadratic and Simpson's rule has no error; elsewhere better than 1e-9, since no
/// spectrum curves within a nanometre.
pub(super) fn xyz_over(spectrum: &Spectrum, range_nm: [f64; 2]) -> [f64; 3] {
    integral(spectrum, range_nm, cie_y_integral_nm(), colour_matching)
}

/// ∫ S·w dλ over a range, divided by `unit`.
fn integral<const N: usize>(
    spectrum: &Spectrum,
    range_nm: [f64; 2],
    unit: f64,
    weights: impl Fn(f64) -> [f64; N],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for (nm, weight) in simpson(whole_nm(range_nm).chain(spectrum.kinks_nm(range_nm))) {
        let value = weight * spectrum.eval(nm) / unit;
        let weights = weights(nm);
        (0..N).for_each(|c| sum[c] += value * weights[c]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wavelength::WavelengthDistribution;
    use etalon_optics::spectrum::Outside;
    use etalon_optics::{Illuminant, Lanes};

    fn samples() -> Vec<Spectrum> {
        vec![
            Spectrum::Constant(0.3),
            Spectrum::blackbody(5000.0, 2.0).unwrap(),
            Spectrum::illuminant(Illuminant::D65, 1.5).unwrap(),
            Spectrum::rgb_emission([0.8, 0.1, 0.2], Illuminant::D65).unwrap(),
            Spectrum::tabulated(vec![400.0, 500.5, 600.25], vec![0.1, 0.9, 0.2], Outside::Zero).unwrap(),
        ]
    }

    #[test]
    fn multiples_of_a_spectrum_have_its_shape_and_others_do_not() {
        let range = [380.0, 780.0];
        for (i, a) in samples().iter().enumerate() {
            for (j, b) in samples().iter().enumerate() {
                assert_eq!(same_shape(&a.clone().scaled(7.3).unwrap(), b, range), i == j, "{i} {j}");
            }
        }
        let blackbody = |t| Spectrum::blackbody(t, 1.0).unwrap();
        assert!(!same_shape(&blackbody(5000.0), &blackbody(5001.0), range));
        // A line between the whole nanometres is seen by its row.
        let line = Spectrum::tabulated(vec![500.2, 500.5, 500.8], vec![0.0, 1.0, 0.0], Outside::Zero).unwrap();
        let flat = Spectrum::Constant(1.0);
        assert!(!same_shape(&line, &flat, range));
    }

    /// The integral against the estimator that the other kernels use, over a fine comb of its own number: the midpoint rule
    /// errs by about one part in the number of points at each of the few hundred jumps of the density.
    #[test]
    fn the_colour_of_a_spectrum_is_what_sampled_wavelengths_converge_to() {
        for range in [[360.0, 830.0], [380.5, 720.25]] {
            let distribution = WavelengthDistribution::new(range);
            for spectrum in samples() {
                let exact = xyz_over(&spectrum, range);
                let n = 400_000;
                let mut mean = [0.0; 3];
                for i in 0..n {
                    let w = distribution.sample_lanes::<4>((f64::from(i) + 0.5) / f64::from(n));
                    let radiance = Lanes::<f64, 4>::from_fn(|lane| spectrum.eval(w.lambda_nm[lane]));
                    let xyz = distribution.to_xyz(&w, radiance);
                    (0..3).for_each(|c| mean[c] += xyz[c] / f64::from(n));
                }
                for c in 0..3 {
                    assert!((mean[c] - exact[c]).abs() <= 2e-5 * exact[1], "{spectrum:?}: {mean:?} is not {exact:?}");
                }
            }
        }
    }
}
