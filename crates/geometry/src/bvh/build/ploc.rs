//! The fast builder: parallel locally ordered clustering (PLOC) by the crate `obvhs`.
//!
//! Each pass of PLOC joins the pairs of boxes that are each other's best partner. Where many boxes are equal, or lie around each
//! other, a pass finds one pair: its time is then quadratic, and its tree a chain. So primitives are first divided along a Morton
//! curve into runs of bounded size, and `obvhs` clusters each run, then the boxes of the runs. A tree that is still too
//! deep is built by splitting instead.

use super::{BinaryTree, Costs, Item, MAX_DEPTH, Node, Span, build};
use crate::frame::Box32;
use etalon_simd::Level;
use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;
use std::iter::once;
use std::ops::Range;

/// Boxes of a run, at most: PLOC takes at most this many passes over them.
const RUN_LIMIT: usize = 1024;
/// Bits of a Morton code for each axis.
const AXIS_BITS: u32 = 20;
/// No child.
const NONE: u32 = u32::MAX;

/// A subtree that has no parent yet.
#[derive(Clone, Copy)]
struct Root {
    bounds: Span,
    /// Its index in [`Forest`].
    cluster: u32,
}

/// Nodes by index: first one leaf for each primitive, then inner nodes, children before parents.
struct Forest {
    bounds: Vec<Span>,
    children: Vec<[u32; 2]>,
}

/// Builds a tree over at least one primitive. The result depends on neither the number of threads nor the instruction set.
pub(crate) fn build_fast(items: Vec<Item>, costs: Costs, level: Level) -> BinaryTree {
    assert!(!items.is_empty(), "a tree has at least one primitive");
    match clustered(&items) {
        Some(tree) => tree,
        None => build(items, costs, level),
    }
}

/// The tree that clustering makes. None if it is too deep for rays.
fn clustered(items: &[Item]) -> Option<BinaryTree> {
    let mut forest = Forest {
        bounds: items.iter().map(|item| Span::of(&item.span().to_box())).collect(),
        children: vec![[NONE; 2]; items.len()],
    };
    let mut roots: Vec<Root> =
        (0..items.len() as u32).map(|cluster| Root { bounds: forest.bounds[cluster as usize], cluster }).collect();
    while roots.len() > 1 {
        let runs = sorted_runs(&mut roots);
        let joined: Vec<Vec<[u32; 2]>> = runs.par_iter().map(|run| joined(&roots[run.clone()])).collect();
        roots = runs.iter().zip(joined).map(|(run, joined)| forest.add(&roots[run.clone()], &joined)).collect();
    }
    forest.tree(items, roots[0].cluster)
}

/// Sorts boxes along a Morton curve and divides them into runs of at most [`RUN_LIMIT`], between cells of the curve; equal codes by count.
fn sorted_runs(roots: &mut Vec<Root>) -> Vec<Range<usize>> {
    if roots.len() <= RUN_LIMIT {
        return once(0..roots.len()).collect();
    }
    let centres = roots.iter().fold([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]], |[lower, upper], root| {
        let c = root.bounds.centre2();
        [std::array::from_fn(|k| lower[k].min(c[k])), std::array::from_fn(|k| upper[k].max(c[k]))]
    });
    let code = |root: &Root| {
        let centre = root.bounds.centre2();
        let axis = |k: usize| {
            let extent = f64::from(centres[1][k]) - f64::from(centres[0][k]);
            let part = (f64::from(centre[k]) - f64::from(centres[0][k])) / extent;
            // A part without extent is NaN and becomes 0.
            spread(((part * f64::from(1 << AXIS_BITS)) as u64).min((1 << AXIS_BITS) - 1))
        };
        axis(0) | axis(1) << 1 | axis(2) << 2
    };
    // Places differ: the order is total.
    let mut coded: Vec<(u64, u32)> =
        roots.par_iter().enumerate().map(|(place, root)| (code(root), place as u32)).collect();
    coded.par_sort_unstable();
    *roots = coded.par_iter().map(|&(_, place)| roots[place as usize]).collect();
    let (mut runs, mut rest) = (Vec::new(), Vec::from_iter(once(0..coded.len())));
    while let Some(run) = rest.pop() {
        if run.len() <= RUN_LIMIT {
            runs.push(run);
            continue;
        }
        let (first, last) = (coded[run.start].0, coded[run.end - 1].0);
        let middle = match (first ^ last).checked_ilog2() {
            None => run.start + run.len() / 2,
            Some(bit) => run.start + coded[run.clone()].partition_point(|(code, _)| code >> bit & 1 == 0),
        };
        rest.extend([middle..run.end, run.start..middle]);
    }
    runs
}

/// The bits of a number, two zeros between them.
fn spread(n: u64) -> u64 {
    let n = (n | n << 32) & 0x001f_0000_0000_ffff;
    let n = (n | n << 16) & 0x001f_0000_ff00_00ff;
    let n = (n | n << 8) & 0x100f_00f0_0f00_f00f;
    let n = (n | n << 4) & 0x10c3_0c30_c30c_30c3;
    (n | n << 2) & 0x1249_2492_4924_9249
}

/// The inner nodes over a run, children before parents: each child a place in the run, or the run's length plus the place of an inner node.
fn joined(run: &[Root]) -> Vec<[u32; 2]> {
    let boxes: Vec<Aabb> = run
        .iter()
        .map(|root| {
            let Box32 { min, max } = root.bounds.to_box();
            Aabb::new(Vec3A::from_array(min), Vec3A::from_array(max))
        })
        .collect();
    let places = (0..run.len() as u32).collect();
    let tree = PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, places, SortPrecision::U64, 0);
    // Parents come before children there, and a parent's children are neighbours.
    let mut place = vec![NONE; tree.nodes.len()];
    let mut joined = Vec::with_capacity(run.len() - 1);
    for (index, node) in tree.nodes.iter().enumerate().rev() {
        let first = node.first_index as usize;
        place[index] = if node.prim_count > 0 {
            tree.primitive_indices[first]
        } else {
            joined.push([place[first], place[first + 1]]);
            (run.len() + joined.len() - 1) as u32
        };
    }
    joined
}

impl Forest {
    /// Adds the inner nodes over a run; its root.
    fn add(&mut self, run: &[Root], joined: &[[u32; 2]]) -> Root {
        let base = self.children.len();
        let of = |place: u32| match run.get(place as usize) {
            Some(root) => root.cluster,
            None => (base + place as usize - run.len()) as u32,
        };
        for pair in joined {
            let children = pair.map(of);
            let [left, right] = children.map(|child| self.bounds[child as usize]);
            self.bounds.push(left.union(right));
            self.children.push(children);
        }
        match joined.len() {
            0 => run[0],
            _ => Root { bounds: self.bounds[self.bounds.len() - 1], cluster: self.bounds.len() as u32 - 1 },
        }
    }

    /// The tree below a root, each leaf one primitive. None if it is too deep for rays.
    fn tree(&self, items: &[Item], root: u32) -> Option<BinaryTree> {
        let (mut nodes, mut order) = (Vec::with_capacity(self.children.len()), Vec::with_capacity(items.len()));
        // What is still to come: a cluster, its depth, and whose right child it is.
        let mut rest = vec![(root, 1, NONE)];
        while let Some((cluster, depth, left_of)) = rest.pop() {
            if depth > MAX_DEPTH {
                return None;
            }
            let at = nodes.len() as u32;
            if left_of != NONE {
                let parent: &mut Node = &mut nodes[left_of as usize];
                parent.first = at;
            }
            let bounds = self.bounds[cluster as usize].to_box();
            let [left, right] = self.children[cluster as usize];
            if left == NONE {
                nodes.push(Node { bounds, first: order.len() as u32, count: 1 });
                order.push(items[cluster as usize].id());
            } else {
                nodes.push(Node { bounds, first: NONE, count: 0 });
                rest.extend([(right, depth + 1, at), (left, depth + 1, NONE)]);
            }
        }
        Some(BinaryTree { nodes, order })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level;
    use crate::test_support::Random;

    const COSTS: Costs = Costs { block: 8, node: 0.35 };

    fn items(boxes: &[Box32]) -> Vec<Item> {
        boxes.iter().enumerate().map(|(id, b)| Item::new(b, id as u32, false)).collect()
    }

    fn scattered(count: usize) -> Vec<Box32> {
        let mut random = Random::new(51);
        let mut one = || {
            let min: [f32; 3] = std::array::from_fn(|_| random.unit() as f32);
            Box32 { min, max: min.map(|c| c + 0.05 * random.unit() as f32) }
        };
        (0..count).map(|_| one()).collect()
    }

    /// Every primitive is in one leaf, every box the union of its children's, and no path longer than rays have room for.
    fn check(tree: &BinaryTree, boxes: &[Box32]) {
        let mut order = tree.order.clone();
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..boxes.len() as u32));
        let mut rest = vec![(0_u32, 1)];
        let mut seen = 0;
        while let Some((index, depth)) = rest.pop() {
            assert!(depth <= MAX_DEPTH);
            seen += 1;
            let Node { bounds, first, count } = tree.nodes[index as usize];
            let below: Vec<Box32> = match count {
                0 => {
                    rest.extend([(index + 1, depth + 1), (first, depth + 1)]);
                    [index + 1, first].map(|child| tree.nodes[child as usize].bounds).to_vec()
                }
                _ => tree.order[first as usize..][..count as usize].iter().map(|&id| boxes[id as usize]).collect(),
            };
            let union = below.iter().map(Span::of).reduce(Span::union).expect("a box").to_box();
            assert_eq!(union, bounds);
        }
        assert_eq!(seen, tree.nodes.len());
    }

    #[test]
    fn a_tree_holds_each_primitive_once_in_tight_boxes() {
        for count in [1, 2, 3, 100, RUN_LIMIT, RUN_LIMIT + 1, 5000, 40_000] {
            let boxes = scattered(count);
            check(&clustered(&items(&boxes)).expect("a flat enough tree"), &boxes);
        }
    }

    #[test]
    fn a_tree_is_the_same_for_any_number_of_threads() {
        let boxes = scattered(20_000);
        let tree = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| format!("{:?}", build_fast(items(&boxes), COSTS, level::best())))
        };
        let one = tree(1);
        assert!([2, 3, 7].into_iter().all(|threads| tree(threads) == one));
    }

    /// A run is as large as PLOC can take when each of its passes joins one pair.
    #[test]
    fn runs_are_bounded_whatever_coincides() {
        let same = Box32 { min: [0.25; 3], max: [0.5; 3] };
        let mut boxes = vec![same; 100_000];
        boxes.extend(scattered(1000));
        let mut roots: Vec<Root> =
            boxes.iter().enumerate().map(|(i, b)| Root { bounds: Span::of(b), cluster: i as u32 }).collect();
        let runs = sorted_runs(&mut roots);
        assert!(runs.iter().all(|run| !run.is_empty() && run.len() <= RUN_LIMIT));
        assert_eq!(runs.iter().map(ExactSizeIterator::len).sum::<usize>(), boxes.len());
        assert!(runs.windows(2).all(|pair| pair[0].end == pair[1].start));
    }

    #[test]
    fn equal_boxes_shells_and_neighbours_an_ulp_apart_make_no_deep_trees() {
        let count = 100_000;
        let same = vec![Box32 { min: [0.25; 3], max: [0.5; 3] }; count];
        let shells: Vec<Box32> =
            (1..=count).map(|i| i as f32 / count as f32).map(|r| Box32 { min: [-r; 3], max: [r; 3] }).collect();
        let mut x = 0.5_f32;
        let line: Vec<Box32> = (0..count)
            .map(|_| {
                x = x.next_up();
                Box32 { min: [x, 0.0, 0.0], max: [x.next_up(), 0.0, 0.0] }
            })
            .collect();
        let halves: Vec<Box32> =
            (0..120).map(|i| 0.5_f32.powi(i)).map(|r| Box32 { min: [r; 3], max: [2.0 * r; 3] }).collect();
        for boxes in [same, shells, line, halves] {
            check(&build_fast(items(&boxes), COSTS, level::best()), &boxes);
        }
    }
}
