//! The program `etalon`: see [`etalon_cli::run`].

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(etalon_cli::run(std::env::args_os(), None))
}
