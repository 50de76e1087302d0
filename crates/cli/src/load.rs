//! Scene files from the disk.

use std::fmt::Write;
use std::path::Path;

use etalon_import::{Imported, Moment, import, is_model};
use etalon_scene::{FileUse, LoadError, Scene};
use miette::{Report, Severity, miette};
use sha2::{Digest, Sha256};

use crate::failure::Failure;
pub(crate) use crate::scene_report::scene_failure as refused_scene;
use crate::scene_report::{scene_failure, scene_warnings};

/// Most things that a model says and a scene cannot, shown by commands that render.
const MAX_NOTES: usize = 50;

/// A scene and the file it came from.
pub(crate) struct LoadedScene {
    /// The scene.
    pub scene: Scene,
    /// What is odd in the file and not an error.
    pub warnings: Vec<Report>,
    /// SHA-256 of the file's bytes and of those of all files that it refers to, in hex.
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
    if is_model(path) {
        return load_model(path, film_size);
    }
    let (name, text) = if is_standard_input(path) {
        let name = "standard input".to_owned();
        let text = etalon_scene::json::read_text(std::io::stdin().lock(), Path::new(&name)).map_err(refused)?;
        (name, text)
    } else {
        (path.display().to_string(), etalon_scene::json::load_text(path).map_err(refused)?)
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let loaded = etalon_scene::parse_in(&text, &name, Some(folder), film_size).map_err(scene_failure)?;
    let sha256 = scene_sha256(&text, &loaded.files);
    Ok(LoadedScene { scene: loaded.scene, warnings: scene_warnings(&name, &text, loaded.warnings), sha256 })
}

/// Whether a scene's name stands for standard input. Files that it refers to are then looked for where the program runs.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// A model as a scene, as it is at a moment, with a folder's name before the names of its files.
pub(crate) fn import_model(path: &Path, prefix: &str, moment: Option<&Moment>) -> Result<Imported, Failure> {
    import(path, prefix, moment).map_err(|error| Failure::input(miette!(code = "model", "{error}")))
}

/// A model rendered directly: what it does not say is added, what is not honoured listed, both as warnings.
fn load_model(path: &Path, film_size: Option<[u32; 2]>) -> Result<LoadedScene, Failure> {
    let imported = import_model(path, "", None)?;
    let name = format!("{} as a scene", path.display());
    let loaded = imported.parse(&name, film_size).map_err(scene_failure)?;
    let sha256 = scene_sha256(&imported.text, &loaded.files);
    let note = |code: &str, text: String| miette!(severity = Severity::Warning, code = code.to_owned(), "{text}");
    let mut warnings: Vec<Report> = imported.added.into_iter().map(|added| note("added", added)).collect();
    let more = imported.left_out.len().saturating_sub(MAX_NOTES);
    let left_out = imported.left_out.into_iter().take(MAX_NOTES);
    warnings.extend(left_out.map(|l| note("not-honoured", format!("{}: {}", l.place, l.what))));
    if more > 0 {
        warnings.push(note("not-honoured", format!("{more} more are not shown; `etalon import` lists them")));
    }
    warnings.extend(scene_warnings(&name, &imported.text, loaded.warnings));
    Ok(LoadedScene { scene: loaded.scene, warnings, sha256 })
}

/// The hash of a scene: that of its text, or, where it refers to files, that of the list of all hashes, a line each as
/// `sha256sum` prints them: first the text's, without a name, then the files' in the order in which they were read.
fn scene_sha256(text: &str, files: &[FileUse]) -> String {
    let of_text = sha256(text.as_bytes());
    if files.is_empty() {
        return of_text;
    }
    let list: String = files.iter().map(|file| format!("{}  {}\n", file.sha256, file.name)).collect();
    sha256(format!("{of_text}  \n{list}").as_bytes())
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
