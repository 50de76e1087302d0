//! The scalar type that a formula computes in.

use std::fmt::{Debug, Display};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A floating-point scalar: `f32` or `f64`.
///
/// Optics and geometry are written once over `Real`. Paths are computed in `f64`.
pub trait Real:
    Copy
    + Debug
    + Display
    + Default
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + Sum
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + 'static
{
    /// Zero.
    const ZERO: Self;
    /// One half.
    const HALF: Self;
    /// One.
    const ONE: Self;
    /// Two.
    const TWO: Self;
    /// The unit roundoff u = 2⁻ᵖ: half the distance from 1 to the next value (pbrt calls it `MachineEpsilon`).
    const UNIT_ROUNDOFF: Self;
    /// The largest value below one.
    const ONE_MINUS_EPSILON: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// Largest finite value.
    const MAX: Self;
    /// Archimedes' constant π.
    const PI: Self;
    /// 1/π.
    const FRAC_1_PI: Self;

    /// Rounds an `f64` to this type.
    fn from_f64(value: f64) -> Self;
    /// Widens to `f64`, exactly.
    fn to_f64(self) -> f64;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller of two numbers; the other one if one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of two numbers; the other one if one is NaN.
    fn max(self, other: Self) -> Self;
    /// Largest integer not above `self`.
    fn floor(self) -> Self;
    /// This magnitude with the sign of `sign` (the sign bit, so −0.0 counts as negative).
    fn copysign(self, sign: Self) -> Self;
    /// Whether the sign bit is set.
    fn is_sign_negative(self) -> bool;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Next representable value toward +∞.
    fn next_up(self) -> Self;
    /// Next representable value toward −∞.
    fn next_down(self) -> Self;

    /// √max(self, 0): for differences of squares that rounding may have pushed below zero.
    ///
    /// Only for arguments whose exact value is known to be non-negative.
    fn sqrt_nonnegative(self) -> Self {
        self.max(Self::ZERO).sqrt()
    }

    /// `(sin 2πu, cos 2πu)` for `u` in [0, 1], without the platform's mathematics library.
    ///
    /// The turn is reduced exactly to an eighth, where Taylor series to x¹⁷ are used; the error is below 4 unit
    /// roundoffs of a value of magnitude 1.
    #[inline(always)]
    fn sin_cos_turns(u: Self) -> (Self, Self) {
        // Rounding to the nearest quarter by truncation: a floor would be a library call on the baseline processor.
        let quarters = (u * Self::from_f64(4.0) + Self::HALF).to_f64() as u32;
        let quarter = Self::from_f64(f64::from(quarters));
        // Exact: `u` and a multiple of 1/4 within 1/8 of it (Sterbenz), or `u` itself.
        let x = (u - quarter * Self::from_f64(0.25)) * (Self::TWO * Self::PI);
        let x2 = x * x;
        let series =
            |coefficients: [f64; 8]| coefficients.iter().fold(Self::ZERO, |sum, &c| sum * x2 + Self::from_f64(c)) * x2;
        let sine = x + x * series(SINE);
        let cosine = Self::ONE + series(COSINE);
        // By quarters (s, c), (c, −s), (−s, −c), (−c, s): choices without branches, so that a loop over arguments is vectorised.
        let (s, c) = if quarters & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
        let s = if quarters & 2 == 0 { s } else { -s };
        let c = if (quarters + 1) & 2 == 0 { c } else { -c };
        (s, c)
    }
}

/// (−1)ᵏ/(2k+1)! for k = 8…1.
const SINE: [f64; 8] = [
    1.0 / 355_687_428_096_000.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 39_916_800.0,
    1.0 / 362_880.0,
    -1.0 / 5_040.0,
    1.0 / 120.0,
    -1.0 / 6.0,
];
/// (−1)ᵏ/(2k)! for k = 8…1.
const COSINE: [f64; 8] = [
    1.0 / 20_922_789_888_000.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 479_001_600.0,
    -1.0 / 3_628_800.0,
    1.0 / 40_320.0,
    -1.0 / 720.0,
    1.0 / 24.0,
    -1.0 / 2.0,
];

macro_rules! real {
    ($t:ident) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            const HALF: Self = 0.5;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const UNIT_ROUNDOFF: Self = $t::EPSILON / 2.0;
            const ONE_MINUS_EPSILON: Self = 1.0 - $t::EPSILON / 2.0;
            const INFINITY: Self = $t::INFINITY;
            const MAX: Self = $t::MAX;
            const PI: Self = std::$t::consts::PI;
            const FRAC_1_PI: Self = std::$t::consts::FRAC_1_PI;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                $t::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                $t::max(self, other)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $t::floor(self)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                $t::copysign(self, sign)
            }
            #[inline(always)]
            fn is_sign_negative(self) -> bool {
                $t::is_sign_negative(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
            #[inline(always)]
            fn next_up(self) -> Self {
                $t::next_up(self)
            }
            #[inline(always)]
            fn next_down(self) -> Self {
                $t::next_down(self)
            }
        }
    };
}
real!(f32);
real!(f64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sin_cos_turns_is_within_4_roundoffs_of_the_library() {
        for i in 0..=100_000_u32 {
            let u = f64::from(i) / 100_000.0;
            let (s, c) = f64::sin_cos_turns(u);
            // The library's own argument 2πu is rounded: its error is up to 2π·u·2⁻⁵³ ≈ 6.3 roundoffs on top.
            let (s0, c0) = (u * std::f64::consts::TAU).sin_cos();
            assert!((s - s0).abs() < 11.0 * f64::UNIT_ROUNDOFF && (c - c0).abs() < 11.0 * f64::UNIT_ROUNDOFF, "{u}");
            let u32 = u as f32;
            let (s, c) = f32::sin_cos_turns(u32);
            let (s0, c0) = (f64::from(u32) * std::f64::consts::TAU).sin_cos();
            let bound = 4.0 * f64::from(f32::UNIT_ROUNDOFF);
            assert!((f64::from(s) - s0).abs() < bound && (f64::from(c) - c0).abs() < bound, "{u32}");
        }
    }

    #[test]
    fn sin_cos_turns_is_exact_at_quarter_turns() {
        assert_eq!(f64::sin_cos_turns(0.0), (0.0, 1.0));
        assert_eq!(f64::sin_cos_turns(0.25), (1.0, 0.0));
        assert_eq!(f64::sin_cos_turns(0.5), (0.0, -1.0));
        assert_eq!(f64::sin_cos_turns(0.75), (-1.0, 0.0));
        assert_eq!(f32::sin_cos_turns(1.0), (0.0, 1.0));
    }
}
