//! Pictures under way in files: checkpoints, and the parts of a picture that several machines share.
//!
//! ```text
//! magic  8 bytes   "ETALON\0\3", the last byte is the version
//! header u32 n, n bytes of JSON: see `Header`
//! tiles  each: u32 n (> 0), n bytes of JSON (its pixels, its samples, what was counted), u32 m, m bytes of sums
//! end    u32 0, SHA-256 of all bytes before
//! ```
//!
//! Numbers are little-endian. The sums are those of `etalon_transport::TileSums`, with every bit.

mod file;

pub(crate) use file::{Header, Kept, Limited, StateError, read, write};

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use etalon_control::SampleAllocation;
use etalon_transport::PixelRect;

/// The shares that a file states, if they are shares of this rectangle.
pub(crate) fn allocation(rect: PixelRect, weights: &[u32]) -> Option<SampleAllocation> {
    let fit = weights.len() == SampleAllocation::regions(rect).len() && weights.iter().all(|&weight| weight > 0);
    fit.then(|| SampleAllocation::new(rect, weights.to_vec()))
}

/// The checkpoint of a render whose first output is this file: beside it, with `.checkpoint` after its name.
pub(crate) fn checkpoint_path(output: &Path) -> PathBuf {
    let mut name: OsString = output.as_os_str().to_owned();
    name.push(".checkpoint");
    PathBuf::from(name)
}
