//! Images that give a surface detail: opacity, normals, heights, numbers of its material.

use super::material::Share;
use super::uv::uv_map;
use crate::files::Files;
use crate::json::{
    Code, Decode, Node, NonNegative, Optional, Reader, Required, Rule, SchemaBuilder, SchemaValue, Spanned,
    by_json_type,
};
use crate::model::{Bitangent, OpacityImage, Relief, Terminator};
use crate::texture::{Channel, Encoding, ImageTexture, TextureFilter, UvMap, Wrap};

/// Declares an image over the texture coordinates of a surface: its file, keys of its own, and how it is laid.
macro_rules! laid_image {
    (
        $(#[doc = $doc:literal])+
        struct $name:ident { $($own:tt)* }
    ) => {
        crate::record! {
            $(#[doc = $doc])+
            pub(crate) struct $name + comment {
                /// A PNG, JPEG, BMP, EXR or HDR file, relative to this file's folder.
                file: Required<Spanned<String>>,
                $($own)*
                /// What the image shows beyond its edges.
                wrap: Required<Wrap> = r#""repeat""#,
                /// What it shows beyond its lower and upper edge, if that is another thing.
                wrap_v: Optional<Wrap>,
                /// Factors on the texture coordinates: 2 shows the image twice.
                uv_scale: Required<[f64; 2]> = "[1, 1]",
                /// Instead: rows of a matrix that the texture coordinates are multiplied by, which may turn and shear the image.
                uv_matrix: Optional<[[f64; 2]; 2]>,
                /// Added to the texture coordinates after that.
                uv_offset: Required<[f64; 2]> = "[0, 0]",
            } with [Rule::NotBoth("uv_scale", "uv_matrix")]
        }

        impl $name {
            /// Its texels, read as `data` says, laid over texture coordinates.
            fn texture(&self, data: Data, files: &mut Files, reader: &mut Reader<'_>) -> Option<ImageTexture> {
                let laid = Laid {
                    file: self.file.as_ref()?,
                    wrap: self.wrap?,
                    wrap_v: self.wrap_v.clone(),
                    uv_map: uv_map(self.uv_scale, &self.uv_matrix, self.uv_offset, self.at, reader),
                };
                laid.texture(data, files, reader)
            }
        }
    };
}

laid_image! {
    /// An image of an object's opacity over its texture coordinates.
    struct OpacityImageForm {
        /// Which of its channels says the share of light that meets the surface.
        channel: Required<Channel> = r#""auto""#,
        /// How its numbers are to be read.
        encoding: Required<Encoding> = r#""linear""#,
        /// Given, what is below this share is not there, and the rest is all there.
        cutoff: Optional<Share>,
        /// What it shows between the centres of its texels.
        filter: Required<TextureFilter> = r#""bilinear""#,
    }
}

laid_image! {
    /// An image of a number of a material, from 0 to 1, over the texture coordinates of the surface.
    struct NumberImageForm {
        /// Which of its channels says the number.
        channel: Required<Channel> = r#""auto""#,
        /// How its numbers are to be read.
        encoding: Required<Encoding> = r#""linear""#,
        /// Factor on what it says.
        factor: Required<NonNegative> = "1",
        /// What it shows between the centres of its texels.
        filter: Required<TextureFilter> = r#""bilinear""#,
    }
}

laid_image! {
    /// An image of how rough a material is, over the texture coordinates of the surface.
    struct RoughnessImageForm {
        /// Which of its channels says the number.
        channel: Required<Channel> = r#""auto""#,
        /// What the number is, from 0 to 1.
        quantity: Required<RoughnessQuantity> = r#""roughness""#,
        /// How its numbers are to be read.
        encoding: Required<Encoding> = r#""linear""#,
        /// Factor on what it says.
        factor: Required<NonNegative> = "1",
        /// What it shows between the centres of its texels.
        filter: Required<TextureFilter> = r#""bilinear""#,
    }
}

laid_image! {
    /// A normal map: red, green and blue are the normal's parts along u, along v and outward, from −1 (0) to 1 (1).
    struct NormalMapForm {
        /// Factor on the parts along the surface, or one each on red and green; below 0 they point the other way.
        strength: Required<Strength> = "1",
        /// Which way green points.
        bitangent: Required<Bitangent> = r#""along-v""#,
        /// What becomes of light at the horizon of the normals.
        terminator: Required<Terminator> = r#""mirrored""#,
        /// How its numbers are to be read.
        encoding: Required<Encoding> = r#""linear""#,
        /// What it shows between the centres of its texels.
        filter: Required<TextureFilter> = r#""bilinear""#,
    }
}

laid_image! {
    /// A bump map: heights over the surface, which is shaded as if it had them.
    struct BumpMapForm {
        /// Height of white over black, m; below 0 white is deep.
        height_m: Required<f64>,
        /// What becomes of light at the horizon of the normals.
        terminator: Required<Terminator> = r#""mirrored""#,
        /// Which of its channels says the height.
        channel: Required<Channel> = r#""red""#,
        /// How its numbers are to be read.
        encoding: Required<Encoding> = r#""linear""#,
    }
}

/// Factors on red and green of a normal map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strength([f64; 2]);

impl Decode for Strength {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        by_json_type(vec![("number", f64::schema(schema)), ("array", <[f64; 2]>::schema(schema))])
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        Some(Self(match node.elements() {
            Some(_) => <[f64; 2]>::decode(node, reader)?,
            None => [f64::decode(node, reader)?; 2],
        }))
    }
}

crate::keywords!(Bitangent {
    /// The way in which v grows.
    "along-v" => Self::AlongV,
    /// To the left of growing u, seen from outside, whichever way v grows.
    "across-u" => Self::AcrossU,
});

crate::keywords!(Terminator {
    /// What a changed normal sends through the surface is mirrored back, and so is a viewer behind its horizon: no light is lost.
    "mirrored" => Self::Mirrored,
    /// Such light is lost.
    "lost" => Self::Lost,
    /// Such light is lost, and grazing light on changed normals is dimmed.
    "shadowed" => Self::Shadowed,
});

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
    /// The mixture of the three that is as bright.
    "luminance" => Self::Luminance,
    /// The mean of the three.
    "mean" => Self::Mean,
});

/// What the numbers of an image of roughness are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RoughnessQuantity {
    Roughness,
    Alpha,
    AlphaSquared,
}

crate::keywords!(RoughnessQuantity {
    /// √α of the width α.
    "roughness" => Self::Roughness,
    /// The width α itself.
    "alpha" => Self::Alpha,
    /// α².
    "alpha-squared" => Self::AlphaSquared,
});

/// How the numbers of a file are read.
struct Data {
    channel: Channel,
    encoding: Encoding,
    filter: TextureFilter,
}

/// Where an image is laid over texture coordinates.
struct Laid<'f> {
    file: &'f Spanned<String>,
    wrap: Wrap,
    wrap_v: Optional<Wrap>,
    uv_map: Option<UvMap>,
}

impl Laid<'_> {
    fn texture(self, data: Data, files: &mut Files, reader: &mut Reader<'_>) -> Option<ImageTexture> {
        let image = files.data(self.file, data.channel, data.encoding, reader);
        Some(ImageTexture {
            image: image?,
            name: self.file.value.clone(),
            wrap: [self.wrap, self.wrap_v.checked()?.unwrap_or(self.wrap)],
            filter: data.filter,
            uv_map: self.uv_map?,
            factor: [1.0; 3],
        })
    }
}

/// The texture with a factor on its numbers, if they then lie from 0 to 1.
fn from_0_to_1(
    texture: ImageTexture,
    factor: f64,
    file: &Spanned<String>,
    reader: &mut Reader<'_>,
) -> Option<ImageTexture> {
    let outside = |[number, ..]: &[f64; 3]| !(0.0..=1.0).contains(&(number * factor));
    if let Some([number, ..]) = texture.image.linear_texels().find(outside) {
        let times = if factor == 1.0 { String::new() } else { format!(", times {factor},") };
        let message = format!("{}: a texel of {number}{times} is not between 0 and 1", file.value);
        reader.error(Code::OutOfRange, file.at, message);
        return None;
    }
    Some(ImageTexture { factor: [factor; 3], ..texture })
}

/// The opacity image of a form.
pub(super) fn opacity_image(
    form: &OpacityImageForm,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<OpacityImage> {
    let data = Data { channel: form.channel?, encoding: form.encoding?, filter: form.filter? };
    let texture = from_0_to_1(form.texture(data, files, reader)?, 1.0, form.file.as_ref()?, reader)?;
    let cutoff = form.cutoff.clone().checked()?.map(|share| share.0);
    Some(OpacityImage { texture, cutoff })
}

/// The image of a number from 0 to 1 of a form.
pub(super) fn number_image(form: &NumberImageForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<ImageTexture> {
    let data = Data { channel: form.channel?, encoding: form.encoding?, filter: form.filter? };
    from_0_to_1(form.texture(data, files, reader)?, form.factor?.0, form.file.as_ref()?, reader)
}

/// The image of roughnesses of a form.
pub(super) fn roughness_image(
    form: &RoughnessImageForm,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<(ImageTexture, RoughnessQuantity)> {
    let data = Data { channel: form.channel?, encoding: form.encoding?, filter: form.filter? };
    let texture = from_0_to_1(form.texture(data, files, reader)?, form.factor?.0, form.file.as_ref()?, reader)?;
    Some((texture, form.quantity?))
}

/// The normal map of a form.
pub(super) fn normal_map(form: &NormalMapForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<Relief> {
    let data = Data { channel: Channel::All, encoding: form.encoding?, filter: form.filter? };
    let texture = form.texture(data, files, reader)?;
    let (bitangent, terminator) = (form.bitangent?, form.terminator?);
    Some(Relief::Normals { texture, strength: form.strength?.0, bitangent, terminator })
}

/// The bump map of a form.
pub(super) fn bump_map(form: &BumpMapForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<Relief> {
    let data = Data { channel: form.channel?, encoding: form.encoding?, filter: TextureFilter::Bilinear };
    let texture = form.texture(data, files, reader)?;
    Some(Relief::Heights { texture, height_m: form.height_m?, terminator: form.terminator? })
}
