//! Eight numbers, one for each of eight rays, in plain Rust: the compiler makes vectors of them in functions that are compiled for
//! such.

use crate::LANES;
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Sub};

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Eight(pub(super) [f64; LANES]);

/// Eight truths.
pub(super) type Which = [bool; LANES];

macro_rules! operator {
    ($trait:ident, $f:ident, $operator:tt) => {
        impl $trait for Eight {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(from_fn(|i| self.0[i] $operator o.0[i]))
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Eight {
    #[inline(always)]
    pub(super) fn splat(v: f64) -> Self {
        Self([v; LANES])
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    /// The larger of each pair; the second if one is NaN.
    #[inline(always)]
    pub(super) fn max(self, o: Self) -> Self {
        Self(from_fn(|i| if self.0[i] > o.0[i] { self.0[i] } else { o.0[i] }))
    }

    #[inline(always)]
    pub(super) fn negated(self) -> Self {
        Self(self.0.map(|v| -v))
    }

    #[inline(always)]
    pub(super) fn below(self, o: Self) -> Which {
        from_fn(|i| self.0[i] < o.0[i])
    }

    #[inline(always)]
    pub(super) fn at_most(self, o: Self) -> Which {
        from_fn(|i| self.0[i] <= o.0[i])
    }

    /// This where a truth is, else another.
    #[inline(always)]
    pub(super) fn or_else(self, which: Which, o: Self) -> Self {
        Self(from_fn(|i| if which[i] { self.0[i] } else { o.0[i] }))
    }

    /// The largest magnitude of three.
    #[inline(always)]
    pub(super) fn largest([x, y, z]: [Self; 3]) -> Self {
        x.abs().max(y.abs()).max(z.abs())
    }

    #[inline(always)]
    pub(super) fn narrowed(self) -> [f32; LANES] {
        self.0.map(|v| v as f32)
    }
}

#[inline(always)]
pub(super) fn both(a: Which, b: Which) -> Which {
    from_fn(|i| a[i] & b[i])
}

/// One bit for each.
#[inline(always)]
pub(super) fn bits(which: Which) -> u8 {
    (0..LANES).fold(0, |mask, i| mask | u8::from(which[i]) << i)
}
