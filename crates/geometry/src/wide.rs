//! The tree that rays traverse: eight children a node, leaves of up to eight primitives, both in SoA order.

use crate::build::BinaryTree;
use crate::frame::{Box32, Frame};
use crate::{Primitive, PrimitiveId};

/// Children of a node, and primitives of a leaf.
pub(crate) const WIDTH: usize = 8;
/// Marks a child that is a leaf.
pub(crate) const LEAF: u32 = 1 << 31;
/// Marks a primitive that has no filter: it is tested in `f64` whenever a ray enters its leaf.
pub(crate) const UNFILTERED: u32 = 1 << 31;

/// A node: the boxes of up to eight children.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node8 {
    /// For x, y and z the lower and the upper planes of the children; a missing child has an inverted, infinite box.
    pub(crate) planes: [[[f32; WIDTH]; 2]; 3],
    /// The index of a node, or of a leaf with [`LEAF`].
    pub(crate) children: [u32; WIDTH],
}

/// A leaf: up to eight primitives.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Leaf8 {
    /// The vertices of triangles in the accelerator's frame, rounded: x, y, z of a, then of b, then of c.
    pub(crate) vertices: [[[f32; WIDTH]; 3]; 3],
    /// Ids, with [`UNFILTERED`] where there is no triangle; `u32::MAX` for an empty lane.
    pub(crate) ids: [u32; WIDTH],
}

/// The tree.
#[derive(Debug)]
pub(crate) struct WideTree {
    pub(crate) frame: Frame,
    pub(crate) nodes: Vec<Node8>,
    pub(crate) leaves: Vec<Leaf8>,
    /// Levels of nodes.
    pub(crate) depth: usize,
}

impl WideTree {
    /// Collapses a binary tree.
    pub(crate) fn collapse(frame: Frame, tree: &BinaryTree, primitives: &[Primitive]) -> Self {
        let mut wide = Self { frame, nodes: Vec::new(), leaves: Vec::new(), depth: 0 };
        let root = wide.node(tree, primitives, 0, 1);
        debug_assert_eq!(root, 0);
        wide.nodes.shrink_to_fit();
        wide.leaves.shrink_to_fit();
        wide
    }

    /// Appends the node that stands for a binary node, and all below it; it is on level `depth`.
    fn node(&mut self, tree: &BinaryTree, primitives: &[Primitive], root: u32, depth: usize) -> u32 {
        let mut children = vec![root];
        // Open the largest inner node until there are eight children.
        while children.len() < WIDTH {
            let area = |&i: &u32| tree.nodes[i as usize].bounds.half_area();
            let inner = (0..children.len()).filter(|&c| tree.nodes[children[c] as usize].count == 0);
            let Some(widest) = inner.max_by(|&a, &b| area(&children[a]).total_cmp(&area(&children[b]))) else { break };
            let opened = children[widest];
            children[widest] = opened + 1;
            children.push(tree.nodes[opened as usize].first);
        }
        let index = self.nodes.len();
        let mut node =
            Node8 { planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], children: [0; WIDTH] };
        for (lane, &child) in children.iter().enumerate() {
            let Box32 { min, max } = tree.nodes[child as usize].bounds;
            for k in 0..3 {
                node.planes[k][0][lane] = min[k];
                node.planes[k][1][lane] = max[k];
            }
        }
        self.nodes.push(node);
        self.depth = self.depth.max(depth);
        for (lane, &child) in children.iter().enumerate() {
            let reference = if tree.nodes[child as usize].count > 0 {
                self.leaf(tree, primitives, child)
            } else {
                self.node(tree, primitives, child, depth + 1)
            };
            self.nodes[index].children[lane] = reference;
        }
        index as u32
    }

    fn leaf(&mut self, tree: &BinaryTree, primitives: &[Primitive], node: u32) -> u32 {
        let node = &tree.nodes[node as usize];
        let first = node.first as usize;
        let mut leaf = Leaf8 { vertices: [[[0.0; WIDTH]; 3]; 3], ids: [u32::MAX; WIDTH] };
        for (lane, &id) in tree.order[first..first + node.count as usize].iter().enumerate() {
            leaf.ids[lane] = id;
            if let Primitive::Triangle(t) = &primitives[id as usize] {
                for (vertex, row) in t.vertices().into_iter().zip(&mut leaf.vertices) {
                    for (c, row) in self.frame.point(vertex).into_iter().zip(row) {
                        row[lane] = c;
                    }
                }
            } else {
                leaf.ids[lane] |= UNFILTERED;
            }
        }
        self.leaves.push(leaf);
        (self.leaves.len() - 1) as u32 | LEAF
    }

    /// Memory held beside the struct itself, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node8>() + self.leaves.capacity() * size_of::<Leaf8>()
    }
}

impl Leaf8 {
    /// The primitive in a lane.
    #[inline(always)]
    pub(crate) fn id(&self, lane: usize) -> PrimitiveId {
        PrimitiveId(self.ids[lane] & !UNFILTERED)
    }
}
