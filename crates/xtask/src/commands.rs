//! The list of the named commands: checks, long tests, measurements. Scripts stay where they are.

mod list;

use std::path::Path;
use std::process::{Command, ExitCode};

use Action::{Cargo, Ignored, Own, Script};
use list::COMMANDS;

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

const fn named(
    name: &'static str,
    takes: &'static str,
    about: &'static str,
    time: &'static str,
    action: Action,
) -> Named {
    Named { name, takes, about, time, action }
}

/// Scripts that other scripts import or start.
#[cfg(test)]
const PARTS: &[&str] = &[
    "bench/race/draw.py",
    "bench/race/hard.py",
    "bench/race/parts.py",
    "bench/race/peer_cycles.py",
    "bench/race/peer_luxcore.py",
    "bench/race/peer_mitsuba.py",
    "bench/race/read_mitsuba.py",
    "bench/race/scenes.py",
    "bench/race/worker.py",
    "tests/peers/closed-forms/films.py",
    "tests/peers/closed-forms/foreign.py",
    "tests/peers/closed-forms/formulas.py",
    "tests/peers/closed-forms/gltf_bodies.py",
    "tests/peers/closed-forms/gltf_materials.py",
    "tests/peers/closed-forms/gltf_models.py",
    "tests/peers/closed-forms/obj_cases.py",
    "tests/peers/closed-forms/reasons.py",
    "tests/peers/closed-forms/views.py",
    "tests/peers/mitsuba/cases.py",
    "tests/peers/mitsuba/files.py",
    "tests/peers/mitsuba/older.py",
    "tests/view/browser.py",
    "tests/view/controls.py",
    "tests/view/measure.py",
    "tests/view/page.py",
    "tests/view/pictures.py",
    "tests/view/suite.py",
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

    #[test]
    fn programs_of_tests_that_commands_name_exist() {
        for command in all() {
            let Ignored { package, target: ["--test", program], .. } = command.action else { continue };
            let folder = crate::root().join("crates").join(package.trim_start_matches("etalon-"));
            let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
            let tests = folder.join("tests");
            let of_own = [format!("{program}.rs"), format!("{program}/main.rs")];
            let exists = manifest.contains(&format!("name = \"{program}\""))
                || !manifest.contains("autotests = false") && of_own.iter().any(|file| tests.join(file).is_file());
            assert!(exists, "{}: {package} has no tests called {program}", command.name);
        }
    }
}
