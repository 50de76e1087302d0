//! `etalon figures`: the published assignment figures, compared pixel for pixel.

use std::path::PathBuf;

/// Renders the assignment's 16 images and its animation, and counts the pixels that differ from the published ones.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder to write the images to; made if it is missing.
    #[arg(short, long, value_name = "DIR", default_value = "figures")]
    output: PathBuf,
}
