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
    let mut list = noise(plate);
    list.extend([
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
    ]);
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

/// A cell of noise of 3 by 4 cells.
fn noise(plate: impl Fn(Value) -> Scene) -> Vec<Truth> {
    let (first, second, seed) = (0.1, 0.9, 5);
    // Both scale by a third and a quarter, and shift as much.
    let form = |placement: Value, octaves: u32| {
        let mut noise = json!({
            "type": "noise", "first": first, "second": second, "cells": [3, 4], "octaves": octaves, "seed": seed,
            "uv_offset": [1.0 / 3.0, 0.25],
        });
        noise.as_object_mut().expect("an object").extend(placement.as_object().expect("an object").clone());
        plate(noise)
    };
    let colour = move |t: f64| first + t * (second - first);
    let number =
        move |octave: u64, i: u64, j: u64| lattice_number(seed, octave, [i % (3 << octave), j % (4 << octave)]);
    let corners = move |octave: u64, i: u64, j: u64| {
        0.25 * [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(di, dj)| number(octave, i + di, j + dj)).iter().sum::<f64>()
    };
    // The cell (1, 1): u from 1/3 to 2/3, v from ¼ to ½.
    let one = form(json!({ "uv_scale": [1.0 / 3.0, 0.25] }), 1);
    let cell = corners(0, 1, 1);
    // Within it, 2 by 2 cells of the second octave.
    let two = form(json!({ "uv_matrix": [[1.0 / 3.0, 0], [0, 0.25]] }), 2);
    let finer = move || 0.25 * [(2, 2), (3, 2), (2, 3), (3, 3)].map(|(i, j)| corners(1, i, j)).iter().sum::<f64>();
    // By the definition, at places of the cell.
    let by_places = move |octaves: u32| {
        let bilinear = |octave: u64, u: f64, v: f64| {
            let [x, y] = [u * f64::from(3_u32 << octave), v * f64::from(4_u32 << octave)];
            let (i, j) = (x.floor() as u64, y.floor() as u64);
            let mix = |a: f64, b: f64, t: f64| a + t * (b - a);
            let row = |j: u64| mix(number(octave, i, j), number(octave, i + 1, j), x - x.floor());
            mix(row(j), row(j + 1), y - y.floor())
        };
        let n = 40;
        let place = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let at = |k: u32| {
            let (u, v) = ((1.0 + place(k % n)) / 3.0, (1.0 + place(k / n)) / 4.0);
            let (sum, weights) = (0..octaves).fold((0.0, 0.0), |(sum, weights), octave| {
                let weight = f64::from(octave).exp2().recip();
                (sum + weight * bilinear(u64::from(octave), u, v), weights + weight)
            });
            sum / weights
        };
        colour((0..n * n).map(at).sum::<f64>() / f64::from(n * n))
    };
    let because = "The mean of a bilinear cell is that of its corners. The picture shows the cell (1, 1) of the lattice, and the mean of its albedo.";
    let both = (cell + 0.5 * finer()) / 1.5;
    vec![
        Truth::new("noise-of-one-octave", &one, colour(cell), "first + (second − first)(v₁₁ + v₂₁ + v₁₂ + v₂₂)/4")
            .because(because)
            .confirmed("1600 places", 1e-9, move || by_places(1))
            .or_else("rows from the top", colour(corners(0, 1, 2)))
            .or_else("half a cell off along u", colour(0.5 * (cell + corners(0, 2, 1))))
            .or_else("half a cell off along v", colour(0.5 * (cell + corners(0, 1, 2))))
            .or_else("colours exchanged", colour(1.0 - cell))
            .sees(2e-3),
        Truth::new(
            "noise-of-two-octaves",
            &two,
            colour(both),
            "the same of v₀ + ½v₁ over 1½, with nine points of the second octave",
        )
        .because(because)
        .confirmed("1600 places", 1e-9, move || by_places(2))
        .or_else("the first octave alone", colour(cell))
        .or_else("octaves of equal strength", colour(0.5 * (cell + finer())))
        .sees(2e-3),
    ]
}

/// The random number in [0, 1) of a point of the lattice, as the scene format defines it.
fn lattice_number(seed: u64, octave: u64, [i, j]: [u64; 2]) -> f64 {
    let output = |state: u64| {
        let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    (output(output(output(output(seed) ^ octave) ^ i) ^ j) >> 11) as f64 * 0.5_f64.powi(53)
}
