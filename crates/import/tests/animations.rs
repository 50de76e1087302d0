//! Animations of glTF: what nodes do while a shutter is open arrives in the scene's motion, everything else is listed.

use base64::Engine as _;
use etalon_import::{Imported, Moment, Options, import_bytes_with};
use etalon_scene::{Scene, Transform};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn nothing(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

/// A channel: node, path, interpolation, times and values.
type Channel<'a> = (usize, &'a str, &'a str, &'a [f32], &'a [f32]);

/// A model of some nodes and the channels of an animation.
fn model(nodes: Value, roots: &[usize], channels: &[Channel<'_>]) -> Value {
    let mut bytes = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let mut add = |list: &[f32], each: usize| {
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][each];
        views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": 4 * list.len() }));
        bytes.extend(list.iter().flat_map(|v| v.to_le_bytes()));
        let (low, high) = (vec![-1e9; each], vec![1e9; each]);
        accessors.push(json!({ "bufferView": views.len() - 1, "componentType": 5126, "count": list.len() / each,
            "type": kind, "min": low, "max": high }));
        accessors.len() - 1
    };
    let positions = add(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], 3);
    let (mut samplers, mut listed) = (Vec::new(), Vec::new());
    for (node, path, interpolation, times, values) in channels {
        let (input, output) = (add(times, 1), add(values, if *path == "rotation" { 4 } else { 3 }));
        listed.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
    }
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": roots }], "nodes": nodes,
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": positions } }] }],
        "animations": [{ "name": "walk", "channels": listed, "samplers": samplers }],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{data}") }],
    })
}

fn options(moment: Option<&Moment>) -> Options {
    Options { moment: moment.cloned(), ..Options::default() }
}

fn at(model: &Value, moment: Option<&Moment>) -> Result<Imported, String> {
    import_bytes_with("gltf", model.to_string().as_bytes(), &nothing, "", "m.gltf", &options(moment))
}

fn moment(opens_s: f64, shutter_s: f64) -> Moment {
    Moment { animation: None, opens_s, shutter_s }
}

fn scene(imported: &Imported) -> Scene {
    imported.parse("model", None).unwrap_or_else(|errors| panic!("{errors}\n{}", imported.text)).scene
}

fn said(imported: &Imported) -> Vec<String> {
    imported.left_out.iter().map(|l| format!("{}: {}", l.place, l.what)).collect()
}

type Point = [f64; 3];

fn apply(transform: &Transform, p: Point) -> Point {
    std::array::from_fn(|i| (0..3).map(|j| transform.linear[i][j] * p[j]).sum::<f64>() + transform.translation_m[i])
}

/// Where a point of the only mesh is in the world at a time: through all instances around it.
fn world(scene: &Scene, p: Point, time_s: f64) -> Point {
    fn through(scene: &Scene, instances: &[etalon_scene::Instance], p: Point, time_s: f64) -> Option<Point> {
        instances.iter().find_map(|instance| {
            let group = &scene.groups[instance.group];
            let within = match group.objects.first() {
                Some(object) => Some(apply(&object.transform, p)),
                None => through(scene, &group.instances, p, time_s),
            };
            let placed =
                instance.motion.as_ref().map_or_else(|| instance.transform.clone(), |motion| motion.at(time_s));
            within.map(|p| apply(&placed, p))
        })
    }
    through(scene, &scene.instances, p, time_s).expect("the mesh is placed")
}

fn turned_z(p: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], p[2]]
}

fn about_z(angle: f64) -> [f32; 4] {
    [0.0, 0.0, (0.5 * angle).sin() as f32, (0.5 * angle).cos() as f32]
}

fn near(a: Point, b: Point, tolerance: f64) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() < tolerance)
}

/// Roundoffs of single precision in a file, for numbers up to 10.
const SINGLE: f64 = 2e-6;
const P: Point = [0.7, -0.2, 0.4];

#[test]
fn a_wheel_that_rolls_moves_on_its_cycloid() {
    // 2 m and −2.4 rad in a second, in proportion.
    let nodes = json!([{ "name": "wheel", "mesh": 0, "scale": [2, 2, 2] }]);
    let turns: Vec<f32> = [about_z(0.0), about_z(-2.4)].concat();
    let model = model(
        nodes,
        &[0],
        &[
            (0, "translation", "LINEAR", &[1.0, 2.0], &[0.0, 0.5, 0.0, 2.0, 0.5, 0.0]),
            (0, "rotation", "LINEAR", &[1.0, 2.0], &turns),
        ],
    );
    let scene = scene(&at(&model, Some(&moment(1.25, 0.5))).unwrap());
    assert_eq!(scene.camera.shutter_s, [1.25, 1.75]);
    for k in 0..=16 {
        let time = 1.25 + 0.5 * f64::from(k) / 16.0;
        let share = time - 1.0;
        let [x, y, z] = turned_z(P.map(|v| 2.0 * v), -2.4 * share);
        let want = [x + 2.0 * share, y + 0.5, z];
        assert!(near(world(&scene, P, time), want, SINGLE), "at {time}");
    }
    // Quaternions that are mixed and normalised, as some do, are noticed: they are off by some mrad between the middle and the ends.
    let chord = |share: f64| 2.0 * (share * 1.2_f64.sin()).atan2(1.0 - share + share * 1.2_f64.cos());
    let off = (chord(0.25) - 0.6).abs();
    assert!(off > 1e3 * SINGLE, "{off}");
}

#[test]
fn what_turns_within_what_turns_is_followed_exactly() {
    // A moon about a planet about a sun, the planet's system stretched and tilted by nodes that rest.
    let nodes = json!([
        { "scale": [1, 1, 3], "children": [1] },
        { "name": "planet", "children": [2] },
        { "translation": [5, 0, 0], "children": [3] },
        { "name": "moon", "mesh": 0, "translation": [1, 0, 0] },
    ]);
    let (slow, fast) = ([about_z(0.0), about_z(1.0)].concat(), [about_z(0.0), about_z(3.0)].concat());
    let model = model(
        nodes,
        &[0],
        &[(1, "rotation", "LINEAR", &[0.0, 1.0], &slow), (3, "rotation", "LINEAR", &[0.0, 1.0], &fast)],
    );
    let scene = scene(&at(&model, Some(&moment(0.0, 1.0))).unwrap());
    for k in 0..=16 {
        let share = f64::from(k) / 16.0;
        let [x, y, z] = turned_z(P, 3.0 * share);
        let [x, y, z] = turned_z([x + 6.0, y, z], share);
        assert!(near(world(&scene, P, share), [x, y, 3.0 * z], 2.0 * SINGLE), "at {share}");
    }
}

#[test]
fn half_turns_and_jumps_are_followed() {
    let half: Vec<f32> = [about_z(0.0), about_z(PI)].concat();
    let rotation = model(json!([{ "mesh": 0 }]), &[0], &[(0, "rotation", "LINEAR", &[0.0, 1.0], &half)]);
    let turning = scene(&at(&rotation, Some(&moment(0.0, 1.0))).unwrap());
    for share in [0.0, 0.25, 0.5, 1.0] {
        // Either way round is right for a half turn.
        let [a, b] = [PI, -PI].map(|turn| turned_z(P, turn * share));
        let found = world(&turning, P, share);
        assert!(near(found, a, SINGLE) || near(found, b, SINGLE), "at {share}");
    }
    let steps = model(
        json!([{ "mesh": 0 }]),
        &[0],
        &[(0, "translation", "STEP", &[0.0, 0.5, 9.0], &[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0])],
    );
    let jumping = scene(&at(&steps, Some(&moment(0.0, 1.0))).unwrap());
    for (time, by) in [(0.0, [0.0; 3]), (0.49, [0.0; 3]), (0.5, [1.0, 2.0, 3.0]), (1.0, [1.0, 2.0, 3.0])] {
        assert!(near(world(&jumping, P, time), std::array::from_fn(|k| P[k] + by[k]), 1e-12), "at {time}");
    }
}

#[test]
fn a_cubic_curve_is_followed_within_its_stated_bound() {
    // 3t² − 2t³ from slopes of 0: its second derivative is 6 at most.
    let values = [[0.0_f32; 3], [0.0; 3], [0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]].concat();
    let model = model(json!([{ "mesh": 0 }]), &[0], &[(0, "translation", "CUBICSPLINE", &[0.0, 1.0], &values)]);
    let scene = scene(&at(&model, Some(&moment(0.0, 1.0))).unwrap());
    let mut largest = 0.0_f64;
    for k in 0..=1000 {
        let t = f64::from(k) / 1000.0;
        let off = world(&scene, P, t)[0] - P[0] - t * t * (3.0 - 2.0 * t);
        largest = largest.max(off.abs());
    }
    let bound = 6.0 / 8.0 / 256.0;
    assert!(largest < bound && largest > 0.8 * bound, "{largest}");
}

#[test]
fn an_instant_shows_the_pose_and_nothing_moves() {
    let nodes = json!([{ "mesh": 0, "scale": [1, 1, 2] }]);
    let model = model(nodes, &[0], &[(0, "translation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 4.0, 2.0, 0.0])]);
    for (time, x) in [(-3.0, 0.0), (0.5, 1.0), (7.0, 4.0)] {
        let scene = scene(&at(&model, Some(&moment(time, 0.0))).unwrap());
        assert!(scene.instances.is_empty());
        assert_eq!(scene.camera.shutter_s, [0.0, 0.0]);
        assert!(near(apply(&scene.objects[0].transform, P), [P[0] + x, P[1] + 0.5 * x, 2.0 * P[2]], 1e-12), "{time}");
    }
    // Beyond the last keyframe it rests, also under an open shutter.
    assert!(scene(&at(&model, Some(&moment(2.5, 1.0))).unwrap()).instances.is_empty());
}

#[test]
fn a_camera_on_an_arm_keeps_to_its_circle() {
    let nodes = json!([
        { "name": "arm", "children": [1] },
        { "translation": [3, 0, 0], "camera": 0 },
        { "mesh": 0 },
    ]);
    let turns: Vec<f32> = [about_z(0.0), about_z(2.0)].concat();
    let model = model(nodes, &[0, 2], &[(0, "rotation", "LINEAR", &[0.0, 1.0], &turns)]);
    let scene = scene(&at(&model, Some(&moment(0.0, 1.0))).unwrap());
    let motion = scene.camera.motion.as_ref().expect("it moves");
    let keyframes = &motion.motion.keyframes;
    assert!(keyframes.len() > 100, "{}", keyframes.len());
    for pair in keyframes.windows(2) {
        let middle = 0.5 * (pair[0].time_s + pair[1].time_s);
        let (a, b) = (pair[0].transform.translation_m, pair[1].transform.translation_m);
        let found: Point = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        // The stated share of the distance, and what the file rounds.
        assert!(near(found, turned_z([3.0, 0.0, 0.0], 2.0 * middle), 3.0 * 1e-6 + SINGLE), "at {middle}");
        let seen = apply(&pair[0].transform, [0.0, 0.0, -1.0]);
        assert!(near(seen, [a[0], a[1], a[2] - 1.0], 1e-6), "it looks along −z all the while");
    }
}

#[test]
fn animations_that_are_not_asked_for_are_listed() {
    let channel: Channel<'_> = (0, "translation", "LINEAR", &[0.0], &[1.0, 2.0, 3.0]);
    let mut model = model(json!([{ "mesh": 0 }]), &[0], &[channel]);
    let first = model["animations"][0].clone();
    model["animations"] = json!([first, { "name": "run", "channels": [], "samplers": [] }]);
    let none = said(&at(&model, None).unwrap());
    assert_eq!(none.len(), 2, "{none:?}");
    assert!(
        none[0].starts_with("$.animations[0]: the animation \"walk\" is ignored: no time is asked for"),
        "{none:?}"
    );
    let one = said(&at(&model, Some(&moment(0.0, 0.0))).unwrap());
    assert_eq!(one.len(), 1, "{one:?}");
    assert!(one[0].starts_with("$.animations[1]: the animation \"run\" is ignored: another one"), "{one:?}");
    for (name, listed) in [("run", "$.animations[0]"), ("1", "$.animations[0]"), ("walk", "$.animations[1]")] {
        let moment = Moment { animation: Some(name.to_owned()), ..moment(0.0, 0.0) };
        assert!(said(&at(&model, Some(&moment)).unwrap())[0].starts_with(listed), "{name}");
    }
    let unknown = Moment { animation: Some("swim".to_owned()), ..moment(0.0, 0.0) };
    assert_eq!(at(&model, Some(&unknown)).unwrap_err(), "there is no animation \"swim\": it has \"walk\", \"run\"");
}

#[test]
fn what_cannot_be_followed_is_said() {
    let ply = b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n";
    assert!(
        import_bytes_with("ply", ply, &nothing, "", "a", &options(Some(&moment(0.0, 0.0))))
            .unwrap_err()
            .contains("glTF")
    );
    let single =
        |path, values: &[f32]| model(json!([{ "mesh": 0 }]), &[0], &[(0, path, "LINEAR", &[0.0, 1.0], values)]);
    for (model, part) in [
        (single("translation", &[0.0; 3]), "1 values for 2 times"),
        (single("translation", &[f32::NAN; 6]), "not finite"),
        (single("rotation", &[0.0; 8]), "of length 0"),
        (
            model(json!([{ "mesh": 0 }]), &[0], &[(0, "scale", "LINEAR", &[1.0, 1.0], &[1.0; 6])]),
            "its times do not increase",
        ),
    ] {
        let why = at(&model, Some(&moment(0.0, 1.0))).unwrap_err();
        assert!(why.contains("$.animations[0].channels[0]") && why.contains(part), "{why}");
        // Not asked for, it does no harm.
        assert!(at(&model, None).is_ok());
    }
    let mut lost = single("translation", &[0.0; 6]);
    lost["animations"][0]["channels"][0]["target"]["node"] = json!(7);
    assert_eq!(
        at(&lost, Some(&moment(0.0, 1.0))).unwrap_err(),
        "$.animations[0].channels[0]: it names node 7; there are 1"
    );
    let mut unknown = single("translation", &[0.0; 6]);
    unknown["animations"][0]["channels"][0]["target"]["path"] = json!("pointer");
    assert_eq!(
        said(&at(&unknown, Some(&moment(0.0, 1.0))).unwrap()),
        ["$.animations[0].channels[0]: its target is not known"]
    );
    let vanishing = single("scale", &[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let imported = at(&vanishing, Some(&moment(0.0, 1.0))).unwrap();
    assert!(said(&imported)[0].contains("its scale goes through 0: it stays as it is"), "{:?}", said(&imported));
    assert!(scene(&imported).instances.is_empty());
}
