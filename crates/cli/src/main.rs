//! The program `etalon`.
//!
//! Exit status: 0 done, 1 failed, 2 bad usage or a bad scene, 3 a comparison that could not be decided, 130 ended by SIGINT and
//! 143 by SIGTERM.

mod args;
mod commands;
mod developing;
mod display;
mod excerpt;
mod failure;
mod frame_settings;
mod frames;
mod interrupt;
mod light;
mod load;
mod machine;
mod machine_limits;
mod output;
mod overrides;
mod print;
mod problem_json;
mod progress;
mod replay_text;
mod scene_report;
mod shell;
mod state;
mod write_outputs;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::failure::{Failure, Outcome};

/// What the environment may say, for `--help`.
const ENVIRONMENT: &str = "Environment:
  ETALON_SIMD  Instruction set: baseline, avx2 or avx512; the widest that the processor has if not set. \
Pictures have the same bytes on each";

/// A physically based spectral path tracer with a test oracle.
#[derive(Parser)]
#[command(name = "etalon", version, arg_required_else_help = true, after_help = ENVIRONMENT)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// What to do. A command is listed here once it works.
#[derive(Subcommand)]
enum Command {
    Render(Box<commands::render::Args>),
    Merge(commands::merge::Args),
    Farm(commands::farm::Args),
    Quote(commands::quote::Args),
    Compare(commands::compare::Args),
    Develop(commands::develop::Args),
    #[cfg(feature = "denoise")]
    Denoise(commands::denoise::Args),
    Study(commands::study::Args),
    Explain(commands::explain::Args),
    Import(commands::import::Args),
    Schema(commands::schema::Args),
    Whitted(commands::whitted::Args),
    Figures(commands::figures::Args),
    Verify(commands::verify::Args),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    print::set_up_reports();
    // Where nothing is rendered too: a wrong value is never passed over.
    if let Err(error) = etalon_simd::Level::chosen() {
        return Failure::input(miette::miette!("{error}")).report();
    }
    let outcome: Outcome = match cli.command {
        Command::Render(args) => commands::render::run(*args),
        Command::Merge(args) => commands::merge::run(args),
        Command::Farm(args) => commands::farm::run(args),
        Command::Quote(args) => commands::quote::run(args),
        Command::Compare(args) => commands::compare::run(args),
        Command::Develop(args) => commands::develop::run(args),
        #[cfg(feature = "denoise")]
        Command::Denoise(args) => commands::denoise::run(args),
        Command::Study(args) => commands::study::run(args),
        Command::Explain(args) => commands::explain::run(args),
        Command::Import(args) => commands::import::run(args),
        Command::Schema(args) => commands::schema::run(args),
        Command::Whitted(args) => commands::whitted::run(args),
        Command::Figures(args) => commands::figures::run(args),
        Command::Verify(args) => commands::verify::run(args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
