//! What a file says that it holds, asked before memory is taken for it.

use std::io::Cursor;

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::reader::ChunksReader;
use exr::compression::Compression;
use exr::error::Error;
use exr::meta::MetaData;
use exr::meta::header::Header;

/// Least bytes that reading takes for a pixel: a line of them is put together as four 32-bit floats each.
const LEAST_PIXEL_BYTES: u64 = 16;

/// Bytes of the counters that a chunk of DWA begins with: eleven 64-bit numbers.
const DWA_COUNTERS_BYTES: usize = 88;
/// Those of the counters that the decoder takes memory by: how many bytes or numbers each section of the chunk unpacks to.
const DWA_UNPACKED: [usize; 5] = [1, 6, 7, 8, 9];

/// The most memory that an EXR file of `file_bytes` bytes may ask for, bytes: 64 MiB and 2000 times its size. Deflate, the
/// densest of the compressions that are read, reaches 1032.
pub fn most_exr_bytes(file_bytes: u64) -> u64 {
    file_bytes.saturating_mul(2000).saturating_add(64 << 20)
}

/// The most memory that decoding an image file of `file_bytes` bytes may take with all its conversions, bytes: 512 MiB and 2000 times
/// its size. A texture of one colour and 8192 × 8192 texels fits.
pub fn most_image_bytes(file_bytes: u64) -> u64 {
    file_bytes.saturating_mul(2000).saturating_add(512 << 20)
}

/// Most memory for what a PNG file holds beside its pixels, bytes. Colour profiles and texts are not used.
pub const MAX_PNG_METADATA_BYTES: u64 = 16 << 20;

/// Refuses an EXR file that claims more than it can hold. In none of its parts may the pixels take more than `most_bytes`, or be more
/// than `most_side` on a side. A chunk packed by DWA may not claim to unpack to more than its pixels come from.
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
            let message =
                format!("its {length} bytes claim {width} × {height} pixels, which would take {asked} bytes of memory");
            return Err(Error::Invalid(message.into()));
        }
        if width > most_side || height > most_side {
            let message = format!("it claims {width} × {height} pixels; a side has at most {most_side}");
            return Err(Error::Invalid(message.into()));
        }
    }
    if header.headers.iter().any(is_dwa) { check_dwa(bytes) } else { Ok(()) }
}

fn is_dwa(part: &Header) -> bool {
    matches!(part.compression, Compression::DWAA(_) | Compression::DWAB(_))
}

/// Refuses chunks of DWA whose counters claim more than their pixels can come from: the decoder takes memory by them.
fn check_dwa(bytes: &[u8]) -> exr::error::Result<()> {
    // The chunks that the decoder finds, which are those that the table of offsets names.
    let mut chunks = exr::block::read(Cursor::new(bytes), false)?.filter_chunks(false, |_, _, _| true)?;
    let parts = chunks.meta_data().headers.clone();
    // Whether a chunk that cannot be read matters, the decoder knows.
    for chunk in chunks.by_ref().flatten() {
        let Some(part) = parts.get(chunk.layer_index).filter(|part| is_dwa(part)) else { continue };
        check_dwa_chunk(part, &chunk)?;
    }
    Ok(())
}

fn check_dwa_chunk(part: &Header, chunk: &Chunk) -> exr::error::Result<()> {
    let packed = match &chunk.compressed_block {
        CompressedBlock::ScanLine(lines) => &lines.compressed_pixels_le,
        CompressedBlock::Tile(tile) => &tile.compressed_pixels_le,
        CompressedBlock::DeepScanLine(_) | CompressedBlock::DeepTile(_) => return Ok(()),
    };
    let tile = part.get_block_data_indices(&chunk.compressed_block)?;
    let size = part.get_absolute_block_pixel_coordinates(tile)?.size;
    let plain = size.area().saturating_mul(part.channels.bytes_per_pixel);
    if packed.len() == plain {
        // What compression would make larger is stored as it is.
        return Ok(());
    }
    // Blocks of 8 × 8 pixels are packed whole; runs of unequal bytes grow by up to a half.
    let whole = |pixels: usize| pixels.next_multiple_of(8);
    let most =
        2 * (whole(size.width()) as u128) * (whole(size.height()) as u128) * (part.channels.bytes_per_pixel as u128);
    let Some((counters, _)) = packed.split_at_checked(DWA_COUNTERS_BYTES) else { return Ok(()) };
    for counter in DWA_UNPACKED {
        let claimed = counters[8 * counter..][..8].iter().rev().fold(0_u64, |n, byte| n << 8 | u64::from(*byte));
        if u128::from(claimed) > most {
            let message = format!(
                "a chunk of {} × {} pixels claims {claimed} values; at most {most}",
                size.width(),
                size.height()
            );
            return Err(Error::Invalid(message.into()));
        }
    }
    Ok(())
}
