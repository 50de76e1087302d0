//! What moves while the shutter is open, against closed forms and against what stands still.

use etalon_oracle::truths::{Claim, truths};
use etalon_scene::{NamedFile, SamplerKind, Scene, parse_with_files};
use etalon_transport::{EffectName, Study, prepare_study};
use serde_json::{Value, json};

use crate::common::rendering::{mean_y, parse, render};

fn without() -> Study {
    Study { without: vec![EffectName::Motion], ..Study::default() }
}

#[test]
fn truths_hold_and_reject_what_stands_still() {
    let moving: Vec<_> = truths().into_iter().filter(|truth| truth.claims.contains(&Claim::Motion)).collect();
    assert!(moving.len() >= 8);
    for truth in moving {
        let files: Vec<_> =
            truth.files.iter().map(|file| NamedFile { name: file.name.clone(), bytes: file.bytes.clone() }).collect();
        let mut scene = parse_with_files(&truth.scene, "test", &files, None).unwrap_or_else(|e| panic!("{e}")).scene;
        // The same number of paths whatever the film: 16 a pixel of the usual one, 2¹⁴ in all.
        scene.integrator.spp = (1 << 14) / (scene.film.width * scene.film.height);
        let film = render(&scene, &Study::default());
        // The worst of them, a lamp found by chance, scatters by (1/√p)/128 = 2.5 % at most if points were independent, and
        // they are stratified.
        let error = (mean_y(&film) / truth.value() - 1.0).abs();
        assert!(error < 0.04, "{}: {} is not {}", truth.name, mean_y(&film), truth.value());
        assert_eq!(film.counters.nonfinite, 0, "{}", truth.name);
        assert_eq!(film.counters.time_draws, film.counters.paths);
        let error = (mean_y(&render(&scene, &without())) / truth.value() - 1.0).abs();
        // Of two lamps that take turns, half is seen either way: that truth is about wavelengths at each time.
        let take_turns = truth.claims.contains(&Claim::PhotometricSensor);
        assert!(error > 0.08 || take_turns, "{}: the mutant that stands still is not seen", truth.name);
    }
}

/// A room of things of all kinds, some of them placed by `placed`; a lamp among them.
fn room(placed: &Value, shutter_s: [f64; 2]) -> Scene {
    let lambert = |reflectance: f64| json!({"type": "lambert", "reflectance": reflectance});
    let mut instance = json!({"name": "thing", "group": "things"});
    for (key, value) in placed.as_object().unwrap() {
        instance[key] = value.clone();
    }
    parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0.5, 0], "vertical_fov_deg": 40,
                "shutter_s": shutter_s},
            "film": {"width": 16, "height": 12},
            "objects": [
                {"shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 3}, "material": lambert(0.6)},
                {"shape": {"type": "parallelogram", "origin_m": [-1, 3, -1], "u_m": [1, 0, 0], "v_m": [0, 0, 1]},
                    "material": lambert(0.0), "emission": {"radiance": 4}}
            ],
            "groups": {"things": {"objects": [
                {"shape": {"type": "sphere", "center_m": [0, 0.4, 0], "radius_m": 0.4},
                    "material": {"type": "dielectric", "interior": "N-BK7"}},
                {"shape": {"type": "box", "min_m": [0.5, 0, 0], "max_m": [0.8, 0.6, 0.5]}, "material": lambert(0.4)},
                {"shape": {"type": "sphere", "center_m": [-0.6, 0.3, 0.3], "radius_m": 0.1}, "material": lambert(0.2),
                    "emission": {"radiance": 6}}
            ]}},
            "instances": [instance],
            "integrator": {"spp": 8}
        })
        .to_string(),
    )
}

fn placement() -> Value {
    json!([{"rotate": {"axis": [1, 2, 3], "angle_deg": 20}}, {"scale": 1.1}, {"translate_m": [0.1, 0.2, 0.3]}])
}

#[test]
fn keyframes_that_are_all_the_same_are_a_placement_that_stands_still_bit_for_bit() {
    let still = render(&room(&json!({"transform": placement()}), [0.0, 0.0]), &Study::default());
    let key = |time_s: f64| json!({"time_s": time_s, "transform": placement()});
    let other = json!({"time_s": 3, "transform": [{"translate_m": [5, 5, 5]}]});
    for (keyframes, shutter_s) in [
        (json!([key(0.0), key(1.0)]), [0.0, 1.0]),
        (json!([key(0.0), key(0.5), key(0.75)]), [0.1, 2.0]),
        (json!([key(0.2)]), [0.0, 1.0]),
        // What moves does so when the shutter is closed.
        (json!([key(0.0), key(1.0), other]), [0.25, 0.75]),
        (json!([key(0.0), key(1.0), other]), [0.0, 1.0]),
        // An instant.
        (json!([key(1.0), other]), [1.0, 1.0]),
    ] {
        let scene = room(&json!({"keyframes": keyframes}), shutter_s);
        let film = render(&scene, &Study::default());
        assert!(film.pixels().eq(still.pixels()), "{keyframes} {shutter_s:?}");
        assert_eq!(film.counters, still.counters);
        assert_eq!(film.counters.time_draws, 0);
        // Times that nothing needs change no bit.
        let forced = render(&scene, &Study { force: vec![EffectName::Motion], ..Study::default() });
        assert!(forced.pixels().eq(still.pixels()) && forced.counters.time_draws == forced.counters.paths);
    }
}

#[test]
fn without_motion_everything_stands_as_in_the_middle_of_the_time() {
    let steps = |x: f64| json!([{"scale": 1.25}, {"translate_m": [x, 0.25, 0.5]}]);
    let keyframes = json!([{"time_s": 0, "transform": steps(-0.5)}, {"time_s": 1, "transform": steps(1.0)}]);
    let moving = room(&json!({"keyframes": keyframes}), [0.5, 1.0]);
    // Three quarters of 1.5 m; exact in binary.
    let still = room(&json!({"transform": steps(0.625)}), [0.0, 0.0]);
    let (frozen, still) = (render(&moving, &without()), render(&still, &Study::default()));
    assert!(frozen.pixels().eq(still.pixels()));
    assert!(!render(&moving, &Study::default()).pixels().eq(still.pixels()));
    let plan = |study: &Study| prepare_study(&moving, study).unwrap().plan().clone();
    assert!(plan(&without()).approximations.iter().any(|text| text.starts_with("motion: everything stands still")));
    assert!(plan(&Study::default()).runs(EffectName::Motion));
}

/// Times are exact in binary, so that not a bit may differ.
#[test]
fn what_moves_while_the_shutter_is_open_does_not_depend_on_when_that_is() {
    let steps = |x: f64, angle_deg: f64| json!([{"rotate": {"axis": [1, 2, 3], "angle_deg": angle_deg}}, {"translate_m": [x, 0.25, 0.5]}]);
    let moving = |times_s: [f64; 3], shutter_s: [f64; 2]| {
        let [first, second, third] = times_s;
        let keyframes = json!([{"time_s": first, "transform": steps(-0.5, 0.0)}, {"time_s": second, "transform": steps(0.0, 20.0)},
            {"time_s": third, "transform": steps(0.75, 30.0)}]);
        render(&room(&json!({"keyframes": keyframes}), shutter_s), &Study::default())
    };
    let from_zero = moving([0.0, 0.25, 1.0], [0.0, 1.0]);
    for (open_s, long_s) in [(3.0, 1.0), (0.5, 0.125), (-2.0, 8.0)] {
        let times_s = [0.0, 0.25, 1.0].map(|t| open_s + t * long_s);
        assert!(moving(times_s, [open_s, open_s + long_s]).pixels().eq(from_zero.pixels()), "{open_s} s, {long_s} s");
    }
    assert!(!moving([0.0, 0.25, 1.0], [0.25, 1.0]).pixels().eq(from_zero.pixels()));
}

/// Along two sides of a triangle, one by one, while it turns by a right angle; the shutter opens in the middle of the first.
#[test]
fn plans_tell_how_far_things_go() {
    let steps = |x: f64, y: f64, angle_deg: f64| json!([{"rotate": {"axis": [0, 1, 0], "angle_deg": angle_deg}}, {"translate_m": [x, y, 0]}]);
    let keyframes = json!([{"time_s": 0, "transform": steps(1.0, 2.0, 0.0)}, {"time_s": 2, "transform": steps(7.0, 10.0, 60.0)},
        {"time_s": 3, "transform": steps(7.0, 6.0, 90.0)}]);
    let reason = |shutter_s: [f64; 2], keyframes: &Value| {
        let prepared = prepare_study(&room(&json!({"keyframes": keyframes}), shutter_s), &Study::default()).unwrap();
        let effects = &prepared.plan().effects;
        effects.iter().find(|effect| effect.name == EffectName::Motion).unwrap().because.clone()
    };
    assert_eq!(reason([1.0, 3.0], &keyframes), "\"thing\" turns by 60.000° and moves by 9.0000 m in 2 s");
    assert_eq!(reason([0.0, 2.0], &keyframes), "\"thing\" turns by 60.000° and moves by 10.0000 m in 2 s");
    let still = |x: f64, scale: f64| json!([{"scale": scale}, {"translate_m": [x, 0, 0]}]);
    let stretched = json!([{"time_s": 0, "transform": still(1.0, 1.0)}, {"time_s": 1, "transform": still(1.0, 2.0)}]);
    assert_eq!(reason([0.0, 1.0], &stretched), "\"thing\" is stretched in 1 s");
    let moved = json!([{"time_s": 0, "transform": still(1.0, 1.0)}, {"time_s": 1, "transform": still(3.0, 1.0)}]);
    assert_eq!(reason([0.0, 0.5], &moved), "\"thing\" moves by 1.0000 m in 0.5 s");
}

/// Things that shine move and turn, and a camera goes with them.
#[test]
fn a_camera_that_moves_with_all_that_it_sees_sees_it_stand_still() {
    let cameras = [
        json!({"type": "orthographic", "position_m": [1, 2, 5], "look_at_m": [0, 0.3, 0], "height_m": 2}),
        json!({"type": "perspective", "position_m": [1, 2, 5], "look_at_m": [0, 0.3, 0], "vertical_fov_deg": 30,
            "lens": {"radius_m": 0.1, "focus_distance_m": 5}}),
    ];
    let key = |time_s: f64, angle_deg: f64, to_m: [f64; 3]| {
        let steps = json!([{"rotate": {"axis": [1, 2, 3], "angle_deg": angle_deg}}, {"translate_m": to_m}]);
        json!({"time_s": time_s, "transform": steps})
    };
    let keyframes = json!([key(0.0, 10.0, [0.5, -0.25, 1.0]), key(1.0, 70.0, [-1.0, 2.0, 0.5])]);
    for camera in cameras {
        let scene = |moves: bool| {
            let (mut camera, mut all) = (camera.clone(), json!({"name": "all", "group": "all"}));
            camera["shutter_s"] = json!([0, 1]);
            if moves {
                (camera["keyframes"], all["keyframes"]) = (keyframes.clone(), keyframes.clone());
            }
            let shines = |shape: Value, radiance: f64| json!({"shape": shape, "material": {"type": "black"}, "emission": {"radiance": radiance, "sides": "both"}});
            parse(
                &json!({
                    "etalon": 1, "camera": camera, "film": {"width": 24, "height": 24},
                    "groups": {"all": {"objects": [
                        shines(json!({"type": "parallelogram", "origin_m": [-0.5, 0.1, 0], "u_m": [1, 0, 0], "v_m": [0, 0.8, 0.3]}), 1.0),
                        shines(json!({"type": "disk", "normal": [0, 1, 0], "radius_m": 0.9}), 3.0),
                        shines(json!({"type": "sphere", "center_m": [0.6, 0.5, 0.4], "radius_m": 0.2}), 10.0)
                    ]}},
                    "instances": [all],
                    "integrator": {"spp": 16}
                })
                .to_string(),
            )
        };
        let film = |moves: bool| render(&scene(moves), &Study::default());
        let (moving, still) = (film(true), film(false));
        assert!(moving.counters.time_draws > 0);
        // Rays of the same random numbers see the same, but for those that rounding leads past an edge.
        let pairs: Vec<_> = moving.xyz().zip(still.xyz()).map(|(a, b)| (a[1], b[1])).collect();
        let same = pairs.iter().filter(|(a, b)| (a - b).abs() <= 1e-6 * b).count();
        assert!(same as f64 > 0.97 * pairs.len() as f64, "{same} of {}", pairs.len());
        let [a, b] = [pairs.iter().map(|pair| pair.0).sum::<f64>(), pairs.iter().map(|pair| pair.1).sum()];
        assert!((a / b - 1.0).abs() < 1e-3 && b > 0.0, "{a} is not {b}");
    }
}

/// The whole picture is bright until 0.37 s, when a shutter of our own closes before it.
fn curtain(spp: u32, sampler: SamplerKind) -> Scene {
    let at = |time_s: f64, y: f64| json!({"time_s": time_s, "transform": [{"translate_m": [0, y, 0]}]});
    let mut scene = parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 1,
                "shutter_s": [0, 1]},
            "film": {"width": 8, "height": 8},
            "groups": {"curtain": {"objects": [
                {"shape": {"type": "parallelogram", "origin_m": [-1, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0]},
                    "material": {"type": "black"}}
            ]}},
            "instances": [{"group": "curtain", "keyframes": [at(0.37, 9.0), at(0.370_000_1, 0.0)]}],
            "lights": [{"type": "environment", "radiance": 1}],
            "integrator": {"spp": spp, "replicates": 1}
        })
        .to_string(),
    );
    scene.integrator.sampler = sampler;
    scene
}

/// Of n stratified times of a pixel, one for each n-th part, 0.37 n are before 0.37 but for one; that takes times of their own
/// for the samples of a pixel. Independent ones miss by √(0.37·0.63·n): the mutant.
#[test]
fn times_of_a_pixel_are_stratified_over_the_shutters_time_and_differ_from_pixel_to_pixel() {
    let n = 256;
    let late = |sampler| {
        let film = render(&curtain(n, sampler), &Study::default());
        let white = {
            let mut open = curtain(n, sampler);
            open.instances.clear();
            mean_y(&render(&open, &Study::default()))
        };
        let counts: Vec<f64> = film.xyz().map(|xyz| xyz[1] / white * f64::from(n)).collect();
        counts.iter().map(|count| (count - 0.37 * f64::from(n)).abs()).fold(0.0, f64::max)
    };
    assert!(late(SamplerKind::Sobol) <= 1.01, "{}", late(SamplerKind::Sobol));
    assert!(late(SamplerKind::Independent) > 5.0, "the mutant is not seen");
    // One sample each: pixels have times of their own, or all would be bright, or none.
    let once = render(&curtain(1, SamplerKind::Sobol), &Study::default());
    let bright = once.xyz().filter(|xyz| xyz[1] > 0.0).count();
    // 64 pixels, bright with probability 0.37: 23.7 ± 3.9.
    assert!((5..=43).contains(&bright), "{bright}");
}

#[test]
fn a_world_scaled_by_a_power_of_two_moves_to_the_same_bits() {
    let scene = |scale: f64| {
        let at = |v: [f64; 3]| json!(v.map(|x| x * scale));
        let key = |time_s: f64, degrees: f64, x: f64| {
            json!({"time_s": time_s, "transform":
                [{"rotate": {"axis": [0, 1, 1], "angle_deg": degrees}}, {"translate_m": at([x, 0.3, 0.0])}]})
        };
        let grey = json!({"type": "lambert", "reflectance": 0.5});
        let text = json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": at([0.0, 1.0, 4.0]), "look_at_m": [0, 0, 0],
                "vertical_fov_deg": 40, "shutter_s": [0, 1], "keyframes": [key(0.0, 0.0, 0.0), key(1.0, 3.0, 0.1)]},
            "film": {"width": 16, "height": 12},
            "groups": {"lamp": {"objects": [{"shape": {"type": "sphere", "center_m": at([0.3, 1.0, 0.0]), "radius_m": 0.2 * scale},
                "material": grey, "emission": {"radiance": 5}}]}},
            "instances": [{"group": "lamp", "keyframes": [key(0.0, 10.0, -0.5), key(0.6, 95.0, 0.25), key(1.0, 40.0, 0.5)]}],
            "objects": [{"shape": {"type": "disk", "center_m": at([0.0, -0.5, 0.0]), "normal": [0, 1, 0], "radius_m": 3.0 * scale},
                "material": grey}],
            "integrator": {"spp": 4}
        });
        render(&parse(&text.to_string()), &Study::default())
    };
    let one = scene(1.0);
    assert!(mean_y(&one) > 0.01);
    for scale in [4.0, 1.0 / 1024.0] {
        assert!(scene(scale).pixels().eq(one.pixels()), "{scale}");
    }
}
