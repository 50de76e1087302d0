//! Files of glTF: what the library takes for granted, and the bytes that they name.

use base64::Engine as _;
use gltf::json::Root;
use gltf::json::buffer::Buffer;
use gltf::{Document, Gltf};
use serde_json::Value;

use super::{compression, extensions};
use crate::Builder;

/// Bytes of the header of a binary file.
const GLB_HEADER: u32 = 12;
/// The most bytes of all buffers of a model: many may name the same file.
const MOST_IN_BUFFERS: u64 = 1 << 32;

/// The file with all that is compressed written out, checked by the library; and the bytes of every buffer.
pub(super) fn parse(bytes: &[u8], builder: &Builder<'_>) -> Result<(Document, Vec<Vec<u8>>), String> {
    let bytes = extensions::without_pointers(bytes)?;
    let Gltf { document, blob } = Gltf::from_slice_without_validation(&bytes).map_err(|error| error.to_string())?;
    let mut root = document.into_json();
    let mut buffers = buffers(&root, blob, builder)?;
    compression::undo(&mut root, &mut buffers)?;
    // They were looked at before.
    root.extensions_required.clear();
    let document = Document::from_json(root).map_err(|error| error.to_string())?;
    Ok((document, buffers))
}

/// What a file says, before the library reads it.
pub(super) fn json(bytes: &[u8]) -> Result<Value, String> {
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
    serde_json::from_slice(text).map_err(|error| error.to_string())
}

/// What morph targets say that is made use of; tangents follow from what is moved.
const MOVED: [&str; 3] = ["POSITION", "NORMAL", "TANGENT"];

/// Refuses primitives that name accessors which are not there: the library looks them up before it counts.
/// Lists what else morph targets say, which the library does not read.
pub(super) fn check_primitives(root: &Value, builder: &mut Builder<'_>) -> Result<(), String> {
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
pub(super) fn check_images(file: &Document) -> Result<(), String> {
    for (i, image) in file.as_json().images.iter().enumerate() {
        let whole = if image.buffer_view.is_some() { image.mime_type.is_some() } else { image.uri.is_some() };
        if !whole {
            return Err(format!("$.images[{i}]: it has neither a uri nor a bufferView with a mimeType"));
        }
    }
    Ok(())
}

/// Refuses nodes that name a light of a list that is not there.
pub(super) fn check_lights(file: &Document) -> Result<(), String> {
    let count = file.lights().map_or(0, Iterator::count);
    for (i, node) in file.as_json().nodes.iter().enumerate() {
        let lamp = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if lamp.is_some_and(|lamp| lamp.light.value() >= count) {
            return Err(format!("$.nodes[{i}]: it names a light that does not exist; there are {count}"));
        }
    }
    Ok(())
}

/// The bytes of every buffer; those of the binary part are `blob`.
fn buffers(root: &Root, mut blob: Option<Vec<u8>>, builder: &Builder<'_>) -> Result<Vec<Vec<u8>>, String> {
    let mut buffers = Vec::with_capacity(root.buffers.len());
    let mut total = 0;
    for (index, buffer) in root.buffers.iter().enumerate() {
        let bytes = buffer_bytes(index, buffer, &mut blob, builder);
        let bytes = bytes.map_err(|why| format!("$.buffers[{index}]: {why}"))?;
        total += bytes.len() as u64;
        if total > MOST_IN_BUFFERS {
            return Err(format!("$.buffers[{index}]: up to here the buffers have more than 4 GiB"));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn buffer_bytes(
    index: usize,
    buffer: &Buffer,
    blob: &mut Option<Vec<u8>>,
    builder: &Builder<'_>,
) -> Result<Vec<u8>, String> {
    if compression::is_placeholder(buffer) {
        return Ok(Vec::new());
    }
    let bytes = match &buffer.uri {
        None if index == 0 => blob.take().ok_or("there is no binary part")?,
        None => return Err("only the first buffer may be the binary part".to_owned()),
        Some(uri) => resource(uri, builder)?,
    };
    match (bytes.len() as u64) < buffer.byte_length.0 {
        true => Err(format!("it has {} bytes, and should have {}", bytes.len(), buffer.byte_length.0)),
        false => Ok(bytes),
    }
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
