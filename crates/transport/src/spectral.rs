//! Spectra as paths meet them: tabulated once, so that no path calls the platform's mathematics library.

use etalon_optics::spectrum::Outside;
use etalon_optics::{Lanes, Real, Spectrum};

/// A spectrum prepared for paths.
#[derive(Clone, Debug)]
pub enum PathSpectrum {
    /// The same value at every wavelength.
    Constant(f64),
    /// Values at each nanometre from `first_nm`, interpolated linearly.
    ///
    /// Exact for tables whose wavelengths are whole nanometres. For Planck's law and lights of an RGB colour the
    /// interpolation errs by |S″|/8 nm², below 1e-5 of the largest value for anything as wide as 100 nm.
    Grid {
        /// Wavelength of the first value, nm.
        first_nm: f64,
        /// The values; one more than there are steps.
        values: Vec<f64>,
    },
    /// A spectrum that may have detail between the nanometres and needs no mathematics library, evaluated as it is.
    Symbolic(Spectrum),
}

impl PathSpectrum {
    /// Prepares a spectrum for wavelengths within `range_nm`.
    pub fn new(spectrum: &Spectrum, range_nm: [f64; 2]) -> Self {
        if spectrum.is_constant() {
            return Self::Constant(spectrum.eval(range_nm[0]));
        }
        if !is_grid_exact(spectrum) {
            return Self::Symbolic(spectrum.clone());
        }
        let (first, last) = (range_nm[0].floor(), range_nm[1].floor() + 1.0);
        let steps = (last - first) as usize;
        let values = (0..=steps).map(|i| spectrum.eval(first + i as f64)).collect();
        Self::Grid { first_nm: first, values }
    }

    /// Tabulates a smooth function of the wavelength (nm) at each nanometre of `range_nm`.
    pub fn tabulate(range_nm: [f64; 2], value: impl Fn(f64) -> f64) -> Self {
        let (first, last) = (range_nm[0].floor(), range_nm[1].floor() + 1.0);
        // Beyond the range, where nothing may be known, the value at its end.
        let at = |nm: f64| value(nm.clamp(range_nm[0], range_nm[1]));
        let values: Vec<f64> = (0..=(last - first) as usize).map(|i| at(first + i as f64)).collect();
        if values.iter().all(|v| *v == values[0]) {
            return Self::Constant(values[0]);
        }
        Self::Grid { first_nm: first, values }
    }

    /// Value at a wavelength within the range, nm.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Grid { first_nm, values } => {
                let x = wavelength_nm - first_nm;
                let i = x as usize;
                values[i] + (x - i as f64) * (values[i + 1] - values[i])
            }
            Self::Symbolic(spectrum) => spectrum.eval(wavelength_nm),
        }
    }

    /// Values in every lane.
    #[inline]
    pub fn lanes<R: Real, const N: usize>(&self, lambda_nm: &Lanes<f64, N>) -> Lanes<R, N> {
        match self {
            Self::Constant(value) => Lanes::splat(R::from_f64(*value)),
            Self::Grid { .. } | Self::Symbolic(_) => Lanes::from_fn(|lane| R::from_f64(self.eval(lambda_nm[lane]))),
        }
    }
}

/// Whether a grid of whole nanometres shows all that a spectrum has to show.
fn is_grid_exact(spectrum: &Spectrum) -> bool {
    match spectrum {
        Spectrum::Tabulated(table) => {
            let whole = |nm: &f64| nm.fract() == 0.0;
            let values = table.values();
            // A table that is zero outside jumps at its ends, unless it ends at zero.
            let jumps = table.outside() == Outside::Zero && (values[0] > 0.0 || values[values.len() - 1] > 0.0);
            table.wavelengths_nm().iter().all(whole) && !jumps
        }
        Spectrum::Scaled { spectrum, .. } => is_grid_exact(spectrum),
        // As steep as its colour is saturated.
        Spectrum::RgbReflectance(_) => false,
        Spectrum::Constant(_) | Spectrum::Blackbody(_) | Spectrum::Illuminant(_) | Spectrum::RgbEmission(_) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_optics::Illuminant;

    #[test]
    fn prepared_spectra_equal_the_symbolic_ones() {
        let spectra = [
            Spectrum::Constant(0.3),
            Spectrum::blackbody(5000.0, 1.0).unwrap(),
            Spectrum::illuminant(Illuminant::D65, 1.0).unwrap(),
            Spectrum::rgb_reflectance([0.8, 0.1, 0.2]).unwrap(),
            Spectrum::tabulated(vec![400.0, 500.5, 600.0], vec![0.1, 0.9, 0.2], Outside::Hold).unwrap(),
            Spectrum::tabulated(vec![400.0, 500.0, 700.0], vec![0.0, 8.0, 18.4], Outside::Zero).unwrap(),
        ];
        for spectrum in spectra {
            let prepared = PathSpectrum::new(&spectrum, [360.0, 830.0]);
            let largest = spectrum.max_over([360.0, 830.0]);
            for i in 0..=4700 {
                let nm = 360.0 + f64::from(i) * 0.1;
                let (a, b) = (prepared.eval(nm), spectrum.eval(nm));
                assert!((a - b).abs() <= 1e-5 * largest, "{spectrum:?} at {nm}: {a} is not {b}");
            }
        }
    }
}
