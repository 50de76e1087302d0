//! Whether anything is hit at all.

use super::compiled::Compiled;
use super::leaf::{SphereFilter, candidates};
use super::node_hits::NodeHits;
use super::portable::Portable;
use super::stack::{Room, Stack};
use super::start::{Deferred, Start};
use super::{Narrow, intersect_exact};
use crate::bvh::leaf::Leaf;
use crate::bvh::node::{ANY_KIND, INSTANCE_LEAF, LEAF, NODE_WIDTH, Node16, Nodes, SPHERES};
use crate::frame::FrameRay;
use crate::geometry::{InstanceNode, WideTree};
use crate::query::Query;
use crate::{Primitive, PrimitiveId};

/// Whether anything is hit, in the order of the tree. A level of the stack is one entry, the children yet to be visited:
/// that spares a loop over them whose length no branch predictor can know.
#[inline(always)]
pub(super) fn any_on<F: Compiled, S: Start, const KIND: u8, const N: usize, const W: usize>(
    filters: F,
    (tree, leaves): (&WideTree, &[Leaf<W>]),
    primitives: &[Primitive],
    start: S,
    frame_ray: &FrameRay<Narrow<F>>,
) -> bool {
    let ray = filters.ray(&frame_ray.boxes);
    let chords = SphereFilter::new(frame_ray, KIND == SPHERES || KIND == ANY_KIND && tree.spheres);
    let mut query = Deferred::new(start);
    let (leaves_id, aims_at) = (start.leaves(), start.aims_at());
    let limit = frame_ray.limit;
    let certain_limit = frame_ray.certain_limit;
    let nodes = tree.nodes();
    let mut room = Room::<(u32, u32), N>::new();
    let mut levels = Stack::new(&mut room);
    let (mut node, mut index, mut mask) = (nodes.at(0), 0, 0);
    let mut child = 0;
    loop {
        // The walk calls no function, lest registers be saved for it.
        let open = loop {
            while child & LEAF == 0 {
                if mask != 0 {
                    levels.push((index, mask));
                }
                (node, index) = (nodes.at(child), child);
                let met = filters.enter(&ray, node, limit);
                mask = met.mask();
                if mask == 0 {
                    match next(&mut levels, nodes, (&mut node, &mut index, &mut mask)) {
                        Some(next) => child = next,
                        None => return false,
                    }
                } else {
                    child = met.first(node);
                    mask &= mask - 1;
                }
            }
            if KIND == ANY_KIND && child & INSTANCE_LEAF != 0 {
                break Open::Instance(&tree.instance_nodes()[(child & !(LEAF | INSTANCE_LEAF)) as usize]);
            }
            let leaf = &leaves[(child & !LEAF) as usize];
            let candidates =
                candidates::<F, KIND, W>(filters, frame_ray, &chords, leaf, limit, certain_limit, leaves_id);
            let (mut met, mut open) = (candidates.mask & !candidates.missed, 0);
            while met != 0 {
                let lane = met.trailing_zeros() as usize;
                met &= met - 1;
                let id = leaf.id(lane);
                if id == aims_at {
                    continue;
                }
                if candidates.certain >> lane & 1 == 1 {
                    return true;
                }
                open |= 1 << lane;
            }
            if open != 0 {
                break Open::Leaf(leaf, open);
            }
            match next(&mut levels, nodes, (&mut node, &mut index, &mut mask)) {
                Some(next) => child = next,
                None => return false,
            }
        };
        let hit = match open {
            Open::Instance(instance_node) => filters.occludes_in_instance(instance_node, primitives, query.get_apart()),
            Open::Leaf(leaf, mut mask) => loop {
                if mask == 0 {
                    break false;
                }
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if occludes_by(tree, leaf, lane, primitives, &mut query) {
                    break true;
                }
            },
        };
        if hit {
            return true;
        }
        match next(&mut levels, nodes, (&mut node, &mut index, &mut mask)) {
            Some(next) => child = next,
            None => return false,
        }
    }
}

/// What a walk leaves open.
enum Open<'a, const W: usize> {
    /// Whether these lanes of a leaf are hit.
    Leaf(&'a Leaf<W>, u32),
    /// Whether anything within an instance is.
    Instance(&'a InstanceNode),
}

/// The next child of a node or, if there is none left, of one above it.
#[inline(always)]
fn next<'a, const N: usize>(
    levels: &mut Stack<'_, (u32, u32), N>,
    nodes: Nodes<'a>,
    (node, index, mask): (&mut &'a Node16, &mut u32, &mut u32),
) -> Option<u32> {
    if *mask == 0 {
        (*index, *mask) = levels.pop()?;
        *node = nodes.at(*index);
    }
    let child = node.children.0[mask.trailing_zeros() as usize % NODE_WIDTH];
    *mask &= *mask - 1;
    Some(child)
}

/// Whether the primitive in a lane of a leaf hides the end of a ray from its start, where `f32` does not tell.
#[cold]
#[inline(never)]
fn occludes_by<S: Start, const W: usize>(
    tree: &WideTree,
    leaf: &Leaf<W>,
    lane: usize,
    primitives: &[Primitive],
    query: &mut Deferred<S>,
) -> bool {
    let query = query.get();
    if leaf.is_exact(lane) {
        intersect_exact(Portable, tree, (leaf, lane), primitives, &query.projection, || *query, query.t_max).is_some()
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
