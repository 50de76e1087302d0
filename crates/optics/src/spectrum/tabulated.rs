//! Tabulated spectra.

use crate::error::{OpticsError, increasing, non_negative};
use crate::table::{lerp, locate};

/// What a table says about wavelengths outside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// Zero.
    Zero,
    /// The value at the nearer end.
    Hold,
}

/// Values at increasing wavelengths, interpolated linearly.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    wavelengths_nm: Vec<f64>,
    values: Vec<f64>,
    outside: Outside,
}

impl Tabulated {
    /// A table of at least two values, finite and not negative, at increasing wavelengths in nm.
    ///
    /// Fails if anything of that does not hold.
    pub fn new(wavelengths_nm: Vec<f64>, values: Vec<f64>, outside: Outside) -> Result<Self, OpticsError> {
        increasing("a tabulated spectrum", &wavelengths_nm, &[values.len()])?;
        for &v in &values {
            non_negative("a tabulated value", v)?;
        }
        Ok(Self { wavelengths_nm, values, outside })
    }

    /// The wavelengths, nm.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// The values.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The first and the last wavelength, nm.
    pub fn range_nm(&self) -> [f64; 2] {
        [self.wavelengths_nm[0], self.wavelengths_nm[self.wavelengths_nm.len() - 1]]
    }

    /// What holds outside [`Tabulated::range_nm`].
    pub fn outside(&self) -> Outside {
        self.outside
    }

    /// Value at a wavelength in nm.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        match locate(&self.wavelengths_nm, wavelength_nm) {
            Some((i, t)) => lerp(self.values[i], self.values[i + 1], t),
            None => match self.outside {
                Outside::Zero => 0.0,
                Outside::Hold if wavelength_nm < self.wavelengths_nm[0] => self.values[0],
                Outside::Hold => self.values[self.values.len() - 1],
            },
        }
    }

    pub(super) fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        let inside =
            self.wavelengths_nm.iter().zip(&self.values).filter(|(w, _)| (range_nm[0]..=range_nm[1]).contains(w));
        let ends = self.eval(range_nm[0]).max(self.eval(range_nm[1]));
        inside.map(|(_, &v)| v).fold(ends, f64::max)
    }

    pub(super) fn is_constant(&self) -> bool {
        let flat = self.values.iter().all(|&v| v == self.values[0]);
        flat && (self.outside == Outside::Hold || self.values[0] == 0.0)
    }
}
