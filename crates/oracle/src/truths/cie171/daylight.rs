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
        // What is seen jumps at the horizon.
        let parts = opening.split_at(point[2]);
        let of_parts = move |of: &dyn Fn(&Opening) -> f64| parts.iter().map(of).sum::<f64>();
        let value = of_parts(&|part| part.irradiance(point, normal, radiance));
        let name = format!("cie171-{section}-{}-sky-{}", place.replace(' ', "-").replace(',', ""), sky.number);
        let truth = Truth::new(
            name,
            &scene.light(self.json()),
            value,
            "∫ L(ω) cos θ dω over the opening, over that of the open sky",
        )
        .because("Through an opening a point sees the sky of the standard, and below the horizon the ground.")
        .confirmed("midpoints over the opening", 2e-4, move || {
            of_parts(&|part| part.irradiance_by_midpoints(point, normal, radiance))
        })
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
    let places = [("2 m opening, floor", 2.0, floor), ("4 m opening, wall at 2.75 m", 4.0, ([-2.0, 0.0, 2.75], wall))];
    let mut list = Vec::new();
    for (place, side, (point, normal)) in places {
        let scene = || roof_room(measured(&[at(point, normal)]), side);
        list.push(day.truth("5.9", place, (point, normal), opening(side), false, scene()));
        if side > 2.0 {
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

/// A vertical meter at the height of the window's middle that faces it, this far from it.
fn facing(distance: f64) -> (Vec3, Vec3) {
    ([distance, 0.0, 1.5], [-1.0, 0.0, 0.0])
}

/// 5.11 and 5.12: sky on the floor, the ground on the ceiling, both on a plane that faces the window.
fn facades(day: &Day) -> Vec<SuiteCase> {
    let mut list = Vec::new();
    let opening = window(WINDOW[1]);
    let places = [
        ("floor at 1 m", ([1.0, 0.0, 0.0], UP)),
        ("ceiling at 1 m", ([1.0, 0.0, 3.0], DOWN)),
        ("facing the window at 1 m", facing(1.0)),
    ];
    for (place, meter) in places {
        let scene = || facade_room(measured(&[at(meter.0, meter.1)]));
        list.push(day.truth("5.11", place, meter, opening, false, scene()));
        if meter.1 != UP && meter.1 != DOWN {
            list.push(day.truth("5.12", place, meter, opening, true, pane(scene(), &opening)));
        }
    }
    list
}

/// 5.13 and 5.14: a roof over the window of 0.5 m, or a wall up to 3 m at a distance of 6 m; both black and without end.
fn masks(day: &Day) -> Vec<SuiteCase> {
    let [_, [low, high]] = WINDOW;
    let (point, normal) = facing(1.0);
    let [distance, _, height] = point;
    let scene = || facade_room(measured(&[at(point, normal)]));
    // Through the height z of the window a ray comes to that of the roof, the window's upper edge, at x = −distance (high − z)/(z − height).
    const DEPTH: f64 = 0.5;
    let seen = (high + DEPTH * height / distance) / (1.0 + DEPTH / distance);
    let roofed = screen(scene(), [-DEPTH, -FAR, high], [DEPTH, 0.0, 0.0], [0.0, 2.0 * FAR, 0.0]);
    let below = day.truth("5.13", "facing the window at 1 m", (point, normal), window([low, seen]), false, roofed);
    // And to the distance of the wall at the height height + (z − height)(distance + away)/distance.
    const AWAY: f64 = 6.0;
    const WALL: f64 = 3.0;
    let seen = height + (WALL - height) * distance / (distance + AWAY);
    let walled = screen(scene(), [-AWAY, -FAR, -FAR], [0.0, 2.0 * FAR, 0.0], [0.0, 0.0, FAR + WALL]);
    let above = day.truth("5.14", "facing the window at 1 m", (point, normal), window([seen, high]), false, walled);
    vec![below, above]
}
