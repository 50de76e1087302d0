//! Scenes from files, texts and models.

use std::fmt::Write;
use std::path::Path;

use etalon_import::{ImportError, LeftOut, Options, import, is_model};
use etalon_scene::{Bands, BandsError, FileUse, LoadError, Loaded, NamedFile, Problem, SceneErrors};
use etalon_transport::{PrepareError, Study, prepare_study};
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::renderer::Renderer;

/// A scene, and what was noticed while it was read.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The scene as validated data. It may be changed before [`Scene::prepare`], for instance its seed.
    ///
    /// The size of the film is better given when the scene is read ([`Scene::load_sized`]): a stated horizontal angle of view
    /// then stays what it is.
    pub model: etalon_scene::Scene,
    /// What is odd in the scene and not an error.
    pub warnings: Vec<Problem>,
    /// What a scene has that its model does not say, such as a camera or a light. Empty for scene files.
    pub added: Vec<String>,
    /// What a model says and its scene does not. Empty for scene files.
    pub left_out: Vec<LeftOut>,
    /// The name of the scene in messages.
    pub file_name: String,
    /// The scene as JSON.
    pub text: String,
    /// SHA-256, in hex, of the text and of all files that it refers to.
    pub sha256: String,
    /// Names of the files that the scene refers to, as it writes them, in the order in which they were read.
    pub files: Vec<String>,
}

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read, or the scene in it has errors: all of them, each with line, column and JSON path.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The model cannot be imported.
    #[error(transparent)]
    Import(#[from] ImportError),
}

impl From<SceneErrors> for SceneError {
    fn from(errors: SceneErrors) -> Self {
        Self::Load(errors.into())
    }
}

impl Scene {
    /// Reads a scene file (`.json`), or a model or scene of another program: glTF 2.0, OBJ, PLY, Mitsuba 3 (`.xml`), pbrt-v4.
    ///
    /// # Errors
    /// If the file or one that it refers to cannot be read, and if the scene is not valid.
    ///
    /// ```
    /// let scene = etalon::Scene::load("../../scenes/cornell.json")?;
    /// assert_eq!(scene.model.film.width, 512);
    /// assert!(scene.warnings.is_empty());
    ///
    /// let error = etalon::Scene::load("nowhere.json").unwrap_err();
    /// assert!(error.to_string().contains("nowhere.json"));
    /// # Ok::<(), etalon::SceneError>(())
    /// ```
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_sized(path, None)
    }

    /// As [`Scene::load`], with a film of another width and height, in pixels, if they are given.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load_sized(path: impl AsRef<Path>, size: Option<[u32; 2]>) -> Result<Self, SceneError> {
        Self::load_with(path, size, &Options::default())
    }

    /// As [`Scene::load_sized`], with what a model is asked for: a moment of its animation, parameters, a variant. A scene file has none of
    /// these.
    ///
    /// # Errors
    /// As [`Scene::load`]; also if the file knows nothing of what is asked for.
    pub fn load_with(path: impl AsRef<Path>, size: Option<[u32; 2]>, options: &Options) -> Result<Self, SceneError> {
        let path = path.as_ref();
        if !is_model(path) && *options != Options::default() {
            let message =
                "it is a scene file: it has no animations and variants of glTF and no parameters of Mitsuba".to_owned();
            return Err(ImportError { path: path.to_owned(), message }.into());
        }
        if is_model(path) {
            let imported = import(path, "", options)?;
            let name = format!("{} as a scene", path.display());
            let loaded = imported.parse(&name, size)?;
            let mut scene = Self::new(loaded, name, imported.text);
            (scene.added, scene.left_out) = (imported.added, imported.left_out);
            return Ok(scene);
        }
        let text = etalon_scene::json::load_text(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse_in(text, path.display().to_string(), Some(folder), size)
    }

    /// Reads a scene from the text of a scene file; `file_name` is for messages.
    ///
    /// # Errors
    /// Every error of the text at once. A scene that refers to files is an error: see [`Scene::parse_in`].
    pub fn parse(text: impl Into<String>, file_name: impl Into<String>) -> Result<Self, SceneError> {
        Self::parse_in(text, file_name, None, None)
    }

    /// As [`Scene::parse`], with the folder to which names of files are relative, and with another width and height of the film,
    /// in pixels, if they are given.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse_in(
        text: impl Into<String>,
        file_name: impl Into<String>,
        folder: Option<&Path>,
        size: Option<[u32; 2]>,
    ) -> Result<Self, SceneError> {
        let (text, name) = (text.into(), file_name.into());
        let loaded = etalon_scene::parse_in(&text, &name, folder, size)?;
        Ok(Self::new(loaded, name, text))
    }

    /// As [`Scene::parse`], with the files that the scene refers to in memory, each at most 4 GiB, and with another width and height of
    /// the film, in pixels, if they are given. No file is read from the disk.
    ///
    /// # Errors
    /// As [`Scene::parse`]; also if the scene refers to a file that is not among `files`, or is too large.
    pub fn parse_with_files(
        text: impl Into<String>,
        file_name: impl Into<String>,
        files: &[NamedFile],
        size: Option<[u32; 2]>,
    ) -> Result<Self, SceneError> {
        let (text, name) = (text.into(), file_name.into());
        let loaded = etalon_scene::parse_with_files(&text, &name, files, size)?;
        Ok(Self::new(loaded, name, text))
    }

    /// Reads a scene from a JSON value, as [`Scene::parse`] does from a text.
    ///
    /// # Errors
    /// As [`Scene::parse`]. Lines and columns are those of the value printed with indentation.
    pub fn from_value(value: &Value) -> Result<Self, SceneError> {
        Self::parse(format!("{value:#}"), "the scene")
    }

    fn new(loaded: Loaded, file_name: String, text: String) -> Self {
        let sha256 = scene_sha256(&text, &loaded.files);
        let Loaded { scene: model, warnings, files } = loaded;
        let files = files.into_iter().map(|file| file.name).collect();
        Self { model, warnings, added: Vec::new(), left_out: Vec::new(), file_name, text, sha256, files }
    }

    /// Keeps bands of wavelengths beside the colour: the centres of the first and of the last band and the step between centres, nm.
    /// Each band is as wide as the step.
    ///
    /// # Errors
    /// If the last centre is not a whole number of steps from the first, and if wavelengths of a band are not rendered.
    pub fn keep_bands(&mut self, first_last_step_nm: [f64; 3]) -> Result<(), BandsError> {
        let range_nm = self.model.integrator.wavelength_range_nm;
        self.model.film.bands = Some(Bands::new(first_last_step_nm, range_nm)?);
        Ok(())
    }

    /// Makes everything ready that a render needs: the tree of the geometry, the tables of lights, the plan.
    ///
    /// # Errors
    /// If a shape cannot be intersected, or an object does not bound the solid that its material needs.
    pub fn prepare(&self) -> Result<Renderer, PrepareError> {
        self.prepare_study(&Study::default())
    }

    /// As [`Scene::prepare`], with effects forced on or left out, for study. A picture without an effect says so in its file.
    ///
    /// # Errors
    /// As [`Scene::prepare`], and if the study makes no sense.
    pub fn prepare_study(&self, study: &Study) -> Result<Renderer, PrepareError> {
        Ok(Renderer::new(prepare_study(&self.model, study)?, self.sha256.clone()))
    }
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
