//! A copy of the tree in which every mutant that compiles is there, to be turned on.

use crate::rewrite::{Mutant, What, mutants, rewritten};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What the root of a crate with mutants gets: whether one is on, and, if asked, which are reached.
const QUESTION: &str = r#"
#[doc(hidden)]
#[allow(missing_docs, unreachable_pub)]
#[inline]
pub fn mutant_is_on(number: u32) -> bool {
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};
    static ON: OnceLock<u32> = OnceLock::new();
    static REACHED: [AtomicBool; 1 << 16] = [const { AtomicBool::new(false) }; 1 << 16];
    let on = *ON.get_or_init(|| match std::env::var("MUTANT") {
        Ok(number) => number.parse().expect("a number"),
        Err(_) => u32::MAX,
    });
    if on == u32::MAX && !REACHED[number as usize].swap(true, Ordering::Relaxed) {
        if let Some(path) = std::env::var_os("MUTANTS_REACHED") {
            use std::io::Write;
            let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).expect("a file");
            file.write_all(format!("{number}\n").as_bytes()).expect("written");
        }
    }
    on == number
}
"#;

/// A file and its mutants.
pub struct Mutated {
    pub file: String,
    pub mutants: Vec<(u32, Mutant)>,
}

/// A test program, and where it is run.
pub struct Program {
    pub path: PathBuf,
    pub folder: PathBuf,
}

/// A command of cargo's in the copy: fast to build.
fn cargo(copy: &Path) -> Command {
    let mut command = Command::new("cargo");
    command.current_dir(copy).stderr(Stdio::null()).env("CARGO_TARGET_DIR", copy.with_file_name("build"));
    command.envs([("CARGO_PROFILE_RELEASE_DEBUG", "0"), ("CARGO_PROFILE_RELEASE_LTO", "off")]);
    command.envs([
        ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16"),
        ("CARGO_INCREMENTAL", "0"),
        ("RUSTFLAGS", "-Awarnings"),
    ]);
    command
}

/// Makes a folder hold the tracked files of a tree and no others; unchanged ones are not written again.
fn copy_tree(tree: &Path, copy: &Path) -> Result<(), String> {
    let list = Command::new("git").arg("ls-files").current_dir(tree).output().map_err(|e| e.to_string())?;
    let mut kept = BTreeSet::new();
    for name in String::from_utf8_lossy(&list.stdout).lines() {
        let Ok(new) = fs::read(tree.join(name)) else { continue };
        write(&copy.join(name), &new)?;
        kept.insert(copy.join(name));
    }
    remove_others(copy, &kept).map_err(|e| format!("{}: {e}", copy.display()))
}

/// Removes the files below a folder that are not among these.
fn remove_others(folder: &Path, kept: &BTreeSet<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            remove_others(&entry.path(), kept)?;
        } else if !kept.contains(&entry.path()) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

fn write(path: &Path, content: &[u8]) -> Result<(), String> {
    if fs::read(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    let folder = path.parent().expect("a file lies in a folder");
    fs::create_dir_all(folder).and_then(|()| fs::write(path, content)).map_err(|e| format!("{}: {e}", path.display()))
}

/// Makes the copy, and leaves out what does not compile.
pub fn prepare(tree: &Path, copy: &Path, files: &[String], what: What) -> Result<Vec<Mutated>, String> {
    copy_tree(tree, copy)?;
    let (mut all, mut sources, mut next) = (Vec::new(), Vec::new(), 0);
    for file in files {
        let source = fs::read_to_string(tree.join(file)).map_err(|e| format!("{file}: {e}"))?;
        let found = mutants(&source, what).map_err(|e| format!("{file}: {e}"))?;
        let numbered: Vec<_> = (next..).zip(found).collect();
        next += numbered.len() as u32;
        all.push(Mutated { file: file.clone(), mutants: numbered });
        sources.push(source);
        let root = file.split_once("/src/").map(|(package, _)| format!("{package}/src/lib.rs"));
        let root = root.ok_or_else(|| format!("{file} is no file of a package's src"))?;
        let lib = fs::read_to_string(tree.join(&root)).map_err(|e| format!("{root}: {e}"))?;
        write(&copy.join(&root), (lib + QUESTION).as_bytes())?;
    }
    loop {
        let mut texts = Vec::new();
        for (mutated, source) in all.iter().zip(&sources) {
            let text = rewritten(source, mutated.mutants.iter().map(|(number, mutant)| (*number, mutant)));
            write(&copy.join(&mutated.file), text.as_bytes())?;
            texts.push((mutated.file.clone(), text));
        }
        let wrong = wrong(copy, &texts)?;
        if wrong.is_empty() {
            return Ok(all);
        }
        let before: usize = all.iter().map(|m| m.mutants.len()).sum();
        all.iter_mut().for_each(|mutated| mutated.mutants.retain(|(number, _)| !wrong.contains(number)));
        let after: usize = all.iter().map(|m| m.mutants.len()).sum();
        println!("{} of {before} mutants do not compile", before - after);
        if after == before {
            return Err("the copy does not compile, and no mutant is to blame".into());
        }
    }
}

/// The mutants at the places of the compiler's errors.
fn wrong(copy: &Path, texts: &[(String, String)]) -> Result<BTreeSet<u32>, String> {
    let output = cargo(copy).args(["check", "--release", "--workspace", "--lib", "--message-format=json"]).output();
    let output = output.map_err(|e| e.to_string())?;
    let mut wrong = BTreeSet::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Ok(message) = serde_json::from_str::<Value>(line) else { continue };
        let message = &message["message"];
        if message["level"] != "error" {
            continue;
        }
        for span in message["spans"].as_array().into_iter().flatten().filter(|span| span["is_primary"] == true) {
            let name = span["file_name"].as_str().unwrap_or_default();
            let Some((_, text)) = texts.iter().find(|(file, _)| name.ends_with(file.as_str())) else { continue };
            let (start, end) =
                (span["byte_start"].as_u64().unwrap_or(0) as usize, span["byte_end"].as_u64().unwrap_or(0) as usize);
            let within = numbers(&text[start..end.max(start)]);
            let before = numbers(&text[text[..start].rfind('\n').map_or(0, |at| at + 1)..start]);
            let after = numbers(&text[start..text[start..].find('\n').map_or(text.len(), |at| start + at)]);
            // What is asked just before the wrong expression; else all about it.
            match before.last() {
                Some(number) if text[start..].starts_with("mutant_") || text[start..].starts_with("*mutant_") => {
                    wrong.insert(*number);
                }
                _ if !within.is_empty() => wrong.extend(within),
                _ => wrong.extend(before.into_iter().chain(after)),
            }
        }
    }
    if wrong.is_empty() && !output.status.success() {
        return Err("the copy does not compile".into());
    }
    Ok(wrong)
}

/// The mutants asked for in a text.
fn numbers(text: &str) -> Vec<u32> {
    let asked = text.split("mutant_is_on(").skip(1);
    asked.filter_map(|rest| rest.split(')').next()?.parse().ok()).collect()
}

/// Builds the tests.
pub fn programs(copy: &Path, tests: &[String]) -> Result<Vec<Program>, String> {
    let mut command = cargo(copy);
    command.args(["test", "--release", "--workspace", "--no-run", "--message-format=json"]).args(tests);
    let output = command.output().map_err(|e| e.to_string())?;
    if !output.status.success() {
        return Err("the tests do not compile".into());
    }
    let mut programs = Vec::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Ok(message) = serde_json::from_str::<Value>(line) else { continue };
        if let (Some(path), true) = (message["executable"].as_str(), message["profile"]["test"] == true) {
            let manifest = Path::new(message["manifest_path"].as_str().unwrap_or_default());
            let folder = manifest.parent().unwrap_or(copy).to_owned();
            programs.push(Program { path: path.into(), folder });
        }
    }
    Ok(programs)
}
