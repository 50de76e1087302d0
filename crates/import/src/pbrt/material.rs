//! Materials of pbrt.

use serde_json::{Map, Value, json};

use super::glass::{glass, named_metal};
use super::parameters::{Parameter, Parameters};
use super::{Look, Reading};
use crate::budget::BlendSize;
use crate::number::{Number, Rough};
use crate::relief::has_map;
use crate::table::{Table, metal};
use crate::translucent::{scaled, translucent};

/// The metal where a conductor states none.
const COPPER: &str = "metal-Cu";

impl Reading<'_, '_> {
    pub(super) fn material(&mut self, kind: &str, list: &Parameters, place: &str) -> Result<Look, String> {
        let (mut opacity, mut size) = (1.0, BlendSize::ONE);
        // What is chosen between has maps of its own, and what is not there has none.
        let detail = if matches!(kind, "mix" | "interface" | "") { Map::new() } else { self.relief(list)? };
        let value = match kind {
            "diffuse" => {
                let reflectance = self.reflectance(list, "reflectance", true)?.unwrap_or(json!(0.5));
                json!({ "type": "lambert", "reflectance": reflectance })
            }
            "diffusetransmission" => {
                let scale = list.numbers("scale").and_then(|numbers| numbers.first().copied()).unwrap_or(1.0).max(0.0);
                let mut share = |name: &str| {
                    let value = self.reflectance(list, name, true)?.unwrap_or(json!(0.25));
                    Ok::<_, String>(if scale == 1.0 { value } else { scaled(value, scale) })
                };
                let (reflectance, transmittance) = (share("reflectance")?, share("transmittance")?);
                translucent(reflectance, transmittance, place, self.builder)
            }
            "coateddiffuse" => {
                let reflectance = self.reflectance(list, "reflectance", true)?.unwrap_or(json!(0.5));
                let coat = self.index(list, 1.5)?;
                // What the coat adds to its thickness of 0 is nothing without absorption, which is listed if there is some.
                for harmless in ["thickness", "maxdepth", "nsamples"] {
                    list.get(harmless);
                }
                let mut plastic = json!({ "type": "plastic", "reflectance": reflectance, "coat": coat });
                self.rough(list, "", place)?.put(&mut plastic);
                plastic
            }
            "conductor" | "coatedconductor" => {
                let is_coated = kind == "coatedconductor";
                if is_coated {
                    self.builder.leave_out(place, "the coat is left out: it becomes bare metal");
                    list.all.iter().filter(|p| p.name.starts_with("interface.")).for_each(|p| p.mark());
                    for of_coat in ["thickness", "maxdepth", "nsamples", "albedo", "g"] {
                        list.get(of_coat);
                    }
                }
                self.conductor(list, if is_coated { "conductor." } else { "" }, place)?
            }
            "dielectric" => {
                let mut glass =
                    json!({ "type": "dielectric", "interior": self.index(list, 1.5)?, "multiple_scattering": "lost" });
                self.rough(list, "", place)?.put(&mut glass);
                glass
            }
            "thindielectric" => json!({ "type": "thin-dielectric", "index": self.index(list, 1.5)? }),
            "measured" => self.measured(list, place)?,
            "mix" => {
                let names: Vec<String> = list.get("materials").map_or(&[][..], |p| p.strings()).to_vec();
                let [first, second] = &names[..] else {
                    return Err(format!("{place}: a mix has two materials, not {}", names.len()));
                };
                let mut known = |name: &String| {
                    let look = self.materials.get(name).cloned();
                    let look = look.ok_or_else(|| format!("{place}: there is no material \"{name}\""))?;
                    if has_map(&look.detail) {
                        let what = format!("the normal or bump map of a part of it, \"{name}\", is left out");
                        self.builder.leave_out(place, what);
                    }
                    // In full, since a blend may only name what stands before it.
                    let named = look.value.as_str().and_then(|name| self.builder.materials.get(name));
                    Ok::<_, String>((named.unwrap_or(&look.value).clone(), look.size))
                };
                let ((first, first_size), (second, second_size)) = (known(first)?, known(second)?);
                size = first_size.blend(second_size, place)?;
                let mut blend = json!({ "type": "blend", "first": first, "second": second });
                self.share(list, "amount")?.unwrap_or(Number::Value(0.5)).put_weight(&mut blend);
                self.builder.spend(&blend, place)?;
                blend
            }
            "interface" | "" => {
                opacity = 0.0;
                json!({ "type": "black" })
            }
            other => {
                self.builder.approximate(place, format!("the material \"{other}\" is not known: it becomes grey"));
                list.mark_all();
                json!({ "type": "lambert", "reflectance": 0.5 })
            }
        };
        list.get("type");
        list.list_unused(self.builder);
        Ok(Look { value, opacity, detail, size })
    }

    /// A measured BRDF, whose file is copied. It reflects on both sides.
    fn measured(&mut self, list: &Parameters, place: &str) -> Result<Value, String> {
        let name = list.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?;
        let mut material = self.builder.measured(name, place)?;
        material["sides"] = json!("both");
        Ok(material)
    }

    /// A metal, whose parameters have a prefix if it is below a coat.
    fn conductor(&mut self, list: &Parameters, prefix: &str, place: &str) -> Result<Value, String> {
        let rough = self.rough(list, prefix, place)?;
        // The reflectance of what is coated has no prefix there.
        let stated = match self.reflectance(list, "reflectance", true)? {
            None if !prefix.is_empty() => self.reflectance(list, &format!("{prefix}reflectance"), true)?,
            stated => stated,
        };
        let mut value = if let Some(reflectance) = stated {
            // The same index as in pbrt: 1 + ik.
            json!({ "type": "conductor", "reflectance": reflectance })
        } else {
            self.metal(list, prefix, place)?
        };
        rough.put(&mut value);
        value["outside_fit"] = json!("clamp");
        value["multiple_scattering"] = json!("lost");
        Ok(value)
    }

    /// A metal by its eta and k: two tables, or the name of a metal. What is not stated is copper's.
    fn metal(&mut self, list: &Parameters, prefix: &str, place: &str) -> Result<Value, String> {
        let [eta, k] = ["eta", "k"].map(|what| list.get(&format!("{prefix}{what}")));
        let (of_eta, of_k) = (eta.map(|eta| metal_name(eta, "-eta")), k.map(|k| metal_name(k, "-k")));
        if let (Some(eta), Some(k), Some(None), Some(None)) = (eta, k, of_eta, of_k) {
            return Ok(metal(&self.index_of_metal(eta)?, &self.index_of_metal(k)?));
        }
        let name = of_eta.flatten().or(of_k.flatten()).unwrap_or(COPPER);
        if [of_eta, of_k].iter().any(|of| of.unwrap_or(Some(COPPER)) != Some(name)) {
            let what = format!("eta and k are of two kinds: the metal \"{name}\" is used for both");
            self.builder.approximate(place, what);
        }
        let (known, other) = named_metal(name);
        if let Some(what) = other {
            self.builder.approximate(place, what);
        }
        Ok(known)
    }

    /// A table of eta or k, which are not named.
    fn index_of_metal(&mut self, parameter: &Parameter) -> Result<Table, String> {
        let table = match (parameter.kind.as_str(), parameter.numbers()) {
            ("rgb" | "color", [r, g, b]) => {
                let what = "a colour as eta or k becomes a smooth spectrum of that colour";
                self.builder.approximate(&parameter.place, what);
                Table::of_colour(&json!({ "rgb": [r, g, b] }))
            }
            (_, [value]) => Some(Table(vec![(550.0, *value)])),
            _ => self.table(parameter)?,
        };
        table.ok_or_else(|| format!("{}: it is not an index of refraction", parameter.place))
    }

    /// An index of refraction: a number, or a glass by its name.
    fn index(&mut self, list: &Parameters, default: f64) -> Result<Value, String> {
        let Some(parameter) = list.get("eta") else { return Ok(json!(default)) };
        let place = parameter.place.clone();
        match (parameter.numbers(), parameter.strings()) {
            ([index], _) if *index > 0.0 => Ok(json!(index)),
            (_, [name]) => Ok(glass(name).unwrap_or_else(|| {
                self.builder.approximate(&place, format!("the glass \"{name}\" is not known: its index becomes 1.5"));
                json!(1.5)
            })),
            _ => Err(format!("{place}: it is not an index of refraction")),
        }
    }

    fn rough(&mut self, list: &Parameters, prefix: &str, place: &str) -> Result<Rough, String> {
        let both = self.share(list, &format!("{prefix}roughness"))?;
        let (u, v) =
            (self.share(list, &format!("{prefix}uroughness"))?, self.share(list, &format!("{prefix}vroughness"))?);
        let (u, v) = (u.or_else(|| both.clone()), v.or(both));
        // Unless told otherwise pbrt takes the square of alpha.
        let squared = list.flag("remaproughness").unwrap_or(true);
        let alpha = |roughness: f64| if squared { roughness.max(0.0).sqrt() } else { roughness };
        Ok(match (u.unwrap_or(Number::Value(0.0)), v.unwrap_or(Number::Value(0.0))) {
            (Number::Image(u, _), Number::Image(v, _)) if u == v => {
                Rough::image(u, if squared { "alpha-squared" } else { "alpha" })
            }
            (u, v) => {
                let (u, v) = (u.mean("uroughness", place, self.builder), v.mean("vroughness", place, self.builder));
                Rough::widths([u, v].map(|roughness| alpha(roughness.max(0.0))))
            }
        })
    }
}

/// The metal of which eta or k is the index, by its name without this ending; `None` of numbers and of files.
fn metal_name<'p>(parameter: &'p Parameter, ending: &str) -> Option<&'p str> {
    let name = parameter.strings().first().filter(|name| !name.ends_with(".spd"))?;
    Some(name.strip_suffix(ending).unwrap_or(name))
}
