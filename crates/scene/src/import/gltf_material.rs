//! glTF materials, as far as the format has them.

use std::collections::HashMap;

use gltf::image::Source;
use gltf::material::AlphaMode;
use gltf::texture::WrappingMode;
use serde_json::{Map, Value, json};

use super::accessor::bytes_of;
use super::gltf::resource;
use super::{Builder, light, reflectance};
use crate::model::LEAST_ALPHA;
use crate::texture::{Encoding, Image};
use etalon_optics::spectrum::RgbBasis;

/// The brightest metal: an index of refraction alone never reflects all.
const BRIGHTEST: f64 = 0.999;
/// The least share of light that a medium of an imported model lets through.
const LEAST_TRANSMITTANCE: f64 = 1e-4;
/// Wavelengths of the hydrogen lines F and C and the helium line d, µm, at which dispersion is stated.
const LINES_UM: [f64; 3] = [0.4861327, 0.6562725, 0.5875618];

/// What a material becomes.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// Its name among the scene's materials.
    pub material: Value,
    pub emission: Option<Value>,
    /// Keys of the objects made of it: opacity, normals.
    pub detail: Map<String, Value>,
    /// Which texture coordinates its image uses.
    pub uv_set: u32,
    pub has_image: bool,
}

/// The materials met so far.
#[derive(Debug, Default)]
pub(super) struct Materials {
    known: HashMap<Option<usize>, Look>,
    images: HashMap<usize, Option<(String, [f64; 3])>>,
    /// Whether the material at hand makes use of alpha.
    alpha_counts: bool,
}

impl Materials {
    pub(super) fn of(
        &mut self,
        material: &gltf::Material<'_>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Result<Look, String> {
        if let Some(look) = self.known.get(&material.index()) {
            return Ok(look.clone());
        }
        let place = material.index().map_or("the default material".to_owned(), |i| format!("$.materials[{i}]"));
        self.alpha_counts = material.alpha_mode() != AlphaMode::Opaque;
        let (value, mut uv_set) = self.value(material, &place, buffers, builder);
        let detail = self.detail(material, &place, &mut uv_set, buffers, builder);
        let has_image = value["reflectance"]["type"] == "image"
            || ["opacity_image", "normal_map"].iter().any(|key| detail.contains_key(*key));
        let uv_set = uv_set.unwrap_or(0);
        let name = builder.material_name(material.name().unwrap_or_default());
        builder.materials.insert(name.clone(), value);
        let emission = self.emission(material, &place, buffers, builder);
        let look = Look { material: json!(name), emission, detail, uv_set, has_image };
        self.known.insert(material.index(), look.clone());
        Ok(look)
    }

    fn value(
        &mut self,
        material: &gltf::Material<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> (Value, Option<u32>) {
        let surface = material.pbr_metallic_roughness();
        list_unhonoured(material, place, builder);
        let [r, g, b, _] = surface.base_color_factor().map(decimal);
        let base = [r, g, b].map(|v| v.clamp(0.0, 1.0));
        let (mut metallic, mut roughness) = (surface.metallic_factor(), surface.roughness_factor());
        if let Some(info) = surface.metallic_roughness_texture() {
            let at = format!("{place}.pbrMetallicRoughness.metallicRoughnessTexture");
            builder.leave_out(at, "every place has the mean of the image");
            if let Some([_, green, blue]) = linear_mean(&info.texture(), buffers, builder) {
                (roughness, metallic) = (roughness * green as f32, metallic * blue as f32);
            }
        }
        if let Some(transmission) = material.transmission()
            && transmission.transmission_factor() >= 0.5
        {
            let at = format!("{place}.extensions.KHR_materials_transmission");
            if transmission.transmission_factor() < 1.0 || transmission.transmission_texture().is_some() {
                builder.leave_out(&at, "it is taken for fully transmitting");
            }
            if base != [1.0; 3] || surface.base_color_texture().is_some() {
                builder.leave_out(format!("{place}.pbrMetallicRoughness"), "clear glass has no base colour");
            }
            let interior = index(material, place, builder);
            let mut glass = json!({ "type": "dielectric", "interior": interior, "alpha": alpha(roughness) });
            if let Some(volume) = material.volume()
                && volume.attenuation_distance().is_finite()
                && volume.attenuation_distance() > 0.0
            {
                // A channel of 0 would need an endless coefficient.
                let colour = volume.attenuation_color().map(|v| decimal(v).clamp(LEAST_TRANSMITTANCE, 1.0));
                glass["transmittance"] = reflectance(colour);
                glass["transmittance_depth_m"] = json!(decimal(volume.attenuation_distance()));
            }
            return (glass, None);
        }
        let at = format!("{place}.pbrMetallicRoughness");
        if metallic >= 0.5 {
            if metallic < 1.0 {
                builder.leave_out(&at, format!("metal by a share of {metallic} is taken for metal"));
            }
            let mut colour = base;
            if let Some(info) = surface.base_color_texture() {
                builder.leave_out(format!("{at}.baseColorTexture"), "metal has the mean of the image everywhere");
                let mean = self.source(&info.texture(), &at, buffers, builder).map_or([1.0; 3], |(_, mean)| mean);
                colour = std::array::from_fn(|c| base[c] * mean[c]);
            }
            return (metal(colour, alpha(roughness)), None);
        }
        builder.leave_out(&at, "it is taken for diffuse, without the reflection at its surface");
        let texture = surface.base_color_texture();
        let image = texture.and_then(|info| self.image(&info, &format!("{at}.baseColorTexture"), buffers, builder));
        match image {
            Some((mut image, set)) => {
                if base != [1.0; 3] {
                    image["factor"] = json!(base);
                }
                (json!({ "type": "lambert", "reflectance": image }), Some(set))
            }
            None => (json!({ "type": "lambert", "reflectance": reflectance(base) }), None),
        }
    }

    /// Opacity and normals, which are the objects' in the format. All images of a material share one set of texture
    /// coordinates, `uv_set`, that of the first.
    fn detail(
        &mut self,
        material: &gltf::Material<'_>,
        place: &str,
        uv_set: &mut Option<u32>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Map<String, Value> {
        let mut detail = Map::new();
        let mut fits = |set: u32, at: &str, builder: &mut Builder<'_>| {
            let fits = *uv_set.get_or_insert(set) == set;
            if !fits {
                builder
                    .leave_out(at, "it uses another set of texture coordinates than the first image, and is left out");
            }
            fits
        };
        let surface = material.pbr_metallic_roughness();
        let [.., factor] = surface.base_color_factor().map(decimal);
        let cutoff = (material.alpha_mode() == AlphaMode::Mask)
            .then(|| material.alpha_cutoff().map_or(0.5, decimal).clamp(0.0, 1.0));
        if material.alpha_mode() != AlphaMode::Opaque {
            let at = format!("{place}.pbrMetallicRoughness.baseColorTexture");
            let image = surface
                .base_color_texture()
                .and_then(|info| self.image(&info, &at, buffers, builder))
                .filter(|(_, set)| fits(*set, &at, builder));
            match (image, cutoff) {
                (Some((image, _)), cutoff) => {
                    let mut opacity = data_image(image);
                    opacity["channel"] = json!("alpha");
                    if let Some(cutoff) = cutoff {
                        // The factor counts before the cutoff.
                        opacity["cutoff"] = json!((cutoff / factor.max(f64::MIN_POSITIVE)).min(1.0));
                        if cutoff > factor {
                            detail.insert("opacity".to_owned(), json!(0));
                        }
                    } else if factor < 1.0 {
                        detail.insert("opacity".to_owned(), json!(factor.clamp(0.0, 1.0)));
                    }
                    detail.insert("opacity_image".to_owned(), opacity);
                }
                (None, Some(cutoff)) if factor < cutoff => {
                    detail.insert("opacity".to_owned(), json!(0));
                }
                (None, None) if factor < 1.0 => {
                    detail.insert("opacity".to_owned(), json!(factor.clamp(0.0, 1.0)));
                }
                (None, _) => {}
            }
        }
        if let Some(map) = material.normal_texture() {
            let at = format!("{place}.normalTexture");
            let image = self
                .laid(&map.texture(), map.tex_coord(), None, &at, buffers, builder)
                .filter(|(_, set)| fits(*set, &at, builder));
            if let Some((image, _)) = image {
                let mut normals = data_image(image);
                normals.as_object_mut().map(|keys| keys.remove("filter"));
                normals["strength"] = json!(decimal(map.scale()).max(0.0));
                detail.insert("normal_map".to_owned(), normals);
            }
        }
        detail
    }

    /// The image of the format that a texture becomes, and its set of texture coordinates.
    fn image(
        &mut self,
        info: &gltf::texture::Info<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(Value, u32)> {
        self.laid(&info.texture(), info.tex_coord(), info.texture_transform(), place, buffers, builder)
    }

    fn laid(
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
                builder.leave_out(at, "the rotation is not honoured");
            }
            let ([su, sv], [ou, ov]) = (transform.scale().map(f64::from), transform.offset().map(f64::from));
            image["uv_scale"] = json!([su, sv]);
            // glTF counts v from the top: 1 − (sv·(1 − v) + ov).
            image["uv_offset"] = json!([ou, 1.0 - sv - ov]);
        }
        Some((image, set))
    }

    /// The file of a texture's image.
    fn source(
        &mut self,
        texture: &gltf::Texture<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(String, [f64; 3])> {
        match texture.source() {
            Some(image) => self.file(&image, buffers, builder),
            None => {
                builder.leave_out(place, "its image is of a kind that is not read");
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

    fn emission(
        &mut self,
        material: &gltf::Material<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<Value> {
        let mut rgb = material.emissive_factor().map(|v| f64::from(v).max(0.0));
        if rgb == [0.0; 3] {
            return None;
        }
        if let Some(info) = material.emissive_texture() {
            let at = format!("{place}.emissiveTexture");
            builder.leave_out(at, "every place shines with the mean of the image");
            let (_, mean) = self.source(&info.texture(), place, buffers, builder)?;
            rgb = std::array::from_fn(|c| rgb[c] * mean[c]);
        }
        if rgb == [0.0; 3] {
            return None;
        }
        let strength = f64::from(material.emissive_strength().unwrap_or(1.0)).max(0.0);
        let sides = if material.double_sided() { "both" } else { "front" };
        Some(json!({ "radiance": light(rgb, strength), "sides": sides }))
    }
}

/// The same image as data: without what is said of colours.
fn data_image(mut image: Value) -> Value {
    if let Some(keys) = image.as_object_mut() {
        for key in ["type", "encoding", "factor"] {
            keys.remove(key);
        }
    }
    image
}

/// The mean of a texture's texels as numbers; `None` if it cannot be read, which is said where it is drawn.
fn linear_mean(texture: &gltf::Texture<'_>, buffers: &[Vec<u8>], builder: &Builder<'_>) -> Option<[f64; 3]> {
    let bytes = match texture.source()?.source() {
        Source::View { view, .. } => bytes_of(&view, buffers)?.to_vec(),
        Source::Uri { uri, .. } => resource(uri, builder).ok()?,
    };
    Image::decode(&bytes, Encoding::Linear).ok().map(|(image, _)| image.mean())
}

/// A number as the file writes it, which single precision has rounded.
fn decimal(value: f32) -> f64 {
    // Shortest digits that stand for the same number.
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// The width of the distribution of facets: the square of glTF's roughness; below what the format resolves it is smooth.
fn alpha(roughness: f32) -> f64 {
    let alpha = decimal(roughness).clamp(0.0, 1.0).powi(2);
    if alpha < LEAST_ALPHA { 0.0 } else { alpha }
}

/// Metal that reflects a colour head-on: the index n = (1 + √R)/(1 − √R) at each wavelength, without absorption, does.
fn metal(rgb: [f64; 3], alpha: f64) -> Value {
    let wavelengths: Vec<u32> = (360..=830).step_by(10).collect();
    let basis = RgbBasis::get();
    let index = |nm: &u32| {
        let root = basis.reflectance(rgb, f64::from(*nm)).clamp(0.0, BRIGHTEST).sqrt();
        (1.0 + root) / (1.0 - root)
    };
    let n: Vec<f64> = wavelengths.iter().map(index).collect();
    let k = vec![0.0; n.len()];
    json!({
        "type": "conductor", "wavelengths_nm": wavelengths, "n": n, "k": k, "alpha": alpha, "outside_fit": "clamp"
    })
}

/// The index of refraction: a number, or Cauchy's formula where the dispersion is stated.
fn index(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) -> Value {
    let ior = decimal(material.ior().unwrap_or(1.5));
    if ior < 1.0 {
        builder
            .leave_out(format!("{place}.extensions.KHR_materials_ior"), format!("an index of {ior} is taken for 1.5"));
        return json!(1.5);
    }
    // 20/V, V the Abbe number (n_d − 1)/(n_F − n_C).
    let dispersion = material.extension_value("KHR_materials_dispersion");
    let dispersion = dispersion.and_then(|value| value["dispersion"].as_f64()).filter(|d| *d > 0.0);
    let Some(dispersion) = dispersion else { return json!(ior) };
    let [f, c, d] = LINES_UM.map(|um| 1.0 / (um * um));
    let b_um2 = (ior - 1.0) * dispersion / 20.0 / (f - c);
    json!({ "type": "cauchy", "a": ior - b_um2 * d, "b_um2": b_um2, "range_nm": [300, 1100] })
}

fn list_unhonoured(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    let mut list = |there: bool, key: &str, what: &str| {
        if there {
            builder.leave_out(format!("{place}.{key}"), what);
        }
    };
    let no = "it is not honoured";
    list(material.occlusion_texture().is_some(), "occlusionTexture", "it is not needed: shadows are traced");
    list(material.unlit(), "extensions.KHR_materials_unlit", "it is lit like any other");
    list(material.specular().is_some(), "extensions.KHR_materials_specular", no);
    let opaque = material.transmission().is_none_or(|transmission| transmission.transmission_factor() < 0.5);
    let coloured = material.volume().is_some_and(|volume| volume.attenuation_distance().is_finite());
    list(coloured && opaque, "extensions.KHR_materials_volume", "it is not transmitting: nothing is absorbed inside");
    const KNOWN: [&str; 1] = ["KHR_materials_dispersion"];
    for key in material.extensions().into_iter().flat_map(|map| map.keys()) {
        list(!KNOWN.contains(&key.as_str()), &format!("extensions.{key}"), no);
    }
}
