//! Scene files from the disk.

use std::path::Path;

use etalon::{LoadError, Scene, SceneError};
use etalon_import::{Imported, Options, import};
use miette::{Report, Severity, miette};

use crate::failure::Failure;
pub(crate) use crate::scene_report::scene_failure as refused_scene;
use crate::scene_report::{scene_failure, scene_warnings};

/// Most things that are not converted exactly, shown by commands that render.
const MAX_NOTES: usize = 50;

/// A scene and the file it came from.
pub(crate) struct LoadedScene {
    /// The scene.
    pub scene: etalon_scene::Scene,
    /// What is odd in the file and not an error.
    pub warnings: Vec<Report>,
    /// SHA-256 of the file's bytes and of those of all files that it refers to, in hex.
    pub sha256: String,
    /// Names of the files that it refers to, as it writes them.
    pub files: Vec<String>,
}

/// Reads a scene. A file that cannot be read is bad input as much as one that makes no sense. `film_size`, if given, stands
/// for the file's width and height in pixels, so that a stated horizontal field of view stays what it says.
///
/// `parameters` are those of a scene of Mitsuba.
pub(crate) fn load(
    path: &Path,
    film_size: Option<[u32; 2]>,
    parameters: &[(String, String)],
) -> Result<LoadedScene, Failure> {
    let scene = if is_standard_input(path) {
        let name = "standard input";
        etalon_scene::json::read_text(std::io::stdin().lock(), Path::new(name))
            .map_err(SceneError::from)
            .and_then(|text| Scene::parse_in(text, name, Some(Path::new("")), film_size))
    } else {
        Scene::load_with(path, film_size, &Options { parameters: parameters.to_vec(), ..Options::default() })
    };
    let Scene { model, warnings: problems, added, left_out, file_name, text, sha256, files } =
        scene.map_err(refused)?;
    // What a model does not say is added, what is not converted is listed, both as warnings.
    let note = |code: &str, text: String| miette!(severity = Severity::Warning, code = code.to_owned(), "{text}");
    let mut warnings: Vec<Report> = added.into_iter().map(|added| note("added", added)).collect();
    let more = left_out.len().saturating_sub(MAX_NOTES);
    let left_out = left_out.into_iter().take(MAX_NOTES);
    warnings.extend(left_out.map(|l| note("not-converted", format!("{}: {}", l.place, l.what))));
    if more > 0 {
        warnings.push(note("not-converted", format!("{more} more are not shown; `etalon import` lists them")));
    }
    warnings.extend(scene_warnings(&file_name, &text, problems));
    Ok(LoadedScene { scene: model, warnings, sha256, files })
}

/// Why there is no scene.
fn refused(error: SceneError) -> Failure {
    match error {
        SceneError::Load(LoadError::Io { path, source }) => {
            Failure::input(Report::from_err(source).wrap_err(format!("cannot read the scene `{}`", path.display())))
        }
        SceneError::Load(LoadError::Invalid(errors)) => scene_failure(errors),
        SceneError::Import(error) => Failure::input(miette!(code = "model", "{error}")),
    }
}

/// Whether a scene's name stands for standard input. Files that it refers to are then looked for where the program runs.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// A model as a scene, with a folder's name before the names of its files.
pub(crate) fn import_model(path: &Path, prefix: &str, options: &Options) -> Result<Imported, Failure> {
    import(path, prefix, options).map_err(|error| refused(error.into()))
}
