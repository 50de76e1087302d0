//! `etalon farm`: a job for many machines, as a script for Slurm or a template for Open Job Description.

mod openjd;
mod sequence;
mod slurm;

use std::path::{Path, PathBuf};

use etalon_picture::write_atomically;
use etalon_scene::Scene;
use etalon_transport::PixelRect;
use miette::{Report, miette};

use crate::commands::render::check_shares;
use crate::failure::{Failure, Outcome};
use crate::frames::{FrameArgs, FrameList, numbered};
use crate::load::load;
use crate::output;
use crate::overrides::Overrides;
use crate::print;
use crate::state;

/// Write a job that renders a scene on many machines.
///
/// Each task renders one share of the picture. The last task merges them. The picture has the same pixels as that of one machine, bit
/// for bit.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon farm scenes/cornell.json --shards 64 --spp 1024 --slurm -o job.sh")]
#[command(group = clap::ArgGroup::new("kind").required(true))]
pub(crate) struct FarmArgs {
    /// Scene. All machines must see it, and the folder of the picture, under the same path.
    scene: PathBuf,
    /// Number of shares. Each is one task of the job. With --frames, the default is one for each frame, 10,000 at most.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_SHARES), required_unless_present = "frames")]
    shards: Option<u32>,
    /// Write a shell script for Slurm. Run it where you submit jobs. It submits an array of renders and a merge.
    #[arg(long, group = "kind")]
    slurm: bool,
    /// Write a job template for Open Job Description (jobtemplate-2023-09).
    #[arg(long, group = "kind")]
    openjd: bool,
    /// File for the job. Default: standard output.
    #[arg(short, long, alias = "outfile", value_name = "FILE")]
    output: Option<PathBuf>,
    /// Picture that the job writes, with the parts beside it. Default: the name of the scene with .exr, in the current folder. With
    /// --frames it has {frame} in its name.
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Number of threads of each task. Default: all cores of its machine.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Stop at this relative error, such as 2% (see `etalon render`). Each task first explores the whole picture. This takes about a tenth
    /// of the time of the whole picture. For ten tasks or more, ask `etalon quote` once and pass --spp instead.
    #[arg(long, value_name = "PERCENT", value_parser = crate::args::percentage)]
    error: Option<f64>,
    #[command(flatten)]
    frames: FrameArgs,
    #[command(flatten)]
    overrides: Overrides,
}

/// Most tasks of a job.
const MOST_SHARES: i64 = 10_000;

/// A job, with paths that do not depend on where it runs.
struct Job {
    name: String,
    program: PathBuf,
    scene: PathBuf,
    picture: PathBuf,
    shards: u32,
    threads: Option<u32>,
    /// Options of every render, as words of a command line.
    options: Vec<String>,
}

impl Job {
    /// What follows a part's number in its name; before it stand the picture's name and a point.
    fn part_suffix(&self) -> String {
        format!("-of-{}.part", self.shards)
    }

    /// The part of a share, counted from 1.
    fn part(&self, share: u32) -> PathBuf {
        PathBuf::from(format!("{}.{share}{}", self.picture.display(), self.part_suffix()))
    }
}

/// How often a task keeps what it has, so that it can be moved to another machine.
const CHECKPOINT: &str = "60s";

pub(crate) fn run(args: FarmArgs, program: Option<PathBuf>) -> Outcome {
    // A scene with mistakes is found here, not on a hundred machines.
    let mut loaded = load(&args.scene, args.overrides.film_size(), args.overrides.parameters())?;
    args.overrides.apply(&mut loaded.scene)?;
    print::warnings(&loaded.warnings);
    let stem = args.scene.file_stem().map_or_else(|| "picture".into(), |stem| stem.to_string_lossy().into_owned());
    let absolute = |path: &Path| std::path::absolute(path).map_err(|error| Failure::run(Report::from_err(error)));
    let frames = args.frames.frames.as_ref();
    let picture = args.picture.clone().unwrap_or_else(|| {
        let name = PathBuf::from(format!("{stem}.exr"));
        if frames.is_some() { numbered(&name) } else { name }
    });
    let each_its_own = || frames.map_or(1, |list| list.numbers().len().min(MOST_SHARES as usize) as u32);
    let mut options = args.overrides.as_words().to_vec();
    options.extend(args.error.iter().flat_map(|error| ["--error".to_owned(), error.to_string()]));
    let job = Job {
        name: label(&stem),
        program: match program {
            Some(program) => program,
            None => std::env::current_exe().map_err(|error| Failure::run(Report::from_err(error)))?,
        },
        scene: absolute(&args.scene)?,
        picture: absolute(&picture)?,
        shards: args.shards.unwrap_or_else(each_its_own),
        threads: args.threads,
        options,
    };
    check(&job, &loaded.scene, args.openjd, frames).into_outcome()?;
    let text = match frames.map(|list| args.frames.words(list.text())) {
        None if args.slurm => slurm::script(&job),
        None => openjd::template(&job),
        Some(frames) if args.slurm => sequence::script(&job, &frames),
        Some(frames) => sequence::openjd(&job, &frames),
    };
    match &args.output {
        None => print::line(text.trim_end()),
        Some(path) => write_atomically(path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| Failure::run(Report::from_err(error)))?,
    }
    Ok(())
}

/// A name for the job that every farm takes: Open Job Description refuses control characters and more than 128 characters, and
/// takes what stands between double braces for an expression.
fn label(stem: &str) -> String {
    let plain = |c: char| if c.is_control() || c == '{' || c == '}' { '_' } else { c };
    format!("etalon-{stem}").chars().map(plain).take(128).collect()
}

/// Longest value of a parameter of Open Job Description, characters.
const LONGEST_VALUE: usize = 1024;
/// Longest name of a file on the usual file systems, bytes.
const LONGEST_NAME: usize = 255;

/// All that would make the job fail when it runs.
fn check(job: &Job, scene: &Scene, openjd: bool, frames: Option<&FrameList>) -> Failure {
    let mut failure = Failure::default();
    let mut refuse = |code: &str, text: String| failure.add(Failure::input(miette!(code = code.to_owned(), "{text}")));
    for path in [&job.program, &job.scene, &job.picture] {
        let shown = path.display();
        match path.to_str() {
            None => refuse("path", format!("a job cannot name the path `{shown}`: it is not UTF-8")),
            Some(text) if text.contains(char::is_control) => {
                refuse("path", format!("a job cannot name the path {text:?}: it has control characters"));
            }
            Some(text) if openjd && text.chars().count() > LONGEST_VALUE => {
                refuse(
                    "path",
                    format!("a job cannot name the path `{shown}`: it has more than {LONGEST_VALUE} characters"),
                );
            }
            Some(_) => {}
        }
    }
    if let Some(list) = frames {
        failure.add(sequence::check(job, list));
        return failure;
    }
    failure.add(check_length(&state::checkpoint_path(&job.part(job.shards)), "its parts' checkpoints"));
    let film = PixelRect { x0: 0, y0: 0, x1: scene.film.width, y1: scene.film.height };
    if let Err(unknown) = output::Format::of(&job.picture) {
        failure.add(unknown);
    }
    if let Err(too_many) = check_shares(film, job.shards) {
        failure.add(too_many);
    }
    failure
}

/// A name must not be longer than file systems allow.
fn check_length(name: &Path, whose: &str) -> Failure {
    let mut failure = Failure::default();
    let length = name.file_name().map_or(0, |name| name.len());
    if length > LONGEST_NAME {
        let text = format!("the picture's name is too long: {whose} would have names of {length} bytes, such as");
        failure.add(Failure::input(miette!(code = "path", "{text} `{}`", name.display())));
    }
    failure
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_jobs_are_such_as_every_farm_takes() {
        assert_eq!(label("it's a box"), "etalon-it's a box");
        assert_eq!(label("{{x}}\n\u{9f}"), "etalon-__x____");
        assert_eq!(label(&"é".repeat(200)).chars().count(), 128);
    }
}
