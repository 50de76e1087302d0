//! Morph targets of glTF: vertices are those of the mesh and the differences of the targets times their weights.

use super::scene;
use super::shapes::{Model, SQUARE, meshes, near, said, vertices};
use etalon_scene::Shape;
use proptest::prelude::*;
use serde_json::json;

/// The square with as many targets as there are weights: target k moves corner c by (k + 1)·(c, 0, 1).
fn model(weights: &[f64]) -> Model {
    let mut model = Model::new(json!([{ "name": "a", "mesh": 0 }]), &[0]);
    let mut targets = Vec::new();
    for k in 0..weights.len() {
        let moves: Vec<f32> = (0..4).flat_map(|c| [c as f32, 0.0, 1.0].map(|v| v * (k as f32 + 1.0))).collect();
        targets.push(json!({ "POSITION": model.floats(&moves, "VEC3") }));
    }
    model.primitive()["targets"] = json!(targets);
    model.json["meshes"][0]["weights"] = json!(weights);
    model
}

/// Where its corners are.
fn moved(weights: &[f64]) -> Vec<[f64; 3]> {
    let sum: f64 = weights.iter().enumerate().map(|(k, weight)| weight * (k as f64 + 1.0)).sum();
    SQUARE.iter().enumerate().map(|(c, v)| [f64::from(v[0]) + sum * c as f64, v[1].into(), sum]).collect()
}

#[test]
fn weights_of_a_mesh_move_its_vertices_and_those_of_a_node_come_first() {
    let mut model = model(&[0.5, 0.25, 0.0]);
    let imported = model.import().unwrap();
    near(&vertices(&imported), &moved(&[0.5, 0.25, 0.0]));
    assert_eq!(said(&imported), "");
    model.json["nodes"][0]["weights"] = json!([0.0, 0.0, -0.5]);
    model.json["nodes"][0]["translation"] = json!([0, 3, 0]);
    let expected: Vec<_> = moved(&[0.0, 0.0, -0.5]).iter().map(|[x, y, z]| [*x, y + 3.0, *z]).collect();
    near(&vertices(&model.import().unwrap()), &expected);
    // What else targets say is listed; tangents are made of what is moved.
    model.primitive()["targets"][1]["TEXCOORD_0"] = json!(0);
    model.primitive()["targets"][1]["TANGENT"] = json!(0);
    let listed = said(&model.import().unwrap());
    assert!(listed.starts_with("$.meshes[0].primitives[0].targets[1].TEXCOORD_0: it is ignored"), "{listed}");
    assert_eq!(listed.lines().count(), 1);
    // Without weights it is as it is.
    model.json["nodes"][0] = json!({ "name": "a", "mesh": 0 });
    model.json["meshes"][0].as_object_mut().unwrap().remove("weights");
    near(&vertices(&model.import().unwrap()), &moved(&[]));
}

#[test]
fn a_mesh_of_several_weights_is_made_once_for_each() {
    let mut model = model(&[0.0]);
    let node = |weight: f64, x: f64| json!({ "name": "a", "mesh": 0, "weights": [weight], "translation": [x, 0, 0] });
    model.json["nodes"] = json!([node(1.0, 0.0), node(2.0, 5.0), node(1.0, 10.0)]);
    model.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let imported = model.import().unwrap();
    let scene = scene(&imported);
    let of_object = |shape: &Shape| match shape {
        Shape::Mesh(mesh) => mesh.vertices.clone(),
        _ => panic!("a mesh"),
    };
    let [(object, _)] = meshes(&scene)[..] else { panic!("one object") };
    near(&of_object(&object.shape), &moved(&[2.0]));
    assert_eq!(
        (scene.groups.len(), scene.instances.len(), scene.instances[1].transform.translation_m[0]),
        (1, 2, 10.0)
    );
    near(&of_object(&scene.groups[0].objects[0].shape), &moved(&[1.0]));
}

#[test]
fn normals_are_moved_and_have_length_one() {
    let mut model = model(&[0.5]);
    let normals = model.floats(&[0.0, 0.0, 1.0].repeat(4), "VEC3");
    let turns = model.floats(&[0.0, 3.0, 0.5].repeat(4), "VEC3");
    model.primitive()["attributes"]["NORMAL"] = json!(normals);
    model.primitive()["targets"][0]["NORMAL"] = json!(turns);
    let scene = scene(&model.import().unwrap());
    // (0, 1.5, 1.25), scaled.
    let length = (1.5_f32 * 1.5 + 1.25 * 1.25).sqrt();
    for normal in &meshes(&scene)[0].1.normals {
        let off = [normal[0], normal[1] - 1.5 / length, normal[2] - 1.25 / length];
        assert!(off.iter().all(|v| v.abs() < 1e-6), "{normal:?}");
    }
}

#[test]
fn a_sparse_target_moves_only_what_it_names() {
    let mut model = model(&[0.5]);
    let indices = model.view(&[2_u16, 3].map(u16::to_le_bytes).concat());
    let values = model.view(&[1.0_f32, 2.0, 3.0, -4.0, 0.0, 8.0].map(f32::to_le_bytes).concat());
    let sparse = model.accessor(json!({
        "componentType": 5126, "count": 4, "type": "VEC3", "min": [-9, -9, -9], "max": [9, 9, 9],
        "sparse": { "count": 2, "indices": { "bufferView": indices, "componentType": 5123 }, "values": { "bufferView": values } },
    }));
    model.primitive()["targets"][0]["POSITION"] = json!(sparse);
    let expected = [[0.0; 3], [1.0, 0.0, 0.0], [1.5, 2.0, 1.5], [-2.0, 1.0, 4.0]];
    near(&vertices(&model.import().unwrap()), &expected);
    // Of a sparse accessor that names what is not there.
    model.json["accessors"][sparse]["count"] = json!(3);
    assert!(model.refused().contains("$.meshes[0].primitives[0].targets[0].POSITION"), "{}", model.refused());
}

#[test]
fn an_animation_gives_the_weights_at_the_time_that_is_asked_for() {
    // Six targets: more than four are read in two parts.
    let rest = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let (first, second): (Vec<f32>, Vec<f32>) =
        ((1..7).map(|k| k as f32).collect(), (1..7).map(|k| -3.0 * k as f32).collect());
    let weights = |share: f64| -> Vec<f64> { (1..7).map(|k| f64::from(k) * (1.0 - 4.0 * share)).collect() };
    let mut linear = model(&rest);
    linear.animate(0, "weights", "LINEAR", &[1.0, 3.0], &[first.clone(), second.clone()].concat());
    for (time_s, share) in [(0.0, 0.0), (1.5, 0.25), (9.0, 1.0)] {
        let imported = linear.at(time_s, 0.0).unwrap();
        near(&vertices(&imported), &moved(&weights(share)));
        assert_eq!(said(&imported), "");
    }
    // Without a time it rests.
    let imported = linear.import().unwrap();
    near(&vertices(&imported), &moved(&rest));
    assert!(said(&imported).contains("$.animations[0]: the animation is ignored: no time is asked for"));
    // What changes while the shutter is open stays as when it opens.
    let imported = linear.at(1.5, 0.5).unwrap();
    near(&vertices(&imported), &moved(&weights(0.25)));
    assert!(said(&imported).contains("$.animations[0].channels[0]: the weights of morph targets change"));
    assert_eq!(said(&linear.at(4.0, 0.5).unwrap()), "");

    let mut step = model(&rest);
    step.animate(0, "weights", "STEP", &[1.0, 3.0], &[first.clone(), second.clone()].concat());
    near(&vertices(&step.at(2.9, 0.0).unwrap()), &moved(&weights(0.0)));
    // With slopes of 0 Hermite's curve is 3s² − 2s³, at ¼ 5/32.
    let mut cubic = model(&rest);
    let still = vec![0.0_f32; 6];
    let values = [&still, &first, &still, &still, &second, &still].map(Clone::clone).concat();
    cubic.animate(0, "weights", "CUBICSPLINE", &[1.0, 3.0], &values);
    near(&vertices(&cubic.at(1.5, 0.0).unwrap()), &moved(&weights(5.0 / 32.0)));
}

#[test]
fn what_makes_no_sense_is_refused_with_its_place() {
    let change = |change: &dyn Fn(&mut Model)| {
        let mut model = model(&[0.5, 1.0]);
        change(&mut model);
        model.refused()
    };
    let part = "$.meshes[0].primitives[0]";
    let cases = [
        (
            change(&|m| m.json["meshes"][0]["weights"] = json!([1.0])),
            "1 weights for the 2 morph targets of $.meshes[0]",
        ),
        (change(&|m| m.json["nodes"][0]["weights"] = json!([1.0, 1.0, 1.0])), "$.nodes[0].weights: 3 weights"),
        (change(&|m| m.primitive()["targets"][1]["POSITION"] = json!(99)), part),
        (
            change(&|m| m.json["accessors"][3]["count"] = json!(3)),
            "$.meshes[0].primitives[0].targets[1].POSITION: 3 differences",
        ),
        (
            change(&|m| m.json["accessors"][3]["count"] = json!(400)),
            "targets[1].POSITION: $.accessors[3]: it leaves its",
        ),
        (
            change(&|m| {
                let other = m.floats(&[f32::NAN; 12], "VEC3");
                m.primitive()["targets"][0]["POSITION"] = json!(other);
            }),
            "$.meshes[0].primitives[0]: vertex 0 lies at",
        ),
        (
            change(&|m| {
                let mut other = m.primitive().clone();
                other["targets"].as_array_mut().unwrap().pop();
                m.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(other);
            }),
            "$.meshes[0].primitives[1]: 1 morph targets, but 2 weights",
        ),
    ];
    for (said, expected) in cases {
        assert!(said.contains(expected), "{said} without {expected}");
    }
    let mut uneven = model(&[0.5, 1.0]);
    uneven.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 1.0]);
    let said = uneven.at(0.0, 0.0).unwrap_err();
    assert!(said.contains("$.animations[0].channels[0]: 3 weights are no multiple of 2 morph targets"), "{said}");
    let mut short = model(&[0.5, 1.0]);
    short.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    assert!(short.at(0.0, 0.0).unwrap_err().contains("1 values for 2 times"));
}

#[test]
fn a_file_of_a_few_bytes_cannot_ask_for_endless_copies() {
    // A million vertices that no bytes stand for, in forty shapes.
    let mut model = model(&[0.0]);
    let (first, zero) = (model.view(&[0, 0]), model.view(&[0; 12]));
    let zeros = model.accessor(json!({
        "componentType": 5126, "count": 1 << 20, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0],
        "sparse": { "count": 1, "indices": { "bufferView": first, "componentType": 5123 }, "values": { "bufferView": zero } },
    }));
    model.primitive()["attributes"]["POSITION"] = json!(zeros);
    model.primitive()["targets"][0]["POSITION"] = json!(zeros);
    let nodes: Vec<_> = (1..41).map(|k| json!({ "mesh": 0, "weights": [k] })).collect();
    model.json["scenes"][0]["nodes"] = json!((0..40).collect::<Vec<_>>());
    model.json["nodes"] = json!(nodes);
    let said = model.refused();
    assert!(said.contains("$.meshes[0].primitives[0]: up to here bent meshes have more than"), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_change_of_bytes_makes_a_morph_panic(at in 0_usize..6000, with in any::<[u8; 3]>()) {
        let mut model = model(&[0.5, 1.0]);
        model.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 1.0, 2.0]);
        let mut bytes = model.glb();
        let at = at % (bytes.len() - 3);
        bytes[at..at + 3].copy_from_slice(&with);
        super::skins::import_anyway(&bytes);
    }
}
