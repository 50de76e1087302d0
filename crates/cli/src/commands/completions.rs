//! `etalon completions`: scripts with which a shell completes commands and options.

use clap::CommandFactory;
use clap_complete::Shell;

use crate::failure::Outcome;
use crate::print;

/// Print a script with which a shell completes commands and options.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon completions bash > ~/.local/share/bash-completion/completions/etalon
  etalon completions zsh > _etalon
  etalon completions fish > ~/.config/fish/completions/etalon.fish
  etalon completions powershell > etalon.ps1

For zsh, put _etalon into a folder of $fpath. For PowerShell, call the file from $PROFILE.")]
pub(crate) struct CompletionArgs {
    /// Shell.
    #[arg(value_enum)]
    shell: Shell,
}

pub(crate) fn run(args: CompletionArgs) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut crate::Cli::command(), "etalon", &mut script);
    print::line(String::from_utf8_lossy(&script).trim_end());
    Ok(())
}
