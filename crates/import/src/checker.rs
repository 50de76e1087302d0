//! Chequerboards of other programs.

use std::io::Cursor;

use etalon_optics::colour::rec709_luminance;
use etalon_scene::UvMap;
use image::{ImageBuffer, ImageFormat, Luma};
use serde_json::{Map, Value, json};

use crate::number::Number;
use crate::{Builder, reflectance, uv};

/// A chequerboard of the format, two by two fields in a unit of the texture coordinates, and its mean.
#[derive(Clone, Debug)]
pub(crate) struct Checker {
    /// Colours of the lower left field and of its neighbours.
    pub(crate) colours: [[f64; 3]; 2],
    /// How it lies over the coordinates.
    pub(crate) uv_map: UvMap,
}

impl Checker {
    /// As a spectrum of the format.
    pub(crate) fn value(&self) -> Value {
        let [first, second] = self.colours.map(written);
        let mut checker = Map::new();
        for (key, value) in [("type", json!("checker")), ("first", first), ("second", second)] {
            checker.insert(key.to_owned(), value);
        }
        uv::put(&self.uv_map, &mut checker);
        Value::Object(checker)
    }

    /// What both fields are in the mean.
    pub(crate) fn mean(&self) -> [f64; 3] {
        let [first, second] = self.colours;
        [0, 1, 2].map(|c| 0.5 * (first[c] + second[c]))
    }

    /// The numbers of both fields. A colour counts by its luminance.
    pub(crate) fn fields(&self) -> [f64; 2] {
        self.colours.map(|rgb| if rgb == [rgb[0]; 3] { rgb[0] } else { rec709_luminance(rgb) })
    }

    /// As numbers from 0 to 1, which are an image of their own in steps of 1/65535.
    pub(crate) fn numbers(&self, builder: &mut Builder<'_>) -> Number {
        let [first, second] = self.fields();
        if first == second {
            return Number::Value(first);
        }
        let mut image = Map::new();
        image.insert("file".to_owned(), json!(builder.add_file("checker", "png", png([first, second]))));
        for (key, word) in [("channel", "luminance"), ("encoding", "linear"), ("filter", "nearest")] {
            image.insert(key.to_owned(), json!(word));
        }
        uv::put(&self.uv_map, &mut image);
        Number::Image(Value::Object(image), 0.5 * (first + second))
    }

    /// As a reflectance of the format that is the same everywhere.
    pub(crate) fn mean_reflectance(&self) -> Value {
        reflectance(self.mean())
    }
}

/// Two by two fields, of which the first is lower left.
fn png([first, second]: [f64; 2]) -> Vec<u8> {
    let grey = |share: f64| (share.clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16;
    let fields = [second, first, first, second].map(grey).to_vec();
    let image = ImageBuffer::<Luma<u16>, _>::from_raw(2, 2, fields).expect("four texels");
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).expect("memory takes every byte");
    bytes.into_inner()
}

fn written(rgb: [f64; 3]) -> Value {
    if rgb[0] == rgb[1] && rgb[1] == rgb[2] { json!(rgb[0]) } else { json!(rgb) }
}

/// The channels of a colour of the format; `None` of another spectrum.
pub(crate) fn channels(value: &Value) -> Option<[f64; 3]> {
    if let Some(grey) = value.as_f64() {
        return Some([grey; 3]);
    }
    let list = value["rgb"].as_array()?;
    let scale = value["scale"].as_f64().unwrap_or(1.0);
    Some(std::array::from_fn(|c| scale * list.get(c).and_then(Value::as_f64).unwrap_or(0.0)))
}
