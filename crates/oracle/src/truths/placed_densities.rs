//! Media whose keys act together: an atmosphere that begins elsewhere, a grid of densities times a factor, and albedos beyond their box.

use std::f64::consts::PI;

use serde_json::json;

use super::{
    Claim, Truth,
    media::{boundary, isotropic, medium, vol},
    scene::{Scene, black, block, level_square},
    textures::{Shown, Wrap},
    tiles::with,
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![atmosphere(), smoke()];
    list.extend([Wrap::Repeat, Wrap::Mirror].map(beyond));
    list.into_iter().map(|truth| truth.claims(Claim::Scattering)).collect()
}

/// A lamp seen through air whose density is 1 at a point that is not the origin, along a slanting up.
fn atmosphere() -> Truth {
    const PER_M: f64 = 0.5;
    const HEIGHT_M: f64 = 1.5;
    let (base, up) = ([0.4, -0.3, 0.8], [0.6, 0.0, 0.8]);
    let mut air = medium(0.0, PER_M, &isotropic());
    air["density"] = json!({ "type": "exponential", "scale_height_m": HEIGHT_M, "base_m": base, "up": [3, 0, 4] });
    // Straight up from z = 0 to 2: heights count 0.8 of the way, from 0.6(x − 0.4) + 0.8(0 − 0.8) on.
    let (x, top) = (0.9, 2.0);
    let scene = Scene::orthographic([x, 0.2, 0.0], [x, 0.2, 1.0], 1e-3)
        .whole("medium", air)
        .lamp(level_square([x, 0.2, top], 50.0, false), black(), 1.0, "front")
        .film(16, 16)
        .spp(64);
    let passes = |first: f64, cosine: f64, scale_height: f64| {
        let density = |height: f64| (-height / scale_height).exp();
        let column = scale_height / cosine * (density(first) - density(first + cosine * top));
        (-PER_M * column).exp()
    };
    let first = up[0] * (x - base[0]) - up[2] * base[2];
    Truth::new(
        "through-air-that-begins-elsewhere",
        &scene,
        passes(first, up[2], HEIGHT_M),
        "exp(−σ H (e^(−h₀/H) − e^(−h₁/H))/cos θ), h₀ = 0.6 · 0.5 − 0.8 · 0.8, h₁ = h₀ + 0.8 · 2, cos θ = 0.8",
    )
    .because(
        "The density is e^(−h/H) with the height h above the base, along up. Its integral along a ray is elementary.",
    )
    .confirmed("a sum over the way", 1e-8, move || {
        let n = 100_000;
        let step = top / f64::from(n);
        let height = |z: f64| up[0] * (x - base[0]) + up[1] * (0.2 - base[1]) + up[2] * (z - base[2]);
        let density = |k: u32| (-height(step * (f64::from(k) + 0.5)) / HEIGHT_M).exp();
        (-PER_M * step * (0..n).map(density).sum::<f64>()).exp()
    })
    .or_else("heights from the origin", passes(up[0] * x, up[2], HEIGHT_M))
    .or_else("heights along z", passes(-base[2], 1.0, HEIGHT_M))
    .or_else("heights along y", (-PER_M * top * (-(0.2 - base[1]) / HEIGHT_M).exp()).exp())
    .or_else("the base on the other side", passes(up[0] * (x + base[0]) + up[2] * base[2], up[2], HEIGHT_M))
    .sees(2e-3)
}

/// A lamp seen through the middle of a grid of two by two by four cells, times a factor.
fn smoke() -> Truth {
    const PER_M: f64 = 0.7;
    const SCALE: f64 = 2.5;
    // Along z; the same in all four columns.
    let layers = [0.2, 1.5, 0.6, 2.4_f32];
    let numbers: Vec<f32> = layers.iter().flat_map(|&layer| [layer; 4]).collect();
    let mut smoke = medium(0.0, PER_M, &isotropic());
    smoke["density"] = json!({ "type": "grid", "file": "layers.vol", "scale": SCALE });
    let box_m = [[-1.0, -1.0, 0.0], [1.0, 1.0, 1.2_f32]];
    // From the middle of the first layer to half way between those of the last two.
    let scene = Scene::orthographic([0.1, 0.2, 2.0], [0.1, 0.2, 0.0], 1e-3)
        .thing(json!({ "shape": block([-0.8, -0.8, 0.15], [0.8, 0.8, 0.9]), "material": boundary(&smoke) }))
        .lamp(level_square([0.0, 0.0, -0.5], 5.0, true), black(), 1.0, "front")
        .file("layers.vol", vol([2, 2, 4], box_m, &numbers))
        .film(16, 16)
        .spp(64);
    let [a, b, c, d] = layers.map(f64::from);
    let passes = |scale: f64, column: f64| (-PER_M * scale * column).exp();
    let column = 0.3 * (0.5 * a + b + 0.5 * c) + 0.15 * (0.75 * c + 0.25 * d);
    Truth::new(
        "through-layers-of-a-grid-times-a-factor",
        &scene,
        passes(SCALE, column),
        "exp(−0.7 · 2.5(0.3(a/2 + b + c/2) + 0.15(¾c + ¼d))) for the densities a to d of layers of 0.3 m",
    )
    .because("Between the middles of layers the density goes evenly from the one to the next: trapezoids are exact. The last ends half way.")
    .confirmed("a sum over the way", 1e-8, move || {
        let n = 75_000;
        let at = |k: u32| {
            let z = 2.5 * (f64::from(k) + 0.5) / f64::from(n);
            let (i, t) = (z.floor() as usize, z - z.floor());
            f64::from(layers[i]) * (1.0 - t) + f64::from(layers[i + 1]) * t
        };
        (-PER_M * SCALE * 0.75 * (0..n).map(at).sum::<f64>() / f64::from(n)).exp()
    })
    .or_else("the factor left out", passes(1.0, column))
    .or_else("cells of one density each", passes(SCALE, 0.15 * a + 0.3 * (b + c)))
    .or_else("the mean of all layers", passes(SCALE, 0.75 * 0.25 * (a + b + c + d)))
    .allows(1e-6, "numbers of the file in single precision")
    .sees(2e-3)
}

/// The sun in smoke whose albedo changes along x, seen from above beyond the box of its grid.
fn beyond(wrap: Wrap) -> Truth {
    const PER_M: f64 = 1.2;
    const ALBEDO: f64 = 0.9;
    let cells = [0.9, 0.1, 0.3, 1.0];
    let numbers = cells.map(|share| share as f32);
    let grid = json!({ "file": "along-x.vol", "wrap": wrap.name() });
    let smoke = with(json!({ "extinction_per_m": PER_M, "albedo": ALBEDO }), &json!({ "albedo_grid": grid }));
    // The box is from −1 to 1 m, and the picture from 1.1 to 2.1 m: from 1.05 to 1.55 of the box.
    let (left, right) = (1.1, 2.1);
    let middle = 0.5 * (left + right);
    let scene = Scene::orthographic([middle, 0.0, 2.0], [middle, 0.0, 0.0], right - left)
        .thing(json!({ "shape": block([-50.0, -50.0, 0.0], [50.0, 50.0, 1.0]), "material": boundary(&smoke) }))
        .directional_light([0.0, 0.0, -1.0], 1.0)
        .file("along-x.vol", vol([4, 1, 1], [[-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]], &numbers))
        .film(16, 16)
        .depth(2)
        .spp(128);
    let row = move |wrap: Wrap| Shown { wrap: [wrap, Wrap::Clamp], ..Shown::new(4, &cells) };
    let u = [left, right].map(|x| 0.5 * (x + 1.0));
    let seen = |share: f64| ALBEDO * share / (4.0 * PI) * 0.5 * -(-2.0 * PER_M).exp_m1();
    let of = |wrap: Wrap| seen(row(wrap).mean(u, [0.4, 0.6]));
    let other = if wrap == Wrap::Repeat { Wrap::Mirror } else { Wrap::Repeat };
    Truth::new(
        format!("sun-in-smoke-beside-the-box-of-its-albedos-by-{}", wrap.name()),
        &scene,
        of(wrap),
        "0.9 ϖ (1 − e^(−2σh))/8π, ϖ the mean of the endless row of cells from 1.05 to 1.55 of the box",
    )
    .because("A place of the albedo ϖ sends ϖ/4π of what the medium takes from a beam there into each direction, and in and out light passes e^(−2σt). The albedo does not depend on the depth.")
    .confirmed("linear between the middles at 100,000 places, and a sum over the depth", 1e-6, move || {
        let n = 100_000;
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let share = (0..n).map(|k| row(wrap).at(u[0] + (u[1] - u[0]) * at(k), 0.5)).sum::<f64>() / f64::from(n);
        let depth = (0..n).map(|k| PER_M * (-2.0 * PER_M * at(k)).exp()).sum::<f64>() / f64::from(n);
        ALBEDO * share / (4.0 * PI) * depth
    })
    .or_else("the other way to go on", of(other))
    .or_else("the nearest value beyond the box", of(Wrap::Clamp))
    .or_else("the same albedo everywhere", seen(1.0))
    .or_else("nothing beyond the box", 0.0)
    .allows(1e-5 * of(wrap), "numbers of the file in single precision")
    .claims(Claim::DepthLimit)
    .sees(5e-3)
}
