//! Eight floats at once, whatever the instruction set.

use crate::wide::LEAF_WIDTH;
use std::ops::{Add, Div, Mul, Sub};

/// Eight floats.
pub(super) trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The proof that the processor has the instructions.
    type Token: Copy;
    /// Eight times the same.
    fn splat(token: Self::Token, v: f32) -> Self;
    /// Eight from memory.
    fn load(token: Self::Token, row: &[f32; LEAF_WIDTH]) -> Self;
    /// The lanes of a row that are this number, one bit each.
    fn lanes_with(token: Self::Token, row: &[u32; LEAF_WIDTH], v: u32) -> u32;
    /// Into memory.
    fn to_array(self) -> [f32; LEAF_WIDTH];
    /// The smaller of each pair; the second if one is NaN.
    fn min(self, o: Self) -> Self;
    /// The larger of each pair; the second if one is NaN.
    fn max(self, o: Self) -> Self;
    /// Zero in all lanes but these, one bit each.
    fn only(self, lanes: u8) -> Self;
    /// Magnitudes.
    fn abs(self) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The lanes that are below, one bit each; none that is NaN.
    fn below(self, o: Self) -> u32;
    /// The lanes that are not above, one bit each; none that is NaN.
    fn at_most(self, o: Self) -> u32;
}
