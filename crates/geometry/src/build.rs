//! Building a binary tree of boxes by the surface area heuristic.
//!
//! How its trees compare with those of the `obvhs` crate stands in `docs/decisions.md`.

use crate::frame::Box32;
use crate::wide::LEAF_WIDTH;
use std::array::from_fn;

/// Above this many primitives a node is split between bins, below at any of their sorted centres.
const SWEEP_LIMIT: usize = 64;
/// Bins an axis.
const BINS: usize = 32;
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

/// What the heuristic weighs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    /// Primitives that a leaf tests at the cost of one.
    pub(crate) block: u32,
    /// Cost of visiting a node, in units of testing a block.
    pub(crate) node: f32,
}

impl Costs {
    /// Cost of testing some primitives whose box is this.
    #[inline(always)]
    fn leaf(self, bounds: Span, count: usize) -> f32 {
        let block = if bounds.is_lone() { 1 } else { self.block };
        (count as u32).div_ceil(block) as f32
    }
}

/// A box as one vector, so that a union is one maximum: its lower corner negated, a lane for a primitive's index, its upper
/// corner, 1 if it holds a primitive that shares its leaf with no other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span([f32; 8]);

impl Span {
    const EMPTY: Self = Self([f32::NEG_INFINITY; 8]);

    /// A box, with zero in the other lanes.
    pub(crate) fn of(b: &Box32) -> Self {
        let [x, y, z] = b.min;
        Self([-x, -y, -z, 0.0, b.max[0], b.max[1], b.max[2], 0.0])
    }

    #[inline(always)]
    pub(crate) fn union(self, o: Self) -> Self {
        Self(from_fn(|i| if self.0[i] > o.0[i] { self.0[i] } else { o.0[i] }))
    }

    /// Twice the centre.
    #[inline(always)]
    fn centre2(self) -> [f32; 4] {
        from_fn(|k| self.0[k + 4] - self.0[k])
    }

    /// The box of twice the centre alone.
    #[inline(always)]
    fn centre(self) -> Self {
        let c = self.centre2();
        Self(from_fn(|i| if i < 4 { -c[i] } else { c[i - 4] }))
    }

    #[inline(always)]
    fn lower(self, axis: usize) -> f32 {
        -self.0[axis]
    }

    #[inline(always)]
    fn upper(self, axis: usize) -> f32 {
        self.0[axis + 4]
    }

    /// Half the surface area; zero for the empty box.
    #[inline(always)]
    pub(crate) fn half_area(self) -> f32 {
        let [x, y, z] = from_fn(|k| self.0[k + 4] + self.0[k]);
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    /// Whether it holds a primitive that shares its leaf with no other.
    #[inline(always)]
    fn is_lone(self) -> bool {
        self.0[7] > 0.0
    }

    pub(crate) fn to_box(self) -> Box32 {
        Box32 { min: from_fn(|k| self.lower(k)), max: from_fn(|k| self.upper(k)) }
    }
}

/// A primitive: its box, and its index in the bits of the lane for it. Items are moved as the tree is built, so that what is
/// read together lies together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item(Span);

impl Item {
    /// `lone`: it shares its leaf with no other.
    pub(crate) fn new(b: &Box32, id: u32, lone: bool) -> Self {
        let [x, y, z] = b.min;
        Self(Span([-x, -y, -z, f32::from_bits(id), b.max[0], b.max[1], b.max[2], f32::from(u8::from(lone))]))
    }

    fn id(&self) -> u32 {
        self.0.0[3].to_bits()
    }

    #[inline(always)]
    fn centre2(&self, axis: usize) -> f32 {
        self.0.centre2()[axis]
    }

    /// What two primitives are ordered by along an axis: their centres, then their indices. Total.
    fn key(&self, axis: usize) -> (u32, u32) {
        let bits = self.centre2(axis).to_bits();
        (if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }, self.id())
    }
}

/// Some primitives' box, and that of their centres.
#[derive(Clone, Copy)]
struct Extent {
    bounds: Span,
    centres: Span,
}

impl Extent {
    const EMPTY: Self = Self { bounds: Span::EMPTY, centres: Span::EMPTY };

    #[inline(always)]
    fn add(&mut self, item: &Item) {
        self.bounds = self.bounds.union(item.0);
        self.centres = self.centres.union(item.0.centre());
    }

    fn of(items: &[Item]) -> Self {
        items.iter().fold(Self::EMPTY, |mut extent, item| {
            extent.add(item);
            extent
        })
    }
}

/// Builds a tree over at least one primitive. The result does not depend on the number of threads.
pub(crate) fn build(mut items: Vec<Item>, costs: Costs) -> BinaryTree {
    assert!(!items.is_empty(), "a tree has at least one primitive");
    let mut nodes = Vec::new();
    let extent = Extent::of(&items);
    Builder { costs }.subtree(&mut items, 0, 0, extent, &mut nodes);
    BinaryTree { nodes, order: items.iter().map(Item::id).collect() }
}

struct Builder {
    costs: Costs,
}

/// A split that the heuristic found.
struct Split {
    cost: f32,
    axis: usize,
    position: Position,
}

enum Position {
    /// Twice-centres below this bin go left.
    Bin(BinMap, usize),
    /// This many of the primitives, in this order, go left.
    Rank(usize, Order),
}

/// The places of up to [`SWEEP_LIMIT`] primitives, in some order.
type Order = [u8; SWEEP_LIMIT];

/// Maps twice-centres to bins.
#[derive(Clone, Copy)]
struct BinMap {
    lower: f32,
    per_unit: f32,
}

impl BinMap {
    fn new(lower: f32, upper: f32) -> Option<Self> {
        let per_unit = BINS as f32 * (1.0 - f32::EPSILON) / (upper - lower);
        (upper > lower && per_unit.is_finite()).then_some(Self { lower, per_unit })
    }

    #[inline(always)]
    fn bin(self, centre2: f32) -> usize {
        (((centre2 - self.lower) * self.per_unit) as i32 as usize).min(BINS - 1)
    }
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
            self.sweep(items, &extent)
        } else {
            self.bins(items, &extent)
        };
        if count <= LEAF_WIDTH && !extent.bounds.is_lone() {
            let area = extent.bounds.half_area();
            let leaf_cost = self.costs.leaf(extent.bounds, count) * area;
            if !split.as_ref().is_some_and(|s| s.cost + self.costs.node * area < leaf_cost) {
                return;
            }
        }
        let (left_count, [left_extent, right_extent]) = self.partition(items, split, &extent);
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

    /// Puts the left primitives before the right ones, counts them and measures both.
    fn partition(&self, items: &mut [Item], split: Option<Split>, extent: &Extent) -> (usize, [Extent; 2]) {
        let rank = match split {
            Some(Split { axis, position: Position::Bin(map, bin), .. }) => {
                let (mut left, mut right) = (Extent::EMPTY, Extent::EMPTY);
                let (mut i, mut j) = (0, items.len());
                while i < j {
                    if map.bin(items[i].centre2(axis)) < bin {
                        left.add(&items[i]);
                        i += 1;
                    } else {
                        right.add(&items[i]);
                        j -= 1;
                        items.swap(i, j);
                    }
                }
                return (i, [left, right]);
            }
            Some(Split { position: Position::Rank(rank, order), .. }) => {
                let mut sorted = [items[0]; SWEEP_LIMIT];
                let sorted = &mut sorted[..items.len()];
                for (item, &place) in sorted.iter_mut().zip(&order) {
                    *item = items[usize::from(place)];
                }
                items.copy_from_slice(sorted);
                rank
            }
            None => {
                // No plane separates the centres, or the tree is too deep: halve.
                let size = |k: usize| extent.centres.upper(k) - extent.centres.lower(k);
                let axis = (1..3).fold(0, |best, k| if size(k) > size(best) { k } else { best });
                let half = items.len() / 2;
                items.select_nth_unstable_by_key(half, |item| item.key(axis));
                half
            }
        };
        (rank, [Extent::of(&items[..rank]), Extent::of(&items[rank..])])
    }

    fn bins(&self, items: &[Item], extent: &Extent) -> Option<Split> {
        let maps: [Option<BinMap>; 3] = from_fn(|k| BinMap::new(extent.centres.lower(k), extent.centres.upper(k)));
        // An axis without a map has one bin.
        let all = maps.map(|map| map.unwrap_or(BinMap { lower: 0.0, per_unit: 0.0 }));
        let mut bins = [[(Span::EMPTY, 0_u32); BINS]; 3];
        for item in items {
            let centre2 = item.0.centre2();
            for k in 0..3 {
                let bin = &mut bins[k][all[k].bin(centre2[k])];
                bin.0 = bin.0.union(item.0);
                bin.1 += 1;
            }
        }
        let mut best: Option<Split> = None;
        for k in 0..3 {
            let Some(map) = maps[k] else { continue };
            let mut right = [(0.0_f32, 0_u32); BINS];
            let mut sum = (Span::EMPTY, 0);
            for bin in (1..BINS).rev() {
                sum = (sum.0.union(bins[k][bin].0), sum.1 + bins[k][bin].1);
                right[bin] = (sum.0.half_area() * self.costs.leaf(sum.0, sum.1 as usize), sum.1);
            }
            let mut sum = (Span::EMPTY, 0);
            for bin in 1..BINS {
                sum = (sum.0.union(bins[k][bin - 1].0), sum.1 + bins[k][bin - 1].1);
                if sum.1 == 0 || right[bin].1 == 0 {
                    continue;
                }
                let cost = sum.0.half_area() * self.costs.leaf(sum.0, sum.1 as usize) + right[bin].0;
                if best.as_ref().is_none_or(|b| cost < b.cost) {
                    best = Some(Split { cost, axis: k, position: Position::Bin(map, bin) });
                }
            }
        }
        best
    }

    fn sweep(&self, items: &[Item], extent: &Extent) -> Option<Split> {
        let mut best: Option<(f32, usize, usize)> = None;
        let mut keys = [0_u64; SWEEP_LIMIT];
        let keys = &mut keys[..items.len()];
        let mut orders = [[0; SWEEP_LIMIT]; 3];
        let mut right = [0.0_f32; SWEEP_LIMIT];
        for k in 0..3 {
            if extent.centres.lower(k) >= extent.centres.upper(k) {
                continue;
            }
            // Equal centres keep their places, which do not depend on the number of threads.
            for (place, (key, item)) in keys.iter_mut().zip(items).enumerate() {
                *key = u64::from(item.key(k).0) << 32 | place as u64;
            }
            keys.sort_unstable();
            let order = &mut orders[k][..keys.len()];
            for (place, key) in order.iter_mut().zip(&*keys) {
                *place = *key as u8;
            }
            let at = |rank: usize| items[usize::from(order[rank])].0;
            let mut sum = Span::EMPTY;
            for rank in (1..order.len()).rev() {
                sum = sum.union(at(rank));
                right[rank] = sum.half_area() * self.costs.leaf(sum, order.len() - rank);
            }
            let mut sum = Span::EMPTY;
            for rank in 1..order.len() {
                sum = sum.union(at(rank - 1));
                let cost = sum.half_area() * self.costs.leaf(sum, rank) + right[rank];
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, k, rank));
                }
            }
        }
        best.map(|(cost, axis, rank)| Split { cost, axis, position: Position::Rank(rank, orders[axis]) })
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
