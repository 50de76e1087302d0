//! Pictures that another program rendered, held to the truths.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use etalon_oracle::statistics::Budget;
use etalon_oracle::subjects::Reading;
use etalon_oracle::truths::{Quantity, Truth, truths};
use etalon_picture::{Picture, read_exr};
use miette::miette;

use super::report::{Report, Row};
use crate::failure::{Failure, Outcome};
use crate::print;

/// Luminance of linear Rec. 709 colours.
const LUMINANCE: [(&str, f64); 3] = [("R", 0.2126), ("G", 0.7152), ("B", 0.0722)];

pub(super) fn run(folder: &Path, chosen: &[Truth], json: bool) -> Outcome {
    let files = Files::in_folder(folder, chosen)?;
    let found = chosen.iter().filter(|truth| files.pictures.contains_key(&truth.name)).count();
    if found == 0 {
        return Err(Failure::input(miette!(
            code = "no-pictures",
            help = "a picture is called like its truth, eye-in-glass.exr, or eye-in-glass.1.exr, eye-in-glass.2.exr … for \
                    several; `etalon verify --export DIR` writes down what is expected",
            "no picture in `{}` has the name of a truth that was asked for",
            folder.display()
        )));
    }
    // A misspelt name would otherwise pass for a picture that was never made.
    print::warnings(
        &files.strangers.iter().map(|name| miette!("`{name}` has the name of no truth")).collect::<Vec<_>>(),
    );
    let significance = Budget::for_tests(found).each();
    let mut report = Report::new(!json).of_images(folder.display().to_string());
    let mut failure = Failure::default();
    for truth in chosen {
        match files.pictures.get(&truth.name) {
            None => report.push_missing(truth),
            Some(pictures) => {
                let reading = reading(truth, pictures, files.pictures.get(&white(&truth.name)));
                if let Err(why) = &reading {
                    failure.add(Failure::input(miette!(code = "picture", "{}: {why}", truth.name)));
                }
                report.push(Row::new(truth, reading, significance));
            }
        }
    }
    if let Err(failed) = report.finish() {
        failure.add(failed);
    }
    failure.into_outcome()
}

/// What another renderer read, of those of these truths that there are pictures of, by their names.
pub(super) fn readings(folder: &Path, chosen: &[Truth]) -> Result<BTreeMap<String, Reading>, Failure> {
    let files = Files::in_folder(folder, chosen)?;
    let mut readings = BTreeMap::new();
    for truth in chosen {
        if let Some(pictures) = files.pictures.get(&truth.name) {
            let reading = reading(truth, pictures, files.pictures.get(&white(&truth.name)))
                .map_err(|why| Failure::input(miette!(code = "picture", "{}: {why}", truth.name)))?;
            readings.insert(truth.name.clone(), reading);
        }
    }
    Ok(readings)
}

/// Under which name the picture of white goes.
fn white(truth: &str) -> String {
    format!("{truth}.white")
}

/// The pictures of one scene.
#[derive(Default)]
struct Pictures {
    /// `NAME.exr`, which states its own error.
    one: Option<PathBuf>,
    /// `NAME.1.exr`, `NAME.2.exr`, …, whose scatter is the error.
    several: Vec<PathBuf>,
}

/// The pictures of a folder, by the name of the truth, or of its white.
struct Files {
    pictures: BTreeMap<String, Pictures>,
    /// EXR files that belong to no truth.
    strangers: Vec<String>,
}

impl Files {
    /// `chosen` may be of a suite, which the list of all truths does not hold.
    fn in_folder(folder: &Path, chosen: &[Truth]) -> Result<Self, Failure> {
        let failed = |error| Failure::input(miette!(code = "folder", "cannot list `{}`: {error}", folder.display()));
        let known: Vec<String> = truths()
            .into_iter()
            .chain(chosen.iter().cloned())
            .flat_map(|truth| truth.band_nm.map(|_| white(&truth.name)).into_iter().chain([truth.name]))
            .collect();
        let mut files = Self { pictures: BTreeMap::new(), strangers: Vec::new() };
        for entry in fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let file_name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
            let Some(name) = file_name.strip_suffix(".exr") else {
                continue;
            };
            // A name may itself hold a point and digits: 89.9 degrees.
            let numbered = name.rsplit_once('.').filter(|(_, number)| number.bytes().all(|byte| byte.is_ascii_digit()));
            if known.iter().any(|known| known == name) {
                files.pictures.entry(name.to_owned()).or_default().one = Some(path);
            } else if let Some((stem, _)) = numbered.filter(|(stem, _)| known.iter().any(|known| known == stem)) {
                files.pictures.entry(stem.to_owned()).or_default().several.push(path);
            } else {
                files.strangers.push(format!("{name}.exr"));
            }
        }
        // The order in which a folder is listed must not show in the last digit.
        files.pictures.values_mut().for_each(|pictures| pictures.several.sort());
        files.strangers.sort();
        Ok(files)
    }
}

/// Reads what a truth asks for off its pictures; relative to white, if there is a picture of it.
fn reading(truth: &Truth, pictures: &Pictures, white: Option<&Pictures>) -> Result<Reading, String> {
    let reading = read(pictures, truth, truth.quantity)?;
    match white {
        None => Ok(reading),
        Some(white) => Ok(reading.relative_to(read(white, truth, Quantity::Radiance)?)),
    }
}

fn read(pictures: &Pictures, truth: &Truth, quantity: Quantity) -> Result<Reading, String> {
    match (&pictures.one, pictures.several.as_slice()) {
        (Some(_), [_, ..]) => {
            Err("there is a picture without a number, and there are numbered ones: keep one kind".to_owned())
        }
        (Some(path), []) => {
            let (values, errors) = pixels(path, truth, quantity)?;
            let errors = errors.ok_or_else(|| {
                format!(
                    "`{}` does not say how noisy it is: it needs Error.Y or Variance.Y (or of R, G and B), or more pictures \
                     with other seeds, NAME.1.exr, NAME.2.exr, …",
                    path.display()
                )
            })?;
            Ok(Reading::from_pixels(&values, &errors))
        }
        (None, [only]) => {
            Err(format!("`{}` is the only numbered picture: the noise needs two or more", only.display()))
        }
        (None, several) => {
            let (mut means, mut nonfinite) = (Vec::new(), 0);
            for path in several {
                let values = pixels(path, truth, quantity)?.0;
                // The errors that such a picture may state are not needed: the scatter of several sees more kinds of noise.
                let alone = Reading::from_pixels(&values, &vec![0.0; values.len()]);
                means.push(alone.estimate.mean);
                nonfinite += alone.nonfinite;
            }
            Ok(Reading::from_means(&means, nonfinite))
        }
    }
}

/// What a linear sensor reads at each pixel, and its standard error if the picture has it.
fn pixels(path: &Path, truth: &Truth, quantity: Quantity) -> Result<(Vec<f64>, Option<Vec<f64>>), String> {
    let [width, height] = truth.film_px();
    let picture = read_exr(path).map_err(|error| error.with_causes())?.picture;
    if [picture.width(), picture.height()] != [width, height] {
        let (w, h) = (picture.width(), picture.height());
        return Err(format!("`{}` is {w} × {h} pixels, the truth's film is {width} × {height}", path.display()));
    }
    let prefix = match quantity {
        Quantity::Radiance => String::new(),
        stokes => format!("{}.", stokes.name()),
    };
    let band = if quantity == truth.quantity { truth.band_channel() } else { None };
    let sensor: Vec<(String, f64)> = match (band, picture.channel(&format!("{prefix}Y"))) {
        (Some(channel), _) => vec![(channel, 1.0)],
        (None, Some(_)) => vec![(format!("{prefix}Y"), 1.0)],
        (None, None) => LUMINANCE.iter().map(|(name, weight)| (format!("{prefix}{name}"), *weight)).collect(),
    };
    let values = weighed(&picture, &sensor, |name| picture.require(name).map(widened).map_err(|e| e.to_string()))
        .map_err(|error| {
            let needed = truth.band_channel().unwrap_or(format!("{prefix}Y, or {prefix}R, {prefix}G and {prefix}B,"));
            format!("`{}`: {error} ({needed} is needed)", path.display())
        })?;
    let has_errors = sensor.iter().all(|(name, _)| error_channel(&picture, name).is_some());
    let errors = has_errors.then(|| {
        // The errors of the three colours may go together, so they add up plainly.
        weighed(&picture, &sensor, |name| Ok(error_channel(&picture, name).expect("it was just seen")))
            .expect("nothing fails here")
    });
    let Some([x0, x1, y0, y1]) = truth.crop_px.map(|crop| crop.map(|side| side as usize)) else {
        return Ok((values, errors));
    };
    let cropped = |all: Vec<f64>| (y0..y1).flat_map(|y| all[y * width + x0..y * width + x1].to_vec()).collect();
    Ok((cropped(values), errors.map(cropped)))
}

/// Σ weight × channel, pixel by pixel.
fn weighed(
    picture: &Picture,
    sensor: &[(String, f64)],
    channel: impl Fn(&str) -> Result<Vec<f64>, String>,
) -> Result<Vec<f64>, String> {
    let mut sum = vec![0.0; picture.width() * picture.height()];
    for (name, weight) in sensor {
        for (sum, sample) in sum.iter_mut().zip(channel(name)?) {
            *sum += weight * sample;
        }
    }
    Ok(sum)
}

/// The standard error of a channel's pixels; a negative one is not a number.
fn error_channel(picture: &Picture, name: &str) -> Option<Vec<f64>> {
    let proper = |error: f64| if error >= 0.0 { error } else { f64::NAN };
    let stated = picture.channel(&format!("Error.{name}")).map(widened);
    let variance = || picture.channel(&format!("Variance.{name}")).map(widened);
    stated
        .or_else(|| variance().map(|squares| squares.into_iter().map(f64::sqrt).collect()))
        .map(|errors| errors.into_iter().map(proper).collect())
}

fn widened(samples: &[f32]) -> Vec<f64> {
    samples.iter().copied().map(f64::from).collect()
}
