//! Spectra and textures of pbrt.

use std::path::Path;

use etalon_optics::colour::luminance_of;
use etalon_optics::spectrum::Blackbody;
use etalon_scene::{Encoding, UvMap};
use serde_json::{Value, json};

use super::Reading;
use super::parameters::{Parameter, Parameters, Values};
use crate::checker::{Checker, channels};
use crate::number::Number;
use crate::table::Table;
use crate::{extension, light, reflectance};

impl Reading<'_, '_> {
    /// What a surface reflects; an image only where `textured`.
    pub(super) fn reflectance(
        &mut self,
        list: &Parameters,
        name: &str,
        textured: bool,
    ) -> Result<Option<Value>, String> {
        Ok(self.value(list, name, textured)?.map(without_mean))
    }

    /// The same; an image or a chequerboard has its mean with it, under a key that the format does not have.
    pub(super) fn value(&mut self, list: &Parameters, name: &str, textured: bool) -> Result<Option<Value>, String> {
        let Some(parameter) = list.get(name) else { return Ok(None) };
        let place = parameter.place.clone();
        let value = match (parameter.kind.as_str(), parameter.numbers()) {
            ("rgb" | "color", [r, g, b]) => {
                let rgb = [*r, *g, *b];
                if rgb.iter().any(|v| !(0.0..=1.0).contains(v)) {
                    self.builder.approximate(&place, format!("{rgb:?} is not a reflectance: it is clamped to 0 to 1"));
                }
                reflectance(rgb)
            }
            ("float", [value]) => {
                if !(0.0..=1.0).contains(value) {
                    self.builder.approximate(&place, format!("{value} is not a reflectance: it is clamped to 0 to 1"));
                }
                json!(value.clamp(0.0, 1.0))
            }
            ("spectrum", _) => match self.table(parameter)? {
                Some(mut table) => {
                    if table.0.iter().any(|(_, v)| !(0.0..=1.0).contains(v)) {
                        self.builder.approximate(&place, "values are clamped to 0 to 1");
                    }
                    table.0.iter_mut().for_each(|(_, v)| *v = v.clamp(0.0, 1.0));
                    table.spectrum("clamp")
                }
                None => {
                    self.builder.approximate(&place, "the named spectrum is not known: it becomes 0.5");
                    json!(0.5)
                }
            },
            ("texture", _) => {
                let texture = parameter.strings().first().cloned().unwrap_or_default();
                let known = self.textures.get(&texture).cloned();
                let value = known.ok_or_else(|| format!("{place}: there is no texture \"{texture}\""))?;
                self.builder.spend(&value, &place)?;
                if !textured && matches!(value["type"].as_str(), Some("image" | "checker")) {
                    let kind = if value["type"] == "image" { "image" } else { "chequerboard" };
                    let what =
                        format!("\"{name}\" is the same everywhere: the mean of the {kind} \"{texture}\" is used");
                    self.builder.approximate(&place, what);
                    reflectance(mean(&value))
                } else {
                    value
                }
            }
            _ => return Err(format!("{place}: \"{name}\" is not a reflectance")),
        };
        Ok(Some(value))
    }

    /// A number from 0 to 1, perhaps by an image, whose channels count by their mean.
    pub(super) fn share(&mut self, list: &Parameters, name: &str) -> Result<Option<Number>, String> {
        let Some(parameter) = list.get(name) else { return Ok(None) };
        if parameter.kind == "texture" {
            let texture = parameter.strings().first().and_then(|texture| self.textures.get(texture));
            if let Some(image) = texture.filter(|value| value["type"] == "image") {
                let number = number_image(image);
                if let Number::Image(image, _) = &number
                    && image["factor"].as_f64().is_some_and(|factor| factor < 0.0)
                {
                    self.builder.approximate(&parameter.place, format!("a negative \"{name}\" becomes 0"));
                    return Ok(Some(Number::Value(0.0)));
                }
                return Ok(Some(number));
            }
            if let Some(name) = parameter.strings().first()
                && let Some(numbers) = self.board_of_numbers(name)
            {
                return Ok(Some(numbers));
            }
        }
        let place = parameter.place.clone();
        let value = self.reflectance(list, name, false)?;
        Ok(value.map(|value| {
            Number::Value(value.as_f64().unwrap_or_else(|| {
                self.builder.approximate(&place, format!("\"{name}\" is a colour: the mean of its channels is used"));
                let channels = value["rgb"].as_array().map_or(&[][..], Vec::as_slice);
                channels.iter().filter_map(Value::as_f64).sum::<f64>() / channels.len().max(1) as f64
            }))
        }))
    }

    /// Light: a colour as it is, any other spectrum with a luminance of 1.
    pub(super) fn emitted(&mut self, list: &Parameters, name: &str, scale: f64) -> Result<Value, String> {
        let Some(parameter) = list.get(name) else {
            return Ok(json!({ "type": "illuminant", "name": "D65", "scale": scale }));
        };
        let place = parameter.place.clone();
        match (parameter.kind.as_str(), parameter.numbers()) {
            ("rgb" | "color", [r, g, b]) => {
                if r.min(*g).min(*b) < 0.0 {
                    self.builder.approximate(&place, "negative light becomes 0");
                }
                Ok(light([*r, *g, *b].map(|v| v.max(0.0)), scale))
            }
            ("blackbody", [kelvin, ..]) => {
                let body = Blackbody::new(*kelvin, 1.0).map_err(|error| format!("{place}: {error}"))?;
                let luminance = luminance_of(|nm| body.eval(nm));
                if luminance <= 0.0 {
                    return Err(format!("{place}: a black body of {kelvin} K emits no light"));
                }
                Ok(json!({ "type": "blackbody", "temperature_k": kelvin, "scale": scale / luminance }))
            }
            ("float", [_]) => Ok(json!({ "type": "illuminant", "name": "E", "scale": scale })),
            ("spectrum", _) => {
                if let Some(table) = self.table(parameter)? {
                    let luminance = luminance_of(|nm| table.at_or_zero(nm));
                    if luminance <= 0.0 {
                        return Err(format!("{place}: it has no visible light"));
                    }
                    let mut value = table.spectrum("zero");
                    value["scale"] = json!(scale / luminance);
                    return Ok(value);
                }
                let name = parameter.strings().first().map_or("", String::as_str);
                let illuminant = match name {
                    "stdillum-D65" => "D65",
                    "stdillum-A" => "A",
                    "stdillum-E" => "E",
                    other => {
                        self.builder.approximate(&place, format!("the illuminant \"{other}\" becomes D65"));
                        "D65"
                    }
                };
                Ok(json!({ "type": "illuminant", "name": illuminant, "scale": scale }))
            }
            _ => Err(format!("{place}: \"{name}\" is not a light")),
        }
    }

    /// Wavelengths, nm, and values; `None` for a named spectrum.
    pub(super) fn table(&mut self, parameter: &Parameter) -> Result<Option<Table>, String> {
        let place = &parameter.place;
        let numbers = match &parameter.values {
            Values::Numbers(numbers) => numbers.clone(),
            Values::Strings(strings) => {
                let name = strings.first().map_or("", String::as_str);
                if !name.ends_with(".spd") {
                    return Ok(None);
                }
                let bytes = self.builder.bytes_of(name, place)?;
                let text = String::from_utf8_lossy(&bytes).into_owned();
                let words = text.lines().flat_map(|line| line.split('#').next().unwrap_or("").split_whitespace());
                let parsed: Result<Vec<f64>, _> = words.map(str::parse).collect();
                let numbers = parsed.map_err(|_| format!("{place}: \"{name}\" is not a list of numbers"))?;
                self.builder.spend(&json!(numbers), place)?;
                numbers
            }
            Values::Flags(_) => return Err(format!("{place}: it is not a spectrum")),
        };
        let table = Table::of_pairs(&numbers);
        let fail = || format!("{place}: {} numbers are not a table of wavelengths and values", numbers.len());
        table.ok_or_else(fail).map(Some)
    }

    pub(super) fn texture(
        &mut self,
        name: String,
        kind: &str,
        class: &str,
        list: &Parameters,
        place: &str,
    ) -> Result<(), String> {
        let value = match class {
            "constant" => self.value(list, "value", true)?.unwrap_or(json!(1.0)),
            "scale" => {
                let inner = self.value(list, "tex", true)?.unwrap_or(json!(1.0));
                let factor = match list.get("scale") {
                    // An image of heights may have any.
                    Some(number) if kind == "float" && number.kind == "float" && inner["type"] == "image" => {
                        list.number("scale")?.map(Value::from)
                    }
                    _ => self.reflectance(list, "scale", false)?,
                };
                let factor = factor.unwrap_or(json!(1.0));
                match (inner["type"].as_str(), factor.as_f64()) {
                    (Some("image"), Some(factor)) => scaled(inner, factor),
                    (Some("checker"), Some(factor)) => scaled_fields(inner, factor),
                    (None, Some(factor)) => json!(inner.as_f64().unwrap_or(1.0) * factor),
                    _ => match (channels(&inner), channels(&factor)) {
                        (Some(a), Some(b)) => reflectance(std::array::from_fn(|c| a[c] * b[c])),
                        _ => {
                            self.builder.approximate(place, "a product of textures becomes the first of them");
                            inner
                        }
                    },
                }
            }
            "mix" => self.mixed(list, place)?,
            "imagemap" => self.image(list, place)?,
            "checkerboard" => self.checkerboard(list, place)?,
            other => {
                self.builder.approximate(place, format!("the texture \"{other}\" is not known: it becomes 0.5"));
                list.mark_all();
                json!(0.5)
            }
        };
        if kind != "spectrum" && kind != "float" && kind != "color" {
            return Err(format!("{place}: a texture is of type \"spectrum\" or \"float\", not \"{kind}\""));
        }
        list.list_unused(self.builder);
        self.boards.remove(&name);
        self.textures.insert(name, value);
        Ok(())
    }

    /// Fields of a unit of the texture coordinates, the first at (0, 0): half as wide as ours.
    fn checkerboard(&mut self, list: &Parameters, place: &str) -> Result<Value, String> {
        let mut colours = [[1.0; 3], [0.0; 3]];
        for (colour, name) in colours.iter_mut().zip(["tex1", "tex2"]) {
            let Some(value) = self.reflectance(list, name, false)? else { continue };
            *colour = channels(&value).unwrap_or_else(|| {
                self.builder.approximate(place, format!("\"{name}\" is a spectrum: it becomes a grey of 0.5"));
                [0.5; 3]
            });
        }
        let uv_scale = [0.5 * list.number_or("uscale", 1.0)?, 0.5 * list.number_or("vscale", 1.0)?];
        let uv_offset = [0.5 * list.number_or("udelta", 0.0)?, 0.5 * list.number_or("vdelta", 0.0)?];
        let checker = Checker { colours, uv_map: UvMap::scaled(uv_scale, uv_offset) };
        let mapping = list.string("mapping").unwrap_or("uv");
        if mapping != "uv" || list.number_or("dimension", 2.0)? != 2.0 {
            self.builder
                .approximate(place, "a chequerboard that is not laid over texture coordinates becomes its mean");
            return Ok(checker.mean_reflectance());
        }
        let mut value = checker.value();
        value["mean"] = checker.mean_reflectance();
        Ok(value)
    }

    fn image(&mut self, list: &Parameters, place: &str) -> Result<Value, String> {
        let file = list.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
        let encoding = match list.string("encoding") {
            None | Some("sRGB") => Encoding::Auto,
            Some("linear") => Encoding::Linear,
            Some(other) => {
                self.builder.approximate(place, format!("the encoding \"{other}\" becomes sRGB"));
                Encoding::Auto
            }
        };
        let found = self.builder.image_file(&file, encoding, place);
        let (name, mean) = match found {
            Ok(found) => found,
            Err(why) => {
                self.builder.leave_out(place, format!("the image is left out: {why}"));
                list.mark_all();
                return Ok(json!(0.5));
            }
        };
        let wrap = match list.string("wrap").unwrap_or("repeat") {
            "clamp" => "clamp",
            "repeat" => "repeat",
            other => {
                self.builder.approximate(place, format!("beyond its edges \"{other}\" becomes \"clamp\""));
                "clamp"
            }
        };
        // Samples of the pixel average what footprints would.
        list.get("filter");
        list.get("maxanisotropy");
        if list.string("mapping") == Some("uv") {
            list.get("mapping");
        }
        let image = json!({
            "type": "image", "file": name, "wrap": wrap,
            "encoding": if matches!(encoding, Encoding::Linear) { "linear" } else { "auto" },
            "uv_scale": [list.number_or("uscale", 1.0)?, list.number_or("vscale", 1.0)?],
            "uv_offset": [list.number_or("udelta", 0.0)?, list.number_or("vdelta", 0.0)?],
            "mean": reflectance(mean),
        });
        Ok(scaled(image, list.number_or("scale", 1.0)?))
    }
}

/// An image of colours as one of numbers.
pub(super) fn number_image(colours: &Value) -> Number {
    let mut image = without_mean(colours.clone());
    let factor = colours["factor"][0].as_f64().unwrap_or(1.0);
    if let Some(keys) = image.as_object_mut() {
        keys.remove("type");
        keys.remove("factor");
        keys.insert("channel".to_owned(), json!("mean"));
        if factor != 1.0 {
            keys.insert("factor".to_owned(), json!(factor));
        }
    }
    Number::Image(image, mean(colours).iter().sum::<f64>() / 3.0)
}

/// The mean of an image with its factor, or of a chequerboard.
fn mean(value: &Value) -> [f64; 3] {
    let factor = value["factor"][0].as_f64().unwrap_or(1.0);
    channels(&value["mean"]).unwrap_or([0.5; 3]).map(|channel| factor * channel)
}

/// An image times a factor.
fn scaled(mut image: Value, factor: f64) -> Value {
    if factor != 1.0 {
        let before = image["factor"][0].as_f64().unwrap_or(1.0);
        image["factor"] = json!([before * factor, before * factor, before * factor]);
    }
    image
}

/// A chequerboard times a factor.
fn scaled_fields(mut checker: Value, factor: f64) -> Value {
    let mean = mean(&checker);
    checker["mean"] = reflectance(mean.map(|channel| factor * channel));
    for field in ["first", "second"] {
        checker[field] = match &checker[field] {
            Value::Array(rgb) => rgb.iter().map(|v| factor * v.as_f64().unwrap_or(0.0)).collect(),
            grey => json!(factor * grey.as_f64().unwrap_or(0.0)),
        };
    }
    checker
}

/// The format has no key for the mean, which goes along for where no image may stand.
fn without_mean(mut value: Value) -> Value {
    if let Some(map) = value.as_object_mut() {
        map.remove("mean");
    }
    value
}

/// The kind of a file, by its name.
pub(super) fn kind(name: &str) -> String {
    extension(Path::new(name))
}
