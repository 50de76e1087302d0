//! The tree that rays traverse: sixteen children a node, leaves of up to eight or sixteen primitives, both in SoA order.

use super::leaf::Leaf;
use bytemuck::{Pod, Zeroable};
use etalon_simd::Level;

/// Children of a node. A ray waits for each node's answer before it knows where to go next: sixteen at once shorten the way.
pub(crate) const NODE_WIDTH: usize = 16;

/// Lanes of the leaves of a tree that is made for an instruction set: as many as its vectors have floats.
pub(crate) fn leaf_lanes(level: Level) -> usize {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(_) => 16,
        _ => 8,
    }
}

/// Marks a child that is a leaf.
pub(crate) const LEAF: u32 = 1 << 31;
/// Marks, together with [`LEAF`], a leaf that holds one instance alone: the rest is the index of its instance node. What a leaf tells of
/// others would say nothing of it.
pub(crate) const INSTANCE_LEAF: u32 = 1 << 30;

/// Which primitives a tree holds, as far as traversals are specialised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum TreeKind {
    /// Of several kinds.
    Any,
    /// Triangles alone.
    Triangles,
    /// Spheres alone.
    Spheres,
}

/// Kinds as const parameters of traversals.
pub(crate) const ANY_KIND: u8 = TreeKind::Any as u8;
pub(crate) const TRIANGLES: u8 = TreeKind::Triangles as u8;
pub(crate) const SPHERES: u8 = TreeKind::Spheres as u8;

/// A node: the boxes of up to sixteen children.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node16 {
    /// For x, y and z the lower and the upper planes of the children; a missing child has an inverted, infinite box.
    pub(crate) planes: [[[f32; NODE_WIDTH]; 2]; 3],
    /// The first [`Line`] of a node, or the index of a leaf with [`LEAF`].
    pub(crate) children: Children,
}

impl Node16 {
    /// Where rays enter boxes along each axis, for [`Node16::planes`], if the direction's sign bits are these, that of x lowest.
    #[inline(always)]
    pub(crate) fn entry_planes(negative: usize) -> [usize; 3] {
        let bits = negative * NODE_WIDTH;
        [bits & NODE_WIDTH, bits >> 1 & NODE_WIDTH, bits >> 2 & NODE_WIDTH]
    }

    /// Planes of the children along an axis: the lower ones from 0 on, the upper ones from [`NODE_WIDTH`] on. Told so, one instruction finds
    /// and reads them.
    #[inline(always)]
    pub(crate) fn planes(&self, axis: usize, from: usize) -> &[f32; NODE_WIDTH] {
        self.planes[axis].as_flattened()[from & NODE_WIDTH..].first_chunk().expect("as many as there are children")
    }
}

/// A cache line of a node.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Line([f32; NODE_WIDTH]);

/// Lines of a node.
pub(crate) const NODE_LINES: usize = size_of::<Node16>() / size_of::<Line>();

/// The nodes of a tree, found by their lines: where one begins is a shift away, not a multiplication, and a ray waits for it.
#[derive(Clone, Copy)]
pub(crate) struct Nodes<'a>(&'a [Line]);

impl<'a> Nodes<'a> {
    /// Of nodes in a row, the root first.
    #[inline(always)]
    pub(crate) fn of(nodes: &'a [Node16]) -> Self {
        Self(bytemuck::cast_slice(nodes))
    }

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

/// The leaves of a tree, as wide as the vectors of the instruction set that it was made for.
#[derive(Clone, Copy)]
pub(crate) enum Leaves<'a> {
    /// Of eight lanes each.
    Eight(&'a [Leaf<8>]),
    /// Of sixteen.
    Sixteen(&'a [Leaf<16>]),
}
