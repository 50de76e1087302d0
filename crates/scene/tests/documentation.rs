//! docs/scene-format.md says what the reader does, and the scenes of the tutorial and of the how-to pages are right.

use crate::common::{Parts, RIGHT};
use etalon_scene::{Code, json};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const PAGE: &str = include_str!("../../../docs/scene-format.md");

/// The JSON examples of a page: what each is of, and its text.
fn examples(page: &str) -> Vec<(&str, &str)> {
    let blocks = page.split("\n```json ").skip(1);
    blocks
        .map(|block| {
            let (kind, rest) = block.split_once('\n').expect("a line");
            (kind, rest.split_once("\n```").expect("an end").0)
        })
        .collect()
}

#[test]
fn every_example_is_right() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"));
    let all = examples(PAGE);
    assert!(all.len() >= 20, "{}", all.len());
    assert_right(&all, folder);
}

#[test]
fn every_example_of_the_tutorial_and_of_the_how_to_pages_is_right() {
    let docs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs"));
    let mut pages = vec![docs.join("tutorial.md")];
    pages.extend(fs::read_dir(docs.join("how-to")).unwrap().map(|entry| entry.unwrap().path()));
    let texts: Vec<String> = pages.iter().map(|page| fs::read_to_string(page).unwrap()).collect();
    let all: Vec<_> = texts.iter().flat_map(|text| examples(text)).collect();
    assert!(all.len() >= 7, "{}", all.len());
    assert_right(&all, &docs.join("../scenes"));
}

/// The tutorial's scene is the file that it names, and the file of its last scene has all that the page adds.
#[test]
fn the_files_of_the_tutorial_are_what_the_page_says() {
    let docs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs"));
    let page = fs::read_to_string(docs.join("tutorial.md")).unwrap();
    let file = |name: &str| -> Value {
        serde_json::from_str(&fs::read_to_string(docs.join("tutorial").join(name)).unwrap()).unwrap()
    };
    let blocks: Vec<(&str, Value)> =
        examples(&page).into_iter().map(|(kind, text)| (kind, serde_json::from_str(text).unwrap())).collect();
    let [("scene", table), ("materials", materials), ("fragment", objects)] = &blocks[..] else {
        panic!("other examples: {blocks:?}");
    };
    assert_eq!(*table, file("table.json"));
    let mut glass = table.clone();
    for (name, material) in materials.as_object().unwrap() {
        glass["materials"][name] = material.clone();
    }
    glass["objects"].as_array_mut().unwrap().extend(objects.as_array().unwrap().iter().cloned());
    assert_eq!(glass, file("glass.json"));
}

fn assert_right(examples: &[(&str, &str)], folder: &Path) {
    for &(kind, text) in examples {
        let object = |shape: &str, transform: &str| {
            format!("[{{\"shape\": {shape}, \"material\": {{\"type\": \"black\"}}, \"transform\": {transform}}}]")
        };
        let ball = "{\"type\": \"sphere\", \"radius_m\": 1}";
        let scene = match kind {
            "scene" => text.to_owned(),
            "camera" => Parts { camera: text, ..RIGHT }.text(),
            "film" => Parts { film: text, ..RIGHT }.text(),
            "spectra" => Parts { spectra: &text.replacen('{', "{\"grey\": 0.5,", 1), ..RIGHT }.text(),
            "materials" => {
                let white = "{\"white\": {\"type\": \"black\"},";
                // A name that an example has itself is not given twice.
                let materials = if text.contains("\"white\"") { text.to_owned() } else { text.replacen('{', white, 1) };
                Parts { materials: &materials, ..RIGHT }.text()
            }
            "object" => Parts { objects: &format!("[{text}]"), ..RIGHT }.text(),
            "shape" => Parts { objects: &object(text, "[]"), ..RIGHT }.text(),
            "transform" => Parts { objects: &object(ball, text), ..RIGHT }.text(),
            "placed" => {
                // Two keys of the top level.
                let keys = text.trim().trim_start_matches('{').trim_end_matches('}');
                RIGHT.text().replacen('{', &format!("{{{keys},"), 1)
            }
            "lights" => Parts { lights: text, ..RIGHT }.text(),
            "integrator" => Parts { integrator: text, ..RIGHT }.text(),
            "fragment" => {
                let _: Value = serde_json::from_str(text).expect("JSON");
                continue;
            }
            other => panic!("an example of {other:?}?"),
        };
        match etalon_scene::parse_in(&scene, "example.json", Some(folder), None) {
            // No schema lies in the folder.
            Ok(mut loaded) => {
                loaded.warnings.retain(|warning| warning.code != Code::NoSchema);
                assert_eq!(loaded.warnings, [], "{text}");
            }
            Err(errors) => panic!("{errors}\n{scene}"),
        }
    }
}

#[test]
fn every_error_and_warning_is_listed() {
    for code in Code::ALL {
        assert!(PAGE.contains(&format!("\n| `{code}` |")), "{code}");
    }
}

#[test]
fn every_key_and_word_of_the_schema_is_described() {
    fn collect(schema: &Value, found: &mut BTreeSet<String>) {
        match schema {
            Value::Object(members) => {
                if let Some(Value::Object(properties)) = members.get("properties") {
                    found.extend(properties.keys().cloned());
                }
                found.extend(members.get("const").and_then(|word| word.as_str()).map(str::to_owned));
                let words = members.get("enum").and_then(|words| words.as_array()).into_iter().flatten();
                found.extend(words.filter_map(|word| word.as_str()).map(str::to_owned));
                members.values().for_each(|member| collect(member, found));
            }
            Value::Array(elements) => elements.iter().for_each(|element| collect(element, found)),
            _ => {}
        }
    }
    let mut all = BTreeSet::new();
    collect(&etalon_scene::schema(), &mut all);
    assert!(all.len() > 80, "{}", all.len());
    let missing: Vec<&String> = all
        .iter()
        .filter(|word| !PAGE.contains(&format!("`{word}`")) && !PAGE.contains(&format!("\"{word}\"")))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn limits_are_the_ones_stated() {
    assert_eq!(json::MAX_BYTES, 64 << 20);
    for text in ["10,000,000 |", "64 levels", "| 50 errors and 50 warnings; "] {
        assert!(PAGE.contains(text), "{text}");
    }
    assert_eq!((json::MAX_VALUES, json::MAX_DEPTH, json::MAX_PROBLEMS), (10_000_000, 64, 50));
}
