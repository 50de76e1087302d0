//! Spectra, colours and textures of Mitsuba.

use etalon_optics::colour::{rec709_luminance, srgb_decode};
use std::path::Path;

use etalon_scene::{Encoding, UvMap, shortened};
use serde_json::{Value, json};

use super::Walk;
use super::element::{Element, numbers};
use crate::checker::{Checker, channels};
use crate::matrix::rows;
use crate::number::Number;
use crate::table::Table;
use crate::{coefficient, extension, light, reflectance, uv, vertex_colours};

/// What a colour is the colour of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// A share of light, from 0 to 1; images may stand here.
    Texture,
    /// The same, where no image may stand.
    Reflectance,
    /// A coefficient of a medium, 0 or above.
    Coefficient,
    /// Light.
    Emission,
    /// Light of a surface; images may stand here.
    Shining,
}

impl Of {
    fn is_light(self) -> bool {
        matches!(self, Self::Emission | Self::Shining)
    }

    /// The largest value that it may have.
    fn most(self) -> f64 {
        if self.is_light() || self == Self::Coefficient { f64::MAX } else { 1.0 }
    }
}

impl Walk<'_, '_, '_> {
    /// The colour that an element has under one of some names, as a spectrum of the format.
    pub(super) fn colour(&mut self, element: &Element, name: &str, of: Of) -> Result<Option<Value>, String> {
        element.property(name).map(|colour| self.colour_of(colour, of)).transpose()
    }

    /// A number from 0 to 1 that an element has under a name, perhaps by an image. A colour counts by the mean of its channels.
    pub(super) fn number(&mut self, element: &Element, name: &str) -> Result<Option<Number>, String> {
        self.number_of(element, name, Of::Reflectance)
    }

    /// The same of a number that may be as large as `of` says.
    pub(super) fn number_of(&mut self, element: &Element, name: &str, of: Of) -> Result<Option<Number>, String> {
        let Some(stated) = element.property(name) else { return Ok(None) };
        let target = if stated.tag == "ref" { self.ids.of(stated)? } else { stated };
        if target.tag == "texture" && target.plugin() == "bitmap" {
            target.mark();
            let (image, mean) = self.bitmap(target)?.unzip();
            target.list_unused(self.builder);
            let Some(mut image) = image else { return Ok(None) };
            // Three channels count by their luminance there, after the curve of sRGB.
            image["channel"] = json!("luminance");
            if let Some(keys) = image.as_object_mut() {
                keys.remove("type");
            }
            return Ok(Some(Number::Image(image, rec709_luminance(mean.unwrap_or([0.0; 3])))));
        }
        if target.tag == "texture" && target.plugin() == "checkerboard" {
            target.mark();
            let mut board = self.checkerboard(target, of)?;
            target.list_unused(self.builder);
            // Mitsuba 3.9 lays numbers the other way round than colours.
            board.colours.swap(0, 1);
            return Ok(Some(self.field_of(&board)));
        }
        let value = self.colour_of(stated, of)?;
        Ok(Some(Number::Value(match value.as_f64() {
            Some(number) => number,
            None => {
                self.builder
                    .approximate(&element.place, format!("\"{name}\" is a colour: the mean of its channels is used"));
                let channels = value["rgb"].as_array().map_or(&[][..], Vec::as_slice);
                channels.iter().filter_map(Value::as_f64).sum::<f64>() / channels.len().max(1) as f64
            }
        })))
    }

    pub(super) fn colour_of(&mut self, element: &Element, of: Of) -> Result<Value, String> {
        let place = &element.place;
        let value = match element.tag.as_str() {
            "ref" => {
                let target = self.ids.of(element)?;
                target.mark();
                let value = match target.tag.as_str() {
                    "texture" | "spectrum" | "rgb" | "srgb" => self.colour_of(target, of)?,
                    other => return Err(format!("{place}: a <{other}> stands where a colour should")),
                };
                self.builder.spend(&value, place)?;
                return Ok(value);
            }
            "rgb" => self.rgb(element.attribute("value").unwrap_or(""), place, of)?,
            "srgb" => {
                let text = element.attribute("value").unwrap_or("");
                let encoded = encoded(text).map_err(|why| format!("{place}: {why}"))?;
                self.channels(encoded.map(srgb_decode), place, of)?
            }
            "float" | "integer" => {
                let text = element.attribute("value").unwrap_or("");
                let value: f64 = text.trim().parse().map_err(|_| format!("{place}: \"{text}\" is not a number"))?;
                // As light, a number is white there: D65 in the spectral variants. A `spectrum` of one number is of equal energy.
                if of.is_light() { self.channels([value; 3], place, of)? } else { self.constant(value, place, of) }
            }
            "spectrum" => self.spectrum(element, of)?,
            "texture" => self.texture(element, of)?,
            other => return Err(format!("{place}: a <{other}> stands where a colour should")),
        };
        element.list_unused(self.builder);
        Ok(value)
    }

    pub(super) fn rgb(&mut self, text: &str, place: &str, of: Of) -> Result<Value, String> {
        let rgb = three(text).map_err(|why| format!("{place}: {why}"))?;
        self.channels(rgb, place, of)
    }

    fn channels(&mut self, rgb: [f64; 3], place: &str, of: Of) -> Result<Value, String> {
        Ok(match of {
            Of::Emission | Of::Shining => {
                if rgb.iter().any(|v| *v < 0.0) {
                    self.builder.approximate(place, "negative light becomes 0");
                }
                light(rgb.map(|v| v.max(0.0)), 1.0)
            }
            Of::Coefficient => {
                if rgb.iter().any(|v| *v < 0.0) {
                    self.builder.approximate(place, "negative coefficients become 0");
                }
                coefficient(rgb.map(|v| v.max(0.0)))
            }
            Of::Texture | Of::Reflectance => {
                if rgb.iter().any(|v| !(0.0..=1.0).contains(v)) {
                    self.builder.approximate(place, format!("{rgb:?} is not a reflectance: it is clamped to 0 to 1"));
                }
                reflectance(rgb)
            }
        })
    }

    fn constant(&mut self, value: f64, place: &str, of: Of) -> Value {
        let (low, high) = (0.0, of.most());
        if !(low..=high).contains(&value) {
            self.builder.approximate(place, format!("{value} is clamped to {low} to {high}"));
        }
        json!(value.clamp(low, high))
    }

    fn spectrum(&mut self, element: &Element, of: Of) -> Result<Value, String> {
        let place = &element.place;
        if let Some(text) = element.attribute("value") {
            if text.contains(':') {
                let pairs = text.replace(':', " ");
                let list = numbers(&pairs).map_err(|why| format!("{place}: {why}"))?;
                return self.table(&list, place, of);
            }
            // In version 0.x, three values are three channels.
            if text.contains(',') {
                return self.rgb(text, place, of);
            }
            let value: f64 = text.trim().parse().map_err(|_| format!("{place}: \"{text}\" is not a number"))?;
            return Ok(self.constant(value, place, of));
        }
        if let Some(name) = element.attribute("filename") {
            return self.file(name, place, of);
        }
        let list = |name: &str| {
            let text = element.string(name).ok_or_else(|| format!("{place}: it has no \"{name}\""))?;
            numbers(text).map_err(|why| format!("{place}: {why}"))
        };
        match (element.plugin(), of) {
            ("uniform", _) => Ok(self.constant(element.number("value")?.unwrap_or(1.0), place, of)),
            ("irregular", _) => {
                if let Some(name) = element.string("filename") {
                    return self.file(name, place, of);
                }
                let (wavelengths, values) = (list("wavelengths")?, list("values")?);
                let pairs: Vec<f64> = wavelengths.iter().zip(&values).flat_map(|(a, b)| [*a, *b]).collect();
                self.table(&pairs, place, of)
            }
            ("regular", _) => {
                let range = ["wavelength_min", "wavelength_max"].map(|name| element.number(name));
                let [Ok(Some(low)), Ok(Some(high))] = range else {
                    return Err(format!("{place}: it has no wavelength_min and wavelength_max"));
                };
                let values = list("values")?;
                let step = (high - low) / (values.len().max(2) - 1) as f64;
                let pairs: Vec<f64> =
                    values.iter().enumerate().flat_map(|(i, value)| [low + step * i as f64, *value]).collect();
                self.table(&pairs, place, of)
            }
            ("blackbody", Of::Emission | Of::Shining) => {
                let kelvin = element.number("temperature")?.unwrap_or(5000.0);
                Ok(
                    json!({ "type": "blackbody", "temperature_k": kelvin, "scale": element.number("scale")?.unwrap_or(1.0) }),
                )
            }
            ("d65", Of::Emission | Of::Shining) => {
                let scale = element.number("scale")?.unwrap_or(1.0);
                match element.property("color") {
                    Some(colour) => self.rgb(colour.attribute("value").unwrap_or(""), place, of).map(|mut light| {
                        light["scale"] = json!(scale);
                        light
                    }),
                    None => Ok(json!({ "type": "illuminant", "name": "D65", "scale": scale })),
                }
            }
            ("srgb", _) => match element.property("color") {
                Some(colour) => self.rgb(colour.attribute("value").unwrap_or(""), place, of),
                None => Err(format!("{place}: it has no \"color\"")),
            },
            (other, _) => {
                self.builder.approximate(place, format!("the spectrum \"{other}\" is not known: it becomes 0.5"));
                Ok(json!(0.5))
            }
        }
    }

    /// A file of wavelengths and values.
    fn file(&mut self, name: &str, place: &str, of: Of) -> Result<Value, String> {
        let bytes = self.builder.bytes_of(name, place)?;
        let text = String::from_utf8_lossy(&bytes);
        let without_comments: Vec<&str> = text.lines().map(|line| line.split('#').next().unwrap_or("")).collect();
        let list = numbers(&without_comments.join(" ")).map_err(|why| format!("{place}: \"{name}\": {why}"))?;
        let table = self.table(&list, place, of)?;
        self.builder.spend(&table, place)?;
        Ok(table)
    }

    /// Wavelengths, nm, and values in turn; nothing outside of them, as in the program.
    fn table(&mut self, pairs: &[f64], place: &str, of: Of) -> Result<Value, String> {
        let table = Table::of_pairs(pairs);
        let mut table = table
            .ok_or_else(|| format!("{place}: {} numbers are not a table of wavelengths and values", pairs.len()))?;
        let highest = of.most();
        if table.0.iter().any(|(_, v)| !(0.0..=highest).contains(v)) {
            self.builder.approximate(place, format!("values are clamped to 0 to {highest}"));
            table.0.iter_mut().for_each(|(_, v)| *v = v.clamp(0.0, highest));
        }
        Ok(table.spectrum("zero"))
    }

    fn texture(&mut self, element: &Element, of: Of) -> Result<Value, String> {
        let place = &element.place;
        if element.plugin() == "checkerboard" {
            let checker = self.checkerboard(element, of)?;
            if of == Of::Texture || of == Of::Shining {
                return Ok(checker.value());
            }
            self.builder.approximate(place, "the mean of the chequerboard is used");
            let mean = checker.mean();
            return Ok(match of {
                Of::Emission => light(mean, 1.0),
                Of::Coefficient => coefficient(mean),
                _ => checker.mean_reflectance(),
            });
        }
        if element.plugin() == "mesh_attribute" {
            let name = element.string("name").unwrap_or("").to_owned();
            let scale = element.number("scale")?.unwrap_or(1.0);
            if of == Of::Texture {
                return Ok(vertex_colours::attribute(&name, scale));
            }
            let what = format!("of meshes only colours are read, no numbers: \"{name}\" is 0.5 on the whole mesh");
            self.builder.approximate(place, what);
            return Ok(json!(0.5));
        }
        if element.plugin() != "bitmap" {
            let what = element.plugin();
            self.builder.approximate(place, format!("the texture \"{what}\" is not known: it becomes 0.5"));
            element.mark();
            element.children.iter().for_each(Element::mark);
            return Ok(json!(0.5));
        }
        let Some((image, mean)) = self.bitmap(element)? else {
            return Ok(if of.is_light() { json!(0.0) } else { json!(0.5) });
        };
        if of != Of::Texture && of != Of::Shining {
            self.builder.approximate(place, "the mean of the image is used");
            return Ok(if of.is_light() { light(mean, 1.0) } else { reflectance(mean) });
        }
        Ok(image)
    }

    /// The chequerboard that a texture is. As ours, its fields are half a unit wide, the first at (0, 0).
    fn checkerboard(&mut self, element: &Element, of: Of) -> Result<Checker, String> {
        let of = match of {
            Of::Emission | Of::Shining => Of::Emission,
            Of::Coefficient => Of::Coefficient,
            Of::Reflectance | Of::Texture => Of::Reflectance,
        };
        let mut colours = [[0.4; 3], [0.2; 3]];
        for (colour, name) in colours.iter_mut().zip(["color0", "color1"]) {
            let Some(value) = self.colour(element, name, of)? else { continue };
            *colour = channels(&value).unwrap_or_else(|| {
                self.builder.approximate(&element.place, format!("\"{name}\" is a spectrum: it becomes a grey of 0.5"));
                [0.5; 3]
            });
        }
        Ok(Checker { colours, uv_map: to_uv(element)? })
    }

    /// The image of the format that a `bitmap` is, and the mean of its texels; `None`, and a note, if it cannot be read.
    pub(super) fn bitmap(&mut self, element: &Element) -> Result<Option<(Value, [f64; 3])>, String> {
        let place = &element.place;
        let name = element.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
        let raw = element.flag("raw")?.unwrap_or(false);
        let word = element.string("wrap_mode").unwrap_or("repeat").to_owned();
        let filter = element.string("filter_type").unwrap_or("bilinear").to_owned();
        // The program counts v from the top of the image.
        let uv_map = uv::from_above(&to_uv(element)?);
        let wrap = match word.as_str() {
            "mirror" | "clamp" | "repeat" => word.as_str(),
            _ => "repeat",
        };
        let filter = if filter == "nearest" { "nearest" } else { "bilinear" };
        Ok(self.image(&name, raw, place).map(|(file, mean)| {
            let encoding = if raw { "linear" } else { "auto" };
            let mut image =
                json!({ "type": "image", "file": file, "encoding": encoding, "wrap": wrap, "filter": filter });
            image.as_object_mut().into_iter().for_each(|keys| uv::put(&uv_map, keys));
            (image, mean)
        }))
    }

    /// The file of an image in the scene, and the mean of its texels; `None`, and a note, if it cannot be read.
    pub(super) fn image(&mut self, name: &str, raw: bool, place: &str) -> Option<(String, [f64; 3])> {
        let encoding = if raw { Encoding::Linear } else { Encoding::Auto };
        let found = self.builder.image_file(name, encoding, place);
        match found {
            Ok(found) => Some(found),
            Err(why) => {
                self.builder.leave_out(place, format!("the image is left out: {why}"));
                None
            }
        }
    }
}

/// A light or a coefficient of the format, times a factor.
pub(super) fn times(mut spectrum: Value, factor: f64) -> Value {
    if let Some(number) = spectrum.as_f64() {
        return json!(number * factor);
    }
    if factor != 1.0 {
        spectrum["scale"] = json!(spectrum["scale"].as_f64().unwrap_or(1.0) * factor);
    }
    spectrum
}

/// The map from texture coordinates to those of a texture. Of a transform in space, what it does to x and y counts.
fn to_uv(texture: &Element) -> Result<UvMap, String> {
    let Some(transform) = texture.property("to_uv") else { return Ok(UvMap::IDENTITY) };
    let [[a, b, _, u], [c, d, _, v], _] = rows(&super::transform::read(transform)?);
    Ok(UvMap { matrix: [[a, b], [c, d]], offset: [u, v] })
}

/// The kind of a file, by its name.
pub(super) fn kind(name: &str) -> String {
    extension(Path::new(name))
}

/// Three channels, or one for all.
pub(super) fn three(text: &str) -> Result<[f64; 3], String> {
    match numbers(text)?[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(format!("\"{}\" is not a colour", shortened(text.to_owned()))),
    }
}

/// Channels after the curve of sRGB, as numbers or as #rrggbb.
fn encoded(text: &str) -> Result<[f64; 3], String> {
    let Some(digits) = text.trim().strip_prefix('#') else { return three(text) };
    match u32::from_str_radix(digits, 16) {
        Ok(bits) if digits.len() == 6 => Ok([16, 8, 0].map(|shift| f64::from(bits >> shift & 255) / 255.0)),
        _ => Err(format!("\"{}\" is not a colour", shortened(text.to_owned()))),
    }
}
