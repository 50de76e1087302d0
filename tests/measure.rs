//! `etalon measure`: the table, the files, when it stops, what it refuses.

use serde_json::{Value, json};

use crate::support::{etalon_line, scene};

/// A point of 100 cd, 2 m above a meter and a grid.
fn lit() -> Value {
    json!({
        "etalon": 1,
        "camera": { "type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40 },
        "film": { "width": 8, "height": 8 },
        "objects": [{ "shape": { "type": "sphere", "center_m": [0, 50, 0], "radius_m": 1 }, "material": { "type": "black" } }],
        "lights": [{ "type": "point", "position_m": [0, 0, 2], "intensity_cd": 100 }],
        "meters": [
            { "type": "irradiance", "name": "a, \"b\"", "position_m": [0, 0, 0], "normal": [0, 0, 1] },
            { "type": "irradiance-grid", "name": "grid", "origin_m": [-1, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0], "columns": 2, "rows": 2 }
        ]
    })
}

#[test]
fn readings_stand_in_the_table_and_in_both_files() {
    let folder = tempfile::tempdir().unwrap();
    let [file, csv, readings] = ["lit.json", "out.csv", "out.json"].map(|name| folder.path().join(name));
    std::fs::write(&file, lit().to_string()).unwrap();
    let ran = etalon_line("measure {} -o {} -o {} --threads 2", [&file, &csv, &readings]).expect(0);
    assert!(ran.stdout.contains("25.0") && ran.stdout.contains("lx"), "{}", ran.stdout);
    let found: Value = serde_json::from_str(&std::fs::read_to_string(&readings).unwrap()).unwrap();
    assert_eq!((&found["replicates"], &found["reached"]), (&json!(32), &json!(true)));
    let lux: Vec<f64> =
        found["readings"].as_array().unwrap().iter().map(|row| row["photometric"]["value"].as_f64().unwrap()).collect();
    // Half a metre aside in x and in y: h/d³ with d² = 4.5.
    let aside = 200.0 / 4.5_f64.powf(1.5);
    for (got, want) in lux.iter().zip([25.0, aside, aside, aside, aside]) {
        assert!((got / want - 1.0).abs() < 1e-6, "{got} is not {want}");
    }
    // Equal energy: 25 lx are 25/(683.002 · 106.857) W/m² a nanometre, over 470 of them.
    let watts = found["readings"][0]["radiometric"]["value"].as_f64().unwrap();
    assert!((watts / (25.0 / (683.002 * 106.856_917) * 470.0) - 1.0).abs() < 1e-6, "{watts}");
    let lines: Vec<String> = std::fs::read_to_string(&csv).unwrap().lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 6);
    assert!(lines[1].starts_with("\"a, \"\"b\"\"\",0,0,0,0,0,irradiance,"), "{}", lines[1]);
    assert!(lines[3].starts_with("grid,1,0,0.5,-0.5,0,irradiance,"), "{}", lines[3]);

    // The same on one thread, and as JSON on standard output.
    let again = etalon_line("measure {} --threads 1 --json", [&file]).expect(0).json();
    assert_eq!(again["readings"], found["readings"]);
}

#[test]
fn it_stops_at_the_error_or_at_the_samples() {
    let scene = scene("meters.json");
    let found = etalon_line("measure {} --error 5% --json", [&scene]).expect(0).json();
    assert_eq!(found["reached"], true);
    for row in found["readings"].as_array().unwrap() {
        let share =
            row["photometric"]["standard_error"].as_f64().unwrap() / row["photometric"]["value"].as_f64().unwrap();
        assert!(share <= 0.05, "{row}");
    }
    let found =
        etalon_line("measure {} --error 0.001% --spp 100 --json", [&scene]).expect(0).says(["not reached"]).json();
    assert_eq!((&found["reached"], &found["samples"]), (&json!(false), &json!(128)));
    let fixed = etalon_line("measure {} --spp 64 --json", [&scene]).expect(0).json();
    assert_eq!((&fixed["reached"], &fixed["samples"]), (&json!(true), &json!(64)));
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    etalon_line("measure {}", [&scene("furnace.json")]).expect(2).says(["the scene has no meters", "add a key"]);
    let scene = scene("meters.json");
    let picture = folder.path().join("x.png");
    etalon_line("measure {} -o {}", [&scene, &picture]).expect(2).says(["not a kind of file that readings"]);
    let nowhere = folder.path().join("none").join("x.csv");
    etalon_line("measure {} -o {}", [&scene, &nowhere]).expect(1);
    let mut many = lit();
    many["meters"][1]["rows"] = json!(65_536);
    let file = folder.path().join("many.json");
    std::fs::write(&file, many.to_string()).unwrap();
    etalon_line("measure {}", [&file]).expect(2).says(["at most 65536 are possible"]);
}

#[test]
fn a_picture_does_not_see_the_meters() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |text: Value, name: &str| {
        let [file, picture] = ["json", "exr"].map(|kind| folder.path().join(format!("{name}.{kind}")));
        std::fs::write(&file, text.to_string()).unwrap();
        etalon_line("render {} -o {} --spp 4", [&file, &picture]).expect(0);
        crate::support::pixel_bits(&picture).0
    };
    let mut without = lit();
    without.as_object_mut().unwrap().remove("meters");
    assert!(bytes(lit(), "with") == bytes(without, "without"));
}
