//! Measured BRDFs: a file arrives, what is wrong is refused with its place.

use crate::common::{Parts, RIGHT};
use etalon_scene::{Code, Loaded, MaterialKind, MeasuredSurface, NamedFile, SceneErrors};

const PAINT: &[u8] = include_bytes!("files/paint.bsdf");

/// The bytes of a truth's file.
fn of_truth(name: &str) -> Vec<u8> {
    let truths = etalon_oracle::truths::truths();
    truths.into_iter().find(|truth| truth.name == name).expect("a truth").files[0].bytes.clone()
}

fn load(materials: &str, objects: &str) -> Result<Loaded, SceneErrors> {
    let text = Parts { materials, objects, ..RIGHT }.text();
    let file = |name: &str, bytes: Vec<u8>| NamedFile { name: name.to_owned(), bytes };
    let files = [
        file("paint.bsdf", PAINT.to_vec()),
        file("cut.bsdf", PAINT[..PAINT.len() - 1].to_vec()),
        file("grain.bsdf", of_truth("measured-grain-in-the-sun")),
    ];
    etalon_scene::parse_with_files(&text, "test.json", &files, None)
}

const BALL: &str = r#"[{ "shape": { "type": "sphere", "radius_m": 1 }, "material": "m" }]"#;

fn material(keys: &str) -> MaterialKind {
    let loaded = load(&format!(r#"{{ "m": {{ "type": "measured", {keys} }} }}"#), BALL);
    loaded.unwrap_or_else(|errors| panic!("{errors}")).scene.materials[0].kind.clone()
}

fn surface(kind: &MaterialKind) -> &MeasuredSurface {
    match kind {
        MaterialKind::Measured { surface } => surface,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_front_reflects_unless_the_scene_says_otherwise() {
    let MaterialKind::TwoSided { front: kind, back } = material(r#""file": "paint.bsdf""#) else { panic!("two sides") };
    assert_eq!(*back, MaterialKind::Black);
    let brdf = &surface(&kind).brdf;
    assert!(surface(&kind).is_isotropic() && surface(&kind).is_coloured() && !brdf.is_zero());
    assert_eq!(brdf.wavelengths_nm(), [400.0, 550.0, 700.0]);
    surface(&material(r#""file": "paint.bsdf", "sides": "both""#));
    let turned = material(r#""file": "grain.bsdf", "sides": "both", "tangent_rotation_deg": 180"#);
    assert_eq!((surface(&turned).is_isotropic(), surface(&turned).rotation_rad), (false, std::f64::consts::PI));
}

#[test]
fn a_file_is_read_once() {
    let both =
        r#"{ "m": { "type": "measured", "file": "paint.bsdf" }, "n": { "type": "measured", "file": "paint.bsdf" } }"#;
    assert_eq!(load(both, BALL).unwrap_or_else(|errors| panic!("{errors}")).files.len(), 1);
}

fn wrong(keys: &str, objects: &str, code: Code, says: &str) {
    let errors = load(&format!(r#"{{ "m": {{ "type": "measured", {keys} }} }}"#), objects).map(|_| ()).expect_err(says);
    let found = errors.problems.iter().any(|problem| problem.code == code && problem.message.contains(says));
    assert!(found, "{errors}");
}

#[test]
fn what_is_wrong_is_said() {
    wrong(
        r#""file": "cut.bsdf""#,
        BALL,
        Code::File,
        "cut.bsdf: its field \"jacobian\" of the extents [1] does not fit",
    );
    wrong(r#""file": "none.bsdf""#, BALL, Code::File, "not among the files");
    wrong(r#""sides": "both""#, BALL, Code::MissingKey, "file");
    let turned = r#""file": "paint.bsdf", "tangent_rotation_deg": 30"#;
    wrong(turned, BALL, Code::KeyConflict, "the material is isotropic");
    let mesh = r#"[{ "shape": { "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]] }, "material": "m" }]"#;
    wrong(r#""file": "grain.bsdf""#, mesh, Code::NoTextureCoordinates, "no texture coordinates");
}
