//! From the walk of a tree into what an instance places.

use super::compiled::Compiled;
use super::vector::Vector;
use super::{LEVELS, Narrow, any_on, closest_on, occludes};
use crate::best::Best;
use crate::frame::{Entry, FrameRay};
use crate::instance::{at_least, told_end};
use crate::instance_node::InstanceNode;
use crate::query::{Query, RawHit};
use crate::wide::{ANY_KIND, Leaf, Leaves, NODE_WIDTH, TRIANGLES, TreeKind, WideTree};
use crate::{Hit, Primitive, Ray};

/// [`Best::test`] of an instance: the same, without a query where there is a tree to walk. The bounds, which cost more than what
/// most rays that miss find out in the tree's root, are asked for only where there is a hit.
#[inline(always)]
pub(super) fn closest_in_instance<F: Compiled>(
    filters: F,
    best: &mut Best,
    instance_node: &InstanceNode,
    primitives: &[Primitive],
    query: &Query,
) -> bool {
    let Some((geometry, tree)) = instance_node.tree() else { return best.test(primitives, query, instance_node.id) };
    // Left as a whole.
    if query.leaves == instance_node.id {
        return false;
    }
    let t_max = best.limit(instance_node.id);
    let (lanes, ray) = instance_node.enter::<F::Four>(filters.into(), query, told_end(t_max));
    let (inner, ray) = (geometry.primitives(), &ray);
    let entry = if tree.depth <= LEVELS[0] {
        tree.frame.enter_anywhere::<F::Four>(filters.into(), lanes, ray.t_max)
    } else {
        Entry::Unknown
    };
    let found = match entry {
        Entry::Misses => None,
        Entry::Unknown => filters.closest_far(tree, inner, ray),
        Entry::Ray(near) => match tree.leaves() {
            Leaves::Eight(leaves) if const { F::Vector::WIDTH == 8 } => {
                closest_in(filters, (tree, leaves), inner, ray, &near)
            }
            Leaves::Sixteen(leaves) if const { F::Vector::WIDTH == 16 } => {
                closest_in(filters, (tree, leaves), inner, ray, &near)
            }
            _ => filters.closest_far(tree, inner, ray),
        },
    };
    let Some(Hit { t, surface, uv }) = found else { return false };
    let mut hit = RawHit { t, uv };
    let Some(entry) = instance_node.entry(query, t_max) else { return false };
    let found = at_least(&mut hit, entry, t_max);
    if found {
        best.set_in_instance(hit, instance_node.id, instance_node.outward(surface));
    }
    found
}

/// [`occludes`] of an instance, likewise.
#[inline(always)]
pub(super) fn occludes_in_instance<F: Compiled>(
    filters: F,
    instance_node: &InstanceNode,
    primitives: &[Primitive],
    query: &Query,
) -> bool {
    let Some((geometry, tree)) = instance_node.tree() else { return occludes(primitives, query, instance_node.id) };
    if instance_node.id == query.aims_at || instance_node.id == query.leaves {
        return false;
    }
    let (lanes, ray) = instance_node.enter::<F::Four>(filters.into(), query, query.t_max);
    let (inner, ray) = (geometry.primitives(), &ray);
    let entry = if tree.depth <= LEVELS[0] {
        tree.frame.enter_anywhere::<F::Four>(filters.into(), lanes, query.t_max)
    } else {
        Entry::Unknown
    };
    let hit = match entry {
        Entry::Misses => false,
        Entry::Unknown => filters.any_far(tree, inner, ray),
        Entry::Ray(near) => match tree.leaves() {
            Leaves::Eight(leaves) if const { F::Vector::WIDTH == 8 } => {
                any_in(filters, (tree, leaves), inner, ray, &near)
            }
            Leaves::Sixteen(leaves) if const { F::Vector::WIDTH == 16 } => {
                any_in(filters, (tree, leaves), inner, ray, &near)
            }
            _ => filters.any_far(tree, inner, ray),
        },
    };
    hit && instance_node.entry(query, query.t_max).is_some()
}

/// The closest hit in what an instance places. Spheres alone have no walk of their own here: this is one function with all that it walks,
/// which the compiler inlines into it up to some length only.
#[inline(always)]
fn closest_in<F: Compiled, const W: usize>(
    filters: F,
    tree: (&WideTree, &[Leaf<W>]),
    primitives: &[Primitive],
    ray: &Ray<f64>,
    near: &FrameRay<Narrow<F>>,
) -> Option<Hit<f64>> {
    const ROOM: usize = LEVELS[0] * (NODE_WIDTH - 1);
    match tree.0.kind {
        TreeKind::Triangles => closest_on::<F, _, TRIANGLES, ROOM, W>(filters, tree, primitives, ray, near),
        _ => closest_on::<F, _, ANY_KIND, ROOM, W>(filters, tree, primitives, ray, near),
    }
}

/// Whether anything is hit there.
#[inline(always)]
fn any_in<F: Compiled, const W: usize>(
    filters: F,
    tree: (&WideTree, &[Leaf<W>]),
    primitives: &[Primitive],
    ray: &Ray<f64>,
    near: &FrameRay<Narrow<F>>,
) -> bool {
    match tree.0.kind {
        TreeKind::Triangles => any_on::<F, _, TRIANGLES, { LEVELS[0] }, W>(filters, tree, primitives, ray, near),
        _ => any_on::<F, _, ANY_KIND, { LEVELS[0] }, W>(filters, tree, primitives, ray, near),
    }
}
