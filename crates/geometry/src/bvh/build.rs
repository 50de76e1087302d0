//! Building a binary tree of boxes: by the surface area heuristic here, by clustering of neighbours in `ploc`.
//!
//! How the two compare stands in `docs/decisions/0049-obvhs-as-fast-builder.md`.

mod ploc;
mod span;
mod split;

use crate::frame::Box32;
use crate::level::vectorised;
use etalon_simd::Level;
pub(crate) use ploc::build_fast;
use span::Extent;
pub(crate) use span::{Item, Span};
pub(crate) use split::Costs;
use split::{Bins, Partition, SWEEP_LIMIT, Sweep};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Which builder makes the tree of a [`Geometry`](crate::Geometry).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TreeBuilder {
    /// Binned splits by the surface area heuristic, then an optimiser: the fastest rays.
    #[default]
    Thorough,
    /// Locally ordered clustering (PLOC) by the crate `obvhs`, without an optimiser: for trees over some thousand moving objects that are
    /// built often. On meshes it is slower (`docs/decisions/0049-obvhs-as-fast-builder.md`).
    Fast,
}

/// Primitives of a leaf, at most. Which of these become one leaf of the tree that rays traverse is found when that is made.
pub(crate) const LEAF_LIMIT: usize = 8;
/// Above this many primitives the two halves of a node are built in parallel.
const PARALLEL_LIMIT: usize = 16_384;
/// Below this depth nodes are halved by count, whatever their areas.
const DEPTH_LIMIT: u32 = 48;
/// Levels of the deepest tree: 2²⁹ primitives are halved 29 times.
pub(crate) const MAX_DEPTH: usize = DEPTH_LIMIT as usize + 30;

/// A node of the binary tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) bounds: Box32,
    /// Leaf: the first of its primitives in [`BinaryTree::order`]. Inner node: its right child; the left one follows it.
    pub(crate) first: u32,
    /// Leaf: the number of its primitives. Inner node: 0.
    pub(crate) count: u32,
}

/// A binary tree of boxes.
#[derive(Debug)]
pub(crate) struct BinaryTree {
    /// The root is the first; a subtree is contiguous.
    pub(crate) nodes: Vec<Node>,
    /// Primitive indices, leaf by leaf.
    pub(crate) order: Vec<u32>,
}

impl BinaryTree {
    /// Up to `limit` boxes that hold all primitives: the largest are opened first.
    pub(crate) fn outline(&self, limit: usize) -> Vec<Box32> {
        let entry = |node: u32| (self.nodes[node as usize].bounds.half_area().to_bits(), Reverse(node));
        let (mut open, mut leaves) = (BinaryHeap::from([entry(0)]), Vec::new());
        while let Some((_, Reverse(index))) = open.pop() {
            let node = &self.nodes[index as usize];
            if node.count > 0 || leaves.len() + open.len() + 2 > limit {
                leaves.push(node.bounds);
            } else {
                open.extend([entry(index + 1), entry(node.first)]);
            }
        }
        leaves
    }

    /// The primitives in a subtree, leaf by leaf.
    pub(crate) fn primitives(&self, root: u32) -> impl Iterator<Item = u32> {
        // It ends where no child is to come any more.
        let mut to_come = 1;
        let within = move |node: &&Node| {
            if to_come == 0 {
                return false;
            }
            to_come = if node.count == 0 { to_come + 1 } else { to_come - 1 };
            true
        };
        let leaves = self.nodes[root as usize..].iter().take_while(within).filter(|node| node.count > 0);
        leaves.flat_map(|leaf| self.order[leaf.first as usize..][..leaf.count as usize].iter().copied())
    }
}

/// Builds a tree over at least one primitive. The result does not depend on the number of threads.
pub(crate) fn build(mut items: Vec<Item>, costs: Costs, level: Level) -> BinaryTree {
    assert!(!items.is_empty(), "a tree has at least one primitive");
    let mut nodes = Vec::new();
    let extent = Extent::of(&items);
    Builder { costs, level }.subtree(&mut items, 0, 0, extent, &mut nodes);
    BinaryTree { nodes, order: items.iter().map(Item::id).collect() }
}

struct Builder {
    costs: Costs,
    /// What the loops over items are compiled for.
    level: Level,
}

impl Builder {
    /// Appends the subtree of `items`; `first` is their place in the tree's order.
    fn subtree(&self, items: &mut [Item], first: u32, depth: u32, extent: Extent, nodes: &mut Vec<Node>) {
        let count = items.len();
        let bounds = extent.bounds.to_box();
        let leaf = Node { bounds, first, count: count as u32 };
        let index = nodes.len();
        nodes.push(leaf);
        if count == 1 {
            return;
        }
        let split = if depth >= DEPTH_LIMIT {
            None
        } else if count <= SWEEP_LIMIT {
            vectorised(self.level, Sweep(self.costs, items, &extent))
        } else {
            vectorised(self.level, Bins(self.costs, items, &extent))
        };
        if count <= LEAF_LIMIT && !extent.bounds.is_instance_leaf() {
            let area = extent.bounds.half_area();
            let leaf_cost = self.costs.leaf(extent.bounds, count) * area;
            if !split.as_ref().is_some_and(|s| s.cost + self.costs.node * area < leaf_cost) {
                return;
            }
        }
        let (left_count, [left_extent, right_extent]) = vectorised(self.level, Partition(items, split, &extent));
        let (left, right) = items.split_at_mut(left_count);
        let right_first = first + left_count as u32;
        let right_child = if count > PARALLEL_LIMIT {
            let (mut left_nodes, mut right_nodes) = (Vec::new(), Vec::new());
            rayon::join(
                || self.subtree(left, first, depth + 1, left_extent, &mut left_nodes),
                || self.subtree(right, right_first, depth + 1, right_extent, &mut right_nodes),
            );
            append(nodes, &left_nodes);
            drop(left_nodes);
            let right_child = nodes.len() as u32;
            append(nodes, &right_nodes);
            right_child
        } else {
            self.subtree(left, first, depth + 1, left_extent, nodes);
            let right_child = nodes.len() as u32;
            self.subtree(right, right_first, depth + 1, right_extent, nodes);
            right_child
        };
        nodes[index] = Node { bounds, first: right_child, count: 0 };
    }
}

/// Appends the nodes of a subtree.
fn append(nodes: &mut Vec<Node>, subtree: &[Node]) {
    let base = nodes.len() as u32;
    nodes.extend(subtree.iter().map(|&node| match node.count {
        0 => Node { first: node.first + base, ..node },
        _ => node,
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level;
    use crate::test_support::Random;

    #[test]
    fn a_tree_is_the_same_for_every_instruction_set() {
        let mut random = Random::new(9);
        for count in [1, 2, 9, 64, 65, 5000] {
            let boxes: Vec<Box32> = (0..count)
                .map(|_| {
                    let min = std::array::from_fn(|_| random.unit() as f32);
                    Box32 { min, max: min.map(|c| c + 0.1 * random.unit() as f32) }
                })
                .collect();
            let tree = |level| {
                let items = boxes.iter().enumerate().map(|(id, b)| Item::new(b, id as u32, id % 97 == 0)).collect();
                let tree = build(items, Costs { block: 8, node: 0.35 }, level);
                // Everything, bit for bit.
                format!("{tree:?}")
            };
            let portable = tree(Level::Baseline);
            assert!(level::all().into_iter().all(|level| tree(level) == portable));
        }
    }

    #[test]
    fn an_outline_holds_all_and_opens_the_largest_boxes() {
        let mut random = Random::new(10);
        for count in [1, 7, 200, 5_000] {
            let boxes: Vec<Box32> = (0..count)
                .map(|_| {
                    let min: [f32; 3] = std::array::from_fn(|_| random.unit() as f32);
                    Box32 { min, max: min.map(|c| c + 0.01 * random.unit() as f32) }
                })
                .collect();
            let items = boxes.iter().enumerate().map(|(id, b)| Item::new(b, id as u32, false)).collect();
            let tree = build(items, Costs { block: 8, node: 0.35 }, level::best());
            for limit in [1, 2, 3, 50, 96] {
                let outline = tree.outline(limit);
                assert!(outline.len() <= limit);
                let holds =
                    |outer: &Box32, b: &Box32| (0..3).all(|k| outer.min[k] <= b.min[k] && b.max[k] <= outer.max[k]);
                assert!(boxes.iter().all(|b| outline.iter().any(|outer| holds(outer, b))));
                // Boxes are as many as may be, unless all are leaves; what stays closed is no larger than what was opened.
                let is_in = |node: &&&Node| outline.contains(&node.bounds);
                let inner: Vec<&Node> = tree.nodes.iter().filter(|node| node.count == 0).collect();
                let area = |node: &&Node| node.bounds.half_area();
                let closed = inner.iter().filter(is_in).map(area).fold(0.0, f32::max);
                assert!(outline.len() == limit || closed == 0.0);
                let opened = inner.iter().filter(|node| outline.iter().any(|b| holds(&node.bounds, b)) && !is_in(node));
                assert!(opened.map(area).all(|area| area >= closed));
            }
        }
    }
}
