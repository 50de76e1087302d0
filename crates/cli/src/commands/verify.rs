//! `etalon verify`: our integrator held to every truth of the oracle.

use std::time::Instant;

use clap::ValueEnum;
use etalon_oracle::Verdict;
use etalon_oracle::statistics::{Budget, Estimate, POWER, SUITE_SIGNIFICANCE, Welford};
use etalon_oracle::subjects::{Reading, Renders};
use etalon_oracle::truths::{Claim, Truth, judge, truths};
use etalon_scene::Precision;
use etalon_transport::{Control, Extent, prepare};
use miette::miette;
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::print;

/// Renders scenes whose answer is known in closed form, and says how far off we are.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only truths whose name contains one of these; all if none is given.
    names: Vec<String>,
    /// Print one JSON object on standard output instead of a table.
    #[arg(long)]
    json: bool,
    /// Seed of every random number.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Sixty-four times the samples: sees an eighth of the bias.
    #[arg(long)]
    thorough: bool,
    /// Scalar type that paths are computed in.
    #[arg(long, value_enum, default_value_t = PrecisionArg::F64)]
    precision: PrecisionArg,
    /// Threads; all cores if not given.
    #[arg(long, alias = "nthreads", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
}

#[derive(Clone, Copy, ValueEnum)]
enum PrecisionArg {
    /// 32-bit floating point.
    F32,
    /// 64-bit floating point.
    F64,
}

/// Independent renders of each truth: their scatter is the standard error, whatever the samples within one have to do
/// with each other. With 64 of them Student's t at the suite's significance is close to the normal distribution.
const REPLICATES: u32 = 64;
/// At the first try, all replicates together take this part of the samples that the truth's scene suggests: those are meant
/// for independent numbers.
const FIRST: u32 = 4;
/// A reading too noisy to count is taken again with this many times the paths, so many times.
const MORE: u64 = 4;
const TRIES: u32 = 5;

/// Our renderer, as the oracle sees one.
struct Etalon {
    seed: u64,
    /// In parts of the samples that the scene suggests, [`FIRST`] of them.
    effort: u64,
    precision: Precision,
    threads: Option<usize>,
}

impl Etalon {
    /// Mean Y of the whole film in one replicate, and its non-finite samples.
    fn mean_y(&self, json: &str, replicate: u32) -> Result<(f64, u64), String> {
        let (mut scene, _) = etalon_scene::parse(json, "truth").map_err(|errors| errors.summary())?;
        let suggested = self.effort * u64::from(scene.integrator.spp);
        let spp = suggested.div_ceil(u64::from(FIRST * REPLICATES)).next_power_of_two();
        scene.integrator.precision = self.precision;
        // Distinct for each pair: fewer replicates than 2¹⁶.
        scene.integrator.seed = self.seed << 16 | u64::from(replicate);
        scene.integrator.spp = u32::try_from(spp).map_err(|error| error.to_string())?;
        let prepared = prepare(&scene).map_err(|error| error.to_string())?;
        let extent = Extent { threads: self.threads, ..prepared.whole(None) };
        let film = prepared.render(&extent, &|_| Control::Continue).map_err(|error| error.to_string())?;
        if film.counters.cut_paths > 0 {
            return Err(format!("{} paths were cut at the internal limit", film.counters.cut_paths));
        }
        Ok((film.mean_y(extent.rect), film.counters.nonfinite))
    }
}

impl Renders for Etalon {
    fn render(&mut self, truth: &Truth) -> Result<Reading, String> {
        let mut moments = Welford::new();
        let mut nonfinite = 0;
        for replicate in 0..REPLICATES {
            let (mean, bad) = self.mean_y(&truth.scene, replicate)?;
            // A film of CIE Y reads a narrow band relative to a white sky in the same band.
            let white = match truth.white_scene() {
                Some(white) => self.mean_y(&white, replicate)?.0,
                None => 1.0,
            };
            moments.push(mean / white);
            nonfinite += bad;
        }
        Ok(Reading { estimate: moments.estimate(), nonfinite })
    }
}

/// One truth, judged.
#[derive(Serialize)]
struct Row {
    name: String,
    formula: String,
    truth: f64,
    measured: f64,
    standard_error: f64,
    z: f64,
    /// The smallest bias that this very test would have caught, in the units of the truth.
    resolvable_bias: f64,
    pass: bool,
    evidence: String,
    seconds: f64,
}

#[derive(Serialize)]
struct Report {
    significance: f64,
    power: f64,
    seed: u64,
    seconds: f64,
    passed: usize,
    failed: usize,
    truths: Vec<Row>,
}

pub(crate) fn run(args: Args) -> Outcome {
    let start = Instant::now();
    let chosen: Vec<Truth> = truths()
        .into_iter()
        // What we claim is plain radiance, polarisations averaged at every interface.
        .filter(|truth| truth.applies_to(&Claim::UNPOLARISED))
        .filter(|truth| args.names.is_empty() || args.names.iter().any(|name| truth.name.contains(name.as_str())))
        .collect();
    if chosen.is_empty() {
        return Err(Failure::input(miette!(code = "unknown-truth", "no truth has a name like {:?}", args.names)));
    }
    let budget = Budget::for_tests(chosen.len());
    if !args.json {
        print::line(&format!(
            "{:<44} {:>14} {:>14} {:>9} {:>6} {:>9}",
            "truth", "value", "measured", "± error", "z", "sees"
        ));
    }
    let mut rows = Vec::new();
    for truth in &chosen {
        let row = judged(&args, truth, budget.each());
        if !args.json {
            print::line(&format!(
                "{:<44} {:>14.10} {:>14.10} {:>9.1e} {:>6.2} {:>9.1e}{}",
                row.name,
                row.truth,
                row.measured,
                row.standard_error,
                row.z,
                row.resolvable_bias,
                if row.pass { String::new() } else { format!("  FAILED: {}", row.evidence) }
            ));
        }
        rows.push(row);
    }
    let failed = rows.iter().filter(|row| !row.pass).count();
    let report = Report {
        significance: SUITE_SIGNIFICANCE,
        power: POWER,
        seed: args.seed,
        seconds: start.elapsed().as_secs_f64(),
        passed: rows.len() - failed,
        failed,
        truths: rows,
    };
    if args.json {
        print::json(&report);
    } else {
        print::line(&format!(
            "{} passed, {} failed, in {:.1} s; a right renderer fails any of them with probability {:.0e}",
            report.passed, failed, report.seconds, SUITE_SIGNIFICANCE
        ));
    }
    match failed {
        0 => Ok(()),
        _ => Err(Failure::run(miette!(code = "truths", "{failed} of {} truths do not hold", report.truths.len()))),
    }
}

/// Renders and judges one truth; takes more samples, never more seeds to choose from, where the reading was too noisy to
/// exclude a known mistake. Whether it was depends on the noise alone, so that stopping does not favour a verdict.
fn judged(args: &Args, truth: &Truth, significance: f64) -> Row {
    let start = Instant::now();
    let mut renderer = Etalon {
        seed: args.seed,
        effort: if args.thorough { 64 } else { 1 },
        precision: match args.precision {
            PrecisionArg::F32 => Precision::F32,
            PrecisionArg::F64 => Precision::F64,
        },
        threads: args.threads.map(|threads| threads as usize),
    };
    let mut tries = 1;
    let (reading, verdict): (Reading, Verdict) = loop {
        let (reading, verdict) = match renderer.render(truth) {
            Ok(reading) => (reading, judge(truth, &reading, significance)),
            Err(why) => {
                let estimate = Estimate::new(f64::NAN, f64::NAN);
                break (Reading { estimate, nonfinite: 0 }, Verdict::broken(&truth.name, why));
            }
        };
        let seen = verdict.resolvable_bias <= truth.must_resolve();
        if seen || tries == TRIES {
            break (reading, verdict);
        }
        tries += 1;
        renderer.effort *= MORE;
    };
    Row {
        name: truth.name.clone(),
        formula: truth.formula.clone(),
        truth: truth.value,
        measured: reading.estimate.mean,
        standard_error: reading.estimate.standard_error,
        z: verdict.statistic,
        resolvable_bias: verdict.resolvable_bias,
        pass: verdict.pass,
        evidence: verdict.evidence,
        seconds: start.elapsed().as_secs_f64(),
    }
}
