//! Layers over a material, which do not have its base colour: clear coat and sheen.

use serde_json::{Value, json};

use crate::vertex_colours::tint;

/// A part of a blend that is a layer; its comment says so.
pub(super) fn layer(mut material: Value, name: &str) -> Value {
    material["comment"] = json!(name);
    material
}

/// Multiplies the base colour of a material by the colours of the vertices, and nothing of its layers; whether it has a base colour.
pub(super) fn tint_base(material: &mut Value) -> bool {
    if material.get("comment").is_some() {
        return false;
    }
    if material["type"] != "blend" {
        return tint(material);
    }
    ["first", "second"].map(|part| tint_base(&mut material[part])).contains(&true)
}
