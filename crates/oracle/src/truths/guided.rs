//! A mirror aside of a plate, by which alone light comes to it: it pays to aim at the box around the mirror.

use serde_json::json;

use super::irradiance::parallelogram_by_quadrature;
use super::scene::{Scene, black, mirror, parallelogram, shown};
use super::{Truth, lambert_polygon};
use crate::vector::Vec3;

const REFLECTANCE: f64 = 0.9;
/// Height of the mirror over the plate, and of the plate over the lamp.
const ABOVE_M: f64 = 1.0;
const BELOW_M: f64 = 0.5;
/// The mirror: from x to x, and its half side along y.
const FROM_M: f64 = 0.5;
const TO_M: f64 = 1.7;
const HALF_M: f64 = 1.0;

/// A level rectangle at a height that is seen from the plate where the mirror is, and a little more.
fn rectangle(z: f64, times: f64, more: f64, front_up: bool) -> serde_json::Value {
    let origin = [times * FROM_M - more, -times * HALF_M - more, z];
    let along: Vec3 = [times * (TO_M - FROM_M) + 2.0 * more, 0.0, 0.0];
    let across: Vec3 = [0.0, 2.0 * (times * HALF_M + more), 0.0];
    if front_up { parallelogram(origin, along, across) } else { parallelogram(origin, across, along) }
}

pub(super) fn truths() -> Vec<Truth> {
    // Seen in the mirror, the lamp is this many times as far away as the mirror.
    let times = (2.0 * ABOVE_M + BELOW_M) / ABOVE_M;
    let scene = Scene::light_meter()
        .object(rectangle(ABOVE_M, 1.0, 0.0, false), mirror(REFLECTANCE))
        .lamp(rectangle(-BELOW_M, times, 0.2, true), black(), 1.0, "front")
        .set("integrator", "light_tracing", json!("never"));
    let corner = |x: f64, side: f64| [x, side * HALF_M, ABOVE_M];
    let corners = [corner(FROM_M, -1.0), corner(TO_M, -1.0), corner(TO_M, 1.0), corner(FROM_M, 1.0)];
    let up = [0.0, 0.0, 1.0];
    let value = REFLECTANCE * shown(lambert_polygon(&corners, up));
    vec![
        Truth::new("lamp-in-a-mirror-seen-aslant", &scene, value, "(ρ/π) R E of the mirror's rectangle by Lambert's formula")
            .because(
                "The lamp is below the plate's horizon and fills the mirror wherever it is seen from the plate. So the plate is lit as by a \
                 rectangle of radiance R in the mirror's place.",
            )
            .confirmed("quadrature over the mirror", 1e-6, move || {
                let (along, across) = ([TO_M - FROM_M, 0.0, 0.0], [0.0, 2.0 * HALF_M, 0.0]);
                let irradiance = parallelogram_by_quadrature(corner(FROM_M, -1.0), along, across, [0.0; 3], up);
                REFLECTANCE * shown(irradiance)
            })
            .or_else("dark", 0.0)
            .or_else("a mirror without loss", value / REFLECTANCE)
            .sees(5e-3),
    ]
}
