//! The attributes at the head of an EXR file: their names, their values, their order.

use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes, standard_names as names};

use crate::{Attribute, Attributes, Chromaticities, PictureError};

/// Attributes that say how the pixels are stored, which a [`crate::Picture`] knows by itself.
const STRUCTURAL: [&[u8]; 15] = [
    names::TILES,
    names::NAME,
    names::BLOCK_TYPE,
    names::DEEP_DATA_VERSION,
    names::CHUNKS,
    names::MAX_SAMPLES,
    names::CHANNELS,
    names::COMPRESSION,
    names::DATA_WINDOW,
    names::DISPLAY_WINDOW,
    names::LINE_ORDER,
    names::PIXEL_ASPECT,
    names::WINDOW_CENTER,
    names::WINDOW_WIDTH,
    names::DWA_COMPRESSION_LEVEL,
];

/// Files the attributes in the crate's structures, the standard ones in the fields that are kept for them.
pub(crate) fn insert(
    attributes: &Attributes,
    image: &mut ImageAttributes,
    layer: &mut LayerAttributes,
) -> Result<(), PictureError> {
    for (name, value) in attributes {
        let bad = |why| PictureError::BadAttribute { name: name.clone(), why };
        if name.is_empty() || name.len() > 255 || name.contains('\0') {
            return Err(bad("must have a name of 1 to 255 bytes without NUL"));
        }
        let value = to_exr(value).ok_or_else(|| bad("has a value that EXR cannot hold"))?;
        use AttributeValue as Value;
        match (name.as_str(), value) {
            ("chromaticities", Value::Chromaticities(value)) => image.chromaticities = Some(value),
            ("software", Value::Text(value)) => layer.software_name = Some(value),
            ("owner", Value::Text(value)) => layer.owner = Some(value),
            ("comments", Value::Text(value)) => layer.comments = Some(value),
            ("capDate", Value::Text(value)) => layer.capture_date = Some(value),
            ("view", Value::Text(value)) => layer.view_name = Some(value),
            ("whiteLuminance", Value::F32(value)) => layer.white_luminance = Some(value),
            ("adoptedNeutral", Value::FloatVec2(value)) => layer.adopted_neutral = Some(value),
            ("focus", Value::F32(value)) => layer.focus = Some(value),
            ("expTime", Value::F32(value)) => layer.exposure = Some(value),
            ("aperture", Value::F32(value)) => layer.aperture = Some(value),
            ("isoSpeed", Value::F32(value)) => layer.iso_speed = Some(value),
            ("near", Value::F32(value)) => layer.near_clip_plane = Some(value),
            ("far", Value::F32(value)) => layer.far_clip_plane = Some(value),
            ("fieldOfViewHorizontal", Value::F32(value)) => layer.horizontal_field_of_view = Some(value),
            ("fieldOfViewVertical", Value::F32(value)) => layer.vertical_field_of_view = Some(value),
            ("worldToCamera", Value::Matrix4x4(value)) => layer.world_to_camera = Some(value),
            ("worldToNDC", Value::Matrix4x4(value)) => layer.world_to_normalized_device = Some(value),
            ("framesPerSecond", Value::Custom { kind, bytes })
                if kind.as_slice() == b"rational" && bytes.len() == 8 =>
            {
                let four = |from: usize| [0, 1, 2, 3].map(|i| bytes[from + i]);
                layer.frames_per_second = Some((i32::from_le_bytes(four(0)), u32::from_le_bytes(four(4))));
            }
            (name, _) if names::ALL.contains(&name.as_bytes()) => {
                return Err(bad("is a standard attribute of another type, or one that the picture sets itself"));
            }
            (_, value) => {
                layer.other.insert(text(name), value);
            }
        }
    }
    Ok(())
}

/// All attributes of a layer that was read, but for the structural ones.
pub(crate) fn collect(image: ImageAttributes, layer: LayerAttributes) -> exr::error::Result<Attributes> {
    // A header of our own is the crate's only way to list attributes; its size and channels are not looked at.
    let header = Header::new(Text::default(), (1, 1), exr::prelude::SmallVec::new())
        .with_attributes(layer)
        .with_shared_attributes(image);
    header
        .all_named_attributes()
        .filter(|(name, _)| !STRUCTURAL.contains(name))
        .map(|(name, value)| Ok((String::from_utf8_lossy(name).into_owned(), from_exr(&value)?)))
        .collect()
}

/// EXR strings are UTF-8; the crate's own constructor knows Latin-1 only.
pub(crate) fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

fn to_exr(value: &Attribute) -> Option<AttributeValue> {
    let pair = |[x, y]: [f32; 2]| exr::math::Vec2(x, y);
    Some(match value {
        // Beyond 2³¹ − 1 bytes the size field overflows.
        Attribute::Text(value) if i32::try_from(value.len()).is_err() => return None,
        Attribute::Text(value) => AttributeValue::Text(text(value)),
        Attribute::Int(value) => AttributeValue::I32(*value),
        Attribute::Float(value) => AttributeValue::F32(*value),
        Attribute::Double(value) => AttributeValue::F64(*value),
        Attribute::Vec2(value) => AttributeValue::FloatVec2(pair(*value)),
        Attribute::Vec3([x, y, z]) => AttributeValue::FloatVec3((*x, *y, *z)),
        Attribute::Matrix4(value) => AttributeValue::Matrix4x4(*value),
        Attribute::Chromaticities(value) => AttributeValue::Chromaticities(exr::meta::attribute::Chromaticities {
            red: pair(value.red),
            green: pair(value.green),
            blue: pair(value.blue),
            white: pair(value.white),
        }),
        Attribute::Other { kind, .. } if kind.is_empty() || kind.len() > 255 || kind.contains('\0') => return None,
        Attribute::Other { bytes, .. } if i32::try_from(bytes.len()).is_err() => return None,
        Attribute::Other { kind, bytes } => AttributeValue::Custom { kind: text(kind), bytes: bytes.as_slice().into() },
    })
}

fn from_exr(value: &AttributeValue) -> exr::error::Result<Attribute> {
    let pair = |exr::math::Vec2(x, y): exr::math::Vec2<f32>| [x, y];
    Ok(match value {
        AttributeValue::Text(value) => Attribute::Text(String::from_utf8_lossy(value.as_slice()).into_owned()),
        AttributeValue::I32(value) => Attribute::Int(*value),
        AttributeValue::F32(value) => Attribute::Float(*value),
        AttributeValue::F64(value) => Attribute::Double(*value),
        AttributeValue::FloatVec2(value) => Attribute::Vec2(pair(*value)),
        AttributeValue::FloatVec3((x, y, z)) => Attribute::Vec3([*x, *y, *z]),
        AttributeValue::Matrix4x4(value) => Attribute::Matrix4(*value),
        AttributeValue::Chromaticities(value) => Attribute::Chromaticities(Chromaticities {
            red: pair(value.red),
            green: pair(value.green),
            blue: pair(value.blue),
            white: pair(value.white),
        }),
        other => {
            let mut bytes = Vec::new();
            other.write(&mut bytes)?;
            Attribute::Other { kind: String::from_utf8_lossy(other.kind_name()).into_owned(), bytes }
        }
    })
}

/// Sorts the attributes of a single-part file by name, in place.
///
/// The `exr` crate keeps custom attributes in a hash map with a random order, so that the same picture would give other
/// bytes each time. OpenEXR's layout of a header: magic number, version, then attributes as `name NUL type NUL size:i32
/// value`, closed by a NUL; what follows is found by its distance from the start of the file, which a new order of the
/// attributes does not change.
pub(crate) fn sort_attributes(file: &mut [u8]) -> Option<()> {
    const FIRST: usize = 8;
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut end = FIRST;
    while *file.get(end)? != 0 {
        let start = end;
        for _ in 0..2 {
            end += file.get(end..)?.iter().position(|byte| *byte == 0)? + 1;
        }
        let size = i32::from_le_bytes(file.get(end..end + 4)?.try_into().ok()?);
        end = end.checked_add(4)?.checked_add(usize::try_from(size).ok()?)?;
        attributes.push(file.get(start..end)?.to_vec());
    }
    // Names are unique and end in NUL, so comparing whole attributes compares names.
    attributes.sort_unstable();
    file[FIRST..end].copy_from_slice(&attributes.concat());
    Some(())
}
