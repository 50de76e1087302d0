//! Views of buffers that are compressed as the library meshoptimizer does, with what is done to their numbers before.

use gltf::json::validation::USize64;
use meshoptimizer_rs::codec::{
    decode_filter_color, decode_filter_exp, decode_filter_oct, decode_filter_quat, decode_index_buffer,
    decode_index_sequence, decode_vertex_buffer,
};
use meshoptimizer_rs::{Error, Limits, Workspace};
use serde_json::{Map, Value};

use super::{Decoded, MOST_BYTES, part, whole_number};

/// The extension, and the later one of the same form.
pub(super) const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Gives every compressed view a buffer of its own.
pub(super) fn undo(out: &mut Decoded<'_>) -> Result<(), String> {
    for index in 0..out.root.buffer_views.len() {
        let extensions = out.root.buffer_views[index].extensions.as_mut();
        let Some(extension) = extensions.and_then(|e| NAMES.iter().find_map(|name| e.others.remove(*name))) else {
            continue;
        };
        let place = format!("$.bufferViews[{index}]");
        let bytes = decoded(&extension, out).map_err(|why| format!("{place}: {why}"))?;
        if (bytes.len() as u64) < out.root.buffer_views[index].byte_length.0 {
            return Err(format!("{place}: its compressed data have {} bytes", bytes.len()));
        }
        let buffer = out.add_buffer(bytes);
        let view = &mut out.root.buffer_views[index];
        (view.buffer, view.byte_offset) = (buffer, Some(USize64(0)));
    }
    Ok(())
}

fn decoded(extension: &Value, out: &Decoded<'_>) -> Result<Vec<u8>, String> {
    let extension = extension.as_object().ok_or("its compression is not an object")?;
    let number = |key| whole_number(extension, key).ok_or_else(|| format!("its compression lacks a number \"{key}\""));
    let [buffer, length, stride, count] =
        [number("buffer")?, number("byteLength")?, number("byteStride")?, number("count")?];
    out.may_become(count.checked_mul(stride))?;
    let source = part(out.buffers, buffer, whole_number(extension, "byteOffset").unwrap_or(0), length)?;
    let text = |key, default| extension_text(extension, key, default);
    let (mode, filter) = (text("mode", "")?, text("filter", "NONE")?);
    let mut workspace = Workspace::new(Limits { max_bytes: MOST_BYTES, ..Limits::default() });
    let wrong = |error: Error| format!("its compressed data are damaged: {error}");
    let mut bytes = match mode {
        "ATTRIBUTES" => decode_vertex_buffer(count, stride, source, &mut workspace),
        "TRIANGLES" => decode_index_buffer(count, stride, source, &mut workspace),
        "INDICES" => decode_index_sequence(count, stride, source, &mut workspace),
        _ => return Err(format!("its compression has the mode \"{mode}\", which is not known")),
    }
    .map_err(wrong)?;
    let apply = match filter {
        "NONE" => return Ok(bytes),
        "OCTAHEDRAL" => decode_filter_oct,
        "QUATERNION" => decode_filter_quat,
        "EXPONENTIAL" => decode_filter_exp,
        "COLOR" => decode_filter_color,
        _ => return Err(format!("its compression has the filter \"{filter}\", which is not known")),
    };
    apply(&mut bytes, count, stride, &mut workspace).map_err(wrong)?;
    Ok(bytes)
}

fn extension_text<'a>(extension: &'a Map<String, Value>, key: &str, default: &'a str) -> Result<&'a str, String> {
    match extension.get(key) {
        None => Ok(default),
        Some(text) => text.as_str().ok_or_else(|| format!("\"{key}\" of its compression is not a string")),
    }
}
