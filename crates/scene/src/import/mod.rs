//! Models of other programs as scenes: glTF 2.0 (`.gltf`, `.glb`), OBJ with MTL, and PLY.
//!
//! [`import`] gives the text of a scene and the files that it names, so that what is rendered directly and what is written
//! for editing are the same. What a model says and a scene cannot is listed in [`Imported::left_out`], each with its place.

mod accessor;
mod gltf;
mod gltf_material;
mod obj;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use crate::mesh::{read_ply, write_ply};
use crate::model::Mesh;
use crate::vector::{dot, length, sub};

/// Largest file that is imported, bytes.
pub const MAX_IMPORT_BYTES: u64 = crate::files::MAX_FILE_BYTES;

/// A model as a scene.
#[derive(Clone, Debug, Default)]
pub struct Imported {
    /// The scene, as JSON.
    pub text: String,
    /// The files that it names.
    pub files: Vec<ImportedFile>,
    /// What the model says and the scene does not.
    pub left_out: Vec<LeftOut>,
    /// What the scene has that the model does not say: a camera, a light.
    pub added: Vec<String>,
}

/// A file of an imported scene.
#[derive(Clone, Debug)]
pub struct ImportedFile {
    /// Its name in the scene.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

/// Something that is not honoured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Where the model says it: a JSON path in glTF, the name of a material in MTL.
    pub place: String,
    /// What becomes of it, in a sentence without a full stop.
    pub what: String,
}

/// Why a model cannot be imported.
#[derive(Debug, thiserror::Error)]
#[error("{}: {message}", path.display())]
pub struct ImportError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong, with its place in the file.
    pub message: String,
}

/// Whether a file is imported, by its name, rather than read as a scene.
pub fn is_model(path: &Path) -> bool {
    matches!(extension(path).as_str(), "gltf" | "glb" | "obj" | "ply")
}

fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase()
}

/// Imports a model. `prefix` comes before the names of all files of the scene: the name of their folder and a slash, or
/// nothing.
///
/// # Errors
/// If the file, or one that it cannot be understood without, is missing or damaged.
pub fn import(path: &Path, prefix: &str) -> Result<Imported, ImportError> {
    let fail = |message: String| ImportError { path: path.to_owned(), message };
    let bytes = crate::files::read(path).map_err(|why| fail(format!("cannot be read: {why}")))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let near = |name: &str| crate::files::read(&folder.join(name));
    let kind = extension(path);
    import_bytes(&kind, &bytes, &near, prefix, &path.file_name().unwrap_or_default().to_string_lossy()).map_err(fail)
}

/// Imports a model of a kind (`glb`, `gltf`, `obj`, `ply`) from its bytes; `near` gives the bytes of a file by the name
/// that the model has for it.
///
/// # Errors
/// A sentence that says what is wrong, with its place.
pub fn import_bytes(
    kind: &str,
    bytes: &[u8],
    near: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    prefix: &str,
    source: &str,
) -> Result<Imported, String> {
    let mut builder = Builder { near, prefix: prefix.to_owned(), ..Builder::new(near) };
    match kind {
        "ply" => {
            let part = read_ply(bytes).map_err(|error| error.to_string())?;
            part.left_out.iter().for_each(|what| builder.leave_out("vertices and faces", what.clone()));
            builder.materials.insert("grey".to_owned(), json!({ "type": "lambert", "reflectance": 0.8 }));
            builder.add_mesh("mesh", part.mesh, &json!("grey"), None, Value::Null)?;
        }
        "obj" => obj::import(bytes, &mut builder)?,
        "gltf" | "glb" => gltf::import(bytes, &mut builder)?,
        other => return Err(format!("\"{other}\" is no kind of model that is imported")),
    }
    builder.finish(source)
}

/// A scene that is being made.
struct Builder<'a> {
    near: &'a dyn Fn(&str) -> Result<Vec<u8>, String>,
    prefix: String,
    materials: Map<String, Value>,
    objects: Vec<Value>,
    lights: Vec<Value>,
    camera: Option<Value>,
    film: Value,
    files: Vec<ImportedFile>,
    /// Names of files by what they were made from.
    known: HashMap<String, Option<String>>,
    left_out: Vec<LeftOut>,
    said: HashSet<(String, String)>,
    emits: bool,
    /// Of everything, in the world.
    bounds: Option<[[f64; 3]; 2]>,
}

impl<'a> Builder<'a> {
    fn new(near: &'a dyn Fn(&str) -> Result<Vec<u8>, String>) -> Self {
        Self {
            near,
            prefix: String::new(),
            materials: Map::new(),
            objects: Vec::new(),
            lights: Vec::new(),
            camera: None,
            film: json!({ "width": 1280, "height": 720 }),
            files: Vec::new(),
            known: HashMap::new(),
            left_out: Vec::new(),
            said: HashSet::new(),
            emits: false,
            bounds: None,
        }
    }

    fn leave_out(&mut self, place: impl Into<String>, what: impl Into<String>) {
        let (place, what) = (place.into(), what.into());
        if self.said.insert((place.clone(), what.clone())) {
            self.left_out.push(LeftOut { place, what });
        }
    }

    /// Adds a file, and gives the name that the scene has for it.
    fn add_file(&mut self, kind: &str, extension: &str, bytes: Vec<u8>) -> String {
        let name = format!("{}{kind}-{}.{extension}", self.prefix, self.files.len());
        self.files.push(ImportedFile { name: name.clone(), bytes });
        name
    }

    /// Adds a mesh as a file; `None`, and a note, if it has no triangles.
    fn mesh_file(&mut self, mesh: &Mesh) -> String {
        let mut bytes = Vec::with_capacity(40 * mesh.vertices.len() + 13 * mesh.triangles.len());
        // Writing to memory cannot fail.
        let _ = write_ply(mesh, &mut bytes);
        self.add_file("mesh", "ply", bytes)
    }

    /// Adds an object made of a mesh.
    fn add_mesh(
        &mut self,
        name: &str,
        mesh: Mesh,
        material: &Value,
        emission: Option<Value>,
        transform: Value,
    ) -> Result<(), String> {
        let file = self.mesh_file(&mesh);
        self.add_object(name, &file, &mesh, material, emission, &transform);
        Ok(())
    }

    /// Adds an object whose mesh is a file that has been added. `transform` is a list of the format, or null.
    fn add_object(
        &mut self,
        name: &str,
        file: &str,
        mesh: &Mesh,
        material: &Value,
        emission: Option<Value>,
        transform: &Value,
    ) {
        let mut object = json!({ "name": name, "shape": { "type": "mesh", "file": file }, "material": material });
        if let Some(emission) = emission {
            object["emission"] = emission;
            self.emits = true;
        }
        let rows = transform[0]["matrix"].as_array().map(|rows| {
            rows.iter().map(|row| std::array::from_fn(|i| row[i].as_f64().unwrap_or(0.0))).collect::<Vec<[f64; 4]>>()
        });
        if !transform.is_null() {
            object["transform"] = transform.clone();
        }
        for v in &mesh.vertices {
            let p: [f64; 3] = match &rows {
                Some(rows) => std::array::from_fn(|i| dot([rows[i][0], rows[i][1], rows[i][2]], *v) + rows[i][3]),
                None => *v,
            };
            let [low, high] = self.bounds.get_or_insert([p, p]);
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        self.objects.push(object);
    }

    /// A name for a material that none has yet.
    fn material_name(&self, wanted: &str) -> String {
        let base = if wanted.is_empty() { "material" } else { wanted };
        let mut name = base.to_owned();
        let mut number = 2;
        while self.materials.contains_key(&name) {
            name = format!("{base} {number}");
            number += 1;
        }
        name
    }

    /// The scene, with a camera and a light if the model has none.
    fn finish(mut self, source: &str) -> Result<Imported, String> {
        let Some([low, high]) = self.bounds else { return Err("it has no triangles".to_owned()) };
        let mut added = Vec::new();
        let camera = self.camera.take().unwrap_or_else(|| {
            let center: [f64; 3] = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
            // So far that the ball around the bounds fits into the height of the picture.
            let radius = (0.5 * length(sub(high, low))).max(f64::MIN_POSITIVE);
            let fov_deg = 35.0_f64;
            let distance = 1.02 * radius / (0.5 * fov_deg).to_radians().sin();
            let from = [0.45, 0.3, 1.0];
            let position: [f64; 3] = std::array::from_fn(|k| center[k] + distance * from[k] / length(from));
            added.push(format!("the model has no camera: one is added that looks at all of it, from {distance:.3} m"));
            json!({
                "type": "perspective", "position_m": position, "look_at_m": center, "vertical_fov_deg": fov_deg
            })
        });
        if self.lights.is_empty() && !self.emits {
            added.push("the model has no light: an even white sky is added".to_owned());
            self.lights.push(json!({
                "name": "sky", "type": "environment",
                "radiance": { "type": "illuminant", "name": "D65", "scale": 1 }
            }));
        }
        let comment: Vec<String> = std::iter::once(format!("Imported from {source}."))
            .chain(added.iter().cloned())
            .chain(self.left_out.iter().map(|l| format!("not honoured: {}: {}", l.place, l.what)))
            .collect();
        let scene = json!({
            "etalon": 1, "comment": comment, "camera": camera, "film": self.film, "materials": self.materials,
            "objects": self.objects, "lights": self.lights,
        });
        let text = format!("{scene:#}\n");
        Ok(Imported { text, files: self.files, left_out: self.left_out, added })
    }
}

/// A colour as a reflectance of the format: a number if it is grey. Channels are brought into [0, 1].
fn reflectance(rgb: [f64; 3]) -> Value {
    let rgb = rgb.map(|v| v.clamp(0.0, 1.0));
    if rgb[0] == rgb[1] && rgb[1] == rgb[2] { json!(rgb[0]) } else { json!({ "type": "rgb", "rgb": rgb }) }
}

/// A colour as light of the format: (1, 1, 1) at scale 1 has the luminance of the constant spectrum 1.
fn light(rgb: [f64; 3], scale: f64) -> Value {
    json!({ "type": "rgb", "rgb": rgb, "scale": scale })
}
