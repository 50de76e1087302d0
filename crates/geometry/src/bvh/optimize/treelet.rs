//! The treelet of a tree: what is above its largest subtrees.

use super::links::{Links, NONE};
use crate::bvh::build::{BinaryTree, Costs, Node};
use crate::bvh::collapse::least_cost;
use etalon_simd::Level;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Subtrees below a treelet, at most.
const SUBTREES: usize = 512;
/// A treelet that was grouped from below is taken if it costs rays less than this part of what the one that was split from above costs. In
/// the bench's rooms that is .78 to .9, in its other scenes 1 to 1.09.
const CLEARLY: f32 = 0.97;

/// The treelet of a tree, whose leaves are subtrees of the tree.
pub(super) struct Treelet {
    links: Links,
    /// The nodes of the tree that those of the treelet are.
    of: Vec<u32>,
}

impl Treelet {
    /// Of a tree; the largest nodes are opened first.
    pub(super) fn new(tree: &Links) -> Self {
        let entry = |of: u32, at: usize| (tree.areas[of as usize].to_bits(), Reverse(at));
        let (mut of, mut parents, mut children) = (vec![0], vec![NONE], vec![[NONE; 2]]);
        let mut open = BinaryHeap::from([entry(0, 0)]);
        // With each opened they are one more.
        while let Some((_, Reverse(at))) = open.pop() {
            if tree.is_leaf(of[at]) || of.len() + 2 >= 2 * SUBTREES {
                continue;
            }
            let first = of.len();
            children[at] = [first as u32, first as u32 + 1];
            for (place, child) in tree.children[of[at] as usize].into_iter().enumerate() {
                open.push(entry(child, first + place));
                of.push(child);
                parents.push(at as u32);
                children.push([NONE; 2]);
            }
        }
        let bounds = of.iter().map(|&node| tree.bounds[node as usize]).collect();
        let areas = of.iter().map(|&node| tree.areas[node as usize]).collect();
        Self { links: Links { bounds, areas, measure: tree.measure, parents, children }, of }
    }

    /// Grouped from below, if rays in it then cost clearly less.
    pub(super) fn grouped(mut self, costs: Costs, level: Level) -> Option<Self> {
        let cost = |links: &Links| {
            // Of leaves nothing is asked but that they are leaves.
            let node = |at: u32| Node {
                bounds: links.bounds[at as usize].to_box(),
                first: 0,
                count: u32::from(links.is_leaf(at)),
            };
            Some(least_cost(&BinaryTree { nodes: links.nodes(node)?, order: Vec::new() }, costs))
        };
        let split = cost(&self.links)?;
        self.links.group(level);
        let is_better = cost(&self.links)? < CLEARLY * split;
        is_better.then_some(self)
    }

    /// Puts it on the tree.
    pub(super) fn put_on(self, tree: &mut Links) {
        let Self { links, of } = self;
        for at in (0..of.len() as u32).filter(|&at| !links.is_leaf(at)) {
            let parent = of[at as usize];
            let children = links.children[at as usize].map(|child| of[child as usize]);
            tree.children[parent as usize] = children;
            children.iter().for_each(|&child| tree.parents[child as usize] = parent);
            tree.bounds[parent as usize] = links.bounds[at as usize];
            tree.areas[parent as usize] = links.areas[at as usize];
        }
    }
}
