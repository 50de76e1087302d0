//! Traversal of the wide tree, once for all instruction sets.
//!
//! Boxes and triangles are only *filtered* in `f32`: a filter errs on the side of keeping, by derived bounds, and what it
//! keeps is decided in `f64`. Filters may therefore differ between instruction sets, hits cannot.

mod any;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod closest;
mod compiled;
mod eight;
mod flat;
#[cfg(target_arch = "x86_64")]
mod lanes256;
mod leaf;
mod met;
mod portable;
mod stack;
mod start;
mod vector;
#[cfg(target_arch = "x86_64")]
mod wide256;
#[cfg(target_arch = "x86_64")]
mod wide512;
mod within;

use crate::best::Found;
use crate::build::MAX_DEPTH;
use crate::frame::BoxRay;
use crate::query::{Four, Projection, Query, RawHit};
use crate::wide::{BALLS, LEAF_WIDTH, Leaf8, MESH, MIXED, NODE_WIDTH, Node16, WideTree};
use crate::{Hits, Primitive, Rays, Triangle};
use any::any_on;
pub(crate) use any::occludes;
use closest::closest_on;
use compiled::Compiled;
use flat::{Eight, Wide};
pub(crate) use flat::{FLAT_LIMIT, Flat};
use met::{Met, Row};
use start::Start;
use vector::Vector;

/// Levels of the stack that serves all but degenerate trees, and of the one that serves any: as many as a binary tree has.
const LEVELS: [usize; 2] = [12, MAX_DEPTH];

/// The primitives of a leaf that a ray may hit.
struct Candidates {
    /// Those that the line of the ray may meet, one bit each. Of others the fields below tell nothing.
    mask: u32,
    /// Those that it certainly meets behind the origin or beyond the limit. Apart from the mask, which is known sooner.
    missed: u32,
    /// Those of which no distance is known.
    unbounded: u32,
    /// Those that are certainly hit between the origin and the certain limit.
    certain: u32,
    /// Distances not above the true ones.
    near: Row<f32, LEAF_WIDTH>,
    /// Distances not below the true ones of those certainly hit.
    far: Row<f32, LEAF_WIDTH>,
}

impl Candidates {
    const NONE: Self = Self {
        mask: 0,
        missed: 0,
        unbounded: 0,
        certain: 0,
        near: Row([0.0; LEAF_WIDTH]),
        far: Row([0.0; LEAF_WIDTH]),
    };
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
    type Met: Met;
    /// Eight floats.
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
    fn enter(self, ray: &Self::Ray, node: &Node16, limit: f32) -> Self::Met;
    /// Announces that an item will be read.
    fn prefetch<T>(self, item: &T);
}

/// Work that is compiled for each instruction set. Its function is inlined into one that is.
trait Job {
    /// What comes of it.
    type Output;
    /// The work.
    fn run<F: Compiled>(self, filters: F) -> Self::Output;
}

/// An instruction set that the processor has.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Level {
    #[cfg(target_arch = "x86_64")]
    Avx512(avx512::Avx512),
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    Portable,
}

impl Level {
    /// The best one.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(filters) = avx512::Avx512::detect() {
            return Self::Avx512(filters);
        } else if let Some(filters) = avx2::Avx2::detect() {
            return Self::Avx2(filters);
        }
        Self::Portable
    }

    /// All.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        let mut all = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        all.extend(avx2::Avx2::detect().map(Self::Avx2));
        #[cfg(target_arch = "x86_64")]
        all.extend(avx512::Avx512::detect().map(Self::Avx512));
        all
    }

    #[inline(always)]
    fn run<J: Job>(self, job: J) -> J::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(filters) => filters.run(job),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(filters) => filters.run(job),
            Self::Portable => portable::Portable.run(job),
        }
    }
}

/// A loop that the compiler makes vectors of, as wide as an instruction set has.
pub(crate) trait Loop {
    /// What comes of it.
    type Output;
    /// The loop, marked to be inlined always, as all that it calls.
    fn run(self) -> Self::Output;
}

/// Runs a loop in the vectors of an instruction set. Operations are the same in all of them, and so is the result.
#[inline(always)]
pub(crate) fn vectorised<L: Loop>(level: Level, work: L) -> L::Output {
    let work = Vectorised(work);
    match level {
        // Vectors that the compiler makes of sixteen floats gain nothing, and what it stores by masks is waited for.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(filters) => avx2::Avx2::from(filters).run(work),
        level => level.run(work),
    }
}

struct Vectorised<L>(L);

impl<L: Loop> Job for Vectorised<L> {
    type Output = L::Output;

    #[inline(always)]
    fn run<F: Compiled>(self, _: F) -> L::Output {
        self.0.run()
    }
}

/// The closest hit, its distance in the units of the start.
///
/// The query is made within, where its numbers can stay in registers.
#[inline]
pub(crate) fn closest<S: Start>(level: Level, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(filters) => filters.closest(tree, primitives, start),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(filters) => filters.closest(tree, primitives, start),
        Level::Portable => closest_portable(tree, primitives, start),
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
        Level::Portable => any_portable(tree, primitives, start),
    }
}

/// [`closest`] of the rays in the lanes of `active`, one bit each.
#[inline]
pub(crate) fn closest_hits(level: Level, tree: &WideTree, primitives: &[Primitive], rays: &Rays, active: u8) -> Hits {
    level.run(eight::Closest { tree, primitives, rays, active })
}

/// [`any`] of the rays in the lanes of `active`: one bit for each lane, zero in the others.
#[inline]
pub(crate) fn any_hits(level: Level, tree: &WideTree, primitives: &[Primitive], rays: &Rays, active: u8) -> u8 {
    level.run(eight::Any { tree, primitives, rays, active })
}

/// [`closest`] on any machine.
pub(crate) fn closest_portable<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
    portable::Portable.closest(tree, primitives, start)
}

/// [`any`] on any machine.
pub(crate) fn any_portable<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    portable::Portable.any(tree, primitives, start)
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

/// The closest hit of a ray that starts near the frame, as most do: without a query until one is needed.
#[inline(always)]
fn closest_with<F: Compiled, S: Start>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    start: S,
) -> Option<Found> {
    let near = if tree.depth <= LEVELS[0] { start.enter_near::<F::Four>(filters.into(), &tree.frame) } else { None };
    match near {
        Some(ray) => {
            const ROOM: usize = LEVELS[0] * (NODE_WIDTH - 1);
            match tree.kind {
                MESH => closest_on::<F, S, MESH, ROOM>(filters, tree, primitives, start, &ray),
                BALLS => closest_on::<F, S, BALLS, ROOM>(filters, tree, primitives, start, &ray),
                _ => closest_on::<F, S, MIXED, ROOM>(filters, tree, primitives, start, &ray),
            }
        }
        None => filters.closest_far(tree, primitives, start),
    }
}

/// The closest hit of any ray.
#[inline(always)]
fn closest_far_with<F: Compiled, S: Start>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    start: S,
) -> Option<Found> {
    let query = start.query()?;
    if tree.depth > LEVELS[0] {
        let (hit, id) = closest_deep(tree, primitives, &query)?;
        return Some((RawHit { t: start.distance(query.scale, hit.t), ..hit }, id));
    }
    let ray = tree.frame.enter(filters.into(), &query)?;
    closest_on::<F, S, MIXED, { LEVELS[0] * (NODE_WIDTH - 1) }>(filters, tree, primitives, start, &ray)
}

/// Whether anything is hit by a ray that starts near the frame.
#[inline(always)]
fn any_with<F: Compiled, S: Start>(filters: F, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    let near = if tree.depth <= LEVELS[0] { start.enter_near::<F::Four>(filters.into(), &tree.frame) } else { None };
    match near {
        Some(ray) => match tree.kind {
            MESH => any_on::<F, S, MESH, { LEVELS[0] }>(filters, tree, primitives, start, &ray),
            BALLS => any_on::<F, S, BALLS, { LEVELS[0] }>(filters, tree, primitives, start, &ray),
            _ => any_on::<F, S, MIXED, { LEVELS[0] }>(filters, tree, primitives, start, &ray),
        },
        None => filters.any_far(tree, primitives, start),
    }
}

/// Whether anything is hit by any ray.
#[inline(always)]
fn any_far_with<F: Compiled, S: Start>(filters: F, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    let Some(query) = start.query() else { return false };
    if tree.depth > LEVELS[0] {
        return any_deep(tree, primitives, &query);
    }
    let Some(ray) = tree.frame.enter(filters.into(), &query) else { return false };
    any_on::<F, S, MIXED, { LEVELS[0] }>(filters, tree, primitives, start, &ray)
}

/// Degenerate trees, by the portable filters.
#[cold]
#[inline(never)]
pub(crate) fn closest_deep(tree: &WideTree, primitives: &[Primitive], query: &Query) -> Option<Found> {
    let ray = tree.frame.enter((), query)?;
    closest_on::<_, _, MIXED, { LEVELS[1] * (NODE_WIDTH - 1) }>(portable::Portable, tree, primitives, query, &ray)
}

/// Degenerate trees, by the portable filters.
#[cold]
#[inline(never)]
pub(crate) fn any_deep(tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    tree.frame
        .enter((), query)
        .is_some_and(|ray| any_on::<_, _, MIXED, { LEVELS[1] }>(portable::Portable, tree, primitives, query, &ray))
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
fn intersect_exact<F: Filters>(
    filters: F,
    tree: &WideTree,
    (leaf, lane): (&Leaf8, usize),
    primitives: &[Primitive],
    projection: &Projection,
    query: impl FnOnce() -> Query,
    t_max: f64,
) -> Option<RawHit> {
    let triangle = || match &primitives[leaf.id(lane).0 as usize] {
        Primitive::Triangle(triangle) => triangle,
        _ => unreachable!("only triangles have exact vertices"),
    };
    let lanes = leaf.lanes::<F::Four>(filters.into(), &tree.frame, lane, projection.axes());
    Triangle::intersect_lanes::<F::Four>(filters.into(), lanes, projection, || (triangle(), query()), t_max)
}
