//! What is viewed: a scene that is rendered, or a picture from a file.

use std::path::PathBuf;
use std::time::SystemTime;

use etalon_picture::ExrFile;
use etalon_scene::Scene;
use etalon_transport::Study;
use serde_json::Value;

/// A scene that was read.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// The scene.
    pub scene: Scene,
    /// SHA-256, in hex, of its text and of all files that it refers to.
    pub sha256: String,
    /// What is odd in it and not an error, in sentences.
    pub warnings: Vec<String>,
    /// The files that it was read from, which are looked at for edits.
    pub files: Vec<PathBuf>,
    /// When reading began. A file that was changed since is read again.
    pub began: SystemTime,
}

/// Reads a scene anew. Problems are JSON objects with `message` and, where they are in a file, `file`, `line`, `column` and `json_path`.
pub type LoadScene = dyn Fn() -> Result<LoadedScene, Vec<Value>> + Send + Sync;

/// A scene that is rendered while it is viewed.
pub struct SceneSource {
    /// Its name, for the page.
    pub name: String,
    /// The scene as it was first read.
    pub first: LoadedScene,
    /// Reads it anew, after an edit.
    pub load: Box<LoadScene>,
    /// What to simulate otherwise than the scene calls for.
    pub study: Study,
    /// The relative error at which the picture is good enough, until a page says otherwise.
    pub error: f64,
    /// Threads that render; all cores if `None`.
    pub threads: Option<usize>,
}

/// What is viewed.
pub enum Source {
    /// A scene.
    Scene(Box<SceneSource>),
    /// A picture from an EXR file, of ours or of others.
    Picture {
        /// Its name, for the page.
        name: String,
        /// Its channels and attributes.
        file: Box<ExrFile>,
    },
}
