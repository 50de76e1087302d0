//! glTF 2.0: nodes, meshes, cameras and lights.

mod accessor;
mod animation;
mod base_colour;
mod camera;
mod clearcoat;
mod colours;
mod diffuse_transmission;
mod file;
mod image;
mod iridescence;
mod material;
mod variants;

use std::collections::HashMap;

use etalon_scene::Mesh;
use etalon_scene::linear::{is_similarity, unit, unit_normal};
use etalon_scene::mesh::MAX_ELEMENTS;
use glam::{DAffine3, DVec3};
use gltf::Node;
use gltf::mesh::{Mode, Semantic};
use serde_json::{Value, json};

use crate::number::{WITHOUT_DIRECTIONS, without_directions};
use crate::{Builder, Options, light};
use accessor::numbers;
use animation::{Animated, Pose};
use file::{buffers, check_images, check_lights, check_primitives, parse};
use material::Materials;

/// Deepest nesting of nodes.
const MAX_DEPTH: usize = 256;

/// Things that move within things that move: each takes up to two groups within each other, of which the format knows sixteen.
const MAX_MOVING: usize = 7;

pub(super) fn import(bytes: &[u8], options: &Options, builder: &mut Builder<'_>) -> Result<(), String> {
    let moment = options.moment.as_ref();
    check_primitives(bytes)?;
    let file = parse(bytes)?;
    check_images(&file)?;
    check_lights(&file)?;
    let buffers = buffers(&file, builder)?;
    if file.skins().count() > 0 {
        builder.leave_out("$.skins", "they are ignored: the model is as its nodes place it");
    }
    let variant = variants::asked(&file, options.variant.as_deref(), builder)?;
    let animated = Animated::read(&file, &buffers, moment, builder)?;
    if moment.is_some_and(|moment| moment.shutter_s > 0.0) {
        builder.shutter_s = Some(animated.shutter_s);
    }
    let mut walk = Walk {
        builder,
        document: &file,
        variant,
        animated: &animated,
        chain: Vec::new(),
        buffers: &buffers,
        materials: Materials::default(),
        parts: HashMap::new(),
        visited: Vec::new(),
        uses: Vec::new(),
    };
    walk.visited = vec![false; file.nodes().count()];
    walk.uses = vec![0; file.meshes().count()];
    let scene = file.default_scene().or_else(|| file.scenes().next()).ok_or("it has no scene")?;
    for other in file.scenes().filter(|other| other.index() != scene.index()) {
        walk.builder.leave_out(format!("$.scenes[{}]", other.index()), "only one scene is imported");
    }
    for mesh in file.nodes().filter_map(|node| node.mesh()) {
        walk.uses[mesh.index()] += 1;
    }
    for node in scene.nodes() {
        walk.node(&node, &DAffine3::IDENTITY, 0)?;
    }
    Ok(())
}

/// A mesh that has been made: its file and what it holds.
struct MadePart {
    file: String,
    mesh: Mesh,
    material: Value,
    emission: Option<Value>,
    /// Keys of the objects: opacity, normals.
    detail: serde_json::Map<String, Value>,
}

struct Walk<'w, 'b> {
    builder: &'w mut Builder<'b>,
    document: &'w gltf::Document,
    /// The number of the variant of materials that is asked for.
    variant: Option<usize>,
    animated: &'w Animated,
    /// What moves around the node: the map from its parent to what moves around that in turn, and its poses.
    chain: Vec<(DAffine3, Vec<(f64, Pose)>)>,
    buffers: &'w [Vec<u8>],
    materials: Materials,
    /// Parts by mesh and primitive; `None` is one without triangles.
    parts: HashMap<(usize, usize), Option<MadePart>>,
    visited: Vec<bool>,
    /// How often each mesh is placed: one that is placed again and again is a group with instances.
    uses: Vec<u32>,
}

impl<'w> Walk<'w, '_> {
    fn node(&mut self, node: &Node<'w>, parent: &DAffine3, depth: usize) -> Result<(), String> {
        let place = format!("$.nodes[{}]", node.index());
        if depth > MAX_DEPTH {
            return Err(format!("{place}: nodes are nested more than {MAX_DEPTH} deep"));
        }
        if std::mem::replace(&mut self.visited[node.index()], true) {
            return Err(format!("{place}: it is part of the scene twice"));
        }
        if let Some(poses) = self.motion(node, parent, &place) {
            return self.moving(node, parent, poses, depth);
        }
        let matrix = *parent * self.animated.local(node, self.animated.shutter_s[0]);
        if !matrix.is_finite() {
            return Err(format!("{place}: its transform is not finite"));
        }
        self.content(node, &matrix, depth)
    }

    /// How a node moves, if it does and can.
    fn motion(&mut self, node: &Node<'w>, parent: &DAffine3, place: &str) -> Option<Vec<(f64, Pose)>> {
        let poses = self.animated.motion(node)?;
        let sides = poses[0].1.scale.signum();
        let why = if self.chain.len() >= MAX_MOVING {
            format!("it moves inside {MAX_MOVING} other moving nodes")
        } else if poses.iter().any(|(_, pose)| pose.scale.cmpeq(DVec3::ZERO).any() || pose.scale.signum() != sides) {
            "its scale goes through 0".to_owned()
        } else if parent.matrix3.determinant() == 0.0 {
            "it is flattened by its parents".to_owned()
        } else {
            return Some(poses);
        };
        self.builder.approximate(place, format!("{why}: it stays as it is when the shutter opens"));
        None
    }

    /// A node that moves: a group of what is in it, placed by keyframes.
    fn moving(
        &mut self,
        node: &Node<'w>,
        parent: &DAffine3,
        poses: Vec<(f64, Pose)>,
        depth: usize,
    ) -> Result<(), String> {
        let name = node.name().map_or_else(|| format!("node {}", node.index()), str::to_owned);
        let maps: Vec<(f64, DAffine3)> = poses.iter().map(|(time_s, pose)| (*time_s, pose.map())).collect();
        let outside = self.builder.begin_group();
        self.chain.push((*parent, poses));
        let within = self.content(node, &DAffine3::IDENTITY, depth);
        self.chain.pop();
        let group = self.builder.group_name(&name);
        self.builder.end_group(&group, outside);
        within?;
        let frames = |before: &DAffine3| -> Vec<(f64, DAffine3)> {
            maps.iter().map(|(time_s, map)| (*time_s, *before * *map)).collect()
        };
        // Between keyframes stretches, turns and moves are joined each for itself: a similarity changes nothing about that.
        if is_similarity(&parent.matrix3) {
            self.builder.place_moving(&name, &group, &frames(parent));
        } else {
            let outside = self.builder.begin_group();
            self.builder.place_moving(&name, &group, &frames(&DAffine3::IDENTITY));
            let around = self.builder.group_name(&name);
            self.builder.end_group(&around, outside);
            if self.builder.group_bounds.get(&around).copied().flatten().is_some() {
                let place = format!("$.nodes[{}]", node.index());
                self.builder.place_group(&name, &around, parent, &place);
            } else {
                self.builder.groups.remove(&around);
            }
        }
        Ok(())
    }

    /// What is in a node, and in those below it. `matrix` leads from its coordinates to the world, or to those of the group that is
    /// being made.
    fn content(&mut self, node: &Node<'w>, matrix: &DAffine3, depth: usize) -> Result<(), String> {
        let place = format!("$.nodes[{}]", node.index());
        if let Some(camera) = node.camera() {
            self.camera(&camera, matrix);
        }
        if let Some(lamp) = node.light() {
            let [opens, closes] = self.animated.shutter_s;
            if !self.chain.is_empty() {
                let what =
                    "a light without a surface cannot move: it stays at its place in the middle of the shutter time";
                self.builder.leave_out(&place, what);
            }
            let world = self.world(matrix, 0.5 * (opens + closes));
            self.light(&lamp, node, &world);
        }
        if node.weights().is_some() {
            self.builder.leave_out(&place, "morph weights are ignored");
        }
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                let name = match (node.name().or(mesh.name()), mesh.primitives().len()) {
                    (Some(name), 1) => name.to_owned(),
                    (Some(name), _) => format!("{name}, part {}", primitive.index()),
                    (None, _) => format!("node {}, part {}", node.index(), primitive.index()),
                };
                self.place(&mesh, &primitive, &name, matrix)?;
            }
        }
        for child in node.children() {
            self.node(&child, matrix, depth + 1)?;
        }
        Ok(())
    }

    /// From the coordinates of a node to the world at a time, by what moves around it.
    fn world(&self, matrix: &DAffine3, time_s: f64) -> DAffine3 {
        let moved = self
            .chain
            .iter()
            .fold(DAffine3::IDENTITY, |map, (before, poses)| map * *before * Pose::at(poses, time_s).map());
        moved * *matrix
    }

    /// Adds a primitive where a node places it; its mesh is made once.
    fn place(
        &mut self,
        mesh: &gltf::Mesh<'w>,
        primitive: &gltf::Primitive<'w>,
        name: &str,
        matrix: &DAffine3,
    ) -> Result<(), String> {
        let key = (mesh.index(), primitive.index());
        if !self.parts.contains_key(&key) {
            let made = self.part(primitive, &format!("$.meshes[{}].primitives[{}]", key.0, key.1))?;
            self.parts.insert(key, made);
        }
        let Some(Some(part)) = self.parts.get(&key) else { return Ok(()) };
        let determinant = matrix.matrix3.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            self.builder.leave_out(format!("node \"{name}\""), "it is flattened by its transform, and left out");
            return Ok(());
        }
        if self.uses[key.0] < 2 {
            self.builder.add_object(
                name,
                &part.file,
                &part.mesh,
                &part.material,
                (part.emission.clone(), &part.detail),
                matrix,
            );
            return Ok(());
        }
        let group = format!("mesh {}, part {}", key.0, key.1);
        if !self.builder.groups.contains_key(&group) {
            let outside = self.builder.begin_group();
            let more = (part.emission.clone(), &part.detail);
            self.builder.add_object(&group, &part.file, &part.mesh, &part.material, more, &DAffine3::IDENTITY);
            self.builder.end_group(&group, outside);
        }
        self.builder.place_group(name, &group, matrix, &format!("node \"{name}\""));
        Ok(())
    }

    fn part(&mut self, primitive: &gltf::Primitive<'w>, place: &str) -> Result<Option<MadePart>, String> {
        let fail = |what: &str| format!("{place}: {what}");
        let material = self.material(primitive, place)?;
        let alpha = material.alpha_mode();
        let look = self.materials.of(&material, self.buffers, self.builder)?;
        for (semantic, _) in primitive.attributes() {
            let used = match semantic {
                Semantic::Positions | Semantic::Normals | Semantic::Tangents => true,
                // Sets that no image uses would be listed for nothing.
                Semantic::TexCoords(_) | Semantic::Colors(0) => true,
                Semantic::Colors(_) | Semantic::Joints(_) | Semantic::Weights(_) => false,
            };
            if !used {
                let key = semantic.to_string();
                self.builder.leave_out(format!("{place}.attributes.{key}"), "it is ignored");
            }
        }
        if primitive.morph_targets().count() > 0 {
            self.builder.leave_out(format!("{place}.targets"), "morph targets are ignored");
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.builder.leave_out(place, "it has no positions, and is left out");
            return Ok(None);
        };
        let vertices = numbers::<3>(&positions, self.buffers)?;
        if let Some(i) = vertices.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
            return Err(fail(&format!("vertex {i} lies at {:?}", vertices[i])));
        }
        let count = vertices.len();
        let normals = match primitive.get(&Semantic::Normals) {
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
        if uvs.iter().flatten().chain(normals.iter().flatten()).any(|v| !v.is_finite()) {
            return Err(fail("a normal or a texture coordinate is not finite"));
        }
        let indices: Vec<u32> = match primitive.indices() {
            Some(accessor) => numbers::<1>(&accessor, self.buffers)?.iter().map(|[i]| *i as u32).collect(),
            None => (0..count as u32).collect(),
        };
        if let Some(i) = indices.iter().position(|&i| i as usize >= count) {
            return Err(fail(&format!("index {i} names vertex {}; there are {count}", indices[i])));
        }
        let triangles = triangles(primitive.mode(), &indices);
        if triangles.is_empty() || triangles.len() > MAX_ELEMENTS {
            self.builder.leave_out(place, "it has no triangles, and is left out");
            return Ok(None);
        }
        let colours = self.colours(primitive, alpha, count, place)?;
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
        let file = self.builder.mesh_file(&mesh);
        Ok(Some(MadePart { file, mesh, material, emission, detail }))
    }

    /// Candela and lux become the format's units as they are: a luminance of 1 cd/m² is a radiance of 1.
    fn light(&mut self, lamp: &gltf::khr_lights_punctual::Light<'_>, node: &Node<'w>, matrix: &DAffine3) {
        use gltf::khr_lights_punctual::Kind;
        let place = format!("$.extensions.KHR_lights_punctual.lights[{}]", lamp.index());
        let spectrum = light(lamp.color().map(|c| f64::from(c).max(0.0)), f64::from(lamp.intensity()).max(0.0));
        let position = matrix.translation.to_array();
        let name = node.name().map_or_else(|| format!("light {}", lamp.index()), str::to_owned);
        if lamp.range().is_some() {
            self.builder.leave_out(&place, "its range is ignored: light has no range");
        }
        let value = match lamp.kind() {
            Kind::Directional => {
                json!({ "name": name, "type": "directional", "direction": forward(matrix), "irradiance": spectrum })
            }
            Kind::Point => json!({ "name": name, "type": "point", "position_m": position, "intensity": spectrum }),
            Kind::Spot { inner_cone_angle, outer_cone_angle } => {
                self.builder.approximate(&place, "between its two angles the light falls off by another curve");
                let outer = f64::from(outer_cone_angle).to_degrees().clamp(1e-3, 180.0);
                let inner = f64::from(inner_cone_angle).to_degrees().clamp(0.0, outer);
                json!({
                    "name": name, "type": "spot", "position_m": position, "direction": forward(matrix),
                    "intensity": spectrum, "half_angle_deg": outer, "inner_half_angle_deg": inner,
                })
            }
        };
        self.builder.lights.push(value);
    }
}

/// Where a camera or a lamp of a node points.
fn forward(matrix: &DAffine3) -> [f64; 3] {
    unit(-matrix.matrix3.z_axis).unwrap_or(DVec3::NEG_Z).to_array()
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
