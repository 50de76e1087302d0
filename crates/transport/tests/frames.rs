//! Frames of a sequence: what one takes over from another changes no bit, and is taken over.

use etalon_geometry::Geometry;
use etalon_scene::{NamedFile, Scene, parse_with_files};
use etalon_transport::{Control, Film, Prepared, Study, prepare_frame, prepare_study};
use serde_json::{Value, json};
use std::sync::Arc;

/// Keyframes that turn about the vertical and move along x, from 0 s to 2 s.
fn rolling() -> Value {
    let key = |time_s: f64, angle_deg: f64, x: f64| json!({"time_s": time_s, "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": angle_deg}}, {"translate_m": [x, 0, 0]}]});
    json!([key(0.0, 0.0, -0.3), key(2.0, 120.0, 0.4)])
}

/// A glass ball, which guides directions, and a box of groups: `moved` says what has keyframes.
fn scene(moved: [bool; 3]) -> Scene {
    let [camera_moves, outer_moves, inner_moves] = moved;
    let lambert = |reflectance: f64| json!({"type": "lambert", "reflectance": reflectance});
    let place = |moves: bool, group: &str| {
        let mut instance = json!({"name": group, "group": group});
        if moves {
            instance["keyframes"] = rolling();
        }
        instance
    };
    let mut camera = json!({"type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0.5, 0], "vertical_fov_deg": 40,
        "shutter_s": [0, 0.02]});
    if camera_moves {
        camera["keyframes"] =
            json!([{"time_s": 0}, {"time_s": 2, "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": 50}}]}]);
    }
    let text = json!({
            "etalon": 1,
            "camera": camera,
            "film": {"width": 16, "height": 12},
            "objects": [
                {"shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 3}, "material": lambert(0.6)},
                {"shape": {"type": "sphere", "center_m": [-1, 0.4, 0.5], "radius_m": 0.4},
                    "material": {"type": "dielectric", "interior": "N-BK7"}},
                {"shape": {"type": "sphere", "center_m": [1, 2, 0], "radius_m": 0.1}, "material": lambert(0.0), "emission": {"radiance": 40}}
            ],
            "groups": {
                "brick": {"objects": [{"shape": {"type": "box", "min_m": [0.5, 0, 0], "max_m": [0.8, 0.6, 0.5]}, "material": lambert(0.4)}]},
                "pair": {
                    "objects": [{"shape": {"type": "sphere", "center_m": [0, 0.3, 0], "radius_m": 0.3}, "material": lambert(0.7)}],
                    "instances": [place(inner_moves, "brick")]
                },
                "still": {"objects": [{"shape": {"type": "sphere", "center_m": [0.3, 0.2, 1], "radius_m": 0.2}, "material": lambert(0.7)}]}
            },
            "instances": [place(outer_moves, "pair"), place(false, "still")],
            "integrator": {"spp": 8, "seed": 3}
    });
    etalon_scene::parse(&text.to_string(), "test").unwrap_or_else(|errors| panic!("{errors}")).0
}

fn film(prepared: &Prepared) -> Film {
    prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap()
}

/// The geometries that the instances of a scene place, the outer ones first.
fn placed(prepared: &Prepared) -> Vec<Arc<Geometry>> {
    fn collect(geometry: &Geometry, all: &mut Vec<Arc<Geometry>>) {
        for (_, instance) in geometry.instances() {
            all.push(instance.geometry().clone());
            collect(instance.geometry(), all);
        }
    }
    let mut all = Vec::new();
    collect(prepared.geometry(), &mut all);
    all
}

/// A strip behind a prism, of which a camera that turns sees the spectrum, and a lamp at a point.
fn spectrum() -> Scene {
    let text = json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0.5, 3], "look_at_m": [0, 0.5, 0], "vertical_fov_deg": 40, "shutter_s": [0, 0.02],
            "keyframes": [{"time_s": 0}, {"time_s": 2, "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": 60}}]}]},
        "film": {"width": 32, "height": 24},
        "objects": [
            {"shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 3}, "material": {"type": "lambert", "reflectance": 0.5}},
            {"shape": {"type": "mesh",
                "vertices_m": [[-0.6, 0, 0.3], [0.6, 0, 0.3], [0, 0, -0.7], [-0.6, 1, 0.3], [0.6, 1, 0.3], [0, 1, -0.7]],
                "triangles": [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]},
                "material": {"type": "dielectric", "interior": "N-SF11"}},
            {"shape": {"type": "parallelogram", "origin_m": [-2.5, 0, -1], "u_m": [0.03, 0, 0.03], "v_m": [0, 1, 0]},
                "material": {"type": "black"}, "emission": {"radiance": 40, "sides": "both"}}
        ],
        "lights": [{"type": "point", "position_m": [1, 2, 1], "intensity": 1}],
        "integrator": {"spp": 4, "seed": 3, "wavelength_range_nm": [370, 830]}
    });
    etalon_scene::parse(&text.to_string(), "test").unwrap_or_else(|errors| panic!("{errors}")).0
}

/// Each trial depends on what the trials before it have decided, and none may depend on what was decided for an earlier frame.
#[test]
fn what_trials_have_decided_for_a_frame_does_not_last() {
    let study = Study::default();
    let mut scene = spectrum();
    let (mut earlier, mut decided) = (None, Vec::new());
    for opens_s in [0.0, 0.6, 1.2, 1.8] {
        scene.set_shutter([opens_s, opens_s + 0.02]);
        let frame = prepare_frame(&scene, &study, earlier.take()).unwrap();
        let alone = prepare_study(&scene, &study).unwrap();
        assert!(film(&frame).pixels().eq(film(&alone).pixels()), "at {opens_s} s");
        assert_eq!(frame.connection_shares(), alone.connection_shares());
        assert_eq!(frame.guided_wavelengths(), alone.guided_wavelengths());
        decided.push((frame.connection_shares(), frame.guided_wavelengths()));
        earlier = Some(frame);
    }
    assert!(decided.iter().any(|other| *other != decided[0]), "all frames are alike: {decided:?}");
}

#[test]
fn a_frame_after_others_has_the_bits_that_it_has_alone() {
    let study = Study::default();
    for moved in [[true, false, false], [false, true, false], [false, false, true], [true, true, true], [false; 3]] {
        let mut scene = scene(moved);
        let mut earlier = None;
        let mut films: Vec<Film> = Vec::new();
        for opens_s in [0.0, 0.5, 1.25, 1.5, 3.0, 0.25] {
            scene.set_shutter([opens_s, opens_s + 0.02]);
            scene.integrator.seed += 1;
            let frame = prepare_frame(&scene, &study, earlier.take()).unwrap();
            let alone = prepare_study(&scene, &study).unwrap();
            let (of_frame, of_alone) = (film(&frame), film(&alone));
            assert!(of_frame.pixels().eq(of_alone.pixels()), "{moved:?} at {opens_s} s");
            assert_eq!(of_frame.counters, of_alone.counters, "{moved:?} at {opens_s} s");
            assert_eq!((frame.plan(), frame.warnings()), (alone.plan(), alone.warnings()));
            assert_eq!(frame.guided_targets(), alone.guided_targets());
            assert!(films.iter().all(|other| !other.pixels().eq(of_frame.pixels())), "the same picture twice");
            films.push(of_frame);
            earlier = Some(frame);
        }
    }
}

/// The outer instance, the one within it, and the one that stands still.
#[test]
fn groups_in_which_nothing_moves_are_built_once() {
    for (moved, same) in [
        ([true, false, false], [true, true, true]),
        ([false, true, false], [true, true, true]),
        ([false, false, true], [false, true, true]),
    ] {
        let mut scene = scene(moved);
        let first = prepare_study(&scene, &Study::default()).unwrap();
        let before = placed(&first);
        scene.set_shutter([1.0, 1.02]);
        let after = placed(&prepare_frame(&scene, &Study::default(), Some(first)).unwrap());
        let shared: Vec<bool> = before.iter().zip(&after).map(|(a, b)| Arc::ptr_eq(a, b)).collect();
        assert_eq!(shared, same, "{moved:?}");
    }
}

#[test]
fn another_scene_or_study_takes_nothing_over_that_it_does_not_have() {
    let study = Study::default();
    let without = Study { without: vec![etalon_transport::EffectName::Motion], ..Study::default() };
    let base = scene([true, true, true]);
    let change = |change: &dyn Fn(&mut Scene)| {
        let mut scene = base.clone();
        change(&mut scene);
        scene
    };
    let others = [
        change(&|scene| scene.objects[0].opacity = 0.5),
        change(&|scene| drop(scene.objects.pop())),
        change(&|scene| scene.groups[0].objects[0].transform.translation_m[0] = 0.1),
        change(&|scene| drop(scene.groups[1].objects.pop())),
        change(&|scene| scene.film.width = 12),
        change(&|scene| scene.materials[0] = scene.materials[1].clone()),
        change(&|scene| drop(scene.instances.pop())),
        change(&|scene| scene.integrator.max_depth = Some(2)),
        base.clone(),
    ];
    for (number, other) in others.iter().enumerate() {
        for study in [&study, &without] {
            let earlier = prepare_study(&base, &Study::default()).unwrap();
            let after = film(&prepare_frame(other, study, Some(earlier)).unwrap());
            let alone = film(&prepare_study(other, study).unwrap());
            assert!(after.pixels().eq(alone.pixels()), "change {number}");
        }
    }
}

#[test]
fn the_tables_of_an_image_environment_are_taken_over_if_it_is_the_same() {
    let sky = |up: [f64; 3]| json!({"type": "environment", "image": {"file": "sky.hdr", "up": up}});
    let text = |up: [f64; 3]| {
        json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
            "film": {"width": 8, "height": 6},
            "groups": {"ball": {"objects": [
                {"shape": {"type": "sphere", "radius_m": 0.5}, "material": {"type": "lambert", "reflectance": 0.5}}
            ]}},
            "instances": [{"group": "ball", "keyframes": [{"time_s": 0}, {"time_s": 1, "transform": [{"translate_m": [1, 0, 0]}]}]}],
            "lights": [sky(up)],
            "integrator": {"spp": 4}
        })
        .to_string()
    };
    // Two texels: bright, and dark.
    let bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\xff\x80\x40\x81\x10\x10\x20\x80".to_vec();
    let files = [NamedFile { name: "sky.hdr".to_owned(), bytes }];
    let read = |up| parse_with_files(&text(up), "test", &files, None).unwrap_or_else(|errors| panic!("{errors}")).scene;
    let study = Study::default();
    let mut moved = read([0.0, 1.0, 0.0]);
    moved.set_shutter([0.5, 0.5]);
    for other in [moved, read([0.0, 0.6, 0.8])] {
        let earlier = prepare_study(&read([0.0, 1.0, 0.0]), &study).unwrap();
        let after = film(&prepare_frame(&other, &study, Some(earlier)).unwrap());
        assert!(after.pixels().eq(film(&prepare_study(&other, &study).unwrap()).pixels()));
    }
}
