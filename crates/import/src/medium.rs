//! Parts of media that scenes of several programs have.

use serde_json::{Value, json};

/// Puts the grid of a .vol file into the box from (0, 0, 0) to (1, 1, 1).
///
/// # Errors
/// If the file is too short to have a box.
pub(crate) fn in_unit_box(vol: &mut [u8]) -> Result<(), String> {
    let corners = vol.get_mut(24..48).ok_or("it is no .vol file")?;
    for (number, bytes) in [0.0, 0.0, 0.0, 1.0, 1.0, 1.0_f32].iter().zip(corners.chunks_exact_mut(4)) {
        bytes.copy_from_slice(&number.to_le_bytes());
    }
    Ok(())
}

/// The means of the channels of a .vol file: one, or three of a colour.
///
/// # Errors
/// If the file holds no numbers, or others than floats in one or three channels.
pub(crate) fn means(vol: &[u8]) -> Result<Vec<f64>, String> {
    let word = |at: usize| vol.get(at..at + 4).map(|bytes| u32::from_le_bytes(bytes.try_into().expect("four bytes")));
    let (Some(1), Some(channels @ (1 | 3))) = (word(4), word(20)) else {
        return Err("it is no .vol file of floats in one channel or three".into());
    };
    let channels = channels as usize;
    let values: Vec<f64> = floats(vol).collect();
    if values.is_empty() || !values.len().is_multiple_of(channels) {
        return Err("it ends in the middle of its values".into());
    }
    let cells = (values.len() / channels) as f64;
    Ok((0..channels).map(|channel| values.iter().skip(channel).step_by(channels).sum::<f64>() / cells).collect())
}

/// Makes a .vol file of colours one of numbers: the mean of the three channels of each cell.
pub(crate) fn without_colour(vol: &mut Vec<u8>) {
    let values: Vec<f64> = floats(vol).collect();
    vol.truncate(HEADER);
    vol[20..24].copy_from_slice(&1_u32.to_le_bytes());
    vol.extend(values.chunks_exact(3).flat_map(|rgb| ((rgb.iter().sum::<f64>() / 3.0) as f32).to_le_bytes()));
}

/// Brings the values of a .vol file down to 1. Whether there were any above it.
pub(crate) fn shares(vol: &mut [u8]) -> bool {
    let mut above = false;
    for bytes in vol.get_mut(HEADER..).unwrap_or(&mut []).chunks_exact_mut(4) {
        if f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) > 1.0 {
            bytes.copy_from_slice(&1.0_f32.to_le_bytes());
            above = true;
        }
    }
    above
}

/// Bytes of a .vol file before its values.
const HEADER: usize = 48;

fn floats(vol: &[u8]) -> impl Iterator<Item = f64> {
    let values = vol.get(HEADER..).unwrap_or(&[]);
    values.chunks_exact(4).map(|bytes| f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes"))))
}

/// A .vol file of numbers, `channels` of them for each cell, x running first.
pub(crate) fn vol(cells: [u32; 3], channels: u32, box_m: [[f64; 3]; 2], values: &[f64]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for word in [1, cells[0], cells[1], cells[2], channels] {
        bytes.extend(word.to_le_bytes());
    }
    for number in box_m.as_flattened().iter().chain(values) {
        bytes.extend((*number as f32).to_le_bytes());
    }
    bytes
}

/// Two phase functions, the second with this share, if the format has their blend.
pub(crate) fn blended(first: &Value, second: &Value, weight: f64) -> Option<Value> {
    let g = |phase: &Value| match phase["type"].as_str()? {
        "isotropic" => Some(0.0),
        "henyey-greenstein" => phase["g"].as_f64(),
        _ => None,
    };
    let (first, second) = (g(first)?, g(second)?);
    Some(json!({ "type": "double-henyey-greenstein", "g": [first, second], "weight": 1.0 - weight }))
}

/// Fills the interior of a body with a medium: that of glass, of the boundary of the medium, or of a filled body of another material. A body
/// that lets no light in stays as it is, and the answer is false. `has_holes` says whether an image is its opacity.
pub(crate) fn fill(material: &mut Value, opacity: &mut f64, has_holes: bool, medium: &Value) -> bool {
    let lets_by = *opacity < 1.0 || has_holes;
    if material["type"] == "black" && *opacity == 0.0 {
        *material = json!({ "type": "boundary", "medium": medium });
        *opacity = 1.0;
    } else if material["type"] == "dielectric" {
        if let Some(keys) = material.as_object_mut() {
            keys.remove("absorption_per_m");
            keys.insert("medium".to_owned(), medium.clone());
        }
    } else if lets_by || has_inside(material) {
        *material = json!({ "type": "filled", "material": material.take(), "medium": medium });
    } else {
        return false;
    }
    true
}

/// Exchanges what fills the two sides of a dielectric, if it states that; `around` is what surrounds the scene.
pub(crate) fn exchange_sides(material: &mut Value, around: Option<&Value>) {
    let Some(keys) = material.as_object_mut() else { return };
    let absorption = keys.remove("absorption_per_m").map(|per_m| json!({ "absorption_per_m": per_m }));
    let inside = keys.remove("medium").or(absorption);
    let outside = keys.remove("exterior_medium");
    if inside.is_none() && outside.is_none() {
        return;
    }
    // An interior without a medium is clear; an exterior without one holds what is around.
    if let Some(medium) = outside.or_else(|| around.cloned()) {
        keys.insert("medium".to_owned(), medium);
    }
    keys.insert("exterior_medium".to_owned(), inside.unwrap_or_else(|| json!({ "absorption_per_m": 0 })));
}

/// Whether a path may be behind the surface of a material: it lets light in, or it scatters light there.
fn has_inside(material: &Value) -> bool {
    match material["type"].as_str() {
        Some("blend") => has_inside(&material["first"]) || has_inside(&material["second"]),
        Some("black") => false,
        Some("lambert" | "mirror" | "conductor" | "plastic" | "principled" | "measured" | "oren-nayar") => {
            material["sides"] != "front"
        }
        _ => true,
    }
}
