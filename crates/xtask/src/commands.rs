//! The list of the named commands: checks, long tests, measurements. Scripts stay where they are.

use std::path::Path;
use std::process::{Command, ExitCode};

use crate::{allowed, architecture, glossary, import_cycles, messages, pages, slowest, targets};

/// One named command.
pub(crate) struct Named {
    name: &'static str,
    /// What follows it on the command line.
    takes: &'static str,
    about: &'static str,
    /// On two cores of the machine that the figures of the documentation are from, unless it says otherwise.
    time: &'static str,
    action: Action,
}

enum Action {
    /// A script, from the root of the repository. It gets all arguments.
    Script(&'static str),
    /// `cargo` with these arguments, and behind them all others.
    Cargo(&'static [&'static str]),
    /// Tests that `cargo test` leaves out: the package, which of its tests, and a part of their names.
    Ignored { package: &'static str, target: &'static [&'static str], name: &'static str },
    /// A function of this program.
    Own(fn(&Path, &[String]) -> Result<ExitCode, String>),
}

use Action::{Cargo, Ignored, Own, Script};

const fn named(
    name: &'static str,
    takes: &'static str,
    about: &'static str,
    time: &'static str,
    action: Action,
) -> Named {
    Named { name, takes, about, time, action }
}

const INTEGRATION: &[&str] = &["--test", "integration"];

/// All commands, in groups with a head.
const COMMANDS: &[(&str, &[Named])] = &[
    (
        "Checks",
        &[
            named("ci", "", "everything that must hold before a change is taken", "under 1 h", Script(".ci/run")),
            named(
                "test",
                "[CARGO OPTIONS]",
                "all tests but the long ones",
                "below 1 h",
                Cargo(&["test", "--release", "--workspace"]),
            ),
            named("format", "[--check]", "formats all crates", "1 s", Cargo(&["fmt", "--all"])),
            named(
                "lint",
                "",
                "clippy on all crates and tests, warnings are errors",
                "minutes",
                Cargo(&["clippy", "--locked", "--release", "--workspace", "--all-targets", "--", "-D", "warnings"]),
            ),
            named("msrv", "", "the oldest supported Rust compiles all crates and tests", "4 min", Own(targets::msrv)),
            named(
                "check-targets",
                "[TARGET …]",
                "all crates and tests compile for platforms that are not at hand",
                "10 min",
                Own(targets::check),
            ),
            named(
                "deny",
                "",
                "licences, duplicates and sources of all packages; needs cargo-deny",
                "1 s",
                Cargo(&["deny", "--workspace", "check"]),
            ),
            named(
                "slowest",
                "-- COMMAND …",
                "runs a test command and prints its 20 slowest tests",
                "as the command",
                Own(slowest::run),
            ),
        ],
    ),
    (
        "The repository",
        &[
            named(
                "architecture",
                "[--write]",
                "ARCHITECTURE.md states the dependencies of every crate",
                "1 s",
                Own(architecture::compare),
            ),
            named(
                "import-cycles",
                "[CRATE …]",
                "modules that import one another in cycles, and where",
                "1 s",
                Own(import_cycles::print),
            ),
            named(
                "glossary",
                "",
                "words that names no longer have, and what stands for them",
                "1 s",
                Own(glossary::print),
            ),
            named(
                "messages",
                "[CRATE …]",
                "every text that the program may print, to be read as a list",
                "1 s",
                Own(messages::print),
            ),
            named(
                "links",
                "",
                "links of Markdown pages that lead to no file or to no heading",
                "1 s",
                Own(pages::check_links),
            ),
            named(
                "book",
                "[MDBOOK OPTIONS]",
                "makes a book of all pages in target/book/html; needs mdbook",
                "seconds",
                Own(pages::book),
            ),
            named(
                "charts",
                "[--check]",
                "draws the charts of docs/performance.md and docs/accuracy.md from their tables",
                "1 s",
                Script("docs/charts.py"),
            ),
            named(
                "turntable",
                "[ETALON]",
                "renders scenes/turntable.json and makes the animation of docs/how-to/sequences.md",
                "5 min",
                Script("docs/turntable.py"),
            ),
            named(
                "allowed",
                "[--write]",
                "compares the lists of what is to go with the sources; --write deletes what is gone",
                "1 s",
                Own(allowed::compare),
            ),
        ],
    ),
    (
        "Long tests",
        &[
            named(
                "rays-alone",
                "",
                "a million rays a generator meet in the tree what they meet alone",
                "5 min",
                Ignored { package: "etalon-geometry", target: &["--lib"], name: "million_rays_a_generator" },
            ),
            named(
                "rays-escape",
                "",
                "of ten million rays none escapes from a closed mesh",
                "seconds",
                Ignored { package: "etalon-geometry", target: &["--lib"], name: "ten_million_rays_none_escapes" },
            ),
            named(
                "oracle-seeds",
                "",
                "the oracle accuses no right subject in 100 seeds",
                "15 min",
                Ignored { package: "etalon-oracle", target: &["--test", "mutants"], name: "hundred" },
            ),
            named(
                "room-scales",
                "",
                "rooms of 1 µm to 1000 km show their radiance to 10⁻³",
                "16 min",
                Ignored {
                    package: "etalon-transport",
                    target: &["--test", "scales"],
                    name: "closed_rooms_read_their_truth",
                },
            ),
            named(
                "coverage",
                "",
                "how often error bars hold the truth: table of docs/accuracy.md",
                "minutes",
                Ignored { package: "etalon-transport", target: &["--test", "coverage"], name: "coverage_over_lamps" },
            ),
            named(
                "compare-pairs",
                "",
                "a hundred pairs of pictures that differ by their seed are called the same",
                "1 min",
                Ignored { package: "etalon-cli", target: INTEGRATION, name: "a_hundred_pairs_of_seeds" },
            ),
            named(
                "render-to-error",
                "",
                "six scenes end at the error that was asked for: table of docs/accuracy.md",
                "13 min",
                Ignored { package: "etalon-cli", target: INTEGRATION, name: "six_scenes_end_at_the_error" },
            ),
            named(
                "quote-times",
                "",
                "six scenes take the time that was quoted: table of docs/accuracy.md",
                "5 min",
                Ignored { package: "etalon-cli", target: INTEGRATION, name: "six_scenes_take_the_time" },
            ),
            named(
                "aarch64",
                "[TEST OPTIONS]",
                "tests on aarch64, emulated by qemu",
                "over 30 min",
                Script("tests/aarch64.sh"),
            ),
            named(
                "miri",
                "",
                "`unsafe` code of stacks and pages under Miri; needs a nightly toolchain",
                "minutes",
                Script("tests/miri.sh"),
            ),
            named(
                "mutants",
                "FILE … -- TESTS",
                "exchanges operators and results that no test notices",
                "by the files",
                Script("tests/mutants.sh"),
            ),
            named(
                "fuzz-parsers",
                "SECONDS [PARSER …]",
                "arbitrary bytes for every parser; needs cargo-fuzz",
                "8 × SECONDS",
                Script("tests/fuzz-parsers.sh"),
            ),
            named(
                "editor",
                "",
                "ten mistakes and six completions of the schema in the JSON service of Visual Studio Code; needs npm",
                "1 min",
                Script("tests/editor.sh"),
            ),
            named(
                "python",
                "[--fuzz [COUNT [SEED]]]",
                "wheel, types, tests and notebooks of the Python package, or arbitrary dicts for it; needs Python 3.10 and pip",
                "15 min",
                Script("tests/python.sh"),
            ),
            named(
                "denoise",
                "",
                "`etalon denoise` in a build with Open Image Denoise, which it fetches",
                "minutes",
                Script("tests/denoise.sh"),
            ),
            named(
                "docker-steps",
                "",
                "runs the steps of the Dockerfile by hand, without Docker",
                "10 min",
                Script("tests/docker-steps.sh"),
            ),
            named(
                "farm-openjd",
                "[ETALON]",
                "runs a job of `etalon farm --openjd`",
                "1 min",
                Script("tests/farm-openjd.sh"),
            ),
            named(
                "farm-slurm",
                "[ETALON]",
                "runs a job of `etalon farm --slurm` on a Slurm of its own; needs root",
                "minutes",
                Script("tests/farm-slurm.sh"),
            ),
            named(
                "docs-commands",
                "[ETALON]",
                "the commands in the pages of the documentation do what the pages say",
                "4 min",
                Script("tests/docs-commands.py"),
            ),
            named(
                "spectral-exr",
                "[ETALON]",
                "an independent reader reads our spectral EXR files",
                "1 min",
                Script("tests/spectral-exr.py"),
            ),
        ],
    ),
    (
        "Against other renderers",
        &[
            named(
                "mitsuba-verify",
                "TRUTHS PICTURES [OPTIONS]",
                "holds Mitsuba 3 to the oracle's truths",
                "4 min",
                Script("docs/mitsuba-verify.py"),
            ),
            named(
                "foreign-scenes",
                "[OPTIONS]",
                "the same scenes by Mitsuba 3 and by etalon",
                "minutes",
                Script("docs/foreign-scenes.py"),
            ),
            named(
                "race",
                "[OPTIONS]",
                "time to a stated error, against every renderer that is installed",
                "by the renderers",
                Script("bench/race/race.py"),
            ),
            named(
                "race-scenes",
                "FOLDER",
                "writes the scenes of the race in our format",
                "1 min",
                Script("bench/race/peer_etalon.py"),
            ),
        ],
    ),
    (
        "Measurements",
        &[
            named(
                "bench-rays",
                "[OPTIONS]",
                "rays per second of the accelerator, also against Embree",
                "minutes",
                Cargo(&["bench", "-p", "etalon-geometry", "--bench", "traversal"]),
            ),
            named(
                "bench-builders",
                "[SCENE] [--turns N]",
                "build and trace times of both tree builders, in turns",
                "1 min",
                Cargo(&["bench", "-p", "etalon-geometry", "--bench", "traversal", "--", "--builders"]),
            ),
            named(
                "films",
                "[OPTIONS]",
                "hashes of sixty films, to hold changes of code to the same bits",
                "20 s",
                Script("bench/films.py"),
            ),
            named(
                "instructions",
                "[OPTIONS]",
                "instructions a path, against those recorded; needs valgrind",
                "minutes",
                Script("bench/instructions.py"),
            ),
            named(
                "scale",
                "[OPTIONS]",
                "how cost grows with triangles, depth, pixels, lights and bands",
                "an hour",
                Script("bench/scale.py"),
            ),
        ],
    ),
];

/// Scripts that other scripts import or start.
#[cfg(test)]
const PARTS: &[&str] = &[
    "bench/race/peer_cycles.py",
    "bench/race/peer_luxcore.py",
    "bench/race/peer_mitsuba.py",
    "bench/race/scenes.py",
    "bench/race/worker.py",
];

fn all() -> impl Iterator<Item = &'static Named> {
    COMMANDS.iter().flat_map(|(_, commands)| commands.iter())
}

pub(crate) fn find(name: &str) -> Option<&'static Named> {
    all().find(|command| command.name == name)
}

/// The text of `cargo xtask`.
pub(crate) fn list() -> String {
    let mut text =
        String::from("cargo xtask NAME [ARGUMENTS]: the named commands, and how long each takes on two cores\n");
    for (head, commands) in COMMANDS {
        text += &format!("\n{head}\n");
        for command in *commands {
            let usage = format!("{} {}", command.name, command.takes);
            text += &format!("  {:<40} {:<14} {}\n", usage.trim_end(), command.time, command.about);
        }
    }
    text
}

impl Named {
    pub(crate) fn run(&self, root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
        let mut command = match self.action {
            Own(function) => return function(root, arguments),
            Script(path) => {
                let mut command = Command::new(interpreter(path));
                command.arg(root.join(path));
                command
            }
            _ => Command::new("cargo"),
        };
        command.args(self.cargo_arguments()).args(arguments).current_dir(root);
        let status =
            command.status().map_err(|error| format!("{}: {error}", command.get_program().to_string_lossy()))?;
        Ok(if status.success() {
            ExitCode::SUCCESS
        } else {
            ExitCode::from(status.code().map_or(1, |code| code.clamp(1, 255) as u8))
        })
    }

    fn cargo_arguments(&self) -> Vec<&'static str> {
        match self.action {
            Cargo(arguments) => arguments.to_vec(),
            Ignored { package, target, name } => {
                let head = ["test", "--release", "--locked", "-p", package];
                [&head[..], target, &["--", "--ignored", "--nocapture", name]].concat()
            }
            Script(_) | Own(_) => Vec::new(),
        }
    }
}

fn interpreter(path: &str) -> &'static str {
    match path {
        _ if !path.ends_with(".py") => "bash",
        _ if cfg!(windows) => "python",
        _ => "python3",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{files, relative};
    use std::collections::BTreeSet;
    use std::fs;

    #[test]
    fn names_are_unique_and_all_is_said_of_each() {
        let names: BTreeSet<_> = all().map(|command| command.name).collect();
        assert_eq!(names.len(), all().count());
        let text = list();
        for command in all() {
            assert!(!command.about.is_empty() && !command.time.is_empty(), "{}", command.name);
            assert!(text.contains(&format!("  {}", command.name)), "{}", command.name);
        }
    }

    #[test]
    fn every_script_is_in_the_list_and_exists() {
        let root = crate::root();
        let mut listed: BTreeSet<String> = PARTS.iter().map(|&path| path.to_owned()).collect();
        listed.extend(
            all().filter_map(|command| if let Script(path) = command.action { Some(path.to_owned()) } else { None }),
        );
        let folders = [".ci", "tests", "docs", "bench"].map(|folder| files(&root.join(folder)));
        let is_script = |path: &Path| {
            let by_name = path.extension().is_some_and(|end| end == "sh" || end == "py");
            by_name || fs::read(path).is_ok_and(|bytes| bytes.starts_with(b"#!/"))
        };
        let found: BTreeSet<String> =
            folders.iter().flatten().filter(|path| is_script(path)).map(|path| relative(&root, path)).collect();
        let missing: Vec<_> = found.difference(&listed).collect();
        let gone: Vec<_> = listed.difference(&found).collect();
        assert!(
            missing.is_empty() && gone.is_empty(),
            "scripts without a name: {missing:?}; names without a script: {gone:?}"
        );
    }

    #[test]
    fn every_test_that_is_left_out_has_a_named_command_and_each_command_a_test() {
        let root = crate::root();
        let mut left_out = BTreeSet::new();
        for folder in ["crates", "tests"] {
            for path in
                files(&root.join(folder)).into_iter().filter(|path| path.extension().is_some_and(|end| end == "rs"))
            {
                let path_name = relative(&root, &path);
                let package = match path_name.split('/').collect::<Vec<_>>()[..] {
                    ["crates", name, ..] => format!("etalon-{name}"),
                    _ => "etalon-cli".to_owned(),
                };
                let tokens = crate::source::tokens(&fs::read_to_string(&path).unwrap());
                for at in 1..tokens.len().saturating_sub(1) {
                    let [before, word] = [at - 1, at].map(|at| tokens[at].text.as_str());
                    if before == "[" && word == "ignore" {
                        let function = tokens[at..].iter().skip_while(|token| token.text != "fn").nth(1).unwrap();
                        left_out.insert((package.clone(), function.text.clone()));
                    }
                }
            }
        }
        let commands: Vec<_> = all()
            .filter_map(|command| match command.action {
                Ignored { package, name, .. } => Some((command.name, package, name)),
                _ => None,
            })
            .collect();
        let matches = |(package, function): &(String, String), of: &(&str, &str, &str)| {
            package == of.1 && function.contains(of.2)
        };
        let missing: Vec<_> = left_out.iter().filter(|test| !commands.iter().any(|of| matches(test, of))).collect();
        let gone: Vec<_> = commands.iter().filter(|of| !left_out.iter().any(|test| matches(test, of))).collect();
        assert!(
            missing.is_empty() && gone.is_empty(),
            "tests without a name: {missing:?}; names without a test: {gone:?}"
        );
    }
}
