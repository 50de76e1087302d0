//! OBJ and MTL.

mod colours;
mod map;

use std::collections::HashMap;
use std::path::Path;

use etalon_scene::LEAST_ALPHA;
use etalon_scene::mesh::{Cut, ObjMaterial, Part, read_obj};
use serde_json::{Value, json};

use crate::number::has_image;
use crate::{Builder, light, reflectance};

pub(crate) fn import(bytes: &[u8], builder: &mut Builder<'_>) -> Result<(), String> {
    let near = builder.near;
    let library = |path: &Path| {
        let name = path.to_string_lossy().replace('\\', "/");
        near(&name).map_err(|why| format!("the material library \"{name}\" cannot be read: {why}"))
    };
    let mut file = read_obj(bytes, Cut::Outline, library).map_err(|error| error.to_string())?;
    file.smooth_groups();
    for missing in &file.missing_libraries {
        builder.leave_out("mtllib", missing.clone());
    }
    for name in &file.unknown_materials {
        builder.approximate(format!("usemtl {name}"), "no library has this material: it becomes grey");
    }
    for material in &file.materials {
        let value = self::material(material, builder);
        builder.materials.entry(material.name.clone()).or_insert(value);
    }
    let plain = builder.material_name("grey");
    // Of those with the same name the first counts.
    let glows: HashMap<&str, Option<[f32; 3]>> =
        file.materials.iter().rev().map(|material| (material.name.as_str(), material.emissive)).collect();
    let opacities: HashMap<&str, Option<f64>> =
        file.materials.iter().rev().map(|material| (material.name.as_str(), opacity(material))).collect();
    for (i, part) in file.parts.into_iter().enumerate() {
        let Part { name, material, mut mesh, left_out, .. } = part;
        let name = name.unwrap_or_else(|| format!("faces {i}"));
        let place = format!("group \"{name}\"");
        for what in left_out {
            builder.leave_out(&place, what);
        }
        let named = material.filter(|name| builder.materials.contains_key(name));
        let name_of = named.clone().unwrap_or_else(|| plain.clone());
        if named.is_none() {
            let grey = json!({ "type": "lambert", "reflectance": 0.8 });
            builder.materials.entry(plain.clone()).or_insert(grey);
        }
        let mut material = json!(name_of);
        if mesh.uvs.is_empty() && has_image(&builder.materials[&name_of]) {
            builder.leave_out(&place, "it has no texture coordinates for the image of its material");
            material = json!({ "type": "lambert", "reflectance": 0.8 });
        }
        let glow = named.as_ref().and_then(|name| *glows.get(name.as_str())?);
        let emission = glow.map(|rgb| rgb.map(f64::from)).filter(|rgb| rgb.iter().any(|v| *v > 0.0)).map(emission);
        let share = named.as_ref().and_then(|name| *opacities.get(name.as_str())?);
        let opacity = share.map(|share| ("opacity".to_owned(), json!(share)));
        if !mesh.colours.is_empty() {
            material = colours::painted(material, named.is_some(), &mut mesh, &place, builder)?;
        }
        builder.add_mesh(&name, mesh, &material, (emission, &opacity.into_iter().collect()))?;
    }
    Ok(())
}

fn emission(rgb: [f64; 3]) -> Value {
    json!({ "radiance": light(rgb.map(|v| v.max(0.0)), 1.0) })
}

/// The index of a material that is glass: it is said to refract, or is more clear than not.
fn glass(material: &ObjMaterial) -> Option<f64> {
    let index = f64::from(material.optical_density.unwrap_or(1.0));
    let clear = material.dissolve.unwrap_or(1.0) < 0.5 || matches!(material.illumination_model, Some(4 | 6 | 7 | 9));
    (clear && index > 1.0 && index.is_finite()).then_some(index)
}

/// The share of the light that meets a material that dissolves (`d`); `None` of glass, and of what light does not pass.
fn opacity(material: &ObjMaterial) -> Option<f64> {
    let share = f64::from(material.dissolve?);
    (share < 1.0 && glass(material).is_none()).then_some(share.max(0.0))
}

/// What a material is here: glass where it is said to refract, a mirror where it only reflects, else diffuse.
fn material(material: &ObjMaterial, builder: &mut Builder<'_>) -> Value {
    let place = format!("material \"{}\"", material.name);
    let colour = |c: Option<[f32; 3]>| c.map(|c| c.map(f64::from));
    let (diffuse, specular) = (colour(material.diffuse), colour(material.specular).unwrap_or([0.0; 3]));
    let is_black = |c: [f64; 3]| c.iter().all(|v| *v <= 0.0);
    for (key, there) in [
        ("map_Ks", material.specular_texture.is_some()),
        ("map_bump", material.normal_texture.is_some()),
        ("map_Ns", material.shininess_texture.is_some()),
        ("map_d", material.dissolve_texture.is_some()),
    ] {
        if there {
            builder.leave_out(&place, format!("{key} is ignored"));
        }
    }
    let is_one = |value: &str| value.split_whitespace().all(|number| number.parse() == Ok(1.0));
    for (key, value) in material.unknown_param.iter().collect::<std::collections::BTreeMap<_, _>>() {
        if !(matches!(key.as_str(), "Pr" | "Pm") || key == "Tf" && is_one(value)) {
            builder.leave_out(&place, format!("{key} is ignored"));
        }
    }
    let illumination = material.illumination_model.unwrap_or(2);
    if let Some(index) = glass(material) {
        return json!({ "type": "dielectric", "interior": index });
    }
    if matches!(illumination, 4 | 6 | 7 | 9) && opacity(material).is_none() {
        builder.approximate(&place, "illum: it is transparent but has no index of refraction: it becomes opaque");
    }
    if matches!(illumination, 3 | 5) && diffuse.is_none_or(is_black) && !is_black(specular) {
        return json!({ "type": "mirror", "reflectance": reflectance(specular) });
    }
    let gloss = Gloss::of(material, illumination, specular);
    if let Some(Gloss { metalness: 0.0, words: Some(_), .. }) = gloss
        && diffuse.is_some_and(is_black)
    {
        // All that it reflects is a highlight: a metal of that colour.
        builder.approximate(&place, "Ks and Ns become a metal of this colour, which is brighter at grazing angles");
        let mut metal = json!({ "type": "conductor", "reflectance": reflectance(specular) });
        gloss_of_phong(material, &mut metal);
        return metal;
    }
    let diffuse = diffuse.unwrap_or([if material.diffuse_texture.is_some() { 1.0 } else { 0.8 }; 3]);
    if diffuse.iter().any(|v| !(0.0..=1.0).contains(v)) {
        builder.approximate(&place, format!("Kd {diffuse:?} is not a reflectance: it is clamped to 0 to 1"));
    }
    let laid = material.diffuse_texture.as_ref().and_then(|words| map::image(words, &place, builder));
    let colour = match laid {
        Some(mut image) => {
            image["factor"] = json!(diffuse.map(|v| v.clamp(0.0, 1.0)));
            image
        }
        None => reflectance(diffuse),
    };
    let Some(gloss) = gloss else { return json!({ "type": "lambert", "reflectance": colour }) };
    if let Some(words) = gloss.words {
        builder.approximate(&place, words);
    }
    let part = |kind: &str| {
        let mut part = json!({ "type": kind, "reflectance": colour });
        match gloss.alpha {
            Some(alpha) => part["alpha"] = json!(alpha),
            None => gloss_of_phong(material, &mut part),
        }
        part
    };
    let mut ground = part("plastic");
    ground["coat"] = json!(gloss.coat);
    // `Kd` is what is seen below the highlights.
    ground["internal_reflection"] = json!("uncoloured");
    match gloss.metalness {
        0.0 => ground,
        1.0 => part("conductor"),
        share => json!({ "type": "blend", "first": ground, "second": part("conductor"), "weight": share }),
    }
}

/// How a material shines beside its diffuse colour.
struct Gloss {
    /// Index of its coat.
    coat: f64,
    /// Share of metal of its surface, from 0 to 1.
    metalness: f64,
    /// Width of GGX facets; `None`: that of Beckmann's by the exponent `Ns`.
    alpha: Option<f64>,
    /// What to say, if it is not what the file means.
    words: Option<&'static str>,
}

impl Gloss {
    /// By `Pr` and `Pm`, or by `Ks` and `Ns`; `None` if it does not shine.
    fn of(material: &ObjMaterial, illumination: u8, specular: [f64; 3]) -> Option<Self> {
        let number = |key: &str| {
            let number: f64 = material.unknown_param.get(key)?.trim().parse().ok()?;
            number.is_finite().then(|| number.clamp(0.0, 1.0))
        };
        if let (roughness, metalness) = (number("Pr"), number("Pm"))
            && (roughness.is_some() || metalness.is_some())
        {
            let index = f64::from(material.optical_density.unwrap_or(1.5));
            let coat = if index > 1.0 && index <= 4.0 { index } else { 1.5 };
            let alpha = roughness.unwrap_or(0.5).powi(2);
            let alpha = if alpha < LEAST_ALPHA { 0.0 } else { alpha };
            return Some(Self { coat, metalness: metalness.unwrap_or(0.0), alpha: Some(alpha), words: None });
        }
        let mean = specular.iter().map(|v| v.clamp(0.0, 1.0)).sum::<f64>() / 3.0;
        // 0 and 1 have no highlights.
        if illumination < 2 || mean == 0.0 {
            return None;
        }
        // Programs that write MTL of materials with Fresnel reflection say 1 where it is 0.08 head-on.
        let root = (0.08 * mean).sqrt();
        let words = "Ks and Ns become a clear coat that reflects 0.08 Ks head-on: the lobe of Phong knows no Fresnel";
        Some(Self { coat: (1.0 + root) / (1.0 - root), metalness: 0.0, alpha: None, words: Some(words) })
    }
}

/// Says of a material the facets whose highlight is that of Phong's exponent n: of Beckmann's with n = 2/α² − 2 (Walter et al. 2007).
fn gloss_of_phong(material: &ObjMaterial, value: &mut Value) {
    let exponent = f64::from(material.shininess.unwrap_or(0.0)).max(0.0);
    value["alpha"] = json!((2.0 / (exponent + 2.0)).sqrt().max(LEAST_ALPHA));
    value["distribution"] = json!("beckmann");
}

#[cfg(test)]
mod tests {
    #[test]
    fn of_materials_with_the_same_name_the_first_holds() {
        let near = |name: &str| match name {
            "a.mtl" => Ok(b"newmtl a\nKd 1 0 0\nnewmtl a\nKd 1 0 0\nd 0.25\n".to_vec()),
            other => Err(format!("there is no {other}")),
        };
        let model = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
        let text = crate::import_bytes("obj", model, &near, "", "a.obj").unwrap().text;
        assert!(!text.contains("\"opacity\""), "{text}");
    }
}
