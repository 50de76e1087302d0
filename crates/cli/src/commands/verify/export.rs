//! The truths as files, for a renderer in any language.

use std::fs;
use std::path::Path;

use etalon_oracle::truths::{Truth, exchange_files};
use etalon_picture::write_atomically;
use miette::{Report, miette};

use crate::failure::{Failure, Outcome};
use crate::print;

/// Writes a scene for each truth, the list of them, the schema of the scenes and a README into a folder, which is made.
pub(super) fn run(folder: &Path, truths: &[Truth]) -> Outcome {
    let scenes = folder.join("scenes");
    fs::create_dir_all(&scenes)
        .map_err(|error| Failure::run(miette!(code = "export", "cannot make `{}`: {error}", scenes.display())))?;
    let files = exchange_files(truths);
    for file in &files {
        write_atomically(&folder.join(&file.path), |out| out.write_all(&file.bytes))
            .map_err(|error| Failure::run(Report::from_err(error)))?;
    }
    print::line(&format!(
        "{} truths in {} files: start at {}",
        truths.len(),
        files.len(),
        folder.join("README.md").display()
    ));
    Ok(())
}
