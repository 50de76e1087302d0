//! Scenes that are refused: every error in one run, with its place, and nothing rendered.

use std::path::Path;

use serde_json::{Value, json};

use crate::support::{changed_scene, entries, etalon_line};

/// A box with three mistakes: a misspelt key, a wrong type, a number out of range.
fn three_mistakes(path: &Path) {
    changed_scene("cornell.json", path, |scene| {
        scene["camra"] = json!(1);
        scene["film"]["width"] = json!("wide");
        scene["film"]["height"] = json!(-4);
    });
}

#[test]
fn every_error_of_a_scene_is_shown_with_its_place_and_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("bad.json");
    three_mistakes(&scene);
    let text = std::fs::read_to_string(&scene).unwrap();
    let ran = etalon_line("render {} -o {}", [&scene, &folder.path().join("x.exr")]).expect(2).says([
        "$.camra",
        "camera",
        "$.film.width",
        "$.film.height",
    ]);
    for key in ["camra", "width", "height"] {
        let line = 1 + text.lines().position(|line| line.contains(&format!("\"{key}\""))).unwrap();
        assert!(ran.stderr.contains(&format!("bad.json:{line}:")), "{key} on line {line}:\n{}", ran.stderr);
    }
    assert_eq!(ran.stdout, "");
    assert_eq!(entries(folder.path()), ["bad.json"]);
}

#[test]
fn with_json_the_errors_are_one_object_on_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("bad.json");
    three_mistakes(&scene);
    let report = etalon_line("render {} -o {} --json", [&scene, &folder.path().join("x.exr")]).expect(2).json();
    assert_eq!(report["scene"], scene.to_str().unwrap());
    let errors = report["errors"].as_array().unwrap();
    let paths: Vec<&str> = errors.iter().map(|error| error["json_path"].as_str().unwrap()).collect();
    for path in ["$.camra", "$.film.width", "$.film.height"] {
        assert!(paths.contains(&path), "{path} is not in {paths:?}");
    }
    for error in errors {
        assert!(error["line"].as_u64().unwrap() >= 1 && error["column"].as_u64().unwrap() >= 1, "{error}");
        for key in ["message", "code", "file"] {
            assert!(!error[key].as_str().unwrap().is_empty(), "{key} of {error}");
        }
    }
    let unknown = errors.iter().find(|error| error["json_path"] == "$.camra").unwrap();
    assert!(unknown["hint"].as_str().unwrap().contains("camera"), "{unknown}");
}

#[test]
fn files_that_are_no_scene_at_all_exit_2() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.json");
    let output = folder.path().join("x.exr");
    etalon_line("render {} -o {}", [&scene, &output]).expect(2).says(["scene.json", "No such file"]);
    etalon_line("render {} -o {}", [folder.path(), &output]).expect(2).says(["directory"]);
    for content in [&b""[..], b"{", b"[]", b"null", b"not json", b"{}", b"\xff\xfe{\0}\0", b"{\"a\": \xff}"] {
        std::fs::write(&scene, content).unwrap();
        let ran = etalon_line("render {} -o {} --json", [&scene, &output]).expect(2);
        let Value::Array(errors) = &ran.json()["errors"] else { panic!("no list of errors: {}", ran.stdout) };
        assert!(!errors.is_empty(), "{content:?}");
        assert!(ran.stderr.contains("scene.json"), "{}", ran.stderr);
    }
    std::fs::write(&scene, "[".repeat(1_000_000)).unwrap();
    etalon_line("render {} -o {}", [&scene, &output]).expect(2);
    assert_eq!(entries(folder.path()), ["scene.json"]);
}

#[test]
fn mistakes_in_usage_outputs_and_scene_are_all_shown_by_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("bad.json");
    three_mistakes(&scene);
    let missing = folder.path().join("missing/x.exr");
    etalon_line("render {} -o {} -o picture.jpg -o y.exr -o y.exr", [&scene, &missing]).expect(2).says([
        "missing",
        "picture.jpg",
        "y.exr",
        "twice",
        "$.camra",
        "$.film.width",
        "$.film.height",
    ]);
}

/// Outputs do not take the place of the scene, nor of an image that it shows, by whatever name.
#[test]
fn an_output_that_the_scene_is_read_from_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    image::RgbImage::from_pixel(2, 2, image::Rgb([9, 9, 9])).save(at("sky.png")).unwrap();
    let scene = r#"{ "etalon": 1, "film": { "width": 4, "height": 4 }, "integrator": { "spp": 4 },
        "camera": { "type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20 },
        "objects": [{ "shape": { "type": "sphere", "radius_m": 1 }, "material": { "type": "lambert", "reflectance": { "type": "image", "file": "sky.png" } } }],
        "lights": [{ "type": "environment", "radiance": 1 }] }"#;
    std::fs::write(at("scene.json"), scene).unwrap();
    let before = std::fs::read(at("sky.png")).unwrap();
    std::fs::create_dir(at("in")).unwrap();
    for output in [at("sky.png"), at("in/../sky.png")] {
        etalon_line("render {} -o {}", [&at("scene.json"), &output]).expect(2).says(["is read from", "sky.png"]);
    }
    assert_eq!(std::fs::read(at("sky.png")).unwrap(), before);
    etalon_line("render {} -o {} -q", [&at("scene.json"), &at("other.png")]).expect(0);
}

#[test]
fn what_lies_outside_the_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = crate::support::scene("cornell.json");
    let output = folder.path().join("x.exr");
    etalon_line("render {} -o {} --size 8x6 --crop 0,0,9,6", [&scene, &output]).expect(2).says(["crop", "8 × 6"]);
    let swapped = etalon_line("render {} -o {} --size 8x6 --crop 4,8,0,6", [&scene, &output]).expect(2);
    swapped.says(["X,Y,W,H"]);
    let swapped = etalon_line("render {} -o {} --size 8x6 --crop 2,8,1,6", [&scene, &output]).expect(2);
    swapped.says(["X,Y,W,H", "columns 2 to 7 and rows 1 to 5", "2,1,6,5"]);
    etalon_line("render {} --size 8x6 --pixel 0,6 --sample 0", [&scene]).expect(2).says(["0,6", "8 × 6"]);
    assert_eq!(entries(folder.path()), [""; 0]);
}

#[test]
fn a_warning_far_along_a_line_does_not_keep_a_scene_from_being_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, output) = (folder.path().join("minified.json"), folder.path().join("x.exr"));
    changed_scene("cornell.json", &scene, |scene| {
        let vertices: Vec<Value> = (0..20_000).map(|i| json!([i, 0, 0])).collect();
        // A second triangle without area is what there is to warn of.
        let mesh = json!({ "type": "mesh", "vertices_m": vertices, "triangles": [[0, 1, 2], [0, 1, 1]] });
        let mesh = mesh.to_string().replace("[0,0,0]", "[0,9,0]");
        let shape: Value = serde_json::from_str(&mesh).unwrap();
        let objects = scene["objects"].as_array_mut().unwrap();
        let material = objects[0]["material"].clone();
        objects.push(json!({ "name": "strip", "shape": shape, "material": material }));
    });
    let value: Value = serde_json::from_str(&std::fs::read_to_string(&scene).unwrap()).unwrap();
    std::fs::write(&scene, value.to_string()).unwrap();
    let ran = etalon_line("render {} -o {} --spp 4 --size 4x4", [&scene, &output]).expect(0);
    assert!(ran.stderr.contains("degenerate-triangles") && ran.stderr.len() < 3000, "{}", ran.stderr);
    assert!(output.exists());
}

#[test]
fn many_mistakes_in_one_long_line_are_shown_briefly_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("minified.json");
    changed_scene("cornell.json", &scene, |scene| {
        let wrong = |i| json!({ "name": format!("{i}"), "shapes": 1, "note": "x".repeat(5000) });
        scene["objects"] = (0..1000).map(wrong).collect();
    });
    let value: Value = serde_json::from_str(&std::fs::read_to_string(&scene).unwrap()).unwrap();
    std::fs::write(&scene, value.to_string()).unwrap();
    let ran = etalon_line("explain {}", [&scene]).expect(2).says(["more errors are not shown", "shapes", "…"]);
    assert!(ran.stderr.len() < 100_000, "{} bytes", ran.stderr.len());
    let longest = ran.stderr.lines().map(|line| line.chars().count()).max().unwrap();
    assert!(longest < 1000, "{longest} columns");
}
