//! Grouping subtrees from below.
//!
//! Of all boxes those two are joined first whose union rays enter least often, and so on until one is left (Walter, Bala, Kulkarni &
//! Pingali, *Fast Agglomerative Agglomeration for Rendering*, IEEE Symposium on Interactive Ray Tracing 2008). The nearest of the nearest and
//! so on are two at the end of each which is the other's nearest. To join these at once makes the same tree, since no union is nearer to
//! others than what it consists of, and asks for a number of distances that grows with the square of that of boxes (Murtagh, *A Survey of
//! Recent Advances in Hierarchical Agglomeration Algorithms*, The Computer Journal 26(4), 1983).

use super::links::{Links, NONE};
use crate::bvh::build::Span;
use crate::bvh::sah_cost::SahCost;
use crate::level::{Loop, vectorised};
use etalon_simd::Level;
use std::array::from_fn;

/// Boxes that are compared at once.
const LANES: usize = 8;
/// A corner that makes a box farther from all others than they can be from each other, though finite.
const FAR: f32 = 1e12;

impl Links {
    /// Groups the leaves anew.
    pub(super) fn group(&mut self, level: Level) {
        let (leaves, mut inner): (Vec<u32>, Vec<u32>) =
            (0..self.children.len() as u32).partition(|&node| self.is_leaf(node));
        let boxes: Vec<Span> = leaves.iter().map(|&leaf| self.bounds[leaf as usize]).collect();
        let pairs = vectorised(level, Agglomeration { boxes: &boxes, measure: self.measure });
        // As many as there are inner nodes. The last one is the root, which is the first.
        inner.reverse();
        let node =
            |cluster: usize| cluster.checked_sub(boxes.len()).map_or_else(|| leaves[cluster], |pair| inner[pair]);
        for (&parent, pair) in inner.iter().zip(pairs) {
            let children = pair.map(node);
            self.children[parent as usize] = children;
            children.iter().for_each(|&child| self.parents[child as usize] = parent);
            self.refit(parent);
        }
        self.parents[0] = NONE;
    }
}

/// Joins boxes two by two. What comes of it are the pairs that were joined: boxes by their indices, what became of the first pair as the
/// next number, and so on; one pair fewer than boxes.
struct Agglomeration<'a> {
    boxes: &'a [Span],
    measure: SahCost,
}

impl Loop for Agglomeration<'_> {
    type Output = Vec<[usize; 2]>;

    #[inline(always)]
    fn run(self) -> Vec<[usize; 2]> {
        let Self { boxes, measure } = self;
        let mut slots = Slots::new(boxes, measure);
        // What is in each slot.
        let mut names: Vec<Option<usize>> = (0..boxes.len()).map(Some).collect();
        let mut pairs = Vec::with_capacity(boxes.len());
        // Slots, each of which is the nearest of the one before it.
        let mut chain: Vec<usize> = Vec::new();
        let mut first = 0;
        while pairs.len() + 1 < boxes.len() {
            let Some(&last) = chain.last() else {
                first += names[first..].iter().position(Option::is_some).expect("a box that is left");
                chain.push(first);
                continue;
            };
            let (distance, nearest) = slots.nearest(last);
            match chain.len().checked_sub(2).map(|place| chain[place]) {
                // Of those that are as near the one before it, lest it goes round in circles.
                Some(before) if slots.distance(last, before) <= distance => {
                    chain.truncate(chain.len() - 2);
                    let pair = [before, last].map(|slot| names[slot].take().expect("what is in the chain is left"));
                    names[before] = Some(boxes.len() + pairs.len());
                    slots.join(before, last);
                    pairs.push(pair);
                }
                _ => chain.push(nearest),
            }
        }
        pairs
    }
}

/// Eight boxes: their lower corners negated, then their upper ones, so that a union is a maximum.
#[derive(Clone, Copy)]
#[repr(align(32))]
struct Block([[f32; LANES]; 6]);

/// Boxes in blocks; what is not there is far away.
struct Slots {
    blocks: Vec<Block>,
    measure: SahCost,
}

impl Slots {
    #[inline(always)]
    fn new(boxes: &[Span], measure: SahCost) -> Self {
        let blocks = vec![Block([[FAR; LANES]; 6]); boxes.len().div_ceil(LANES)];
        let mut slots = Self { blocks, measure };
        boxes.iter().enumerate().for_each(|(slot, span)| slots.set(slot, span.corners()));
        slots
    }

    #[inline(always)]
    fn get(&self, slot: usize) -> [f32; 6] {
        let block = &self.blocks[slot / LANES].0;
        from_fn(|row| block[row][slot % LANES])
    }

    #[inline(always)]
    fn set(&mut self, slot: usize, corners: [f32; 6]) {
        let block = &mut self.blocks[slot / LANES].0;
        (0..6).for_each(|row| block[row][slot % LANES] = corners[row]);
    }

    /// How often rays enter the union of two.
    #[inline(always)]
    fn distance(&self, a: usize, b: usize) -> f32 {
        let [a, b] = [self.get(a), self.get(b)];
        let union: [f32; 6] = from_fn(|row| if a[row] > b[row] { a[row] } else { b[row] });
        self.measure.of(from_fn(|k| union[k] + union[k + 3]))
    }

    /// Puts the union of two in the place of the first.
    #[inline(always)]
    fn join(&mut self, a: usize, b: usize) {
        let (first, second) = (self.get(a), self.get(b));
        self.set(a, from_fn(|row| first[row].max(second[row])));
        self.set(b, [FAR; 6]);
    }

    /// The distance of the nearest other, and where it is: of those that are as near the one with the lowest place.
    #[inline(always)]
    fn nearest(&mut self, slot: usize) -> (f32, usize) {
        let own = self.get(slot);
        self.set(slot, [FAR; 6]);
        let (mut least, mut places) = ([f32::INFINITY; LANES], [0_u32; LANES]);
        for (place, Block(rows)) in self.blocks.iter().enumerate() {
            let distances: [f32; LANES] = from_fn(|lane| {
                let side = |k: usize| {
                    let end = |row: usize| if rows[row][lane] > own[row] { rows[row][lane] } else { own[row] };
                    end(k) + end(k + 3)
                };
                self.measure.of([side(0), side(1), side(2)])
            });
            for lane in 0..LANES {
                let nearer = distances[lane] < least[lane];
                least[lane] = if nearer { distances[lane] } else { least[lane] };
                places[lane] = if nearer { place as u32 } else { places[lane] };
            }
        }
        self.set(slot, own);
        let slot_of = |lane: usize| places[lane] as usize * LANES + lane;
        let lane = (0..LANES).min_by(|&a, &b| least[a].total_cmp(&least[b]).then(slot_of(a).cmp(&slot_of(b))));
        let lane = lane.expect("eight lanes");
        (least[lane], slot_of(lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::BinaryTree;
    use crate::bvh::optimize::scattered;
    use crate::level;
    use crate::test_support::Random;

    fn leaves(tree: &BinaryTree) -> Vec<Span> {
        tree.nodes.iter().filter(|node| node.count > 0).map(|node| Span::of(&node.bounds)).collect()
    }

    /// What each pair that was joined consists of, in order.
    fn members(pairs: &[[usize; 2]], count: usize) -> Vec<Vec<usize>> {
        let mut of: Vec<Vec<usize>> = (0..count).map(|index| vec![index]).collect();
        for pair in pairs {
            let mut joined = pair.map(|cluster| of[cluster].clone()).concat();
            joined.sort_unstable();
            of.push(joined);
        }
        let mut joined = of.split_off(count);
        joined.sort();
        joined
    }

    /// The nearest two of all, again and again.
    fn nearest_first(boxes: &[Span], measure: SahCost) -> Vec<[usize; 2]> {
        let mut left: Vec<(usize, Span)> = boxes.iter().copied().enumerate().collect();
        let mut pairs = Vec::new();
        while left.len() > 1 {
            let distance = |&[a, b]: &[usize; 2]| measure.of(left[a].1.union(left[b].1).sides());
            let all = (0..left.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
            let [a, b] = all.min_by(|p, q| distance(p).total_cmp(&distance(q))).expect("two are left");
            let (second, first) = (left.remove(b), left.remove(a));
            left.push((boxes.len() + pairs.len(), first.1.union(second.1)));
            pairs.push([first.0, second.0]);
        }
        pairs
    }

    #[test]
    fn the_nearest_two_of_all_are_joined_first_in_every_instruction_set() {
        let mut random = Random::new(33);
        for count in [1, 2, 3, 8, 9, 40, 100] {
            let boxes = leaves(&scattered(&mut random, count));
            let measure = SahCost::in_scene([1.0, 1.0, 1.0]);
            let expected = members(&nearest_first(&boxes, measure), count);
            for level in level::all() {
                let pairs = vectorised(level, Agglomeration { boxes: &boxes, measure });
                assert_eq!(pairs.len(), count - 1);
                assert_eq!(members(&pairs, count), expected);
            }
        }
    }

    #[test]
    fn boxes_that_are_all_alike_are_joined_too() {
        for count in [2, 7, 8, 300] {
            let boxes = vec![leaves(&scattered(&mut Random::new(34), 1))[0]; count];
            let pairs =
                vectorised(Level::Baseline, Agglomeration { boxes: &boxes, measure: SahCost::in_scene([1.0; 3]) });
            let all = members(&pairs, count);
            assert_eq!(all.len(), count - 1);
            assert!(all.contains(&(0..count).collect()));
        }
    }
}
