//! Eight or sixteen floats at once, whatever the instruction set.

use std::ops::{Add, Div, Mul, Sub};

/// Floats of one vector.
pub(super) trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The proof that the processor has the instructions.
    type Token: Copy;
    /// How many.
    const WIDTH: usize;
    /// The same in all lanes.
    fn splat(token: Self::Token, v: f32) -> Self;
    /// Those of a row from `at` on, a multiple of the width.
    fn load<const W: usize>(token: Self::Token, row: &[f32; W], at: usize) -> Self;
    /// Which numbers of a row from `at` on, a multiple of the width, are this one, a bit each.
    fn lanes_with<const W: usize>(token: Self::Token, row: &[u32; W], at: usize, v: u32) -> u32;
    /// Into a row from `at` on, a multiple of the width; the rest is zero.
    fn to_row<const W: usize>(self, at: usize) -> [f32; W];
    /// The smaller of each pair; the second if one is NaN.
    fn min(self, o: Self) -> Self;
    /// The larger of each pair; the second if one is NaN.
    fn max(self, o: Self) -> Self;
    /// Zero in all lanes but these, one bit each.
    fn only(self, lanes: u32) -> Self;
    /// Magnitudes.
    fn abs(self) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The lanes that are below, one bit each; none that is NaN.
    fn below(self, o: Self) -> u32;
    /// The lanes that are not above, one bit each; none that is NaN.
    fn at_most(self, o: Self) -> u32;
}
