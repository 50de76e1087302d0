//! EXR files to pictures.

use std::path::Path;

use exr::image::read::image::ReadLayers;
use exr::image::read::layers::ReadChannels;
use exr::image::{FlatSamples, read};

use crate::{Attributes, Picture, PictureError, Window};
use crate::{exr_header, exr_size};

/// What an EXR file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrFile {
    /// Its channels, by name.
    pub picture: Picture<f32>,
    /// Its attributes, without those that describe how the pixels are stored.
    pub attributes: Attributes,
}

/// Reads all channels and attributes of an EXR file: of its first part, at full resolution. 16-bit floats are widened;
/// 32-bit integers become the nearest `f32`.
///
/// # Errors
/// A file that cannot be opened or is no EXR file that we can read (deep or subsampled channels), or says that it holds more than
/// [`most_exr_bytes`](crate::most_exr_bytes).
pub fn read_exr(path: &Path) -> Result<ExrFile, PictureError> {
    let bytes = crate::read_plain(path).map_err(|source| PictureError::io("read", path, source))?;
    decode_exr(&bytes, path)
}

/// Reads what [`read_exr`] does from the bytes of a file; `path` names it in errors.
///
/// # Errors
/// As [`read_exr`].
pub fn decode_exr(bytes: &[u8], path: &Path) -> Result<ExrFile, PictureError> {
    let failed = |source| PictureError::exr("read", path, source);
    exr_size::check(bytes, exr_size::most_exr_bytes(bytes.len() as u64), u64::MAX).map_err(failed)?;
    let image = read::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(std::io::Cursor::new(bytes))
        .map_err(failed)?;

    let layer = image.layer_data;
    let exr::math::Vec2(x, y) = layer.attributes.layer_position;
    let display = image.attributes.display_window;
    let relative = |position: i32, frame: i32| {
        position.checked_sub(frame).ok_or_else(|| failed(exr::error::Error::Invalid("window out of range".into())))
    };
    let window = Window {
        origin_px: [relative(x, display.position.x())?, relative(y, display.position.y())?],
        frame_px: [display.size.width(), display.size.height()],
    };
    let mut picture = Picture::new(layer.size.width(), layer.size.height())?.in_frame(window)?;
    for channel in layer.channel_data.list {
        if channel.sampling != exr::math::Vec2(1, 1) {
            return Err(failed(exr::error::Error::NotSupported("subsampled channels".into())));
        }
        let name = String::from_utf8_lossy(channel.name.as_slice()).into_owned();
        let half = matches!(channel.sample_data, FlatSamples::F16(_));
        let samples = match channel.sample_data {
            FlatSamples::F16(samples) => samples.into_iter().map(|sample| sample.to_f32()).collect(),
            FlatSamples::F32(samples) => samples,
            FlatSamples::U32(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
        };
        picture.insert(&name, samples)?;
        if half {
            picture.mark_half(&name);
        }
    }
    let attributes = exr_header::collect(image.attributes, layer.attributes).map_err(failed)?;
    Ok(ExrFile { picture, attributes })
}
