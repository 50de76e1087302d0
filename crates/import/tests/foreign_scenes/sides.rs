//! Materials that Mitsuba has on one side.

use etalon_scene::{MaterialKind, Shape, Side};

use super::{imported, scene};

/// The material of the last object.
fn material(shape: &str) -> MaterialKind {
    let scene = scene(&imported("xml", &format!("<scene version=\"3.0.0\">{shape}</scene>")));
    scene.materials[scene.objects.last().expect("an object").material].kind.clone()
}

fn side(kind: &MaterialKind) -> Option<Side> {
    match kind {
        MaterialKind::TwoSided { back, .. } if **back == MaterialKind::Black => Some(Side::Front),
        MaterialKind::TwoSided { front, .. } if **front == MaterialKind::Black => Some(Side::Back),
        _ => None,
    }
}

#[test]
fn what_only_reflects_is_black_from_behind_unless_it_is_twosided() {
    for plugin in ["diffuse", "conductor", "roughconductor", "plastic", "roughplastic"] {
        let plain = format!("<bsdf type=\"{plugin}\"/>");
        for (bsdf, flipped, expected) in [
            (plain.clone(), false, Some(Side::Front)),
            (plain.clone(), true, Some(Side::Back)),
            (format!("<bsdf type=\"twosided\">{plain}</bsdf>"), false, None),
            (format!("<bsdf type=\"twosided\">{plain}</bsdf>"), true, None),
        ] {
            let shape =
                format!("<shape type=\"rectangle\"><boolean name=\"flip_normals\" value=\"{flipped}\"/>{bsdf}</shape>");
            assert_eq!(side(&material(&shape)), expected, "{shape}");
        }
    }
    assert_eq!(side(&material("<shape type=\"rectangle\"/>")), Some(Side::Front));
    assert_eq!(side(&material("<shape type=\"rectangle\"><bsdf type=\"dielectric\"/></shape>")), None);
    // A name that is used on both sides and on one.
    let two = "<bsdf type=\"diffuse\" id=\"m\"/><shape type=\"rectangle\"><bsdf type=\"twosided\"><ref id=\"m\"/></bsdf></shape>\
               <shape type=\"rectangle\"><ref id=\"m\"/></shape>";
    assert_eq!(side(&material(two)), Some(Side::Front));
}

/// Of two materials the second is that of the back, and of a turned surface that of the front.
#[test]
fn a_twosided_surface_may_have_two_materials() {
    let both = "<bsdf type=\"twosided\"><bsdf type=\"conductor\"/><bsdf type=\"diffuse\"/></bsdf>";
    for flipped in [false, true] {
        let kind = material(&format!(
            "<shape type=\"rectangle\"><boolean name=\"flip_normals\" value=\"{flipped}\"/>{both}</shape>"
        ));
        let MaterialKind::TwoSided { front, back } = &kind else { panic!("{kind:?}") };
        let (metal, paint) = if flipped { (back, front) } else { (front, back) };
        assert!(matches!(**metal, MaterialKind::Mirror { .. }), "{metal:?}");
        assert!(matches!(**paint, MaterialKind::Lambert { .. }), "{paint:?}");
    }
}

#[test]
fn the_parts_of_a_blend_have_sides_of_their_own() {
    let blend = "<bsdf type=\"blendbsdf\"><bsdf type=\"diffuse\"/><bsdf type=\"twosided\"><bsdf type=\"plastic\"/></bsdf></bsdf>";
    for (flipped, expected) in [(false, Side::Front), (true, Side::Back)] {
        let kind = material(&format!(
            "<shape type=\"rectangle\"><boolean name=\"flip_normals\" value=\"{flipped}\"/>{blend}</shape>"
        ));
        let MaterialKind::Blend { parts, .. } = &kind else { panic!("{kind:?}") };
        assert_eq!((side(&parts[0].1), side(&parts[1].1)), (Some(expected), None));
    }
}

/// The front is where the normals of the vertices point, whichever way round the corners go. With normals of faces, the corners decide.
#[test]
fn normals_say_which_side_of_a_mesh_is_its_front() {
    let up = |kind: &str, text: &str| {
        let scene = scene(&imported(kind, text));
        let Shape::Mesh(mesh) = &scene.objects[0].shape else { panic!("a mesh") };
        let [a, b, c] = mesh.triangles[0].map(|i| mesh.vertices[i as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    for (file, flat, is_up) in [
        ("normals.obj", "false", true),
        ("turned.obj", "false", false),
        ("turned.obj", "true", true),
        ("a.obj", "false", true),
    ] {
        let text = format!(
            r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="obj"><string name="filename" value="{file}"/>
<boolean name="face_normals" value="{flat}"/></shape></scene>"#
        );
        assert_eq!(up("xml", &text), is_up, "{file} {flat}");
    }
    for (z, is_up) in [(1, true), (-1, false)] {
        let text = format!(
            "Scale -1 1 1\nWorldBegin\nShape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [0 0 0 1 0 0 0 1 0] \
             \"normal N\" [0 0 {z} 0 0 {z} 0 0 {z}]"
        );
        assert_eq!(up("pbrt", &text), is_up, "{z}");
    }
}
