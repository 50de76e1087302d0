//! Refractive indices of dielectrics and metals, relative to vacuum.
//!
//! Named media carry published data, which were measured in air; the surrounding medium of index 1 stands for it.

mod complex;
mod glasses;
mod refractive;

pub use complex::ComplexIndex;
pub use refractive::{Cauchy, RefractiveIndex, Sellmeier, SellmeierTerm, reference_nm};

use crate::error::OpticsError;

/// What holds at wavelengths that published data do not cover.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutsideFit {
    /// Nothing is known there: `check_range` fails, and a value asked for all the same is NaN.
    #[default]
    Error,
    /// The value at the nearer end of the range, as a stated approximation.
    Clamp,
}

/// The wavelengths for which data were fitted or measured, and what holds outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    pub(crate) range_nm: [f64; 2],
    pub(crate) outside: OutsideFit,
}

impl Fit {
    pub(crate) fn new(range_nm: [f64; 2]) -> Result<Self, OpticsError> {
        check_order(range_nm)?;
        Ok(Self { range_nm, outside: OutsideFit::Error })
    }

    /// The wavelength to evaluate at; NaN where nothing is known.
    #[inline]
    pub(crate) fn admit(&self, wavelength_nm: f64) -> f64 {
        let [first, last] = self.range_nm;
        if wavelength_nm >= first && wavelength_nm <= last {
            wavelength_nm
        } else {
            match self.outside {
                OutsideFit::Error => f64::NAN,
                OutsideFit::Clamp => wavelength_nm.clamp(first, last),
            }
        }
    }

    pub(crate) fn check(&self, what: impl FnOnce() -> String, range_nm: [f64; 2]) -> Result<(), OpticsError> {
        check_order(range_nm)?;
        let covered = self.range_nm[0] <= range_nm[0] && range_nm[1] <= self.range_nm[1];
        if covered || self.outside == OutsideFit::Clamp {
            Ok(())
        } else {
            Err(OpticsError::OutsideFit { what: what(), fit_nm: self.range_nm, range_nm })
        }
    }
}

/// Checks that a range starts above 0 and does not end before it starts.
pub(crate) fn check_order(range_nm: [f64; 2]) -> Result<(), OpticsError> {
    for bound in range_nm {
        crate::error::positive("a bound of a wavelength range (nm)", bound)?;
    }
    if range_nm[0] > range_nm[1] { Err(OpticsError::EmptyRange { range_nm }) } else { Ok(()) }
}

/// Compares names the way people write them: case does not matter, and a space or underscore is a hyphen.
pub(crate) fn same_name(a: &str, b: &str) -> bool {
    let key = |c: char| if c == ' ' || c == '_' { '-' } else { c.to_ascii_lowercase() };
    a.chars().map(key).eq(b.chars().map(key))
}
