//! `etalon expose`: files of digital numbers, what is said of them, what is refused.

use std::fs;
use std::path::{Path, PathBuf};

use etalon_picture::{Attribute, Attributes, Picture, read_exr, read_png_text, write_exr};
use serde_json::{Value, json};

use crate::support::{Ran, entries, etalon_line, etalon_that_ends, scene};

/// An EXR of 8 × 6 pixels of one radiance in three bands, with the relative error given, if any.
fn picture(path: &Path, radiance: f32, error: Option<f32>) {
    let mut picture = Picture::new(8, 6).unwrap();
    for nm in [500, 550, 600] {
        picture.insert(&format!("S0.{nm},000000nm"), vec![radiance; 48]).unwrap();
        if let Some(error) = error {
            picture.insert(&format!("Error.S0.{nm},000000nm"), vec![error * radiance; 48]).unwrap();
        }
    }
    let text = |text: &str| Attribute::Text(text.to_owned());
    let attributes =
        Attributes::from([("emissiveUnits".to_owned(), text("W.m^-2.sr^-1")), ("sceneSha256".to_owned(), text("abc"))]);
    write_exr(path, &picture, &attributes).unwrap();
}

fn sensor() -> Value {
    json!({
        "pixel_pitch_um": 5, "exposure_s": 0.01, "f_number": 4,
        "quantum_efficiency": { "R": 0.2, "G": 0.5, "B": 0.3 }, "mosaic": "RGGB",
        "full_well_e": 20000, "dark_current_e_per_s": 10, "read_noise_e": 3, "gain_e_per_dn": 5,
        "black_level_dn": 50, "bits": 12
    })
}

/// A folder with `x.exr` and `s.json`.
fn set_up(radiance: f32, error: Option<f32>, sensor: &Value) -> (tempfile::TempDir, [PathBuf; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["x.exr", "s.json"].map(|name| folder.path().join(name));
    picture(&paths[0], radiance, error);
    fs::write(&paths[1], serde_json::to_string_pretty(sensor).unwrap()).unwrap();
    (folder, paths)
}

#[track_caller]
fn expose([picture, sensor]: &[PathBuf; 2], options: &str, output: &Path) -> Ran {
    etalon_that_ends(&format!("expose {{}} --sensor {{}} -o {{}} {options}"), [picture, sensor, output])
}

#[test]
fn both_files_hold_the_numbers_and_say_what_they_were_made_with() {
    let (folder, paths) = set_up(1e-3, Some(1e-3), &sensor());
    let [exr, png] = ["raw.exr", "raw.png"].map(|name| folder.path().join(name));
    let ran = expose(&paths, &format!("-o {} --seed 7 --json", png.display()), &exr).expect(0);
    assert_eq!(ran.stderr, "");
    let told = ran.json();
    assert_eq!((&told["seed"], &told["frames"][0]["frame"]), (&json!(7), &json!(0)));
    let green = told["frames"][0]["channels"].as_array().unwrap().iter().find(|c| c["channel"] == "G").unwrap();
    // π L/(4N²) over 150 nm, at 550 nm, on 25 µm² in 10 ms, half of the photons: EMVA's 50.34 photons in 1 µm², 1 ms, 1 µm, 1 µW/cm².
    let electrons = 0.5 * 50.341_165_67 * 25.0 * 10.0 * 0.55 * (std::f64::consts::PI / 64.0 * 1e-3 * 150.0 * 100.0);
    let mean = green["mean_photoelectrons"].as_f64().unwrap();
    assert!((mean / electrons - 1.0).abs() < 1e-6, "{mean} is not {electrons}");
    assert_eq!(green["pixels"], 24);
    // Six standard deviations of the mean of 24 pixels.
    let dn = green["mean_dn"].as_f64().unwrap();
    assert!(
        (dn - 50.0 - (electrons + 0.1) / 5.0).abs() < 6.0 * (electrons + 9.0).sqrt() / 5.0 / 24.0_f64.sqrt(),
        "{dn}"
    );

    let file = read_exr(&exr).unwrap();
    let numbers = file.picture.require("DN").unwrap();
    let shown = etalon_picture::read_png(&png).unwrap();
    // The reader of PNG files decodes sRGB, so that the order alone is compared here.
    let grey = shown.require("R").unwrap();
    for (i, j) in (0..48).zip(1..48) {
        assert_eq!(numbers[i].partial_cmp(&numbers[j]), grey[i].partial_cmp(&grey[j]), "{i}");
    }
    let text = fs::read_to_string(&paths[1]).unwrap();
    assert_eq!(file.attributes["sensor"], Attribute::Text(text.clone()));
    assert_eq!(file.attributes["sensorSeed"], Attribute::Text("7".to_owned()));
    assert_eq!(file.attributes["sceneSha256"], Attribute::Text("abc".to_owned()));
    assert!(!file.attributes.contains_key("emissiveUnits"));
    assert_eq!(read_png_text(&png, "sensor").unwrap(), Some(text));
}

#[test]
fn frames_and_threads_are_what_was_asked_for() {
    let (folder, paths) = set_up(1e-3, None, &sensor());
    let out = |name: &str| folder.path().join(name);
    expose(&paths, "--threads 1 --electrons", &out("one.exr")).expect(0);
    let ran = expose(&paths, "--threads 3 --electrons", &out("three.exr")).expect(0);
    assert!(ran.stdout.contains("three.exr: 8 × 6 pixels\n  B: mean signal"), "{}", ran.stdout);
    assert!(ran.stdout.contains("signal-to-noise") && ran.stdout.contains("saturated 0 %"), "{}", ran.stdout);
    let read = |name: &str| fs::read(out(name)).unwrap();
    assert!(read("one.exr") == read("three.exr"));
    let names: Vec<String> =
        read_exr(&out("one.exr")).unwrap().picture.channels().iter().map(|channel| channel.name.clone()).collect();
    assert_eq!(names, ["DN", "electrons", "meanPhotoelectrons"]);

    expose(&paths, "--frames 0:2", &out("raw.exr")).expect(2).says(["raw-{frame:04}.exr"]);
    expose(&paths, "--frames 0:2 --quiet --electrons", &out("f-{frame}.exr")).expect(0);
    assert!(read("f-0.exr") == read("one.exr") && read("f-1.exr") != read("f-2.exr"));
    assert_eq!(entries(folder.path()).len(), 7);
}

#[test]
fn what_may_be_wrong_is_said() {
    let mut dark = sensor();
    dark["black_level_dn"] = json!(0);
    dark["quantum_efficiency"]["B"] =
        json!({ "wavelengths_nm": [300, 500, 700], "values": [0.5, 0.2, 0], "outside": "zero" });
    let (folder, paths) = set_up(1e-3, Some(0.5), &dark);
    let out = folder.path().join("raw.exr");
    expose(&paths, "", &out)
        .expect(0)
        .says(["channel G: the noise of the render itself may be", "times the samples"])
        .says(["channel B:", "outside of the bands of the picture"]);
    picture(&paths[0], 0.0, Some(f32::NAN));
    expose(&paths, "", &out).expect(0).says(["below 0, where the digital number is cut", "black_level_dn"]);
    picture(&paths[0], f32::NAN, None);
    expose(&paths, "", &out)
        .expect(0)
        .says(["the light of 48 pixels is not finite or negative, first in column 0, row 0"]);
    expose(&paths, "", &folder.path().join("raw.png")).expect(2).says(["a PNG file cannot hold pixels", "EXR"]);
    let mut none = read_exr(&paths[0]).unwrap();
    none.attributes.clear();
    write_exr(&paths[0], &none.picture, &none.attributes).unwrap();
    expose(&paths, "", &out).expect(0).says(["does not state the unit"]);
}

#[test]
fn what_cannot_be_exposed_is_refused() {
    let (folder, paths) = set_up(1e-3, None, &sensor());
    let out = folder.path().join("raw.exr");
    expose(&paths, "", &folder.path().join("raw.tif")).expect(2).says([".exr or .png"]);
    expose(&paths, "", &folder.path().join("none/raw.exr")).expect(1).says(["does not exist"]);
    let [picture, _] = &paths;
    let missing = folder.path().join("missing.json");
    expose(&[picture.clone(), missing], "", &out).expect(2).says(["cannot read the sensor"]);

    let mut wrong = sensor();
    (wrong["bits"], wrong["read_noise_e"], wrong["f_numer"]) = (json!(20), json!("3"), json!(4));
    fs::write(&paths[1], serde_json::to_string_pretty(&wrong).unwrap()).unwrap();
    let ran = expose(&paths, "", &out).expect(2);
    ran.says([
        "s.json:",
        "$.bits: 20 is not within 1 … 16",
        "$.read_noise_e",
        "remove the quotes",
        "unknown key \"f_numer\"",
    ]);

    fs::write(&paths[1], sensor().to_string()).unwrap();
    let grey = Picture::from_rgb(2, 1, &[[0.5_f32; 3]; 2]).unwrap();
    write_exr(&paths[0], &grey, &Attributes::new()).unwrap();
    expose(&paths, "", &out).expect(2).says(["no spectral bands", "--bands"]);
    assert!(!out.exists());
}

#[test]
fn a_render_is_exposed_on_the_sensors_beside_the_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let [exr, raw] = ["room.exr", "raw.png"].map(|name| folder.path().join(name));
    let line = "render {} -o {} --size 32x24 --spp 8 --bands 400:700:20 --quiet";
    etalon_line(line, [&scene("meters.json"), &exr]).expect(0);
    for name in ["mono", "colour"] {
        let sensor = scene(&format!("sensors/{name}.sensor.json"));
        let ran = expose(&[exr.clone(), sensor], "--json", &raw).expect(0);
        for channel in ran.json()["frames"][0]["channels"].as_array().unwrap() {
            let mean = channel["mean_photoelectrons"].as_f64().unwrap();
            assert!((50.0..10_500.0).contains(&mean), "{channel}");
            assert!(channel["render_over_sensor_noise"].as_f64().is_some_and(|ratio| ratio > 0.0), "{channel}");
        }
    }
    let schema = etalon_line("schema sensor", []).expect(0).json();
    assert_eq!(schema["title"], "Etalon sensor");
}

/// At f/2, focused on 0.54 m with a lens of 50 mm: the image is 0.055 m behind the lens, and sin θ₀ about 0.25 · 0.05/0.055.
#[test]
fn a_picture_through_a_compound_lens_states_its_cone_of_light() {
    let (folder, [exr, sensor_file]) = set_up(1.0, None, &{
        let mut sensor = sensor();
        sensor.as_object_mut().unwrap().remove("f_number");
        sensor
    });
    let raw = folder.path().join("raw.exr");
    expose(&[exr.clone(), sensor_file.clone()], "", &raw).expect(2).says(["how wide the cone of light", "f_number"]);
    let line = "render {} -o {} --size 12x8 --spp 2 --bands 400:700:20 --quiet";
    etalon_line(line, [&scene("double-gauss.json"), &exr]).expect(0);
    let Attribute::Double(sine) = read_exr(&exr).unwrap().attributes["imageNumericalAperture"] else {
        panic!("it is a double")
    };
    assert!((0.2..0.26).contains(&sine), "{sine}");
    expose(&[exr.clone(), sensor_file], "", &raw).expect(0);
    let stated = scene("sensors/mono.sensor.json");
    expose(&[exr, stated], "", &raw).expect(0).says(["rendered through a lens with sin θ = 0.2", "states 0.1250"]);
}
