//! A finished binary tree made better: rays visit fewer of its nodes.
//!
//! A builder that splits from above sees large boxes alone, and what it cuts first stays apart: a room becomes eight corners, each with
//! pieces of three walls and the air between them, which most rays enter only to find nothing there. So the largest subtrees are
//! grouped from below, too (`agglomerate`), where the pieces of a wall find each other, and it stays so if that is better for rays (`treelet`);
//! among spheres in the air it is not. Then those that have a better place are moved there, one by one (`reinsert`). What it gains
//! stands in `docs/log/2026-11-ray-traversal.md`.

mod agglomerate;
mod links;
mod reinsert;
mod treelet;

use crate::bvh::build::{BinaryTree, Costs};
use etalon_simd::Level;
use links::Links;
use treelet::Treelet;

/// The same leaves in a better tree. The result does not depend on the instruction set.
pub(crate) fn improved(tree: BinaryTree, costs: Costs, level: Level) -> BinaryTree {
    let moved = |mut links: Links| {
        links.reinsert_largest();
        links.nodes(|node| tree.nodes[node as usize])
    };
    let mut links = Links::new(&tree);
    let better = match Treelet::new(&links).grouped(costs, level) {
        Some(treelet) => {
            treelet.put_on(&mut links);
            // What is grouped from below may be too deep for rays.
            moved(links).or_else(|| moved(Links::new(&tree)))
        }
        None => moved(links),
    };
    match better {
        Some(nodes) => BinaryTree { nodes, ..tree },
        None => tree,
    }
}

#[cfg(test)]
pub(crate) use tests::scattered;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::{Item, Span, build};
    use crate::bvh::collapse::least_cost;
    use crate::frame::Box32;
    use crate::level;
    use crate::test_support::Random;
    use std::array::from_fn;

    const COSTS: Costs = Costs { block: 1, node: 0.35 };

    fn split(boxes: &[Box32]) -> BinaryTree {
        let items = boxes.iter().enumerate().map(|(id, b)| Item::new(b, id as u32, false)).collect();
        build(items, Costs { block: 1, node: 0.0 }, level::best())
    }

    /// The tree of boxes of a thousandth to one, anywhere in a cube, each a leaf.
    pub(crate) fn scattered(random: &mut Random, count: usize) -> BinaryTree {
        let boxes = (0..count).map(|_| {
            let min = from_fn(|_| random.unit() as f32);
            let size = 10_f64.powf(-3.0 * random.unit()) as f32;
            Box32 { min, max: from_fn(|k: usize| min[k] + size * random.unit() as f32) }
        });
        split(&boxes.collect::<Vec<_>>())
    }

    /// The tree of the tiles of a cubic room, this many along each edge of each wall.
    fn room(tiles: u32) -> BinaryTree {
        let at = |i: u32| i as f32 / tiles as f32 - 0.5;
        let mut boxes = Vec::new();
        for k in 0..3 {
            for wall in [-0.5, 0.5] {
                for (i, j) in (0..tiles).flat_map(|i| (0..tiles).map(move |j| (i, j))) {
                    let (mut min, mut max) = ([wall; 3], [wall; 3]);
                    (min[(k + 1) % 3], max[(k + 1) % 3]) = (at(i), at(i + 1));
                    (min[(k + 2) % 3], max[(k + 2) % 3]) = (at(j), at(j + 1));
                    boxes.push(Box32 { min, max });
                }
            }
        }
        split(&boxes)
    }

    fn leaves(tree: &BinaryTree) -> Vec<(u32, u32)> {
        let mut leaves: Vec<_> = tree.nodes.iter().filter(|n| n.count > 0).map(|n| (n.first, n.count)).collect();
        leaves.sort_unstable();
        leaves
    }

    #[test]
    fn a_better_tree_has_the_same_leaves_tight_boxes_and_costs_less() {
        let mut random = Random::new(32);
        let trees = [1, 2, 3, 9, 100, 3000].map(|count| scattered(&mut random, count));
        for before in trees.into_iter().chain([room(1), room(4), room(30)]) {
            let (cost, leaves_before, count) = (least_cost(&before, COSTS), leaves(&before), before.order.len());
            let after = improved(before, COSTS, level::best());
            assert_eq!(leaves(&after), leaves_before);
            assert_eq!(after.order.len(), count);
            for (index, node) in after.nodes.iter().enumerate().filter(|(_, node)| node.count == 0) {
                let union = [index + 1, node.first as usize].map(|child| Span::of(&after.nodes[child].bounds));
                let (union, bounds) = (union[0].union(union[1]).to_box(), &node.bounds);
                assert!(union.min == bounds.min && union.max == bounds.max);
            }
            let after = least_cost(&after, COSTS);
            assert!(after <= 1.0001 * cost, "{after} of {cost}");
            assert!(count < 1000 || after < 0.98 * cost, "{after} of {cost}");
        }
    }

    #[test]
    fn the_walls_of_a_room_become_subtrees() {
        let flat = |b: &Box32| (0..3).any(|k| b.min[k] == b.max[k]);
        let walls = |tree: &BinaryTree| {
            let is_wall = |b: &Box32| flat(b) && (0..3).filter(|&k| b.max[k] - b.min[k] == 1.0).count() == 2;
            tree.nodes.iter().filter(|node| is_wall(&node.bounds)).count()
        };
        for tiles in [4, 8] {
            let before = room(tiles);
            assert_eq!(walls(&before), 0, "split from above they are in pieces");
            assert_eq!(walls(&improved(before, COSTS, level::best())), 6);
        }
    }

    /// From below, shells around each other become a chain, one level each: more than rays have room for.
    #[test]
    fn shells_around_each_other_do_not_become_too_deep() {
        let shells: Vec<Box32> =
            (0..400).map(|i| 0.5 * 0.97_f32.powi(i)).map(|r| Box32 { min: [-r; 3], max: [r; 3] }).collect();
        let before = split(&shells);
        let leaves_before = leaves(&before);
        assert!(Treelet::new(&Links::new(&before)).grouped(COSTS, level::best()).is_none());
        let after = improved(before, COSTS, level::best());
        assert_eq!(leaves(&after), leaves_before);
        assert!(Links::new(&after).nodes(|node| after.nodes[node as usize]).is_some());
    }

    #[test]
    fn what_is_better_is_the_same_for_every_instruction_set() {
        let trees = |level| {
            let mut random = Random::new(35);
            // Everything, bit for bit.
            [scattered(&mut random, 2000), room(12)].map(|tree| format!("{:?}", improved(tree, COSTS, level)))
        };
        let portable = trees(Level::Baseline);
        assert!(level::all().into_iter().all(|level| trees(level) == portable));
    }
}
