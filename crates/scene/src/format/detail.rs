//! Images that give a surface detail: opacity, normals, heights, numbers of its material.

use super::material::Share;
use super::spectra::FARTHEST_UV;
use crate::files::Files;
use crate::json::{Code, NonNegative, Optional, Reader, Required, Span, Spanned};
use crate::model::{OpacityImage, Relief};
use crate::texture::{Channel, ImageTexture, TextureFilter, Wrap};

crate::record! {
    /// An image of an object's opacity over its texture coordinates.
    pub(crate) struct OpacityImageForm + comment {
        /// A PNG, JPEG, EXR or HDR file, relative to this file's folder.
        file: Required<Spanned<String>>,
        /// Which of its channels says the share of light that meets the surface.
        channel: Required<Channel> = r#""auto""#,
        /// Given, what is below this share is not there, and the rest is all there.
        cutoff: Optional<Share>,
        /// What it shows beyond its edges.
        wrap: Required<Wrap> = r#""repeat""#,
        /// What it shows beyond its lower and upper edge, if that is another thing.
        wrap_v: Optional<Wrap>,
        /// What it shows between the centres of its texels.
        filter: Required<TextureFilter> = r#""bilinear""#,
        /// Factors on the texture coordinates: 2 shows the image twice.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
    }
}

crate::record! {
    /// An image of a number of a material, from 0 to 1, over the texture coordinates of the surface.
    pub(crate) struct NumberImageForm + comment {
        /// A PNG, JPEG, EXR or HDR file, relative to this file's folder; its numbers are linear.
        file: Required<Spanned<String>>,
        /// Which of its channels says the number.
        channel: Required<Channel> = r#""auto""#,
        /// Factor on what it says.
        factor: Required<NonNegative> = "1",
        /// What it shows beyond its edges.
        wrap: Required<Wrap> = r#""repeat""#,
        /// What it shows beyond its lower and upper edge, if that is another thing.
        wrap_v: Optional<Wrap>,
        /// What it shows between the centres of its texels.
        filter: Required<TextureFilter> = r#""bilinear""#,
        /// Factors on the texture coordinates: 2 shows the image twice.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
    }
}

crate::record! {
    /// A normal map: red, green and blue are the normal's parts along u, along v and outward, from −1 (0) to 1 (1).
    pub(crate) struct NormalMapForm + comment {
        /// A PNG, JPEG, EXR or HDR file, relative to this file's folder; its numbers are linear.
        file: Required<Spanned<String>>,
        /// Factor on the parts along u and v.
        strength: Required<NonNegative> = "1",
        /// What it shows beyond its edges.
        wrap: Required<Wrap> = r#""repeat""#,
        /// What it shows beyond its lower and upper edge, if that is another thing.
        wrap_v: Optional<Wrap>,
        /// Factors on the texture coordinates: 2 shows the image twice.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
    }
}

crate::record! {
    /// A bump map: heights over the surface, which is shaded as if it had them.
    pub(crate) struct BumpMapForm + comment {
        /// A PNG, JPEG, EXR or HDR file, relative to this file's folder; its numbers are linear, and the first channel counts.
        file: Required<Spanned<String>>,
        /// Height of white over black, m; below 0 white is deep.
        height_m: Required<f64>,
        /// What it shows beyond its edges.
        wrap: Required<Wrap> = r#""repeat""#,
        /// What it shows beyond its lower and upper edge, if that is another thing.
        wrap_v: Optional<Wrap>,
        /// Factors on the texture coordinates: 2 shows the image twice.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
    }
}

crate::keywords!(Channel {
    /// "alpha" of an image that has it, else "luminance".
    "auto" => Self::Auto,
    /// How opaque the image says it is itself.
    "alpha" => Self::Alpha,
    /// Red.
    "red" => Self::Red,
    /// Green.
    "green" => Self::Green,
    /// Blue.
    "blue" => Self::Blue,
    /// The mixture of the three that is as bright, of numbers as they are written.
    "luminance" => Self::Luminance,
});

/// Where an image is laid over texture coordinates.
struct Laid<'f> {
    at: Span,
    file: &'f Spanned<String>,
    channel: Channel,
    wrap: Wrap,
    wrap_v: Optional<Wrap>,
    filter: TextureFilter,
    uv_scale: [f64; 2],
    uv_offset: [f64; 2],
}

impl Laid<'_> {
    fn texture(self, files: &mut Files, reader: &mut Reader<'_>) -> Option<ImageTexture> {
        let image = files.data(self.file, self.channel, reader);
        for (key, pair) in [("uv_scale", self.uv_scale), ("uv_offset", self.uv_offset)] {
            if pair.iter().any(|v| v.abs() > FARTHEST_UV) {
                let message = format!("a {key} beyond {FARTHEST_UV:e} leaves no digits for the place in the image");
                reader.error(Code::OutOfRange, self.at.head(), message);
                return None;
            }
        }
        Some(ImageTexture {
            image: image?,
            name: self.file.value.clone(),
            wrap: [self.wrap, self.wrap_v.checked()?.unwrap_or(self.wrap)],
            filter: self.filter,
            uv_scale: self.uv_scale,
            uv_offset: self.uv_offset,
            factor: [1.0; 3],
        })
    }
}

/// The opacity image of a form.
pub(super) fn opacity_image(
    form: &OpacityImageForm,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<OpacityImage> {
    let file = form.file.as_ref()?;
    let laid = Laid {
        at: form.at,
        file,
        channel: form.channel?,
        wrap: form.wrap?,
        wrap_v: form.wrap_v.clone(),
        filter: form.filter?,
        uv_scale: form.uv_scale?,
        uv_offset: form.uv_offset?,
    };
    let texture = laid.texture(files, reader)?;
    if let Some([share, ..]) = texture.image.linear_texels().find(|[share, ..]| !(0.0..=1.0).contains(share)) {
        let message = format!("{}: a texel of {share} is no share, which lies from 0 to 1", file.value);
        reader.error(Code::OutOfRange, file.at, message);
        return None;
    }
    let cutoff = form.cutoff.clone().checked()?.map(|share| share.0);
    Some(OpacityImage { texture, cutoff })
}

/// The image of a number from 0 to 1 of a form.
pub(super) fn number_image(form: &NumberImageForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<ImageTexture> {
    let file = form.file.as_ref()?;
    let laid = Laid {
        at: form.at,
        file,
        channel: form.channel?,
        wrap: form.wrap?,
        wrap_v: form.wrap_v.clone(),
        filter: form.filter?,
        uv_scale: form.uv_scale?,
        uv_offset: form.uv_offset?,
    };
    let factor = form.factor?.0;
    let texture = ImageTexture { factor: [factor; 3], ..laid.texture(files, reader)? };
    let outside = |[number, ..]: &[f64; 3]| !(0.0..=1.0).contains(&(number * factor));
    if let Some([number, ..]) = texture.image.linear_texels().find(outside) {
        let message = format!("{}: a texel of {number}, times {factor}, does not lie from 0 to 1", file.value);
        reader.error(Code::OutOfRange, file.at, message);
        return None;
    }
    Some(texture)
}

/// The normal map of a form.
pub(super) fn normal_map(form: &NormalMapForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<Relief> {
    let laid = Laid {
        at: form.at,
        file: form.file.as_ref()?,
        channel: Channel::All,
        wrap: form.wrap?,
        wrap_v: form.wrap_v.clone(),
        filter: TextureFilter::Bilinear,
        uv_scale: form.uv_scale?,
        uv_offset: form.uv_offset?,
    };
    Some(Relief::Normals { texture: laid.texture(files, reader)?, strength: form.strength?.0 })
}

/// The bump map of a form.
pub(super) fn bump_map(form: &BumpMapForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<Relief> {
    let laid = Laid {
        at: form.at,
        file: form.file.as_ref()?,
        channel: Channel::Red,
        wrap: form.wrap?,
        wrap_v: form.wrap_v.clone(),
        filter: TextureFilter::Bilinear,
        uv_scale: form.uv_scale?,
        uv_offset: form.uv_offset?,
    };
    Some(Relief::Heights { texture: laid.texture(files, reader)?, height_m: form.height_m? })
}
