//! Spectra as paths meet them: tabulated once, so that no path calls the platform's mathematics library.

use crate::wavelength::cells::CellTable;
use etalon_optics::colour::daylight_components;
use etalon_optics::spectrum::Outside;
use etalon_optics::{Lanes, Spectrum};

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
        /// The value at each nanometre, and how much larger the next is.
        steps: Vec<[f64; 2]>,
    },
    /// The same, and zero outside these wavelengths: a table that ends with a jump.
    Band {
        /// Wavelength of the first value, nm.
        first_nm: f64,
        /// The value at each nanometre, and how much larger the next is.
        steps: Vec<[f64; 2]>,
        /// The first and the last wavelength at which it is not zero, nm.
        band_nm: [f64; 2],
    },
    /// A spectrum that may have detail between the nanometres and needs no mathematics library, evaluated as it is.
    Symbolic(Spectrum),
}

/// What a light's spectrum is multiplied by at each wavelength, where it is not the same in all directions or at all places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Colour {
    /// Shares of red, green and blue, of an image.
    Rgb([f64; 3]),
    /// Daylight of the weights M₁ and M₂ of its components, over the first component: 1 + (M₁S₁ + M₂S₂)/S₀.
    Daylight([f64; 2]),
}

/// Daylight of these weights over its first component, in every lane.
pub(crate) fn daylight<const N: usize>([m1, m2]: [f64; 2], lambda_nm: &Lanes<f64, N>) -> Lanes<f64, N> {
    Lanes::from_fn(|lane| {
        let [s0, s1, s2] = daylight_components(lambda_nm[lane]);
        1.0 + (m1 * s1 + m2 * s2) / s0
    })
}

impl PathSpectrum {
    /// Prepares a spectrum for wavelengths within `range_nm`.
    pub fn new(spectrum: &Spectrum, range_nm: [f64; 2]) -> Self {
        if spectrum.is_constant() {
            return Self::Constant(spectrum.eval(range_nm[0]));
        }
        let (first_nm, last_nm) = (range_nm[0].floor(), range_nm[1].floor() + 1.0);
        let count = (last_nm - first_nm) as usize;
        let at = |i: usize| first_nm + i as f64;
        match detail(spectrum) {
            Detail::OnGrid => {
                let values: Vec<f64> = (0..=count).map(|i| spectrum.eval(at(i))).collect();
                Self::Grid { first_nm, steps: steps(&values) }
            }
            Detail::OnGridWithin([from, to]) => {
                // Held beyond the band, so that no interpolation within it sees the zero outside.
                let values: Vec<f64> = (0..=count).map(|i| spectrum.eval(at(i).clamp(from, to))).collect();
                Self::Band { first_nm, steps: steps(&values), band_nm: [from, to] }
            }
            Detail::Between => Self::Symbolic(spectrum.clone()),
        }
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
        Self::Grid { first_nm: first, steps: steps(&values) }
    }

    /// Whether it is known to be the same spectrum as another, bit for bit.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a.to_bits() == b.to_bits(),
            (Self::Grid { first_nm: a, steps: s }, Self::Grid { first_nm: b, steps: t }) => a == b && s == t,
            (Self::Band { first_nm: a, steps: s, band_nm: c }, Self::Band { first_nm: b, steps: t, band_nm: d }) => {
                (a, c) == (b, d) && s == t
            }
            (Self::Symbolic(a), Self::Symbolic(b)) => a == b,
            _ => false,
        }
    }

    /// Value at a wavelength within the range, nm.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Grid { first_nm, steps } => interpolate(*first_nm, steps, wavelength_nm),
            Self::Band { first_nm, steps, band_nm: [from, to] } => {
                let inside = (*from..=*to).contains(&wavelength_nm);
                if inside { interpolate(*first_nm, steps, wavelength_nm) } else { 0.0 }
            }
            Self::Symbolic(spectrum) => spectrum.eval(wavelength_nm),
        }
    }

    /// Its values by cells of wavelengths, each of which lies within the nanometre that begins at one of `whole_nm`: at the
    /// beginning of the nanometre, and how much larger it is at its end. `None` if it is not linear there.
    pub(crate) fn by_cells(&self, whole_nm: &[f64]) -> Option<CellTable> {
        let (first_nm, steps, [from, to]) = match self {
            Self::Grid { first_nm, steps } => (first_nm, steps, [f64::NEG_INFINITY, f64::INFINITY]),
            Self::Band { first_nm, steps, band_nm } => (first_nm, steps, *band_nm),
            Self::Constant(_) | Self::Symbolic(_) => return None,
        };
        Some(CellTable::new(whole_nm.len() as u32, |cell| {
            let nm = whole_nm[cell as usize];
            // Bands end at whole nanometres, where no wavelength is drawn.
            if from <= nm && nm + 1.0 <= to { steps[(nm - first_nm) as usize] } else { [0.0; 2] }
        }))
    }

    /// Values in every lane.
    #[inline]
    pub fn lanes<const N: usize>(&self, lambda_nm: &Lanes<f64, N>) -> Lanes<f64, N> {
        match self {
            Self::Constant(value) => Lanes::splat(*value),
            Self::Grid { first_nm, steps } => Lanes::from_fn(|lane| interpolate(*first_nm, steps, lambda_nm[lane])),
            // All lanes at once: imported scenes have most of their colours as RGB.
            Self::Symbolic(Spectrum::RgbReflectance(colour)) => colour.lanes(lambda_nm),
            Self::Band { .. } | Self::Symbolic(_) => Lanes::from_fn(|lane| self.eval(lambda_nm[lane])),
        }
    }
}

/// Each value but the last, and how much larger the next is.
fn steps(values: &[f64]) -> Vec<[f64; 2]> {
    values.windows(2).map(|pair| [pair[0], pair[1] - pair[0]]).collect()
}

/// The value between two of those at each nanometre from `first_nm`.
#[inline(always)]
fn interpolate(first_nm: f64, steps: &[[f64; 2]], wavelength_nm: f64) -> f64 {
    let x = wavelength_nm - first_nm;
    // A narrow integer: its conversions are single instructions.
    let i = x as u32;
    let [value, step] = steps[i as usize];
    value + (x - f64::from(i)) * step
}

/// Where a spectrum has to be looked at.
enum Detail {
    /// A grid of whole nanometres shows all that there is to show.
    OnGrid,
    /// The same between two of these; outside it is zero.
    OnGridWithin([f64; 2]),
    /// There may be more between them.
    Between,
}

fn detail(spectrum: &Spectrum) -> Detail {
    match spectrum {
        Spectrum::Tabulated(table) => {
            let whole = |nm: &f64| nm.fract() == 0.0;
            let values = table.values();
            // A table that is zero outside jumps at its ends, unless it ends at zero.
            let jumps = table.outside() == Outside::Zero && (values[0] > 0.0 || values[values.len() - 1] > 0.0);
            match table.wavelengths_nm().iter().all(whole) {
                true if jumps => Detail::OnGridWithin(table.range_nm()),
                true => Detail::OnGrid,
                false => Detail::Between,
            }
        }
        Spectrum::Scaled { spectrum, .. } => detail(spectrum),
        // As steep as its colour is saturated.
        Spectrum::RgbReflectance(_) => Detail::Between,
        Spectrum::Constant(_) | Spectrum::Blackbody(_) | Spectrum::Illuminant(_) | Spectrum::RgbEmission(_) => {
            Detail::OnGrid
        }
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
            Spectrum::tabulated(vec![500.0, 501.0, 600.0], vec![3.0, 8.0, 2.0], Outside::Zero).unwrap(),
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

    #[test]
    fn a_smooth_function_is_interpolated_up_to_ends_that_are_no_whole_nanometres() {
        let range = [400.25, 410.75];
        let prepared = PathSpectrum::tabulate(range, |nm| 0.5 * nm - 100.0);
        for nm in [401.0, 401.5, 405.125, 409.0, 410.0] {
            assert!((prepared.eval(nm) - (0.5 * nm - 100.0)).abs() < 1e-9, "{nm}: {}", prepared.eval(nm));
        }
        // Nothing is known beyond the ends: the last steps lead to the values there, and go half as far, or a quarter more.
        let ends = [(400.25, 0.25 * 0.375), (400.5, 0.5 * 0.375), (410.75, 0.75 * 0.375)];
        for (nm, since) in ends {
            let start = if nm < 405.0 { 0.5 * 400.25 - 100.0 } else { 105.0 };
            assert!((prepared.eval(nm) - start - since).abs() < 1e-9, "{nm}: {}", prepared.eval(nm));
        }
    }
}
