//! 5.2 to 5.4: light straight from lamps, and its conservation.

use std::f64::consts::PI;

use serde_json::json;

use super::super::scene::{black, parallelogram};
use super::{LUX, SuiteCase, UP, at, case, corners, measured, screen};
use crate::quadrature::rectangle;
use crate::truths::{Truth, lambert_polygon};
use crate::vector::Vec3;

pub(super) fn cases() -> Vec<SuiteCase> {
    let mut list = points();
    list.extend(areas());
    list.extend(conservation());
    list
}

/// An IES file whose intensity is 1000 cd times the cosine of the angle from the nadir, in steps of half a degree.
fn lambert_ies() -> Vec<u8> {
    let steps: Vec<f64> = (0..=180).map(|step| 0.5 * f64::from(step)).collect();
    let line = |numbers: &[f64]| numbers.iter().map(|n| format!("{n:.9}")).collect::<Vec<_>>().join(" ");
    let intensities: Vec<f64> = steps.iter().map(|angle| 1000.0 * angle.to_radians().cos().max(0.0)).collect();
    format!("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 181 1 1 2 0 0 0\n1 1 0\n{}\n0\n{}\n", line(&steps), line(&intensities))
        .into_bytes()
}

/// 5.2: a point 3 m above a plane, its intensity 1000 cd in every direction, or 1000 cd times the cosine (from an IES file).
fn points() -> Vec<SuiteCase> {
    const H: f64 = 3.0;
    let mut list = Vec::new();
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (1.5, 1.5), (2.0, 2.0)] {
        let d = (x * x + y * y + H * H).sqrt();
        let place = format!("x = {x} m, y = {y} m");
        let even = 1000.0 * H / d.powi(3) / LUX;
        let scene = measured(&[at([x, y, 0.0], UP)])
            .light(json!({ "type": "point", "position_m": [0, 0, H], "intensity_cd": 1000 }));
        let by_angle = move |power: i32| 1000.0 * (x.hypot(y) / H).atan().cos().powi(power) / (H * H) / LUX;
        let truth = Truth::new(format!("cie171-5.2-even-{x}-{y}"), &scene, even, "I h/d³")
            .because("A point of intensity I gives I/d² across its light, times the cosine h/d.")
            .confirmed("cos³ of the angle over h²", 1e-12, move || by_angle(3));
        list.push(case("5.2", format!("{place}, even"), "lx", LUX, truth));
        let lambert = 1000.0 * H * H / d.powi(4) / LUX;
        let scene = measured(&[at([x, y, 0.0], UP)])
            .light(json!({ "type": "luminaire", "file": "lambert.ies", "position_m": [0, 0, H], "nadir": [0, 0, -1], "forward": [1, 0, 0] }))
            .file("lambert.ies", lambert_ies());
        let truth = Truth::new(format!("cie171-5.2-lambert-{x}-{y}"), &scene, lambert, "I₀ h²/d⁴")
            .because("With I = I₀ cos γ another cosine h/d is there.")
            .confirmed("cos⁴ of the angle over h²", 1e-12, move || by_angle(4))
            .allows(2e-5 * lambert, "2e-5 for single precision, 1e-5 for a cosine that is linear over half a degree");
        list.push(case("5.2", format!("{place}, Lambert from an IES file"), "lx", LUX, truth));
    }
    list
}

/// 5.3: a square of 1 m², 3 m above the floor of a room, 1000 cd/m².
fn areas() -> Vec<SuiteCase> {
    let (origin, u, v): (Vec3, Vec3, Vec3) = ([-0.5, -0.5, 3.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    let mut list = Vec::new();
    let floor = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0)]
        .map(|(x, y)| ([x, y, 0.0], UP, format!("floor, x = {x} m, y = {y} m")));
    let wall = [0.5, 1.5, 2.5].map(|z| ([2.0, 0.0, z], [-1.0, 0.0, 0.0], format!("wall, z = {z} m")));
    for (point, normal, place) in floor.into_iter().chain(wall) {
        let value = 1000.0 / LUX * lambert_polygon(&corners(origin, u, v, point), normal);
        let lamp = json!({
            "shape": parallelogram(origin, u, v), "material": black(),
            "emission": { "luminance_cd_per_m2": 1000, "sides": "front" },
        });
        let scene = measured(&[at(point, normal)]).thing(lamp);
        let by_area = move || {
            let over = |a: f64, b: f64| {
                let way = [origin[0] + b - point[0], origin[1] + a - point[1], 3.0 - point[2]];
                let d2 = way.iter().map(|c| c * c).sum::<f64>();
                let here: f64 = (0..3).map(|k| way[k] * normal[k]).sum();
                here * way[2] / (d2 * d2)
            };
            1000.0 / LUX * rectangle(over, [0.0, 1.0], [0.0, 1.0], 1e-11, 1_000_000).value
        };
        let truth = Truth::new(format!("cie171-5.3-{}-{}-{}", point[0], point[1], point[2]), &scene, value, "π L F by Lambert's formula")
            .because("The configuration factor of a rectangle is half the sum of the angles of its edges, each times the cosine of its plane.")
            .confirmed("quadrature over the lamp", 1e-7, by_area);
        list.push(case("5.3", place, "lx", LUX, truth));
    }
    list
}

/// 5.4: what comes through an evenly luminous opening in the roof of a black room of 4 × 4 × 3 m arrives on its floor and walls.
fn conservation() -> Vec<SuiteCase> {
    let mut list = Vec::new();
    for side in [1.0, 2.0, 3.0, 4.0] {
        // The mean of five readings.
        let meters = [
            ([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]),
            ([-2.0, -2.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]),
            ([2.0, -2.0, 0.0], [0.0, 0.0, 3.0], [0.0, 4.0, 0.0]),
            ([-2.0, -2.0, 0.0], [0.0, 0.0, 3.0], [4.0, 0.0, 0.0]),
            ([-2.0, 2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 3.0]),
        ]
        .map(|(origin, u, v): (Vec3, Vec3, Vec3)| json!({ "type": "flux", "origin_m": origin, "u_m": u, "v_m": v }));
        let radiance = 1000.0 / LUX;
        let flux = PI * radiance * side * side;
        let opening: Vec3 = [-0.5 * side, -0.5 * side, 3.0];
        let (u, v) = ([0.0, side, 0.0], [side, 0.0, 0.0]);
        let lamp = json!({
            "shape": parallelogram(opening, u, v), "material": black(),
            "emission": { "luminance_cd_per_m2": 1000, "sides": "front" },
        });
        let scene = roof_room(measured(&meters), side).thing(lamp);
        let exchanged = move || {
            // Through the opening by Lambert's formula at places of the floor and of a wall.
            let from = |point: Vec3, normal: Vec3| radiance * lambert_polygon(&corners(opening, u, v, point), normal);
            let floor = rectangle(|x, y| from([x, y, 0.0], UP), [-2.0, 2.0], [-2.0, 2.0], 1e-6, 200_000).value;
            let wall =
                rectangle(|y, z| from([2.0, y, z], [-1.0, 0.0, 0.0]), [-2.0, 2.0], [0.0, 3.0], 1e-6, 400_000).value;
            0.2 * (floor + 4.0 * wall)
        };
        let truth = Truth::new(format!("cie171-5.4-{side}"), &scene, 0.2 * flux, "π L A/5")
            .because("An evenly luminous opening sends πLA; the room is closed, so all of it arrives on the floor and the walls.")
            .confirmed("quadrature of Lambert's formula over the floor and the walls", 1e-3, exchanged);
        list.push(case("5.4", format!("opening of {side} × {side} m, floor and walls"), "lm", 5.0 * LUX, truth));
    }
    list
}

/// A black room of 4 × 4 × 3 m about the z axis, with a square opening of this side in the middle of its roof.
pub(super) fn roof_room(scene: super::Scene, side: f64) -> super::Scene {
    let h = 0.5 * side;
    let scene = screen(scene, [-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]);
    let scene = screen(scene, [-2.0, -2.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]);
    let scene = screen(scene, [2.0, -2.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]);
    let scene = screen(scene, [-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
    let scene = screen(scene, [-2.0, 2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
    if side >= 4.0 {
        return scene;
    }
    let rim = 2.0 - h;
    let scene = screen(scene, [-2.0, -2.0, 3.0], [rim, 0.0, 0.0], [0.0, 4.0, 0.0]);
    let scene = screen(scene, [h, -2.0, 3.0], [rim, 0.0, 0.0], [0.0, 4.0, 0.0]);
    let scene = screen(scene, [-h, -2.0, 3.0], [side, 0.0, 0.0], [0.0, rim, 0.0]);
    screen(scene, [-h, h, 3.0], [side, 0.0, 0.0], [0.0, rim, 0.0])
}
