//! Objects where a transform places them.

use etalon_scene::linear::is_similarity;
use glam::DAffine3;
use serde_json::{Map, Value, json};

use super::{Builder, WITHOUT_AREA};
use crate::matrix::steps;
use crate::medium::exchange_sides;
use crate::relief::turn_over;
use crate::sides::change_sides;

/// An object that is to be placed.
pub(crate) struct Placed {
    pub(crate) name: String,
    /// A shape of the format.
    pub(crate) shape: Value,
    /// Two corners of a box around it, before its transform.
    pub(crate) reach: [[f64; 3]; 2],
    pub(crate) material: Value,
    pub(crate) emission: Option<Value>,
    pub(crate) opacity: f64,
    /// Further keys of the object.
    pub(crate) detail: Map<String, Value>,
    pub(crate) map: DAffine3,
    /// Whether its normals point the other way.
    pub(crate) flipped: bool,
}

impl Builder<'_> {
    /// Adds an object. One whose transform flattens it is left out. A round one that is stretched becomes an instance, or a mesh if it emits.
    ///
    /// # Errors
    /// If there are more objects than a scene can hold.
    pub(crate) fn place(&mut self, placed: &Placed, place: &str) -> Result<(), String> {
        let determinant = placed.map.matrix3.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            self.leave_out(place, "it is flattened by its transform, and left out");
            return Ok(());
        }
        if placed.shape["file"].as_str().is_some_and(|file| self.flat_meshes.contains(file)) {
            self.leave_out(place, WITHOUT_AREA);
            return Ok(());
        }
        let (material, emission) = self.sides(placed);
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
        let mut map = placed.map;
        let mut stretched = round && !is_similarity(&map.matrix3);
        if stretched
            && emission.is_some()
            && let Some(lamp) = self.stretched_lamp(&placed.shape, &map, place)
        {
            (object["shape"], map) = lamp;
            stretched = false;
        }
        if stretched && emission.is_some() {
            self.leave_out(place, "its emission is left out: an emitting shape of this kind cannot be stretched");
        } else if let Some(emission) = emission {
            self.spend(&emission, place)?;
            object["emission"] = emission;
            self.emits = true;
        }
        if stretched {
            let group = self.group_name(&placed.name);
            self.keep_grids(&mut object, &map.inverse());
            self.groups.insert(group.clone(), json!({ "objects": [object] }));
            self.instances.push(json!({ "name": placed.name, "group": group, "transform": steps(&map) }));
        } else {
            let transform = steps(&map);
            if !transform.is_null() {
                object["transform"] = transform;
            }
            self.objects.push(object);
        }
        self.enclose(placed.reach, &placed.map);
        Ok(())
    }

    /// The material and the emission of an object, the other way round if it is flipped.
    fn sides(&self, placed: &Placed) -> (Value, Option<Value>) {
        let mut material = placed.material.clone();
        let mut emission = placed.emission.clone();
        if placed.flipped {
            // Which side is which matters to a dielectric and to what shines on one side.
            let own = material.as_str().and_then(|name| self.materials.get(name)).cloned().unwrap_or(material.clone());
            if own["type"] == "dielectric" {
                material = own.clone();
                material["interior"] = own.get("exterior").cloned().unwrap_or(json!(1));
                material["exterior"] = own["interior"].clone();
                exchange_sides(&mut material, self.medium.as_ref());
            }
            let mut turned = own.clone();
            change_sides(&mut turned, &|sides| match sides {
                "front" => "back",
                "back" => "front",
                _ => "both",
            });
            if turned != own {
                material = turned;
            }
            if let Some(emission) = &mut emission {
                emission["sides"] = json!(if emission["sides"] == "back" { "front" } else { "back" });
            }
        }
        (material, emission)
    }
}
