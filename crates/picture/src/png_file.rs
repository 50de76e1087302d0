//! PNG files.

use std::io::Cursor;
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, ImageError};

use crate::exr_size::{MAX_PNG_METADATA_BYTES, most_image_bytes};
use crate::{Picture, PictureError, Rgb8, decode_srgb, write_atomically};

/// Writes an 8-bit PNG that says it is sRGB, atomically (see [`write_atomically`]), with a text chunk for each keyword
/// and text. The same picture and texts give the same bytes.
///
/// # Errors
/// A file that cannot be written; a keyword that PNG does not allow (1 to 79 characters of Latin-1); a number of bytes
/// that does not fit the size.
pub fn write_png(path: &Path, picture: &Rgb8, texts: &[(&str, &str)]) -> Result<(), PictureError> {
    let bytes = encode(picture, texts, path)?;
    write_atomically(path, |out| out.write_all(&bytes))
}

/// The bytes of the file that [`write_png`] writes.
///
/// # Errors
/// As [`write_png`], but for files.
pub fn encode_png(picture: &Rgb8, texts: &[(&str, &str)]) -> Result<Vec<u8>, PictureError> {
    encode(picture, texts, Path::new("(in memory)"))
}

/// Numbers of 16 bits, row after row from the top: one or three for each pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Samples16 {
    /// Width, pixels.
    pub width: usize,
    /// Height, pixels.
    pub height: usize,
    /// Numbers for each pixel: 1 (grey) or 3 (colour).
    pub channels: usize,
    /// The numbers.
    pub samples: Vec<u16>,
}

/// Writes a PNG of 16 bits with the numbers as they are, atomically (see [`write_atomically`]), with a text chunk for each keyword and text. It
/// says that the numbers are proportional to light (a gamma of 1).
///
/// # Errors
/// As [`write_png`].
pub fn write_png16(path: &Path, picture: &Samples16, texts: &[(&str, &str)]) -> Result<(), PictureError> {
    let bytes = encode_bytes16(picture, texts).map_err(|source| PictureError::Png {
        action: "write",
        path: path.to_owned(),
        source: Box::new(source),
    })?;
    write_atomically(path, |out| out.write_all(&bytes))
}

fn encode_bytes16(picture: &Samples16, texts: &[(&str, &str)]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(picture.width), side(picture.height));
    encoder.set_color(if picture.channels == 3 { png::ColorType::Rgb } else { png::ColorType::Grayscale });
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_source_gamma(png::ScaledFloat::new(1.0));
    for (keyword, text) in texts {
        encoder.add_itxt_chunk((*keyword).to_owned(), (*text).to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    let samples: Vec<u8> = picture.samples.iter().flat_map(|sample| sample.to_be_bytes()).collect();
    writer.write_image_data(&samples)?;
    writer.finish()?;
    Ok(bytes)
}

/// A side of a PNG. One that is too long becomes one that PNG refuses.
fn side(pixels: usize) -> u32 {
    u32::try_from(pixels).unwrap_or(0)
}

fn encode(picture: &Rgb8, texts: &[(&str, &str)], path: &Path) -> Result<Vec<u8>, PictureError> {
    encode_bytes(picture, texts).map_err(|source| PictureError::Png {
        action: "write",
        path: path.to_owned(),
        source: Box::new(source),
    })
}

fn encode_bytes(picture: &Rgb8, texts: &[(&str, &str)]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(picture.width), side(picture.height));
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    for (keyword, text) in texts {
        encoder.add_itxt_chunk((*keyword).to_owned(), (*text).to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&picture.pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// Reads a PNG file as linear light: sRGB decoded, in channels `R`, `G`, `B`, and `A` (not decoded) if it has one. A
/// colour profile or gamma in the file is not looked at.
///
/// # Errors
/// A file that cannot be read or is no PNG.
pub fn read_png(path: &Path) -> Result<Picture<f32>, PictureError> {
    // For each pixel up to four channels of 32-bit floats.
    let image = decode(path, 16)?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let (count, has_alpha) = (usize::from(image.color().channel_count()), image.color().has_alpha());
    let colours = count - usize::from(has_alpha);
    let mut picture = Picture::new(width, height)?;
    for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
        let samples = channel(&image, i.min(colours - 1), count);
        picture.insert(name, samples.map(|value| decode_srgb(f64::from(value)) as f32).collect())?;
    }
    if has_alpha {
        picture.insert("A", channel(&image, count - 1, count).collect())?;
    }
    Ok(picture)
}

/// The text that a PNG file has under a keyword, if it has one. All pixels are decoded, so that a file which is cut short is an error.
///
/// # Errors
/// As [`read_png`].
pub fn read_png_text(path: &Path, keyword: &str) -> Result<Option<String>, PictureError> {
    decode(path, 3)?;
    let bytes = crate::read_plain(path).map_err(|source| PictureError::io("read", path, source))?;
    let text = || {
        let reader = png::Decoder::new(Cursor::new(bytes)).read_info()?;
        let found = reader.info().utf8_text.iter().find(|text| text.keyword == keyword);
        found.map(|text| text.get_text()).transpose()
    };
    text().map_err(|source: png::DecodingError| PictureError::Png {
        action: "read",
        path: path.to_owned(),
        source: Box::new(source),
    })
}

/// The samples of one channel out of `count`, from 0 to 1.
fn channel(image: &DynamicImage, offset: usize, count: usize) -> Box<dyn Iterator<Item = f32> + '_> {
    match image.as_flat_samples_u16() {
        Some(flat) => Box::new(flat.samples.iter().skip(offset).step_by(count).map(|v| f32::from(*v) / 65535.0)),
        // PNG has no others.
        None => Box::new(image.as_bytes().iter().skip(offset).step_by(count).map(|v| f32::from(*v) / 255.0)),
    }
}

/// Reads the 8-bit RGB pixels of a PNG file as they are. An alpha channel is dropped, and must be opaque.
///
/// # Errors
/// A file that cannot be read or is no PNG; 16 bits, grey, or an alpha that is not 255 everywhere.
pub fn read_png8(path: &Path) -> Result<Rgb8, PictureError> {
    let not_rgb8 = |found: &str| PictureError::NotRgb8 { path: path.to_owned(), found: found.to_owned() };
    let image = decode(path, 3)?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = match image {
        DynamicImage::ImageRgb8(image) => image.into_raw(),
        DynamicImage::ImageRgba8(image) if image.pixels().any(|pixel| pixel.0[3] != 255) => {
            return Err(not_rgb8("some pixels are transparent"));
        }
        image @ DynamicImage::ImageRgba8(_) => image.into_rgb8().into_raw(),
        other => return Err(not_rgb8(&format!("its pixels are {:?}", other.color()))),
    };
    Ok(Rgb8 { width, height, pixels })
}

/// The pixels of a file, of which something is made that takes `made_bytes` bytes each.
fn decode(path: &Path, made_bytes: u64) -> Result<DynamicImage, PictureError> {
    let bytes = crate::read_plain(path).map_err(|source| PictureError::io("read", path, source))?;
    let most_bytes = most_image_bytes(bytes.len() as u64);
    let read = || {
        let mut limits = image::Limits::no_limits();
        limits.max_alloc = Some(MAX_PNG_METADATA_BYTES);
        let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits)?;
        let (width, height) = decoder.dimensions();
        let pixels = u128::from(width) * u128::from(height);
        if pixels * u128::from(u64::from(decoder.color_type().bytes_per_pixel()) + made_bytes) > u128::from(most_bytes)
        {
            let kind = image::error::LimitErrorKind::InsufficientMemory;
            return Err(ImageError::Limits(image::error::LimitError::from_kind(kind)));
        }
        DynamicImage::from_decoder(decoder)
    };
    read().map_err(|source: ImageError| PictureError::Png {
        action: "read",
        path: path.to_owned(),
        source: Box::new(source),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_png_says_that_it_is_srgb_and_keeps_its_texts() {
        let picture = Rgb8 { width: 1, height: 1, pixels: vec![1, 2, 3] };
        let bytes = encode_png(&picture, &[("Software", "etalon"), ("Comment", "+1.5 EV · λ")]).unwrap();
        let reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().srgb, Some(png::SrgbRenderingIntent::RelativeColorimetric));
        let texts: Vec<_> =
            reader.info().utf8_text.iter().map(|text| (text.keyword.clone(), text.get_text().unwrap())).collect();
        assert_eq!(texts, [("Software".into(), "etalon".into()), ("Comment".into(), "+1.5 EV · λ".into())]);

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("texts.png");
        write_png(&path, &picture, &[("Comment", "λ")]).unwrap();
        assert_eq!(read_png_text(&path, "Comment").unwrap().as_deref(), Some("λ"));
        assert_eq!(read_png_text(&path, "Author").unwrap(), None);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 20]).unwrap();
        assert!(read_png_text(&path, "Comment").is_err(), "it is cut short");
    }

    #[test]
    fn numbers_of_16_bits_come_back_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("raw.png");
        for channels in [1, 3] {
            let samples: Vec<u16> = (0..6 * channels as u16).map(|i| 257 * i + 4095).collect();
            let picture = Samples16 { width: 3, height: 2, channels, samples };
            write_png16(&path, &picture, &[("sensor", "{}")]).unwrap();
            let image = decode(&path, 16).unwrap();
            assert_eq!(image.as_flat_samples_u16().unwrap().samples, picture.samples);
            assert_eq!(usize::from(image.color().channel_count()), channels);
            assert_eq!(read_png_text(&path, "sensor").unwrap().as_deref(), Some("{}"));
        }
        let short = Samples16 { width: 3, height: 2, channels: 1, samples: vec![0; 5] };
        assert!(write_png16(&path, &short, &[]).is_err());
    }

    #[test]
    fn a_png_with_too_few_pixels_is_refused_and_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("short.png");
        let error = write_png(&path, &Rgb8 { width: 2, height: 2, pixels: vec![0; 3] }, &[]).unwrap_err();
        assert!(error.to_string().contains("short.png"), "{error}");
        assert!(!path.exists());
    }

    #[test]
    fn what_is_not_opaque_rgb_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("alpha.png");
        image::RgbaImage::from_raw(1, 1, vec![1, 2, 3, 254]).unwrap().save(&path).unwrap();
        assert!(read_png8(&path).unwrap_err().to_string().contains("transparent"));
        image::RgbaImage::from_raw(1, 1, vec![1, 2, 3, 255]).unwrap().save(&path).unwrap();
        assert_eq!(read_png8(&path).unwrap().pixels, [1, 2, 3]);
        std::fs::write(&path, "not a picture").unwrap();
        let error = read_png8(&path).unwrap_err();
        assert!(matches!(error, PictureError::Png { action: "read", .. }), "{error}");
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(read_png8(&path), Err(PictureError::Io { action: "read", .. })));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn eight_bit_pictures_of_any_size_come_back(
            (width, height, pixels) in (1..40_usize, 1..40_usize).prop_flat_map(|(width, height)| {
                (Just(width), Just(height), prop::collection::vec(any::<u8>(), 3 * width * height))
            }),
        ) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("picture.png");
            let picture = Rgb8 { width, height, pixels };
            write_png(&path, &picture, &[]).unwrap();
            prop_assert_eq!(&read_png8(&path).unwrap(), &picture);
            // Decoded to light and encoded again, every level comes back.
            let (again, clipping) = crate::encode_srgb8(&read_png(&path).unwrap(), 0.0).unwrap();
            prop_assert_eq!(again, picture);
            prop_assert_eq!(clipping.any, 0);
        }
    }
}
