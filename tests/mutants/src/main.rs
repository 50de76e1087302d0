//! Hunts mutants that no test notices: places of a source file where an operator may be exchanged for another, or the result of a
//! function for a constant, without any test failing.
//!
//! All mutants of the files named are compiled into one build, in a copy of the tree, and one is chosen by an environment variable when
//! the tests run: a mutant costs the tests that reach it, and no build. See `tests/mutants.sh`.
#![allow(clippy::print_stdout)] // A tool prints.

mod build;
mod hunt;
mod rewrite;

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut tree = PathBuf::from(".");
    let (mut files, mut tests, mut limit) = (Vec::new(), Vec::new(), usize::MAX);
    // No test takes an hour.
    let mut quick_s = 3600.0;
    let mut what = rewrite::What::default();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--tree" => tree = arguments.next().map(PathBuf::from).expect("--tree takes a folder"),
            "--limit" => limit = arguments.next().and_then(|n| n.parse().ok()).expect("--limit takes a number"),
            "--quick" => quick_s = arguments.next().and_then(|n| n.parse().ok()).expect("--quick takes seconds"),
            "--results" => what = rewrite::What::Results,
            "--" => tests.extend(arguments.by_ref()),
            file => files.push(file.to_owned()),
        }
    }
    match hunt::hunt(&tree, (&files, what), &tests, limit, quick_s) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}
