//! What a crate's `Cargo.toml` says of it. Reads the few forms that our manifests have, not all of TOML.

use std::fs;
use std::path::Path;

pub(crate) struct Manifest {
    pub(crate) description: String,
    /// Of the library or program and its build script, for every platform; without those of tests alone. In alphabetical order.
    pub(crate) dependencies: Vec<Dependency>,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Dependency {
    pub(crate) name: String,
    /// Only with a feature that is off unless asked for.
    pub(crate) optional: bool,
}

pub(crate) fn read(root: &Path, name: &str) -> Result<Manifest, String> {
    let path = root.join("crates").join(name).join("Cargo.toml");
    fs::read_to_string(&path).map(|text| parse(&text)).map_err(|error| format!("{}: {error}", path.display()))
}

/// `rust-version` of the workspace.
pub(crate) fn rust_version(root: &Path) -> Result<String, String> {
    let path = root.join("Cargo.toml");
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let version = text.lines().find_map(|line| value(line, "rust-version"));
    version.ok_or_else(|| format!("{}: no rust-version", path.display()))
}

/// The text of `key = "text"`.
fn value(line: &str, key: &str) -> Option<String> {
    let rest = line.strip_prefix(key)?.trim_start().strip_prefix('=')?;
    Some(rest.trim().trim_matches('"').to_owned())
}

fn parse(text: &str) -> Manifest {
    let mut manifest = Manifest { description: String::new(), dependencies: Vec::new() };
    let (mut section, mut depth) = (String::new(), 0_usize);
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim_end();
        if depth == 0 && line.starts_with('[') {
            section = line.trim_matches(['[', ']']).to_owned();
            // `[dependencies.name]`
            if let Some((table, name)) = section.rsplit_once('.').filter(|(table, _)| is_dependencies(table)) {
                let (table, name) = (table.to_owned(), name.to_owned());
                note(&mut manifest, &table, &name, line);
            }
            continue;
        }
        if depth == 0 {
            if let Some(description) = value(line, "description").filter(|_| section == "package") {
                manifest.description = description;
            }
            if let Some((name, rest)) = line.split_once(['=', '.']) {
                let section = section.clone();
                note(&mut manifest, &section, name.trim(), rest);
            }
        }
        let count = |what: [char; 2]| line.matches(what).count();
        depth = (depth + count(['[', '{'])).saturating_sub(count([']', '}']));
    }
    manifest.dependencies.sort();
    manifest.dependencies.dedup();
    manifest
}

fn is_dependencies(section: &str) -> bool {
    let section = section.rsplit('.').next().unwrap_or_default();
    section == "dependencies" || section == "build-dependencies"
}

fn note(manifest: &mut Manifest, section: &str, name: &str, rest: &str) {
    if is_dependencies(section) {
        let optional = rest.contains("optional = true");
        manifest.dependencies.push(Dependency { name: name.trim_matches('"').to_owned(), optional });
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::process::Command;

    use super::*;

    /// The README's `cargo run --release -- render …` names no package. It needs exactly one default member with a program.
    #[test]
    fn cargo_run_runs_the_program() {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let arguments = ["metadata", "--no-deps", "--offline", "--locked", "--format-version", "1"];
        let output = Command::new(cargo).args(arguments).current_dir(crate::root()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        let (_, members) = text.split_once("\"workspace_default_members\":[").unwrap();
        let (members, _) = members.split_once(']').unwrap();
        assert!(members.contains("/crates/cli#") && !members.contains(','), "default members: {members}");
    }

    /// The crates of others that a selection of `cargo build` compiles, each with its features.
    fn built(selection: &[&str]) -> HashSet<String> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        // Not offline: the tests need nothing of what the package alone is built with, and may not have it yet.
        let form = ["--locked", "--prefix", "none", "--format", "{p} [{f}]"];
        let output =
            Command::new(cargo).arg("tree").args(form).args(selection).current_dir(crate::root()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let lines = String::from_utf8(output.stdout).unwrap();
        lines.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).filter(|line| !line.contains("(/")).collect()
    }

    /// Ten minutes of two cores: another feature of one small crate, and whoever runs the tests after the program compiles both twice.
    #[test]
    fn program_tests_and_package_share_one_build() {
        let tests = built(&["--workspace", "--edges", "normal,build,dev"]);
        let name = |line: &str| line.split(' ').next().unwrap().to_owned();
        let known: HashSet<String> = tests.iter().map(|line| name(line)).collect();
        let package: &[&str] = &["--package", "etalon-python", "--features", "bindings", "--edges", "normal,build"];
        for selection in [&["--edges", "normal,build"][..], &["--workspace", "--edges", "normal,build"], package] {
            let other: Vec<_> =
                built(selection).difference(&tests).filter(|line| known.contains(&name(line))).cloned().collect();
            assert!(
                other.is_empty(),
                "`cargo build` of {selection:?} compiles anew what the tests have compiled: {other:?}"
            );
        }
    }

    /// Where a crate has one program of tests, cargo looks for no others: a file that it does not name would never run.
    #[test]
    fn every_file_of_tests_is_named_in_the_program_of_tests() {
        let crates = fs::read_dir(crate::root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
        let mut seen = 0;
        for tests in crates.map(|folder| folder.join("tests")) {
            let Ok(main) = fs::read_to_string(tests.join("main.rs")) else { continue };
            for path in fs::read_dir(&tests).unwrap().map(|entry| entry.unwrap().path()) {
                let is_module = path.extension().is_some_and(|end| end == "rs") || path.join("mod.rs").exists();
                let name = path.file_stem().unwrap().to_str().unwrap();
                if is_module && name != "main" {
                    assert!(main.contains(&format!("mod {name};")), "{} is in no program of tests", path.display());
                    seen += 1;
                }
            }
        }
        assert!(seen > 50, "only {seen} files were looked at");
    }

    #[test]
    fn every_form_of_a_dependency_is_read() {
        let manifest = parse(
            r#"
[package]
name = "x"
description = "Some words"
[features]
a = ["dep:h"]
[dependencies]
b.workspace = true
a = "1" # a comment = with signs
c = { version = "1", features = [
    "d", "e",
] }
h = { version = "2", optional = true }
[target.'cfg(unix)'.dependencies]
f = { version = "1" }
[build-dependencies]
g.workspace = true
[dependencies.i]
version = "1"
[dev-dependencies]
j = "1"
"#,
        );
        let names: Vec<_> = manifest.dependencies.iter().map(|d| (d.name.as_str(), d.optional)).collect();
        let plain = ["a", "b", "c", "f", "g"].map(|name| (name, false));
        assert_eq!(names, [&plain[..], &[("h", true), ("i", false)]].concat());
        assert_eq!(manifest.description, "Some words");
    }
}
