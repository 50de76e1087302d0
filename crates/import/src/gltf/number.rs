//! Numbers of materials, which images may vary.

use etalon_scene::{Encoding, Image, LEAST_ALPHA};
use gltf::image::Source;
use serde_json::{Value, json};

use super::accessor::bytes_of;
use super::anisotropy::Anisotropy;
use super::file::resource;
use super::material::{Materials, decimal};
use crate::Builder;

impl Materials<'_> {
    /// The image of roughness and metalness: as it is laid over a surface, unless it has other texture coordinates than what else is
    /// laid, and the ranges of its channels.
    pub(super) fn numbers(
        &mut self,
        surface: &gltf::material::PbrMetallicRoughness<'_>,
        place: &str,
        uv_set: &mut Option<u32>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(Option<Value>, Ranges)> {
        let info = surface.metallic_roughness_texture()?;
        let at = format!("{place}.pbrMetallicRoughness.metallicRoughnessTexture");
        let (image, set) = self.image(&info, &at, buffers, builder)?;
        let ranges = self.ranges(&info.texture(), buffers, builder)?;
        if *uv_set.get_or_insert(set) != set {
            builder.approximate(at, "it uses another set of texture coordinates than the colour: its mean is used");
            return Some((None, ranges));
        }
        Some((Some(data_image(image)), ranges))
    }

    /// The ranges of a texture's channels as numbers; `None` if it cannot be read, which is said where it is drawn.
    fn ranges(&mut self, texture: &gltf::Texture<'_>, buffers: &[Vec<u8>], builder: &Builder<'_>) -> Option<Ranges> {
        let index = texture.source()?.index();
        *self.ranges.entry(index).or_insert_with(|| {
            let bytes = bytes(texture, buffers, builder)?;
            Image::decode(&bytes, Encoding::Linear).ok().map(|(image, _)| Ranges::of(&image))
        })
    }

    /// A factor of an extension, on a channel of its image if it names one.
    pub(super) fn number(
        &mut self,
        (extension, factor, texture): (&Value, &str, &str),
        channel: &str,
        place: &str,
        uv_set: &mut Option<u32>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Number {
        let factor = extension[factor].as_f64().filter(|number| number.is_finite()).unwrap_or(0.0);
        let at = format!("{place}.{texture}");
        let image = match extension.get(texture) {
            Some(info) if factor > 0.0 => self.named(info, &at, buffers, builder),
            _ => None,
        };
        let Some((texture, image, set)) = image else { return Number::new(factor, channel, None) };
        let Some(ranges) = self.ranges(&texture, buffers, builder) else { return Number::new(factor, channel, None) };
        let laid = if *uv_set.get_or_insert(set) == set {
            Some(data_image(image))
        } else {
            builder
                .approximate(at, "it uses another set of texture coordinates than the first image: its mean is used");
            None
        };
        Number::new(factor, channel, Some(&(laid, ranges)))
    }
}

impl Materials<'_> {
    /// A factor on a channel of an image, if there is one that can be laid.
    pub(super) fn factor_on(
        &mut self,
        (factor, info): (f64, Option<gltf::texture::Info<'_>>),
        channel: &str,
        at: &str,
        uv_set: &mut Option<u32>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Number {
        let image = info.filter(|_| factor > 0.0).and_then(|info| self.image(&info, at, buffers, builder));
        let Some((image, set)) = image else { return Number::Value(factor) };
        if *uv_set.get_or_insert(set) != set {
            builder.leave_out(at, "it uses another set of texture coordinates than the first image: it is left out");
            return Number::Value(factor);
        }
        let mut laid = data_image(image);
        laid["channel"] = json!(channel);
        if factor != 1.0 {
            laid["factor"] = json!(factor);
        }
        Number::Image(laid)
    }
}

/// The same image as data: without what is said of colours.
pub(super) fn data_image(mut image: Value) -> Value {
    if let Some(keys) = image.as_object_mut() {
        for key in ["type", "encoding", "factor"] {
            keys.remove(key);
        }
    }
    image
}

/// The range and the mean of each channel of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ranges {
    least: [f64; 3],
    most: [f64; 3],
    mean: [f64; 3],
}

impl Ranges {
    fn of(image: &Image) -> Self {
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for texel in image.linear_texels() {
            for c in 0..3 {
                (least[c], most[c]) = (least[c].min(texel[c]), most[c].max(texel[c]));
            }
        }
        Self { least, most, mean: image.mean() }
    }
}

/// A number of a material.
pub(super) enum Number {
    Value(f64),
    Image(Value),
}

impl Number {
    /// A factor on a channel of an image, if there is one: an image, where the channel varies and can be laid.
    pub(super) fn new(factor: f64, channel: &str, numbers: Option<&(Option<Value>, Ranges)>) -> Self {
        let factor = factor.clamp(0.0, 1.0);
        let Some((laid, ranges)) = numbers else { return Self::Value(factor) };
        let c = ["red", "green", "blue"].iter().position(|name| *name == channel).unwrap_or(0);
        match laid {
            _ if ranges.least[c] == ranges.most[c] => Self::Value(factor * ranges.least[c].clamp(0.0, 1.0)),
            None => Self::Value(factor * ranges.mean[c].clamp(0.0, 1.0)),
            Some(laid) => {
                let mut laid = laid.clone();
                laid["channel"] = json!(channel);
                if factor != 1.0 {
                    laid["factor"] = json!(factor);
                }
                Self::Image(laid)
            }
        }
    }

    /// The same number times a factor up to 1.
    pub(super) fn times(&self, factor: f64) -> Self {
        match self {
            Self::Value(value) => Self::Value(factor * value),
            Self::Image(image) => {
                let mut image = image.clone();
                image["factor"] = json!(factor * image["factor"].as_f64().unwrap_or(1.0));
                Self::Image(image)
            }
        }
    }

    /// A material of which the number is the share of a second.
    pub(super) fn mixed(&self, first: Value, second: Value) -> Value {
        let mut blend = json!({ "type": "blend" });
        match self {
            Self::Value(0.0) => return first,
            Self::Value(1.0) => return second,
            Self::Value(share) => blend["weight"] = json!(share),
            Self::Image(image) => blend["weight_image"] = image.clone(),
        }
        (blend["first"], blend["second"]) = (first, second);
        blend
    }

    /// Says it of a material as its roughness; returns whether by an image.
    pub(super) fn put_as_roughness(&self, anisotropy: Option<&Anisotropy>, material: &mut Value) -> bool {
        match self {
            Self::Value(roughness) => {
                let alpha = alpha(*roughness as f32);
                match anisotropy {
                    Some(anisotropy) => anisotropy.put(alpha, material),
                    None => material["alpha"] = json!(alpha),
                }
            }
            Self::Image(image) => material["roughness_image"] = image.clone(),
        }
        matches!(self, Self::Image(_))
    }
}

/// The bytes of a texture's file.
pub(super) fn bytes(texture: &gltf::Texture<'_>, buffers: &[Vec<u8>], builder: &Builder<'_>) -> Option<Vec<u8>> {
    match texture.source()?.source() {
        Source::View { view, .. } => bytes_of(&view, buffers).map(<[u8]>::to_vec),
        Source::Uri { uri, .. } => resource(uri, builder).ok(),
    }
}

/// The width of the distribution of facets: the square of glTF's roughness; below what the format resolves it is smooth.
fn alpha(roughness: f32) -> f64 {
    let alpha = decimal(roughness).clamp(0.0, 1.0).powi(2);
    if alpha < LEAST_ALPHA { 0.0 } else { alpha }
}
