//! `etalon schema`: the JSON Schema of scene files, for editors.

use crate::failure::Outcome;
use crate::print;

/// Print the JSON Schema of scene files, so that an editor can complete and check them.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon schema > scenes/etalon.schema.json")]
pub(crate) struct Args {}

pub(crate) fn run(_: Args) -> Outcome {
    print::json(&etalon_scene::schema());
    Ok(())
}
