//! A binary tree whose parts can be moved.

use crate::bvh::build::{BinaryTree, MAX_DEPTH, Node, Span};
use crate::bvh::sah_cost::SahCost;

/// No node.
pub(super) const NONE: u32 = u32::MAX;

/// A binary tree in which subtrees can be moved: nodes by their indices in the tree that it is made of.
#[derive(Clone)]
pub(super) struct Links {
    pub(super) bounds: Vec<Span>,
    /// How often rays enter them, by the measure: areas to which the inside adds.
    pub(super) areas: Vec<f32>,
    pub(super) measure: SahCost,
    /// [`NONE`] for the root, which is node 0.
    pub(super) parents: Vec<u32>,
    /// [`NONE`] for leaves.
    pub(super) children: Vec<[u32; 2]>,
}

impl Links {
    pub(super) fn new(tree: &BinaryTree) -> Self {
        let bounds: Vec<Span> = tree.nodes.iter().map(|node| Span::of(&node.bounds)).collect();
        let measure = SahCost::in_scene(bounds[0].sides());
        let areas = bounds.iter().map(|bounds| measure.of(bounds.sides())).collect();
        let mut parents = vec![NONE; bounds.len()];
        let mut children = vec![[NONE; 2]; bounds.len()];
        for (index, node) in tree.nodes.iter().enumerate().filter(|(_, node)| node.count == 0) {
            children[index] = [index as u32 + 1, node.first];
            children[index].iter().for_each(|&child| parents[child as usize] = index as u32);
        }
        Self { bounds, areas, measure, parents, children }
    }

    pub(super) fn sibling(&self, node: u32) -> u32 {
        let [a, b] = self.children[self.parents[node as usize] as usize];
        if a == node { b } else { a }
    }

    pub(super) fn replace(&mut self, parent: u32, child: u32, new: u32) {
        self.children[parent as usize].iter_mut().filter(|c| **c == child).for_each(|c| *c = new);
        self.parents[new as usize] = parent;
    }

    /// Measures a node anew.
    pub(super) fn refit(&mut self, node: u32) {
        let [left, right] = self.children[node as usize];
        let bounds = self.bounds[left as usize].union(self.bounds[right as usize]);
        self.bounds[node as usize] = bounds;
        self.areas[node as usize] = self.measure.of(bounds.sides());
    }

    /// Whether a node is one.
    pub(super) fn is_leaf(&self, node: u32) -> bool {
        self.children[node as usize][0] == NONE
    }

    /// The nodes in the order of a [`BinaryTree`], of which `node` tells what is not told here: what a leaf holds. None if it became too
    /// deep for rays.
    pub(super) fn nodes(&self, node: impl Fn(u32) -> Node) -> Option<Vec<Node>> {
        let mut nodes: Vec<Node> = Vec::with_capacity(self.children.len());
        // What is still to come: a node, its depth, and whose right child it is.
        let mut rest = vec![(0, 1, NONE)];
        while let Some((index, depth, left_of)) = rest.pop() {
            if depth > MAX_DEPTH {
                return None;
            }
            let at = nodes.len() as u32;
            if left_of != NONE {
                nodes[left_of as usize].first = at;
            }
            let bounds = self.bounds[index as usize].to_box();
            nodes.push(Node { bounds, ..node(index) });
            let [left, right] = self.children[index as usize];
            if left != NONE {
                rest.extend([(right, depth + 1, at), (left, depth + 1, NONE)]);
            }
        }
        Some(nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Box32;

    #[test]
    fn a_tree_that_became_too_deep_is_not_taken() {
        // A chain of nodes, each with a leaf: one more level than rays have room for.
        for (levels, fits) in [(MAX_DEPTH, true), (MAX_DEPTH + 1, false)] {
            let bounds = Box32 { min: [0.0; 3], max: [1.0; 3] };
            let leaf = |first| Node { bounds, first, count: 1 };
            let mut nodes = Vec::new();
            for level in 1..levels as u32 {
                // Its left child follows, its right one comes after all of them.
                nodes.push(Node { bounds, first: 2 * levels as u32 - 1 - level, count: 0 });
            }
            nodes.extend((0..levels as u32).map(leaf));
            let tree = BinaryTree { order: (0..levels as u32).collect(), nodes };
            assert_eq!(Links::new(&tree).nodes(|node| tree.nodes[node as usize]).is_some(), fits);
        }
    }
}
