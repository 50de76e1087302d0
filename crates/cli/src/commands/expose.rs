//! `etalon expose`: the digital numbers that an image sensor makes of a spectral picture.

mod summary;

use std::path::{Path, PathBuf};

use etalon::{LoadError, SensorFile};
use etalon_picture::expose::{ExposureSettings, RawFrame, RawInfo, SensorExposure};
use etalon_picture::{ExrFile, PictureError, check_writable, read_exr, write_exr, write_png16};
use miette::{Report, miette};

use crate::failure::{Failure, Outcome};
use crate::frames::{FrameList, patterns};
use crate::print;
use crate::scene_report::{scene_failure, scene_warnings};
use summary::{ExposureJson, FrameJson, describe, warnings};

/// Expose a spectral picture on an image sensor: digital numbers with photon noise.
///
/// The picture needs spectral bands (`etalon render --bands`). The sensor is a JSON file: quantum efficiencies, mosaic, full well, gain, and
/// every noise of the linear camera model of EMVA Standard 1288. The same picture, sensor, seed and frame give the same file on every machine.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon expose room.exr --sensor scenes/sensors/colour.sensor.json -o raw.exr -o raw.png
  etalon expose room.exr --sensor mono.sensor.json --frames 0:15 -o raw-{frame:02}.exr")]
pub(crate) struct ExposeArgs {
    /// Picture with spectral bands, as EXR.
    picture: PathBuf,
    /// Sensor, as JSON.
    #[arg(long, value_name = "JSON", required = true)]
    sensor: PathBuf,
    /// File for the digital numbers: .exr, or .png with 16 bits. The option may be repeated.
    #[arg(short, long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    /// Seed of shot noise and read noise. The fixed pattern has a seed in the sensor's file.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Make exposures FIRST to LAST, each with other noise. The names of the outputs have {frame} where the number stands, {frame:04} for four
    /// digits. Default: exposure 0 alone.
    #[arg(long, value_name = "FIRST:LAST[:STEP]")]
    frames: Option<FrameList>,
    /// Keep the electrons in each pixel and the mean number of those that light raises, as channels of an EXR.
    #[arg(long)]
    electrons: bool,
    /// Number of threads. Default: all cores.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Print one JSON object on standard output.
    #[arg(long)]
    json: bool,
    /// Print only warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn run(args: ExposeArgs) -> Outcome {
    let frames = args.frames.clone().unwrap_or_else(|| FrameList::from(0));
    let patterns = patterns(&args.output, frames.numbers().len())?;
    check_outputs(&patterns.iter().map(|pattern| pattern.of(frames.numbers()[0])).collect::<Vec<_>>())?;
    let sensor = SensorFile::load(&args.sensor).map_err(refused)?;
    print::warnings(&scene_warnings(&sensor.file_name, &sensor.text, sensor.warnings.clone()));
    let file = read_exr(&args.picture).map_err(|error| Failure::input(Report::from_err(error)))?;
    let threads = args.threads.map_or(0, |threads| threads as usize);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Failure::run(miette!(code = "threads", "cannot start threads: {error}")))?;
    let exposure = pool.install(|| SensorExposure::new(&file, &sensor.sensor));
    let exposure = exposure.map_err(|error| cannot(&args.picture, error))?;

    let mut told = Vec::new();
    for (place, &number) in frames.numbers().iter().enumerate() {
        let settings = ExposureSettings { seed: args.seed, frame: number, electrons: args.electrons };
        let raw = pool.install(|| exposure.frame(&settings)).map_err(|error| cannot(&args.picture, error))?;
        let info = RawInfo {
            software: concat!("etalon ", env!("CARGO_PKG_VERSION")).to_owned(),
            sensor_json: sensor.text.clone(),
            sensor_sha256: sensor.sha256.clone(),
            seed: args.seed,
            frame: number,
        };
        if place == 0 {
            print::warnings(&warnings(&args.picture, &exposure, &raw));
        }
        let outputs: Vec<PathBuf> = patterns.iter().map(|pattern| pattern.of(number)).collect();
        for path in &outputs {
            write(path, &raw, &info, &file).map_err(|error| cannot(&args.picture, error))?;
        }
        if args.json {
            told.push(FrameJson::new(number, &outputs, &raw));
        } else if !args.quiet {
            // The files are written, whether anybody reads about them or not.
            print::line_if_read(&describe(&outputs, &raw, place == 0));
        }
    }
    if args.json {
        print::json(&ExposureJson::new(&args.picture, &args.sensor, &sensor.sha256, args.seed, told));
    }
    Ok(())
}

/// A kind of file for digital numbers.
enum RawKind {
    Exr,
    Png,
}

impl RawKind {
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        match extension.as_str() {
            "exr" => Some(Self::Exr),
            "png" => Some(Self::Png),
            _ => None,
        }
    }
}

/// Refuses files that are not of a kind that is written, or that cannot be written.
fn check_outputs(paths: &[PathBuf]) -> Outcome {
    let mut failure = Failure::default();
    for path in paths {
        if RawKind::of(path).is_none() {
            failure.add(Failure::input(miette!(
                code = "output-format",
                help = "name it .exr for all channels as floats, .png for one or three numbers of 16 bits",
                "`{}` does not end in .exr or .png",
                path.display()
            )));
        } else if let Err(error) = check_writable(path) {
            failure.add(Failure::run(Report::from_err(error)));
        }
    }
    failure.into_outcome()
}

fn write(path: &Path, raw: &RawFrame, info: &RawInfo, source: &ExrFile) -> Result<(), PictureError> {
    match RawKind::of(path) {
        Some(RawKind::Png) => {
            let texts = info.texts();
            let texts: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (*name, text.as_str())).collect();
            write_png16(path, &raw.samples16()?, &texts)
        }
        _ => write_exr(path, &raw.picture, &info.attributes(&source.attributes)),
    }
}

/// A picture that cannot be exposed as it was asked for is the input's fault, a file that cannot be written is not.
fn cannot(picture: &Path, error: PictureError) -> Failure {
    match error {
        PictureError::Expose { why } => {
            Failure::input(miette!(code = "expose", "cannot expose `{}`: {why}", picture.display()))
        }
        other => Failure::run(Report::from_err(other)),
    }
}

/// Why there is no sensor.
fn refused(error: LoadError) -> Failure {
    match error {
        LoadError::Io { path, source } => {
            Failure::input(Report::from_err(source).wrap_err(format!("cannot read the sensor `{}`", path.display())))
        }
        LoadError::Invalid(errors) => scene_failure(errors),
    }
}
