//! Patterns that need no image.

use serde_json::{Value, json};

use crate::truths::Truth;
use crate::truths::scene::Scene;

/// Chequerboards and even changes of a colour, on a plate under a sky of radiance 1: each place shows its albedo.
pub(super) fn patterns() -> Vec<Truth> {
    // Three by three fields are seen of a board on [0, 1]², five of them the first.
    let plate = |reflectance: Value| {
        let shape = json!({ "type": "parallelogram", "origin_m": [-1, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0] });
        Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 2.0)
            .thing(json!({ "shape": shape, "material": { "type": "lambert", "reflectance": reflectance } }))
            .sky(1.0)
            .film(48, 48)
            .spp(64)
    };
    let board = plate(json!({ "type": "checker", "first": 0.8, "second": 0.2, "uv_scale": [1.5, 1.5] }));
    let fields = |first: f64| (first * 0.8 + (9.0 - first) * 0.2) / 9.0;
    // Of a grid of places in fields of a third.
    let by_places = || {
        let field = |k: u32| 3 * (2 * k + 1) / 60;
        let shown = |i: u32, j: u32| if (field(i) + field(j)).is_multiple_of(2) { 0.8 } else { 0.2 };
        (0..30).flat_map(|i| (0..30).map(move |j| (i, j))).map(|(i, j)| shown(i, j)).sum::<f64>() / 900.0
    };
    // A shift by half a unit of the board along u exchanges its fields, along v as well.
    let shifted =
        plate(json!({ "type": "checker", "first": 0.8, "second": 0.2, "uv_scale": [1.5, 1.5], "uv_offset": [0.5, 0] }));
    let ramp = |along: &str| {
        let (scale, offset) = if along == "u" { ([2, 1], [-0.25, 0.5]) } else { ([1, 2], [0.5, -0.25]) };
        plate(json!({
            "type": "gradient", "from": 0.2, "to": [0.8, 0.8, 0.8], "along": along, "uv_scale": scale,
            "uv_offset": offset,
        }))
    };
    // 2t − ¼ reaches 0 at ⅛ and 1 at ⅝; of the other coordinate t + ½ reaches 1 at ½.
    let mean = 0.125 * 0.2 + 0.5 * 0.5 + 0.375 * 0.8;
    let ramp_by_places = || {
        let at = |k: u32| ((f64::from(k) + 0.5) / 4000.0 * 2.0 - 0.25).clamp(0.0, 1.0);
        (0..4000).map(|k| 0.2 + 0.6 * at(k)).sum::<f64>() / 4000.0
    };
    let because = "A plane under an even sky shows its albedo, and the picture the mean of it.";
    let mut list = vec![
        Truth::new("chequerboard-of-nine-fields", &board, fields(5.0), "(5 · 0.8 + 4 · 0.2)/9")
            .because(because)
            .confirmed("the fields of 900 places", 1e-12, by_places)
            .or_else("colours exchanged", fields(4.0))
            .sees(2e-3),
        Truth::new("chequerboard-shifted-by-a-field", &shifted, fields(4.0), "(4 · 0.8 + 5 · 0.2)/9")
            .because(because)
            .confirmed("what the nine fields leave of both colours", 1e-12, move || 1.0 - by_places())
            .or_else("not shifted", fields(5.0))
            .sees(2e-3),
    ];
    for along in ["u", "v"] {
        list.push(
            Truth::new(
                format!("gradient-along-{along}"),
                &ramp(along),
                mean,
                "⅛ · 0.2 + ½ · 0.5 + ⅜ · 0.8: it changes between ⅛ and ⅝",
            )
            .because(because)
            .confirmed("4000 midpoints", 1e-6, ramp_by_places)
            .or_else("ends exchanged", 1.0 - mean)
            .or_else("not shifted", 0.5 * 0.5 + 0.5 * 0.8)
            .or_else("along the other coordinate", 0.5 * 0.65 + 0.5 * 0.8)
            .sees(2e-3),
        );
    }
    list
}
