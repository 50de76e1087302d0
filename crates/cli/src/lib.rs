//! The commands of the program `etalon`, for programs that offer the same command line: [`run`].
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
mod tables;
mod write_outputs;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Parser, Subcommand};

use crate::failure::{Failure, Outcome};

/// What follows the list of commands in `--help`.
const ENVIRONMENT: &str = "Example:
  etalon render scenes/cornell.json --spp 64 -o cornell.exr -o cornell.png

`etalon COMMAND --help` lists the options of a command, with an example.

Exit status:
  0    done
  1    failed, or pictures that differ
  2    bad usage, or a bad scene
  3    a comparison that could not be decided
  130  ended by SIGINT (Ctrl-C)
  143  ended by SIGTERM

Environment:
  ETALON_SIMD    Instruction set: baseline, avx2 or avx512. It does not change a picture.
                 Default: the widest that the processor has
  ETALON_TABLES  Folder that keeps tables of rough surfaces for later runs. They do not change a
                 picture. If it is empty, none are kept. Default: etalon/tables in the user's folder
                 of cached files";

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
    Render(Box<commands::render::RenderArgs>),
    Merge(commands::merge::MergeArgs),
    Farm(commands::farm::FarmArgs),
    Quote(commands::quote::QuoteArgs),
    Measure(commands::measure::MeasureArgs),
    Compare(commands::compare::CompareArgs),
    Develop(commands::develop::DevelopArgs),
    Expose(commands::expose::ExposeArgs),
    View(Box<commands::view::ViewArgs>),
    #[cfg(feature = "denoise")]
    Denoise(commands::denoise::DenoiseArgs),
    Study(commands::study::StudyArgs),
    Explain(commands::explain::ExplainArgs),
    Import(commands::import::ImportArgs),
    Schema(commands::schema::SchemaArgs),
    Whitted(commands::whitted::WhittedArgs),
    Figures(commands::figures::FiguresArgs),
    Verify(commands::verify::VerifyArgs),
    Completions(commands::completions::CompletionArgs),
    Man(commands::man::ManArgs),
}

/// Runs a command line, the first of whose `words` is the name of the program, and gives the exit status. Jobs for farms call `program`;
/// without it, they call the running executable.
///
/// It prints on standard output and standard error. `--help`, `--version` and bad usage end the process. A render listens to SIGINT and
/// SIGTERM, and ends the process on the second of them. So only a program that does nothing else calls this.
pub fn run(words: impl IntoIterator<Item = OsString>, program: Option<PathBuf>) -> u8 {
    let cli = Cli::parse_from(words);
    print::set_up_reports();
    // Where nothing is rendered too: a wrong value is never passed over.
    if let Err(error) = etalon_simd::Level::chosen() {
        return Failure::input(miette::miette!("{error}")).report();
    }
    if let Err(failure) = tables::keep_tables() {
        return failure.report();
    }
    let outcome: Outcome = match cli.command {
        Command::Render(args) => commands::render::run(*args),
        Command::Merge(args) => commands::merge::run(args),
        Command::Farm(args) => commands::farm::run(args, program),
        Command::Quote(args) => commands::quote::run(args),
        Command::Measure(args) => commands::measure::run(args),
        Command::Compare(args) => commands::compare::run(args),
        Command::Develop(args) => commands::develop::run(args),
        Command::Expose(args) => commands::expose::run(args),
        Command::View(args) => commands::view::run(*args),
        #[cfg(feature = "denoise")]
        Command::Denoise(args) => commands::denoise::run(args),
        Command::Study(args) => commands::study::run(args),
        Command::Explain(args) => commands::explain::run(args),
        Command::Import(args) => commands::import::run(args),
        Command::Schema(args) => commands::schema::run(args),
        Command::Whitted(args) => commands::whitted::run(args),
        Command::Figures(args) => commands::figures::run(args),
        Command::Verify(args) => commands::verify::run(args),
        Command::Completions(args) => commands::completions::run(args),
        Command::Man(args) => commands::man::run(args),
    };
    match outcome {
        Ok(()) => 0,
        Err(failure) => failure.report(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_command_has_an_example_that_the_program_understands() {
        for command in Cli::command().get_subcommands() {
            let name = command.get_name();
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let examples: Vec<&str> = help.lines().filter_map(|line| line.strip_prefix("  etalon ")).collect();
            assert!(!examples.is_empty(), "{name} has no example");
            for example in examples {
                let line = example.split(" > ").next().unwrap_or_default();
                let words = std::iter::once("etalon").chain(line.split_whitespace());
                assert!(line.starts_with(name), "{example}: an example of another command than {name}");
                if let Err(error) = Cli::try_parse_from(words) {
                    panic!("etalon {example}: {error}");
                }
            }
        }
    }

    /// The page of all commands. It is for the ordinary build, which has no `denoise`.
    #[cfg(not(feature = "denoise"))]
    fn page() -> String {
        let mut program = Cli::command().disable_help_subcommand(true).term_width(100);
        program.build();
        let mut text = "# Commands\n\nThis is the help of every command (`etalon COMMAND --help`). A test compares the page with the program.\n\n"
            .to_owned();
        let mut add = |heading: &str, command: &mut clap::Command| {
            let help = command.render_long_help().to_string();
            let lines: Vec<&str> = help.lines().map(str::trim_end).collect();
            text += &format!("## {heading}\n\n```text\n{}\n```\n\n", lines.join("\n").trim_end());
        };
        add("etalon", &mut program.clone());
        for command in program.get_subcommands_mut() {
            add(&format!("etalon {}", command.get_name()), command);
        }
        text.truncate(text.trim_end().len() + 1);
        text
    }

    /// Run with `ETALON_UPDATE_SNAPSHOTS=1` to write the page, and read the difference.
    #[cfg(not(feature = "denoise"))]
    #[test]
    fn the_page_of_commands_is_their_help() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/commands.md");
        let page = page();
        if std::env::var_os("ETALON_UPDATE_SNAPSHOTS").is_some() {
            std::fs::write(file, &page).unwrap();
        }
        let written = std::fs::read_to_string(file).unwrap_or_default();
        assert!(page == written, "ETALON_UPDATE_SNAPSHOTS=1 cargo test -p etalon-cli writes docs/commands.md anew");
    }

    #[test]
    fn every_command_option_and_value_is_described() {
        for command in Cli::command().get_subcommands() {
            assert!(command.get_about().is_some(), "{}", command.get_name());
            for argument in command.get_arguments() {
                assert!(argument.get_help().is_some(), "{} {}", command.get_name(), argument.get_id());
                let values = argument.get_possible_values();
                for value in values.iter().filter(|_| argument.get_action().takes_values()) {
                    let described = value.get_help().is_some() || command.get_name() == "completions";
                    assert!(described, "{} {} {}", command.get_name(), argument.get_id(), value.get_name());
                }
            }
        }
    }
}
