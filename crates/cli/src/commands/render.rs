//! `etalon render`: a scene in, a picture out.

mod report;
mod warnings;

use std::path::PathBuf;
use std::time::Instant;

use etalon_picture::{Attribute, ERROR_PREFIX, ErrorInfo, Picture, RenderInfo, Window};
use etalon_transport::{Film, Finished, ImageError, Limits, PixelRect, Prepared, prepare_study};
use miette::{Report, miette};
use serde::Serialize;

use crate::args::{Crop, PixelAt};
use crate::failure::{Failure, Outcome, ProblemJson};
use crate::load::{LoadedScene, load};
use crate::machine::{Clock, ClockKind};
use crate::output::{self, Output, Written};
use crate::overrides::Overrides;
use crate::print;
use crate::progress::RenderBar;

/// Renders a scene to EXR and PNG files.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The scene, as JSON (see `etalon schema`), or a model: glTF 2.0 (.glb, .gltf), OBJ or PLY.
    scene: PathBuf,
    /// Picture to write: .exr keeps the linear picture and all that is known about it, .png is what a screen shows.
    /// Give it twice to write both.
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
    /// Render only these pixels: columns from X0 up to but not including X1, rows from Y0 to Y1, counted from the top
    /// left. The EXR remembers where they belong.
    #[arg(long, value_name = "X0,X1,Y0,Y1")]
    crop: Option<Crop>,
    /// Trace one path of this pixel again and print it vertex by vertex, instead of rendering.
    #[arg(long, value_name = "X,Y", requires = "sample", conflicts_with_all = ["output", "crop", "error", "time"])]
    pixel: Option<PixelAt>,
    /// Which of the pixel's paths.
    #[arg(long, value_name = "K")]
    sample: Option<u32>,
    /// Print one JSON object on standard output, about the render or about what is wrong, and no progress.
    #[arg(long)]
    json: bool,
    /// Print nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
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
    args.overrides.apply(&mut loaded.scene);
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
    failure.into_outcome()?;
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
    Ok(Job { loaded, prepared, prepare_seconds: start.elapsed().as_secs_f64(), warnings, rect, threads })
}

fn render(args: &Args) -> Result<(), Stop> {
    let mut outputs = Vec::new();
    let mut job = set_up(args, &mut outputs).map_err(Stop::Refused)?;
    print::warnings(&job.warnings);

    let limits = limits(args, &job);
    let bar = RenderBar::new(job.rect, limits.seconds, limits.relative_rmse, args.quiet || args.json);
    let clock = Clock::start(args.clock, job.threads);
    let done = job.prepared.render_within(job.rect, &limits, Some(job.threads), &|| clock.seconds(), &bar);
    bar.clear();
    let done = done.map_err(|error| Stop::Refused(Failure::run(Report::from_err(error))))?;

    let done = Done { error: done.film.error(job.rect), finished: done };
    let noticed = warnings::of(args, &done.finished.film.counters);
    print::warnings(&noticed);
    job.warnings.extend(noticed);
    let (written, failure) = write(args, &job, &done, &outputs);
    if args.json {
        print::json(&report::json(args, &job, &done, &written, &failure));
    } else if !args.quiet {
        print::line(&report::summary(&job, &done, &written));
    }
    failure.into_outcome().map_err(Stop::Reported)
}

/// A render that is done, and how wrong it is.
struct Done {
    finished: Finished,
    error: Option<ImageError>,
}

/// What ends the render. The scene's own number of samples counts where the command line says nothing.
fn limits(args: &Args, job: &Job) -> Limits {
    let otherwise = args.error.is_some() || args.time.is_some();
    let samples = match args.overrides.spp() {
        Some(spp) => spp,
        None if otherwise => i32::MAX as u32,
        None => job.loaded.scene.integrator.spp,
    };
    Limits { samples, relative_rmse: args.error, seconds: args.time }
}

/// Writes every output, also after one of them has failed.
fn write(args: &Args, job: &Job, done: &Done, outputs: &[Output]) -> (Vec<Written>, Failure) {
    let Finished { film, samples, seconds, .. } = &done.finished;
    let (mut written, mut failure) = (Vec::new(), Failure::default());
    let integrator = &job.loaded.scene.integrator;
    let software = concat!("etalon ", env!("CARGO_PKG_VERSION"));
    let info = RenderInfo {
        software: software.to_owned(),
        render_time_s: *seconds,
        samples_per_pixel: *samples,
        seed: integrator.seed,
        scene_sha256: job.loaded.sha256.clone(),
        plan_json: serde_json::to_string(job.prepared.plan()).expect("a plan is plain data"),
    };
    let approximation = job.prepared.plan().approximations.join("; without ");
    let mut comment = format!(
        "{} samples a pixel, seed {}, exposure {:+} EV, scene {}",
        samples, integrator.seed, args.exposure, job.loaded.sha256
    );
    if !approximation.is_empty() {
        comment += &format!(", approximation without {approximation}");
    }
    let picture = info.attributes().and_then(|mut attributes| {
        if !approximation.is_empty() {
            let text = Attribute::Text(format!("without {approximation}"));
            attributes.insert("approximation".to_owned(), text);
        }
        Ok((picture(film, job.rect)?, attributes))
    });
    match picture {
        Err(error) => failure.add(Failure::run(Report::from_err(error))),
        Ok((picture, mut attributes)) => {
            attributes
                .extend(done.error.as_ref().map(|error| error_info(film, error).attributes()).unwrap_or_default());
            for output in outputs {
                match output::write(output, &picture, &attributes, args.exposure, software, &comment) {
                    Ok(done) => written.push(done),
                    Err(error) => failure.add(error),
                }
            }
        }
    }
    (written, failure)
}

/// What the file says about the error of its picture.
fn error_info(film: &Film, error: &ImageError) -> ErrorInfo {
    let tile = error.noisiest.rect;
    ErrorInfo {
        replicates: film.replicates(),
        relative_rmse: error.relative_rmse,
        interval: error.interval,
        tail_index: error.tail_index,
        noisiest_tile: [tile.x0, tile.x1, tile.y0, tile.y1],
    }
}

/// The rendered part of the film as linear Rec. 709, and the standard error of each channel where it is known.
fn picture(film: &Film, rect: PixelRect) -> Result<Picture<f32>, etalon_picture::PictureError> {
    let cut = |whole: Vec<[f32; 3]>| -> Vec<[f32; 3]> {
        rect.pixels().map(|(x, y)| whole[y as usize * film.width() as usize + x as usize]).collect()
    };
    let window = Window {
        origin_px: [rect.x0 as i32, rect.y0 as i32],
        frame_px: [film.width() as usize, film.height() as usize],
    };
    let (width, height) = ((rect.x1 - rect.x0) as usize, (rect.y1 - rect.y0) as usize);
    let mut picture = Picture::from_rgb(width, height, &cut(film.linear_rec709()))?.in_frame(window)?;
    let errors = cut(film.linear_rec709_error());
    // Where nothing at all is known there is nothing to say.
    if errors.iter().any(|error| error[0].is_finite()) {
        for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
            picture.insert(&format!("{ERROR_PREFIX}{name}"), errors.iter().map(|error| error[index]).collect())?;
        }
    }
    Ok(picture)
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
