//! Maps of all pixels: their errors, and how far two pictures are apart.

use etalon::{CompareSettings, Comparison, compare};
use etalon_picture::develop::{Axis, ColourScale, NOT_FINITE};
use serde::{Deserialize, Serialize};

use crate::look::fast_png;
use crate::picture::Snapshot;

/// Standard errors at the ends of the scale of a difference.
const DIFFERENCE_ENDS: f64 = 5.0;

/// Which numbers a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MapKind {
    /// Standard error of the luminance of each pixel, in units of that luminance.
    Relative,
    /// The same in units of the mean luminance of the picture: the root mean square of this map is the error of the picture.
    OfMean,
    /// Luminance less that of the pinned picture, in standard errors of the difference.
    Difference,
    /// The relative number of samples: that of each pixel over the mean.
    Samples,
}

/// What a map shows, for its legend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Legend {
    /// Which numbers.
    pub kind: MapKind,
    /// Values at the two ends of the scale.
    pub range: [f64; 2],
    /// Values that the legend names.
    pub ticks: Vec<f64>,
    /// Colours at equal distances along the scale, as sRGB levels.
    pub colours: Vec<[u8; 3]>,
    /// Pixels of which nothing is known.
    pub unknown: usize,
    /// Root mean square of all that is known.
    pub rms: f64,
}

/// A map as a PNG, with its legend.
pub(crate) struct Map {
    pub png: Vec<u8>,
    pub legend: Legend,
}

/// Colours of a legend.
const COLOURS: usize = 64;

/// A map of a picture.
///
/// # Errors
/// A sentence that says what the picture lacks.
pub(crate) fn map(kind: MapKind, snapshot: &Snapshot, pinned: Option<&Snapshot>) -> Result<Map, String> {
    let values = values(kind, snapshot, pinned)?;
    let [width, height] = snapshot.size();
    let known = || values.iter().copied().filter(|value| value.is_finite());
    let unknown = values.len() - known().count();
    let rms = (known().map(|value| value * value).sum::<f64>() / known().count().max(1) as f64).sqrt();
    let legend = |range: [f64; 2], ticks: Vec<f64>, colour: &dyn Fn(f64) -> [u8; 3]| {
        let colours = (0..COLOURS).map(|i| colour(i as f64 / (COLOURS - 1) as f64)).collect();
        Legend { kind, range, ticks, colours, unknown, rms }
    };
    if kind == MapKind::Difference {
        let place = |value: f64| 0.5 + 0.5 * (value / DIFFERENCE_ENDS);
        let colour = |value: f64| if value.is_finite() { diverging(place(value)) } else { NOT_FINITE };
        let pixels: Vec<u8> = values.iter().flat_map(|value| colour(*value)).collect();
        let ends = [-DIFFERENCE_ENDS, DIFFERENCE_ENDS];
        let legend = legend(ends, vec![-5.0, -3.0, -1.0, 1.0, 3.0, 5.0], &diverging);
        return Ok(Map { png: fast_png(width, height, &pixels), legend });
    }
    let scale = ColourScale::fitting(Axis::Log, known()).ok_or("there is no value above 0 to show")?;
    let pixels: Vec<u8> = values.iter().flat_map(|value| scale.colour(*value)).collect();
    let [low, high] = scale.range();
    let at = |place: f64| scale.colour(low * (high / low).powf(place));
    let legend = legend(scale.range(), scale.ticks(), &at);
    Ok(Map { png: fast_png(width, height, &pixels), legend })
}

fn values(kind: MapKind, snapshot: &Snapshot, pinned: Option<&Snapshot>) -> Result<Vec<f64>, String> {
    let luminance = &snapshot.luminance;
    let wide = |values: &[f32]| -> Vec<f64> { values.iter().map(|v| f64::from(*v)).collect() };
    if kind == MapKind::Samples {
        let samples = snapshot.file.picture.channel("samples");
        let samples = samples.ok_or("every pixel has the same number of samples")?;
        let mean = samples.iter().map(|v| f64::from(*v)).sum::<f64>() / samples.len() as f64;
        return Ok(samples.iter().map(|v| f64::from(*v) / mean).collect());
    }
    if luminance.errors.is_empty() {
        return Err("the error of these pixels is not known: that takes two replicates at least".to_owned());
    }
    let (values, errors) = (wide(&luminance.values), wide(&luminance.errors));
    let pairs = || values.iter().zip(&errors);
    Ok(match kind {
        MapKind::Relative => {
            let relative = |(value, error): (&f64, &f64)| if *error == 0.0 { 0.0 } else { error / value.abs() };
            pairs().map(relative).collect()
        }
        MapKind::OfMean => {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            pairs().map(|(_, error)| error / mean).collect()
        }
        _ => {
            let pinned = pinned.ok_or("no picture is pinned to compare with")?;
            if pinned.size() != snapshot.size() {
                let [[a, b], [c, d]] = [snapshot.size(), pinned.size()];
                return Err(format!("this picture has {a} × {b} pixels, the pinned one {c} × {d}"));
            }
            let other = &pinned.luminance;
            if other.errors.is_empty() {
                return Err("the error of the pinned picture is not known".to_owned());
            }
            let of = |i: usize| {
                let difference = values[i] - f64::from(other.values[i]);
                let error = errors[i].hypot(f64::from(other.errors[i]));
                if difference == 0.0 { 0.0 } else { difference / error }
            };
            (0..values.len()).map(of).collect()
        }
    })
}

/// Blue over white to red, by the place from 0 to 1; equal steps of light on both sides.
fn diverging(place: f64) -> [u8; 3] {
    let t = 2.0 * place.clamp(0.0, 1.0) - 1.0;
    let ends = if t < 0.0 { [33.0, 90.0, 190.0] } else { [190.0, 50.0, 40.0] };
    let white = [247.0, 246.0, 243.0];
    std::array::from_fn(|c| (white[c] + t.abs() * (ends[c] - white[c])).round() as u8)
}

/// The test of two pictures against their noise, as `etalon compare` does it.
///
/// # Errors
/// A sentence that says why they cannot be compared.
pub(crate) fn comparison(snapshot: &Snapshot, pinned: &Snapshot) -> Result<Comparison, String> {
    let names = ["this picture", "the pinned picture"];
    compare(&snapshot.file, &pinned.file, names, &CompareSettings::default()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Luminance;
    use etalon_picture::{Attributes, ExrFile, Picture};

    fn snapshot(values: &[f32], errors: &[f32]) -> Snapshot {
        let mut picture = Picture::new(values.len(), 1).unwrap();
        picture.insert("Y", values.to_vec()).unwrap();
        Snapshot {
            number: 1,
            stage: 1,
            file: ExrFile { picture, attributes: Attributes::new() },
            colour: None,
            luminance: Luminance { values: values.to_vec(), errors: errors.to_vec() },
            film: [values.len() as u32, 1],
            block: 1,
            samples: 4,
            seconds: 1.0,
            error: None,
            camera: None,
            title: String::new(),
        }
    }

    #[test]
    fn maps_show_errors_and_differences_in_their_units() {
        let one = snapshot(&[1.0, 3.0], &[0.1, 0.6]);
        let two = snapshot(&[1.0, 2.2], &[0.1, 0.8]);
        let near = |found: Vec<f64>, wanted: [f64; 2]| {
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {wanted:?}");
        };
        near(values(MapKind::Relative, &one, None).unwrap(), [0.1, 0.2]);
        near(values(MapKind::OfMean, &one, None).unwrap(), [0.05, 0.3]);
        near(values(MapKind::Difference, &one, Some(&two)).unwrap(), [0.0, 0.8]);
        assert!(values(MapKind::Difference, &one, None).is_err());
        assert!(values(MapKind::Relative, &snapshot(&[1.0, 2.0], &[]), None).is_err());
        assert!(values(MapKind::Samples, &one, None).is_err());
        // The root mean square of the second kind is the error of the picture.
        let map = map(MapKind::OfMean, &one, None).unwrap();
        assert!((map.legend.rms - ((0.01_f64 + 0.36) / 2.0).sqrt() / 2.0).abs() < 1e-6);
    }

    #[test]
    fn differences_are_white_where_there_are_none() {
        assert_eq!(diverging(0.5), [247, 246, 243]);
        let ([low, .., low_blue], [high, .., high_blue]) = (diverging(0.0), diverging(1.0));
        assert!(low < low_blue && high > high_blue && diverging(9.0) == diverging(1.0));
    }
}
