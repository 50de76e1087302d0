//! Moving subtrees of a finished binary tree to better places.
//!
//! A builder that splits from above decides about large boxes before it knows small ones. Afterwards each subtree can be taken out and
//! put where it enlarges the boxes around it least (Bittner, Hapala & Havran, *Fast Insertion-Based Optimization of Bounding Volume
//! Hierarchies*, CGF 32(1), 2013; the search from the place left upward: Meister & Bittner, *Parallel Reinsertion for Bounding
//! Volume Hierarchy Optimization*, CGF 37(2), 2018). What it gains stands in `docs/performance.md`.

use crate::build::{BinaryTree, MAX_DEPTH, Node, Span};

/// Times that the largest subtrees are looked at.
const ROUNDS: usize = 4;
/// One in so many subtrees is looked at: nearly all that can be gained is to be had from the largest.
const SHARE: usize = 32;
/// At least so many are, if there are.
const LEAST: usize = 1024;
/// Places that are looked at for one subtree, at most: so that no input makes the time more than proportional to its size. Most
/// searches end after some tens.
const MOST_PLACES: usize = 4096;
/// No node.
const NONE: u32 = u32::MAX;

/// The same leaves in a tree whose inner nodes have less area, or as much.
pub(crate) fn improved(tree: BinaryTree) -> BinaryTree {
    let mut links = Links::new(&tree);
    let mut search = Vec::new();
    for _ in 0..ROUNDS {
        let mut moved = false;
        for node in links.largest() {
            if let Some(place) = links.best_place(node, &mut search).1 {
                links.reinsert(node, place);
                moved = true;
            }
        }
        if !moved {
            break;
        }
    }
    match links.nodes(&tree) {
        Some(nodes) => BinaryTree { nodes, ..tree },
        None => tree,
    }
}

/// A binary tree in which subtrees can be moved: nodes by their indices in the tree that it is made of.
struct Links {
    bounds: Vec<Span>,
    /// Half the surface areas of the bounds.
    areas: Vec<f32>,
    /// [`NONE`] for the root, which is node 0.
    parents: Vec<u32>,
    /// [`NONE`] for leaves.
    children: Vec<[u32; 2]>,
}

impl Links {
    fn new(tree: &BinaryTree) -> Self {
        let bounds: Vec<Span> = tree.nodes.iter().map(|node| Span::of(&node.bounds)).collect();
        let areas = bounds.iter().map(|bounds| bounds.half_area()).collect();
        let mut parents = vec![NONE; bounds.len()];
        let mut children = vec![[NONE; 2]; bounds.len()];
        for (index, node) in tree.nodes.iter().enumerate().filter(|(_, node)| node.count == 0) {
            children[index] = [index as u32 + 1, node.first];
            children[index].iter().for_each(|&child| parents[child as usize] = index as u32);
        }
        Self { bounds, areas, parents, children }
    }

    /// The subtrees to be looked at, the largest first; of the same area in the order of their indices.
    fn largest(&self) -> Vec<u32> {
        let count = (self.areas.len() / SHARE).max(LEAST);
        let key = |&node: &u32| (std::cmp::Reverse(self.areas[node as usize].to_bits()), node);
        let mut nodes: Vec<u32> = (1..self.areas.len() as u32).collect();
        if nodes.len() > count {
            nodes.select_nth_unstable_by_key(count, key);
            nodes.truncate(count);
        }
        nodes.sort_unstable_by_key(key);
        nodes
    }

    fn sibling(&self, node: u32) -> u32 {
        let [a, b] = self.children[self.parents[node as usize] as usize];
        if a == node { b } else { a }
    }

    /// The node beside which a subtree would be best, and by how much the area of all inner nodes would be less. None if it is
    /// best where it is, or hangs on the root. `search` is room that is used again.
    ///
    /// The subtree's parent goes when it is taken out, and those above shrink; where it is put a node of its union with its new
    /// sibling comes, and those above grow. From each node above in turn one searches downward on the other side, as long as what is
    /// gained so far, less the subtree's own area, of which any new parent has at least as much, exceeds the best.
    fn best_place(&self, node: u32, search: &mut Vec<(u32, f32)>) -> (f32, Option<u32>) {
        let (bounds, area) = (self.bounds[node as usize], self.areas[node as usize]);
        let parent = self.parents[node as usize];
        let (mut best, mut place) = (0.0, None);
        if self.parents[parent as usize] == NONE {
            return (best, place);
        }
        let mut above = parent;
        let mut side = self.sibling(node);
        // The bounds of the node above without the subtree, and what is gained below that.
        let mut without = self.bounds[side as usize];
        let mut gain = self.areas[parent as usize];
        let mut places = 0;
        loop {
            search.clear();
            search.push((side, gain));
            while let Some((at, gain)) = search.pop() {
                if gain - area <= best || places == MOST_PLACES {
                    continue;
                }
                places += 1;
                let union = self.bounds[at as usize].union(bounds).half_area();
                // Never the sibling that it has, which gains nothing.
                if gain - union > best {
                    (best, place) = (gain - union, Some(at));
                }
                let below = gain - (union - self.areas[at as usize]);
                let [left, right] = self.children[at as usize];
                if left != NONE && below - area > best {
                    search.extend([(left, below), (right, below)]);
                }
            }
            if above != parent {
                without = without.union(self.bounds[side as usize]);
                let area = without.half_area();
                // Beside the node above itself: what comes is as large as that was.
                if gain - area > best && self.parents[above as usize] != NONE {
                    (best, place) = (gain - area, Some(above));
                }
                // Put anywhere farther up, it leaves that node smaller.
                gain += self.areas[above as usize] - area;
            }
            if self.parents[above as usize] == NONE {
                return (best, place);
            }
            side = self.sibling(above);
            above = self.parents[above as usize];
        }
    }

    /// Takes a subtree that does not hang on the root out and puts it beside another node, neither the root nor its parent nor within
    /// it.
    fn reinsert(&mut self, node: u32, place: u32) {
        let parent = self.parents[node as usize];
        let (sibling, grandparent) = (self.sibling(node), self.parents[parent as usize]);
        self.replace(grandparent, parent, sibling);
        self.replace(self.parents[place as usize], place, parent);
        self.children[parent as usize] = [place, node];
        self.parents[place as usize] = parent;
        self.refit(grandparent);
        self.refit(parent);
    }

    fn replace(&mut self, parent: u32, child: u32, new: u32) {
        self.children[parent as usize].iter_mut().filter(|c| **c == child).for_each(|c| *c = new);
        self.parents[new as usize] = parent;
    }

    /// Measures a node and all above it anew.
    fn refit(&mut self, mut node: u32) {
        while node != NONE {
            let [left, right] = self.children[node as usize];
            let bounds = self.bounds[left as usize].union(self.bounds[right as usize]);
            self.bounds[node as usize] = bounds;
            self.areas[node as usize] = bounds.half_area();
            node = self.parents[node as usize];
        }
    }

    /// The nodes in the order of a [`BinaryTree`], where `tree` is the one that this one is made of; none if it became too deep for
    /// rays.
    fn nodes(&self, tree: &BinaryTree) -> Option<Vec<Node>> {
        let mut nodes: Vec<Node> = Vec::with_capacity(tree.nodes.len());
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
            nodes.push(Node { bounds, ..tree.nodes[index as usize] });
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
    use crate::build::{Costs, Item, build};
    use crate::frame::Box32;
    use crate::test_support::Random;
    use crate::traverse::Level;

    fn boxes(random: &mut Random, count: usize) -> Vec<Item> {
        (0..count as u32)
            .map(|id| {
                let min = std::array::from_fn(|_| random.unit() as f32);
                let size = 10_f64.powf(-3.0 * random.unit()) as f32;
                let max = std::array::from_fn(|k: usize| min[k] + size * random.unit() as f32);
                Item::new(&Box32 { min, max }, id, false)
            })
            .collect()
    }

    fn tree(random: &mut Random, count: usize) -> BinaryTree {
        build(boxes(random, count), Costs { block: 1, node: 0.0 }, Level::detect())
    }

    /// The area of all inner nodes, from the leaves' boxes alone.
    fn inner_area(links: &Links, node: u32) -> (Span, f64) {
        let [left, right] = links.children[node as usize];
        if left == NONE {
            return (links.bounds[node as usize], 0.0);
        }
        let ((a, below_a), (b, below_b)) = (inner_area(links, left), inner_area(links, right));
        let bounds = a.union(b);
        (bounds, f64::from(bounds.half_area()) + below_a + below_b)
    }

    fn within(links: &Links, root: u32, mut node: u32) -> bool {
        while node != NONE && node != root {
            node = links.parents[node as usize];
        }
        node == root
    }

    #[test]
    fn the_place_found_is_the_best_of_all_places_tried_one_by_one() {
        let mut random = Random::new(31);
        let (mut moved, mut looked) = (0, 0);
        for _ in 0..20 {
            let tree = tree(&mut random, 12);
            let links = Links::new(&tree);
            let count = tree.nodes.len() as u32;
            let before = inner_area(&links, 0).1;
            for node in (1..count).filter(|&n| links.parents[links.parents[n as usize] as usize] != NONE) {
                let (gain, place) = links.best_place(node, &mut Vec::new());
                let possible = |&at: &u32| {
                    !within(&links, node, at) && at != links.parents[node as usize] && at != links.sibling(node)
                };
                let gain_at = |at: u32| {
                    let mut other = Links::new(&tree);
                    other.reinsert(node, at);
                    before - inner_area(&other, 0).1
                };
                let best = (1..count).filter(possible).map(gain_at).fold(0.0, f64::max);
                // Sums of some twenty areas below 3, each rounded.
                assert!((f64::from(gain) - best).abs() < 1e-4, "{gain} for {best}");
                assert!(place.is_none_or(|at| (gain_at(at) - best).abs() < 1e-4));
                moved += u32::from(place.is_some());
                looked += 1;
            }
        }
        assert!(moved > 20 && moved < looked, "{moved} of {looked}");
    }

    #[test]
    fn an_improved_tree_has_the_same_leaves_tight_boxes_and_less_area() {
        let mut random = Random::new(32);
        for count in [1, 2, 3, 9, 100, 3000] {
            let before = tree(&mut random, count);
            let area = |tree: &BinaryTree| inner_area(&Links::new(tree), 0).1;
            let leaves = |tree: &BinaryTree| {
                let mut leaves: Vec<_> =
                    tree.nodes.iter().filter(|n| n.count > 0).map(|n| (n.first, n.count)).collect();
                leaves.sort_unstable();
                leaves
            };
            let (area_before, leaves_before) = (area(&before), leaves(&before));
            let after = improved(before);
            assert_eq!(leaves(&after), leaves_before);
            assert_eq!(after.order.len(), count);
            for (index, node) in after.nodes.iter().enumerate().filter(|(_, node)| node.count == 0) {
                let union = [index + 1, node.first as usize].map(|child| Span::of(&after.nodes[child].bounds));
                let (union, bounds) = (union[0].union(union[1]).to_box(), &node.bounds);
                assert!(union.min == bounds.min && union.max == bounds.max);
            }
            assert!(area(&after) <= area_before);
            if count == 3000 {
                assert!(area(&after) < 0.99 * area_before, "{} of {area_before}", area(&after));
            }
        }
    }

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
            assert_eq!(Links::new(&tree).nodes(&tree).is_some(), fits);
        }
    }
}
