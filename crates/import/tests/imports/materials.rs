//! What materials of glTF say: roughness, metalness, anisotropy, films, coats, masks.

use super::{PNG, imported, model, scene, widths};
use etalon_scene::{Encoding, Image, MaterialKind, Metal, NumberTexture, Scene, SpectrumTexture, UvMap, Wrap};
use serde_json::{Value, json};

#[test]
fn the_roughness_of_glass_comes_from_the_image_of_its_material() {
    let mut model = model();
    model["meshes"][0]["primitives"][1]["attributes"]["TEXCOORD_0"] = json!(2);
    let glass = &mut model["materials"][1];
    glass["pbrMetallicRoughness"] =
        json!({ "metallicRoughnessTexture": { "index": 0 }, "roughnessFactor": 0.5, "metallicFactor": 0 });
    glass["extensions"]["KHR_materials_volume"] =
        json!({ "thicknessFactor": 1, "attenuationDistance": 0.5, "attenuationColor": [0.5, 0.6, 0.7] });
    let imported = imported(&model).unwrap();
    let scene = scene(&imported);
    let material = scene.materials.iter().find(|material| material.name == "glass").expect("the glass");
    let widths = widths(&material.kind);
    assert!(widths.iter().all(|(place, alpha)| (place * place - alpha).abs() < 1e-15), "{widths:?}");
    let image = Image::decode(PNG, Encoding::Linear).unwrap().0;
    let greens = || image.linear_texels().map(|texel| 0.5 * texel[1]);
    assert!(widths[0].0 <= greens().fold(1.0, f64::min) && widths[widths.len() - 1].0 >= greens().fold(0.0, f64::max));
    assert!(material.medium.is_some());
    assert!(!imported.left_out.iter().any(|left| left.what.contains("image")), "{:?}", imported.left_out);
}

#[test]
fn metalness_and_roughness_come_from_their_image() {
    let mut model = model();
    let surface = &mut model["materials"][0]["pbrMetallicRoughness"];
    surface["metallicRoughnessTexture"] = json!({ "index": 0 });
    surface["metallicFactor"] = json!(0.75);
    surface["roughnessFactor"] = json!(0.5);
    let scene = scene(&imported(&model).unwrap());
    let object = &scene.groups[scene.instances[0].group].objects[0];
    let MaterialKind::Blend { parts, by: NumberTexture::Image(metalness) } = &scene.materials[object.material].kind
    else {
        panic!("plastic and metal")
    };
    let image = Image::decode(PNG, Encoding::Linear).unwrap().0;
    let texels: Vec<_> = image.linear_texels().collect();
    let [(0.0, plastic), (1.0, metal)] = &parts[..] else { panic!("{parts:?}") };
    assert_eq!(metalness.factor, [0.75; 3]);
    // Blue is metalness and green roughness, whatever red says.
    for (found, texel) in metalness.image.linear_texels().zip(&texels) {
        assert!((found[0] - texel[2]).abs() < 1e-6, "{found:?} {texel:?}");
    }
    for kind in [plastic, metal] {
        let widths = widths(kind);
        assert!(widths.iter().all(|(place, alpha)| (place * place - alpha).abs() < 1e-15), "{widths:?}");
        let [least, most] = texels.iter().fold([1.0_f64, 0.0], |[l, m], t| [l.min(0.5 * t[1]), m.max(0.5 * t[1])]);
        assert!(widths[0].0 <= least && widths[widths.len() - 1].0 >= most);
    }
}

#[test]
fn the_colours_of_vertices_multiply_the_base_colour() {
    let mut model = model();
    // The four vertices of the first accessor stand for colours: (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0).
    model["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(0);
    model["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!(null);
    let painted = imported(&model).unwrap();
    assert!(!painted.left_out.iter().any(|l| l.place.contains("COLOR_0")), "{:?}", painted.left_out);
    let scene = scene(&painted);
    let object = &scene.groups[scene.instances[0].group].objects[0];
    assert_eq!(object.shape.vertex_colours()[2], [1.0, 1.0, 0.0]);
    let factors: Vec<[f64; 3]> = scene.materials[object.material].kind.vertex_colours().collect();
    assert_eq!(factors, [[0.5, 1.0, 0.25]]);
    // Beside an image, by which they are multiplied.
    let mut model = self::model();
    for primitive in 0..2 {
        model["meshes"][0]["primitives"][primitive]["attributes"]["COLOR_0"] = json!(0);
    }
    let with_image = imported(&model).unwrap();
    let places: Vec<&str> =
        with_image.left_out.iter().map(|l| l.place.as_str()).filter(|p| p.contains("COLOR")).collect();
    assert_eq!(places, Vec::<&str>::new());
    let scene = self::scene(&with_image);
    let object = &scene.groups[scene.instances[0].group].objects[0];
    let kind = &scene.materials[object.material].kind;
    assert_eq!(kind.vertex_colours().collect::<Vec<_>>(), [[1.0; 3]]);
    assert_eq!(kind.image().expect("an image").factor, [0.5, 1.0, 0.25]);
}

#[test]
fn images_are_scaled_turned_and_moved_as_their_transform_says() {
    let transform = json!({ "KHR_texture_transform": { "scale": [2, 4], "rotation": 0.5, "offset": [0.25, 0.5] } });
    let mut model = model();
    let material = &mut model["materials"][0];
    material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = transform.clone();
    material["normalTexture"]["extensions"] = transform;
    let imported = imported(&model).unwrap();
    assert!(!imported.left_out.iter().any(|left| left.place.contains("materials[0]")), "{:?}", imported.left_out);
    let scene = scene(&imported);
    let object = &scene.groups[scene.instances[0].group].objects[0];
    let MaterialKind::Plastic { reflectance: SpectrumTexture::Image(colours), .. } =
        &scene.materials[object.material].kind
    else {
        panic!("an image")
    };
    let relief = object.relief.as_ref().expect("a normal map").texture();
    for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.25, 0.75)] {
        // There v is counted from the top, and a positive angle turns right into up.
        let (sin, cos) = 0.5_f64.sin_cos();
        let [x, y] = [2.0 * u, 4.0 * (1.0 - v)];
        let [right, down] = [x * cos + y * sin + 0.25, -x * sin + y * cos + 0.5];
        for map in [colours.uv_map, relief.uv_map] {
            let [found_right, found_up] = map.at([u, v]);
            assert!((found_right - right).abs() + (found_up - (1.0 - down)).abs() < 1e-12, "{map:?} at {u}, {v}");
        }
    }
}

#[test]
fn what_shines_by_an_image_does_so_where_there_are_texture_coordinates() {
    let mut model = model();
    for material in [0, 2] {
        model["materials"][material]["emissiveFactor"] = json!([1, 0.5, 0.25]);
        model["materials"][material]["emissiveTexture"] = json!({ "index": 0 });
    }
    let imported = imported(&model).unwrap();
    let scene = scene(&imported);
    let emission = |i: usize| scene.groups[scene.instances[i].group].objects[0].emission.as_ref();
    let image = emission(0).expect("a lamp").image.as_ref().expect("an image");
    assert_eq!((image.factor, image.wrap), ([1.0, 0.5, 0.25], [Wrap::Clamp, Wrap::Mirror]));
    assert_eq!(image.uv_map, UvMap::IDENTITY);
    // The strip has no texture coordinates: nothing says which texel shines where.
    assert!(emission(2).is_none());
    assert!(imported.left_out.iter().any(|l| l.what.contains("emission is left out")), "{:?}", imported.left_out);
    // Of the material with another strength, where there are coordinates.
    model["materials"][0]["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 8 } });
    let brighter = self::scene(&self::imported(&model).unwrap());
    let object = &brighter.groups[brighter.instances[0].group].objects[0];
    assert_eq!(object.emission.as_ref().and_then(|e| e.image.as_ref()).expect("an image").factor, [8.0, 4.0, 2.0]);
}

/// `KHR_materials_anisotropy` of roughness 0.5: α is 0.25, and along the direction 0.25 + 0.75·0.6².
#[test]
fn anisotropy_of_gltf_arrives() {
    let with = |extension: Value, roughness_texture: bool| {
        let mut model = model();
        let mut surface = json!({ "metallicFactor": 1, "roughnessFactor": 0.5 });
        if roughness_texture {
            surface["metallicRoughnessTexture"] = json!({ "index": 0 });
        }
        let material =
            json!({ "pbrMetallicRoughness": surface, "extensions": { "KHR_materials_anisotropy": extension } });
        model["extensionsUsed"].as_array_mut().unwrap().push(json!("KHR_materials_anisotropy"));
        for (i, place) in model["materials"].as_array_mut().unwrap().iter_mut().enumerate() {
            if i != 1 {
                *place = material.clone();
            }
        }
        let imported = imported(&model).unwrap();
        let scene = scene(&imported);
        let facets = |i: usize| {
            let part = &scene.groups[scene.instances[i].group].objects[0];
            scene.materials[part.material].kind.microfacets().next().copied()
        };
        let said: Vec<_> = imported.left_out.iter().map(|l| l.what.clone()).collect();
        ([facets(0), facets(2)], said.join("\n"))
    };
    let full = json!({ "anisotropyStrength": 0.6, "anisotropyRotation": 0.5 });
    // The third part of the mesh has no texture coordinates.
    let ([found, without], said) = with(full.clone(), false);
    let found = found.unwrap();
    assert!((found.alpha[0] - 0.52).abs() < 1e-7 && (found.alpha[1] - 0.25).abs() < 1e-7, "{found:?}");
    assert!((found.rotation_rad - 0.5).abs() < 1e-12, "{found:?}");
    let mean = (0.52_f64 * 0.25).sqrt();
    assert!(
        without.is_some_and(|facets| facets.is_isotropic() && (facets.alpha[0] - mean).abs() < 1e-7),
        "{without:?}"
    );
    assert!(said.contains("geometric mean of both widths") && !said.contains("honoured"), "{said}");
    // Nothing without strength.
    let ([found, _], said) = with(json!({ "anisotropyRotation": 0.5 }), false);
    assert!(found.is_some_and(|facets| facets.is_isotropic()) && !said.contains("widths"), "{said}");
    // Images.
    let mut textured = full.clone();
    textured["anisotropyTexture"] = json!({ "index": 0 });
    let ([found, _], said) = with(textured, false);
    assert!(!found.unwrap().is_isotropic() && said.contains("its image is left out"), "{said}");
    let (_, said) = with(full, true);
    assert!(said.contains("since an image says the roughness"), "{said}");
}

/// `KHR_materials_iridescence`: a film on metal, and on glass.
#[test]
fn iridescence_of_gltf_arrives_as_a_thin_film() {
    let with = |extension: Value, metallic: f64, transmits: bool| {
        let mut model = model();
        let mut material = json!({
            "pbrMetallicRoughness": { "metallicFactor": metallic, "roughnessFactor": 0 },
            "extensions": { "KHR_materials_iridescence": extension },
        });
        if transmits {
            material["extensions"]["KHR_materials_transmission"] = json!({ "transmissionFactor": 1 });
            material["extensions"]["KHR_materials_volume"] = json!({ "thicknessFactor": 1 });
        }
        model["extensionsUsed"].as_array_mut().unwrap().push(json!("KHR_materials_iridescence"));
        model["materials"][0] = material;
        let imported = imported(&model).unwrap();
        let scene = scene(&imported);
        let kind = scene.materials[scene.groups[scene.instances[0].group].objects[0].material].kind.clone();
        let said: Vec<_> = imported.left_out.iter().map(|l| l.what.clone()).collect();
        (kind, said.join("\n"))
    };
    let layer = |kind: &MaterialKind| {
        let film = kind.film().expect("a film");
        assert_eq!(film.layers.len(), 1);
        (film.layers[0].thickness_nm.mean(), film.layers[0].index.eval(550.0).re)
    };
    let whole = json!({ "iridescenceFactor": 1, "iridescenceIor": 1.8, "iridescenceThicknessMaximum": 550 });
    let (metal, said) = with(whole.clone(), 1.0, false);
    assert!(matches!(metal, MaterialKind::Conductor { film: Some(_), .. }), "{metal:?}");
    assert_eq!(layer(&metal), (550.0, 1.8));
    assert!(!said.contains("film") && !said.contains("ignored"), "{said}");
    // The defaults of the extension; half of the surface carries the film.
    let (half, _) = with(json!({ "iridescenceFactor": 0.5 }), 1.0, false);
    let MaterialKind::Blend { parts, by } = &half else { panic!("{half:?}") };
    assert_eq!((parts[0].1.film(), layer(&parts[1].1), by.mean()), (None, (400.0, 1.3), 0.5));
    let (glass, _) = with(whole.clone(), 0.0, true);
    assert!(matches!(glass, MaterialKind::Dielectric { film: Some(_), .. }), "{glass:?}");
    // Below it the base has the real index of its reflectance: (1 + ½)/(1 − ½).
    let mut model = model();
    model["materials"][0] = json!({
        "pbrMetallicRoughness": { "metallicFactor": 1, "roughnessFactor": 0, "baseColorFactor": [0.25, 0.25, 0.25, 1] },
        "extensions": { "KHR_materials_iridescence": whole.clone() },
    });
    let scene = scene(&imported(&model).unwrap());
    let kind = &scene.materials[scene.groups[scene.instances[0].group].objects[0].material].kind;
    let MaterialKind::Conductor { metal: Metal::Index(index), .. } = kind else { panic!("{kind:?}") };
    let (n, k) = index.eval(500.0);
    assert!((n - 3.0).abs() < 1e-9 && k == 0.0, "{n} {k}");
    // What has none, or cannot have one.
    let (bare, said) = with(json!({ "iridescenceFactor": 0 }), 1.0, false);
    assert!(bare.film().is_none() && !said.contains("film"), "{said}");
    let (plastic, said) = with(whole.clone(), 0.0, false);
    assert!(plastic.film().is_none() && said.contains("has no film"), "{said}");
    let mut textured = whole;
    textured["iridescenceThicknessTexture"] = json!({ "index": 0 });
    let (metal, said) = with(textured, 1.0, false);
    assert!(layer(&metal).0 == 325.0 && said.contains("half-way"), "{said}");
}

#[test]
fn what_meshes_say_beyond_their_shape_is_listed() {
    let mut model = model();
    let positions = model["meshes"][0]["primitives"][0]["attributes"]["POSITION"].clone();
    model["meshes"][0]["primitives"][0]["attributes"]["COLOR_1"] = positions.clone();
    model["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = positions;
    let imported = imported(&model).unwrap();
    for place in ["$.meshes[0].primitives[0].attributes.COLOR_1", "$.meshes[0].primitives[0].attributes.JOINTS_0"] {
        assert!(imported.left_out.iter().any(|l| l.place == place), "{place}: {:#?}", imported.left_out);
    }
}

#[test]
fn opacity_normals_and_absorption_arrive() {
    let with = |mode: &str, factor: f64| {
        let mut model = model();
        model["materials"][0]["alphaMode"] = json!(mode);
        model["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, factor]);
        model["materials"][0]["normalTexture"]["scale"] = json!(0.5);
        model["materials"][1]["extensions"]["KHR_materials_volume"] =
            json!({ "thicknessFactor": 1, "attenuationDistance": 0.5, "attenuationColor": [0.25, 0.25, 0.25] });
        scene(&imported(&model).unwrap())
    };
    let textured = |scene: &Scene| {
        let mut objects = scene.groups.iter().flat_map(|group| &group.objects).chain(&scene.objects);
        objects.find(|o| scene.materials[o.material].kind.image().is_some()).expect("an image").clone()
    };
    let blend = with("BLEND", 0.5);
    let object = textured(&blend);
    // The image has no alpha: all of it is there.
    let image = object.opacity_image.expect("an image of opacity");
    assert_eq!((object.opacity, image.cutoff, image.eval([0.3, 0.7])), (0.5, None, 1.0));
    assert!(
        matches!(object.relief, Some(etalon_scene::Relief::Normals { strength: [0.5, 0.5], .. })),
        "{:?}",
        object.relief
    );
    let object = textured(&with("MASK", 0.8));
    // A cutoff of ½ of what the factor has made of alpha.
    assert_eq!((object.opacity, object.opacity_image.and_then(|image| image.cutoff)), (1.0, Some(0.625)));
    let object = textured(&with("OPAQUE", 0.5));
    assert!(object.opacity == 1.0 && object.opacity_image.is_none());
    let glass = blend.materials.iter().find(|m| m.medium.is_some()).expect("glass that absorbs");
    let per_m = glass.medium.as_ref().map(|medium| medium.absorption.eval(550.0)).unwrap();
    assert!((per_m - 4.0_f64.ln() / 0.5).abs() < 1e-12, "{per_m}");
}
