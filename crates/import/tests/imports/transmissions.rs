//! `KHR_materials_transmission`: panes for thin walls, solids where there is a thickness, and what metal does with it.

use super::{imported, model, scene};
use etalon_scene::MaterialKind;
use serde_json::{Value, json};

/// What a material becomes, and what is listed of what passes it.
fn with(surface: Value, extensions: Value) -> (MaterialKind, Vec<String>) {
    let mut model = model();
    model["materials"][0] = json!({ "pbrMetallicRoughness": surface, "extensions": extensions });
    let imported = imported(&model).unwrap();
    let of_it = |place: &str| place.contains("transmission") || place.contains("volume");
    let listed = imported.left_out.iter().filter(|l| of_it(&l.place)).map(|l| l.what.clone()).collect();
    let scene = scene(&imported);
    let part = &scene.groups[scene.instances[0].group].objects[0];
    (scene.materials[part.material].kind.clone(), listed)
}

fn passes(factor: f64) -> Value {
    json!({ "KHR_materials_transmission": { "transmissionFactor": factor } })
}

#[test]
fn without_a_thickness_a_wall_is_a_pane() {
    let clear = json!({ "metallicFactor": 0, "roughnessFactor": 0 });
    let (pane, listed) = with(clear.clone(), passes(1.0));
    assert!(matches!(pane, MaterialKind::ThinDielectric { .. }) && listed.is_empty(), "{pane:?} {listed:?}");
    let (part, listed) = with(clear.clone(), passes(0.25));
    let MaterialKind::Blend { parts, by } = &part else { panic!("{part:?}") };
    assert!(matches!(parts[1].1, MaterialKind::ThinDielectric { .. }) && (by.mean() - 0.25).abs() < 1e-9, "{part:?}");
    assert!(listed.is_empty(), "{listed:?}");
    let mut thin = passes(1.0);
    thin["KHR_materials_volume"] = json!({ "attenuationDistance": 0.1, "attenuationColor": [0.5, 0.5, 0.5] });
    let (pane, listed) = with(clear.clone(), thin.clone());
    assert!(matches!(pane, MaterialKind::ThinDielectric { .. }), "{pane:?}");
    assert!(listed.len() == 1 && listed[0].contains("thicknessFactor is 0"), "{listed:?}");
    thin["KHR_materials_volume"]["thicknessFactor"] = json!(0.01);
    let (solid, listed) = with(clear, thin);
    assert!(matches!(solid, MaterialKind::Dielectric { .. }) && listed.is_empty(), "{solid:?} {listed:?}");
    // The format has no rough pane.
    let (rough, listed) = with(json!({ "metallicFactor": 0, "roughnessFactor": 0.5 }), passes(1.0));
    assert!(matches!(rough, MaterialKind::RoughDielectric { .. }), "{rough:?}");
    assert!(listed.len() == 1 && listed[0].contains("a rough thin wall"), "{listed:?}");
    let (nearly, listed) = with(json!({ "metallicFactor": 0, "roughnessFactor": 0.1 }), passes(1.0));
    assert!(matches!(nearly, MaterialKind::ThinDielectric { .. }), "{nearly:?}");
    assert!(listed.len() == 1 && listed[0].contains("a smooth pane"), "{listed:?}");
}

#[test]
fn a_metal_passes_nothing() {
    let (metal, listed) = with(json!({ "metallicFactor": 1, "roughnessFactor": 0 }), passes(1.0));
    assert!(matches!(metal, MaterialKind::Conductor { .. }) && listed.is_empty(), "{metal:?} {listed:?}");
    // glTF's own value of what a file does not say is 1.
    let (metal, _) = with(json!({ "roughnessFactor": 0 }), passes(1.0));
    assert!(matches!(metal, MaterialKind::Conductor { .. }), "{metal:?}");
    let (part, listed) = with(json!({ "metallicFactor": 0.5, "roughnessFactor": 0 }), passes(1.0));
    let MaterialKind::Blend { parts, .. } = &part else { panic!("{part:?}") };
    let [(_, pane), (_, metal)] = &parts[..] else { panic!("{parts:?}") };
    assert!(matches!(pane, MaterialKind::ThinDielectric { .. }) && matches!(metal, MaterialKind::Conductor { .. }));
    assert!(listed.is_empty(), "{listed:?}");
}
