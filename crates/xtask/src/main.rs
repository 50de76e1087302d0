//! The named commands of the repository. `cargo xtask` lists them, `cargo xtask NAME` runs one.
//!
//! The tests of this crate hold the repository itself to its rules: [`commands`] has every script, [`architecture`] states the
//! dependencies of every crate, every link of the [`pages`] leads somewhere, no crate has new [`import_cycles`], retired words of the
//! [`glossary`] or [`duplicate_types`], and the lists of CONTRIBUTING.md name the files that an existing part touches (`parts`).
#![allow(clippy::print_stdout, clippy::print_stderr)] // A tool prints.

mod allowed;
mod architecture;
mod commands;
mod duplicate_types;
#[cfg(test)]
mod faults;
mod glossary;
mod import_cycles;
mod manifest;
mod messages;
mod pages;
#[cfg(test)]
mod parts;
mod slowest;
mod source;
mod targets;
mod vocabulary;

use std::path::PathBuf;
use std::process::ExitCode;

/// The folder of the repository.
fn root() -> PathBuf {
    // Cargo sets the variable for what it runs; the other is for a binary that is started by hand.
    let here = std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    here.ancestors().nth(2).map_or_else(|| here.clone(), PathBuf::from)
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next();
    let rest: Vec<String> = arguments.collect();
    match name.as_deref() {
        None | Some("help" | "--help" | "-h") => {
            print!("{}", commands::list());
            ExitCode::SUCCESS
        }
        Some(name) => match commands::find(name) {
            Some(command) => command.run(&root(), &rest).unwrap_or_else(|message| {
                eprintln!("xtask {name}: {message}");
                ExitCode::FAILURE
            }),
            None => {
                eprintln!("xtask: there is no command `{name}`; `cargo xtask` lists all");
                ExitCode::from(2)
            }
        },
    }
}
