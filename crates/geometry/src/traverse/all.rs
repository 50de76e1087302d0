//! Every hit of a ray, in the order of the tree.

use super::compiled::Compiled;
use super::leaf::{SphereFilter, candidates};
use super::node_hits::NodeHits;
use super::portable::Portable;
use super::{Filters, Job, run};
use crate::bvh::leaf::Leaf;
use crate::bvh::node::{ANY_KIND, INSTANCE_LEAF, LEAF, Leaves};
use crate::frame::Frame;
use crate::geometry::WideTree;
use crate::query::Query;
use crate::ray::RawHit;
use crate::{Primitive, PrimitiveId, SurfaceId};
use etalon_simd::Level;

/// Takes a hit and returns the end, exclusive, of the distances that still matter.
pub(crate) type Visit<'a> = dyn FnMut(RawHit, SurfaceId) -> f64 + 'a;

/// Calls `visit` for every hit at a distance from `from` on and below the end: that of the query at first, then what the last
/// call returned. Returns the last end.
pub(crate) fn all(
    level: Level,
    tree: &WideTree,
    primitives: &[Primitive],
    query: &Query,
    from: f64,
    visit: &mut Visit<'_>,
) -> f64 {
    run(level, All { tree, primitives, query, from, visit })
}

struct All<'a, 'v> {
    tree: &'a WideTree,
    primitives: &'a [Primitive],
    query: &'a Query,
    from: f64,
    visit: &'a mut Visit<'v>,
}

impl Job for All<'_, '_> {
    type Output = f64;

    #[inline(always)]
    fn run<F: Compiled>(self, filters: F) -> f64 {
        use super::vector::Vector;
        match self.tree.leaves() {
            Leaves::Eight(leaves) if const { F::Vector::WIDTH == 8 } => walk(filters, leaves, self),
            Leaves::Sixteen(leaves) if const { F::Vector::WIDTH == 16 } => walk(filters, leaves, self),
            Leaves::Eight(leaves) => walk(Portable, leaves, self),
            Leaves::Sixteen(leaves) => walk(Portable, leaves, self),
        }
    }
}

#[inline(always)]
fn walk<F: Filters, const W: usize>(filters: F, leaves: &[Leaf<W>], all: All<'_, '_>) -> f64 {
    let All { tree, primitives, query, from, visit } = all;
    let mut t_max = query.t_max;
    let (ahead, culled) = ahead(&tree.frame, query, from);
    let Some(frame_ray) = tree.frame.enter(filters.into(), &culled) else { return t_max };
    let ray = filters.ray(&frame_ray.boxes);
    let chords = SphereFilter::new(&frame_ray, tree.spheres);
    let mut limit = frame_ray.limit;
    let mut stack = Vec::with_capacity(64);
    stack.push(0);
    while let Some(child) = stack.pop() {
        if child & LEAF == 0 {
            let node = tree.nodes().at(child);
            let met = filters.enter(&ray, node, limit).mask();
            stack.extend(bits(met).map(|lane| node.children.0[lane]));
            continue;
        }
        if child & INSTANCE_LEAF != 0 {
            let instance_node = &tree.instance_nodes()[(child & !(LEAF | INSTANCE_LEAF)) as usize];
            t_max = all_of(primitives, query, instance_node.id, (from, t_max), visit);
        } else {
            let leaf = &leaves[(child & !LEAF) as usize];
            // No primitive counts as left: the filters would judge it by the origin that was moved ahead.
            let leaves = PrimitiveId::NONE;
            let found = candidates::<F, ANY_KIND, W>(filters, &frame_ray, &chords, leaf, limit, 0.0, leaves);
            for lane in bits(found.mask & !found.missed) {
                t_max = all_of(primitives, query, leaf.id(lane), (from, t_max), visit);
            }
        }
        if t_max < query.t_max {
            limit = limit.min(tree.frame.distance(frame_ray.start, t_max - ahead));
        }
    }
    t_max
}

/// The query with its origin moved along it, short of `from`, for the filters alone; and by how much.
///
/// It stays where it is if it starts, or `from` lies, so far from the frame that the new origin would err by more than what boxes
/// are widened by: 2⁻⁴² of the frame, where 2⁻⁴⁸ are the rounding of coordinates below 32.
#[inline(always)]
fn ahead(frame: &Frame, query: &Query, from: f64) -> (f64, Query) {
    const REACH: f64 = 16.0;
    // So much short that the first hits are ahead beyond the doubts of their distances.
    let ahead = from * (1.0 - 1.0 / (1_u64 << 24) as f64);
    let near = frame.place(query.origin).abs().max_component() < REACH && ahead * frame.scale() < REACH;
    if !near || ahead <= 0.0 {
        return (0.0, *query);
    }
    let origin = query.origin + query.direction * ahead;
    (ahead, Query { origin, t_max: query.t_max - ahead, ..*query })
}

/// Calls `visit` for every hit of one primitive.
pub(crate) fn all_of(
    primitives: &[Primitive],
    query: &Query,
    id: PrimitiveId,
    (from, mut t_max): (f64, f64),
    visit: &mut Visit<'_>,
) -> f64 {
    match &primitives[id.0 as usize] {
        // Left as a whole.
        Primitive::Instance(_) if query.leaves == id => {}
        Primitive::Instance(instance) => t_max = instance.all(query, (from, t_max), visit),
        shape => {
            for hit in shape.crossings(query, query.leaves == id).into_iter().flatten() {
                if from <= hit.t && hit.t < t_max {
                    t_max = visit(hit, SurfaceId::from(id));
                }
            }
        }
    }
    t_max
}

/// The bits of a mask.
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (mask != 0).then(|| mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        lane
    })
}
