//! `KHR_materials_specular`: how much the surface of what is not metal reflects.
//!
//! glTF mixes the bare base and what the coat reflects in proportion to `specularFactor`: so does a blend here. `specularColorFactor` is a factor
//! on what the coat reflects head-on, up to all of it: that of another index. Its hue becomes a tint of the coat.

use serde_json::{Value, json};

use super::material::{Materials, decimal, index};
use super::number::Number;
use crate::{Builder, reflectance};

const KEY: &str = "extensions.KHR_materials_specular";

/// The most that a coat of an index reflects head-on.
const MOST_HEAD_ON: f64 = 0.9;

/// What the surface of a material reflects.
pub(super) struct Specular {
    /// The share of the surface that has a coat.
    factor: Number,
    /// Factors on what the coat reflects head-on.
    colour: [f64; 3],
}

impl Specular {
    /// That of a material; of one without the extension a whole coat.
    pub(super) fn of(
        material: &gltf::Material<'_>,
        materials: &mut Materials<'_>,
        uv_set: &mut Option<u32>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Self {
        let Some(specular) = material.specular() else { return Self { factor: Number::Value(1.0), colour: [1.0; 3] } };
        let factor = decimal(specular.specular_factor()).clamp(0.0, 1.0);
        let info = specular.specular_texture();
        let at = format!("{place}.{KEY}.specularTexture");
        let factor = materials.factor_on((factor, info), "alpha", &at, uv_set, buffers, builder);
        if specular.specular_color_texture().is_some() {
            builder.leave_out(format!("{place}.{KEY}.specularColorTexture"), "it is left out: the factor alone counts");
        }
        Self { factor, colour: specular.specular_color_factor().map(|c| decimal(c).max(0.0)) }
    }

    /// The index of the coat; `None` where nothing is reflected.
    pub(super) fn coat(&self, material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) -> Option<Value> {
        let own = index(material, place, builder);
        let most = self.strongest();
        if matches!(self.factor, Number::Value(0.0)) || own == json!(1.0) {
            return None;
        }
        if most == 1.0 {
            return Some(own);
        }
        if most == 0.0 {
            let what = "a black colour takes the whole coat: what it reflects at grazing angles is left out";
            builder.approximate(format!("{place}.{KEY}"), what);
            return None;
        }
        let ior = decimal(material.ior().unwrap_or(1.5)).max(1.0);
        let root = ((ior - 1.0) / (ior + 1.0) * most.sqrt()).min(MOST_HEAD_ON.sqrt());
        Some(json!((1.0 + root) / (1.0 - root)))
    }

    fn strongest(&self) -> f64 {
        self.colour.into_iter().fold(0.0, f64::max)
    }

    /// A coated base where the surface reflects, and the bare one where it does not.
    pub(super) fn over(&self, bare: Value, mut coated: Value, place: &str, builder: &mut Builder<'_>) -> Value {
        let most = self.strongest();
        if self.colour != [most; 3] {
            coated["reflected_tint"] = reflectance(self.colour.map(|channel| channel / most));
            let what =
                "its hue is that of what the coat reflects at every angle; that of glTF is white at grazing angles";
            builder.approximate(format!("{place}.{KEY}"), what);
        }
        self.factor.mixed(bare, coated)
    }
}

/// Lists what it would change of a material that is all glass.
pub(super) fn leave_out(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    let changes = material.specular().is_some_and(|specular| {
        specular.specular_factor() != 1.0
            || specular.specular_texture().is_some()
            || specular.specular_color_factor() != [1.0; 3]
            || specular.specular_color_texture().is_some()
    });
    if changes {
        builder.leave_out(format!("{place}.{KEY}"), "it is ignored: what transmits light reflects by its index");
    }
}
