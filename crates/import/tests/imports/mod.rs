//! Models of other programs: what they say arrives in the scene, what cannot be honoured is listed with its place.

mod coats;
mod compressed;
mod extensions;
mod files;
mod materials;
mod meshes;
mod morphs;
mod obj_files;
mod shapes;
mod sheens;
mod skins;
mod speculars;
mod studio;
mod transmissions;
mod variants;
mod volumes;

use etalon_import::{Imported, import_bytes};
use etalon_scene::{
    Light, LightKind, MaterialKind, Metal, NumberTexture, Projection, Scene, Shape, SpectrumTexture, TextureFilter,
    UvMap, Wrap,
};
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
const PNG: &[u8] = include_bytes!("../../../scene/tests/files/chequers.png");

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
            { "name": "glass", "pbrMetallicRoughness": { "roughnessFactor": 0, "metallicFactor": 0 }, "extensions": {
                "KHR_materials_volume": { "thicknessFactor": 1 },
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
    glb_of(model, BUFFER.clone())
}

/// A model and its buffer as a GLB file.
fn glb_of(model: &Value, mut binary: Vec<u8>) -> Vec<u8> {
    let mut text = model.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
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
    // That backs are seen: no camera, no light.
    assert!(imported.added.len() == 1 && imported.added[0].contains("doubleSided"), "{:?}", imported.added);
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
    // v = 0.25 here is 0.75 from the top: 4·0.75 + 0.5 = 3.5 from the top, so −2.5 here.
    let from_below = 1.0 - 3.5 - 4.0 * 0.25;
    assert_eq!(image.factor, [0.5, 1.0, 0.25]);
    assert_eq!(image.uv_map, UvMap::scaled([2.0, 4.0], [0.25, from_below]));
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
    model["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 0, 0, 1]);
    model["materials"][2]["extensions"]["KHR_materials_sheen"] = json!({ "sheenColorFactor": [1, 1, 1] });
    let imported = imported(&model).unwrap();
    let places: Vec<&str> = imported.left_out.iter().map(|l| l.place.as_str()).collect();
    for expected in [
        "$.animations[0]",
        "$.materials[2].extensions.KHR_materials_sheen",
        "$.extensions.KHR_lights_punctual.lights[2]",
        "$.meshes[0].primitives[3]",
    ] {
        assert!(places.contains(&expected), "{expected} is not among {places:#?}");
    }
    // Glass passes its base colour.
    let scene = scene(&imported);
    let red = scene.materials.iter().find_map(|material| match &material.kind {
        MaterialKind::Tinted { transmitted: SpectrumTexture::Uniform(tint), .. } => Some(tint.clone()),
        _ => None,
    });
    assert!(red.is_some_and(|tint| tint.eval(650.0) > 0.9 && tint.eval(500.0) < 0.1));
    // The scene to edit says so too.
    assert!(imported.text.contains("left out: $.materials[2].extensions.KHR_materials_sheen"));
}
