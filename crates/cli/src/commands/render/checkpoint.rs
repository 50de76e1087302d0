//! What becomes of a render that ends before it is done, or whose pictures cannot be written.

use std::path::{Path, PathBuf};

use miette::{Report, miette};

use super::{Done, RenderArgs};
use crate::failure::Failure;
use crate::output;
use crate::state;

/// Keeps what was rendered where the outputs do not: after a signal, and after an output that could not be written. Takes the
/// checkpoint away where they do.
pub(super) fn keep(args: &RenderArgs, done: &Done, failure: &Failure, begun: bool) -> Option<Result<PathBuf, Failure>> {
    let beside = state::checkpoint_path(args.output.first()?);
    if done.header.complete && failure.is_empty() {
        // It may never have been written.
        let _ = std::fs::remove_file(&beside);
        return None;
    }
    if !begun {
        return None;
    }
    let Err(error) = state::write(&beside, &done.header, &done.canvas, &[]) else { return Some(Ok(beside)) };
    // The disk of the outputs may be full; another may not be.
    let name = format!("etalon-{}.checkpoint", std::process::id());
    let elsewhere = std::env::temp_dir().join(name);
    Some(match state::write(&elsewhere, &done.header, &done.canvas, &[]) {
        Ok(()) => Ok(elsewhere),
        Err(_) => Err(Failure::run(Report::from_err(error).wrap_err("the render is lost"))),
    })
}

/// What must be done with a checkpoint before it is found.
pub(super) fn moved(args: &RenderArgs, kept: &Path) -> String {
    match args.output.first().map(|output| state::checkpoint_path(output)) {
        Some(beside) if beside != kept => format!("move it to `{}`: ", beside.display()),
        _ => String::new(),
    }
}

/// What is said of a render that a signal has ended.
pub(super) fn interrupted(
    args: &RenderArgs,
    signal: u8,
    done: &Done,
    written: &[output::Written],
    kept: Option<&Result<PathBuf, Failure>>,
) -> Failure {
    let [fewest, most] = done.canvas.samples();
    let mut text = match most {
        0 => "interrupted before the first tile was done".to_owned(),
        _ if fewest == most => format!("interrupted at {fewest} samples a pixel"),
        _ => format!("interrupted at {fewest} to {most} samples a pixel"),
    };
    if !written.is_empty() {
        text += &format!("; the picture has what there is: {}", {
            let names: Vec<_> = written.iter().map(|written| format!("`{}`", written.path)).collect();
            names.join(", ")
        });
    }
    let help = match kept {
        Some(Ok(path)) => {
            format!("{}the same command with --resume goes on from `{}`", moved(args, path), path.display())
        }
        Some(Err(_)) => "the sums could not be kept, so it cannot be resumed".to_owned(),
        None => "nothing is kept".to_owned(),
    };
    Failure::signal(signal, miette!(code = "interrupted", help = help, "{text}"))
}
