//! The schema and the reader agree, and neither breaks on anything.

mod changes;
mod plausible;

use crate::common::{EVERYTHING, RIGHT};
use changes::{change, changed, places};
use etalon_scene::{Code, Severity};
use jsonschema::Validator;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::LazyLock;

static VALIDATOR: LazyLock<Validator> = LazyLock::new(|| {
    let schema = etalon_scene::schema();
    jsonschema::meta::validate(&schema).expect("a JSON Schema");
    jsonschema::draft202012::new(&schema).expect("a usable one")
});

fn everything() -> Value {
    serde_json::from_str(EVERYTHING).expect("JSON")
}

#[test]
fn the_schema_accepts_right_scenes() {
    for text in [EVERYTHING, &RIGHT.text()] {
        let value = serde_json::from_str(text).expect("JSON");
        let faults: Vec<String> =
            VALIDATOR.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(faults.is_empty(), "{faults:#?}");
    }
}

#[test]
fn every_scene_of_the_repository_is_right() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let files = std::fs::read_dir(folder).expect("the folder of scenes").map(|entry| entry.expect("an entry").path());
    let scenes: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "json")).collect();
    assert!(scenes.len() >= 8, "{}", scenes.len());
    for path in scenes {
        let text = std::fs::read_to_string(&path).expect("readable");
        let value = serde_json::from_str(&text).expect("JSON");
        let faults: Vec<String> =
            VALIDATOR.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(faults.is_empty(), "{}: {faults:#?}", path.display());
        match etalon_scene::load(&path) {
            Ok((_, warnings)) => assert_eq!(warnings, [], "{}", path.display()),
            Err(errors) => panic!("{errors}"),
        }
        assert!(
            value["comment"].is_string() || value["comment"].is_array(),
            "{} does not say what it is",
            path.display()
        );
    }
}

#[test]
fn the_schema_refuses_what_it_can_see_to_be_wrong() {
    for (path, value) in [
        ("/etalon", json!(2)),
        ("/film/width", json!(0)),
        ("/film/width", json!("64")),
        ("/film/filter/type", json!("sharp")),
        ("/camera/direction", json!([0, 0, -1])),
        ("/camera/vertical_fov_deg", json!(40)),
        ("/camera/lens/radius_m", json!(0.1)),
        ("/camera/up", json!([0, 0, 0])),
        ("/spectra/half", json!(-1)),
        ("/spectra/half", json!(null)),
        ("/materials/glass/interior", json!("N-BK8")),
        ("/materials/gold/metal", json!("gold")),
        ("/materials/gold/n", json!([1, 1])),
        ("/objects/0/shape/radius_m", json!(-1)),
        ("/objects/0/shape/radius", json!(1)),
        ("/objects/4/transform/0/scale", json!(0)),
        ("/objects/4/transform/0/translate_m", json!([0, 0, 1])),
        ("/objects/4/shape/triangles/0", json!([0, 1])),
        ("/lights/0/type", json!("lamp")),
        ("/integrator/max_depth", json!(0)),
        ("/integrator/max_depth", json!("none")),
        ("/integrator/sampler", json!("halton")),
        ("/integrator/roulette", json!(1)),
        ("/film/bands_nm", json!([400, 700])),
        ("/materials/lambert/type", json!("diffuse")),
        ("/materials/lambert/reflectance", json!([1, 0, 0])),
        ("/materials/lambert/reflectance", json!({ "type": "rgb", "rgb": [1, 0] })),
        ("/materials/lambert/reflectance", json!({ "rgb": [1, 0, 0] })),
        ("/materials/solid/exterior", json!(1)),
        ("/materials/clay/roughness", json!(1.5)),
        ("/materials/dusty/second/type", json!("none")),
        ("/materials/mirror", json!("lambert")),
        ("/objects/0/material", json!(7)),
        ("/objects/0/shape", json!([])),
        ("/objects/4/transform/1/scale/0", json!(0)),
        ("/lights/0/intensity", json!(true)),
        ("/lights/2/image", json!({ "file": "sky.exr" })),
        ("/groups/ball/objects/0/shape/type", json!("ball")),
    ] {
        let mut scene = everything();
        let (parent, key) = path.rsplit_once('/').expect("a path");
        let parent = scene.pointer_mut(parent).expect("there");
        match parent.as_array_mut() {
            Some(list) => list[key.parse::<usize>().expect("an index")] = value,
            None => parent[key] = value,
        }
        assert!(!VALIDATOR.is_valid(&scene), "{path}");
        assert!(etalon_scene::parse(&scene.to_string(), "test.json").is_err(), "{path}");
    }
}

/// The parts of a part of a schema, without conditions, which only ask for a kind.
fn below(members: &serde_json::Map<String, Value>) -> impl Iterator<Item = &Value> {
    members.iter().filter(|(key, _)| *key != "if").map(|(_, member)| member)
}

/// Every key of every record in a schema.
fn keys(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(members) => {
            if let Some(Value::Object(properties)) = members.get("properties") {
                found.extend(properties.keys().cloned());
            }
            below(members).for_each(|member| keys(member, found));
        }
        Value::Array(elements) => elements.iter().for_each(|element| keys(element, found)),
        _ => {}
    }
}

#[test]
fn every_key_of_the_schema_has_a_description_and_is_exercised() {
    fn described(schema: &Value) {
        if let Some(Value::Object(properties)) = schema.get("properties") {
            for (key, property) in properties {
                let text = property["description"].as_str().unwrap_or_default();
                assert!(text.len() >= 4, "{key} is not described");
            }
        }
        match schema {
            Value::Object(members) => below(members).for_each(described),
            Value::Array(elements) => elements.iter().for_each(described),
            _ => {}
        }
    }
    let schema = etalon_scene::schema();
    described(&schema);
    let mut all = BTreeSet::new();
    keys(&schema, &mut all);
    let unused: Vec<&String> = all.iter().filter(|key| !EVERYTHING.contains(&format!("\"{key}\":"))).collect();
    // These exclude others that the file has, or name files; the tests of camera, film, meshes, textures and environments have
    // them.
    let exclusive = ["height_m", "lobes", "nadir", "sensor_width_m", "sigma_px", "vertical_fov_deg", "zenith_radiance"];
    let of_files = ["encoding", "file", "wrap", "wrap_v"];
    let of_detail = [
        "bitangent",
        "terminator",
        "bump_map",
        "albedo_grid",
        "channel",
        "cutoff",
        "metallic_image",
        "normal_map",
        "opacity_image",
        "quantity",
        "roughness_image",
        "strength",
        "thickness_image",
        "weight_image",
    ];
    let of_skies = ["forward", "projection", "rotation_deg"];
    // The tests of compound lenses have these.
    let of_lenses = [
        "aspheric",
        "coating",
        "conic",
        "film_distance_m",
        "lens_file",
        "radius_mm",
        "semi_aperture_mm",
        "stop",
        "surfaces",
        "thickness_mm",
    ];
    let mut expected = [exclusive.as_slice(), &of_files, &of_detail, &of_skies, &of_lenses].concat();
    expected.sort_unstable();
    assert_eq!(unused, expected);
}

/// Each fault of a scene: the path of the value, and what is wrong with it.
fn faults(scene: &Value) -> Vec<(String, String)> {
    VALIDATOR.iter_errors(scene).map(|error| (error.instance_path().to_string(), error.to_string())).collect()
}

#[test]
fn an_unknown_key_is_one_error_at_its_object() {
    let mut all = vec![String::new()];
    places(&everything(), String::new(), &mut all);
    let mut tried = 0;
    for path in all {
        let mut scene = everything();
        let place = scene.pointer_mut(&path).expect("there");
        // Names in these are the file's own.
        let named = ["/spectra", "/materials", "/groups"].contains(&path.as_str());
        if let Some(members) = place.as_object_mut().filter(|_| !named) {
            members.insert("radus".to_owned(), json!(1));
            let found = faults(&scene);
            assert!(
                matches!(found.as_slice(), [(at, text)] if *at == path && text.contains("radus")),
                "{path}: {found:#?}"
            );
            tried += 1;
        }
    }
    assert!(tried > 60, "{tried}");
}

#[test]
fn a_wrong_word_or_value_is_one_error_at_its_place() {
    for (path, value) in [
        ("/materials/glass/type", json!("glas")),
        ("/materials/glass/interior", json!("BK7")),
        ("/materials/lambert/reflectance", json!([1, 0, 0])),
        ("/materials/lambert", json!([])),
        ("/materials/dispersive/interior/name", json!("BK7")),
        ("/spectra/red/rgb", json!(1)),
        ("/objects/0/material", json!(7)),
        ("/objects/0/shape/type", json!("rectangle")),
        ("/objects/0/shape/radius_m", json!("1")),
        ("/objects/4/transform/1/scale/0", json!("2")),
        ("/objects/4/material/reflectance/value", json!("2")),
        ("/lights/0/type", json!("area")),
        ("/film/filter/radius_px", json!(-1)),
        ("/integrator/sampler", json!("halton")),
        ("/integrator/max_depth", json!("none")),
        ("/objects/4/transform/0", json!(2)),
        ("/camera/lens", json!(0.1)),
    ] {
        let mut scene = everything();
        *scene.pointer_mut(path).expect("there") = value;
        let found = faults(&scene);
        assert!(matches!(found.as_slice(), [(at, _)] if at == path), "{path}: {found:#?}");
    }
}

/// Editors list the words of a `type` from one enum, with what each means.
#[test]
fn every_type_is_a_list_of_words() {
    fn visit(schema: &Value, found: &mut Vec<Vec<String>>) {
        if let Some(tag) = schema.pointer("/properties/type").filter(|tag| tag.get("enum").is_some()) {
            let words: Vec<String> = serde_json::from_value(tag["enum"].clone()).expect("a list of words");
            let meanings = tag["enumDescriptions"].as_array().expect("meanings");
            assert_eq!(words.len(), meanings.len());
            assert!(meanings.iter().all(|text| text.as_str().is_some_and(|text| text.len() > 5)), "{meanings:?}");
            let cases = schema["allOf"].as_array().expect("cases");
            let of =
                |case: &Value| case.pointer("/if/properties/type/const").and_then(Value::as_str).map(str::to_owned);
            assert_eq!(cases.iter().filter_map(of).collect::<Vec<_>>(), words);
            found.push(words);
        }
        match schema {
            Value::Object(members) => below(members).for_each(|member| visit(member, found)),
            Value::Array(elements) => elements.iter().for_each(|element| visit(element, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    visit(&etalon_scene::schema(), &mut found);
    for word in ["perspective", "gaussian", "lambert", "sphere", "environment", "rgb", "sellmeier"] {
        assert!(found.iter().any(|words| words.iter().any(|listed| listed == word)), "{word}");
    }
}

/// What holds of any outcome: places lie in the text, lines and columns are theirs, an accepted scene keeps its promises.
fn sane(text: &str) -> Result<(), TestCaseError> {
    let problems = match etalon_scene::parse(text, "test.json") {
        Ok((scene, warnings)) => {
            prop_assert!(warnings.iter().all(|w| w.severity == Severity::Warning));
            let camera = &scene.camera;
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            prop_assert!((dot(camera.forward, camera.forward) - 1.0).abs() < 1e-14);
            prop_assert!((dot(camera.up, camera.up) - 1.0).abs() < 1e-14);
            prop_assert!(dot(camera.up, camera.forward).abs() < 1e-14);
            for object in &scene.objects {
                prop_assert!(object.material < scene.materials.len());
                let t = &object.transform;
                prop_assert!(t.linear.iter().flatten().chain(&t.translation_m).all(|v| v.is_finite()));
            }
            // Everything that is known over the range is a number there.
            let [first, last] = scene.integrator.wavelength_range_nm;
            for material in &scene.materials {
                for nm in [first, 0.5 * (first + last), last] {
                    let good = plausible::kind(&material.kind, nm, material.medium.is_some());
                    prop_assert!(good, "{material:?} at {nm}");
                    for medium in material.media().chain(&scene.medium) {
                        let both = [&medium.absorption, &medium.scattering].map(|spectrum| spectrum.eval(nm));
                        prop_assert!(both.iter().all(|v| *v >= 0.0 && v.is_finite()), "{medium:?} at {nm}");
                    }
                }
            }
            warnings
        }
        Err(errors) => {
            prop_assert!(errors.errors().next().is_some());
            prop_assert_eq!(&errors.text, text);
            errors.problems
        }
    };
    for problem in &problems {
        prop_assert!(problem.json_path.starts_with('$'));
        let (start, end) = (problem.span.start, problem.span.end);
        prop_assert!(start <= end && end <= text.len(), "{problem}");
        prop_assert!(text.is_char_boundary(start) && text.is_char_boundary(end), "{problem}");
        let before = text[..start].replace("\r\n", "\n").replace('\r', "\n");
        prop_assert_eq!(problem.line, before.matches('\n').count() + 1);
        prop_assert_eq!(problem.column, before.rsplit('\n').next().unwrap_or("").chars().count() + 1);
    }
    Ok(())
}

/// Cases from a fixed seed: a failure comes back, and none comes by chance.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(cases) }
}

// A parse of the whole scene takes some 20 ms, nearly all of it for upsampling its two colours.
proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn schema_and_reader_agree_on_changed_scenes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), change()), 1..3),
    ) {
        let scene = changed(&changes);
        let valid = VALIDATOR.is_valid(&scene);
        let outcome = etalon_scene::parse(&scene.to_string(), "test.json");
        if !valid {
            prop_assert!(outcome.is_err(), "only the schema refuses {scene}");
        }
        if let Err(errors) = outcome {
            // What is a matter of form alone, the schema must see as well.
            let form = [Code::UnknownKey, Code::WrongType, Code::UnknownWord, Code::Version, Code::ZeroVector];
            let seen = errors.errors().find(|e| form.contains(&e.code));
            prop_assert!(!valid || seen.is_none(), "only the reader refuses: {}", seen.expect("one"));
        }
    }

    #[test]
    fn changed_scenes_neither_panic_nor_break_promises(
        changes in prop::collection::vec((any::<prop::sample::Index>(), change()), 1..5),
    ) {
        sane(&changed(&changes).to_string())?;
    }

}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn damaged_texts_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, 0..40_usize, any::<char>()), 1..4),
        marks in prop::collection::vec(prop::sample::select("{}[],:\"'/*-+.0x1eNaN\\\u{a0}\u{feff}\n\r\té".chars().collect::<Vec<_>>()), 3),
    ) {
        let mut text = EVERYTHING.to_owned();
        for (i, (place, kind, length, any)) in edits.into_iter().enumerate() {
            let mut at = place.index(text.len().max(1)).min(text.len());
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            let mut end = (at + length).min(text.len());
            while !text.is_char_boundary(end) {
                end += 1;
            }
            match kind {
                0 => text.truncate(at),
                1 => text.replace_range(at..end, ""),
                2 => text.insert(at, marks[i % marks.len()]),
                _ => text.insert(at, any),
            }
        }
        // A mark at the very start is taken off before anything is counted.
        sane(text.strip_prefix('\u{feff}').unwrap_or(&text))?;
    }

    #[test]
    fn noise_never_panics(text in "[\\[\\]{}:,\"0-9eE+\\-. \n/*'a-f\\\\]{0,80}") {
        sane(&text)?;
    }
}
