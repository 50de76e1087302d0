//! Lamps and skies that the camera does not see directly, though they light the scene.

use serde_json::json;
use std::f64::consts::PI;

use super::Truth;
use super::irradiance::{disk_by_quadrature, disk_irradiance, sphere_by_quadrature, sphere_irradiance};
use super::scene::{PLATE_ALBEDO, Scene, black, disk, lambert, level_square, mirror, shown, sphere};

pub(super) fn truths() -> Vec<Truth> {
    vec![disk_before_the_camera(), ball_before_the_camera(), sky_behind_a_mirror(), in_air_that_absorbs()]
}

/// A scene whose lights the camera does not see.
fn hidden(scene: Scene) -> Scene {
    scene.set("integrator", "hide_lights", json!(true))
}

/// A camera that looks straight down on the middle of a plate.
fn plate_from_above() -> Scene {
    Scene::orthographic([0.0, 0.0, 4.0], [0.0; 3], 1e-4)
        .object(level_square([0.0; 3], 1e-3, true), lambert(PLATE_ALBEDO))
}

fn disk_before_the_camera() -> Truth {
    let scene = plate_from_above().lamp(disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0), black(), 1.0, "front");
    Truth::new(
        "hidden-disk-before-the-camera",
        &hidden(scene),
        shown(disk_irradiance(1.0, 1.0, 0.0)),
        "(ρ/π)E, E = π r²/(r² + h²)",
    )
    .because("The camera looks through the disk, whose back is black, at what it lights.")
    .confirmed("quadrature over the disk", 1e-8, || {
        shown(disk_by_quadrature([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0, [0.0; 3], [0.0, 0.0, 1.0]))
    })
    .or_else("the disk in the way", 0.0)
    .sees(5e-3)
}

fn ball_before_the_camera() -> Truth {
    let scene = plate_from_above().lamp(sphere([0.0, 0.0, 2.0], 0.5), black(), 1.0, "front");
    Truth::new("hidden-ball-before-the-camera", &hidden(scene), shown(sphere_irradiance(0.5, 2.0, 0.0)), "(ρ/π)π(R/d)²")
        .because("The camera looks through both sides of the ball at what it lights.")
        .confirmed("quadrature over the cone", 1e-7, || shown(sphere_by_quadrature(0.5, 2.0, 0.0)))
        .or_else("the ball is seen", 1.0)
        .or_else("only its near side is hidden", 0.0)
        .sees(5e-3)
}

fn sky_behind_a_mirror() -> Truth {
    const REFLECTANCE: f64 = 0.9;
    // The mirror covers the left half of the picture.
    let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1.0)
        .object(level_square([-5.0, 0.0, 0.0], 5.0, true), mirror(REFLECTANCE))
        .sky(1.0);
    Truth::new("hidden-sky-behind-a-mirror", &hidden(scene), 0.5 * REFLECTANCE, "R/2")
        .because("One half of the picture shows the sky in a mirror, the other would show the sky itself and is black.")
        .or_else("the sky is seen", 0.5 + 0.5 * REFLECTANCE)
        .or_else("hidden in the mirror, too", 0.0)
        .sees(5e-3)
}

/// The medium before a hidden lamp and behind it counts.
fn in_air_that_absorbs() -> Truth {
    const PER_M: f64 = 0.25;
    let lamp = disk([0.0, 0.0, 2.0], [0.0, 0.0, 1.0], 0.5);
    let scene = plate_from_above()
        .lamp(lamp, black(), 1.0, "front")
        .point_light([0.0, 1.0, 1.0], 3.0)
        .whole("medium", json!({ "absorption_per_m": PER_M }));
    let of_point = 3.0 / 2.0 * 0.5_f64.sqrt();
    let value = shown(of_point) * (-PER_M * (4.0 + 2.0_f64.sqrt())).exp();
    Truth::new("hidden-disk-in-air-that-absorbs", &hidden(scene), value, "(ρ/π) (I/d²) cos 45° e^(−σ(d + 4)), d = √2")
        .because(
            "The camera looks through the back of a disk that lights nothing. The air on both sides of it absorbs.",
        )
        .or_else("the disk is seen", (-2.0 * PER_M).exp())
        .or_else("air up to the disk does not count", value * (2.0 * PER_M).exp())
        .or_else("without air", shown(of_point))
        .confirmed("by the inverse square of the way, in steps", 1e-6, || {
            let steps = 1000;
            let through = |way: f64| {
                (1.0 - PER_M * way / f64::from(steps) + 0.5 * (PER_M * way / f64::from(steps)).powi(2)).powi(steps)
            };
            PLATE_ALBEDO / PI * 3.0 * (1.0 / 2.0) / 2.0_f64.sqrt() * through(2.0_f64.sqrt()) * through(4.0)
        })
        .sees(5e-3)
}
