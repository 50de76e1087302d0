//! `KHR_materials_specular`: coats of another index, of a share of the surface, of a hue.

use super::{imported, model, scene};
use etalon_scene::{MaterialKind, SpectrumTexture};
use serde_json::{Value, json};

/// What a material that is not metal becomes, and what is listed of its coat.
fn with(specular: Value) -> (MaterialKind, Vec<String>) {
    let mut model = model();
    model["materials"][0] = json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.5 }, "extensions": { "KHR_materials_specular": specular },
    });
    let imported = imported(&model).unwrap();
    let listed = imported.left_out.iter().filter(|l| l.place.contains("specular")).map(|l| l.what.clone()).collect();
    let scene = scene(&imported);
    let part = &scene.groups[scene.instances[0].group].objects[0];
    (scene.materials[part.material].kind.clone(), listed)
}

/// What a coat reflects head-on, and its hue.
fn head_on(kind: &MaterialKind) -> (f64, Option<[f64; 2]>) {
    match kind {
        MaterialKind::Plastic { coat, .. } => {
            let n = coat.eval(550.0);
            (((n - 1.0) / (n + 1.0)).powi(2), None)
        }
        MaterialKind::Tinted { kind, reflected: SpectrumTexture::Uniform(tint), .. } => {
            (head_on(kind).0, Some([tint.eval(450.0), tint.eval(630.0)]))
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_factor_of_a_coat_is_the_share_of_the_surface_that_has_one() {
    let (whole, listed) = with(json!({}));
    assert!((head_on(&whole).0 - 0.04).abs() < 1e-9 && listed.is_empty(), "{listed:?}");
    let (none, listed) = with(json!({ "specularFactor": 0 }));
    assert!(matches!(none, MaterialKind::Lambert { .. }) && listed.is_empty(), "{none:?}");
    let (part, listed) = with(json!({ "specularFactor": 0.3 }));
    let MaterialKind::Blend { parts, by } = &part else { panic!("{part:?}") };
    assert!(matches!(parts[0].1, MaterialKind::Lambert { .. }));
    assert!((head_on(&parts[1].1).0 - 0.04).abs() < 1e-9 && (by.mean() - 0.3).abs() < 1e-9 && listed.is_empty());
    let (image, listed) = with(json!({ "specularFactor": 0.5, "specularTexture": { "index": 0 } }));
    let MaterialKind::Blend { by, .. } = &image else { panic!("{image:?}") };
    // The image has no alpha: all of it is there.
    assert!((by.mean() - 0.5).abs() < 1e-9 && listed.is_empty(), "{by:?} {listed:?}");
}

#[test]
fn the_colour_of_a_coat_is_a_factor_on_what_it_reflects_head_on() {
    for (colour, known) in [(0.5, 0.02), (2.5, 0.1), (100.0, 0.9)] {
        let (kind, listed) = with(json!({ "specularColorFactor": [colour, colour, colour] }));
        assert!((head_on(&kind).0 - known).abs() < 1e-9 && listed.is_empty(), "{colour}: {kind:?} {listed:?}");
    }
    let (kind, listed) = with(json!({ "specularColorFactor": [2, 1, 0.5] }));
    let (strongest, hue) = head_on(&kind);
    let [blue, red] = hue.expect("a hue");
    assert!((strongest - 0.08).abs() < 1e-9 && red > 0.9 && blue < 0.4, "{kind:?}");
    assert!(listed.len() == 1 && listed[0].contains("grazing"), "{listed:?}");
    let (black, listed) = with(json!({ "specularColorFactor": [0, 0, 0] }));
    assert!(matches!(black, MaterialKind::Lambert { .. }) && listed.len() == 1, "{black:?}");
}
