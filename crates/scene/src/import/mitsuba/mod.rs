//! Mitsuba 3 scenes: the XML files of its common shapes, materials, spectra, lights and cameras.
//!
//! Every element that is read marks itself; what no part of this module has asked for is listed with its line.

mod camera;
mod colour;
mod element;
mod emitter;
mod material;
mod relief;
mod shape;
mod transform;

use std::collections::HashMap;

use super::Builder;
use element::{Element, Ids};
use material::Look;

pub(super) fn import(bytes: &[u8], builder: &mut Builder<'_>) -> Result<(), String> {
    let root = element::read(bytes, builder.near)?;
    if root.tag != "scene" {
        return Err(format!("{}: <{}> is no Mitsuba scene", root.place, root.tag));
    }
    let version = root.attribute("version").unwrap_or("");
    if !version.starts_with('3') && !version.starts_with('2') {
        builder.leave_out(&root.place, format!("its version is \"{version}\": names of version 3 are expected"));
    }
    let ids = Ids::new(&root);
    Walk { ids: &ids, builder, looks: HashMap::new(), meshes: HashMap::new() }.scene(&root)
}

/// The way through a scene.
struct Walk<'a, 'w, 'b> {
    ids: &'a Ids<'a>,
    builder: &'w mut Builder<'b>,
    /// Materials by the address of their element, each with its name in the scene.
    looks: HashMap<*const Element, Look>,
    /// Mesh files that have been read, by what was asked of them.
    meshes: HashMap<String, std::rc::Rc<shape::Mesh>>,
}

impl<'a> Walk<'a, '_, '_> {
    fn scene(&mut self, root: &'a Element) -> Result<(), String> {
        // Materials that shapes refer to are read where they are first used, so that the unused ones are named as such.
        for child in &root.children {
            match child.tag.as_str() {
                "integrator" => self.integrator(child)?,
                "sensor" => self.sensor(child)?,
                "emitter" => self.emitter(child)?,
                "shape" if child.plugin() == "shapegroup" => self.group(child)?,
                _ => continue,
            }
            child.mark();
        }
        for child in root.children.iter().filter(|child| child.tag == "shape" && child.plugin() != "shapegroup") {
            self.shape(child)?;
            child.mark();
        }
        // A material, texture or shape that nothing refers to is nothing in the picture.
        for child in root.children.iter().filter(|child| child.attribute("id").is_some()) {
            if matches!(child.tag.as_str(), "bsdf" | "texture" | "spectrum" | "rgb") {
                child.mark();
            }
        }
        root.list_unused(self.builder);
        Ok(())
    }
}
