//! Normal and bump maps that lose light: what the changed normal sends through the surface is not mirrored back, and grazing light may be
//! dimmed. A square shows one changed normal everywhere.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Truth,
    scene::{Scene, grey_hdr, parallelogram, radiance_hdr},
};
use crate::vector::{Vec3, cross, dot, frame, length, normalize, scale};

const ALBEDO: f64 = 0.8;
/// Toward the light, along no axis and no diagonal, and grazing.
const TO_LIGHT: Vec3 = [0.6, -0.2, 0.3];
/// Along u, along v and outward.
const MAPPED: Vec3 = [1.5, -0.75, 0.75];
const SLOPE: f64 = 1.5;

pub(super) fn truths() -> Vec<Truth> {
    // Parts along the surface are those of (½, −¼, ¾), times 3.
    let normals = || json!({ "normal_map": { "file": "tilted-normal.hdr", "strength": 3 } });
    // Grows by a quarter from texel to texel along u, each a quarter of the square.
    let heights = || json!({ "bump_map": { "file": "ramp-along-u.hdr", "height_m": -SLOPE, "wrap": "clamp" } });
    let sloped = [SLOPE, 0.0, 1.0];
    vec![
        lost("normal-map-that-loses-light", &normals(), MAPPED),
        lost("bump-map-that-loses-light", &heights(), sloped),
        shadowed("normal-map-with-shadows", &normals(), MAPPED),
        shadowed("bump-map-with-shadows", &heights(), sloped),
    ]
}

/// A white square, seen from above, under a map with one more key.
fn scene(map: &Value, terminator: &str) -> Scene {
    let square = parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let mut object = json!({ "shape": square, "material": { "type": "lambert", "reflectance": ALBEDO } });
    for (key, value) in map.as_object().into_iter().flatten() {
        object[key] = value.clone();
        object[key]["terminator"] = json!(terminator);
    }
    let scene = Scene::orthographic([0.5, 0.5, 2.0], [0.5, 0.5, 0.0], 0.2).thing(object).film(16, 16);
    match map.get("normal_map") {
        Some(_) => scene.file("tilted-normal.hdr", radiance_hdr(1, &[[0.75, 0.375, 0.875]])),
        None => scene.file("ramp-along-u.hdr", grey_hdr(4, &[0.25, 0.5, 0.75, 1.0])),
    }
}

fn lost(name: &str, map: &Value, normal: Vec3) -> Truth {
    let n = normalize(normal);
    let again = move || {
        // Over directions around the changed normal, by what is above the square.
        let steps = 1500;
        let (s, t) = frame(n);
        let step = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let all = (0..steps).flat_map(|i| (0..steps).map(move |j| (step(i), 2.0 * PI * step(j))));
        let above = all.filter(|&(squared, azimuth)| {
            let (sin, cos) = (squared.sqrt(), (1.0 - squared).sqrt());
            sin * (azimuth.cos() * s[2] + azimuth.sin() * t[2]) + cos * n[2] > 0.0
        });
        ALBEDO * above.count() as f64 / f64::from(steps).powi(2)
    };
    Truth::new(name, &scene(map, "lost").sky(1.0).spp(256), ALBEDO * (1.0 + n[2]) / 2.0, "ρ (1 + cos β)/2")
        .because(
            "A Lambert surface whose normal is turned by β scatters light of a sky that is above both the surface and the plane across that \
             normal. A plane that is tilted by β receives this share of an even sky.",
        )
        .confirmed("directions around the changed normal, counted above the surface", 1e-3, again)
        .or_else("light mirrored back", ALBEDO)
        .or_else("light lost twice", ALBEDO * n[2])
        .sees(3e-3)
}

fn shadowed(name: &str, map: &Value, normal: Vec3) -> Truth {
    let (n, l) = (normalize(normal), normalize(TO_LIGHT));
    let plain = ALBEDO * dot(n, l);
    let tan_squared = |v: Vec3| (v[0] * v[0] + v[1] * v[1]) / (v[2] * v[2]);
    let dimmed = |a: f64, tan: f64| plain * 2.0 / (1.0 + (1.0 + a * tan).sqrt());
    let value = dimmed((tan_squared(n) / 8.0).min(1.0), tan_squared(l));
    let again = move || {
        // By the angles: a = tan²β/8, and the smaller of the two roots of G²·a tan²θ + 4G − 4 = 0.
        let up = [0.0, 0.0, 1.0];
        let angle = |v: Vec3| length(cross(v, up)).atan2(dot(v, up));
        let (beta, theta) = (angle(normal), angle(TO_LIGHT));
        let b = (beta.tan().powi(2) / 8.0).min(1.0) * theta.tan().powi(2);
        let share = ((16.0 + 16.0 * b).sqrt() - 4.0) / (2.0 * b);
        ALBEDO * length(cross(normal, TO_LIGHT)).atan2(dot(normal, TO_LIGHT)).cos() * share
    };
    let scene = scene(map, "shadowed").directional_light(scale(-1.0, l), PI).spp(64);
    Truth::new(name, &scene, value, "ρ n·l · 2/(1 + √(1 + a tan²θ)), a = min(tan²β/8, 1)")
        .because(
            "A Lambert surface scatters around its changed normal n: in parallel light of irradiance π from l it shows ρ n·l. Facets of the \
             width √a, whose mean normal is that of the surface, hide light that comes at θ to it (Estevez, Lecocq & Stein 2019).",
        )
        .confirmed("the angles, and the root of an equation of the second degree", 1e-12, again)
        .or_else("not dimmed", plain)
        .or_else("not an eighth", dimmed(tan_squared(n).min(1.0), tan_squared(l)))
        .sees(1e-3)
}
