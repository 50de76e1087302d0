//! Primitives of meshes, as mesh files of the scene.

use etalon_scene::Mesh;
use etalon_scene::linear::unit_normal;
use etalon_scene::mesh::MAX_ELEMENTS;
use gltf::Node;
use gltf::mesh::{Mode, Semantic};
use serde_json::{Value, json};

use super::Walk;
use super::accessor::numbers;
use crate::number::{WITHOUT_DIRECTIONS, without_directions};

/// Most vertices and triangles of meshes that morph targets or joints bend: each is one more copy of what the file states.
const MOST_BENT: usize = 1 << 25;

/// How a mesh is bent.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Shape {
    /// The bits of the weights of its morph targets; none where all are 0.
    weights: Vec<u64>,
    /// The skin whose joints it follows.
    pub skin: Option<usize>,
}

impl Shape {
    fn new(weights: &[f64], skin: Option<usize>) -> Self {
        Self { weights: weights.iter().map(|weight| weight.to_bits()).collect(), skin }
    }

    fn weights(&self) -> Vec<f64> {
        self.weights.iter().map(|bits| f64::from_bits(*bits)).collect()
    }
}

/// A mesh that has been made: its file and what it holds.
pub(super) struct MadePart {
    pub file: String,
    pub mesh: Mesh,
    pub material: Value,
    pub emission: Option<Value>,
    /// Keys of the objects: opacity, normals.
    pub detail: serde_json::Map<String, Value>,
}

impl<'w> Walk<'w, '_> {
    /// How the mesh of a node is bent when the shutter opens.
    pub(super) fn shape(&self, node: &Node<'w>, mesh: &gltf::Mesh<'w>) -> Result<Shape, String> {
        let weights = self.weights(node, mesh)?;
        Ok(Shape::new(&weights, node.skin().map(|skin| skin.index())))
    }

    pub(super) fn part(
        &mut self,
        primitive: &gltf::Primitive<'w>,
        shape: &Shape,
        place: &str,
    ) -> Result<Option<MadePart>, String> {
        let fail = |what: &str| format!("{place}: {what}");
        let stated = self.material(primitive, place)?;
        let alpha = stated.alpha_mode();
        let look = self.materials.of(&stated, self.buffers, self.builder)?;
        for (semantic, _) in primitive.attributes() {
            let used = match semantic {
                Semantic::Positions | Semantic::Normals | Semantic::Tangents => true,
                // Sets that no image uses would be listed for nothing.
                Semantic::TexCoords(_) | Semantic::Colors(0) => true,
                Semantic::Joints(_) | Semantic::Weights(_) => shape.skin.is_some(),
                Semantic::Colors(_) => false,
            };
            if !used {
                let key = semantic.to_string();
                self.builder.leave_out(format!("{place}.attributes.{key}"), "it is ignored");
            }
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.builder.leave_out(place, "it has no positions, and is left out");
            return Ok(None);
        };
        let mut vertices = numbers::<3>(&positions, self.buffers)?;
        let count = vertices.len();
        let mut normals = match primitive.get(&Semantic::Normals) {
            Some(accessor) => numbers::<3>(&accessor, self.buffers)?,
            None => Vec::new(),
        };
        let uvs = match primitive.get(&Semantic::TexCoords(look.uv_set)) {
            Some(accessor) => numbers::<2>(&accessor, self.buffers)?,
            None => Vec::new(),
        };
        for (what, length) in [("normals", normals.len()), ("texture coordinates", uvs.len())] {
            if length != 0 && length != count {
                return Err(fail(&format!("{length} {what} for {count} vertices")));
            }
        }
        let indices: Vec<u32> = match primitive.indices() {
            Some(accessor) => numbers::<1>(&accessor, self.buffers)?.iter().map(|[i]| *i as u32).collect(),
            None => (0..count as u32).collect(),
        };
        if let Some(i) = indices.iter().position(|&i| i as usize >= count) {
            return Err(fail(&format!("index {i} names vertex {}; there are {count}", indices[i])));
        }
        let mut triangles = triangles(primitive.mode(), &indices);
        if triangles.is_empty() || triangles.len() > MAX_ELEMENTS {
            self.builder.leave_out(place, "it has no triangles, and is left out");
            return Ok(None);
        }
        let colours = self.colours(primitive, alpha, count, place)?;
        // A few bytes may name the same accessors again and again.
        let elements = count + triangles.len();
        self.made += elements;
        if self.made > MAX_ELEMENTS {
            return Err(fail("up to here all meshes have more than 2^29 vertices and triangles"));
        }
        if *shape != Shape::default() {
            self.bent += elements;
            if self.bent > MOST_BENT {
                return Err(fail(&format!("up to here bent meshes have more than {MOST_BENT} vertices and triangles")));
            }
        }
        if !shape.weights.is_empty() {
            self.morph(primitive, &shape.weights(), &mut vertices, &mut normals, place)?;
        }
        if let Some(skin) = shape.skin {
            self.bend(primitive, skin, (&mut vertices, &mut normals), &mut triangles, place)?;
        }
        if let Some(i) = vertices.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
            return Err(fail(&format!("vertex {i} lies at {:?}", vertices[i])));
        }
        if uvs.iter().flatten().chain(normals.iter().flatten()).any(|v| !v.is_finite()) {
            return Err(fail("a normal or a texture coordinate is not finite"));
        }
        let mesh = Mesh {
            vertices,
            triangles,
            normals: normals.into_iter().map(unit_normal).collect(),
            // glTF counts v from the top of the image.
            uvs: uvs.into_iter().map(|[u, v]| [u as f32, (1.0 - v) as f32]).collect(),
            colours,
        };
        let mut material = look.material.clone();
        let mut detail = look.detail.clone();
        let mut emission = look.emission.clone();
        if mesh.uvs.is_empty() && look.has_image {
            let what = "it has no texture coordinates for the images of its material: it becomes grey, and an image of \
                        emission is left out";
            self.builder.leave_out(place, what);
            material = json!({ "type": "lambert", "reflectance": 0.8 });
            detail.clear();
            emission = emission.filter(|emission| emission["radiance"]["type"] != "image");
        }
        if mesh.uvs.is_empty() {
            let own = material.as_str().and_then(|name| self.builder.materials.get(name));
            let mut without = own.unwrap_or(&material).clone();
            if without_directions(&mut without) {
                self.builder.leave_out(place, WITHOUT_DIRECTIONS);
                material = without;
            }
        }
        if !mesh.colours.is_empty() {
            material = self.tinted(material, place)?;
        }
        self.note_back(&stated);
        let file = self.builder.mesh_file(&mesh);
        Ok(Some(MadePart { file, mesh, material, emission, detail }))
    }
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        // Every other one is turned, so that all have the same side outward.
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
            .collect(),
        Mode::TriangleFan => match indices {
            [first, rest @ ..] => rest.windows(2).map(|t| [*first, t[0], t[1]]).collect(),
            [] => Vec::new(),
        },
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}
