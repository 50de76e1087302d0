//! Models and scenes of other programs as scenes of Etalon: glTF 2.0 (`.gltf`, `.glb`), OBJ with MTL, PLY, Mitsuba 3 (`.xml`) and
//! pbrt-v4 (`.pbrt`).
//!
//! An import makes the text of a scene file and the mesh and image files that it names. `etalon render` reads that text, and
//! `etalon import` writes it for editing, so both show the same scene. The crate `etalon-scene` reads the text and does not know this
//! crate.
//!
//! ```
//! let sphere = br#"
//!     LookAt 0 0 5  0 0 0  0 1 0
//!     Camera "perspective" "float fov" 40
//!     WorldBegin
//!     LightSource "infinite" "rgb L" [1 1 1]
//!     Shape "sphere" "float radius" 2
//! "#;
//! let no_files = |name: &str| Err(format!("there is no {name}"));
//! let imported = etalon_import::import_bytes("pbrt", sphere, &no_files, "", "sphere.pbrt")?;
//! assert!(imported.left_out.is_empty());
//! let scene = imported.parse("sphere", None).map_err(|errors| errors.summary())?.scene;
//! assert_eq!(scene.objects.len(), 1);
//! # Ok::<(), String>(())
//! ```
//!
//! | item | what it does |
//! |---|---|
//! | [`import`] | imports a file from the disk |
//! | [`import_bytes`], [`import_bytes_with`] | import bytes in memory, the latter with [`Options`]: a moment, parameters, a variant |
//! | [`Imported::parse`] | the imported scene as an [`etalon_scene::Scene`] |
//! | [`Imported::left_out`] | each thing that the model says and the scene does not, or not exactly, with its place in the file |
//! | [`Imported::taken_over`] | how much the scene has of the model |
//!
//! The example `convert` writes the scene of a model to a folder.
//!
//! Each format has its module. All of them fill one `Builder`, which writes the scene's JSON, and spend from one `Budget`, which bounds
//! what a small file can ask for.

mod budget;
mod builder;
mod checker;
mod gltf;
mod matrix;
mod medium;
mod metals;
mod missing;
mod mitsuba;
mod number;
mod obj;
mod pbrt;
mod relief;
mod round;
mod sides;
mod table;
mod translucent;
mod uv;
mod vertex_colours;
mod winding;

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use etalon_scene::mesh::read_ply;
use etalon_scene::{Loaded, NamedFile, SceneErrors, read_file, shortened};
use serde_json::{Map, Value, json};

use builder::{Builder, Outside, Placed};

/// A model as a scene.
#[derive(Clone, Debug, Default)]
pub struct Imported {
    /// The scene, as JSON.
    pub text: String,
    /// The files that it names.
    pub files: Vec<NamedFile>,
    /// What the scene has of the model.
    pub taken_over: TakenOver,
    /// What the model says and the scene does not, or not exactly: at most 1000 things, and a last one that counts the rest.
    pub left_out: Vec<LeftOut>,
    /// What the scene has that the model does not say: a camera, a light.
    pub added: Vec<String>,
}

impl Imported {
    /// Reads the scene, with a film of another width and height, in pixels, if they are given. `file_name` is for messages.
    ///
    /// # Errors
    /// Every error of the scene at once: what the model says may make no sense.
    pub fn parse(&self, file_name: &str, size: Option<[u32; 2]>) -> Result<Loaded, SceneErrors> {
        etalon_scene::parse_with_files(&self.text, file_name, &self.files, size)
    }
}

/// How many things of each kind a scene has of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TakenOver {
    /// Objects, those of groups once.
    pub objects: usize,
    /// Placements of groups.
    pub instances: usize,
    /// Materials with a name.
    pub materials: usize,
    /// Lights without a surface.
    pub lights: usize,
    /// Files of meshes.
    pub meshes: usize,
    /// Files of images and of densities.
    pub images: usize,
}

impl TakenOver {
    /// Each kind that there is something of, in words: `3 objects`.
    pub fn words(&self) -> Vec<String> {
        let kinds = [
            (self.objects, "object"),
            (self.instances, "instance"),
            (self.materials, "material"),
            (self.lights, "light"),
            (self.meshes, "mesh file"),
            (self.images, "image or grid file"),
        ];
        let words = |(count, kind): (usize, &str)| format!("{count} {kind}{}", if count == 1 { "" } else { "s" });
        kinds.into_iter().filter(|(count, _)| *count > 0).map(words).collect()
    }
}

/// What becomes of something that is not honoured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Loss {
    /// Something else stands for it.
    Approximated,
    /// It is not in the scene.
    LeftOut,
}

/// Something that is not honoured, or not exactly.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LeftOut {
    /// Whether something stands for it.
    pub loss: Loss,
    /// Where the model says it: a JSON path in glTF, the name of a material in MTL, a line elsewhere.
    pub place: String,
    /// What becomes of it, in a sentence without a full stop.
    pub what: String,
}

/// When a model that moves is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The animation, by its name or its index from 0; the first if left out.
    pub animation: Option<String>,
    /// When the shutter opens, s, finite.
    pub opens_s: f64,
    /// How long it stays open, s, 0 or above: 0 shows the model as it is at that instant.
    pub shutter_s: f64,
}

/// What a file may be asked for beyond itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// When an animation of glTF is seen; left out, the model is as its nodes place it.
    pub moment: Option<Moment>,
    /// Names and values of parameters of a scene of Mitsuba, which stand for its `<default>`s. Of two of a name the last counts.
    pub parameters: Vec<(String, String)>,
    /// The variant of the materials of glTF (`KHR_materials_variants`), by its name; left out, the materials that the meshes name.
    pub variant: Option<String>,
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
    let kind = extension(path);
    matches!(kind.as_str(), "gltf" | "glb" | "obj" | "ply" | "xml" | "pbrt") || UNREADABLE.contains(&kind.as_str())
}

/// Kinds of models and scenes that a user may have and that cannot be read. They are no scenes of ours with errors.
const UNREADABLE: [&str; 12] =
    ["fbx", "blend", "usd", "usda", "usdc", "usdz", "dae", "stl", "3ds", "abc", "max", "c4d"];

fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase()
}

/// Imports a model. `prefix` comes before the names of all files of the scene: the name of their folder and a slash, or
/// nothing.
///
/// # Errors
/// If the file, or one that it cannot be understood without, is missing or damaged, or knows nothing of the options.
pub fn import(path: &Path, prefix: &str, options: &Options) -> Result<Imported, ImportError> {
    let fail = |message: String| ImportError { path: path.to_owned(), message };
    let bytes = read_file(path).map_err(|why| fail(format!("cannot be read: {why}")))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let kind = extension(path);
    let near = |name: &str| match read_file(&folder.join(name)) {
        // The folder that the program runs in comes last, as in Mitsuba.
        Err(why) if kind == "xml" => read_file(Path::new(name)).map_err(|_| why),
        read => read,
    };
    let source = path.file_name().unwrap_or_default().to_string_lossy();
    import_bytes_with(&kind, &bytes, &near, prefix, &source, options).map_err(fail)
}

/// As [`import_bytes_with`], without options.
///
/// # Errors
/// As [`import_bytes_with`].
pub fn import_bytes(
    kind: &str,
    bytes: &[u8],
    near: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    prefix: &str,
    source: &str,
) -> Result<Imported, String> {
    import_bytes_with(kind, bytes, near, prefix, source, &Options::default())
}

/// Imports a model of a kind (`glb`, `gltf`, `obj`, `ply`, `xml`, `pbrt`) from its bytes; `near` gives the bytes of a file by the name that
/// the model has for it.
///
/// # Errors
/// A sentence that says what is wrong, with its place.
pub fn import_bytes_with(
    kind: &str,
    bytes: &[u8],
    near: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    prefix: &str,
    source: &str,
    options: &Options,
) -> Result<Imported, String> {
    if options.moment.is_some() && !matches!(kind, "gltf" | "glb") {
        return Err("a time is asked for, but only animations of glTF can be read".to_owned());
    }
    if let Some(name) = options.variant.as_ref().filter(|_| !matches!(kind, "gltf" | "glb")) {
        return Err(format!("the variant \"{name}\" is asked for, but only models of glTF have variants"));
    }
    if let Some((name, _)) = options.parameters.first().filter(|_| kind != "xml") {
        return Err(format!("the parameter \"{name}\" is given, but only scenes of Mitsuba have parameters"));
    }
    // Folders that the scene names come before its own, the last one first.
    let folders = RefCell::new(Vec::new());
    let search = |name: &str| {
        let found = folders.borrow().iter().rev().find_map(|folder: &String| near(&format!("{folder}/{name}")).ok());
        found.map_or_else(|| near(name), Ok)
    };
    let mut builder = Builder::new(&search, &folders, prefix);
    builder.is_bare = matches!(kind, "ply" | "obj" | "gltf" | "glb");
    let read = read(kind, bytes, options, &mut builder);
    read.and_then(|()| builder.finish(source)).map_err(shortened)
}

fn read(kind: &str, bytes: &[u8], options: &Options, builder: &mut Builder<'_>) -> Result<(), String> {
    match kind {
        "ply" => {
            let mut part = read_ply(bytes).map_err(|error| error.to_string())?;
            part.left_out.iter().for_each(|what| builder.leave_out("vertices and faces", what.clone()));
            if part.mesh.colours.is_empty() && !part.face_colours.is_empty() {
                part.mesh = vertex_colours::of_faces(&part.mesh, &part.face_colours);
            }
            if vertex_colours::clamp(&mut part.mesh.colours) {
                builder
                    .approximate("vertices and faces", "some colours are no reflectances: they are clamped to 0 to 1");
            }
            let (name, reflectance) = match part.mesh.colours.is_empty() {
                true => ("grey", json!(0.8)),
                false => ("colours", json!({ "type": "vertex-colours" })),
            };
            builder.materials.insert(name.to_owned(), json!({ "type": "lambert", "reflectance": reflectance }));
            builder.add_mesh("mesh", part.mesh, &json!(name), (None, &Map::new()))
        }
        "obj" => obj::import(bytes, builder),
        "gltf" | "glb" => gltf::import(bytes, options, builder),
        "xml" => check_name(kind, bytes).and_then(|()| mitsuba::import(bytes, &options.parameters, builder)),
        "pbrt" => check_name(kind, bytes).and_then(|()| pbrt::import(bytes, builder)),
        other => Err(format!(
            "models of the kind .{other} cannot be read. Export the model as glTF (.glb), or as .gltf, .obj or .ply. Scenes of Mitsuba 3 \
             (.xml) and pbrt-v4 (.pbrt) can be read too"
        )),
    }
}

/// Fails if a scene of Mitsuba has the name of one of pbrt, or the other way round.
fn check_name(kind: &str, bytes: &[u8]) -> Result<(), String> {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let is_xml = start.starts_with(b"<");
    if kind == "pbrt" && is_xml {
        return Err("it is a scene of Mitsuba, not of pbrt: rename it to .xml".to_owned());
    }
    if kind == "xml" && !is_xml && bytes.windows(10).any(|word| word == b"WorldBegin") {
        return Err("it is a scene of pbrt, not of Mitsuba: rename it to .pbrt".to_owned());
    }
    Ok(())
}

/// A colour as a reflectance of the format: a number if it is grey. Channels are brought into [0, 1].
fn reflectance(rgb: [f64; 3]) -> Value {
    coefficient(rgb.map(|v| v.clamp(0.0, 1.0)))
}

/// A colour whose channels may exceed 1 as a spectrum of the format: of grey, its number.
fn coefficient(rgb: [f64; 3]) -> Value {
    if rgb[0] == rgb[1] && rgb[1] == rgb[2] { json!(rgb[0]) } else { json!({ "type": "rgb", "rgb": rgb }) }
}

/// A colour as light of the format: (1, 1, 1) at scale 1 has the luminance of the constant spectrum 1.
fn light(rgb: [f64; 3], scale: f64) -> Value {
    json!({ "type": "rgb", "rgb": rgb, "scale": scale })
}
