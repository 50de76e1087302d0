//! glTF materials, as far as the format has them.

use std::collections::HashMap;

use etalon_scene::LEAST_ALPHA;
use etalon_scene::{Encoding, Image};
use gltf::image::Source;
use gltf::material::AlphaMode;
use serde_json::{Map, Value, json};

use super::accessor::bytes_of;
use super::clearcoat;
use super::diffuse_transmission;
use super::file::resource;
use super::image::TextureTransform;
use super::iridescence::Iridescence;
use crate::{Builder, light, reflectance};

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
    pub(super) images: HashMap<usize, Option<(String, [f64; 3])>>,
    /// Whether the material at hand makes use of alpha.
    pub(super) alpha_counts: bool,
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
        let emission = self.emission(material, &place, &mut uv_set, buffers, builder);
        let has_image = uv_set.is_some();
        let uv_set = uv_set.unwrap_or(0);
        let name = builder.material_name(material.name().unwrap_or_default());
        builder.materials.insert(name.clone(), value);
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
        let (metallic, roughness) = (surface.metallic_factor(), surface.roughness_factor());
        if let Some(transmission) = material.transmission()
            && transmission.transmission_factor() >= 0.5
        {
            let at = format!("{place}.extensions.KHR_materials_transmission");
            if transmission.transmission_factor() < 1.0 || transmission.transmission_texture().is_some() {
                builder.approximate(&at, "it becomes fully transmitting");
            }
            clearcoat::roughness(material, false, place, builder);
            let interior = index(material, place, builder);
            let mut glass = json!({ "type": "dielectric", "interior": interior });
            let (base, mut uv_set) = self.base_colour(&surface, place, buffers, builder);
            let tinted = base != json!(1.0);
            if tinted {
                glass["transmitted_tint"] = base;
            }
            let numbers = self.numbers(&surface, place, &mut uv_set, buffers, builder);
            let roughness = Number::new(decimal(roughness), "green", numbers.as_ref());
            let anisotropy = Anisotropy::of(material, &roughness, place, builder);
            if !roughness.put_as_roughness(anisotropy.as_ref(), &mut glass) && !tinted {
                uv_set = None;
            }
            if let Some(volume) = material.volume()
                && volume.attenuation_distance().is_finite()
                && volume.attenuation_distance() > 0.0
            {
                // A channel of 0 would need an endless coefficient.
                let colour = volume.attenuation_color().map(|v| decimal(v).clamp(LEAST_TRANSMITTANCE, 1.0));
                glass["transmittance"] = reflectance(colour);
                glass["transmittance_depth_m"] = json!(decimal(volume.attenuation_distance()));
            }
            if let Some(iridescence) = Iridescence::of(material, place, builder) {
                iridescence.put_on_glass(&mut glass, place, builder);
            }
            return (glass, uv_set);
        }
        let (colour, mut uv_set) = self.base_colour(&surface, place, buffers, builder);
        let numbers = self.numbers(&surface, place, &mut uv_set, buffers, builder);
        let roughness = Number::new(decimal(roughness), "green", numbers.as_ref());
        let anisotropy = Anisotropy::of(material, &roughness, place, builder);
        let part = |kind: &str, roughness: &Number| {
            let mut part = json!({ "type": kind, "reflectance": colour });
            roughness.put_as_roughness(anisotropy.as_ref(), &mut part);
            part
        };
        let metallic = Number::new(decimal(metallic), "blue", numbers.as_ref());
        let has_coat = !matches!(metallic, Number::Value(1.0));
        let clear = clearcoat::roughness(material, has_coat, place, builder).map(Number::Value);
        let mut ground = part("plastic", clear.as_ref().unwrap_or(&roughness));
        ground["coat"] = index(material, place, builder);
        // The coat takes away what it reflects, and no more: the base colour is that of the whole.
        ground["internal_reflection"] = json!("uncoloured");
        if material.specular().is_some_and(|specular| specular.specular_factor() == 0.0) || ground["coat"] == json!(1.0)
        {
            ground = json!({ "type": "lambert", "reflectance": colour });
        }
        let ground = diffuse_transmission::over(ground, material, place, builder);
        let iridescence = Iridescence::of(material, place, builder);
        let metal = || {
            let bare = part("conductor", &roughness);
            iridescence.as_ref().map_or(bare.clone(), |iridescence| iridescence.on_metal(bare))
        };
        if iridescence.is_some() && !matches!(metallic, Number::Value(1.0)) {
            let at = format!("{place}.extensions.KHR_materials_iridescence");
            builder.leave_out(at, "what is not metal and transmits no light has no film");
        }
        let value = match metallic {
            Number::Value(0.0) => ground,
            Number::Value(1.0) => metal(),
            Number::Value(share) => json!({ "type": "blend", "first": ground, "second": metal(), "weight": share }),
            Number::Image(image) => {
                json!({ "type": "blend", "first": ground, "second": metal(), "weight_image": image })
            }
        };
        (value, uv_set)
    }

    /// The image of roughness and metalness: as it is laid over a surface, unless it has other texture coordinates than what else is
    /// laid, and its texels.
    fn numbers(
        &mut self,
        surface: &gltf::material::PbrMetallicRoughness<'_>,
        place: &str,
        uv_set: &mut Option<u32>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<(Option<Value>, Image)> {
        let info = surface.metallic_roughness_texture()?;
        let at = format!("{place}.pbrMetallicRoughness.metallicRoughnessTexture");
        let (image, set) = self.image(&info, &at, buffers, builder)?;
        let texels = linear(&info.texture(), buffers, builder)?;
        if *uv_set.get_or_insert(set) != set {
            builder.approximate(at, "it uses another set of texture coordinates than the colour: its mean is used");
            return Some((None, texels));
        }
        Some((Some(data_image(image)), texels))
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
                    .leave_out(at, "it uses another set of texture coordinates than the first image: it is left out");
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
            let transform = map.extension_value("KHR_texture_transform").map(TextureTransform::of_json);
            let image = self
                .laid(&map.texture(), map.tex_coord(), transform, &at, buffers, builder)
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

    fn emission(
        &mut self,
        material: &gltf::Material<'_>,
        place: &str,
        uv_set: &mut Option<u32>,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Option<Value> {
        let mut rgb = material.emissive_factor().map(|v| f64::from(v).max(0.0));
        if rgb == [0.0; 3] {
            return None;
        }
        let strength = f64::from(material.emissive_strength().unwrap_or(1.0)).max(0.0);
        let sides = if material.double_sided() { "both" } else { "front" };
        if let Some(info) = material.emissive_texture() {
            let at = format!("{place}.emissiveTexture");
            let (mut image, set) = self.image(&info, &at, buffers, builder)?;
            let (_, mean) = self.source(&info.texture(), place, buffers, builder)?;
            rgb = std::array::from_fn(|c| rgb[c] * mean[c]);
            if rgb == [0.0; 3] {
                return None;
            }
            if *uv_set.get_or_insert(set) == set {
                image["factor"] = json!(material.emissive_factor().map(|v| f64::from(v).max(0.0) * strength));
                return Some(json!({ "radiance": image, "sides": sides }));
            }
            builder.approximate(
                at,
                "it uses another set of texture coordinates than the first image: its mean is emitted",
            );
        }
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

/// A number of a material.
enum Number {
    Value(f64),
    Image(Value),
}

impl Number {
    /// A factor on a channel of an image, if there is one: an image, where the channel varies and can be laid.
    fn new(factor: f64, channel: &str, numbers: Option<&(Option<Value>, Image)>) -> Self {
        let factor = factor.clamp(0.0, 1.0);
        let Some((laid, image)) = numbers else { return Self::Value(factor) };
        let c = if channel == "green" { 1 } else { 2 };
        let [least, most] = image
            .linear_texels()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], texel| [least.min(texel[c]), most.max(texel[c])]);
        match laid {
            _ if least == most => Self::Value(factor * least.clamp(0.0, 1.0)),
            None => Self::Value(factor * image.mean()[c].clamp(0.0, 1.0)),
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

    /// Says it of a material as its roughness; returns whether by an image.
    fn put_as_roughness(&self, anisotropy: Option<&Anisotropy>, material: &mut Value) -> bool {
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

/// `KHR_materials_anisotropy`: along a direction the width α becomes α + (1 − α)s², s the strength. The direction is that of growing u,
/// turned toward the top of the image.
struct Anisotropy {
    strength: f64,
    rotation_rad: f64,
}

impl Anisotropy {
    fn of(material: &gltf::Material<'_>, roughness: &Number, place: &str, builder: &mut Builder<'_>) -> Option<Self> {
        let value = material.extension_value("KHR_materials_anisotropy")?;
        let number = |key: &str| value[key].as_f64().unwrap_or(0.0);
        let place = format!("{place}.extensions.KHR_materials_anisotropy");
        let strength = number("anisotropyStrength").clamp(0.0, 1.0);
        if strength == 0.0 {
            return None;
        }
        if matches!(roughness, Number::Image(_)) {
            builder.leave_out(place, "it is left out, since an image says the roughness");
            return None;
        }
        if value.get("anisotropyTexture").is_some() {
            builder.leave_out(place, "its image is left out: strength and rotation are the same everywhere");
        }
        Some(Self { strength, rotation_rad: number("anisotropyRotation") })
    }

    fn put(&self, alpha: f64, material: &mut Value) {
        let alpha = alpha.max(LEAST_ALPHA);
        material["alpha_u"] = json!((alpha + (1.0 - alpha) * self.strength * self.strength).min(1.0));
        material["alpha_v"] = json!(alpha);
        if self.rotation_rad != 0.0 {
            material["tangent_rotation_deg"] = json!(self.rotation_rad.to_degrees());
        }
    }
}

/// A texture's texels as numbers; `None` if it cannot be read, which is said where it is drawn.
fn linear(texture: &gltf::Texture<'_>, buffers: &[Vec<u8>], builder: &Builder<'_>) -> Option<Image> {
    let bytes = match texture.source()?.source() {
        Source::View { view, .. } => bytes_of(&view, buffers)?.to_vec(),
        Source::Uri { uri, .. } => resource(uri, builder).ok()?,
    };
    Image::decode(&bytes, Encoding::Linear).ok().map(|(image, _)| image)
}

/// A number as the file writes it, which single precision has rounded.
pub(super) fn decimal(value: f32) -> f64 {
    // Shortest digits that stand for the same number.
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// The width of the distribution of facets: the square of glTF's roughness; below what the format resolves it is smooth.
fn alpha(roughness: f32) -> f64 {
    let alpha = decimal(roughness).clamp(0.0, 1.0).powi(2);
    if alpha < LEAST_ALPHA { 0.0 } else { alpha }
}

/// The index of refraction: a number, or Cauchy's formula where the dispersion is stated.
fn index(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) -> Value {
    let ior = decimal(material.ior().unwrap_or(1.5));
    if ior < 1.0 {
        builder.approximate(format!("{place}.extensions.KHR_materials_ior"), format!("an index of {ior} becomes 1.5"));
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
    let no = "it is ignored";
    list(material.occlusion_texture().is_some(), "occlusionTexture", "it is ignored: shadows are traced");
    list(material.unlit(), "extensions.KHR_materials_unlit", "it is ignored: the surface is lit like any other");
    let specular = material.specular().is_some_and(|specular| {
        ![0.0, 1.0].contains(&specular.specular_factor())
            || specular.specular_texture().is_some()
            || specular.specular_color_factor() != [1.0; 3]
            || specular.specular_color_texture().is_some()
    });
    list(specular, "extensions.KHR_materials_specular", "only the factors 0 and 1 can be converted");
    let opaque = material.transmission().is_none_or(|transmission| transmission.transmission_factor() < 0.5);
    let weak = material.transmission().is_some_and(|transmission| transmission.transmission_factor() > 0.0);
    list(weak && opaque, "extensions.KHR_materials_transmission", "a factor below 0.5 becomes opaque");
    let coloured = material.volume().is_some_and(|volume| volume.attenuation_distance().is_finite());
    list(coloured && opaque, "extensions.KHR_materials_volume", "it is ignored: the material does not transmit light");
    const KNOWN: [&str; 5] = [
        "KHR_materials_anisotropy",
        "KHR_materials_clearcoat",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_dispersion",
        "KHR_materials_iridescence",
    ];
    for key in material.extensions().into_iter().flat_map(|map| map.keys()) {
        list(!KNOWN.contains(&key.as_str()), &format!("extensions.{key}"), no);
    }
}
