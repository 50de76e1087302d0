//! Whether anything is hit at all.

use super::leaf::{Chords, candidates};
use super::portable::Portable;
use super::stack::{Room, Stack};
use super::start::{Deferred, Start};
use super::{Filters, Narrow, intersect_exact};
use crate::frame::FrameRay;
use crate::query::Query;
use crate::wide::{LEAF, LONE, Leaf8, WideTree};
use crate::{Primitive, PrimitiveId};

/// Whether anything is hit, in the order of the tree. A level of the stack is one entry, the children yet to be visited:
/// that spares a loop over them whose length no branch predictor can know.
#[inline(always)]
pub(super) fn any_on<F: Filters, S: Start, const N: usize>(
    filters: F,
    tree: &WideTree,
    primitives: &[Primitive],
    start: S,
    frame_ray: &FrameRay<Narrow<F>>,
) -> bool {
    let ray = filters.ray(&frame_ray.boxes);
    let chords = Chords::new(frame_ray, tree.spheres);
    let mut query = Deferred::new(start);
    let (leaves_id, aims_at) = (start.leaves(), start.aims_at());
    let limit = frame_ray.distance(frame_ray.t_max);
    let certain_limit = frame_ray.distance_below(frame_ray.t_max);
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
            if child & LONE != 0 {
                if occludes(primitives, query.get(), PrimitiveId(child & !(LEAF | LONE))) {
                    return true;
                }
                continue;
            }
            let leaf = &leaves[(child & !LEAF) as usize];
            let mut candidates = candidates(filters, frame_ray, &chords, leaf, limit, certain_limit);
            while candidates.mask != 0 {
                let lane = candidates.mask.trailing_zeros() as usize;
                candidates.mask &= candidates.mask - 1;
                let id = leaf.id(lane);
                if id == aims_at || id == leaves_id && candidates.left >> lane & 1 == 1 {
                    continue;
                }
                let certain = candidates.certain >> lane & 1 == 1 && id != leaves_id;
                let hit = certain || occludes_by(tree, leaf, lane, primitives, &mut query);
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
fn occludes_by<S: Start>(
    tree: &WideTree,
    leaf: &Leaf8,
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
