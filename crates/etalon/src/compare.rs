//! How far apart two pictures are, and whether that is more than their noise.

mod power;
mod scales;
#[cfg(test)]
mod tests;
mod tiles;

use etalon_oracle::statistics::sidak;
use etalon_picture::{ExrFile, PIXELS_PER_DEGREE, PictureError, RenderInfo, flip};
use serde::Serialize;

pub use power::{POWER as COMPARE_POWER, Seen};
pub use scales::{ChannelTest, ScaleTest};
pub use tiles::TileTest;

/// How two pictures are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompareSettings {
    /// Probability of calling two pictures of the same thing different.
    pub significance: f64,
    /// Side of the smallest tiles that are compared, pixels. Tiles of two, four and eight times that are compared as well, where the picture
    /// has several, and the whole picture. A change inside a smallest tile is not seen. The noise of a tile is taken for normally
    /// distributed: of fewer than 4 pixels a side it is not, and pictures of the same thing are called different too often.
    pub tile: usize,
    /// Exposure for FLIP, in stops.
    pub exposure_ev: f64,
}

impl Default for CompareSettings {
    /// One false alarm in a thousand, tiles from 4 × 4 pixels.
    fn default() -> Self {
        Self { significance: 1e-3, tile: 4, exposure_ev: 0.0 }
    }
}

/// What the noise has to say about the difference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseTest {
    /// Probability of calling two pictures of the same thing different.
    pub significance: f64,
    /// Whether the pictures differ beyond their noise.
    pub differ: bool,
    /// Below this p a single question is answered "different". There are one or two questions for each channel and size of tiles, see
    /// [`ScaleTest`]; together they have `significance` (Šidák 1967).
    pub accepted_from: f64,
    /// The test of each channel.
    pub channels: Vec<ChannelTest>,
}

/// What a comparison comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// All values are equal.
    Equal,
    /// No difference beyond the noise.
    WithinNoise,
    /// A difference beyond the noise, or a value that is not finite.
    Differ,
    /// There are differences, and at least one tile's errors are not known.
    Untested,
}

/// Pixels with a value that is not finite in either picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct NonFinitePixels {
    /// How many.
    pub pixels: usize,
    /// Column and row of the first.
    pub first: [usize; 2],
}

/// Two pictures, compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Width of both, pixels.
    pub width: usize,
    /// Height of both, pixels.
    pub height: usize,
    /// Root mean square difference over pixels and colours.
    pub rmse: f64,
    /// Mean square difference in units of the squares of the reference.
    pub rel_mse: f64,
    /// Mean of the map of FLIP: 0 looks alike, 1 does not.
    pub flip: f64,
    /// What it comes to.
    pub verdict: Verdict,
    /// `None` where all values are finite.
    pub non_finite: Option<NonFinitePixels>,
    /// `None` where a picture does not know its errors.
    pub test: Option<NoiseTest>,
    /// Why there is no test, or why it must not be believed.
    pub note: Option<String>,
    /// FLIP of each pixel, row after row.
    #[serde(skip)]
    pub flip_map: Vec<f64>,
}

/// Channels compared.
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Compares `R`, `G` and `B` of two pictures; `names` are for messages. Relative measures are in units of the second.
///
/// # Errors
/// If the sizes differ, and if a picture has no colour.
///
/// ```
/// use etalon::{CompareSettings, Settings, Verdict, compare};
///
/// let render = |seed| -> Result<_, Box<dyn std::error::Error>> {
///     let mut scene = etalon::Scene::load_sized("../../scenes/cornell.json", Some([32, 32]))?;
///     scene.model.integrator.seed = seed;
///     Ok(scene.prepare()?.render(&Settings { samples: Some(16), ..Default::default() })?.exr()?)
/// };
/// let (one, other) = (render(1)?, render(2)?);
/// let comparison = compare(&one, &other, ["one", "other"], &CompareSettings::default())?;
/// assert_eq!(comparison.verdict, Verdict::WithinNoise);
/// assert!(comparison.rmse > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare(
    image: &ExrFile,
    reference: &ExrFile,
    names: [&str; 2],
    settings: &CompareSettings,
) -> Result<Comparison, PictureError> {
    let metrics = etalon_picture::compare(&image.picture, &reference.picture, &CHANNELS)?;
    let flip_map = flip(&image.picture, &reference.picture, settings.exposure_ev.exp2(), PIXELS_PER_DEGREE)?;
    let (test, note) = test(image, reference, names, settings);
    let non_finite = non_finite(image, reference);
    Ok(Comparison {
        width: image.picture.width(),
        height: image.picture.height(),
        rmse: metrics.rmse,
        rel_mse: metrics.rel_mse,
        flip: flip_map.iter().sum::<f64>() / flip_map.len() as f64,
        verdict: verdict(test.as_ref(), non_finite.is_some(), metrics.rmse == 0.0),
        non_finite,
        test,
        note,
        flip_map,
    })
}

fn verdict(test: Option<&NoiseTest>, non_finite: bool, equal: bool) -> Verdict {
    let tested = test.is_some_and(|test| test.channels.iter().all(|channel| channel.untested_tiles == 0));
    if non_finite || test.is_some_and(|test| test.differ) {
        Verdict::Differ
    } else if equal {
        Verdict::Equal
    } else if tested {
        Verdict::WithinNoise
    } else {
        Verdict::Untested
    }
}

/// Where the values of one of the compared channels are not finite.
fn non_finite(image: &ExrFile, reference: &ExrFile) -> Option<NonFinitePixels> {
    let channels = || [image, reference].into_iter().flat_map(|file| CHANNELS.map(|name| file.picture.channel(name)));
    let (width, height) = (image.picture.width(), image.picture.height());
    let wrong = |pixel: &usize| channels().flatten().any(|values| !values[*pixel].is_finite());
    let mut pixels = (0..width * height).filter(wrong);
    let first = pixels.next()?;
    Some(NonFinitePixels { pixels: 1 + pixels.count(), first: [first % width, first / width] })
}

/// Significance of each question, so that all questions of all channels together have `significance`.
fn each(significance: f64, channels: &[ChannelTest]) -> f64 {
    sidak(significance, channels.iter().map(ChannelTest::questions).sum::<usize>().max(1))
}

fn test(
    image: &ExrFile,
    reference: &ExrFile,
    names: [&str; 2],
    settings: &CompareSettings,
) -> (Option<NoiseTest>, Option<String>) {
    let [a, b] = [image, reference].map(|file| RenderInfo::from_attributes(&file.attributes));
    let same_numbers = matches!((&a, &b), (Some(a), Some(b)) if a.seed == b.seed && a.scene_sha256 == b.scene_sha256);
    let mut channels = Vec::new();
    for name in CHANNELS {
        let (Some(a), Some(b)) = (tiles::Measured::new(image, name), tiles::Measured::new(reference, name)) else {
            let lacking = if tiles::Measured::new(image, name).is_none() { names[0] } else { names[1] };
            let note = format!("`{lacking}` has no channel Error.{name}, so noise cannot be told from difference");
            return (None, Some(note));
        };
        channels.push(scales::test(name, &a, &b, image.picture.width(), settings.tile));
    }
    let accepted_from = each(settings.significance, &channels);
    channels.iter_mut().for_each(|channel| channel.set_power(accepted_from));
    let differ = channels.iter().any(|channel| channel.p() < accepted_from);
    let note = same_numbers.then(|| {
        "both were rendered from the same scene with the same seed: their noise is not independent, and the test sees too \
         little"
            .to_owned()
    });
    (Some(NoiseTest { significance: settings.significance, differ, accepted_from, channels }), note)
}
