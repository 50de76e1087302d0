//! All that can fail before the work.

use std::time::Instant;

use etalon::{Channels, Frame, Subject};
use etalon_control::Shard;
use etalon_control::canvas::tiles_of;
use etalon_transport::{PixelRect, Prepared, prepare_frame};
use miette::{MietteDiagnostic, Report, miette};

use super::{Adaptive, RenderArgs, preflight, resume};
use crate::args::{PixelAt, corners_hint};
use crate::failure::Failure;
use crate::frames::FirstFrame;
use crate::load::{LoadedScene, load};
use crate::output::{self, Output};
use crate::state::Kept;

/// A scene ready to be rendered.
pub(super) struct Job {
    pub loaded: LoadedScene,
    pub prepared: Prepared,
    pub prepare_seconds: f64,
    pub warnings: Vec<Report>,
    pub rect: PixelRect,
    pub threads: usize,
    pub subject: Subject,
    /// A checkpoint to go on from.
    pub resumed: Option<Kept>,
}

/// Does all that can fail before the work, and collects all that is wrong.
pub(super) fn set_up(args: &RenderArgs, outputs: &mut Vec<Output>) -> Result<Job, Failure> {
    let mut failure = Failure::default();
    *outputs = output::plan(&args.output, &mut failure);
    let ready = load_scene(args).and_then(|mut loaded| {
        let frame = only_frame(args, &mut loaded)?;
        Ok((loaded, frame))
    });
    match ready {
        Ok((loaded, frame)) => make_ready(args, outputs, loaded, frame, None, failure),
        Err(wrong) => {
            failure.add(wrong);
            Err(failure)
        }
    }
}

/// The scene, as the options have it.
pub(super) fn load_scene(args: &RenderArgs) -> Result<LoadedScene, Failure> {
    let mut loaded = load(&args.scene, args.overrides.film_size(), args.overrides.parameters())?;
    args.overrides.apply(&mut loaded.scene)?;
    Ok(loaded)
}

/// Where a path of a frame is to be traced again: moves the scene there.
fn only_frame(args: &RenderArgs, loaded: &mut LoadedScene) -> Result<Option<Frame>, Failure> {
    let Some(list) = &args.frames.frames else { return Ok(None) };
    let [number] = list.numbers() else {
        return Err(Failure::input(miette!(
            code = "frames",
            help = "give its number, such as --frames 12",
            "--pixel traces a path of one frame, and --frames {} are several",
            list.text()
        )));
    };
    let first = FirstFrame::of(&loaded.scene);
    args.frames.set(&mut loaded.scene, first, *number);
    Ok(Some(args.frames.frame(*number)))
}

/// Makes a scene ready that is as the options, and the frame, have it. What is the same in an earlier frame is taken over from it.
pub(super) fn make_ready(
    args: &RenderArgs,
    outputs: &[Output],
    mut loaded: LoadedScene,
    frame: Option<Frame>,
    earlier: Option<Prepared>,
    mut failure: Failure,
) -> Result<Job, Failure> {
    output::check_inputs(outputs, &args.scene, &loaded.files, &mut failure);
    let stokes = loaded.scene.film.stokes || args.overrides.polarised();
    preflight::check_memory(&loaded.scene, stokes, args.threads.unwrap_or(1) as usize, &mut failure);
    let film = &loaded.scene.film;
    let whole = PixelRect { x0: 0, y0: 0, x1: film.width, y1: film.height };
    let rect = args.crop.map_or(whole, |crop| crop.0);
    if rect.x1 > whole.x1 || rect.y1 > whole.y1 {
        let PixelRect { x0, y0, x1, y1 } = rect;
        let numbers = [x0, y0, x1 - x0, y1 - y0].map(|number| number as usize);
        let hint = corners_hint(numbers, [whole.x1 as usize, whole.y1 as usize]);
        let outside = MietteDiagnostic::new(format!(
            "the crop reaches to column {} and row {} of a picture of {} × {} pixels",
            x1 - 1,
            y1 - 1,
            whole.x1,
            whole.y1
        ));
        let outside = outside.with_code("crop-outside");
        failure.add(Failure::input(match hint {
            Some(hint) => outside.with_help(hint),
            None => outside,
        }));
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
    let prepared = match prepare_frame(&loaded.scene, &args.overrides.study(), earlier) {
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
            "path reuse makes neighbouring pixels share paths, but --error, --adaptive always and --pixel need independent pixels"
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
    if !args.developing.is_plain() && !outputs.iter().any(|output| output.format == output::Format::Png) {
        warnings.push(miette!(
            severity = miette::Severity::Warning,
            code = "develop-unused",
            help = "`etalon develop` makes a PNG from the EXR later",
            "--exposure and the other options for PNG files have no effect, because no PNG is written"
        ));
    }
    if let Some(option) = wants_exr(args)
        && !outputs.iter().any(|output| output.format != output::Format::Png)
        && !outputs.is_empty()
    {
        failure.add(Failure::input(miette!(
            code = "no-exr",
            help = "add -o NAME.exr",
            "{option} adds channels to an EXR, but no EXR is written"
        )));
    }
    let subject = Subject { frame, ..Subject::new(&prepared, &loaded.sha256, rect) };
    check_developing(args, &subject, &mut failure);
    let threads = args.threads.map_or_else(rayon::current_num_threads, |threads| threads as usize);
    let prepare_seconds = start.elapsed().as_secs_f64();
    let shard = args.shard.map_or(Shard::WHOLE, |shard| shard.0);
    check_shard(args, rect, shard, outputs, &mut failure);
    let channels = Channels::new(&args.aov, args.only);
    preflight::check_disks(args.checkpoint.is_some(), &subject, &channels, outputs, &mut failure, &mut warnings);
    let resumed = if args.resume { resume::find(args, &subject, shard, &mut failure) } else { None };
    failure.into_outcome()?;
    if args.resume && resumed.is_none() && frame.is_none() {
        warnings.push(miette!(
            severity = miette::Severity::Warning,
            code = "nothing-to-resume",
            "there is no checkpoint, so the render starts from the beginning"
        ));
    }
    Ok(Job { loaded, prepared, prepare_seconds, warnings, rect, threads, subject, resumed })
}

/// Finds what a PNG could not show before there is a picture.
fn check_developing(args: &RenderArgs, subject: &Subject, failure: &mut Failure) {
    let rect = subject.crop;
    let mut refuse = |code: &'static str, help: &str, why: String| {
        failure.add(Failure::input(miette!(code = code, help = help, "{why}")));
    };
    if let Err(error) = args.developing.check((rect.x1 - rect.x0) as usize, (rect.y1 - rect.y0) as usize) {
        refuse("develop", "see `etalon render --help`", error.to_string());
    }
    if args.developing.shows_errors() && subject.replicates < 2 {
        refuse(
            "develop",
            "render with at least two replicates",
            "--error-map: the error is not known with a single replicate".to_owned(),
        );
    }
    let Some(nm) = args.developing.band_nm() else { return };
    let Some(bands) = &subject.bands else {
        return refuse(
            "develop",
            "add bands such as `--bands 400:700:10`",
            "--band: the film has no spectral bands".to_owned(),
        );
    };
    let [first, last] = [bands.first_nm, bands.centre_nm(bands.count - 1)];
    // A single band is found by its centre: see `etalon_picture::develop::band_at`.
    let reach = if bands.count == 1 { 0.5 } else { 0.5 * bands.step_nm };
    if !(first - reach <= nm && nm <= last + reach) {
        let why = format!("--band: {nm} nm is in none of the bands, whose centres go from {first} to {last} nm");
        refuse("develop", "change --band or --bands", why);
    }
}

/// The first option given that only an EXR can follow.
fn wants_exr(args: &RenderArgs) -> Option<&'static str> {
    // A PNG can show a band.
    match (args.aov.is_empty(), args.overrides.has_bands() && args.developing.band_nm().is_none()) {
        (false, _) => Some("--aov"),
        (true, true) => Some("--bands"),
        (true, false) => None,
    }
}

/// Every share must have tiles.
pub(crate) fn check_shares(rect: PixelRect, shares: u32) -> Result<(), Failure> {
    let tiles = tiles_of(rect, Shard::WHOLE).len();
    if shares as usize <= tiles {
        return Ok(());
    }
    Err(Failure::input(miette!(
        code = "shard-empty",
        "the picture has {tiles} tiles of 16 × 16 pixels and cannot be divided into {shares} shares"
    )))
}

/// A share must have tiles, and something must come of it.
fn check_shard(args: &RenderArgs, rect: PixelRect, shard: Shard, outputs: &[Output], failure: &mut Failure) {
    if let Err(too_many) = check_shares(rect, shard.of) {
        failure.add(too_many);
    }
    if args.shard.is_some() && args.time.is_some() {
        failure.add(Failure::input(miette!(
            code = "shard-time",
            help = "give --spp or --error, or render whole frames of a sequence",
            "--time and --shard exclude each other: the shares of a picture would have different numbers of samples"
        )));
    }
    if args.shard.is_some()
        && !outputs.is_empty()
        && !outputs.iter().any(|output| output.format == output::Format::Part)
    {
        failure.add(Failure::input(miette!(
            code = "shard-without-part",
            help = "add -o NAME.part; an EXR or a PNG beside it shows the tiles of this share",
            "`etalon merge` needs a .part file of each share, but none is written"
        )));
    }
}
