//! `etalon man`: manual pages.

use std::path::PathBuf;

use clap::CommandFactory;
use clap_mangen::Man;
use etalon_picture::write_atomically;
use miette::Report;

use crate::failure::{Failure, Outcome};
use crate::print;

/// Write a manual page for the program and one for each command.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon man -o ~/.local/share/man/man1")]
pub(crate) struct ManArgs {
    /// Folder for the pages. It is created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub(crate) fn run(args: ManArgs) -> Outcome {
    let failed = |what: &str, error: std::io::Error| Failure::run(Report::from_err(error).wrap_err(what.to_owned()));
    std::fs::create_dir_all(&args.output)
        .map_err(|error| failed(&format!("cannot create the folder `{}`", args.output.display()), error))?;
    let mut program = crate::Cli::command().disable_help_subcommand(true);
    // Gives each command its whole name, such as `etalon-render`.
    program.build();
    let commands: Vec<clap::Command> = program.get_subcommands().cloned().collect();
    let pages = 1 + commands.len();
    for command in std::iter::once(program).chain(commands) {
        let page = Man::new(command);
        let path = args.output.join(page.get_filename());
        let mut text = Vec::new();
        page.render(&mut text).map_err(|error| failed("cannot make a manual page", error))?;
        write_atomically(&path, |out| out.write_all(&text)).map_err(|error| Failure::run(Report::from_err(error)))?;
    }
    print::line(&format!(
        "{pages} pages in {}: `man -l {}`",
        args.output.display(),
        args.output.join("etalon.1").display()
    ));
    Ok(())
}
