//! `etalon schema`: the JSON Schema of scene files, for editors.

use crate::failure::Outcome;
use crate::print;

/// Prints the JSON Schema of scene files, with which editors complete and check them.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: Args) -> Outcome {
    print::json(&etalon_scene::schema());
    Ok(())
}
