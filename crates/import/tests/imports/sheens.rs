//! Sheen of glTF: a share of a flat lobe where it is rough, left out where nothing in the format is like it.

use super::{PNG, imported, model, scene};
use etalon_scene::{Encoding, Image, MaterialKind, NumberTexture, SpectrumTexture};
use serde_json::{Value, json};

/// What a material of a sheen becomes, and what is listed of the sheen.
fn with(mut material: Value, sheen: Value) -> (MaterialKind, Vec<String>) {
    let mut model = model();
    material["extensions"]["KHR_materials_sheen"] = sheen;
    model["materials"][0] = material;
    model["extensionsRequired"] = json!(["KHR_materials_sheen"]);
    let imported = imported(&model).unwrap();
    let listed = imported.left_out.iter().filter(|l| l.place.contains("sheen")).map(|l| l.what.clone()).collect();
    let scene = scene(&imported);
    let part = &scene.groups[scene.instances[0].group].objects[0];
    (scene.materials[part.material].kind.clone(), listed)
}

/// The material below the sheen, and the hue of the sheen; it is a flat lobe without a surface.
fn parts(kind: &MaterialKind) -> (&MaterialKind, &etalon_optics::Spectrum, &NumberTexture) {
    let MaterialKind::Blend { parts, by } = kind else { panic!("{kind:?}") };
    let [(0.0, below), (1.0, fibres)] = &parts[..] else { panic!("{parts:?}") };
    let MaterialKind::Principled { reflectance: SpectrumTexture::Uniform(hue), index, facets, lobes } = fibres else {
        panic!("{fibres:?}")
    };
    assert_eq!((index.eval(550.0), facets.alpha, lobes.flatness, lobes.sheen), (1.0, [1.0; 2], 1.0, 0.0));
    (below, hue, by)
}

/// 0.2975 and 0.1405 are the means of glTF's lobe over all pairs of directions, 0.985 is that of the flat lobe.
#[test]
fn rough_sheen_reflects_as_much_as_that_of_gltf_in_the_mean() {
    let wood = json!({ "pbrMetallicRoughness": { "metallicFactor": 0 } });
    for (roughness, mean, elsewhere) in [(1.0, 0.2975, 16), (0.5, 0.1405, 42)] {
        let sheen = json!({ "sheenColorFactor": [0.8, 0.4, 0.0], "sheenRoughnessFactor": roughness });
        let (kind, listed) = with(wood.clone(), sheen);
        let (below, hue, by) = parts(&kind);
        assert!(matches!(below, MaterialKind::Plastic { .. }));
        assert!((by.mean() * 0.985 - 0.8 * mean).abs() < 1e-3, "{by:?}");
        assert_eq!(*hue, etalon_optics::Spectrum::rgb_reflectance([1.0, 0.5, 0.0]).unwrap());
        let said = format!("{:.3} of the light; {elsewhere} % of it in other directions", 0.8 * mean);
        assert!(listed.len() == 1 && listed[0].contains(&said), "{said}: {listed:?}");
    }
}

#[test]
fn narrow_sheen_is_left_out_and_no_sheen_is_not_listed() {
    let metal = json!({ "pbrMetallicRoughness": { "metallicFactor": 1, "roughnessFactor": 0.5 } });
    let (kind, listed) = with(metal.clone(), json!({ "sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 0.3 }));
    assert!(matches!(kind, MaterialKind::RoughConductor { .. }), "{kind:?}");
    assert!(listed.len() == 1 && listed[0].contains("left out") && listed[0].contains("reflect 0.070"), "{listed:?}");
    let (kind, listed) = with(metal.clone(), json!({ "sheenRoughnessFactor": 1 }));
    assert!(matches!(kind, MaterialKind::RoughConductor { .. }) && listed.is_empty(), "{listed:?}");
    // On metal, and over a clear coat.
    let rough = json!({ "sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 1 });
    let mut coated = metal.clone();
    coated["extensions"] = json!({ "KHR_materials_clearcoat": { "clearcoatFactor": 1 } });
    let (kind, listed) = with(coated, rough.clone());
    assert!(matches!(parts(&kind).0, MaterialKind::Blend { .. }));
    assert!(listed.iter().any(|line| line.contains("over the clear coat")), "{listed:?}");
    // Glass has none.
    let glass = json!({ "pbrMetallicRoughness": { "metallicFactor": 0 }, "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 } } });
    let (kind, listed) = with(glass, rough);
    assert!(!matches!(kind, MaterialKind::Blend { .. }) && listed.len() == 1, "{listed:?}");
}

#[test]
fn an_image_of_sheen_says_where_it_is() {
    let image = Image::decode(PNG, Encoding::Srgb).unwrap().0;
    let factor = [0.5, 0.25, 0.125];
    let sheen = json!({
        "sheenColorFactor": factor, "sheenColorTexture": { "index": 0 },
        "sheenRoughnessFactor": 1, "sheenRoughnessTexture": { "index": 0 },
    });
    let surface = json!({ "pbrMetallicRoughness": { "metallicFactor": 0 } });
    let (kind, listed) = with(surface.clone(), sheen.clone());
    let (_, hue, by) = parts(&kind);
    let NumberTexture::Image(weight) = by else { panic!("{by:?}") };
    let mean: [f64; 3] = std::array::from_fn(|c| factor[c] * image.mean()[c]);
    let strongest = (0..3).max_by(|a, b| mean[*a].total_cmp(&mean[*b])).unwrap();
    assert!((weight.factor[0] * 0.985 - factor[strongest] * 0.2975).abs() < 1e-3, "{weight:?}");
    for (found, texel) in weight.image.linear_texels().zip(image.linear_texels()) {
        assert!((found[0] - texel[strongest]).abs() < 1e-6, "{found:?} {texel:?}");
    }
    let expected = etalon_optics::Spectrum::rgb_reflectance(mean.map(|channel| channel / mean[strongest])).unwrap();
    assert!([450.0, 550.0, 650.0].iter().all(|nm| (hue.eval(*nm) - expected.eval(*nm)).abs() < 1e-9), "{hue:?}");
    for part in ["the mean of its alpha is used", "its colour is the mean of the image"] {
        assert!(listed.iter().any(|line| line.contains(part)), "{part}: {listed:?}");
    }
    // Other texture coordinates than those of the first image, and textures that do not exist.
    let mut other = sheen;
    other["sheenColorTexture"]["texCoord"] = json!(1);
    other["sheenRoughnessTexture"]["index"] = json!(9);
    let mut painted = surface;
    painted["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
    let (kind, listed) = with(painted, other);
    let by = parts(&kind).2;
    assert!((by.mean() * 0.985 - mean[strongest] * 0.2975).abs() < 1e-3, "{by:?}");
    for part in ["another set of texture coordinates", "texture 9, which does not exist"] {
        assert!(listed.iter().any(|line| line.contains(part)), "{part}: {listed:?}");
    }
}
