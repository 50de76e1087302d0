//! Numbers of about 32 digits, as unevaluated sums of two `f64`: the high-precision evaluation behind the accuracy laws.
//!
//! Dekker (1971), "A floating-point technique for extending the available precision"; the variants with proven error
//! bounds (a few 2⁻¹⁰⁴) are those of Joldes, Muller & Popescu (2017), "Tight and rigorous error bounds for basic building
//! blocks of double-word arithmetic".

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo`, with `|lo|` at most half a unit in the last place of `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl DoubleDouble {
    /// Zero.
    pub const ZERO: Self = Self { hi: 0.0, lo: 0.0 };
    /// One.
    pub const ONE: Self = Self { hi: 1.0, lo: 0.0 };

    /// The nearest `f64`.
    #[must_use]
    pub const fn to_f64(self) -> f64 {
        self.hi + self.lo
    }

    /// Square root; NaN below zero. Karp & Markstein (1997).
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.hi == 0.0 {
            return Self::ZERO;
        }
        let approximate = self.hi.sqrt();
        let square = two_product(approximate, approximate);
        let rest = self - Self { hi: square.0, lo: square.1 };
        let (hi, lo) = quick_two_sum(approximate, rest.hi / (2.0 * approximate));
        Self { hi, lo }
    }

    /// The square.
    #[must_use]
    pub fn squared(self) -> Self {
        self * self
    }

    /// Whether it is below zero.
    #[must_use]
    pub fn is_negative(self) -> bool {
        self.hi < 0.0
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (hi, lo) = two_sum(self.hi, other.hi);
        let (tail_hi, tail_lo) = two_sum(self.lo, other.lo);
        let (hi, lo) = quick_two_sum(hi, lo + tail_hi);
        let (hi, lo) = quick_two_sum(hi, lo + tail_lo);
        Self { hi, lo }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (hi, lo) = two_product(self.hi, other.hi);
        let lo = lo + (self.hi * other.lo + self.lo * other.hi);
        let (hi, lo) = quick_two_sum(hi, lo);
        Self { hi, lo }
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // Long division, two digits of base 2⁵³: to 15 · 2⁻¹⁰⁶ (their algorithm 17).
        let first = self.hi / other.hi;
        let rest = self - other * Self::from(first);
        let (hi, lo) = quick_two_sum(first, rest.hi / other.hi);
        Self { hi, lo }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_keeps_thirty_digits() {
        let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
        let back = third * DoubleDouble::from(3.0) - DoubleDouble::ONE;
        assert!(back.to_f64().abs() < 1e-31);
        let root = DoubleDouble::from(2.0).sqrt();
        assert!((root.squared() - DoubleDouble::from(2.0)).to_f64().abs() < 1e-31);
        // √2 = 1.41421356237309504880168872420969807…
        assert_eq!(root.hi, std::f64::consts::SQRT_2);
        assert!((root.lo - -9.667_293_313_452_913e-17).abs() < 1e-31);
    }

    #[test]
    fn cancellation_that_ruins_f64_is_harmless() {
        let tiny = DoubleDouble::from(1e-20);
        let one_and_tiny = DoubleDouble::ONE + tiny;
        assert_eq!((one_and_tiny - DoubleDouble::ONE).to_f64(), 1e-20);
    }
}
