//! Lights as scenes state them beyond the neutral form: spots, lamps in instances, many unequal lamps, and ways of rendering one picture.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Truth, lambert_polygon,
    scene::{Scene, black, lambert, level_square, shown, sphere},
    sphere_irradiance,
};
use crate::vector::Vec3;

const UP: Vec3 = [0.0, 0.0, 1.0];

pub(super) fn truths() -> Vec<Truth> {
    let mut list = spots();
    list.extend(in_instances());
    list.extend(unequal());
    list.extend(under_a_roof());
    list.extend(ways());
    list.extend(dark());
    list
}

/// A spot 2 m above the plate whose axis lies this angle off the way to it.
fn spots() -> Vec<Truth> {
    const INTENSITY: f64 = 10.0;
    let make = |name: &str, off_deg: f64, outer: f64, inner: Option<f64>| {
        let (sin, cos) = off_deg.to_radians().sin_cos();
        let mut spot = json!({
            "type": "spot", "position_m": [0, 0, 2], "direction": [0.6 * sin, 0.8 * sin, -cos], "intensity": INTENSITY,
            "half_angle_deg": outer,
        });
        if let Some(inner) = inner {
            spot["inner_half_angle_deg"] = json!(inner);
        }
        let inner = inner.unwrap_or(0.8 * outer);
        let cosine = |degrees: f64| degrees.to_radians().cos();
        let x = ((cosine(off_deg) - cosine(outer)) / (cosine(inner) - cosine(outer))).clamp(0.0, 1.0);
        let of = |x: f64| shown(INTENSITY * x / 4.0);
        let value = of(x * x * (3.0 - 2.0 * x));
        let linear = (1.0 - (off_deg - inner) / (outer - inner)).clamp(0.0, 1.0);
        let mut truth = Truth::new(
            name,
            &Scene::light_meter().light(spot).film(16, 16).spp(64),
            value,
            format!("(ρ/π)(I₀/4)(3x² − 2x³), x = (cos θ − cos outer)/(cos inner − cos outer), θ = {off_deg}°"),
        )
        .because("Between its two angles a spot falls off by the smooth step of the cosine; inside it has I₀, outside nothing.")
        .confirmed("the integral of 6t(1 − t) up to x", 1e-9, move || {
            of(crate::quadrature::interval(|t| 6.0 * t * (1.0 - t), 0.0, x, 1e-12).value)
        })
        .sees(1e-3);
        if x > 0.0 && x < 1.0 {
            truth = truth
                .or_else("a step at the outer angle", of(1.0))
                .or_else("in proportion to the cosine", of(x))
                .or_else("a smooth step of the angle", of(linear * linear * (3.0 - 2.0 * linear)));
        } else if x == 0.0 {
            truth.second_opinion = None;
            truth = truth.or_else("as far as it is bright", of(1.0));
        } else {
            truth = truth.or_else("dark", 0.0);
        }
        truth
    };
    vec![
        make("spot-inside-its-soft-edge", 24.0, 32.0, Some(18.0)),
        make("spot-inside-the-soft-edge-by-default", 28.0, 30.0, None),
        make("spot-near-its-axis", 10.0, 32.0, Some(18.0)),
        make("spot-beyond-its-edge", 33.0, 32.0, Some(18.0)),
        make("spot-wider-than-a-half-space", 100.0, 120.0, Some(80.0)),
    ]
}

/// What a square lamp of half side h about a place gives.
fn polygon([x, y, z]: Vec3, h: f64) -> f64 {
    lambert_polygon(&[[x - h, y - h, z], [x + h, y - h, z], [x + h, y + h, z], [x - h, y + h, z]], UP)
}

fn in_instances() -> Vec<Truth> {
    let lamp = |shape: Value, radiance: f64| json!({ "shape": shape, "material": black(), "emission": { "radiance": radiance, "sides": "front" } });
    // A square of side 0.4 that faces down, at twice its size 1 m above, and mirrored aside, both also of a third lamp's group.
    let squares = Scene::light_meter()
        .set("groups", "lamp", json!({ "objects": [lamp(level_square([0.0; 3], 0.2, false), 3.0)] }))
        .whole(
            "instances",
            json!([
                { "group": "lamp", "transform": [{ "scale": 2 }, { "translate_m": [0, 0, 1] }] },
                { "group": "lamp", "transform": [{ "scale": [-1, 2, 1] }, { "translate_m": [1.5, 0.5, 1.2] }] },
            ]),
        );
    let long = |[x, y, z]: Vec3| {
        lambert_polygon(
            &[[x - 0.2, y - 0.4, z], [x + 0.2, y - 0.4, z], [x + 0.2, y + 0.4, z], [x - 0.2, y + 0.4, z]],
            UP,
        )
    };
    let value = shown(3.0 * (polygon([0.0, 0.0, 1.0], 0.4) + long([1.5, 0.5, 1.2])));
    let turned = [
        json!([{ "rotate": { "axis": [0, 1, 0], "angle_deg": 30 } }, { "translate_m": [0.3, 0.4, 2] }]),
        json!([{ "scale": 0.5 }, { "translate_m": [-1, 0.2, 1.5] }]),
    ];
    let balls = Scene::light_meter()
        .set("groups", "ball", json!({ "objects": [lamp(sphere([0.2, 0.0, 0.0], 0.5), 2.0)] }))
        .set("groups", "balls", json!({ "instances": [{ "group": "ball", "transforms": turned }] }))
        .whole(
            "instances",
            json!([{ "group": "balls", "transform": [{ "matrix": [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.1]] }] }]),
        );
    let ball = |[x, y, z]: Vec3, radius: f64| {
        let distance = (x * x + y * y + z * z).sqrt();
        sphere_irradiance(radius, distance, (z / distance).acos())
    };
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let first = [-(0.2 * cos + 0.3), 0.4, -0.2 * sin + 2.1];
    let second = [-(0.1 - 1.0), 0.2, 1.6];
    let of_balls = 2.0 * (ball(first, 0.5) + ball(second, 0.25));
    vec![
        Truth::new("square-lamps-of-instances", &squares, value, "(ρ/π) L Σ of Lambert's polygons of the placed squares")
            .because("Placed lamps shine where they are placed, as large as they are there, from the side that was their front.")
            .confirmed("quadrature over both rectangles", 1e-6, move || {
                let part = |[x, y, z]: Vec3, a: f64, b: f64| {
                    let (u, v) = ([2.0 * a, 0.0, 0.0], [0.0, 2.0 * b, 0.0]);
                    super::irradiance::parallelogram_by_quadrature([x - a, y - b, z], u, v, [0.0; 3], UP)
                };
                shown(3.0 * (part([0.0, 0.0, 1.0], 0.4, 0.4) + part([1.5, 0.5, 1.2], 0.2, 0.4)))
            })
            .or_else("the mirrored lamp shines from its back", shown(3.0 * polygon([0.0, 0.0, 1.0], 0.4)))
            .or_else("lamps of their own size", shown(3.0 * (polygon([0.0, 0.0, 1.0], 0.2) + polygon([1.5, 0.5, 1.2], 0.2))))
            .sees(0.01),
        Truth::new("ball-lamps-of-instances-in-instances", &balls, shown(of_balls), "(ρ/π) L Σ π(R/d)² cos β of the placed balls")
            .because("Placements act from within outward: each ball is turned, scaled and moved, and all are mirrored and lifted.")
            .or_else("not mirrored", shown(2.0 * (ball([0.2 * cos + 0.3, 0.4, -0.2 * sin + 2.1], 0.5) + ball([-0.9, 0.2, 1.6], 0.25))) + 1e-2)
            .or_else("the first of two placements only", shown(2.0 * ball(first, 0.5)))
            .sees(0.01),
    ]
}

/// Forty balls whose power spans eight orders of magnitude; the nearest is dim and gives as much as the brightest, far away.
fn unequal() -> Vec<Truth> {
    let ball = |k: u32| {
        // A spiral over the upper directions, so that none hides another: they lie 0.2 and more apart, and none is larger than 0.06.
        let (share, angle) = (f64::from((17 * k) % 40) / 39.0, 2.399_963 * f64::from(k));
        let distance = 0.5 * 60.0_f64.powf(share);
        let tilt = (0.98 - 0.58 * f64::from(k) / 39.0).acos();
        let radius = 0.01 * distance * f64::from(1 + k % 3);
        let centre = [distance * tilt.sin() * angle.cos(), distance * tilt.sin() * angle.sin(), distance * tilt.cos()];
        // As much irradiance from each, times one of four factors.
        let radiance = 0.03 * (distance / radius).powi(2) * [1.0, 0.1, 3.0, 0.01][k as usize % 4];
        (centre, radius, distance, tilt, radiance)
    };
    let irradiance = |chosen: fn(u32) -> bool| -> f64 {
        (0..40)
            .filter(|&k| chosen(k))
            .map(|k| {
                let (_, radius, distance, tilt, radiance) = ball(k);
                radiance * sphere_irradiance(radius, distance, tilt)
            })
            .sum()
    };
    let value = shown(irradiance(|_| true));
    ["auto", "power", "tree"]
        .map(|how| {
            let mut scene = Scene::light_meter().set("integrator", "light_selection", json!(how)).spp(8192);
            for k in 0..40 {
                let (centre, radius, _, _, radiance) = ball(k);
                scene = scene.lamp(sphere(centre, radius), black(), radiance, "front");
            }
            Truth::new(format!("forty-unequal-lamps-by-{how}"), &scene, value, "(ρ/π) Σ Lᵢ π(R/d)² cos β")
                .because("Irradiances add up, whichever lamp a shadow ray is sent to; near ones are dim and far ones bright.")
                    .or_else("the nearest three left out", shown(irradiance(|k| (17 * k) % 40 > 2)))
                .or_else("the farthest three left out", shown(irradiance(|k| (17 * k) % 40 < 37)))
                .sees(0.02)
        })
        .into()
}

/// Balls that light a plate under a roof, and a sun with hundreds of times their power above it. What shadow rays send to the sun brings nothing.
fn under_a_roof() -> Vec<Truth> {
    const RADIUS_M: f64 = 0.4;
    const SUN: f64 = 300.0;
    let make = |name: &str, centres: Vec<Vec3>| {
        let sun_and_roof = Scene::light_meter()
            .directional_light([0.0, 0.0, -1.0], SUN)
            .object(level_square([0.0, 0.0, 3.0], 2.0, false), black())
            .spp(1 << 10);
        let lamp = |scene: Scene, &centre: &Vec3| scene.lamp(sphere(centre, RADIUS_M), black(), 1.0, "front");
        let irradiance: f64 = centres
            .iter()
            .map(|[x, y, z]| {
                let distance = (x * x + y * y + z * z).sqrt();
                sphere_irradiance(RADIUS_M, distance, (z / distance).acos())
            })
            .sum();
        Truth::new(name, &centres.iter().fold(sun_and_roof, lamp), shown(irradiance), "(ρ/π) Σ L π(R/d)² cos β")
            .because("Irradiances add up. The roof keeps the sun from the plate, however bright it is.")
            .or_else("the sun shines through the roof", shown(irradiance + SUN))
            .or_else("each ball twice", shown(2.0 * irradiance))
            .or_else("dark", 0.0)
            .sees(0.01)
    };
    let ring = (0..12).map(|k| {
        let (sin, cos) = (f64::from(k) * PI / 6.0).sin_cos();
        [1.7 * cos, 1.7 * sin, 1.0]
    });
    vec![
        make("ball-lamp-under-a-roof-in-the-sun", vec![[0.3, 0.0, 1.2]]),
        make("twelve-ball-lamps-under-a-roof-in-the-sun", ring.collect()),
    ]
}

/// One picture by every way of rendering it that a scene can ask for.
fn ways() -> Vec<Truth> {
    // A wall of the integrating sphere: half of the light comes directly, half by way of the wall.
    let room = || {
        Scene::pinhole([0.3, 0.1, 0.2], [0.9, 0.3, 0.6], 90.0)
            .object(sphere([0.0; 3], 1.0), lambert(0.5))
            .lamp(sphere([0.0; 3], 0.1), black(), 100.0 / PI, "front")
            .film(32, 32)
            .spp(512)
    };
    // Radiant exitance 100 of a ball of radius 0.1 falls on the wall as 1; of light from the wall the ball takes the share (r/R)².
    let (rho, taken) = (0.5, 0.01);
    let one = rho / PI;
    let value = one / (1.0 - rho * (1.0 - taken));
    [
        ("path_reuse", json!("2x2")),
        ("path_reuse", json!("4x2")),
        ("path_reuse", json!("4x4")),
        ("path_reuse", json!("none")),
        ("sampler", json!("independent")),
        ("sampler", json!("sobol")),
        ("roulette", json!(false)),
        ("roulette", json!(true)),
        ("light_selection", json!("tree")),
        ("light_selection", json!("power")),
    ]
    .into_iter()
    .map(|(key, word)| {
        let name = format!("lamp-in-a-sphere-by-{}-{}", key.replace('_', "-"), word.to_string().trim_matches('"'));
        // The camera looks away from the lamp.
        let scene = room().set("integrator", key, word);
        Truth::new(name, &scene, value, "(ρ/π)/(1 − ρ(1 − (r/R)²))")
            .because(
                "A lamp in the middle lights the wall of a sphere evenly, and two places of the wall exchange the same light wherever they \
                 lie; of light from the wall the black ball in the middle takes (r/R)². How the picture is rendered changes nothing.",
            )
            .confirmed("adding up bounce by bounce", 1e-12, move || {
                (0..200).map(|k| one * (rho * (1.0 - taken)).powi(k)).sum()
            })
            .or_else("direct light only", one)
            .or_else("the ball takes nothing", one / (1.0 - rho))
            .sees(0.004)
    })
    .collect()
}

/// Paths whose throughput falls to a thousandth before they find light.
fn dark() -> Vec<Truth> {
    // A ceiling lit from below by parallel light, which gives the plate under it its light: albedo 0.01, and a lamp of a hundred.
    let (side, rho) = (1.0, 0.01);
    let slant = 45.0_f64.to_radians();
    let ceiling = Scene::light_meter()
        .object(level_square([0.0, 0.0, 1.0], side, false), lambert(rho))
        .directional_light([slant.sin(), 0.0, slant.cos()], 100.0 * PI / slant.cos());
    let value = shown(polygon([0.0, 0.0, 1.0], side));
    let mut list = Vec::new();
    for (name, roulette) in [("dark-ceiling", true), ("dark-ceiling-without-roulette", false)] {
        list.push(
            Truth::new(name, &ceiling.clone().set("integrator", "roulette", json!(roulette)).spp(4096), value, "(ρ/π) L E/L, L = 0.01 · 100")
                .because("A Lambert ceiling of albedo 0.01 in parallel light of irradiance 100π shows 1, and lights the plate below it as a lamp.")
                .confirmed("quadrature over the ceiling", 1e-6, move || {
                    let (u, v) = ([2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
                    shown(super::irradiance::parallelogram_by_quadrature([-1.0, -1.0, 1.0], u, v, [0.0; 3], UP))
                })
                .or_else("paths of so little throughput ended", 0.0)
                .sees(0.02),
        );
    }
    // Three mirrors of 0.1 to and fro between two levels, before a lamp of a thousand.
    let mirrors = (0..3_i32).fold(Scene::orthographic([-0.5, 0.0, 0.5], [0.0; 3], 0.1), |scene, k| {
        let x = f64::from(k);
        let z = if k % 2 == 0 { 0.0 } else { 1.0 };
        scene.object(level_square([x, 0.0, z], 0.3, k % 2 == 0), json!({ "type": "mirror", "reflectance": 0.1 }))
    });
    let scene = mirrors.lamp(level_square([3.0, 0.0, 1.0], 0.3, false), black(), 1e3, "both");
    let scene = scene.film(16, 16).spp(16384).set("integrator", "roulette", json!(true));
    list.push(
        Truth::new("lamp-by-three-dark-mirrors", &scene, 1.0, "0.1³ · 10³")
            .because("Three mirrors of reflectance 0.1 pass on a thousandth of a lamp of radiance 1000.")
            .or_else("paths of so little throughput ended", 0.0)
            .or_else("one mirror of three without loss", 10.0)
            .sees(0.2),
    );
    list
}
