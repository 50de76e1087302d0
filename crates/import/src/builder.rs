//! A scene that is being made of a model.

mod files;
mod groups;
mod lamps;
mod place;
mod studio;

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};

use etalon_scene::{Encoding, Mesh, NamedFile, shortened};
use glam::{DAffine3, DVec3};
use serde_json::{Map, Value, json};

use crate::budget::{Budget, FreshNames};
use crate::matrix::steps;
use crate::{Imported, LeftOut, Loss, TakenOver};
use files::KnownImage;
pub(crate) use groups::Outside;
pub(crate) use place::Placed;
use studio::area;

/// Most things that are listed as not honoured; the rest is counted.
const MAX_LEFT_OUT: usize = 1000;

/// Most of them that are named where there is no scene without them.
const MOST_NAMED: usize = 5;

const WITHOUT_AREA: &str = "none of its triangles has an area: it is left out";

/// How something that is listed is introduced.
fn how(loss: Loss) -> &'static str {
    match loss {
        Loss::Approximated => "approximated",
        Loss::LeftOut => "left out",
    }
}

/// Whether it is or has a part that states the media on both of its sides.
fn has_dielectric(value: &Value) -> bool {
    match value {
        Value::Object(map) => {
            map.get("type").is_some_and(|kind| kind == "dielectric") || map.values().any(has_dielectric)
        }
        Value::Array(list) => list.iter().any(has_dielectric),
        _ => false,
    }
}

/// A scene that is being made.
pub(crate) struct Builder<'a> {
    pub(crate) near: &'a dyn Fn(&str) -> Result<Vec<u8>, String>,
    /// Folders in which `near` looks too.
    pub(crate) folders: &'a RefCell<Vec<String>>,
    pub(crate) prefix: String,
    pub(crate) materials: Map<String, Value>,
    pub(crate) objects: Vec<Value>,
    pub(crate) lights: Vec<Value>,
    pub(crate) groups: Map<String, Value>,
    pub(crate) instances: Vec<Value>,
    /// The box around each group, in its own coordinates.
    pub(crate) group_bounds: HashMap<String, Bounds>,
    pub(crate) camera: Option<Value>,
    /// When the shutter opens and when it closes, s; an instant if left out.
    pub(crate) shutter_s: Option<[f64; 2]>,
    pub(crate) film: Value,
    /// What fills the space outside of all bodies.
    pub(crate) medium: Option<Value>,
    /// Media that end at the boundary of a body, with where that is stated.
    bounded: Vec<(Value, String)>,
    pub(crate) integrator: Map<String, Value>,
    pub(crate) files: Vec<NamedFile>,
    /// The names of those that are meshes of which no triangle has an area.
    flat_meshes: HashSet<String>,
    /// Names of files by the files of the model that they are copies of.
    pub(crate) known: HashMap<String, Option<String>>,
    /// Names of files that are made here, by what they hold.
    made: HashMap<String, String>,
    /// Images by their file and how its numbers stand: what is known of each, or why there is none.
    images: HashMap<(String, Encoding), Result<KnownImage, String>>,
    /// Measured materials, by the names of their files.
    measured: HashMap<String, Value>,
    budget: Budget,
    material_names: FreshNames,
    group_names: FreshNames,
    pub(crate) left_out: Vec<LeftOut>,
    pub(crate) added: Vec<String>,
    said: HashSet<LeftOut>,
    /// What was left out beyond [`MAX_LEFT_OUT`]; the same thing may count more than once.
    uncounted: usize,
    pub(crate) emits: bool,
    /// Whether it is a model that may come without light, rather than a scene of another renderer.
    pub(crate) is_bare: bool,
    /// Radiance × area of everything that emits, m²; as `bounds`, of the world or of the group that is being made.
    emitted: f64,
    /// The same of each group, in its own coordinates.
    group_emitted: HashMap<String, f64>,
    /// The mean luminance of images that emit, by their file.
    emitting_images: HashMap<String, f64>,
    /// Of everything, in the world, or in the group that is being made.
    pub(crate) bounds: Bounds,
}

/// The two corners of a box around things, if there are any.
type Bounds = Option<[[f64; 3]; 2]>;

impl<'a> Builder<'a> {
    pub(crate) fn new(
        near: &'a dyn Fn(&str) -> Result<Vec<u8>, String>,
        folders: &'a RefCell<Vec<String>>,
        prefix: &str,
    ) -> Self {
        Self {
            near,
            folders,
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
            medium: None,
            bounded: Vec::new(),
            integrator: Map::new(),
            files: Vec::new(),
            flat_meshes: HashSet::new(),
            known: HashMap::new(),
            made: HashMap::new(),
            images: HashMap::new(),
            measured: HashMap::new(),
            budget: Budget::default(),
            material_names: FreshNames::default(),
            group_names: FreshNames::default(),
            left_out: Vec::new(),
            added: Vec::new(),
            said: HashSet::new(),
            uncounted: 0,
            emits: false,
            is_bare: false,
            emitted: 0.0,
            group_emitted: HashMap::new(),
            emitting_images: HashMap::new(),
            bounds: None,
        }
    }

    /// Lists something that is not in the scene.
    pub(crate) fn leave_out(&mut self, place: impl Into<String>, what: impl Into<String>) {
        self.list(Loss::LeftOut, place.into(), what.into());
    }

    /// Lists something that another stands for.
    pub(crate) fn approximate(&mut self, place: impl Into<String>, what: impl Into<String>) {
        self.list(Loss::Approximated, place.into(), what.into());
    }

    fn list(&mut self, loss: Loss, place: String, what: String) {
        let left_out = LeftOut { loss, place: shortened(place), what: shortened(what) };
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

    /// Adds an object made of a mesh.
    pub(crate) fn add_mesh(
        &mut self,
        name: &str,
        mesh: Mesh,
        material: &Value,
        emission_and_detail: (Option<Value>, &Map<String, Value>),
    ) -> Result<(), String> {
        let file = self.mesh_file(&mesh);
        self.add_object(name, &file, &mesh, material, emission_and_detail, &DAffine3::IDENTITY);
        Ok(())
    }

    /// Adds an object whose mesh is a file that has been added. `transform` is a list of the format, or null.
    pub(crate) fn add_object(
        &mut self,
        name: &str,
        file: &str,
        mesh: &Mesh,
        material: &Value,
        (emission, detail): (Option<Value>, &Map<String, Value>),
        map: &DAffine3,
    ) {
        if self.flat_meshes.contains(file) {
            self.leave_out(name, WITHOUT_AREA);
            return;
        }
        let mut object = json!({ "name": name, "shape": { "type": "mesh", "file": file }, "material": material });
        for (key, value) in detail {
            object[key] = value.clone();
        }
        if let Some(emission) = emission {
            self.emitted += self.mean_radiance(&emission) * area(mesh, map);
            object["emission"] = emission;
            self.emits = true;
        }
        let transform = steps(map);
        if !transform.is_null() {
            object["transform"] = transform;
        }
        for v in &mesh.vertices {
            self.reach(map.transform_point3((*v).into()));
        }
        self.objects.push(object);
    }

    /// Fills the space outside of all bodies. All say the same: what is said first holds.
    pub(crate) fn surround(&mut self, medium: Value, place: &str) {
        match &self.medium {
            None => self.medium = Some(medium),
            Some(known) if *known == medium => {}
            Some(_) => self.leave_out(place, "another medium than elsewhere fills the space outside: it is left out"),
        }
    }

    /// Says that a medium fills a body whose boundary is no surface, and is not outside of it.
    pub(crate) fn bound(&mut self, medium: &Value, place: &str) {
        if !self.bounded.iter().any(|(known, _)| known == medium) {
            self.bounded.push((medium.clone(), place.to_owned()));
        }
    }

    /// A medium that is said to be around the camera, and to end at the boundary of a body, fills that body alone: the camera is inside.
    fn end_medium(&mut self) {
        let Some((_, place)) = self.bounded.iter().find(|(medium, _)| Some(medium) == self.medium.as_ref()) else {
            return;
        };
        if self.materials.values().chain(&self.objects).chain(self.groups.values()).any(has_dielectric) {
            let what = "the medium around the camera ends here; beside glass it fills all space";
            self.approximate(place.clone(), what);
        } else {
            self.medium = None;
        }
    }

    /// Counts a copy of something toward what a scene can hold.
    ///
    /// # Errors
    /// If that is too much.
    pub(crate) fn spend(&mut self, value: &Value, place: &str) -> Result<(), String> {
        self.budget.spend(value, place)
    }

    /// Widens the bounds by a box that is moved.
    pub(crate) fn enclose(&mut self, [low, high]: [[f64; 3]; 2], map: &DAffine3) {
        for corner in 0..8 {
            let p: [f64; 3] = std::array::from_fn(|k| if corner >> k & 1 == 0 { low[k] } else { high[k] });
            self.reach(map.transform_point3(p.into()));
        }
    }

    /// Widens the bounds by a point.
    fn reach(&mut self, p: DVec3) {
        let [low, high] = self.bounds.get_or_insert([p.to_array(); 2]);
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }

    /// A name for a material that none has yet.
    pub(crate) fn material_name(&mut self, wanted: &str) -> String {
        self.material_names.name(if wanted.is_empty() { "material" } else { wanted }, &self.materials)
    }

    /// The scene, with a camera and a light if the model has none.
    pub(crate) fn finish(mut self, source: &str) -> Result<Imported, String> {
        let Some([low, high]) = self.bounds else { return Err(self.nothing_to_see()) };
        let taken_over = self.taken_over();
        self.end_medium();
        let mut added = std::mem::take(&mut self.added);
        if self.uncounted > 0 {
            let what = format!("{} more things are not listed", self.uncounted);
            self.left_out.push(LeftOut { loss: Loss::LeftOut, place: source.to_owned(), what });
        }
        let mut camera = self.camera.take().unwrap_or_else(|| {
            let (camera, distance) = studio::camera([low, high]);
            added.push(format!("the model has no camera: one is added that looks at all of it, from {distance:.3} m"));
            camera
        });
        if let Some(shutter_s) = self.shutter_s {
            camera["shutter_s"] = json!(shutter_s);
        }
        added.extend(self.add_light([low, high], &camera));
        let comment: Vec<String> = std::iter::once(format!("Imported from {source}."))
            .chain(added.iter().cloned())
            .chain(self.left_out.iter().map(|l| format!("{}: {}: {}", how(l.loss), l.place, l.what)))
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
        if let Some(medium) = &self.medium {
            scene["medium"] = medium.clone();
        }
        if !self.instances.is_empty() {
            scene["instances"] = json!(self.instances);
        }
        let text = format!("{scene:#}\n");
        Ok(Imported { text, files: self.files, taken_over, left_out: self.left_out, added })
    }

    /// Why there is no scene: it has no surfaces, and which things were left out.
    fn nothing_to_see(&self) -> String {
        let left_out: Vec<&LeftOut> = self.left_out.iter().filter(|l| l.loss == Loss::LeftOut).collect();
        let mut words: Vec<String> =
            left_out.iter().take(MOST_NAMED).map(|l| format!("{}: {}", l.place, l.what)).collect();
        if words.is_empty() {
            return "it has no surfaces".to_owned();
        }
        if left_out.len() > MOST_NAMED {
            words.push(format!("and {} more", left_out.len() - MOST_NAMED + self.uncounted));
        }
        format!("it has no surfaces that can be read ({})", words.join("; "))
    }

    fn taken_over(&self) -> TakenOver {
        let of_groups = self.groups.values().filter_map(|group| group["objects"].as_array()).map(Vec::len);
        let meshes = self.files.iter().filter(|file| file.name.ends_with(".ply")).count();
        TakenOver {
            objects: self.objects.len() + of_groups.sum::<usize>(),
            instances: self.instances.len(),
            materials: self.materials.len(),
            lights: self.lights.len(),
            meshes,
            images: self.files.len() - meshes,
        }
    }
}
