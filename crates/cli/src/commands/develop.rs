//! `etalon develop`: a PNG from an EXR, or the spectrum of a part of it.

mod plot;

use std::path::{Path, PathBuf};

use etalon_picture::develop::{Rect, Tone, spectrum_of};
use etalon_picture::{ExrFile, PictureError, check_writable, read_exr, write_atomically};
use miette::{Report, Severity, miette};

use crate::developing::{ALL, Developing, warn_not_finite};
use crate::failure::{Failure, Outcome};
use crate::print;

/// Makes a PNG for a screen from an EXR, of Etalon or of another renderer: exposure, white balance, tone curve, crop, scale, false colour,
/// error map, single bands. With --spectrum it plots a spectrum instead.
///
/// Without options the PNG is that of `etalon render`. It holds R, G, B of the file, or else X, Y, Z, or Y, or the colour of its spectral
/// bands.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The picture, as EXR.
    image: PathBuf,
    /// File to write: .png, or .svg with --spectrum.
    #[arg(short, long, alias = "outfile", value_name = "FILE", required = true)]
    output: PathBuf,
    /// Show only these pixels: W columns from column X, H rows from row Y, counted from 0 at the top left of the picture.
    #[arg(long, value_name = "X,Y,W,H", value_parser = crate::args::rect)]
    crop: Option<Rect>,
    /// Plot the spectral bands of a pixel, or their means over W × H pixels, with bars of one standard error.
    #[arg(long, value_name = "X,Y[,W,H]", value_parser = crate::args::region, conflicts_with = "crop", conflicts_with_all = ALL)]
    spectrum: Option<Rect>,
    /// Print nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    developing: Developing,
}

pub(crate) fn run(args: Args) -> Outcome {
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
fn check_output(args: &Args) -> Outcome {
    let extension = args.output.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let (kind, help) = match args.spectrum {
        Some(_) => ("svg", "a plot is written as SVG; browsers show it, and other programs turn it into PNG or PDF"),
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

fn develop(args: &Args, file: &ExrFile) -> Result<String, Failure> {
    let developed = args.developing.write(&args.output, file, args.crop).map_err(|error| cannot(&args.image, error))?;
    print::warnings(&warn_not_finite(&args.image, &developed));
    let image = &developed.image;
    let legend = if matches!(developed.tone, Tone::Map { .. }) { " with a legend" } else { "" };
    Ok(format!("{} × {} pixels{legend}, {}", image.width, image.height, args.developing.describe(&developed)))
}

fn plot_spectrum(args: &Args, file: &ExrFile, region: Rect) -> Result<String, Failure> {
    let bands = spectrum_of(file, region).map_err(|error| cannot(&args.image, error))?;
    let name = args.image.file_name().map_or_else(|| args.image.display().to_string(), |n| n.to_string_lossy().into());
    let svg = plot::svg(&name, region, &bands, &file.attributes)
        .map_err(|why| cannot(&args.image, PictureError::Develop { why }))?;
    write_atomically(&args.output, |out| out.write_all(svg.as_bytes()))
        .map_err(|error| Failure::run(Report::from_err(error)))?;
    let left_out: usize = bands.iter().map(|band| band.left_out).sum();
    let unknown = bands.iter().filter(|band| !band.error.is_some_and(f64::is_finite)).count();
    for (count, what) in [
        (left_out, "values of pixels are not finite and are left out of the means"),
        (unknown, "bands have no error bar: their error is not known"),
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
