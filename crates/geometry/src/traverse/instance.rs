//! From the walk of a tree into what an instance places.

use super::best::Best;
use super::compiled::Compiled;
use super::vector::Vector;
use super::{LEVELS, Narrow, Visit, any_on, closest_on, occludes};
use crate::bvh::leaf::Leaf;
use crate::bvh::node::{ANY_KIND, Leaves, NODE_WIDTH, TRIANGLES, TreeKind};
use crate::frame::{Entry, FrameRay};
use crate::geometry::{InstanceNode, WideTree};
use crate::query::Query;
use crate::ray::{ExactPoint, Found, RawHit};
use crate::{Hit, Instance, Primitive, Ray, SurfaceId};

/// The end of a ray within an instance: that outside, but no smaller than 2⁻¹²⁰. In the units there, which may be 2⁹⁰⁰ times as long, a
/// smaller one would be rounded, and what of several instances is hit first would depend on which was asked before. What is found is
/// compared with the end outside anyway.
#[inline(always)]
fn told_end(t_max: f64) -> f64 {
    const LEAST: f64 = 1.0 / (1_u128 << 120) as f64;
    // Never of NaN: ends are limits that have been compared.
    if t_max > LEAST { t_max } else { LEAST }
}

/// Puts a hit that rounding found before the ray has entered the instance's bounds to where it does, and tells whether it counts before
/// `t_max`. What is hit first must not depend on whether the bounds are entered before `t_max`, and an instance that is flat to one part
/// in 10³⁰ has coordinates in which rays are little but rounding.
#[inline(always)]
fn at_least(hit: &mut RawHit, entry: f64, t_max: f64) -> bool {
    // Where t is so small that the change of units lost it there is no hit, nor beyond an end that was not told.
    let is_ahead = hit.t > 0.0;
    hit.t = if hit.t < entry { entry } else { hit.t };
    is_ahead && hit.t < t_max
}

impl Instance {
    /// The closest hit with 0 < t < `t_max`.
    #[inline(never)]
    pub(crate) fn closest(&self, query: &Query, t_max: f64) -> Option<Found> {
        let entry = self.entry(query, t_max)?;
        let inner = self.enter(query, told_end(t_max))?;
        let (mut hit, mut surface) = self.geometry().closest(&inner)?;
        hit.t *= inner.scale;
        surface.instance += self.first;
        at_least(&mut hit, entry, t_max).then_some((hit, surface))
    }

    /// Calls `visit` for every hit at a distance from `from` on and below `t_max`, as [`all_of`](super::all_of) does.
    pub(crate) fn all(&self, query: &Query, (from, t_max): (f64, f64), visit: &mut Visit<'_>) -> f64 {
        let Some(entry) = self.entry(query, t_max) else { return t_max };
        let Some(inner) = self.enter(query, told_end(t_max)) else { return t_max };
        let mut end = t_max;
        // A hit before the bounds are entered counts as one where they are.
        let inner_from = if entry < from { from / inner.scale } else { 0.0 };
        self.geometry().all(&inner, inner_from, &mut |mut hit, mut surface| {
            hit.t *= inner.scale;
            surface.instance += self.first;
            if at_least(&mut hit, entry, end) && hit.t >= from {
                end = visit(hit, surface);
            }
            told_end(end) / inner.scale
        });
        end
    }

    /// Whether anything but the surface aimed at is hit.
    #[inline(never)]
    pub(crate) fn occludes(&self, query: &Query) -> bool {
        self.entry(query, query.t_max).is_some()
            && self.enter(query, query.t_max).is_some_and(|inner| self.geometry().any(&inner))
    }

    /// The point of a surface within at parameter `t` of the query; see [`Geometry::exact_point`].
    pub(crate) fn exact_point(
        &self,
        query: &Query,
        t: f64,
        refine: bool,
        surface: SurfaceId,
    ) -> Option<(ExactPoint, u32)> {
        let inner = self.enter(query, query.t_max)?;
        let (point, label) = self.geometry().exact_point(&inner, t / inner.scale, refine, self.inward(surface))?;
        Some((self.placement_at(query.time).outward(&point), label))
    }
}

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
