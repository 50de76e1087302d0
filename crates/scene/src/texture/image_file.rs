//! Images, decoded from files.

use etalon_optics::colour::rec709_luminance;
use std::io::Cursor;
use std::sync::LazyLock;

use etalon_picture::{MAX_PNG_METADATA_BYTES, check_exr_size, most_exr_bytes, most_image_bytes};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

/// Largest side of an image, pixels.
pub const MAX_IMAGE_SIDE: u32 = 65_536;
/// Most memory that an image may take with all its conversions, bytes: 4 GiB, and for a small file no more than
/// [`etalon_picture::most_image_bytes`].
pub const MAX_IMAGE_BYTES: u64 = 4 << 30;

/// An image of three channels, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// The texels.
    pub texels: Texels,
    /// What is asked of all of them, by each part of each material that shows the image: found once.
    mean: [f64; 3],
    most: [f64; 3],
    grey: bool,
}

/// No number is NaN. Two [`Arc`](std::sync::Arc)s of one image are therefore equal at once, without a look at its texels.
impl Eq for Image {}

/// Texels, as they are stored.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Eight bits a channel, encoded as sRGB.
    Srgb8(Vec<[u8; 3]>),
    /// Eight bits a channel, in proportion.
    Linear8(Vec<[u8; 3]>),
    /// Numbers.
    F32(Vec<[f32; 3]>),
}

/// How numbers stand in an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// As the kind of file has it: sRGB in PNG and JPEG, linear in EXR and HDR.
    Auto,
    /// By the curve of sRGB.
    Srgb,
    /// Values are proportional to light.
    Linear,
}

/// Which of an image's channels are data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Alpha, where the image has it, else its luminance.
    Auto,
    /// Alpha; 1 in an image without.
    Alpha,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// 0.2126 R + 0.7152 G + 0.0722 B.
    Luminance,
    /// (R + G + B)/3.
    Mean,
    /// Red, green and blue, each as it is.
    All,
}

/// sRGB (IEC 61966-2-1) as linear numbers, for each of the 256 values of a channel.
static SRGB: LazyLock<[f64; 256]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let v = i as f64 / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    })
});

impl Image {
    /// An image of `width` × `height` texels, rows from the top.
    ///
    /// # Panics
    /// If there are more or fewer texels.
    pub fn new(width: u32, height: u32, texels: Texels) -> Self {
        let count = match &texels {
            Texels::Srgb8(texels) | Texels::Linear8(texels) => texels.len(),
            Texels::F32(texels) => texels.len(),
        };
        assert_eq!(count, width as usize * height as usize, "texels of an image of {width} × {height}");
        let mut image = Self { width, height, texels, mean: [0.0; 3], most: [0.0; 3], grey: true };
        let (mut sum, mut most) = ([0.0; 3], [0.0_f64; 3]);
        let mut grey = true;
        for texel in image.linear_texels() {
            (0..3).for_each(|c| sum[c] += texel[c]);
            (0..3).for_each(|c| most[c] = most[c].max(texel[c].abs()));
            grey &= texel[0] == texel[1] && texel[1] == texel[2];
        }
        image.mean = sum.map(|v| v / (f64::from(width) * f64::from(height)));
        image.most = most;
        image.grey = grey;
        image
    }

    /// Decodes a PNG, JPEG, BMP, EXR or HDR file, told apart by its first bytes. What it says beyond three channels is left
    /// out: the second value says what.
    ///
    /// # Errors
    /// A sentence that says what is wrong: no such file, too large, damaged, or texels that are not finite.
    pub fn decode(bytes: &[u8], encoding: Encoding) -> Result<(Self, Option<String>), String> {
        let decoded = Self::read(bytes, 3)?;
        let left_out = match &decoded {
            d if !d.color().has_alpha() => None,
            d if is_opaque(d) => None,
            _ => Some("its alpha channel is not used".to_owned()),
        };
        Self::of(decoded, encoding).map(|image| (image, left_out))
    }

    /// Decodes one channel of such a file, or three, as linear numbers; one stands in all three of the image. Alpha is linear
    /// whatever the encoding.
    ///
    /// # Errors
    /// As [`Image::decode`].
    pub fn decode_data(bytes: &[u8], channel: Channel, encoding: Encoding) -> Result<Self, String> {
        let decoded = Self::read(bytes, 12)?;
        let channel = match channel {
            Channel::Auto if decoded.color().has_alpha() => Channel::Alpha,
            Channel::Auto => Channel::Luminance,
            other => other,
        };
        let (width, height) = (decoded.width(), decoded.height());
        if channel == Channel::Alpha {
            return Self::of_numbers(width, height, alpha(&decoded));
        }
        let image = Self::of(decoded, encoding)?;
        let pick = |[r, g, b]: [f64; 3]| match channel {
            Channel::Red => r,
            Channel::Green => g,
            Channel::Blue => b,
            Channel::Mean => (r + g + b) / 3.0,
            Channel::Luminance => rec709_luminance([r, g, b]),
            Channel::Auto | Channel::Alpha | Channel::All => unreachable!("decided above, or below"),
        };
        if channel == Channel::All {
            return Ok(image);
        }
        let texels = image.linear_texels().map(|texel| [pick(texel) as f32; 3]).collect();
        Ok(Self::new(width, height, Texels::F32(texels)))
    }

    /// The pixels of a file. What becomes of each takes `made_bytes` bytes, or 12 where its samples are more than bytes.
    fn read(bytes: &[u8], made_bytes: u64) -> Result<DynamicImage, String> {
        let failed = |error: image::ImageError| error.to_string();
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
        let Some(format) = reader.format() else {
            return Err("it is not a PNG, JPEG, BMP, EXR or HDR file".to_owned());
        };
        let length = bytes.len() as u64;
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_IMAGE_SIDE);
        limits.max_image_height = Some(MAX_IMAGE_SIDE);
        // Beside the pixels, which are counted below.
        limits.max_alloc = Some(MAX_PNG_METADATA_BYTES);
        if format == ImageFormat::OpenExr {
            // The decoder's own limits are of the window that is shown, not of the one that is stored.
            check_exr_size(bytes, MAX_IMAGE_BYTES.min(most_exr_bytes(length)), u64::from(MAX_IMAGE_SIDE))?;
        }
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(failed)?;
        let (width, height) = decoder.dimensions();
        let decoded = u64::from(decoder.color_type().bytes_per_pixel());
        let samples = decoded / u64::from(decoder.color_type().channel_count());
        let (texel, made) = if samples == 1 { (3, made_bytes) } else { (12, 12) };
        // A progressive JPEG is put together from two bytes a coefficient.
        let coefficients = if format == ImageFormat::Jpeg { 6 } else { 0 };
        // Each step holds what it reads and what it makes.
        let peak = (coefficients + decoded).max(decoded + made).max(made + texel);
        let asked = u128::from(width) * u128::from(height) * u128::from(peak);
        let most = MAX_IMAGE_BYTES.min(most_image_bytes(length));
        if asked > u128::from(most) {
            return Err(format!(
                "its {length} bytes claim {width} × {height} pixels, which would take {asked} bytes of memory; at most \
                 {most}"
            ));
        }
        DynamicImage::from_decoder(decoder).map_err(failed)
    }

    fn of(decoded: DynamicImage, encoding: Encoding) -> Result<Self, String> {
        let (width, height) = (decoded.width(), decoded.height());
        if width == 0 || height == 0 {
            return Err("it has no texels".to_owned());
        }
        let float = matches!(decoded, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
        let srgb = encoding == Encoding::Srgb || encoding == Encoding::Auto && !float;
        let eight = matches!(
            decoded,
            DynamicImage::ImageLuma8(_)
                | DynamicImage::ImageLumaA8(_)
                | DynamicImage::ImageRgb8(_)
                | DynamicImage::ImageRgba8(_)
        );
        let texels = if eight {
            let texels = decoded.into_rgb8().pixels().map(|p| p.0).collect();
            if srgb { Texels::Srgb8(texels) } else { Texels::Linear8(texels) }
        } else {
            let linear = |v: f32| match srgb {
                false => v,
                true if v <= 0.04045 => v / 12.92,
                true => ((f64::from(v) + 0.055) / 1.055).powf(2.4) as f32,
            };
            Texels::F32(decoded.into_rgb32f().pixels().map(|p| p.0.map(linear)).collect())
        };
        match texels {
            Texels::F32(texels) => Self::of_numbers(width, height, texels),
            levels => Ok(Self::new(width, height, levels)),
        }
    }

    fn of_numbers(width: u32, height: u32, texels: Vec<[f32; 3]>) -> Result<Self, String> {
        if width == 0 || height == 0 {
            return Err("it has no texels".to_owned());
        }
        if let Some(i) = texels.iter().position(|t| t.iter().any(|v| !v.is_finite())) {
            let (column, row) = (i % width as usize, i / width as usize);
            return Err(format!("its texel in column {column}, row {row} is {:?}", texels[i]));
        }
        Ok(Self::new(width, height, Texels::F32(texels)))
    }

    /// The texel in a column and a row, counted from 0 at the top left, in linear numbers.
    #[inline(always)]
    pub fn texel(&self, column: usize, row: usize) -> [f64; 3] {
        let i = row * self.width as usize + column;
        // Written out: the library's `map` is not always made part of its caller, and this is called for every corner of every look-up.
        match &self.texels {
            Texels::Srgb8(texels) => {
                let [r, g, b] = texels[i];
                let curve = &*SRGB;
                [curve[usize::from(r)], curve[usize::from(g)], curve[usize::from(b)]]
            }
            Texels::Linear8(texels) => {
                let [r, g, b] = texels[i];
                [f64::from(r) / 255.0, f64::from(g) / 255.0, f64::from(b) / 255.0]
            }
            Texels::F32(texels) => {
                let [r, g, b] = texels[i];
                [f64::from(r), f64::from(g), f64::from(b)]
            }
        }
    }

    /// All texels, row after row from the top, in linear numbers.
    pub fn linear_texels(&self) -> impl Iterator<Item = [f64; 3]> {
        let width = self.width as usize;
        (0..width * self.height as usize).map(move |i| self.texel(i % width, i / width))
    }

    /// The mean of all texels.
    pub fn mean(&self) -> [f64; 3] {
        self.mean
    }

    /// The largest number of each channel, without its sign.
    pub fn most(&self) -> [f64; 3] {
        self.most
    }

    /// Whether every texel has three equal channels.
    pub fn is_grey(&self) -> bool {
        self.grey
    }
}

/// Alpha as three equal numbers, 1 in an image without.
fn alpha(image: &DynamicImage) -> Vec<[f32; 3]> {
    let byte = |v: u8| [f32::from(v) / 255.0; 3];
    let word = |v: u16| [f32::from(v) / 65535.0; 3];
    match image {
        DynamicImage::ImageLumaA8(i) => i.pixels().map(|p| byte(p.0[1])).collect(),
        DynamicImage::ImageRgba8(i) => i.pixels().map(|p| byte(p.0[3])).collect(),
        DynamicImage::ImageLumaA16(i) => i.pixels().map(|p| word(p.0[1])).collect(),
        DynamicImage::ImageRgba16(i) => i.pixels().map(|p| word(p.0[3])).collect(),
        DynamicImage::ImageRgba32F(i) => i.pixels().map(|p| [p.0[3]; 3]).collect(),
        other => vec![[1.0; 3]; other.width() as usize * other.height() as usize],
    }
}

fn is_opaque(image: &DynamicImage) -> bool {
    match image {
        DynamicImage::ImageLumaA8(i) => i.pixels().all(|p| p.0[1] == u8::MAX),
        DynamicImage::ImageRgba8(i) => i.pixels().all(|p| p.0[3] == u8::MAX),
        DynamicImage::ImageLumaA16(i) => i.pixels().all(|p| p.0[1] == u16::MAX),
        DynamicImage::ImageRgba16(i) => i.pixels().all(|p| p.0[3] == u16::MAX),
        DynamicImage::ImageRgba32F(i) => i.pixels().all(|p| p.0[3] == 1.0),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn files_mean_what_their_encoding_says() {
        let grey = DynamicImage::ImageRgb8(image::RgbImage::from_pixel(3, 2, image::Rgb([188, 0, 255])));
        let png = encoded(&grey, ImageFormat::Png);
        let (srgb, left_out) = Image::decode(&png, Encoding::Auto).unwrap();
        assert_eq!((srgb.width, srgb.height, left_out), (3, 2, None));
        // 188/255 = 0.737254902; ((0.737254902 + 0.055)/1.055)^2.4 by hand.
        assert!((srgb.texel(0, 0)[0] - 0.502_886_458_033).abs() < 1e-11, "{}", srgb.texel(0, 0)[0]);
        assert_eq!(srgb.texel(2, 1)[1..], [0.0, 1.0]);
        let (linear, _) = Image::decode(&png, Encoding::Linear).unwrap();
        assert_eq!(linear.texel(1, 1), [188.0 / 255.0, 0.0, 1.0]);
        let (bmp, _) = Image::decode(&encoded(&grey, ImageFormat::Bmp), Encoding::Linear).unwrap();
        assert_eq!(bmp.texel(1, 1), linear.texel(1, 1));

        let float = DynamicImage::ImageRgb32F(image::Rgb32FImage::from_pixel(2, 2, image::Rgb([0.5, 2.0, 0.125])));
        for format in [ImageFormat::OpenExr, ImageFormat::Hdr] {
            let (image, _) = Image::decode(&encoded(&float, format), Encoding::Auto).unwrap();
            assert_eq!(image.texel(1, 0), [0.5, 2.0, 0.125], "{format:?}");
        }
        let jpeg = encoded(&grey, ImageFormat::Jpeg);
        let (image, _) = Image::decode(&jpeg, Encoding::Linear).unwrap();
        // A lossy file of one colour: chroma is rounded to whole levels.
        assert!((image.texel(1, 1)[0] - 188.0 / 255.0).abs() < 0.02);
        let rgba = DynamicImage::ImageRgba8(image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 4])));
        assert!(Image::decode(&encoded(&rgba, ImageFormat::Png), Encoding::Auto).unwrap().1.is_some());
    }

    #[test]
    fn conversions_count_toward_the_memory_of_an_image() {
        // A byte a pixel when it is decoded, fifteen while it becomes data.
        let grey = DynamicImage::ImageLuma8(image::GrayImage::new(8000, 8000));
        let mut png = Vec::new();
        let (compression, filter) =
            (image::codecs::png::CompressionType::Best, image::codecs::png::FilterType::NoFilter);
        let encoder = image::codecs::png::PngEncoder::new_with_quality(&mut png, compression, filter);
        grey.write_with_encoder(encoder).unwrap();
        assert!(Image::decode(&png, Encoding::Linear).is_ok());
        let error = Image::decode_data(&png, Channel::Mean, Encoding::Linear).unwrap_err();
        assert!(error.contains("would take 960000000 bytes"), "{error}");
    }

    #[test]
    fn damaged_files_and_those_larger_than_they_look_are_refused() {
        let image = DynamicImage::ImageRgb8(image::RgbImage::from_pixel(30, 20, image::Rgb([1, 2, 3])));
        let png = encoded(&image, ImageFormat::Png);
        for length in [0, 3, 20, png.len() / 2] {
            assert!(Image::decode(&png[..length], Encoding::Auto).is_err(), "{length}");
        }
        assert!(Image::decode(b"not an image at all", Encoding::Auto).unwrap_err().contains("not a PNG"));
        // A header that promises 60,000 × 60,000 texels in a hundred bytes.
        let mut huge = png.clone();
        huge[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
        assert!(Image::decode(&huge, Encoding::Auto).is_err());
        let nan = DynamicImage::ImageRgb32F(image::Rgb32FImage::from_pixel(2, 2, image::Rgb([0.5, f32::NAN, 0.1])));
        assert!(Image::decode(&encoded(&nan, ImageFormat::OpenExr), Encoding::Auto).unwrap_err().contains("column 0"));
    }
}
