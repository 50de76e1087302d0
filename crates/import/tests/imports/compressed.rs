//! Compressed meshes of glTF. The streams are by the reference encoders: Draco 1.5 and meshoptimizer 0.2.

use super::{nothing, scene};
use etalon_import::import_bytes;
use etalon_scene::{Mesh, Shape};
use serde_json::{Value, json};

/// A pyramid of five corners and six triangles, with normals away from its middle and texture coordinates.
const CORNERS: [[f64; 3]; 5] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 2.0], [0.0, 0.0, 2.0], [1.0, 1.5, 1.0]];
const TRIANGLES: [[u32; 3]; 6] = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]];
const UV: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.25]];

/// Positions in 16 bits, normals in 10, texture coordinates in 12; their numbers in the stream are 2, 1 and 0.
const EDGEBREAKER: &str = "RFJBQ08CAgEBAAAABQYCBQAAAm8BAQEQ/wKZQP8CmUAD/wAAAAAAAQAAAQAJAwACAgEDCQIBAAIBAQkDAAEDAQEBABEDmRk3aSYDkAyH//8BgP////8CgP//DAAAAPj/Bw\
    AAAAD//wAAAAAAAAAAAAAAAAAAAAAAQBAFAQEADQOZGSdpJgNMCYf/D4D//3+9gOoAAwAAAKsD7FuAAAAAAP8PAAAAAAAAAAAAAAAAgD8MBgMBAAsDzQwXzQwDaSYDGFCd\
    2ED+EmmTb8OSJf8DAAD/AQAA/wJVQAo=";
/// The same in the order of the corners.
const SEQUENTIAL: &str = "RFJBQ08CAgEAAAAGBQEAAQIAAgMABAEBBAICBAMDBAABAwMJAgEAAQkDAAEACQMAAgIDAgABAQANA2kmzQwjzQwDBfWdpPy/AAIAAAAA/w8AAAADAQALI80MNTMD8t+CaS\
    u99NIA1C69dC2VAv8DAAD/AQAAAAEBABEDaSbNDDPNDAMF9Z0Ihf//AMD+fwAAAAD//wAAAAAAAAAAAAAAAIA/DAoAAAAAAAAAAAAAAAAAAABAEA==";
/// Positions and texture coordinates in vertices of 20 bytes.
const VERTICES: &str = "oAAAAQDAAAD/ATPAAACAf34AAAEAwAAAfwEAwAAAfgAAAQDAAAD/AQxAAACAAAABMwAAAP//ATPAAAB+fX4AAAEMAAAA/wEMQAAAfgAAAAAAAAAAAAAAAAAAAAAAAAAAAA\
    AAAAAAAAAAAAAA";
const AS_TRIANGLES: &str = "4fAAQAIRFAB2h1ZneKmGZYlomAFpAAA=";
const AS_INDICES: &str = "0QAEBAYIBAoQCgAMBgAIAgAEDgAAAAA=";
/// Octahedral normals along +x, +y, +z, −x and −y.
const NORMALS: &str = "oAEzwAAA/f3+ATzAAAD+/f0AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAB/AH8A";

fn length(base64: &str) -> usize {
    3 * base64.len() / 4 - base64.bytes().rev().take_while(|byte| *byte == b'=').count()
}

fn buffer(base64: &str) -> Value {
    json!({ "uri": format!("data:application/octet-stream;base64,{base64}"), "byteLength": length(base64) })
}

fn model(meshes: Value, accessors: Value, views: Value, buffers: Value, extension: &str) -> Value {
    json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "extensionsUsed": [extension], "extensionsRequired": [extension],
        "meshes": meshes, "accessors": accessors, "bufferViews": views, "buffers": buffers,
    })
}

fn draco(stream: &str, [position, normal, uv]: [u32; 3]) -> Value {
    let numbers = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv });
    let compressed = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": numbers } });
    let attributes = json!({ "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 });
    let accessor = |kind: &str, count: usize| json!({ "componentType": 5126, "count": count, "type": kind });
    model(
        json!([{ "primitives": [{ "attributes": attributes, "indices": 3, "extensions": compressed }] }]),
        json!([
            { "componentType": 5126, "count": 5, "type": "VEC3", "min": [0, 0, 0], "max": [2, 1.5, 2] },
            accessor("VEC3", 5),
            accessor("VEC2", 5),
            { "componentType": 5123, "count": 18, "type": "SCALAR" },
        ]),
        json!([{ "buffer": 0, "byteLength": length(stream) }]),
        json!([buffer(stream)]),
        "KHR_draco_mesh_compression",
    )
}

/// Views of a buffer without bytes stand for what other buffers have in compressed form.
fn meshopt(extension: &str, indices: (&str, &str)) -> Value {
    let view = |buffer: u32, data: &str, stride: u32, count: u32, mode: &str, filter: &str| {
        let compressed = json!({ extension: { "buffer": buffer, "byteLength": length(data), "byteStride": stride, "count": count, "mode": mode, "filter": filter } });
        let mut view = json!({ "buffer": 0, "byteLength": stride * count, "extensions": compressed });
        if mode == "ATTRIBUTES" {
            view["byteStride"] = json!(stride);
        }
        view
    };
    let attributes = json!({ "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 });
    model(
        json!([{ "primitives": [{ "attributes": attributes, "indices": 3 }] }]),
        json!([
            { "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3", "min": [0, 0, 0], "max": [2, 1.5, 2] },
            { "bufferView": 1, "componentType": 5120, "normalized": true, "count": 5, "type": "VEC3" },
            { "bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 5, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5125, "count": 18, "type": "SCALAR" },
        ]),
        json!([
            view(1, VERTICES, 20, 5, "ATTRIBUTES", "NONE"),
            view(2, NORMALS, 4, 5, "ATTRIBUTES", "OCTAHEDRAL"),
            view(3, indices.1, 4, 18, indices.0, "NONE"),
        ]),
        json!([
            { "byteLength": 1_000_000_000_000_u64, "extensions": { extension: { "fallback": true } } },
            buffer(VERTICES),
            buffer(NORMALS),
            buffer(indices.1),
        ]),
        extension,
    )
}

fn mesh_of(model: &Value) -> Mesh {
    part_of(model, 0)
}

fn part_of(model: &Value, part: usize) -> Mesh {
    let imported = import_bytes("gltf", model.to_string().as_bytes(), &nothing, "", "m.gltf").unwrap();
    assert!(imported.left_out.is_empty(), "{:?}", imported.left_out);
    let Shape::Mesh(mesh) = &scene(&imported).objects[part].shape else { panic!("a mesh") };
    (**mesh).clone()
}

fn failure(model: &Value) -> String {
    let failed = import_bytes("gltf", model.to_string().as_bytes(), &nothing, "", "m.gltf");
    failed.map(|_| ()).unwrap_err().to_string()
}

/// Corner for corner the triangles are those of the pyramid, in any order of corners and triangles.
fn is_the_pyramid(mesh: &Mesh, rounding: f64) {
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= rounding);
    let corner = |index: u32| {
        let found = mesh.vertices[index as usize];
        let known = CORNERS.iter().position(|corner| near(corner, &found)).unwrap_or_else(|| panic!("{found:?}"));
        // v grows downward in glTF, upward here.
        let [u, v] = mesh.uvs[index as usize].map(f64::from);
        let uv = [u, 1.0 - v];
        assert!(near(&uv, &UV[known]), "{uv:?} is not {:?}", UV[known]);
        known as u32
    };
    let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap();
    let mut found: Vec<_> = mesh.triangles.iter().map(|triangle| turned(triangle.map(corner))).collect();
    let mut known: Vec<_> = TRIANGLES.map(turned).into();
    found.sort_unstable();
    known.sort_unstable();
    assert_eq!(found, known);
}

#[test]
fn meshes_compressed_by_draco_are_read() {
    for stream in [EDGEBREAKER, SEQUENTIAL] {
        let mesh = mesh_of(&draco(stream, [2, 1, 0]));
        // Half a step of 2⁻¹⁶ of the extent for positions, of 2⁻¹² for texture coordinates.
        is_the_pyramid(&mesh, 2.0_f64.powi(-12));
        for (corner, normal) in mesh.vertices.iter().zip(&mesh.normals) {
            let out: Vec<f64> = [1.0, 0.5, 1.0].iter().zip(corner).map(|(middle, at)| at - middle).collect();
            assert!(out.iter().zip(normal).map(|(a, b)| a * f64::from(*b)).sum::<f64>() > 0.9, "{corner:?} {normal:?}");
        }
    }
}

#[test]
fn buffers_compressed_by_meshoptimizer_are_read() {
    for extension in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        for indices in [("TRIANGLES", AS_TRIANGLES), ("INDICES", AS_INDICES)] {
            let mesh = mesh_of(&meshopt(extension, indices));
            is_the_pyramid(&mesh, 0.0);
            let along = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
            for (index, normal) in along.iter().enumerate() {
                let found = mesh.normals[index].map(f64::from);
                assert!(found.iter().zip(normal).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} is not {normal:?}");
            }
        }
    }
}

/// The streams have their corners in different orders.
#[test]
fn primitives_with_streams_of_their_own_may_name_the_same_accessors() {
    let mut model = draco(EDGEBREAKER, [2, 1, 0]);
    let mut second = model["meshes"][0]["primitives"][0].clone();
    second["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = json!(1);
    for (list, more) in
        [("bufferViews", json!({ "buffer": 1, "byteLength": length(SEQUENTIAL) })), ("buffers", buffer(SEQUENTIAL))]
    {
        model[list].as_array_mut().unwrap().push(more);
    }
    model["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    for part in [0, 1] {
        is_the_pyramid(&part_of(&model, part), 2.0_f64.powi(-12));
    }
}

/// The attribute 2 has three components, the attribute 0 has two.
#[test]
fn streams_whose_attributes_have_other_components_are_refused() {
    let said = failure(&draco(EDGEBREAKER, [0, 1, 2]));
    let expected = "$.meshes[0].primitives[0]: its POSITION has 3 components, but 2 in its compressed data";
    assert!(said.contains(expected), "{said}");
}

/// The file that a fallback buffer names is not needed.
#[test]
fn only_buffers_that_say_so_are_fallbacks() {
    let name = "EXT_meshopt_compression";
    let mut model = meshopt(name, ("TRIANGLES", AS_TRIANGLES));
    model["buffers"][0]["uri"] = json!("gone.bin");
    is_the_pyramid(&mesh_of(&model), 0.0);
    model["buffers"][0]["extensions"][name]["fallback"] = json!(false);
    let said = failure(&model);
    assert!(said.contains("$.buffers[0]: \"gone.bin\" cannot be read"), "{said}");
}

#[test]
fn only_the_first_buffer_may_be_the_binary_part() {
    let mut model = meshopt("EXT_meshopt_compression", ("TRIANGLES", AS_TRIANGLES));
    model["buffers"][1].as_object_mut().unwrap().remove("uri");
    let said = failure(&model);
    assert!(said.contains("$.buffers[1]: only the first buffer may be the binary part"), "{said}");
}

/// Accessors without data are zeros, as joints of a mesh may be whose other attributes are compressed.
#[test]
fn accessors_without_data_are_zeros() {
    let mut model = draco(EDGEBREAKER, [2, 1, 0]);
    model["accessors"].as_array_mut().unwrap().push(json!({ "componentType": 5126, "count": 5, "type": "VEC2" }));
    model["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(4);
    let numbers = &mut model["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"];
    numbers.as_object_mut().unwrap().remove("TEXCOORD_0");
    assert_eq!(mesh_of(&model).uvs, [[0.0, 1.0]; 5]);
    model["accessors"][4]["count"] = json!(1_u64 << 40);
    let said = failure(&model);
    assert!(said.contains("$.accessors[4]: it has more than 2^24 elements without data"), "{said}");
}

#[test]
fn damaged_streams_are_named_and_end() {
    let damaged = EDGEBREAKER.replace("AAAABQYC", "AAAA/////w");
    let said = failure(&draco(&damaged[..EDGEBREAKER.len() - 8], [2, 1, 0]));
    assert!(said.contains("$.meshes[0].primitives[0]: its compressed data are damaged"), "{said}");
    let said = failure(&draco(EDGEBREAKER, [7, 1, 0]));
    assert!(said.contains("its compressed data have no attribute 7"), "{said}");
    let mut huge = meshopt("EXT_meshopt_compression", ("TRIANGLES", AS_TRIANGLES));
    huge["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = json!(4_000_000_000_u64);
    let said = failure(&huge);
    assert!(said.contains("$.bufferViews[0]: the compressed parts of the file would take more than 1 GiB"), "{said}");
    let mut cut = meshopt("EXT_meshopt_compression", ("TRIANGLES", AS_TRIANGLES));
    cut["bufferViews"][2]["extensions"]["EXT_meshopt_compression"]["byteLength"] = json!(9);
    let said = failure(&cut);
    assert!(said.contains("$.bufferViews[2]: its compressed data are damaged"), "{said}");
    let mut unknown = meshopt("EXT_meshopt_compression", ("TRIANGLES", AS_TRIANGLES));
    unknown["bufferViews"][1]["extensions"]["EXT_meshopt_compression"]["filter"] = json!("SPHERICAL");
    let said = failure(&unknown);
    assert!(said.contains("its compression has the filter \"SPHERICAL\", which is not known"), "{said}");
}
