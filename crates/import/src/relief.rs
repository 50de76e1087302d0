//! Normal and bump maps, as keys of the objects that have them.

use serde_json::{Map, Value, json};

/// The keys of the maps, of which an object has one at most.
const MAPS: [&str; 2] = ["normal_map", "bump_map"];

/// Whether the keys of an object give it a map.
pub(crate) fn has_map(detail: &Map<String, Value>) -> bool {
    MAPS.iter().any(|key| detail.contains_key(*key))
}

/// Takes the map away; whether there was one.
pub(crate) fn without_map(detail: &mut Map<String, Value>) -> bool {
    MAPS.iter().any(|key| detail.remove(*key).is_some())
}

/// The map of a surface whose outer side is the format's inner one: heights are depths, and a normal x·t + y·(−n × t) + z·(−n)
/// is that of −x, y and z about n, turned around.
pub(crate) fn turn_over(detail: &mut Map<String, Value>) {
    if let Some(bumps) = detail.get_mut("bump_map") {
        bumps["height_m"] = json!(-bumps["height_m"].as_f64().unwrap_or(0.0));
    }
    if let Some(normals) = detail.get_mut("normal_map") {
        let green = normals["strength"][1].as_f64().unwrap_or(1.0);
        normals["strength"] = json!([-1.0, green]);
    }
}
