//! Surfaces that let light pass are passed exactly: a ray that goes on through one is the ray that it was.

use etalon_transport::{Film, Study};
use serde_json::{Value, json};

use crate::common::rendering::{mean_y, parse, render};

/// A glass with water on a table, under a lamp and a sky: nested solids, mirrors, rough and diffuse surfaces, absorption.
fn scene(ghosts: &[Value]) -> Value {
    let mut objects = vec![
        json!({"material": "wood", "shape": {"type": "parallelogram", "origin_m": [-3, 0, 3], "u_m": [6, 0, 0], "v_m": [0, 0, -6]}}),
        json!({"material": "glass", "shape": {"type": "cylinder", "start_m": [0, 0, 0], "end_m": [0, 1.2, 0], "radius_m": 0.5, "capped": true}}),
        json!({"material": "water", "shape": {"type": "cylinder", "start_m": [0, 0.1, 0], "end_m": [0, 1.0, 0], "radius_m": 0.45, "capped": true}}),
        json!({"material": "gold", "shape": {"type": "sphere", "center_m": [1.2, 0.4, 0.3], "radius_m": 0.4}}),
        json!({
            "material": "black", "shape": {"type": "disk", "center_m": [0.5, 3, 1], "normal": [0, -1, 0], "radius_m": 0.5},
            "emission": {"radiance": 20}
        }),
    ];
    objects.extend_from_slice(ghosts);
    json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0.3, 1.5, 4], "look_at_m": [0.2, 0.5, 0], "vertical_fov_deg": 40},
        "film": {"width": 32, "height": 24},
        "materials": {
            "wood": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.6, 0.3, 0.2]}},
            "glass": {"type": "dielectric", "interior": 1.5, "priority": 0},
            "water": {"type": "dielectric", "interior": 1.33, "priority": 1, "absorption_per_m": 0.7},
            "gold": {"type": "conductor", "metal": "Au", "alpha": 0.3},
            "black": {"type": "black"}
        },
        "objects": objects,
        "lights": [{"type": "environment", "radiance": 0.5}],
        "integrator": {"spp": 16, "max_depth": 12}
    })
}

fn film(ghosts: &[Value]) -> Film {
    let film = render(&parse(&scene(ghosts).to_string()), &Study::default());
    assert_eq!((film.counters.lost_media, film.counters.nonfinite), (0, 0));
    assert!(mean_y(&film) > 0.1, "a black picture would show nothing");
    film
}

/// A shape that is not there: all light passes it.
fn ghost(shape: Value) -> Value {
    json!({"material": "wood", "opacity": 0, "shape": shape})
}

#[test]
fn what_lets_all_light_pass_changes_no_path() {
    // Before the camera, around the glass, across the water, around the lamp; none beyond the table, whose size sets the frame.
    let ghosts = [
        ghost(json!({"type": "sphere", "center_m": [0.2, 0.9, 2.4], "radius_m": 0.4})),
        ghost(
            json!({"type": "cylinder", "start_m": [0, 0.05, 0], "end_m": [0, 1.4, 0], "radius_m": 0.6, "capped": false}),
        ),
        ghost(json!({"type": "parallelogram", "origin_m": [-1, 0.6, 1], "u_m": [2, 0, 0], "v_m": [0, 0.1, -2]})),
        ghost(json!({"type": "box", "min_m": [-0.2, 2.8, 0.2], "max_m": [1.2, 2.95, 1.8]})),
    ];
    let (without, with) = (film(&[]), film(&ghosts));
    // Absorption over two parts of a way is the product of two exponentials: nothing else is rounded otherwise.
    let worst = without.xyz().zip(with.xyz()).map(|(a, b)| (b[1] / a[1] - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-13, "a pixel differs by {worst:e} of itself");
    // Where no such surface divides a way through the water, not a bit differs.
    let (without, with) = (film(&[]), film(&[ghosts[0].clone(), ghosts[3].clone()]));
    assert!(without.xyz().eq(with.xyz()));
}

#[test]
fn what_lets_all_light_pass_may_lie_in_any_surface() {
    let ghosts = [
        // In the table, in the lamp, in the glass's wall and base, in the water's, around the metal.
        ghost(json!({"type": "parallelogram", "origin_m": [-2, 0, 2], "u_m": [4, 0, 0], "v_m": [0, 0, -4]})),
        ghost(json!({"type": "disk", "center_m": [0.5, 3, 1], "normal": [0, 1, 0], "radius_m": 0.8})),
        ghost(json!({"type": "cylinder", "start_m": [0, 0, 0], "end_m": [0, 1.2, 0], "radius_m": 0.5, "capped": true})),
        ghost(
            json!({"type": "cylinder", "start_m": [0, 0.1, 0], "end_m": [0, 1.0, 0], "radius_m": 0.45, "capped": true}),
        ),
        ghost(json!({"type": "sphere", "center_m": [1.2, 0.4, 0.3], "radius_m": 0.4})),
    ];
    let without = film(&[]);
    let mut reversed = ghosts.clone();
    reversed.reverse();
    for ghosts in [&ghosts, &reversed] {
        let with = film(ghosts);
        // Rays leave surfaces that coincide with others from a little farther off, so paths differ in their last digits, and at an
        // edge one may take another turn.
        let differs = |(a, b): &([f64; 3], [f64; 3])| (a[1] - b[1]).abs() > 1e-6 * a[1].max(b[1]);
        let different = without.xyz().zip(with.xyz()).filter(differs).count();
        assert!(different <= 8, "{different} of {} pixels differ", 32 * 24);
    }
}
