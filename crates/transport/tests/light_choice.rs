//! How often each light is chosen for a shadow ray, as a trial before the picture learns it.

use super::common::rendering::{mean_y, parse, render};
use etalon_scene::{LightSelection, Scene};
use etalon_transport::{Study, prepare};

/// A floor under a ball lamp and a sun of hundreds of times its power, with a roof between the two or not.
fn scene(roof: &str, seed: u64) -> Scene {
    parse(&format!(
        r#"{{ "etalon": 1,
        "camera": {{ "type": "perspective", "position_m": [0, -2, 1], "look_at_m": [0, 0, 0], "vertical_fov_deg": 50 }},
        "film": {{ "width": 32, "height": 32 }},
        "integrator": {{ "spp": 16, "seed": {seed} }},
        "materials": {{ "grey": {{ "type": "lambert", "reflectance": 0.5 }}, "black": {{ "type": "black" }} }},
        "lights": [{{ "type": "directional", "direction": [0, 0, -1], "irradiance": 300 }}],
        "objects": [
            {{ "shape": {{ "type": "parallelogram", "origin_m": [-2, -2, 0], "u_m": [4, 0, 0], "v_m": [0, 4, 0] }}, "material": "grey" }},
            {{ "shape": {{ "type": "sphere", "center_m": [0.3, 0, 1.2], "radius_m": 0.3 }}, "material": "black", "emission": {{ "radiance": 1 }} }}{roof}
        ] }}"#
    ))
}

const ROOF: &str = r#",
    { "shape": { "type": "parallelogram", "origin_m": [-9, -9, 3], "u_m": [18, 0, 0], "v_m": [0, 18, 0] }, "material": "black" }"#;

fn learned(scene: &Scene) -> Option<Vec<f64>> {
    prepare(scene).unwrap().learned_light_shares()
}

#[test]
fn a_light_that_the_roof_hides_gets_few_shadow_rays() {
    let shares = learned(&scene(ROOF, 1)).expect("power sends most to the sun");
    // The lamp comes first. A tenth stays by power.
    assert!(shares.len() == 2 && shares[0] > 0.9, "{shares:?}");
    assert_eq!(learned(&scene(ROOF, 2)), Some(shares), "another seed");
    let in_the_open = learned(&scene("", 1));
    assert!(in_the_open.as_ref().is_none_or(|shares| shares[1] > 0.9), "{in_the_open:?}");
    let by_power = |mut scene: Scene| {
        scene.integrator.light_selection = LightSelection::Power;
        scene
    };
    assert_eq!(learned(&by_power(scene(ROOF, 1))), None);

    // The same light with less noise. By power one ray in twenty goes to the lamp, which is a noise of 3 % at most of 16,384 samples.
    let squares = |scene: &dyn Fn(u64) -> Scene| {
        let [a, b] = [1, 2].map(|seed| render(&scene(seed), &Study::default()));
        let square: f64 = a.xyz().zip(b.xyz()).map(|(a, b)| (a[1] - b[1]).powi(2)).sum();
        (square, 0.5 * (mean_y(&a) + mean_y(&b)))
    };
    let (learned_square, learned_mean) = squares(&|seed| scene(ROOF, seed));
    let (square, mean) = squares(&|seed| by_power(scene(ROOF, seed)));
    assert!(learned_square < 0.3 * square, "{learned_square} is not much less than {square}");
    assert!((learned_mean / mean - 1.0).abs() < 0.1, "{learned_mean} and {mean}");
}
