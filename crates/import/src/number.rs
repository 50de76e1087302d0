//! Numbers of materials, which may be images.

use etalon_scene::LEAST_ALPHA;
use serde_json::{Value, json};

use crate::Builder;

/// A number from 0 to 1.
#[derive(Clone, Debug)]
pub(crate) enum Number {
    Value(f64),
    /// An image of the format that says numbers, and the mean of its texels.
    Image(Value, f64),
}

impl Number {
    /// What it is everywhere, or in the mean, which is listed.
    pub(crate) fn mean(self, what: &str, place: &str, builder: &mut Builder<'_>) -> f64 {
        match self {
            Self::Value(value) => value,
            Self::Image(_, mean) => {
                builder.approximate(place, format!("the mean of the image of \"{what}\" is used"));
                mean
            }
        }
    }

    /// The share of a material of the format's `blend`.
    pub(crate) fn put_weight(self, blend: &mut Value) {
        match self {
            Self::Value(weight) => blend["weight"] = json!(weight),
            Self::Image(image, _) => blend["weight_image"] = image,
        }
    }
}

/// How rough a surface is.
#[derive(Clone, Debug)]
pub(crate) enum Rough {
    /// The width α.
    Alpha(f64),
    /// Widths along the direction of growing u and across it.
    Widths([f64; 2]),
    /// An image of the format.
    Image(Value),
}

impl Rough {
    /// A width as the format has it: below what it resolves the surface is smooth.
    pub(crate) fn width(alpha: f64) -> Self {
        Self::Alpha(within(alpha))
    }

    /// Widths along the direction of growing u and across it: below what the format resolves they are the least that it does, unless both are.
    pub(crate) fn widths([u, v]: [f64; 2]) -> Self {
        if u == v || (within(u) == 0.0 && within(v) == 0.0) {
            return Self::width(u);
        }
        Self::Widths([u, v].map(|alpha| alpha.clamp(LEAST_ALPHA, 1.0)))
    }

    /// Of an image whose numbers are a quantity of the format.
    pub(crate) fn image(mut image: Value, quantity: &str) -> Self {
        image["quantity"] = json!(quantity);
        Self::Image(image)
    }

    /// Says it of a material.
    pub(crate) fn put(self, material: &mut Value) {
        match self {
            Self::Alpha(alpha) => material["alpha"] = json!(alpha),
            Self::Widths([u, v]) => (material["alpha_u"], material["alpha_v"]) = (json!(u), json!(v)),
            Self::Image(image) => material["roughness_image"] = image,
        }
    }
}

fn within(alpha: f64) -> f64 {
    if alpha < LEAST_ALPHA { 0.0 } else { alpha.min(1.0) }
}

/// Whether a material of the format, or a part of it, is a measured one with a grain.
pub(crate) fn has_measured_grain(value: &Value) -> bool {
    match value {
        Value::Object(map) => {
            let measured = map.get("type").is_some_and(|kind| kind == "measured");
            measured && map.contains_key("tangent_rotation_deg") || map.values().any(has_measured_grain)
        }
        _ => false,
    }
}

/// Takes the directions away from facets of two widths, in a material of the format: the geometric mean of both is their width. Returns
/// whether there were any.
pub(crate) fn without_directions(value: &mut Value) -> bool {
    match value {
        Value::Object(map) => {
            let widths = [map.remove("alpha_u"), map.remove("alpha_v")].map(|width| width.and_then(|w| w.as_f64()));
            map.remove("tangent_rotation_deg");
            if let [Some(u), Some(v)] = widths {
                map.insert("alpha".to_owned(), json!((u * v).sqrt()));
                return true;
            }
            // Each of them, not the first alone.
            map.values_mut().map(without_directions).filter(|found| *found).count() > 0
        }
        _ => false,
    }
}

/// Whether facets of a material of the format have two widths, or a measured one has a grain.
pub(crate) fn has_directions(value: &Value) -> bool {
    match value {
        Value::Object(map) => {
            map.contains_key("alpha_u") || map.contains_key("tangent_rotation_deg") || map.values().any(has_directions)
        }
        _ => false,
    }
}

/// What is said where facets lose their directions.
pub(crate) const WITHOUT_DIRECTIONS: &str =
    "it has no texture coordinates for the directions of its roughness: the geometric mean of both widths is taken";

/// Whether a material of the format shows an image.
pub(crate) fn has_image(value: &Value) -> bool {
    match value {
        Value::Object(map) => {
            map.get("type").is_some_and(|t| ["image", "checker", "gradient"].iter().any(|kind| t == kind))
                || map.iter().any(|(key, value)| key.ends_with("_image") || has_image(value))
        }
        Value::Array(list) => list.iter().any(has_image),
        _ => false,
    }
}
