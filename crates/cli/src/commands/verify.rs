//! `etalon verify`: our integrator, or pictures from another, held to every truth of the oracle.

mod export;
mod ours;
mod pictures;
mod report;
mod series;

use std::path::PathBuf;

use etalon_oracle::truths::{Truth, truths};
use miette::miette;

use crate::failure::{Failure, Outcome};

/// Renders scenes whose answer is known in closed form, and says how far off we are; or judges another renderer's pictures.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only truths whose name contains one of these; all if none is given.
    names: Vec<String>,
    /// Judge the pictures in this folder (NAME.exr), which another program rendered, instead of rendering.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["seed", "thorough", "threads"])]
    images: Option<PathBuf>,
    /// Write the scenes with what is expected of them into this folder, for another renderer to join, and do nothing else.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["images", "json", "seed", "thorough", "threads"])]
    export: Option<PathBuf>,
    /// Print one JSON object on standard output instead of a table.
    #[arg(long)]
    json: bool,
    /// Seed of every random number.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Take more samples until a bias of one part in ten thousand would show: 32 million rays a truth, and up to 256 million where
    /// these will do. Each film is one pixel then, whose samples are spread over the whole picture.
    #[arg(long)]
    thorough: bool,
    /// Threads; all cores if not given.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
}

pub(crate) fn run(args: Args) -> Outcome {
    let named =
        |truth: &Truth| args.names.is_empty() || args.names.iter().any(|name| truth.name.contains(name.as_str()));
    let chosen: Vec<Truth> = truths().into_iter().filter(named).collect();
    match (&args.export, &args.images) {
        _ if chosen.is_empty() => {
            Err(Failure::input(miette!(code = "unknown-truth", "no truth has a name like {:?}", args.names)))
        }
        (Some(folder), _) => export::run(folder, &chosen),
        (None, Some(folder)) => pictures::run(folder, &chosen, args.json),
        (None, None) => ours::run(&args, chosen),
    }
}
