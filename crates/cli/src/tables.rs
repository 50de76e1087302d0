//! Where tables are kept between runs.

use std::path::PathBuf;

use etalon_control::SOURCES_SHA256;
use etcetera::BaseStrategy;
use miette::{Report, miette};

use crate::failure::Failure;

/// Names the folder; empty if none is to be kept.
const VARIABLE: &str = "ETALON_TABLES";

/// Keeps the tables of rough surfaces for later runs, in the folder that the environment variable `ETALON_TABLES` names or among the user's cached files.
pub(crate) fn keep_tables() -> Result<(), Failure> {
    match std::env::var_os(VARIABLE) {
        Some(folder) if folder.is_empty() => Ok(()),
        Some(folder) => {
            let folder = PathBuf::from(folder);
            etalon_transport::bsdf::keep_tables(&folder, SOURCES_SHA256).map_err(|error| {
                let what = miette!("cannot keep tables in `{}`, which {VARIABLE} names", folder.display());
                Failure::input(Report::from_err(error).wrap_err(what))
            })
        }
        None => {
            if let Ok(folders) = etcetera::choose_base_strategy() {
                // Nobody has asked for it: without it a start takes longer.
                let folder = folders.cache_dir().join("etalon").join("tables");
                let _kept = etalon_transport::bsdf::keep_tables(&folder, SOURCES_SHA256);
            }
            Ok(())
        }
    }
}
