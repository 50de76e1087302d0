//! Public suites of test cases, and the page with what we read.

use clap::ValueEnum;
use etalon_oracle::statistics::Budget;
use etalon_oracle::truths::{SuiteCase, Truth, cie171, rami};
use etalon_picture::write_atomically;
use miette::Report as Problem;
use std::fmt::Write as _;

use super::VerifyArgs;
use super::ours::judged;
use super::report::{Figures, Report};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;

/// A public suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Suite {
    /// CIE 171:2006, sections 5.2 to 5.14.
    Cie171,
    /// Canopies of leaves in the manner of RAMI.
    Rami,
}

impl Suite {
    /// Its points.
    pub(super) fn cases(self) -> Vec<SuiteCase> {
        match self {
            Self::Cie171 => cie171(),
            Self::Rami => rami(),
        }
    }

    /// Its name in commands and files.
    fn name(self) -> &'static str {
        match self {
            Self::Cie171 => "cie171",
            Self::Rami => "rami",
        }
    }

    /// What the page says before and after its readings.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Cie171 => [include_str!("suite/cie171.md"), include_str!("suite/cie171-notes.md")],
            Self::Rami => [include_str!("suite/rami.md"), include_str!("suite/rami-notes.md")],
        }
    }
}

/// Our own integrator, held to the points of a suite; the page goes to `page`.
pub(super) fn run(args: &VerifyArgs, suite: Suite, cases: &[SuiteCase]) -> Outcome {
    let interrupt = Interrupt::listen()
        .map_err(|error| Failure::run(Problem::from_err(error).wrap_err("cannot listen to signals")))?;
    let significance = Budget::for_tests(cases.len()).each();
    let mut report = Report::new(!args.json).with_seed(args.seed).of(cases.len());
    let mut lines = Vec::with_capacity(cases.len());
    for (index, case) in cases.iter().enumerate() {
        let Some((row, _)) = judged(args, &case.truth, None, significance, &interrupt) else {
            let signal = interrupt.signal().expect("nothing else ends a measurement early");
            let left: Vec<Truth> = cases[index..].iter().map(|case| case.truth.clone()).collect();
            return report.interrupted(signal, &left);
        };
        lines.push((case, row.figures()));
        report.push(row);
    }
    if let Some(page) = args.page.as_deref() {
        let text = written(suite, args.seed, &lines);
        write_atomically(page, |out| out.write_all(text.as_bytes()))
            .map_err(|error| Failure::run(Problem::from_err(error)))?;
    }
    report.finish()
}

const READINGS: &str = "
Each reading is the mean of 64 independent replicates; `±` is its standard error. *Finds* is the smallest relative bias that the test would have
found. *z* is the difference over the standard error, `–` where the reading has no noise.
";

fn written(suite: Suite, seed: u64, lines: &[(&SuiteCase, Figures)]) -> String {
    let (name, [head, notes]) = (suite.name(), suite.words());
    let passed = lines.iter().filter(|(_, figures)| figures.pass).count();
    let finds = |figures: &Figures| figures.resolvable_bias / figures.truth.abs();
    let worst = lines.iter().map(|(_, figures)| finds(figures)).fold(0.0, f64::max);
    let noisy = |figures: &Figures| (figures.standard_error > 1e-9 * figures.truth.abs()).then(|| figures.deviation());
    let largest = lines.iter().filter_map(|(_, figures)| noisy(figures)).map(f64::abs).fold(0.0, f64::max);
    let mut text = format!("{head}{READINGS}");
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "\n```sh\netalon verify --suite {name} --seed {seed} --page docs/benchmarks/{name}.md\n```\n\n\
         {passed} of {} points pass. The largest |z| is {largest:.2}. The coarsest reading would have shown a bias of {:.2} %.\n\n\
         Another renderer can be held to the same points: `etalon verify --suite {name} --export DIR` writes the scenes and the expected readings,\n\
         `etalon verify --suite {name} --images DIR` judges what it read (see [your own renderer](../how-to/your-own-renderer.md)).\n",
        lines.len(),
        100.0 * worst
    );
    let mut section = "";
    for (case, figures) in lines {
        if case.section != section {
            section = case.section;
            let _ = write!(
                text,
                "\n## {section} {}\n\n{}.\n\n| point | expected | measured | difference | z | finds |\n|---|---:|---:|---:|---:|---:|\n",
                case.title, case.truth.formula
            );
        }
        let shown = |value: f64| value * case.factor;
        let z = noisy(figures).map_or("–".to_owned(), |z| format!("{z:.2}"));
        let _ = writeln!(
            text,
            "| {} | {:.4}{} | {:.4} ± {:.4} | {:+.3} % | {z} | {:.2} %{} |",
            case.point,
            shown(figures.truth),
            if case.unit.is_empty() { String::new() } else { format!(" {}", case.unit) },
            shown(figures.measured),
            shown(figures.standard_error),
            100.0 * (figures.measured / figures.truth - 1.0),
            100.0 * finds(figures),
            if figures.pass { "" } else { ", **fails**" }
        );
    }
    text + "\n" + notes
}
