//! `etalon verify`: our integrator, or pictures from another, held to every truth of the oracle.

mod export;
mod ours;
mod pictures;
mod report;
mod resolution;
mod series;
mod suite;

use std::path::PathBuf;

use etalon_oracle::truths::{Claim, SuiteCase, Truth, truths};
use miette::miette;

use crate::failure::{Failure, Outcome};

/// Test Etalon, or another renderer, with scenes whose answer is known in closed form.
///
/// For each scene it prints the measured value, its standard error, and the smallest bias that the test would have found. For all of them it says
/// how many would have shown a bias of 5, 1, 0.2 and 0.02 %, and how many known mistakes would have been seen. Each scene must exclude its known
/// mistakes and a bias of 2 %, or another that is stated for it. A run of all scenes takes about three minutes of two cores: there a scene need
/// not exclude a bias below 5 % once it has taken 0.4 million rays. The exit status is 1 if a scene fails.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon verify eye-in-glass
  etalon verify --suite cie171
  etalon verify --suite rami
  etalon verify --export truths
  etalon verify --images pictures")]
pub(crate) struct VerifyArgs {
    /// Test only scenes whose name contains one of these words, or that need one of these abilities, such as scattering. The word media stands for absorption and scattering. Default: all.
    names: Vec<String>,
    /// Render nothing. Judge the pictures of another renderer in this folder, named NAME.exr.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["seed", "thorough", "sees", "coarse", "threads"])]
    images: Option<PathBuf>,
    /// Render nothing. Write the scenes and the expected values to this folder, for another renderer.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["images", "json", "seed", "thorough", "sees", "coarse", "threads"])]
    export: Option<PathBuf>,
    /// Test a public suite of test cases instead of our own.
    #[arg(long, value_enum, value_name = "SUITE")]
    suite: Option<suite::Suite>,
    /// Write a page with what was read of the suite to this file, and its drawing beside it, with the ending .svg.
    #[arg(long, value_name = "FILE", requires = "suite", conflicts_with_all = ["export", "images"])]
    page: Option<PathBuf>,
    /// Add what another renderer read to the page, from its pictures in this folder: "My renderer 2.0=pictures".
    #[arg(long, value_name = "NAME=DIR", requires = "page", value_parser = suite::Peer::parse)]
    peer: Vec<suite::Peer>,
    /// Print one JSON object on standard output instead of a table.
    #[arg(long)]
    json: bool,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Take more rays until a relative bias of 0.2 % would be found, or 0.02 % in a scene given by its whole name. A scene gets up to 32 million
    /// rays, or up to 4 billion if that many suffice; one that needs more stops earlier. Each film then has as few pixels as its shape allows;
    /// together they cover the picture.
    #[arg(long)]
    thorough: bool,
    /// The same until another bias would be found, such as 0.5%.
    #[arg(long, value_name = "PERCENT", value_parser = crate::args::percentage, conflicts_with = "thorough")]
    sees: Option<f64>,
    /// Take the first samples of each scene alone. A reading that is too noisy to exclude a known mistake does not fail; what it has seen is
    /// printed as always.
    #[arg(long, conflicts_with_all = ["thorough", "sees"])]
    coarse: bool,
    /// Number of threads. Default: all cores.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
}

impl VerifyArgs {
    /// Whether more rays are taken than a reading needs to count.
    fn is_thorough(&self) -> bool {
        self.thorough || self.sees.is_some()
    }
}

pub(crate) fn run(args: VerifyArgs) -> Outcome {
    let is_of = |truth: &Truth, word: &str| {
        let in_media = |claim: &Claim| word == "media" && matches!(claim, Claim::Absorption | Claim::Scattering);
        truth.name.contains(word) || truth.claims.iter().any(|claim| claim.name() == word || in_media(claim))
    };
    let named = |truth: &Truth| args.names.is_empty() || args.names.iter().any(|word| is_of(truth, word));
    let cases: Option<Vec<SuiteCase>> = args.suite.map(suite::Suite::cases);
    let cases = cases.map(|cases| cases.into_iter().filter(|case| named(&case.truth)).collect::<Vec<_>>());
    let chosen: Vec<Truth> = match &cases {
        Some(cases) => cases.iter().map(|case| case.truth.clone()).collect(),
        None => truths().into_iter().filter(named).collect(),
    };
    match (&args.export, &args.images) {
        _ if chosen.is_empty() => Err(Failure::input(miette!(
            code = "unknown-truth",
            "no scene has a name that contains one of {:?}, and none needs such an ability",
            args.names
        ))),
        (Some(folder), _) => export::run(folder, &chosen),
        (None, Some(folder)) => pictures::run(folder, &chosen, args.json),
        (None, None) => match (args.suite, &cases) {
            (Some(suite), Some(cases)) => suite::run(&args, suite, cases),
            _ => ours::run(&args, chosen),
        },
    }
}
