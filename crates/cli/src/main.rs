//! The program `etalon`.
//!
//! Exit status: 0 done, 1 failed, 2 bad usage or a bad scene.

mod commands;
mod failure;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::failure::Outcome;

/// A physically based spectral path tracer with a test oracle.
#[derive(Parser)]
#[command(name = "etalon", version, about, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// What to do. A command is listed here once it works.
#[derive(Subcommand)]
enum Command {}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let outcome: Outcome = match cli.command {};
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
