//! The door: a set of primitives that answers ray queries.

use crate::build::{BinaryTree, Costs, build};
use crate::frame::{Frame, FrameRay};
use crate::query::{Query, RawHit};
use crate::{Aabb, Hit, Primitive, PrimitiveId, Ray, SurfacePoint};
use etalon_optics::Real;

/// Up to this many primitives are tested one by one, without a tree.
const FLAT_LIMIT: usize = 8;
/// Entries of the traversal's stack: the deepest tree has fewer levels than this, and each level leaves at most one.
const STACK: usize = 96;

/// Why primitives cannot be built into a [`Geometry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GeometryError {
    /// More primitives than ids.
    #[error("{0} primitives are more than the 2^31 that can be indexed")]
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
    tree: Option<(Frame, BinaryTree)>,
}

impl Geometry {
    /// Builds the accelerator. No primitives at all are allowed.
    ///
    /// # Errors
    /// If there are more than 2³¹ primitives.
    pub fn build(primitives: Vec<Primitive>) -> Result<Self, GeometryError> {
        if primitives.len() > 1 << 31 {
            return Err(GeometryError::TooMany(primitives.len()));
        }
        let bounds = primitives.iter().map(Primitive::bounds).reduce(Aabb::union);
        let tree = bounds.filter(|_| primitives.len() > FLAT_LIMIT).map(|bounds| {
            let frame = Frame::around(bounds);
            let boxes: Vec<_> = primitives.iter().map(|p| frame.enclose(p.bounds())).collect();
            (frame, build(&boxes, Costs { block: 1, leaf_limit: 4, node: 1.0 }))
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
        let tree = self.tree.as_ref().map_or(0, |(_, tree)| {
            tree.nodes.capacity() * size_of::<crate::build::Node>() + tree.order.capacity() * size_of::<u32>()
        });
        size_of::<Self>() + self.primitives.capacity() * size_of::<Primitive>() + tree
    }

    /// The closest hit along a ray. A ray of which no point is defined (NaN, zero direction) hits nothing.
    pub fn closest_hit<R: Real>(&self, ray: &Ray<R>) -> Option<Hit<R>> {
        let query = Query::new(ray)?;
        self.closest(&query).map(|(hit, primitive)| Hit {
            t: R::from_f64(hit.t * query.scale),
            primitive,
            uv: hit.uv.map(R::from_f64),
        })
    }

    /// Whether anything but the primitive aimed at lies on a ray before `t_max`.
    pub fn occluded<R: Real>(&self, ray: &Ray<R>) -> bool {
        Query::new(ray).is_some_and(|query| self.any(&query))
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
    pub(crate) fn closest_flat(&self, query: &Query) -> Option<(RawHit, PrimitiveId)> {
        let mut best = Best::new(query);
        for i in 0..self.primitives.len() as u32 {
            best.test(self, query, i);
        }
        best.hit
    }

    /// Whether anything occludes, by testing every primitive.
    pub(crate) fn any_flat(&self, query: &Query) -> bool {
        (0..self.primitives.len() as u32).any(|i| self.occludes(query, i))
    }

    fn occludes(&self, query: &Query, i: u32) -> bool {
        let id = PrimitiveId(i);
        id != query.aims_at && self.primitives[i as usize].intersect(query, query.t_max, query.leaves == id).is_some()
    }

    pub(crate) fn closest(&self, query: &Query) -> Option<(RawHit, PrimitiveId)> {
        let Some((frame, tree)) = &self.tree else { return self.closest_flat(query) };
        let ray = frame.enter(query)?;
        let mut best = Best::new(query);
        let mut limit = ray.distance(best.t_max);
        let mut stack = Stack::new();
        let mut next = ray.enters(&tree.nodes[0].bounds, limit).map(|near| (0, near));
        while let Some((index, near)) = next {
            if near <= limit {
                let node = &tree.nodes[index as usize];
                if node.count > 0 {
                    let first = node.first as usize;
                    for &i in &tree.order[first..first + node.count as usize] {
                        if best.test(self, query, i) {
                            limit = ray.distance(best.t_max);
                        }
                    }
                } else {
                    let [mut near_child, mut far_child] = children(tree, &ray, index, limit);
                    if far_child.is_some_and(|f| near_child.is_none_or(|n| f.1 < n.1)) {
                        (near_child, far_child) = (far_child, near_child);
                    }
                    if let Some(child) = far_child {
                        stack.push(child);
                    }
                    if near_child.is_some() {
                        next = near_child;
                        continue;
                    }
                }
            }
            next = stack.pop();
        }
        best.hit
    }

    fn any(&self, query: &Query) -> bool {
        let Some((frame, tree)) = &self.tree else { return self.any_flat(query) };
        let Some(ray) = frame.enter(query) else { return false };
        let limit = ray.distance(query.t_max);
        let mut stack = Stack::new();
        let mut next = ray.enters(&tree.nodes[0].bounds, limit).map(|near| (0, near));
        while let Some((index, _)) = next {
            let node = &tree.nodes[index as usize];
            if node.count > 0 {
                let first = node.first as usize;
                if tree.order[first..first + node.count as usize].iter().any(|&i| self.occludes(query, i)) {
                    return true;
                }
            } else {
                children(tree, &ray, index, limit).into_iter().flatten().for_each(|child| stack.push(child));
            }
            next = stack.pop();
        }
        false
    }
}

/// The children of an inner node that the ray meets, with the distances at which it enters them.
fn children(tree: &BinaryTree, ray: &FrameRay, node: u32, limit: f32) -> [Option<(u32, f32)>; 2] {
    [node + 1, tree.nodes[node as usize].first]
        .map(|child| ray.enters(&tree.nodes[child as usize].bounds, limit).map(|near| (child, near)))
}

/// The closest hit so far.
struct Best {
    hit: Option<(RawHit, PrimitiveId)>,
    t_max: f64,
}

impl Best {
    fn new(query: &Query) -> Self {
        Self { hit: None, t_max: query.t_max }
    }

    /// Tests a primitive and tells whether its hit is the best so far.
    #[inline]
    fn test(&mut self, geometry: &Geometry, query: &Query, i: u32) -> bool {
        let id = PrimitiveId(i);
        // An equal distance counts for a lower id, whatever the order of the tests.
        let t_max = match self.hit {
            Some((hit, best)) if id < best => hit.t.next_up(),
            _ => self.t_max,
        };
        let found = geometry.primitives[i as usize].intersect(query, t_max, query.leaves == id);
        if let Some(hit) = found {
            self.hit = Some((hit, id));
            self.t_max = hit.t;
        }
        found.is_some()
    }
}

/// A stack of nodes and the distances at which the ray enters them.
struct Stack {
    entries: [(u32, f32); STACK],
    length: usize,
}

impl Stack {
    fn new() -> Self {
        Self { entries: [(0, 0.0); STACK], length: 0 }
    }

    #[inline]
    fn push(&mut self, entry: (u32, f32)) {
        self.entries[self.length] = entry;
        self.length += 1;
    }

    #[inline]
    fn pop(&mut self) -> Option<(u32, f32)> {
        self.length = self.length.checked_sub(1)?;
        Some(self.entries[self.length])
    }
}
