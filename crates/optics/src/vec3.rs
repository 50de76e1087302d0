//! Vectors over any [`Real`], and orthonormal frames.
//!
//! glam has no vector that is generic over its scalar, so the kernels use this small one; glam serves where a scene's
//! transforms are applied.

use crate::Real;
use std::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub, SubAssign};

/// A vector or point with three Cartesian components.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
    /// Third component.
    pub z: R,
}

impl<R: Real> Vec3<R> {
    /// The zero vector.
    pub const ZERO: Self = Self { x: R::ZERO, y: R::ZERO, z: R::ZERO };

    /// A vector of three components.
    #[inline(always)]
    pub const fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }

    /// Three equal components.
    #[inline(always)]
    pub const fn splat(v: R) -> Self {
        Self { x: v, y: v, z: v }
    }

    /// A vector of an array's components.
    #[inline(always)]
    pub const fn from_array([x, y, z]: [R; 3]) -> Self {
        Self { x, y, z }
    }

    /// Rounds an array of `f64`.
    #[inline(always)]
    pub fn from_f64(v: [f64; 3]) -> Self {
        Self::new(R::from_f64(v[0]), R::from_f64(v[1]), R::from_f64(v[2]))
    }

    /// Widens to `f64`, exactly.
    #[inline(always)]
    pub fn to_f64(self) -> Vec3<f64> {
        Vec3::new(self.x.to_f64(), self.y.to_f64(), self.z.to_f64())
    }

    /// Changes the scalar type, rounding if the new one is narrower.
    #[inline(always)]
    pub fn cast<S: Real>(self) -> Vec3<S> {
        Vec3::new(S::from_f64(self.x.to_f64()), S::from_f64(self.y.to_f64()), S::from_f64(self.z.to_f64()))
    }

    /// The components as an array.
    #[inline(always)]
    pub fn to_array(self) -> [R; 3] {
        [self.x, self.y, self.z]
    }

    /// Scalar product, summed as (x + y) + z.
    #[inline(always)]
    pub fn dot(self, o: Self) -> R {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product. Cancels for nearly parallel arguments.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }

    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> R {
        self.dot(self)
    }

    /// Length.
    #[inline(always)]
    pub fn length(self) -> R {
        self.length_squared().sqrt()
    }

    /// The unit vector of this direction; NaN for the zero vector.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        self / self.length()
    }

    /// Brings a vector that is a unit vector up to rounding back to unit length, by one Newton step for 1/√(v·v).
    ///
    /// A length error δ becomes 3δ²/2; a vector whose computed squared length is exactly one keeps its bits.
    #[inline(always)]
    pub fn renormalized(self) -> Self {
        self * (R::from_f64(1.5) - R::HALF * self.length_squared())
    }

    /// Component-wise absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// Component-wise minimum.
    #[inline(always)]
    pub fn min(self, o: Self) -> Self {
        Self::new(self.x.min(o.x), self.y.min(o.y), self.z.min(o.z))
    }

    /// Component-wise maximum.
    #[inline(always)]
    pub fn max(self, o: Self) -> Self {
        Self::new(self.x.max(o.x), self.y.max(o.y), self.z.max(o.z))
    }

    /// The largest component.
    #[inline(always)]
    pub fn max_component(self) -> R {
        self.x.max(self.y).max(self.z)
    }

    /// Whether every component is neither infinite nor NaN.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// The mirror image of this direction about the unit vector `n`, both leaving the surface: 2(n·v)n − v.
    #[inline(always)]
    pub fn reflected_about(self, n: Self) -> Self {
        n * (R::TWO * self.dot(n)) - self
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}
impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: R) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}
impl<R: Real> Div<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: R) -> Self {
        Self::new(self.x / s, self.y / s, self.z / s)
    }
}
impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
impl<R: Real> AddAssign for Vec3<R> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<R: Real> SubAssign for Vec3<R> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
impl<R> Index<usize> for Vec3<R> {
    type Output = R;
    #[inline(always)]
    fn index(&self, axis: usize) -> &R {
        match axis {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("a vector has axes 0 to 2, not {axis}"),
        }
    }
}

/// A right-handed orthonormal frame (s, t, n).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<R> {
    /// First tangent.
    pub s: Vec3<R>,
    /// Second tangent.
    pub t: Vec3<R>,
    /// Normal.
    pub n: Vec3<R>,
}

impl<R: Real> Frame<R> {
    /// A frame about the unit vector `n`, continuous except at the sign change of n.z (Duff et al. 2017, *Building an
    /// Orthonormal Basis, Revisited*, JCGT 6(1), listing 3).
    #[inline(always)]
    pub fn from_normal(n: Vec3<R>) -> Self {
        let sign = R::ONE.copysign(n.z);
        let a = -R::ONE / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(R::ONE + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// From frame coordinates to world coordinates.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<R>) -> Vec3<R> {
        self.s * v.x + self.t * v.y + self.n * v.z
    }

    /// From world coordinates to frame coordinates.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<R>) -> Vec3<R> {
        Vec3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check_frame<R: Real>(n: Vec3<R>) {
        let f = Frame::from_normal(n);
        // Hard case 19: 4ε (ε = 2 unit roundoffs) for a normal that is itself a unit vector to one ε.
        let bound = R::from_f64(8.0) * R::UNIT_ROUNDOFF;
        for (a, b, expected) in
            [(f.s, f.s, R::ONE), (f.t, f.t, R::ONE), (f.s, f.t, R::ZERO), (f.s, f.n, R::ZERO), (f.t, f.n, R::ZERO)]
        {
            assert!((a.dot(b) - expected).abs() <= bound, "{n:?}: {} is not {expected}", a.dot(b));
        }
        assert!((f.s.cross(f.t).dot(n) - R::ONE).abs() <= bound, "left-handed about {n:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        #[test]
        fn frame_is_orthonormal_near_minus_z_and_everywhere(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64, flatness in -20.0..0.0_f64,
        ) {
            prop_assume!(x * x + y * y + z * z > 1e-3);
            for squeeze in [1.0, 10.0_f64.powf(flatness)] {
                let n = Vec3::new(x * squeeze, y * squeeze, z);
                prop_assume!(n.length_squared() > 1e-6);
                check_frame(n.normalized());
                check_frame(n.normalized().cast::<f32>().normalized());
            }
        }
    }

    #[test]
    fn frame_is_orthonormal_at_the_poles() {
        for z in [-1.0, 1.0] {
            check_frame(Vec3::new(0.0_f64, 0.0, z));
            check_frame(Vec3::new(0.0_f32, -0.0, z as f32));
        }
    }
    #[test]
    fn vectors_add_reflect_and_tell_what_they_are() {
        let (a, b) = (Vec3::new(1.0, -2.0, 4.0), Vec3::new(0.5, 8.0, -1.0));
        let (mut sum, mut difference) = (a, a);
        sum += b;
        difference -= b;
        assert_eq!((sum, difference), (Vec3::new(1.5, 6.0, 3.0), Vec3::new(0.5, -10.0, 5.0)));
        assert_eq!((sum, difference), (a + b, a - b));
        assert_eq!((a.max_component(), b.max_component(), (-a).max_component()), (4.0, 8.0, 2.0));
        assert_eq!(a.reflected_about(Vec3::new(0.0, 0.0, 1.0)), Vec3::new(-1.0, 2.0, 4.0));
        let slanting = Vec3::new(0.6, 0.0, 0.8);
        let mirrored = a.reflected_about(slanting);
        // The same along the normal, opposite across it.
        assert!((mirrored.dot(slanting) - a.dot(slanting)).abs() < 1e-14);
        assert!((mirrored + a - slanting * (2.0 * a.dot(slanting))).length() < 1e-14);
        for axis in 0..3 {
            let mut values = [1.0, 2.0, 3.0];
            assert!(Vec3::from_array(values).is_finite());
            values[axis] = f64::NAN;
            assert!(!Vec3::from_array(values).is_finite());
        }
    }

    /// One step of Newton's method for 1/√x: an error of δ becomes 3δ²/2.
    #[test]
    fn renormalising_squares_the_error_of_a_length() {
        for error in [1e-3, -1e-3, 1e-5] {
            let length = (Vec3::new(0.6, 0.0, -0.8) * (1.0 + error)).renormalized().length();
            assert!((length - (1.0 - 1.5 * error * error)).abs() < 2e-9, "{error}: {length}");
        }
    }
}
