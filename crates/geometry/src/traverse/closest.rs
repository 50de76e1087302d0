//! The closest hit.

use super::best::Best;
use super::compiled::Compiled;
use super::leaf::{SphereFilter, candidates};
use super::portable::Portable;
use super::stack::{Room, Stack};
use super::start::{Deferred, Start};
use super::{Filters, Narrow, NodeHits, intersect_exact};
use crate::bvh::leaf::Leaf;
use crate::bvh::node::{ANY_KIND, INSTANCE_LEAF, LEAF, NODE_WIDTH, Nodes, SPHERES};
use crate::frame::FrameRay;
use crate::geometry::WideTree;
use crate::query::Projection;
use crate::ray::RawHit;
use crate::{Primitive, PrimitiveId, SurfaceId, Triangle};

/// The closest hit, by a stack of children, nearest on top.
#[inline(always)]
pub(super) fn closest_on<F: Compiled, S: Start, const KIND: u8, const N: usize, const W: usize>(
    filters: F,
    (tree, leaves): (&WideTree, &[Leaf<W>]),
    primitives: &[Primitive],
    start: S,
    frame_ray: &FrameRay<Narrow<F>>,
) -> Option<S::Hit> {
    let ray = filters.ray(&frame_ray.boxes);
    let chords = SphereFilter::new(frame_ray, KIND == SPHERES || KIND == ANY_KIND && tree.spheres);
    let mut query = Deferred::new(start);
    // At once, for its division takes as long as two nodes and waits for nothing.
    let projection = start.projection::<F::Four>(filters.into(), frame_ray.t_scale, frame_ray.axis);
    let leaves_id = start.leaves();
    let mut best = Best::new(frame_ray.t_max);
    let mut limit = frame_ray.limit;
    let certain_limit = frame_ray.certain_limit;
    let nothing = Waiting { leaf: 0, lane: 0, near: 0.0 };
    let mut pending = Pending { list: [nothing; Pending::LIMIT], count: 0 };
    let nodes = tree.nodes();
    let mut room = Room::<u64, N>::new();
    let mut stack = Stack::new(&mut room);
    let mut child = 0;
    loop {
        if child & LEAF == 0 {
            let node = nodes.at(child);
            let met = filters.enter(&ray, node, limit);
            let mask = met.mask();
            if mask != 0 {
                let second = mask & (mask - 1);
                if second == 0 {
                    child = met.first(node);
                    continue;
                }
                let [a, b] = met.pair::<false>(node);
                let [mut nearest, mut last] = sorted(a, b);
                let third = second & (second - 1);
                if third == 0 {
                    prefetch::<F, KIND, W>(filters, (tree, nodes, leaves), last as u32);
                    stack.push(last);
                    child = nearest as u32;
                    continue;
                }
                let [c, d] = met.pair::<true>(node);
                let fourth = third & (third - 1);
                let mut middle;
                [nearest, middle] = sorted(nearest, c);
                [middle, last] = sorted(middle, last);
                let base = stack.len();
                if fourth == 0 {
                    stack.push(last);
                    stack.push(middle);
                } else {
                    let mut next;
                    [nearest, next] = sorted(nearest, d);
                    [next, middle] = sorted(next, middle);
                    [middle, last] = sorted(middle, last);
                    stack.push(last);
                    stack.push(middle);
                    stack.push(next);
                    prefetch::<F, KIND, W>(filters, (tree, nodes, leaves), next as u32);
                    let beyond = (fourth & (fourth - 1)).count_ones() as usize;
                    if beyond > 0 {
                        let all = met.all(node);
                        for &new in &all.0[4..4 + beyond % (NODE_WIDTH - 3)] {
                            prefetch::<F, KIND, W>(filters, (tree, nodes, leaves), new as u32);
                            let [near, far] = sorted(nearest, new);
                            stack.insert(base, far);
                            nearest = near;
                        }
                    }
                }
                prefetch::<F, KIND, W>(filters, (tree, nodes, leaves), middle as u32);
                prefetch::<F, KIND, W>(filters, (tree, nodes, leaves), last as u32);
                child = nearest as u32;
                continue;
            }
        } else if KIND == ANY_KIND && child & INSTANCE_LEAF != 0 {
            let instance_node = &tree.instance_nodes()[(child & !(LEAF | INSTANCE_LEAF)) as usize];
            if filters.closest_in_instance(&mut best, instance_node, primitives, query.get_apart()) {
                limit = limit.min(tree.frame.distance(frame_ray.start, best.t_max));
            }
        } else {
            let index = child & !LEAF;
            let leaf = &leaves[index as usize];
            let mut candidates =
                candidates::<F, KIND, W>(filters, frame_ray, &chords, leaf, limit, certain_limit, leaves_id);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                let id = leaf.id(lane);
                let beyond = candidates.near.0[lane % W] > limit && candidates.unbounded >> lane & 1 == 0;
                if beyond || candidates.missed >> lane & 1 == 1 {
                    continue;
                }
                if candidates.certain >> lane & 1 == 1 {
                    // Its exact distance can wait until the end, when it has been fetched.
                    if KIND == SPHERES || !leaf.is_exact(lane) {
                        filters.prefetch(&primitives[id.0 as usize]);
                    }
                    if pending.count == Pending::LIMIT {
                        pending.resolve(&mut best, (tree, leaves), primitives, &mut query, limit);
                    }
                    if candidates.far.0[lane] < limit {
                        limit = candidates.far.0[lane];
                        // Most often what waited is now beyond the limit.
                        if pending.count == 1 && pending.list[0].near > limit {
                            pending.count = 0;
                        }
                    }
                    pending.list[pending.count] =
                        Waiting { leaf: index, lane: lane as u32, near: candidates.near.0[lane] };
                    pending.count += 1;
                } else if decide(&mut best, tree, (leaf, lane), primitives, &mut query) {
                    limit = limit.min(tree.frame.distance(frame_ray.start, best.t_max));
                }
            }
        }
        loop {
            let Some(next) = stack.pop() else {
                if pending.count == 1 {
                    let Waiting { leaf, lane, .. } = pending.list[0];
                    let leaf = &leaves[leaf as usize];
                    let last = decide_last(
                        filters,
                        &best,
                        tree,
                        (leaf, lane as usize),
                        primitives,
                        &mut query,
                        (&projection, frame_ray.t_scale),
                    );
                    if let Some((RawHit { t, uv: [u, v] }, id)) = last {
                        let t = start.distance(frame_ray.t_scale, t);
                        return start.told(RawHit { t, uv: [u, v] }, SurfaceId::from(id));
                    }
                } else if pending.count > 1 {
                    pending.resolve(&mut best, (tree, leaves), primitives, &mut query, limit);
                }
                let (hit, surface) = best.found()?;
                return start.told(RawHit { t: start.distance(frame_ray.t_scale, hit.t), ..hit }, surface);
            };
            if (next >> 32) as u32 <= limit.to_bits() {
                child = next as u32;
                break;
            }
        }
    }
}

/// Two entries, the nearer one first.
#[inline(always)]
fn sorted(a: u64, b: u64) -> [u64; 2] {
    [a.min(b), a.max(b)]
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
    fn resolve<S: Start, const W: usize>(
        &mut self,
        best: &mut Best,
        (tree, leaves): (&WideTree, &[Leaf<W>]),
        primitives: &[Primitive],
        query: &mut Deferred<S>,
        limit: f32,
    ) {
        for waiting in &self.list[..self.count] {
            if waiting.near <= limit {
                let lane = (&leaves[waiting.leaf as usize], waiting.lane as usize);
                decide(best, tree, lane, primitives, query);
            }
        }
        self.count = 0;
    }
}

/// Decides in `f64` whether a lane of a leaf holds the closest hit so far.
#[cold]
#[inline(never)]
fn decide<S: Start, const W: usize>(
    best: &mut Best,
    tree: &WideTree,
    (leaf, lane): (&Leaf<W>, usize),
    primitives: &[Primitive],
    query: &mut Deferred<S>,
) -> bool {
    let (id, query) = (leaf.id(lane), query.get());
    if !leaf.is_exact(lane) {
        return best.test(primitives, query, id);
    }
    let limit = best.limit(id);
    let found = intersect_exact(Portable, tree, (leaf, lane), primitives, &query.projection, || *query, limit);
    if let Some(hit) = found {
        best.set(hit, id);
    }
    found.is_some()
}

/// [`decide`] for what is most often the only one to be decided: without a query, where its projection is enough.
#[inline(always)]
fn decide_last<F: Filters, S: Start, const W: usize>(
    filters: F,
    best: &Best,
    tree: &WideTree,
    (leaf, lane): (&Leaf<W>, usize),
    primitives: &[Primitive],
    query: &mut Deferred<S>,
    (projection, t_scale): (&Projection, f64),
) -> Option<(RawHit, PrimitiveId)> {
    let id = leaf.id(lane);
    let (limit, token) = (best.limit(id), filters.into());
    let found = if leaf.is_exact(lane) {
        intersect_exact(filters, tree, (leaf, lane), primitives, projection, || *query.get(), limit)
    } else {
        // Whose like is certain before leaves no primitive that it hits.
        match &primitives[id.0 as usize] {
            Primitive::Triangle(shape) => {
                let lanes = shape.lanes::<F::Four>(token, projection.axes());
                Triangle::intersect_lanes::<F::Four>(token, lanes, projection, || (shape, *query.get()), limit)
            }
            Primitive::Parallelogram(shape) => {
                shape.intersect_lanes::<F::Four>(token, projection, || *query.get(), limit)
            }
            Primitive::Sphere(shape) => {
                let [origin, direction] = query.start.line(t_scale);
                shape.intersect_line(origin, direction, limit, false)
            }
            // Taken apart: what a function that is called writes to lies in memory, and all that is made of it.
            shape => {
                let RawHit { t, uv: [u, v] } = shape.intersect(query.get(), limit, false)?;
                Some(RawHit { t, uv: [u, v] })
            }
        }
    };
    // As above.
    let RawHit { t, uv: [u, v] } = found?;
    Some((RawHit { t, uv: [u, v] }, id))
}

/// Announces that a child that waits on the stack will be visited. Without it rays that share nothing are a tenth slower in
/// trees that no cache holds.
#[inline(always)]
fn prefetch<F: Filters, const KIND: u8, const W: usize>(
    filters: F,
    (tree, nodes, leaves): (&WideTree, Nodes<'_>, &[Leaf<W>]),
    child: u32,
) {
    if !tree.prefetch {
        return;
    }
    if child & LEAF == 0 {
        filters.prefetch(nodes.at(child));
    } else if KIND != ANY_KIND || child & INSTANCE_LEAF == 0 {
        filters.prefetch(&leaves[(child & !LEAF) as usize]);
    }
}
