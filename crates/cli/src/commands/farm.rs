//! `etalon farm`: a job for many machines, as a script for Slurm or a template for Open Job Description.

mod openjd;
mod slurm;

use std::path::{Path, PathBuf};

use etalon_picture::write_atomically;
use miette::{Report, miette};

use crate::failure::{Failure, Outcome};
use crate::load::load;
use crate::overrides::Overrides;
use crate::print;

/// Writes a job that renders a scene in shares on many machines and merges them into one picture, byte for byte that of one
/// machine.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("kind").required(true))]
pub(crate) struct Args {
    /// The scene, as for `etalon render`. All machines must see it, and the picture's folder, under the same path.
    scene: PathBuf,
    /// How many shares; each is one task of the job.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    shards: u32,
    /// Write a script for Slurm: run it where jobs are submitted, and it submits an array of renders and a merge.
    #[arg(long, group = "kind")]
    slurm: bool,
    /// Write a job template of Open Job Description (jobtemplate-2023-09).
    #[arg(long, group = "kind")]
    openjd: bool,
    /// The job; standard output if not given.
    #[arg(short, long, alias = "outfile", value_name = "FILE")]
    output: Option<PathBuf>,
    /// The picture that the job makes; the scene's name with .exr, in this folder, if not given. The parts lie beside it.
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Threads of each task; all cores of its machine if not given.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// End when the relative error is this small: see `etalon render`. Every share explores and pilots the
    /// whole picture to find out, which costs each of them a tenth of the picture or so: from about ten shares on, `etalon quote`
    /// and --spp cost less.
    #[arg(long, value_name = "PERCENT", value_parser = crate::args::percentage)]
    error: Option<f64>,
    #[command(flatten)]
    overrides: Overrides,
}

/// A job, with paths that do not depend on where it runs.
struct Job {
    name: String,
    program: PathBuf,
    scene: PathBuf,
    picture: PathBuf,
    shards: u32,
    threads: Option<u32>,
    /// Options of every render, each with a space before it.
    flags: String,
}

impl Job {
    /// What follows a part's number in its name; before it stand the picture's name and a point.
    fn part_suffix(&self) -> String {
        format!("-of-{}.part", self.shards)
    }
}

/// How often a task keeps what it has, so that it can be moved to another machine.
const CHECKPOINT: &str = "60s";

pub(crate) fn run(args: Args) -> Outcome {
    // A scene with mistakes is found here, not on a hundred machines.
    let mut loaded = load(&args.scene, args.overrides.film_size())?;
    args.overrides.apply(&mut loaded.scene)?;
    print::warnings(&loaded.warnings);
    let stem = args.scene.file_stem().map_or_else(|| "picture".into(), |stem| stem.to_string_lossy().into_owned());
    let absolute = |path: &Path| std::path::absolute(path).map_err(|error| Failure::run(Report::from_err(error)));
    let picture = args.picture.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.exr")));
    let mut flags = args.overrides.as_flags();
    if let Some(error) = args.error {
        flags += &format!(" --error {error}");
    }
    let job = Job {
        name: format!("etalon-{stem}"),
        program: std::env::current_exe().map_err(|error| Failure::run(Report::from_err(error)))?,
        scene: absolute(&args.scene)?,
        picture: absolute(&picture)?,
        shards: args.shards,
        threads: args.threads,
        flags,
    };
    for path in [&job.program, &job.scene, &job.picture] {
        if path.to_str().is_none_or(|path| path.contains(['\n', '\0'])) {
            let text = format!("a job cannot name the path `{}`", path.display());
            return Err(Failure::input(miette!(code = "path", "{text}")));
        }
    }
    let text = if args.slurm { slurm::script(&job) } else { openjd::template(&job) };
    match &args.output {
        None => print::line(text.trim_end()),
        Some(path) => write_atomically(path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| Failure::run(Report::from_err(error)))?,
    }
    Ok(())
}
