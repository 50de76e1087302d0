//! What an EXR file says that it holds, asked before memory is taken for it.

use std::io::Cursor;

use exr::error::Error;
use exr::meta::MetaData;

/// Least bytes that reading takes for a pixel: a line of them is put together as four 32-bit floats each.
const LEAST_PIXEL_BYTES: u64 = 16;

/// The most memory that an EXR file of `file_bytes` bytes may ask for, bytes: 64 MiB and 2000 times its size. Deflate, the
/// densest of the compressions that are read, reaches 1032.
pub fn most_exr_bytes(file_bytes: u64) -> u64 {
    file_bytes.saturating_mul(2000).saturating_add(64 << 20)
}

/// Looks through the header of an EXR file for what a few bytes may claim and nobody has: a picture that would take more than
/// `most_bytes`, or be wider or higher than `most_side` pixels, in any of its parts.
///
/// Reading takes memory by the window of the pixels that a file holds. An image's size as a viewer shows it is another window, which may be
/// small.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn check_exr_size(bytes: &[u8], most_bytes: u64, most_side: u64) -> Result<(), String> {
    check(bytes, most_bytes, most_side).map_err(|error| match error {
        Error::Invalid(message) => message.into_owned(),
        other => other.to_string(),
    })
}

/// [`check_exr_size`], with what the reader itself says.
pub(crate) fn check(bytes: &[u8], most_bytes: u64, most_side: u64) -> exr::error::Result<()> {
    let header = MetaData::read_from_buffered(Cursor::new(bytes), false)?;
    for part in header.headers.iter().filter(|part| !part.deep) {
        let [width, height] = [part.layer_size.width() as u64, part.layer_size.height() as u64];
        let pixel_bytes = (part.channels.bytes_per_pixel as u64).max(LEAST_PIXEL_BYTES);
        let asked = u128::from(width) * u128::from(height) * u128::from(pixel_bytes);
        if asked > u128::from(most_bytes) {
            let length = bytes.len();
            let message = format!("its {length} bytes claim {width} × {height} pixels, {asked} bytes of memory");
            return Err(Error::Invalid(message.into()));
        }
        if width > most_side || height > most_side {
            let message = format!("it claims {width} × {height} pixels, of at most {most_side} a side");
            return Err(Error::Invalid(message.into()));
        }
    }
    Ok(())
}
