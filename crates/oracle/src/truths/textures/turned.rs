//! Images and patterns that lie turned or sheared over texture coordinates.

use serde_json::{Value, json};

use super::{matte, square, view};
use crate::truths::Truth;
use crate::truths::scene::grey_hdr;

const BECAUSE: &str = "Each place of a Lambert plane under a sky of radiance 1 shows its albedo. The image has two texels, so the line \
                       where they meet cuts the square into a triangle and the rest.";

/// The share of 2000 × 2000 places of the unit square where `within` holds.
fn share(within: impl Fn(f64, f64) -> bool) -> f64 {
    let at = |k: u32| (f64::from(k) + 0.5) / 2000.0;
    let inside = (0..2000).flat_map(|j| (0..2000).map(move |i| (i, j))).filter(|&(i, j)| within(at(i), at(j)));
    inside.count() as f64 / 4e6
}

/// The area of the corner that the line a·u + b·v = c cuts off at (0, 0).
fn corner(a: f64, b: f64, c: f64) -> f64 {
    0.5 * (c / a) * (c / b)
}

pub(super) fn turned() -> Vec<Truth> {
    let seen = |albedo: Value| view([0.5, 0.5], 1.0).thing(json!({ "shape": square(), "material": matte(albedo) }));
    // The angle of a triangle of sides 3, 4 and 5: u′ = 0.8 u + 0.6 v.
    let file = "two-texels.hdr";
    let image = json!({
        "type": "image", "file": file, "filter": "nearest", "wrap": "clamp", "uv_matrix": [[0.8, 0.6], [-0.6, 0.8]],
    });
    let of_image = |left: f64| 0.25 * left + 0.75 * (1.0 - left);
    // The fields of the board are half a unit wide; v′ = 0.1 + v/4 stays in the first row.
    let board = json!({
        "type": "checker", "first": 0.8, "second": 0.2, "uv_matrix": [[0.8, 0.6], [0, 0.25]], "uv_offset": [0, 0.1],
    });
    let of_board = |first: f64| 0.8 * first + 0.2 * (1.0 - first);
    // Beyond u′ = 1, at the upper right corner, the first field comes again: 0.8 (1 − u) + 0.6 (1 − v) < 0.4.
    let first = corner(0.8, 0.6, 0.5) + corner(0.8, 0.6, 0.4);
    let ramp = json!({
        "type": "gradient", "from": 0.2, "to": 0.8, "uv_matrix": [[0.4, 0.3], [0.5, -1]], "uv_offset": [0.1, 7],
    });
    let of_ramp = |t: f64| 0.2 + 0.6 * t;
    // ∫∫ max(0, 0.1 + 0.4 u − 0.3 v), whose negative part lies at u = 0, v = 1: a pyramid over the corner that the line cuts off.
    let other_way = 0.1 + 0.2 - 0.15 + corner(0.4, 0.3, 0.2) * 0.2 / 3.0;
    vec![
        Truth::new(
            "texture-turned",
            &seen(image).file(file, grey_hdr(2, &[0.25, 0.75])),
            of_image(corner(0.8, 0.6, 0.5)),
            "¼ A + ¾ (1 − A), A = ½ · 0.5/0.8 · 0.5/0.6: left of ½ lie the places with 0.8 u + 0.6 v < ½",
        )
        .because(BECAUSE)
        .confirmed("counted places", 1e-3, move || of_image(share(|u, v| 0.8 * u + 0.6 * v < 0.5)))
        .or_else("turned the other way", of_image(share(|u, v| 0.8 * u - 0.6 * v < 0.5)))
        .or_else("not turned", of_image(0.5))
        .or_else("the part of v left out", of_image(0.625))
        .sees(0.01),
        Truth::new(
            "chequerboard-sheared",
            &seen(board),
            of_board(first),
            "0.8 A + 0.2 (1 − A), A the corners with 0.8 u + 0.6 v below ½ and above 1",
        )
        .because("A plane under an even sky shows its albedo, and the picture the mean of it.")
        .confirmed("counted places", 1e-3, move || {
            of_board(share(|u, v| {
                let along = 0.8 * u + 0.6 * v;
                along - along.floor() < 0.5
            }))
        })
        .or_else("rows and columns of the matrix exchanged", of_board(0.625))
        .or_else(
            "sheared the other way",
            of_board(share(|u, v| {
                let along = 0.8 * u - 0.6 * v;
                along - along.floor() < 0.5
            })),
        )
        .sees(0.01),
        Truth::new(
            "gradient-turned",
            &seen(ramp),
            of_ramp(0.45),
            "0.2 + 0.6 t, t = 0.1 + 0.4/2 + 0.3/2 in the middle of the square",
        )
        .because("A plane under an even sky shows its albedo, and the mean of an even change is what is in the middle.")
        .confirmed("the mean of its corners", 1e-12, move || {
            let corners = [0.1, 0.1 + 0.4, 0.1 + 0.3, 0.1 + 0.4 + 0.3];
            corners.into_iter().map(of_ramp).sum::<f64>() / 4.0
        })
        .or_else("turned the other way", of_ramp(other_way))
        .or_else("the part of v left out", of_ramp(0.3))
        .or_else("the other row of the matrix", of_ramp(1.0))
        .sees(0.005),
    ]
}
