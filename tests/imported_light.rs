//! Light of imported materials, against closed forms of glTF and MTL. `cargo xtask compare-formats` does this for every construct.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use crate::support::{etalon_line, pixel_bits};

/// How far a picture may be off, in parts of its mean: a colour is a spectrum that shows it within 3·10⁻⁴, and the noise is below 2·10⁻⁴.
const TOLERANCE: f64 = 1e-3;

/// What glass of index 1.5 reflects head-on.
const HEAD_ON: f64 = 0.04;

/// A material that emits light of luminance 2 and reflects none.
fn glowing() -> Value {
    let mut lamp = bare([0.0; 3]);
    lamp["extensions"]["KHR_materials_emissive_strength"] = json!({ "emissiveStrength": 4 });
    lamp["emissiveFactor"] = json!([0.5, 0.5, 0.5]);
    lamp["doubleSided"] = json!(true);
    lamp
}

/// A material without a coat.
fn bare(colour: [f64; 3]) -> Value {
    let [r, g, b] = colour;
    json!({
        "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1], "metallicFactor": 0 },
        "extensions": { "KHR_materials_specular": { "specularFactor": 0 } },
    })
}

/// Smooth glass that passes light, of a grey base colour.
fn clear(base: f64) -> Value {
    json!({
        "pbrMetallicRoughness": { "baseColorFactor": [base, base, base, 1], "metallicFactor": 0, "roughnessFactor": 0 },
        "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 } },
    })
}

/// Mean red, green and blue of squares at heights z, seen from straight above, where a lamp of π lx shines down.
fn seen(squares: &[(f64, Value)]) -> [f64; 3] {
    let corners: [f32; 12] = [-4.0, -4.0, 0.0, 4.0, -4.0, 0.0, 4.0, 4.0, 0.0, -4.0, 4.0, 0.0];
    let mut bytes: Vec<u8> = corners.iter().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    let primitive = |material: usize| json!({ "attributes": { "POSITION": 0 }, "indices": 1, "material": material });
    let mut nodes = vec![
        json!({ "camera": 0, "translation": [0, 0, 5] }),
        json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }),
    ];
    nodes.extend(squares.iter().enumerate().map(|(i, (z, _))| json!({ "mesh": i, "translation": [0, 0, z] })));
    // The back of a solid faces down.
    if squares.len() == 3 {
        nodes[3]["rotation"] = json!([1, 0, 0, 0]);
    }
    let model = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }], "nodes": nodes,
        "cameras": [{ "type": "orthographic", "orthographic": { "xmag": 0.5, "ymag": 0.5, "znear": 0.01, "zfar": 100 } }],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional", "intensity": PI }] } },
        "meshes": (0..squares.len()).map(|i| json!({ "primitives": [primitive(i)] })).collect::<Vec<_>>(),
        "materials": squares.iter().map(|(_, material)| material.clone()).collect::<Vec<_>>(),
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-4, -4, 0], "max": [4, 4, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 12 }],
        "buffers": [{
            "byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes)),
        }],
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.gltf");
    fs::write(&path, model.to_string()).unwrap();
    means(&path)
}

/// Means of the channels of a render of 8 × 8.
fn means(scene: &Path) -> [f64; 3] {
    let picture = scene.with_extension("exr");
    etalon_line("render {} -o {} --spp 256 --seed 3 --size 8x8", [scene, &picture]).expect(0);
    let channels = pixel_bits(&picture).0;
    ["R", "G", "B"].map(|name| {
        let (_, bits) = channels.iter().find(|(channel, _)| channel == name).expect("a channel");
        bits.iter().map(|bits| f64::from(f32::from_bits(*bits))).sum::<f64>() / bits.len() as f64
    })
}

#[track_caller]
fn near(found: [f64; 3], known: [f64; 3]) {
    let most = known.iter().fold(0.0_f64, |most, v| most.max(*v));
    assert!((0..3).all(|c| (found[c] - known[c]).abs() <= TOLERANCE * most), "{found:?} is not {known:?}");
}

/// The share of diffuse light that a smooth interface reflects, from outside, in closed form (Walsh 1926).
fn diffuse_reflectance(n: f64) -> f64 {
    let n2 = n * n;
    let n4 = n2 * n2;
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

#[test]
fn lux_on_a_bare_base_show_its_colour() {
    near(seen(&[(0.0, bare([0.6, 0.3, 0.1]))]), [0.6, 0.3, 0.1]);
}

#[test]
fn a_coat_on_a_share_of_a_base_takes_what_it_reflects_from_it() {
    let mut half = bare([0.5; 3]);
    half["pbrMetallicRoughness"]["roughnessFactor"] = json!(0);
    half["extensions"]["KHR_materials_specular"]["specularFactor"] = json!(0.3);
    let coated = 0.5 * (1.0 - HEAD_ON).powi(2) / (1.0 - diffuse_reflectance(1.5));
    near(seen(&[(0.0, half)]), [0.7 * 0.5 + 0.3 * coated; 3]);
}

#[test]
fn alpha_lets_the_rest_of_the_light_by() {
    let mut veil = bare([0.5; 3]);
    veil["pbrMetallicRoughness"]["baseColorFactor"][3] = json!(0.25);
    veil["alphaMode"] = json!("BLEND");
    near(seen(&[(0.0, veil), (-2.0, glowing())]), [0.25 * 0.5 + 0.75 * 2.0; 3]);
}

#[test]
fn a_thin_wall_passes_what_its_faces_do_not_reflect_and_a_metal_nothing() {
    let passed = 1.0 - 2.0 * HEAD_ON / (1.0 + HEAD_ON);
    near(seen(&[(0.0, clear(0.6)), (-2.0, glowing())]), [0.6 * passed * 2.0; 3]);
    let mut metal = clear(0.6);
    metal["pbrMetallicRoughness"]["metallicFactor"] = json!(1);
    assert_eq!(seen(&[(0.0, metal), (-2.0, glowing())]), [0.0; 3]);
}

/// Two faces, and on the way between them 0.5 of the light is left after each metre.
#[test]
fn a_solid_absorbs_by_the_way_through_it() {
    let mut glass = clear(1.0);
    glass["extensions"]["KHR_materials_volume"] =
        json!({ "thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [0.5, 0.5, 0.5] });
    let left = 0.5_f64.powf(1.5);
    let passed = (1.0 - HEAD_ON).powi(2) * left / (1.0 - (HEAD_ON * left).powi(2));
    near(seen(&[(0.0, glass.clone()), (-1.5, glass), (-3.0, glowing())]), [passed * 2.0; 3]);
}

#[test]
fn what_dissolves_in_an_obj_file_shows_what_is_behind() {
    let folder = tempfile::tempdir().unwrap();
    let square = |z: i32, i: i32| {
        format!("v -4 -4 {z}\nv 4 -4 {z}\nv 4 4 {z}\nv -4 4 {z}\nf {} {} {} {}\n", i + 1, i + 2, i + 3, i + 4)
    };
    let obj = format!("mtllib model.mtl\nusemtl veil\n{}usemtl glow\n{}", square(0, 0), square(-2, 4));
    fs::write(folder.path().join("model.obj"), obj).unwrap();
    let mtl = "newmtl veil\nKd 0 0 0\nd 0.25\nnewmtl glow\nKd 0 0 0\nKe 2 2 2\n";
    fs::write(folder.path().join("model.mtl"), mtl).unwrap();
    let json = folder.path().join("model.json");
    etalon_line("import {} -o {}", [&folder.path().join("model.obj"), &json]).expect(0);
    let mut scene: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    scene["camera"] = json!({ "type": "orthographic", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "up": [0, 1, 0], "height_m": 1 });
    fs::write(&json, scene.to_string()).unwrap();
    near(means(&json), [0.75 * 2.0; 3]);
}
