//! Groups of objects, and the instances that place them.

use glam::DAffine3;
use serde_json::{Value, json};

use super::{Bounds, Builder};
use crate::matrix::{rows, steps};

/// The objects, instances, bounds and emitted light of what is outside of a group that is being made.
pub(crate) type Outside = (Vec<Value>, Vec<Value>, Bounds, f64);

/// The keys of a medium that say what it is from place to place.
const GRIDS: [&str; 2] = ["density", "albedo_grid"];

/// The keys of a material's media that may be grids: that of the medium, and its own.
fn places_of_grids() -> impl Iterator<Item = [&'static str; 2]> {
    ["medium", "exterior_medium"].into_iter().flat_map(|medium| GRIDS.map(|key| [medium, key]))
}

impl Builder<'_> {
    pub(crate) fn group_name(&mut self, wanted: &str) -> String {
        self.group_names.name(wanted, &self.groups)
    }

    /// From here on objects belong to a group. Gives what is outside of it.
    pub(crate) fn begin_group(&mut self) -> Outside {
        let emitted = std::mem::take(&mut self.emitted);
        (std::mem::take(&mut self.objects), std::mem::take(&mut self.instances), self.bounds.take(), emitted)
    }

    pub(crate) fn end_group(&mut self, name: &str, (objects, instances, bounds, emitted): Outside) {
        let mut group = json!({ "objects": std::mem::replace(&mut self.objects, objects) });
        let within = std::mem::replace(&mut self.instances, instances);
        if !within.is_empty() {
            group["instances"] = json!(within);
        }
        self.groups.insert(name.to_owned(), group);
        self.group_bounds.insert(name.to_owned(), std::mem::replace(&mut self.bounds, bounds));
        self.group_emitted.insert(name.to_owned(), std::mem::replace(&mut self.emitted, emitted));
    }

    /// Places a group.
    pub(crate) fn place_group(&mut self, name: &str, group: &str, map: &DAffine3, place: &str) {
        let determinant = map.matrix3.determinant();
        let Some(Some(bounds)) = self.group_bounds.get(group).copied() else {
            self.leave_out(
                place,
                format!("the group \"{group}\" is empty or does not exist: its instance is left out"),
            );
            return;
        };
        if determinant == 0.0 || !determinant.is_finite() {
            self.leave_out(place, "it is flattened by its transform, and left out");
            return;
        }
        let mut instance = json!({ "name": name, "group": group });
        let transform = steps(map);
        if !transform.is_null() {
            instance["transform"] = transform;
        }
        self.instances.push(instance);
        self.list_moved_grids(group, place);
        self.enclose(bounds, map);
        self.count_emitted(group, map);
    }

    /// The material of an object, where a grid says how dense or how white its medium is from place to place.
    fn material_with_grids(&self, object: &Value) -> Option<Value> {
        let material = match &object["material"] {
            Value::String(name) => self.materials.get(name)?,
            own => own,
        };
        places_of_grids().any(|[medium, key]| material[medium][key]["file"].is_string()).then(|| material.clone())
    }

    /// Keeps the grids of an object's medium where they are in the world, though its group is placed: by the map from the world to the group.
    pub(super) fn keep_grids(&self, object: &mut Value, to_group: &DAffine3) {
        let Some(mut material) = self.material_with_grids(object) else { return };
        for [medium, key] in places_of_grids() {
            let grid = material.get_mut(medium).and_then(|medium| medium.get_mut(key));
            let Some(grid) = grid.filter(|grid| grid["file"].is_string()) else { continue };
            let mut transform = grid["transform"].as_array().cloned().unwrap_or_default();
            transform.push(json!({ "matrix": rows(to_group) }));
            grid["transform"] = json!(transform);
        }
        object["material"] = material;
    }

    /// Lists the grids of media that move with a group, which other programs leave in the world.
    fn list_moved_grids(&mut self, group: &str, place: &str) {
        let objects = self.groups.get(group).and_then(|group| group["objects"].as_array());
        if objects.into_iter().flatten().any(|object| self.material_with_grids(object).is_some()) {
            self.approximate(
                place,
                "the grid of its medium is placed with the body; there it has coordinates of the world",
            );
        }
    }

    /// Counts the light that an instance of a group emits.
    fn count_emitted(&mut self, group: &str, map: &DAffine3) {
        // An area grows by the square of the lengths; one that is stretched, by that of their geometric mean.
        let scale = map.matrix3.determinant().abs().cbrt();
        self.emitted += self.group_emitted.get(group).copied().unwrap_or(0.0) * scale * scale;
    }

    /// Places a group that moves: keyframes are times, s, and maps at them.
    pub(crate) fn place_moving(&mut self, name: &str, group: &str, keyframes: &[(f64, DAffine3)]) {
        let Some(Some(bounds)) = self.group_bounds.get(group).copied() else {
            // There is nothing in it.
            self.groups.remove(group);
            return;
        };
        let frames: Vec<Value> = keyframes
            .iter()
            .map(|(time_s, map)| json!({ "time_s": time_s, "transform": [{ "matrix": rows(map) }] }))
            .collect();
        self.instances.push(json!({ "name": name, "group": group, "keyframes": frames }));
        keyframes.iter().for_each(|(_, map)| self.enclose(bounds, map));
        if let Some((_, map)) = keyframes.first() {
            self.count_emitted(group, map);
        }
    }
}
