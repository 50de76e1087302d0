//! What is inside of a body of glTF: `KHR_materials_volume`, which absorbs, and `KHR_materials_volume_scatter`, which scatters.
//!
//! The second is a draft of Khronos (pull request 2453 of KhronosGroup/glTF, as of 2025). There −ln(attenuationColor)/attenuationDistance is
//! the whole extinction. The share ρ of it that is scattered follows from `multiscatterColor` m, channel by channel:
//! ρ = 1 − (4.09712 + 4.20863 m − √(9.59217 + 41.6808 m + 17.7126 m²))². It is a fit of Kulla and Conty ("Revisiting Physically Based Shading
//! at Imageworks", 2017): a medium without end, with isotropic scattering and no mirroring surface, reflects m of even light. Against the exact
//! albedo by Chandrasekhar's H function it is within 0.0021. The phase function is that of Henyey and Greenstein.

use serde_json::{Value, json};

use super::material::decimal;
use crate::medium::fill;
use crate::{Builder, coefficient, reflectance};

const SCATTER: &str = "KHR_materials_volume_scatter";
/// The least share of light that a medium of an imported model lets through.
const LEAST_TRANSMITTANCE: f64 = 1e-4;
/// The largest mean cosine of the format.
const LARGEST_G: f64 = 0.9999;

/// What a volume takes from light: the colour that is left over a distance, m.
struct Attenuation {
    colour: [f64; 3],
    distance_m: f64,
}

impl Attenuation {
    fn of(material: &gltf::Material<'_>) -> Option<Self> {
        let volume = material.volume()?;
        let distance_m = decimal(volume.attenuation_distance());
        // A channel of 0 would need an endless coefficient.
        let colour = volume.attenuation_color().map(|v| decimal(v).clamp(LEAST_TRANSMITTANCE, 1.0));
        (distance_m.is_finite() && distance_m > 0.0).then_some(Self { colour, distance_m })
    }

    fn extinction_per_m(&self) -> Value {
        coefficient(self.colour.map(|share| -share.ln() / self.distance_m + 0.0))
    }
}

/// Fills glass.
pub(super) fn put_in_glass(glass: &mut Value, material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    if let Some(medium) = scattering(material, place, builder) {
        glass["medium"] = medium;
    } else if let Some(attenuation) = Attenuation::of(material) {
        glass["transmittance"] = reflectance(attenuation.colour);
        glass["transmittance_depth_m"] = json!(attenuation.distance_m);
    }
}

/// Fills a body that lets light in diffusely.
pub(super) fn fill_body(body: &mut Value, material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    let medium = scattering(material, place, builder).or_else(|| {
        // Without a thickness it is a sheet with nothing behind.
        material.volume().filter(|volume| volume.thickness_factor() > 0.0)?;
        Some(json!({ "absorption_per_m": Attenuation::of(material)?.extinction_per_m() }))
    });
    if let Some(medium) = medium {
        fill(body, &mut 1.0, false, &medium);
    }
}

/// Lists what would be inside of a body, and why it is not.
pub(super) fn leave_out(material: &gltf::Material<'_>, what: &str, place: &str, builder: &mut Builder<'_>) {
    if material.volume().is_some_and(|volume| volume.attenuation_distance().is_finite()) {
        builder.leave_out(format!("{place}.extensions.KHR_materials_volume"), what);
    }
    if material.extension_value(SCATTER).is_some() {
        builder.leave_out(format!("{place}.extensions.{SCATTER}"), what);
    }
}

/// A medium that scatters, if there is one.
fn scattering(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) -> Option<Value> {
    let value = material.extension_value(SCATTER)?;
    let place = format!("{place}.extensions.{SCATTER}");
    let Some(attenuation) = Attenuation::of(material) else {
        builder
            .leave_out(place, "it is ignored: nothing is taken from light without a distance in KHR_materials_volume");
        return None;
    };
    let number = |value: &Value| value.as_f64().filter(|v| v.is_finite()).unwrap_or(0.0);
    let colour = [0, 1, 2].map(|c| number(&value["multiscatterColor"][c]).clamp(0.0, 1.0));
    if colour == [0.0; 3] {
        return None;
    }
    let what = "its colour becomes an albedo by the fit of a draft of this extension: a thick medium has that colour within 0.0021 if its surface \
                mirrors nothing and scatterAnisotropy is 0";
    builder.approximate(place, what);
    let mut medium = json!({
        "extinction_per_m": attenuation.extinction_per_m(),
        "albedo": reflectance(colour.map(single_scattering)),
    });
    let g = number(&value["scatterAnisotropy"]).clamp(-LARGEST_G, LARGEST_G);
    if g != 0.0 {
        medium["phase"] = json!({ "type": "henyey-greenstein", "g": g });
    }
    Some(medium)
}

/// The share of light that one scattering leaves, of a medium that reflects a share after all of them.
fn single_scattering(reflected: f64) -> f64 {
    if reflected == 0.0 {
        return 0.0;
    }
    let root = (9.59217 + reflected * (41.6808 + reflected * 17.7126)).sqrt();
    let lost = 4.09712 + 4.20863 * reflected - root;
    (1.0 - lost * lost).clamp(0.0, 1.0)
}
