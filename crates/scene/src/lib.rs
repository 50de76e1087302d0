//! The JSON scene description: inert, validated data.
//!
//! [`parse`] and [`load`] turn a scene file into a [`Scene`], or into every error of the file at once
//! ([`SceneErrors`]), each with its JSON path, line, column and a hint. [`schema`] is the JSON Schema of such files, made
//! from the same declarations as the reader. The format is described in `docs/scene-format.md`.
//!
//! ```
//! let (scene, warnings) = etalon_scene::parse(r#"{
//!     "etalon": 1,
//!     "camera": { "type": "perspective", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40 },
//!     "film": { "width": 64, "height": 64 },
//!     "objects": [{ "shape": { "type": "sphere", "radius_m": 1 }, "material": { "type": "lambert", "reflectance": 0.5 } }],
//!     "lights": [{ "type": "environment", "radiance": 1 }]
//! }"#, "ball.json")?;
//! assert_eq!(scene.objects.len(), 1);
//! assert!(warnings.is_empty());
//!
//! // A word that is no key is an error with its place, and a hint where one is near.
//! let errors = etalon_scene::parse(r#"{ "etalon": 1, "camra": {} }"#, "typo.json").unwrap_err();
//! assert!(errors.errors().any(|problem| problem.message.contains("camra") && problem.line == 1));
//! # Ok::<(), etalon_scene::SceneErrors>(())
//! ```
//!
//! | for | see |
//! |---|---|
//! | reading a file, a text, or a text with its files in memory | [`load`], [`parse`], [`parse_with_files`] |
//! | what a scene holds | [`Scene`] and [`model`] |
//! | what is wrong, and where | [`Problem`], [`SceneErrors`] |
//! | completion and checks in an editor | [`schema`] |
//! | meshes and textures in files | [`mesh`], [`ImageTexture`] |
//! | transforms beyond those of glam | [`linear`] |
//! | the reader alone, for any other JSON format | [`json`] |
//! | models of other programs (glTF, OBJ, Mitsuba, pbrt) | the crate `etalon-import` |
//!
//! The example `check` prints what is in a scene file, or everything that is wrong with it.

mod files;
mod format;
mod grid;
pub mod json;
pub mod linear;
mod luminaire;
mod measured;
pub mod mesh;
pub mod model;
mod problem;
mod texture;

use std::path::Path;

pub use files::{FileUse, MAX_FILE_BYTES, NamedFile, read_file};
pub use format::{MOST_BLEND_PARTS, MOST_WIDTHS};
pub use luminaire::Photometry;
pub use measured::{
    MeasuredArray, MeasuredArrays, MeasuredBrdf, MeasuredSurface, Slices, Symmetry, Table, Warp, read_measured,
};
pub use model::*;
pub use problem::{Code, LoadError, Problem, Related, SceneErrors, Severity, Span, shortened};
pub use texture::{
    Channel, Encoding, Image, ImageTexture, MAX_IMAGE_BYTES, MAX_IMAGE_SIDE, Texels, TextureFilter, UvMap, Wrap,
};

/// The JSON Schema (2020-12) of scene files.
///
/// Editors use it to complete and check scenes. What it cannot say (names that refer to each other, physical ranges of
/// tables, degenerate shapes, keys that exclude each other) [`parse`] checks.
pub fn schema() -> serde_json::Value {
    json::document_schema::<format::SceneForm>("Etalon scene")
}

/// Reads a scene from the text of a file; `file_name` is for messages. The scene comes with the warnings.
///
/// # Errors
/// Every error of the text at once, and its warnings.
pub fn parse(text: &str, file_name: &str) -> Result<(Scene, Vec<Problem>), SceneErrors> {
    parse_with_size(text, file_name, None)
}

/// As [`parse`], with a film of another width and height, in pixels, than the file says.
///
/// Changing [`Film`] afterwards is not the same: a camera whose horizontal angle of view, or whose sensor's width, the
/// file states keeps that, and its vertical one follows the shape of the picture.
///
/// # Errors
/// As [`parse`].
pub fn parse_with_size(
    text: &str,
    file_name: &str,
    size: Option<[u32; 2]>,
) -> Result<(Scene, Vec<Problem>), SceneErrors> {
    parse_in(text, file_name, None, size).map(|loaded| (loaded.scene, loaded.warnings))
}

/// A scene, and what it was made from.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// What is odd and not an error.
    pub warnings: Vec<Problem>,
    /// The files that the scene refers to, in the order in which they were first read.
    pub files: Vec<FileUse>,
}

/// As [`parse_with_size`], with the folder to which names of files are relative; without one, a scene that refers to
/// files is refused.
///
/// # Errors
/// As [`parse`].
pub fn parse_in(
    text: &str,
    file_name: &str,
    folder: Option<&Path>,
    size: Option<[u32; 2]>,
) -> Result<Loaded, SceneErrors> {
    read_scene(text, file_name, files::Files::new(folder), size)
}

/// As [`parse_with_size`], with the files that the scene refers to in memory, each at most [`MAX_FILE_BYTES`] long. No file is read
/// from the disk. Files that the scene does not refer to are ignored.
///
/// # Errors
/// As [`parse`]; also if the scene refers to a file that is not among `files`, or is too long.
pub fn parse_with_files(
    text: &str,
    file_name: &str,
    files: &[NamedFile],
    size: Option<[u32; 2]>,
) -> Result<Loaded, SceneErrors> {
    read_scene(text, file_name, files::Files::given(files), size)
}

fn read_scene(
    text: &str,
    file_name: &str,
    mut files: files::Files<'_>,
    size: Option<[u32; 2]>,
) -> Result<Loaded, SceneErrors> {
    let read =
        json::read(text, file_name, |form: format::SceneForm, reader| format::scene(&form, size, &mut files, reader));
    read.map(|(scene, warnings)| Loaded { scene, warnings, files: files.used() })
}

/// Reads a scene file. The scene comes with the warnings.
///
/// # Errors
/// [`LoadError::Io`] if the file cannot be read, else as [`parse`].
pub fn load(path: impl AsRef<Path>) -> Result<(Scene, Vec<Problem>), LoadError> {
    let path = path.as_ref();
    let text = json::load_text(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let loaded = parse_in(&text, &path.display().to_string(), Some(folder), None)?;
    Ok((loaded.scene, loaded.warnings))
}
