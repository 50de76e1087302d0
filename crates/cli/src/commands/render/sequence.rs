//! Many frames of one scene, one after the other. Each is the picture that it would be alone.

use std::collections::HashSet;
use std::path::PathBuf;
use std::time::Instant;

use miette::{Report, miette};
use serde::Serialize;
use serde_json::{Value, json};

use super::setup::{load_scene, make_ready};
use super::{Job, RenderArgs, Rendered, Stop, listen, render_job, report};
use crate::failure::Failure;
use crate::frame_settings::FrameSettings;
use crate::frames::{FirstFrame, FrameList, FramePattern, patterns};
use crate::interrupt::Interrupt;
use crate::load::LoadedScene;
use crate::output::{self, Format};
use crate::print;
use crate::problem_json::{ProblemJson, problems_json};
use crate::progress::{RenderBar, duration};
use etalon::Channels;
use etalon_transport::Prepared;

/// A frame's place among the others, and what its files say of it.
pub(super) struct InSequence {
    /// How many of how many frames are done before it.
    pub position: [usize; 2],
    pub settings: FrameSettings,
}

/// What `--json` prints about a sequence.
#[derive(Serialize)]
struct SequenceJson<'a> {
    scene: String,
    scene_sha256: &'a str,
    fps: String,
    /// A report of each frame, in the order of rendering; of one that was there, `"skipped": true`.
    frames: Vec<Value>,
    errors: Vec<ProblemJson>,
}

/// The frames that this run is to render.
struct Plan {
    patterns: Vec<FramePattern>,
    numbers: Vec<u32>,
    /// Which of them are finished.
    finished: HashSet<u32>,
}

/// How far a sequence has come.
struct Progress {
    begin: Instant,
    /// Frames that were rendered here.
    rendered: u32,
    reports: Vec<Value>,
    /// Warnings that were printed.
    told: HashSet<String>,
}

/// Renders the frames that the options name, but for those that are there when `--resume` is given.
pub(super) fn render(args: &mut RenderArgs, names_itself: bool) -> Result<(), Stop> {
    let (loaded, plan, first) = set_up(args, names_itself).map_err(Stop::Refused)?;
    let (total, sha256) = (plan.numbers.len(), loaded.sha256.clone());
    let interrupt = listen().map_err(Stop::Refused)?;
    let mut progress = Progress { begin: Instant::now(), rendered: 0, reports: Vec::new(), told: HashSet::new() };
    let (mut scene, mut failure) = (Some((loaded, None)), Failure::default());
    for (place, &number) in plan.numbers.iter().enumerate() {
        args.output = plan.names(number);
        if plan.finished.contains(&number) {
            let names: Vec<String> = args.output.iter().map(|name| name.display().to_string()).collect();
            progress.reports.push(json!({"frame": number, "skipped": true, "outputs": names}));
            continue;
        }
        let Some((loaded, earlier)) = scene.take() else { break };
        let wrong = match interrupt.signal() {
            Some(signal) => Failure::signal(signal, miette!(code = "interrupted", "interrupted before frame {number}")),
            None => match frame(args, (loaded, earlier), (&plan, first, place), &interrupt, &mut progress) {
                Ok(next) => {
                    scene = Some(next);
                    continue;
                }
                Err(wrong) => wrong,
            },
        };
        failure.add(wrong);
        failure.add(ended(number, progress.rendered as usize + plan.finished.len(), total, interrupt.signal()));
        break;
    }
    if args.json {
        print::json(&SequenceJson {
            scene: args.scene.display().to_string(),
            scene_sha256: &sha256,
            fps: args.frames.fps.to_string(),
            frames: progress.reports,
            errors: problems_json(&failure),
        });
    } else if !args.quiet && !plan.finished.is_empty() {
        print::line_if_read(&format!("{} of {total} frames were there already", plan.finished.len()));
    }
    failure.into_outcome().map_err(Stop::Reported)
}

/// Renders one frame, and hands the scene and what was prepared of it on to the next.
fn frame(
    args: &mut RenderArgs,
    (mut loaded, earlier): (LoadedScene, Option<Prepared>),
    (plan, first, place): (&Plan, FirstFrame, usize),
    interrupt: &Interrupt,
    progress: &mut Progress,
) -> Result<(LoadedScene, Option<Prepared>), Failure> {
    let (number, total) = (plan.numbers[place], plan.numbers.len());
    // Whatever repeats the options names this frame alone.
    args.frames.frames = Some(FrameList::from(number));
    args.frames.set(&mut loaded.scene, first, number);
    let settings = settings(args, &loaded, first, number);
    let mut wrong = Failure::default();
    let outputs = output::plan(&args.output, &mut wrong);
    let mut job = make_ready(args, &outputs, loaded, Some(args.frames.frame(number)), earlier, wrong)?;
    print::warnings(job.warnings.iter().filter(|warning| progress.told.insert(warning.to_string())));

    let after = plan.numbers[place + 1..].iter().filter(|number| !plan.finished.contains(number)).count();
    let mean_s = |progress: &Progress| progress.begin.elapsed().as_secs_f64() / f64::from(progress.rendered);
    let label = format!("frame {number}, {} of {total}", place + 1);
    let bar = RenderBar::new(job.rect, args.time, args.error, args.quiet || args.json);
    let bar = bar.of_frame(label.clone(), after, (progress.rendered > 0).then(|| mean_s(progress)));
    let in_sequence = InSequence { position: [place, total], settings };
    let rendered = render_job(args, &mut job, &outputs, interrupt, &bar, Some(&in_sequence))?;
    progress.rendered += u32::from(rendered.failure.is_empty());
    if args.json {
        progress.reports.push(report_of(args, &job, &rendered));
    } else if !args.quiet && rendered.failure.is_empty() {
        let left = format!(", remaining {}", duration(mean_s(progress) * after as f64));
        let summary = report::summary(&job, &rendered.done, &rendered.written);
        // The picture is written, whether anybody reads about it or not.
        print::line_if_read(&format!("{label}{}: {summary}", if after > 0 { &left } else { "" }));
    }
    rendered.failure.into_outcome()?;
    Ok((job.loaded, Some(job.prepared)))
}

/// Does all that can fail before the first frame, and collects all that is wrong.
fn set_up(args: &mut RenderArgs, names_itself: bool) -> Result<(LoadedScene, Plan, FirstFrame), Failure> {
    let list = args.frames.frames.clone().unwrap_or_else(|| FrameList::from(0));
    let mut failure = Failure::default();
    let numbers = match args.shard.take() {
        None => list.numbers().to_vec(),
        Some(shard) => list.share(shard.0.index, shard.0.of),
    };
    if numbers.is_empty() {
        failure.add(Failure::input(miette!(
            code = "shard-empty",
            "this share has no frame: there are more shares than the {} frames",
            list.numbers().len()
        )));
    }
    if args.output.iter().any(|name| matches!(Format::of(name), Ok(Format::Part))) {
        failure.add(Failure::input(miette!(
            code = "frame-part",
            help = "write .exr or .png; --shard divides the frames among machines, each frame is rendered whole",
            "frames of a sequence are not rendered in parts"
        )));
    }
    let patterns = match patterns(&args.output, list.numbers().len()) {
        Ok(patterns) => patterns,
        Err(wrong) => {
            failure.add(wrong);
            Vec::new()
        }
    };
    let mut plan = Plan { patterns, numbers, finished: HashSet::new() };
    let loaded = match load_scene(args) {
        Ok(loaded) => loaded,
        Err(wrong) => {
            failure.add(wrong);
            return Err(failure);
        }
    };
    let first = FirstFrame::of(&loaded.scene);
    for &number in &plan.numbers {
        let names = plan.names(number);
        let outputs = output::plan(&names, &mut failure);
        if names_itself && !args.resume {
            names.iter().filter_map(|name| output::check_own(name).err()).for_each(|foreign| failure.add(foreign));
        }
        if args.resume && !outputs.is_empty() {
            let settings = settings(args, &loaded, first, number);
            let finished: Result<Vec<bool>, Failure> =
                outputs.iter().map(|output| settings.is_finished(output)).collect();
            match finished {
                Ok(finished) if finished.iter().all(|&finished| finished) => drop(plan.finished.insert(number)),
                Ok(_) => {}
                Err(other) => failure.add(other),
            }
        }
    }
    failure.into_outcome().map(|()| (loaded, plan, first))
}

impl Plan {
    /// The files of a frame.
    fn names(&self, number: u32) -> Vec<PathBuf> {
        self.patterns.iter().map(|pattern| pattern.of(number)).collect()
    }
}

/// What the files of a frame say of it.
fn settings(args: &RenderArgs, loaded: &LoadedScene, first: FirstFrame, number: u32) -> FrameSettings {
    FrameSettings {
        software: FrameSettings::SOFTWARE,
        sources_sha256: FrameSettings::SOURCES,
        scene_sha256: loaded.sha256.clone(),
        frame: args.frames.frame(number),
        seed: args.frames.seed(first, number),
        options: crate::shell::words(args.overrides.as_words().to_vec()),
        error: args.error,
        time_s: args.time,
        adaptive: args.adaptive.effective(args.error).word(),
        crop: args.crop.map(|crop| crop.0),
        channels: Channels::new(&args.aov, args.only),
        develop: args.developing.as_text(),
    }
}

fn report_of(args: &RenderArgs, job: &Job, rendered: &Rendered) -> Value {
    let report = report::json(args, job, &rendered.done, &rendered.written, &rendered.failure);
    serde_json::to_value(report).expect("a report is plain data with text keys")
}

/// What is said of a sequence that ended in the midst of it.
fn ended(number: u32, finished: usize, total: usize, signal: Option<u8>) -> Failure {
    let report: Report = miette!(
        code = "sequence-ended",
        help = "the same command with --resume keeps these and renders the others",
        "the sequence ended with frame {number}: {finished} of {total} frames are finished"
    );
    match signal {
        Some(signal) => Failure::signal(signal, report),
        None => Failure::run(report),
    }
}
