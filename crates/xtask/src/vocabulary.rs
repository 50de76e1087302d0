//! The table of what scenes can say and the truths that would notice, `docs/vocabulary.md`: a test of the crate that reads scenes makes it.

use std::path::Path;
use std::process::{Command, ExitCode};

/// Compares the page with the schema and the truths; with `--write`, writes it.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<ExitCode, String> {
    let write = match arguments {
        [] => false,
        [only] if only == "--write" => true,
        _ => return Err("takes nothing but --write".to_owned()),
    };
    let mut command = Command::new("cargo");
    command.args(["test", "--release", "-p", "etalon-scene", "--test", "integration", "vocabulary"]).current_dir(root);
    if write {
        command.env("ETALON_UPDATE_SNAPSHOTS", "1");
    }
    let status = command.status().map_err(|error| format!("cargo: {error}"))?;
    Ok(if status.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
