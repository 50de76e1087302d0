//! `KHR_materials_anisotropy`: roughness that differs along a direction and across it.

use etalon_scene::LEAST_ALPHA;
use serde_json::{Value, json};

use super::number::Number;
use crate::Builder;

/// `KHR_materials_anisotropy`: along a direction the width α becomes α + (1 − α)s², s the strength. The direction is that of growing u,
/// turned toward the top of the image.
pub(super) struct Anisotropy {
    strength: f64,
    rotation_rad: f64,
}

impl Anisotropy {
    pub(super) fn of(
        material: &gltf::Material<'_>,
        roughness: &Number,
        place: &str,
        builder: &mut Builder<'_>,
    ) -> Option<Self> {
        let value = material.extension_value("KHR_materials_anisotropy")?;
        let number = |key: &str| value[key].as_f64().unwrap_or(0.0);
        let place = format!("{place}.extensions.KHR_materials_anisotropy");
        let strength = number("anisotropyStrength").clamp(0.0, 1.0);
        if strength == 0.0 {
            return None;
        }
        if matches!(roughness, Number::Image(_)) {
            builder.leave_out(place, "it is left out, since an image says the roughness");
            return None;
        }
        if value.get("anisotropyTexture").is_some() {
            builder.leave_out(place, "its image is left out: strength and rotation are the same everywhere");
        }
        Some(Self { strength, rotation_rad: number("anisotropyRotation") })
    }

    pub(super) fn put(&self, alpha: f64, material: &mut Value) {
        let alpha = alpha.max(LEAST_ALPHA);
        material["alpha_u"] = json!((alpha + (1.0 - alpha) * self.strength * self.strength).min(1.0));
        material["alpha_v"] = json!(alpha);
        if self.rotation_rad != 0.0 {
            material["tangent_rotation_deg"] = json!(self.rotation_rad.to_degrees());
        }
    }
}
