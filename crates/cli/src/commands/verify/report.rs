//! What is said about each truth: a table for people, one JSON object for machines.

use std::time::Instant;

use etalon_oracle::Verdict;
use etalon_oracle::statistics::{Estimate, POWER, SUITE_SIGNIFICANCE};
use etalon_oracle::subjects::Reading;
use etalon_oracle::truths::{Mistake, Truth, judge};
use miette::miette;
use serde::Serialize;

use super::resolution::Resolution;
use crate::failure::{Failure, Outcome};
use crate::print;

/// One truth, judged.
#[derive(Serialize)]
pub(super) struct Row {
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
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
    /// Camera paths that were taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    paths: Option<u64>,
    /// Camera paths, and shadow rays, that were cut at the internal limit on vertices.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut_paths: Option<u64>,
    /// The largest bias that they may have caused, in the units of the truth; `null` where nothing bounds it.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut_bias: Option<f64>,
    /// What the scene needs beyond the basics.
    #[serde(skip)]
    abilities: Vec<&'static str>,
    #[serde(skip)]
    mistakes: usize,
    /// Known mistakes that could have passed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unseen: Vec<&'static str>,
}

/// The numbers of a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figures {
    pub truth: f64,
    pub measured: f64,
    pub standard_error: f64,
    pub resolvable_bias: f64,
    pub pass: bool,
}

impl Figures {
    /// The difference over the standard error.
    pub(super) fn deviation(&self) -> f64 {
        (self.measured - self.truth) / self.standard_error
    }
}

impl Row {
    /// Its numbers.
    pub(super) fn figures(&self) -> Figures {
        let Self { truth, measured, standard_error, resolvable_bias, pass, .. } = *self;
        Figures { truth, measured, standard_error, resolvable_bias, pass }
    }

    /// The truth's.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// What the scene needs beyond the basics.
    pub(super) fn abilities(&self) -> &[&'static str] {
        &self.abilities
    }

    /// How many mistakes the truth knows of.
    pub(super) fn mistakes(&self) -> usize {
        self.mistakes
    }

    /// Those that could have passed.
    pub(super) fn unseen_mistakes(&self) -> impl Iterator<Item = &'static str> {
        self.unseen.iter().copied()
    }

    /// The smallest bias that would have been caught, relative to the truth; `None` of a truth of 0, and without a reading.
    pub(super) fn relative_resolution(&self) -> Option<f64> {
        let relative = self.resolvable_bias / self.truth.abs();
        (self.truth != 0.0 && relative.is_finite()).then_some(relative)
    }

    /// Judges a reading, or says why there is none.
    pub(super) fn new(truth: &Truth, reading: Result<Reading, String>, significance: f64) -> Self {
        Self::by(truth, reading, |reading| judge(truth, reading, significance))
    }

    /// The same by another judge.
    pub(super) fn by(truth: &Truth, reading: Result<Reading, String>, judge: impl Fn(&Reading) -> Verdict) -> Self {
        let (estimate, verdict) = match reading {
            Ok(reading) => (reading.estimate, judge(&reading)),
            Err(why) => (Estimate::new(f64::NAN, f64::NAN), Verdict::broken(&truth.name, why)),
        };
        // What is not a number excludes nothing.
        let sees = |mistake: &Mistake| (mistake.value - truth.value()).abs() >= verdict.resolvable_bias;
        let could_pass = |mistake: &&Mistake| !sees(mistake);
        Self {
            name: truth.name.clone(),
            formula: truth.formula.clone(),
            truth: truth.value(),
            measured: estimate.mean,
            standard_error: estimate.standard_error,
            z: verdict.statistic,
            resolvable_bias: verdict.resolvable_bias,
            pass: verdict.pass,
            evidence: verdict.evidence,
            seconds: None,
            paths: None,
            cut_paths: None,
            cut_bias: None,
            abilities: truth.claims.iter().map(|claim| claim.name()).collect(),
            mistakes: truth.mistakes().len(),
            unseen: truth.mistakes().iter().filter(could_pass).map(|mistake| mistake.what).collect(),
        }
    }

    /// Says how many paths were cut, if any, and what bias they may have caused.
    pub(super) fn cut(self, paths: u64, bias: f64) -> Self {
        if paths == 0 { self } else { Self { cut_paths: Some(paths), cut_bias: Some(bias), ..self } }
    }

    pub(super) fn took(self, seconds: f64, paths: Option<u64>) -> Self {
        Self { seconds: Some(seconds), paths, ..self }
    }
}

/// Everything that was judged together.
#[derive(Serialize)]
pub(super) struct Report {
    significance: f64,
    power: f64,
    /// Where the pictures came from; absent when they are our own.
    #[serde(skip_serializing_if = "Option::is_none")]
    images: Option<String>,
    /// Absent when the pictures are not our own.
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    seconds: f64,
    /// Whether every truth that was asked for has been judged.
    complete: bool,
    passed: usize,
    failed: usize,
    truths: Vec<Row>,
    /// Absent if no truth was judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    resolution: Option<Resolution>,
    /// Truths that a signal left unjudged.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unjudged: Vec<String>,
    /// Truths of which there is no picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    missing: Option<Vec<String>>,
    #[serde(skip)]
    start: Instant,
    #[serde(skip)]
    table: bool,
    /// How many truths there will be; `None` where pictures are judged.
    #[serde(skip)]
    expected: Option<usize>,
}

impl Report {
    /// An empty report; with `table` every row is printed as it comes.
    pub(super) fn new(table: bool) -> Self {
        if table {
            print::line(&format!(
                "{:<44} {:>14} {:>14} {:>9} {:>6} {:>9} {:>6}",
                "truth", "value", "measured", "± error", "z", "min bias", "s"
            ));
        }
        Self {
            significance: SUITE_SIGNIFICANCE,
            power: POWER,
            images: None,
            seed: None,
            seconds: 0.0,
            complete: true,
            passed: 0,
            failed: 0,
            truths: Vec::new(),
            resolution: None,
            unjudged: Vec::new(),
            missing: None,
            start: Instant::now(),
            table,
            expected: None,
        }
    }

    /// Says how far a run of this many truths has come, where no table shows it.
    pub(super) fn of(self, expected: usize) -> Self {
        Self { expected: Some(expected), ..self }
    }

    pub(super) fn with_seed(self, seed: u64) -> Self {
        Self { seed: Some(seed), ..self }
    }

    pub(super) fn of_images(self, folder: String) -> Self {
        Self { images: Some(folder), missing: Some(Vec::new()), ..self }
    }

    pub(super) fn push(&mut self, row: Row) {
        if self.table {
            print::line(&format!(
                "{:<44} {:>14.10} {:>14.10} {:>9.1e} {:>6.2} {:>9.1e} {:>6}{}",
                row.name,
                row.truth,
                row.measured,
                row.standard_error,
                row.z,
                row.resolvable_bias,
                row.seconds.map(|seconds| format!("{seconds:.1}")).unwrap_or_default(),
                match (row.pass, row.cut_paths.zip(row.cut_bias)) {
                    (true, None) => String::new(),
                    (true, Some((1, bias))) => format!("  1 path was cut: a bias of at most {bias:.1e}"),
                    (true, Some((paths, bias))) => format!("  {paths} paths were cut: a bias of at most {bias:.1e}"),
                    (false, _) => format!("  FAILED: {}", row.evidence),
                }
            ));
        }
        if let Some(expected) = self.expected.filter(|_| !self.table) {
            print::note(&format!(
                "{}/{expected} {}: {}, smallest visible bias {:.1e} of {:.10}, {:.1} s",
                self.truths.len() + 1,
                row.name,
                if row.pass { "passes".to_owned() } else { format!("FAILED: {}", row.evidence) },
                row.resolvable_bias,
                row.truth,
                row.seconds.unwrap_or_default(),
            ));
        }
        *if row.pass { &mut self.passed } else { &mut self.failed } += 1;
        self.truths.push(row);
    }

    pub(super) fn push_missing(&mut self, truth: &Truth) {
        if self.table {
            print::line(&format!("{:<44} {:>14.10} {:>14}", truth.name, truth.value(), "no picture"));
        }
        self.missing.get_or_insert_default().push(truth.name.clone());
    }

    /// The truths that took most of the time, with their seconds; `None` of pictures that were rendered elsewhere.
    fn slowest(&self) -> Option<String> {
        let mut timed: Vec<(&str, f64)> =
            self.truths.iter().filter_map(|row| Some((row.name.as_str(), row.seconds?))).collect();
        timed.sort_by(|a, b| b.1.total_cmp(&a.1));
        let named: Vec<String> = timed.iter().take(5).map(|(name, seconds)| format!("{name} {seconds:.1} s")).collect();
        (!named.is_empty()).then(|| named.join(", "))
    }

    /// As [`Report::finish`], of a run that a signal has ended before these truths.
    pub(super) fn interrupted(mut self, signal: u8, left: &[Truth]) -> Outcome {
        self.complete = false;
        self.unjudged = left.iter().map(|truth| truth.name.clone()).collect();
        let (done, left) = (self.truths.len(), left.len());
        let ended =
            Failure::signal(signal, miette!(code = "interrupted", "ended after {done} truths; {left} are not judged"));
        let mut failure = self.finish().err().unwrap_or_default();
        failure.add(ended);
        Err(failure)
    }

    /// Prints what is left to say; a failure if any truth does not hold.
    pub(super) fn finish(mut self) -> Outcome {
        self.seconds = self.start.elapsed().as_secs_f64();
        self.resolution = Resolution::of(&self.truths);
        if self.table {
            let missing = match &self.missing {
                Some(missing) if !missing.is_empty() => format!(", {} without a picture", missing.len()),
                _ => String::new(),
            };
            let unjudged = match self.unjudged.len() {
                0 => String::new(),
                left => format!(", {left} not judged"),
            };
            print::line(&format!(
                "{} passed, {} failed{missing}{unjudged}, in {:.1} s; a correct renderer fails one of them with probability {:.0e}",
                self.passed, self.failed, self.seconds, SUITE_SIGNIFICANCE
            ));
            self.resolution.iter().flat_map(Resolution::lines).for_each(|line| print::line(&line));
            if let Some(slowest) = self.slowest() {
                print::line(&format!("slowest: {slowest}"));
            }
        } else {
            print::json(&self);
        }
        match self.failed {
            0 => Ok(()),
            failed => Err(Failure::run(miette!(code = "truths", "{failed} of {} truths failed", self.truths.len()))),
        }
    }
}
