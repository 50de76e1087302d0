//! Larger and smaller pictures, in linear light.

use crate::{Picture, PictureError, Sample};

/// Most pixels of a picture that is made larger.
pub const MAX_SCALED_PIXELS: usize = 1 << 26;

/// The size of a picture times a factor: each side rounded to whole pixels, at least 1.
///
/// # Errors
/// A factor that is not above 0 and finite; a larger picture of more than [`MAX_SCALED_PIXELS`] pixels.
///
/// ```
/// use etalon_picture::develop::scaled_size;
///
/// assert_eq!(scaled_size(640, 480, 0.5)?, (320, 240));
/// assert_eq!(scaled_size(3, 2, 0.01)?, (1, 1));
/// assert!(scaled_size(640, 480, 1e6).is_err());
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
pub fn scaled_size(width: usize, height: usize, factor: f64) -> Result<(usize, usize), PictureError> {
    if !(factor > 0.0 && factor.is_finite()) {
        return Err(PictureError::develop("the scale factor must be above 0 and finite"));
    }
    let [new_width, new_height] = [width, height].map(|side| (side as f64 * factor).round().max(1.0));
    if new_width * new_height > MAX_SCALED_PIXELS.max(width * height) as f64 {
        return Err(PictureError::develop(format!(
            "{width} × {height} pixels times {factor} are more than {MAX_SCALED_PIXELS} pixels"
        )));
    }
    Ok((new_width as usize, new_height as usize))
}

/// A picture of another size. The light of each new pixel is a mean over its area:
///
/// - where the picture becomes smaller, of the old pixels, each by the part of it that lies within;
/// - where it becomes larger, of the bilinear interpolation between the centres of the old pixels.
///
/// Both are weighted means without negative weights, so bright pixels have no dark rims. All old pixels have the same total weight,
/// so the mean of the picture stays the same. A value that is not finite is left out; where no other value is near, the result is
/// NaN.
///
/// # Errors
/// A size without pixels.
///
/// ```
/// use etalon_picture::Picture;
/// use etalon_picture::develop::scale;
///
/// let mut picture = Picture::new(4, 2)?;
/// picture.insert("Y", vec![0.0_f64, 2.0, 4.0, 6.0, 2.0, 4.0, 6.0, 8.0])?;
/// assert_eq!(scale(&picture, 2, 1)?.require("Y")?, [2.0, 6.0]);
/// # Ok::<(), etalon_picture::PictureError>(())
/// ```
pub fn scale<T: Sample>(picture: &Picture<T>, width: usize, height: usize) -> Result<Picture<T>, PictureError> {
    let mut scaled = Picture::new(width, height)?;
    let (old_width, old_height) = (picture.width(), picture.height());
    let (columns, rows) = (weights(old_width, width), weights(old_height, height));
    for channel in picture.channels() {
        // A row of the result needs few rows of the picture, so each is made when it is first asked for.
        let narrow_row = |y: usize| -> Vec<f64> {
            let row = &channel.samples[y * old_width..(y + 1) * old_width];
            columns.iter().map(|weights| mean(weights, |x| row[x].to_f64())).collect()
        };
        let mut kept: Vec<(usize, Vec<f64>)> = Vec::new();
        let mut samples = Vec::with_capacity(width * height);
        for weights in &rows {
            let first = weights[0].0;
            kept.retain(|(y, _)| *y >= first);
            for (y, _) in weights {
                if kept.iter().all(|(other, _)| other != y) {
                    kept.push((*y, narrow_row(*y)));
                }
            }
            let by_row: Vec<(usize, f64)> = weights
                .iter()
                .map(|(y, weight)| (kept.iter().position(|(other, _)| other == y).expect("it was added"), *weight))
                .collect();
            samples.extend((0..width).map(|x| T::from_f64(mean(&by_row, |row| kept[row].1[x]))));
        }
        scaled.insert(&channel.name, samples)?;
    }
    Ok(scaled)
}

/// The mean of the finite values, by their weights.
fn mean(weights: &[(usize, f64)], value: impl Fn(usize) -> f64) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (index, weight) in weights {
        let value = value(*index);
        if value.is_finite() {
            sum += weight * value;
            total += weight;
        }
    }
    // 0/0 where there is none.
    sum / total
}

/// For each of `new` pixels along an axis: which of the `old` pixels it is made of, by increasing index, and their weights.
fn weights(old: usize, new: usize) -> Vec<Vec<(usize, f64)>> {
    let step = old as f64 / new as f64;
    // The integral from −∞ to t of what a pixel centred at 0 holds: a box where the picture becomes smaller, a tent where it becomes larger.
    let integral = |t: f64| -> f64 {
        if step >= 1.0 {
            (t + 0.5).clamp(0.0, 1.0)
        } else if t < 0.0 {
            0.5 * (1.0 + t.max(-1.0)).powi(2)
        } else {
            1.0 - 0.5 * (1.0 - t.min(1.0)).powi(2)
        }
    };
    (0..new)
        .map(|j| {
            let [begin, end] = [j as f64 * step, (j + 1) as f64 * step];
            let mut weights: Vec<(usize, f64)> = Vec::new();
            for i in (begin - 1.5).ceil() as isize..=(end + 0.5).floor() as isize {
                let centre = i as f64 + 0.5;
                let weight = integral(end - centre) - integral(begin - centre);
                if weight <= 0.0 {
                    continue;
                }
                // Beyond the edge the picture goes on as its last pixel.
                let index = i.clamp(0, old as isize - 1) as usize;
                match weights.last_mut() {
                    Some((last, sum)) if *last == index => *sum += weight,
                    _ => weights.push((index, weight)),
                }
            }
            weights
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture(width: usize, height: usize, samples: Vec<f64>) -> Picture<f64> {
        let mut picture = Picture::new(width, height).unwrap();
        picture.insert("Y", samples).unwrap();
        picture
    }

    fn mean_of(picture: &Picture<f64>) -> f64 {
        let samples = picture.require("Y").unwrap();
        samples.iter().sum::<f64>() / samples.len() as f64
    }

    #[test]
    fn the_same_size_is_the_same_picture_and_a_half_is_the_mean_of_four() {
        let old = picture(4, 2, (0..8).map(f64::from).collect());
        assert_eq!(scale(&old, 4, 2).unwrap(), old);
        assert_eq!(scale(&old, 2, 1).unwrap().require("Y").unwrap(), [2.5, 4.5]);
        // Twice as large: 0 up to the first centre, a ramp between the centres, 8 from there.
        let line = picture(2, 1, vec![0.0, 8.0]);
        assert_eq!(scale(&line, 4, 1).unwrap().require("Y").unwrap(), [0.0, 2.0, 6.0, 8.0]);
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let nan = f64::NAN;
        let old = picture(4, 1, vec![1.0, nan, nan, f64::INFINITY]);
        let new = scale(&old, 2, 1).unwrap();
        assert_eq!(new.require("Y").unwrap()[0], 1.0);
        assert!(new.require("Y").unwrap()[1].is_nan());
    }

    #[test]
    fn sizes_that_cannot_be_are_refused() {
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(scaled_size(100, 100, factor).is_err(), "{factor}");
        }
        // A picture that is large itself may be made smaller.
        assert_eq!(scaled_size(1 << 15, 1 << 15, 0.5).unwrap(), (1 << 14, 1 << 14));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn the_mean_and_the_range_stay(
            (width, height, samples) in (1..20_usize, 1..20_usize).prop_flat_map(|(width, height)| {
                (Just(width), Just(height), prop::collection::vec(-1.0..100.0_f64, width * height))
            }),
            (new_width, new_height) in (1..50_usize, 1..50_usize),
        ) {
            let old = picture(width, height, samples);
            let new = scale(&old, new_width, new_height).unwrap();
            prop_assert!((mean_of(&old) - mean_of(&new)).abs() < 1e-11, "{} {}", mean_of(&old), mean_of(&new));
            let range = |picture: &Picture<f64>| {
                picture.require("Y").unwrap().iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [f64::min(l, *v), f64::max(h, *v)])
            };
            let ([low, high], [new_low, new_high]) = (range(&old), range(&new));
            prop_assert!(low - 1e-12 <= new_low && new_high <= high + 1e-12);
        }
    }
}
