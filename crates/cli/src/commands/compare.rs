//! `etalon compare`: how far apart two pictures are, and whether that is more than their noise.

mod tiles;

use std::path::{Path, PathBuf};

use etalon_picture::{
    Attributes, ExrFile, PIXELS_PER_DEGREE, Picture, PictureError, RenderInfo, compare, encode_srgb8, flip, read_exr,
    read_png, write_png,
};
use miette::{Report, miette};
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::print;

/// Compare two pictures, and test whether they differ by more than their noise.
///
/// Prints RMSE, relative MSE and FLIP. The test needs the error bars of an EXR; a PNG has none.
///
/// Exit status: 0 if the pictures are equal or differ by no more than their noise, 1 if they differ by more or a value is not finite, 3 if a
/// difference could not be tested.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon compare one.exr two.exr --diff difference.png")]
pub(crate) struct Args {
    /// Picture, EXR or PNG.
    image: PathBuf,
    /// Reference picture, EXR or PNG. Relative measures are relative to it.
    reference: PathBuf,
    /// Probability of a false alarm, for two renders of the same scene with different seeds.
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = probability)]
    significance: f64,
    /// Side of the tiles that are compared, in pixels. The test assumes that the mean of a tile has a normal distribution, so take 4 or
    /// more. Smaller tiles give more false alarms.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    tile: u32,
    /// Exposure in stops, for FLIP and --diff.
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true, value_parser = crate::args::finite)]
    exposure: f64,
    /// Write the FLIP map as PNG: black where the pictures look alike, then red, yellow and white.
    #[arg(long, value_name = "PNG")]
    diff: Option<PathBuf>,
    /// Print one JSON object on standard output.
    #[arg(long)]
    json: bool,
}

fn probability(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err("expected a probability between 0 and 1, such as 0.001".to_owned()),
    }
}

/// What the noise has to say about the difference.
#[derive(Serialize)]
struct Test {
    significance: f64,
    /// Whether the pictures differ beyond their noise.
    differ: bool,
    /// Below this p a single question is answered "different".
    accepted_from: f64,
    channels: Vec<tiles::Channel>,
}

/// What the comparison comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Verdict {
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
#[derive(Serialize)]
struct NonFinite {
    pixels: usize,
    /// Column and row of the first.
    first: [usize; 2],
}

#[derive(Serialize)]
struct Comparison {
    image: String,
    reference: String,
    width: usize,
    height: usize,
    rmse: f64,
    rel_mse: f64,
    flip: f64,
    verdict: Verdict,
    /// `null` where all values are finite.
    non_finite: Option<NonFinite>,
    /// `null` where a picture does not know its errors.
    test: Option<Test>,
    /// Why there is no test, or why it must not be believed.
    note: Option<String>,
}

/// Channels compared.
const CHANNELS: [&str; 3] = ["R", "G", "B"];

pub(crate) fn run(args: Args) -> Outcome {
    let read = |path| read(path).map_err(|error| Failure::input(Report::from_err(error)));
    let (image, reference) = (read(&args.image)?, read(&args.reference)?);
    let input = |error| Failure::input(Report::from_err(error));
    let metrics = compare(&image.picture, &reference.picture, &CHANNELS).map_err(input)?;
    let scale = args.exposure.exp2();
    let map = flip(&image.picture, &reference.picture, scale, PIXELS_PER_DEGREE).map_err(input)?;
    let (test, note) = test(&args, &image, &reference);
    let non_finite = non_finite(&image, &reference);
    let verdict = verdict(test.as_ref(), non_finite.is_some(), metrics.rmse == 0.0);
    let comparison = Comparison {
        image: args.image.display().to_string(),
        reference: args.reference.display().to_string(),
        width: image.picture.width(),
        height: image.picture.height(),
        rmse: metrics.rmse,
        rel_mse: metrics.rel_mse,
        flip: map.iter().sum::<f64>() / map.len() as f64,
        verdict,
        non_finite,
        test,
        note,
    };
    if let Some(path) = &args.diff {
        write_map(path, &map, &image).map_err(|error| Failure::run(Report::from_err(error)))?;
    }
    if args.json {
        print::json(&comparison);
    } else {
        print::line(&describe(&comparison));
    }
    match (verdict, &comparison.non_finite) {
        (Verdict::Equal | Verdict::WithinNoise, _) => Ok(()),
        (Verdict::Differ, Some(_)) => {
            Err(Failure::run(miette!(code = "pictures-differ", "a picture has values that are not finite")))
        }
        (Verdict::Differ, None) => Err(Failure::run(miette!(
            code = "pictures-differ",
            "the pictures differ by more than their noise explains"
        ))),
        (Verdict::Untested, _) => Err(Failure::undecided(miette!(
            code = "not-tested",
            help = "render both pictures with at least two replicates, and at least one sample in each",
            "the pictures are not equal, and their errors are not known everywhere: the difference may be noise"
        ))),
    }
}

/// An EXR, or the linear colours of a PNG, which says nothing more.
fn read(path: &Path) -> Result<ExrFile, PictureError> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Ok(ExrFile { picture: read_png(path)?, attributes: Attributes::default() });
    }
    read_exr(path)
}

fn verdict(test: Option<&Test>, non_finite: bool, equal: bool) -> Verdict {
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
fn non_finite(image: &ExrFile, reference: &ExrFile) -> Option<NonFinite> {
    let channels = || [image, reference].into_iter().flat_map(|file| CHANNELS.map(|name| file.picture.channel(name)));
    let (width, height) = (image.picture.width(), image.picture.height());
    let wrong = |pixel: &usize| channels().flatten().any(|values| !values[*pixel].is_finite());
    let mut pixels = (0..width * height).filter(wrong);
    let first = pixels.next()?;
    Some(NonFinite { pixels: 1 + pixels.count(), first: [first % width, first / width] })
}

fn test(args: &Args, image: &ExrFile, reference: &ExrFile) -> (Option<Test>, Option<String>) {
    let [a, b] = [image, reference].map(|file| RenderInfo::from_attributes(&file.attributes));
    let same_numbers = matches!((&a, &b), (Some(a), Some(b)) if a.seed == b.seed && a.scene_sha256 == b.scene_sha256);
    let mut channels = Vec::new();
    for name in CHANNELS {
        let (Some(a), Some(b)) = (tiles::Measured::new(image, name), tiles::Measured::new(reference, name)) else {
            let lacking = if tiles::Measured::new(image, name).is_none() { &args.image } else { &args.reference };
            let note = format!(
                "`{}` has no channel Error.{name}, so the difference cannot be compared with the noise",
                lacking.display()
            );
            return (None, Some(note));
        };
        channels.push(tiles::test(name, &a, &b, image.picture.width(), args.tile as usize));
    }
    let accepted_from = tiles::each(args.significance, channels.len());
    let differ = channels.iter().any(|channel| channel.p() < accepted_from);
    let note = same_numbers.then(|| {
        "both pictures have the same scene and the same seed: their noise is not independent, and the test may miss a \
         difference"
            .to_owned()
    });
    (Some(Test { significance: args.significance, differ, accepted_from, channels }), note)
}

fn describe(comparison: &Comparison) -> String {
    let Comparison { width, height, rmse, rel_mse, flip, .. } = comparison;
    let mut text = format!(
        "{width} × {height} pixels: RMSE {rmse:.6e}, relative MSE {rel_mse:.6e}, FLIP {flip:.6} (0 looks alike, 1 does not)"
    );
    if let Some(NonFinite { pixels, first: [x, y] }) = comparison.non_finite {
        text.push_str(&format!(
            "\n  {pixels} pixels have values that are not finite, the first in column {x}, row {y}"
        ));
    }
    if let Some(test) = &comparison.test {
        for channel in &test.channels {
            text.push_str(&format!("\n  {}: ", channel.channel));
            if let Some(tile) = &channel.worst {
                let [x0, x1, y0, y1] = tile.crop;
                text.push_str(&format!(
                    "worst of {} tiles is columns {x0} to {}, rows {y0} to {}: {:.6} against {:.6}, t {:.2}, ",
                    channel.tiles,
                    x1 - 1,
                    y1 - 1,
                    tile.means[0],
                    tile.means[1],
                    tile.t
                ));
            }
            text.push_str(&format!("p {:.2e} for the worst, {:.2e} for all", channel.p_worst, channel.p_spread));
            if channel.untested_tiles > 0 {
                text.push_str(&format!("; {} tiles without known errors", channel.untested_tiles));
            }
        }
        text.push_str(&format!("\n  the probability of a false alarm is {}", test.significance));
    }
    text.push_str(match comparison.verdict {
        Verdict::Equal => "\n  all values are equal",
        Verdict::WithinNoise => "\n  no difference beyond their noise",
        Verdict::Differ => "\n  they differ beyond their noise",
        Verdict::Untested => "\n  not tested: some errors are not known",
    });
    if let Some(note) = &comparison.note {
        text.push_str(&format!("\n  {note}"));
    }
    text
}

/// The map in colours whose lightness grows with the difference.
fn write_map(path: &Path, map: &[f64], image: &ExrFile) -> Result<(), PictureError> {
    let ramp = |v: f64, from: f64| ((v - from) * 3.0).clamp(0.0, 1.0) as f32;
    let pixels: Vec<[f32; 3]> = map.iter().map(|&v| [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|from| ramp(v, from))).collect();
    let (width, height) = (image.picture.width(), image.picture.height());
    let (shown, _) = encode_srgb8(&Picture::from_rgb(width, height, &pixels)?, 0.0)?;
    write_png(path, &shown, &[("Software", concat!("etalon ", env!("CARGO_PKG_VERSION")))])
}
