//! Pixels that share paths on either side of a wall: light that one side finds never reaches the other.

use std::f64::consts::PI;

use serde_json::json;

use super::scene::{Scene, black, block, lambert, level_square};
use super::{Truth, lambert_polygon};
use crate::quadrature::{interval, rectangle};

const ALBEDO: f64 = 0.8;
/// Half width of the wall, and its height.
const WALL_M: [f64; 2] = [0.5, 0.1];
/// Side of the picture, of 12 × 12 pixels: the wall stands in the middle of a block of 4 × 4.
const VIEW_M: f64 = 0.12;
/// Of the wall about z, along no axis.
const TURN_DEG: f64 = 20.0;

/// A white floor, open to the sky before the wall of a black box and covered by the box behind it. The camera is within the box and sees the
/// floor on both sides.
fn scene() -> Scene {
    let [width, height] = WALL_M;
    let (sin, cos) = TURN_DEG.to_radians().sin_cos();
    Scene::orthographic([0.0, 0.0, 0.05], [0.0; 3], VIEW_M)
        .up([-sin, cos, 0.0])
        .film(12, 12)
        .spp(4096)
        .object(level_square([0.0; 3], 5.0, true), lambert(ALBEDO))
        .thing(json!({
            "shape": block([-1.0, -width, -height], [0.0, width, height]), "material": black(),
            "transform": [{ "rotate": { "axis": [0, 0, 1], "angle_deg": TURN_DEG } }],
        }))
        .sky(1.0)
        .set("integrator", "path_reuse", json!("4x4"))
}

/// The share of the sky's light that the wall takes, in the mean over the two columns before it; `at` has it for a place so far before the wall
/// and beside its middle.
fn hidden(at: impl Fn(f64, f64) -> f64) -> f64 {
    let (depth, half) = (VIEW_M / 6.0, 0.5 * VIEW_M);
    rectangle(at, [0.0, depth], [-half, half], 1e-12, 100_000).value / (depth * VIEW_M)
}

fn by_lambert(x: f64, y: f64) -> f64 {
    let [width, height] = WALL_M;
    let corner = |side: f64, z: f64| [-x, side * width - y, z];
    let corners = [corner(-1.0, 0.0), corner(1.0, 0.0), corner(1.0, height), corner(-1.0, height)];
    lambert_polygon(&corners, [0.0, 0.0, 1.0]) / PI
}

/// The same from the height to which the wall rises in each azimuth.
fn by_azimuth(x: f64, y: f64) -> f64 {
    let [width, height] = WALL_M;
    let rises = |azimuth: f64| {
        let up = height * azimuth.cos();
        up * up / (up * up + x * x)
    };
    interval(rises, ((-width - y) / x).atan(), ((width - y) / x).atan(), 1e-10).value / (2.0 * PI)
}

pub(super) fn truths() -> Vec<Truth> {
    const BECAUSE: &str = "What a pixel finds from its place on the floor serves others that see it, too. Through a black wall nobody sees it.";
    let lit = ALBEDO * (1.0 - hidden(by_lambert));
    vec![
        Truth::new("shared-paths-on-the-dark-side-of-a-wall", &scene(), 0.0, "0")
            .because(BECAUSE)
            .or_else("light that the other half of the block finds, shared with all of it", 0.5 * lit)
            .reads_pixels([4, 6, 0, 12]),
        Truth::new(
            "shared-paths-on-the-lit-side-of-a-wall",
            &scene(),
            lit,
            "ρ(1 − F), F of the wall by Lambert's formula, in the mean over two columns",
        )
        .because(BECAUSE)
        .confirmed("the height of the wall, azimuth by azimuth", 1e-7, || ALBEDO * (1.0 - hidden(by_azimuth)))
        .or_else("the light shared with the half of the block behind the wall", 0.5 * lit)
        .or_else("no wall", ALBEDO)
        .reads_pixels([6, 8, 0, 12])
        .sees(5e-3),
    ]
}
