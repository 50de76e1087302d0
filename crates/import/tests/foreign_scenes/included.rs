//! Files of Mitsuba within files.

use etalon_import::{Imported, import_bytes};
use etalon_scene::{MaterialKind, Shape, SpectrumTexture};

use super::{on_its_side, said, scene};

/// Files in two folders, of which each names others from where it lies.
fn near(name: &str) -> Result<Vec<u8>, String> {
    let text = match name {
        "parts/all.xml" => {
            r#"<scene version="3.0.0"><include filename="red.xml"/><include filename="far/ball.xml"/><include filename="beside.xml"/></scene>"#
        }
        "parts/red.xml" => {
            r#"<bsdf version="3.0.0" type="diffuse" id="red"><rgb name="reflectance" value="0.6 0.1 0.1"/></bsdf>"#
        }
        "parts/far/ball.xml" => {
            r#"<shape version="3.0.0" type="sphere" name="forgotten"><include filename="half.xml"/><ref id="red"/></shape>"#
        }
        "parts/far/half.xml" => r#"<scene version="3.0.0"><default name="r" value="0.5"/></scene>"#,
        // Beside the scene, and not beside the file that names it.
        "beside.xml" => r#"<emitter version="3.0.0" type="point"/>"#,
        "wood.xml" => r#"<texture version="0.6.0" type="checkerboard"><rgb name="color0" value="1"/></texture>"#,
        other => return Err(format!("there is no {other}")),
    };
    Ok(text.as_bytes().to_vec())
}

fn imported(text: &str) -> Imported {
    import_bytes("xml", text.as_bytes(), &near, "", "a").unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn the_root_of_an_included_file_stands_where_the_file_is_included() {
    let imported = imported(r#"<scene version="3.0.0"><include filename="parts/all.xml"/></scene>"#);
    assert_eq!(said(&imported), Vec::<String>::new());
    let scene = scene(&imported);
    assert!(matches!(scene.objects[0].shape, Shape::Sphere { .. }));
    assert!(matches!(on_its_side(&scene.materials[0].kind), MaterialKind::Lambert { .. }));
    assert_eq!((scene.objects.len(), scene.lights.len()), (1, 1));
}

#[test]
fn an_included_root_has_the_name_that_it_is_given() {
    let imported = imported(
        r#"<scene version="3.0.0"><shape type="rectangle"><bsdf type="diffuse"><include filename="wood.xml" name="reflectance"/></bsdf></shape></scene>"#,
    );
    assert_eq!(said(&imported), Vec::<String>::new());
    let scene = scene(&imported);
    let kind = on_its_side(&scene.materials[0].kind);
    let MaterialKind::Lambert { reflectance } = kind else { panic!("{kind:?}") };
    assert!(!matches!(reflectance, SpectrumTexture::Uniform(_)), "{reflectance:?}");
}

#[test]
fn a_file_that_is_nowhere_is_named_with_the_line_that_includes_it() {
    let text = "<scene version=\"3.0.0\">\n<include filename=\"gone.xml\"/></scene>";
    let why = import_bytes("xml", text.as_bytes(), &near, "", "a").unwrap_err();
    assert_eq!(why, "line 2: \"gone.xml\" cannot be read: there is no gone.xml");
}
