//! `KHR_materials_clearcoat`: a second coat, which the format has not. It takes the place of the first.

use crate::Builder;

const KEY: &str = "KHR_materials_clearcoat";

/// How rough the clear coat of a material is, if it has one that takes the place of its coat: on what is not metal, from a factor of 0.5.
pub(super) fn roughness(
    material: &gltf::Material<'_>,
    has_coat: bool,
    place: &str,
    builder: &mut Builder<'_>,
) -> Option<f64> {
    let value = material.extension_value(KEY)?;
    let number = |key: &str| value[key].as_f64().filter(|number| number.is_finite()).unwrap_or(0.0).clamp(0.0, 1.0);
    let factor = number("clearcoatFactor");
    let place = format!("{place}.extensions.{KEY}");
    if factor == 0.0 {
        return None;
    }
    let images = ["clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"];
    if images.iter().any(|key| value.get(key).is_some()) {
        builder.leave_out(&place, "its images are left out");
    }
    if !has_coat {
        builder.leave_out(place, "it is left out: only what is not metal, and transmits no light, has a coat");
        return None;
    }
    if factor < 0.5 {
        builder.leave_out(place, "a factor below 0.5 becomes none");
        return None;
    }
    let what = "it takes the place of the base's own coat, which would reflect another 4 % head-on";
    builder.approximate(place, what);
    Some(number("clearcoatRoughnessFactor"))
}
