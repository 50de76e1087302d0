//! Materials that Mitsuba has on one side.

use etalon_scene::{MaterialKind, Side};

use super::{imported, scene};

/// The material of the last object.
fn material(shape: &str) -> MaterialKind {
    let scene = scene(&imported("xml", &format!("<scene version=\"3.0.0\">{shape}</scene>")));
    scene.materials[scene.objects.last().expect("an object").material].kind.clone()
}

fn side(kind: &MaterialKind) -> Option<Side> {
    match kind {
        MaterialKind::OneSided { side, .. } => Some(*side),
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
