//! Measured materials of Mitsuba.

use etalon_scene::MaterialKind;

use super::{BSDF, imported, refusal, said, scene};

const MEASURED: &str = "<bsdf type=\"measured\"><string name=\"filename\" value=\"paint.bsdf\"/></bsdf>";

/// A scene of spheres, each with one of these materials.
fn spheres(materials: &[&str]) -> String {
    let shapes: String = materials.iter().map(|bsdf| format!("<shape type=\"sphere\">{bsdf}</shape>")).collect();
    format!("<scene version=\"3.0.0\">{shapes}</scene>")
}

#[test]
fn a_measured_material_arrives_with_its_file_on_the_side_that_was_measured() {
    let both = format!("<bsdf type=\"twosided\">{MEASURED}</bsdf>");
    let imported = imported("xml", &spheres(&[MEASURED, &both]));
    // The file is copied once.
    assert_eq!(imported.files.iter().filter(|file| file.bytes == BSDF).count(), 1);
    let scene = scene(&imported);
    assert_eq!(said(&imported), Vec::<String>::new());
    let kind = |object: usize| &scene.materials[scene.objects[object].material].kind;
    let MaterialKind::TwoSided { front, back } = kind(0) else { panic!("{:?}", kind(0)) };
    assert_eq!(**back, MaterialKind::Black);
    let (MaterialKind::Measured { surface }, MaterialKind::Measured { surface: both }) = (&**front, kind(1)) else {
        panic!("{front:?}, {:?}", kind(1))
    };
    assert_eq!(surface, both);
    assert_eq!((surface.brdf.wavelengths_nm(), surface.rotation_rad), (&[400.0, 550.0, 700.0][..], 0.0));
}

#[test]
fn a_file_that_is_missing_or_wrong_is_named() {
    let of = |name: &str| spheres(&[&MEASURED.replace("paint.bsdf", name)]);
    assert!(refusal("xml", &of("none.bsdf")).contains("none.bsdf"));
    assert!(refusal("xml", &spheres(&["<bsdf type=\"measured\"/>"])).contains("no \"filename\""));
    let cut = refusal("xml", &of("cut.bsdf"));
    assert!(cut.contains("\"cut.bsdf\": its field") && cut.contains("does not fit"), "{cut}");
}

/// The pole of a sphere is z there, and y here: only a grain makes a difference.
#[test]
fn a_grain_lies_as_it_does_in_mitsuba() {
    let linear = |name: &str| {
        let scene = scene(&imported("xml", &spheres(&[&MEASURED.replace("paint.bsdf", name)])));
        scene.objects[0].transform.linear
    };
    let unturned = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(linear("paint.bsdf"), unturned);
    assert_ne!(linear("grain.bsdf"), unturned);
}

#[test]
fn a_grain_without_texture_coordinates_becomes_grey() {
    let text = |file: &str| {
        let bsdf = MEASURED.replace("paint.bsdf", file);
        format!(
            "<scene version=\"3.0.0\"><shape type=\"ply\"><string name=\"filename\" value=\"bare.ply\"/>{bsdf}</shape></scene>"
        )
    };
    let grain = imported("xml", &text("grain.bsdf"));
    assert!(said(&grain).iter().any(|line| line.contains("the grain of its measured material")), "{:?}", said(&grain));
    assert!(scene(&grain).materials.iter().all(|material| !matches!(material.kind, MaterialKind::Measured { .. })));
    assert!(said(&imported("xml", &text("paint.bsdf"))).is_empty());
}
