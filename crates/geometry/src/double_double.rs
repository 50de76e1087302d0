//! Double-double arithmetic: an unevaluated sum of two `f64` with about 104 significant bits.
//!
//! The fall-back of the intersection tests when an error bound says that `f64` alone does not determine the result.
//! The error-free transformations are Knuth's sum and Dekker's product (T. J. Dekker, *A floating-point technique for
//! extending the available precision*, Numer. Math. 18, 1971); no fused multiply-add is used.

use etalon_optics::Vec3;
use std::ops::{Add, Mul, Neg, Sub};

/// A value `hi + lo` with |lo| ≤ ulp(hi)/2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dd {
    hi: f64,
    lo: f64,
}

/// a + b = sum + error, exactly.
#[inline]
fn two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    let b_part = hi - a;
    let lo = (a - (hi - b_part)) + (b - b_part);
    Dd { hi, lo }
}

/// As [`two_sum`], for |a| ≥ |b|.
#[inline]
fn fast_two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    Dd { hi, lo: b - (hi - a) }
}

/// Splits a value into two halves of at most 26 bits each.
#[inline]
fn split(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a; // 2²⁷ + 1
    let high = c - (c - a);
    (high, a - high)
}

/// a·b = product + error, exactly, short of overflow and underflow.
#[inline]
fn two_product(a: f64, b: f64) -> Dd {
    let hi = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Dd { hi, lo: ((ah * bh - hi) + ah * bl + al * bh) + al * bl }
}

/// a·b − c·d with the right sign, short of overflow and underflow.
pub(crate) fn product_difference(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, q) = (two_product(a, b), two_product(c, d));
    // Where the differences could cancel, both are exact.
    (p.hi - q.hi) + (p.lo - q.lo)
}

impl Dd {
    /// a − b, exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        two_sum(a, -b)
    }

    /// Rounded to `f64`.
    pub(crate) fn to_f64(self) -> f64 {
        self.hi
    }

    /// The quotient of two values, rounded to `f64` with a relative error of a few unit roundoffs.
    pub(crate) fn ratio(self, divisor: Self) -> f64 {
        // One Newton correction of the leading quotient removes the error that the low part of the divisor leaves.
        let q = self.hi / divisor.hi;
        let rest = self - divisor * Self { hi: q, lo: 0.0 };
        q + rest.hi / divisor.hi
    }
}

impl From<f64> for Dd {
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}
impl Add for Dd {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        let s = two_sum(self.hi, o.hi);
        let t = two_sum(self.lo, o.lo);
        let s = fast_two_sum(s.hi, s.lo + t.hi);
        fast_two_sum(s.hi, s.lo + t.lo)
    }
}
impl Neg for Dd {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}
impl Sub for Dd {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}
impl Mul for Dd {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        let p = two_product(self.hi, o.hi);
        fast_two_sum(p.hi, p.lo + (self.hi * o.lo + self.lo * o.hi))
    }
}

/// A vector of [`Dd`].
pub(crate) type DdVec = [Dd; 3];

/// a − b, exactly.
pub(crate) fn difference(a: Vec3<f64>, b: Vec3<f64>) -> DdVec {
    [Dd::difference(a.x, b.x), Dd::difference(a.y, b.y), Dd::difference(a.z, b.z)]
}

/// Widens a vector.
pub(crate) fn widen(a: Vec3<f64>) -> DdVec {
    [a.x.into(), a.y.into(), a.z.into()]
}

/// Vector product.
pub(crate) fn cross(a: DdVec, b: DdVec) -> DdVec {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Scalar product.
pub(crate) fn dot(a: DdVec, b: DdVec) -> Dd {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Rounds a vector to `f64`.
pub(crate) fn round(a: DdVec) -> Vec3<f64> {
    Vec3::new(a[0].to_f64(), a[1].to_f64(), a[2].to_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cancelling_product_difference_keeps_its_leading_digits() {
        // (1 + 2⁻³⁰)(1 − 2⁻³⁰) − 1 = −2⁻⁶⁰, which f64 rounds to zero.
        let e = 2.0_f64.powi(-30);
        let p = Dd::from(1.0 + e) * Dd::from(1.0 - e) - Dd::from(1.0);
        assert_eq!(p.to_f64(), -(e * e));
        assert_eq!((1.0 + e) * (1.0 - e) - 1.0, 0.0);
    }

    #[test]
    fn a_product_difference_that_f64_loses_keeps_its_sign() {
        let e = 2.0_f64.powi(-30);
        assert_eq!(product_difference(1.0 + e, 1.0 - e, 1.0, 1.0), -(e * e));
        assert_eq!(product_difference(1.0, 1.0, 1.0 + e, 1.0 - e), e * e);
        assert_eq!(product_difference(3.0, 7.0, 7.0, 3.0), 0.0);
        assert_eq!(product_difference(3.0, 7.0, 5.0, 4.0), 1.0);
    }

    #[test]
    fn a_ratio_is_right_to_a_few_roundoffs() {
        let third = Dd::from(1.0).ratio(Dd::from(3.0));
        assert_eq!(third, 1.0 / 3.0);
        let e = 2.0_f64.powi(-70);
        let x = Dd::from(1.0) + Dd::from(e);
        assert_eq!((x - Dd::from(1.0)).ratio(Dd::from(e)), 1.0);
    }
}
