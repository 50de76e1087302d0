//! Which format a file has.

use super::Photometry;
use super::eulumdat::read_eulumdat;
use super::ies::read_ies;

/// The intensities of a file: EULUMDAT by the name's ending `.ldt`, else IES LM-63.
///
/// # Errors
/// A sentence that says what is wrong with it.
pub(crate) fn read_photometry(name: &str, bytes: &[u8]) -> Result<Photometry, String> {
    if name.to_ascii_lowercase().ends_with(".ldt") { read_eulumdat(bytes) } else { read_ies(bytes) }
}
