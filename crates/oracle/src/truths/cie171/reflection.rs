//! 5.6 to 5.8: light from diffuse surfaces.

use serde_json::json;

use super::super::scene::{lambert, parallelogram};
use super::{DOWN, LUX, SuiteCase, at, case, corners, measured, screen};
use crate::quadrature::rectangle;
use crate::truths::{Truth, lambert_polygon};
use crate::vector::{Vec3, dot};

pub(super) fn cases() -> Vec<SuiteCase> {
    let mut list = factors();
    list.extend(obstructed());
    list.extend(rooms());
    list
}

/// Reflectance of the surface that is lit, and the illuminance of the parallel light from above, lx.
const REFLECTANCE: f64 = 0.8;
const LIT_LX: f64 = 1000.0;

/// Illuminance at a point from a level rectangle that is lit from above, in units of the sensor.
fn reflected(origin: Vec3, [a, b]: [f64; 2], point: Vec3, normal: Vec3) -> f64 {
    let polygon = lambert_polygon(&corners(origin, [a, 0.0, 0.0], [0.0, b, 0.0], point), normal);
    REFLECTANCE * LIT_LX / LUX / std::f64::consts::PI * polygon
}

/// The same by quadrature over the rectangle.
fn by_area(origin: Vec3, [a, b]: [f64; 2], point: Vec3, normal: Vec3) -> f64 {
    let over = |x: f64, y: f64| {
        let way = [origin[0] + x - point[0], origin[1] + y - point[1], origin[2] - point[2]];
        let d2 = dot(way, way);
        dot(way, normal).max(0.0) * -way[2] / (d2 * d2)
    };
    let integral = rectangle(over, [0.0, a], [0.0, b], 1e-10, 2_000_000).value;
    REFLECTANCE * LIT_LX / LUX / std::f64::consts::PI * integral
}

fn lit(scene: super::Scene, origin: Vec3, [a, b]: [f64; 2]) -> super::Scene {
    scene
        .object(parallelogram(origin, [a, 0.0, 0.0], [0.0, b, 0.0]), lambert(REFLECTANCE))
        .light(json!({ "type": "directional", "direction": DOWN, "illuminance_lx": LIT_LX }))
}

/// 5.6: a level surface lights a wall beside it and a ceiling above it. Neither sees the parallel light.
fn factors() -> Vec<SuiteCase> {
    let wall: Vec3 = [1.0, 0.0, 0.0];
    let mut list = Vec::new();
    for (name, origin, sides) in [
        ("0.5 × 0.5 m", [1.75, -0.25, 0.0], [0.5, 0.5]),
        ("4 × 4 m", [0.0, -2.0, 0.0], [4.0, 4.0]),
        ("5 × 4 m", [0.0, -2.0, 0.0], [5.0, 4.0]),
    ] {
        let walls = [0.5, 1.5, 3.0].map(|z| ([0.0, 0.0, z], wall, format!("wall, z = {z} m")));
        let ceiling = [0.5, 2.0, 3.5].map(|x| ([x, 0.0, 4.0], DOWN, format!("ceiling at 4 m, x = {x} m")));
        for (point, normal, place) in walls.into_iter().chain(ceiling) {
            let value = reflected(origin, sides, point, normal);
            // A small surface is found by few paths.
            let scene =
                lit(measured(&[at(point, normal)]), origin, sides).spp(if sides[0] < 1.0 { 1 << 20 } else { 1 << 18 });
            let truth = Truth::new(
                format!("cie171-5.6-{}-{}-{}", sides[0] * sides[1], point[0], point[2]),
                &scene,
                value,
                "ρ E F by Lambert's formula",
            )
            .because("A diffuse surface that is lit evenly has the luminance ρE/π, and gives πF times that.")
            .confirmed("quadrature over the surface", 1e-6, move || by_area(origin, sides, point, normal));
            list.push(case("5.6", format!("{name}, {place}"), "lx", LUX, truth));
        }
    }
    list
}

/// 5.7: the same with a black screen that stands on the surface, along the light: it hides a strip from the wall.
fn obstructed() -> Vec<SuiteCase> {
    const SCREEN_X: f64 = 1.5;
    const SCREEN_M: f64 = 0.6;
    let (origin, sides): (Vec3, [f64; 2]) = ([0.5, -2.0, 0.0], [4.0, 4.0]);
    let normal: Vec3 = [1.0, 0.0, 0.0];
    [1.0, 1.5, 2.0, 3.0]
        .into_iter()
        .map(|z| {
            let point = [0.0, 0.0, z];
            // Where the line from the point over the screen's edge meets the floor.
            let beyond = (SCREEN_X * z / (z - SCREEN_M)).min(origin[0] + sides[0]);
            let parts = [(origin, [SCREEN_X - origin[0], 4.0]), ([beyond, -2.0, 0.0], [origin[0] + sides[0] - beyond, 4.0])];
            let value = parts.iter().map(|(origin, sides)| reflected(*origin, *sides, point, normal)).sum();
            let scene = screen(
                lit(measured(&[at(point, normal)]), origin, sides),
                [SCREEN_X, -20.0, 0.0],
                [0.0, 40.0, 0.0],
                [0.0, 0.0, SCREEN_M],
            );
            let truth = Truth::new(format!("cie171-5.7-{z}"), &scene, value, "ρ E (F before + F beyond the screen)")
                .because("The wall sees the surface before the screen, and what lies beyond the line over the screen's edge.")
                .confirmed("quadrature over both parts", 1e-6, move || {
                    parts.iter().map(|(origin, sides)| by_area(*origin, *sides, point, normal)).sum()
                })
                .or_else("no screen", reflected(origin, sides, point, normal));
            case("5.7", format!("wall, z = {z} m, screen of {SCREEN_M} m"), "lx", LUX, truth)
        })
        .collect()
}

/// 5.8: a closed room of 4 × 4 × 4 m with a point of 10,000 lm in its middle; the mean over all faces.
fn rooms() -> Vec<SuiteCase> {
    const FLUX_LM: f64 = 1e4;
    [0.5, 0.8, 0.9, 0.95]
        .into_iter()
        .map(|rho: f64| {
            let faces: [[Vec3; 3]; 6] = [
                [[-2.0, -2.0, -2.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
                [[-2.0, -2.0, 2.0], [0.0, 4.0, 0.0], [4.0, 0.0, 0.0]],
                [[-2.0, -2.0, -2.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]],
                [[2.0, -2.0, -2.0], [0.0, 0.0, 4.0], [0.0, 4.0, 0.0]],
                [[-2.0, -2.0, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]],
                [[-2.0, 2.0, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]],
            ];
            let meters = faces.map(|[origin, u, v]| json!({ "type": "flux", "origin_m": origin, "u_m": u, "v_m": v }));
            let scene = faces
                .iter()
                .fold(measured(&meters), |scene, [origin, u, v]| scene.object(parallelogram(*origin, *u, *v), lambert(rho)))
                .light(json!({ "type": "point", "position_m": [0, 0, 0], "flux_lm": FLUX_LM }));
            // The mean of six fluxes, in units of the sensor.
            let value = FLUX_LM / (1.0 - rho) / 6.0 / LUX;
            let truth = Truth::new(format!("cie171-5.8-{rho}"), &scene, value, "Φ/(6(1 − ρ)) on each face in the mean; of it Φρ/(6(1 − ρ)) reflected")
                .because("All light that arrives is what the lamp sends and what walls of one reflectance send back: Φₜ = Φ + ρΦₜ.")
                .confirmed("the sum over the orders of reflection", 1e-9, move || {
                    (0..600).map(|k| FLUX_LM * rho.powi(k)).sum::<f64>() / 6.0 / LUX
                })
                .or_else("the direct light left out", value * rho)
                // By a bound on the largest radiance: that of the brightest place of the walls in direct light, with all orders.
                .no_brighter_than(FLUX_LM / (4.0 * std::f64::consts::PI) / 4.0 / LUX / (1.0 - rho));
            case("5.8", format!("ρ = {rho}, mean of all faces, direct light included"), "lx", 6.0 * LUX / 96.0, truth)
        })
        .collect()
}
