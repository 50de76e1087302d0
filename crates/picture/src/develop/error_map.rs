//! The standard error of each pixel.

use super::band::SpectralBand;
use super::colour::{luminance_weights, rgb_pixels};
use crate::{ERROR_PREFIX, ExrFile, PictureError};

/// Whether an error is told as it is, or as a share of its pixel's value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorKind {
    /// The error over the value. 0 where both are 0.
    #[default]
    Relative,
    /// The error, in the unit of the value.
    Absolute,
}

impl ErrorKind {
    /// The number that the map shows for an error of a value.
    ///
    /// ```
    /// use etalon_picture::develop::ErrorKind;
    ///
    /// assert_eq!(ErrorKind::Relative.of(0.1, 2.0), 0.05);
    /// assert_eq!(ErrorKind::Absolute.of(0.1, 2.0), 0.1);
    /// assert_eq!(ErrorKind::Relative.of(0.0, 0.0), 0.0);
    /// ```
    #[must_use]
    pub fn of(self, error: f64, value: f64) -> f64 {
        match self {
            Self::Absolute => error,
            Self::Relative if error == 0.0 && value == 0.0 => 0.0,
            Self::Relative => error / value.abs(),
        }
    }
}

/// The standard errors of the luminance Y, pixel by pixel, from the channels `Error.R`, `Error.G` and `Error.B`: w·σ with the weights w of R, G
/// and B in Y.
///
/// The file does not hold how the errors of R, G and B go together. This sum is exact if they rise and fall together, as the noise of grey
/// light does, and else an upper bound.
///
/// # Errors
/// A file without these channels.
///
/// ```
/// use etalon_picture::develop::luminance_errors;
/// use etalon_picture::{Attributes, ExrFile, Picture};
///
/// let mut picture = Picture::new(1, 1)?;
/// for name in ["Error.R", "Error.G", "Error.B"] {
///     picture.insert(name, vec![0.25])?;
/// }
/// let errors = luminance_errors(&ExrFile { picture, attributes: Attributes::new() })?;
/// assert!((errors[0] - 0.25).abs() < 1e-15);
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
pub fn luminance_errors(file: &ExrFile) -> Result<Vec<f64>, PictureError> {
    let weights = luminance_weights(&file.attributes)?;
    let names = ["R", "G", "B"].map(|name| format!("{ERROR_PREFIX}{name}"));
    let [Some(r), Some(g), Some(b)] = names.each_ref().map(|name| file.picture.channel(name)) else {
        return Err(no_errors("R"));
    };
    let error = |i: usize| {
        let errors = [r[i], g[i], b[i]].map(f64::from);
        errors.iter().zip(weights).map(|(error, weight)| error * weight.abs()).sum()
    };
    Ok((0..r.len()).map(error).collect())
}

/// The standard errors of a band, pixel by pixel.
pub(crate) fn band_errors<'a>(file: &'a ExrFile, band: &SpectralBand<'_>) -> Result<&'a [f32], PictureError> {
    file.picture.channel(&format!("{ERROR_PREFIX}{}", band.channel)).ok_or_else(|| no_errors(band.channel))
}

fn no_errors(channel: &str) -> PictureError {
    PictureError::develop(format!(
        "the file has no channel `{ERROR_PREFIX}{channel}`: the error of its pixels is not known (render with at least two replicates)"
    ))
}

/// The luminance Y, pixel by pixel, of a picture in linear Rec. 709.
pub(crate) fn luminances(picture: &crate::Picture<f32>) -> Result<Vec<f64>, PictureError> {
    Ok(rgb_pixels(picture)?.map(super::colour::luminance).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Attributes, Picture};

    #[test]
    fn errors_count_by_the_weights_of_the_luminance() {
        let mut picture = Picture::new(2, 1).unwrap();
        for (name, errors) in [("Error.R", [1.0, 0.0]), ("Error.G", [0.0, f32::INFINITY]), ("Error.B", [2.0, 0.0])] {
            picture.insert(name, errors.to_vec()).unwrap();
        }
        let mut file = ExrFile { picture, attributes: Attributes::new() };
        let errors = luminance_errors(&file).unwrap();
        assert!((errors[0] - (0.2126 + 2.0 * 0.0722)).abs() < 2e-4, "{errors:?}");
        assert_eq!(errors[1], f64::INFINITY);
        file.picture = Picture::new(2, 1).unwrap();
        assert!(luminance_errors(&file).unwrap_err().to_string().contains("`Error.R`"));
    }

    #[test]
    fn a_relative_error_of_nothing_is_not_finite() {
        assert_eq!(ErrorKind::Relative.of(0.1, 0.0), f64::INFINITY);
        assert_eq!(ErrorKind::Relative.of(0.1, -0.2), 0.5);
        assert!(ErrorKind::Relative.of(f64::NAN, 1.0).is_nan());
    }
}
