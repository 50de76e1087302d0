//! Mitsuba's `principled` material, by the materials of the format that come nearest.

use etalon_scene::Encoding;
use serde_json::{Value, json};

use super::Walk;
use super::colour::Of;
use super::element::Element;
use crate::number::{Number, Rough};
use crate::reflectance;
use crate::translucent::{root, scaled, translucent};

/// Parts that nothing here stands for, by the number that says how much there is of them.
const WITHOUT: [&str; 4] = ["sheen", "spec_tint", "flatness", "clearcoat"];
/// Further properties of these parts, and how often they are sampled, which changes the noise alone.
const OF_THEM: [&str; 6] = [
    "sheen_tint",
    "clearcoat_gloss",
    "diffuse_reflectance_sampling_rate",
    "clearcoat_sampling_rate",
    "main_specular_sampling_rate",
    "spec_trans_sampling_rate",
];

/// What is said of every such material.
const APPROXIMATED: &str = "\"principled\" becomes a coat over a diffuse base, blended with metal and glass: diffuse light is not \
                            brighter at grazing angles";

impl Walk<'_, '_, '_> {
    /// A sheet that reflects and passes light diffusely, by half of its `diff_trans`.
    pub(super) fn principled_thin(&mut self, element: &Element) -> Result<Value, String> {
        let place = &element.place;
        let what = "\"principledthin\" becomes a diffuse sheet: its light is not brighter at grazing angles, and it is never clear";
        self.builder.approximate(place, what);
        let base = self.colour(element, "base_color", Of::Texture)?.unwrap_or(json!(0.5));
        // From 0 to 2; a texture counts by its mean.
        let passes = self.number_of(element, "diff_trans", Of::Coefficient)?;
        let passes = passes.map_or(0.0, |share| share.mean("diff_trans", place, self.builder));
        let passed = 0.5 * passes.clamp(0.0, 2.0);
        if passed == 0.0 {
            return Ok(json!({ "type": "lambert", "reflectance": base }));
        }
        Ok(translucent(scaled(base.clone(), 1.0 - passed), scaled(base, passed), place, self.builder))
    }

    /// A coat over a diffuse base; a metal, by the share `metallic`; glass, by the share `spec_trans` of what is no metal.
    pub(super) fn principled(&mut self, element: &Element) -> Result<Value, String> {
        let place = &element.place;
        self.builder.approximate(place, APPROXIMATED);
        let base = self.colour(element, "base_color", Of::Texture)?.unwrap_or(json!(0.5));
        let index = match (element.number("eta")?, element.number("specular")?.unwrap_or(0.5)) {
            (Some(eta), _) => eta,
            // What reflects 0.08 times the number head-on.
            (None, specular) => 2.0 / (1.0 - (0.08 * specular.clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        let rough = self.principled_roughness(element)?;
        for name in WITHOUT {
            let share = self.number(element, name)?;
            if share.is_some_and(|share| !matches!(share, Number::Value(0.0))) {
                self.builder.leave_out(place, format!("\"{name}\" is left out"));
            }
        }
        for name in OF_THEM {
            element.property(name);
        }
        let transmits = self.number(element, "spec_trans")?.unwrap_or(Number::Value(0.0));
        let opaque = matches!(transmits, Number::Value(0.0));
        let part = |mut part: Value, rough: Rough| {
            rough.put(&mut part);
            part["masking"] = json!("separable");
            if opaque && part["type"] != "dielectric" {
                part["sides"] = json!("front");
            }
            part
        };
        let coated = if index == 1.0 {
            let mut bare = json!({ "type": "lambert", "reflectance": base });
            if opaque {
                bare["sides"] = json!("front");
            }
            bare
        } else {
            // The coat takes away what it reflects, and no more.
            let coated =
                json!({ "type": "plastic", "reflectance": base, "coat": index, "internal_reflection": "uncoloured" });
            part(coated, rough.clone())
        };
        // Each face passes as much.
        let tint = if opaque { Value::Null } else { self.root_of_base(&base, place) };
        let glass = || {
            let mut glass =
                json!({ "type": "dielectric", "interior": index, "exterior": 1, "multiple_scattering": "lost" });
            if tint != json!(1.0) {
                glass["transmitted_tint"] = tint.clone();
            }
            part(glass, rough.clone())
        };
        let ground = mixed(coated, glass, transmits);
        let metal = || {
            let metal = json!({ "type": "conductor", "reflectance": base, "multiple_scattering": "lost" });
            part(metal, rough.clone())
        };
        let metallic = self.number(element, "metallic")?.unwrap_or(Number::Value(0.0));
        let made = mixed(ground, metal, metallic);
        self.builder.spend(&made, place)?;
        Ok(made)
    }

    /// The square root of a base colour; of an image that of its mean.
    fn root_of_base(&mut self, base: &Value, place: &str) -> Value {
        root(base).unwrap_or_else(|| {
            self.builder.approximate(place, "an image as base colour of glass becomes its mean");
            let encoding = if base["encoding"] == "linear" { Encoding::Linear } else { Encoding::Auto };
            let mean = base["file"].as_str().and_then(|file| self.builder.image_mean(file, encoding));
            reflectance(mean.unwrap_or([0.5; 3]).map(f64::sqrt))
        })
    }

    /// α is the square of `roughness`; with `anisotropic` a, it is divided along u and multiplied across it by √(1 − 0.9 a).
    fn principled_roughness(&mut self, element: &Element) -> Result<Rough, String> {
        let anisotropic = self.number(element, "anisotropic")?.unwrap_or(Number::Value(0.0));
        let anisotropic = anisotropic.mean("anisotropic", &element.place, self.builder);
        Ok(match self.number(element, "roughness")?.unwrap_or(Number::Value(0.5)) {
            Number::Value(roughness) => {
                let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * anisotropic.clamp(0.0, 1.0)).sqrt());
                Rough::widths([alpha / aspect, alpha * aspect].map(|alpha| alpha.clamp(0.001, 1.0)))
            }
            Number::Image(image, _) => {
                if anisotropic != 0.0 {
                    self.builder
                        .leave_out(&element.place, "\"anisotropic\" is left out, since an image says the roughness");
                }
                Rough::Image(image)
            }
        })
    }
}

/// The first material with a share of the second.
fn mixed(first: Value, second: impl Fn() -> Value, share: Number) -> Value {
    match share {
        Number::Value(0.0) => first,
        Number::Value(1.0) => second(),
        share => {
            let mut blend = json!({ "type": "blend", "first": first, "second": second() });
            share.put_weight(&mut blend);
            blend
        }
    }
}
