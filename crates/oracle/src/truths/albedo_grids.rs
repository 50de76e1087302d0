//! Media that absorb more at some places than at others, by a grid of albedos.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    media::{boundary, of_half_space, slab, vol},
    scene::{Scene, block},
};
use crate::quadrature::interval;
use crate::transfer::HalfSpace;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![beam(), turned(), lamp(), placed(), colour(), half_space()];
    list.extend(["repeat", "mirror"].map(beyond));
    list
}

/// Extinction, 1/m, and the albedo that the grid is a factor on.
const PER_M: f64 = 1.2;
const ALBEDO: f64 = 0.9;
/// Cells of a box of −1 to 1 across and 0 to 1 upward: their middles lie at ±½, and at ¼ and ¾.
const CELLS: [f32; 8] = [0.9, 0.2, 0.5, 1.0, 0.1, 0.7, 0.8, 0.3];
const BOX_M: [[f32; 3]; 2] = [[-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]];
/// Where the eye's ray goes straight down.
const AT: [f64; 2] = [0.2, -0.1];

/// A slab from 0 to 1 of what the grid says, from above.
fn scene(grid: Value) -> Scene {
    let mut smoke = json!({ "extinction_per_m": PER_M, "albedo": ALBEDO });
    smoke["albedo_grid"] = grid;
    let [x, y] = AT;
    Scene::orthographic([x, y, 2.0], [x, y, 0.0], 1e-4)
        .thing(json!({ "shape": block([-50.0, -50.0, 0.0], [50.0, 50.0, 1.0]), "material": boundary(&smoke) }))
        .depth(2)
        .spp(256)
}

/// The same of the eight cells, placed.
fn cells(mut grid: Value) -> Scene {
    grid["file"] = json!("shares.vol");
    scene(grid).file("shares.vol", vol([2, 2, 2], BOX_M, &CELLS))
}

/// The share at a height of the eye's ray: trilinear between the middles, and the same from the outermost ones on.
fn share(x: f64, y: f64, z: f64) -> f64 {
    let along = [x + 0.5, y + 0.5, 2.0 * z - 0.5].map(|share| share.clamp(0.0, 1.0));
    let weight =
        |cell: usize| (0..3).map(|k| if cell >> k & 1 == 1 { along[k] } else { 1.0 - along[k] }).product::<f64>();
    (0..8).map(|cell| weight(cell) * f64::from(CELLS[cell])).sum()
}

/// ∫ σϖ/4π e^(−2σt) dt from the top down: light comes in and goes out straight.
fn seen(share: impl Fn(f64) -> f64) -> f64 {
    let at = |z: f64| ALBEDO * share(z) * (-2.0 * PER_M * (1.0 - z)).exp();
    // Between the places where a share has a kink.
    let part = |k: u32| interval(at, f64::from(k) / 32.0, f64::from(k + 1) / 32.0, 1e-13).value;
    PER_M / (4.0 * PI) * (0..32).map(part).sum::<f64>()
}

/// The same where the share is `a` up to a height of ¼, `b` from ¾ on, and linear between: e^(−2σt) integrated by parts.
fn by_parts(a: f64, b: f64) -> f64 {
    let k = 2.0 * PER_M;
    let e = |z: f64| (-k * (1.0 - z)).exp();
    let whole = b * e(1.0) - a * e(0.0) - 2.0 * (b - a) * (e(0.75) - e(0.25)) / k;
    ALBEDO * PER_M / (4.0 * PI) * whole / k
}

const BECAUSE: &str =
    "A place of the albedo ϖ sends ϖ/4π of what the medium takes from a beam there into each direction.";

fn beam() -> Truth {
    let [x, y] = AT;
    let [a, b] = [0.25, 0.75].map(|z| share(x, y, z));
    let value = by_parts(a, b);
    let lit = cells(json!({})).directional_light([0.0, 0.0, -1.0], 1.0);
    Truth::new(
        "beam-in-smoke-of-a-grid-of-albedos",
        &lit,
        value,
        "∫ σϖ/4π e^(−2σt) dt, ϖ trilinear between eight cells",
    )
    .because(BECAUSE)
    .confirmed("quadrature along the ray", 1e-9, move || seen(|z| share(x, y, z)))
    .or_else("the same albedo everywhere", by_parts(1.0, 1.0))
    .or_else("the mean of the cells", by_parts(0.5625, 0.5625))
    .or_else("cells of one albedo each", seen(|z| f64::from(CELLS[if z < 0.5 { 1 } else { 5 }])))
    .or_else("upside down", by_parts(b, a))
    .or_else("the albedo applied twice", seen(|z| ALBEDO * share(x, y, z).powi(2)))
    .sees(5e-3)
    .allows(1e-5 * value, "the picture is 0.1 mm wide; single precision 2e-5")
}

/// The grid turned by half a turn about an upright axis, and a third as high: above it lies what its top has.
fn turned() -> Truth {
    let [x, y] = AT;
    let grid = json!({ "transform": [
        { "rotate": { "axis": [0, 0, 1], "angle_deg": 180 } }, { "scale": [1, 1, 0.5] }
    ] });
    let placed = move |z: f64| share(-x, -y, 2.0 * z);
    let lit = cells(grid).directional_light([0.0, 0.0, -1.0], 1.0);
    let value = seen(placed);
    Truth::new("beam-in-smoke-of-a-turned-grid", &lit, value, "∫ σϖ/4π e^(−2σt) dt, the grid turned, and half as high")
        .because(BECAUSE)
        .confirmed("midpoints along the ray", 1e-8, move || seen_by_midpoints(placed))
        .or_else("not turned", seen(|z| share(x, y, 2.0 * z)))
        .or_else("as high as before", seen(|z| share(-x, -y, z)))
        .or_else("nothing above the grid", seen(|z| if z < 0.5 { placed(z) } else { 0.0 }))
        .sees(5e-3)
        .allows(1e-5 * value, "the picture is 0.1 mm wide; single precision 2e-5")
}

/// By midpoints.
fn seen_by_midpoints(share: impl Fn(f64) -> f64) -> f64 {
    let n = 400_000;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    let of = |z: f64| ALBEDO * share(z) * (-2.0 * PER_M * (1.0 - z)).exp();
    PER_M / (4.0 * PI) * (0..n).map(|i| of(at(i))).sum::<f64>() / f64::from(n)
}

/// A grid that is smaller than the smoke.
fn beyond(wrap: &'static str) -> Truth {
    let (across, upward) = (0.3, 0.25);
    let grid = json!({ "wrap": wrap, "transform": [{ "scale": [across, across, upward] }] });
    // Of two cells along each edge: how much of the second there is, if the box is there again and again, from its least corner in units of it.
    let second = move |t: f64| {
        let (turns, within) = (t.floor(), t - t.floor());
        let mirrored = wrap == "mirror" && turns.rem_euclid(2.0) == 1.0;
        let x = 2.0 * if mirrored { 1.0 - within } else { within } - 0.5;
        match wrap {
            "repeat" if x < 0.0 => -x,
            "repeat" if x > 1.0 => 2.0 - x,
            _ => x.clamp(0.0, 1.0),
        }
    };
    let again = move |z: f64| {
        let [x, y] = AT.map(|at| second(0.5 * (at / across + 1.0)));
        // The middles lie at ±½ and at ¼ and ¾.
        share(x - 0.5, y - 0.5, 0.25 + 0.5 * second(z / upward))
    };
    let lit = cells(grid).directional_light([0.0, 0.0, -1.0], 1.0);
    let value = seen(again);
    let [x, y] = AT.map(|at| at / across);
    Truth::new(
        format!("beam-in-smoke-of-a-grid-beyond-its-box-by-{wrap}"),
        &lit,
        value,
        "∫ σϖ/4π e^(−2σt) dt, ϖ from box to box",
    )
    .because(BECAUSE)
    .confirmed("midpoints along the ray", 1e-8, move || seen_by_midpoints(again))
    .or_else("the nearest value beyond the box", seen(|z| share(x, y, z / upward)))
    .or_else("nothing beyond the box", seen(|z| if z < upward { again(z) } else { 0.0 }))
    .sees(5e-3)
    .allows(1e-5 * value, "the picture is 0.1 mm wide; single precision 2e-5")
}

/// A point lamp beside the ray: places are chosen by where it shines.
fn lamp() -> Truth {
    let ([x, y], h, height) = (AT, 0.3, 0.6);
    // By the angle at the lamp, z = height + h tan θ: E dz is dθ/h.
    let of = move |angle: f64, share: &dyn Fn(f64) -> f64| {
        let z = height + h * angle.tan();
        share(z) * (-PER_M * (1.0 - z + h / angle.cos())).exp()
    };
    let seen = move |share: &dyn Fn(f64) -> f64| {
        let angle = |z: f64| ((z - height) / h).atan();
        let part = |from: f64, to: f64| interval(|a| of(a, share), angle(from), angle(to), 1e-12).value;
        ALBEDO * PER_M / (4.0 * PI * h) * (part(0.0, 0.25) + part(0.25, 0.75) + part(0.75, 1.0))
    };
    let value = seen(&|z| share(x, y, z));
    let lit = cells(json!({})).point_light([x + h, y, height], 1.0);
    Truth::new("lamp-in-smoke-of-a-grid-of-albedos", &lit, value, "∫ σϖ/4π I/d² e^(−σ(s + d)) ds")
        .because(BECAUSE)
        .confirmed("midpoints along the ray", 1e-7, move || {
            let n = 400_000;
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
            let of = |z: f64| {
                let d2 = h * h + (z - height).powi(2);
                share(x, y, z) / d2 * (-PER_M * (1.0 - z + d2.sqrt())).exp()
            };
            ALBEDO * PER_M / (4.0 * PI) * (0..n).map(|i| of(at(i))).sum::<f64>() / f64::from(n)
        })
        .or_else("the same albedo everywhere", seen(&|_| 1.0))
        .or_else("the mean of the cells", seen(&|_| 0.5625))
        .or_else("upside down", seen(&|z| share(x, y, 1.0 - z)))
        .sees(5e-3)
        .allows(1e-5 * value, "the picture is 0.1 mm wide; single precision 2e-5")
}

/// The same lamp in smoke that an instance turns by half a turn about an upright axis, and makes half as high.
fn placed() -> Truth {
    let ([x, y], h, height) = (AT, 0.3, 0.6);
    let of = move |z: f64, share: f64| {
        let d2 = h * h + (z - height).powi(2);
        ALBEDO * PER_M / (4.0 * PI) * share / d2 * (-PER_M * (1.0 - z + d2.sqrt())).exp()
    };
    let seen = move |share: &dyn Fn(f64) -> f64| {
        let part = |k: u32| interval(|z| of(z, share(z)), f64::from(k) / 32.0, f64::from(k + 1) / 32.0, 1e-12).value;
        (0..32).map(part).sum::<f64>()
    };
    let placed = move |z: f64| share(-x, -y, 2.0 * z);
    let value = seen(&placed);
    let mut smoke = json!({ "extinction_per_m": PER_M, "albedo": ALBEDO });
    smoke["albedo_grid"] = json!({ "file": "shares.vol" });
    let body = json!({ "shape": block([-50.0, -50.0, 0.0], [50.0, 50.0, 2.0]), "material": boundary(&smoke) });
    let place = json!([{ "rotate": { "axis": [0, 0, 1], "angle_deg": 180 } }, { "scale": [1, 1, 0.5] }]);
    let lit = Scene::orthographic([x, y, 2.0], [x, y, 0.0], 1e-4)
        .whole("groups", json!({ "smoke": { "objects": [body] } }))
        .whole("instances", json!([{ "group": "smoke", "transform": place }]))
        .file("shares.vol", vol([2, 2, 2], BOX_M, &CELLS))
        .point_light([x + h, y, height], 1.0)
        .depth(2)
        .spp(256);
    Truth::new(
        "lamp-in-smoke-of-a-placed-grid-of-albedos",
        &lit,
        value,
        "∫ σϖ/4π I/d² e^(−σ(s + d)) ds, the grid placed",
    )
    .because(BECAUSE)
    .confirmed("midpoints along the ray", 1e-7, move || {
        let n = 400_000;
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n).map(|i| of(at(i), placed(at(i)))).sum::<f64>() / f64::from(n)
    })
    .or_else("in the coordinates of the world", seen(&|z| share(x, y, z)))
    .or_else("not turned", seen(&|z| share(x, y, 2.0 * z)))
    .or_else("as high as before", seen(&|z| share(-x, -y, z)))
    .sees(5e-3)
    .allows(1e-5 * value, "the picture is 0.1 mm wide; single precision 2e-5")
}

/// A grid of one colour in daylight shows the luminance of that colour.
fn colour() -> Truth {
    let rgb = [0.8, 0.4, 0.1_f32];
    let [r, g, b] = rgb.map(f64::from);
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let mut file = vol([1, 1, 1], BOX_M, &rgb);
    file[20..24].copy_from_slice(&3_u32.to_le_bytes());
    let light = json!({
        "type": "directional", "direction": [0, 0, -1], "irradiance": { "type": "illuminant", "name": "D65" }
    });
    let lit = scene(json!({ "file": "colour.vol" })).file("colour.vol", file).light(light);
    let value = by_parts(luminance, luminance);
    Truth::new(
        "beam-in-smoke-of-a-coloured-grid",
        &lit,
        value,
        "Yσϖ/4π (1 − e^(−2σ))/2σ, Y of (0.8, 0.4, 0.1) under D65",
    )
    .because(BECAUSE)
    .confirmed("quadrature along the ray", 1e-9, move || seen(|_| luminance))
    .or_else("blue for red", by_parts(luminance + 0.1404 * (b - r), luminance + 0.1404 * (b - r)))
    .or_else("the mean of the channels", by_parts((r + g + b) / 3.0, (r + g + b) / 3.0))
    .or_else("the first channel", by_parts(r, r))
    .claims(Claim::PhotometricSensor)
    .allows(3e-4 * value, "the luminance of the spectrum that stands for a colour, 3e-4; single precision 2e-5")
    .sees(5e-3)
}

/// Scattered many times, where the grid is the same everywhere.
fn half_space() -> Truth {
    let file = vol([1, 1, 1], BOX_M, &[(ALBEDO / 0.95) as f32]);
    let smoke = json!({ "extinction_per_m": 1, "albedo": 0.95, "albedo_grid": { "file": "even.vol" } });
    let scene = slab(200.0, &smoke, 1.0).file("even.vol", file).sky(1.0);
    let value = HalfSpace::new(ALBEDO).plane_albedo(1.0);
    of_half_space("half-space-of-a-grid-of-albedos", &scene, ALBEDO, 1.0, value)
        .or_else("without the grid", HalfSpace::new(0.95).plane_albedo(1.0))
        .or_else("the grid alone", HalfSpace::new(ALBEDO / 0.95).plane_albedo(1.0))
}
