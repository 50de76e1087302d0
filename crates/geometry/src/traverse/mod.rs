//! Traversal of the wide tree, once for all instruction sets.
//!
//! Boxes and triangles are only *filtered* in `f32`: a filter errs on the side of keeping, by derived bounds, and what it
//! keeps is decided in `f64`. Filters may therefore differ between instruction sets, hits cannot.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod leaf;
mod portable;
mod stack;
mod vector;

use crate::build::MAX_DEPTH;
use crate::frame::FrameRay;
use crate::geometry::{Best, Found};
use crate::query::{Four, Query, RawHit};
use crate::wide::{LEAF, LEAF_WIDTH, Leaf8, NODE_WIDTH, Node16, WideTree};
use crate::{Primitive, PrimitiveId, Ray, Triangle};
use etalon_optics::Real;
use leaf::candidates;
use stack::{Room, Stack};
use vector::Vector;

/// Levels of the stack that serves all but degenerate trees, and of the one that serves any: as many as a binary tree has.
const LEVELS: [usize; 2] = [12, MAX_DEPTH];

/// The children of a node that a ray meets.
struct Entered {
    /// One bit a child.
    mask: u32,
    /// The distances at which it enters them, not above the true ones.
    near: [f32; NODE_WIDTH],
}

/// The primitives of a leaf that a ray may hit.
struct Candidates {
    /// Those that may be hit, one bit each.
    mask: u32,
    /// Those among them of which no distance is known.
    unbounded: u32,
    /// Those among them that are certainly hit between the origin and the certain limit.
    certain: u32,
    /// Those that are certainly not hit if it is they that the ray leaves.
    left: u32,
    /// Distances not above the true ones.
    near: [f32; LEAF_WIDTH],
    /// Distances not below the true ones of those certainly hit.
    far: [f32; LEAF_WIDTH],
}

impl Candidates {
    const NONE: Self =
        Self { mask: 0, unbounded: 0, certain: 0, left: 0, near: [0.0; LEAF_WIDTH], far: [0.0; LEAF_WIDTH] };
}

/// The filters of an instruction set.
trait Filters: Copy + Into<<Self::Vector as Vector>::Token> + Into<<Self::Four as Four>::Token> {
    /// The ray as the filter of nodes wants it.
    type Ray: Copy;
    /// Eight floats.
    type Vector: Vector;
    /// Four numbers.
    type Four: Four;
    /// Prepares a ray.
    fn ray(self, ray: &FrameRay) -> Self::Ray;
    /// The children of a node that the ray meets in [0, `limit`].
    fn enter(self, ray: &Self::Ray, node: &Node16, limit: f32) -> Entered;
    /// Announces that an item will be read.
    fn prefetch<T>(self, item: &T);
}

/// What a traversal starts with: a ray, or a query made of one.
pub(crate) trait Start: Copy {
    /// The query; none if it cannot be computed with.
    fn query(self) -> Option<Query>;
    /// A distance along the query's direction in the units of what it starts with.
    fn distance(self, query: &Query, t: f64) -> f64;
}

impl Start for &Query {
    #[inline(always)]
    fn query(self) -> Option<Query> {
        Some(*self)
    }

    #[inline(always)]
    fn distance(self, _: &Query, t: f64) -> f64 {
        t
    }
}

impl<R: Real> Start for &Ray<R> {
    #[inline(always)]
    fn query(self) -> Option<Query> {
        Query::new(self)
    }

    #[inline(always)]
    fn distance(self, query: &Query, t: f64) -> f64 {
        t * query.scale
    }
}

/// The closest hit, its distance in the units of the start.
///
/// The query is made within, where its numbers can stay in registers.
#[inline]
pub(crate) fn closest<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
    #[cfg(target_arch = "x86_64")]
    if let Some(filters) = avx512::Avx512::detect() {
        return filters.closest(tree, primitives, start);
    } else if let Some(filters) = avx2::Avx2::detect() {
        return filters.closest(tree, primitives, start);
    }
    closest_portable(tree, primitives, start)
}

/// Whether anything but the primitive aimed at is hit.
#[inline]
pub(crate) fn any<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    #[cfg(target_arch = "x86_64")]
    if let Some(filters) = avx512::Avx512::detect() {
        return filters.any(tree, primitives, start);
    } else if let Some(filters) = avx2::Avx2::detect() {
        return filters.any(tree, primitives, start);
    }
    any_portable(tree, primitives, start)
}

/// [`closest`] on any machine.
pub(crate) fn closest_portable<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
    closest_with(portable::Portable, tree, primitives, start)
}

/// [`any`] on any machine.
pub(crate) fn any_portable<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    any_with(portable::Portable, tree, primitives, start)
}

/// [`closest`] with AVX2 alone; none without.
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) fn closest_avx2<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Option<Found>> {
    avx2::Avx2::detect().map(|filters| filters.closest(tree, primitives, start))
}

/// [`any`] with AVX2 alone; none without.
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) fn any_avx2<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> Option<bool> {
    avx2::Avx2::detect().map(|filters| filters.any(tree, primitives, start))
}

#[inline(always)]
fn closest_with<F: Filters, S: Start>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    start: S,
) -> Option<Found> {
    let query = start.query()?;
    let ray = tree.frame.enter(&query)?;
    let (mut hit, id) = if tree.depth <= LEVELS[0] {
        closest_on::<F, { LEVELS[0] * (NODE_WIDTH - 1) }>(filters, tree, primitives, &query, &ray)?
    } else {
        closest_deep(tree, primitives, &query)?
    };
    hit.t = start.distance(&query, hit.t);
    Some((hit, id))
}

#[inline(always)]
fn any_with<F: Filters, S: Start>(filters: F, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    let Some(query) = start.query() else { return false };
    let Some(ray) = tree.frame.enter(&query) else { return false };
    if tree.depth <= LEVELS[0] {
        any_on::<F, { LEVELS[0] }>(filters, tree, primitives, &query, &ray)
    } else {
        any_deep(tree, primitives, &query)
    }
}

/// Degenerate trees, by the portable filters.
#[cold]
#[inline(never)]
pub(crate) fn closest_deep(tree: &WideTree, primitives: &[Primitive], query: &Query) -> Option<Found> {
    let ray = tree.frame.enter(query)?;
    closest_on::<_, { LEVELS[1] * (NODE_WIDTH - 1) }>(portable::Portable, tree, primitives, query, &ray)
}

/// Degenerate trees, by the portable filters.
#[cold]
#[inline(never)]
pub(crate) fn any_deep(tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    tree.frame
        .enter(query)
        .is_some_and(|ray| any_on::<_, { LEVELS[1] }>(portable::Portable, tree, primitives, query, &ray))
}

/// A stack entry: the distance's bits above (those of non-negative numbers are ordered as they are), the child below.
#[inline(always)]
fn entry(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

/// What is likely to be the closest hit, though its exact distance is not yet known.
#[derive(Clone, Copy)]
struct Waiting {
    leaf: u32,
    lane: u32,
    /// Not above its distance.
    near: f32,
}

/// Hits whose decision in `f64` can wait until the end, when most of them are beyond another and what they need has been
/// fetched.
struct Pending {
    list: [Waiting; Self::LIMIT],
    count: usize,
}

impl Pending {
    /// Hits that `f32` cannot order are rare, more than two of them duplicates.
    const LIMIT: usize = 4;

    /// Decides those that are not beyond `limit`.
    #[cold]
    #[inline(never)]
    fn resolve(&mut self, best: &mut Best, tree: &WideTree, primitives: &[Primitive], query: &Query, limit: f32) {
        for waiting in &self.list[..self.count] {
            if waiting.near <= limit {
                decide(portable::Portable, best, tree, waiting.leaf, waiting.lane, primitives, query);
            }
        }
        self.count = 0;
    }
}

/// Decides in `f64` whether a lane of a leaf holds the closest hit so far.
#[inline(always)]
fn decide<F: Filters>(
    filters: F,
    best: &mut Best,
    tree: &WideTree,
    leaf: u32,
    lane: u32,
    primitives: &[Primitive],
    query: &Query,
) -> bool {
    let (leaf, lane) = (&tree.leaves()[leaf as usize], lane as usize);
    let id = leaf.id(lane);
    if leaf.is_exact(lane) {
        let found = intersect_exact(filters, tree, leaf, lane, primitives, query, best.limit(id));
        if let Some(hit) = found {
            best.set(hit, id);
        }
        found.is_some()
    } else {
        best.test(primitives, query, id)
    }
}

/// The intersection with a triangle whose vertices are exact in its leaf. The triangle lies elsewhere and is not touched, as
/// a rule.
#[inline(always)]
fn intersect_exact<F: Filters>(
    filters: F,
    tree: &WideTree,
    leaf: &Leaf8,
    lane: usize,
    primitives: &[Primitive],
    query: &Query,
    t_max: f64,
) -> Option<RawHit> {
    let triangle = || match &primitives[leaf.id(lane).0 as usize] {
        Primitive::Triangle(triangle) => triangle,
        _ => unreachable!("only triangles have exact vertices"),
    };
    let lanes = leaf.lanes(&tree.frame, lane, query);
    Triangle::intersect_lanes::<F::Four>(filters.into(), lanes, triangle, query, t_max)
}

/// [`decide`] where it is not the rule.
#[cold]
#[inline(never)]
fn decide_now(best: &mut Best, tree: &WideTree, leaf: u32, lane: u32, primitives: &[Primitive], query: &Query) -> bool {
    decide(portable::Portable, best, tree, leaf, lane, primitives, query)
}

/// Announces that a child that waits on the stack will be visited. Without it rays that share nothing are a tenth slower in
/// trees that no cache holds.
#[inline(always)]
fn prefetch<F: Filters>(filters: F, tree: &WideTree, child: u32) {
    if child & LEAF == 0 {
        filters.prefetch(&tree.nodes()[child as usize]);
    } else {
        filters.prefetch(&tree.leaves()[(child & !LEAF) as usize]);
    }
}

/// The closest hit, by a stack of children, nearest on top.
#[inline(always)]
fn closest_on<F: Filters, const N: usize>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
    frame_ray: &FrameRay,
) -> Option<Found> {
    let ray = filters.ray(frame_ray);
    let mut best = Best::new(query);
    let mut limit = frame_ray.distance(query.t_max);
    let certain_limit = frame_ray.distance_below(query.t_max);
    let nothing = Waiting { leaf: 0, lane: 0, near: 0.0 };
    let mut pending = Pending { list: [nothing; Pending::LIMIT], count: 0 };
    let (nodes, leaves) = (tree.nodes(), tree.leaves());
    let mut room = Room::<u64, N>::new();
    let mut stack = Stack::new(&mut room);
    let mut child = 0;
    loop {
        if child & LEAF == 0 {
            let node = &nodes[child as usize];
            let Entered { mut mask, near } = filters.enter(&ray, node, limit);
            if mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if mask == 0 {
                    child = node.children.0[lane];
                    continue;
                }
                let first = entry(near[lane], node.children.0[lane]);
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let second = entry(near[lane], node.children.0[lane]);
                let mut nearest = first.min(second);
                prefetch(filters, tree, first.max(second) as u32);
                let base = stack.len();
                stack.push(first.max(second));
                while mask != 0 {
                    let lane = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    let new = entry(near[lane], node.children.0[lane]);
                    prefetch(filters, tree, node.children.0[lane]);
                    stack.insert(base, nearest.max(new));
                    nearest = nearest.min(new);
                }
                child = nearest as u32;
                continue;
            }
        } else {
            let index = child & !LEAF;
            let leaf = &leaves[index as usize];
            let mut candidates = candidates(filters, frame_ray, leaf, limit, certain_limit);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                let id = leaf.id(lane);
                if candidates.near[lane % LEAF_WIDTH] > limit && candidates.unbounded >> lane & 1 == 0 {
                    continue;
                }
                if id == query.leaves && candidates.left >> lane & 1 == 1 {
                    continue;
                }
                if candidates.certain >> lane & 1 == 1 && id != query.leaves {
                    // Its exact distance can wait until the end, when it has been fetched.
                    if !leaf.is_exact(lane) {
                        filters.prefetch(&primitives[id.0 as usize]);
                    }
                    if pending.count == Pending::LIMIT {
                        pending.resolve(&mut best, tree, primitives, query, limit);
                    }
                    if candidates.far[lane] < limit {
                        limit = candidates.far[lane];
                        // Most often what waited is now beyond the limit.
                        if pending.count == 1 && pending.list[0].near > limit {
                            pending.count = 0;
                        }
                    }
                    pending.list[pending.count] =
                        Waiting { leaf: index, lane: lane as u32, near: candidates.near[lane] };
                    pending.count += 1;
                } else if decide_now(&mut best, tree, index, lane as u32, primitives, query) {
                    limit = limit.min(frame_ray.distance(best.t_max));
                }
            }
        }
        loop {
            let Some(next) = stack.pop() else {
                if pending.count == 1 {
                    let Waiting { leaf, lane, .. } = pending.list[0];
                    decide(filters, &mut best, tree, leaf, lane, primitives, query);
                } else {
                    pending.resolve(&mut best, tree, primitives, query, limit);
                }
                return best.found();
            };
            if f32::from_bits((next >> 32) as u32) <= limit {
                child = next as u32;
                break;
            }
        }
    }
}

/// Whether anything is hit, in the order of the tree. A level of the stack is one entry, the children yet to be visited:
/// that spares a loop over them whose length no branch predictor can know.
#[inline(always)]
fn any_on<F: Filters, const N: usize>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
    frame_ray: &FrameRay,
) -> bool {
    let ray = filters.ray(frame_ray);
    let limit = frame_ray.distance(query.t_max);
    let certain_limit = frame_ray.distance_below(query.t_max);
    let (nodes, leaves) = (tree.nodes(), tree.leaves());
    let mut room = Room::<(u32, u32), N>::new();
    let mut levels = Stack::new(&mut room);
    let mut index = 0;
    loop {
        let mut node = &nodes[index as usize];
        let mut mask = filters.enter(&ray, node, limit).mask;
        loop {
            while mask == 0 {
                match levels.pop() {
                    Some(level) => (index, mask) = level,
                    None => return false,
                }
                node = &nodes[index as usize];
            }
            let lane = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let child = node.children.0[lane];
            if child & LEAF == 0 {
                if mask != 0 {
                    levels.push((index, mask));
                }
                index = child;
                break;
            }
            let leaf = &leaves[(child & !LEAF) as usize];
            let mut candidates = candidates(filters, frame_ray, leaf, limit, certain_limit);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                let id = leaf.id(lane);
                if id == query.aims_at || id == query.leaves && candidates.left >> lane & 1 == 1 {
                    continue;
                }
                let certain = candidates.certain >> lane & 1 == 1 && id != query.leaves;
                let hit = certain || occludes_by(tree, leaf, lane, primitives, query);
                if hit {
                    return true;
                }
            }
        }
    }
}

/// Whether the primitive in a lane of a leaf hides the end of a ray from its start, where `f32` does not tell.
#[cold]
#[inline(never)]
fn occludes_by(tree: &WideTree, leaf: &Leaf8, lane: usize, primitives: &[Primitive], query: &Query) -> bool {
    if leaf.is_exact(lane) {
        intersect_exact(portable::Portable, tree, leaf, lane, primitives, query, query.t_max).is_some()
    } else {
        occludes(primitives, query, leaf.id(lane))
    }
}

/// Whether a primitive hides the end of a ray from its start.
#[inline]
pub(crate) fn occludes(primitives: &[Primitive], query: &Query, id: PrimitiveId) -> bool {
    match &primitives[id.0 as usize] {
        Primitive::Instance(instance) => id != query.aims_at && id != query.leaves && instance.occludes(query),
        shape => id != query.aims_at && shape.intersect(query, query.t_max, query.leaves == id).is_some(),
    }
}
