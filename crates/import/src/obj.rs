//! OBJ and MTL.

use std::collections::HashMap;
use std::path::Path;

use etalon_scene::mesh::{ObjMaterial, read_obj};
use serde_json::{Value, json};

use crate::{Builder, light, reflectance};

pub(crate) fn import(bytes: &[u8], builder: &mut Builder<'_>) -> Result<(), String> {
    let near = builder.near;
    let library = |path: &Path| {
        let name = path.to_string_lossy().replace('\\', "/");
        near(&name).map_err(|why| format!("the material library \"{name}\" cannot be read: {why}"))
    };
    let file = read_obj(bytes, library).map_err(|error| error.to_string())?;
    for missing in &file.missing_libraries {
        builder.leave_out("mtllib", missing.clone());
    }
    for material in &file.materials {
        let value = self::material(material, builder);
        builder.materials.entry(material.name.clone()).or_insert(value);
    }
    let plain = builder.material_name("grey");
    // Of those with the same name the first counts.
    let glows: HashMap<&str, Option<[f32; 3]>> =
        file.materials.iter().rev().map(|material| (material.name.as_str(), material.emissive)).collect();
    for (i, part) in file.parts.into_iter().enumerate() {
        let name = part.name.unwrap_or_else(|| format!("faces {i}"));
        let named = part.material.filter(|name| builder.materials.contains_key(name));
        let name_of = named.clone().unwrap_or_else(|| plain.clone());
        if named.is_none() {
            let grey = json!({ "type": "lambert", "reflectance": 0.8 });
            builder.materials.entry(plain.clone()).or_insert(grey);
        }
        let mut material = json!(name_of);
        if part.mesh.uvs.is_empty() && builder.materials[&name_of]["reflectance"]["type"] == "image" {
            builder
                .leave_out(format!("group \"{name}\""), "it has no texture coordinates for the image of its material");
            material = json!({ "type": "lambert", "reflectance": 0.8 });
        }
        let glow = named.as_ref().and_then(|name| *glows.get(name.as_str())?);
        let emission = glow.map(|rgb| rgb.map(f64::from)).filter(|rgb| rgb.iter().any(|v| *v > 0.0)).map(emission);
        builder.add_mesh(&name, part.mesh, &material, emission)?;
    }
    Ok(())
}

fn emission(rgb: [f64; 3]) -> Value {
    json!({ "radiance": light(rgb.map(|v| v.max(0.0)), 1.0) })
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
        if key != "Ke" && !(key == "Tf" && is_one(value)) {
            builder.leave_out(&place, format!("{key} is ignored"));
        }
    }
    let illumination = material.illumination_model.unwrap_or(2);
    let index = f64::from(material.optical_density.unwrap_or(1.0));
    let clear = material.dissolve.unwrap_or(1.0) < 0.5 || matches!(illumination, 4 | 6 | 7 | 9);
    if clear && index > 1.0 && index.is_finite() {
        return json!({ "type": "dielectric", "interior": index });
    }
    if clear || material.dissolve.is_some_and(|d| d < 1.0) {
        builder.leave_out(&place, "d: it is transparent but has no index of refraction: it becomes opaque");
    }
    if matches!(illumination, 3 | 5) && diffuse.is_none_or(is_black) && !is_black(specular) {
        return json!({ "type": "mirror", "reflectance": reflectance(specular) });
    }
    if !is_black(specular) {
        builder.leave_out(&place, "Ks: its gloss is ignored; it becomes diffuse");
    }
    let diffuse = diffuse.unwrap_or([if material.diffuse_texture.is_some() { 1.0 } else { 0.8 }; 3]);
    if diffuse.iter().any(|v| !(0.0..=1.0).contains(v)) {
        builder.leave_out(&place, format!("Kd {diffuse:?} is not a reflectance: it is clamped to 0 to 1"));
    }
    if let Some(words) = &material.diffuse_texture
        && let Some(image) = image(words, &place, builder)
    {
        let factor = diffuse.map(|v| v.clamp(0.0, 1.0));
        return json!({ "type": "lambert", "reflectance": { "type": "image", "file": image, "factor": factor } });
    }
    json!({ "type": "lambert", "reflectance": reflectance(diffuse) })
}

/// The name in the scene of the image that `map_Kd` names.
fn image(words: &str, place: &str, builder: &mut Builder<'_>) -> Option<String> {
    let words = words.replace('\\', "/");
    let mut name = words.trim();
    if name.starts_with('-') {
        builder.leave_out(place, "the options of map_Kd are ignored");
        name = name.rsplit(char::is_whitespace).next().unwrap_or(name);
    }
    if let Some(known) = builder.known.get(name) {
        return known.clone();
    }
    let kind = super::extension(Path::new(name));
    let added = match (builder.near)(name) {
        Ok(bytes) if matches!(kind.as_str(), "png" | "jpg" | "jpeg" | "exr" | "hdr") => {
            Some(builder.add_file("image", &kind, bytes))
        }
        Ok(_) => {
            builder.leave_out(place, format!("map_Kd \"{name}\" is not PNG, JPEG, EXR or HDR"));
            None
        }
        Err(why) => {
            builder.leave_out(place, format!("map_Kd \"{name}\" cannot be read: {why}"));
            None
        }
    };
    builder.known.insert(name.to_owned(), added.clone());
    added
}
