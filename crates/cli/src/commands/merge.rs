//! `etalon merge`: the parts of a picture that several machines have rendered, into one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use etalon_control::{Canvas, Shard};
use etalon_picture::open_plain;
use etalon_transport::{Features, ImageError};
use miette::{Report, miette};
use serde::Serialize;

use crate::developing::Developing;
use crate::failure::{Failure, Outcome};
use crate::light::without_light;
use crate::output::{self, Written};
use crate::print;
use crate::problem_json::{ProblemJson, problem_json, problems_json};
use crate::progress::percent;
use crate::state::{self, Header, Kept};
use crate::write_outputs::Delivery;

/// Merge the parts of `etalon render --shard` into one picture.
///
/// The picture has the same pixels as if one machine had rendered it, bit for bit.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon merge 1.part 2.part 3.part -o cornell.exr -o cornell.png")]
pub(crate) struct MergeArgs {
    /// Parts in any order. A folder stands for all .part files in it.
    #[arg(required_unless_present = "list", value_name = "PART")]
    parts: Vec<PathBuf>,
    /// File with one part or folder per line, for more parts than a command line holds. `-` reads standard input.
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// File to write: .exr, .png or .part. Repeat the option to write several.
    #[arg(short, long, alias = "outfile", value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    /// Print one JSON object on standard output.
    #[arg(long)]
    json: bool,
    /// Print only warnings and errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    developing: Developing,
}

#[derive(Serialize)]
struct MergeJson {
    parts: usize,
    outputs: Vec<Written>,
    samples: u32,
    /// Seconds that all parts took together.
    seconds: f64,
    /// `null` if it is unknown: with a single replicate, and if no sample found light.
    relative_rmse: Option<f64>,
    warnings: Vec<ProblemJson>,
    errors: Vec<ProblemJson>,
}

pub(crate) fn run(args: MergeArgs) -> Outcome {
    let mut failure = Failure::default();
    let outputs = output::plan(&args.output, &mut failure);
    let paths = named(&args, &mut failure);
    let parts = read(&paths, &mut failure);
    if let Some(parts) = &parts {
        check(parts, &mut failure);
    }
    let Some(parts) = parts.filter(|_| failure.is_empty()) else {
        if args.json {
            let (parts, errors) = (paths.len(), problems_json(&failure));
            let (outputs, warnings) = (Vec::new(), Vec::new());
            print::json(&MergeJson { parts, outputs, samples: 0, seconds: 0.0, relative_rmse: None, warnings, errors });
        }
        return failure.into_outcome();
    };

    let (header, canvas, features) = put_together(parts)?;
    let error = canvas.with_film(|film| film.error(header.subject.crop));
    let samples = header.samples;
    let delivery = Delivery {
        header: &header,
        canvas: &canvas,
        features: &features,
        samples,
        error,
        developing: &args.developing,
        frame: None,
    };
    let warning = canvas.with_film(|film| without_light(film, header.subject.crop));
    print::warnings(&warning);
    let (written, failure) = delivery.write(&outputs);
    let relative_rmse = error.filter(ImageError::is_known).map(|error| error.relative_rmse);
    if args.json {
        let (parts, errors) = (paths.len(), problems_json(&failure));
        let (seconds, warnings) = (header.seconds, warning.iter().map(problem_json).collect());
        print::json(&MergeJson { parts, outputs: written, samples, seconds, relative_rmse, warnings, errors });
    } else if !args.quiet {
        let mut text = format!("{} parts merged, {samples} samples a pixel", paths.len());
        if error.is_some() {
            text += &format!(", relative error {}", relative_rmse.map_or_else(|| "unknown".to_owned(), percent));
        }
        written.iter().for_each(|written| text += &format!("\n  {}", written.path));
        print::line(&text);
    }
    failure.into_outcome()
}

/// The parts that the command line names, one by one, by folders or by a list.
fn named(args: &MergeArgs, failure: &mut Failure) -> Vec<PathBuf> {
    let mut refuse = |path: &Path, why: String| {
        failure.add(Failure::input(miette!(code = "parts", "cannot read `{}`: {why}", path.display())));
    };
    let mut given = args.parts.clone();
    if let Some(list) = &args.list {
        let text = if list.as_os_str() == "-" {
            std::io::read_to_string(std::io::stdin())
        } else {
            open_plain(list).and_then(std::io::read_to_string)
        };
        match text {
            Ok(text) => given.extend(text.lines().filter(|line| !line.trim().is_empty()).map(PathBuf::from)),
            Err(error) => refuse(list, error.to_string()),
        }
    }
    let mut parts = Vec::new();
    for path in given {
        if !path.is_dir() {
            parts.push(path);
            continue;
        }
        let entries = std::fs::read_dir(&path).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
        let entries: Vec<PathBuf> = entries.unwrap_or_else(|error: std::io::Error| {
            refuse(&path, error.to_string());
            Vec::new()
        });
        let mut inside: Vec<PathBuf> =
            entries.into_iter().filter(|path| path.extension().is_some_and(|extension| extension == "part")).collect();
        inside.sort();
        if inside.is_empty() {
            refuse(&path, "there is no .part file in this folder".to_owned());
        }
        parts.extend(inside);
    }
    if parts.is_empty() && failure.is_empty() {
        failure.add(Failure::input(miette!(code = "parts", "no part is given")));
    }
    parts
}

/// Reads all parts; what is wrong with each goes into `failure`.
fn read(paths: &[PathBuf], failure: &mut Failure) -> Option<Vec<(PathBuf, Kept)>> {
    let mut parts = Vec::new();
    for path in paths {
        match state::read(path) {
            Ok(kept) => parts.push((path.clone(), kept)),
            Err(error) => failure.add(Failure::input(Report::from_err(error))),
        }
    }
    failure.is_empty().then_some(parts)
}

/// Whether these are all parts of one picture, each once.
fn check(parts: &[(PathBuf, Kept)], failure: &mut Failure) {
    let mut refuse = |code: &str, text: String| failure.add(Failure::input(miette!(code = code.to_owned(), "{text}")));
    let (first_path, Kept { header: first, .. }) = &parts[0];
    let mut seen: BTreeMap<u32, &PathBuf> = BTreeMap::new();
    for (path, Kept { header, .. }) in parts {
        let name = path.display();
        let foreign = if let Some(difference) = header.subject.difference(&first.subject) {
            Some(difference)
        } else if header.shard.of != first.shard.of {
            Some(format!("it is one of {} shares, not of {}", header.shard.of, first.shard.of))
        } else if header.samples != first.samples {
            Some(format!("it has {} samples a pixel, not {}", header.samples, first.samples))
        } else if header.allocation != first.allocation {
            Some("its samples are distributed differently over the picture".to_owned())
        } else if header.channels != first.channels {
            Some("it has other channels (--aov)".to_owned())
        } else {
            None
        };
        if let Some(difference) = foreign {
            let text =
                format!("`{name}` is not a part of the same picture as `{}`: {difference}", first_path.display());
            refuse("foreign-part", text);
            continue;
        }
        if !header.complete {
            refuse("unfinished-part", format!("`{name}` is a checkpoint: its share of the picture is not finished"));
        }
        if let Some(other) = seen.insert(header.shard.index, path) {
            let share = format!("{}/{}", header.shard.index + 1, header.shard.of);
            refuse("duplicate-part", format!("`{}` and `{name}` are both share {share}", other.display()));
        }
    }
    let missing: Vec<String> = (0..first.shard.of)
        .filter(|index| !seen.contains_key(index))
        .map(|index| format!("{}/{}", index + 1, first.shard.of))
        .collect();
    if !missing.is_empty() && failure.is_empty() {
        let shares = if missing.len() == 1 { "share" } else { "shares" };
        let text = format!(
            "{shares} {} of the picture {} missing",
            missing.join(", "),
            if missing.len() == 1 { "is" } else { "are" }
        );
        failure.add(Failure::input(miette!(code = "missing-part", help = "render them with --shard K/N", "{text}")));
    }
}

/// All tiles on one canvas, and what the pixels of each meet first.
fn put_together(parts: Vec<(PathBuf, Kept)>) -> Result<(Header, Canvas, Vec<Vec<Features>>), Failure> {
    let damaged = |path: &PathBuf, why: &str| {
        Failure::input(miette!(code = "damaged-part", "`{}` is damaged: {why}", path.display()))
    };
    let (first_path, first) = &parts[0];
    let seconds = parts.iter().map(|(_, part)| part.header.seconds).sum();
    let header = Header { shard: Shard::WHOLE, seconds, ..first.header.clone() };
    let allocation = match &header.allocation {
        Some(weights) => Some(
            state::allocation(header.subject.crop, weights)
                .ok_or_else(|| damaged(first_path, "its samples are distributed over another picture"))?,
        ),
        None => None,
    };
    let canvas = Canvas::of_share(header.subject.film(), header.subject.crop, Shard::WHOLE, allocation.as_ref());
    let (mut tiles, mut found) = (0, BTreeMap::new());
    for (path, part) in &parts {
        for (tile, sums, of_tile) in &part.tiles {
            if header.channels.has_features() && of_tile.is_empty() {
                return Err(damaged(path, "it lacks the data of its channels"));
            }
            found.insert((tile.rect.y0, tile.rect.x0), of_tile);
            if !canvas.take_up(tile, sums) {
                return Err(damaged(
                    path,
                    "it has a tile that does not belong to the picture, or that another part has too",
                ));
            }
            tiles += 1;
        }
    }
    if tiles != canvas.tiles() {
        return Err(damaged(first_path, "tiles are missing from it or from another part"));
    }
    let features = if header.channels.has_features() {
        let rects = (0..canvas.tiles()).map(|number| canvas.tile(number).0.rect);
        rects.map(|rect| found[&(rect.y0, rect.x0)].clone()).collect()
    } else {
        Vec::new()
    };
    Ok((header, canvas, features))
}
