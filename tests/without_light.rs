//! Pictures in which no sample found light, as a user meets them: the warning, and an error that is unknown.

use std::path::{Path, PathBuf};

use etalon_picture::{Attribute, read_exr};
use serde_json::{Value, json};

use crate::support::{entries, etalon_line};

/// A floor under a camera, of 16 × 16 pixels, with these materials, objects and lights beside.
fn scene(folder: &Path, name: &str, materials: Value, objects: Value, lights: Value) -> PathBuf {
    let mut scene = json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0.4, 0], "direction": [0, -1, 0], "up": [0, 0, -1], "height_m": 0.1},
        "film": {"width": 16, "height": 16},
        "materials": {"paper": {"type": "lambert", "reflectance": 0.7}},
        "objects": [{"name": "table", "material": "paper",
            "shape": {"type": "parallelogram", "origin_m": [-0.2, 0, 0.2], "u_m": [0.4, 0, 0], "v_m": [0, 0, -0.4]}}],
        "lights": lights,
        "integrator": {"spp": 4}
    });
    scene["materials"].as_object_mut().unwrap().extend(materials.as_object().unwrap().clone());
    scene["objects"].as_array_mut().unwrap().extend(objects.as_array().unwrap().clone());
    let path = folder.join(name);
    std::fs::write(&path, scene.to_string()).unwrap();
    path
}

/// The lamp is outside of a ball that holds the camera.
fn black(folder: &Path) -> PathBuf {
    let ball = json!([{"material": "paper", "shape": {"type": "sphere", "radius_m": 1}}]);
    scene(folder, "black.json", json!({}), ball, json!([{"type": "point", "position_m": [0, 3, 0], "intensity": 1}]))
}

const WITHOUT_LIGHT: &str = "no sample found light";

#[test]
fn a_black_picture_says_that_its_error_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let (black, output) = (black(folder.path()), folder.path().join("a.exr"));
    let ran = etalon_line("render {} -o {} --json", [&black, &output]).expect(0).says([WITHOUT_LIGHT]);
    let report = ran.json();
    let error = &report["error"];
    assert_eq!(
        (&error["relative_rmse"], &error["interval_95"], &error["noisiest"]),
        (&Value::Null, &Value::Null, &Value::Null)
    );
    assert_eq!((error["mean_y"].as_f64(), error["replicates"].as_u64()), (Some(0.0), Some(4)));
    assert_eq!(report["warnings"][0]["code"], "no-light");
    let unknown = |path: &Path| {
        let attributes = read_exr(path).unwrap().attributes;
        assert_eq!(attributes["relativeRmse"], Attribute::Float(f32::INFINITY));
        assert_eq!(attributes["relativeRmseInterval"], Attribute::Vec2([0.0, f32::INFINITY]));
        assert_eq!(attributes["replicates"], Attribute::Int(4));
        assert!(!attributes.contains_key("noisiestTile") && !attributes.contains_key("tailIndex"));
    };
    unknown(&output);
    let text = etalon_line("render {} -o {}", [&black, &output]).expect(0).stdout;
    assert!(text.contains("relative error unknown: no sample found light") && !text.contains("0 %"), "{text}");
    // With a single replicate no error is known of any picture.
    let ran = etalon_line("render {} -o {} --json --replicates 1", [&black, &output]).expect(0).says([WITHOUT_LIGHT]);
    assert_eq!(ran.json()["error"], Value::Null);
    // So it is of one whose parts were rendered apart.
    let [first, second, whole] = ["1.part", "2.part", "whole.exr"].map(|name| folder.path().join(name));
    etalon_line("render {} -o {} --size 32x32 --shard 1/2", [&black, &first]).expect(0);
    etalon_line("render {} -o {} --size 32x32 --shard 2/2", [&black, &second]).expect(0);
    let ran = etalon_line("merge {} {} -o {} --json", [&first, &second, &whole]).expect(0).says([WITHOUT_LIGHT]).json();
    assert_eq!((&ran["relative_rmse"], &ran["warnings"][0]["code"]), (&Value::Null, &"no-light".into()));
    unknown(&whole);
    let text = etalon_line("merge {} {} -o {}", [&first, &second, &whole]).expect(0).stdout;
    assert!(text.contains("relative error unknown"), "{text}");
}

/// It is not reached at once, and not sought forever.
#[test]
fn an_error_that_is_unknown_ends_no_render_and_has_no_quote() {
    let folder = tempfile::tempdir().unwrap();
    let black = black(folder.path());
    let output = folder.path().join("a.exr");
    let ran = etalon_line("render {} -o {} --error 10% --json", [&black, &output]).expect(1);
    let ran = ran.says(["the pilot found no light in", "--spp or --time", "`etalon explain`"]);
    assert_eq!(ran.json()["errors"][0]["code"], "no-light");
    assert_eq!(entries(folder.path()), ["black.json"]);
    for (limit, reached) in [("--spp 8", "samples"), ("--time 0.5s", "time")] {
        let line = format!("render {{}} -o {{}} --error 10% {limit} --json");
        let report = etalon_line(&line, [&black, &output]).expect(0).says([WITHOUT_LIGHT]).json();
        assert_eq!((&report["reached"], &report["predicted"]["samples"]), (&reached.into(), &Value::Null));
    }
    let text = etalon_line("render {} -o {} --error 10% --spp 8", [&black, &output]).expect(0).stdout;
    assert!(text.contains("found no light, so the cost of 10 % is unknown"), "{text}");
    let ran = etalon_line("quote {} --pilot 0.2s --json", [&black])
        .expect(1)
        .says(["the pilot found no light in", "--pilot"]);
    assert_eq!(ran.stdout, "");
}

#[test]
fn a_study_of_a_black_scene_claims_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let (black, output) = (black(folder.path()), folder.path().join("study"));
    etalon_line("study {} -o {} --width 8 --seconds 0.02s --only sampler", [&black, &output]).expect(0);
    let study: Value = serde_json::from_str(&std::fs::read_to_string(output.join("study.json")).unwrap()).unwrap();
    let scene = &study["scenes"][0];
    assert_eq!(scene["reference"]["relative_rmse"], Value::Null);
    for row in scene["rows"].as_array().unwrap() {
        for key in ["error", "scatter", "efficiency", "bias", "z", "slope"] {
            assert_eq!(row[key], Value::Null, "{key}");
        }
    }
    let text = std::fs::read_to_string(output.join("study.md")).unwrap();
    assert!(text.contains("error unknown (no sample found light)") && !text.contains("NaN"), "{text}");
}
