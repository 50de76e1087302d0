//! Files of every kind: packed, beside each other, damaged, of programs that are not read.

use super::{BUFFER, glb, imported, model, nothing, scene};
use etalon_import::import_bytes;
use etalon_scene::Shape;
use serde_json::{Value, json};

/// A model may require whole numbers as positions, with a stride of whole words.
#[test]
fn quantised_meshes_arrive() {
    use base64::Engine as _;
    let corners: [[i16; 4]; 4] = [[-100, 0, 0, 7], [100, 0, 0, 7], [100, 50, 0, 7], [-100, 50, 0, 7]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let mut model = model();
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let uri = format!("data:application/octet-stream;base64,{data}");
    model["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": bytes.len(), "uri": uri }));
    model["bufferViews"][0] = json!({ "buffer": 1, "byteLength": 32, "byteStride": 8 });
    model["accessors"][0] = json!({ "bufferView": 0, "componentType": 5122, "count": 4, "type": "VEC3", "min": [-100, 0, 0], "max": [100, 50, 0] });
    model["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    model["extensionsUsed"].as_array_mut().unwrap().push(json!("KHR_mesh_quantization"));
    let scene = scene(&imported(&model).unwrap());
    let vertices = scene.placed_objects().filter_map(|object| match &object.shape {
        Shape::Mesh(mesh) => Some(mesh.vertices[2]),
        _ => None,
    });
    assert!(vertices.into_iter().any(|v| v == [100.0, 50.0, 0.0]));
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
        assert_eq!(!said.iter().any(|what| what.contains("is no colour")), right, "{colour} {said:?}");
    }
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
