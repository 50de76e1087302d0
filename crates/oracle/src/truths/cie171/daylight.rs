//! 5.9 to 5.14: the light of the sixteen skies through openings, in percent of what an open level place gets.
//!
//! Walls are black, so that a reading is the sky component, and where the ground is seen the externally reflected one. The ground has the
//! luminance of a diffuse one of reflectance 0.3 in the open, to the horizon. Masks are black. Glass is a pane of index 1.52 without
//! absorption.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::super::skylight::{Opening, Sky, direction, slab};
use super::lamps::roof_room;
use super::{DOWN, Scene, SuiteCase, UP, at, case, measured, screen};
use crate::truths::Truth;
use crate::vector::Vec3;

const INDEX: f64 = 1.52;
const GROUND_REFLECTANCE: f64 = 0.3;
/// Screens that stand for ones without end.
const FAR: f64 = 2000.0;

pub(super) fn cases() -> Vec<SuiteCase> {
    let mut list = Vec::new();
    for number in 1..=16 {
        // Above the side that the facade faces, −x, and off it.
        let mut sky = Sky::new(number, direction(40.0, 150.0));
        let level = sky.irradiance(UP);
        sky.ground = GROUND_REFLECTANCE * level / PI;
        let day = Day { sky, zenith: 100.0 / level };
        list.extend(roofs(&day));
        list.extend(facades(&day));
        list.extend(masks(&day));
    }
    // By section, each with its skies.
    list.sort_by_key(|case| case.section[2..].parse::<u32>().unwrap_or_default());
    list
}

/// A sky whose level irradiance is 100 in units of the sensor.
#[derive(Clone, Copy)]
struct Day {
    sky: Sky,
    zenith: f64,
}

impl Day {
    fn json(&self) -> Value {
        json!({
            "type": "environment",
            "sky": { "cie_type": self.sky.number, "up": UP, "sun_direction": self.sky.sun, "zenith_radiance": self.zenith, "ground": self.sky.ground },
        })
    }

    /// A point's reading, and how it is confirmed.
    fn truth(
        &self,
        section: &'static str,
        place: &str,
        (point, normal): (Vec3, Vec3),
        opening: Opening,
        glass: bool,
        scene: Scene,
    ) -> SuiteCase {
        let Self { sky, zenith } = *self;
        let radiance = move |toward: Vec3, cos: f64| {
            zenith * sky.relative(toward) * if glass { slab(cos, INDEX, 0.0) } else { 1.0 }
        };
        let value = opening.irradiance(point, normal, radiance);
        let name = format!("cie171-{section}-{}-sky-{}", place.replace(' ', "-").replace(',', ""), sky.number);
        let truth = Truth::new(
            name,
            &scene.light(self.json()),
            value,
            "∫ L(ω) cos θ dω over the opening, over that of the open sky",
        )
        .because("Through an opening a point sees the sky of the standard, and below the horizon the ground.")
        .confirmed("midpoints over the opening", 2e-4, move || opening.irradiance_by_midpoints(point, normal, radiance))
        .allows(1e-4 * value, "2e-5 for single precision, 1e-4 for screens that end and for the quadrature");
        case(section, format!("sky {}, {place}", sky.number), "%", 1.0, truth)
    }
}

/// A pane over a parallelogram.
fn pane(scene: Scene, opening: &Opening) -> Scene {
    let [u, v] = opening.edges;
    scene.object(
        json!({ "type": "parallelogram", "origin_m": opening.origin, "u_m": u, "v_m": v }),
        json!({ "type": "thin-dielectric", "index": INDEX }),
    )
}

/// 5.9 and 5.10: a square opening in the roof.
fn roofs(day: &Day) -> Vec<SuiteCase> {
    let opening =
        |side: f64| Opening { origin: [-0.5 * side, -0.5 * side, 3.0], edges: [[side, 0.0, 0.0], [0.0, side, 0.0]] };
    let wall: Vec3 = [1.0, 0.0, 0.0];
    let floor = ([0.0, 0.0, 0.0], UP);
    let places = [("1 m opening, floor", 1.0, floor), ("4 m opening, wall at 2.75 m", 4.0, ([-2.0, 0.0, 2.75], wall))];
    let mut list = Vec::new();
    for (place, side, (point, normal)) in places {
        let scene = || roof_room(measured(&[at(point, normal)]), side);
        list.push(day.truth("5.9", place, (point, normal), opening(side), false, scene()));
        if side > 1.0 {
            list.push(day.truth("5.10", place, (point, normal), opening(side), true, pane(scene(), &opening(side))));
        }
    }
    list
}

/// The opening of a facade in the plane x = 0, 2 m wide, from 1 to 2 m above the floor; the room is 4 × 4 × 3 m.
const WINDOW: [[f64; 2]; 2] = [[-1.0, 1.0], [1.0, 2.0]];

fn window([low, high]: [f64; 2]) -> Opening {
    let [[left, right], _] = WINDOW;
    Opening { origin: [0.0, left, low], edges: [[0.0, right - left, 0.0], [0.0, 0.0, high - low]] }
}

fn facade_room(scene: Scene) -> Scene {
    let [[left, right], [low, high]] = WINDOW;
    let scene = screen(scene, [0.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]);
    let scene = screen(scene, [0.0, -2.0, 3.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]);
    let scene = screen(scene, [4.0, -2.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]);
    let scene = screen(scene, [0.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
    let scene = screen(scene, [0.0, 2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
    // The facade around the window.
    let scene = screen(scene, [0.0, -2.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, low]);
    let scene = screen(scene, [0.0, -2.0, high], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0 - high]);
    let scene = screen(scene, [0.0, -2.0, low], [0.0, left + 2.0, 0.0], [0.0, 0.0, high - low]);
    screen(scene, [0.0, right, low], [0.0, 2.0 - right, 0.0], [0.0, 0.0, high - low])
}

/// 5.11 and 5.12: sky on the floor, the ground on the ceiling.
fn facades(day: &Day) -> Vec<SuiteCase> {
    let mut list = Vec::new();
    for (place, point, normal) in [("floor at 1.5 m", [1.5, 0.0, 0.0], UP), ("ceiling at 1.5 m", [1.5, 0.0, 3.0], DOWN)]
    {
        let scene = || facade_room(measured(&[at(point, normal)]));
        let opening = window(WINDOW[1]);
        list.push(day.truth("5.11", place, (point, normal), opening, false, scene()));
        if normal == UP {
            list.push(day.truth("5.12", place, (point, normal), opening, true, pane(scene(), &opening)));
        }
    }
    list
}

/// 5.13 and 5.14: a roof over the window of 1 m, or a wall of 8 m at a distance of 6 m; both black and without end.
fn masks(day: &Day) -> Vec<SuiteCase> {
    let [_, [low, high]] = WINDOW;
    let mut list = Vec::new();
    for distance in [1.0, 1.5] {
        let (point, place) = ([distance, 0.0, 0.0], format!("floor at {distance} m"));
        let scene = || facade_room(measured(&[at(point, UP)]));
        // Through heights z the ray comes to the height of the roof at x = −distance (high − z)/z.
        const DEPTH: f64 = 0.5;
        let seen = high / (1.0 + DEPTH / distance);
        let roofed = screen(scene(), [-DEPTH, -FAR, high], [DEPTH, 0.0, 0.0], [0.0, 2.0 * FAR, 0.0]);
        list.push(day.truth("5.13", &place, (point, UP), window([low, seen.clamp(low, high)]), false, roofed));
        // And to x = −6 m at the height z (distance + 6)/distance.
        const AWAY: f64 = 6.0;
        const WALL: f64 = 8.0;
        let seen = (WALL * distance / (distance + AWAY)).clamp(low, high);
        let walled = screen(scene(), [-AWAY, -FAR, -FAR], [0.0, 2.0 * FAR, 0.0], [0.0, 0.0, FAR + WALL]);
        list.push(day.truth("5.14", &place, (point, UP), window([seen, high]), false, walled));
    }
    list
}
