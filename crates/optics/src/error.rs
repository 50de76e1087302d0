//! What can be wrong with the numbers that describe an optical property.

/// Why a spectrum or an index of refraction was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OpticsError {
    /// NaN or infinite.
    #[error("{what} must be a finite number, not {value}")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Below zero where only zero and above make sense.
    #[error("{what} must not be negative, but is {value}")]
    Negative {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Zero or below where only positive numbers make sense.
    #[error("{what} must be above 0, but is {value}")]
    NotPositive {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// An index of refraction beyond what Fresnel's equations can be computed with.
    #[error("{what} of {value:e} is outside the possible range ({0:e} to {1:e})", INDEX_RANGE[0], INDEX_RANGE[1])]
    Extreme {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Above one where a share is meant.
    #[error("{what} must be at most 1, but is {value}")]
    AboveOne {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A table with too few rows.
    #[error("{what} needs at least {needed} entries, but has {found}")]
    TooShort {
        /// The table.
        what: &'static str,
        /// Fewest rows that make sense.
        needed: usize,
        /// Rows found.
        found: usize,
    },
    /// Columns of different length.
    #[error("{what} has {wavelengths} wavelengths but {values} values")]
    LengthMismatch {
        /// The table.
        what: &'static str,
        /// Number of wavelengths.
        wavelengths: usize,
        /// Number of values.
        values: usize,
    },
    /// Wavelengths that do not increase.
    #[error("wavelengths must increase, but entry {index} ({wavelength_nm} nm) follows {previous_nm} nm")]
    Unsorted {
        /// The offending entry, from 0.
        index: usize,
        /// Its wavelength, nm.
        wavelength_nm: f64,
        /// The wavelength before it, nm.
        previous_nm: f64,
    },
    /// A wavelength range that is empty or reversed.
    #[error("the wavelength range [{0}, {1}] nm is empty", range_nm[0], range_nm[1])]
    EmptyRange {
        /// The range, nm.
        range_nm: [f64; 2],
    },
    /// Wavelengths for which the data say nothing.
    #[error(
        "{what} is known from {0} to {1} nm only, which does not cover [{2}, {3}] nm",
        fit_nm[0], fit_nm[1], range_nm[0], range_nm[1]
    )]
    OutsideFit {
        /// The data.
        what: String,
        /// Range that the data cover, nm.
        fit_nm: [f64; 2],
        /// Range asked for, nm.
        range_nm: [f64; 2],
    },
    /// A dispersion formula without a positive real index.
    #[error("the formula gives no positive real index of refraction at {wavelength_nm} nm")]
    NoRealIndex {
        /// The wavelength, nm.
        wavelength_nm: f64,
    },
    /// A colour that no spectrum of the family can show.
    #[error("no smooth reflectance has the colour [{0}, {1}, {2}] under {white}", rgb[0], rgb[1], rgb[2])]
    UnreachableColour {
        /// Linear Rec. 709.
        rgb: [f64; 3],
        /// The white asked for.
        white: &'static str,
    },
}

/// Smallest and largest index of refraction. The square of the ratio of two of them is still a finite number, and so is its
/// inverse.
pub const INDEX_RANGE: [f64; 2] = [1e-50, 1e50];

/// `value` if it can be an index of refraction.
pub(crate) fn index(what: &'static str, value: f64) -> Result<f64, OpticsError> {
    let [least, most] = INDEX_RANGE;
    let value = positive(what, value)?;
    if (least..=most).contains(&value) { Ok(value) } else { Err(OpticsError::Extreme { what, value }) }
}

/// `value` if it is finite.
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, OpticsError> {
    if value.is_finite() { Ok(value) } else { Err(OpticsError::NotFinite { what, value }) }
}

/// `value` if it is finite and not negative.
pub(crate) fn non_negative(what: &'static str, value: f64) -> Result<f64, OpticsError> {
    if finite(what, value)? < 0.0 { Err(OpticsError::Negative { what, value }) } else { Ok(value) }
}

/// `value` if it is finite and above zero.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, OpticsError> {
    if finite(what, value)? <= 0.0 { Err(OpticsError::NotPositive { what, value }) } else { Ok(value) }
}

/// Checks that a table's wavelengths are positive, finite and increasing, and that every column is as long.
pub(crate) fn increasing(what: &'static str, wavelengths_nm: &[f64], columns: &[usize]) -> Result<(), OpticsError> {
    for &values in columns {
        if values != wavelengths_nm.len() {
            return Err(OpticsError::LengthMismatch { what, wavelengths: wavelengths_nm.len(), values });
        }
    }
    if wavelengths_nm.len() < 2 {
        return Err(OpticsError::TooShort { what, needed: 2, found: wavelengths_nm.len() });
    }
    for &w in wavelengths_nm {
        positive("a wavelength (nm)", w)?;
    }
    match wavelengths_nm.windows(2).position(|w| w[0] >= w[1]) {
        None => Ok(()),
        Some(i) => Err(OpticsError::Unsorted {
            index: i + 1,
            wavelength_nm: wavelengths_nm[i + 1],
            previous_nm: wavelengths_nm[i],
        }),
    }
}
