//! The ready-made scenes: each says what it is, keeps to the schema, loads without a warning and renders.

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::support::{etalon, etalon_line, scenes_folder};

/// The scenes that other documents rely on by name.
const PROMISED: [&str; 8] = [
    "assignment.json",
    "cornell-glass.json",
    "cornell.json",
    "diamond.json",
    "furnace.json",
    "integrating-sphere.json",
    "prism.json",
    "veach-mis.json",
];

fn all_scenes() -> Vec<(PathBuf, Value)> {
    let mut scenes: Vec<PathBuf> = std::fs::read_dir(scenes_folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    scenes.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path, value)
    };
    scenes.into_iter().map(read).collect()
}

fn schema() -> Value {
    etalon(["schema"]).expect(0).json()
}

#[test]
fn the_promised_scenes_are_there() {
    let names: Vec<String> =
        all_scenes().iter().map(|(path, _)| path.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    for name in PROMISED {
        assert!(names.iter().any(|other| other == name), "{name} is missing");
    }
}

#[test]
fn every_scene_keeps_to_the_schema() {
    let validator = jsonschema::validator_for(&schema()).expect("the schema is a schema");
    for (path, scene) in all_scenes() {
        let errors: Vec<String> =
            validator.iter_errors(&scene).map(|error| format!("{}: {error}", error.instance_path())).collect();
        assert!(errors.is_empty(), "{}: {errors:#?}", path.display());
    }
}

#[test]
fn the_schema_refuses_what_the_program_refuses() {
    let validator = jsonschema::validator_for(&schema()).expect("the schema is a schema");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.json");
    type Change = (&'static str, fn(&mut Value));
    let changes: [Change; 6] = [
        ("an unknown key", |scene| scene["camra"] = json!({})),
        ("an unknown key deeper down", |scene| scene["film"]["wdith"] = json!(1)),
        ("a word for a number", |scene| scene["film"]["width"] = json!("wide")),
        ("no camera", |scene| drop(scene.as_object_mut().unwrap().remove("camera"))),
        ("a size of 0", |scene| scene["film"]["width"] = json!(0)),
        ("a scene that is a list", |scene| *scene = json!([])),
    ];
    for (what, change) in changes {
        let (_, mut scene) = all_scenes().remove(0);
        change(&mut scene);
        assert!(!validator.is_valid(&scene), "{what} keeps to the schema");
        std::fs::write(&path, scene.to_string()).unwrap();
        etalon_line("render {} -o {}", [&path, &folder.path().join("x.exr")]).expect(2);
    }
}

#[test]
fn every_scene_loads_without_a_warning_and_renders_finite_samples_only() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    for (path, _) in all_scenes() {
        // Enough that the one path in a thousand is there that finds the prism's spectrum.
        let ran = etalon_line("render {} -o {} --size 32x24 --spp 16 --json", [&path, &output]).expect(0);
        let report = ran.json();
        assert_eq!(report["warnings"], json!([]), "{}", path.display());
        assert_eq!(report["nonfinite"], 0, "{}", path.display());
        assert_eq!(ran.stderr, "", "{}", path.display());
        let (_, file) = crate::support::pixel_bits(&output);
        let light: f64 = file.picture.channel("G").unwrap().iter().map(|sample| f64::from(*sample)).sum();
        assert!(light.is_finite() && light > 0.0, "{} is black", path.display());
    }
}
