//! What a `principled` material of Mitsuba becomes, and other things that it has and we have not.

use serde_json::Value;

use super::{imported, said, scene};

fn material(keys: &str) -> (Value, Vec<String>) {
    let text = format!(
        "<scene version=\"3.0.0\"><shape type=\"rectangle\"><bsdf type=\"principled\">{keys}</bsdf></shape></scene>"
    );
    let imported = imported("xml", &text);
    scene(&imported);
    let json: Value = serde_json::from_str(&imported.text).expect("a scene is JSON");
    (json["objects"][0]["material"].clone(), said(&imported))
}

fn number(name: &str, value: f64) -> String {
    format!("<float name=\"{name}\" value=\"{value}\"/>")
}

#[test]
fn a_principled_material_becomes_a_principled_surface_and_glass() {
    let (plain, said) = material(&number("roughness", 0.5));
    assert_eq!((&plain["type"], &plain["sides"]), (&"principled".into(), &"front".into()));
    assert!(said.is_empty(), "nothing is approximated: {said:?}");
    assert!((plain["index"].as_f64().unwrap() - 1.5).abs() < 1e-12, "what reflects 4 % head-on");
    assert_eq!(plain["alpha"], 0.25);
    assert_eq!(material(&number("metallic", 1.0)).0["metallic"], 1.0);
    assert_eq!(material(&number("spec_trans", 1.0)).0["type"], "dielectric");
    let (mixed, _) = material(&(number("metallic", 0.25) + &number("spec_trans", 0.5)));
    assert_eq!([&mixed["type"], &mixed["first"]["type"]], ["blend", "blend"]);
    let kinds = [&mixed["first"]["first"], &mixed["first"]["second"], &mixed["second"]].map(|part| &part["type"]);
    assert_eq!(kinds, ["principled", "dielectric", "principled"]);
    assert_eq!((&mixed["weight"], &mixed["second"]["metallic"]), (&0.25.into(), &1.into()));
    // √(1 − 0.9) = 0.316.
    let (brushed, _) = material(&number("anisotropic", 1.0));
    let widths = ["alpha_u", "alpha_v"].map(|key| brushed[key].as_f64().unwrap());
    assert!((widths[0] - 0.790_57).abs() < 1e-4 && (widths[1] - 0.079_057).abs() < 1e-5, "{widths:?}");
}

#[test]
fn lobes_of_it_keep_their_strength() {
    let lobes =
        [("sheen", 0.5), ("sheen_tint", 0.25), ("clearcoat", 1.0), ("clearcoat_gloss", 0.5), ("flatness", 0.75)];
    let keys: String = lobes.iter().map(|(name, value)| number(name, *value)).collect();
    let (surface, said) = material(&(keys.clone() + &number("spec_tint", 0.125)));
    assert!(said.is_empty(), "{said:?}");
    let expected = [
        ("sheen", 0.5),
        ("sheen_tint", 0.25),
        ("clear_coat", 1.0),
        ("clear_coat_alpha", 0.0505),
        ("flatness", 0.75),
        ("specular_tint", 0.125),
    ];
    for (key, value) in expected {
        assert!((surface[key].as_f64().unwrap() - value).abs() < 1e-12, "{key}: {surface}");
    }
    // Of half of the surface twice as much is as much.
    let (half, said) = material(&(keys.clone() + &number("spec_trans", 0.5)));
    assert!(said.is_empty(), "{said:?}");
    assert_eq!((&half["first"]["sheen"], &half["first"]["clear_coat"]), (&1.0.into(), &2.0.into()));
    let (_, said) = material(&(keys + &number("spec_trans", 1.0) + &number("spec_tint", 1.0)));
    let expected = [
        "line 1: what transmits reflects without \"spec_tint\"",
        "line 1: \"clearcoat\" of what transmits is left out",
        "line 1: \"sheen\" of what transmits is left out",
    ];
    assert_eq!(said, expected);
    let (metal, said) = material(&(number("sheen", 3.0) + &number("metallic", 1.0) + &number("spec_trans", 0.5)));
    assert_eq!((&metal["type"], &metal["sheen"], said.len()), (&"principled".into(), &3.0.into(), 0), "{said:?}");
    let (turned, said) = material(&number("eta", 0.5));
    assert_eq!((&turned["index"], said.len()), (&2.0.into(), 1), "{said:?}");
    let (bubble, _) = material(&(number("eta", 0.5) + &number("spec_trans", 1.0)));
    assert_eq!(bubble["interior"], 0.5, "light bends the way that it says");
    let (_, said) = material(&(number("roughness", 1.0) + &number("anisotropic", 1.0)));
    assert_eq!(said, ["line 1: the width of facets along the grain, 3.162, becomes 1"]);
}

#[test]
fn materials_and_lights_that_are_not_known_are_listed_by_their_names() {
    for (element, name) in [
        (
            "<shape type=\"sphere\"><bsdf type=\"measured_polarized\"><string name=\"filename\" value=\"a.pbsdf\"/></bsdf></shape>",
            "measured_polarized",
        ),
        ("<shape type=\"sphere\"><bsdf type=\"hair\"/></shape>", "hair"),
        ("<shape type=\"sphere\"/><emitter type=\"collimated\"/>", "collimated"),
        ("<shape type=\"sphere\"/><shape type=\"bsplinecurve\"/>", "bsplinecurve"),
    ] {
        let said = said(&imported("xml", &format!("<scene version=\"3.0.0\">{element}</scene>")));
        assert!(said.len() == 1 && said[0].contains(&format!("\"{name}\"")), "{said:?}");
    }
}

#[test]
fn nested_integrators_and_crops_are_listed_and_keep_the_depth() {
    let text = r#"<scene version="3.0.0"><integrator type="moment"><integrator type="path"><integer name="max_depth" value="7"/></integrator></integrator>
        <sensor type="perspective"><float name="fov" value="30"/><film type="hdrfilm"><integer name="width" value="96"/><integer name="height" value="72"/>
        <integer name="crop_offset_x" value="28"/><integer name="crop_width" value="40"/></film></sensor><shape type="sphere"/></scene>"#;
    let imported = imported("xml", text);
    assert_eq!(scene(&imported).integrator.max_depth, Some(7));
    let said = said(&imported);
    assert!(said.iter().any(|line| line.contains("--crop 28,0,40,72")) && said.len() == 2, "{said:?}");
}

#[test]
fn pplastic_loses_what_its_coat_reflects_back_down() {
    let text = "<scene version=\"3.0.0\"><shape type=\"rectangle\"><bsdf type=\"pplastic\"><float name=\"int_ior\" value=\"1.5\"/>\
                <float name=\"ext_ior\" value=\"1\"/><float name=\"alpha\" value=\"0.2\"/>\
                <float name=\"specular_reflectance\" value=\"0.75\"/></bsdf></shape></scene>";
    let imported = imported("xml", text);
    let json: Value = serde_json::from_str(&imported.text).expect("a scene is JSON");
    let plastic = &json["objects"][0]["material"];
    let keys = ["type", "sides", "internal_reflection", "distribution"].map(|key| plastic[key].as_str().unwrap());
    assert_eq!(keys, ["plastic", "front", "lost", "beckmann"]);
    let numbers = ["alpha", "coat", "reflectance", "reflected_tint"].map(|key| plastic[key].as_f64().unwrap());
    assert_eq!((numbers, said(&imported)), ([0.2, 1.5, 0.5, 0.75], vec![]));
    scene(&imported);
}

/// In Mitsuba, too, a lamp without a material reflects nothing.
#[test]
fn a_lamp_without_a_material_is_black() {
    let lamp = "<scene version=\"3.0.0\"><shape type=\"sphere\"><emitter type=\"area\"/></shape></scene>";
    let json: Value = serde_json::from_str(&imported("xml", lamp).text).expect("a scene is JSON");
    assert_eq!(json["objects"][0]["material"]["type"], "black");
}
