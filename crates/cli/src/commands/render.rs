//! `etalon render`: a scene in, a picture out.

mod checkpoint;
mod preflight;
mod report;
mod resume;
mod run;
mod sequence;
mod setup;
mod warnings;
mod watcher;

use std::path::PathBuf;

use etalon::Aov;
use etalon_control::{Canvas, Ended, Explored, Limits, SettleError};
use etalon_transport::{Features, ImageError};
use miette::{Report, miette};
use serde::Serialize;

use crate::args::{Adaptive, Crop, PixelAt, ShardArg};
use crate::developing::Developing;
use crate::display::{self, Display};
use crate::failure::{Failure, Outcome};
use crate::frames::{FrameArgs, asks_for_number, numbered};
use crate::interrupt::Interrupt;
use crate::light::NO_LIGHT_HELP;
use crate::machine::ClockKind;
use crate::output::{self, Output, Written};
use crate::overrides::Overrides;
use crate::print;
use crate::problem_json::{ProblemJson, problems_json};
use crate::progress::RenderBar;
use crate::state::Header;
use crate::write_outputs::Delivery;
use checkpoint::{interrupted, keep, moved};
use run::Run;
use sequence::InSequence;
pub(crate) use setup::check_shares;
use setup::{Job, set_up};
use watcher::{ProgressKind, Watcher};

/// Render a scene to EXR and PNG files.
///
/// The scene says how many samples each pixel takes. --spp, --error and --time replace this number. If several are given, the limit that is
/// reached first ends the render.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon render scenes/cornell.json --spp 64 -o cornell.exr -o cornell.png
  etalon render scenes/cornell.json --error 2% -o cornell.exr
  etalon render scenes/cornell.json --time 30s --exposure auto --curve agx -o cornell.png")]
pub(crate) struct RenderArgs {
    /// Scene as JSON. It may also be a model (glTF 2.0, OBJ or PLY) or a scene of Mitsuba 3 (.xml) or pbrt-v4 (.pbrt); see `etalon import`.
    /// `-` reads JSON from standard input.
    scene: PathBuf,
    /// File to write. Repeat the option to write several. An .exr holds the linear picture with its error bars, a .png is for a screen, a
    /// .part is for `etalon merge`. Default: the name of the scene with .exr, in the current folder. This replaces a picture of
    /// Etalon, but no other file.
    #[arg(short, long, alias = "outfile", value_name = "FILE")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    frames: FrameArgs,
    #[command(flatten)]
    overrides: Overrides,
    /// Stop at this relative error, such as 2%. It is the root mean square over all pixels of the standard error of luminance, divided by the
    /// mean luminance. A pilot predicts the number of samples; its own samples are discarded.
    #[arg(long, value_name = "PERCENT", value_parser = crate::args::percentage)]
    error: Option<f64>,
    /// Stop after this time, such as 90s or 1h30m. A plain number is in seconds.
    #[arg(long, value_name = "TIME", value_parser = crate::args::seconds)]
    time: Option<f64>,
    /// Whether noisy regions get more samples. A short exploration decides before the render; its own samples are discarded. The mean
    /// number of samples per pixel stays the same.
    #[arg(long, value_enum, value_name = "WHEN", default_value_t = Adaptive::Auto)]
    adaptive: Adaptive,
    /// Clock for --time and for reports.
    #[arg(long, value_enum, default_value_t = ClockKind::Wall)]
    clock: ClockKind,
    /// Number of threads. Default: all cores. It does not change the picture.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// More channels for the EXR, separated by commas: properties of the first surface, or of the samples.
    #[arg(long, value_enum, value_name = "CHANNELS", value_delimiter = ',')]
    aov: Vec<Aov>,
    /// Write only the channels of --aov to the EXR.
    #[arg(long, requires = "aov")]
    only: bool,
    /// Render only a part: W × H pixels from column X and row Y, counted from 0 at the top left. The EXR states where they belong.
    #[arg(long, value_name = "X,Y,W,H")]
    crop: Option<Crop>,
    /// Save the unfinished render at this interval, such as 60s, to OUTPUT.checkpoint. OUTPUT is the first output.
    #[arg(long, value_name = "TIME", value_parser = crate::args::seconds)]
    checkpoint: Option<f64>,
    /// Continue from OUTPUT.checkpoint, if it exists. The picture is the same as without the interruption.
    #[arg(long)]
    resume: bool,
    /// Render share K of N of the picture, such as 3/16. Write it to a .part file. `etalon merge` joins the parts. With --frames,
    /// render every N-th frame from the K-th on.
    #[arg(long, value_name = "K/N")]
    shard: Option<ShardArg>,
    /// Render nothing. Trace one path of this pixel and print it vertex by vertex. X and Y count from 0 at the top left.
    #[arg(long, value_name = "X,Y", conflicts_with_all = ["output", "crop", "error", "time", "checkpoint", "resume", "shard"])]
    pixel: Option<PixelAt>,
    /// Number of the path within --pixel, from 0. Default: 0.
    #[arg(long, value_name = "K")]
    sample: Option<u32>,
    /// Show the picture in the viewer tev during the render. Without a HOST:PORT it is 127.0.0.1:14158.
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true, default_missing_value = display::DEFAULT)]
    display_server: Option<String>,
    /// How to show progress.
    #[arg(long, value_enum, default_value_t = ProgressKind::Bar, conflicts_with_all = ["json", "quiet"])]
    progress: ProgressKind,
    /// Print one JSON object on standard output, with the report or the errors. Shows no progress.
    #[arg(long)]
    json: bool,
    /// Print only warnings and errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    developing: Developing,
}

/// What `--json` prints when there is no render to speak of.
#[derive(Serialize)]
struct RefusedJson {
    scene: String,
    errors: Vec<ProblemJson>,
}

pub(crate) fn run(mut args: RenderArgs) -> Outcome {
    let names_itself = args.output.is_empty() && args.pixel.is_none();
    if names_itself {
        let name = output::of_scene(&args.scene);
        args.output.push(if args.frames.frames.is_some() { numbered(&name) } else { name });
    }
    let result = match (args.pixel, args.sample) {
        (Some(pixel), sample) => replay(&args, pixel, sample.unwrap_or(0)),
        (None, None) if args.frames.frames.is_some() => sequence::render(&mut args, names_itself),
        _ if let Some(name) = args.output.iter().find(|name| asks_for_number(name)) => {
            Err(Stop::Refused(Failure::input(miette!(
                code = "frame-name",
                help = "add the frames, such as --frames 0:99",
                "`{}` has the number of a frame in it, and --frames is not given",
                name.display()
            ))))
        }
        _ if names_itself && let Err(foreign) = output::check_own(&args.output[0]) => Err(Stop::Refused(foreign)),
        (None, Some(_)) => {
            let failure = miette!(
                code = "sample-without-pixel",
                "--sample needs --pixel: it chooses one of the paths of that pixel"
            );
            Err(Stop::Refused(Failure::input(failure)))
        }
        (None, None) => render(&args),
    };
    match result {
        Ok(()) => Ok(()),
        Err(Stop::Refused(failure)) => {
            if args.json {
                print::json(&RefusedJson { scene: args.scene.display().to_string(), errors: problems_json(&failure) });
            }
            Err(failure)
        }
        Err(Stop::Reported(failure)) => Err(failure),
    }
}

/// Why a render ended early.
enum Stop {
    /// Nothing was rendered, and nothing said about it on standard output.
    Refused(Failure),
    /// The picture was rendered and the report printed, but something went wrong after that.
    Reported(Failure),
}

fn render(args: &RenderArgs) -> Result<(), Stop> {
    let mut outputs = Vec::new();
    let mut job = set_up(args, &mut outputs).map_err(Stop::Refused)?;
    print::warnings(&job.warnings);
    let interrupt = listen().map_err(Stop::Refused)?;
    let bar = RenderBar::new(job.rect, args.time, args.error, args.quiet || args.json);
    let rendered = render_job(args, &mut job, &outputs, &interrupt, &bar, None).map_err(Stop::Refused)?;
    let Rendered { done, written, failure, begun } = rendered;
    if args.json {
        print::json(&report::json(args, &job, &done, &written, &failure));
    } else if !args.quiet && begun {
        // The picture is written, whether anybody reads about it or not.
        print::line_if_read(&report::summary(&job, &done, &written));
    }
    failure.into_outcome().map_err(Stop::Reported)
}

fn listen() -> Result<Interrupt, Failure> {
    Interrupt::listen().map_err(|error| Failure::run(Report::from_err(error).wrap_err("cannot listen to signals")))
}

/// What became of a render.
struct Rendered {
    done: Done,
    written: Vec<Written>,
    /// What went wrong after it had begun.
    failure: Failure,
    /// Whether there is anything of the picture.
    begun: bool,
}

/// Renders a picture and writes it, and keeps what there is of it if it is interrupted. A frame of a sequence is only written once it is
/// finished.
fn render_job(
    args: &RenderArgs,
    job: &mut Job,
    outputs: &[Output],
    interrupt: &Interrupt,
    bar: &RenderBar,
    frame: Option<&InSequence>,
) -> Result<Rendered, Failure> {
    let limits = limits(args, job);
    let display = args.display_server.as_ref().and_then(|address| {
        let name = args.output.first().map_or_else(|| "etalon".to_owned(), |output| output.display().to_string());
        Display::open(address, &name, job.subject.size, job.subject.replicates)
    });
    let openjd = (args.progress == ProgressKind::Openjd).then(|| frame.map_or([0, 1], |frame| frame.position));
    let watch = Watcher::new(bar, interrupt, display.as_ref(), openjd);
    let run = match job.resumed.take() {
        Some(kept) => Run::taken_up(args, job, kept, limits),
        None => Run::new(args, job, limits, &watch),
    };
    let done = run.and_then(|run| run.finish(args, job, &watch));
    bar.clear();
    let mut done = done.map_err(not_rendered)?;
    if let Some(display) = display {
        done.canvas.with_film(|film| display.finish(film, job.rect));
    }

    let noticed = done.canvas.with_film(|film| warnings::of(args, film, job.rect));
    print::warnings(&noticed);
    job.warnings.extend(noticed);
    done.error = done.canvas.with_film(|film| film.error(job.rect));
    let delivery = Delivery {
        header: &done.header,
        canvas: &done.canvas,
        features: &done.features,
        samples: done.ended.samples,
        error: done.error,
        developing: &args.developing,
        frame: frame.map(|frame| &frame.settings),
    };
    let begun = done.canvas.samples()[1] > 0;
    let is_to_be_written = begun && (done.header.complete || frame.is_none());
    let (written, mut failure) = if is_to_be_written { delivery.write(outputs) } else { Default::default() };
    let kept = keep(args, &done, &failure, begun);
    if let Some(signal) = interrupt.signal().filter(|_| !done.header.complete) {
        failure.add(interrupted(args, signal, &done, &written, kept.as_ref()));
    } else if let Some(kept) = kept {
        failure.add(match kept {
            Ok(path) => Failure::run(miette!(
                code = "kept",
                help = format!(
                    "{}the same command with --resume writes the pictures without rendering again",
                    moved(args, &path)
                ),
                "the render is kept in `{}`",
                path.display()
            )),
            Err(failure) => failure,
        });
    }
    Ok(Rendered { done, written, failure, begun })
}

/// Why there is no picture.
fn not_rendered(error: SettleError) -> Failure {
    Failure::run(match error {
        SettleError::Threads(error) => Report::from_err(error),
        SettleError::NoLight { .. } => miette!(
            code = "no-light",
            help = format!("add --spp or --time to render the picture without knowing its error; {NO_LIGHT_HELP}"),
            "{error}"
        ),
    })
}

/// A render that is done, and how wrong it is.
struct Done {
    ended: Ended,
    canvas: Canvas,
    header: Header,
    /// Of each tile, where a channel wants them.
    features: Vec<Vec<Features>>,
    error: Option<ImageError>,
    /// How it was decided where the samples go; not known of a render that was taken up.
    explored: Option<Explored>,
}

/// What ends the render. The scene's own number of samples counts where the command line says nothing.
fn limits(args: &RenderArgs, job: &Job) -> Limits {
    let otherwise = args.error.is_some() || args.time.is_some();
    let samples = match args.overrides.spp() {
        Some(spp) => spp,
        None if otherwise => Limits::ANY_SAMPLES,
        None => job.loaded.scene.integrator.spp,
    };
    Limits { samples, relative_rmse: args.error, seconds: args.time, adaptivity: args.adaptive.into() }
}

/// One path again, vertex by vertex.
fn replay(args: &RenderArgs, pixel: PixelAt, sample: u32) -> Result<(), Stop> {
    let job = set_up(args, &mut Vec::new()).map_err(Stop::Refused)?;
    print::warnings(&job.warnings);
    let path = job.prepared.replay(pixel.x, pixel.y, sample);
    if args.json {
        print::json(&path);
    } else {
        print::line(&crate::replay_text::describe(&path));
    }
    Ok(())
}
