//! Which nodes of a binary tree become nodes and leaves of the tree that rays traverse.

use super::node::NODE_WIDTH;
use crate::bvh::build::{BinaryTree, Costs, LEAF_LIMIT, Node};
use crate::bvh::sah_cost::SahCost;

/// Above this many binary nodes the two halves of a tree are taken in parallel.
const PARALLEL_LIMIT: usize = 16_384;
/// What the memory of a leaf is worth, as the area of a leaf that a ray is spared: this times the tree's area over the number of
/// primitives. Without it leaves are half empty: on curved surfaces fewer rays enter two small boxes, by a few in a hundred, than
/// one that holds both.
const LEAF_PRICE: f32 = 2.0;
/// More primitives than any leaf holds: those of a subtree that is no leaf, or of one that shares none.
const TOO_MANY: u32 = 1 << 30;

/// Whether the primitive of an id is an instance, which has a leaf of its own.
type IsInstance<'a> = dyn Fn(u32) -> bool + Sync + 'a;

/// Which binary nodes become the children of which node, and which of them become leaves: the choice of least cost, as a ray
/// meets a node or a leaf about as often as it is large (Ylitie, Karras & Laine, *Efficient Incoherent Ray Traversal on GPUs
/// Through Compressed Wide BVHs*, HPG 2017, §3.1).
pub(crate) struct Collapse<'a> {
    tree: &'a BinaryTree,
    is_instance: &'a IsInstance<'a>,
    /// For each inner binary node and each number i of children that it may become, 2 to 16, in four bits: how many of them
    /// its left child becomes, zero if it stays one. In the lowest four: one if it is a leaf where it stays one.
    splits: Vec<u64>,
}

/// What the choice weighs.
struct Weights<'a> {
    tree: &'a BinaryTree,
    /// None where leaves stay what they are, whatever is in them.
    is_instance: Option<&'a IsInstance<'a>>,
    costs: Costs,
    measure: SahCost,
    /// What a leaf costs beside how often rays enter it.
    price: f32,
    /// Primitives of a leaf, at most.
    lanes: u32,
}

impl Weights<'_> {
    /// Cost of a leaf of some primitives, no more than lanes.
    fn leaf(&self, node: &Node, count: u32) -> f32 {
        let tests = if self.costs.block == 1 { count as f32 } else { 1.0 };
        tests * self.measure.of(node.bounds.sides()) + self.price
    }

    /// The least cost of the nodes and leaves below a binary node if it becomes up to 1, 2, … 16 children, and its primitives, up to
    /// [`TOO_MANY`]. Itself counts if it stays one. `below` are the splits of the node and of all below it.
    fn least(&self, node: u32, below: &mut [u64]) -> ([f32; NODE_WIDTH], u32) {
        let binary @ Node { bounds, first, count } = &self.tree.nodes[node as usize];
        if *count > 0 {
            // An instance is in no leaf.
            let instance_leaf =
                self.is_instance.is_some_and(|is_instance| instance_leaf(self.tree, is_instance, node).is_some());
            return if instance_leaf {
                ([self.measure.of(bounds.sides()); NODE_WIDTH], TOO_MANY)
            } else {
                ([self.leaf(binary, *count); NODE_WIDTH], *count)
            };
        }
        let (own, below) = below.split_first_mut().expect("a node's own split");
        let parallel = below.len() > PARALLEL_LIMIT;
        let (below_left, below_right) = below.split_at_mut((first - node - 1) as usize);
        let mut left = || self.least(node + 1, below_left);
        let mut right = || self.least(*first, below_right);
        let ((left, left_count), (right, right_count)) =
            if parallel { rayon::join(left, right) } else { (left(), right()) };
        let count = if left_count + right_count <= self.lanes { left_count + right_count } else { TOO_MANY };
        let mut costs = [0.0; NODE_WIDTH];
        let mut splits = [0_u64; NODE_WIDTH];
        for i in 2..=NODE_WIDTH {
            let split = |k: usize| left[k - 1] + right[i - k - 1];
            let best = (2..i).fold(1, |best, k| if split(k) < split(best) { k } else { best });
            (costs[i - 1], splits[i - 1]) = (split(best), best as u64);
        }
        costs[0] = self.costs.node * self.measure.of(bounds.sides()) + costs[NODE_WIDTH - 1];
        if count < TOO_MANY {
            let leaf = self.leaf(binary, count);
            if leaf <= costs[0] {
                (costs[0], splits[0]) = (leaf, 1);
            }
        }
        // As the root of a node it is split, whatever its area.
        for i in 2..NODE_WIDTH {
            if costs[0] <= costs[i - 1] {
                (costs[i - 1], splits[i - 1]) = (costs[0], 0);
            }
        }
        *own = splits.iter().rev().fold(0, |bits, &k| bits << 4 | k);
        costs[NODE_WIDTH - 1] = costs[NODE_WIDTH - 1].min(costs[0]);
        (costs, count)
    }
}

/// What the nodes and leaves that a binary tree becomes cost rays, if its leaves stay what they are; relative to others of the same box.
pub(crate) fn least_cost(tree: &BinaryTree, costs: Costs) -> f32 {
    let measure = SahCost::in_scene(tree.nodes[0].bounds.sides());
    let weights = Weights { tree, is_instance: None, costs, measure, price: 0.0, lanes: 0 };
    weights.least(0, &mut vec![0; tree.nodes.len()]).0[0]
}

/// The id of the instance that a binary leaf is, if it is one.
fn instance_leaf(tree: &BinaryTree, is_instance: &IsInstance<'_>, leaf: u32) -> Option<u32> {
    let Node { first, count, .. } = tree.nodes[leaf as usize];
    if count != 1 {
        return None;
    }
    let id = tree.order[first as usize];
    is_instance(id).then_some(id)
}

impl<'a> Collapse<'a> {
    /// For leaves of `lanes` primitives at most; no leaf of the binary tree has more.
    pub(crate) fn new(tree: &'a BinaryTree, is_instance: &'a IsInstance<'a>, costs: Costs, lanes: usize) -> Self {
        // Those of the binary tree are as full as leaves of eight can be.
        let price = if lanes > LEAF_LIMIT { LEAF_PRICE } else { 0.0 };
        let price = price * tree.nodes[0].bounds.half_area() / tree.order.len() as f32;
        Self::at_price(tree, is_instance, costs, price, lanes)
    }

    fn at_price(tree: &'a BinaryTree, is_instance: &'a IsInstance<'a>, costs: Costs, price: f32, lanes: usize) -> Self {
        let mut splits = vec![0; tree.nodes.len()];
        let measure = SahCost::in_scene(tree.nodes[0].bounds.sides());
        Weights { tree, is_instance: Some(is_instance), costs, measure, price, lanes: lanes as u32 }
            .least(0, &mut splits);
        Self { tree, is_instance, splits }
    }

    /// Whether a binary node that is a child becomes a leaf.
    pub(crate) fn is_leaf(&self, child: u32) -> bool {
        self.tree.nodes[child as usize].count > 0 || self.splits[child as usize] & 15 == 1
    }

    /// The id of the instance that a leaf is, if it is one.
    pub(crate) fn instance_leaf(&self, leaf: u32) -> Option<u32> {
        instance_leaf(self.tree, self.is_instance, leaf)
    }

    /// The children of the node whose root is a binary node.
    pub(crate) fn children(&self, root: u32) -> ([u32; NODE_WIDTH], usize) {
        let mut out = ([0; NODE_WIDTH], 0);
        if self.is_leaf(root) {
            out = ([root; NODE_WIDTH], 1);
        } else {
            self.split(root, NODE_WIDTH, &mut out);
        }
        out
    }

    fn split(&self, node: u32, i: usize, out: &mut ([u32; NODE_WIDTH], usize)) {
        let left = (self.splits[node as usize] >> (4 * (i - 1)) & 15) as usize;
        if i == 1 || left == 0 || self.tree.nodes[node as usize].count > 0 {
            out.0[out.1] = node;
            out.1 += 1;
        } else {
            self.split(node + 1, left, out);
            self.split(self.tree.nodes[node as usize].first, i - left, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::optimize::scattered;
    use crate::test_support::Random;

    const LANES: usize = 16;
    const COSTS: Costs = Costs { block: LANES as u32, node: 0.35 };

    fn area(tree: &BinaryTree, node: u32) -> f64 {
        f64::from(SahCost::in_scene(tree.nodes[0].bounds.sides()).of(tree.nodes[node as usize].bounds.sides()))
    }

    /// What was chosen costs, by what it consists of; and how many of its leaves were joined of several.
    fn cost(choices: &Collapse<'_>, node: u32, price: f64) -> (f64, usize) {
        let tree = choices.tree;
        if choices.is_leaf(node) {
            let count = tree.primitives(node).count();
            assert!(count <= LANES, "{count}");
            return (area(tree, node) + price, usize::from(count > 1));
        }
        let (children, count) = choices.children(node);
        let below = children[..count].iter().map(|&child| cost(choices, child, price));
        below.fold((0.35 * area(tree, node), 0), |sum, below| (sum.0 + below.0, sum.1 + below.1))
    }

    /// The least cost of all trees, made one by one: each inner node a node, a leaf or none; of up to as many primitives as a leaf and
    /// a node hold.
    fn least(tree: &BinaryTree, price: f64) -> f64 {
        let inner: Vec<u32> = (1..tree.nodes.len() as u32).filter(|&n| tree.nodes[n as usize].count == 0).collect();
        let below = |node: u32, what: &[u32]| {
            let (mut sum, mut rest) = (0.0, vec![node]);
            while let Some(node) = rest.pop() {
                let is = inner.iter().position(|&n| n == node).map(|place| what[place]);
                if tree.nodes[node as usize].count > 0 || is == Some(2) {
                    sum += area(tree, node) + price;
                    continue;
                }
                if is != Some(0) {
                    sum += 0.35 * area(tree, node);
                }
                rest.extend([node + 1, tree.nodes[node as usize].first]);
            }
            sum
        };
        let all = 3_u32.pow(inner.len() as u32);
        let ways = (0..all).map(|way| (0..inner.len() as u32).map(|k| way / 3_u32.pow(k) % 3).collect::<Vec<u32>>());
        // Or all of it is one leaf.
        ways.map(|what| below(0, &what)).fold(area(tree, 0) + price, f64::min)
    }

    #[test]
    fn the_choice_costs_least_of_all_trees_made_one_by_one() {
        let mut random = Random::new(41);
        let (mut joined, mut kept) = (0, 0);
        for round in 0..60 {
            let tree = scattered(&mut random, 8);
            let price = [0.0, 0.01, 0.03][round % 3] * area(&tree, 0) as f32;
            let choices = Collapse::at_price(&tree, &|_| false, COSTS, price, LANES);
            let (cost, leaves) = cost(&choices, 0, f64::from(price));
            let least = least(&tree, f64::from(price));
            assert!((cost - least).abs() < 1e-5 * least, "{cost}, but {least} can be had");
            joined += leaves;
            kept += usize::from(!choices.is_leaf(0));
        }
        assert!(joined > 20 && kept > 20, "{joined}, {kept}");
    }

    #[test]
    fn a_price_fills_leaves() {
        let mut random = Random::new(42);
        let tree = scattered(&mut random, 3000);
        let leaves = |price: f32| {
            let choices = Collapse::at_price(&tree, &|_| false, COSTS, price, LANES);
            let (mut leaves, mut held, mut rest) = (0, 0, vec![0]);
            while let Some(node) = rest.pop() {
                if choices.is_leaf(node) {
                    let count = tree.primitives(node).count();
                    assert!(count <= LANES, "{count}");
                    (leaves, held) = (leaves + 1, held + count);
                } else {
                    let (children, count) = choices.children(node);
                    rest.extend(&children[..count]);
                }
            }
            assert_eq!(held, 3000);
            leaves
        };
        let root = tree.nodes[0].bounds.half_area();
        let (free, dear) = (leaves(0.0), leaves(root));
        // So dear a leaf that only their number counts.
        assert!(dear < free && dear < 3000 / 8, "{dear}, {free}");
    }
}
