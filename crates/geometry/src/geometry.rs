//! The door: a set of primitives that answers ray queries.

use crate::build::{Costs, build};
use crate::frame::Frame;
use crate::query::{Query, RawHit};
use crate::traverse;
use crate::wide::WideTree;
use crate::{Aabb, Hit, Primitive, PrimitiveId, Ray, SurfacePoint};
use etalon_optics::Real;

/// Up to this many primitives are tested one by one, without a tree.
const FLAT_LIMIT: usize = 8;

/// A hit and its primitive.
pub(crate) type Found = (RawHit, PrimitiveId);

/// Why primitives cannot be built into a [`Geometry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GeometryError {
    /// More primitives than ids.
    #[error("{0} primitives are more than the 2^29 that can be indexed")]
    TooMany(usize),
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
}

impl Geometry {
    /// Builds the accelerator. No primitives at all are allowed.
    ///
    /// # Errors
    /// If there are more than 2²⁹ primitives.
    pub fn build(primitives: Vec<Primitive>) -> Result<Self, GeometryError> {
        if primitives.len() > 1 << 29 {
            return Err(GeometryError::TooMany(primitives.len()));
        }
        let bounds = primitives.iter().map(Primitive::bounds).reduce(Aabb::union);
        let tree = bounds.filter(|_| primitives.len() > FLAT_LIMIT).map(|bounds| {
            let frame = Frame::around(bounds);
            let boxes: Vec<_> = primitives.iter().map(|p| frame.enclose(p.bounds())).collect();
            let binary = build(&boxes, costs(&primitives));
            drop(boxes);
            WideTree::collapse(frame, &binary, &primitives)
        });
        Ok(Self { primitives, bounds, tree })
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

    /// Memory held, bytes: the primitives and the accelerator.
    pub fn memory_bytes(&self) -> usize {
        let tree = self.tree.as_ref().map_or(0, WideTree::memory_bytes);
        size_of::<Self>() + self.primitives.capacity() * size_of::<Primitive>() + tree
    }

    /// The closest hit along a ray.
    ///
    /// A ray of which no point is defined (NaN, zero direction) hits nothing, nor does one that starts beyond 2²⁰⁰ m or
    /// whose direction is outside 2^±900.
    pub fn closest_hit<R: Real>(&self, ray: &Ray<R>) -> Option<Hit<R>> {
        let found = match &self.tree {
            Some(tree) => traverse::closest(tree, &self.primitives, ray),
            None => {
                let query = Query::new(ray)?;
                self.closest_flat(&query).map(|(hit, id)| (RawHit { t: hit.t * query.scale, ..hit }, id))
            }
        };
        found.map(|(hit, primitive)| Hit { t: R::from_f64(hit.t), primitive, uv: hit.uv.map(R::from_f64) })
    }

    /// Whether anything but the primitive aimed at lies on a ray before `t_max`.
    pub fn occluded<R: Real>(&self, ray: &Ray<R>) -> bool {
        match &self.tree {
            Some(tree) => traverse::any(tree, &self.primitives, ray),
            None => Query::new(ray).is_some_and(|query| self.any_flat(&query)),
        }
    }

    /// The surface at a hit, as [`Geometry::closest_hit`] returned it for `ray`.
    pub fn surface<R: Real>(&self, ray: &Ray<R>, hit: &Hit<R>) -> SurfacePoint<R> {
        let primitive = self.primitive(hit.primitive);
        let (origin, direction) = (ray.origin.to_f64(), ray.direction.to_f64());
        let mut t = hit.t.to_f64();
        if R::UNIT_ROUNDOFF.to_f64() > f64::UNIT_ROUNDOFF
            && let Primitive::Sphere(_) = primitive
        {
            // What the rounding of t displaces along the ray would turn the normal of a curved surface.
            let precise = Query::new(ray).and_then(|query| {
                let hit = primitive.intersect(&query, query.t_max, query.leaves == hit.primitive)?;
                Some(hit.t * query.scale)
            });
            t = precise.unwrap_or(t);
        }
        primitive.surface(origin + direction * t, hit.primitive)
    }

    /// The closest hit, by testing every primitive: the specification that the tree is held against.
    pub(crate) fn closest_flat(&self, query: &Query) -> Option<Found> {
        let mut best = Best::new(query);
        for i in 0..self.primitives.len() as u32 {
            best.test(&self.primitives, query, PrimitiveId(i));
        }
        best.hit
    }

    /// Whether anything occludes, by testing every primitive.
    pub(crate) fn any_flat(&self, query: &Query) -> bool {
        (0..self.primitives.len() as u32).any(|i| traverse::occludes(&self.primitives, query, PrimitiveId(i)))
    }

    #[cfg(test)]
    pub(crate) fn closest(&self, query: &Query) -> Option<Found> {
        match &self.tree {
            Some(tree) => traverse::closest(tree, &self.primitives, query),
            None => self.closest_flat(query),
        }
    }

    /// The tree, for tests of its traversals.
    #[cfg(test)]
    pub(crate) fn tree(&self) -> Option<&WideTree> {
        self.tree.as_ref()
    }

    /// The primitives, in the order of their ids.
    #[cfg(test)]
    pub(crate) fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }
}

/// What the tree's builder weighs: a leaf tests eight triangles or spheres at once, but other primitives one by one.
fn costs(primitives: &[Primitive]) -> Costs {
    let filtered = |p: &&Primitive| matches!(p, Primitive::Triangle(_) | Primitive::Sphere(_));
    let most = primitives.iter().filter(filtered).count() > primitives.len() / 2;
    Costs { block: if most { 8 } else { 1 }, leaf_limit: 8, node: 0.5 }
}

/// The closest hit so far.
pub(crate) struct Best {
    pub(crate) hit: Option<(RawHit, PrimitiveId)>,
    pub(crate) t_max: f64,
}

impl Best {
    pub(crate) fn new(query: &Query) -> Self {
        Self { hit: None, t_max: query.t_max }
    }

    /// Tests a primitive and tells whether its hit is the best so far.
    #[inline]
    pub(crate) fn test(&mut self, primitives: &[Primitive], query: &Query, id: PrimitiveId) -> bool {
        self.take(id, |t_max| primitives[id.0 as usize].intersect(query, t_max, query.leaves == id))
    }

    /// Takes what a test with a limit finds for a primitive, if it is the best so far.
    #[inline(always)]
    pub(crate) fn take(&mut self, id: PrimitiveId, intersect: impl FnOnce(f64) -> Option<RawHit>) -> bool {
        // An equal distance counts for a lower id, whatever the order of the tests.
        let t_max = match self.hit {
            Some((hit, best)) if id < best => hit.t.next_up(),
            _ => self.t_max,
        };
        let found = intersect(t_max);
        if let Some(hit) = found {
            self.hit = Some((hit, id));
            self.t_max = hit.t;
        }
        found.is_some()
    }
}
