//! Images of glTF.

use etalon_scene::{Encoding, Image};
use gltf::image::Source;
use gltf::texture::WrappingMode;
use serde_json::{Value, json};

use super::accessor::bytes_of;
use super::file::resource;
use super::material::Materials;
use crate::Builder;

impl Materials {
    /// The image of the format that a texture becomes, and its set of texture coordinates.
    pub(super) fn image(
        &mut self,
        info: &gltf::texture::Info<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(Value, u32)> {
        self.laid(&info.texture(), info.tex_coord(), info.texture_transform(), place, buffers, builder)
    }

    pub(super) fn laid(
        &mut self,
        texture: &gltf::Texture<'_>,
        mut set: u32,
        transform: Option<gltf::texture::TextureTransform<'_>>,
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
            let at = format!("{place}.extensions.KHR_texture_transform");
            set = transform.tex_coord().unwrap_or(set);
            if transform.rotation() != 0.0 {
                builder.leave_out(at, "the rotation is ignored");
            }
            let ([su, sv], [ou, ov]) = (transform.scale().map(f64::from), transform.offset().map(f64::from));
            image["uv_scale"] = json!([su, sv]);
            // glTF counts v from the top: 1 − (sv·(1 − v) + ov).
            image["uv_offset"] = json!([ou, 1.0 - sv - ov]);
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
                builder.leave_out(place, "its image is of an unknown kind");
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
                builder.leave_out(&place, format!("it is left out: {why}"));
                None
            }
        };
        self.images.insert(image.index(), added.clone());
        added
    }
}
