//! `EXT_mesh_gpu_instancing`: a node that places its mesh at many places.

use glam::{DAffine3, DQuat, DVec3};
use gltf::Node;
use serde_json::{Map, Value, json};

use super::Walk;
use super::accessor::numbers;
use crate::matrix::rows;

const NAME: &str = "EXT_mesh_gpu_instancing";

/// Attributes that say where a mesh is.
const READ: [&str; 3] = ["TRANSLATION", "ROTATION", "SCALE"];

/// What a node states of the places of its mesh, if anything.
fn attributes<'n>(node: &'n Node<'_>) -> Option<&'n Map<String, Value>> {
    node.extension_value(NAME)?["attributes"].as_object().filter(|attributes| !attributes.is_empty())
}

impl<'w> Walk<'w, '_> {
    /// How often a node places its mesh.
    pub(super) fn placements(&self, node: &Node<'w>) -> usize {
        let Some(attributes) = attributes(node) else { return 1 };
        attributes.values().filter_map(|index| self.accessor(index)).map(|accessor| accessor.count()).max().unwrap_or(0)
    }

    /// The maps from the mesh of a node to what the node's own map leads to: one, unless the node says where it has the mesh.
    pub(super) fn places(&mut self, node: &Node<'w>, matrix: &DAffine3) -> Result<Vec<DAffine3>, String> {
        let Some(attributes) = attributes(node) else { return Ok(vec![*matrix]) };
        let place = format!("$.nodes[{}].extensions.{NAME}", node.index());
        // Any attribute says how many places there are, whatever it is for.
        let mut lengths = Vec::new();
        for (key, index) in attributes {
            lengths.push(self.stated_accessor(index, &place)?.count());
            if !READ.contains(&key.as_str()) {
                self.builder.leave_out(format!("{place}.attributes.{key}"), "it is ignored");
            }
        }
        let count = lengths.first().copied().unwrap_or(0);
        if lengths.iter().any(|length| *length != count) {
            return Err(format!("{place}: its attributes have different lengths"));
        }
        let translations = self.attribute::<3>(attributes.get("TRANSLATION"), &place)?;
        let rotations = self.attribute::<4>(attributes.get("ROTATION"), &place)?;
        let scales = self.attribute::<3>(attributes.get("SCALE"), &place)?;
        let mut maps = Vec::new();
        for i in 0..count {
            let of =
                |list: &Option<Vec<[f64; 3]>>, default: DVec3| list.as_ref().map_or(default, |list| list[i].into());
            let turn = rotations.as_ref().map_or(DQuat::IDENTITY, |list| DQuat::from_array(list[i]).normalize());
            let (scale, to) = (of(&scales, DVec3::ONE), of(&translations, DVec3::ZERO));
            let map = *matrix * DAffine3::from_scale_rotation_translation(scale, turn, to);
            if !map.is_finite() {
                return Err(format!("{place}: the transform of instance {i} is not finite"));
            }
            self.builder.spend(&json!(rows(&map)), &place)?;
            maps.push(map);
        }
        Ok(maps)
    }

    /// Lists that a mesh which joints place is not at the places that its node states.
    pub(super) fn list_unused_places(&mut self, node: &Node<'w>) {
        if attributes(node).is_some() {
            let place = format!("$.nodes[{}].extensions.{NAME}", node.index());
            self.builder.leave_out(place, "it is ignored: the mesh is where its joints place it");
        }
    }

    fn attribute<const N: usize>(&self, index: Option<&Value>, place: &str) -> Result<Option<Vec<[f64; N]>>, String> {
        let Some(index) = index else { return Ok(None) };
        numbers::<N>(&self.stated_accessor(index, place)?, self.buffers).map(Some)
    }

    fn stated_accessor(&self, index: &Value, place: &str) -> Result<gltf::Accessor<'w>, String> {
        self.accessor(index).ok_or_else(|| format!("{place}: it names accessor {index}, which does not exist"))
    }

    fn accessor(&self, index: &Value) -> Option<gltf::Accessor<'w>> {
        let index = index.as_u64().and_then(|index| usize::try_from(index).ok())?;
        self.document.accessors().nth(index)
    }
}
