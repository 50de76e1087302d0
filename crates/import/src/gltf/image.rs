//! Images of glTF.

use etalon_scene::{Encoding, Image, UvMap};
use gltf::image::Source;
use gltf::texture::WrappingMode;
use serde_json::{Value, json};

use super::accessor::bytes_of;
use super::extensions::unread_image;
use super::file::resource;
use super::material::{Materials, decimal};
use crate::{Builder, uv};

/// `KHR_texture_transform`: texture coordinates, v from above, are scaled, turned and moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextureTransform {
    scale: [f64; 2],
    rotation_rad: f64,
    offset: [f64; 2],
    tex_coord: Option<u32>,
}

impl TextureTransform {
    fn of(transform: &gltf::texture::TextureTransform<'_>) -> Self {
        Self {
            scale: transform.scale().map(decimal),
            rotation_rad: decimal(transform.rotation()),
            offset: transform.offset().map(decimal),
            tex_coord: transform.tex_coord(),
        }
    }

    /// That of an extension which the library does not read. What is not stated, or not as it should be, is as if there were none.
    pub(super) fn of_json(value: &Value) -> Self {
        let number = |value: &Value| value.as_f64().filter(|number| number.is_finite());
        let pair = |key: &str| Some([number(&value[key][0])?, number(&value[key][1])?]);
        Self {
            scale: pair("scale").unwrap_or([1.0; 2]),
            rotation_rad: number(&value["rotation"]).unwrap_or(0.0),
            offset: pair("offset").unwrap_or([0.0; 2]),
            tex_coord: value["texCoord"].as_u64().and_then(|set| u32::try_from(set).ok()),
        }
    }

    /// Counter-clockwise as the coordinates lie on the image, whose v points down: (u, v) goes to (u cos + v sin, −u sin + v cos).
    fn uv_map(&self) -> UvMap {
        let ([su, sv], (sin, cos)) = (self.scale, self.rotation_rad.sin_cos());
        UvMap { matrix: [[su * cos, sv * sin], [-su * sin, sv * cos]], offset: self.offset }
    }
}

impl<'d> Materials<'d> {
    /// The image that an extension names which the library does not read: its texture, what it becomes, and its set of texture coordinates.
    pub(super) fn named(
        &mut self,
        info: &Value,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(gltf::Texture<'d>, Value, u32)> {
        let texture = self.texture(info, place, builder)?;
        let set = info["texCoord"].as_u64().and_then(|set| u32::try_from(set).ok()).unwrap_or(0);
        let transform = info["extensions"].get("KHR_texture_transform").map(TextureTransform::of_json);
        let (image, set) = self.laid(&texture, set, transform, place, buffers, builder)?;
        Some((texture, image, set))
    }

    /// The texture that such an extension names.
    pub(super) fn texture(&self, info: &Value, place: &str, builder: &mut Builder<'_>) -> Option<gltf::Texture<'d>> {
        let index = info["index"].as_u64().and_then(|index| usize::try_from(index).ok());
        let texture = index.and_then(|index| self.document.textures().nth(index));
        if texture.is_none() {
            builder.leave_out(place, format!("it names the texture {}, which does not exist", info["index"]));
        }
        texture
    }

    /// The image of the format that a texture becomes, and its set of texture coordinates.
    pub(super) fn image(
        &mut self,
        info: &gltf::texture::Info<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(Value, u32)> {
        let transform = info.texture_transform().as_ref().map(TextureTransform::of);
        self.laid(&info.texture(), info.tex_coord(), transform, place, buffers, builder)
    }

    pub(super) fn laid(
        &mut self,
        texture: &gltf::Texture<'_>,
        mut set: u32,
        transform: Option<TextureTransform>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(Value, u32)> {
        let (file, _) = self.source(texture, place, buffers, builder)?;
        let word = |mode: WrappingMode| match mode {
            WrappingMode::ClampToEdge => "clamp",
            WrappingMode::MirroredRepeat => "mirror",
            WrappingMode::Repeat => "repeat",
        };
        let sampler = texture.sampler();
        let mut image = json!({ "type": "image", "file": file, "encoding": "srgb", "wrap": word(sampler.wrap_s()) });
        if sampler.wrap_t() != sampler.wrap_s() {
            image["wrap_v"] = json!(word(sampler.wrap_t()));
        }
        if sampler.mag_filter() == Some(gltf::texture::MagFilter::Nearest) {
            image["filter"] = json!("nearest");
        }
        if let Some(transform) = transform {
            set = transform.tex_coord.unwrap_or(set);
            // Both the image and the surface have v from above there.
            let uv_map = uv::over_v_from_above(&uv::from_above(&transform.uv_map()));
            image.as_object_mut().into_iter().for_each(|keys| uv::put(&uv_map, keys));
        }
        Some((image, set))
    }

    /// The file of a texture's image.
    pub(super) fn source(
        &mut self,
        texture: &gltf::Texture<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(String, [f64; 3])> {
        match texture.source() {
            Some(image) => self.file(&image, buffers, builder),
            None => {
                builder.leave_out(place, unread_image(texture));
                None
            }
        }
    }

    /// The file of an image in the scene, and the mean of its texels; `None`, and a note, if it cannot be read.
    fn file(
        &mut self,
        image: &gltf::Image<'_>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(String, [f64; 3])> {
        if let Some(known) = self.images.get(&image.index()) {
            return known.clone();
        }
        let bytes = match image.source() {
            Source::View { view, .. } => bytes_of(&view, buffers)
                .map(<[u8]>::to_vec)
                .ok_or_else(|| "its buffer view leaves the buffer".to_owned()),
            Source::Uri { uri, .. } => resource(uri, builder),
        };
        let place = format!("$.images[{}]", image.index());
        let added = match bytes.and_then(|bytes| Image::decode(&bytes, Encoding::Srgb).map(|decoded| (bytes, decoded)))
        {
            Ok((bytes, (decoded, left_out))) => {
                if let Some(what) = left_out.filter(|_| !self.alpha_counts) {
                    builder.leave_out(&place, what);
                }
                let extension = if bytes.starts_with(b"\x89PNG") { "png" } else { "jpg" };
                Some((builder.add_file("image", extension, bytes), decoded.mean()))
            }
            Err(why) => {
                builder.leave_out(&place, format!("it is left out: {why} (PNG and JPEG are read)"));
                None
            }
        };
        self.images.insert(image.index(), added.clone());
        added
    }
}
