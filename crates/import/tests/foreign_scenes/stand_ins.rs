//! What stands for things of Mitsuba that a scene cannot say.

use etalon_scene::{MaterialKind, Projection};

use super::{imported, near, on_its_side, refusal, said, scene};

#[test]
fn a_lens_that_states_no_distance_is_in_focus_where_its_camera_sees_no_further() {
    for (keys, distance) in [
        ("", 1e4),
        ("<float name=\"far_clip\" value=\"250\"/>", 250.0),
        ("<float name=\"far_clip\" value=\"250\"/><float name=\"focus_distance\" value=\"7\"/>", 7.0),
    ] {
        let text = format!(
            "<scene version=\"3.0.0\"><sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.1\"/>{keys}</sensor>\
             <shape type=\"sphere\"/></scene>"
        );
        let imported = imported("xml", &text);
        assert_eq!(said(&imported), Vec::<String>::new());
        let scene = scene(&imported);
        let Projection::Perspective { lens: Some(lens), .. } = &scene.camera.projection else { panic!("a lens") };
        assert_eq!(lens.focus_distance_m, distance, "{keys}");
    }
}

#[test]
fn a_depth_of_0_becomes_1_and_minus_1_is_no_limit() {
    for (depth, becomes, lines) in [(-1, None, 0), (0, Some(1), 1), (1, Some(1), 0), (3, Some(3), 0)] {
        let text = format!(
            "<scene version=\"3.0.0\">\n<integrator type=\"path\"><integer name=\"max_depth\" value=\"{depth}\"/></integrator>\
             <shape type=\"sphere\"/></scene>"
        );
        let imported = imported("xml", &text);
        assert_eq!(scene(&imported).integrator.max_depth, becomes, "{depth}");
        assert_eq!(said(&imported).len(), lines, "{:?}", said(&imported));
        assert!(
            said(&imported).iter().all(|what| what.starts_with("line 2: a max_depth of 0 shows nothing in Mitsuba"))
        );
    }
}

#[test]
fn materials_that_cannot_be_read_say_what_stands_for_them() {
    for (plugin, kind) in
        [("hair", "fibres"), ("measured_polarized", "measured, with polarisation"), ("ward", "a glossy surface")]
    {
        let text =
            format!("<scene version=\"3.0.0\">\n<shape type=\"sphere\"><bsdf type=\"{plugin}\"/></shape></scene>");
        let imported = imported("xml", &text);
        let expected = format!(
            "line 2: the material \"{plugin}\" ({kind}) cannot be read: grey that scatters half of the light is used"
        );
        assert_eq!(said(&imported), [expected]);
    }
    let text = r#"<scene version="0.6.0">
<shape type="sphere"><subsurface type="dipole"><string name="material" value="skimmilk"/></subsurface></shape></scene>"#;
    let imported = imported("xml", text);
    let expected = "line 2: the subsurface scattering \"dipole\" is left out: the surface alone reflects light";
    assert_eq!(said(&imported), [expected]);
}

#[test]
fn the_second_material_of_a_twosided_may_be_the_first() {
    let two = |second: &str| {
        format!(
            "<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"a\"/><bsdf type=\"plastic\" id=\"b\"/>\n<shape type=\"sphere\">\
             <bsdf type=\"twosided\"><ref id=\"a\"/><ref id=\"{second}\"/></bsdf></shape></scene>"
        )
    };
    for (second, differs) in [("a", false), ("b", true)] {
        let imported = imported("xml", &two(second));
        assert_eq!(said(&imported), Vec::<String>::new());
        let kind = scene(&imported).materials[0].kind.clone();
        assert_eq!(matches!(kind, MaterialKind::TwoSided { .. }), differs, "{kind:?}");
        assert!(matches!(on_its_side(&kind), MaterialKind::Lambert { .. }), "{kind:?}");
    }
}

#[test]
fn a_scene_with_the_name_of_another_program_is_told_apart() {
    let pbrt = "LookAt 0 0 5 0 0 0 0 1 0\nWorldBegin\nShape \"sphere\"\n";
    assert_eq!(refusal("xml", pbrt), "it is a scene of pbrt, not of Mitsuba: rename it to .pbrt");
    let mitsuba = "\u{feff}\n<scene version=\"3.0.0\"><shape type=\"sphere\"/></scene>";
    assert_eq!(refusal("pbrt", mitsuba), "it is a scene of Mitsuba, not of pbrt: rename it to .xml");
}

#[test]
fn an_image_that_is_not_there_is_listed_with_its_place_once() {
    assert!(near("gone.png").is_err());
    let text = r#"<scene version="3.0.0">
<shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="gone.png"/></texture></bsdf></shape></scene>"#;
    let expected = "line 2: the image is left out: \"gone.png\" cannot be read: there is no gone.png";
    assert_eq!(said(&imported("xml", text)), [expected]);
}
