//! `etalon explain`: what it says of each ready-made scene, word for word, and what a study changes.

use std::path::{Path, PathBuf};

use etalon_picture::Attribute;
use serde_json::Value;

use crate::support::{changed_scene, etalon_line, pixel_bits, scene, scenes_folder};

fn snapshots() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/snapshots/explain")
}

/// The texts are read by eye when they change: run with `ETALON_UPDATE_SNAPSHOTS=1` and look at the difference.
#[test]
fn each_ready_made_scene_is_explained_as_it_was_when_it_was_last_read() {
    let update = std::env::var_os("ETALON_UPDATE_SNAPSHOTS").is_some();
    let mut names: Vec<String> = std::fs::read_dir(scenes_folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".json"))
        .collect();
    names.sort();
    for name in names {
        let said = etalon_line("explain {}", [&scene(&name)]).expect(0).stdout;
        let file = snapshots().join(name.replace(".json", ".txt"));
        if update {
            std::fs::create_dir_all(snapshots()).unwrap();
            std::fs::write(&file, &said).unwrap();
        }
        let expected = std::fs::read_to_string(&file).unwrap_or_default();
        assert_eq!(said, expected, "{} is not what is said of {name}", file.display());
    }
}

#[test]
fn the_plan_for_machines_is_the_one_that_the_picture_carries() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    let scene = scene("prism.json");
    let explained = etalon_line("explain {} --json --spp 1 --size 8x5", [&scene]).expect(0).json();
    etalon_line("render {} -o {} --spp 1 --size 8x5", [&scene, &output]).expect(0);
    let Attribute::Text(carried) = &pixel_bits(&output).1.attributes["plan"] else { panic!("the plan is no text") };
    let carried: Value = serde_json::from_str(carried).unwrap();
    assert_eq!(explained["plan"], carried);
    assert_eq!(carried["kernel"], "hero-8");
    let effects = carried["effects"].as_array().unwrap();
    let dispersion = effects.iter().find(|effect| effect["name"] == "dispersion").unwrap();
    assert_eq!(dispersion["on"], true);
    assert!(dispersion["because"].as_str().unwrap().starts_with("material \"flint\" of \"prism\": n 1.763–1.870"));
}

#[test]
fn leaving_out_what_is_called_for_marks_the_picture_on_the_terminal_and_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.exr");
    let line = "render {} -o {} --spp 1 --size 8x5 --without dispersion,lens";
    etalon_line(line, [&scene("prism.json"), &output])
        .expect(0)
        .says(["approximation", "without dispersion: every index of refraction is that of one wavelength"]);
    let (_, file) = pixel_bits(&output);
    // The scene has no lens to leave out.
    let without = "without dispersion: every index of refraction is that of one wavelength";
    assert_eq!(file.attributes["approximation"], Attribute::Text(without.to_owned()));
    // Nor is a picture marked that is none.
    etalon_line("render {} -o {} --spp 1 --size 8x5 --without lens", [&scene("prism.json"), &output]).expect(0);
    assert!(!pixel_bits(&output).1.attributes.contains_key("approximation"));
}

#[test]
fn a_study_that_contradicts_the_scene_or_itself_is_refused() {
    let cornell = scene("cornell.json");
    for (flags, says) in [
        ("--force lens --without lens", "lens cannot be forced and left out at once"),
        ("--force specular-chains", "specular-chains cannot be forced"),
        ("--force mis --light-sampling light", "integrator.light_sampling is \"light\""),
        ("--force blur", "there is no effect \"blur\"; the effects are wavelengths, dispersion"),
    ] {
        etalon_line(&format!("explain {{}} {flags}"), [&cornell]).expect(2).says([says]);
    }
}

#[test]
fn what_effects_cost_and_would_cost_can_be_measured() {
    let folder = tempfile::tempdir().unwrap();
    let small = folder.path().join("small.json");
    changed_scene("furnace.json", &small, |scene| {
        scene["film"]["width"] = 16.into();
        scene["film"]["height"] = 12.into();
    });
    let report = etalon_line("explain {} --measure --json", [&small]).expect(0).json();
    let costs = report["costs"].as_array().unwrap();
    let names = |on: bool| -> Vec<&str> {
        let of = costs.iter().filter(|cost| cost["on"] == on);
        of.map(|cost| cost["effect"].as_str().unwrap()).collect()
    };
    assert_eq!(names(true), ["environment"]);
    assert_eq!(
        names(false),
        [
            "wavelengths",
            "dispersion",
            "lens",
            "shadow-rays",
            "mis",
            "nested-dielectrics",
            "absorption",
            "polarisation",
            "motion"
        ]
    );
    assert!(costs.iter().all(|cost| cost["ratio"].as_f64().unwrap() > 0.0));
    let text = etalon_line("explain {} --measure", [&small]).expect(0).stdout;
    assert_eq!(text.matches("(would cost ").count(), names(false).len(), "{text}");
    assert_eq!(text.matches("(costs ").count(), names(true).len(), "{text}");
}

#[test]
fn polarisation_is_followed_where_it_is_asked_for_and_what_it_would_change_is_said_elsewhere() {
    let glass = scene("cornell-glass.json");
    let plain = etalon_line("explain {} --json", [&glass]).expect(0).json();
    let polarised = etalon_line("explain {} --json --polarised", [&glass]).expect(0).json();
    let effect = |plan: &Value| {
        let effects = plan["plan"]["effects"].as_array().unwrap();
        effects.iter().find(|effect| effect["name"] == "polarisation").unwrap().clone()
    };
    assert_eq!((&effect(&plain)["on"], &effect(&polarised)["on"]), (&Value::Bool(false), &Value::Bool(true)));
    assert!(effect(&plain)["because"].as_str().unwrap().contains("factor of 2"));
    assert_eq!(polarised["plan"]["kernel"], "polarised-hero-8");
    let path = etalon_line("render {} --pixel 300,300 --sample 0 --polarised --json", [&glass]).expect(0).json();
    assert_eq!(path["stokes"].as_array().unwrap().len(), 3);
    let path = etalon_line("render {} --pixel 300,300 --sample 0 --json", [&glass]).expect(0).json();
    assert!(path.get("stokes").is_none());
}
