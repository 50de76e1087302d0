//! Media: what is wrong with a table of a phase function or a grid is refused, with its place.

use crate::common::{Parts, RIGHT};
use etalon_scene::{AlbedoGrid, Code, Loaded, NamedFile, SceneErrors, Wrap, parse_with_files};

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

/// What fills a body must not contradict what the body says itself.
#[test]
fn a_body_is_filled_once() {
    let medium = r#"{"absorption_per_m": 1}"#;
    let with = |of: &str| {
        let materials = format!(
            "{{\"white\": {{\"type\": \"lambert\", \"reflectance\": 0.5}}, \"m\": {{\"type\": \"filled\", \"material\": {of}, \"medium\": {medium}}}}}"
        );
        etalon_scene::parse(&Parts { materials: &materials, ..RIGHT }.text(), "test.json")
    };
    for (of, code, says) in [
        (
            format!(r#"{{"type": "dielectric", "interior": 1.5, "medium": {medium}}}"#),
            Code::KeyConflict,
            "already holds",
        ),
        (
            r#"{"type": "dielectric", "interior": 1.5, "absorption_per_m": 1}"#.to_owned(),
            Code::KeyConflict,
            "already holds",
        ),
        (format!(r#"{{"type": "boundary", "medium": {medium}}}"#), Code::KeyConflict, "already holds"),
        (r#"{"type": "dielectric", "interior": 1.5, "priority": 1}"#.to_owned(), Code::KeyConflict, "\"priority\""),
        (r#""black""#.to_owned(), Code::UnknownName, "black"),
        (r#""m""#.to_owned(), Code::Circular, "defined after it"),
    ] {
        let errors = with(&of).map(|_| ()).expect_err(says);
        assert!(errors.problems.iter().any(|p| p.code == code && p.message.contains(says)), "{of}: {errors}");
    }
    for of in [
        r#""white""#,
        r#"{"type": "dielectric", "interior": 1.5}"#,
        r#"{"type": "blend", "first": "white", "second": {"type": "black"}, "weight": 0.5}"#,
    ] {
        assert!(with(of).is_ok(), "{of}");
    }
}

/// A grid of two cells, one above the other, from (0, 0, 0) to (1, 1, 2).
fn vol(channels: i32, values: &[f32]) -> Vec<u8> {
    let head = [1, 1, 1, 2, channels].into_iter().flat_map(i32::to_le_bytes);
    let numbers = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0].iter().chain(values).flat_map(|number: &f32| number.to_le_bytes());
    b"VOL\x03".iter().copied().chain(head).chain(numbers).collect()
}

fn with_grid(medium: &str) -> Result<Loaded, SceneErrors> {
    let materials = format!(
        "{{\"white\": {{\"type\": \"lambert\", \"reflectance\": 0.5}}, \"m\": {{\"type\": \"boundary\", \"medium\": {{{medium}}}}}}}"
    );
    let text = Parts { materials: &materials, ..RIGHT }.text();
    let file = |name: &str, bytes: Vec<u8>| NamedFile { name: name.to_owned(), bytes };
    let files = [
        file("shares.vol", vol(1, &[0.25, 0.75])),
        file("colours.vol", vol(3, &[1.0, 0.5, 0.0, 0.5, 0.5, 0.5])),
        file("pairs.vol", vol(2, &[0.0; 4])),
        file("bright.vol", vol(1, &[0.5, 1.5])),
    ];
    parse_with_files(&text, "test.json", &files, None)
}

fn albedos(keys: &str) -> AlbedoGrid {
    let medium = format!(r#""extinction_per_m": 2, "albedo": 0.5, "albedo_grid": {{ {keys} }}"#);
    let loaded = with_grid(&medium).unwrap_or_else(|errors| panic!("{errors}"));
    loaded.scene.materials[1].medium.clone().expect("a medium").albedo.expect("a grid").as_ref().clone()
}

#[test]
fn grids_of_albedos_are_read_as_they_are() {
    let shares = albedos(r#""file": "shares.vol""#);
    assert_eq!((shares.wrap, shares.is_grey(), shares.mean()), (Wrap::Clamp, true, [0.5; 3]));
    // The middles lie at a quarter and at three quarters.
    for (z, share) in [(-7.0, 0.25), (0.25, 0.25), (0.375, 0.375), (0.75, 0.75), (9.0, 0.75)] {
        assert_eq!(shares.eval([0.3, 0.9, z]), [share; 3], "{z}");
    }
    let mut colours = albedos(r#""file": "colours.vol", "wrap": "repeat""#);
    assert_eq!((colours.is_grey(), colours.mean()), (false, [0.75, 0.5, 0.25]));
    assert_eq!(colours.eval([0.0, 0.0, 0.25]), [1.0, 0.5, 0.0]);
    assert_eq!(colours.eval([0.0, 0.0, 5.75]), [0.5; 3], "five boxes up");
    colours.turn_grey(|[red, ..]| red);
    assert_eq!((colours.is_grey(), colours.eval([0.0, 0.0, 0.25])), (true, [1.0; 3]));
}

#[test]
fn grids_that_cannot_be_meant_are_refused() {
    let refused = |medium: &str, code: Code, says: &str| {
        let errors = with_grid(medium).map(|_| ()).expect_err(says);
        let found = errors.problems.iter().any(|problem| problem.code == code && problem.message.contains(says));
        assert!(found, "{errors}");
    };
    let of = |file: &str| format!(r#""extinction_per_m": 1, "albedo": 1, "albedo_grid": {{ "file": "{file}" }}"#);
    refused(&of("pairs.vol"), Code::File, "2 channels; an albedo has 1 or 3");
    refused(&of("bright.vol"), Code::OutOfRange, "number 1 is 1.5");
    refused(&(of("shares.vol") + r#", "source_radiance": 1"#), Code::KeyConflict, "source_radiance");
    refused(r#""scattering_per_m": 1, "albedo_grid": { "file": "shares.vol" }"#, Code::MissingKey, "albedo");
    let density = |file: &str| format!(r#""scattering_per_m": 1, "density": {{ "type": "grid", "file": "{file}" }}"#);
    refused(&density("colours.vol"), Code::File, "3 channels; a density has 1");
}
