//! Scenes from files, texts and models.

use std::path::PathBuf;

use etalon::NamedFile;
use etalon::scene_model::MOST_REPLICATES;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::{Value, json};

use crate::errors::{of_prepare, of_scene, problem, setting};
use crate::renderer::Renderer;

/// A scene that has no errors.
#[pyclass(frozen, module = "etalon._etalon")]
pub(crate) struct Scene {
    scene: etalon::Scene,
}

/// Reads a scene file, or a model or scene of another program.
#[pyfunction]
#[pyo3(signature = (path, size))]
pub(crate) fn load(py: Python<'_>, path: PathBuf, size: Option<[u32; 2]>) -> PyResult<Scene> {
    let scene = py.detach(|| etalon::Scene::load_sized(&path, size));
    scene.map(|scene| Scene { scene }).map_err(|error| of_scene(py, &path.display().to_string(), &error))
}

/// Reads the text of a scene file. Names of files are relative to `folder`.
#[pyfunction]
#[pyo3(signature = (text, name, folder, size))]
pub(crate) fn parse(
    py: Python<'_>,
    text: String,
    name: String,
    folder: PathBuf,
    size: Option<[u32; 2]>,
) -> PyResult<Scene> {
    let scene = py.detach(|| etalon::Scene::parse_in(text, name.clone(), Some(&folder), size));
    scene.map(|scene| Scene { scene }).map_err(|error| of_scene(py, &name, &error))
}

/// Reads the text of a scene file whose files are in memory.
#[pyfunction]
#[pyo3(signature = (text, name, files, size))]
pub(crate) fn parse_with_files(
    py: Python<'_>,
    text: String,
    name: String,
    files: Vec<(String, Bound<'_, PyBytes>)>,
    size: Option<[u32; 2]>,
) -> PyResult<Scene> {
    let named = |(name, bytes): (String, Bound<'_, PyBytes>)| NamedFile { name, bytes: bytes.as_bytes().to_vec() };
    let files: Vec<NamedFile> = files.into_iter().map(named).collect();
    let scene = py.detach(|| etalon::Scene::parse_with_files(text, name.clone(), &files, size));
    scene.map(|scene| Scene { scene }).map_err(|error| of_scene(py, &name, &error))
}

/// The JSON Schema of scene files, as JSON.
#[pyfunction]
pub(crate) fn schema() -> String {
    etalon::scene_model::schema().to_string()
}

#[pymethods]
impl Scene {
    /// Width and height of the film, pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.scene.model.film.width, self.scene.model.film.height)
    }

    /// SHA-256 of the text and of all files that it refers to.
    #[getter]
    fn sha256(&self) -> &str {
        &self.scene.sha256
    }

    /// The name in messages.
    #[getter]
    fn name(&self) -> &str {
        &self.scene.file_name
    }

    /// The scene as the text of a scene file.
    #[getter]
    fn text(&self) -> &str {
        &self.scene.text
    }

    /// What is odd, what was added and what was left out, as JSON.
    fn notes(&self) -> String {
        let scene = &self.scene;
        let left_out: Vec<Value> =
            scene.left_out.iter().map(|left| json!({ "place": left.place, "what": left.what })).collect();
        json!({
            "warnings": scene.warnings.iter().map(problem).collect::<Vec<Value>>(),
            "added": scene.added,
            "left_out": left_out,
        })
        .to_string()
    }

    /// Makes the scene ready to be rendered, with some settings changed.
    #[pyo3(signature = (*, bands, seed, max_depth, replicates, polarised))]
    fn prepare(
        &self,
        py: Python<'_>,
        bands: Option<[f64; 3]>,
        seed: Option<u64>,
        max_depth: Option<u32>,
        replicates: Option<u32>,
        polarised: bool,
    ) -> PyResult<Renderer> {
        let mut scene = self.scene.clone();
        if let Some(bands) = bands {
            scene.keep_bands(bands).map_err(|error| setting(py, format!("the bands: {error}")))?;
        }
        let integrator = &mut scene.model.integrator;
        integrator.seed = seed.unwrap_or(integrator.seed);
        if let Some(depth) = max_depth {
            if depth == 0 {
                return Err(setting(py, "a path has one edge at least: max_depth is 0"));
            }
            integrator.max_depth = Some(depth);
        }
        if let Some(replicates) = replicates {
            if !(1..=MOST_REPLICATES).contains(&replicates) {
                return Err(setting(py, format!("replicates is {replicates}; it must be from 1 to {MOST_REPLICATES}")));
            }
            integrator.replicates = replicates;
        }
        let study = etalon::Study { polarised, ..etalon::Study::default() };
        let renderer = py.detach(|| scene.prepare_study(&study));
        renderer.map(Renderer::new).map_err(|error| of_prepare(py, &scene.file_name, &error))
    }
}
