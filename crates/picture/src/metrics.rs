//! How far a picture is from a reference.

use crate::{Picture, PictureError, Sample};

/// The constant that keeps [`rel_mse`] finite where the reference is black: 0.1², so that below a radiance of about 0.1
/// the measure turns from relative to absolute.
pub const RELMSE_FLOOR: f64 = 0.01;

/// Distances of a picture from a reference, over all pixels and the channels compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// Root of the mean squared difference, in the picture's unit.
    pub rmse: f64,
    /// Mean of the squared difference over (reference² + [`RELMSE_FLOOR`]); no unit.
    pub rel_mse: f64,
}

/// Root mean squared difference √(mean((x − ref)²)). NaN anywhere gives NaN.
///
/// # Panics
/// If the slices differ in length or are empty: there is no such mean.
#[must_use]
pub fn rmse<T: Sample, U: Sample>(image: &[T], reference: &[U]) -> f64 {
    mean_over(image, reference, |difference, _| difference * difference).sqrt()
}

/// Relative mean squared error mean((x − ref)² / (ref² + 0.01)), the measure usual for Monte Carlo renders: a pixel's
/// error counts by its share of the pixel's value. NaN anywhere gives NaN.
///
/// # Panics
/// If the slices differ in length or are empty: there is no such mean.
#[must_use]
pub fn rel_mse<T: Sample, U: Sample>(image: &[T], reference: &[U]) -> f64 {
    mean_over(image, reference, |difference, reference| {
        difference * difference / (reference * reference + RELMSE_FLOOR)
    })
}

/// Both metrics over the named channels together.
///
/// # Errors
/// Different sizes, a channel that one of the two lacks.
pub fn compare<T: Sample, U: Sample>(
    image: &Picture<T>,
    reference: &Picture<U>,
    channels: &[&str],
) -> Result<Metrics, PictureError> {
    let size = (image.width(), image.height());
    let reference_size = (reference.width(), reference.height());
    if size != reference_size {
        return Err(PictureError::SizeMismatch { image: size, reference: reference_size });
    }
    let (mut squared, mut relative) = (0.0, 0.0);
    for name in channels {
        let (image, reference) = (image.require(name)?, reference.require(name)?);
        squared += mean_over(image, reference, |difference, _| difference * difference);
        relative += rel_mse(image, reference);
    }
    let count = channels.len() as f64;
    Ok(Metrics { rmse: (squared / count).sqrt(), rel_mse: relative / count })
}

/// The mean of `term(x − ref, ref)`. A plain f64 sum: its relative error is at most n·2⁻⁵³, 1e-8 for 10⁸ pixels.
fn mean_over<T: Sample, U: Sample>(image: &[T], reference: &[U], term: impl Fn(f64, f64) -> f64) -> f64 {
    assert_eq!(image.len(), reference.len(), "only pictures of the same size can be compared");
    assert!(!image.is_empty(), "a mean over no pixels");
    let sum: f64 = image
        .iter()
        .zip(reference)
        .map(|(x, reference)| term(x.to_f64() - reference.to_f64(), reference.to_f64()))
        .sum();
    sum / image.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rmse_of_a_known_pair_is_the_hand_computed_root() {
        // Differences 3 and 4: √((9 + 16) / 2).
        assert_eq!(rmse(&[4.0_f64, 4.0], &[1.0_f64, 0.0]), 12.5_f64.sqrt());
    }

    #[test]
    fn rel_mse_of_a_known_pair_weights_by_the_reference() {
        // (1²/(1 + 0.01) + 0.1²/(0 + 0.01)) / 2; the second term is 1 but for the rounding of 0.1² and 0.01.
        let expected = (1.0 / 1.01 + 1.0) / 2.0;
        assert!((rel_mse(&[2.0_f64, 0.1], &[1.0_f64, 0.0]) - expected).abs() < 1e-15);
    }

    #[test]
    fn a_nan_pixel_is_not_averaged_away() {
        assert!(rmse(&[f32::NAN, 1.0], &[1.0_f32, 1.0]).is_nan());
        assert!(rel_mse(&[1.0_f32, 1.0], &[1.0_f32, f32::NAN]).is_nan());
    }

    #[test]
    fn pictures_of_different_size_are_refused() {
        let image = Picture::from_rgb(2, 1, &[[0.0_f32; 3]; 2]).unwrap();
        let reference = Picture::from_rgb(1, 2, &[[0.0_f32; 3]; 2]).unwrap();
        assert!(matches!(compare(&image, &reference, &["R"]), Err(PictureError::SizeMismatch { .. })));
        assert!(matches!(compare(&image, &image, &["Z"]), Err(PictureError::MissingChannel { .. })));
    }

    proptest! {
        #[test]
        fn rmse_is_symmetric_zero_on_itself_and_scales(
            pairs in prop::collection::vec((-1e3..1e3_f64, -1e3..1e3_f64), 1..50),
        ) {
            let (a, b): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            prop_assert_eq!(rmse(&a, &b), rmse(&b, &a));
            prop_assert_eq!(rmse(&a, &a), 0.0);
            // Doubling is exact in binary, the square root of 4x is exactly twice that of x.
            let double = |values: &[f64]| values.iter().map(|value| 2.0 * value).collect::<Vec<_>>();
            prop_assert_eq!(rmse(&double(&a), &double(&b)), 2.0 * rmse(&a, &b));
        }

        #[test]
        fn comparing_pictures_equals_comparing_their_samples(
            pixels in prop::collection::vec(any::<[(u16, u16); 3]>(), 6),
        ) {
            let of = |pick: fn((u16, u16)) -> u16| {
                let pixels: Vec<[f64; 3]> = pixels.iter().map(|pixel| pixel.map(|pair| f64::from(pick(pair)))).collect();
                (Picture::from_rgb(3, 2, &pixels).unwrap(), pixels.concat())
            };
            let (image, image_samples) = of(|pair| pair.0);
            let (reference, reference_samples) = of(|pair| pair.1);
            let metrics = compare(&image, &reference, &["R", "G", "B"]).unwrap();
            // Same terms, summed in another order: 18 of them, so 1e-14 relative is ample.
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-14 * b.abs();
            prop_assert!(close(metrics.rmse, rmse(&image_samples, &reference_samples)));
            prop_assert!(close(metrics.rel_mse, rel_mse(&image_samples, &reference_samples)));
        }
    }
}
