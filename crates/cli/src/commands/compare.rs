//! `etalon compare`: how far apart two pictures are, and whether that is more than their noise.

use std::path::{Path, PathBuf};

use etalon::{
    COMPARE_POWER, ChannelTest, CompareSettings, Comparison, NoiseTest, NonFinitePixels, Seen, Verdict, compare,
};
use etalon_picture::{Attributes, ExrFile, Picture, PictureError, encode_srgb8, read_exr, read_png, write_png};
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
pub(crate) struct CompareArgs {
    /// Picture, EXR or PNG.
    image: PathBuf,
    /// Reference picture, EXR or PNG. Relative measures are relative to it.
    reference: PathBuf,
    /// Probability of a false alarm, for two renders of the same scene with different seeds.
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = probability)]
    significance: f64,
    /// Side of the smallest tiles that are compared, in pixels. Tiles of two, four and eight times that are compared too, and the whole
    /// picture. The test assumes that the mean of a tile has a normal distribution, so take 4 or more. Smaller tiles give more false alarms.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
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

#[derive(Serialize)]
struct ComparisonJson<'a> {
    image: String,
    reference: String,
    #[serde(flatten)]
    comparison: &'a Comparison,
}

pub(crate) fn run(args: CompareArgs) -> Outcome {
    let read = |path| read(path).map_err(|error| Failure::input(Report::from_err(error)));
    let (image, reference) = (read(&args.image)?, read(&args.reference)?);
    let names = [&args.image, &args.reference].map(|path| path.display().to_string());
    let settings =
        CompareSettings { significance: args.significance, tile: args.tile as usize, exposure_ev: args.exposure };
    let comparison = compare(&image, &reference, names.each_ref().map(String::as_str), &settings)
        .map_err(|error| Failure::input(Report::from_err(error)))?;
    if let Some(path) = &args.diff {
        write_map(path, &comparison.flip_map, &image).map_err(|error| Failure::run(Report::from_err(error)))?;
    }
    if args.json {
        let [image, reference] = names;
        print::json(&ComparisonJson { image, reference, comparison: &comparison });
    } else {
        print::line(&describe(&comparison));
    }
    match (comparison.verdict, &comparison.non_finite) {
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

fn describe(comparison: &Comparison) -> String {
    let Comparison { width, height, rmse, rel_mse, flip, .. } = comparison;
    let mut text = format!(
        "{width} × {height} pixels: RMSE {rmse:.6e}, relative MSE {rel_mse:.6e}, FLIP {flip:.6} (0 looks alike, 1 does not)"
    );
    if let Some(NonFinitePixels { pixels, first: [x, y] }) = comparison.non_finite {
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
                    "the worst tile is columns {x0} to {}, rows {y0} to {}: {:.6} against {:.6}, t {:.2}, ",
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
        text.push_str(&seen(test));
        text.push_str(&format!(
            "\n  pictures differ if a p is below {:.1e}; the probability of a false alarm is {}",
            test.accepted_from, test.significance
        ));
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

/// What the test would have seen in each size of tiles: the least sensitive of the channels.
fn seen(test: &NoiseTest) -> String {
    let mut text = String::new();
    for (size, scale) in test.channels[0].scales.iter().enumerate() {
        let least = |change: fn(&Seen) -> Option<f64>| -> Option<f64> {
            let of = |channel: &ChannelTest| change(&channel.scales[size].seen);
            test.channels.iter().map(of).try_fold(0.0_f64, |most, change| Some(most.max(change?)))
        };
        let one = least(|seen| seen.in_one_tile).map(percent);
        let all = least(|seen| seen.in_all_tiles).map(percent);
        let what = match (scale.side, one, all) {
            (None, Some(one), _) => format!("a change of {one} of the whole picture"),
            (Some(side), Some(one), None) => format!("a change of {one} in one region of {side} × {side}"),
            (Some(side), None, Some(all)) => format!("a change of {all} in all regions of {side} × {side}"),
            (Some(side), Some(one), Some(all)) => {
                format!("a change of {one} in one region of {side} × {side}, or of {all} in all of them")
            }
            (_, None, None) | (None, ..) => continue,
        };
        text.push_str(&format!("\n  would have seen {what} with probability {COMPARE_POWER}"));
    }
    text
}

/// A part in per cent, with two digits.
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    let decimals = (1.0 - percent.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{percent:.decimals$} %")
}

/// The map in colours whose lightness grows with the difference.
fn write_map(path: &Path, map: &[f64], image: &ExrFile) -> Result<(), PictureError> {
    let ramp = |v: f64, from: f64| ((v - from) * 3.0).clamp(0.0, 1.0) as f32;
    let pixels: Vec<[f32; 3]> = map.iter().map(|&v| [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|from| ramp(v, from))).collect();
    let (width, height) = (image.picture.width(), image.picture.height());
    let (shown, _) = encode_srgb8(&Picture::from_rgb(width, height, &pixels)?, 0.0)?;
    write_png(path, &shown, &[("Software", concat!("etalon ", env!("CARGO_PKG_VERSION")))])
}
