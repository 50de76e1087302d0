//! `etalon quote`: what accuracy will cost, before it is paid for.

mod sequence;

use std::fmt::Write;
use std::path::PathBuf;

use etalon::{CostEstimate, Quote, QuoteSettings, RenderError};
use etalon_transport::{Prepared, prepare_study};
use miette::{Report, miette};
use serde::Serialize;

use crate::args::{Adaptive, percentage};
use crate::failure::{Failure, Outcome};
use crate::frames::FrameArgs;
use crate::light::NO_LIGHT_HELP;
use crate::load::{LoadedScene, load};
use crate::machine::{Clock, ClockKind, Machine};
use crate::overrides::Overrides;
use crate::print;
use crate::progress::{duration, percent, two_digits};

/// Predict the samples and the time for each accuracy, on this machine.
///
/// A pilot renders the scene for a few seconds. From it the command predicts how many samples per pixel, and how much time, a picture of each
/// relative error takes. Intervals are at 95 % confidence.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon quote scenes/cornell.json --error 5%,1% --pilot 5s")]
pub(crate) struct QuoteArgs {
    /// Scene as JSON, or a model (see `etalon render`).
    scene: PathBuf,
    #[command(flatten)]
    frames: FrameArgs,
    #[command(flatten)]
    overrides: Overrides,
    /// Relative errors to predict the cost of, separated by commas.
    #[arg(long = "error", value_name = "PERCENT", value_delimiter = ',', value_parser = percentage,
        default_values = ["10%", "5%", "2%", "1%", "0.5%", "0.1%"])]
    errors: Vec<f64>,
    /// Maximum time of the pilot, such as 10s.
    #[arg(long, value_name = "TIME", value_parser = crate::args::seconds, default_value = "10s")]
    pilot: f64,
    /// Whether noisy regions get more samples, as in `etalon render`.
    #[arg(long, value_enum, value_name = "WHEN", default_value_t = Adaptive::Auto)]
    adaptive: Adaptive,
    /// Number of threads. Default: all cores.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Clock of the predicted times.
    #[arg(long, value_enum, default_value_t = ClockKind::Wall)]
    clock: ClockKind,
    /// Print one JSON object on standard output.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct QuoteJson {
    scene: String,
    scene_sha256: String,
    width: u32,
    height: u32,
    machine: Machine,
    pilot: PilotJson,
    /// The exploration of where the error is; `null` if it was not wanted.
    adaptive: Option<AdaptiveJson>,
    /// Seconds before the first sample.
    prepare_seconds: f64,
    /// What `etalon render --error` takes beside the seconds of a price, in units of these: its own exploration and pilot.
    settling_share: f64,
    estimates: Vec<CostEstimateJson>,
}

#[derive(Serialize)]
struct PilotJson {
    seconds: f64,
    /// The error of the whole picture as the pilot saw it grow smaller.
    points: Vec<PointJson>,
}

#[derive(Serialize)]
struct AdaptiveJson {
    /// Factor of time that uneven shares are predicted to win.
    predicted_gain: f64,
    /// Whether the prices are for such shares.
    used: bool,
    seconds: f64,
}

#[derive(Serialize)]
struct PointJson {
    samples: u32,
    /// `null` as long as no light was found.
    relative_rmse: f64,
    /// Relative standard error of `relative_rmse`; `null` if it is unknown.
    uncertainty: f64,
    seconds: f64,
}

#[derive(Serialize)]
struct CostEstimateJson {
    relative_rmse: f64,
    samples: f64,
    samples_interval: [f64; 2],
    seconds: f64,
    seconds_interval: [f64; 2],
}

pub(crate) fn run(args: QuoteArgs) -> Outcome {
    let mut loaded = load(&args.scene, args.overrides.film_size(), args.overrides.parameters())?;
    args.overrides.apply(&mut loaded.scene)?;
    print::warnings(&loaded.warnings);
    if let Some(list) = &args.frames.frames {
        return sequence::run(&args, list, loaded);
    }
    let clock = Clock::start(args.clock, threads(&args));
    let prepared = prepare_study(&loaded.scene, &args.overrides.study())
        .map_err(|error| Failure::input(Report::from_err(error)))?;
    let prepare_seconds = clock.seconds();
    let quote = quote(&args, &loaded, &prepared, (&clock, args.pilot, prepare_seconds))?;
    if args.json {
        print::json(&quote);
    } else {
        print::line(&describe(&quote));
    }
    Ok(())
}

fn threads(args: &QuoteArgs) -> usize {
    args.threads.map_or_else(rayon::current_num_threads, |threads| threads as usize)
}

/// Pilots a scene that is ready for this many seconds.
fn quote(
    args: &QuoteArgs,
    loaded: &LoadedScene,
    prepared: &Prepared,
    (clock, pilot_seconds, prepare_seconds): (&Clock, f64, f64),
) -> Result<QuoteJson, Failure> {
    let settings = QuoteSettings {
        errors: args.errors.clone(),
        pilot_seconds,
        adaptivity: args.adaptive.into(),
        threads: Some(threads(args)),
    };
    let found = Quote::of(prepared, &settings, &|| clock.seconds()).map_err(refused)?;
    let film = &loaded.scene.film;
    Ok(QuoteJson {
        scene: args.scene.display().to_string(),
        scene_sha256: loaded.sha256.clone(),
        width: film.width,
        height: film.height,
        machine: Machine::with_threads(threads(args)),
        pilot: PilotJson {
            seconds: found.pilot_seconds,
            points: found
                .points
                .iter()
                .map(|p| PointJson {
                    samples: p.samples,
                    relative_rmse: p.relative_rmse,
                    uncertainty: p.uncertainty,
                    seconds: p.seconds,
                })
                .collect(),
        },
        settling_share: found.settling_share,
        adaptive: found.exploration.map(|exploration| AdaptiveJson {
            predicted_gain: exploration.predicted_gain,
            used: exploration.used,
            seconds: exploration.seconds,
        }),
        prepare_seconds,
        estimates: found.estimates.iter().map(cost_estimate_json).collect(),
    })
}

/// Why there is no quote.
fn refused(error: RenderError) -> Failure {
    match error {
        RenderError::PathReuse(_) => Failure::input(miette!(
            code = "path-reuse",
            help = "leave out --path-reuse, and \"path_reuse\" in the scene",
            "a quote needs independent pixels, and path reuse makes neighbouring pixels share paths"
        )),
        RenderError::NoLight { paths } => Failure::run(miette!(
            code = "no-light",
            help = format!("a longer pilot may find some: --pilot 60s; {NO_LIGHT_HELP}"),
            "the pilot found no light in {paths} paths, so the cost of an error is unknown",
        )),
        other => Failure::run(Report::from_err(other)),
    }
}

fn cost_estimate_json(cost_estimate: &CostEstimate) -> CostEstimateJson {
    CostEstimateJson {
        relative_rmse: cost_estimate.relative_rmse,
        samples: cost_estimate.samples,
        samples_interval: cost_estimate.samples_interval,
        seconds: cost_estimate.seconds,
        seconds_interval: cost_estimate.seconds_interval,
    }
}

fn describe(quote: &QuoteJson) -> String {
    let mut text = format!(
        "{}, {} × {} pixels, on {} threads of {}, {}\n\n{:>8} {:>10}  {:<22} {:>10}  {}\n",
        quote.scene,
        quote.width,
        quote.height,
        quote.machine.threads,
        quote.machine.processor,
        quote.machine.software,
        "error",
        "samples",
        "(95 % sure)",
        "time",
        "(95 % sure)",
    );
    for cost_estimate in &quote.estimates {
        let between = |interval: [f64; 2], show: &dyn Fn(f64) -> String| {
            format!("{} to {}", show(interval[0]), show(interval[1]))
        };
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:>8} {:>10}  {:<22} {:>10}  {}",
            percent(cost_estimate.relative_rmse),
            two_digits(cost_estimate.samples),
            between(cost_estimate.samples_interval, &two_digits),
            duration(cost_estimate.seconds),
            between(cost_estimate.seconds_interval, &duration),
        );
    }
    let _ = write!(
        text,
        "\nThe error is the root mean square over all pixels of the standard error of luminance, in units of the picture's\n\
         mean luminance. Samples are per pixel. The pilot took {}, preparing the scene {}.\n\
         `etalon render --error` finds the number of samples itself. This takes about {} more time.",
        duration(quote.pilot.seconds),
        duration(quote.prepare_seconds),
        percent(quote.settling_share),
    );
    if let Some(adaptive) = quote.adaptive.as_ref().filter(|adaptive| adaptive.used) {
        let _ = write!(
            text,
            " Noisy regions\nget more samples. This is predicted to be {:.1} times as fast as the same number of samples in every pixel.",
            adaptive.predicted_gain
        );
    }
    text
}
