//! Sensors from texts: units, defaults, and every mistake with its place.

use super::*;

fn valid() -> Value {
    json!({
        "comment": ["A sensor of a test."],
        "pixel_pitch_um": 3.45, "exposure_s": 0.01, "f_number": 2.8,
        "quantum_efficiency": {
            "R": { "wavelengths_nm": [400, 600, 700], "values": [0, 0.5, 0.4], "outside": "zero" },
            "G": 0.5, "B": 0.4
        },
        "mosaic": "RGGB",
        "full_well_e": 10500, "dark_current_e_per_s": 5, "read_noise_e": 2.3, "gain_e_per_dn": 2.6, "bits": 12
    })
}

fn changed(change: impl FnOnce(&mut Value)) -> Result<SensorFile, SceneErrors> {
    let mut value = valid();
    change(&mut value);
    SensorFile::parse(&value.to_string(), "sensor.json")
}

#[test]
fn a_sensor_is_read_with_its_units_and_defaults() {
    let file = changed(|_| {}).unwrap();
    let sensor = &file.sensor;
    sensor.check().unwrap();
    assert!((sensor.pixel_pitch_m / 3.45e-6 - 1.0).abs() < 1e-15);
    assert_eq!((sensor.numerical_aperture, sensor.lens_transmittance), (Some(0.5 / 2.8), 1.0));
    assert_eq!((sensor.full_well_e, sensor.bits, sensor.black_level_dn, sensor.pattern_seed), (10_500, 12, 0.0, 0));
    // The file's order of names counts: serde_json sorts them.
    let names: Vec<&str> = sensor.channels.iter().map(|channel| channel.name.as_str()).collect();
    let mosaic = sensor.mosaic.as_ref().unwrap();
    let rows: Vec<Vec<&str>> = mosaic.rows().map(|row| row.iter().map(|i| names[*i]).collect()).collect();
    assert_eq!(rows, [["R", "G"], ["G", "B"]]);
    assert_eq!(file.sha256.len(), 64);
    let rows = changed(|value| value["mosaic"] = json!([["R", "G", "B"]])).unwrap();
    assert_eq!(rows.sensor.mosaic.unwrap().rows().count(), 1);
    let aperture = changed(|value| {
        value.as_object_mut().unwrap().remove("f_number");
        value["numerical_aperture"] = json!(0.2);
    });
    assert_eq!(aperture.unwrap().sensor.numerical_aperture, Some(0.2));
}

#[test]
fn every_mistake_has_its_place_and_its_reason() {
    let cases: [(&str, Value, &str, &str); 12] = [
        ("pixel_pitch_um", json!(0), "$.pixel_pitch_um", "not above 0"),
        ("f_number", json!(0.4), "$.f_number", "below 0.5"),
        ("numerical_aperture", json!(0.1), "$", "exclude each other"),
        ("bits", json!(17), "$.bits", "not within 1 … 16"),
        ("full_well_e", json!(10.5), "$.full_well_e", "not a whole number"),
        ("prnu", json!(0.5), "$.prnu", "above 0.08"),
        ("gain", json!(1), "$", "unknown key"),
        ("mosaic", json!("RGB"), "$.mosaic", "has 4 letters"),
        ("mosaic", json!("RGGX"), "$.mosaic", "no channel is named \"X\""),
        ("mosaic", json!([["R"], ["G", "B"]]), "$.mosaic", "same length"),
        ("quantum_efficiency", json!({}), "$.quantum_efficiency", "a sensor of 0 channels"),
        ("quantum_efficiency", json!({ "R": 60, "G": 1, "B": 1 }), "$.quantum_efficiency.R", "60 is above 1"),
    ];
    for (key, value, path, message) in cases {
        let errors = changed(|sensor| sensor[key] = value.clone()).unwrap_err();
        let found =
            errors.errors().any(|p| p.json_path.starts_with(path) && p.message.contains(message) && p.line == 1);
        assert!(found, "{key} {value}: {errors}");
    }
    for (table, message) in [
        (json!({ "wavelengths_nm": [400, 390], "values": [0, 1] }), "wavelengths must increase"),
        (json!({ "wavelengths_nm": [400, 500], "values": [0] }), "2 wavelengths_nm, but 1 values"),
        (json!({ "wavelengths_nm": [400], "values": [0] }), "at least 2 wavelengths"),
        (json!({ "wavelengths_nm": [400, 500], "values": [0, 2] }), "2 is above 1"),
        (json!("x"), "expected an object"),
    ] {
        let errors = changed(|sensor| sensor["quantum_efficiency"]["R"] = table.clone()).unwrap_err();
        assert!(errors.errors().any(|problem| problem.message.contains(message)), "{table}: {errors}");
    }
}

#[test]
fn the_schema_names_every_key() {
    let schema = SensorFile::schema();
    let text = schema.to_string();
    for key in valid().as_object().unwrap().keys() {
        assert!(text.contains(&format!("\"{key}\"")), "{key}");
    }
    assert_eq!(schema["title"], "Etalon sensor");
}

#[test]
fn the_sensors_of_the_page_and_of_the_scenes_are_right() {
    let page = include_str!("../../../../docs/how-to/sensor.md");
    let examples: Vec<&str> =
        page.split("\n```json fragment\n").skip(1).map(|rest| rest.split_once("\n```").expect("an end").0).collect();
    assert_eq!(examples.len(), 1);
    let [mono, colour] = [
        include_str!("../../../../scenes/sensors/mono.sensor.json"),
        include_str!("../../../../scenes/sensors/colour.sensor.json"),
    ];
    for text in [examples[0], mono, colour] {
        let file = SensorFile::parse(text, "sensor.json").unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(file.warnings, []);
    }
    // Every key is on the page.
    let schema = SensorFile::schema();
    for key in schema["$defs"]["SensorForm"]["properties"].as_object().unwrap().keys() {
        assert!(["$schema", "comment"].contains(&key.as_str()) || page.contains(&format!("`{key}`")), "{key}");
    }
}
