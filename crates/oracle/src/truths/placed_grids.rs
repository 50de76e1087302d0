//! Media that are thicker at some places than at others, in bodies that move and are placed by instances.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    media::{boundary, isotropic, medium, vol},
    scene::{Scene, block, sphere},
};
use crate::quadrature::interval;
use crate::vector::{Vec3, add, length, scale, sub};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![crossing(), turning(), rising()];
    list.extend([false, true].map(two_instances));
    list
}

/// Dark gas of a density, 1/m where that is 1.
fn gas(per_m: f64, density: Value) -> Value {
    let mut filled = medium(0.0, per_m, &isotropic());
    filled["density"] = density;
    filled
}

fn keys(times: &[f64], transforms: &[Value]) -> Vec<Value> {
    let key = |(time_s, transform)| json!({ "time_s": time_s, "transform": transform });
    times.iter().zip(transforms).map(key).collect()
}

const STILL: &str = "the density stays where it is as the body moves";

/// Four cells in a row that pass before the eye.
fn crossing() -> Truth {
    const PER_M: f64 = 0.8;
    let cells = [0.2, 1.5, 0.4, 1.1_f32];
    // A body of four cells, each 1 m wide: the middles lie at ±½ and ±1½.
    let passes = |density: f64| (-2.0 * PER_M * density).exp();
    let density = move |x: f64| {
        let at = (x + 1.5).clamp(0.0, 3.0);
        let first = at.floor().min(2.0);
        let [a, b] = [cells[first as usize], cells[first as usize + 1]].map(f64::from);
        a + (b - a) * (at - first)
    };
    // The eye sees them from one outermost middle to the other, at an even speed.
    let between = |a: f32, b: f32| {
        let [a, b] = [a, b].map(f64::from);
        (passes(a) - passes(b)) / (2.0 * PER_M * (b - a))
    };
    let value = cells.windows(2).map(|pair| between(pair[0], pair[1])).sum::<f64>() / 3.0;
    let moved = [1.5, -1.5].map(|x| json!([{ "translate_m": [x + 0.3, 0, 0] }]));
    let smoke = gas(PER_M, json!({ "type": "grid", "file": "row.vol" }));
    let body = json!({ "shape": block([-2.0, -1.0, -1.0], [2.0, 1.0, 1.0]), "material": boundary(&smoke) });
    let scene = Scene::orthographic([0.3, 0.0, 4.0], [0.3, 0.0, 0.0], 1e-6)
        .sky(1.0)
        .shutter([0.0, 1.0])
        .moving(&[body], &keys(&[0.0, 1.0], &moved))
        .file("row.vol", vol([4, 1, 1], [[-2.0, -1.0, -1.0], [2.0, 1.0, 1.0]], &cells));
    let mean = interval(density, -1.5, 1.5, 1e-10).value / 3.0;
    Truth::new(
        "grid-that-crosses-the-ray",
        &scene,
        value,
        "⅓ Σ (e^(−2σa) − e^(−2σb))/2σ(b − a) over neighbouring cells a, b",
    )
    .because("The cells of a body pass with it. Between two middles the density on the ray goes evenly with time.")
    .confirmed("midpoints of the time", 1e-7, move || {
        let n = 30_000;
        (0..n).map(|i| passes(density(-1.5 + 3.0 * (f64::from(i) + 0.5) / f64::from(n)))).sum::<f64>() / f64::from(n)
    })
    .or_else(STILL, passes(density(0.3)))
    .or_else("as the shutter opens", passes(density(-1.5)))
    .or_else("in the middle of the time", passes(density(0.0)))
    .or_else("the mean density", passes(mean))
    .sees(5e-3)
    .claims(Claim::Scattering)
    .claims(Claim::WholeFormat)
    .claims(Claim::Motion)
}

/// A ball of two cells that makes half a turn about its middle while it is seen.
fn turning() -> Truth {
    const PER_M: f64 = 1.4;
    let cells = [0.1, 1.7_f32];
    let [low, high] = cells.map(f64::from);
    // The eye looks along −z at the height h. At the angle α the density is m + d (z cos α + h sin α): what is odd in z falls out of the column.
    let h = 0.7_f64;
    let (mean, slope, chord) = (0.5 * (low + high), 0.5 * (high - low), 2.0 * (1.0 - h * h).sqrt());
    let passes = move |angle: f64| (-PER_M * chord * (mean + slope * h * angle.sin())).exp();
    // I₀(b) = Σ (b/2)²ᵏ/k!².
    let b = PER_M * chord * slope * h;
    let (mut term, mut i0) = (1.0, 1.0);
    for k in 1..30 {
        term *= (0.5 * b / f64::from(k)).powi(2);
        i0 += term;
    }
    let value = passes(0.0) * i0;
    let turned = [-90.0, 0.0, 90.0].map(|degrees| json!([{ "rotate": { "axis": [1, 0, 0], "angle_deg": degrees } }]));
    // The middles of the cells lie where the ball ends.
    let smoke = gas(PER_M, json!({ "type": "grid", "file": "two.vol" }));
    let body = json!({ "shape": sphere([0.0; 3], 1.0), "material": boundary(&smoke) });
    let scene = Scene::orthographic([0.0, h, 4.0], [0.0, h, 0.0], 1e-6)
        .sky(1.0)
        .shutter([0.0, 1.0])
        .moving(&[body], &keys(&[0.0, 0.5, 1.0], &turned))
        .file("two.vol", vol([1, 1, 2], [[-2.0; 3], [2.0; 3]], &cells));
    Truth::new("grid-that-turns", &scene, value, "e^(−am) I₀(adh), a = 2σ√(1 − h²), σ = 1.4, h = 0.7, m = 0.9, d = 0.8")
        .because("A ball of gas that is thicker to one side makes half a turn. Its chord has the mean density m + dh sin α; that of e^(−b sin α) is I₀(b).")
        .confirmed("midpoints of the angle", 1e-8, move || {
            let n = 20_000;
            (0..n).map(|i| passes(PI * ((f64::from(i) + 0.5) / f64::from(n) - 0.5))).sum::<f64>() / f64::from(n)
        })
        .or_else(STILL, passes(0.0))
        .or_else("as the shutter opens", passes(-0.5 * PI))
        .or_else("as the shutter closes", passes(0.5 * PI))
        .sees(5e-3)
        .claims(Claim::Scattering)
        .claims(Claim::WholeFormat)
        .claims(Claim::Motion)
}

/// A body of gas that thins with its height, as it rises.
fn rising() -> Truth {
    let (per_m, height, rises) = (1.6_f64, 0.8, 2.0_f64);
    // The eye looks level through 1 m of it, at its foot when the shutter opens.
    let passes = move |up: f64| (-per_m * (-up / height).exp()).exp();
    let value = interval(|x| passes(-rises * x), 0.0, 1.0, 1e-12).value;
    let moved = [0.0, rises].map(|y| json!([{ "translate_m": [0, y, 0] }]));
    let air = gas(per_m, json!({ "type": "exponential", "scale_height_m": height }));
    let body = json!({ "shape": block([-1.0, -3.0, -0.5], [1.0, 1.0, 0.5]), "material": boundary(&air) });
    let scene = Scene::orthographic([0.0, 0.0, 4.0], [0.0; 3], 1e-6)
        .sky(1.0)
        .shutter([0.0, 1.0])
        .moving(&[body], &keys(&[0.0, 1.0], &moved));
    Truth::new("thinning-gas-that-rises", &scene, value, "(E₁(σ) − E₁(σ e^(v/H))) H/v, σ = 1.6, v = 2 m, H = 0.8 m")
        .because("Heights count from the foot of the body, which rises by v: at its end the ray goes v below it.")
        .confirmed("the series of E₁", 1e-8, move || {
            // E₁(x) = −γ − ln x − Σ (−x)ᵏ/k k!; γ falls out.
            let e1 = |x: f64| {
                let (mut term, mut sum) = (1.0, 0.0);
                for k in 1..200 {
                    term *= -x / f64::from(k);
                    sum -= term / f64::from(k);
                }
                sum - x.ln()
            };
            height / rises * (e1(per_m) - e1(per_m * (rises / height).exp()))
        })
        .or_else(STILL, passes(0.0))
        .or_else("as the shutter closes", passes(-rises))
        .or_else("down for up", interval(|x| passes(rises * x), 0.0, 1.0, 1e-12).value)
        .sees(5e-3)
        .claims(Claim::Scattering)
        .claims(Claim::WholeFormat)
        .claims(Claim::Motion)
}

/// One group in two places along the ray, once in a group of its own: turned, drawn out and mirrored.
fn two_instances(by_priority: bool) -> Truth {
    const PER_M: f64 = 0.9;
    let values = [0.2, 1.4, 0.7, 0.1, 0.9, 0.3, 2.0, 0.6_f32];
    // Trilinear between the middles of eight cells, at ±1.
    let density = move |at: Vec3| -> f64 {
        let weight = |corner: usize| -> f64 {
            (0..3).map(|k| 0.5 * if corner >> k & 1 == 1 { 1.0 + at[k] } else { 1.0 - at[k] }).product()
        };
        (0..8).map(|corner| weight(corner) * f64::from(values[corner])).sum()
    };
    // The ray goes down along z at the place (x, y). The first instance is a quarter turn about z and half as high, at a height of 2. The second
    // is mirrored in x, and its z runs along −y.
    let (x, y) = (0.3, -0.2);
    let first = move |z: f64| [y, -x, 2.0 * (z - 2.0)];
    let second = move |z: f64| [-x, z, -y];
    // A polynomial of the third degree along each, for which Gauss's rule of two points is exact.
    let column = move |local: &dyn Fn(f64) -> Vec3, [from, to]: [f64; 2]| {
        let (middle, apart) = (0.5 * (from + to), 0.5 * (to - from) / 3.0_f64.sqrt());
        0.5 * (to - from) * (density(local(middle - apart)) + density(local(middle + apart)))
    };
    let columns = [column(&first, [1.5, 2.5]), column(&second, [-1.0, 1.0])];
    let passes = |column: f64| (-PER_M * column).exp();
    let value = passes(columns[0] + columns[1]);
    let smoke = gas(PER_M, json!({ "type": "grid", "file": "eight.vol" }));
    let mut material = boundary(&smoke);
    if by_priority {
        material["priority"] = json!(1);
    }
    let body = json!({ "shape": block([-1.0; 3], [1.0; 3]), "material": material });
    let quarter = json!({ "rotate": { "axis": [0, 0, 1], "angle_deg": 90 } });
    let mirrored = json!({ "matrix": [[-1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0]] });
    let scene = Scene::orthographic([x, y, 5.0], [x, y, 0.0], 1e-4)
        .sky(1.0)
        .whole(
            "groups",
            json!({
                "smoke": { "objects": [body] },
                "flat": { "instances": [{ "group": "smoke", "transform": [{ "scale": [1, 1, 0.5] }] }] },
            }),
        )
        .whole(
            "instances",
            json!([
                { "group": "flat", "transform": [quarter, { "translate_m": [0, 0, 2] }] },
                { "group": "smoke", "transform": [mirrored] },
            ]),
        )
        .file("eight.vol", vol([2, 2, 2], [[-2.0; 3], [2.0; 3]], &values));
    let sum = move |local: &dyn Fn(f64) -> Vec3, enters: f64, leaves: f64| {
        // In steps from one end to the other, each as long as it is in the world.
        let (from, to) = (local(enters), local(leaves));
        let n = 100_000;
        let at = |i: u32| add(from, scale((f64::from(i) + 0.5) / f64::from(n), sub(to, from)));
        (0..n).map(|i| density(at(i))).sum::<f64>() / f64::from(n) * (leaves - enters)
    };
    let in_group = length(sub(first(2.5), first(1.5)));
    let (name, what) = match by_priority {
        false => ("grid-in-two-instances", "exp(−σ ∫ρ ds), ρ trilinear in the coordinates of two instances"),
        true => ("grid-in-two-instances-by-priority", "the same, of bodies with priorities"),
    };
    Truth::new(name, &scene, value, what)
        .because("The cells of a body are where an instance puts it: turned, mirrored and drawn out. A mean free path is a length of the world.")
        .confirmed("a sum over the way", 1e-8, move || passes(sum(&first, 1.5, 2.5) + sum(&second, -1.0, 1.0)))
        .or_else("lengths of the group", passes(columns[0] * in_group + columns[1]))
        .or_else("in the coordinates of the world", passes(column(&|z| [x, y, z], [-1.0, 1.0]) + column(&|z| [x, y, z], [1.5, 2.0])))
        .or_else("both as the first", passes(columns[0] + column(&|z| [y, -x, z], [-1.0, 1.0])))
        .or_else("not mirrored", passes(columns[0] + column(&|z| [x, z, -y], [-1.0, 1.0])))
        .allows(1e-8, "the picture is 0.1 mm wide: the squares of what the density changes over it")
        .sees(5e-3)
        .claims(Claim::Scattering)
        .claims(Claim::WholeFormat)
}
