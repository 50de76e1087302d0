//! Traversal of the wide tree, once for all instruction sets.
//!
//! Boxes and triangles are only *filtered* in `f32`: a filter errs on the side of keeping, by derived bounds, and what it
//! keeps is decided in `f64`. Filters may therefore differ between instruction sets, hits cannot.

mod all;
mod any;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod best;
mod closest;
mod compiled;
mod eight;
mod geometry;
mod instance;
mod job;
#[cfg(target_arch = "x86_64")]
mod lanes256;
#[cfg(target_arch = "x86_64")]
mod lanes512;
mod leaf;
mod node_hits;
mod portable;
mod small_scene;
mod stack;
mod start;
mod vector;
#[cfg(target_arch = "x86_64")]
mod wide256;
#[cfg(target_arch = "x86_64")]
mod wide512;

use crate::bvh::build::MAX_DEPTH;
use crate::bvh::leaf::Leaf;
use crate::bvh::node::{ANY_KIND, Leaves, NODE_WIDTH, Node16, SPHERES, TRIANGLES, TreeKind};
use crate::frame::{BoxRay, FrameRay};
use crate::geometry::WideTree;
use crate::query::{Projection, Query};
use crate::ray::{Found, RawHit};
use crate::small_scene::{Eight, Wide};
use crate::vec4::Four;
use crate::{Hits, Primitive, PrimitiveId, Rays, Triangle};
pub(crate) use all::{Visit, all, all_of};
use any::any_on;
pub(crate) use any::occludes;
use closest::closest_on;
use compiled::Compiled;
use etalon_simd::Level;
use job::{Job, run};
use node_hits::{NodeHits, Row};
use portable::Portable;
use start::Start;
use vector::Vector;

/// Levels of the stack that serves all but degenerate trees, and of the one that serves any: as many as a binary tree has.
const LEVELS: [usize; 2] = [12, MAX_DEPTH];

/// The primitives of a leaf that a ray may hit.
struct Candidates<const W: usize> {
    /// Those that the line of the ray may meet, one bit each. Of others the fields below tell nothing.
    mask: u32,
    /// Those that it certainly meets behind the origin or beyond the limit. Apart from the mask, which is known sooner.
    missed: u32,
    /// Those of which no distance is known.
    unbounded: u32,
    /// Those that are certainly hit between the origin and the certain limit.
    certain: u32,
    /// Distances not above the true ones.
    near: Row<f32, W>,
    /// Distances not below the true ones of those certainly hit.
    far: Row<f32, W>,
}

impl<const W: usize> Candidates<W> {
    const NONE: Self = Self { mask: 0, missed: 0, unbounded: 0, certain: 0, near: Row([0.0; W]), far: Row([0.0; W]) };
}

/// The four floats of an instruction set.
type Narrow<F> = <<F as Filters>::Four as Four>::Narrow;

/// The filters of an instruction set.
trait Filters:
    Copy
    + Into<<Self::Vector as Vector>::Token>
    + Into<<Self::Four as Four>::Token>
    + Into<<Self::Wide as Wide>::Token>
    + Into<<Self::Eight as Eight>::Token>
{
    /// The ray as the filter of nodes wants it.
    type Ray: Copy;
    /// What a ray meets of a node.
    type NodeHits: NodeHits;
    /// Eight floats, or sixteen.
    type Vector: Vector;
    /// Eight floats, or sixteen.
    type Wide: Wide;
    /// Eight numbers.
    type Eight: Eight;
    /// Four numbers.
    type Four: Four;
    /// Prepares a ray.
    fn ray(self, ray: &BoxRay<Narrow<Self>>) -> Self::Ray;
    /// The children of a node that the ray meets in [0, `limit`].
    fn enter(self, ray: &Self::Ray, node: &Node16, limit: f32) -> Self::NodeHits;
    /// Announces that an item will be read.
    fn prefetch<T>(self, item: &T);
}

/// The closest hit, its distance in the units of the start.
///
/// The query is made within, where its numbers can stay in registers.
#[inline]
pub(crate) fn closest<S: Start>(level: Level, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit> {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(filters) => filters.closest(tree, primitives, start),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(filters) => filters.closest(tree, primitives, start),
        Level::Baseline => Portable.closest(tree, primitives, start),
    }
}

/// Whether anything but the primitive aimed at is hit.
#[inline]
pub(crate) fn any<S: Start>(level: Level, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(filters) => filters.any(tree, primitives, start),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(filters) => filters.any(tree, primitives, start),
        Level::Baseline => Portable.any(tree, primitives, start),
    }
}

/// [`closest`] of the rays in the lanes of `active`, one bit each.
#[inline]
pub(crate) fn closest_hits(level: Level, tree: &WideTree, primitives: &[Primitive], rays: &Rays, active: u8) -> Hits {
    run(level, eight::Closest { tree, primitives, rays, active })
}

/// [`any`] of the rays in the lanes of `active`: one bit for each lane, zero in the others.
#[inline]
pub(crate) fn any_hits(level: Level, tree: &WideTree, primitives: &[Primitive], rays: &Rays, active: u8) -> u8 {
    run(level, eight::Any { tree, primitives, rays, active })
}

/// The closest hit of a ray that starts near the frame, as most do: without a query until one is needed.
#[inline(always)]
fn closest_with<F: Compiled, S: Start>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    start: S,
) -> Option<S::Hit> {
    let near = if tree.depth <= LEVELS[0] { start.enter_near::<F::Four>(filters.into(), &tree.frame) } else { None };
    match (near, tree.leaves()) {
        (Some(ray), Leaves::Eight(leaves)) if const { F::Vector::WIDTH == 8 } => {
            closest_near(filters, (tree, leaves), primitives, start, &ray)
        }
        (Some(ray), Leaves::Sixteen(leaves)) if const { F::Vector::WIDTH == 16 } => {
            closest_near(filters, (tree, leaves), primitives, start, &ray)
        }
        _ => filters.closest_far(tree, primitives, start),
    }
}

/// The closest hit of a ray near the frame of a tree that is made for the filters.
#[inline(always)]
fn closest_near<F: Compiled, S: Start, const W: usize>(
    filters: F,
    tree: (&WideTree, &[Leaf<W>]),
    primitives: &[Primitive],
    start: S,
    ray: &FrameRay<Narrow<F>>,
) -> Option<S::Hit> {
    const ROOM: usize = LEVELS[0] * (NODE_WIDTH - 1);
    match tree.0.kind {
        TreeKind::Triangles => closest_on::<F, S, TRIANGLES, ROOM, W>(filters, tree, primitives, start, ray),
        TreeKind::Spheres => closest_on::<F, S, SPHERES, ROOM, W>(filters, tree, primitives, start, ray),
        _ => closest_on::<F, S, ANY_KIND, ROOM, W>(filters, tree, primitives, start, ray),
    }
}

/// The closest hit of any ray.
#[inline(always)]
fn closest_far_with<F: Compiled, S: Start>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    start: S,
) -> Option<S::Hit> {
    let query = start.query()?;
    const ROOM: usize = LEVELS[0] * (NODE_WIDTH - 1);
    if tree.depth <= LEVELS[0] {
        match tree.leaves() {
            Leaves::Eight(leaves) if const { F::Vector::WIDTH == 8 } => {
                let ray = tree.frame.enter(filters.into(), &query)?;
                return closest_on::<F, S, ANY_KIND, ROOM, 8>(filters, (tree, leaves), primitives, start, &ray);
            }
            Leaves::Sixteen(leaves) if const { F::Vector::WIDTH == 16 } => {
                let ray = tree.frame.enter(filters.into(), &query)?;
                return closest_on::<F, S, ANY_KIND, ROOM, 16>(filters, (tree, leaves), primitives, start, &ray);
            }
            _ => {}
        }
    }
    let (hit, surface) = closest_deep(tree, primitives, &query)?;
    start.told(RawHit { t: start.distance(query.scale, hit.t), ..hit }, surface)
}

/// Whether anything is hit by a ray that starts near the frame.
#[inline(always)]
fn any_with<F: Compiled, S: Start>(filters: F, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    let near = if tree.depth <= LEVELS[0] { start.enter_near::<F::Four>(filters.into(), &tree.frame) } else { None };
    match (near, tree.leaves()) {
        (Some(ray), Leaves::Eight(leaves)) if const { F::Vector::WIDTH == 8 } => {
            any_near(filters, (tree, leaves), primitives, start, &ray)
        }
        (Some(ray), Leaves::Sixteen(leaves)) if const { F::Vector::WIDTH == 16 } => {
            any_near(filters, (tree, leaves), primitives, start, &ray)
        }
        _ => filters.any_far(tree, primitives, start),
    }
}

/// Whether anything is hit by a ray near the frame of a tree that is made for the filters.
#[inline(always)]
fn any_near<F: Compiled, S: Start, const W: usize>(
    filters: F,
    tree: (&WideTree, &[Leaf<W>]),
    primitives: &[Primitive],
    start: S,
    ray: &FrameRay<Narrow<F>>,
) -> bool {
    match tree.0.kind {
        TreeKind::Triangles => any_on::<F, S, TRIANGLES, { LEVELS[0] }, W>(filters, tree, primitives, start, ray),
        TreeKind::Spheres => any_on::<F, S, SPHERES, { LEVELS[0] }, W>(filters, tree, primitives, start, ray),
        _ => any_on::<F, S, ANY_KIND, { LEVELS[0] }, W>(filters, tree, primitives, start, ray),
    }
}

/// Whether anything is hit by any ray.
#[inline(always)]
fn any_far_with<F: Compiled, S: Start>(filters: F, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    let Some(query) = start.query() else { return false };
    const N: usize = LEVELS[0];
    if tree.depth <= N {
        let enter = || tree.frame.enter(filters.into(), &query);
        match tree.leaves() {
            Leaves::Eight(leaves) if const { F::Vector::WIDTH == 8 } => {
                let Some(ray) = enter() else { return false };
                return any_on::<F, S, ANY_KIND, N, 8>(filters, (tree, leaves), primitives, start, &ray);
            }
            Leaves::Sixteen(leaves) if const { F::Vector::WIDTH == 16 } => {
                let Some(ray) = enter() else { return false };
                return any_on::<F, S, ANY_KIND, N, 16>(filters, (tree, leaves), primitives, start, &ray);
            }
            _ => {}
        }
    }
    any_deep(tree, primitives, &query)
}

/// Degenerate trees, and those made for another instruction set, by the portable filters.
#[cold]
#[inline(never)]
pub(crate) fn closest_deep(tree: &WideTree, primitives: &[Primitive], query: &Query) -> Option<Found> {
    const ROOM: usize = LEVELS[1] * (NODE_WIDTH - 1);
    let ray = tree.frame.enter((), query)?;
    match tree.leaves() {
        Leaves::Eight(l) => closest_on::<_, _, ANY_KIND, ROOM, 8>(Portable, (tree, l), primitives, query, &ray),
        Leaves::Sixteen(l) => closest_on::<_, _, ANY_KIND, ROOM, 16>(Portable, (tree, l), primitives, query, &ray),
    }
}

/// The same for [`any`].
#[cold]
#[inline(never)]
pub(crate) fn any_deep(tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    const N: usize = LEVELS[1];
    let Some(ray) = tree.frame.enter((), query) else { return false };
    match tree.leaves() {
        Leaves::Eight(l) => any_on::<_, _, ANY_KIND, N, 8>(Portable, (tree, l), primitives, query, &ray),
        Leaves::Sixteen(l) => any_on::<_, _, ANY_KIND, N, 16>(Portable, (tree, l), primitives, query, &ray),
    }
}

/// [`Primitive::intersect`] in the vectors of an instruction set.
#[inline(always)]
fn intersect_shape<F: Filters>(
    filters: F,
    shape: &Primitive,
    query: &Query,
    t_max: f64,
    leaves: bool,
) -> Option<RawHit> {
    match shape {
        Primitive::Triangle(s) if !leaves => {
            let lanes = s.lanes::<F::Four>(filters.into(), query.projection.axes());
            Triangle::intersect_lanes::<F::Four>(filters.into(), lanes, &query.projection, || (s, *query), t_max)
        }
        Primitive::Parallelogram(s) if !leaves => {
            s.intersect_lanes::<F::Four>(filters.into(), &query.projection, || *query, t_max)
        }
        shape => shape.intersect(query, t_max, leaves),
    }
}

/// The intersection with a triangle whose vertices are exact in its leaf. The triangle lies elsewhere and is not touched, as
/// a rule, nor the query.
#[inline(always)]
fn intersect_exact<F: Filters, const W: usize>(
    filters: F,
    tree: &WideTree,
    (leaf, lane): (&Leaf<W>, usize),
    primitives: &[Primitive],
    projection: &Projection,
    query: impl FnOnce() -> Query,
    t_max: f64,
) -> Option<RawHit> {
    let lanes = leaf.lanes::<F::Four>(filters.into(), &tree.frame, lane, projection.axes());
    Triangle::intersect_lanes::<F::Four>(
        filters.into(),
        lanes,
        projection,
        || (triangle(primitives, leaf.id(lane)), query()),
        t_max,
    )
}

/// The triangle of an exact lane: apart, so that what it takes to find it is not kept for it.
#[cold]
#[inline(never)]
fn triangle(primitives: &[Primitive], id: PrimitiveId) -> &Triangle {
    match &primitives[id.0 as usize] {
        Primitive::Triangle(triangle) => triangle,
        _ => unreachable!("only triangles have exact vertices"),
    }
}
