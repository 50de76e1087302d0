//! Media that are thicker at some places than at others.

use serde_json::json;

use super::{
    Truth,
    media::{boundary, isotropic, medium, vol},
    scene::{Scene, black, block, level_square},
};
use crate::vector::{Vec3, add, length, scale, sub};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = atmospheres();
    list.push(grid());
    list
}

/// Ways up and down between the ground and a height.
fn atmospheres() -> Vec<Truth> {
    let (per_m, height, top) = (0.6, 2.0, 3.0_f64);
    let mut air = medium(0.0, per_m, &isotropic());
    air["density"] = json!({ "type": "exponential", "scale_height_m": height, "up": [0, 0, 3] });
    let mut list = Vec::new();
    for (name, degrees, down) in [
        ("through-air-straight-up", 0.0_f64, false),
        ("through-air-at-60-degrees", 60.0, false),
        ("through-air-straight-down", 0.0, true),
        ("through-air-down-at-60-degrees", 60.0, true),
    ] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let column = height * -(-top / height).exp_m1() / cosine;
        let value = (-per_m * column).exp();
        let (from, to) = if down { (top, 0.0) } else { (0.0, top) };
        let toward = [sine, 0.0, from + cosine * (to - from).signum()];
        let scene = Scene::orthographic([0.0, 0.0, from], toward, 1e-3).whole("medium", air.clone()).lamp(
            level_square([0.0, 0.0, to], 50.0, down),
            black(),
            1.0,
            "front",
        );
        let truth = Truth::new(name, &scene, value, "exp(−σ₀H(1 − e^(−h/H))/cos θ)")
            .because("The integral of e^(−s cos θ/H) over the way up to the height h, or down from it.")
            .confirmed("a sum over the way", 1e-8, move || {
                let n = 100_000;
                let step = top / cosine / f64::from(n);
                let sum: f64 = (0..n).map(|i| (-(f64::from(i) + 0.5) * step * cosine / height).exp()).sum();
                (-per_m * sum * step).exp()
            })
            .or_else("the same density everywhere", (-per_m * top / cosine).exp())
            .or_else("to the end of the air", (-per_m * height / cosine).exp())
            .sees(5e-3);
        list.push(truth);
    }
    list
}

/// A slanting way through eight cells, between their middles.
fn grid() -> Truth {
    const PER_M: f64 = 0.9;
    let values = [0.2, 1.4, 0.7, 0.1, 0.9, 0.3, 2.0, 0.6_f32];
    // The middles of the cells are at −1 and 1, before all of it is moved.
    let moved = [0.2, -0.1, 0.3];
    let file = vol([2, 2, 2], [[-2.0; 3], [2.0; 3]], &values);
    let mut smoke = medium(0.0, PER_M, &isotropic());
    smoke["density"] = json!({ "type": "grid", "file": "eight.vol", "transform": [{ "translate_m": moved }] });
    let density = move |at: Vec3, soft: bool| -> f64 {
        let share = at.map(|x| if soft { 0.5 * (x + 1.0) } else { f64::from(u8::from(x > 0.0)) });
        let weight = |corner: usize| -> f64 {
            (0..3).map(|k| if corner >> k & 1 == 1 { share[k] } else { 1.0 - share[k] }).product()
        };
        (0..8).map(|corner| weight(corner) * f64::from(values[corner])).sum()
    };
    let (enters, leaves) = ([-0.8, -0.6, 1.0], [0.7, 0.5, -1.0]);
    let way = sub(leaves, enters);
    let at = move |u: f64| add(enters, scale(u, way));
    let passes = move |mean: f64| (-PER_M * length(way) * mean).exp();
    // Along the way the density is a polynomial of the third degree, for which Gauss's rule of two points is exact.
    let apart = 0.5 / 3.0_f64.sqrt();
    let value = passes(0.5 * (density(at(0.5 - apart), true) + density(at(0.5 + apart), true)));
    let sum = move |soft: bool| {
        let n = 100_000;
        (0..n).map(|i| density(at((f64::from(i) + 0.5) / f64::from(n)), soft)).sum::<f64>() / f64::from(n)
    };
    let place = |p: Vec3| add(p, moved);
    let scene = Scene::orthographic(place(at(-0.5)), place(enters), 1e-4)
        .thing(json!({ "shape": block(place([-1.0; 3]), place([1.0; 3])), "material": boundary(&smoke) }))
        .file("eight.vol", file)
        .lamp(level_square([0.0, 0.0, -3.0], 10.0, true), black(), 1.0, "front");
    Truth::new("through-eight-cells", &scene, value, "exp(−σ ∫ρ ds), ρ trilinear between the middles of eight cells")
        .because("Densities of a grid are those at the middles of its cells, and go evenly from one to the next along each axis.")
        .confirmed("a sum over the way", 1e-8, move || passes(sum(true)))
        .or_else("cells of one density each", passes(sum(false)))
        .or_else("the density in the middle of the way", passes(density(at(0.5), true)))
        .or_else("the mean of all cells", passes(values.iter().map(|v| f64::from(*v)).sum::<f64>() / 8.0))
        .allows(1e-8, "the picture is 0.1 mm wide: the squares of what the density changes over it")
        .sees(5e-3)
}
