//! Moving subtrees of a finished binary tree to better places.
//!
//! A builder that splits from above decides about large boxes before it knows small ones. Afterwards each subtree can be taken out and
//! put where it enlarges the boxes around it least (Bittner, Hapala & Havran, *Fast Insertion-Based Optimization of Bounding Volume
//! Hierarchies*, CGF 32(1), 2013; the search from the place left upward: Meister & Bittner, *Parallel Reinsertion for Bounding
//! Volume Hierarchy Optimization*, CGF 37(2), 2018). What it gains stands in `docs/log/2026-11-ray-traversal.md`.

use super::links::{Links, NONE};

/// Times that the largest subtrees are looked at.
const ROUNDS: usize = 4;
/// One of this many subtrees is looked at: nearly all that can be gained is to be had from the largest.
const SHARE: usize = 32;
/// At least this many are looked at, if there are as many.
const LEAST: usize = 1024;
/// Places that are looked at for one subtree, at most: so that no input makes the time more than proportional to its size. Most
/// searches end after some tens.
const MOST_PLACES: usize = 4096;

impl Links {
    /// Puts subtrees, the largest ones first, where the boxes around them grow least.
    pub(super) fn reinsert_largest(&mut self) {
        let mut search = Vec::new();
        for _ in 0..ROUNDS {
            let mut moved = false;
            for node in self.largest() {
                if let Some(place) = self.best_place(node, &mut search).1 {
                    self.reinsert(node, place);
                    moved = true;
                }
            }
            if !moved {
                break;
            }
        }
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
                let union = self.measure.of(self.bounds[at as usize].union(bounds).sides());
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
                let area = self.measure.of(without.sides());
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
        self.refit_from(grandparent);
        self.refit_from(parent);
    }

    /// Measures a node and all above it anew.
    fn refit_from(&mut self, mut node: u32) {
        while node != NONE {
            self.refit(node);
            node = self.parents[node as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::Span;
    use crate::bvh::optimize::scattered;
    use crate::test_support::Random;

    /// The area of all inner nodes, from the leaves' boxes alone.
    fn inner_area(links: &Links, node: u32) -> (Span, f64) {
        let [left, right] = links.children[node as usize];
        if left == NONE {
            return (links.bounds[node as usize], 0.0);
        }
        let ((a, below_a), (b, below_b)) = (inner_area(links, left), inner_area(links, right));
        let bounds = a.union(b);
        (bounds, f64::from(links.measure.of(bounds.sides())) + below_a + below_b)
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
            let tree = scattered(&mut random, 12);
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
                // Sums of some twenty areas below 3, with an inside below 12 each, rounded.
                assert!((f64::from(gain) - best).abs() < 1e-4, "{gain} for {best}");
                assert!(place.is_none_or(|at| (gain_at(at) - best).abs() < 1e-4));
                moved += u32::from(place.is_some());
                looked += 1;
            }
        }
        assert!(moved > 20 && moved < looked, "{moved} of {looked}");
    }

    #[test]
    fn moving_subtrees_makes_the_boxes_smaller() {
        let mut random = Random::new(32);
        for count in [1, 2, 3, 9, 100, 3000] {
            let tree = scattered(&mut random, count);
            let mut links = Links::new(&tree);
            let before = inner_area(&links, 0).1;
            links.reinsert_largest();
            let after = inner_area(&links, 0).1;
            assert!(after <= before);
            assert!(count < 3000 || after < 0.99 * before, "{after} of {before}");
        }
    }
}
