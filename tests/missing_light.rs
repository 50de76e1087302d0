//! Pictures in which light is missing, as a user meets them: the warnings, and an error that is unknown.

use std::path::{Path, PathBuf};

use etalon_picture::{Attribute, read_exr};
use serde_json::{Value, json};

use crate::support::{entries, etalon_line, pixel_bits};

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

/// A prism lies before a spot on the table, as a caustic is shown in school.
fn prism(folder: &Path, lights: Value) -> PathBuf {
    let glass = json!({"flint": {"type": "dielectric", "interior": 1.7}});
    let prism = json!([{"name": "prism", "material": "flint", "shape": {"type": "mesh",
        "vertices_m": [[-0.02, 0.0005, 0.0173], [0.02, 0.0005, 0.0173], [0, 0.0005, -0.0173],
            [-0.02, 0.02, 0.0173], [0.02, 0.02, 0.0173], [0, 0.02, -0.0173]],
        "triangles": [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]}}]);
    scene(folder, "prism.json", glass, prism, lights)
}

fn spot() -> Value {
    json!({"type": "spot", "name": "torch", "position_m": [-0.1, 0.01, 0], "direction": [1, 0, 0], "intensity": 100, "half_angle_deg": 2})
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

/// Named with the lamp and the glass, also where another lamp lights the picture, and at no place where nothing is missing.
#[test]
fn light_that_no_path_finds_is_named_with_lamp_and_glass() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("a.exr");
    let said =
        "light of \"torch\" that \"prism\" reflects or transmits (material \"flint\": a smooth interface of two media)";
    let sky = json!({"type": "environment", "name": "sky", "radiance": 1});
    for lights in [json!([spot()]), json!([sky, spot()])] {
        let prism = prism(folder.path(), lights);
        let ran = etalon_line("explain {}", [&prism]).expect(0).says([
            "some light is missing",
            said,
            "`etalon explain --json`",
        ]);
        assert!(ran.stdout.contains(&format!("missing light      {said}")), "{}", ran.stdout);
        etalon_line("quote {} --pilot 0.01s --error 90%", [&prism]).says([said]);
        let report = etalon_line("render {} -o {} --json", [&prism, &output]).expect(0).says([said]).json();
        assert_eq!(report["warnings"][0]["code"], "missing-light");
        let pair = json!({"light": "torch", "object": "prism", "material": "flint",
            "surface": "a smooth interface of two media", "lost": "reflected-and-transmitted"});
        let missing = json!({"pairs": 1, "listed": [pair]});
        let Attribute::Text(plan) = &pixel_bits(&output).1.attributes["plan"] else { panic!("the plan is no text") };
        let plan: Value = serde_json::from_str(plan).unwrap();
        let explained = etalon_line("explain {} --json", [&prism]).expect(0).json();
        assert_eq!(
            [&report["plan"], &plan, &explained["plan"]].map(|plan| plan["missing_light"].clone()),
            [0; 3].map(|_| missing.clone())
        );
    }
    let prism = prism(folder.path(), json!([sky]));
    let ran = etalon_line("explain {}", [&prism]).expect(0);
    assert_eq!((ran.stderr.as_str(), ran.stdout.contains("missing light")), ("", false));
}

/// Hundreds of pairs are one warning of a few lines.
#[test]
fn many_pairs_are_told_in_few_lines() {
    let folder = tempfile::tempdir().unwrap();
    let lamp = json!({"type": "point", "position_m": [0, 3, 0], "intensity": 1});
    let ran = etalon_line("explain {}", [&prism(folder.path(), Value::from(vec![lamp; 300]))]).expect(0);
    assert_eq!(ran.stderr.matches("light of \"").count(), 8, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("and 292 more pairs of a lamp and a surface") && ran.stderr.len() < 2000,
        "{}",
        ran.stderr
    );
}
