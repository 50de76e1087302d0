//! Traversal of the wide tree, once for all instruction sets.
//!
//! Boxes and triangles are only *filtered* in `f32`: a filter errs on the side of keeping, by derived bounds, and what it
//! keeps is decided in `f64`. Filters may therefore differ between instruction sets, hits cannot.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;
mod stack;

use crate::build::MAX_DEPTH;
use crate::frame::FrameRay;
use crate::geometry::Best;
use crate::query::{Query, RawHit};
use crate::wide::{EXACT, LEAF, Leaf8, Node8, WIDTH, WideTree};
use crate::{Primitive, PrimitiveId};
use stack::Stack;

/// Levels of the stack that serves all but degenerate trees, and of the one that serves any: as many as a binary tree has.
const LEVELS: [usize; 2] = [12, MAX_DEPTH];

/// The children of a node that a ray meets.
pub(crate) struct Entered {
    /// One bit a child.
    mask: u32,
    /// The distances at which it enters them, not above the true ones.
    near: [f32; WIDTH],
}

/// The primitives of a leaf that a ray may hit.
pub(crate) struct Candidates {
    /// Those to be decided in `f64`, and those certainly hit, one bit each.
    mask: u32,
    /// Those that are certainly hit between the origin and the certain limit.
    certain: u32,
    /// Distances of triangles, not above the true ones.
    near: [f32; WIDTH],
    /// Distances not below the true ones of those certainly hit.
    far: [f32; WIDTH],
}

/// The filters of an instruction set.
pub(crate) trait Filters: Copy {
    /// The ray as the filters want it.
    type Ray: Copy;
    /// Prepares a ray.
    fn ray(self, ray: &FrameRay, leaves: PrimitiveId) -> Self::Ray;
    /// The children of a node that the ray meets in [0, `limit`].
    fn enter(self, ray: &Self::Ray, node: &Node8, limit: f32) -> Entered;
    /// Announces that a primitive will be read.
    fn prefetch(self, primitive: &Primitive);
    /// The primitives of a leaf that the ray may hit in [0, `limit`], and those that it certainly hits in
    /// (0, `certain_limit`). A triangle that it leaves is none of them.
    fn candidates(self, ray: &Self::Ray, leaf: &Leaf8, limit: f32, certain_limit: f32) -> Candidates;
}

/// The closest hit.
pub(crate) fn closest(tree: &WideTree, primitives: &[Primitive], query: &Query) -> Option<(RawHit, PrimitiveId)> {
    #[cfg(target_arch = "x86_64")]
    if let Some(filters) = avx2::Avx2::detect() {
        return filters.closest(tree, primitives, query);
    }
    closest_portable(tree, primitives, query)
}

/// Whether anything but the primitive aimed at is hit.
pub(crate) fn any(tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    #[cfg(target_arch = "x86_64")]
    if let Some(filters) = avx2::Avx2::detect() {
        return filters.any(tree, primitives, query);
    }
    any_portable(tree, primitives, query)
}

/// [`closest`] on any machine.
pub(crate) fn closest_portable(
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
) -> Option<(RawHit, PrimitiveId)> {
    closest_with(portable::Portable, tree, primitives, query)
}

/// [`any`] on any machine.
pub(crate) fn any_portable(tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    any_with(portable::Portable, tree, primitives, query)
}

#[inline(always)]
fn closest_with<F: Filters>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
) -> Option<(RawHit, PrimitiveId)> {
    let ray = tree.frame.enter(query)?;
    if tree.depth <= LEVELS[0] {
        closest_on::<F, { LEVELS[0] * (WIDTH - 1) }>(filters, tree, primitives, query, &ray)
    } else {
        closest_deep(tree, primitives, query, &ray)
    }
}

#[inline(always)]
fn any_with<F: Filters>(filters: F, tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    let Some(ray) = tree.frame.enter(query) else { return false };
    if tree.depth <= LEVELS[0] {
        any_on::<F, { LEVELS[0] }>(filters, tree, primitives, query, &ray)
    } else {
        any_deep(tree, primitives, query, &ray)
    }
}

/// Degenerate trees, by the portable filters.
#[cold]
#[inline(never)]
pub(crate) fn closest_deep(
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
    ray: &FrameRay,
) -> Option<(RawHit, PrimitiveId)> {
    closest_on::<_, { LEVELS[1] * (WIDTH - 1) }>(portable::Portable, tree, primitives, query, ray)
}

/// Degenerate trees, by the portable filters.
#[cold]
#[inline(never)]
pub(crate) fn any_deep(tree: &WideTree, primitives: &[Primitive], query: &Query, ray: &FrameRay) -> bool {
    any_on::<_, { LEVELS[1] }>(portable::Portable, tree, primitives, query, ray)
}

/// A stack entry: the distance's bits above (those of non-negative numbers are ordered as they are), the child below.
#[inline(always)]
fn entry(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

/// Hits that are certain, but whose distances are known in `f32` only.
struct Pending {
    /// The leaf and the lane.
    at: [(u32, u32); Self::LIMIT],
    near: [f32; Self::LIMIT],
    count: usize,
}

impl Pending {
    /// Hits that `f32` cannot order are rare, more than two of them duplicates.
    const LIMIT: usize = 4;

    /// Decides in `f64` those that are not beyond `limit`.
    #[inline(always)]
    fn resolve(&mut self, best: &mut Best, tree: &WideTree, primitives: &[Primitive], query: &Query, limit: f32) {
        let leaves = tree.leaves();
        for i in 0..self.count {
            if self.near[i] <= limit {
                let (leaf, lane) = self.at[i];
                test(best, tree, &leaves[leaf as usize], lane as usize, primitives, query);
            }
        }
        self.count = 0;
    }
}

/// Decides in `f64` whether a lane of a leaf holds the closest hit so far.
#[inline(never)]
fn test(best: &mut Best, tree: &WideTree, leaf: &Leaf8, lane: usize, primitives: &[Primitive], query: &Query) -> bool {
    let id = leaf.id(lane);
    if leaf.is_exact(lane) {
        best.take(id, |t_max| leaf.intersect(&tree.frame, lane, query, t_max))
    } else {
        best.test(primitives, query, id)
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
) -> Option<(RawHit, PrimitiveId)> {
    let ray = filters.ray(frame_ray, query.leaves);
    let mut best = Best::new(query);
    let mut limit = frame_ray.distance(query.t_max);
    let certain_limit = frame_ray.distance_below(query.t_max);
    let mut pending = Pending { at: [(0, 0); Pending::LIMIT], near: [0.0; Pending::LIMIT], count: 0 };
    let (nodes, leaves) = (tree.nodes(), tree.leaves());
    let mut stack = Stack::<u64, N>::new();
    let mut child = 0;
    loop {
        if child & LEAF == 0 {
            let node = &nodes[child as usize];
            let Entered { mut mask, near } = filters.enter(&ray, node, limit);
            if mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if mask == 0 {
                    child = node.children[lane];
                    continue;
                }
                let first = entry(near[lane], node.children[lane]);
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let second = entry(near[lane], node.children[lane]);
                let mut nearest = first.min(second);
                let base = stack.len();
                stack.push(first.max(second));
                while mask != 0 {
                    let lane = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    let new = entry(near[lane], node.children[lane]);
                    stack.insert(base, nearest.max(new));
                    nearest = nearest.min(new);
                }
                child = nearest as u32;
                continue;
            }
        } else {
            let index = child & !LEAF;
            let leaf = &leaves[index as usize];
            let mut candidates = filters.candidates(&ray, leaf, limit, certain_limit);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                let id = leaf.id(lane);
                if candidates.near[lane] > limit && leaf.is_triangle(lane) {
                    continue;
                }
                if candidates.certain >> lane & 1 == 1 {
                    // Its exact distance can wait until the end, when it has been fetched.
                    if leaf.ids[lane] & EXACT == 0 {
                        filters.prefetch(&primitives[id.0 as usize]);
                    }
                    if pending.count == Pending::LIMIT {
                        pending.resolve(&mut best, tree, primitives, query, limit);
                    }
                    if candidates.far[lane] < limit {
                        limit = candidates.far[lane];
                        // Most often what waited is now beyond the limit.
                        if pending.count == 1 && pending.near[0] > limit {
                            pending.count = 0;
                        }
                    }
                    pending.at[pending.count] = (index, lane as u32);
                    pending.near[pending.count] = candidates.near[lane];
                    pending.count += 1;
                } else if test(&mut best, tree, leaf, lane, primitives, query) {
                    limit = limit.min(frame_ray.distance(best.t_max));
                }
            }
        }
        loop {
            let Some(next) = stack.pop() else {
                pending.resolve(&mut best, tree, primitives, query, limit);
                return best.hit;
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
    let ray = filters.ray(frame_ray, query.leaves);
    let limit = frame_ray.distance(query.t_max);
    let certain_limit = frame_ray.distance_below(query.t_max);
    let (nodes, leaves) = (tree.nodes(), tree.leaves());
    let mut levels = Stack::<(u32, u32), N>::new();
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
            let child = node.children[lane];
            if child & LEAF == 0 {
                if mask != 0 {
                    levels.push((index, mask));
                }
                index = child;
                break;
            }
            let leaf = &leaves[(child & !LEAF) as usize];
            let mut candidates = filters.candidates(&ray, leaf, limit, certain_limit);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                let id = leaf.id(lane);
                if id == query.aims_at {
                    continue;
                }
                let certain = candidates.certain >> lane & 1 == 1;
                let hit = certain
                    || if leaf.is_exact(lane) {
                        leaf.intersect(&tree.frame, lane, query, query.t_max).is_some()
                    } else {
                        occludes(primitives, query, id)
                    };
                if hit {
                    return true;
                }
            }
        }
    }
}

/// Bound on the error of the edge functions of a leaf's triangles in the projection of a ray that meets the leaf's box.
///
/// `error` is the bound δ on the error of a projected coordinate. With e the largest of them, an edge function
/// (cx·by − cy·bx) errs by at most 4δe + 2δ² for its factors and 4ue² for its rounding; e is below twice the reach of the
/// ray, of which δ is at least 10 roundoffs, so that 5δe + 2δ² covers both. A vertex is no farther than the `extent` of
/// the box along any axis from a point of the ray, which projects to zero, so that e is at most twice the extent, plus
/// twice the slack with which the ray may miss the box, below 3δ: its 3ε a distance (`frame`).
#[inline(always)]
fn leaf_error(error: f32, extent: f32) -> f32 {
    error * (12.0 * extent + 32.0 * error)
}

/// Bounds for spheres in the projection of a ray: on the error of a centre's distance from the ray and of its place along
/// it, and a relative one on the squared distance.
///
/// A centre relative to the origin and sheared, (x, y), errs by δ in each coordinate, its distance from the ray,
/// √(x² + y² − (x·sx + y·sy)²/(1 + sx² + sy²)), by no more than √2·δ and, since the difference is at least a third of
/// x² + y², by 30 roundoffs of itself; the radius errs by one. Along the ray the centre errs by at most 4δ.
#[inline(always)]
fn sphere_bounds(error: f32) -> (f32, f32) {
    (6.0 * error, 1.0 + 32.0 * f32::EPSILON)
}

/// Whether a primitive hides the end of a ray from its start.
#[inline]
pub(crate) fn occludes(primitives: &[Primitive], query: &Query, id: PrimitiveId) -> bool {
    id != query.aims_at && primitives[id.0 as usize].intersect(query, query.t_max, query.leaves == id).is_some()
}
