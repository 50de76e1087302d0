//! Scenes built in code, part by part.

use std::path::Path;

use etalon_scene::NamedFile;
use serde_json::{Map, Value, json};

use crate::scene::{Scene, SceneError};

/// A scene that is built part by part. The parts are JSON values in the words of the scene format (`docs/scene-format.md`), so
/// whatever a file can say, a program can build; [`SceneBuilder::to_json`] is the scene as a file.
///
/// Nothing is checked before [`SceneBuilder::build`], which reports every mistake at once.
///
/// ```
/// use etalon::json;
///
/// let scene = etalon::SceneBuilder::new()
///     .camera(json!({ "type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40 }))
///     .film(64, 48)
///     .material("clay", json!({ "type": "lambert", "reflectance": 0.6 }))
///     .object(json!({ "name": "ball", "shape": { "type": "sphere", "radius_m": 1 }, "material": "clay" }))
///     .light(json!({ "type": "environment", "radiance": 1 }))
///     .build()?;
/// assert_eq!(scene.model.objects[0].name, "ball");
///
/// let mistaken = etalon::SceneBuilder::new().film(0, 48).light(json!({ "type": "enviroment" }));
/// let message = mistaken.build().unwrap_err().to_string();
/// assert!(message.contains("errors"), "{message}");
/// # Ok::<(), etalon::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    document: Map<String, Value>,
    files: Vec<NamedFile>,
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl SceneBuilder {
    /// A scene without anything.
    pub fn new() -> Self {
        let document = Map::from_iter([("etalon".to_owned(), json!(1))]);
        Self { document, files: Vec::new() }
    }

    /// The camera.
    pub fn camera(self, camera: Value) -> Self {
        self.set("camera", camera)
    }

    /// A film of this width and height, in pixels.
    pub fn film(self, width: u32, height: u32) -> Self {
        self.film_with(json!({ "width": width, "height": height }))
    }

    /// The film with all that it can say: size, filter, bands.
    pub fn film_with(self, film: Value) -> Self {
        self.set("film", film)
    }

    /// Settings of the render: samples a pixel, depth, seed.
    pub fn integrator(self, integrator: Value) -> Self {
        self.set("integrator", integrator)
    }

    /// A spectrum with a name. A second one of the same name replaces the first.
    pub fn spectrum(self, name: &str, spectrum: Value) -> Self {
        self.name("spectra", name, spectrum)
    }

    /// A material with a name. A second one of the same name replaces the first.
    pub fn material(self, name: &str, material: Value) -> Self {
        self.name("materials", name, material)
    }

    /// A group of objects with a name, which instances place. A second one of the same name replaces the first.
    pub fn group(self, name: &str, group: Value) -> Self {
        self.name("groups", name, group)
    }

    /// One more object.
    pub fn object(self, object: Value) -> Self {
        self.add("objects", object)
    }

    /// One more instance of a group.
    pub fn instance(self, instance: Value) -> Self {
        self.add("instances", instance)
    }

    /// One more light without a surface.
    pub fn light(self, light: Value) -> Self {
        self.add("lights", light)
    }

    /// A file that the scene refers to, in memory: a mesh (PLY, OBJ) or an image. With it, no file is read from the disk.
    pub fn file(mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.push(NamedFile { name: name.into(), bytes: bytes.into() });
        self
    }

    /// The scene as the text of a scene file.
    pub fn to_json(&self) -> String {
        format!("{:#}", Value::Object(self.document.clone()))
    }

    /// Reads the scene. It refers to no files, or to those of [`SceneBuilder::file`].
    ///
    /// # Errors
    /// Every error of the scene at once, with its JSON path and a line of [`SceneBuilder::to_json`].
    pub fn build(&self) -> Result<Scene, SceneError> {
        if self.files.is_empty() {
            return Scene::parse(self.to_json(), NAME);
        }
        Scene::parse_with_files(self.to_json(), NAME, &self.files, None)
    }

    /// Reads the scene, with names of files relative to a folder.
    ///
    /// # Errors
    /// As [`SceneBuilder::build`]; also if a file cannot be read.
    pub fn build_in(&self, folder: impl AsRef<Path>) -> Result<Scene, SceneError> {
        Scene::parse_in(self.to_json(), NAME, Some(folder.as_ref()), None)
    }

    fn set(mut self, key: &str, value: Value) -> Self {
        self.document.insert(key.to_owned(), value);
        self
    }

    fn name(mut self, key: &str, name: &str, value: Value) -> Self {
        let named = self.document.entry(key).or_insert_with(|| json!({}));
        named.as_object_mut().expect("only this function makes it").insert(name.to_owned(), value);
        self
    }

    fn add(mut self, key: &str, value: Value) -> Self {
        let list = self.document.entry(key).or_insert_with(|| json!([]));
        list.as_array_mut().expect("only this function makes it").push(value);
        self
    }
}

/// What messages call a scene that is in no file.
const NAME: &str = "the scene";
