//! Materials of Mitsuba.

use serde_json::{Map, Value, json};

use super::Walk;
use super::colour::Of;
use super::element::Element;
use super::sheet::{is_sheet, unpolarised};
use crate::budget::BlendSize;
use crate::metals;
use crate::missing;
use crate::number::{Number, Rough};
use crate::relief::{has_map, without_map};
use crate::sides::change_sides;
use crate::table::{Table, metal};

/// What a surface is made of.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// A material of the format.
    pub material: Value,
    /// Share of light that meets it.
    pub opacity: f64,
    /// Further keys of its objects: an image of that share, a map of normals or heights.
    pub detail: Map<String, Value>,
    /// How many materials it is a blend of.
    pub size: BlendSize,
}

impl Look {
    pub(super) fn of(material: Value) -> Self {
        Self { material, opacity: 1.0, detail: Map::new(), size: BlendSize::ONE }
    }

    pub(super) fn plain(material: Value, opacity: f64) -> Self {
        Self { opacity, ..Self::of(material) }
    }
}

/// The grey that stands for what is not known.
pub(super) fn grey() -> Value {
    json!({ "type": "lambert", "reflectance": 0.5 })
}

impl Walk<'_, '_, '_> {
    /// The material that an element is. One that others can refer to is read once.
    pub(super) fn look(&mut self, element: &Element) -> Result<Look, String> {
        let key = std::ptr::from_ref(element);
        if let Some(look) = self.looks.get(&key) {
            return Ok(look.clone());
        }
        let look = self.within(element, |walk| walk.read_look(element))?;
        if element.attribute("id").is_some() {
            self.looks.insert(key, look.clone());
        }
        Ok(look)
    }

    fn read_look(&mut self, element: &Element) -> Result<Look, String> {
        let place = element.place.clone();
        let look = match element.plugin() {
            "twosided" => {
                let nested = element.nested("bsdf", self.ids)?;
                let mut look = self.first(&nested, &place)?;
                if let Some(other) = nested.iter().find(|other| !std::ptr::eq(**other, nested[0])) {
                    let back = self.look(other)?;
                    if back.detail != look.detail || back.opacity != look.opacity {
                        let what = "maps and masks of its back are left out: those of its front stand for both";
                        self.builder.leave_out(&place, what);
                    }
                    look.size = look.size.blend(back.size, &place)?;
                    look.material = json!({ "type": "two-sided", "front": look.material, "back": back.material });
                    self.builder.spend(&look.material, &place)?;
                }
                change_sides(&mut look.material, &|_| "both");
                look
            }
            "mask" => {
                let mut look = self.nested_look(element)?;
                match self.number(element, "opacity")?.unwrap_or(Number::Value(0.5)) {
                    Number::Value(share) => look.opacity *= share,
                    Number::Image(image, _) if !look.detail.contains_key("opacity_image") => {
                        look.detail.insert("opacity_image".to_owned(), image);
                    }
                    image => look.opacity *= image.mean("opacity", &place, self.builder),
                }
                look
            }
            "bumpmap" | "normalmap" => {
                let mut look = self.nested_look(element)?;
                match self.relief(element)? {
                    Some(_) if has_map(&look.detail) => {
                        let what = format!("the \"{}\" around another map is left out", element.plugin());
                        self.builder.leave_out(&place, what);
                    }
                    Some((key, map)) => {
                        look.detail.insert(key.to_owned(), map);
                    }
                    None => {}
                }
                look
            }
            "polarizer" | "retarder" | "circular" => {
                self.has_panes = true;
                self.sheet(element)?
            }
            "null" => Look::plain(json!({ "type": "black" }), 0.0),
            "blendbsdf" => {
                let nested = element.nested("bsdf", self.ids)?;
                let [first, second] = nested[..] else {
                    return Err(format!("{place}: a blend has two materials, not {}", nested.len()));
                };
                let (mut first, mut second) = (self.look(first)?, self.look(second)?);
                for part in [&mut first, &mut second].into_iter().filter(|part| is_sheet(&part.material)) {
                    self.builder.approximate(&place, "a polarising sheet inside a blend changes no polarisation");
                    let passed = unpolarised(&part.material);
                    *part = Look::plain(json!({ "type": "black" }), 1.0 - passed);
                }
                if without_map(&mut first.detail) | without_map(&mut second.detail) {
                    self.builder.leave_out(&place, "a normal or bump map of a part of a blend is left out");
                }
                let weight = self.number(element, "weight")?.unwrap_or(Number::Value(0.5));
                let mean = match weight {
                    Number::Value(mean) | Number::Image(_, mean) => mean,
                };
                if first.opacity != second.opacity || !first.detail.is_empty() || !second.detail.is_empty() {
                    self.builder
                        .leave_out(&place, "masks inside a blend become their mean; images of masks are left out");
                }
                let mut material = json!({ "type": "blend", "first": first.material, "second": second.material });
                weight.put_weight(&mut material);
                // Each blend holds its parts in full.
                let size = first.size.blend(second.size, &place)?;
                self.builder.spend(&material, &place)?;
                Look { size, ..Look::plain(material, (1.0 - mean) * first.opacity + mean * second.opacity) }
            }
            plugin => {
                let material = self.varying(element, plugin)?;
                let size = BlendSize::of(&material);
                Look { size, ..Look::of(material) }
            }
        };
        element.list_unused(self.builder);
        Ok(look)
    }

    fn nested_look(&mut self, element: &Element) -> Result<Look, String> {
        let nested = element.nested("bsdf", self.ids)?;
        self.first(&nested, &element.place)
    }

    fn first(&mut self, nested: &[&Element], place: &str) -> Result<Look, String> {
        match nested.first() {
            Some(first) => self.look(first),
            None => Err(format!("{place}: it has no <bsdf> in it")),
        }
    }

    /// A material whose numbers are the same everywhere, or images.
    pub(super) fn material(&mut self, element: &Element, plugin: &str) -> Result<Value, String> {
        let place = &element.place;
        let mut material = match plugin {
            "diffuse" | "roughdiffuse" => {
                if plugin == "roughdiffuse" {
                    let what = "what is rough and diffuse becomes diffuse: its edge, seen against the light, is darker";
                    self.builder.approximate(place, what);
                    element.property("alpha");
                }
                let reflectance = self.colour(element, "reflectance", Of::Texture)?.unwrap_or(json!(0.5));
                json!({ "type": "lambert", "reflectance": reflectance })
            }
            "dielectric" | "roughdielectric" => {
                let (interior, exterior) =
                    (self.index(element, "int_ior", 1.5046)?, self.index(element, "ext_ior", 1.000_277)?);
                let mut glass = json!({ "type": "dielectric", "interior": interior, "exterior": exterior,
                    "multiple_scattering": "lost" });
                self.put_tints(element, &mut glass)?;
                if plugin == "roughdielectric" {
                    self.put_facets(element, &mut glass)?;
                }
                glass
            }
            "thindielectric" => {
                let ratio = self.index(element, "int_ior", 1.5046)? / self.index(element, "ext_ior", 1.000_277)?;
                self.has_panes = true;
                let mut pane = json!({ "type": "thin-dielectric", "index": ratio });
                self.put_tints(element, &mut pane)?;
                if pane.get("reflected_tint").is_some() || pane.get("transmitted_tint").is_some() {
                    let what = "a tinted pane adds the passes inside it for each polarisation, where Mitsuba takes their mean before: it differs by \
                                up to 1.3 %";
                    self.builder.approximate(place, what);
                }
                pane
            }
            "conductor" | "roughconductor" => self.conductor(element, plugin == "roughconductor")?,
            "plastic" | "roughplastic" => {
                let reflectance = self.colour(element, "diffuse_reflectance", Of::Texture)?.unwrap_or(json!(0.5));
                let coat = self.index(element, "int_ior", 1.49)? / self.index(element, "ext_ior", 1.000_277)?;
                let tint = self.colour(element, "specular_reflectance", Of::Texture)?;
                let nonlinear = element.flag("nonlinear")?.unwrap_or(false);
                let internal_reflection = if nonlinear { "coloured" } else { "uncoloured" };
                let mut plastic = json!({ "type": "plastic", "reflectance": reflectance, "coat": coat,
                    "internal_reflection": internal_reflection });
                put_tint(&mut plastic, "reflected_tint", tint);
                if plugin == "roughplastic" {
                    self.put_facets(element, &mut plastic)?;
                    let what = "a rough coat returns what it reflects from below; a sum of 64 terms in Mitsuba makes it 1.5 % less: \
                                the base is up to 2 % brighter here";
                    self.builder.approximate(place, what);
                    // The program has no facets of two widths here.
                    if plastic.get("alpha_u").is_none() {
                        plastic["multiple_scattering"] = json!("lost");
                    }
                }
                plastic
            }
            "principled" => self.principled(element)?,
            "principledthin" => self.principled_thin(element)?,
            "pplastic" => self.polarised_plastic(element)?,
            "measured" => self.measured(element)?,
            other => {
                self.builder.approximate(place, missing::material(other));
                element.children.iter().for_each(Element::mark);
                grey()
            }
        };
        // What reflects only is black from behind there.
        if matches!(
            plugin,
            "diffuse"
                | "roughdiffuse"
                | "conductor"
                | "roughconductor"
                | "plastic"
                | "roughplastic"
                | "pplastic"
                | "measured"
        ) {
            material["sides"] = json!("front");
        }
        Ok(material)
    }

    /// Rough plastic whose light is lost if it is reflected down again below the coat. It enters and leaves as through a smooth coat.
    fn polarised_plastic(&mut self, element: &Element) -> Result<Value, String> {
        let reflectance = self.colour(element, "diffuse_reflectance", Of::Texture)?.unwrap_or(json!(0.5));
        let coat = self.index(element, "int_ior", 1.49)? / self.index(element, "ext_ior", 1.000_277)?;
        let mut plastic =
            json!({ "type": "plastic", "reflectance": reflectance, "coat": coat, "internal_reflection": "lost" });
        put_tint(&mut plastic, "reflected_tint", self.colour(element, "specular_reflectance", Of::Texture)?);
        self.put_facets(element, &mut plastic)?;
        Ok(plastic)
    }

    /// A measured BRDF, whose file is copied.
    fn measured(&mut self, element: &Element) -> Result<Value, String> {
        let place = &element.place;
        let name = element.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?;
        self.builder.measured(name, place)
    }

    fn conductor(&mut self, element: &Element, rough: bool) -> Result<Value, String> {
        let place = &element.place;
        let tint = self.colour(element, "specular_reflectance", Of::Texture)?;
        // Without a name it is "none", too: η = 0 and k = 1, which reflect all light. An eta or a k of its own takes the place of these.
        let own = match element.string("material") {
            Some("none") | None => self.own_metal(element)?,
            Some(symbol) => Some(self.named_metal(symbol, place)),
        };
        let Some(mut value) = own else {
            if !rough {
                return Ok(json!({ "type": "mirror", "reflectance": tint.unwrap_or(json!(1.0)) }));
            }
            let mut value = json!({ "type": "conductor", "reflectance": 1.0 });
            put_tint(&mut value, "reflected_tint", tint);
            self.put_facets(element, &mut value)?;
            value["multiple_scattering"] = json!("lost");
            return Ok(value);
        };
        put_tint(&mut value, "reflected_tint", tint);
        if rough {
            self.put_facets(element, &mut value)?;
        }
        value["outside_fit"] = json!("clamp");
        // As in the program.
        value["multiple_scattering"] = json!("lost");
        Ok(value)
    }

    /// A metal by the name that the program has for it.
    fn named_metal(&mut self, symbol: &str, place: &str) -> Value {
        metals::named(symbol).unwrap_or_else(|| {
            self.builder.approximate(place, format!("the metal \"{symbol}\" is not known: it becomes aluminium"));
            json!({ "type": "conductor", "metal": "Al" })
        })
    }

    /// A metal by its own eta and k.
    fn own_metal(&mut self, element: &Element) -> Result<Option<Value>, String> {
        let (eta, k) = (self.colour(element, "eta", Of::Coefficient)?, self.colour(element, "k", Of::Coefficient)?);
        let (eta, k) = match (eta, k) {
            (None, None) => return Ok(None),
            (eta, k) => (eta.unwrap_or(json!(0.0)), k.unwrap_or(json!(1.0))),
        };
        let mut table = |value: &Value| {
            Table::of_spectrum(value).or_else(|| {
                self.builder
                    .approximate(&element.place, "a colour as eta or k becomes a smooth spectrum of that colour");
                Table::of_colour(value)
            })
        };
        let (Some(mut eta), Some(k)) = (table(&eta), table(&k)) else {
            return Err(format!("{}: eta and k are no spectra", element.place));
        };
        // As good as 0, which no scene may have.
        eta.0.iter_mut().for_each(|(_, n)| *n = n.max(1e-9));
        Ok(Some(metal(&eta, &k)))
    }

    /// States what is left of what glass reflects and passes.
    fn put_tints(&mut self, element: &Element, glass: &mut Value) -> Result<(), String> {
        for (name, key) in [("specular_reflectance", "reflected_tint"), ("specular_transmittance", "transmitted_tint")]
        {
            let tint = self.colour(element, name, Of::Texture)?;
            put_tint(glass, key, tint);
        }
        Ok(())
    }

    /// Says of a rough material how its facets are distributed and how they hide each other.
    fn put_facets(&mut self, element: &Element, material: &mut Value) -> Result<(), String> {
        let distribution = match element.string("distribution").unwrap_or("beckmann") {
            known @ ("beckmann" | "ggx") => known,
            other => {
                // Their widths were chosen to be those of Beckmann's.
                let what = format!("the facets \"{other}\" become Beckmann's of the same width");
                self.builder.approximate(&element.place, what);
                "beckmann"
            }
        };
        // Which facets a sampler prefers changes the noise alone.
        element.string("sample_visible");
        element.flag("sample_visible")?;
        self.alpha(element)?.put(material);
        material["distribution"] = json!(distribution);
        material["masking"] = json!("separable");
        Ok(())
    }

    fn alpha(&mut self, element: &Element) -> Result<Rough, String> {
        let place = &element.place;
        let both = (self.number(element, "alpha_u")?, self.number(element, "alpha_v")?);
        let alpha = match (self.number(element, "alpha")?, both) {
            (_, (Some(u), Some(v))) => {
                if let (Number::Image(image, _), Number::Image(other, _)) = (&u, &v)
                    && image == other
                {
                    return Ok(Rough::image(image.clone(), "alpha"));
                }
                let (u, v) = (u.mean("alpha_u", place, self.builder), v.mean("alpha_v", place, self.builder));
                return Ok(Rough::widths([u, v]));
            }
            (Some(alpha), _) | (None, (Some(alpha), None)) => alpha,
            (None, _) => Number::Value(0.1),
        };
        Ok(match alpha {
            Number::Value(alpha) => Rough::width(alpha),
            Number::Image(image, _) => Rough::image(image, "alpha"),
        })
    }
}

fn put_tint(material: &mut Value, key: &str, tint: Option<Value>) {
    if let Some(tint) = tint.filter(|tint| *tint != json!(1.0)) {
        material[key] = tint;
    }
}
