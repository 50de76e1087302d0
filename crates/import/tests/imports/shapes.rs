//! A small model for tests of shapes: buffers are filled number by number, and vertices are read where they come to lie.

use super::{glb_of, nothing, scene};
use etalon_import::{Imported, Moment, Options, import_bytes_with};
use etalon_scene::{Mesh, Object, Scene, Shape};
use serde_json::{Value, json};

/// Corners of the unit square in the z plane, counter-clockwise.
pub(super) const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

/// A model that is being filled.
#[derive(Clone)]
pub(super) struct Model {
    pub(super) json: Value,
    pub(super) bytes: Vec<u8>,
}

impl Model {
    /// One mesh, a square of two triangles without normals.
    pub(super) fn new(nodes: Value, roots: &[usize]) -> Self {
        let mut model = Self {
            json: json!({
                "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": roots }], "nodes": nodes,
                "accessors": [], "bufferViews": [],
            }),
            bytes: Vec::new(),
        };
        let positions = model.floats(&SQUARE.concat(), "VEC3");
        let indices = model.add([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect(), 5123, "SCALAR");
        model.json["meshes"] =
            json!([{ "primitives": [{ "attributes": { "POSITION": positions }, "indices": indices }] }]);
        model
    }

    pub(super) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Adds a part of the buffer; its number.
    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend(bytes);
        views.len() - 1
    }

    /// Adds an accessor of numbers of a kind; its number.
    pub(super) fn add(&mut self, bytes: Vec<u8>, kind: u32, of: &str) -> usize {
        let each = match of {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        } * match kind {
            5121 => 1,
            5123 => 2,
            _ => 4,
        };
        let view = self.view(&bytes);
        let mut accessor =
            json!({ "bufferView": view, "componentType": kind, "count": bytes.len() / each, "type": of });
        if of == "VEC3" || of == "SCALAR" {
            let n = if of == "VEC3" { 3 } else { 1 };
            (accessor["min"], accessor["max"]) = (json!(vec![-1e9; n]), json!(vec![1e9; n]));
        }
        self.accessor(accessor)
    }

    pub(super) fn accessor(&mut self, accessor: Value) -> usize {
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(accessor);
        accessors.len() - 1
    }

    pub(super) fn floats(&mut self, list: &[f32], of: &str) -> usize {
        self.add(list.iter().flat_map(|v| v.to_le_bytes()).collect(), 5126, of)
    }

    /// Adds a channel to the only animation.
    pub(super) fn animate(&mut self, node: usize, path: &str, interpolation: &str, times: &[f32], values: &[f32]) {
        let input = self.floats(times, "SCALAR");
        let output = self.floats(
            values,
            match path {
                "weights" => "SCALAR",
                "rotation" => "VEC4",
                _ => "VEC3",
            },
        );
        if self.json.get("animations").is_none() {
            self.json["animations"] = json!([{ "channels": [], "samplers": [] }]);
        }
        let animation = &mut self.json["animations"][0];
        let samplers = animation["samplers"].as_array_mut().unwrap();
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        let sampler = samplers.len() - 1;
        let channels = animation["channels"].as_array_mut().unwrap();
        channels.push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        glb_of(&json, self.bytes.clone())
    }

    pub(super) fn import(&self) -> Result<Imported, String> {
        import_bytes_with("glb", &self.glb(), &nothing, "", "m.glb", &Options::default())
    }

    pub(super) fn at(&self, opens_s: f64, shutter_s: f64) -> Result<Imported, String> {
        let moment = Some(Moment { animation: None, opens_s, shutter_s });
        import_bytes_with("glb", &self.glb(), &nothing, "", "m.glb", &Options { moment, ..Options::default() })
    }

    /// The sentence that refuses it.
    pub(super) fn refused(&self) -> String {
        self.import().expect_err("refused")
    }
}

/// Objects of the model: those of the studio have materials of their own.
pub(super) fn meshes(scene: &Scene) -> Vec<(&Object, &Mesh)> {
    let named = |object: &&Object| object.name.starts_with("node") || object.name.len() == 1;
    let mut meshes = Vec::new();
    for object in scene.objects.iter().filter(named) {
        if let Shape::Mesh(mesh) = &object.shape {
            meshes.push((object, &**mesh));
        }
    }
    meshes
}

/// The vertices of the only mesh, in the world.
pub(super) fn vertices(imported: &Imported) -> Vec<[f64; 3]> {
    let scene = scene(imported);
    let meshes = meshes(&scene);
    let [(object, mesh)] = meshes.as_slice() else { panic!("{} meshes", meshes.len()) };
    let t = &object.transform;
    let place = |v: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| (0..3).map(|j| t.linear[i][j] * v[j]).sum::<f64>() + t.translation_m[i])
    };
    mesh.vertices.iter().map(place).collect()
}

pub(super) fn near(found: &[[f64; 3]], expected: &[[f64; 3]]) {
    let fits = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-6);
    assert!(found.len() == expected.len() && found.iter().zip(expected).all(fits), "{found:?} instead of {expected:?}");
}

/// What is listed, with its place.
pub(super) fn said(imported: &Imported) -> String {
    imported.left_out.iter().map(|l| format!("{}: {}\n", l.place, l.what)).collect()
}
