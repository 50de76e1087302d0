//! The door: a set of primitives that answers ray queries.

use crate::best::{Best, Found};
use crate::build::{Costs, Item, LEAF_LIMIT, TreeBuilder, build, build_fast};
use crate::frame::Frame;
use crate::optimize::improved;
use crate::query::{Query, RawHit};
use crate::ray::ExactPoint;
use crate::statistics::PrimitiveStatistics;
use crate::traverse::{self, FLAT_LIMIT, Flat, Visit, level};
use crate::wide::WideTree;
use crate::{Aabb, Hit, Instance, Passed, Primitive, PrimitiveId, Ray, SurfaceId, SurfacePoint};
use etalon_optics::{Real, Vec3};
use etalon_simd::Level;
use rayon::prelude::*;

/// Up to this many primitives, instances among them, are tested one by one, without a tree.
const TREELESS_LIMIT: usize = 8;
/// Most boxes of an outline.
const OUTLINE_LIMIT: usize = 96;
/// Most instances within each other: a ray descends through them by recursion.
pub const MAX_NESTING: u32 = 32;

/// Why primitives cannot be built into a [`Geometry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GeometryError {
    /// More primitives than ids.
    #[error("{0} primitives are more than the 2^29 that can be indexed")]
    TooMany(usize),
    /// More instances, those within instances counted wherever they are placed, than numbers for them.
    #[error("{0} placed instances are more than the 2^31 that can be numbered")]
    TooManyInstances(u64),
    /// Instances within instances, too many of them.
    #[error("instances within instances, {0} of them: more than {MAX_NESTING}")]
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
    flat: Option<Flat>,
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
    /// Builds the accelerator. No primitives at all are allowed.
    ///
    /// # Errors
    /// If there are more than 2²⁹ primitives, more than 2³¹ instances, or more than [`MAX_NESTING`] of them within each
    /// other.
    pub fn build(primitives: Vec<Primitive>) -> Result<Self, GeometryError> {
        Self::build_by(primitives, TreeBuilder::Thorough)
    }

    /// [`Geometry::build`] with a choice of the tree's builder. The hits of rays do not depend on it. Of a geometry that is placed by
    /// instances, the boxes of these follow the tree: there the last bits of a hit at the edge of a box may.
    ///
    /// # Errors
    /// As [`Geometry::build`].
    pub fn build_by(primitives: Vec<Primitive>, builder: TreeBuilder) -> Result<Self, GeometryError> {
        Self::build_as(primitives, FLAT_LIMIT, builder)
    }

    /// [`Geometry::build`] with a tree above another number of primitives: for tests, which want trees of few.
    ///
    /// # Errors
    /// As [`Geometry::build`].
    #[doc(hidden)]
    pub fn build_with(primitives: Vec<Primitive>, flat_limit: usize) -> Result<Self, GeometryError> {
        Self::build_as(primitives, flat_limit, TreeBuilder::Thorough)
    }

    pub(crate) fn build_as(
        mut primitives: Vec<Primitive>,
        flat_limit: usize,
        builder: TreeBuilder,
    ) -> Result<Self, GeometryError> {
        if primitives.len() > 1 << 29 {
            return Err(GeometryError::TooMany(primitives.len()));
        }
        let statistics = PrimitiveStatistics::of(&primitives);
        let (mut instances, mut instance_count, mut nesting) = (Vec::with_capacity(statistics.instances), 1, 0);
        let may_be_instances = if statistics.instances > 0 { primitives.as_mut_slice() } else { &mut [] };
        for (index, primitive) in may_be_instances.iter_mut().enumerate() {
            if let Primitive::Instance(instance) = primitive {
                instances.push(index as u32);
                instance.first = instance_count as u32;
                // Each is at most 2³¹, and they are checked as they come: no overflow.
                instance_count += instance.count();
                nesting = nesting.max(instance.geometry().nesting + 1);
                if instance_count > 1 << 31 {
                    return Err(GeometryError::TooManyInstances(instance_count));
                }
            }
        }
        if nesting > MAX_NESTING {
            return Err(GeometryError::TooDeep(nesting));
        }
        let bounds = statistics.bounds;
        let level = level::best();
        let is_flat = instances.is_empty() && primitives.len() <= flat_limit;
        let flat = bounds.filter(|_| is_flat).map(|bounds| Flat::new(&primitives, bounds));
        let mut outline = Vec::new();
        let tree = bounds.filter(|_| !is_flat && primitives.len() > TREELESS_LIMIT).map(|bounds| {
            let frame = Frame::around(bounds);
            // What is within an instance costs far more than a node.
            let instance_leaf = |p: &Primitive| matches!(p, Primitive::Instance(_));
            let item =
                |(id, p): (usize, &Primitive)| Item::new(&frame.enclose(p.bounds()), id as u32, instance_leaf(p));
            let items = primitives.par_iter().enumerate().map(item).collect();
            let costs = costs(&statistics);
            let binary = match builder {
                TreeBuilder::Thorough => improved(build(items, costs, level), costs, level),
                TreeBuilder::Fast => build_fast(items, costs, level),
            };
            outline = binary.outline(OUTLINE_LIMIT).into_iter().map(|b| frame.unscaled_box(b)).collect();
            WideTree::collapse(frame, &binary, &primitives, &statistics, costs, level::lanes(level))
        });
        if tree.is_none() {
            outline = if primitives.len() <= OUTLINE_LIMIT {
                primitives.iter().map(Primitive::bounds).collect()
            } else {
                bounds.into_iter().collect()
            };
        }
        Ok(Self { primitives, bounds, tree, flat, level, instances, instance_count, nesting, outline, label: 0 })
    }

    /// The same geometry with a number of the caller's, by which points on its surfaces tell that they are its.
    #[must_use]
    pub fn with_label(self, label: u32) -> Self {
        Self { label, ..self }
    }

    /// The number given to [`Geometry::with_label`], 0 without.
    pub fn label(&self) -> u32 {
        self.label
    }

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
        let tree =
            self.tree.as_ref().map_or(0, WideTree::memory_bytes) + self.flat.as_ref().map_or(0, Flat::memory_bytes);
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
    fn instance_of(&self, surface: SurfaceId) -> Option<(u32, &Instance)> {
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

    /// A normal at a surface, from the coordinates of the geometry that holds the surface's primitive to those of this one, at
    /// a time of the shutter's: of any length.
    #[inline]
    pub fn placed_normal(&self, surface: SurfaceId, normal: Vec3<f64>, time: f64) -> Vec3<f64> {
        if surface.instance == 0 { normal } else { self.normal_in_instance(surface, normal, time) }
    }

    fn normal_in_instance(&self, surface: SurfaceId, normal: Vec3<f64>, time: f64) -> Vec3<f64> {
        let Some((_, instance)) = self.instance_of(surface) else { return normal };
        let inner = SurfaceId { instance: surface.instance - instance.first, ..surface };
        instance.placement_at(time).normal(instance.geometry().placed_normal(inner, normal, time))
    }

    /// A vector along a surface, carried as [`Geometry::placed_normal`] carries normals: as the points of the surface move.
    #[inline]
    pub fn placed_vector(&self, surface: SurfaceId, vector: Vec3<f64>, time: f64) -> Vec3<f64> {
        if surface.instance == 0 {
            return vector;
        }
        let Some((_, instance)) = self.instance_of(surface) else { return vector };
        let inner = SurfaceId { instance: surface.instance - instance.first, ..surface };
        instance.placement_at(time).vector(instance.geometry().placed_vector(inner, vector, time))
    }

    /// A point of this geometry in the coordinates of the geometry that holds the surface's primitive, at a time.
    #[inline]
    pub fn local_point(&self, surface: SurfaceId, point: Vec3<f64>, time: f64) -> Vec3<f64> {
        if surface.instance == 0 {
            return point;
        }
        let Some((_, instance)) = self.instance_of(surface) else { return point };
        let inner = SurfaceId { instance: surface.instance - instance.first, ..surface };
        instance.geometry().local_point(inner, instance.placement_at(time).local_point(point), time)
    }

    /// A primitive's own parameters at a point of this geometry that lies on it, at a time: what a hit of it there carries, to rounding.
    /// 0 of what has none of its own.
    pub fn parameters(&self, surface: SurfaceId, point: Vec3<f64>, time: f64) -> [f64; 2] {
        if surface.instance == 0 {
            return self.primitive(surface.primitive).parameters(point);
        }
        let Some((_, instance)) = self.instance_of(surface) else { return [0.0; 2] };
        let inner = SurfaceId { instance: surface.instance - instance.first, ..surface };
        instance.geometry().parameters(inner, instance.placement_at(time).local_point(point), time)
    }

    /// The closest hit along a ray.
    ///
    /// A ray of which no point is defined (NaN, zero direction) hits nothing, nor does one that starts beyond 2²⁰⁰ m or
    /// whose direction is outside 2^±900; nor is there a hit whose parameter `R` cannot represent.
    pub fn closest_hit<R: Real>(&self, ray: &Ray<R>) -> Option<Hit<R>> {
        if let Some(tree) = &self.tree {
            return traverse::closest(self.level, tree, &self.primitives, ray);
        }
        let query = Query::new(ray)?;
        let (hit, surface) = self.closest(&query)?;
        Hit::new(RawHit { t: hit.t * query.scale, ..hit }, surface)
    }

    /// Calls `visit` for every hit with `from` ≤ t < `t_max`, in no particular order. `visit` returns the end of the distances
    /// that still matter, which becomes the new `t_max`: that of the ray to see all hits, 0 to see no more.
    ///
    /// A sphere or a cylinder may be hit twice. Distances are those that [`Geometry::closest_hit`] finds, bit for bit.
    pub fn all_hits(&self, ray: &Ray<f64>, from: f64, mut visit: impl FnMut(Hit<f64>) -> f64) {
        let Some(query) = Query::new(ray) else { return };
        let mut end = query.t_max;
        self.all(&query, from / query.scale, &mut |hit, surface| {
            if let Some(hit) = Hit::new(RawHit { t: hit.t * query.scale, ..hit }, surface) {
                end = visit(hit) / query.scale;
            }
            end
        });
    }

    /// The closest hit that a walk along a ray has not yet passed; of several at the same distance, that of the lowest
    /// [`SurfaceId`].
    ///
    /// The ray stays as it is, so what lies at the same distance as a surface that the walk passes is still ahead of it: each
    /// surface is met exactly once, however many coincide.
    pub fn next_hit(&self, ray: &Ray<f64>, passed: &Passed) -> Option<Hit<f64>> {
        if passed.is_nothing() {
            return self.closest_hit(ray);
        }
        let mut next: Option<Hit<f64>> = None;
        self.all_hits(ray, passed.from(), |hit| {
            let closer = next.is_none_or(|next| (hit.t, hit.surface) < (next.t, next.surface));
            if closer && !passed.holds(&hit) {
                next = Some(hit);
            }
            next.map_or(ray.t_max, |next| next.t.next_up())
        });
        next
    }

    /// Whether anything but the surface aimed at lies on a ray before `t_max`.
    pub fn occluded<R: Real>(&self, ray: &Ray<R>) -> bool {
        match &self.tree {
            Some(tree) => traverse::any(self.level, tree, &self.primitives, ray),
            None => Query::new(ray).is_some_and(|query| self.any(&query)),
        }
    }

    /// [`Geometry::closest_hit`] and [`Geometry::occluded`] by testing every primitive (what instances place is not taken
    /// apart): for tests.
    #[doc(hidden)]
    pub fn one_by_one(&self, ray: &Ray<f64>) -> (Option<Hit<f64>>, bool) {
        let Some(query) = Query::new(ray) else { return (None, false) };
        let hit = self.closest_flat(&query).map(|(RawHit { t, uv }, surface)| Hit { t: t * query.scale, surface, uv });
        (hit.filter(|hit| hit.t < f64::INFINITY), self.any_flat(&query))
    }

    /// The surface at a hit, as [`Geometry::closest_hit`] returned it for `ray`.
    ///
    /// # Panics
    /// If the hit is not one of this geometry's with this ray.
    pub fn surface<R: Real>(&self, ray: &Ray<R>, hit: &Hit<R>) -> SurfacePoint<R> {
        // What the rounding of t displaces along the ray would turn the normal of a curved surface.
        let refine = R::UNIT_ROUNDOFF.to_f64() > f64::UNIT_ROUNDOFF;
        let primitive = self.primitives.get(hit.surface.primitive.0 as usize).filter(|_| hit.surface.instance == 0);
        if let Some(primitive) = primitive.filter(|p| !(refine && p.is_curved())) {
            let p = ray.origin.to_f64() + ray.direction.to_f64() * hit.t.to_f64();
            let point = match &self.flat {
                Some(flat) => flat.surface(&self.primitives, hit.surface.primitive, p),
                None => primitive.surface(p),
            };
            return SurfacePoint::rounded(&point, hit.surface, self.label, ray.time);
        }
        let found = Query::new(ray)
            .and_then(|query| self.exact_point(&query, hit.t.to_f64() / query.scale, refine, hit.surface));
        let Some((point, label)) = found else { panic!("the hit is of another geometry or another ray") };
        SurfacePoint::rounded(&point, hit.surface, label, ray.time)
    }

    /// The surface at parameter `t` of a query, and the label of the geometry that it belongs to; `refine` if `t` is
    /// rounded to less than `f64`.
    pub(crate) fn exact_point(
        &self,
        query: &Query,
        mut t: f64,
        refine: bool,
        surface: SurfaceId,
    ) -> Option<(ExactPoint, u32)> {
        if surface.instance > 0 {
            let (_, instance) = self.instance_of(surface)?;
            return instance.exact_point(query, t, refine, surface);
        }
        let primitive = self.primitives.get(surface.primitive.0 as usize)?;
        if refine && primitive.is_curved() {
            let precise = primitive.intersect(query, query.t_max, query.leaves == surface.primitive);
            t = precise.map_or(t, |hit| hit.t);
        }
        Some((primitive.surface(query.origin + query.direction * t), self.label))
    }

    /// The closest hit, by testing every primitive: the specification that the tree is held against.
    pub(crate) fn closest_flat(&self, query: &Query) -> Option<Found> {
        let mut best = Best::new(query.t_max);
        for i in 0..self.primitives.len() as u32 {
            best.test(&self.primitives, query, PrimitiveId(i));
        }
        best.found()
    }

    /// Whether anything occludes, by testing every primitive.
    pub(crate) fn any_flat(&self, query: &Query) -> bool {
        (0..self.primitives.len() as u32).any(|i| traverse::occludes(&self.primitives, query, PrimitiveId(i)))
    }

    pub(crate) fn closest(&self, query: &Query) -> Option<Found> {
        match (&self.tree, &self.flat) {
            (Some(tree), _) => traverse::closest(self.level, tree, &self.primitives, query),
            (_, Some(flat)) => flat.closest(self.level, &self.primitives, query),
            _ => self.closest_flat(query),
        }
    }

    /// See [`traverse::all`].
    pub(crate) fn all(&self, query: &Query, from: f64, visit: &mut Visit<'_>) -> f64 {
        if let Some(tree) = &self.tree {
            return traverse::all(self.level, tree, &self.primitives, query, from, visit);
        }
        let ids = 0..self.primitives.len() as u32;
        ids.fold(query.t_max, |end, id| traverse::all_of(&self.primitives, query, PrimitiveId(id), (from, end), visit))
    }

    /// Whether anything but the surface aimed at is hit.
    pub(crate) fn any(&self, query: &Query) -> bool {
        match (&self.tree, &self.flat) {
            (Some(tree), _) => traverse::any(self.level, tree, &self.primitives, query),
            (_, Some(flat)) => flat.any(self.level, &self.primitives, query),
            _ => self.any_flat(query),
        }
    }

    /// What serves few primitives, and the instruction set that does.
    pub(crate) fn flat(&self) -> Option<(&Flat, Level)> {
        self.flat.as_ref().map(|flat| (flat, self.level))
    }

    /// The instruction set.
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Wrong on purpose, for tests: see [`Flat::forget_rounding`].
    #[cfg(test)]
    pub(crate) fn forget_rounding(&mut self) {
        self.flat.iter_mut().for_each(Flat::forget_rounding);
    }

    /// The tree, if there is one.
    pub(crate) fn tree(&self) -> Option<&WideTree> {
        self.tree.as_ref()
    }

    /// The primitives, in the order of their ids.
    pub(crate) fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }
}

/// What the tree's builder weighs: a leaf tests flat shapes or spheres at once, but cylinders one by one. As many at once, whatever
/// the instruction set: what a ray meets of an instance must not depend on that, nor does the tree of which its box is made.
fn costs(statistics: &PrimitiveStatistics) -> Costs {
    let most = 2 * statistics.cylinders < statistics.count - statistics.instances;
    Costs { block: if most { LEAF_LIMIT as u32 } else { 1 }, node: 0.35 }
}
