//! Mitsuba 3 scenes: the XML files of its common shapes, materials, spectra, lights and cameras.
//!
//! Every element that is read marks itself; what no part of this module has asked for is listed with its line.

mod camera;
mod colour;
mod coordinates;
mod element;
mod emitter;
mod filled;
mod index;
mod material;
mod medium;
mod older;
mod principled;
mod relief;
mod serialized;
mod shape;
mod sheet;
mod sheet_mesh;
mod slide;
mod spot;
mod transform;
mod varying;

use std::collections::HashMap;

use super::Builder;
use element::{Element, Ids, MAX_DEPTH, MAX_ELEMENTS};
use material::Look;
use varying::Choices;

pub(super) fn import(bytes: &[u8], parameters: &[(String, String)], builder: &mut Builder<'_>) -> Result<(), String> {
    let (root, goes_on) = element::read(bytes, parameters, builder)?;
    if goes_on {
        builder.leave_out(&root.place, "what follows </scene> is left out, as in Mitsuba");
    }
    if root.tag != "scene" {
        return Err(format!("{}: <{}> is not a Mitsuba scene", root.place, root.tag));
    }
    let version = root.attribute("version").unwrap_or("");
    if !version.starts_with(['0', '2', '3']) {
        builder.leave_out(&root.place, format!("its version is \"{version}\": names of version 3 are expected"));
    }
    let ids = Ids::new(&root);
    let mut walk = Walk {
        ids: &ids,
        builder,
        looks: HashMap::new(),
        named_looks: HashMap::new(),
        meshes: HashMap::new(),
        choices: Choices::default(),
        ignores_media: None,
        interiors: HashMap::new(),
        nested: false,
        has_panes: false,
        limit_without_panes: false,
        open: Vec::new(),
        entered: 0,
    };
    walk.scene(&root)
}

/// The way through a scene.
struct Walk<'a, 'w, 'b> {
    ids: &'a Ids<'a>,
    builder: &'w mut Builder<'b>,
    /// Materials that can be referred to, by the address of their element.
    looks: HashMap<*const Element, Look>,
    /// Those of shapes, each with its name in the scene.
    named_looks: HashMap<*const Element, Look>,
    /// Mesh files that have been read, by what was asked of them.
    meshes: HashMap<String, std::rc::Rc<shape::Mesh>>,
    /// What has been chosen of the material that is being read.
    choices: Choices,
    /// The integrator, if it goes through media as if they were not there.
    ignores_media: Option<&'a str>,
    /// Media that fill shapes, each with the medium outside of such a shape, if that is stated.
    interiors: HashMap<*const Element, Option<*const Element>>,
    /// Whether a shape says that what is outside of it fills another.
    nested: bool,
    /// Whether a pane of glass without thickness, or a polarising sheet, was read.
    has_panes: bool,
    /// Whether there is a `max_depth` that does not count the ways through panes.
    limit_without_panes: bool,
    /// The elements that are being read, each within the one before.
    open: Vec<*const Element>,
    /// How many elements have been entered, each as often as it is.
    entered: usize,
}

impl<'a> Walk<'a, '_, '_> {
    /// Reads an element that may hold others of its kind, in it or by reference.
    ///
    /// # Errors
    /// Those of `read`; an element within itself; too many within each other, or in all.
    fn within<T>(&mut self, element: &Element, read: impl FnOnce(&mut Self) -> Result<T, String>) -> Result<T, String> {
        let (place, tag, key) = (&element.place, &element.tag, std::ptr::from_ref(element));
        if self.open.contains(&key) {
            return Err(format!("{place}: this <{tag}> refers to itself"));
        }
        if self.open.len() == MAX_DEPTH {
            return Err(format!("{place}: by references, <{tag}> is nested more than {MAX_DEPTH} deep"));
        }
        self.entered += 1;
        if self.entered > MAX_ELEMENTS {
            return Err(format!("{place}: references make more than {MAX_ELEMENTS} elements"));
        }
        self.open.push(key);
        let made = read(self);
        self.open.pop();
        made
    }

    fn scene(&mut self, root: &'a Element) -> Result<(), String> {
        // What an integrator ignores, and what fills bodies, decides what other elements mean.
        for child in root.children.iter().filter(|child| child.tag == "integrator") {
            self.integrator(child)?;
            child.mark();
        }
        self.find_interiors(root);
        self.nested = self.holds_nested(root);
        // Materials that shapes refer to are read where they are first used, so that the unused ones are named as such.
        for child in &root.children {
            match child.tag.as_str() {
                "sensor" => self.sensor(child)?,
                // That of shapes, which refer to it.
                "emitter" if child.plugin() == "area" && child.attribute("id").is_some() => {}
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
            if matches!(child.tag.as_str(), "bsdf" | "texture" | "spectrum" | "rgb" | "srgb") {
                child.mark();
            }
        }
        if self.limit_without_panes && self.has_panes {
            self.builder.integrator.insert("count_panes".to_owned(), serde_json::json!(false));
        }
        root.list_unused(self.builder);
        Ok(())
    }
}
