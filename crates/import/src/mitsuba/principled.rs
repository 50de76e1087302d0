//! Mitsuba's `principled` material: a principled surface of the format, in a blend with glass by what it transmits.

use etalon_scene::Encoding;
use serde_json::{Value, json};

use super::Walk;
use super::colour::Of;
use super::element::Element;
use crate::number::{Number, Rough};
use crate::translucent::{root, scaled, translucent};

/// How often lobes are sampled, which changes the noise alone.
const SAMPLING_RATES: [&str; 4] = [
    "diffuse_reflectance_sampling_rate",
    "clearcoat_sampling_rate",
    "main_specular_sampling_rate",
    "spec_trans_sampling_rate",
];
/// The least width of facets there.
const LEAST_ALPHA: f64 = 0.001;

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

    /// A principled surface; with glass, by the share `spec_trans` of what is no metal.
    pub(super) fn principled(&mut self, element: &Element) -> Result<Value, String> {
        let place = &element.place;
        let base = self.colour(element, "base_color", Of::Texture)?.unwrap_or(json!(0.5));
        let index = self.principled_index(element)?;
        let rough = self.principled_roughness(element)?;
        for name in SAMPLING_RATES {
            element.property(name);
        }
        let transmits = self.number(element, "spec_trans")?.unwrap_or(Number::Value(0.0));
        let metallic = self.number(element, "metallic")?.unwrap_or(Number::Value(0.0));
        let mut share = |name: &str| -> Result<f64, String> {
            let number = self.number(element, name)?;
            Ok(number.map_or(0.0, |number| number.mean(name, place, self.builder)))
        };
        let (sheen, coat) = (share("sheen")?, share("clearcoat")?);
        let specular_tint = share("spec_tint")?;
        let alone =
            [("specular_tint", specular_tint), ("flatness", share("flatness")?), ("sheen_tint", share("sheen_tint")?)];
        let coat_alpha = 0.1 + (LEAST_ALPHA - 0.1) * share("clearcoat_gloss")?;
        // What is opaque, with this many times the sheen and the coat.
        let surface = |times: f64| {
            let mut surface = json!({ "type": "principled", "reflectance": base, "index": index, "sides": "front" });
            rough.clone().put(&mut surface);
            let lobes = alone.into_iter().chain([("sheen", times * sheen), ("clear_coat", times * coat)]);
            lobes.filter(|(_, number)| *number > 0.0).for_each(|(key, number)| surface[key] = json!(number));
            if coat > 0.0 {
                surface["clear_coat_alpha"] = json!(coat_alpha);
            }
            surface
        };
        let mut opaque = surface(1.0);
        let made = match transmits {
            Number::Value(0.0) => {
                match metallic {
                    Number::Value(0.0) => {}
                    Number::Value(share) => opaque["metallic"] = json!(share),
                    Number::Image(image, _) => opaque["metallic_image"] = image,
                }
                opaque
            }
            transmits => {
                if specular_tint > 0.0 {
                    self.builder.leave_out(place, "what transmits reflects without \"spec_tint\"");
                }
                // There, neither the coat nor the sheen is less where light is transmitted, unless all of it is.
                let rest = match &transmits {
                    Number::Value(share) => 1.0 - share,
                    Number::Image(_, mean) => 1.0 - mean,
                };
                let spread = matches!(transmits, Number::Image(..)) && (sheen > 0.0 || coat > 0.0);
                if spread {
                    self.builder.approximate(place, "sheen and clear coat lie on what does not transmit alone");
                }
                if rest <= 0.0 && coat > 0.0 {
                    self.builder.leave_out(place, "\"clearcoat\" of glass is left out");
                }
                let tint = self.root_of_base(&base, place);
                let glass = || {
                    let mut glass = json!({
                        "type": "dielectric", "interior": index, "exterior": 1, "multiple_scattering": "lost", "masking": "separable"
                    });
                    if tint != json!(1.0) {
                        glass["transmitted_tint"] = tint.clone();
                    }
                    rough.clone().put(&mut glass);
                    glass
                };
                let metal = || {
                    let mut metal = opaque.clone();
                    metal["metallic"] = json!(1);
                    metal
                };
                mixed(mixed(surface(if rest > 0.0 { 1.0 / rest } else { 0.0 }), glass, transmits), metal, metallic)
            }
        };
        self.builder.spend(&made, place)?;
        Ok(made)
    }

    /// The index that `eta` or `specular` says.
    fn principled_index(&mut self, element: &Element) -> Result<f64, String> {
        let index = match (element.number("eta")?, element.number("specular")?.unwrap_or(0.5)) {
            (Some(eta), _) => eta,
            // What reflects 0.08 times the number head-on.
            (None, specular) => 2.0 / (1.0 - (0.08 * specular.clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        if index > 0.0 && index < 1.0 {
            self.builder
                .approximate(&element.place, "an \"eta\" below 1 becomes its reciprocal: it reflects as much head-on");
            return Ok(1.0 / index);
        }
        Ok(index)
    }

    /// The square root of a base colour, which each face of glass passes.
    fn root_of_base(&mut self, base: &Value, place: &str) -> Value {
        if let Some(root) = root(base) {
            return root;
        }
        let encoding = if base["encoding"] == "linear" { Encoding::Linear } else { Encoding::Auto };
        let Some(file) = base["file"].as_str().and_then(|file| self.builder.root_of_image(file, encoding)) else {
            self.builder.approximate(place, "a base colour of glass that is no image becomes grey");
            return json!(0.5_f64.sqrt());
        };
        let mut image = base.clone();
        (image["file"], image["encoding"]) = (json!(file), json!("linear"));
        if let Some(factor) = base.get("factor").and_then(root) {
            image["factor"] = factor;
        }
        image
    }

    /// α is the square of `roughness`; with `anisotropic` a, it is divided along u and multiplied across it by √(1 − 0.9 a).
    fn principled_roughness(&mut self, element: &Element) -> Result<Rough, String> {
        let anisotropic = self.number(element, "anisotropic")?.unwrap_or(Number::Value(0.0));
        let anisotropic = anisotropic.mean("anisotropic", &element.place, self.builder);
        Ok(match self.number(element, "roughness")?.unwrap_or(Number::Value(0.5)) {
            Number::Value(roughness) => {
                let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * anisotropic.clamp(0.0, 1.0)).sqrt());
                Rough::widths([alpha / aspect, alpha * aspect].map(|alpha| alpha.clamp(LEAST_ALPHA, 1.0)))
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
