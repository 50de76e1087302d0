//! Scene files from the disk.

use std::fmt::Write;
use std::path::Path;

use etalon_scene::{LoadError, Scene};
use miette::Report;
use sha2::{Digest, Sha256};

use crate::failure::Failure;
use crate::scene_report::{scene_failure, scene_warnings};

/// A scene and the file it came from.
pub(crate) struct LoadedScene {
    /// The scene.
    pub scene: Scene,
    /// What is odd in the file and not an error.
    pub warnings: Vec<Report>,
    /// SHA-256 of the file's bytes, in hex.
    pub sha256: String,
}

/// Reads a scene. A file that cannot be read is bad input as much as one that makes no sense. `film_size`, if given, stands
/// for the file's width and height in pixels, so that a stated horizontal field of view stays what it says.
pub(crate) fn load(path: &Path, film_size: Option<[u32; 2]>) -> Result<LoadedScene, Failure> {
    let refused = |error| match error {
        LoadError::Io { path, source } => {
            Failure::input(Report::from_err(source).wrap_err(format!("cannot read the scene `{}`", path.display())))
        }
        LoadError::Invalid(errors) => scene_failure(errors),
    };
    let name = path.display().to_string();
    let text = etalon_scene::json::load_text(path).map_err(refused)?;
    let (scene, warnings) = etalon_scene::parse_with_size(&text, &name, film_size).map_err(scene_failure)?;
    let sha256 = sha256(text.as_bytes());
    Ok(LoadedScene { scene, warnings: scene_warnings(&name, text, warnings), sha256 })
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_hash_is_the_published_one_of_abc() {
        // FIPS 180-2, appendix B.1.
        let published = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(super::sha256(b"abc"), published);
    }
}
