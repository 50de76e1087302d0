//! Sheets that scatter light to both sides.

use serde_json::{Value, json};

use crate::Builder;

/// The material of two shares. Where these are known to add up to more than 1, both are lowered alike.
pub(crate) fn translucent(reflectance: Value, transmittance: Value, place: &str, builder: &mut Builder<'_>) -> Value {
    let most = match (channels(&reflectance), channels(&transmittance)) {
        (Some(r), Some(t)) => [0, 1, 2].map(|c| r[c] + t[c]).into_iter().fold(0.0, f64::max),
        _ => 0.0,
    };
    let mut shares = [reflectance, transmittance];
    if most > 1.0 {
        builder
            .approximate(place, format!("reflectance and transmittance add up to {most:.3}: both are divided by it"));
        shares = shares.map(|share| scaled(share, 1.0 / most));
    }
    let [reflectance, transmittance] = shares;
    json!({ "type": "translucent", "reflectance": reflectance, "transmittance": transmittance })
}

/// A reflectance times a factor, where it is a number, a colour or an image; others stay as they are.
pub(crate) fn scaled(mut value: Value, factor: f64) -> Value {
    if let Some(number) = value.as_f64() {
        return json!(number * factor);
    }
    let key = match value["type"].as_str() {
        Some("rgb") => "rgb",
        Some("image") => "factor",
        _ => return value,
    };
    let before = |c: usize| value[key][c].as_f64().or_else(|| value[key].as_f64()).unwrap_or(1.0);
    value[key] = json!([0, 1, 2].map(|c| before(c) * factor));
    value
}

/// The channels of a number or a colour.
fn channels(value: &Value) -> Option<[f64; 3]> {
    let number = value.as_f64().map(|number| [number; 3]);
    let rgb = || {
        let channel = |c: usize| value["rgb"][c].as_f64();
        Some([channel(0)?, channel(1)?, channel(2)?])
    };
    number.or_else(rgb)
}
