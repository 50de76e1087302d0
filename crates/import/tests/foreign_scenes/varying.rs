//! Numbers of materials that vary over a surface.

use etalon_scene::{MaterialKind, NumberTexture};
use serde_json::Value;

use super::{imported, on_its_side, said, scene};

/// A material of a rectangle as a scene has it, as the renderer sees it, and what was said of it.
fn material(bsdf: &str) -> (Value, MaterialKind, Vec<String>) {
    let text = format!("<scene version=\"3.0.0\"><shape type=\"rectangle\">{bsdf}</shape></scene>");
    let imported = imported("xml", &text);
    let scene = scene(&imported);
    let json: Value = serde_json::from_str(&imported.text).expect("a scene is JSON");
    let kind = scene.materials[scene.objects[0].material].kind.clone();
    (json["objects"][0]["material"].clone(), kind, said(&imported))
}

/// A chequerboard whose lower left field is the first. Mitsuba lays numbers the other way round than colours.
fn board(name: &str, [first, second]: [f64; 2], scale: f64) -> String {
    format!(
        "<texture type=\"checkerboard\" name=\"{name}\"><float name=\"color1\" value=\"{first}\"/><float name=\"color0\" value=\"{second}\"/>\
         <transform name=\"to_uv\"><scale x=\"{scale}\" y=\"3\"/></transform></texture>"
    )
}

fn image(name: &str) -> String {
    format!(
        "<texture type=\"bitmap\" name=\"{name}\"><string name=\"filename\" value=\"chequers.png\"/><boolean name=\"raw\" value=\"true\"/></texture>"
    )
}

fn parts(kind: &MaterialKind) -> (&MaterialKind, &MaterialKind, &NumberTexture) {
    match kind {
        MaterialKind::Blend { parts, by } => (on_its_side(&parts[0].1), on_its_side(&parts[1].1), by),
        other => panic!("a blend, not {other:?}"),
    }
}

fn widths(kind: &MaterialKind) -> [f64; 2] {
    kind.microfacets().next().expect("it is rough").alpha
}

/// The first fields have the first numbers, wherever the board lies.
#[test]
fn widths_by_a_chequerboard_are_a_blend_of_both_fields() {
    for plugin in ["roughconductor", "roughdielectric", "roughplastic", "pplastic"] {
        let numbers = board("alpha_u", [0.05, 0.3], 2.0) + &board("alpha_v", [0.2, 0.1], 2.0);
        let (_, kind, said) = material(&format!("<bsdf type=\"{plugin}\">{numbers}</bsdf>"));
        assert!(said.iter().all(|what| what.contains("coat")), "{said:?}");
        let (first, second, by) = parts(&kind);
        assert_eq!((widths(first), widths(second)), ([0.05, 0.2], [0.3, 0.1]), "{plugin}");
        for i in 0..40 {
            for k in 0..40 {
                let (u, v) = ((f64::from(i) + 0.3) / 40.0, (f64::from(k) + 0.7) / 40.0);
                let [x, y] = [2.0 * u, 3.0 * v].map(|t: f64| t - t.floor() > 0.5);
                assert_eq!(by.eval([u, v]), f64::from(x != y), "{u} {v}");
            }
        }
    }
    // Of one width, too, and of two boards that lie apart.
    let (_, kind, _) = material(&format!("<bsdf type=\"roughconductor\">{}</bsdf>", board("alpha", [0.1, 0.4], 2.0)));
    let (first, second, _) = parts(&kind);
    assert_eq!((widths(first), widths(second)), ([0.1; 2], [0.4; 2]));
    let apart = board("alpha_u", [0.05, 0.3], 2.0) + &board("alpha_v", [0.2, 0.1], 4.0);
    let (_, kind, _) = material(&format!("<bsdf type=\"roughconductor\">{apart}</bsdf>"));
    let all: Vec<_> = kind.microfacets().map(|facets| facets.alpha).collect();
    assert_eq!(all, [[0.05, 0.2], [0.05, 0.1], [0.3, 0.2], [0.3, 0.1]]);
    // The same everywhere, it is one material.
    let (_, kind, _) = material(&format!("<bsdf type=\"roughconductor\">{}</bsdf>", board("alpha", [0.1, 0.1], 2.0)));
    assert!(matches!(on_its_side(&kind), MaterialKind::RoughConductor { .. }));
}

#[test]
fn every_number_of_a_principled_material_may_be_a_chequerboard() {
    let names = [
        ("metallic", "metallic"),
        ("sheen", "sheen"),
        ("spec_tint", "specular_tint"),
        ("flatness", "flatness"),
        ("sheen_tint", "sheen_tint"),
        ("clearcoat", "clear_coat"),
    ];
    for (name, key) in names {
        let (json, _, said) = material(&format!("<bsdf type=\"principled\">{}</bsdf>", board(name, [0.25, 0.75], 2.0)));
        assert_eq!(said, Vec::<String>::new(), "{name}");
        assert_eq!([&json["first"][key], &json["second"][key]], [&0.25, &0.75], "{name}: {json}");
        assert_eq!([&json["first"]["sides"], &json["second"]["sides"]], ["front"; 2], "{name}");
    }
    let all = board("roughness", [0.5, 0.2], 2.0) + &board("anisotropic", [0.0, 1.0], 2.0);
    let (json, kind, said) = material(&format!("<bsdf type=\"principled\">{all}</bsdf>"));
    assert_eq!((said, &json["first"]["alpha"]), (vec![], &0.25.into()));
    let (_, second, _) = parts(&kind);
    let ratio = widths(second)[1] / widths(second)[0];
    assert!((ratio - 0.1).abs() < 1e-12, "{ratio}");
    let gloss = board("clearcoat_gloss", [0.0, 1.0], 2.0) + "<float name=\"clearcoat\" value=\"1\"/>";
    let (json, ..) = material(&format!("<bsdf type=\"principled\">{gloss}</bsdf>"));
    let widths = ["first", "second"].map(|part| json[part]["clear_coat_alpha"].as_f64().unwrap());
    assert!((widths[0] - 0.1).abs().max((widths[1] - 0.001).abs()) < 1e-12, "{widths:?}");
    let (json, _, said) =
        material(&format!("<bsdf type=\"principled\">{}</bsdf>", board("spec_trans", [0.0, 1.0], 2.0)));
    let kinds = [&json["first"]["type"], &json["second"]["type"]];
    assert_eq!((kinds, said), ([&"principled".into(), &"dielectric".into()], vec![]));
}

/// What a material is linear in is a blend of what it is at 0 and at 1.
#[test]
fn lobes_of_a_principled_material_may_be_images() {
    for (name, key) in
        [("sheen", "sheen"), ("spec_tint", "specular_tint"), ("flatness", "flatness"), ("clearcoat", "clear_coat")]
    {
        let (json, _, said) = material(&format!("<bsdf type=\"principled\">{}</bsdf>", image(name)));
        assert_eq!(said, Vec::<String>::new(), "{name}");
        assert!(json["first"].get(key).is_none() && json["second"][key] == 1.0, "{name}: {json}");
        assert!(json["weight_image"]["file"].is_string(), "{name}: {json}");
    }
    let (json, _, said) = material(&format!("<bsdf type=\"principledthin\">{}</bsdf>", image("diff_trans")));
    let kinds = [&json["first"]["type"], &json["second"]["type"]];
    assert_eq!((kinds, said.len()), ([&"lambert".into(), &"translucent".into()], 1), "{said:?}");
    // One image of both widths is one of a width.
    let both = image("alpha_u") + &image("alpha_v");
    let (json, _, said) = material(&format!("<bsdf type=\"roughconductor\">{both}</bsdf>"));
    assert!(said.is_empty() && json["roughness_image"]["quantity"] == "alpha", "{json} {said:?}");
}

#[test]
fn what_makes_too_many_parts_becomes_its_mean_and_is_listed() {
    let names = ["sheen", "spec_tint", "flatness", "sheen_tint", "clearcoat"];
    let apart: String = names.iter().enumerate().map(|(i, name)| board(name, [0.25, 0.75], 1.0 + i as f64)).collect();
    let (json, kind, said) = material(&format!("<bsdf type=\"principled\">{apart}</bsdf>"));
    assert_eq!((kind.parts().len(), said.len()), (16, 1), "{said:?}");
    assert!(said[0].contains("the mean of the image of"), "{said:?}");
    assert!(json["type"] == "blend");
    // An image of roughness is many materials already.
    let rough = image("roughness") + &apart + "<float name=\"spec_trans\" value=\"0.5\"/>";
    let (_, _, said) = material(&format!("<bsdf type=\"principled\">{rough}</bsdf>"));
    assert_eq!(said.iter().filter(|what| what.contains("the mean of the image")).count(), 5, "{said:?}");
}
