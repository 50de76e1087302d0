//! `etalon render`: a scene in, a picture out.

mod report;
mod resume;
mod room;
mod run;
mod warnings;
mod watcher;

use std::path::{Path, PathBuf};
use std::time::Instant;

use etalon_transport::canvas::tiles_of;
use etalon_transport::{
    Adaptivity, Canvas, Ended, Explored, Features, ImageError, Limits, PixelRect, Prepared, Shard, prepare_study,
};
use miette::{Report, miette};
use serde::{Deserialize, Serialize};

use crate::args::{Crop, PixelAt, ShardArg};
use crate::channels::{Aov, Channels};
use crate::deliver::Delivery;
use crate::display::{self, Display};
use crate::failure::{Failure, Outcome, ProblemJson};
use crate::interrupt::Interrupt;
use crate::load::{LoadedScene, load};
use crate::machine::ClockKind;
use crate::output::{self, Output};
use crate::overrides::Overrides;
use crate::print;
use crate::progress::RenderBar;
use crate::state::{self, Header, Kept, Subject};
use run::Run;
use watcher::{ProgressKind, Watcher};

/// Renders a scene to EXR and PNG files.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The scene, as JSON (see `etalon schema`), or a model: glTF 2.0 (.glb, .gltf), OBJ or PLY.
    scene: PathBuf,
    /// Picture to write: .exr keeps the linear picture and all that is known about it, .png is what a screen shows, .part
    /// the sums themselves. Give it twice to write both.
    #[arg(short, long, alias = "outfile", value_name = "FILE", required_unless_present = "pixel")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    overrides: Overrides,
    /// End when the relative error is this small. A pilot, none of whose samples are kept, tells how many samples that
    /// takes; the scene's own number of samples does not count then. Of --error, --time and --spp the first one wins.
    #[arg(long, value_name = "PERCENT", value_parser = crate::args::percentage)]
    error: Option<f64>,
    /// End when this time is up, such as 90s or 1h30m; the scene's own number of samples does not count then.
    #[arg(long, value_name = "TIME", value_parser = crate::args::seconds)]
    time: Option<f64>,
    /// Whether regions with more error take more samples. An exploration, none of whose samples are kept, decides it before the
    /// picture begins; the mean number of samples a pixel is that of --spp all the same.
    #[arg(long, value_enum, value_name = "WHEN", default_value_t = Adaptive::Auto)]
    adaptive: Adaptive,
    /// Which clock counts for --time and for reports: that on the wall, or the processor's over the number of threads, which
    /// other programs do not slow down.
    #[arg(long, value_enum, default_value_t = ClockKind::Wall)]
    clock: ClockKind,
    /// Threads; all cores if not given. The picture is the same whatever their number.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Exposure of PNG files, in stops: each doubles the light. EXR files stay as they are.
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true, value_parser = crate::args::finite)]
    exposure: f64,
    /// Channels that the EXR has beside the picture: of the first surface that is met, or of the samples.
    #[arg(long, value_enum, value_name = "CHANNELS", value_delimiter = ',')]
    aov: Vec<Aov>,
    /// Write no channels but those of --aov to the EXR.
    #[arg(long, requires = "aov")]
    only: bool,
    /// Render only these pixels: columns from X0 up to but not including X1, rows from Y0 to Y1, counted from the top
    /// left. The EXR remembers where they belong.
    #[arg(long, value_name = "X0,X1,Y0,Y1")]
    crop: Option<Crop>,
    /// Keep what is rendered in a file beside the first output, OUTPUT.checkpoint, each time so much time has passed.
    #[arg(long, value_name = "TIME", value_parser = crate::args::seconds)]
    checkpoint: Option<f64>,
    /// Go on from OUTPUT.checkpoint, if there is one; the picture is the same, byte for byte.
    #[arg(long)]
    resume: bool,
    /// Render one share of the picture's tiles only, the K-th of N: an output that ends in .part is for `etalon merge`.
    #[arg(long, value_name = "K/N", conflicts_with = "time")]
    shard: Option<ShardArg>,
    /// Trace one path of this pixel again and print it vertex by vertex, instead of rendering.
    #[arg(long, value_name = "X,Y", requires = "sample", conflicts_with_all = ["output", "crop", "error", "time", "checkpoint", "resume", "shard"])]
    pixel: Option<PixelAt>,
    /// Which of the pixel's paths.
    #[arg(long, value_name = "K")]
    sample: Option<u32>,
    /// Show the picture in tev while it is rendered; 127.0.0.1:14158 if no HOST:PORT is given.
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true, default_missing_value = display::DEFAULT)]
    display_server: Option<String>,
    /// How progress is shown: as a bar on a terminal, or as lines on standard output that a farm reads.
    #[arg(long, value_enum, default_value_t = ProgressKind::Bar, conflicts_with_all = ["json", "quiet"])]
    progress: ProgressKind,
    /// Print one JSON object on standard output, about the render or about what is wrong, and no progress.
    #[arg(long)]
    json: bool,
    /// Print nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// When samples are spread by an exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Adaptive {
    /// With --error, where the exploration foretells that the error is reached sooner.
    Auto,
    /// In any case.
    Always,
    /// Every pixel takes the same number of samples.
    Never,
}

impl Adaptive {
    /// What it comes to where a relative error is asked for, or none: "auto" without one is "never".
    fn effective(self, error: Option<f64>) -> Self {
        if self == Self::Auto && error.is_none() { Self::Never } else { self }
    }

    /// The word of the command line.
    fn word(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Always => "always",
            Self::Never => "never",
        }
    }
}

impl From<Adaptive> for Adaptivity {
    fn from(adaptive: Adaptive) -> Self {
        match adaptive {
            Adaptive::Auto => Self::Auto,
            Adaptive::Always => Self::Always,
            Adaptive::Never => Self::Never,
        }
    }
}

/// What `--json` prints when there is no render to speak of.
#[derive(Serialize)]
struct RefusedJson {
    scene: String,
    errors: Vec<ProblemJson>,
}

pub(crate) fn run(args: Args) -> Outcome {
    let result = match (args.pixel, args.sample) {
        (Some(pixel), Some(sample)) => replay(&args, pixel, sample),
        // clap waives the requirement because --pixel would conflict with --output.
        (None, Some(_)) => {
            let failure = miette!(code = "sample-without-pixel", "--sample says which path of --pixel to trace again");
            Err(Stop::Refused(Failure::input(failure)))
        }
        (_, None) => render(&args),
    };
    match result {
        Ok(()) => Ok(()),
        Err(Stop::Refused(failure)) => {
            if args.json {
                print::json(&RefusedJson { scene: args.scene.display().to_string(), errors: failure.to_json() });
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

/// A scene ready to be rendered.
struct Job {
    loaded: LoadedScene,
    prepared: Prepared,
    prepare_seconds: f64,
    warnings: Vec<Report>,
    rect: PixelRect,
    threads: usize,
    subject: Subject,
    /// A checkpoint to go on from.
    resumed: Option<Kept>,
}

/// Does all that can fail before the work, and collects all that is wrong.
fn set_up(args: &Args, outputs: &mut Vec<Output>) -> Result<Job, Failure> {
    let mut failure = Failure::default();
    *outputs = output::plan(&args.output, &mut failure);
    let mut loaded = match load(&args.scene, args.overrides.film_size()) {
        Ok(loaded) => loaded,
        Err(scene_failure) => {
            failure.add(scene_failure);
            return Err(failure);
        }
    };
    if let Err(wrong) = args.overrides.apply(&mut loaded.scene) {
        failure.add(wrong);
        return Err(failure);
    }
    room::check_memory(&loaded.scene, loaded.scene.film.stokes || args.overrides.polarised(), &mut failure);
    let film = &loaded.scene.film;
    let whole = PixelRect { x0: 0, y0: 0, x1: film.width, y1: film.height };
    let rect = args.crop.map_or(whole, |crop| crop.0);
    if rect.x1 > whole.x1 || rect.y1 > whole.y1 {
        failure.add(Failure::input(miette!(
            code = "crop-outside",
            "the crop reaches to column {} and row {} of a picture of {} × {} pixels",
            rect.x1,
            rect.y1,
            whole.x1,
            whole.y1
        )));
    }
    if let Some(PixelAt { x, y }) = args.pixel.filter(|at| at.x >= whole.x1 || at.y >= whole.y1) {
        failure.add(Failure::input(miette!(
            code = "pixel-outside",
            "pixel {x},{y} is not in a picture of {} × {} pixels",
            whole.x1,
            whole.y1
        )));
    }
    let start = Instant::now();
    let prepared = match prepare_study(&loaded.scene, &args.overrides.study()) {
        Ok(prepared) => prepared,
        Err(error) => {
            failure.add(Failure::input(Report::from_err(error)));
            return Err(failure);
        }
    };
    if prepared.path_reuse().is_some()
        && (args.error.is_some() || args.adaptive == Adaptive::Always || args.pixel.is_some())
    {
        failure.add(Failure::input(miette!(
            code = "path-reuse",
            help = "leave out --path-reuse, or give --spp or --time",
            "where neighbouring pixels share paths, no path stands alone: --error, --adaptive always and --pixel trace single ones"
        )));
    }
    std::mem::take(&mut failure).into_outcome()?;
    let mut warnings = std::mem::take(&mut loaded.warnings);
    warnings.extend(
        prepared
            .warnings()
            .iter()
            .map(|warning| miette!(severity = miette::Severity::Warning, code = "prepare", "{warning}")),
    );
    warnings.extend(prepared.plan().approximations.iter().map(|lost| {
        miette!(
            severity = miette::Severity::Warning,
            code = "approximation",
            "the picture is an approximation, without {lost}"
        )
    }));
    if args.exposure != 0.0 && !outputs.iter().any(|output| output.format == output::Format::Png) {
        warnings.push(miette!(
            severity = miette::Severity::Warning,
            code = "exposure-unused",
            "--exposure changes PNG files only, and none is written"
        ));
    }
    let threads = args.threads.map_or_else(rayon::current_num_threads, |threads| threads as usize);
    let subject = Subject::new(&prepared, &loaded.sha256, rect);
    let prepare_seconds = start.elapsed().as_secs_f64();
    let shard = args.shard.map_or(Shard::WHOLE, |shard| shard.0);
    check_shard(args, rect, shard, outputs, &mut failure);
    let channels = Channels::new(&args.aov, args.only);
    room::check_disks(args.checkpoint.is_some(), &subject, &channels, outputs, &mut failure, &mut warnings);
    let resumed = if args.resume { resume::find(args, &subject, shard, &mut failure) } else { None };
    failure.into_outcome()?;
    if args.resume && resumed.is_none() {
        warnings.push(miette!(
            severity = miette::Severity::Warning,
            code = "nothing-to-resume",
            "there is no checkpoint, so the render starts from the beginning"
        ));
    }
    Ok(Job { loaded, prepared, prepare_seconds, warnings, rect, threads, subject, resumed })
}

/// A share must have tiles, and something must come of it.
fn check_shard(args: &Args, rect: PixelRect, shard: Shard, outputs: &[Output], failure: &mut Failure) {
    let tiles = tiles_of(rect, Shard::WHOLE).len();
    if shard.of as usize > tiles {
        failure.add(Failure::input(miette!(
            code = "shard-empty",
            "the picture has {tiles} tiles of 16 × 16 pixels and cannot be divided into {} shares",
            shard.of
        )));
    }
    if args.shard.is_some()
        && !outputs.is_empty()
        && !outputs.iter().any(|output| output.format == output::Format::Part)
    {
        failure.add(Failure::input(miette!(
            code = "shard-without-part",
            help = "add -o NAME.part; an EXR or a PNG beside it shows the share's tiles",
            "a share of a picture is merged from its .part file, and none is written"
        )));
    }
}

fn render(args: &Args) -> Result<(), Stop> {
    let mut outputs = Vec::new();
    let mut job = set_up(args, &mut outputs).map_err(Stop::Refused)?;
    print::warnings(&job.warnings);
    let interrupt = Interrupt::listen()
        .map_err(|error| Stop::Refused(Failure::run(Report::from_err(error).wrap_err("cannot listen to signals"))))?;

    let limits = limits(args, &job);
    let bar = RenderBar::new(job.rect, limits.seconds, limits.relative_rmse, args.quiet || args.json);
    let openjd = args.progress == ProgressKind::Openjd;
    let display = args.display_server.as_ref().and_then(|address| {
        let name = args.output.first().map_or_else(|| "etalon".to_owned(), |output| output.display().to_string());
        Display::open(address, &name, job.subject.size, job.subject.replicates)
    });
    let watch = Watcher::new(&bar, &interrupt, display.as_ref(), openjd);
    let run = match job.resumed.take() {
        Some(kept) => Run::taken_up(args, &job, kept, limits),
        None => Run::new(args, &job, limits, &watch),
    };
    let done = run.and_then(|run| run.finish(args, &job, &watch));
    bar.clear();
    let mut done = done.map_err(|error| Stop::Refused(Failure::run(Report::from_err(error))))?;
    if let Some(display) = display {
        done.canvas.with_film(|film| display.finish(film, job.rect));
    }

    let noticed = done.canvas.with_film(|film| warnings::of(args, &film.counters));
    print::warnings(&noticed);
    job.warnings.extend(noticed);
    done.error = done.canvas.with_film(|film| film.error(job.rect));
    let delivery = Delivery {
        header: &done.header,
        canvas: &done.canvas,
        features: &done.features,
        samples: done.ended.samples,
        error: done.error,
        exposure_ev: args.exposure,
    };
    let begun = done.canvas.samples()[1] > 0;
    let (written, mut failure) = if begun { delivery.write(&outputs) } else { Default::default() };
    let kept = keep(args, &done, &failure, begun);
    if let Some(signal) = interrupt.signal().filter(|_| !done.header.complete) {
        failure.add(interrupted(args, signal, &done, &written, kept.as_ref()));
    } else if let Some(kept) = kept {
        failure.add(match kept {
            Ok(path) => Failure::run(miette!(
                code = "kept",
                help = format!(
                    "{}with --resume, the same command writes the pictures without rendering again",
                    moved(args, &path)
                ),
                "what was rendered is kept in `{}`",
                path.display()
            )),
            Err(failure) => failure,
        });
    }
    if args.json {
        print::json(&report::json(args, &job, &done, &written, &failure));
    } else if !args.quiet && begun {
        print::line(&report::summary(&job, &done, &written));
    }
    failure.into_outcome().map_err(Stop::Reported)
}

/// Keeps what was rendered where the outputs do not: after a signal, and after an output that could not be written. Takes the
/// checkpoint away where they do.
fn keep(args: &Args, done: &Done, failure: &Failure, begun: bool) -> Option<Result<PathBuf, Failure>> {
    let beside = state::checkpoint_path(args.output.first()?);
    if done.header.complete && failure.is_empty() {
        // It may never have been written.
        let _ = std::fs::remove_file(&beside);
        return None;
    }
    if !begun {
        return None;
    }
    let Err(error) = state::write(&beside, &done.header, &done.canvas, &[]) else { return Some(Ok(beside)) };
    // The disk of the outputs may be full; another may not be.
    let name = format!("etalon-{}.checkpoint", std::process::id());
    let elsewhere = std::env::temp_dir().join(name);
    Some(match state::write(&elsewhere, &done.header, &done.canvas, &[]) {
        Ok(()) => Ok(elsewhere),
        Err(_) => Err(Failure::run(Report::from_err(error).wrap_err("what was rendered is lost"))),
    })
}

/// What must be done with a checkpoint before it is found.
fn moved(args: &Args, kept: &Path) -> String {
    match args.output.first().map(|output| state::checkpoint_path(output)) {
        Some(beside) if beside != kept => format!("move it to `{}`: ", beside.display()),
        _ => String::new(),
    }
}

/// What is said of a render that a signal has ended.
fn interrupted(
    args: &Args,
    signal: u8,
    done: &Done,
    written: &[output::Written],
    kept: Option<&Result<PathBuf, Failure>>,
) -> Failure {
    let [fewest, most] = done.canvas.samples();
    let mut text = match most {
        0 => "interrupted before the first tile was done".to_owned(),
        _ if fewest == most => format!("interrupted at {fewest} samples a pixel"),
        _ => format!("interrupted at {fewest} to {most} samples a pixel"),
    };
    if !written.is_empty() {
        text += &format!("; the picture has what there is: {}", {
            let names: Vec<_> = written.iter().map(|written| format!("`{}`", written.path)).collect();
            names.join(", ")
        });
    }
    let help = match kept {
        Some(Ok(path)) => {
            format!("{}the same command with --resume goes on from `{}`", moved(args, path), path.display())
        }
        Some(Err(_)) => "the sums could not be kept, so it cannot be resumed".to_owned(),
        None => "nothing is kept".to_owned(),
    };
    Failure::signal(signal, miette!(code = "interrupted", help = help, "{text}"))
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
fn limits(args: &Args, job: &Job) -> Limits {
    let otherwise = args.error.is_some() || args.time.is_some();
    let samples = match args.overrides.spp() {
        Some(spp) => spp,
        None if otherwise => i32::MAX as u32,
        None => job.loaded.scene.integrator.spp,
    };
    Limits { samples, relative_rmse: args.error, seconds: args.time, adaptivity: args.adaptive.into() }
}

/// One path again, vertex by vertex.
fn replay(args: &Args, pixel: PixelAt, sample: u32) -> Result<(), Stop> {
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
