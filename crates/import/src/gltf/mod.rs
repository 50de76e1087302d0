//! glTF 2.0: nodes, meshes, cameras and lights.

mod accessor;
mod animation;
mod anisotropy;
mod base_colour;
mod camera;
mod clearcoat;
mod colours;
mod compression;
mod diffuse_transmission;
mod extensions;
mod file;
mod image;
mod instancing;
mod iridescence;
mod layers;
mod light;
mod material;
mod morph;
mod number;
mod part;
mod sheen;
mod skin;
mod specular;
mod specular_glossiness;
mod transmission;
mod variants;
mod volume;

use std::collections::{HashMap, HashSet};

use etalon_scene::linear::is_similarity;
use glam::{DAffine3, DVec3};
use gltf::Node;
use gltf::mesh::Semantic;

use crate::{Builder, Options};
use animation::{Animated, Pose};
use file::{check_images, check_lights, check_primitives, json, parse};
use material::Materials;
use part::{MadePart, Shape};
use skin::Skeletons;

/// Deepest nesting of nodes.
const MAX_DEPTH: usize = 256;

/// Things that move within things that move: each takes up to two groups within each other, of which the format knows sixteen.
const MAX_MOVING: usize = 7;

pub(super) fn import(bytes: &[u8], options: &Options, builder: &mut Builder<'_>) -> Result<(), String> {
    let moment = options.moment.as_ref();
    let stated = json(bytes)?;
    extensions::check_required(&stated)?;
    check_primitives(&stated, builder)?;
    let channels = extensions::channels_of_nodes(&stated);
    drop(stated);
    let (file, buffers) = parse(bytes, builder)?;
    check_images(&file)?;
    check_lights(&file)?;
    extensions::list_unread(&file.as_json().extensions_used, builder);
    let variant = variants::asked(&file, options.variant.as_deref(), builder)?;
    let animated = Animated::read(&file, &channels, &buffers, moment, builder)?;
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
        materials: Materials::new(&file),
        skeletons: Skeletons::new(&file, &animated),
        parts: HashMap::new(),
        shape_groups: HashMap::new(),
        made: 0,
        bent: 0,
        skinned: Vec::new(),
        visited: vec![false; file.nodes().count()],
        uses: HashMap::new(),
        is_hidden: false,
    };
    let scene = file.default_scene().or_else(|| file.scenes().next()).ok_or("it has no scene")?;
    for other in file.scenes().filter(|other| other.index() != scene.index()) {
        walk.builder.leave_out(format!("$.scenes[{}]", other.index()), "only one scene is imported");
    }
    for (node, mesh) in file.nodes().filter_map(|node| node.mesh().map(|mesh| (node, mesh))) {
        // What is wrong with its shape is said if it is in the scene.
        if let Ok(shape) = walk.shape(&node, &mesh) {
            let placements = walk.placements(&node);
            let uses = walk.uses.entry((mesh.index(), shape)).or_default();
            *uses = uses.saturating_add(placements);
        }
    }
    for node in scene.nodes() {
        walk.node(&node, &DAffine3::IDENTITY, 0)?;
    }
    walk.place_skinned()?;
    walk.add_backs();
    Ok(())
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
    materials: Materials<'w>,
    skeletons: Skeletons,
    /// Parts by mesh, primitive and shape; `None` is one without triangles.
    parts: HashMap<(usize, usize, Shape), Option<MadePart>>,
    /// The groups of parts that are placed again and again.
    shape_groups: HashMap<(usize, usize, Shape), String>,
    /// Vertices and triangles of all parts.
    made: usize,
    /// Those of parts that are bent.
    bent: usize,
    /// Primitives that joints place, with their names.
    skinned: Vec<(gltf::Mesh<'w>, gltf::Primitive<'w>, String, Shape)>,
    visited: Vec<bool>,
    /// How often each mesh is placed in each shape: one that is placed again and again is a group with instances.
    uses: HashMap<(usize, Shape), usize>,
    /// Whether the node at hand, or one around it, is hidden.
    is_hidden: bool,
}

impl<'w> Walk<'w, '_> {
    fn visit(&mut self, node: &Node<'w>, parent: &DAffine3, depth: usize) -> Result<(), String> {
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
        if let Some(lamp) = node.light().filter(|_| !self.is_hidden) {
            let [opens, closes] = self.animated.shutter_s;
            if !self.chain.is_empty() {
                let what =
                    "a light without a surface cannot move: it stays at its place in the middle of the shutter time";
                self.builder.leave_out(&place, what);
            }
            let world = self.world(matrix, 0.5 * (opens + closes));
            self.light(&lamp, node, &world);
        }
        if let Some(mesh) = node.mesh().filter(|_| !self.is_hidden) {
            let shape = self.shape(node, &mesh)?;
            let places = self.places(node, matrix)?;
            for primitive in mesh.primitives() {
                let name = match (node.name().or(mesh.name()), mesh.primitives().len()) {
                    (Some(name), 1) => name.to_owned(),
                    (Some(name), _) => format!("{name}, part {}", primitive.index()),
                    (None, _) => format!("node {}, part {}", node.index(), primitive.index()),
                };
                let mut shape = shape.clone();
                if shape.skin.is_some() && primitive.get(&Semantic::Joints(0)).is_none() {
                    let at = format!("$.meshes[{}].primitives[{}]", mesh.index(), primitive.index());
                    self.builder.approximate(at, "it has a skin, but no JOINTS_0: its node places it");
                    shape.skin = None;
                }
                match shape.skin {
                    // Its joints place it in the world, wherever its node is.
                    Some(_) => {
                        self.list_unused_places(node);
                        self.skinned.push((mesh.clone(), primitive, name, shape));
                    }
                    None => {
                        for map in &places {
                            self.place((&mesh, &primitive, &shape), &name, map)?;
                        }
                    }
                }
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

    /// Adds what joints place. The same mesh with the same joints is in one place, whatever nodes have it.
    fn place_skinned(&mut self) -> Result<(), String> {
        let mut placed = HashSet::new();
        for (mesh, primitive, name, shape) in std::mem::take(&mut self.skinned) {
            if placed.insert((mesh.index(), primitive.index(), shape.clone())) {
                self.place((&mesh, &primitive, &shape), &name, &DAffine3::IDENTITY)?;
            } else {
                let what = "the same joints place the same mesh for another node: it is left out";
                self.builder.leave_out(format!("node \"{name}\""), what);
            }
        }
        Ok(())
    }

    /// Adds a primitive where a node places it; its mesh is made once for each shape.
    fn place(
        &mut self,
        (mesh, primitive, shape): (&gltf::Mesh<'w>, &gltf::Primitive<'w>, &Shape),
        name: &str,
        matrix: &DAffine3,
    ) -> Result<(), String> {
        let key = (mesh.index(), primitive.index(), shape.clone());
        if !self.parts.contains_key(&key) {
            let made = self.part(primitive, shape, &format!("$.meshes[{}].primitives[{}]", key.0, key.1))?;
            self.parts.insert(key.clone(), made);
        }
        let Some(Some(part)) = self.parts.get(&key) else { return Ok(()) };
        let determinant = matrix.matrix3.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            self.builder.leave_out(format!("node \"{name}\""), "it is flattened by its transform, and left out");
            return Ok(());
        }
        // One that has a skin but no joints is not counted with its shape: it is an object each time.
        if shape.skin.is_some() || self.uses.get(&(key.0, shape.clone())).is_none_or(|uses| *uses < 2) {
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
        // Names of groups are given once, in the order of their shapes.
        let known = self.shape_groups.get(&key).cloned();
        let group = known.unwrap_or_else(|| self.builder.group_name(&format!("mesh {}, part {}", key.0, key.1)));
        if self.shape_groups.insert(key.clone(), group.clone()).is_none() {
            let outside = self.builder.begin_group();
            let more = (part.emission.clone(), &part.detail);
            self.builder.add_object(&group, &part.file, &part.mesh, &part.material, more, &DAffine3::IDENTITY);
            self.builder.end_group(&group, outside);
        }
        self.builder.place_group(name, &group, matrix, &format!("node \"{name}\""));
        Ok(())
    }
}
