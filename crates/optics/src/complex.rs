//! Complex numbers, as amplitudes of waves and indices of media that absorb have them.

use std::ops::{Add, Mul, Neg, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// Zero.
    pub const ZERO: Self = Self::new(0.0, 0.0);
    /// One.
    pub const ONE: Self = Self::new(1.0, 0.0);

    /// Of its parts.
    #[inline(always)]
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// A real number.
    #[inline(always)]
    pub const fn real(re: f64) -> Self {
        Self::new(re, 0.0)
    }

    /// The conjugate.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// The square of the magnitude.
    #[inline(always)]
    pub fn squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// A real multiple.
    #[inline(always)]
    pub fn scaled(self, by: f64) -> Self {
        Self::new(self.re * by, self.im * by)
    }

    /// The quotient; not finite where `o` is 0.
    #[inline(always)]
    pub fn over(self, o: Self) -> Self {
        let d = o.squared();
        Self::new((self.re * o.re + self.im * o.im) / d, (self.im * o.re - self.re * o.im) / d)
    }

    /// i times it.
    #[inline(always)]
    pub fn times_i(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// The root in the closed first quadrant, of a number whose imaginary part is not negative. Neither part is a difference of near
    /// numbers: the smaller one is found as the imaginary part over twice the larger.
    #[inline]
    pub fn sqrt_upper(self) -> Self {
        let length = self.squared().sqrt();
        let larger = (0.5 * (length + self.re.abs())).sqrt();
        let smaller = if larger == 0.0 { 0.0 } else { 0.5 * self.im / larger };
        if self.re >= 0.0 { Self::new(larger, smaller) } else { Self::new(smaller, larger) }
    }
}

impl Add for Complex {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.re + o.re, self.im + o.im)
    }
}

impl Sub for Complex {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.re - o.re, self.im - o.im)
    }
}

impl Mul for Complex {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self::new(self.re * o.re - self.im * o.im, self.re * o.im + self.im * o.re)
    }
}

impl Neg for Complex {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_lies_in_the_first_quadrant_and_its_square_is_the_number() {
        for re in [-4.0, -1e-9, 0.0, 1e-9, 2.25] {
            for im in [0.0, 1e-12, 0.3, 5.0] {
                let number = Complex::new(re, im);
                let root = number.sqrt_upper();
                assert!(root.re >= 0.0 && root.im >= 0.0, "{root:?}");
                assert!((root * root - number).squared().sqrt() <= 4e-16 * number.squared().sqrt(), "{number:?}");
            }
        }
    }

    #[test]
    fn a_quotient_times_its_divisor_is_the_dividend() {
        let (a, b) = (Complex::new(0.3, -2.0), Complex::new(-1.5, 0.25));
        assert!((a.over(b) * b - a).squared().sqrt() < 1e-15);
        assert_eq!(a.times_i(), Complex::new(0.0, 1.0) * a);
        assert_eq!((a * a.conjugate()).re, a.squared());
    }
}
