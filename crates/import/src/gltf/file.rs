//! Files of glTF: what the library takes for granted, and the bytes that they name.

use base64::Engine as _;
use gltf::{Gltf, buffer};
use serde_json::Value;

use crate::Builder;

/// Bytes of the header of a binary file.
const GLB_HEADER: u32 = 12;

/// Extensions that a file may require although the library does not know them.
const HONOURED: [&str; 8] = [
    "KHR_mesh_quantization",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_variants",
];

/// Extensions that compress meshes, and what a user may do.
const COMPRESSED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// The file, checked by the library.
pub(super) fn parse(bytes: &[u8]) -> Result<Gltf, String> {
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(|error| error.to_string())?;
    let mut root = document.into_json();
    if let Some(name) = root.extensions_required.iter().find(|name| COMPRESSED.contains(&name.as_str())) {
        return Err(format!(
            "$.extensionsRequired: its meshes are compressed by {name}, which cannot be read; write the model without compression, for \
             example with gltf-transform"
        ));
    }
    root.extensions_required.retain(|name| !HONOURED.contains(&name.as_str()));
    let document = gltf::Document::from_json(root).map_err(|error| error.to_string())?;
    Ok(Gltf { document, blob })
}

/// What morph targets say that is made use of; tangents follow from what is moved.
const MOVED: [&str; 3] = ["POSITION", "NORMAL", "TANGENT"];

/// Refuses primitives that name accessors which are not there: the library's own check looks them up before it counts. Lists what else morph
/// targets say, which the library does not read.
pub(super) fn check_primitives(bytes: &[u8], builder: &mut Builder<'_>) -> Result<(), String> {
    let glb;
    let text = if bytes.starts_with(b"glTF") {
        // The library subtracts the header's own length before it compares.
        if let Some(&[a, b, c, d]) = bytes.get(8..12)
            && u32::from_le_bytes([a, b, c, d]) < GLB_HEADER
        {
            return Err(format!("its header has {GLB_HEADER} bytes, but states a smaller length for the whole file"));
        }
        glb = gltf::Glb::from_slice(bytes).map_err(|error| error.to_string())?;
        &*glb.json
    } else {
        bytes
    };
    let root: Value = serde_json::from_slice(text).map_err(|error| error.to_string())?;
    let list = |value: &'_ Value| value.as_array().cloned().unwrap_or_default();
    let count = root["accessors"].as_array().map_or(0, Vec::len) as u64;
    for (i, mesh) in root["meshes"].as_array().into_iter().flatten().enumerate() {
        for (j, primitive) in mesh["primitives"].as_array().into_iter().flatten().enumerate() {
            for (k, target) in primitive["targets"].as_array().into_iter().flatten().enumerate() {
                for key in target.as_object().into_iter().flat_map(|map| map.keys()) {
                    if !MOVED.contains(&key.as_str()) {
                        let place = format!("$.meshes[{i}].primitives[{j}].targets[{k}].{key}");
                        builder.leave_out(place, "it is ignored: morph targets move positions and normals");
                    }
                }
            }
            let mut named: Vec<Value> = vec![primitive["indices"].clone()];
            for attributes in list(&primitive["targets"]).iter().chain([&primitive["attributes"]]) {
                named.extend(attributes.as_object().into_iter().flat_map(|map| map.values().cloned()));
            }
            if let Some(missing) = named.iter().filter_map(Value::as_u64).find(|index| *index >= count) {
                let place = format!("$.meshes[{i}].primitives[{j}]");
                return Err(format!("{place}: it names accessor {missing}; there are {count}"));
            }
        }
    }
    Ok(())
}

/// Refuses images that the library takes for granted: each is a file, or a part of a buffer of a stated type.
pub(super) fn check_images(file: &Gltf) -> Result<(), String> {
    for (i, image) in file.as_json().images.iter().enumerate() {
        let whole = if image.buffer_view.is_some() { image.mime_type.is_some() } else { image.uri.is_some() };
        if !whole {
            return Err(format!("$.images[{i}]: it has neither a uri nor a bufferView with a mimeType"));
        }
    }
    Ok(())
}

/// Refuses nodes that name a light of a list that is not there.
pub(super) fn check_lights(file: &Gltf) -> Result<(), String> {
    let count = file.lights().map_or(0, Iterator::count);
    for (i, node) in file.as_json().nodes.iter().enumerate() {
        let lamp = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if lamp.is_some_and(|lamp| lamp.light.value() >= count) {
            return Err(format!("$.nodes[{i}]: it names a light that does not exist; there are {count}"));
        }
    }
    Ok(())
}

/// The bytes of every buffer.
pub(super) fn buffers(file: &Gltf, builder: &Builder<'_>) -> Result<Vec<Vec<u8>>, String> {
    file.buffers()
        .map(|buffer| {
            let place = format!("$.buffers[{}]", buffer.index());
            let bytes = match buffer.source() {
                buffer::Source::Bin => file.blob.clone().ok_or_else(|| format!("{place}: there is no binary part")),
                buffer::Source::Uri(uri) => resource(uri, builder).map_err(|why| format!("{place}: {why}")),
            }?;
            match bytes.len() < buffer.length() {
                true => Err(format!("{place}: it has {} bytes, and should have {}", bytes.len(), buffer.length())),
                false => Ok(bytes),
            }
        })
        .collect()
}

/// The bytes that a URI stands for: data in itself, or a file beside the model.
pub(super) fn resource(uri: &str, builder: &Builder<'_>) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, base64) = data.split_once(";base64,").ok_or("its data are not in base 64")?;
        return base64::engine::general_purpose::STANDARD.decode(base64).map_err(|error| error.to_string());
    }
    if uri.contains("://") {
        return Err(format!("\"{uri}\" is not a file"));
    }
    let name = percent_decoded(uri).ok_or_else(|| format!("\"{uri}\" is not a file name"))?;
    (builder.near)(&name).map_err(|why| format!("\"{name}\" cannot be read: {why}"))
}

/// A URI's path with its %XX as bytes.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        if *first == b'%' {
            let digits = std::str::from_utf8(tail.get(..2)?).ok()?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &tail[2..];
        } else {
            bytes.push(*first);
            rest = tail;
        }
    }
    String::from_utf8(bytes).ok()
}
