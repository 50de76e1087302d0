//! Eight numbers, one for each of eight rays, whatever the instruction set.

use crate::LANES;
use std::array::from_fn;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Eight numbers.
pub(crate) trait Eight:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The proof that the processor has the instructions.
    type Token: Copy;
    /// Eight truths.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    fn splat(token: Self::Token, v: f64) -> Self;
    fn new(token: Self::Token, v: &[f64; LANES]) -> Self;
    fn to_array(self) -> [f64; LANES];
    fn narrowed(self) -> [f32; LANES];
    /// The numbers at eight places of a table, whose length is a power of two that bounds them.
    fn gathered<const N: usize>(token: Self::Token, table: &[f64; N], at: &[u32; LANES]) -> Self;
    fn abs(self) -> Self;
    fn negated(self) -> Self;
    /// The larger of each pair; the second if one is NaN.
    fn max(self, o: Self) -> Self;
    fn below(self, o: Self) -> Self::Mask;
    fn at_most(self, o: Self) -> Self::Mask;
    /// This where a mask is set, else another.
    fn or_else(self, mask: Self::Mask, o: Self) -> Self;
    /// The bits below in the exponents alone: the powers of two not above positive numbers.
    fn exponents(self) -> Self;
    /// One over each, of powers of two.
    fn inverse_powers(self) -> Self;
    /// One bit for each truth.
    fn bits(mask: Self::Mask) -> u8;

    /// The largest magnitude of three.
    #[inline(always)]
    fn largest([x, y, z]: [Self; 3]) -> Self {
        x.abs().max(y.abs()).max(z.abs())
    }

    /// Three rows.
    #[inline(always)]
    fn rows(token: Self::Token, v: &[[f64; LANES]; 3]) -> [Self; 3] {
        [Self::new(token, &v[0]), Self::new(token, &v[1]), Self::new(token, &v[2])]
    }
}

/// What a function makes of each of three axes. `array::map` may stay a function of its own, without the caller's vector
/// instructions, and each operation within it then becomes a call.
#[inline(always)]
pub(crate) fn axes<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

/// Exponents' bits.
pub(crate) const EXPONENT: u64 = 0x7FF << 52;
/// The sum of the bits of a power of two and of its inverse.
pub(crate) const TURN: u64 = 2046 << 52;

/// [`Eight`] in plain Rust.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlainEight([f64; LANES]);

macro_rules! operator {
    ($trait:ident, $f:ident, $operator:tt) => {
        impl $trait for PlainEight {
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

impl Eight for PlainEight {
    type Token = ();
    type Mask = u8;

    #[inline(always)]
    fn splat((): (), v: f64) -> Self {
        Self([v; LANES])
    }

    #[inline(always)]
    fn new((): (), v: &[f64; LANES]) -> Self {
        Self(*v)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        self.0
    }

    #[inline(always)]
    fn narrowed(self) -> [f32; LANES] {
        self.0.map(|v| v as f32)
    }

    #[inline(always)]
    fn gathered<const N: usize>((): (), table: &[f64; N], at: &[u32; LANES]) -> Self {
        Self(at.map(|i| table[i as usize % N]))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    #[inline(always)]
    fn negated(self) -> Self {
        Self(self.0.map(|v| -v))
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(from_fn(|i| if self.0[i] > o.0[i] { self.0[i] } else { o.0[i] }))
    }

    #[inline(always)]
    fn below(self, o: Self) -> u8 {
        (0..LANES).fold(0, |mask, i| mask | u8::from(self.0[i] < o.0[i]) << i)
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> u8 {
        (0..LANES).fold(0, |mask, i| mask | u8::from(self.0[i] <= o.0[i]) << i)
    }

    #[inline(always)]
    fn or_else(self, mask: u8, o: Self) -> Self {
        Self(from_fn(|i| if mask >> i & 1 == 1 { self.0[i] } else { o.0[i] }))
    }

    #[inline(always)]
    fn exponents(self) -> Self {
        Self(self.0.map(|v| f64::from_bits(v.to_bits() & EXPONENT)))
    }

    #[inline(always)]
    fn inverse_powers(self) -> Self {
        Self(self.0.map(|v| f64::from_bits(TURN.wrapping_sub(v.to_bits()))))
    }

    #[inline(always)]
    fn bits(mask: u8) -> u8 {
        mask
    }
}
