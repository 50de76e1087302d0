//! Media: what is wrong with a table of a phase function is refused, with its place.

use crate::common::{Parts, RIGHT};
use etalon_scene::Code;

fn with_table(table: &str) -> String {
    let phase = format!("{{\"type\": \"tabulated\", {table}}}");
    let medium = format!("{{\"scattering_per_m\": 1, \"phase\": {phase}}}");
    let materials = format!(
        "{{\"white\": {{\"type\": \"lambert\", \"reflectance\": 0.5}}, \"m\": {{\"type\": \"boundary\", \"medium\": {medium}}}}}"
    );
    Parts { materials: &materials, ..RIGHT }.text()
}

fn wrong(table: &str, code: Code, says: &str) {
    let errors = etalon_scene::parse(&with_table(table), "test.json").map(|_| ()).expect_err(says);
    let found = errors.problems.iter().any(|problem| problem.code == code && problem.message.contains(says));
    assert!(found, "{errors}");
}

#[test]
fn tables_of_phase_functions_are_whole_and_possible() {
    let angles = r#""angles_deg": [0, 90, 180]"#;
    wrong(r#""angles_deg": [0, 90], "values": [1, 1]"#, Code::OutOfRange, "from 0 to 180");
    wrong(r#""angles_deg": [0, 90, 180], "values": [1, 1]"#, Code::WrongLength, "3 angles have 2 values");
    wrong(r#""angles_deg": [0, 180], "values": [0, 0]"#, Code::OutOfRange, "scatters nowhere");
    let whole = r#""f33": [1, 0, -1], "f34": [0, 0, 0]"#;
    wrong(&format!(r#"{angles}, "values": [1, 1, 1], "f12": [0, -1]"#), Code::MissingKey, "f33");
    wrong(&format!(r#"{angles}, "values": [1, 1, 1], "f12": [0, -1], {whole}"#), Code::WrongLength, "have 2 values");
    wrong(&format!(r#"{angles}, "values": [1, 1, 1], "f12": [0, -1.2, 0], {whole}"#), Code::OutOfRange, "at 90°");
    wrong(
        &format!(r#"{angles}, "values": [1, 1, 1], "f12": [0, 0, 0], "f22": [1, 1.2, 1], {whole}"#),
        Code::OutOfRange,
        "more polarised light than there is light",
    );
    wrong(
        &format!(r#"{angles}, "values": [1, 1, 1], "f12": [0, 0, 0], "f44": [1, 0.5, -1], {whole}"#),
        Code::OutOfRange,
        "at 90°",
    );
    let right = format!(r#"{angles}, "values": [1, 0.5, 1], "f12": [0, -0.5, 0], {whole}"#);
    assert!(etalon_scene::parse(&with_table(&right), "test.json").is_ok());
}
