//! Traversal of the wide tree, once for all instruction sets.
//!
//! Boxes and triangles are only *filtered* in `f32`: a filter errs on the side of keeping, by derived bounds, and what it
//! keeps is decided in `f64`. Filters may therefore differ between instruction sets, hits cannot.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

use crate::frame::FrameRay;
use crate::geometry::Best;
use crate::query::{Query, RawHit};
use crate::wide::{LEAF, Leaf8, Node8, WIDTH, WideTree};
use crate::{Primitive, PrimitiveId};

/// Entries of the stack that serves all but degenerate trees, and of the one that serves any (see `build`: 80 binary
/// levels, each of which can leave seven siblings only if eight were merged into one).
const STACKS: [usize; 2] = [96, 640];

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
    /// Distances not above the true ones.
    near: [f32; WIDTH],
}

/// The filters of an instruction set.
pub(crate) trait Filters: Copy {
    /// The ray as the filters want it.
    type Ray: Copy;
    /// Prepares a ray.
    fn ray(self, ray: &FrameRay) -> Self::Ray;
    /// The children of a node that the ray meets in [0, `limit`].
    fn enter(self, ray: &Self::Ray, node: &Node8, limit: f32) -> Entered;
    /// The primitives of a leaf that the ray may hit in [0, `limit`], and those that it certainly hits in
    /// (0, `certain_limit`).
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
    if tree.stack <= STACKS[0] {
        closest_on(filters, tree, primitives, query, &ray, &mut [0; STACKS[0]])
    } else {
        closest_on(filters, tree, primitives, query, &ray, &mut [0; STACKS[1]])
    }
}

#[inline(always)]
fn any_with<F: Filters>(filters: F, tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    let Some(ray) = tree.frame.enter(query) else { return false };
    if tree.stack <= STACKS[0] {
        any_on(filters, tree, primitives, query, &ray, &mut [0; STACKS[0]])
    } else {
        any_on(filters, tree, primitives, query, &ray, &mut [0; STACKS[1]])
    }
}

/// A stack entry: the distance's bits above (those of non-negative numbers are ordered as they are), the child below.
#[inline(always)]
fn entry(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

#[inline(always)]
fn closest_on<F: Filters, const N: usize>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
    frame_ray: &FrameRay,
    stack: &mut [u64; N],
) -> Option<(RawHit, PrimitiveId)> {
    let ray = filters.ray(frame_ray);
    let mut best = Best::new(query);
    let mut limit = frame_ray.distance(best.t_max);
    let mut top = 0;
    let mut child = 0;
    loop {
        if child & LEAF == 0 {
            let node = &tree.nodes[child as usize];
            let Entered { mut mask, near } = filters.enter(&ray, node, limit);
            if mask != 0 {
                // Descend into the nearest; the others wait, nearest on top.
                let base = top;
                loop {
                    let lane = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    let new = entry(near[lane], node.children[lane]);
                    let mut at = top;
                    while at > base && stack[at - 1] < new {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = new;
                    top += 1;
                    if mask == 0 {
                        break;
                    }
                }
            }
        } else {
            let leaf = &tree.leaves[(child & !LEAF) as usize];
            let mut candidates = filters.candidates(&ray, leaf, limit, 0.0);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                if candidates.near[lane] <= limit && best.test(primitives, query, leaf.id(lane)) {
                    limit = frame_ray.distance(best.t_max);
                }
            }
        }
        loop {
            if top == 0 {
                return best.hit;
            }
            top -= 1;
            let next = stack[top];
            if f32::from_bits((next >> 32) as u32) <= limit {
                child = next as u32;
                break;
            }
        }
    }
}

#[inline(always)]
fn any_on<F: Filters, const N: usize>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
    frame_ray: &FrameRay,
    stack: &mut [u64; N],
) -> bool {
    let ray = filters.ray(frame_ray);
    let limit = frame_ray.distance(query.t_max);
    let certain_limit = frame_ray.distance_below(query.t_max);
    let mut top = 0;
    let mut child = 0;
    loop {
        if child & LEAF == 0 {
            let node = &tree.nodes[child as usize];
            let mut mask = filters.enter(&ray, node, limit).mask;
            while mask != 0 {
                stack[top] = u64::from(node.children[mask.trailing_zeros() as usize]);
                top += 1;
                mask &= mask - 1;
            }
        } else {
            let leaf = &tree.leaves[(child & !LEAF) as usize];
            let mut candidates = filters.candidates(&ray, leaf, limit, certain_limit);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                let id = leaf.id(lane);
                let certain = candidates.certain >> lane & 1 == 1;
                if (certain && id != query.aims_at && id != query.leaves) || occludes(primitives, query, id) {
                    return true;
                }
            }
        }
        if top == 0 {
            return false;
        }
        top -= 1;
        child = stack[top] as u32;
    }
}

/// Whether a primitive hides the end of a ray from its start.
#[inline]
pub(crate) fn occludes(primitives: &[Primitive], query: &Query, id: PrimitiveId) -> bool {
    id != query.aims_at && primitives[id.0 as usize].intersect(query, query.t_max, query.leaves == id).is_some()
}
