//! Four floats at once, whatever the instruction set.

use crate::query::AXES;
use std::array::from_fn;

/// Four floats, whatever the instruction set.
pub(crate) trait Lanes4: Copy {
    /// The proof that the processor has the instructions.
    type Token: Copy;
    fn new(token: Self::Token, v: [f32; 4]) -> Self;
    fn to_array(self) -> [f32; 4];
    fn abs(self) -> Self;
    fn sum(self, o: Self) -> Self;
    fn difference(self, o: Self) -> Self;
    fn product(self, o: Self) -> Self;
    fn times(self, factor: f32) -> Self;
    fn plus(self, v: f32) -> Self;
    fn at_least(self, v: f32) -> Self;
    fn reciprocal(self) -> Self;
    /// The magnitudes of positive numbers with the sign bits of others.
    fn signed_as(self, o: Self) -> Self;
    /// Whether no number is above a limit, or NaN.
    fn all_at_most(self, limit: f32) -> bool;
    /// The sign bits of the first three, the first one lowest.
    fn negative(self) -> usize;
    /// Those along [`AXES`] of an axis.
    fn turned(self, axis: usize) -> Self;
}

/// [`Lanes4`] in plain Rust.
#[derive(Clone, Copy)]
pub(crate) struct Plain([f32; 4]);

impl Lanes4 for Plain {
    type Token = ();

    #[inline(always)]
    fn new((): (), v: [f32; 4]) -> Self {
        Self(v)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 4] {
        self.0
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i] + o.0[i]))
    }

    #[inline(always)]
    fn difference(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i] - o.0[i]))
    }

    #[inline(always)]
    fn product(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i] * o.0[i]))
    }

    #[inline(always)]
    fn times(self, factor: f32) -> Self {
        Self(self.0.map(|v| v * factor))
    }

    #[inline(always)]
    fn plus(self, v: f32) -> Self {
        Self(self.0.map(|w| w + v))
    }

    #[inline(always)]
    fn at_least(self, v: f32) -> Self {
        Self(self.0.map(|w| if w > v { w } else { v }))
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self(self.0.map(|v| 1.0 / v))
    }

    #[inline(always)]
    fn signed_as(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i].copysign(o.0[i])))
    }

    #[inline(always)]
    fn all_at_most(self, limit: f32) -> bool {
        self.0.iter().all(|&v| v <= limit)
    }

    #[inline(always)]
    fn negative(self) -> usize {
        (0..3).map(|i| usize::from(self.0[i].is_sign_negative()) << i).sum()
    }

    #[inline(always)]
    fn turned(self, axis: usize) -> Self {
        let [x, y, z] = AXES[axis % AXES.len()];
        Self([self.0[x as usize], self.0[y as usize], self.0[z as usize], self.0[3]])
    }
}
