//! The children of a node that a ray meets.

use crate::bvh::node::{NODE_WIDTH, Node16};

/// Numbers that a vector is stored to and of which some are read back at once: within a cache line, for what is stored across two of
/// them can be read only once it is written.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Row<T, const N: usize>(pub(super) [T; N]);

/// The children of a node that a ray meets, in the node's order.
pub(super) trait NodeHits: Copy {
    /// One bit a child.
    fn mask(&self) -> u32;
    /// The first, if there is one.
    fn first(&self, node: &Node16) -> u32;
    /// The [`entry`]s of the first two, or of the third and the fourth; of those there are.
    fn pair<const SECOND: bool>(&self, node: &Node16) -> [u64; 2];
    /// All [`entry`]s.
    fn all(&self, node: &Node16) -> Row<u64, NODE_WIDTH>;
}

/// A stack entry: the bits of the distance at which a child is entered above (those of non-negative numbers are ordered as they
/// are), the child below.
#[inline(always)]
fn entry(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

/// The place of the lowest bit, if there is one.
#[inline(always)]
fn lowest(mask: u32) -> usize {
    mask.trailing_zeros() as usize % NODE_WIDTH
}

/// [`NodeHits`] with the distances in memory.
#[derive(Clone, Copy)]
pub(super) struct HitMask {
    /// One bit a child.
    pub(super) mask: u32,
    /// The distances at which the ray enters them, not above the true ones.
    pub(super) near: Row<f32, NODE_WIDTH>,
}

impl HitMask {
    #[inline(always)]
    fn entry(&self, node: &Node16, lane: usize) -> u64 {
        entry(self.near.0[lane], node.children.0[lane])
    }
}

impl NodeHits for HitMask {
    #[inline(always)]
    fn mask(&self) -> u32 {
        self.mask
    }

    #[inline(always)]
    fn first(&self, node: &Node16) -> u32 {
        node.children.0[lowest(self.mask)]
    }

    #[inline(always)]
    fn pair<const SECOND: bool>(&self, node: &Node16) -> [u64; 2] {
        let without_lowest = |mask: u32| mask & mask.wrapping_sub(1);
        let first = if SECOND { without_lowest(without_lowest(self.mask)) } else { self.mask };
        [first, without_lowest(first)].map(|mask| self.entry(node, lowest(mask)))
    }

    #[inline(always)]
    fn all(&self, node: &Node16) -> Row<u64, NODE_WIDTH> {
        let (mut out, mut mask) = (Row([0; NODE_WIDTH]), self.mask);
        let mut rank = 0;
        while mask != 0 {
            out.0[rank % NODE_WIDTH] = self.entry(node, lowest(mask));
            mask &= mask - 1;
            rank += 1;
        }
        out
    }
}
