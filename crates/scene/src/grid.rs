//! Grids of numbers in .vol files.
//!
//! The format is that of Mitsuba's grids: the letters `VOL`, a byte 3 (version), then little-endian: the type of the numbers as a 32-bit
//! integer (1: 32-bit floating point), the cells along x, y and z and the channels as 32-bit integers, the corners of the box as six 32-bit
//! floating-point numbers (least x, y, z, greatest x, y, z), and the numbers; channels run first, then x, then y, then z.

use std::sync::Arc;

/// Bytes before the numbers.
const HEADER: usize = 48;

/// A grid of numbers in a box.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Cells along x, y and z.
    pub(crate) cells: [u32; 3],
    /// Numbers in each.
    pub(crate) channels: usize,
    /// Their numbers, 0 or above; channels run first, then x, then y.
    pub(crate) values: Arc<[f32]>,
    /// Corners of the box, m.
    pub(crate) box_m: [[f64; 3]; 2],
}

/// Reads a .vol file.
///
/// # Errors
/// A sentence that says what is wrong with it.
pub(crate) fn read_vol(bytes: &[u8]) -> Result<Grid, String> {
    if bytes.len() < HEADER || &bytes[..3] != b"VOL" {
        return Err("this is no .vol file: it does not begin with VOL and a header of 48 bytes".to_owned());
    }
    if bytes[3] != 3 {
        return Err(format!("this .vol file has version {}; version 3 is read", bytes[3]));
    }
    let word = |at: usize| -> [u8; 4] { bytes[at..at + 4].try_into().expect("four bytes") };
    let integer = |at| i32::from_le_bytes(word(at));
    if integer(4) != 1 {
        return Err(format!("its numbers are of type {}; type 1, 32-bit floating point, is read", integer(4)));
    }
    let counts = [8, 12, 16, 20].map(integer);
    if counts.iter().any(|count| *count < 1) {
        return Err(format!("it says that it has {counts:?} cells and channels: each must be at least 1"));
    }
    let [nx, ny, nz, channels] = counts.map(|count| count as u64);
    let cells = u128::from(nx) * u128::from(ny) * u128::from(nz) * u128::from(channels);
    let numbers = &bytes[HEADER..];
    if numbers.len() as u128 != 4 * cells {
        return Err(format!(
            "{nx} × {ny} × {nz} cells of {channels} take {} bytes, but it has {}",
            4 * cells,
            numbers.len()
        ));
    }
    let box_m = [0, 1].map(|corner| [0, 1, 2].map(|k| f64::from(f32::from_le_bytes(word(24 + 12 * corner + 4 * k)))));
    if (0..3).any(|k| !(box_m[0][k] < box_m[1][k] && box_m[0][k].is_finite() && box_m[1][k].is_finite())) {
        return Err(format!("its box reaches from {:?} to {:?}: it has no inside", box_m[0], box_m[1]));
    }
    let values: Arc<[f32]> =
        numbers.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().expect("four bytes"))).collect();
    if let Some(place) = values.iter().position(|value| !(*value >= 0.0 && value.is_finite())) {
        return Err(format!("number {place} is {}: all are 0 or above", values[place]));
    }
    Ok(Grid { cells: [nx as u32, ny as u32, nz as u32], channels: channels as usize, values, box_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(cells: [i32; 3], channels: i32, numbers: &[f32]) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        let head = [1, cells[0], cells[1], cells[2], channels];
        head.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
        [0.0, 0.0, 0.0, 1.0, 2.0, 3.0_f32].iter().chain(numbers).for_each(|number| bytes.extend(number.to_le_bytes()));
        bytes
    }

    #[test]
    fn a_grid_is_read_as_it_was_written() {
        let grid = read_vol(&file([2, 1, 2], 1, &[0.0, 1.0, 2.0, 3.5])).expect("it is right");
        assert_eq!((grid.cells, grid.box_m), ([2, 1, 2], [[0.0; 3], [1.0, 2.0, 3.0]]));
        assert_eq!((grid.channels, &grid.values[..]), (1, &[0.0, 1.0, 2.0, 3.5][..]));
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said() {
        let wrong = |bytes: &[u8], says: &str| {
            let why = read_vol(bytes).expect_err(says);
            assert!(why.contains(says), "{why}");
        };
        wrong(b"VOL", "no .vol file");
        wrong(&file([2, 1, 2], 1, &[0.0; 3]), "16 bytes, but it has 12");
        wrong(&file([i32::MAX; 3], 1, &[0.0; 3]), "bytes, but it has 12");
        wrong(&file([2, 0, 2], 1, &[]), "at least 1");
        wrong(&file([1, 1, 1], 3, &[0.0; 2]), "12 bytes, but it has 8");
        wrong(&file([1, 1, 1], 1, &[-1.0]), "number 0 is -1");
        wrong(&file([1, 1, 1], 1, &[f32::NAN]), "number 0 is NaN");
        let mut old = file([1, 1, 1], 1, &[1.0]);
        old[3] = 2;
        wrong(&old, "version 2");
        let mut flat = file([1, 1, 1], 1, &[1.0]);
        flat[36..40].copy_from_slice(&0.0_f32.to_le_bytes());
        wrong(&flat, "no inside");
    }
}
