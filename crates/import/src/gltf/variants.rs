//! `KHR_materials_variants`: looks of a model, each with other materials of some of its primitives.

use gltf::Document;
use serde_json::Value;

use super::Walk;
use crate::Builder;

const NAME: &str = "KHR_materials_variants";

/// The number of the variant that is asked for; those of a model of which none is asked for are listed.
///
/// # Errors
/// If there is no such variant, with the names of those that there are.
pub(super) fn asked(file: &Document, wanted: Option<&str>, builder: &mut Builder<'_>) -> Result<Option<usize>, String> {
    let extensions = file.as_json().extensions.as_ref();
    let list = extensions.and_then(|extensions| extensions.others.get(NAME)?["variants"].as_array());
    let names: Vec<&str> =
        list.into_iter().flatten().map(|variant| variant["name"].as_str().unwrap_or_default()).collect();
    let listed = || names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    let Some(wanted) = wanted else {
        if !names.is_empty() {
            let what = format!("of the variants {} none is asked for (--variant of `etalon import`)", listed());
            builder.leave_out(format!("$.extensions.{NAME}"), what);
        }
        return Ok(None);
    };
    let found = names.iter().position(|name| *name == wanted);
    found.map(Some).ok_or_else(|| {
        let has = if names.is_empty() { "it has none".to_owned() } else { format!("it has {}", listed()) };
        format!("there is no variant \"{wanted}\": {has}")
    })
}

impl<'w> Walk<'w, '_> {
    /// The material of a primitive in the variant that is asked for.
    pub(super) fn material(&self, primitive: &gltf::Primitive<'w>, place: &str) -> Result<gltf::Material<'w>, String> {
        let own = primitive.material();
        let (Some(variant), Some(stated)) = (self.variant, primitive.extension_value(NAME)) else { return Ok(own) };
        let says = |mapping: &&Value| {
            let variants = mapping["variants"].as_array();
            variants.into_iter().flatten().any(|number| number.as_u64() == Some(variant as u64))
        };
        let Some(mapping) = stated["mappings"].as_array().into_iter().flatten().find(says) else { return Ok(own) };
        let index = mapping["material"].as_u64().and_then(|index| usize::try_from(index).ok());
        let material = index.and_then(|index| self.document.materials().nth(index));
        material.ok_or_else(|| {
            format!("{place}.extensions.{NAME}: it names material {}, which does not exist", mapping["material"])
        })
    }
}
