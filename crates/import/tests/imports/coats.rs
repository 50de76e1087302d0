//! Clear coats of glTF: mixed by their factor, as glTF mixes them, and what stands for them on metal.

use super::{PNG, imported, model, scene};
use etalon_scene::{Encoding, Image, MaterialKind, NumberTexture, SpectrumTexture};
use serde_json::{Value, json};

/// What a material of a coat becomes, and what is listed of the coat. Its own roughness is 0.9, the coat's 0.2.
fn coated(surface: Value, coat: Value, extensions: Value) -> (MaterialKind, Vec<String>) {
    let mut model = model();
    let mut material = json!({ "pbrMetallicRoughness": { "roughnessFactor": 0.9 }, "extensions": extensions });
    for (key, value) in surface.as_object().unwrap() {
        material["pbrMetallicRoughness"][key] = value.clone();
    }
    material["extensions"]["KHR_materials_clearcoat"] = json!({ "clearcoatRoughnessFactor": 0.2 });
    for (key, value) in coat.as_object().unwrap() {
        material["extensions"]["KHR_materials_clearcoat"][key] = value.clone();
    }
    model["materials"][0] = material;
    let imported = imported(&model).unwrap();
    let listed = imported.left_out.iter().filter(|l| l.place.contains("clearcoat")).map(|l| l.what.clone()).collect();
    let scene = scene(&imported);
    let part = &scene.groups[scene.instances[0].group].objects[0];
    (scene.materials[part.material].kind.clone(), listed)
}

/// The width of the facets of plastic, and what its coat reflects head-on.
fn plastic(kind: &MaterialKind) -> [f64; 2] {
    let MaterialKind::Plastic { facets: Some(facets), coat, .. } = kind else { panic!("{kind:?}") };
    let n = coat.eval(550.0);
    [facets.alpha[0], ((n - 1.0) / (n + 1.0)).powi(2)]
}

/// Width and reflectance of a metal.
fn metal(kind: &MaterialKind) -> [f64; 2] {
    let MaterialKind::RoughConductor { metal: etalon_scene::Metal::Reflectance(reflectance), facets, .. } = kind else {
        panic!("{kind:?}")
    };
    let SpectrumTexture::Uniform(reflectance) = reflectance else { panic!("{reflectance:?}") };
    [facets.alpha[0], reflectance.eval(550.0)]
}

fn near(found: [f64; 2], expected: [f64; 2]) {
    assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-6), "{found:?} instead of {expected:?}");
}

/// The parts of a blend of two, and its weight.
fn parts(kind: &MaterialKind) -> (&MaterialKind, &MaterialKind, f64) {
    let MaterialKind::Blend { parts, by } = kind else { panic!("{kind:?}") };
    let [(0.0, first), (1.0, second)] = &parts[..] else { panic!("{parts:?}") };
    (first, second, by.mean())
}

#[test]
fn a_coat_on_what_is_not_metal_is_mixed_in_by_its_factor() {
    let dull = json!({ "metallicFactor": 0 });
    let ior = json!({ "KHR_materials_ior": { "ior": 1.8 } });
    // The clear coat reflects 0.04 head-on, whatever the index of what is below; that reflects (0.8/2.8)².
    let (kind, listed) = coated(dull.clone(), json!({ "clearcoatFactor": 1 }), ior.clone());
    near(plastic(&kind), [0.04, 0.04]);
    assert!(listed.len() == 1 && listed[0].contains("which would reflect 0.078 of the light head-on"), "{listed:?}");
    let (kind, _) = coated(dull.clone(), json!({ "clearcoatFactor": 0.3 }), ior);
    let (bare, clear, weight) = parts(&kind);
    near(plastic(bare), [0.81, (0.8_f64 / 2.8).powi(2)]);
    near(plastic(clear), [0.04, 0.04]);
    assert!((weight - 0.3).abs() < 1e-12);
    // Over a base without a coat of its own it is exact.
    let (kind, listed) = coated(
        dull.clone(),
        json!({ "clearcoatFactor": 0.25 }),
        json!({ "KHR_materials_specular": { "specularFactor": 0 } }),
    );
    let (bare, clear, weight) = parts(&kind);
    assert!(matches!(bare, MaterialKind::Lambert { .. }) && (weight - 0.25).abs() < 1e-12, "{kind:?}");
    near(plastic(clear), [0.04, 0.04]);
    assert_eq!(listed, Vec::<String>::new());
    // None of the factor 0, and the grain of the base is not the coat's.
    let (kind, listed) = coated(dull.clone(), json!({ "clearcoatFactor": 0 }), json!({}));
    near(plastic(&kind), [0.81, 0.04]);
    assert_eq!(listed, Vec::<String>::new());
    let grain = json!({ "KHR_materials_anisotropy": { "anisotropyStrength": 0.6 } });
    let (kind, _) = coated(dull, json!({ "clearcoatFactor": 1 }), grain);
    near(plastic(&kind), [0.04, 0.04]);
    assert!(kind.microfacets().all(|facets| facets.is_isotropic()), "{kind:?}");
}

#[test]
fn a_coat_on_metal_becomes_white_facets_that_reflect_as_much_head_on() {
    let gold = json!({ "metallicFactor": 1, "baseColorFactor": [0.5, 0.5, 0.5, 1] });
    for factor in [1.0, 0.5] {
        let (kind, listed) = coated(gold.clone(), json!({ "clearcoatFactor": factor }), json!({}));
        let (bare, white, weight) = parts(&kind);
        near(metal(bare), [0.81, 0.5]);
        near(metal(white), [0.04, 1.0]);
        // glTF: (1 − 0.04 factor) of the metal, and 0.04 factor.
        let head_on = (1.0 - weight) * 0.5 + weight;
        assert!((head_on - ((1.0 - 0.04 * factor) * 0.5 + 0.04 * factor)).abs() < 1e-12, "{head_on}");
        let at_60_deg = format!("60° from the normal the coat would take {:.3}", 0.07 * factor);
        assert!(listed.len() == 1 && listed[0].contains(&at_60_deg), "{listed:?}");
    }
    // By Schlick's formula, in full.
    assert!((0.04 + 0.96 * 0.5_f64.powi(5) - 0.07).abs() < 1e-12);
    // Half metal: both parts have the coat.
    let half = json!({ "metallicFactor": 0.5, "baseColorFactor": [0.5, 0.5, 0.5, 1] });
    let (kind, listed) = coated(half, json!({ "clearcoatFactor": 1 }), json!({}));
    let (ground, metal, _) = parts(&kind);
    near(plastic(ground), [0.04, 0.04]);
    assert!((parts(metal).2 - 0.04).abs() < 1e-12 && listed.len() == 2, "{listed:?}");
    // Films stay below it.
    let film = json!({ "KHR_materials_iridescence": { "iridescenceFactor": 1 } });
    let (kind, _) = coated(json!({ "metallicFactor": 1 }), json!({ "clearcoatFactor": 1 }), film);
    let (below, white, _) = parts(&kind);
    assert!(below.film().is_some() && white.film().is_none());
}

#[test]
fn images_say_where_the_coat_is_and_how_rough() {
    let image = Image::decode(PNG, Encoding::Linear).unwrap().0;
    let coat = json!({
        "clearcoatFactor": 0.5, "clearcoatTexture": { "index": 0 },
        "clearcoatRoughnessFactor": 0.8, "clearcoatRoughnessTexture": { "index": 0 },
    });
    let (kind, listed) = coated(json!({ "metallicFactor": 0 }), coat.clone(), json!({}));
    let MaterialKind::Blend { by: NumberTexture::Image(weight), parts } = &kind else { panic!("{kind:?}") };
    assert_eq!(weight.factor, [0.5; 3]);
    for (found, texel) in weight.image.linear_texels().zip(image.linear_texels()) {
        assert!((found[0] - texel[0]).abs() < 1e-6, "{found:?} {texel:?}");
    }
    near(plastic(&parts[0].1), [0.81, 0.04]);
    let widths = super::widths(&parts[1].1);
    let greens = || image.linear_texels().map(|texel| 0.8 * texel[1]);
    assert!(widths[0].0 <= greens().fold(1.0, f64::min) && widths[widths.len() - 1].0 >= greens().fold(0.0, f64::max));
    assert!(listed.len() == 1 && listed[0].contains("takes the place"), "{listed:?}");
    // On metal.
    let (kind, listed) = coated(json!({ "metallicFactor": 1 }), coat.clone(), json!({}));
    let MaterialKind::Blend { by: NumberTexture::Image(weight), .. } = &kind else { panic!("{kind:?}") };
    assert!((weight.factor[0] - 0.02).abs() < 1e-12, "{weight:?}");
    assert!(listed.len() == 1 && listed[0].contains("0.07 times its image"), "{listed:?}");
    // What cannot be kept: bent normals, other coordinates than those of the first image, textures that do not exist.
    let mut other = coat.clone();
    other["clearcoatNormalTexture"] = json!({ "index": 0 });
    other["clearcoatRoughnessTexture"]["texCoord"] = json!(1);
    other["clearcoatTexture"]["index"] = json!(7);
    let surface = json!({ "metallicFactor": 0, "baseColorTexture": { "index": 0 } });
    let (kind, listed) = coated(surface, other, json!({}));
    assert!((parts_of_images(&kind) - 0.5).abs() < 1e-12, "{kind:?}");
    for part in ["normal map is left out", "another set of texture coordinates", "texture 7, which does not exist"] {
        assert!(listed.iter().any(|line| line.contains(part)), "{part}: {listed:?}");
    }
}

fn parts_of_images(kind: &MaterialKind) -> f64 {
    let (_, clear, weight) = parts(kind);
    let image = Image::decode(PNG, Encoding::Linear).unwrap().0;
    near(plastic(clear), [(0.8 * image.mean()[1]).powi(2), 0.04]);
    weight
}

#[test]
fn coats_keep_their_colour_and_glass_has_none() {
    let (kind, listed) = coated(
        json!({ "metallicFactor": 0 }),
        json!({ "clearcoatFactor": 1 }),
        json!({ "KHR_materials_transmission": { "transmissionFactor": 1 } }),
    );
    assert!(!matches!(kind, MaterialKind::Blend { .. }));
    assert!(listed.len() == 1 && listed[0].contains("it is left out: what transmits light"), "{listed:?}");
    // Colours of vertices are those of the metal, not of the coat.
    let mut model = model();
    model["materials"][0] = json!({ "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 1 } } });
    model["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" }));
    model["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(4);
    let scene = scene(&imported(&model).unwrap());
    let part = &scene.groups[scene.instances[0].group].objects[0];
    let (bare, white, _) = parts(&scene.materials[part.material].kind);
    let coloured = |kind: &MaterialKind| format!("{kind:?}").contains("VertexColours");
    assert!(coloured(bare) && !coloured(white), "{bare:?} {white:?}");
}
