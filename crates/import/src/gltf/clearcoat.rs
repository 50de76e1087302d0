//! `KHR_materials_clearcoat`: a coat of index 1.5 over a material. glTF mixes a material with and without it by a factor: so do blends here.
//!
//! A coat over a diffuse base is `plastic`. Over a base that has a coat of its own the clear coat takes its place. Over metal the format has
//! no coat: white facets of the same roughness take as much of it as the coat reflects head-on. They are nearer to glTF than the clear coat of
//! a `principled` surface, whose facets have long tails, and which takes nothing away from what is below.

use serde_json::{Value, json};

use super::layers::layer;
use super::material::Materials;
use super::number::Number;
use crate::Builder;

const KEY: &str = "KHR_materials_clearcoat";

/// What the coat reflects head-on, and at 60° from the normal by Schlick's formula, which glTF uses: 0.04 + 0.96 (1 − cos 60°)⁵.
const HEAD_ON: f64 = 0.04;
const AT_60_DEG: f64 = 0.07;

/// A clear coat.
pub(super) struct ClearCoat {
    /// Its share.
    factor: Number,
    roughness: Number,
}

impl ClearCoat {
    /// That of a material, if it has one that shows.
    pub(super) fn of(
        material: &gltf::Material<'_>,
        materials: &mut Materials<'_>,
        uv_set: &mut Option<u32>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<Self> {
        let value = material.extension_value(KEY)?;
        let place = format!("{place}.extensions.{KEY}");
        let mut number = |factor: &str, texture: &str, channel: &str, builder: &mut Builder<'_>| {
            materials.number((value, factor, texture), channel, &place, uv_set, buffers, builder)
        };
        let factor = number("clearcoatFactor", "clearcoatTexture", "red", builder);
        if matches!(factor, Number::Value(0.0)) {
            return None;
        }
        let roughness = number("clearcoatRoughnessFactor", "clearcoatRoughnessTexture", "green", builder);
        if value.get("clearcoatNormalTexture").is_some() {
            builder.leave_out(&place, "its normal map is left out: the coat has the normals of what is below");
        }
        Some(Self { factor, roughness })
    }

    /// What is not metal with it: `ground` is a diffuse base of a colour, bare or under a coat of its own of an index.
    pub(super) fn over_ground(
        &self,
        ground: Value,
        colour: &Value,
        own: Option<f64>,
        place: &str,
        builder: &mut Builder<'_>,
    ) -> Value {
        let mut coated =
            json!({ "type": "plastic", "reflectance": colour, "coat": 1.5, "internal_reflection": "uncoloured" });
        self.roughness.put_as_roughness(None, &mut coated);
        if let Some(index) = own {
            let own = ((index - 1.0) / (index + 1.0)).powi(2);
            let what = format!(
                "it takes the place of the base's own coat, which would reflect {:.3} of the light head-on below it",
                (1.0 - HEAD_ON) * own
            );
            builder.approximate(format!("{place}.extensions.{KEY}"), what);
        }
        self.factor.mixed(ground, coated)
    }

    /// A metal with it.
    pub(super) fn over_metal(&self, metal: Value) -> Value {
        let mut white = json!({ "type": "conductor", "reflectance": 1 });
        self.roughness.put_as_roughness(None, &mut white);
        self.factor.times(HEAD_ON).mixed(metal, layer(white, "clear coat"))
    }

    /// Lists what becomes of it on metal.
    pub(super) fn list_on_metal(&self, place: &str, builder: &mut Builder<'_>) {
        let [head_on, at_60_deg] = match self.factor {
            Number::Value(factor) => [HEAD_ON, AT_60_DEG].map(|share| format!("{:.3}", factor * share)),
            Number::Image(_) => [HEAD_ON, AT_60_DEG].map(|share| format!("{share} times its image")),
        };
        let what = format!(
            "on metal it becomes white facets, which take the share {head_on} at every angle: as much as the coat head-on; 60° from the \
             normal the coat would take {at_60_deg}"
        );
        builder.approximate(format!("{place}.extensions.{KEY}"), what);
    }
}

/// Lists the coat of a material that transmits light.
pub(super) fn leave_out(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    let factor = material.extension_value(KEY).and_then(|value| value["clearcoatFactor"].as_f64());
    if factor.is_some_and(|factor| factor > 0.0) {
        let what = "it is left out: what transmits light has no other coat than its own surface";
        builder.leave_out(format!("{place}.extensions.{KEY}"), what);
    }
}
