//! Skins of glTF: vertices are where their joints take them.

use super::shapes::{Model, SQUARE, meshes, near, said, vertices};
use super::{nothing, scene};
use etalon_import::{Moment, Options, import_bytes_with};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::FRAC_1_SQRT_2;

const HALF: f64 = FRAC_1_SQRT_2;

/// The square with two joints: one at the origin that rests, one at (0, 1, 0) that is turned a quarter about z. The lower corners follow the
/// first, the upper ones both alike. The node of the mesh is far away.
fn model() -> Model {
    let mut model = Model::new(
        json!([
            { "name": "a", "mesh": 0, "skin": 0, "translation": [100, 0, 0], "scale": [7, 7, 7] },
            { "name": "hip", "children": [2] },
            { "name": "knee", "translation": [0, 1, 0], "rotation": [0, 0, HALF, HALF] },
        ]),
        &[0, 1],
    );
    let joints = model.add(vec![0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0], 5121, "VEC4");
    let weights = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]];
    let weights = model.floats(&weights.concat(), "VEC4");
    (model.primitive()["attributes"]["JOINTS_0"], model.primitive()["attributes"]["WEIGHTS_0"]) =
        (json!(joints), json!(weights));
    // By columns: the identity, and a move by −1 along y.
    let mut inverses = [[0.0_f32; 16]; 2];
    for k in [0, 5, 10, 15] {
        (inverses[0][k], inverses[1][k]) = (1.0, 1.0);
    }
    inverses[1][13] = -1.0;
    let inverses = model.floats(&inverses.concat(), "MAT4");
    model.json["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": inverses }]);
    model
}

/// Where the corners are if the knee is turned by an angle: (x, 1) goes to ½(x, 1) + ½(x cos, 1 + x sin).
fn bent(angle: f64) -> Vec<[f64; 3]> {
    let (sin, cos) = angle.sin_cos();
    let upper = |x: f64| [0.5 * (x + x * cos), 1.0 + 0.5 * x * sin, 0.0];
    vec![[0.0; 3], [1.0, 0.0, 0.0], upper(1.0), upper(0.0)]
}

const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

/// Imports bytes at a time, and reads what comes out of it.
pub(super) fn import_anyway(bytes: &[u8]) {
    let moment = Some(Moment { animation: None, opens_s: 0.25, shutter_s: 0.5 });
    let options = Options { moment, ..Options::default() };
    if let Ok(imported) = import_bytes_with("glb", bytes, &nothing, "", "m.glb", &options) {
        let _ = imported.parse("m", None);
    }
}

#[test]
fn a_square_is_bent_by_two_joints_wherever_its_node_is() {
    let mut model = model();
    let imported = model.import().unwrap();
    near(&vertices(&imported), &bent(QUARTER));
    assert_eq!(said(&imported), "");
    // What is above the joints moves all.
    model.json["nodes"][1]["translation"] = json!([0, 0, 5]);
    model.json["nodes"][1]["scale"] = json!([2, 2, 2]);
    let expected: Vec<_> = bent(QUARTER).iter().map(|[x, y, z]| [2.0 * x, 2.0 * y, 2.0 * z + 5.0]).collect();
    near(&vertices(&model.import().unwrap()), &expected);
    // Joints without inverse matrices: bound where their coordinates begin.
    model.json["skins"][0].as_object_mut().unwrap().remove("inverseBindMatrices");
    model.json["nodes"][1] = json!({ "children": [2] });
    let expected = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [-0.5, 1.0, 0.0]];
    near(&vertices(&model.import().unwrap()), &expected);
}

#[test]
fn normals_turn_with_the_joints_and_mirrored_joints_keep_the_outer_side() {
    let mut model = model();
    let normals = model.floats(&[1.0, 1.0, 1.0].repeat(4), "VEC3");
    model.primitive()["attributes"]["NORMAL"] = json!(normals);
    // All corners follow the knee, stretched by (2, 1, 4) before it turns: normals are divided by that.
    let joints = model.add(vec![1; 16], 5121, "VEC4");
    model.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    model.json["nodes"][2]["scale"] = json!([2, 1, 4]);
    let scene_of = |model: &Model| scene(&model.import().unwrap());
    let scene = scene_of(&model);
    let mesh = meshes(&scene)[0].1;
    let length = (1.0_f32 + 0.25 + 0.0625).sqrt();
    for (found, expected) in mesh.normals.iter().flatten().zip([-1.0, 0.5, 0.25].repeat(4)) {
        assert!((found - expected / length).abs() < 1e-6, "{:?}", mesh.normals);
    }
    assert_eq!(mesh.triangles[0], [0, 1, 2]);
    model.json["nodes"][2]["scale"] = json!([2, 1, -4]);
    let scene = scene_of(&model);
    let mesh = meshes(&scene)[0].1;
    assert!((mesh.normals[0][2] + 0.25 / length).abs() < 1e-6, "{:?}", mesh.normals);
    // Seen from below, whence the outer side is seen now, the corners go counter-clockwise.
    assert_eq!(mesh.triangles[0], [0, 2, 1]);
}

#[test]
fn joints_are_where_an_animation_has_them_at_the_time() {
    let mut model = model();
    let half = |angle: f64| [0.0, 0.0, (0.5 * angle).sin() as f32, (0.5 * angle).cos() as f32];
    model.animate(2, "rotation", "LINEAR", &[1.0, 2.0], &[half(0.0), half(1.6)].concat());
    for (time_s, angle) in [(0.0, 0.0), (1.25, 0.4), (3.0, 1.6)] {
        let imported = model.at(time_s, 0.0).unwrap();
        near(&vertices(&imported), &bent(angle));
        assert_eq!(said(&imported), "");
    }
    near(&vertices(&model.import().unwrap()), &bent(QUARTER));
    let imported = model.at(1.25, 0.5).unwrap();
    near(&vertices(&imported), &bent(0.4));
    assert!(said(&imported).contains("$.skins[0]: its joints move while the shutter is open"), "{}", said(&imported));
    // A node that moves does not take its mesh along.
    let mut carried = self::model();
    carried.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 9.0, 9.0, 9.0]);
    let imported = carried.at(0.0, 1.0).unwrap();
    near(&vertices(&imported), &bent(QUARTER));
}

#[test]
fn morph_targets_come_before_joints_and_further_joints_count() {
    let mut model = model();
    // Target: the corner (1, 1) goes to (3, 1).
    let moves = model.floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0], "VEC3");
    model.primitive()["targets"] = json!([{ "POSITION": moves }]);
    model.json["meshes"][0]["weights"] = json!([0.5]);
    let mut expected = bent(QUARTER);
    expected[2] = [1.5, 2.5, 0.0];
    near(&vertices(&model.import().unwrap()), &expected);
    // A second set of joints, and weights as parts of 255: ⅕ to the first joint, ⅘ to the knee.
    let joints = model.add([[0_u8; 4], [0; 4], [1, 0, 0, 0], [1, 0, 0, 0]].concat(), 5121, "VEC4");
    let parts = model.add([[0_u8; 4], [0; 4], [204, 0, 0, 0], [204, 0, 0, 0]].concat(), 5121, "VEC4");
    let first = model.add([[255_u8, 0, 0, 0], [255, 0, 0, 0], [51, 0, 0, 0], [51, 0, 0, 0]].concat(), 5121, "VEC4");
    for accessor in [parts, first] {
        model.json["accessors"][accessor]["normalized"] = json!(true);
    }
    let attributes = &mut model.primitive()["attributes"];
    for (key, accessor) in [("JOINTS_1", joints), ("WEIGHTS_1", parts), ("WEIGHTS_0", first)] {
        attributes[key] = json!(accessor);
    }
    // ⅕(3, 1) + ⅘(0, 4).
    expected[2] = [0.6, 3.4, 0.0];
    let imported = model.import().unwrap();
    near(&vertices(&imported), &expected);
    assert_eq!(said(&imported), "");
}

#[test]
fn what_weights_leave_open_is_listed() {
    let with = |weights: [[f32; 4]; 4]| {
        let mut model = model();
        let weights = model.floats(&weights.concat(), "VEC4");
        model.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
        model.import().unwrap()
    };
    let doubled = with([[2.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]]);
    near(&vertices(&doubled), &bent(QUARTER));
    assert!(said(&doubled).contains("WEIGHTS_0: the weights of 4 vertices do not add up to 1"), "{}", said(&doubled));
    let none = with([[0.0; 4]; 4]);
    near(&vertices(&none), &SQUARE.map(|v| v.map(f64::from)));
    assert!(said(&none).contains("4 vertices have no weight: they follow the first joint"), "{}", said(&none));
    // Two nodes, one place.
    let mut twice = model();
    let second = json!({ "name": "b", "mesh": 0, "skin": 0 });
    twice.json["nodes"].as_array_mut().unwrap().push(second);
    twice.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    let imported = twice.import().unwrap();
    near(&vertices(&imported), &bent(QUARTER));
    assert!(said(&imported).contains("node \"b\": the same joints place the same mesh"), "{}", said(&imported));
    // A skin without joints: the node places the mesh.
    let mut without = model();
    let attributes = without.primitive()["attributes"].as_object_mut().unwrap();
    attributes.retain(|key, _| key == "POSITION");
    let imported = without.import().unwrap();
    near(&vertices(&imported), &SQUARE.map(|v| v.map(|c| f64::from(c) * 7.0)).map(|[x, y, z]| [x + 100.0, y, z]));
    assert!(said(&imported).contains("$.meshes[0].primitives[0]: it has a skin, but no JOINTS_0"));
}

#[test]
fn what_makes_no_sense_is_refused_with_its_place() {
    let change = |change: &dyn Fn(&mut Model)| {
        let mut model = model();
        change(&mut model);
        model.refused()
    };
    let attribute = |key: &str, floats: Vec<f32>| {
        change(&|m| {
            let accessor = m.floats(&floats, "VEC4");
            m.primitive()["attributes"][key] = json!(accessor);
        })
    };
    let part = |what: &str| format!("$.meshes[0].primitives[0].attributes.{what}");
    let joint = change(&|m| {
        let joints =
            m.add([[0_u16, 7, 0, 0]; 4].as_flattened().iter().flat_map(|i| i.to_le_bytes()).collect(), 5123, "VEC4");
        m.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    });
    let matrix = |floats: Vec<f32>| {
        change(&|m| {
            let matrices = m.floats(&floats, "MAT4");
            m.json["skins"][0]["inverseBindMatrices"] = json!(matrices);
        })
    };
    let cases = [
        (joint, part("JOINTS_0: vertex 2 names joint 7; there are 2")),
        (attribute("WEIGHTS_0", vec![-1.0; 16]), part("WEIGHTS_0: vertex 0 has the weight -1")),
        (attribute("WEIGHTS_0", vec![f32::NAN; 16]), part("WEIGHTS_0: vertex 0 has the weight NaN")),
        (attribute("WEIGHTS_0", vec![1.0; 12]), part("WEIGHTS_0: 3 elements for 4 vertices")),
        (attribute("WEIGHTS_1", vec![1.0; 16]), "of JOINTS_1 and WEIGHTS_1 it has only one".to_owned()),
        (matrix(vec![1.0; 16]), "$.skins[0]: 1 inverse bind matrices for 2 joints".to_owned()),
        (matrix(vec![f32::INFINITY; 32]), "$.skins[0]: the matrix of joint 0 is not finite".to_owned()),
        (change(&|m| m.json["skins"][0]["joints"] = json!([1, 9])), "joints".to_owned()),
        (change(&|m| m.json["nodes"][0]["skin"] = json!(1)), "skin".to_owned()),
        // A joint outside of the scene, above itself.
        (
            change(&|m| {
                m.json["nodes"].as_array_mut().unwrap().push(json!({ "children": [3] }));
                m.json["skins"][0]["joints"] = json!([1, 3]);
            }),
            "above joint $.nodes[3] nodes are nested more than".to_owned(),
        ),
    ];
    for (said, expected) in cases {
        assert!(said.contains(&expected), "{said} without {expected}");
    }
    let mut many = model();
    let attributes = many.primitive()["attributes"].clone();
    for set in 1..17 {
        for key in ["JOINTS", "WEIGHTS"] {
            let same: Value = attributes[format!("{key}_0")].clone();
            many.primitive()["attributes"][format!("{key}_{set}")] = same;
        }
    }
    assert!(many.refused().contains("it has more than 16 sets of joints"), "{}", many.refused());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_change_of_bytes_makes_a_skin_panic(at in 0_usize..6000, with in any::<[u8; 3]>()) {
        let mut model = model();
        model.animate(2, "rotation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
        let mut bytes = model.glb();
        let at = at % (bytes.len() - 3);
        bytes[at..at + 3].copy_from_slice(&with);
        import_anyway(&bytes);
    }
}
