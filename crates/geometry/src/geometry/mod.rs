//! Primitives and what is built over them.
//!
//! An instance places a geometry, which has primitives of its own, some of which may be instances. So the types of this module name each
//! other. None of them knows how rays go through them: that is [`traverse`](crate::traverse).

mod build;
mod instance;
mod instance_node;
mod primitive;
mod statistics;
mod wide_tree;

use crate::small_scene::SmallScene;
use crate::{Aabb, PrimitiveId, SurfaceId};
use etalon_optics::Vec3;
use etalon_simd::Level;
pub use instance::Instance;
pub(crate) use instance_node::InstanceNode;
pub use primitive::Primitive;
use statistics::PrimitiveStatistics;
pub(crate) use wide_tree::WideTree;

/// Most instances within each other: a ray descends through them by recursion.
pub const MAX_NESTING: u32 = 32;

/// Why primitives cannot be built into a [`Geometry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GeometryError {
    /// More primitives than ids.
    #[error("{0} primitives; at most 2^29 are possible")]
    TooMany(usize),
    /// More instances, those within instances counted wherever they are placed, than numbers for them.
    #[error("{0} placed instances; at most 2^31 are possible")]
    TooManyInstances(u64),
    /// Instances within instances, too many of them.
    #[error("instances are nested {0} deep; at most {MAX_NESTING}")]
    TooDeep(u32),
}

/// Primitives and the accelerator over them; immutable.
///
/// Every query is answered in `f64`, whatever the scalar of the ray, and the result is rounded: both scalars see the
/// same scene. Of several hits at the same distance the one of the lowest [`PrimitiveId`] is reported.
#[derive(Debug)]
pub struct Geometry {
    primitives: Vec<Primitive>,
    bounds: Option<Aabb>,
    tree: Option<WideTree>,
    /// Instead of a tree, for few primitives.
    small_scene: Option<SmallScene>,
    level: Level,
    /// Which primitives are instances.
    instances: Vec<u32>,
    /// Numbers that instances take, 1 for the geometry itself among them.
    instance_count: u64,
    /// Instances within each other.
    nesting: u32,
    /// See [`Geometry::outline`].
    outline: Vec<Aabb>,
    label: u32,
}

impl Geometry {
    /// The same geometry with a number of the caller's, by which points on its surfaces tell that they are its.
    #[must_use]
    pub fn with_label(self, label: u32) -> Self {
        Self { label, ..self }
    }

    /// The number given to [`Geometry::with_label`], 0 without.
    pub fn label(&self) -> u32 {
        self.label
    }

    #[inline]
    pub(crate) fn instance_count(&self) -> u64 {
        self.instance_count
    }

    /// The primitive of an id. Panics if the id is none of this geometry's.
    pub fn primitive(&self, id: PrimitiveId) -> &Primitive {
        &self.primitives[id.0 as usize]
    }

    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.primitives.len()
    }

    /// Whether there are no primitives.
    pub fn is_empty(&self) -> bool {
        self.primitives.is_empty()
    }

    /// A box around all primitives; `None` if there are none.
    pub fn bounds(&self) -> Option<Aabb> {
        self.bounds
    }

    /// Some boxes that together hold all primitives: fewer than a hundred, but closer to their shape than one. An instance's box
    /// is made of them, lest it be as large as that of a turned box.
    pub(crate) fn outline(&self) -> &[Aabb] {
        &self.outline
    }

    /// Memory held, bytes: the primitives, the accelerator and every shared geometry, each once.
    pub fn memory_bytes(&self) -> usize {
        let mut seen = Vec::new();
        self.memory_beside(&mut seen)
    }

    fn memory_beside(&self, seen: &mut Vec<*const Self>) -> usize {
        let tree = self.tree.as_ref().map_or(0, WideTree::memory_bytes)
            + self.small_scene.as_ref().map_or(0, SmallScene::memory_bytes);
        let own = size_of::<Self>()
            + self.primitives.capacity() * size_of::<Primitive>()
            + tree
            + size_of_val(self.outline());
        let places = self.instances.len() * (size_of::<Instance>() + size_of::<u32>());
        let mut shared = 0;
        for instance in self.own_instances() {
            let address = std::sync::Arc::as_ptr(instance.geometry());
            if let Err(place) = seen.binary_search(&address) {
                seen.insert(place, address);
                shared += instance.geometry().memory_beside(seen);
            }
        }
        own + places + shared
    }

    /// The instances, each with the [number](SurfaceId::instance) of what it places: surfaces within have that plus their
    /// number in the geometry placed.
    pub fn instances(&self) -> impl Iterator<Item = (u32, &Instance)> {
        self.own_instances().map(|instance| (instance.first, instance))
    }

    fn own_instances(&self) -> impl Iterator<Item = &Instance> {
        self.instances.iter().filter_map(|&index| self.instance_at(index))
    }

    fn instance_at(&self, index: u32) -> Option<&Instance> {
        match &self.primitives[index as usize] {
            Primitive::Instance(instance) => Some(instance),
            _ => None,
        }
    }

    /// The instance that holds a surface which is not this geometry's own.
    pub(crate) fn instance_of(&self, surface: SurfaceId) -> Option<(u32, &Instance)> {
        let first = |&index: &u32| self.instance_at(index).map_or(0, |instance| instance.first);
        let after = self.instances.partition_point(|index| first(index) <= surface.instance);
        let index = *self.instances.get(after.checked_sub(1)?)?;
        self.instance_at(index).map(|instance| (index, instance))
    }

    /// The instances that place a surface, the outermost first: each by its index among the primitives of the geometry that
    /// it is part of. Empty for one of this geometry's own.
    pub fn path(&self, mut surface: SurfaceId) -> Vec<PrimitiveId> {
        let (mut geometry, mut path) = (self, Vec::new());
        while surface.instance > 0
            && let Some((index, instance)) = geometry.instance_of(surface)
        {
            path.push(PrimitiveId(index));
            surface.instance -= instance.first;
            geometry = instance.geometry();
        }
        path
    }

    /// The instance that holds a surface which is not this geometry's own, and the surface within what it places.
    #[inline]
    fn enter_instance(&self, surface: SurfaceId) -> Option<(&Instance, SurfaceId)> {
        if surface.instance == 0 {
            return None;
        }
        let (_, instance) = self.instance_of(surface)?;
        Some((instance, SurfaceId { instance: surface.instance - instance.first, ..surface }))
    }

    /// A normal at a surface, from the coordinates of the geometry that holds the surface's primitive to those of this one, at
    /// a time of the shutter's: of any length.
    #[inline]
    pub fn placed_normal(&self, surface: SurfaceId, normal: Vec3<f64>, time: f64) -> Vec3<f64> {
        let Some((instance, inner)) = self.enter_instance(surface) else { return normal };
        instance.placement_at(time).normal(instance.geometry().placed_normal(inner, normal, time))
    }

    /// A vector along a surface, carried as [`Geometry::placed_normal`] carries normals: as the points of the surface move.
    #[inline]
    pub fn placed_vector(&self, surface: SurfaceId, vector: Vec3<f64>, time: f64) -> Vec3<f64> {
        let Some((instance, inner)) = self.enter_instance(surface) else { return vector };
        instance.placement_at(time).vector(instance.geometry().placed_vector(inner, vector, time))
    }

    /// A point of a surface, carried as [`Geometry::placed_normal`] carries normals. [`Geometry::local_point`] carries it back.
    #[inline]
    pub fn placed_point(&self, surface: SurfaceId, point: Vec3<f64>, time: f64) -> Vec3<f64> {
        let Some((instance, inner)) = self.enter_instance(surface) else { return point };
        instance.placement_at(time).point(instance.geometry().placed_point(inner, point, time))
    }

    /// A point of this geometry in the coordinates of the geometry that holds the surface's primitive, at a time.
    #[inline]
    pub fn local_point(&self, surface: SurfaceId, point: Vec3<f64>, time: f64) -> Vec3<f64> {
        let Some((instance, inner)) = self.enter_instance(surface) else { return point };
        instance.geometry().local_point(inner, instance.placement_at(time).local_point(point), time)
    }

    /// A vector, carried as [`Geometry::local_point`] carries points.
    #[inline]
    pub fn local_vector(&self, surface: SurfaceId, vector: Vec3<f64>, time: f64) -> Vec3<f64> {
        let Some((instance, inner)) = self.enter_instance(surface) else { return vector };
        instance.geometry().local_vector(inner, instance.placement_at(time).local_vector(vector), time)
    }

    /// The primitive of a surface, in the coordinates of the geometry that holds it.
    pub fn primitive_of(&self, surface: SurfaceId) -> &Primitive {
        match self.enter_instance(surface) {
            None => self.primitive(surface.primitive),
            Some((instance, inner)) => instance.geometry().primitive_of(inner),
        }
    }

    /// A primitive's own parameters at a point of this geometry that lies on it, at a time: what a hit of it there carries, to rounding.
    /// 0 of what has none of its own.
    pub fn parameters(&self, surface: SurfaceId, point: Vec3<f64>, time: f64) -> [f64; 2] {
        match self.enter_instance(surface) {
            None => self.primitive(surface.primitive).parameters(point),
            Some((instance, inner)) => {
                instance.geometry().parameters(inner, instance.placement_at(time).local_point(point), time)
            }
        }
    }

    /// What serves few primitives instead of a tree.
    #[inline]
    pub(crate) fn small_scene(&self) -> Option<&SmallScene> {
        self.small_scene.as_ref()
    }

    /// The instruction set.
    #[inline]
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Wrong on purpose, for tests: see [`SmallScene::forget_rounding`].
    #[cfg(test)]
    pub(crate) fn forget_rounding(&mut self) {
        self.small_scene.iter_mut().for_each(SmallScene::forget_rounding);
    }

    /// The tree, if there is one.
    #[inline]
    pub(crate) fn tree(&self) -> Option<&WideTree> {
        self.tree.as_ref()
    }

    /// The primitives, in the order of their ids.
    #[inline]
    pub(crate) fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }
}
