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
/// Where less than this share is opaque, it does not get the sheen and the coat of all: rare directions would bring much light.
const LEAST_OPAQUE: f64 = 0.05;

/// What a `principled` material says, but how much of it transmits and is metal.
struct Lobes {
    base: Value,
    eta: f64,
    rough: Rough,
    specular_tint: f64,
    flatness: f64,
    sheen: f64,
    sheen_tint: f64,
    coat: f64,
    coat_alpha: f64,
}

impl Lobes {
    /// What is opaque, with this many times the sheen and the coat.
    fn surface(&self, times: f64) -> Value {
        let index = if self.eta > 0.0 && self.eta < 1.0 { 1.0 / self.eta } else { self.eta };
        let mut surface = json!({ "type": "principled", "reflectance": self.base, "index": index, "sides": "front" });
        self.rough.clone().put(&mut surface);
        let lobes = [
            ("specular_tint", self.specular_tint),
            ("flatness", self.flatness),
            ("sheen", times * self.sheen),
            ("sheen_tint", self.sheen_tint),
            ("clear_coat", times * self.coat),
        ];
        lobes.into_iter().filter(|(_, number)| *number > 0.0).for_each(|(key, number)| surface[key] = json!(number));
        if self.coat > 0.0 {
            surface["clear_coat_alpha"] = json!(self.coat_alpha);
        }
        surface
    }

    /// What transmits, each of whose faces passes `tint`.
    fn glass(&self, tint: &Value) -> Value {
        let mut glass = json!({
            "type": "dielectric", "interior": self.eta, "exterior": 1, "multiple_scattering": "lost", "masking": "separable"
        });
        if *tint != json!(1.0) {
            glass["transmitted_tint"] = tint.clone();
        }
        self.rough.clone().put(&mut glass);
        glass
    }
}

impl Walk<'_, '_, '_> {
    /// A sheet that reflects and passes light diffusely, by half of its `diff_trans`.
    pub(super) fn principled_thin(&mut self, element: &Element) -> Result<Value, String> {
        let place = &element.place;
        let what = "\"principledthin\" becomes a diffuse sheet: its light is not brighter at grazing angles, and it is never clear";
        self.builder.approximate(place, what);
        let base = self.colour(element, "base_color", Of::Texture)?.unwrap_or(json!(0.5));
        // From 0 to 2.
        let passes = self.number_of(element, "diff_trans", Of::Coefficient)?;
        let passes = passes.map_or(0.0, |share| self.linear(share, "diff_trans", place));
        let passed = 0.5 * passes.clamp(0.0, 2.0);
        if passed == 0.0 {
            return Ok(json!({ "type": "lambert", "reflectance": base }));
        }
        Ok(translucent(scaled(base.clone(), 1.0 - passed), scaled(base, passed), place, self.builder))
    }

    /// A principled surface; with glass, by the share `spec_trans` of what is no metal.
    pub(super) fn principled(&mut self, element: &Element) -> Result<Value, String> {
        let place = &element.place;
        let lobes = self.principled_lobes(element)?;
        for name in SAMPLING_RATES {
            element.property(name);
        }
        let transmits = self.number(element, "spec_trans")?.unwrap_or(Number::Value(0.0));
        let metallic = self.number(element, "metallic")?.unwrap_or(Number::Value(0.0));
        let mut opaque = lobes.surface(1.0);
        if matches!(transmits, Number::Value(0.0)) || matches!(metallic, Number::Value(1.0)) {
            match metallic {
                Number::Value(0.0) => {}
                Number::Value(share) => opaque["metallic"] = json!(share),
                Number::Image(image, _) => opaque["metallic_image"] = image,
            }
            return Ok(opaque);
        }
        let rest = self.not_transmitting(&lobes, &transmits, place);
        let tint = self.root_of_base(&lobes.base, place);
        let metal = || {
            let mut metal = opaque.clone();
            metal["metallic"] = json!(1);
            metal
        };
        Ok(mixed(mixed(rest, || lobes.glass(&tint), transmits), metal, metallic))
    }

    /// What does not transmit. In Mitsuba neither the coat nor the sheen is less where light is transmitted: here what is opaque has more of them.
    fn not_transmitting(&mut self, lobes: &Lobes, transmits: &Number, place: &str) -> Value {
        if lobes.specular_tint > 0.0 {
            self.builder.leave_out(place, "what transmits reflects without \"spec_tint\"");
        }
        let both = [("clearcoat", lobes.coat), ("sheen", lobes.sheen)];
        let times = match transmits {
            Number::Value(share) if 1.0 - share > LEAST_OPAQUE => 1.0 / (1.0 - share),
            _ => {
                for (name, _) in both.into_iter().filter(|(_, strength)| *strength > 0.0) {
                    self.builder.leave_out(place, format!("\"{name}\" of what transmits is left out"));
                }
                1.0
            }
        };
        lobes.surface(times)
    }

    /// All but what transmits, and how much of it is metal.
    fn principled_lobes(&mut self, element: &Element) -> Result<Lobes, String> {
        let place = &element.place;
        let mut share = |name: &str, most: f64| -> Result<f64, String> {
            // A texture is of shares.
            let is_number =
                element.property(name).is_some_and(|stated| stated.tag == "float" || stated.tag == "integer");
            let of = if is_number { Of::Coefficient } else { Of::Reflectance };
            let number = match self.number_of(element, name, of)? {
                // The width of the coat's facets is the one that the surface is not linear in.
                Some(number) if name == "clearcoat_gloss" => number.mean(name, place, self.builder),
                Some(number) => self.linear(number, name, place),
                None => 0.0,
            };
            if number > most {
                self.builder.approximate(place, format!("\"{name}\" of {number} becomes {most}"));
            }
            Ok(number.min(most))
        };
        let (sheen, coat) = (share("sheen", f64::INFINITY)?, share("clearcoat", f64::INFINITY)?);
        let (specular_tint, flatness, sheen_tint) =
            (share("spec_tint", 1.0)?, share("flatness", 1.0)?, share("sheen_tint", 1.0)?);
        let coat_alpha = 0.1 + (LEAST_ALPHA - 0.1) * share("clearcoat_gloss", 1.0)?;
        let base = self.colour(element, "base_color", Of::Texture)?.unwrap_or(json!(0.5));
        let eta = match (element.number("eta")?, element.number("specular")?.unwrap_or(0.5)) {
            (Some(eta), _) => eta,
            // What reflects 0.08 times the number head-on.
            (None, specular) => 2.0 / (1.0 - (0.08 * specular.clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        if eta > 0.0 && eta < 1.0 {
            let what =
                "an \"eta\" below 1 becomes its reciprocal where nothing is transmitted: it reflects as much head-on";
            self.builder.approximate(place, what);
        }
        let rough = self.principled_roughness(element)?;
        Ok(Lobes { base, eta, rough, specular_tint, flatness, sheen, sheen_tint, coat, coat_alpha })
    }

    /// The square root of a base colour, which each face of glass passes.
    fn root_of_base(&mut self, base: &Value, place: &str) -> Value {
        if let Some(root) = root(base) {
            return root;
        }
        let encoding = if base["encoding"] == "linear" { Encoding::Linear } else { Encoding::Auto };
        let Some(file) = base["file"].as_str().and_then(|file| self.builder.root_of_image(file, encoding, place))
        else {
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
                if alpha / aspect > 1.0 {
                    let what = format!("the width of facets along the grain, {:.3}, becomes 1", alpha / aspect);
                    self.builder.approximate(&element.place, what);
                }
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
