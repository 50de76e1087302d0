//! What refers to something else by number, and arrays that go together.

use super::{Group, Instance, Material, MaterialKind, Mesh, Motion, Object, Parameter, Scene, Shape};
use crate::texture::{Image, Texels};
use std::collections::HashSet;
use std::sync::Arc;

/// A reference of a [`Scene`] to something that is not there, or arrays of it that do not go together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReferenceError {
    /// An object of no material.
    #[error("object \"{object}\" has material {index}, but the scene has {count}")]
    Material {
        /// Name of the object.
        object: String,
        /// Its material.
        index: usize,
        /// How many materials there are.
        count: usize,
    },
    /// An instance of no group.
    #[error("instance \"{instance}\" places group {index}, but it may only place the first {count}")]
    Group {
        /// Name of the instance.
        instance: String,
        /// Its group.
        index: usize,
        /// How many groups it may place: in the scene all, in a group those before it.
        count: usize,
    },
    /// A triangle of no vertex.
    #[error("object \"{object}\": triangle {triangle} has vertex {index}, but the mesh has {count}")]
    Vertex {
        /// Name of the object.
        object: String,
        /// Index of the triangle.
        triangle: usize,
        /// Its vertex.
        index: u32,
        /// How many vertices the mesh has.
        count: usize,
    },
    /// Normals or texture coordinates that are not one for each vertex.
    #[error("object \"{object}\": {found} {what} for {count} vertices")]
    PerVertex {
        /// Name of the object.
        object: String,
        /// What the mesh has for each vertex.
        what: &'static str,
        /// How many of them there are.
        found: usize,
        /// How many vertices the mesh has.
        count: usize,
    },
    /// An image with too few or too many texels.
    #[error("{owner}: an image of {width} × {height} has {found} texels")]
    Texels {
        /// What has the image.
        owner: String,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// How many texels it has.
        found: usize,
    },
    /// A motion without a keyframe.
    #[error("{owner}: a motion without a keyframe")]
    NoKeyframe {
        /// What moves.
        owner: String,
    },
    /// A blend of nothing.
    #[error("material \"{material}\": a blend of no materials")]
    EmptyBlend {
        /// Name of the material.
        material: String,
    },
}

impl Scene {
    /// Checks that everything the scene refers to by number is there, and that arrays which go together are as long as each
    /// other. A scene from a file always passes.
    ///
    /// # Errors
    /// The first [`ReferenceError`].
    pub fn check_references(&self) -> Result<(), ReferenceError> {
        self.materials.iter().try_for_each(|material| check_material(&material.kind, material))?;
        let mut checked = HashSet::new();
        for object in self.objects.iter().chain(self.groups.iter().flat_map(|group| &group.objects)) {
            check_object(object, self.materials.len(), &mut checked)?;
        }
        for (index, Group { instances, .. }) in self.groups.iter().enumerate() {
            instances.iter().try_for_each(|instance| check_instance(instance, index))?;
        }
        self.instances.iter().try_for_each(|instance| check_instance(instance, self.groups.len()))?;
        if let Some(moves) = &self.camera.motion {
            check_motion(&moves.motion, || "the camera".into())?;
        }
        for light in &self.lights {
            if let Some(environment) = light.kind.image() {
                check_image(&environment.image, || format!("light \"{}\"", light.name))?;
            }
            if let Some(slide) = light.kind.slide() {
                check_image(&slide.image.image, || format!("light \"{}\"", light.name))?;
            }
        }
        Ok(())
    }
}

/// A kind of a material, or of a part of it.
fn check_material(kind: &MaterialKind, material: &Material) -> Result<(), ReferenceError> {
    let owner = || format!("material \"{}\"", material.name);
    if let MaterialKind::TwoSided { front, back } = kind {
        return [front, back].into_iter().try_for_each(|side| check_material(side, material));
    }
    if let MaterialKind::Tinted { kind: of, .. } = kind {
        check_material(of, material)?;
    }
    if let MaterialKind::Blend { parts, by } = kind {
        if parts.is_empty() {
            return Err(ReferenceError::EmptyBlend { material: material.name.clone() });
        }
        by.image().map_or(Ok(()), |texture| check_image(&texture.image, owner))?;
        parts.iter().try_for_each(|(_, part)| check_material(part, material))?;
    }
    let images = kind.parameters().into_iter().flat_map(|parameter| match parameter {
        Parameter::Film(film) => film.images().collect(),
        other => Vec::from_iter(other.image()),
    });
    images.into_iter().try_for_each(|texture| check_image(&texture.image, owner))
}

/// An object, one of `materials`. Its mesh is looked at unless it is one of those `checked`.
fn check_object(object: &Object, materials: usize, checked: &mut HashSet<*const Mesh>) -> Result<(), ReferenceError> {
    if object.material >= materials {
        let (object, index) = (object.name.clone(), object.material);
        return Err(ReferenceError::Material { object, index, count: materials });
    }
    if let Shape::Mesh(mesh) = &object.shape
        && checked.insert(Arc::as_ptr(mesh))
    {
        check_mesh(mesh, &object.name)?;
    }
    let images = [
        object.emission.as_ref().and_then(|emission| emission.image.as_ref()),
        object.opacity_image.as_ref().map(|opacity| &opacity.texture),
        object.relief.as_ref().map(|relief| relief.texture()),
    ];
    let mut images = images.into_iter().flatten();
    images.try_for_each(|texture| check_image(&texture.image, || format!("object \"{}\"", object.name)))
}

fn check_mesh(mesh: &Mesh, object: &str) -> Result<(), ReferenceError> {
    let (object, count) = (object.to_owned(), mesh.vertices.len());
    let lists =
        [("normals", mesh.normals.len()), ("texture coordinates", mesh.uvs.len()), ("colours", mesh.colours.len())];
    for (what, found) in lists {
        if found != 0 && found != count {
            return Err(ReferenceError::PerVertex { object, what, found, count });
        }
    }
    for (triangle, vertices) in mesh.triangles.iter().enumerate() {
        if let Some(&index) = vertices.iter().find(|&&vertex| vertex as usize >= count) {
            return Err(ReferenceError::Vertex { object, triangle, index, count });
        }
    }
    Ok(())
}

/// An instance that may place the first `count` groups.
fn check_instance(instance: &Instance, count: usize) -> Result<(), ReferenceError> {
    let Instance { name, group, motion, .. } = instance;
    if *group >= count {
        return Err(ReferenceError::Group { instance: name.clone(), index: *group, count });
    }
    motion.as_ref().map_or(Ok(()), |motion| check_motion(motion, || format!("instance \"{name}\"")))
}

fn check_motion(motion: &Motion, owner: impl FnOnce() -> String) -> Result<(), ReferenceError> {
    if motion.keyframes.is_empty() {
        return Err(ReferenceError::NoKeyframe { owner: owner() });
    }
    Ok(())
}

fn check_image(image: &Image, owner: impl FnOnce() -> String) -> Result<(), ReferenceError> {
    let found = match &image.texels {
        Texels::Srgb8(texels) | Texels::Linear8(texels) => texels.len(),
        Texels::F32(texels) => texels.len(),
    };
    let (width, height) = (image.width, image.height);
    if found == 0 || found as u64 != u64::from(width) * u64::from(height) {
        return Err(ReferenceError::Texels { owner: owner(), width, height, found });
    }
    Ok(())
}
