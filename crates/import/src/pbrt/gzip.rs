//! Files that gzip has compressed.

use miniz_oxide::inflate::stream::{InflateState, inflate};
use miniz_oxide::{DataFormat, MZFlush, MZStatus};

use super::Reading;
use super::spectrum::kind;

/// Most bytes of all compressed files of a scene, once they are inflated.
pub(super) const MOST_INFLATED: usize = 1 << 30;

/// The remainders of bytes for CRC-32.
const REMAINDERS: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut rest = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            rest = if rest & 1 == 1 { 0xedb8_8320 ^ (rest >> 1) } else { rest >> 1 };
            bit += 1;
        }
        table[byte] = rest;
        byte += 1;
    }
    table
};

/// The check sum of gzip.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| REMAINDERS[usize::from(crc as u8 ^ byte)] ^ (crc >> 8))
}

impl Reading<'_, '_> {
    /// The bytes of a file that the scene names, inflated if its name ends in `.gz`.
    pub(super) fn inflated(&mut self, name: &str, place: &str) -> Result<Vec<u8>, String> {
        let bytes = self.builder.bytes_of(name, place)?;
        if kind(name) != "gz" {
            return Ok(bytes);
        }
        let inflated = gunzip(&bytes, self.inflated_left).map_err(|why| format!("{place}: \"{name}\": {why}"))?;
        self.inflated_left -= inflated.len();
        Ok(inflated)
    }
}

/// What gzip compressed, in one piece (RFC 1952), of at most so many bytes.
fn gunzip(file: &[u8], most: usize) -> Result<Vec<u8>, String> {
    let [0x1f, 0x8b, 8, flags, _, _, _, _, _, _, rest @ ..] = file else {
        return Err("it is no file of gzip".to_owned());
    };
    let cut = || "it is cut off".to_owned();
    let mut rest = rest;
    if flags & 4 != 0 {
        let (length, after) = rest.split_first_chunk::<2>().ok_or_else(cut)?;
        rest = after.get(usize::from(u16::from_le_bytes(*length))..).ok_or_else(cut)?;
    }
    // The name of the file and a comment end with a zero.
    for flag in [8, 16] {
        if flags & flag != 0 {
            let end = rest.iter().position(|byte| *byte == 0).ok_or_else(cut)?;
            rest = &rest[end + 1..];
        }
    }
    if flags & 2 != 0 {
        rest = rest.get(2..).ok_or_else(cut)?;
    }
    let bytes = inflated(&mut rest, most)?;
    let (crc, rest) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
    let (size, rest) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
    if u32::from_le_bytes(*size) != bytes.len() as u32 {
        return Err("its size is another than it says".to_owned());
    }
    if u32::from_le_bytes(*crc) != crc32(&bytes) {
        return Err("its check sum is another than it says".to_owned());
    }
    if !rest.is_empty() {
        return Err("it has several parts".to_owned());
    }
    Ok(bytes)
}

/// Inflates what `rest` begins with; then `rest` is what follows.
fn inflated(rest: &mut &[u8], most: usize) -> Result<Vec<u8>, String> {
    let mut state = InflateState::new_boxed(DataFormat::Raw);
    let mut some = vec![0; 1 << 16];
    let mut bytes = Vec::new();
    loop {
        let step = inflate(&mut state, rest, &mut some, MZFlush::None);
        *rest = &rest[step.bytes_consumed..];
        if step.bytes_written > most - bytes.len() {
            return Err(format!("all compressed files together have more than {MOST_INFLATED} bytes"));
        }
        bytes.extend_from_slice(&some[..step.bytes_written]);
        match step.status {
            Ok(MZStatus::StreamEnd) => return Ok(bytes),
            Ok(_) if step.bytes_consumed + step.bytes_written > 0 => {}
            _ => return Err("it cannot be inflated: it is damaged or cut off".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compressed by one block of deflate that is stored as it is.
    fn gzip(flags: u8, head: &[u8], text: &[u8]) -> Vec<u8> {
        let length = (text.len() as u16).to_le_bytes();
        let mut file = vec![0x1f, 0x8b, 8, flags, 0, 0, 0, 0, 0, 255];
        file.extend(head);
        file.extend([1, length[0], length[1], !length[0], !length[1]]);
        file.extend(text);
        file.extend(crc32(text).to_le_bytes());
        file.extend((text.len() as u32).to_le_bytes());
        file
    }

    #[test]
    fn files_are_inflated_whatever_their_head_holds() {
        for (flags, head) in [(0, &b""[..]), (8, b"a.ply\0"), (31, b"\x03\0abcname\0remark\0\0\0")] {
            assert_eq!(gunzip(&gzip(flags, head, b"some bytes"), 10).unwrap(), b"some bytes", "{flags}");
        }
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = gzip(8, b"a\0", b"some bytes");
        for length in 0..whole.len() {
            assert!(gunzip(&whole[..length], 99).is_err(), "{length}");
        }
        assert!(gunzip(b"ply\nformat ascii 1.0\n", 99).unwrap_err().contains("no file of gzip"));
        let mut longer = whole.clone();
        *longer.last_mut().unwrap() = 1;
        assert!(gunzip(&longer, 99).unwrap_err().contains("size"));
        let mut other = whole.clone();
        let at = other.len() - 9;
        other[at] ^= 1;
        assert!(gunzip(&other, 99).unwrap_err().contains("check sum"));
        let twice = [&whole[..], &whole].concat();
        assert!(gunzip(&twice, 99).unwrap_err().contains("several parts"));
        assert!(gunzip(&whole, 9).unwrap_err().contains("all compressed files"));
    }

    #[test]
    fn the_check_sum_is_that_of_gzip() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }
}
