//! `etalon measure`: what the meters of a scene show.

mod table;

use std::path::PathBuf;

use etalon::{
    MOST_METER_SAMPLES, MeasureSettings, Measurement, MeterError, MeterReader, RenderError, Study,
    picture_files::{check_writable, write_atomically},
};
use etalon_scene::Scene;
use etalon_transport::Control;
use miette::{Report, miette};

use crate::args::percentage;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::load::load;
use crate::print;
use table::{Readings, csv};

/// The relative error of readings where neither it nor a number of samples is given.
const ERROR: f64 = 0.01;

/// Read the meters of a scene: irradiance and illuminance at points and on grids, flux, radiance and luminance.
///
/// The meters stand in the key "meters" of the scene. Each reading comes in radiometric units over all wavelengths that are rendered, and in
/// photometric units with the CIE 1931 2° observer and 683.002 lm/W. Its standard error is the scatter of 32 independent replicates.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon measure scenes/meters.json
  etalon measure scenes/meters.json --error 0.2% -o readings.csv -o readings.json")]
pub(crate) struct MeasureArgs {
    /// Scene as JSON.
    scene: PathBuf,
    /// File for the readings, .csv or .json. The option may be repeated.
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Relative standard error of each reading at which to stop, such as 0.5%. Default: 1%, if --spp is not given.
    #[arg(long, value_name = "PERCENT", value_parser = percentage)]
    error: Option<f64>,
    /// Maximum number of samples of each reading, such as 4096 or 1e6, rounded up to a multiple of 32.
    #[arg(long, value_name = "N", value_parser = crate::args::samples)]
    spp: Option<u32>,
    /// Seed of the random numbers. Default: what the scene says.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Largest number of path edges from the meter to a light: 1 is direct light. Default: what the scene says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,
    /// Trace the polarisation of light. Without it, surfaces average s and p polarisation.
    #[arg(long)]
    polarised: bool,
    /// Number of threads. Default: all cores.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Print one JSON object on standard output instead of a table.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: MeasureArgs) -> Outcome {
    let mut failure = Failure::default();
    for path in &args.output {
        if let Err(problem) = FileKind::of(path).and_then(|_| check_writable(path).map_err(unwritable)) {
            failure.add(problem);
        }
    }
    failure.into_outcome()?;
    let mut loaded = load(&args.scene, None, &[])?;
    print::warnings(&loaded.warnings);
    apply(&args, &mut loaded.scene);
    let study = Study { polarised: args.polarised, ..Study::default() };
    let reader = MeterReader::new(&loaded.scene, &study).map_err(refused)?;
    let interrupt = Interrupt::listen()
        .map_err(|error| Failure::run(Report::from_err(error).wrap_err("cannot listen to signals")))?;
    let settings = MeasureSettings {
        samples: args.spp.unwrap_or(MOST_METER_SAMPLES),
        error: args.error.or(args.spp.is_none().then_some(ERROR)),
        threads: args.threads.map(|threads| threads as usize),
    };
    let control = || if interrupt.signal().is_some() { Control::Stop } else { Control::Continue };
    let measurement = reader.read(&settings, &control).map_err(stopped)?;
    if measurement.interrupted {
        let signal = interrupt.signal().expect("nothing else ends a measurement early");
        return Err(Failure::signal(
            signal,
            miette!(code = "interrupted", "interrupted: the readings are not complete"),
        ));
    }
    let readings = Readings::new(&args.scene.display().to_string(), &loaded.sha256, &loaded.scene, &measurement);
    for path in &args.output {
        let text = match FileKind::of(path)? {
            FileKind::Csv => csv(&readings),
            FileKind::Json => readings.json() + "\n",
        };
        write_atomically(path, |out| out.write_all(text.as_bytes())).map_err(unwritable)?;
    }
    if args.json {
        print::json(&readings);
    } else {
        print::line(&readings.table());
    }
    warn(&measurement, &settings);
    Ok(())
}

/// Puts what the command line says into the scene.
fn apply(args: &MeasureArgs, scene: &mut Scene) {
    if let Some(seed) = args.seed {
        scene.integrator.seed = seed;
    }
    if args.max_depth.is_some() {
        scene.integrator.max_depth = args.max_depth;
    }
}

fn warn(measurement: &Measurement, settings: &MeasureSettings) {
    if !measurement.reached {
        let error = crate::progress::percent(settings.error.unwrap_or(ERROR));
        print::note(&format!(
            "The error of {error} is not reached with {} samples of each reading. More samples, or an error that is larger, end this.",
            measurement.samples
        ));
    }
    if measurement.nonfinite > 0 {
        print::note(&format!("{} samples were not finite and are left out.", measurement.nonfinite));
    }
}

/// A kind of file that readings are written to.
enum FileKind {
    Csv,
    Json,
}

impl FileKind {
    fn of(path: &std::path::Path) -> Result<Self, Failure> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("json") => Ok(Self::Json),
            _ => Err(Failure::input(miette!(
                code = "output-format",
                help = "name it .csv for a table, .json for an object",
                "`{}` is not a kind of file that readings can be written to",
                path.display()
            ))),
        }
    }
}

fn unwritable(error: etalon::picture_files::PictureError) -> Failure {
    Failure::run(Report::from_err(error))
}

fn refused(error: MeterError) -> Failure {
    match error {
        MeterError::NoMeters => Failure::input(miette!(
            code = "no-meters",
            help = "add a key \"meters\", such as [{ \"type\": \"irradiance\", \"position_m\": [0, 0, 0], \"normal\": [0, 1, 0] }]",
            "the scene has no meters"
        )),
        other => Failure::input(Report::from_err(other)),
    }
}

fn stopped(error: RenderError) -> Failure {
    match error {
        RenderError::Setting(_) => Failure::input(Report::from_err(error)),
        other => Failure::run(Report::from_err(other)),
    }
}
