//! Light adds up: a picture with two lights is the sum of the pictures with one of them, whatever the lights are.

use crate::common::chance::made;
use etalon_scene::Scene;
use etalon_transport::{Control, prepare};
use serde_json::{Value, json};

/// What shines.
#[derive(Clone)]
enum Shines {
    Light(Value),
    /// A body, which is dark where only the other light shines.
    Body(Value),
}

fn kinds() -> Vec<(&'static str, Shines)> {
    let sun = json!([0.5, 0.6, 0.3]);
    vec![
        ("constant sky", Shines::Light(json!({"type": "environment", "radiance": 0.5}))),
        ("image", Shines::Light(json!({"type": "environment", "name": "image 10", "radiance": 1}))),
        ("another image", Shines::Light(json!({"type": "environment", "name": "image 13", "radiance": 1}))),
        (
            "standard sky",
            Shines::Light(
                json!({"type": "environment", "sky": {"cie_type": 12, "zenith_radiance": 0.4, "sun_direction": sun}}),
            ),
        ),
        (
            "daylight",
            Shines::Light(
                json!({"type": "environment", "daylight": {"turbidity": 3, "scale": 3, "sun_direction": sun}}),
            ),
        ),
        ("point", Shines::Light(json!({"type": "point", "position_m": [0.4, 1.1, 0.8], "intensity": 1}))),
        (
            "slide",
            Shines::Light(
                json!({"type": "point", "position_m": [-0.3, 1, 0.9], "intensity": 2, "slide": {"direction": [0.3, -1, -0.9], "horizontal_fov_deg": 70,
                    "image": {"type": "checker", "first": [1, 0.3, 0.1], "second": 0.4, "uv_scale": [1.5, 1.5]}}}),
            ),
        ),
        ("parallel", Shines::Light(json!({"type": "directional", "direction": [-0.3, -1, -0.2], "irradiance": 1}))),
        ("ball", Shines::Body(json!({"type": "sphere", "center_m": [-0.5, 0.9, 0.2], "radius_m": 0.2}))),
        (
            "disk",
            Shines::Body(json!({"type": "disk", "center_m": [0.5, 0.8, -0.3], "normal": [0, -1, 0], "radius_m": 0.3})),
        ),
        (
            "mesh",
            Shines::Body(
                json!({"type": "mesh", "vertices_m": [[-0.4, 1, -0.9], [0.4, 1, -0.9], [0.4, 1, -0.5], [-0.4, 1, -0.5]], "triangles": [[0, 1, 2], [0, 2, 3]]}),
            ),
        ),
    ]
}

/// A floor beneath all bodies, of which those shine that are in `on`, as the other kinds in it do.
fn scene(kinds: &[(&str, Shines)], on: &[usize], sampling: &str) -> Scene {
    let mut objects = vec![
        json!({"material": "floor", "shape": {"type": "parallelogram", "origin_m": [-1, 0, 1], "u_m": [2, 0, 0], "v_m": [0, 0, -2]}}),
    ];
    let mut lights = Vec::new();
    for (index, (_, shines)) in kinds.iter().enumerate() {
        match shines {
            Shines::Body(shape) => {
                let mut body = json!({"material": "black", "shape": shape});
                if on.contains(&index) {
                    body["emission"] = json!({"radiance": 8, "sides": "both"});
                }
                objects.push(body);
            }
            _ if !on.contains(&index) => {}
            Shines::Light(light) => lights.push(light.clone()),
        }
    }
    made(&json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0.5, 2], "look_at_m": [0, 0, 0], "vertical_fov_deg": 30},
        "film": {"width": 12, "height": 8},
        "materials": {"floor": {"type": "lambert", "reflectance": 0.6}, "black": {"type": "black"}},
        "objects": objects,
        "lights": lights,
        "integrator": {"spp": 256, "light_sampling": sampling}
    }))
}

/// Mean luminance of the picture, and its variance by the scatter of replicates.
fn mean(scene: &Scene) -> (f64, f64) {
    let prepared = prepare(scene).unwrap();
    let film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
    let pixels = film.pixels().count() as f64;
    let mean = film.pixels().map(|pixel| pixel.xyz()[1]).sum::<f64>() / pixels;
    let variance = film.pixels().map(|pixel| pixel.variance(|xyz| xyz).unwrap().0[1]).sum::<f64>();
    (mean, variance / (pixels * pixels))
}

/// 55 pairs in two ways. By chance one of them has |z| > 5 in one run of 1.6 · 10⁴. A fifth of the lesser light is more than 6 standard errors in
/// every pair. A light counted twice is all of it.
#[test]
fn the_picture_of_two_lights_is_the_sum_of_theirs() {
    let kinds = kinds();
    for sampling in ["mis", "light"] {
        let alone: Vec<_> = (0..kinds.len()).map(|k| mean(&scene(&kinds, &[k], sampling))).collect();
        for first in 0..kinds.len() {
            for second in first + 1..kinds.len() {
                let (both, variance) = mean(&scene(&kinds, &[first, second], sampling));
                let (sum, of_sum) = (alone[first].0 + alone[second].0, alone[first].1 + alone[second].1);
                // Rounding, where there is no noise.
                let error = (variance + of_sum).sqrt().max(1e-9 * sum);
                let names = [kinds[first].0, kinds[second].0];
                let z = (both - sum) / error;
                assert!(z.abs() < 5.0, "{names:?} by {sampling}: {both} is not {sum}, z = {z}");
                let lesser = alone[first].0.min(alone[second].0);
                assert!(
                    6.0 * error < 0.2 * lesser,
                    "{names:?} by {sampling}: {error} is too much noise beside {lesser}"
                );
            }
        }
    }
}
