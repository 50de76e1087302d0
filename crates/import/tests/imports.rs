//! Models of other programs: what they say arrives in the scene, what cannot be honoured is listed with its place.

use etalon_import::{Imported, import_bytes};
use etalon_scene::{
    Encoding, Image, Light, LightKind, MaterialKind, Metal, NumberTexture, Projection, Scene, Shape, SpectrumTexture,
    TextureFilter, Wrap,
};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::LazyLock;

fn nothing(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

fn scene(imported: &Imported) -> Scene {
    imported.parse("model", None).unwrap_or_else(|errors| panic!("{errors}\n{}", imported.text)).scene
}

/// A PNG of 2 × 2 texels.
const PNG: &[u8] = include_bytes!("../../scene/tests/files/chequers.png");

/// A quadrilateral in the z plane from (0, 0) to (1, 1), as two triangles of 16-bit indices, with normals, texture
/// coordinates and an image.
static BUFFER: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut bytes = Vec::new();
    let mut floats = |list: &[f32]| bytes.extend(list.iter().flat_map(|v| v.to_le_bytes()));
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    floats(&[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend(PNG);
    bytes
});

/// A model with nodes within nodes, two uses of a mesh, a camera, lights and materials of several kinds.
fn model() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_transmission", "KHR_materials_ior",
            "KHR_materials_dispersion", "KHR_materials_emissive_strength", "KHR_texture_transform"],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "point", "color": [1, 0.5, 0.25], "intensity": 8 },
            { "type": "directional", "intensity": 3 },
            { "type": "spot", "intensity": 2, "spot": { "outerConeAngle": 0.5 } },
        ] } },
        "scene": 0,
        "scenes": [{ "nodes": [0, 3, 4, 5, 6] }],
        "nodes": [
            { "name": "table", "translation": [10, 0, 0], "rotation": [0, 0, FRAC_1_SQRT_2, FRAC_1_SQRT_2], "children": [1, 2] },
            { "name": "card", "mesh": 0, "scale": [2, 3, 4] },
            { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 5, 1] },
            { "name": "eye", "camera": 0, "translation": [0, 1, 9] },
            { "extensions": { "KHR_lights_punctual": { "light": 0 } }, "translation": [1, 2, 3] },
            { "name": "sun", "extensions": { "KHR_lights_punctual": { "light": 1 } }, "rotation": [-FRAC_1_SQRT_2, 0, 0, FRAC_1_SQRT_2] },
            { "extensions": { "KHR_lights_punctual": { "light": 2 } } },
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1, "aspectRatio": 1.5 } }],
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0 },
            { "attributes": { "POSITION": 0 }, "indices": 3, "material": 1 },
            { "attributes": { "POSITION": 0 }, "material": 2, "mode": 5 },
            { "attributes": { "POSITION": 0 }, "mode": 1 },
        ] }],
        "materials": [
            { "name": "painted", "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorFactor": [0.5, 1, 0.25, 1],
                "baseColorTexture": { "index": 0, "extensions": {
                    "KHR_texture_transform": { "scale": [2, 4], "offset": [0.25, 0.5] } } } },
              "normalTexture": { "index": 0 } },
            { "name": "glass", "pbrMetallicRoughness": { "roughnessFactor": 0 }, "extensions": {
                "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_ior": { "ior": 1.6 },
                "KHR_materials_dispersion": { "dispersion": 0.5 } } },
            { "name": "lamp", "emissiveFactor": [1, 0.5, 0], "pbrMetallicRoughness": { "roughnessFactor": 0.1, "baseColorFactor": [0.1, 0.1, 0.1, 1] },
              "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 7 } } },
        ],
        "textures": [{ "source": 0, "sampler": 0 }],
        "samplers": [{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }],
        "images": [{ "bufferView": 4, "mimeType": "image/png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 128, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 140, "byteLength": PNG.len() },
        ],
        "buffers": [{ "byteLength": BUFFER.len() }],
    })
}

/// A model as a GLB file.
fn glb(model: &Value) -> Vec<u8> {
    let mut text = model.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = BUFFER.clone();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes()[..], kind, data].concat();
    let body = [chunk(b"JSON", &text), chunk(b"BIN\0", &binary)].concat();
    [b"glTF", &2_u32.to_le_bytes()[..], &(12 + body.len() as u32).to_le_bytes(), &body].concat()
}

fn imported(model: &Value) -> Result<Imported, String> {
    import_bytes("glb", &glb(model), &nothing, "m-files/", "model.glb")
}

/// Every width of facets in a material of varied roughness, with the roughness at which it stands alone.
fn widths(kind: &MaterialKind) -> Vec<(f64, f64)> {
    let MaterialKind::Blend { parts, by: NumberTexture::Image(_) } = kind else { panic!("{kind:?}") };
    let alpha = |kind: &MaterialKind| match kind {
        MaterialKind::Plastic { facets: Some(facets), .. }
        | MaterialKind::RoughConductor { facets, .. }
        | MaterialKind::RoughDielectric { facets, .. } => facets.alpha[0],
        MaterialKind::Conductor { .. } | MaterialKind::Dielectric { .. } => 0.0,
        other => panic!("{other:?}"),
    };
    parts.iter().map(|(place, part)| (*place, alpha(part))).collect()
}

#[test]
fn the_roughness_of_glass_comes_from_the_image_of_its_material() {
    let mut model = model();
    model["meshes"][0]["primitives"][1]["attributes"]["TEXCOORD_0"] = json!(2);
    let glass = &mut model["materials"][1];
    glass["pbrMetallicRoughness"] = json!({ "metallicRoughnessTexture": { "index": 0 }, "roughnessFactor": 0.5 });
    glass["extensions"]["KHR_materials_volume"] =
        json!({ "attenuationDistance": 0.5, "attenuationColor": [0.5, 0.6, 0.7] });
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
fn a_glb_file_becomes_a_scene_whose_nodes_are_where_they_were_placed() {
    let imported = imported(&model()).unwrap();
    let scene = scene(&imported);
    // Two nodes of three primitives with triangles: each a group, placed twice.
    assert!(scene.objects.is_empty());
    assert_eq!((scene.groups.len(), scene.instances.len()), (3, 6));
    // By hand: scaled by (2, 3, 4), turned a quarter about z, moved 10 along x: (1, 1, 1) goes to (−3 + 10, 2, 4).
    let t = &scene.instances[0].transform;
    let at: Vec<f64> = (0..3).map(|i| t.linear[i].iter().sum::<f64>() + t.translation_m[i]).collect();
    for (found, expected) in at.iter().zip([7.0, 2.0, 4.0]) {
        assert!((found - expected).abs() < 1e-6, "{at:?}");
    }
    let part = |i: usize| &scene.groups[scene.instances[i].group].objects[0];
    let Shape::Mesh(mesh) = &part(0).shape else { panic!("a mesh") };
    assert_eq!((mesh.vertices.len(), mesh.triangles.as_slice()), (4, [[0, 1, 2], [0, 2, 3]].as_slice()));
    assert_eq!((mesh.normals[0], mesh.uvs[2]), ([0.0, 0.0, 1.0], [1.0, 1.0]));
    // A strip, every other triangle of which is turned.
    let Shape::Mesh(strip) = &part(2).shape else { panic!("a mesh") };
    assert_eq!(strip.triangles, [[0, 1, 2], [2, 1, 3]]);
    // The second node places the same.
    assert_eq!(scene.instances[0].group, scene.instances[3].group);
    assert_eq!(imported.files.len(), 4);
    assert!(imported.files.iter().all(|file| file.name.starts_with("m-files/")));
    assert_eq!(imported.added, Vec::<String>::new());
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
    assert_eq!((image.factor, image.uv_scale, image.wrap), ([1.0, 0.5, 0.25], [1.0; 2], [Wrap::Clamp, Wrap::Mirror]));
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
fn glb_materials_lights_and_cameras_arrive() {
    let scene = scene(&imported(&model()).unwrap());
    let part = |i: usize| &scene.groups[scene.instances[i].group].objects[0];
    let kind = |i: usize| &scene.materials[part(i).material].kind;
    let MaterialKind::Plastic { reflectance: SpectrumTexture::Image(image), coat, facets, internal_reflection, .. } =
        kind(0)
    else {
        panic!("an image")
    };
    // glTF mixes the base with what the coat reflects: 1 − F of it remains, and the light within the coat takes nothing of it.
    assert_eq!(format!("{internal_reflection:?}"), "Uncoloured");
    assert_eq!(*facets, Some(1.0.into()));
    assert_eq!(coat.eval(550.0), 1.5);
    assert_eq!((image.wrap, image.filter), ([Wrap::Clamp, Wrap::Mirror], TextureFilter::Nearest));
    assert_eq!((image.factor, image.uv_scale), ([0.5, 1.0, 0.25], [2.0, 4.0]));
    // v = 0.25 here is 0.75 from the top: 4·0.75 + 0.5 = 3.5 from the top, so −2.5 here.
    assert_eq!(0.25 * image.uv_scale[1] + image.uv_offset[1], 1.0 - 3.5);
    assert_eq!(image.uv_offset[0], 0.25);
    let MaterialKind::Dielectric { interior, .. } = kind(1) else { panic!("glass") };
    // n_d and the Abbe number 20/0.5 = 40, from the definition.
    let n = |nm: f64| interior.eval(nm);
    assert!((n(587.5618) - 1.6).abs() < 1e-12);
    assert!(((n(587.5618) - 1.0) / (n(486.1327) - n(656.2725)) - 40.0).abs() < 1e-9);
    // Metal of roughness 0.1, so α = 0.01, that reflects a tenth of white head-on.
    let MaterialKind::RoughConductor { metal: Metal::Reflectance(reflectance), facets, .. } = kind(2) else {
        panic!("metal")
    };
    assert!((facets.alpha[0] - 0.01).abs() < 1e-7 && facets.is_isotropic(), "{facets:?}");
    assert_eq!(reflectance, &etalon_optics::Spectrum::Constant(0.1).into());
    let emission = part(2).emission.as_ref().expect("a lamp");
    let expected = etalon_optics::Spectrum::rgb_emission([7.0, 3.5, 0.0], etalon_optics::Illuminant::D65).unwrap();
    assert_eq!(emission.radiance, expected);

    let [point, sun, spot] = scene.lights.as_slice() else { panic!("three lights") };
    assert!(matches!(point, Light { kind: LightKind::Point { position_m: [1.0, 2.0, 3.0], .. }, .. }));
    // The sun's node turns −z by −90° about x: it shines straight down.
    let LightKind::Directional { direction, .. } = &sun.kind else { panic!("a sun") };
    assert!((direction[1] + 1.0).abs() < 1e-6, "{direction:?}");
    let LightKind::Spot { axis, half_angles_rad: [inner, outer], .. } = spot.kind else { panic!("a spot") };
    assert_eq!((axis, inner), ([0.0, 0.0, -1.0], 0.0));
    assert!((outer - 0.5).abs() < 1e-7, "{outer}");
    let Projection::Perspective { vertical_fov_rad, .. } = scene.camera.projection else { panic!("perspective") };
    assert!((vertical_fov_rad - 0.7).abs() < 1e-6);
    assert_eq!((scene.camera.position_m, scene.camera.forward), ([0.0, 1.0, 9.0], [0.0, 0.0, -1.0]));
    assert_eq!((scene.film.width, scene.film.height), (1080, 720));
}

#[test]
fn what_is_not_honoured_is_listed_with_its_path() {
    let mut model = model();
    model["animations"] = json!([{ "channels": [], "samplers": [] }]);
    model["skins"] = json!([{ "joints": [0] }]);
    model["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 0, 0, 1]);
    model["materials"][2]["extensions"]["KHR_materials_sheen"] = json!({});
    let imported = imported(&model).unwrap();
    let places: Vec<&str> = imported.left_out.iter().map(|l| l.place.as_str()).collect();
    for expected in [
        "$.animations[0]",
        "$.skins",
        "$.materials[1].pbrMetallicRoughness",
        "$.materials[2].extensions.KHR_materials_sheen",
        "$.extensions.KHR_lights_punctual.lights[2]",
        "$.meshes[0].primitives[3]",
    ] {
        assert!(places.contains(&expected), "{expected} is not among {places:#?}");
    }
    // The scene to edit says so too.
    assert!(imported.text.contains("left out: $.materials[2].extensions.KHR_materials_sheen"));
}

/// On what is not metal the clear coat is the coat; vertex colours, weights of skins and morph targets are listed.
#[test]
fn clear_coats_and_what_meshes_say_beyond_their_shape() {
    let coated = |factor: f64, metallic: f64| {
        let mut model = model();
        model["materials"][0] = json!({
            "pbrMetallicRoughness": { "metallicFactor": metallic, "roughnessFactor": 0.9 },
            "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": factor, "clearcoatRoughnessFactor": 0.2 } },
        });
        let imported = imported(&model).unwrap();
        let said = imported.left_out.iter().filter(|l| l.place.ends_with("clearcoat")).map(|l| l.what.clone());
        (imported.text.contains("\"alpha\": 0.04"), said.collect::<Vec<_>>())
    };
    let (shown, said) = coated(1.0, 0.0);
    assert!(shown && said.len() == 1 && said[0].contains("takes the place"), "{said:?}");
    for (factor, metallic, listed) in [(0.0, 0.0, 0), (0.3, 0.0, 1), (1.0, 1.0, 1)] {
        let (shown, said) = coated(factor, metallic);
        assert!(!shown && said.len() == listed, "{factor} {metallic} {said:?}");
    }
    let mut model = model();
    let positions = model["meshes"][0]["primitives"][0]["attributes"]["POSITION"].clone();
    model["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = positions.clone();
    model["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": positions }]);
    let imported = imported(&model).unwrap();
    for place in ["$.meshes[0].primitives[0].attributes.COLOR_0", "$.meshes[0].primitives[0].targets"] {
        assert!(imported.left_out.iter().any(|l| l.place == place), "{place}: {:#?}", imported.left_out);
    }
}

/// A model may require whole numbers as positions, with a stride of whole words.
#[test]
fn quantised_meshes_arrive_and_compressed_ones_are_refused() {
    use base64::Engine as _;
    let corners: [[i16; 4]; 4] = [[-100, 0, 0, 7], [100, 0, 0, 7], [100, 50, 0, 7], [-100, 50, 0, 7]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let mut model = model();
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let uri = format!("data:application/octet-stream;base64,{data}");
    model["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": bytes.len(), "uri": uri }));
    model["bufferViews"][0] = json!({ "buffer": 1, "byteLength": 32, "byteStride": 8 });
    model["accessors"][0] = json!({ "bufferView": 0, "componentType": 5122, "count": 4, "type": "VEC3", "min": [-100, 0, 0], "max": [100, 50, 0] });
    for extension in ["KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression"] {
        model["extensionsRequired"] = json!([extension]);
        model["extensionsUsed"].as_array_mut().unwrap().push(json!(extension));
        let read = imported(&model);
        if extension != "KHR_mesh_quantization" {
            assert!(read.unwrap_err().contains(extension));
            continue;
        }
        let scene = scene(&read.unwrap());
        let vertices = scene.placed_objects().filter_map(|object| match &object.shape {
            Shape::Mesh(mesh) => Some(mesh.vertices[2]),
            _ => None,
        });
        assert!(vertices.into_iter().any(|v| v == [100.0, 50.0, 0.0]));
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

#[test]
fn a_damaged_glb_file_is_refused_with_its_place() {
    let change = |pointer: &str, value: Value| {
        let mut model = model();
        *model.pointer_mut(pointer).expect(pointer) = value;
        imported(&model).expect_err(pointer)
    };
    assert!(change("/accessors/0/count", json!(1000)).contains("$.accessors[0]"));
    assert!(change("/accessors/3/count", json!(4_000_000_000_u32)).contains("$.accessors[3]"));
    assert!(change("/bufferViews/0/byteLength", json!(40)).contains("$.accessors[0]"));
    assert!(change("/bufferViews/3/byteOffset", json!(4_000_000_000_u32)).contains("$.accessors[3]"));
    assert!(change("/buffers/0/byteLength", json!(100_000)).contains("$.buffers[0]"));
    assert!(change("/accessors/2/type", json!("VEC3")).contains("$.accessors[2]"));
    // Indices read from the normals' numbers.
    assert!(change("/accessors/3/bufferView", json!(1)).contains("names vertex"));
    assert!(change("/images/0", json!({ "bufferView": 4 })).contains("$.images[0]"));
    assert!(change("/meshes/0/primitives/0/indices", json!(9)).contains("$.meshes[0].primitives[0]"));
    // A node within itself.
    assert!(change("/nodes/2", json!({ "children": [0] })).contains("$.nodes[0]"));
    assert!(imported(&json!({ "asset": { "version": "2.0" } })).is_err());
    for length in [0, 4, 12, 20, 100, 2000] {
        assert!(import_bytes("glb", &glb(&model())[..length], &nothing, "", "cut").is_err(), "{length}");
    }
}

#[test]
fn a_gltf_file_finds_its_buffer_beside_it_or_in_itself() {
    let mut model = model();
    model["buffers"][0]["uri"] = json!("my%20data.bin");
    let near = |name: &str| if name == "my data.bin" { Ok(BUFFER.clone()) } else { nothing(name) };
    let beside = import_bytes("gltf", model.to_string().as_bytes(), &near, "", "m.gltf").unwrap();
    use base64::Engine as _;
    let data = base64::engine::general_purpose::STANDARD.encode(&*BUFFER);
    model["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{data}"));
    let inside = import_bytes("gltf", model.to_string().as_bytes(), &nothing, "", "m.gltf").unwrap();
    assert_eq!(beside.text, inside.text);
    model["buffers"][0]["uri"] = json!("gone.bin");
    let lost = import_bytes("gltf", model.to_string().as_bytes(), &near, "", "m.gltf").unwrap_err();
    assert!(lost.contains("$.buffers[0]") && lost.contains("gone.bin"), "{lost}");
}

#[test]
fn a_mesh_alone_gets_a_camera_that_sees_all_of_it_and_light() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n100 0 0\n104 0 0\n100 2 0\n3 0 1 2\n";
    let imported = import_bytes("ply", ply.as_bytes(), &nothing, "", "t.ply").unwrap();
    assert_eq!(imported.added.len(), 2, "{:?}", imported.added);
    let scene = scene(&imported);
    assert!(matches!(scene.lights[0].kind, LightKind::Environment { .. }));
    let Projection::Perspective { vertical_fov_rad, .. } = scene.camera.projection else { panic!("perspective") };
    // Every corner is within the half angle of the picture's height.
    for corner in [[100.0, 0.0, 0.0], [104.0, 0.0, 0.0], [100.0, 2.0, 0.0]] {
        let to: [f64; 3] = std::array::from_fn(|i| corner[i] - scene.camera.position_m[i]);
        let dot: f64 = to.iter().zip(scene.camera.forward).map(|(a, b)| a * b).sum();
        let length = to.iter().map(|v| v * v).sum::<f64>().sqrt();
        assert!((dot / length).acos() < 0.5 * vertical_fov_rad);
    }
}

#[test]
fn obj_materials_become_paint_mirrors_glass_and_lamps() {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
        usemtl paint\nf 1/1 2/2 3/3\nusemtl mirror\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl lamp\nf 1 2 3\nusemtl bare\nf 1 2 3\n";
    let mtl = "newmtl paint\nKd 0.5 0.25 1\nmap_Kd -s 1 1 1 sub\\tiles.png\nKs 1 1 1\nmap_Bump b.png\n\
        newmtl mirror\nKd 0 0 0\nKs 0.9 0.9 0.9\nillum 3\nnewmtl glass\nd 0.1\nNi 1.45\nillum 7\nnewmtl lamp\nKe 3 2 1\nKd 0 0 0\n";
    let near = |name: &str| match name {
        "a.mtl" => Ok(mtl.as_bytes().to_vec()),
        "sub/tiles.png" => Ok(PNG.to_vec()),
        other => nothing(other),
    };
    let imported = import_bytes("obj", obj.as_bytes(), &near, "x/", "a.obj").unwrap();
    let scene = scene(&imported);
    let kind = |i: usize| &scene.materials[scene.objects[i].material].kind;
    let MaterialKind::Plastic { reflectance: SpectrumTexture::Image(image), .. } = kind(0) else { panic!("an image") };
    assert_eq!(image.factor, [0.5, 0.25, 1.0]);
    assert!(matches!(kind(1), MaterialKind::Mirror { .. }));
    let MaterialKind::Dielectric { interior, .. } = kind(2) else { panic!("glass") };
    assert!((interior.eval(500.0) - 1.45).abs() < 1e-6);
    assert!(scene.objects[3].emission.is_some() && scene.objects[4].emission.is_none());
    let said: Vec<String> = imported.left_out.iter().map(|l| format!("{}: {}", l.place, l.what)).collect();
    for part in ["map_bump", "Ks", "options of map_Kd"] {
        assert!(said.iter().any(|line| line.contains("\"paint\"") && line.contains(part)), "{part}: {said:#?}");
    }
    // Without its library it is grey, and says so.
    let lost = import_bytes("obj", obj.as_bytes(), &nothing, "", "a.obj").unwrap();
    assert!(lost.left_out.iter().any(|l| l.what.contains("a.mtl")), "{:?}", lost.left_out);
    // Beside the backdrop and two lamps of the studio.
    assert_eq!(self::scene(&lost).objects.len(), 1 + 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_change_of_bytes_makes_an_import_panic(at in 0_usize..6000, with in any::<[u8; 3]>()) {
        let mut bytes = glb(&model());
        let at = at % (bytes.len() - 3);
        bytes[at..at + 3].copy_from_slice(&with);
        if let Ok(imported) = import_bytes("glb", &bytes, &nothing, "", "m.glb") {
            let _ = imported.parse("m", None);
        }
    }
}

/// What a fuzzer found: libraries that panicked.
#[test]
fn files_that_contradict_themselves_are_refused() {
    let mut short = glb(&model());
    short[8..12].copy_from_slice(&3_u32.to_le_bytes());
    let error = import_bytes("glb", &short, &nothing, "", "m.glb").unwrap_err();
    assert!(error.contains("header"), "{error}");

    let obj = b"mtllib a.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (colour, right) in [("Kd 0.5 0.5", false), ("Ks", false), ("Ka 1 1 1 1", true), ("Kd 0.5 0.25 1", true)] {
        let near = |_: &str| Ok(format!("newmtl red\n{colour}\n").into_bytes());
        let imported = import_bytes("obj", obj, &near, "", "a.obj").unwrap();
        let said: Vec<_> = imported.left_out.iter().map(|l| l.what.as_str()).collect();
        assert_eq!(
            !said.iter().any(|what| what.contains("line 2: a colour has three numbers")),
            right,
            "{colour} {said:?}"
        );
    }
}

/// A cube of side 2 around a point, as OBJ, its faces of the material "paint" but for a square of a share of one face's side, of
/// the material "decal".
fn cube_with_decal(center: [f64; 3], share: f64) -> String {
    let mut text = "mtllib a.mtl\n".to_owned();
    for corner in 0..8 {
        let [x, y, z] = std::array::from_fn(|k| center[k] + if corner >> k & 1 == 0 { -1.0 } else { 1.0 });
        text += &format!("v {x} {y} {z}\n");
    }
    for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        text += &format!("v {} {} {}\n", center[0] + share * a, center[1] + share * b, center[2] + 1.01);
    }
    text + "usemtl paint\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nusemtl decal\nf 9 10 11 12\n"
}

fn glowing_cube(share: f64, glow: f64) -> Imported {
    let mtl = format!("newmtl paint\nKd 0.5 0.5 0.5\nnewmtl decal\nKd 0 0 0\nKe {glow} {glow} {glow}\n");
    let near = move |_: &str| Ok(mtl.clone().into_bytes());
    import_bytes("obj", cube_with_decal([3.0, 5.0, -7.0], share).as_bytes(), &near, "", "cube.obj").unwrap()
}

#[test]
fn a_model_without_light_stands_in_a_studio() {
    // The only light is a decal of 1 % of a face.
    let imported = glowing_cube(0.1, 1.0);
    assert!(imported.added.iter().any(|a| a.contains("grey studio") && a.contains("too weak")), "{:?}", imported.added);
    let scene = scene(&imported);
    let object =
        |name: &str| scene.objects.iter().find(|object| object.name == name).unwrap_or_else(|| panic!("{name}"));
    let Shape::Mesh(backdrop) = &object("backdrop").shape else { panic!("a mesh") };
    // It stands on the floor, and nothing of the backdrop is between the camera and it.
    let floor = backdrop.vertices.iter().map(|v| v[1]).fold(f64::INFINITY, f64::min);
    assert!(floor < 4.0 && floor > 4.0 - 1e-3, "{floor}");
    assert!(scene.camera.position_m[1] > 4.0);
    // The lamps face the model: their normals point to its middle.
    for name in ["key light", "rim light"] {
        let Shape::Parallelogram { origin, u, v } = object(name).shape else { panic!("a parallelogram") };
        let [o, u, v] = [origin, u, v].map(glam::DVec3::from);
        let to_model = glam::DVec3::new(3.0, 5.0, -7.0) - (o + 0.5 * (u + v));
        assert!(u.cross(v).normalize().dot(to_model.normalize()) > 0.999, "{name}");
        assert!(u.length() > 2.0, "a large lamp");
    }
}

#[test]
fn a_model_with_enough_light_of_its_own_gets_no_studio() {
    for (share, glow, studio) in [(0.1, 1.0, true), (0.1, 100.0, false), (1.0, 1.0, false), (1.0, 1e-3, true)] {
        let added = glowing_cube(share, glow).added;
        assert_eq!(added.iter().any(|a| a.contains("studio")), studio, "{share} {glow}: {added:?}");
    }
}

#[test]
fn a_scene_of_another_renderer_gets_no_backdrop() {
    let pbrt = b"LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n";
    let imported = import_bytes("pbrt", pbrt, &nothing, "", "s.pbrt").unwrap();
    assert!(imported.added.iter().any(|a| a.contains("even white sky")), "{:?}", imported.added);
    assert_eq!(scene(&imported).objects.len(), 1);
}

/// A kind that a user may have, and that cannot be read, is no scene with errors: the message says what to do.
#[test]
fn models_of_other_kinds_are_refused_with_the_way_out() {
    for kind in ["fbx", "blend", "usdz", "STL"] {
        let path = std::path::PathBuf::from(format!("model.{kind}"));
        assert!(etalon_import::is_model(&path), "{kind}");
        let why = import_bytes(kind, b"", &nothing, "", "model").unwrap_err();
        assert!(why.contains(kind) && why.contains(".glb"), "{why}");
    }
    assert!(!etalon_import::is_model(std::path::Path::new("scene.json")));
}

#[test]
fn weak_transmission_and_filters_of_mtl_are_listed() {
    let listed = |imported: &Imported, place: &str, what: &str| {
        imported.left_out.iter().any(|l| l.place.contains(place) && l.what.contains(what))
    };
    let weak = |factor: f64| {
        let mut model = model();
        model["materials"] =
            json!([{ "extensions": { "KHR_materials_transmission": { "transmissionFactor": factor } } }]);
        for primitive in model["meshes"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .flat_map(|mesh| mesh["primitives"].as_array_mut().unwrap())
        {
            primitive["material"] = json!(0);
        }
        imported(&model).unwrap()
    };
    assert!(listed(&weak(0.25), "KHR_materials_transmission", "becomes opaque"));
    assert!(
        !listed(&weak(0.0), "KHR_materials_transmission", "opaque")
            && !listed(&weak(1.0), "KHR_materials_transmission", "")
    );

    let filtered = |filter: &str| {
        let mtl = format!("newmtl m\nKd 0.5 0.5 0.5\nTf {filter}\n");
        let near = |name: &str| if name == "m.mtl" { Ok(mtl.clone().into_bytes()) } else { nothing(name) };
        let obj = b"mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        import_bytes("obj", obj, &near, "", "model").unwrap()
    };
    assert!(listed(&filtered("0.5 1 1"), "m", "Tf is ignored"));
    assert!(!listed(&filtered("1 1 1.0"), "m", "Tf"));
}
