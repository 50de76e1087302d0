//! Eight floats of AVX2 as the filters of flat geometries want them.

use super::lanes256::F8;
use super::vector::Vector;
use crate::LANES;
use crate::small_scene::{BLOCK, EXPONENT, Eight, TURN, Wide};
use etalon_simd::Avx2;
use std::arch::x86_64::*;
use std::ops::{BitAnd, BitOr, Not};

/// Eight truths, all bits of a number each.
#[derive(Clone, Copy)]
pub(super) struct M8(__m256, Avx2);

impl BitAnd for M8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(self.1._mm256_and_ps(self.0, o.0), self.1)
    }
}

impl BitOr for M8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(self.1._mm256_or_ps(self.0, o.0), self.1)
    }
}

impl Not for M8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let t = self.1;
        Self(t._mm256_xor_ps(self.0, t._mm256_castsi256_ps(t._mm256_set1_epi32(-1))), t)
    }
}

impl Wide for F8 {
    type Token = Avx2;
    type Mask = M8;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(token: Avx2, v: f32) -> Self {
        Vector::splat(token, v)
    }

    #[inline(always)]
    fn load(token: Avx2, row: &[f32; BLOCK], at: usize) -> Self {
        Vector::load(token, row, at)
    }

    #[inline(always)]
    fn shared(token: Avx2, row: &[f32; BLOCK], at: usize) -> Self {
        Vector::splat(token, row[at % BLOCK])
    }

    #[inline(always)]
    fn rays(t: Avx2, v: &[f32; LANES]) -> Self {
        Self(t._mm256_loadu_ps(v), t)
    }

    #[inline(always)]
    fn store(self, row: &mut [f32; BLOCK]) {
        F8::store(self, row, 0);
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Vector::min(self, o)
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Vector::max(self, o)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Vector::sqrt(self)
    }

    #[inline(always)]
    fn least(self) -> f32 {
        let t = self.1;
        let four = t._mm_min_ps(t._mm256_castps256_ps128(self.0), t._mm256_extractf128_ps::<1>(self.0));
        let two = t._mm_min_ps(four, t._mm_movehl_ps(four, four));
        t._mm_cvtss_f32(t._mm_min_ss(two, t._mm_movehdup_ps(two)))
    }

    #[inline(always)]
    fn flipped(self, sign: Self) -> Self {
        let t = self.1;
        Self(t._mm256_xor_ps(self.0, t._mm256_and_ps(sign.0, t._mm256_set1_ps(-0.0))), t)
    }

    #[inline(always)]
    fn below(self, o: Self) -> M8 {
        M8(self.1._mm256_cmp_ps::<_CMP_LT_OQ>(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> M8 {
        M8(self.1._mm256_cmp_ps::<_CMP_LE_OQ>(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn equals(self, o: Self) -> M8 {
        M8(self.1._mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn differs(self, o: Self) -> M8 {
        M8(self.1._mm256_cmp_ps::<_CMP_NEQ_OQ>(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn shares(self) -> [[f32; LANES]; 2] {
        let mut out = [0.0; LANES];
        self.1._mm256_storeu_ps(&mut out, self.0);
        [out; 2]
    }

    #[inline(always)]
    fn or_else(self, mask: M8, other: Self) -> Self {
        Self(self.1._mm256_blendv_ps(other.0, self.0, mask.0), self.1)
    }

    #[inline(always)]
    fn bits(mask: M8) -> u32 {
        mask.1._mm256_movemask_ps(mask.0) as u32
    }
}

/// Eight numbers in two halves.
#[derive(Clone, Copy)]
pub(super) struct D8([__m256d; 2], Avx2);

macro_rules! operator8 {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl std::ops::$trait for D8 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self([self.1.$instruction(self.0[0], o.0[0]), self.1.$instruction(self.0[1], o.0[1])], self.1)
            }
        }
    };
}
operator8!(Add, add, _mm256_add_pd);
operator8!(Sub, sub, _mm256_sub_pd);
operator8!(Mul, mul, _mm256_mul_pd);
operator8!(Div, div, _mm256_div_pd);
// Truths are numbers whose bits are all set, or none.
operator8!(BitAnd, bitand, _mm256_and_pd);
operator8!(BitOr, bitor, _mm256_or_pd);

/// An instruction on both halves.
macro_rules! halves {
    ($v:expr, $half:ident => $instruction:expr) => {{
        let [$half, second] = $v.0;
        let first = $instruction;
        let $half = second;
        D8([first, $instruction], $v.1)
    }};
    ($v:expr, $o:expr, $half:ident, $other:ident => $instruction:expr) => {{
        let ([$half, second], [$other, second_other]) = ($v.0, $o.0);
        let first = $instruction;
        let ($half, $other) = (second, second_other);
        D8([first, $instruction], $v.1)
    }};
}

impl Eight for D8 {
    type Token = Avx2;
    type Mask = Self;

    #[inline(always)]
    fn splat(t: Avx2, v: f64) -> Self {
        Self([t._mm256_set1_pd(v); 2], t)
    }

    #[inline(always)]
    fn new(t: Avx2, v: &[f64; LANES]) -> Self {
        let (halves, _) = v.as_chunks::<4>();
        Self([t._mm256_loadu_pd(&halves[0]), t._mm256_loadu_pd(&halves[1])], t)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        let mut out = [0.0; LANES];
        let (halves, _) = out.as_chunks_mut::<4>();
        for (half, v) in halves.iter_mut().zip(self.0) {
            self.1._mm256_storeu_pd(half, v);
        }
        out
    }

    #[inline(always)]
    fn narrowed(self) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        let (halves, _) = out.as_chunks_mut::<4>();
        for (half, v) in halves.iter_mut().zip(self.0) {
            self.1._mm_storeu_ps(half, self.1._mm256_cvtpd_ps(v));
        }
        out
    }

    #[inline(always)]
    fn gathered<const N: usize>(token: Avx2, table: &[f64; N], at: &[u32; LANES]) -> Self {
        Self::new(token, &at.map(|i| table[i as usize % N]))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        halves!(self, v => self.1._mm256_andnot_pd(self.1._mm256_set1_pd(-0.0), v))
    }

    #[inline(always)]
    fn negated(self) -> Self {
        halves!(self, v => self.1._mm256_xor_pd(self.1._mm256_set1_pd(-0.0), v))
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        halves!(self, o, v, w => self.1._mm256_max_pd(v, w))
    }

    #[inline(always)]
    fn below(self, o: Self) -> Self {
        halves!(self, o, v, w => self.1._mm256_cmp_pd::<_CMP_LT_OQ>(v, w))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> Self {
        halves!(self, o, v, w => self.1._mm256_cmp_pd::<_CMP_LE_OQ>(v, w))
    }

    #[inline(always)]
    fn or_else(self, mask: Self, o: Self) -> Self {
        let blend = |i: usize| self.1._mm256_blendv_pd(o.0[i], self.0[i], mask.0[i]);
        Self([blend(0), blend(1)], self.1)
    }

    #[inline(always)]
    fn exponents(self) -> Self {
        let t = self.1;
        halves!(self, v => t._mm256_and_pd(v, t._mm256_castsi256_pd(t._mm256_set1_epi64x(EXPONENT as i64))))
    }

    #[inline(always)]
    fn inverse_powers(self) -> Self {
        let t = self.1;
        halves!(self, v => {
            t._mm256_castsi256_pd(t._mm256_sub_epi64(t._mm256_set1_epi64x(TURN as i64), t._mm256_castpd_si256(v)))
        })
    }

    #[inline(always)]
    fn bits(mask: Self) -> u8 {
        (mask.1._mm256_movemask_pd(mask.0[0]) | mask.1._mm256_movemask_pd(mask.0[1]) << 4) as u8
    }
}
