//! Image environments: what a scene says of them arrives, what is wrong is refused with its place.

use crate::common::{Parts, RIGHT};
use etalon_optics::{Illuminant, Spectrum};
use etalon_scene::{Code, EnvironmentImage, LightKind, Loaded, SceneErrors};
use std::path::Path;

fn scene_with(light: &str) -> Result<Loaded, SceneErrors> {
    let lights = format!("[{light}]");
    let text = Parts { lights: &lights, ..RIGHT }.text();
    etalon_scene::parse_in(&text, "test.json", Some(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"))), None)
}

fn image(keys: &str) -> EnvironmentImage {
    let light = format!(r#"{{"type": "environment", "image": {{"file": "files/chequers.png"{keys}}}}}"#);
    let loaded = scene_with(&light).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(loaded.files.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["files/chequers.png"]);
    let LightKind::ImageEnvironment(image) = loaded.scene.lights[0].kind.clone() else { panic!("an image") };
    image
}

fn close(got: [f64; 3], want: [f64; 3]) {
    // A few roundings of unit vectors.
    assert!((0..3).all(|i| (got[i] - want[i]).abs() < 1e-15), "{got:?} is not {want:?}");
}

#[test]
fn directions_are_those_of_one_who_looks_along_forward() {
    let plain = image("");
    assert_eq!((plain.image.width, plain.image.height, plain.name.as_str()), (2, 2, "files/chequers.png"));
    assert_eq!(plain.white, Spectrum::illuminant(Illuminant::D65, 1.0).unwrap());
    close(plain.forward, [0.0, 0.0, -1.0]);
    close(plain.right, [1.0, 0.0, 0.0]);
    close(plain.up, [0.0, 1.0, 0.0]);
    // z is up; the middle is what is left of x across it.
    let turned = image(r#", "up": [0, 0, 3], "forward": [2, 0, 5], "scale": 2"#);
    close(turned.forward, [1.0, 0.0, 0.0]);
    close(turned.right, [0.0, -1.0, 0.0]);
    assert_eq!(turned.white, Spectrum::illuminant(Illuminant::D65, 2.0).unwrap());
    // Counter-clockwise seen from above: what was ahead is to the left, what was to the right is ahead.
    let quarter = image(r#", "rotation_deg": 90"#);
    close(quarter.forward, [-1.0, 0.0, 0.0]);
    close(quarter.right, [0.0, 0.0, -1.0]);
}

#[test]
fn projections_and_mirrors_arrive() {
    use etalon_scene::EnvironmentProjection::{EqualArea, LatitudeLongitude, LatitudeLongitudeAtPoles};
    assert_eq!(image("").projection, LatitudeLongitude);
    assert_eq!(image(r#", "projection": "latitude-longitude-at-poles""#).projection, LatitudeLongitudeAtPoles);
    let square = image(r#", "projection": "equal-area", "mirrored": true, "up": [0, 0, 1], "forward": [0, 1, 0]"#);
    assert_eq!(square.projection, EqualArea);
    close(square.forward, [0.0, 1.0, 0.0]);
    close(square.right, [-1.0, 0.0, 0.0]);
    close(square.up, [0.0, 0.0, 1.0]);
}

#[test]
fn what_is_wrong_with_an_image_is_said_where_it_is_named() {
    for (light, code) in [
        (r#"{"type": "environment", "image": {"file": "files/no.hdr"}}"#, Code::File),
        (r#"{"type": "environment", "image": {"file": "files/tetrahedron.ply"}}"#, Code::ImageFile),
        (r#"{"type": "environment", "image": {"file": "files/chequers.png", "scale": -1}}"#, Code::OutOfRange),
        (r#"{"type": "environment", "image": {"file": "files/chequers.png", "scale": 1e31}}"#, Code::OutOfRange),
        (r#"{"type": "environment", "image": {"file": "files/chequers.png", "up": [0, 0, 2]}}"#, Code::DegenerateView),
        (r#"{"type": "environment", "image": {}}"#, Code::MissingKey),
        (r#"{"type": "environment"}"#, Code::MissingKey),
        (r#"{"type": "environment", "radiance": 1, "image": {"file": "files/chequers.png"}}"#, Code::KeyConflict),
    ] {
        let errors = scene_with(light).expect_err(light);
        assert_eq!(errors.problems[0].code, code, "{errors}");
        assert_eq!(errors.problems.len(), 1, "{errors}");
    }
}
