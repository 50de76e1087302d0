//! `KHR_materials_transmission`: light that a surface passes and does not scatter.
//!
//! Without a thickness in `KHR_materials_volume` glTF means a thin wall, which does not refract: a pane. With it the surface is that of a solid.

use serde_json::{Value, json};

use super::anisotropy::Anisotropy;
use super::iridescence::Iridescence;
use super::material::{Materials, decimal, index};
use super::number::Number;
use super::{clearcoat, sheen, specular, volume};
use crate::Builder;

const KEY: &str = "extensions.KHR_materials_transmission";

/// The largest roughness for which a pane, which is smooth, stands for a thin wall: it would spread light by less than a degree.
const SMOOTH: f64 = 0.1;

/// What becomes of light that meets a surface and is not reflected.
pub(super) enum Passes {
    /// It is scattered back.
    Nothing,
    /// It goes into a solid.
    Solid,
    /// This share goes straight on.
    ThinWall(Number),
}

impl Passes {
    /// That of a material that is not all metal.
    pub(super) fn of(
        material: &gltf::Material<'_>,
        materials: &mut Materials<'_>,
        roughness: &Number,
        uv_set: &mut Option<u32>,
        (place, buffers): (&str, &[Vec<u8>]),
        builder: &mut Builder<'_>,
    ) -> Self {
        let Some(transmission) = material.transmission() else { return Self::Nothing };
        let factor = decimal(transmission.transmission_factor()).clamp(0.0, 1.0);
        if factor == 0.0 {
            return Self::Nothing;
        }
        let at = format!("{place}.{KEY}");
        let is_thin = !has_thickness(material);
        let is_smooth = matches!(roughness, Number::Value(value) if *value <= SMOOTH);
        if is_thin && is_smooth {
            if !matches!(roughness, Number::Value(0.0)) {
                builder.approximate(&at, "a thin wall becomes a smooth pane");
            }
            let texture = format!("{at}.transmissionTexture");
            let info = transmission.transmission_texture();
            return Self::ThinWall(materials.factor_on((factor, info), "red", &texture, uv_set, buffers, builder));
        }
        if factor < 0.5 {
            builder.leave_out(at, "a factor below 0.5 becomes opaque");
            return Self::Nothing;
        }
        if factor < 1.0 || transmission.transmission_texture().is_some() {
            builder.approximate(&at, "it becomes fully transmitting");
        }
        if is_thin {
            builder.approximate(at, "a rough thin wall becomes the surface of a solid, which refracts light");
        }
        Self::Solid
    }
}

/// Whether the surface is that of a solid, and not a thin wall.
fn has_thickness(material: &gltf::Material<'_>) -> bool {
    material.volume().is_some_and(|volume| volume.thickness_factor() > 0.0)
}

/// The surface of a solid of a base colour; whether it has an image.
pub(super) fn solid(
    material: &gltf::Material<'_>,
    colour: Value,
    (roughness, metallic): (&Number, &Number),
    place: &str,
    builder: &mut Builder<'_>,
) -> (Value, bool) {
    if !matches!(metallic, Number::Value(0.0)) {
        builder.approximate(format!("{place}.{KEY}"), "the share that is metal becomes glass, too");
    }
    let mut glass = json!({ "type": "dielectric", "interior": index(material, place, builder) });
    let tinted = colour != json!(1.0);
    if tinted {
        glass["transmitted_tint"] = colour;
    }
    let anisotropy = Anisotropy::of(material, roughness, place, builder);
    let has_image = roughness.put_as_roughness(anisotropy.as_ref(), &mut glass) || tinted;
    if has_thickness(material) {
        volume::put_in_glass(&mut glass, material, place, builder);
    } else {
        volume::leave_out(material, THIN, place, builder);
    }
    list_layers(material, place, builder);
    put_film(&mut glass, material, place, builder);
    (glass, has_image)
}

/// A thin wall that passes all that it does not reflect, tinted by a base colour.
pub(super) fn pane(material: &gltf::Material<'_>, colour: &Value, place: &str, builder: &mut Builder<'_>) -> Value {
    let mut pane = json!({ "type": "thin-dielectric", "index": index(material, place, builder) });
    if *colour != json!(1.0) {
        pane["transmitted_tint"] = colour.clone();
    }
    volume::leave_out(material, THIN, place, builder);
    specular::leave_out(material, place, builder);
    put_film(&mut pane, material, place, builder);
    pane
}

const THIN: &str = "it is ignored: the material is a thin wall, since thicknessFactor is 0";

/// Lists the layers that what is all glass does not have.
pub(super) fn list_layers(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    clearcoat::leave_out(material, place, builder);
    sheen::leave_out(material, place, builder);
    specular::leave_out(material, place, builder);
}

fn put_film(glass: &mut Value, material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    if let Some(iridescence) = Iridescence::of(material, place, builder) {
        iridescence.put_on_glass(glass, place, builder);
    }
}
