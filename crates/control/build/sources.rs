//! The hash of the sources that decide a film. It covers this crate, our crates below it, and the entries of `Cargo.lock` of all other
//! packages below them. It is the same on every platform and in every folder, and needs no git.
//!
//! Our crates are found by the names in the manifests of the folders beside this one, so that the folders may have any names.
//! Packages that only tests and build scripts use do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Packages whose names begin so are ours.
const OURS: &str = "etalon-";

/// Folders of a crate whose files become part of the library.
const FOLDERS: [&str; 2] = ["src", "data"];

/// What was found.
#[derive(Debug)]
pub(crate) struct Hashed {
    /// In hex.
    pub(crate) sha256: String,
    /// The files and folders that it depends on.
    pub(crate) read: Vec<PathBuf>,
    /// Whether no `Cargo.lock` knows this crate.
    pub(crate) lock_is_missing: bool,
}

/// Hashes what decides a film by the crate in the folder `own` that is built with `features`. Its `Cargo.lock` is looked for above
/// this folder, then above the folder `out` of what is built.
pub(crate) fn hash(own: &Path, out: &Path, features: &[String]) -> Result<Hashed, String> {
    let own_name = package_name(&read(&own.join("Cargo.toml"))?).ok_or("the manifest has no name")?;
    let beside = crates_beside(own)?;
    let lock = own.ancestors().chain(out.ancestors()).find_map(|folder| {
        let path = folder.join("Cargo.lock");
        let packages = lock_entries(&fs::read_to_string(&path).ok()?);
        packages.iter().any(|package| package.name == own_name).then_some((path, packages))
    });
    let mut files = vec![format!("features {}\n", features.join(" "))];
    let mut all_read: Vec<PathBuf> = lock.iter().map(|(path, _)| path.clone()).collect();

    let (mut ours, mut others) = (BTreeSet::new(), BTreeSet::new());
    let mut waiting = vec![own_name];
    while let Some(name) = waiting.pop() {
        if !name.starts_with(OURS) {
            others.insert(name);
        } else if ours.insert(name.clone()) {
            let folder = beside.get(&name).ok_or_else(|| format!("there is no folder of `{name}` beside this one"))?;
            let manifest = folder.join("Cargo.toml");
            waiting.extend(dependencies(&read(&manifest)?));
            all_read.push(manifest);
        }
    }
    for name in &ours {
        for part in FOLDERS {
            let folder = beside[name].join(part);
            if folder.is_dir() {
                add_files(&folder, &format!("{name}/{part}"), &mut files)?;
                all_read.push(folder);
            }
        }
    }
    if let Some((_, packages)) = &lock {
        files.extend(locked(packages, &others)?);
    }

    files.sort();
    let list = Sha256::digest(files.concat().as_bytes());
    Ok(Hashed { sha256: hex(&list), read: all_read, lock_is_missing: lock.is_none() })
}

/// A line for each file of a folder: its hash with the line ends of Unix, and its name.
fn add_files(folder: &Path, name: &str, lines: &mut Vec<String>) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let file_name =
            path.file_name().and_then(|name| name.to_str()).ok_or_else(|| format!("{path:?} is no text"))?;
        let name = format!("{name}/{file_name}");
        if path.is_dir() {
            add_files(&path, &name, lines)?;
        } else {
            let bytes = fs::read(&path).map_err(failed)?;
            lines.push(format!("{}  {name}\n", hex(&Sha256::digest(with_unix_line_ends(&bytes)))));
        }
    }
    Ok(())
}

fn with_unix_line_ends(bytes: &[u8]) -> Vec<u8> {
    let next = bytes.iter().skip(1).map(Some).chain([None]);
    bytes.iter().zip(next).filter(|&pair| pair != (&b'\r', Some(&b'\n'))).map(|(byte, _)| *byte).collect()
}

/// The crates in the folders beside this one, itself included, by their names.
fn crates_beside(own: &Path) -> Result<BTreeMap<String, PathBuf>, String> {
    let parent = own.parent().ok_or("the crate is in no folder")?;
    let entries = fs::read_dir(parent).map_err(|error| format!("{}: {error}", parent.display()))?;
    let folders = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let named = |folder: PathBuf| {
        let name = package_name(&fs::read_to_string(folder.join("Cargo.toml")).ok()?)?;
        name.starts_with(OURS).then_some((name, folder))
    };
    Ok(folders.filter_map(named).collect())
}

/// The name that a manifest gives its package.
fn package_name(manifest: &str) -> Option<String> {
    let (_, package) = manifest.split_once("[package]")?;
    Some(value_of(package.lines(), "name")?.to_owned())
}

/// The packages that a manifest names as dependencies of the library itself.
fn dependencies(manifest: &str) -> Vec<String> {
    let (mut names, mut listed) = (Vec::new(), false);
    for line in manifest.lines().map(str::trim) {
        if let Some(section) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            let of_one = section.rsplit_once('.').filter(|(table, _)| is_dependencies(table));
            names.extend(of_one.map(|(_, name)| name.to_owned()));
            listed = is_dependencies(section);
        } else if listed && !line.starts_with('#') {
            let name = line.split(['=', '.']).next().unwrap_or_default().trim().trim_matches('"');
            names.extend((!name.is_empty()).then(|| name.to_owned()));
        }
    }
    names
}

/// Whether a section of a manifest is `dependencies`, for all targets or for some.
fn is_dependencies(section: &str) -> bool {
    section == "dependencies" || section.starts_with("target.") && section.ends_with(".dependencies")
}

/// What `Cargo.lock` says of one package.
struct Locked {
    name: String,
    version: String,
    /// Name, version, where it comes from, and its checksum.
    line: String,
    /// Names, each with a version behind it where several are locked.
    dependencies: Vec<String>,
}

fn lock_entries(lock: &str) -> Vec<Locked> {
    let entries = lock.split("[[package]]").skip(1);
    let entry = |text: &str| {
        let value = |key| value_of(text.lines(), key).unwrap_or_default().to_owned();
        let (name, version) = (value("name"), value("version"));
        let list = text.split_once("dependencies = [").and_then(|(_, rest)| rest.split_once(']'));
        let dependencies = list.map_or_else(Vec::new, |(list, _)| {
            list.split(',')
                .map(|word| word.trim().trim_matches('"').to_owned())
                .filter(|word| !word.is_empty())
                .collect()
        });
        let line = format!("{name} {version} {} {}\n", value("source"), value("checksum"));
        Locked { name, version, line, dependencies }
    };
    entries.map(entry).collect()
}

/// A line for each of the named packages, and for all that these use.
fn locked(packages: &[Locked], names: &BTreeSet<String>) -> Result<BTreeSet<String>, String> {
    let mut lines = BTreeSet::new();
    let mut waiting: Vec<&str> = names.iter().map(String::as_str).collect();
    while let Some(wanted) = waiting.pop() {
        let mut words = wanted.split(' ');
        let (name, version) = (words.next().unwrap_or_default(), words.next());
        let fits = |package: &&Locked| package.name == name && version.is_none_or(|version| package.version == version);
        let mut found = packages.iter().filter(fits).peekable();
        found.peek().ok_or_else(|| format!("Cargo.lock has no `{wanted}`"))?;
        // A manifest names no version; of several that are locked all count.
        for package in found {
            if lines.insert(package.line.clone()) {
                waiting.extend(package.dependencies.iter().map(String::as_str));
            }
        }
    }
    Ok(lines)
}

/// The text that a line `key = "text"` gives.
fn value_of<'a>(mut lines: impl Iterator<Item = &'a str>, key: &str) -> Option<&'a str> {
    lines.find_map(|line| Some(line.trim().strip_prefix(key)?.trim_start().strip_prefix('=')?.trim().trim_matches('"')))
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}
