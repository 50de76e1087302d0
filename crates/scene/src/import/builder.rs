//! A scene that is being made of a model.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use serde_json::{Map, Value, json};

use super::budget::{Budget, FreshNames};
use super::matrix::{Rows, determinant, is_similarity, point, steps};
use super::relief::turn_over;
use super::{Imported, ImportedFile, LeftOut, extension};
use crate::mesh::write_ply;
use crate::model::Mesh;
use crate::problem::shortened;
use crate::texture::{Encoding, Image};
use crate::vector::{dot, length, sub};

/// Most things that are listed as not honoured; the rest is counted.
const MAX_LEFT_OUT: usize = 1000;

/// A scene that is being made.
pub(super) struct Builder<'a> {
    pub(super) near: &'a dyn Fn(&str) -> Result<Vec<u8>, String>,
    pub(super) prefix: String,
    pub(super) materials: Map<String, Value>,
    pub(super) objects: Vec<Value>,
    pub(super) lights: Vec<Value>,
    pub(super) groups: Map<String, Value>,
    pub(super) instances: Vec<Value>,
    /// The box around each group, in its own coordinates.
    pub(super) group_bounds: HashMap<String, Bounds>,
    pub(super) camera: Option<Value>,
    /// When the shutter opens and when it closes, s; an instant if left out.
    pub(super) shutter_s: Option<[f64; 2]>,
    pub(super) film: Value,
    pub(super) integrator: Map<String, Value>,
    pub(super) files: Vec<ImportedFile>,
    /// Names of files by what they were made from.
    pub(super) known: HashMap<String, Option<String>>,
    /// Images by their file and how its numbers stand: what is known of each, or why there is none.
    images: HashMap<(String, Encoding), Result<KnownImage, String>>,
    budget: Budget,
    material_names: FreshNames,
    group_names: FreshNames,
    pub(super) left_out: Vec<LeftOut>,
    pub(super) added: Vec<String>,
    said: HashSet<LeftOut>,
    /// What was left out beyond [`MAX_LEFT_OUT`]; the same thing may count more than once.
    uncounted: usize,
    pub(super) emits: bool,
    /// Of everything, in the world, or in the group that is being made.
    pub(super) bounds: Bounds,
}

/// An image that has been decoded.
#[derive(Clone, Debug)]
struct KnownImage {
    /// Its file in the scene.
    file: String,
    /// The mean of its texels.
    mean: [f64; 3],
    /// What of it is not used.
    left_out: Option<String>,
}

/// The objects, instances and bounds of what is outside of a group that is being made.
pub(super) type Outside = (Vec<Value>, Vec<Value>, Bounds);

/// The two corners of a box around things, if there are any.
type Bounds = Option<[[f64; 3]; 2]>;

/// An object that is to be placed.
pub(super) struct Placed {
    pub(super) name: String,
    /// A shape of the format.
    pub(super) shape: Value,
    /// Two corners of a box around it, before its transform.
    pub(super) reach: [[f64; 3]; 2],
    pub(super) material: Value,
    pub(super) emission: Option<Value>,
    pub(super) opacity: f64,
    /// Further keys of the object.
    pub(super) detail: Map<String, Value>,
    pub(super) rows: Rows,
    /// Whether its normals point the other way.
    pub(super) flipped: bool,
}

impl<'a> Builder<'a> {
    pub(super) fn new(near: &'a dyn Fn(&str) -> Result<Vec<u8>, String>, prefix: &str) -> Self {
        Self {
            near,
            prefix: prefix.to_owned(),
            materials: Map::new(),
            objects: Vec::new(),
            lights: Vec::new(),
            groups: Map::new(),
            instances: Vec::new(),
            group_bounds: HashMap::new(),
            camera: None,
            shutter_s: None,
            film: json!({ "width": 1280, "height": 720 }),
            integrator: Map::new(),
            files: Vec::new(),
            known: HashMap::new(),
            images: HashMap::new(),
            budget: Budget::default(),
            material_names: FreshNames::default(),
            group_names: FreshNames::default(),
            left_out: Vec::new(),
            added: Vec::new(),
            said: HashSet::new(),
            uncounted: 0,
            emits: false,
            bounds: None,
        }
    }

    pub(super) fn leave_out(&mut self, place: impl Into<String>, what: impl Into<String>) {
        let left_out = LeftOut { place: shortened(place.into()), what: shortened(what.into()) };
        if self.said.contains(&left_out) {
            return;
        }
        if self.left_out.len() == MAX_LEFT_OUT {
            self.uncounted += 1;
            return;
        }
        self.said.insert(left_out.clone());
        self.left_out.push(left_out);
    }

    /// Adds a file, and gives the name that the scene has for it.
    pub(super) fn add_file(&mut self, kind: &str, extension: &str, bytes: Vec<u8>) -> String {
        let name = format!("{}{kind}-{}.{extension}", self.prefix, self.files.len());
        self.files.push(ImportedFile { name: name.clone(), bytes });
        name
    }

    /// Adds a mesh as a file; `None`, and a note, if it has no triangles.
    pub(super) fn mesh_file(&mut self, mesh: &Mesh) -> String {
        let mut bytes = Vec::with_capacity(40 * mesh.vertices.len() + 13 * mesh.triangles.len());
        // Writing to memory cannot fail.
        let _ = write_ply(mesh, &mut bytes);
        self.add_file("mesh", "ply", bytes)
    }

    /// Adds an object made of a mesh.
    pub(super) fn add_mesh(
        &mut self,
        name: &str,
        mesh: Mesh,
        material: &Value,
        emission: Option<Value>,
        transform: Value,
    ) -> Result<(), String> {
        let file = self.mesh_file(&mesh);
        self.add_object(name, &file, &mesh, material, (emission, &Map::new()), &transform);
        Ok(())
    }

    /// Adds an object whose mesh is a file that has been added. `transform` is a list of the format, or null.
    pub(super) fn add_object(
        &mut self,
        name: &str,
        file: &str,
        mesh: &Mesh,
        material: &Value,
        (emission, detail): (Option<Value>, &Map<String, Value>),
        transform: &Value,
    ) {
        let mut object = json!({ "name": name, "shape": { "type": "mesh", "file": file }, "material": material });
        for (key, value) in detail {
            object[key] = value.clone();
        }
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

    /// Adds an object. One whose transform flattens it is left out; a round one that is stretched becomes an instance, which
    /// may be, unless it emits.
    ///
    /// # Errors
    /// If there are more objects than a scene can hold.
    pub(super) fn place(&mut self, placed: &Placed, place: &str) -> Result<(), String> {
        let determinant = determinant(&placed.rows);
        if determinant == 0.0 || !determinant.is_finite() {
            self.leave_out(place, "it is flattened by its transform, and left out");
            return Ok(());
        }
        let mut material = placed.material.clone();
        let mut emission = placed.emission.clone();
        if placed.flipped {
            // Which side is which matters to a dielectric and to what shines on one side.
            let own = material.as_str().and_then(|name| self.materials.get(name)).cloned().unwrap_or(material.clone());
            if own["type"] == "dielectric" {
                material = own.clone();
                material["interior"] = own.get("exterior").cloned().unwrap_or(json!(1));
                material["exterior"] = own["interior"].clone();
            }
            if let Some(emission) = &mut emission {
                emission["sides"] = json!(if emission["sides"] == "back" { "front" } else { "back" });
            }
        }
        let mut object = json!({ "name": placed.name, "shape": placed.shape, "material": material });
        if placed.opacity < 1.0 {
            object["opacity"] = json!(placed.opacity);
        }
        let mut detail = placed.detail.clone();
        if placed.flipped {
            turn_over(&mut detail);
        }
        for (key, value) in detail {
            object[key] = value;
        }
        let round = matches!(placed.shape["type"].as_str(), Some("sphere" | "disk" | "cylinder"));
        self.spend(&object, place)?;
        let stretched = round && !is_similarity(&placed.rows);
        if stretched && emission.is_some() {
            self.leave_out(place, "its light is left out: what emits may not be stretched");
        } else if let Some(emission) = emission {
            self.spend(&emission, place)?;
            object["emission"] = emission;
            self.emits = true;
        }
        if stretched {
            let group = self.group_name(&placed.name);
            self.groups.insert(group.clone(), json!({ "objects": [object] }));
            self.instances.push(json!({ "name": placed.name, "group": group, "transform": steps(&placed.rows) }));
        } else {
            let transform = steps(&placed.rows);
            if !transform.is_null() {
                object["transform"] = transform;
            }
            self.objects.push(object);
        }
        self.enclose(placed.reach, &placed.rows);
        Ok(())
    }

    /// Counts a copy of something toward what a scene can hold.
    ///
    /// # Errors
    /// If that is too much.
    pub(super) fn spend(&mut self, value: &Value, place: &str) -> Result<(), String> {
        self.budget.spend(value, place)
    }

    /// Widens the bounds by a box that is moved.
    pub(super) fn enclose(&mut self, [low, high]: [[f64; 3]; 2], rows: &Rows) {
        for corner in 0..8 {
            let p = point(rows, std::array::from_fn(|k| if corner >> k & 1 == 0 { low[k] } else { high[k] }));
            let [low, high] = self.bounds.get_or_insert([p, p]);
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
    }

    pub(super) fn group_name(&mut self, wanted: &str) -> String {
        self.group_names.name(wanted, &self.groups)
    }

    /// From here on objects belong to a group. Gives what is outside of it.
    pub(super) fn begin_group(&mut self) -> Outside {
        (std::mem::take(&mut self.objects), std::mem::take(&mut self.instances), self.bounds.take())
    }

    pub(super) fn end_group(&mut self, name: &str, (objects, instances, bounds): Outside) {
        let mut group = json!({ "objects": std::mem::replace(&mut self.objects, objects) });
        let within = std::mem::replace(&mut self.instances, instances);
        if !within.is_empty() {
            group["instances"] = json!(within);
        }
        self.groups.insert(name.to_owned(), group);
        self.group_bounds.insert(name.to_owned(), std::mem::replace(&mut self.bounds, bounds));
    }

    /// Places a group.
    pub(super) fn place_group(&mut self, name: &str, group: &str, rows: &Rows, place: &str) {
        let determinant = determinant(rows);
        let Some(Some(bounds)) = self.group_bounds.get(group).copied() else {
            self.leave_out(place, format!("the group \"{group}\" is empty or not there: its instance is left out"));
            return;
        };
        if determinant == 0.0 || !determinant.is_finite() {
            self.leave_out(place, "it is flattened by its transform, and left out");
            return;
        }
        let mut instance = json!({ "name": name, "group": group });
        let transform = steps(rows);
        if !transform.is_null() {
            instance["transform"] = transform;
        }
        self.instances.push(instance);
        self.enclose(bounds, rows);
    }

    /// Places a group that moves: keyframes are times, s, and maps at them.
    pub(super) fn place_moving(&mut self, name: &str, group: &str, keyframes: &[(f64, Rows)]) {
        let Some(Some(bounds)) = self.group_bounds.get(group).copied() else {
            // There is nothing in it.
            self.groups.remove(group);
            return;
        };
        let frames: Vec<Value> = keyframes
            .iter()
            .map(|(time_s, rows)| json!({ "time_s": time_s, "transform": [{ "matrix": rows }] }))
            .collect();
        self.instances.push(json!({ "name": name, "group": group, "keyframes": frames }));
        keyframes.iter().for_each(|(_, rows)| self.enclose(bounds, rows));
    }

    /// The bytes of a file that the model names.
    pub(super) fn bytes_of(&self, name: &str, place: &str) -> Result<Vec<u8>, String> {
        let name = name.replace('\\', "/");
        (self.near)(&name).map_err(|why| format!("{place}: \"{name}\" cannot be read: {why}"))
    }

    /// Adds the file of an image, once, and gives its name in the scene and the mean of its texels.
    pub(super) fn image_file(
        &mut self,
        name: &str,
        encoding: Encoding,
        place: &str,
    ) -> Result<(String, [f64; 3]), String> {
        let key = (name.to_owned(), encoding);
        let known = match self.images.get(&key) {
            Some(known) => known.clone(),
            None => {
                let read = self.read_image(name, encoding, place);
                self.images.insert(key, read.clone());
                read
            }
        };
        let KnownImage { file, mean, left_out } = known?;
        if let Some(what) = left_out {
            self.leave_out(place, what);
        }
        Ok((file, mean))
    }

    fn read_image(&mut self, name: &str, encoding: Encoding, place: &str) -> Result<KnownImage, String> {
        let bytes = self.bytes_of(name, place)?;
        let (image, left_out) = Image::decode(&bytes, encoding)?;
        let file = match self.known.get(name) {
            Some(Some(file)) => file.clone(),
            _ => {
                let file = self.add_file("image", &extension(Path::new(name)), bytes);
                self.known.insert(name.to_owned(), Some(file.clone()));
                file
            }
        };
        Ok(KnownImage { file, mean: image.mean(), left_out })
    }

    /// A name for a material that none has yet.
    pub(super) fn material_name(&mut self, wanted: &str) -> String {
        self.material_names.name(if wanted.is_empty() { "material" } else { wanted }, &self.materials)
    }

    /// The scene, with a camera and a light if the model has none.
    pub(super) fn finish(mut self, source: &str) -> Result<Imported, String> {
        let Some([low, high]) = self.bounds else { return Err("there is nothing in it to see".to_owned()) };
        let mut added = std::mem::take(&mut self.added);
        if self.uncounted > 0 {
            let what = format!("{} more things are not listed", self.uncounted);
            self.left_out.push(LeftOut { place: source.to_owned(), what });
        }
        let mut camera = self.camera.take().unwrap_or_else(|| {
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
        if let Some(shutter_s) = self.shutter_s {
            camera["shutter_s"] = json!(shutter_s);
        }
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
        let mut scene = json!({
            "etalon": 1, "comment": comment, "camera": camera, "film": self.film, "materials": self.materials,
            "objects": self.objects, "lights": self.lights,
        });
        for (key, part) in [("groups", &self.groups), ("integrator", &self.integrator)] {
            if !part.is_empty() {
                scene[key] = json!(part);
            }
        }
        if !self.instances.is_empty() {
            scene["instances"] = json!(self.instances);
        }
        let text = format!("{scene:#}\n");
        Ok(Imported { text, files: self.files, left_out: self.left_out, added })
    }
}
