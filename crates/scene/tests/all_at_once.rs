//! Every error of a file in one run. A reader that stops at its first error fails these tests.

use crate::common::{EVERYTHING, RIGHT};
use etalon_scene::json::{self, Code, Problem};

/// Twenty-odd errors, of syntax, of form and of meaning; lines and columns were counted by hand.
const WRONG: &str = r#"{
  "etalon": 3,
  "camera": { "type": "perspective", "position_m": [0, 0, 5], "look_at_m": [0, 0, 5], "vertical_fov_deg": -40 },
  "film": { "widht": 0, "height": "tall" },
  "spectra": { "a": "b", "t": { "type": "tabulated", "wavelengths_nm": [400, 300], "values": [1] } },
  "materials": {
    "white": { "type": "lambert", "reflectance": 1.01 },
    "glass": { "type": "dielectric", "interior": "N-BK8" },
    "gem": { "type": "dielectric", "interior": "diamond" },
    "white": { "type": "black" }
  },
  "objects": [
    { "shape": { "type": "sphere", "radius_m": -1 }, "material": "whit", "emission": { "radiance": -2 } },
    { "shape": { "type": "disk", "normal": [0, 0, 0], "radius_m": 1e999 }, "material": "white", "color": 1 },
    { "shape": { "type": "mesh", "vertices_m": [[0, 0, 0]], "triangles": [[0, 0, 7]] }, "material": "glass" },
    { "shape": { "type": "sphere", "radius_m": 1 }, "material": "white", "transform": [{ "scale": [1, 2, 3] }] },
  ],
  "lights": [{ "type": "lantern" }, { "type": "point", "intensity": "day" }],
  "integrator": { "spp": 1.5, "sampler": "sobel", "max_depth": [] }
}"#;

/// What is wrong with it: line, column, kind and path.
const EXPECTED: [(usize, usize, Code, &str); 28] = [
    (2, 13, Code::Version, "$.etalon"),
    (3, 76, Code::DegenerateView, "$.camera.look_at_m"),
    (3, 107, Code::OutOfRange, "$.camera.vertical_fov_deg"),
    (4, 13, Code::UnknownKey, "$.film.widht"),
    (4, 22, Code::OutOfRange, "$.film.widht"),
    (4, 35, Code::WrongType, "$.film.height"),
    (5, 21, Code::UnknownName, "$.spectra.a"),
    (5, 31, Code::WrongLength, "$.spectra.t"),
    (5, 78, Code::OutOfRange, "$.spectra.t.wavelengths_nm[1]"),
    (7, 50, Code::Reflectance, "$.materials.white.reflectance"),
    (8, 50, Code::UnknownName, "$.materials.glass.interior"),
    (9, 48, Code::OutsideFit, "$.materials.gem.interior"),
    (10, 5, Code::DuplicateKey, "$.materials.white"),
    (13, 48, Code::OutOfRange, "$.objects[0].shape.radius_m"),
    (13, 66, Code::UnknownName, "$.objects[0].material"),
    (13, 100, Code::NegativeEmission, "$.objects[0].emission.radiance"),
    (14, 44, Code::ZeroVector, "$.objects[1].shape.normal"),
    (14, 67, Code::NotFinite, "$.objects[1].shape.radius_m"),
    (14, 97, Code::UnknownKey, "$.objects[1].color"),
    (15, 75, Code::IndexOutOfRange, "$.objects[2].shape.triangles[0]"),
    (16, 87, Code::NotSimilarity, "$.objects[3].transform"),
    (16, 113, Code::Syntax, "$.objects"),
    (18, 24, Code::UnknownWord, "$.lights[0].type"),
    (18, 37, Code::MissingKey, "$.lights[1]"),
    (18, 69, Code::UnknownName, "$.lights[1].intensity"),
    (19, 26, Code::OutOfRange, "$.integrator.spp"),
    (19, 42, Code::UnknownWord, "$.integrator.sampler"),
    (19, 64, Code::WrongType, "$.integrator.max_depth"),
];

fn places(problems: &[Problem]) -> Vec<(usize, usize, Code, &str)> {
    problems.iter().map(|p| (p.line, p.column, p.code, p.json_path.as_str())).collect()
}

#[test]
fn all_errors_of_a_file_come_in_one_run() {
    let errors = etalon_scene::parse(WRONG, "wrong.json").expect_err("it is wrong");
    assert_eq!(places(&errors.problems), EXPECTED);
    // Mutants: readers that stop early, after however many errors.
    for stop in 0..EXPECTED.len() {
        assert_ne!(places(&errors.problems[..stop]), EXPECTED);
    }
}
#[test]
fn each_error_alone_is_among_those_of_the_whole() {
    // Independent of the list above: breaking a right file in k places gives k errors, whichever the places.
    let faults = [
        ("\"vertical_fov_deg\": 40", "\"vertical_fov_deg\": 400"),
        ("\"width\": 64", "\"width\": 0"),
        ("\"grey\": 0.5", "\"grey\": 1.5"),
        ("\"radius_m\": 1", "\"radius_m\": \"1\""),
        ("\"material\": \"white\"", "\"material\": \"black\""),
        ("\"radiance\": 1", "\"radiance\": -1"),
        ("\"integrator\": {}", "\"integrator\": {\"spp\": 0}"),
    ];
    let right = RIGHT.text();
    for chosen in 0..1_u32 << faults.len() {
        let mut text = right.clone();
        for (i, (from, to)) in faults.iter().enumerate() {
            assert!(text.contains(from), "{from}");
            if chosen >> i & 1 == 1 {
                text = text.replacen(from, to, 1);
            }
        }
        let found = etalon_scene::parse(&text, "test.json").map_or_else(|e| e.errors().count(), |_| 0);
        assert_eq!(found, chosen.count_ones() as usize, "{text}");
    }
}

#[test]
fn the_scene_with_every_key_has_no_problem() {
    let (_, warnings) = etalon_scene::parse(EVERYTHING, "everything.json").expect("it is right");
    assert_eq!(warnings, []);
}

#[test]
fn the_reader_serves_other_formats_with_the_same_care() {
    etalon_scene::record! {
        /// A format of its own.
        struct Other {
            /// Whether it is.
            is_there as "IsThere": json::Required<bool>,
            /// How many.
            count as "Count": json::Required<json::Whole<1, 9>> = "3",
        }
    }
    let read = |text: &str| {
        json::read(text, "other.json", |form: Other, reader| {
            if form.count == Some(json::Whole(9)) {
                reader.warning(Code::OutOfRange, form.at, "that many", None);
            }
            Some((form.is_there?, form.count?.0))
        })
    };
    assert_eq!(read(r#"{"IsThere": true}"#).expect("right"), ((true, 3), vec![]));
    let (value, warnings) = read(r#"{"IsThere": false, "Count": 9}"#).expect("right");
    assert_eq!((value, warnings.len()), ((false, 9), 1));
    let errors = read(r#"{"isThere": 1, "Count": 10}"#).expect_err("wrong");
    let codes: Vec<Code> = errors.problems.iter().map(|p| p.code).collect();
    assert_eq!(codes, [Code::UnknownKey, Code::WrongType, Code::OutOfRange]);
}
