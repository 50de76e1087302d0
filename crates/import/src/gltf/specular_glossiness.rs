//! `KHR_materials_pbrSpecularGlossiness`: a diffuse colour, a specular colour and a glossiness, instead of the surface that glTF itself describes.
//!
//! A diffuse base under a coat that reflects the specular colour head-on is used, as in the conversions to today's glTF: the coat takes
//! away what it reflects. Without a diffuse colour it is a metal.

use etalon_scene::{Channel, Encoding, Image};
use serde_json::{Value, json};

use super::extensions::is_read;
use super::material::{Materials, Opacity};
use super::number::{Number, bytes};
use crate::{Builder, reflectance};

const NAME: &str = "KHR_materials_pbrSpecularGlossiness";
/// Extensions that count beside it, or are listed in any case.
const BESIDE: [&str; 3] = [NAME, "KHR_materials_emissive_strength", "KHR_materials_unlit"];
/// The most that a coat reflects head-on.
const MOST_HEAD_ON: f64 = 0.9;

impl Materials<'_> {
    /// The material of the format, and the set of texture coordinates of its image; `None` without the extension.
    pub(super) fn specular_glossiness(
        &mut self,
        material: &gltf::Material<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(Value, Option<u32>)> {
        let stated = material.extension_value(NAME)?;
        self.list_beside(material, place, builder);
        let at = format!("{place}.extensions.{NAME}");
        let factor = |value: &Value| value.as_f64().map_or(1.0, |v| v.clamp(0.0, 1.0));
        let triple = |key: &str| [0, 1, 2].map(|c| factor(&stated[key][c]));
        let diffuse = triple("diffuseFactor");
        let image = stated.get("diffuseTexture").filter(|_| diffuse != [0.0; 3]);
        let image = image.and_then(|info| self.named(info, &format!("{at}.diffuseTexture"), buffers, builder));
        let (colour, uv_set) = match image {
            Some((_, mut image, set)) => {
                if diffuse != [1.0; 3] {
                    image["factor"] = json!(diffuse);
                }
                (image, Some(set))
            }
            None => (reflectance(diffuse), None),
        };
        let mut specular = triple("specularFactor");
        let mut glossiness = factor(&stated["glossinessFactor"]);
        if let Some(info) = stated.get("specularGlossinessTexture") {
            let at = format!("{at}.specularGlossinessTexture");
            let texture = self.texture(info, &at, builder);
            match texture.and_then(|texture| self.means(&texture, buffers, builder)) {
                Some((mean, alpha)) => {
                    specular = [0, 1, 2].map(|c| specular[c] * mean[c]);
                    glossiness *= alpha;
                    builder.approximate(at, "its mean is used");
                }
                None => builder.leave_out(at, "it cannot be read: the factors alone count"),
            }
        }
        let roughness = Number::Value(1.0 - glossiness);
        let strongest = specular.into_iter().fold(0.0, f64::max);
        let mut value = json!({ "reflectance": colour });
        if diffuse == [0.0; 3] {
            value["type"] = json!("conductor");
            value["reflectance"] = reflectance(specular);
            builder.approximate(at, "it has no diffuse colour: a metal of its specular colour is used");
        } else if strongest == 0.0 {
            value["type"] = json!("lambert");
            let what = "it reflects nothing head-on: a diffuse surface is used, which reflects nothing at grazing angles either";
            builder.approximate(at, what);
            return Some((value, uv_set));
        } else {
            let root = strongest.min(MOST_HEAD_ON).sqrt();
            value["type"] = json!("plastic");
            value["coat"] = json!((1.0 + root) / (1.0 - root));
            value["internal_reflection"] = json!("uncoloured");
            if specular != [strongest; 3] {
                value["reflected_tint"] = reflectance(specular.map(|channel| channel / strongest));
            }
            let what = format!("a diffuse base under a coat that reflects {:.3} head-on is used", root * root);
            builder.approximate(at, what);
        }
        roughness.put_as_roughness(None, &mut value);
        Some((value, uv_set))
    }

    /// Lists the extensions of a material that are read, but not beside this one.
    fn list_beside(&self, material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
        let stated = material.index().and_then(|i| self.document.as_json().materials.get(i)?.extensions.as_ref());
        let stated = stated.and_then(|stated| serde_json::to_value(stated).ok());
        for name in stated.iter().filter_map(Value::as_object).flat_map(|stated| stated.keys()) {
            if name.starts_with("KHR_materials_") && is_read(name) && !BESIDE.contains(&name.as_str()) {
                builder.leave_out(format!("{place}.extensions.{name}"), format!("it is ignored beside {NAME}"));
            }
        }
    }

    /// The mean colour of an image, and the mean of its alpha: 1 if it has none.
    pub(super) fn means(
        &mut self,
        texture: &gltf::Texture<'_>,
        buffers: &[Vec<u8>],
        builder: &Builder<'_>,
    ) -> Option<([f64; 3], f64)> {
        let index = texture.source()?.index();
        *self.means.entry(index).or_insert_with(|| {
            let bytes = bytes(texture, buffers, builder)?;
            let (colours, _) = Image::decode(&bytes, Encoding::Srgb).ok()?;
            let alpha = Image::decode_data(&bytes, Channel::Alpha, Encoding::Linear).ok()?;
            Some((colours.mean(), alpha.mean()[0]))
        })
    }

    /// The opacity that it states; `None` without the extension.
    pub(super) fn diffuse_alpha(
        &mut self,
        material: &gltf::Material<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<Opacity> {
        let stated = material.extension_value(NAME)?;
        let place = format!("{place}.extensions.{NAME}.diffuseTexture");
        let image = stated.get("diffuseTexture").and_then(|info| self.named(info, &place, buffers, builder));
        let factor = stated["diffuseFactor"][3].as_f64().unwrap_or(1.0);
        Some(Opacity { factor, image: image.map(|(_, image, set)| (image, set)), place })
    }
}
