//! glTF materials, as far as the format has them.

use std::collections::{HashMap, HashSet};

use gltf::material::AlphaMode;
use serde_json::{Map, Value, json};

use super::anisotropy::Anisotropy;
use super::clearcoat::ClearCoat;
use super::diffuse_transmission;
use super::extensions;
use super::image::TextureTransform;
use super::iridescence::Iridescence;
use super::number::{Number, Ranges, data_image};
use super::sheen::Fit;
use super::specular::Specular;
use super::transmission::{self, Passes};
use super::volume;
use crate::{Builder, light};

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

/// How much of the light meets a surface.
pub(super) struct Opacity {
    pub factor: f64,
    /// An image whose alpha is multiplied by the factor, and its set of texture coordinates.
    pub image: Option<(Value, u32)>,
    /// Where the image is stated.
    pub place: String,
}

/// The materials met so far.
#[derive(Debug)]
pub(super) struct Materials<'d> {
    pub(super) document: &'d gltf::Document,
    /// What stands for sheen, by a hundred times its roughness.
    pub(super) fits: HashMap<u32, Fit>,
    known: HashMap<Option<usize>, Look>,
    pub(super) images: HashMap<usize, Option<(String, [f64; 3])>>,
    /// By image; `None` is one that cannot be read.
    pub(super) ranges: HashMap<usize, Option<Ranges>>,
    /// By image: its mean colour and the mean of its alpha; `None` is one that cannot be read.
    pub(super) means: HashMap<usize, Option<([f64; 3], f64)>>,
    /// Those of triangles that glTF shows from their front only.
    pub(super) single_sided: HashSet<Option<usize>>,
    /// Whether the material at hand makes use of alpha.
    pub(super) alpha_counts: bool,
}

impl<'d> Materials<'d> {
    pub(super) fn new(document: &'d gltf::Document) -> Self {
        Self {
            document,
            fits: HashMap::new(),
            known: HashMap::new(),
            images: HashMap::new(),
            ranges: HashMap::new(),
            means: HashMap::new(),
            single_sided: HashSet::new(),
            alpha_counts: false,
        }
    }

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
        list_unhonoured(material, &place, builder);
        extensions::list_undeclared(material, &self.document.as_json().extensions_used, &place, builder);
        self.alpha_counts = material.alpha_mode() != AlphaMode::Opaque;
        let (value, mut uv_set) = match self.specular_glossiness(material, &place, buffers, builder) {
            Some(made) => made,
            None => self.value(material, &place, buffers, builder),
        };
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
        let (colour, mut uv_set) = self.base_colour(&surface, place, buffers, builder);
        let numbers = self.numbers(&surface, place, &mut uv_set, buffers, builder);
        let roughness = Number::new(decimal(surface.roughness_factor()), "green", numbers.as_ref());
        let metallic = Number::new(decimal(surface.metallic_factor()), "blue", numbers.as_ref());
        let is_metal = matches!(metallic, Number::Value(1.0));
        let passes = match is_metal {
            // What goes into metal is absorbed.
            true => Passes::Nothing,
            false => Passes::of(material, self, &roughness, &mut uv_set, (place, buffers), builder),
        };
        match &passes {
            Passes::Solid => {
                let (glass, has_image) = transmission::solid(material, colour, (&roughness, &metallic), place, builder);
                return (glass, uv_set.filter(|_| has_image));
            }
            Passes::ThinWall(Number::Value(1.0)) if matches!(metallic, Number::Value(0.0)) => {
                transmission::list_layers(material, place, builder);
                return (transmission::pane(material, &colour, place, builder), uv_set);
            }
            _ => {}
        }
        let anisotropy = Anisotropy::of(material, &roughness, place, builder);
        let part = |kind: &str, roughness: &Number| {
            let mut part = json!({ "type": kind, "reflectance": colour });
            roughness.put_as_roughness(anisotropy.as_ref(), &mut part);
            part
        };
        let specular = Specular::of(material, self, &mut uv_set, place, buffers, builder);
        let mut ground = json!({ "type": "lambert", "reflectance": colour });
        let own = specular.coat(material, place, builder);
        if let Some(own) = &own {
            let mut coated = part("plastic", &roughness);
            coated["coat"] = own.clone();
            // The coat takes away what it reflects, and no more: the base colour is that of the whole.
            coated["internal_reflection"] = json!("uncoloured");
            ground = specular.over(ground, coated, place, builder);
        }
        let clear = ClearCoat::of(material, self, &mut uv_set, place, buffers, builder);
        if let Some(clear) = clear.as_ref().filter(|_| !is_metal) {
            let own = own.as_ref().map(|own| own.as_f64().unwrap_or(decimal(material.ior().unwrap_or(1.5))));
            ground = clear.over_ground(ground, &colour, own, place, builder);
        }
        let mut ground = diffuse_transmission::over(ground, material, place, builder);
        if let Passes::ThinWall(share) = &passes {
            if clear.is_some() {
                let what = "it covers only the share of the surface that does not pass light";
                builder.approximate(format!("{place}.extensions.KHR_materials_clearcoat"), what);
            }
            ground = share.mixed(ground, transmission::pane(material, &colour, place, builder));
        }
        let iridescence = Iridescence::of(material, place, builder);
        let metal = |builder: &mut Builder<'_>| {
            let bare = part("conductor", &roughness);
            let metal = match &iridescence {
                Some(iridescence) => iridescence.on_metal(bare, &colour, place, builder),
                None => bare,
            };
            clear.as_ref().map_or(metal.clone(), |clear| clear.over_metal(metal))
        };
        if let Some(clear) = clear.as_ref().filter(|_| !matches!(metallic, Number::Value(0.0))) {
            clear.list_on_metal(place, builder);
        }
        if iridescence.is_some() && !is_metal {
            let at = format!("{place}.extensions.KHR_materials_iridescence");
            builder.leave_out(at, "what is not metal and transmits no light has no film");
        }
        let value = match metallic {
            Number::Value(0.0) => ground,
            Number::Value(1.0) => metal(builder),
            share => {
                let metal = metal(builder);
                share.mixed(ground, metal)
            }
        };
        let mut value = self.with_sheen(value, material, &mut uv_set, (place, buffers, clear.is_some()), builder);
        if is_metal || !diffuse_transmission::passes(material) {
            if !matches!(passes, Passes::ThinWall(_)) {
                volume::leave_out(material, "it is ignored: the material does not transmit light", place, builder);
            }
        } else {
            volume::fill_body(&mut value, material, place, builder);
        }
        (value, uv_set)
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
        let cutoff = (material.alpha_mode() == AlphaMode::Mask)
            .then(|| material.alpha_cutoff().map_or(0.5, decimal).clamp(0.0, 1.0));
        if material.alpha_mode() != AlphaMode::Opaque {
            let Opacity { factor, image, place: at } = self.alpha(material, place, buffers, builder);
            let image = image.filter(|(_, set)| fits(*set, &at, builder));
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

    /// What a material that makes use of alpha says of it.
    fn alpha(
        &mut self,
        material: &gltf::Material<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Opacity {
        if let Some(stated) = self.diffuse_alpha(material, place, buffers, builder) {
            return stated;
        }
        let surface = material.pbr_metallic_roughness();
        let at = format!("{place}.pbrMetallicRoughness.baseColorTexture");
        let image = surface.base_color_texture().and_then(|info| self.image(&info, &at, buffers, builder));
        Opacity { factor: decimal(surface.base_color_factor()[3]), image, place: at }
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

/// A number as the file writes it, which single precision has rounded.
pub(super) fn decimal(value: f32) -> f64 {
    // Shortest digits that stand for the same number.
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// The index of refraction: a number, or Cauchy's formula where the dispersion is stated.
pub(super) fn index(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) -> Value {
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
    list(material.occlusion_texture().is_some(), "occlusionTexture", "it is ignored: shadows are traced");
    list(material.unlit(), "extensions.KHR_materials_unlit", "it is ignored: the surface is lit like any other");
}
