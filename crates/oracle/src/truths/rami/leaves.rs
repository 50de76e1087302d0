//! The purist corner: leaves and ground absorb nothing, so all light comes back.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::super::meters::measured;
use super::super::scene::{Scene, disk, lambert, level_square};
use super::{HEIGHT_M, LEAF_AREA_INDEX, SUNS_DEG, SuiteCase, Truth, case};
use crate::random::Uniform;
use crate::vector::Vec3;

/// The side of the square that repeats, the radius of a leaf, and how many squares there are along each axis.
const CELL_M: f64 = 2.5;
const LEAF_M: f64 = 0.1;
const CELLS: u32 = 33;

pub(super) fn cases() -> Vec<SuiteCase> {
    const EVERYWHERE: &str = "Purist, leaves everywhere";
    const IN_BALLS: &str = "Purist, leaves in balls";
    let mut list = Vec::new();
    for (section, title, in_balls) in [("homogeneous", EVERYWHERE, false), ("heterogeneous", IN_BALLS, true)] {
        for (reflectance, transmittance, suns_deg) in [(0.5, 0.5, &SUNS_DEG[..]), (0.0, 1.0, &SUNS_DEG[..1])] {
            for &sun_deg in suns_deg {
                let point = format!("sun at {sun_deg}°, ρ = {reflectance}, τ = {transmittance}");
                let name = format!("rami-{section}-{sun_deg}-{reflectance}-{transmittance}");
                let scene = scene(in_balls, reflectance, transmittance, sun_deg);
                let truth = Truth::new(name, &scene, CELL_M * CELL_M, "albedo 1: the flux up through the area of a cell is that down")
                    .because(
                        "Of a canopy that repeats without end, what enters a cell at its sides is what leaves the next one. So the flux up \
                         through the top of a cell is what came down, less what is absorbed: nothing.",
                    )
                    .or_else("leaves that pass nothing", reflectance * CELL_M * CELL_M)
                    .or_else("a ground that absorbs a tenth of the light", 0.95 * CELL_M * CELL_M);
                list.push(case(section, title, point, truth));
            }
        }
    }
    list
}

/// The canopy on white ground under parallel light of the irradiance 1 on the level, and a meter that looks down on the cell in the middle.
fn scene(in_balls: bool, reflectance: f64, transmittance: f64, sun_deg: f64) -> Scene {
    let leaf = json!({ "type": "translucent", "reflectance": reflectance, "transmittance": transmittance });
    let middle = 0.5 * f64::from(CELLS - 1);
    let steps = |axis: usize| -> Vec<Value> {
        let step = |i: u32| {
            let mut by = [0.0; 3];
            by[axis] = CELL_M * (f64::from(i) - middle);
            json!([{ "translate_m": by }])
        };
        (0..CELLS).map(step).collect()
    };
    let (sine, cosine) = sun_deg.to_radians().sin_cos();
    let meter = json!({
        "type": "flux", "origin_m": [0, 0, HEIGHT_M + 0.2], "u_m": [0, CELL_M, 0], "v_m": [CELL_M, 0, 0]
    });
    measured(&[meter])
        .object(level_square([0.0; 3], 1000.0, true), lambert(1.0))
        .set("materials", "leaf", leaf)
        .set("groups", "cell", json!({ "objects": leaves(in_balls) }))
        .set("groups", "row", json!({ "instances": [{ "group": "cell", "transforms": steps(0) }] }))
        .whole("instances", json!([{ "group": "row", "transforms": steps(1) }]))
        .directional_light([sine, 0.0, -cosine], 1.0 / cosine)
}

/// The leaves of a cell: everywhere in it, or in a ball in its middle.
fn leaves(in_balls: bool) -> Vec<Value> {
    let count = (LEAF_AREA_INDEX * CELL_M * CELL_M / (PI * LEAF_M * LEAF_M)).round() as usize;
    let mut random = Uniform::new(if in_balls { 2 } else { 1 });
    let radius = 0.5 * HEIGHT_M - LEAF_M;
    let mut place = || -> Vec3 {
        if !in_balls {
            return [
                random.between(0.0, CELL_M),
                random.between(0.0, CELL_M),
                random.between(LEAF_M, HEIGHT_M - LEAF_M),
            ];
        }
        let (direction, r) = (random.direction(), radius * random.number().cbrt());
        let centre = [0.5 * CELL_M, 0.5 * CELL_M, 0.5 * HEIGHT_M];
        [0, 1, 2].map(|k| centre[k] + r * direction[k])
    };
    let places: Vec<Vec3> = (0..count).map(|_| place()).collect();
    places.into_iter().map(|at| json!({ "shape": disk(at, random.direction(), LEAF_M), "material": "leaf" })).collect()
}
