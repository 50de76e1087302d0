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

/// A reflectance times a factor: a number, a colour, a table, an image, a chequerboard or the colours of vertices.
pub(crate) fn scaled(mut value: Value, factor: f64) -> Value {
    if let Some(number) = value.as_f64() {
        return json!(number * factor);
    }
    if let Some(numbers) = value.as_array() {
        return numbers.iter().map(|number| scaled(number.clone(), factor)).collect();
    }
    let keys: &[&str] = match value["type"].as_str() {
        Some("rgb") => &["rgb"],
        Some("tabulated") => &["values"],
        Some("checker") => &["first", "second"],
        Some("image" | "vertex-colours") => &["factor"],
        _ => &[],
    };
    for key in keys {
        let before = value.get(key).cloned().unwrap_or(json!([1.0, 1.0, 1.0]));
        value[*key] = scaled(before, factor);
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_reflectance_is_scaled() {
        for (before, after) in [
            (json!(0.5), json!(0.25)),
            (json!({ "type": "rgb", "rgb": [0.5, 1.0, 0.0] }), json!({ "type": "rgb", "rgb": [0.25, 0.5, 0.0] })),
            (
                json!({ "type": "tabulated", "values": [1.0, 0.5] }),
                json!({ "type": "tabulated", "values": [0.5, 0.25] }),
            ),
            (json!({ "type": "image" }), json!({ "type": "image", "factor": [0.5, 0.5, 0.5] })),
            (
                json!({ "type": "checker", "first": [1.0, 0.5, 0.0], "second": 0.5 }),
                json!({ "type": "checker", "first": [0.5, 0.25, 0.0], "second": 0.25 }),
            ),
        ] {
            assert_eq!(scaled(before, 0.5), after);
        }
    }
}
