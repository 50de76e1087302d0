//! The tree that rays traverse: sixteen children a node, leaves of up to eight primitives, both in SoA order.

use crate::build::BinaryTree;
use crate::frame::{Box32, Frame};
use crate::pages::Pages;
use crate::query::Query;
use crate::{Primitive, PrimitiveId};
use bytemuck::{Pod, Zeroable};

/// Children of a node. A ray waits for each node's answer before it knows where to go next: sixteen at once shorten the way.
pub(crate) const NODE_WIDTH: usize = 16;
/// Primitives of a leaf.
pub(crate) const LEAF_WIDTH: usize = 8;
/// Marks a child that is a leaf.
pub(crate) const LEAF: u32 = 1 << 31;

/// A node: the boxes of up to sixteen children.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node16 {
    /// For x, y and z the lower and the upper planes of the children; a missing child has an inverted, infinite box.
    pub(crate) planes: [[[f32; NODE_WIDTH]; 2]; 3],
    /// The index of a node, or of a leaf with [`LEAF`].
    pub(crate) children: Children,
}

/// The children of a node, in one cache line.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Children(pub(crate) [u32; NODE_WIDTH]);

/// A leaf: up to eight primitives.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Leaf8 {
    /// The vertices of triangles in the accelerator's frame, rounded: x, y, z of a, then of b, then of c. The rows of the
    /// first vertex hold a sphere's centre, the first row of the second its radius. NaN in all other lanes, which no filter
    /// for triangles or spheres keeps.
    pub(crate) vertices: [[[f32; LEAF_WIDTH]; 3]; 3],
    /// Ids; `u32::MAX` for an empty lane.
    pub(crate) ids: [u32; LEAF_WIDTH],
    /// The largest extent of the primitives' common box along an axis.
    pub(crate) extent: f32,
    /// The lanes of spheres, one bit each.
    pub(crate) spheres: u8,
    /// The lanes of primitives that are neither triangles nor spheres. They have no filter: they are tested in `f64`
    /// whenever a ray enters the leaf.
    pub(crate) others: u8,
    /// The lanes of triangles whose vertices are exact: they need not be fetched to be tested in `f64`.
    pub(crate) exact: u8,
    padding: [u8; 25],
}

/// The tree.
#[derive(Debug)]
pub(crate) struct WideTree {
    pub(crate) frame: Frame,
    nodes: Pages<Node16>,
    leaves: Pages<Leaf8>,
    /// Levels of nodes.
    pub(crate) depth: usize,
}

impl WideTree {
    /// Collapses a binary tree.
    pub(crate) fn collapse(frame: Frame, tree: &BinaryTree, primitives: &[Primitive]) -> Self {
        let mut size = Size::default();
        size.count(tree, 0, 1);
        let mut wide =
            Self { frame, nodes: Pages::new(size.nodes), leaves: Pages::new(size.leaves), depth: size.depth };
        let (nodes, leaves) = (wide.nodes.as_mut_slice(), wide.leaves.as_mut_slice());
        Filler { frame: &frame, tree, primitives, nodes, leaves, node_count: 0, leaf_count: 0 }.node(0);
        wide
    }

    /// The nodes, the root first.
    #[inline(always)]
    pub(crate) fn nodes(&self) -> &[Node16] {
        self.nodes.as_slice()
    }

    /// The leaves.
    #[inline(always)]
    pub(crate) fn leaves(&self) -> &[Leaf8] {
        self.leaves.as_slice()
    }

    /// Memory held beside the struct itself, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes()) + size_of_val(self.leaves())
    }
}

/// The up to sixteen binary nodes that become the children of a node: the largest inner one is opened until there are
/// sixteen.
fn open(tree: &BinaryTree, root: u32) -> ([u32; NODE_WIDTH], usize) {
    let mut children = [root; NODE_WIDTH];
    let mut count = 1;
    while count < NODE_WIDTH {
        let mut widest = (None, -1.0);
        for (c, &child) in children[..count].iter().enumerate() {
            let node = &tree.nodes[child as usize];
            let area = node.bounds.half_area();
            if node.count == 0 && area > widest.1 {
                widest = (Some(c), area);
            }
        }
        let Some(c) = widest.0 else { break };
        let opened = children[c];
        children[c] = opened + 1;
        children[count] = tree.nodes[opened as usize].first;
        count += 1;
    }
    (children, count)
}

/// What a tree will need.
#[derive(Default)]
struct Size {
    nodes: usize,
    leaves: usize,
    depth: usize,
}

impl Size {
    fn count(&mut self, tree: &BinaryTree, root: u32, depth: usize) {
        self.nodes += 1;
        self.depth = self.depth.max(depth);
        let (children, count) = open(tree, root);
        for &child in &children[..count] {
            if tree.nodes[child as usize].count > 0 {
                self.leaves += 1;
            } else {
                self.count(tree, child, depth + 1);
            }
        }
    }
}

/// Fills a tree.
struct Filler<'a> {
    frame: &'a Frame,
    tree: &'a BinaryTree,
    primitives: &'a [Primitive],
    nodes: &'a mut [Node16],
    leaves: &'a mut [Leaf8],
    node_count: usize,
    leaf_count: usize,
}

impl Filler<'_> {
    /// Adds the node that stands for a binary node, and all below it.
    fn node(&mut self, root: u32) -> u32 {
        let index = self.node_count;
        self.node_count += 1;
        let (children, count) = open(self.tree, root);
        let mut node = Node16 {
            planes: [[[f32::INFINITY; NODE_WIDTH], [f32::NEG_INFINITY; NODE_WIDTH]]; 3],
            children: Children([0; NODE_WIDTH]),
        };
        for (lane, &child) in children[..count].iter().enumerate() {
            let child_node = &self.tree.nodes[child as usize];
            let Box32 { min, max } = child_node.bounds;
            for k in 0..3 {
                node.planes[k][0][lane] = min[k];
                node.planes[k][1][lane] = max[k];
            }
            node.children.0[lane] = if child_node.count > 0 { self.leaf(child) } else { self.node(child) };
        }
        self.nodes[index] = node;
        index as u32
    }

    fn leaf(&mut self, node: u32) -> u32 {
        let node = &self.tree.nodes[node as usize];
        let first = node.first as usize;
        let extent = |k: usize| node.bounds.max[k] - node.bounds.min[k];
        let mut leaf = Leaf8 {
            vertices: [[[f32::NAN; LEAF_WIDTH]; 3]; 3],
            ids: [u32::MAX; LEAF_WIDTH],
            extent: extent(0).max(extent(1)).max(extent(2)),
            spheres: 0,
            others: 0,
            exact: 0,
            padding: [0; 25],
        };
        for (lane, &id) in self.tree.order[first..first + node.count as usize].iter().enumerate() {
            leaf.ids[lane] = id;
            let mut put = |i: usize, vertex| {
                for (c, row) in self.frame.point(vertex).into_iter().zip(&mut leaf.vertices[i]) {
                    row[lane] = c;
                }
            };
            match &self.primitives[id as usize] {
                Primitive::Triangle(t) => {
                    t.vertices().into_iter().enumerate().for_each(|(i, vertex)| put(i, vertex));
                    let exact = t.vertices().into_iter().all(|v| self.frame.is_exact(v));
                    leaf.exact |= u8::from(exact) << lane;
                }
                Primitive::Sphere(s) => {
                    put(0, s.centre());
                    leaf.vertices[1][0][lane] = self.frame.length(s.radius());
                    leaf.spheres |= 1 << lane;
                }
                _ => leaf.others |= 1 << lane,
            }
        }
        let index = self.leaf_count;
        self.leaf_count += 1;
        self.leaves[index] = leaf;
        index as u32 | LEAF
    }
}

impl Leaf8 {
    /// The primitive in a lane.
    #[inline(always)]
    pub(crate) fn id(&self, lane: usize) -> PrimitiveId {
        PrimitiveId(self.ids[lane % LEAF_WIDTH])
    }

    /// Whether the vertices in a lane are those of its triangle.
    #[inline(always)]
    pub(crate) fn is_exact(&self, lane: usize) -> bool {
        self.exact >> lane & 1 == 1
    }

    /// The vertices in a lane if they are exact: what [`Triangle::lanes`] gives for it.
    ///
    /// [`Triangle::lanes`]: crate::Triangle::lanes
    #[inline(always)]
    pub(crate) fn lanes(&self, frame: &Frame, lane: usize, query: &Query) -> [[f64; 4]; 3] {
        let lane = lane % LEAF_WIDTH;
        let [a, b, c] = &self.vertices;
        let unscale = frame.unscale();
        query.axes.map(|k| [a[k][lane], b[k][lane], c[k][lane], c[k][lane]].map(|v| f64::from(v) * unscale))
    }
}
