//! Public suites of test cases, and the page with what we read.

mod plot;

use clap::ValueEnum;
use etalon_oracle::statistics::Budget;
use etalon_oracle::truths::{SuiteCase, Truth, cie171, rami};
use etalon_picture::write_atomically;
use miette::Report as Problem;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::VerifyArgs;
use super::ours::judged;
use super::pictures::readings;
use super::report::{Figures, Report, Row};
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

    /// Its name in words.
    fn title(self) -> &'static str {
        match self {
            Self::Cie171 => "CIE 171:2006, sections 5.2 to 5.14",
            Self::Rami => "RAMI: canopies of leaves",
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

/// Another renderer, and the folder of its pictures.
#[derive(Clone, Debug)]
pub(super) struct Peer {
    name: String,
    folder: PathBuf,
}

impl Peer {
    /// `NAME=DIR`.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((name, folder)) if !name.is_empty() && !folder.is_empty() => {
                Ok(Self { name: name.to_owned(), folder: folder.into() })
            }
            _ => Err("it is written NAME=DIR".to_owned()),
        }
    }
}

/// What another renderer read of some points, by their names.
struct PeerReadings<'a> {
    name: &'a str,
    figures: BTreeMap<String, Figures>,
}

impl<'a> PeerReadings<'a> {
    fn of(peer: &'a Peer, truths: &[Truth], significance: f64) -> Result<Self, Failure> {
        let mut read = readings(&peer.folder, truths)?;
        let of = |truth: &Truth| {
            let reading = read.remove(&truth.name)?;
            Some((truth.name.clone(), Row::new(truth, Ok(reading), significance).figures()))
        };
        Ok(Self { name: &peer.name, figures: truths.iter().filter_map(of).collect() })
    }
}

/// Our own integrator, held to the points of a suite; the page goes to `page`, its drawing beside it.
pub(super) fn run(args: &VerifyArgs, suite: Suite, cases: &[SuiteCase]) -> Outcome {
    let drawing = args.page.as_deref().map(|page| page.with_extension("svg"));
    if drawing.is_some() && drawing == args.page {
        return Err(Failure::input(miette::miette!(
            help = "the page is Markdown: give it the ending .md, say",
            "--page {} has the ending of the drawing beside the page",
            args.page.as_deref().unwrap_or(Path::new("")).display()
        )));
    }
    let interrupt = Interrupt::listen()
        .map_err(|error| Failure::run(Problem::from_err(error).wrap_err("cannot listen to signals")))?;
    let significance = Budget::for_tests(cases.len()).each();
    let truths: Vec<Truth> = cases.iter().map(|case| case.truth.clone()).collect();
    let peers = args.peer.iter().map(|peer| PeerReadings::of(peer, &truths, significance));
    let peers = peers.collect::<Result<Vec<_>, Failure>>()?;
    let mut report = Report::new(!args.json).with_seed(args.seed).of(cases.len());
    let mut lines = Vec::with_capacity(cases.len());
    let mut last = None;
    for (index, case) in cases.iter().enumerate() {
        let Some(row) = judged(args, &case.truth, significance, &interrupt, &mut last) else {
            let signal = interrupt.signal().expect("nothing else ends a measurement early");
            let left: Vec<Truth> = cases[index..].iter().map(|case| case.truth.clone()).collect();
            return report.interrupted(signal, &left);
        };
        lines.push((case, row.figures()));
        report.push(row);
    }
    if let Some((page, drawing)) = args.page.as_deref().zip(drawing) {
        let text = written(suite, args.seed, &lines, &peers, &drawing);
        let svg = plot::plot(suite.title(), &lines, &peers);
        for (path, text) in [(page, text), (&drawing, svg)] {
            write_atomically(path, |out| out.write_all(text.as_bytes()))
                .map_err(|error| Failure::run(Problem::from_err(error)))?;
        }
    }
    report.finish()
}

const READINGS: &str = "
Each reading is the mean of 64 independent replicates; `±` is its standard error. *Finds* is the smallest relative bias that the test would have
found. *z* is the difference over the standard error, `–` where the reading has no noise. All points begin with the same seed. Points that differ
little, such as one room under two skies, use the same random numbers, so their differences go together.
";

fn written(
    suite: Suite,
    seed: u64,
    lines: &[(&SuiteCase, Figures)],
    peers: &[PeerReadings<'_>],
    drawing: &Path,
) -> String {
    let (name, [head, notes]) = (suite.name(), suite.words());
    let passed = lines.iter().filter(|(_, figures)| figures.pass).count();
    let worst = lines.iter().map(|(_, figures)| finds(figures)).fold(0.0, f64::max);
    let largest = largest_deviation(lines.iter().map(|(_, figures)| figures));
    let mut text = format!("{head}{READINGS}");
    let of_peers: String = peers.iter().map(|peer| format!(" --peer \"{}=DIR\"", peer.name)).collect();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "\n```sh\netalon verify --suite {name} --seed {seed}{of_peers} --page docs/benchmarks/{name}.md\n```\n\n\
         {passed} of {} points pass. The largest |z| is {largest:.2}. The coarsest reading would have shown a bias of {:.2} %.\n\n\
         Another renderer can be held to the same points. `etalon verify --suite {name} --export DIR` writes the scenes and the expected readings.\n\
         `etalon verify --suite {name} --images DIR` judges what it read. `--peer NAME=DIR` adds it to this page. See [your own\n\
         renderer](../how-to/your-own-renderer.md).\n",
        lines.len(),
        100.0 * worst
    );
    for PeerReadings { name, figures } in peers {
        let (count, largest) = (figures.len(), largest_deviation(figures.values()));
        let coarsest = figures.values().map(finds).fold(0.0, f64::max);
        let _ = write!(
            text,
            "\n{name} was held to {count} of the points; the others have what it cannot be told. Its largest |z| is {largest:.2}, its coarsest reading\n\
             would have shown a bias of {:.2} %.\n",
            100.0 * coarsest
        );
    }
    let _ = write!(
        text,
        "\n![The difference of each reading from the truth, in standard errors and in percent](<{}>)\n",
        drawing.file_name().unwrap_or_default().to_string_lossy()
    );
    let mut section = "";
    for (case, figures) in lines {
        let of_section = |peer: &&PeerReadings<'_>| {
            let mut here = lines.iter().filter(|(other, _)| other.section == case.section);
            here.any(|(other, _)| peer.figures.contains_key(&other.truth.name))
        };
        let peers: Vec<_> = peers.iter().filter(of_section).collect();
        if case.section != section {
            section = case.section;
            let columns: String = peers.iter().map(|peer| format!(" {} | z |", peer.name)).collect();
            let rules = "---:|".repeat(5 + 2 * peers.len());
            let _ = write!(
                text,
                "\n## {section} {}\n\n{}.\n\n| point | expected | measured | difference | z | finds |{columns}\n|---|{rules}\n",
                case.title, case.truth.formula
            );
        }
        let measured = |figures: &Figures| {
            let shown = |value: f64| value * case.factor;
            format!("{:.4} ± {:.4}", shown(figures.measured), shown(figures.standard_error))
        };
        let z = |figures: &Figures| deviation(figures).map_or("–".to_owned(), |z| format!("{z:.2}"));
        let of_peer = |peer: &&PeerReadings<'_>| match peer.figures.get(&case.truth.name) {
            Some(figures) => format!(" {} | {} |", measured(figures), z(figures)),
            None => " – | – |".to_owned(),
        };
        let _ = writeln!(
            text,
            "| {} | {:.4}{} | {} | {:+.3} % | {} | {:.2} %{} |{}",
            case.point,
            figures.truth * case.factor,
            if case.unit.is_empty() { String::new() } else { format!(" {}", case.unit) },
            measured(figures),
            100.0 * difference(figures),
            z(figures),
            100.0 * finds(figures),
            if figures.pass { "" } else { ", **fails**" },
            peers.iter().map(of_peer).collect::<String>()
        );
    }
    text + "\n" + notes
}

/// The relative difference from the truth.
fn difference(figures: &Figures) -> f64 {
    figures.measured / figures.truth - 1.0
}

/// The smallest relative bias that would have been found.
fn finds(figures: &Figures) -> f64 {
    figures.resolvable_bias / figures.truth.abs()
}

/// The difference over the standard error, of a reading that has noise.
fn deviation(figures: &Figures) -> Option<f64> {
    (figures.standard_error > 1e-9 * figures.truth.abs()).then(|| figures.deviation())
}

fn largest_deviation<'a>(figures: impl Iterator<Item = &'a Figures>) -> f64 {
    figures.filter_map(deviation).map(f64::abs).fold(0.0, f64::max)
}
