//! Four floats or numbers at once, whatever the instruction set; and the axes along which a ray's numbers are ordered.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

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

/// Four numbers at once, whatever the instruction set.
pub(crate) trait Four: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The proof that the processor has the instructions.
    type Token: Copy;
    /// Four floats.
    type Narrow: Lanes4<Token = Self::Token>;
    /// Four times the same.
    fn splat(token: Self::Token, v: f64) -> Self;
    /// Four numbers.
    fn new(token: Self::Token, v: [f64; 4]) -> Self;
    /// Four floats, exactly.
    fn widened(token: Self::Token, v: [f32; 4]) -> Self;
    /// Rounded.
    fn narrowed(self) -> Self::Narrow;
    /// 1 where a float is not the number, else 0.
    fn differs(self, o: Self::Narrow) -> Self::Narrow;
    /// The numbers below zero, and those above it, one bit each; none that is NaN.
    fn signs(self) -> [u32; 2];
    /// Whether no number is above a limit, or NaN.
    fn all_at_most(self, limit: f64) -> bool;
    /// The numbers.
    fn to_array(self) -> [f64; 4];
    /// Magnitudes.
    fn abs(self) -> Self;
    /// The larger of each pair, none of them NaN.
    fn max(self, o: Self) -> Self;
    /// The third, the first and the second number, and any fourth.
    fn turned(self) -> Self;
    /// The second, the third, the fourth and the first number.
    fn next(self) -> Self;
    /// Those along [`AXES`] of an axis.
    fn along(self, axis: usize) -> Self;

    /// The largest of four numbers, none of them NaN.
    #[inline(always)]
    fn largest(self) -> f64 {
        let v = self.to_array();
        larger(larger(v[0], v[2]), larger(v[1], v[3]))
    }
}

/// [`Four`] in plain Rust.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain4([f64; 4]);

macro_rules! operator {
    ($trait:ident, $f:ident, $operator:tt) => {
        impl $trait for Plain4 {
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

impl Four for Plain4 {
    type Token = ();
    type Narrow = Plain;

    #[inline(always)]
    fn splat((): (), v: f64) -> Self {
        Self([v; 4])
    }

    #[inline(always)]
    fn new((): (), v: [f64; 4]) -> Self {
        Self(v)
    }

    #[inline(always)]
    fn widened((): (), v: [f32; 4]) -> Self {
        Self(v.map(f64::from))
    }

    #[inline(always)]
    fn narrowed(self) -> Plain {
        Plain::new((), self.0.map(|v| v as f32))
    }

    #[inline(always)]
    fn differs(self, o: Plain) -> Plain {
        let o = o.to_array();
        Plain::new((), from_fn(|i| if f64::from(o[i]) == self.0[i] { 0.0 } else { 1.0 }))
    }

    #[inline(always)]
    fn signs(self) -> [u32; 2] {
        let lanes = |is: fn(f64) -> bool| (0..4).fold(0, |mask, i| mask | u32::from(is(self.0[i])) << i);
        [lanes(|v| v < 0.0), lanes(|v| v > 0.0)]
    }

    #[inline(always)]
    fn all_at_most(self, limit: f64) -> bool {
        self.0.iter().all(|&v| v <= limit)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        self.0
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(from_fn(|i| self.0[i].abs()))
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(from_fn(|i| larger(self.0[i], o.0[i])))
    }

    #[inline(always)]
    fn turned(self) -> Self {
        let [a, b, c, _] = self.0;
        Self([c, a, b, b])
    }

    #[inline(always)]
    fn next(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([b, c, d, a])
    }

    #[inline(always)]
    fn along(self, axis: usize) -> Self {
        let [x, y, z] = AXES[axis % AXES.len()];
        Self([self.0[x as usize], self.0[y as usize], self.0[z as usize], self.0[3]])
    }
}

/// The larger of two numbers; the second if one is NaN. One instruction, unlike [`f64::max`].
#[inline(always)]
pub(crate) fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// The axis along which a direction of these magnitudes (the first three) is largest, an index into [`AXES`].
#[inline(always)]
pub(crate) fn projection_axis<T: PartialOrd + Copy>([x, y, z, _]: [T; 4]) -> usize {
    // Without a branch: the axis of a ray is as good as random.
    usize::from(y > larger(x, z)) + 2 * usize::from(z > x && z >= y)
}

/// The axes of the projection along each axis, that one last.
pub(crate) const AXES: [[Axis; 3]; 4] = {
    use Axis::{X, Y, Z};
    [[Y, Z, X], [Z, X, Y], [X, Y, Z], [X, Y, Z]]
};

/// An index of three coordinates, of which the compiler knows that it is one.
#[derive(Clone, Copy, Debug)]
#[repr(usize)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}
