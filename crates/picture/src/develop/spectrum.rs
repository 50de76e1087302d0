//! The spectrum of a pixel or of a region.

use super::Rect;
use super::band::{bands_of, no_bands};
use crate::{ERROR_PREFIX, ErrorInfo, ExrFile, PictureError};

/// The mean of a band over a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandMean {
    /// The wavelength at the band's centre, nm.
    pub centre_nm: f64,
    /// The mean over the finite pixels, in the unit of the file: W·m⁻²·sr⁻¹·nm⁻¹ in ours. NaN if there is none.
    pub mean: f64,
    /// The standard error of the mean; infinite where that of a pixel is, `None` in a file without errors.
    pub error: Option<f64>,
    /// Pixels that are left out because their value is not finite.
    pub left_out: usize,
}

/// The means of all bands over a region, by increasing wavelength, with their standard errors.
///
/// The error of a mean of n pixels with the errors σᵢ is √(c · Σ σᵢ²) / n, where c is the largest number of pixels whose errors have a part in
/// common (the attribute `correlatedPixels`, 1 if pixels are independent), at most n. For c > 1 this is an upper bound.
///
/// # Errors
/// A file without bands, a region that is not within the picture.
///
/// ```
/// use etalon_picture::develop::{Rect, spectrum_of};
/// use etalon_picture::{Attributes, ExrFile, Picture};
///
/// let mut picture = Picture::new(2, 1)?;
/// picture.insert("S0.550,000000nm", vec![1.0, 2.0])?;
/// picture.insert("Error.S0.550,000000nm", vec![0.3, 0.4])?;
/// let file = ExrFile { picture, attributes: Attributes::new() };
/// let [band] = spectrum_of(&file, Rect { x: 0, y: 0, width: 2, height: 1 })?[..] else { panic!() };
/// assert_eq!((band.centre_nm, band.mean), (550.0, 1.5));
/// assert!((band.error.unwrap() - 0.25).abs() < 1e-7);
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
pub fn spectrum_of(file: &ExrFile, region: Rect) -> Result<Vec<BandMean>, PictureError> {
    let picture = &file.picture;
    region.check_within(picture.width(), picture.height())?;
    let correlated = ErrorInfo::from_attributes(&file.attributes).map_or(1, |info| info.correlated_pixels.max(1));
    let bands = bands_of(picture);
    if bands.is_empty() {
        return Err(no_bands());
    }
    let mean_of = |band: &super::SpectralBand<'_>| {
        let errors = picture.channel(&format!("{ERROR_PREFIX}{}", band.channel));
        let (mut count, mut sum, mut squares, mut left_out) = (0_usize, 0.0, 0.0, 0);
        for i in region.indices(picture.width()) {
            let value = f64::from(band.samples[i]);
            if !value.is_finite() {
                left_out += 1;
                continue;
            }
            count += 1;
            sum += value;
            squares += errors.map_or(0.0, |errors| f64::from(errors[i]).powi(2));
        }
        let n = count as f64;
        let error = errors.map(|_| (f64::from(correlated).min(n) * squares).sqrt() / n);
        BandMean { centre_nm: band.centre_nm, mean: sum / n, error, left_out }
    };
    Ok(bands.iter().map(mean_of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Attribute, Attributes, Picture};

    fn file() -> ExrFile {
        let mut picture = Picture::new(3, 2).unwrap();
        for (nm, scale) in [(600, 2.0), (500, 1.0)] {
            let samples: Vec<f32> = (0..6).map(|i| scale * i as f32).collect();
            picture.insert(&format!("S0.{nm},000000nm"), samples).unwrap();
            picture.insert(&format!("Error.S0.{nm},000000nm"), vec![0.5 * scale; 6]).unwrap();
        }
        ExrFile { picture, attributes: Attributes::new() }
    }

    #[test]
    fn a_pixel_has_the_values_of_the_file_and_a_region_their_means() {
        let file = file();
        let pixel = spectrum_of(&file, Rect { x: 1, y: 1, width: 1, height: 1 }).unwrap();
        let told: Vec<_> = pixel.iter().map(|b| (b.centre_nm, b.mean, b.error)).collect();
        assert_eq!(told, [(500.0, 4.0, Some(0.5)), (600.0, 8.0, Some(1.0))]);
        let region = spectrum_of(&file, Rect { x: 1, y: 0, width: 2, height: 2 }).unwrap();
        // 1, 2, 4, 5; and a half of the error with four times the pixels.
        let told: Vec<_> = region.iter().map(|b| (b.mean, b.error)).collect();
        assert_eq!(told, [(3.0, Some(0.25)), (6.0, Some(0.5))]);
    }

    #[test]
    fn pixels_that_share_paths_have_a_larger_error() {
        let mut file = file();
        let info = ErrorInfo {
            replicates: 4,
            correlated_pixels: 4,
            relative_rmse: 0.1,
            interval: [0.1, 0.2],
            tail_index: None,
            noisiest_tile: None,
        };
        file.attributes = info.attributes();
        let region = spectrum_of(&file, Rect { x: 1, y: 0, width: 2, height: 2 }).unwrap();
        assert_eq!(region[0].error, Some(0.5));
        // A pixel has no other to share with.
        let pixel = spectrum_of(&file, Rect { x: 1, y: 1, width: 1, height: 1 }).unwrap();
        assert_eq!(pixel[0].error, Some(0.5));
        file.attributes.insert("correlatedPixels".to_owned(), Attribute::Int(i32::MAX));
        assert!(spectrum_of(&file, Rect { x: 0, y: 0, width: 3, height: 2 }).unwrap()[0].error.unwrap().is_finite());
    }

    #[test]
    fn what_is_not_finite_is_left_out_and_counted() {
        let mut file = file();
        let mut picture = Picture::new(3, 2).unwrap();
        for channel in file.picture.channels() {
            let mut samples = channel.samples.clone();
            if channel.name == "S0.500,000000nm" {
                samples[0] = f32::NAN;
            }
            if channel.name == "Error.S0.600,000000nm" {
                samples[1] = f32::INFINITY;
            }
            picture.insert(&channel.name, samples).unwrap();
        }
        file.picture = picture;
        let bands = spectrum_of(&file, Rect { x: 0, y: 0, width: 2, height: 1 }).unwrap();
        assert_eq!((bands[0].mean, bands[0].error, bands[0].left_out), (1.0, Some(0.5), 1));
        assert_eq!((bands[1].error, bands[1].left_out), (Some(f64::INFINITY), 0));
        let none = spectrum_of(&file, Rect { x: 0, y: 0, width: 1, height: 1 }).unwrap();
        assert!(none[0].mean.is_nan() && none[0].left_out == 1);
        assert!(spectrum_of(&file, Rect { x: 3, y: 0, width: 1, height: 1 }).is_err());
    }
}
