//! The native half of the Python package `etalon`: the module `etalon._etalon`.
//!
//! It is thin. Arrays cross the border as bytes, plain data as JSON text; the Python half (`python/etalon/`) makes numpy arrays and
//! dataclasses of them and is what users see. Everything else is the facade crate `etalon`.
//!
//! Without the feature `bindings` the crate is empty: see `docs/decisions/0050-python-package.md`.
#![cfg(feature = "bindings")]

mod background;
mod errors;
mod oracle;
mod picture;
mod renderer;
mod scene;
mod spectra;

use pyo3::prelude::*;

/// The native half of the package `etalon`.
#[pymodule]
mod _etalon {
    use std::ffi::OsString;
    use std::path::PathBuf;

    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::oracle::{exchange_files, judge, truth_files, truths};
    #[pymodule_export]
    use crate::picture::{Picture, compare, read};
    #[pymodule_export]
    use crate::renderer::{Passes, Renderer};
    #[pymodule_export]
    use crate::scene::{Scene, load, parse, parse_with_files, schema};
    #[pymodule_export]
    use crate::spectra::{
        abbe_number, blackbody, colour_matching, emission_of_rgb, glass, glasses, illuminant, illuminants, metal,
        metals, reflectance_of_rgb, rgb_to_xyz, srgb_decode, srgb_encode, xyz_to_rgb,
    };

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    /// Runs the command line: words, of which the first is the name of the program. Farm jobs call `program`.
    #[pyfunction]
    #[pyo3(signature = (words, program))]
    fn main(py: Python<'_>, words: Vec<OsString>, program: Option<PathBuf>) -> u8 {
        py.detach(|| etalon_cli::run(words, program))
    }
}
