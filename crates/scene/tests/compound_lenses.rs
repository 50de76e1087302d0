//! Lenses of many surfaces: what a scene says arrives in SI units, what is wrong is refused with its place.

use crate::common::{Parts, RIGHT};
use etalon_optics::RefractiveIndex;
use etalon_scene::{Code, CompoundLens, LensCoating, Loaded, NamedFile, Problem, Projection, SceneErrors};

/// A stop 4 mm before a biconvex lens of ±50 mm.
const BICONVEX: &str = r#"{ "comment": "a magnifier", "surfaces": [
    { "semi_aperture_mm": 3, "thickness_mm": 4, "stop": true },
    { "radius_mm": 50, "thickness_mm": 5, "medium": 1.5168, "semi_aperture_mm": 10 },
    { "radius_mm": -50, "conic": -0.5, "aspheric": [1e-6, -2e-9], "semi_aperture_mm": 9 } ], "coating": "ideal" }"#;

fn scene_with(camera: &str) -> Result<Loaded, SceneErrors> {
    let camera =
        format!("{{\"type\": \"compound-lens\", \"position_m\": [0, 0, 5], \"direction\": [0, 0, -1], {camera}}}");
    let text = Parts { camera: &camera, ..RIGHT }.text();
    let files = [
        NamedFile { name: "biconvex.lens.json".to_owned(), bytes: BICONVEX.into() },
        NamedFile {
            name: "broken.lens.json".to_owned(),
            bytes: BICONVEX.replace("\"radius_mm\": 50", "\"radius_mm\": 5").into(),
        },
    ];
    etalon_scene::parse_with_files(&text, "test.json", &files, None)
}

fn lens(camera: &str) -> CompoundLens {
    let loaded = scene_with(camera).unwrap_or_else(|errors| panic!("{errors}"));
    let Projection::CompoundLens(lens) = &loaded.scene.camera.projection else { panic!("a compound lens") };
    CompoundLens::clone(lens)
}

/// The one error of a camera whose lens is changed in one place.
fn wrong(old: &str, new: &str, code: Code, says: &str) -> Problem {
    assert!(BICONVEX.contains(old), "{old}");
    let camera =
        format!("\"sensor_height_m\": 0.024, \"film_distance_m\": 0.05, \"lens\": {}", BICONVEX.replacen(old, new, 1));
    let errors = scene_with(&camera).map(|_| ()).expect_err(says);
    let [problem] = errors.problems.as_slice() else { panic!("{errors}") };
    assert!(problem.code == code && problem.message.contains(says), "{errors}");
    problem.clone()
}

#[test]
fn a_lens_arrives_in_metres() {
    let lens = lens(&format!("\"sensor_height_m\": 0.024, \"film_distance_m\": 0.045, \"lens\": {BICONVEX}"));
    assert_eq!((lens.surfaces.len(), lens.stop(), lens.coating), (3, 0, LensCoating::Ideal));
    assert_eq!((lens.film_distance_m, lens.film_height_m, lens.reference_nm), (0.045, 0.024, 587.5618));
    let [stop, front, rear] = &lens.surfaces[..] else { panic!("three surfaces") };
    assert_eq!((stop.curvature_per_m, stop.is_stop, stop.thickness_m), (0.0, true, 4.0 * 1e-3));
    assert_eq!(front.medium, RefractiveIndex::constant(1.5168).unwrap());
    // Two roundings.
    assert!((front.curvature_per_m - 20.0).abs() < 1e-14 && (rear.curvature_per_m + 20.0).abs() < 1e-14);
    assert_eq!((rear.conic, rear.thickness_m, rear.semi_aperture_m), (-0.5, 0.0, 9.0 * 1e-3));
    // A₄ in mm⁻³ is 10⁹ as many m⁻³, A₆ 10¹⁵.
    let [a4, a6] = rear.aspheric[..] else { panic!("two coefficients") };
    assert!((a4 / 1e3 - 1.0).abs() < 1e-14 && (a6 / -2e6 - 1.0).abs() < 1e-14, "{a4} {a6}");
    let half_view = lens.half_view();
    assert!((half_view / (0.012 / lens.focal_length_m(587.5618)) - 1.0).abs() < 0.1, "{half_view}");
}

#[test]
fn the_film_moves_to_the_image() {
    let at = |focus_m: f64| {
        lens(&format!(
            "\"sensor_height_m\": 0.024, \"focus_distance_m\": {focus_m}, \"lens_file\": \"biconvex.lens.json\""
        ))
    };
    let (far, near) = (at(1e6), at(0.3));
    assert_eq!(Some(near.film_distance_m), near.image_distance_m(0.3, 587.5618));
    assert!(near.film_distance_m > far.film_distance_m + 0.008, "{} {}", near.film_distance_m, far.film_distance_m);
    let errors =
        scene_with("\"sensor_height_m\": 0.024, \"focus_distance_m\": 0.01, \"lens_file\": \"biconvex.lens.json\"")
            .unwrap_err();
    assert!(errors.problems[0].message.contains("no image"), "{errors}");
}

#[test]
fn what_is_wrong_is_said() {
    let at = |problem: &Problem| problem.json_path.clone();
    let path = |rest: &str| format!("$.camera.lens.surfaces{rest}");
    let found = wrong("\"stop\": true", "\"stop\": false", Code::MissingKey, "no stop");
    assert_eq!(at(&found), path(""));
    let found = wrong("\"conic\"", "\"stop\": true, \"conic\"", Code::KeyConflict, "two stops");
    assert_eq!(at(&found), path("[2]"));
    let found = wrong("\"radius_mm\": 50", "\"radius_mm\": 0", Code::OutOfRange, "must not be 0");
    assert_eq!(at(&found), path("[1].radius_mm"));
    let found = wrong("\"radius_mm\": 50", "\"radius_mm\": 8", Code::OutOfRange, "wider than the surface");
    assert_eq!(at(&found), path("[1].semi_aperture_mm"));
    let found = wrong("\"thickness_mm\": 5, ", "", Code::MissingKey, "thickness_mm");
    assert_eq!(at(&found), path("[1]"));
    let found = wrong("\"conic\"", "\"thickness_mm\": 45, \"conic\"", Code::KeyConflict, "no thickness");
    assert_eq!(at(&found), path("[2].thickness_mm"));
    let found = wrong("\"thickness_mm\": 5", "\"thickness_mm\": 1", Code::OutOfRange, "meets the one before it");
    assert_eq!(at(&found), path("[2]"));
    let found = wrong("\"conic\"", "\"medium\": 1.3, \"conic\"", Code::OutOfRange, "air behind");
    assert_eq!(at(&found), path("[2]"));
    let found = wrong("1.5168", "\"BK7\"", Code::UnknownName, "BK7");
    assert_eq!(at(&found), path("[1].medium"));
    let found = wrong("1.5168", "0.9", Code::OutOfRange, "at least 1");
    assert_eq!(at(&found), path("[1]"));
    wrong("[1e-6, -2e-9]", "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0]", Code::WrongLength, "at most 9");
    let camera = "\"sensor_height_m\": 0.024, \"film_distance_m\": 0.05, \"lens\": { \"surfaces\": [] }";
    assert!(scene_with(camera).unwrap_err().problems[0].message.contains("from 1 to 64"));
}

#[test]
fn what_is_wrong_with_a_file_is_said_with_its_line() {
    let errors =
        scene_with("\"sensor_height_m\": 0.024, \"film_distance_m\": 0.05, \"lens_file\": \"broken.lens.json\"")
            .unwrap_err();
    let [problem] = errors.problems.as_slice() else { panic!("{errors}") };
    assert_eq!(problem.json_path, "$.camera.lens_file");
    let message = &problem.message;
    assert!(
        message.starts_with("broken.lens.json:3:") && message.contains("$.surfaces[1].semi_aperture_mm"),
        "{message}"
    );
}
