//! Words of other programs give a hint wherever the word that stands for them is right, and are never accepted.

use crate::common::{EVERYTHING, RIGHT};
use etalon_scene::json::{Answer, NEIGHBOURS, Neighbour, Place};
use etalon_scene::{Code, Problem};
use serde_json::{Map, Value, json};

/// Right scenes that together have every word that the table answers with. Some name files that do not exist.
fn scenes() -> Vec<Value> {
    let right: Value = serde_json::from_str(&RIGHT.text()).expect("JSON");
    let with = |pointer: &str, value: Value| {
        let mut scene = right.clone();
        let (parent, key) = pointer.rsplit_once('/').expect("a path");
        scene.pointer_mut(parent).expect("there")[key] = value;
        scene
    };
    let view = |rest: Value| {
        let mut camera = json!({ "type": "perspective", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0] });
        camera.as_object_mut().expect("an object").extend(rest.as_object().expect("an object").clone());
        with("/camera", camera)
    };
    let orthographic =
        json!({ "type": "orthographic", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "height_m": 2 });
    let shape = |value: Value| with("/objects/0/shape", value);
    let own = |value: Value| with("/objects/0/material", value);
    let medium = |name: &str| own(json!({ "type": "dielectric", "interior": name }));
    let metal = |name: &str| own(json!({ "type": "conductor", "metal": name, "outside_fit": "clamp" }));
    let image = |file: &str, key: &str, word: &str| {
        own(json!({ "type": "lambert", "reflectance": { "type": "image", "file": file, key: word } }))
    };
    let sky = |projection: &str| json!([{ "type": "environment", "image": { "file": "sky.exr", "projection": projection, "scale": 2 } }]);
    vec![
        serde_json::from_str(EVERYTHING).expect("JSON"),
        right.clone(),
        view(json!({ "horizontal_fov_deg": 40 })),
        view(json!({ "vertical_fov_deg": 40, "lens": { "radius_m": 0.1, "focus_distance_m": 2 } })),
        with("/camera", orthographic),
        with("/film/width", json!(8)),
        with("/film", json!({ "width": 8, "height": 8, "filter": { "type": "tent" } })),
        with("/film", json!({ "width": 8, "height": 8, "filter": { "type": "gaussian" } })),
        with("/film", json!({ "width": 8, "height": 8, "filter": { "type": "lanczos" } })),
        shape(json!({ "type": "mesh", "file": "ball.ply" })),
        medium("N-BK7"),
        medium("N-SF11"),
        medium("fused-silica"),
        metal("Au"),
        metal("Ag"),
        metal("Cu"),
        metal("Al"),
        image("a.png", "encoding", "linear"),
        image("a.png", "wrap", "clamp"),
        image("a.png", "wrap", "mirror"),
        image("a.png", "filter", "bilinear"),
        image("a.png", "filter", "nearest"),
        with("/lights", sky("latitude-longitude")),
        with("/lights", sky("equal-area")),
        with("/objects/0/normal_map", json!({ "file": "a.png" })),
        with("/objects/0/bump_map", json!({ "file": "a.png" })),
        with("/integrator", json!({ "sampler": "sobol", "light_selection": "tree" })),
    ]
}

fn problems(scene: &Value) -> Vec<Problem> {
    match etalon_scene::parse(&scene.to_string(), "test.json") {
        Ok((_, warnings)) => warnings,
        Err(errors) => errors.problems,
    }
}

fn is_unknown(problem: &&Problem) -> bool {
    [Code::UnknownKey, Code::UnknownWord, Code::UnknownName].contains(&problem.code)
}

/// All scenes that come from one by putting `foreign` in place of `word`, once each.
fn replaced(scene: &Value, place: Place, word: &str, foreign: &str) -> Vec<Value> {
    fn visit(value: &Value, at: &str, act: &mut impl FnMut(&str, &Value)) {
        act(at, value);
        match value {
            Value::Object(members) => {
                members.iter().for_each(|(key, member)| visit(member, &format!("{at}/{key}"), act));
            }
            Value::Array(elements) => {
                elements.iter().enumerate().for_each(|(i, element)| visit(element, &format!("{at}/{i}"), act));
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    visit(scene, "", &mut |at, value| {
        let new = match (place, value) {
            (Place::Key, Value::Object(members)) if members.contains_key(word) && !at.ends_with("spectra") => {
                let renamed = |(key, value): (&String, &Value)| {
                    (if key == word { foreign.to_owned() } else { key.clone() }, value.clone())
                };
                Value::Object(members.iter().map(renamed).collect::<Map<_, _>>())
            }
            (Place::Key, _) => return,
            (_, Value::String(text)) if text == word => json!(foreign),
            _ => return,
        };
        let mut changed = scene.clone();
        *changed.pointer_mut(at).expect("there") = new;
        found.push(changed);
    });
    found
}

/// Whether a foreign word in place of `word` gives the hint of its row somewhere, and is refused.
fn hints(scenes: &[Value], row: &Neighbour, foreign: &str, word: &str) -> bool {
    let hint = row.answer.hint();
    scenes.iter().any(|scene| {
        replaced(scene, row.place, word, foreign).iter().any(|changed| {
            let found = problems(changed);
            let unknown: Vec<&Problem> = found.iter().filter(is_unknown).collect();
            matches!(unknown.as_slice(), [one, ..] if one.hint.as_ref() == Some(&hint))
        })
    })
}

/// A scene in which `value` is the material of an object, or the intensity of a light.
fn with_value(place: Place, value: Value) -> Value {
    let mut scene: Value = serde_json::from_str(&RIGHT.text()).expect("JSON");
    match place {
        Place::Material => scene["objects"][0]["material"] = value,
        Place::Spectrum => {
            scene["lights"] = json!([{ "type": "point", "position_m": [0, 0, 0], "intensity": value }]);
        }
        Place::Medium => scene["objects"][0]["material"] = json!({ "type": "dielectric", "interior": value }),
        other => panic!("no value replaces a word at {other:?}"),
    }
    scene
}

#[test]
fn each_foreign_word_gives_its_hint_and_the_hinted_word_is_right_there() {
    let scenes = scenes();
    for scene in &scenes {
        // Files may be missing, but every word is known.
        assert_eq!(problems(scene).iter().find(is_unknown), None);
    }
    let mut silent = Vec::new();
    for row in NEIGHBOURS {
        for foreign in row.foreign.split(' ') {
            let mut expect = |word: &str| {
                if !hints(&scenes, row, foreign, word) {
                    silent.push(format!("{:?}: {foreign} in place of {word}", row.place));
                }
            };
            match row.answer {
                Answer::Word(word, _) | Answer::Advice(word, _) => {
                    expect(word);
                }
                Answer::OneOf(words) => words.iter().for_each(|word| expect(word)),
                Answer::Write(text) => {
                    let found = problems(&with_value(row.place, json!(foreign)));
                    let hint = found.iter().find(is_unknown).and_then(|problem| problem.hint.clone());
                    assert_eq!(hint, Some(row.answer.hint()), "{foreign}");
                    let written = serde_json::from_str(text).expect("JSON");
                    let found = problems(&with_value(row.place, written));
                    assert!(!found.iter().any(|p| p.severity == etalon_scene::Severity::Error), "{found:#?}");
                }
            }
        }
    }
    assert!(silent.is_empty(), "no hint for {silent:#?}");
}

#[test]
fn foreign_words_are_plain_and_stand_once_in_a_row() {
    for row in NEIGHBOURS {
        let words: Vec<&str> = row.foreign.split(' ').collect();
        for (i, word) in words.iter().enumerate() {
            let plain = !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit());
            assert!(plain, "{word:?} can never be found");
            assert!(!words[..i].contains(word), "{word} is twice in its row");
        }
    }
}
