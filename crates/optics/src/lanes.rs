//! One value for each wavelength that a path carries.

use crate::Real;
use std::ops::{Add, AddAssign, Div, DivAssign, Index, IndexMut, Mul, MulAssign, Sub};

/// `N` values, one a wavelength; lane 0 belongs to the hero wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Lanes<R, const N: usize>(pub [R; N]);

impl<R: Real, const N: usize> Lanes<R, N> {
    /// Zero in every lane.
    pub const ZERO: Self = Self([R::ZERO; N]);
    /// One in every lane.
    pub const ONE: Self = Self([R::ONE; N]);

    /// The same value in every lane.
    #[inline(always)]
    pub const fn splat(v: R) -> Self {
        Self([v; N])
    }

    /// The value of `f` at each lane's index.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(usize) -> R) -> Self {
        // A loop, of which compilers make vector instructions more surely than of the library's function of this name.
        let mut lanes = Self::ZERO;
        for lane in 0..N {
            lanes.0[lane] = f(lane);
        }
        lanes
    }

    /// `f` of each lane.
    #[inline(always)]
    pub fn map(self, mut f: impl FnMut(R) -> R) -> Self {
        Self::from_fn(|lane| f(self.0[lane]))
    }

    /// `f` of each pair of lanes.
    #[inline(always)]
    pub fn zip(self, o: Self, mut f: impl FnMut(R, R) -> R) -> Self {
        Self::from_fn(|i| f(self.0[i], o.0[i]))
    }

    /// Sum over the lanes: pairs first, then pairs of these, for a sum in order waits for each of its steps.
    #[inline(always)]
    pub fn sum(self) -> R {
        self.folded(|a, b| a + b)
    }

    /// `f` of pairs of lanes, then of pairs of what came of these, down to one.
    #[inline(always)]
    fn folded(self, f: impl Fn(R, R) -> R) -> R {
        let Self(mut lanes) = self;
        let mut count = N;
        while count > 1 {
            let half = count.div_ceil(2);
            for lane in 0..count - half {
                lanes[lane] = f(lanes[lane], lanes[lane + half]);
            }
            count = half;
        }
        lanes[0]
    }

    /// Mean over the lanes.
    #[inline(always)]
    pub fn mean(self) -> R {
        self.sum() / R::from_f64(N as f64)
    }

    /// The largest lane, if all are numbers.
    #[inline(always)]
    pub fn max_lane(self) -> R {
        // One instruction, where the library's maximum looks for NaN.
        self.folded(|a, b| if a > b { a } else { b })
    }

    /// Whether every lane is exactly zero.
    #[inline(always)]
    pub fn is_zero(self) -> bool {
        // Without a way out before the end, so that it is done at once.
        let mut zero = true;
        for lane in 0..N {
            zero &= self.0[lane] == R::ZERO;
        }
        zero
    }

    /// Whether every lane is neither infinite nor NaN.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        let mut finite = true;
        for lane in 0..N {
            finite &= self.0[lane].is_finite();
        }
        finite
    }

    /// Keeps lane 0 (the hero) and sets the others to zero.
    #[inline(always)]
    pub fn hero_only(self) -> Self {
        Self::from_fn(|i| if i == 0 { self.0[0] } else { R::ZERO })
    }
}

macro_rules! lane_operator {
    ($trait:ident, $f:ident, $op:tt) => {
        impl<R: Real, const N: usize> $trait for Lanes<R, N> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self::from_fn(|i| self.0[i] $op o.0[i])
            }
        }
        impl<R: Real, const N: usize> $trait<R> for Lanes<R, N> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, s: R) -> Self {
                Self::from_fn(|i| self.0[i] $op s)
            }
        }
    };
}
lane_operator!(Add, add, +);
lane_operator!(Sub, sub, -);
lane_operator!(Mul, mul, *);
lane_operator!(Div, div, /);

impl<R: Real, const N: usize> AddAssign for Lanes<R, N> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<R: Real, const N: usize> MulAssign for Lanes<R, N> {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}
impl<R: Real, const N: usize> MulAssign<R> for Lanes<R, N> {
    #[inline(always)]
    fn mul_assign(&mut self, s: R) {
        *self = *self * s;
    }
}
impl<R: Real, const N: usize> DivAssign<R> for Lanes<R, N> {
    #[inline(always)]
    fn div_assign(&mut self, s: R) {
        *self = *self / s;
    }
}
impl<R, const N: usize> Index<usize> for Lanes<R, N> {
    type Output = R;
    #[inline(always)]
    fn index(&self, lane: usize) -> &R {
        &self.0[lane]
    }
}
impl<R, const N: usize> IndexMut<usize> for Lanes<R, N> {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut R {
        &mut self.0[lane]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lanes(values: [f64; 3]) -> Lanes<f64, 3> {
        Lanes(values)
    }

    #[test]
    fn operators_take_lane_by_lane_and_leave_nothing_out() {
        let (a, b) = (lanes([2.0, 3.0, 5.0]), lanes([4.0, 8.0, 16.0]));
        assert_eq!(a + b, lanes([6.0, 11.0, 21.0]));
        assert_eq!(a - b, lanes([-2.0, -5.0, -11.0]));
        assert_eq!(a * b, lanes([8.0, 24.0, 80.0]));
        assert_eq!(a / b, lanes([0.5, 0.375, 0.3125]));
        assert_eq!((a + 1.0, a - 1.0), (lanes([3.0, 4.0, 6.0]), lanes([1.0, 2.0, 4.0])));
        assert_eq!((a * 2.0, a / 2.0), (lanes([4.0, 6.0, 10.0]), lanes([1.0, 1.5, 2.5])));
        let (mut sum, mut product, mut scaled, mut divided) = (a, a, a, a);
        sum += b;
        product *= b;
        scaled *= 4.0;
        divided /= 4.0;
        assert_eq!((sum, product, scaled, divided), (a + b, a * b, a * 4.0, a / 4.0));
    }

    #[test]
    fn what_is_said_of_all_lanes_takes_each_into_account() {
        let a = lanes([2.0, -3.0, 7.0]);
        assert_eq!((a.sum(), a.mean(), a.max_lane()), (6.0, 2.0, 7.0));
        assert_eq!(a.hero_only(), lanes([2.0, 0.0, 0.0]));
        for lane in 0..3 {
            let (mut dark, mut finite) = (lanes([0.0; 3]), lanes([1.0; 3]));
            assert!(dark.is_zero() && finite.is_finite());
            dark[lane] = -1.0;
            assert!(!dark.is_zero());
            for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                finite[lane] = wrong;
                assert!(!finite.is_finite(), "{finite:?}");
            }
        }
    }
}
