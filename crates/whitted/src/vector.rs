//! Three doubles with componentwise operators, and the few operations whose rounding the published pixels depend on.

use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// A point, a direction or a linear RGB colour. `*` and `/` between two vectors do not exist: use [`Vec3::times`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3(pub [f64; 3]);

/// Shorthand for [`Vec3`].
pub const fn vec3(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3([x, y, z])
}

impl Vec3 {
    /// The componentwise product (colours).
    pub fn times(self, o: Self) -> Self {
        vec3(self.0[0] * o.0[0], self.0[1] * o.0[1], self.0[2] * o.0[2])
    }

    /// The cross product.
    pub fn cross(self, o: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, o.0);
        vec3(b * z - c * y, c * x - a * z, a * y - b * x)
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        vec3(self.0[0] + o.0[0], self.0[1] + o.0[1], self.0[2] + o.0[2])
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        vec3(self.0[0] - o.0[0], self.0[1] - o.0[1], self.0[2] - o.0[2])
    }
}

impl Mul<Vec3> for f64 {
    type Output = Vec3;
    fn mul(self, v: Vec3) -> Vec3 {
        vec3(self * v.0[0], self * v.0[1], self * v.0[2])
    }
}

impl Div<f64> for Vec3 {
    type Output = Self;
    fn div(self, s: f64) -> Self {
        vec3(self.0[0] / s, self.0[1] / s, self.0[2] / s)
    }
}

impl AddAssign for Vec3 {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

/// The operations that are free to round differently, each with the choice that the published figures were made with.
///
/// It is a trait so that a test can put a wrong choice in its place and count the pixels that notice.
pub trait Arithmetic {
    /// The dot product, summed from the left.
    fn dot(a: Vec3, b: Vec3) -> f64 {
        (a.0[0] * b.0[0] + a.0[1] * b.0[1]) + a.0[2] * b.0[2]
    }

    /// `x` to the power `y`.
    ///
    /// IEEE 754 does not bind `pow` to be correctly rounded, and the C library behind [`f64::powf`] changes with the
    /// platform, with its version, even with the processor (glibc picks an FMA variant at run time). So this is the
    /// `libm` crate's: plain `+ - * /` on doubles, hence the same bits wherever IEEE 754 holds. It is within one unit in
    /// the last place of glibc's; the tests show that no published pixel can tell the two apart.
    fn pow(x: f64, y: f64) -> f64 {
        libm::pow(x, y)
    }

    /// The tangent of an angle in radians, from the `libm` crate for the same reason.
    fn tan(angle_rad: f64) -> f64 {
        libm::tan(angle_rad)
    }

    /// `v / sqrt(v·v)`; the zero vector stays as it is.
    fn normalize(v: Vec3) -> Vec3 {
        let z = Self::dot(v, v);
        if z > 0.0 { v / z.sqrt() } else { v }
    }
}

/// The arithmetic of the published figures.
#[derive(Clone, Copy, Debug)]
pub struct Published;

impl Arithmetic for Published {}
