//! Pictures to EXR files.

use std::io::Cursor;
use std::path::Path;

use exr::compression::Compression;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{IntegerBounds, LineOrder};
use exr::meta::header::{ImageAttributes, LayerAttributes};

use crate::exr_header;
use crate::{Attributes, Picture, PictureError, Sample, write_atomically};

/// Lossless, which PIZ and ZIP are; ZIP is what every reader knows.
const ENCODING: Encoding =
    Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };

/// Writes a picture and what is said about it as an EXR file, atomically: see [`write_atomically`] and [`encode_exr`].
///
/// # Errors
/// Those of both, and each names the file.
pub fn write_exr<T: Sample>(path: &Path, picture: &Picture<T>, attributes: &Attributes) -> Result<(), PictureError> {
    let bytes = encode_exr(picture, attributes).map_err(|error| match error {
        PictureError::Exr { source, action, .. } => PictureError::Exr { action, path: path.to_owned(), source },
        other => other,
    })?;
    write_atomically(path, |out| out.write_all(&bytes))
}

/// The bytes of an EXR file: one part of 32-bit float channels in scan lines, compressed without loss (ZIP, 16 lines a
/// block), every NaN, infinity and subnormal kept; `f64` samples are rounded to `f32`. The picture's window becomes the
/// data window, its frame the display window. The same picture and attributes give the same bytes.
///
/// # Errors
/// A picture without channels; an attribute whose name EXR has for something else, or whose value it cannot hold.
pub fn encode_exr<T: Sample>(picture: &Picture<T>, attributes: &Attributes) -> Result<Vec<u8>, PictureError> {
    let failed = |source| PictureError::exr("write", Path::new(""), source);
    let window = picture.window();
    let [x, y] = window.origin_px;
    let [frame_width, frame_height] = window.frame_px;
    let mut image_attributes = ImageAttributes::new(IntegerBounds::new((0, 0), (frame_width, frame_height)));
    let mut layer_attributes = LayerAttributes { layer_position: Vec2(x, y), ..LayerAttributes::default() };
    exr_header::insert(attributes, &mut image_attributes, &mut layer_attributes)?;

    let channels = picture
        .channels()
        .iter()
        .map(|channel| {
            let samples = channel.samples.iter().map(|sample| sample.to_f32()).collect();
            AnyChannel::new(exr_header::text(&channel.name), FlatSamples::F32(samples))
        })
        .collect();
    let layer =
        Layer::new((picture.width(), picture.height()), layer_attributes, ENCODING, AnyChannels::sort(channels));

    let mut bytes = Cursor::new(Vec::new());
    Image::new(image_attributes, layer).write().to_buffered(&mut bytes).map_err(failed)?;
    let mut bytes = bytes.into_inner();
    exr_header::sort_attributes(&mut bytes)
        .ok_or_else(|| failed(exr::error::Error::Invalid("the header has no end".into())))?;
    Ok(bytes)
}
