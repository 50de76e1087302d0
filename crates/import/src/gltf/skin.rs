//! Skins: vertices that follow joints.

use std::collections::HashMap;
use std::rc::Rc;

use etalon_scene::linear::cofactors;
use glam::{DAffine3, DVec3};
use gltf::mesh::Semantic;
use gltf::{Document, Primitive, Skin};

use super::accessor::numbers;
use super::animation::Animated;
use super::{MAX_DEPTH, Walk};

/// Most sets of four joints of a vertex.
const MOST_SETS: u32 = 16;
/// Weights of a vertex are listed if they add up to 1 no better than this.
const OFF: f64 = 0.01;

/// The joints and weights of each vertex, four of each.
type Set = Vec<[(usize, f64); 4]>;

/// The joints of a skin.
#[derive(Clone, Debug)]
struct Joints {
    /// From the coordinates of a mesh to the world.
    matrices: Rc<[DAffine3]>,
    /// Whether some move while the shutter is open.
    moving: bool,
}

/// The joints of all skins that are used.
#[derive(Debug, Default)]
pub(super) struct Skeletons {
    parents: Vec<Option<usize>>,
    moving: Vec<bool>,
    known: HashMap<usize, Joints>,
}

impl Skeletons {
    pub(super) fn new(file: &Document, animated: &Animated) -> Self {
        if file.skins().len() == 0 {
            return Self::default();
        }
        let mut parents = vec![None; file.nodes().len()];
        for node in file.nodes() {
            for child in node.children() {
                parents[child.index()] = Some(node.index());
            }
        }
        let moving = file.nodes().map(|node| animated.motion(&node).is_some()).collect();
        Self { parents, moving, known: HashMap::new() }
    }
}

impl Walk<'_, '_> {
    /// Moves the vertices of a primitive with the joints of a skin, and turns its normals. Where joints mirror, triangles turn over.
    pub(super) fn bend(
        &mut self,
        primitive: &Primitive<'_>,
        skin: usize,
        (vertices, normals): (&mut [[f64; 3]], &mut [[f64; 3]]),
        triangles: &mut [[u32; 3]],
        place: &str,
    ) -> Result<(), String> {
        let Some(skin) = self.document.skins().nth(skin) else { return Ok(()) };
        let joints = self.joints(&skin)?;
        let sets = self.sets(primitive, vertices.len(), joints.matrices.len(), place)?;
        let (mut without, mut uneven) = (0_usize, 0_usize);
        let mut mirrored = vec![false; vertices.len()];
        for (i, vertex) in vertices.iter_mut().enumerate() {
            let weighted = sets.iter().flat_map(|set| set[i]).filter(|(_, weight)| *weight > 0.0);
            let sum: f64 = weighted.clone().map(|(_, weight)| weight).sum();
            uneven += usize::from(sum > 0.0 && (sum - 1.0).abs() > OFF);
            let map = if sum > 0.0 {
                let part = |(joint, weight): (usize, f64)| (joints.matrices[joint], weight / sum);
                weighted.map(part).fold(DAffine3::ZERO, |map, (joint, share)| DAffine3 {
                    matrix3: map.matrix3 + joint.matrix3 * share,
                    translation: map.translation + joint.translation * share,
                })
            } else {
                without += 1;
                joints.matrices[0]
            };
            *vertex = map.transform_point3(DVec3::from(*vertex)).to_array();
            mirrored[i] = map.matrix3.determinant() < 0.0;
            if let Some(normal) = normals.get_mut(i) {
                let turned = cofactors(&map.matrix3) * DVec3::from(*normal);
                *normal = if mirrored[i] { -turned } else { turned }.to_array();
            }
        }
        for triangle in triangles.iter_mut().filter(|t| t.iter().filter(|i| mirrored[**i as usize]).count() > 1) {
            triangle.swap(1, 2);
        }
        let at = format!("{place}.attributes.WEIGHTS_0");
        if without > 0 {
            self.builder.approximate(&at, format!("{without} vertices have no weight: they follow the first joint"));
        }
        if uneven > 0 {
            let what = format!("the weights of {uneven} vertices do not add up to 1: they are scaled");
            self.builder.approximate(&at, what);
        }
        if joints.moving {
            let what = "its joints move while the shutter is open: it stays as it is when the shutter opens";
            self.builder.approximate(format!("$.skins[{}]", skin.index()), what);
        }
        Ok(())
    }

    /// The joints of a skin: where each is in the world when the shutter opens, after the inverse of where it was when the mesh was bound to it.
    fn joints(&mut self, skin: &Skin<'_>) -> Result<Joints, String> {
        if let Some(known) = self.skeletons.known.get(&skin.index()) {
            return Ok(known.clone());
        }
        let place = format!("$.skins[{}]", skin.index());
        let count = skin.joints().len();
        let inverses: Vec<DAffine3> = match skin.inverse_bind_matrices() {
            None => vec![DAffine3::IDENTITY; count],
            Some(accessor) => {
                let matrices = numbers::<16>(&accessor, self.buffers).map_err(|why| format!("{place}: {why}"))?;
                // The last row of a matrix that moves and turns things is 0 0 0 1.
                let affine = |m: &[f64; 16]| {
                    DAffine3::from_cols_array(&[
                        m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10], m[12], m[13], m[14],
                    ])
                };
                matrices.iter().map(affine).collect()
            }
        };
        if count == 0 || inverses.len() < count {
            return Err(format!("{place}: {} inverse bind matrices for {count} joints", inverses.len()));
        }
        let mut moving = false;
        let mut matrices = Vec::with_capacity(count);
        for (k, (joint, inverse)) in skin.joints().zip(inverses).enumerate() {
            let (world, moves) = self.of_joint(joint.index(), &place)?;
            moving |= moves;
            let matrix = world * inverse;
            if !matrix.is_finite() {
                return Err(format!("{place}: the matrix of joint {k} is not finite"));
            }
            matrices.push(matrix);
        }
        let joints = Joints { matrices: matrices.into(), moving };
        self.skeletons.known.insert(skin.index(), joints.clone());
        Ok(joints)
    }

    /// Where a node is in the world when the shutter opens, and whether it moves until it closes.
    fn of_joint(&self, node: usize, place: &str) -> Result<(DAffine3, bool), String> {
        let (mut map, mut moving) = (DAffine3::IDENTITY, false);
        let mut above = Some(node);
        for _ in 0..=MAX_DEPTH {
            let Some(index) = above else { return Ok((map, moving)) };
            let Some(node) = self.document.nodes().nth(index) else { break };
            map = self.animated.local(&node, self.animated.shutter_s[0]) * map;
            moving |= self.skeletons.moving[index];
            above = self.skeletons.parents[index];
        }
        Err(format!("{place}: above joint $.nodes[{node}] nodes are nested more than {MAX_DEPTH} deep"))
    }

    /// The joints and weights of each vertex, in sets of four.
    fn sets(&self, primitive: &Primitive<'_>, count: usize, joints: usize, place: &str) -> Result<Vec<Set>, String> {
        let mut sets = Vec::new();
        for set in 0.. {
            let accessors = [Semantic::Joints(set), Semantic::Weights(set)].map(|semantic| primitive.get(&semantic));
            let [of_joints, of_weights] = match accessors {
                [None, None] => break,
                [Some(of_joints), Some(of_weights)] => [of_joints, of_weights],
                _ => return Err(format!("{place}: of JOINTS_{set} and WEIGHTS_{set} it has only one")),
            };
            if set == MOST_SETS {
                return Err(format!("{place}: it has more than {MOST_SETS} sets of joints"));
            }
            let [indices, weights] = [("JOINTS", of_joints), ("WEIGHTS", of_weights)].map(|(what, accessor)| {
                let list = numbers::<4>(&accessor, self.buffers).map_err(|why| format!("{place}: {why}"))?;
                let fits = list.len() == count;
                fits.then_some(list).ok_or_else(|| {
                    format!("{place}.attributes.{what}_{set}: {} elements for {count} vertices", accessor.count())
                })
            });
            let (indices, weights) = (indices?, weights?);
            let mut rows = Vec::with_capacity(count);
            for (i, (indices, weights)) in indices.iter().zip(&weights).enumerate() {
                let of_vertex: [(usize, f64); 4] = std::array::from_fn(|k| (indices[k] as usize, weights[k]));
                for (joint, weight) in of_vertex {
                    if !weight.is_finite() || weight < 0.0 {
                        return Err(format!("{place}.attributes.WEIGHTS_{set}: vertex {i} has the weight {weight}"));
                    }
                    if weight > 0.0 && joint >= joints {
                        return Err(format!(
                            "{place}.attributes.JOINTS_{set}: vertex {i} names joint {joint}; there are {joints}"
                        ));
                    }
                }
                rows.push(of_vertex);
            }
            sets.push(rows);
        }
        Ok(sets)
    }
}
