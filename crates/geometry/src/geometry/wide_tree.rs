//! The wide tree of a geometry: nodes, leaves of shapes, and a node for each instance.

use super::{InstanceNode, Primitive, PrimitiveStatistics};
use crate::PrimitiveId;
use crate::bvh::build::{BinaryTree, Costs};
use crate::bvh::collapse::Collapse;
use crate::bvh::leaf::Leaf;
use crate::bvh::node::{Children, INSTANCE_LEAF, LEAF, Leaves, NODE_LINES, NODE_WIDTH, Node16, Nodes, TreeKind};
use crate::frame::{Box32, Frame};
use crate::pages::Pages;
use rayon::prelude::*;

/// Trees up to this size, bytes, are mostly in caches from which prefetching gains nothing.
const NEAR_CACHE: usize = 16 << 20;

/// [`Leaves`] in large pages.
#[derive(Debug)]
enum LeafPages {
    Eight(Pages<Leaf<8>>),
    Sixteen(Pages<Leaf<16>>),
}

/// The tree.
#[derive(Debug)]
pub(crate) struct WideTree {
    pub(crate) frame: Frame,
    nodes: Pages<Node16>,
    leaves: LeafPages,
    /// Of the instances that have a leaf of their own, in the order of the tree.
    instance_nodes: Vec<InstanceNode>,
    /// Levels of nodes.
    pub(crate) depth: usize,
    /// Whether there are spheres.
    pub(crate) spheres: bool,
    /// Whether the tree is larger than near caches, so that what waits on the stack is announced.
    pub(crate) prefetch: bool,
    pub(crate) kind: TreeKind,
}

impl WideTree {
    /// Collapses a binary tree, to leaves of `lanes` primitives, eight or sixteen.
    pub(crate) fn collapse(
        frame: Frame,
        tree: &BinaryTree,
        primitives: &[Primitive],
        statistics: &PrimitiveStatistics,
        costs: Costs,
        lanes: usize,
    ) -> Self {
        let mut size = Size::default();
        let is_instance = |id: u32| primitives[id as usize].is_instance();
        let choices = Collapse::new(tree, &is_instance, costs, lanes);
        size.count(&choices, 0, 1);
        let mut wide = Self {
            frame,
            nodes: Pages::new(size.nodes),
            leaves: match lanes {
                16 => LeafPages::Sixteen(Pages::new(size.leaves)),
                _ => LeafPages::Eight(Pages::new(size.leaves)),
            },
            instance_nodes: Vec::new(),
            depth: size.depth,
            spheres: statistics.spheres > 0,
            kind: match statistics {
                c if c.triangles == c.count => TreeKind::Triangles,
                c if c.spheres == c.count => TreeKind::Spheres,
                _ => TreeKind::Any,
            },
            prefetch: false,
        };
        wide.prefetch = wide.memory_bytes() > NEAR_CACHE;
        let mut filler = Filler {
            choices: &choices,
            tree,
            primitives,
            lanes,
            nodes: wide.nodes.as_mut_slice(),
            node_count: 0,
            leaves: Vec::with_capacity(size.leaves),
            instance_nodes: Vec::new(),
        };
        filler.node(0);
        let roots = filler.leaves;
        wide.instance_nodes = filler.instance_nodes;
        match &mut wide.leaves {
            LeafPages::Eight(leaves) => fill(leaves.as_mut_slice(), &frame, tree, &roots, primitives),
            LeafPages::Sixteen(leaves) => fill(leaves.as_mut_slice(), &frame, tree, &roots, primitives),
        }
        wide
    }

    /// The nodes, the root first.
    #[inline(always)]
    pub(crate) fn nodes(&self) -> Nodes<'_> {
        Nodes::of(self.nodes.as_slice())
    }

    /// The leaves.
    #[inline(always)]
    pub(crate) fn leaves(&self) -> Leaves<'_> {
        match &self.leaves {
            LeafPages::Eight(leaves) => Leaves::Eight(leaves.as_slice()),
            LeafPages::Sixteen(leaves) => Leaves::Sixteen(leaves.as_slice()),
        }
    }

    /// Lanes of a leaf.
    pub(crate) fn lanes(&self) -> usize {
        match self.leaves {
            LeafPages::Eight(_) => 8,
            LeafPages::Sixteen(_) => 16,
        }
    }

    /// The instance nodes.
    #[inline(always)]
    pub(crate) fn instance_nodes(&self) -> &[InstanceNode] {
        &self.instance_nodes
    }

    /// Memory held beside the struct itself, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        let leaves = match self.leaves() {
            Leaves::Eight(leaves) => size_of_val(leaves),
            Leaves::Sixteen(leaves) => size_of_val(leaves),
        };
        size_of_val(self.nodes.as_slice()) + leaves + size_of_val(self.instance_nodes())
    }
}

/// Makes leaves of subtrees.
fn fill<const W: usize>(
    leaves: &mut [Leaf<W>],
    frame: &Frame,
    tree: &BinaryTree,
    roots: &[u32],
    primitives: &[Primitive],
) {
    leaves.par_iter_mut().zip(roots).with_min_len(256).for_each(|(leaf, &root)| {
        *leaf = Leaf::new(frame, tree, root, |id| primitives[id as usize].filter_shape());
    });
}

/// What a tree will need.
#[derive(Default)]
struct Size {
    nodes: usize,
    leaves: usize,
    depth: usize,
}

impl Size {
    fn count(&mut self, choices: &Collapse<'_>, root: u32, depth: usize) {
        self.nodes += 1;
        self.depth = self.depth.max(depth);
        let (children, count) = choices.children(root);
        for &child in &children[..count] {
            if choices.is_leaf(child) {
                self.leaves += usize::from(choices.instance_leaf(child).is_none());
            } else {
                self.count(choices, child, depth + 1);
            }
        }
    }
}

/// Fills the nodes of a tree.
struct Filler<'a> {
    choices: &'a Collapse<'a>,
    tree: &'a BinaryTree,
    primitives: &'a [Primitive],
    lanes: usize,
    nodes: &'a mut [Node16],
    node_count: usize,
    /// The binary nodes whose primitives become leaves, in turn.
    leaves: Vec<u32>,
    instance_nodes: Vec<InstanceNode>,
}

impl Filler<'_> {
    /// Adds the node that stands for a binary node, and all below it.
    fn node(&mut self, root: u32) -> u32 {
        let index = self.node_count;
        self.node_count += 1;
        let (children, count) = self.choices.children(root);
        let mut node = Node16 {
            planes: [[[f32::INFINITY; NODE_WIDTH], [f32::NEG_INFINITY; NODE_WIDTH]]; 3],
            children: Children([0; NODE_WIDTH]),
        };
        for (lane, &child) in children[..count].iter().enumerate() {
            let Box32 { min, max } = self.tree.nodes[child as usize].bounds;
            for k in 0..3 {
                node.planes[k][0][lane] = min[k];
                node.planes[k][1][lane] = max[k];
            }
            node.children.0[lane] = if self.choices.is_leaf(child) {
                if let Some(id) = self.choices.instance_leaf(child)
                    && let Primitive::Instance(instance) = &self.primitives[id as usize]
                {
                    node.children.0[lane] = self.instance_nodes.len() as u32 | LEAF | INSTANCE_LEAF;
                    self.instance_nodes.push(InstanceNode::new(instance, PrimitiveId(id), self.lanes));
                    continue;
                }
                self.leaves.push(child);
                (self.leaves.len() - 1) as u32 | LEAF
            } else {
                self.node(child)
            };
        }
        self.nodes[index] = node;
        // Far fewer than there are primitives, of which 2²⁹ at most: it fits.
        (index * NODE_LINES) as u32
    }
}
