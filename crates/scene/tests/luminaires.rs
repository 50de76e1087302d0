//! Luminaires, standard skies and photometric units: what a scene says arrives, what is wrong is refused with its place.

use crate::common::{Parts, RIGHT};
use etalon_scene::{Code, LightKind, Loaded, NamedFile, SceneErrors};

const FILE: &str = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 2 1 2 0 0 0\n1 1 0\n0 45 90\n0 90\n10 20 30\n40 50 60\n";

fn scene_with(lights: &str) -> Result<Loaded, SceneErrors> {
    let text = Parts { lights, ..RIGHT }.text();
    let files = [
        NamedFile { name: "lamp.ies".to_owned(), bytes: FILE.into() },
        NamedFile { name: "broken.ies".to_owned(), bytes: FILE.replace("60", "-60").into() },
    ];
    etalon_scene::parse_with_files(&text, "test.json", &files, None)
}

fn wrong(lights: &str, code: Code, says: &str) {
    let errors = scene_with(lights).map(|_| ()).expect_err(says);
    let found = errors.problems.iter().any(|problem| problem.code == code && problem.message.contains(says));
    assert!(found, "{errors}");
}

#[test]
fn a_luminaire_has_the_axes_that_it_is_given() {
    let text = r#"[{ "type": "luminaire", "file": "lamp.ies", "position_m": [1, 2, 3], "scale": 2 },
        { "type": "luminaire", "file": "lamp.ies", "position_m": [0, 0, 0], "nadir": [0, 0, -2], "forward": [3, 0, 1] }]"#;
    let loaded = scene_with(text).unwrap_or_else(|errors| panic!("{errors}"));
    let [hanging, turned] = [0, 1].map(|i| loaded.scene.lights[i].kind.clone());
    let LightKind::Luminaire { nadir, planes, photometry, intensity, .. } = hanging else { panic!("a luminaire") };
    // Up is y and forward −z: a quarter turn counter-clockwise from above is −x.
    assert_eq!((nadir, planes), ([0.0, -1.0, 0.0], [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]));
    assert_eq!(photometry.eval(0.25, 0.25), 60.0);
    let LightKind::Luminaire { nadir, planes, intensity: single, .. } = turned else { panic!("a luminaire") };
    assert_eq!((nadir, planes), ([0.0, 0.0, -1.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    assert!((intensity.eval(500.0) / single.eval(500.0) - 2.0).abs() < 1e-15);
    // One file, read once.
    assert_eq!(loaded.files.len(), 1);
}

#[test]
fn what_is_wrong_is_said() {
    wrong(
        r#"[{ "type": "luminaire", "file": "broken.ies", "position_m": [0, 0, 0] }]"#,
        Code::File,
        "intensity number 6 is -60",
    );
    wrong(
        r#"[{ "type": "luminaire", "file": "none.ies", "position_m": [0, 0, 0] }]"#,
        Code::File,
        "not among the files",
    );
    wrong(
        r#"[{ "type": "luminaire", "file": "lamp.ies", "position_m": [0, 0, 0], "forward": [0, 1, 0] }]"#,
        Code::DegenerateView,
        "along \"nadir\"",
    );
    wrong(
        r#"[{ "type": "point", "position_m": [0, 0, 0], "intensity_cd": 1, "spectrum": { "type": "tabulated", "wavelengths_nm": [900, 950], "values": [1, 1], "outside": "zero" } }]"#,
        Code::OutOfRange,
        "invisible",
    );
    wrong(
        r#"[{ "type": "point", "position_m": [0, 0, 0], "intensity_cd": 1, "flux_lm": 1 }]"#,
        Code::KeyConflict,
        "flux_lm",
    );
    wrong(
        r#"[{ "type": "environment", "sky": { "cie_type": 12, "zenith_radiance": 1 } }]"#,
        Code::MissingKey,
        "where the sun is",
    );
    wrong(
        r#"[{ "type": "environment", "sky": { "cie_type": 12, "zenith_radiance": 1, "sun_direction": [1, -0.1, 0] } }]"#,
        Code::OutOfRange,
        "below the horizon",
    );
    wrong(
        r#"[{ "type": "environment", "daylight": { "sun_direction": [1, -0.1, 0] } }]"#,
        Code::OutOfRange,
        "below the horizon",
    );
    wrong(
        r#"[{ "type": "environment", "daylight": { "sun_direction": [1, 0.1, 0] } }]"#,
        Code::OutOfRange,
        "a sun as low as this",
    );
    wrong(
        r#"[{ "type": "environment", "daylight": { "turbidity": 1, "sun_direction": [1, 1, 0] } }]"#,
        Code::OutOfRange,
        "a turbidity of 1",
    );
    wrong(
        r#"[{ "type": "environment", "daylight": { "sun_direction": [1, 1, 0], "scale": 1e35 } }]"#,
        Code::OutOfRange,
        "more than",
    );
    wrong(
        r#"[{ "type": "environment", "radiance": { "type": "daylight", "temperature_k": 3000 } }]"#,
        Code::OutOfRange,
        "3000 K",
    );
    wrong(r#"[{ "type": "environment", "sky": { "cie_type": 17, "zenith_radiance": 1 } }]"#, Code::OutOfRange, "17");
    assert!(
        scene_with(r#"[{ "type": "environment", "sky": { "cie_type": 16, "zenith_luminance_cd_per_m2": 9 } }]"#)
            .is_ok()
    );
}
