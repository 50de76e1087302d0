//! `etalon whitted`: any file in the assignment's JSON form, rendered as the assignment prescribes.

use std::path::PathBuf;

/// Renders a scene in the assignment's JSON form.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The scene, in the assignment's JSON form.
    scene: PathBuf,
    /// Picture to write.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}
