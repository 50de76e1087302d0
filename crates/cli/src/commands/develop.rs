//! `etalon develop`: a PNG from an EXR, or the spectrum of a part of it.

mod plot;

use std::path::{Path, PathBuf};

use etalon_picture::develop::{Rect, Tone, spectrum_of};
use etalon_picture::{ExrFile, PictureError, check_writable, read_exr, write_atomically};
use miette::{MietteDiagnostic, Report, Severity, miette};

use crate::args::corners_hint;
use crate::developing::{ALL, Developing, warn_not_finite};
use crate::failure::{Failure, Outcome};
use crate::print;

/// Make a PNG for a screen from an EXR file, or plot a spectrum.
///
/// The EXR may be of Etalon or of another renderer. Without options the PNG is the same as that of `etalon render`. It shows the channels R, G
/// and B. If the file has none, it shows X, Y and Z, or Y, or the colour of the spectral bands.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon develop cornell.exr --exposure auto --curve agx -o cornell.png
  etalon develop cornell.exr --error-map -o error.png
  etalon develop cornell.exr --spectrum 32,50 -o spectrum.svg")]
pub(crate) struct DevelopArgs {
    /// Picture, as EXR.
    image: PathBuf,
    /// File to write: .png, or .svg with --spectrum.
    #[arg(short, long, alias = "outfile", value_name = "FILE", required = true)]
    output: PathBuf,
    /// Show only a part: W × H pixels from column X and row Y, counted from 0 at the top left.
    #[arg(long, value_name = "X,Y,W,H", value_parser = crate::args::rect)]
    crop: Option<Rect>,
    /// Plot the spectral bands of a pixel, or their mean over W × H pixels. Error bars are one standard error.
    #[arg(long, value_name = "X,Y[,W,H]", value_parser = crate::args::region, conflicts_with = "crop", conflicts_with_all = ALL)]
    spectrum: Option<Rect>,
    /// Print only warnings and errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    developing: Developing,
}

pub(crate) fn run(args: DevelopArgs) -> Outcome {
    check_output(&args)?;
    let file = read_exr(&args.image).map_err(|error| Failure::input(Report::from_err(error)))?;
    let said = match args.spectrum {
        Some(region) => plot_spectrum(&args, &file, region)?,
        None => develop(&args, &file)?,
    };
    if !args.quiet {
        // The file is written, whether anybody reads about it or not.
        print::line_if_read(&format!("wrote {}: {said}", args.output.display()));
    }
    Ok(())
}

/// Refuses a file that is not of the kind that is written, or that cannot be written.
fn check_output(args: &DevelopArgs) -> Outcome {
    let extension = args.output.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let (kind, help) = match args.spectrum {
        Some(_) => ("svg", "a plot is an SVG file; browsers show it, and other programs convert it to PNG or PDF"),
        None => ("png", "a developed picture is a PNG; the EXR keeps the linear picture"),
    };
    if extension.as_deref() != Some(kind) {
        return Err(Failure::input(miette!(
            code = "output-format",
            help = help,
            "`{}` does not end in .{kind}",
            args.output.display()
        )));
    }
    check_writable(&args.output).map_err(|error| Failure::run(Report::from_err(error)))
}

fn develop(args: &DevelopArgs, file: &ExrFile) -> Result<String, Failure> {
    check_crop(args, file)?;
    let developed = args.developing.write(&args.output, file, args.crop).map_err(|error| cannot(&args.image, error))?;
    print::warnings(&warn_not_finite(&args.image, &developed));
    let image = &developed.image;
    let legend = if matches!(developed.tone, Tone::Map { .. }) { " with a legend" } else { "" };
    Ok(format!("{} × {} pixels{legend}, {}", image.width, image.height, args.developing.describe(&developed)))
}

/// Refuses a crop that leaves the picture.
fn check_crop(args: &DevelopArgs, file: &ExrFile) -> Outcome {
    let Some(crop) = args.crop else { return Ok(()) };
    let size = [file.picture.width(), file.picture.height()];
    crop.check_within(size[0], size[1]).map_err(|error| {
        let outside = MietteDiagnostic::new(format!("cannot develop `{}`: {error}", args.image.display()));
        let outside = outside.with_code("crop-outside");
        match corners_hint([crop.x, crop.y, crop.width, crop.height], size) {
            Some(hint) => Failure::input(outside.with_help(hint)),
            None => Failure::input(outside),
        }
    })
}

fn plot_spectrum(args: &DevelopArgs, file: &ExrFile, region: Rect) -> Result<String, Failure> {
    let bands = spectrum_of(file, region).map_err(|error| cannot(&args.image, error))?;
    let name = args.image.file_name().map_or_else(|| args.image.display().to_string(), |n| n.to_string_lossy().into());
    let svg = plot::svg(&name, region, &bands, &file.attributes)
        .map_err(|why| cannot(&args.image, PictureError::Develop { why }))?;
    write_atomically(&args.output, |out| out.write_all(svg.as_bytes()))
        .map_err(|error| Failure::run(Report::from_err(error)))?;
    let left_out: usize = bands.iter().map(|band| band.left_out).sum();
    let unknown = bands.iter().filter(|band| !band.error.is_some_and(f64::is_finite)).count();
    for (count, what) in [
        (left_out, "values are not finite and are left out of the means"),
        (unknown, "bands have no error bar, because their error is not known"),
    ] {
        if count > 0 {
            let path = args.image.display();
            print::warnings(&[miette!(severity = Severity::Warning, code = "spectrum", "`{path}`: {count} {what}")]);
        }
    }
    let pixels = region.width * region.height;
    let place = if pixels == 1 { "of a pixel".to_owned() } else { format!("averaged over {pixels} pixels") };
    Ok(format!("{} bands {place}", bands.len()))
}

/// A picture that cannot be shown as it was asked for is the input's fault, a file that cannot be written is not.
fn cannot(image: &Path, error: PictureError) -> Failure {
    match error {
        PictureError::Develop { .. } | PictureError::MissingChannel { .. } => {
            Failure::input(miette!(code = "develop", "cannot develop `{}`: {error}", image.display()))
        }
        other => Failure::run(Report::from_err(other)),
    }
}
