//! Public suites of test cases, and the page with what we read.

use std::fmt::Write as _;
use std::path::Path;

use clap::ValueEnum;
use etalon_oracle::statistics::Budget;
use etalon_oracle::truths::{SuiteCase, Truth, cie171, section_title};
use etalon_picture::write_atomically;
use miette::Report as Problem;

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
}

impl Suite {
    /// Its points.
    pub(super) fn cases(self) -> Vec<SuiteCase> {
        match self {
            Self::Cie171 => cie171(),
        }
    }
}

/// Our own integrator, held to the points of a suite; the page goes to `page`.
pub(super) fn run(args: &VerifyArgs, cases: &[SuiteCase], page: Option<&Path>) -> Outcome {
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
    if let Some(page) = page {
        let text = written(args.seed, &lines);
        write_atomically(page, |out| out.write_all(text.as_bytes()))
            .map_err(|error| Failure::run(Problem::from_err(error)))?;
    }
    report.finish()
}

const HEAD: &str = "# CIE 171:2006

The report *CIE 171:2006, Test cases to assess the accuracy of lighting computer programs* describes situations whose illuminance has an analytical
answer. This page has a reading for each of its sections 5.2 to 5.14. The situations are the report's. Every expected value is computed by
the oracle (`crates/oracle/src/truths/cie171/`) from a closed form or by quadrature, and a second time by another way. No number of the report's
tables is used, so a printed table that is wrong changes nothing here.

Each reading is the mean of 64 independent replicates; `±` is its standard error. *Finds* is the smallest relative bias that the test would have
found. *z* is the difference over the standard error, `–` where the reading has no noise.
";

const NOTES: &str = "
## What differs from the report

- In 5.4 the opening itself is evenly luminous; what is tested is that what enters arrives.
- In 5.5 and behind glass the glass has the index 1.52. In 5.5 it is 6 mm thick and absorbs 10 m⁻¹; s and p are carried apart (`--polarised`).
  In 5.10 and 5.12 it is a pane that absorbs nothing.
- In 5.8 the readings are means over all faces with the direct light. Of E = Φ/(96 (1 − ρ)) lx the part Φ/96 = 104.17 lx is direct; what is left,
  ρΦ/(96 (1 − ρ)), is 104, 417, 938 and 1979 lx.
- In 5.9 to 5.14 all inner surfaces are black, so that readings are sky components, and externally reflected ones where the ground is seen. The
  sun that the skies depend on stands 40° high. The ground has the luminance 0.3 E/π, E the level illuminance in the open, up to the horizon.
  Masks are black.
- The three general skies of the report stand among all sixteen of the standard (CIE S 011): 5 is the uniform one, 1 the overcast one, 16 the
  traditional overcast one, 12 the clear one.
";

fn written(seed: u64, lines: &[(&SuiteCase, Figures)]) -> String {
    let passed = lines.iter().filter(|(_, figures)| figures.pass).count();
    let finds = |figures: &Figures| figures.resolvable_bias / figures.truth.abs();
    let worst = lines.iter().map(|(_, figures)| finds(figures)).fold(0.0, f64::max);
    let noisy = |figures: &Figures| (figures.standard_error > 1e-9 * figures.truth.abs()).then(|| figures.deviation());
    let largest = lines.iter().filter_map(|(_, figures)| noisy(figures)).map(f64::abs).fold(0.0, f64::max);
    let mut text = HEAD.to_owned();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "\n```sh\netalon verify --suite cie171 --seed {seed} --page docs/benchmarks/cie171.md\n```\n\n\
         {passed} of {} points pass. The largest |z| is {largest:.2}. The coarsest reading would have shown a bias of {:.2} %.\n\n\
         Another renderer can be held to the same points: `etalon verify --suite cie171 --export DIR` writes the scenes and the expected readings,\n\
         `etalon verify --suite cie171 --images DIR` judges what it read (see [your own renderer](../how-to/your-own-renderer.md)).\n",
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
                section_title(section),
                case.truth.formula
            );
        }
        let shown = |value: f64| value * case.factor;
        let z = noisy(figures).map_or("–".to_owned(), |z| format!("{z:.2}"));
        let _ = writeln!(
            text,
            "| {} | {:.4} {} | {:.4} ± {:.4} | {:+.3} % | {z} | {:.2} %{} |",
            case.point,
            shown(figures.truth),
            case.unit,
            shown(figures.measured),
            shown(figures.standard_error),
            100.0 * (figures.measured / figures.truth - 1.0),
            100.0 * finds(figures),
            if figures.pass { "" } else { ", **fails**" }
        );
    }
    text + NOTES
}
