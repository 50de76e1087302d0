//! Eight or sixteen floats at once, whatever the instruction set.

use super::block::BLOCK;
use crate::LANES;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

/// Floats of one vector: as many primitives for one ray, or one or two primitives for each of eight rays.
pub(crate) trait Wide:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The proof that the processor has the instructions.
    type Token: Copy;
    /// One truth for each number.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;
    /// How many numbers.
    const WIDTH: usize;
    /// How many of them belong to each of eight rays, one beside the other.
    const SHARE: usize = Self::WIDTH / LANES;

    /// The same number everywhere.
    fn splat(token: Self::Token, v: f32) -> Self;
    /// The numbers of a row from `at` on, a multiple of the width.
    fn load(token: Self::Token, row: &[f32; BLOCK], at: usize) -> Self;
    /// The numbers of a row from `at` on, a multiple of the share, as many as the share is, the same for each ray.
    fn shared(token: Self::Token, row: &[f32; BLOCK], at: usize) -> Self;
    /// The numbers of eight rays, each as often as the share is.
    fn rays(token: Self::Token, v: &[f32; LANES]) -> Self;
    /// Puts the numbers at the start of a row.
    fn store(self, row: &mut [f32; BLOCK]);
    /// The smaller of each pair; the second if one is NaN.
    fn min(self, o: Self) -> Self;
    /// The larger of each pair; the second if one is NaN.
    fn max(self, o: Self) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The smallest, none of them NaN.
    fn least(self) -> f32;
    /// Negated where another number's sign bit is set.
    fn flipped(self, sign: Self) -> Self;
    /// Where this is below; nowhere that one is NaN.
    fn below(self, o: Self) -> Self::Mask;
    /// Where this is not above; nowhere that one is NaN.
    fn at_most(self, o: Self) -> Self::Mask;
    /// Where both are equal.
    fn equals(self, o: Self) -> Self::Mask;
    /// Where both differ, and neither is NaN.
    fn differs(self, o: Self) -> Self::Mask;
    /// The numbers that belong to eight rays, first and second, where the share is two; where it is one, twice the same.
    fn shares(self) -> [[f32; LANES]; 2];
    /// This where a mask is set, else another.
    fn or_else(self, mask: Self::Mask, other: Self) -> Self;
    /// One bit for each number.
    fn bits(mask: Self::Mask) -> u32;

    /// [`Wide::below`] where a mask is set.
    #[inline(always)]
    fn below_where(self, mask: Self::Mask, o: Self) -> Self::Mask {
        mask & self.below(o)
    }

    /// [`Wide::at_most`] where a mask is set.
    #[inline(always)]
    fn at_most_where(self, mask: Self::Mask, o: Self) -> Self::Mask {
        mask & self.at_most(o)
    }

    /// [`Wide::min`] where a mask is set, else this.
    #[inline(always)]
    fn min_where(self, mask: Self::Mask, o: Self) -> Self {
        self.min(o).or_else(mask, self)
    }
}
