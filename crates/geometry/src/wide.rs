//! The tree that rays traverse: sixteen children a node, leaves of up to eight primitives, both in SoA order.

mod leaf;

use crate::build::{BinaryTree, Node};
use crate::census::Census;
use crate::frame::{Box32, Frame};
use crate::pages::Pages;
use crate::portal::Portal;
use crate::{Aabb, Instance, Primitive, PrimitiveId};
use bytemuck::{Pod, Zeroable};
pub(crate) use leaf::{LEAF_WIDTH, Leaf8};
use rayon::prelude::*;

/// Children of a node. A ray waits for each node's answer before it knows where to go next: sixteen at once shorten the way.
pub(crate) const NODE_WIDTH: usize = 16;
/// Trees up to this size, bytes, are mostly in caches from which prefetching gains nothing.
const NEAR_CACHE: usize = 16 << 20;
/// Above this many binary nodes the two halves of a tree are taken in parallel.
const PARALLEL_LIMIT: usize = 16_384;
/// Marks a child that is a leaf.
pub(crate) const LEAF: u32 = 1 << 31;
/// Marks, together with [`LEAF`], a leaf that holds but an instance: the rest is the index of its portal. What a leaf tells of
/// others would say nothing of it.
pub(crate) const LONE: u32 = 1 << 30;

/// What primitives a tree holds, as far as rays have walks of their own: any.
pub(crate) const MIXED: u8 = 0;
/// Triangles alone.
pub(crate) const MESH: u8 = 1;
/// Spheres alone.
pub(crate) const BALLS: u8 = 2;

/// A node: the boxes of up to sixteen children.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node16 {
    /// For x, y and z the lower and the upper planes of the children; a missing child has an inverted, infinite box.
    pub(crate) planes: [[[f32; NODE_WIDTH]; 2]; 3],
    /// The first [`Line`] of a node, or the index of a leaf with [`LEAF`].
    pub(crate) children: Children,
}

/// A cache line of a node.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Line([f32; NODE_WIDTH]);

/// Lines of a node.
const NODE_LINES: usize = size_of::<Node16>() / size_of::<Line>();

/// The nodes of a tree, found by their lines: where one begins is a shift away, not a multiplication, and a ray waits for it.
#[derive(Clone, Copy)]
pub(crate) struct Nodes<'a>(&'a [Line]);

impl<'a> Nodes<'a> {
    /// The node that begins at a line.
    #[inline(always)]
    pub(crate) fn at(self, line: u32) -> &'a Node16 {
        let line = line as usize;
        let lines = self.0[line..line + NODE_LINES].first_chunk::<NODE_LINES>().expect("a node");
        bytemuck::cast_ref(lines)
    }
}

/// The children of a node, in one cache line.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Children(pub(crate) [u32; NODE_WIDTH]);

/// The tree.
#[derive(Debug)]
pub(crate) struct WideTree {
    pub(crate) frame: Frame,
    nodes: Pages<Node16>,
    leaves: Pages<Leaf8>,
    /// Of the instances that have a leaf of their own, in the order of the tree.
    portals: Vec<Portal>,
    /// Levels of nodes.
    pub(crate) depth: usize,
    /// Whether there are spheres.
    pub(crate) spheres: bool,
    /// Whether the tree is larger than near caches, so that what waits on the stack is announced.
    pub(crate) prefetch: bool,
    /// One of [`MIXED`], [`MESH`] and [`BALLS`].
    pub(crate) kind: u8,
}

impl WideTree {
    /// Collapses a binary tree.
    pub(crate) fn collapse(frame: Frame, tree: &BinaryTree, primitives: &[Primitive], census: &Census) -> Self {
        let mut size = Size::default();
        let choices = Choices::new(tree, primitives);
        size.count(&choices, 0, 1);
        let mut wide = Self {
            frame,
            nodes: Pages::new(size.nodes),
            leaves: Pages::new(size.leaves),
            portals: Vec::new(),
            depth: size.depth,
            spheres: census.spheres > 0,
            kind: match census {
                c if c.triangles == c.count => MESH,
                c if c.spheres == c.count => BALLS,
                _ => MIXED,
            },
            prefetch: size.nodes * size_of::<Node16>() + size.leaves * size_of::<Leaf8>() > NEAR_CACHE,
        };
        let mut filler = Filler {
            choices: &choices,
            tree,
            nodes: wide.nodes.as_mut_slice(),
            node_count: 0,
            leaves: Vec::with_capacity(size.leaves),
            portals: Vec::new(),
        };
        filler.node(0);
        let roots = filler.leaves;
        wide.portals = filler.portals;
        wide.leaves.as_mut_slice().par_iter_mut().zip(roots).with_min_len(256).for_each(|(leaf, root)| {
            *leaf = Leaf8::new(&frame, tree, root, primitives);
        });
        wide
    }

    /// The nodes, the root first.
    #[inline(always)]
    pub(crate) fn nodes(&self) -> Nodes<'_> {
        Nodes(bytemuck::cast_slice(self.nodes.as_slice()))
    }

    /// The leaves.
    #[inline(always)]
    pub(crate) fn leaves(&self) -> &[Leaf8] {
        self.leaves.as_slice()
    }

    /// The portals.
    #[inline(always)]
    pub(crate) fn portals(&self) -> &[Portal] {
        &self.portals
    }

    /// Up to `limit` boxes that hold all primitives, as small as the upper nodes of the tree are.
    pub(crate) fn outline(&self, limit: usize) -> Vec<Aabb> {
        let children = |node: u32| {
            let Node16 { planes, children } = self.nodes().at(node);
            let of = move |lane: usize| {
                let corner = |side: usize| [0, 1, 2].map(|k| planes[k][side][lane]);
                (Box32 { min: corner(0), max: corner(1) }, children.0[lane])
            };
            (0..NODE_WIDTH).map(of).filter(|(bounds, _)| bounds.min[0] <= bounds.max[0])
        };
        let mut boxes: Vec<(Box32, u32)> = children(0).collect();
        while boxes.len() + NODE_WIDTH <= limit {
            let inner = boxes.iter().enumerate().filter(|(_, (_, child))| child & LEAF == 0);
            let largest = inner.max_by(|(_, (a, _)), (_, (b, _))| a.half_area().total_cmp(&b.half_area()));
            let Some((place, &(_, node))) = largest else { break };
            boxes.swap_remove(place);
            boxes.extend(children(node));
        }
        boxes.into_iter().map(|(bounds, _)| self.frame.unscaled_box(bounds)).collect()
    }

    /// Memory held beside the struct itself, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.leaves()) + size_of_val(self.portals())
    }
}

/// Which binary nodes become the children of which node: the choice of least surface area of all nodes, as a ray meets a
/// node about as often as it is large (Ylitie, Karras & Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed
/// Wide BVHs*, HPG 2017, §3.1).
struct Choices<'a> {
    tree: &'a BinaryTree,
    primitives: &'a [Primitive],
    /// For each inner binary node and each number i of children that it may become, 2 to 16, in four bits: how many of them
    /// its left child becomes, zero if it stays one.
    splits: Vec<u64>,
}

impl<'a> Choices<'a> {
    fn new(tree: &'a BinaryTree, primitives: &'a [Primitive]) -> Self {
        let mut splits = vec![0; tree.nodes.len()];
        Self::costs(tree, 0, &mut splits);
        Self { tree, primitives, splits }
    }

    /// The instance that a leaf is, if it is one, and its id.
    fn lone(&self, leaf: u32) -> Option<(&'a Instance, u32)> {
        let Node { first, count, .. } = self.tree.nodes[leaf as usize];
        let id = self.tree.order[first as usize];
        match &self.primitives[id as usize] {
            Primitive::Instance(instance) if count == 1 => Some((instance, id)),
            _ => None,
        }
    }

    /// The least area of the nodes below a binary node if it becomes up to 1, 2, … 16 children. Itself counts if it stays
    /// one and is no leaf. `below` are the splits of the node and of all below it.
    fn costs(tree: &BinaryTree, node: u32, below: &mut [u64]) -> [f32; NODE_WIDTH] {
        let Node { bounds, first, count } = tree.nodes[node as usize];
        if count > 0 {
            return [0.0; NODE_WIDTH];
        }
        let (own, below) = below.split_first_mut().expect("a node's own split");
        let parallel = below.len() > PARALLEL_LIMIT;
        let (below_left, below_right) = below.split_at_mut((first - node - 1) as usize);
        let mut left = || Self::costs(tree, node + 1, below_left);
        let mut right = || Self::costs(tree, first, below_right);
        let (left, right) = if parallel { rayon::join(left, right) } else { (left(), right()) };
        let mut costs = [0.0; NODE_WIDTH];
        let mut splits = [0_u64; NODE_WIDTH];
        for i in 2..=NODE_WIDTH {
            let split = |k: usize| left[k - 1] + right[i - k - 1];
            let best = (2..i).fold(1, |best, k| if split(k) < split(best) { k } else { best });
            (costs[i - 1], splits[i - 1]) = (split(best), best as u64);
        }
        costs[0] = bounds.half_area() + costs[NODE_WIDTH - 1];
        // As the root of a node it is split, whatever its area.
        for i in 2..NODE_WIDTH {
            if costs[0] <= costs[i - 1] {
                (costs[i - 1], splits[i - 1]) = (costs[0], 0);
            }
        }
        *own = splits.iter().rev().fold(0, |bits, &k| bits << 4 | k);
        costs[NODE_WIDTH - 1] = costs[NODE_WIDTH - 1].min(costs[0]);
        costs
    }

    /// The children of the node whose root is a binary node.
    fn children(&self, root: u32) -> ([u32; NODE_WIDTH], usize) {
        let mut out = ([0; NODE_WIDTH], 0);
        if self.tree.nodes[root as usize].count > 0 {
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

/// What a tree will need.
#[derive(Default)]
struct Size {
    nodes: usize,
    leaves: usize,
    depth: usize,
}

impl Size {
    fn count(&mut self, choices: &Choices<'_>, root: u32, depth: usize) {
        self.nodes += 1;
        self.depth = self.depth.max(depth);
        let (children, count) = choices.children(root);
        for &child in &children[..count] {
            if choices.tree.nodes[child as usize].count > 0 {
                self.leaves += usize::from(choices.lone(child).is_none());
            } else {
                self.count(choices, child, depth + 1);
            }
        }
    }
}

/// Fills the nodes of a tree.
struct Filler<'a> {
    choices: &'a Choices<'a>,
    tree: &'a BinaryTree,
    nodes: &'a mut [Node16],
    node_count: usize,
    /// The binary nodes that become leaves, in turn.
    leaves: Vec<u32>,
    portals: Vec<Portal>,
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
            let child_node = &self.tree.nodes[child as usize];
            let Box32 { min, max } = child_node.bounds;
            for k in 0..3 {
                node.planes[k][0][lane] = min[k];
                node.planes[k][1][lane] = max[k];
            }
            node.children.0[lane] = if child_node.count > 0 {
                if let Some((instance, id)) = self.choices.lone(child) {
                    node.children.0[lane] = self.portals.len() as u32 | LEAF | LONE;
                    self.portals.push(Portal::new(instance, PrimitiveId(id)));
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
