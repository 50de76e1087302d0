//! Files that gzip has compressed.

use std::io::Read;

use flate2::bufread::MultiGzDecoder;

use super::Reading;
use super::spectrum::kind;

/// Most bytes of all compressed files of a scene, once they are inflated.
pub(super) const MOST_INFLATED: usize = 1 << 30;

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

/// What gzip compressed, perhaps in several pieces: at most `most` bytes, or an error.
fn gunzip(file: &[u8], most: usize) -> Result<Vec<u8>, String> {
    if !file.starts_with(&[0x1f, 0x8b]) {
        return Err("it is not a gzip file".to_owned());
    }
    let mut bytes = Vec::new();
    let read = MultiGzDecoder::new(file).take(most as u64 + 1).read_to_end(&mut bytes);
    if bytes.len() > most {
        return Err(format!("all compressed files together have more than {MOST_INFLATED} bytes"));
    }
    read.map_err(|error| format!("it cannot be inflated: {error}"))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;

    use super::*;

    const SCENE: &str = "WorldBegin\nTranslate 0 0 0\nShape \"sphere\" \"float radius\" 0.5\n\
        Translate 0 1 0\nShape \"sphere\" \"float radius\" 0.25\nTranslate 0 2 0\nShape \"sphere\" \"float radius\" 0.166667\n\
        Translate 0 3 0\nShape \"sphere\" \"float radius\" 0.125\n";

    /// The scene as `gzip.compress` of Python writes it.
    fn compressed() -> Vec<u8> {
        let text = "H4sIAAAAAAACAwvPL8pJcUpNz8zjCilKzCvOSSxJVTAAQa7gjMSCVAWl4oKM1KJUJQWltJz8xBKFosSUzNJiJQUDPVMUHYZE6DBC\
            1WJEhBZDMyAwR9FmTIw2oFUA5CLKHNsAAAA=";
        STANDARD.decode(text).unwrap()
    }

    #[test]
    fn files_of_several_parts_are_inflated_as_one() {
        let whole = compressed();
        assert_eq!(gunzip(&whole, SCENE.len()).unwrap(), SCENE.as_bytes());
        let twice = [&whole[..], &whole].concat();
        assert_eq!(gunzip(&twice, 2 * SCENE.len()).unwrap(), SCENE.repeat(2).as_bytes());
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = compressed();
        for length in 0..whole.len() {
            assert!(gunzip(&whole[..length], 999).is_err(), "{length}");
        }
        assert_eq!(gunzip(b"ply\nformat ascii 1.0\n", 99).unwrap_err(), "it is not a gzip file");
        // The size and the check sum stand at the end.
        for from_end in [1, 5] {
            let mut changed = whole.clone();
            changed[whole.len() - from_end] ^= 1;
            let why = gunzip(&changed, 999).unwrap_err();
            assert!(why.starts_with("it cannot be inflated: ") && why.contains("checksum"), "{why}");
        }
        let longer = [&whole[..], b"more"].concat();
        assert!(gunzip(&longer, 999).is_err());
        assert!(gunzip(&whole, SCENE.len() - 1).unwrap_err().contains("all compressed files"));
    }
}
