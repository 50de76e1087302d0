//! How often each light is chosen for a shadow ray, as a trial before the picture learns it.

use super::common::rendering::{mean_y, parse, render};
use etalon_scene::{LightSelection, Scene};
use etalon_transport::{Control, Film, Prepared, Study, prepare, prepare_frame};

/// A floor and a ball of glass under a ball lamp, and a sun of hundreds of times its power, with a roof below the sun or not. The camera turns.
fn scene(roof: &str, seed: u64) -> Scene {
    with_sun(300.0, roof, seed)
}

fn with_sun(irradiance: f64, roof: &str, seed: u64) -> Scene {
    parse(&format!(
        r#"{{ "etalon": 1,
        "camera": {{ "type": "perspective", "position_m": [0, -2, 1], "look_at_m": [0, 0, 0], "vertical_fov_deg": 50, "shutter_s": [0, 0.02],
            "keyframes": [{{ "time_s": 0 }}, {{ "time_s": 2, "transform": [{{ "rotate": {{ "axis": [0, 0, 1], "angle_deg": 60 }} }}] }}] }},
        "film": {{ "width": 32, "height": 32 }},
        "integrator": {{ "spp": 16, "seed": {seed} }},
        "materials": {{ "grey": {{ "type": "lambert", "reflectance": 0.5 }}, "black": {{ "type": "black" }} }},
        "lights": [{{ "type": "directional", "direction": [0, 0, -1], "irradiance": {irradiance} }}],
        "objects": [
            {{ "shape": {{ "type": "parallelogram", "origin_m": [-2, -2, 0], "u_m": [4, 0, 0], "v_m": [0, 4, 0] }}, "material": "grey" }},
            {{ "shape": {{ "type": "sphere", "center_m": [0.3, 0, 1.2], "radius_m": 0.3 }}, "material": "black", "emission": {{ "radiance": 1 }} }},
            {{ "shape": {{ "type": "sphere", "center_m": [-0.5, 0, 0.3], "radius_m": 0.3 }}, "material": {{ "type": "dielectric", "interior": 1.5 }} }}{roof}
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
    // In the open power is right.
    assert_eq!(learned(&scene("", 1)), None);
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

/// Trials of one frame must not depend on what those of another have decided. The roof leaves some of the floor in a weak sun, so both lights are
/// worth shadow rays. In the first frame most directions at diffuse surfaces aim at the ball. In the others none do.
#[test]
fn what_is_learned_for_a_frame_is_what_it_learns_alone() {
    let film =
        |prepared: &Prepared| -> Film { prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap() };
    let mut scene = with_sun(1.0, &ROOF.replace("[0, 18, 0]", "[0, 10.6, 0]"), 1);
    let (mut earlier, mut learned) = (None, Vec::new());
    for opens_s in [0.0, 0.7, 1.4] {
        scene.set_shutter([opens_s, opens_s + 0.02]);
        let frame = prepare_frame(&scene, &Study::default(), earlier.take()).unwrap();
        let alone = prepare(&scene).unwrap();
        assert_eq!(frame.learned_light_shares(), alone.learned_light_shares(), "at {opens_s} s");
        assert!(film(&frame).pixels().eq(film(&alone).pixels()), "at {opens_s} s");
        learned.push(frame.learned_light_shares());
        earlier = Some(frame);
    }
    let between = |shares: &Option<Vec<f64>>| shares.as_ref().is_some_and(|shares| (0.2..0.8).contains(&shares[0]));
    assert!(learned.iter().all(between), "{learned:?}");
}
