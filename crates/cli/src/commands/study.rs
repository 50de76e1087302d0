//! `etalon study`: what each choice buys and costs, measured side by side.

mod choices;
mod measure;
mod page;
mod pictures;
mod plots;
mod report;

use std::path::{Path, PathBuf};

use etalon_oracle::truths::{Claim, truths};
use etalon_picture::write_atomically;
use etalon_scene::{NamedFile, Scene};
use miette::{Report, miette};
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::load::load;
use crate::machine::{Clock, ClockKind, Machine};
use crate::print;
use measure::{Effort, SceneStudy};
use pictures::Pictures;

/// Measure what samplers, path depth, light sampling and effects gain and cost.
///
/// Renders each scene with one setting changed at a time, and compares error and time. Writes a table, plots and a page of HTML.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon study scenes/cornell.json --seconds 1s -o study")]
pub(crate) struct StudyArgs {
    /// Scenes as JSON files, or truths of the oracle as truth:NAME (see `etalon verify`). Default: all scenes in the folder `scenes`.
    scenes: Vec<String>,
    /// Folder for study.json, study.md, study.html, pictures and plots. It is created if it does not exist.
    #[arg(short, long, alias = "outfile", value_name = "FOLDER")]
    output: PathBuf,
    /// Width of the pictures in pixels. The height follows from the shape of the film.
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = clap::value_parser!(u32).range(8..=4096))]
    width: u32,
    /// Maximum render time of each choice, such as 2s.
    #[arg(long, value_name = "TIME", value_parser = crate::args::seconds, default_value = "2s")]
    seconds: f64,
    /// Maximum render time of the reference, as a multiple of --seconds.
    #[arg(long, value_name = "FACTOR", default_value_t = 5.0, value_parser = crate::args::finite)]
    reference: f64,
    /// Study only choices, or groups of choices, whose name contains one of these words.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Commit of the program, to state in the report.
    #[arg(long, value_name = "COMMIT")]
    commit: Option<String>,
    /// Number of threads. Default: all cores.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Print only warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// All that was found.
#[derive(Serialize)]
struct StudyReport {
    command: String,
    machine: Machine,
    commit: Option<String>,
    seconds: f64,
    scenes: Vec<SceneStudy>,
}

/// A scene to study.
struct Subject {
    name: String,
    scene: Scene,
    truth: Option<f64>,
}

pub(crate) fn run(args: StudyArgs) -> Outcome {
    let threads = args.threads.map_or_else(rayon::current_num_threads, |threads| threads as usize);
    let subjects = subjects(&args)?;
    let io = |error: std::io::Error| {
        Failure::run(Report::from_err(error).wrap_err(format!("cannot write to `{}`", args.output.display())))
    };
    std::fs::create_dir_all(&args.output).map_err(io)?;
    let effort =
        Effort { seconds: args.seconds, reference: args.reference, threads, only: args.only.clone(), seed: args.seed };
    let clock = Clock::start(ClockKind::Cpu, threads);
    let bar = crate::progress::spinner(args.quiet);
    let mut scenes = Vec::new();
    for subject in &subjects {
        let said = |text: &str| bar.set_message(text.to_owned());
        let study = measure::study(&subject.name, &subject.scene, subject.truth, &effort, &said)
            .map_err(|error| Failure::run(miette!("{}: {error}", subject.name)))?;
        scenes.push(study);
    }
    bar.finish_and_clear();
    let mut words: Vec<String> = std::env::args().collect();
    words[0] = "etalon".to_owned();
    let report = StudyReport {
        command: words.join(" "),
        machine: Machine::with_threads(threads),
        commit: args.commit.clone(),
        seconds: clock.seconds(),
        scenes,
    };
    write(&args.output, &report)?;
    if !args.quiet {
        print::line(&report::heading(&report));
        let samplers = report::samplers(&report);
        if !samplers.is_empty() {
            print::line(&format!("  {}", report::verdict(&samplers)));
        }
        for scene in &samplers {
            let [scene, gain, sobol, independent] = scene.cells();
            print::line(&format!(
                "  {scene}: independent numbers take {gain} times as long as Owen-Sobol (slopes {independent} and {sobol})"
            ));
        }
        print::line(&format!("  {}", args.output.join("study.html").display()));
    }
    Ok(())
}

/// What the command line names, at the size of the study.
fn subjects(args: &StudyArgs) -> Result<Vec<Subject>, Failure> {
    let names = match args.scenes.as_slice() {
        [] => all_scenes()?,
        given => given.to_vec(),
    };
    let mut failure = Failure::default();
    let mut subjects = Vec::new();
    for name in names {
        let subject = match name.strip_prefix("truth:") {
            Some(truth) => of_truth(truth),
            None => of_file(Path::new(&name), args.width),
        };
        match subject {
            Ok(subject) => subjects.push(subject),
            Err(error) => failure.add(error),
        }
    }
    failure.into_outcome()?;
    Ok(subjects)
}

fn all_scenes() -> Result<Vec<String>, Failure> {
    let folder = std::fs::read_dir("scenes").map_err(|error| {
        Failure::input(
            Report::from_err(error).wrap_err("no scene is given, and the current folder has no folder `scenes`"),
        )
    })?;
    let mut names: Vec<String> = folder
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .map(|path| path.display().to_string())
        .collect();
    names.sort();
    Ok(names)
}

fn of_file(path: &Path, width: u32) -> Result<Subject, Failure> {
    let film = load(path, None, &[])?.scene.film;
    let height = (f64::from(width) * f64::from(film.height) / f64::from(film.width)).round().max(1.0) as u32;
    let scene = load(path, Some([width, height]), &[])?.scene;
    let name = path.file_stem().map_or_else(|| path.display().to_string(), |stem| stem.to_string_lossy().into_owned());
    Ok(Subject { name, scene, truth: None })
}

/// A scene whose mean luminance is known, at its own size.
fn of_truth(name: &str) -> Result<Subject, Failure> {
    // Those for polarised light too: the study says what averaging s and p gets wrong there.
    let claims: Vec<Claim> = Claim::UNPOLARISED.into_iter().chain([Claim::CarriesPolarisation]).collect();
    let truth = truths().into_iter().find(|truth| truth.name == name && truth.applies_to(&claims));
    let truth = truth.filter(|truth| truth.band_nm.is_none() && truth.crop_px.is_none()).ok_or_else(|| {
        Failure::input(miette!(code = "unknown-truth", "there is no truth `{name}` of a mean luminance"))
    })?;
    let files: Vec<_> =
        truth.files.iter().map(|file| NamedFile { name: file.name.clone(), bytes: file.bytes.clone() }).collect();
    let loaded = etalon_scene::parse_with_files(&truth.scene, name, &files, None);
    let scene = loaded.map_err(|e| Failure::run(miette!("{}", e.summary())))?.scene;
    Ok(Subject { name: name.to_owned(), scene, truth: Some(truth.value()) })
}

fn write(folder: &Path, report: &StudyReport) -> Outcome {
    let failed = |error| Failure::run(Report::from_err(error));
    let put =
        |name: &str, bytes: &[u8]| write_atomically(&folder.join(name), |out| out.write_all(bytes)).map_err(failed);
    let styles = plots::Styles::of(&report.scenes);
    let mut drawn = Vec::new();
    let mut files = Vec::new();
    for study in &report.scenes {
        let pictures = Pictures::of(study).map_err(|error| Failure::run(miette!("cannot show a picture: {error}")))?;
        let plots = plots::of(study, &styles);
        let plots = plots.map_err(|error| Failure::run(miette!("cannot draw a plot: {error}")))?;
        let mut names = vec![format!("{}.png", study.scene)];
        put(&names[0], &pictures.reference)?;
        for plot in &plots {
            let name = format!("{}.svg", plot.name);
            put(&name, plot.svg.as_bytes())?;
            names.push(name);
        }
        files.push((study.scene.clone(), names));
        drawn.push((pictures, plots));
    }
    let json = serde_json::to_string_pretty(report).expect("a report is plain data with text keys");
    put("study.json", json.as_bytes())?;
    put("study.md", report::markdown(report, &files).as_bytes())?;
    put("study.html", page::html(report, &drawn).as_bytes())
}
