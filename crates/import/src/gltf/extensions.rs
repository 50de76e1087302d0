//! Extensions of glTF: which a file may require, and what a picture lacks of those that are not read.

use std::borrow::Cow;

use glam::DAffine3;
use gltf::{Glb, Node};
use serde_json::Value;

use super::{Walk, compression};
use crate::Builder;

/// Extensions that are read, or whose losses are listed where they stand.
const READ: [&str; 20] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions that change no picture.
const INVISIBLE: [&str; 11] = [
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "KHR_audio_emitter",
    "KHR_implicit_shapes",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_rigid_bodies",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
];

/// Extensions by which textures name images of other kinds: the kind, and what makes PNG files of them.
const IMAGES: [(&str, &str, &str); 4] = [
    ("KHR_texture_basisu", "KTX2", "gltf-transform ktxdecompress"),
    ("EXT_texture_webp", "WebP", "gltf-transform png"),
    ("EXT_texture_avif", "AVIF", "gltf-transform png"),
    ("MSFT_texture_dds", "DDS", "an image editor"),
];

/// Lets animations change any property, not only those of nodes.
const POINTER: &str = "KHR_animation_pointer";

/// What a picture lacks without an extension.
fn lack(name: &str) -> String {
    if let Some((_, kind, tool)) = IMAGES.iter().find(|(known, ..)| *known == name) {
        return format!(
            "images in {kind} cannot be read, only PNG and JPEG; those that its textures name beside them are used. `{tool}` makes them"
        );
    }
    let what = match name {
        "EXT_lights_ies" => "lamps shine evenly, without the distributions of their files",
        "EXT_lights_image_based" => "the light of its surroundings is missing",
        POINTER => "what it animates stays as it is: materials, lights and cameras",
        "KHR_gaussian_splatting" => "its splats are not seen",
        "KHR_techniques_webgl" => "surfaces do not look as its shaders make them",
        name if name.contains("_materials_") => "surfaces look as they do without it",
        name if name.contains("_lights_") => "its light is missing",
        name if name.contains("_texture_") => "its images are missing",
        _ => "what it says is not in the picture",
    };
    format!("it is ignored: {what}")
}

/// Fails if a file requires an extension without which it cannot be read.
pub(super) fn check_required(root: &Value) -> Result<(), String> {
    let named = root["extensionsRequired"].as_array().into_iter().flatten().filter_map(Value::as_str);
    for name in named {
        // Without an image there is a picture, and the image is listed.
        let is_image = IMAGES.iter().any(|(known, ..)| *known == name);
        if !is_read(name) && !is_image && !INVISIBLE.contains(&name) {
            return Err(format!("$.extensionsRequired: it requires {name}, which cannot be read"));
        }
    }
    Ok(())
}

/// A file without the channels of animations that lead to no node, but to anything by `KHR_animation_pointer`. The library refuses them.
pub(super) fn without_pointers(bytes: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    if !bytes.windows(POINTER.len()).any(|word| word == POINTER.as_bytes()) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut glb = match bytes.starts_with(b"glTF") {
        true => Some(Glb::from_slice(bytes).map_err(|error| error.to_string())?),
        false => None,
    };
    let text = glb.as_ref().map_or(bytes, |glb| &*glb.json);
    let mut root: Value = serde_json::from_slice(text).map_err(|error| error.to_string())?;
    let animations = root.get_mut("animations").and_then(Value::as_array_mut);
    for channels in
        animations.into_iter().flatten().filter_map(|animation| animation.get_mut("channels")?.as_array_mut())
    {
        channels.retain(leads_to_node);
    }
    let text = root.to_string().into_bytes();
    let Some(glb) = &mut glb else { return Ok(Cow::Owned(text)) };
    glb.json = Cow::Owned(text);
    glb.to_vec().map(Cow::Owned).map_err(|error| error.to_string())
}

fn leads_to_node(channel: &Value) -> bool {
    !channel["target"]["node"].is_null()
}

/// The numbers of the channels of each animation that lead to nodes, as the file counts them.
pub(super) fn channels_of_nodes(root: &Value) -> Vec<Vec<usize>> {
    let of_nodes = |animation: &Value| {
        let channels = animation["channels"].as_array().into_iter().flatten().enumerate();
        channels.filter(|(_, channel)| leads_to_node(channel)).map(|(number, _)| number).collect()
    };
    root["animations"].as_array().into_iter().flatten().map(of_nodes).collect()
}

pub(super) fn is_read(name: &str) -> bool {
    READ.contains(&name) || compression::UNDONE.contains(&name)
}

/// Lists the extensions that are used and not read, each with what the picture lacks.
pub(super) fn list_unread(used: &[String], builder: &mut Builder<'_>) {
    for (i, name) in used.iter().enumerate() {
        if !is_read(name) && !INVISIBLE.contains(&name.as_str()) {
            builder.leave_out(format!("$.extensionsUsed[{i}]"), format!("{name}: {}", lack(name)));
        }
    }
}

/// Lists the extensions of a material that are neither read nor declared: `list_unread` lists those that are declared.
pub(super) fn list_undeclared(material: &gltf::Material<'_>, used: &[String], place: &str, builder: &mut Builder<'_>) {
    for name in material.extensions().into_iter().flat_map(|stated| stated.keys()) {
        if !is_read(name) && !INVISIBLE.contains(&name.as_str()) && !used.contains(name) {
            builder.leave_out(format!("{place}.extensions.{name}"), lack(name));
        }
    }
}

/// Why the image of a texture cannot be read, if it has no other.
pub(super) fn unread_image(texture: &gltf::Texture<'_>) -> String {
    let stated = texture.extensions();
    let known = IMAGES.iter().find(|(name, ..)| stated.is_some_and(|stated| stated.contains_key(*name)));
    match known {
        Some((name, kind, tool)) => {
            format!("its image is in {kind} ({name}), and only PNG and JPEG can be read: `{tool}` makes them")
        }
        None => "it names no image that can be read, only PNG and JPEG can".to_owned(),
    }
}

impl<'w> Walk<'w, '_> {
    /// A node and those below it. Of hidden ones (`KHR_node_visibility`) the camera alone counts.
    pub(super) fn node(&mut self, node: &Node<'w>, parent: &DAffine3, depth: usize) -> Result<(), String> {
        let stated = node.extension_value("KHR_node_visibility");
        let is_hidden = stated.is_some_and(|stated| stated["visible"] == false);
        let outside = self.is_hidden;
        self.is_hidden |= is_hidden;
        let visited = self.visit(node, parent, depth);
        self.is_hidden = outside;
        visited
    }

    /// Notes that a material is seen from behind where glTF leaves its back out. That of glass is seen through it.
    pub(super) fn note_back(&mut self, material: &gltf::Material<'w>) {
        if !material.double_sided() && material.transmission().is_none() {
            self.materials.single_sided.insert(material.index());
        }
    }

    /// Says which backs are seen.
    pub(super) fn add_backs(&mut self) {
        let what = match self.materials.single_sided.len() {
            0 => return,
            1 => "the back of a material that is not doubleSided: viewers of glTF hide it".to_owned(),
            count => format!("the backs of {count} materials that are not doubleSided: viewers of glTF hide them"),
        };
        self.builder.added.push(what);
    }
}
