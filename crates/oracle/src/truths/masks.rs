//! Surfaces that let a part of the light pass, where they lie in the plane of another surface.
//!
//! Such a surface lies before whatever it coincides with, seen from either side; of several, the one that comes later in the scene
//! lies before the others. Light that passes it goes on as it was, and light that leaves the surface behind it does not meet it again.

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{PLATE_ALBEDO, Scene, black, block, lambert, level_square, mesh, mirror, parallelogram},
};
use crate::vector::{add, scale, sub};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = coplanar();
    list.push(sliding());
    list.push(veil_by_two_mirrors());
    list.extend(["mis", "light", "bsdf"].map(veiled_lamp));
    list.into_iter().map(|truth| truth.claims(Claim::Masks)).collect()
}

const FLOOR: f64 = 0.3;

/// What a floor under a sky of radiance 1 shows, seen at a slant so that no ray meets a face at right angles.
fn view() -> Scene {
    Scene::orthographic([0.3, -0.5, 2.0], [0.0; 3], 0.2).sky(1.0).film(16, 16)
}

fn coplanar() -> Vec<Truth> {
    let floor = || level_square([0.0; 3], 5.0, true);
    let sheet = || level_square([0.0; 3], 0.4, true);
    let because = "A surface of opacity a shows a times its own albedo; the rest of the light meets what lies behind, here in the same \
                   plane. Each face of albedo ρ under a sky of radiance 1 shows ρ: nothing else is there to see or to hide the sky.";
    let truth = |name: &str, scene: &Scene, value: f64, formula: &str, behind: f64| {
        Truth::new(name, scene, value, formula)
            .because(because)
            .or_else("what lies behind is not met", behind)
            .sees(0.01)
    };
    let first = view().mask(sheet(), lambert(0.9), 0.0).object(floor(), lambert(FLOOR));
    let last = view().object(floor(), lambert(FLOOR)).mask(sheet(), lambert(0.9), 0.0);
    let half_first = view().mask(sheet(), lambert(0.9), 0.5).object(floor(), lambert(FLOOR));
    let half_last = view().object(floor(), lambert(FLOOR)).mask(sheet(), lambert(0.9), 0.5);
    let standing =
        view().mask(block([-0.5, -0.5, 0.0], [0.5, 0.5, 0.7]), lambert(0.9), 0.0).object(floor(), lambert(FLOOR));
    let layers = view().mask(sheet(), lambert(0.8), 0.25).object(floor(), lambert(FLOOR)).mask(
        level_square([0.0; 3], 0.6, true),
        lambert(0.1),
        0.5,
    );
    let three = 0.5 * 0.1 + 0.5 * (0.25 * 0.8 + 0.75 * FLOOR);
    vec![
        truth("mask-in-a-floor-listed-first", &first, FLOOR, "ρ = 0.3", 1.0),
        truth("mask-in-a-floor-listed-last", &last, FLOOR, "ρ = 0.3", 1.0),
        truth("mask-of-half-in-a-floor-listed-first", &half_first, 0.6, "½·0.9 + ½·0.3", 0.95)
            .or_else("light from the floor is masked once more", 0.525),
        truth("mask-of-half-in-a-floor-listed-last", &half_last, 0.6, "½·0.9 + ½·0.3", 0.95)
            .or_else("the floor hides the sheet", FLOOR),
        truth("mask-of-a-box-on-a-floor", &standing, FLOOR, "ρ = 0.3", 1.0),
        truth(
            "masks-of-two-sheets-in-a-floor",
            &layers,
            three,
            "½·0.1 + ½·(¼·0.8 + ¾·0.3)",
            0.5 * 0.1 + 0.5 * (0.25 * 0.8 + 0.75),
        )
        .or_else("the sheet that is listed first lies before the other", 0.25 * 0.8 + 0.75 * (0.5 * 0.1 + 0.5 * FLOOR)),
        truth("mask-of-half-in-a-tilted-floor", &tilted(), 0.6, "½·0.9 + ½·0.3", 0.95),
    ]
}

/// Two meshes of other triangles in a plane that no coordinate is exact in, seen from above it.
fn tilted() -> Scene {
    // Columns of a rotation whose entries are rounded: u and v span the plane.
    let (u, v) = ([0.48, 0.6, 0.64], [-0.8, 0.6, 0.0]);
    let at = |a: f64, b: f64| [0, 1, 2].map(|i| 0.1 + a * u[i] + b * v[i]);
    let normal = [0.6 * 0.0 - 0.64 * 0.6, 0.64 * -0.8 - 0.48 * 0.0, 0.48 * 0.6 + 0.6 * 0.8];
    let centre = [0.1; 3];
    let eye = [0, 1, 2].map(|i| centre[i] + 2.0 * normal[i] + 0.3 * u[i]);
    let floor = mesh(&[at(-5.0, -5.0), at(5.0, -5.0), at(5.0, 5.0), at(-5.0, 5.0)], &[[0, 1, 2], [0, 2, 3]]);
    let rim = (0..6).map(|k| {
        let (s, c) = (f64::from(k) * std::f64::consts::TAU / 6.0).sin_cos();
        at(0.7 * c, 0.7 * s)
    });
    let corners: Vec<_> = std::iter::once(at(0.0, 0.0)).chain(rim).collect();
    let fan: Vec<_> = (0..6).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect();
    let scene = Scene::orthographic(eye, centre, 0.2).sky(1.0).film(16, 16);
    scene.object(floor, lambert(FLOOR)).mask(mesh(&corners, &fan), lambert(0.9), 0.5)
}

/// A sheet that slides through the view, in the plane of the floor.
fn sliding() -> Truth {
    let sheet = json!({ "shape": level_square([0.0; 3], 1.0, true), "material": lambert(0.9), "opacity": 0.5 });
    let key = |time_s: f64, x: f64| json!({ "time_s": time_s, "transform": [{ "translate_m": [x, 0.0, 0.0] }] });
    let scene = view()
        .object(level_square([0.0; 3], 5.0, true), lambert(FLOOR))
        .shutter([0.0, 1.0])
        .moving(&[sheet], &[key(0.0, -4.0), key(1.0, 4.0)]);
    Truth::new("mask-of-half-sliding-over-a-floor", &scene, 0.375, "¼·(½·0.9 + ½·0.3) + ¾·0.3")
        .because("The sheet, 2 m wide, slides in the plane of the floor at 8 m/s: each point of the view is under it for a quarter of the time.")
        .or_else("the floor is not met where the sheet is", 0.25 * 0.95 + 0.75 * FLOOR)
        .or_else("the sheet is not met", FLOOR)
        .or_else("the sheet stands still", 0.6)
        .sees(0.01)
        .claims(Claim::Motion)
}

/// A lamp with a black sheet of opacity ½ in its own plane.
fn veiled_lamp(how: &'static str) -> Truth {
    let lamp = parallelogram([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
    let veil: Value = parallelogram([-1.5, -1.5, 1.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
    let scene =
        Scene::light_meter().lamp(lamp, black(), 1.0, "front").mask(veil, black(), 0.5).light_sampling(how).spp(4096);
    // E of the square: 4 g atan g with g = a/√(1 + a²), a = 1.
    let g = 0.5_f64.sqrt();
    let whole = 4.0 * g * g.atan() * PLATE_ALBEDO / std::f64::consts::PI;
    Truth::new(format!("mask-in-the-plane-of-a-lamp-{how}"), &scene, 0.5 * whole, "½ · ρ/π · 4g·atan g, g = 1/√2")
        .because(
            "The sheet lies before the lamp, from whichever side it is seen, and lets half of its light pass: shadow rays and paths \
             that run into the lamp find the same half.",
        )
        .or_else("the sheet is not met", whole)
        .or_else("the lamp is not met", 0.0)
        .sees(0.01)
}

/// A mirror of opacity ½ leads the view to a whole mirror, and this to a black sheet of opacity ½ before a lamp.
fn veil_by_two_mirrors() -> Truth {
    // Around a place, with its front to the left and up, or to the right and up.
    let slanted = |center: [f64; 3], rises: f64| {
        let (along, across) = ([0.4, 0.0, 0.4 * rises], [0.0, 0.4, 0.0]);
        parallelogram(sub(center, scale(0.5, add(along, across))), along, across)
    };
    let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 0.1)
        .mask(slanted([0.0; 3], -1.0), mirror(1.0), 0.5)
        .object(slanted([1.0, 0.0, 0.0], 1.0), mirror(1.0))
        .mask(level_square([1.0, 0.0, 1.0], 0.3, false), black(), 0.5)
        .lamp(level_square([1.0, 0.0, 2.0], 0.5, false), black(), 1.0, "front")
        .film(16, 16)
        .spp(256);
    Truth::new("veil-by-a-veiled-mirror-and-another", &scene, 0.25, "½ · ½")
        .because(
            "The first mirror reflects half of the light, and the sheet lets half of that pass. What passes the first mirror meets nothing. One \
             sheet does not know what another has done.",
        )
        .or_else("where the mirror reflects, the sheet always stops the light", 0.0)
        .or_else("where the mirror reflects, the sheet never stops the light", 0.5)
        .or_else("the mirror reflects all", 0.5)
        .or_else("the sheet is not met", 0.5)
        .sees(0.01)
}
