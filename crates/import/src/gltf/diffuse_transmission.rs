//! `KHR_materials_diffuse_transmission`: leaves, paper, cloth.

use serde_json::{Value, json};

use crate::{Builder, reflectance};

const KEY: &str = "KHR_materials_diffuse_transmission";

/// Whether a material that is not metal passes light.
pub(super) fn passes(material: &gltf::Material<'_>) -> bool {
    let factor = material.extension_value(KEY).and_then(|value| value["diffuseTransmissionFactor"].as_f64());
    factor.is_some_and(|factor| factor > 0.0)
}

/// The ground of a material, of which a share passes light to the other side.
pub(super) fn over(ground: Value, material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) -> Value {
    let Some(value) = material.extension_value(KEY) else { return ground };
    let number =
        |value: &Value, default: f64| value.as_f64().filter(|v| v.is_finite()).unwrap_or(default).clamp(0.0, 1.0);
    let factor = number(&value["diffuseTransmissionFactor"], 0.0);
    if factor == 0.0 {
        return ground;
    }
    let place = format!("{place}.extensions.{KEY}");
    if ["diffuseTransmissionTexture", "diffuseTransmissionColorTexture"].iter().any(|key| value.get(key).is_some()) {
        builder.leave_out(&place, "its images are left out");
    }
    if ground["type"] != "lambert" {
        builder.approximate(&place, "the coat covers only the share of the surface that does not pass light");
    }
    let colour = [0, 1, 2].map(|c| number(&value["diffuseTransmissionColorFactor"][c], 1.0));
    let sheet = json!({ "type": "translucent", "reflectance": 0, "transmittance": reflectance(colour) });
    if factor == 1.0 {
        return sheet;
    }
    json!({ "type": "blend", "first": ground, "second": sheet, "weight": factor })
}
