//! Variants of glTF: other materials of the same primitives.

use etalon_import::{Imported, Options, import_bytes_with};
use etalon_scene::MaterialKind;
use serde_json::json;

use super::{glb, model, nothing, scene};

fn with(variant: Option<&str>, index: u32) -> Result<Imported, String> {
    let mut model = model();
    model["extensions"]["KHR_materials_variants"] = json!({ "variants": [{ "name": "day" }, { "name": "night" }] });
    model["meshes"][0]["primitives"][1]["extensions"] = json!({ "KHR_materials_variants": { "mappings": [
        { "material": 1, "variants": [0] }, { "material": index, "variants": [1] },
    ] } });
    let options = Options { variant: variant.map(str::to_owned), ..Options::default() };
    import_bytes_with("glb", &glb(&model), &nothing, "", "model.glb", &options)
}

#[test]
fn the_variant_that_is_asked_for_decides_materials() {
    for (variant, is_glass) in [(None, true), (Some("day"), true), (Some("night"), false)] {
        let imported = with(variant, 2).unwrap();
        let scene = scene(&imported);
        let kind = |i: usize| &scene.materials[scene.groups[scene.instances[i].group].objects[0].material].kind;
        assert_eq!(matches!(kind(1), MaterialKind::Dielectric { .. }), is_glass, "{variant:?}");
        // Of the others nothing is said.
        assert!(matches!(kind(0), MaterialKind::Plastic { .. }), "{variant:?}");
        let listed = imported.left_out.iter().find(|l| l.place == "$.extensions.KHR_materials_variants");
        assert_eq!(listed.map(|l| l.what.contains("\"day\", \"night\"")), variant.is_none().then_some(true));
    }
}

#[test]
fn a_variant_that_is_not_there_is_refused_with_the_names_of_the_others() {
    let why = with(Some("dusk"), 2).unwrap_err();
    assert_eq!(why, "there is no variant \"dusk\": it has \"day\", \"night\"");
    let why = with(Some("night"), 7).unwrap_err();
    assert!(why.starts_with("$.meshes[0].primitives[1]") && why.contains("material 7"), "{why}");
    let options = Options { variant: Some("day".to_owned()), ..Options::default() };
    let bare = import_bytes_with("glb", &glb(&model()), &nothing, "", "model.glb", &options).unwrap_err();
    assert_eq!(bare, "there is no variant \"day\": it has none");
    let other = import_bytes_with("ply", b"ply", &nothing, "", "model.ply", &options).unwrap_err();
    assert!(other.contains("only models of glTF have variants"), "{other}");
}
