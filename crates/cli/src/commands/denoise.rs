//! `etalon denoise`: a picture smoothed for show by Open Image Denoise. What comes out is no measurement, and says so.

use std::path::PathBuf;

use etalon_picture::{Attribute, Attributes, Chromaticities, ExrFile, Picture, read_exr};
use miette::{Report, miette};

use crate::developing::Developing;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::print;

/// Denoise a picture with Open Image Denoise, for show only.
///
/// The result is no measurement and has no error bars. Albedo and normals help the denoiser: render with --aov albedo,normal.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon denoise cornell.exr -o smooth.png")]
pub(crate) struct DenoiseArgs {
    /// Picture, as EXR.
    image: PathBuf,
    /// File to write: .exr or .png. Repeat the option to write several.
    #[arg(short, long, required = true, value_name = "FILE")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    developing: Developing,
}

/// The attribute that marks a picture as smoothed.
const DENOISED: &str = "denoised";

pub(crate) fn run(args: DenoiseArgs) -> Outcome {
    let mut failure = Failure::default();
    let outputs = output::plan(&args.output, &mut failure);
    std::mem::take(&mut failure).into_outcome()?;
    let refused =
        |code: &'static str, why: String| Failure::input(miette!(code = code, "`{}` {why}", args.image.display()));
    let file = read_exr(&args.image).map_err(|error| Failure::input(Report::from_err(error)))?;
    if file.attributes.contains_key(DENOISED) {
        return Err(refused("denoised-already", "is denoised already".to_owned()));
    }
    let Some(colour) = interleaved(&file, ["R", "G", "B"]) else {
        return Err(refused("no-colour", "lacks a channel R, G or B".to_owned()));
    };
    if let Some(at) = colour.iter().position(|v| !v.is_finite()) {
        let (x, y) = (at / 3 % file.picture.width(), at / 3 / file.picture.width());
        return Err(refused("not-finite", format!("has a pixel that is not finite, in column {x}, row {y}")));
    }
    let smoothed = smooth(&file, colour)?;

    let mut attributes = Attributes::new();
    attributes.insert("chromaticities".to_owned(), Attribute::Chromaticities(Chromaticities::REC_709));
    // Nothing by which a picture would pass for a render: no seed, no samples, no hash of a scene.
    let name = args.image.file_name().map_or_else(|| args.image.display().to_string(), |n| n.to_string_lossy().into());
    let note = format!("{name}, smoothed by Open Image Denoise: for show, not measured");
    attributes.insert(DENOISED.to_owned(), Attribute::Text(note));
    let smoothed = ExrFile { picture: smoothed, attributes };
    for output in &outputs {
        match output::write(output, &smoothed, &args.developing) {
            Ok(written) => {
                let description = written.description.map_or(String::new(), |text| format!(", {text}"));
                print::line(&format!("wrote {}{description}", written.path));
            }
            Err(error) => failure.add(error),
        }
    }
    failure.into_outcome()
}

/// Three channels pixel by pixel, if they are there.
fn interleaved(file: &ExrFile, names: [&str; 3]) -> Option<Vec<f32>> {
    let [a, b, c] = names.map(|name| file.picture.channel(name));
    let (a, b, c) = (a?, b?, c?);
    Some((0..a.len()).flat_map(|i| [a[i], b[i], c[i]]).collect())
}

fn smooth(file: &ExrFile, mut colour: Vec<f32>) -> Result<Picture<f32>, Failure> {
    let (width, height) = (file.picture.width(), file.picture.height());
    let failed = |error: oidn::Error| Failure::run(miette!(code = "open-image-denoise", "Open Image Denoise: {error}"));
    // Not whatever device is fastest: the same picture on every machine of a kind.
    let device = oidn::Device::cpu().map_err(failed)?;
    let mut filter = oidn::RayTracing::try_new(&device).map_err(failed)?;
    filter.hdr(true).image_dimensions(width, height);
    let albedo = interleaved(file, ["Albedo.R", "Albedo.G", "Albedo.B"]);
    let normal = interleaved(file, ["N.X", "N.Y", "N.Z"]);
    match (&albedo, &normal) {
        (Some(albedo), Some(normal)) => filter.albedo_normal(albedo, normal),
        // The library takes normals beside an albedo only.
        (Some(albedo), None) => filter.albedo(albedo),
        (None, _) => &mut filter,
    };
    filter.filter_in_place(&mut colour).map_err(failed)?;
    let pixels: Vec<[f32; 3]> = colour.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    Picture::from_rgb(width, height, &pixels)
        .and_then(|picture| picture.in_frame(file.picture.window()))
        .map_err(|error| Failure::run(Report::from_err(error)))
}
