//! Eight floats of AVX2 as the filters of flat geometries want them.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::avx2::Avx2;
use super::flat::{BLOCK, EXPONENT, Eight, TURN, Wide};
use super::lanes256::F8;
use super::vector::Vector;
use crate::LANES;
use std::arch::x86_64::*;
use std::ops::{BitAnd, BitOr, Not};

/// Eight truths, all bits of a number each.
#[derive(Clone, Copy)]
pub(super) struct M8(__m256);

/// An instruction on an [`F8`] or an [`M8`].
macro_rules! avx {
    ($instruction:expr) => {{
        // SAFETY: an instruction of AVX, whose presence is proved where an `F8` comes from; what it reads or writes is within the
        // array named, whose length its type tells.
        unsafe { $instruction }
    }};
}

impl BitAnd for M8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(avx!(_mm256_and_ps(self.0, o.0)))
    }
}

impl BitOr for M8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(avx!(_mm256_or_ps(self.0, o.0)))
    }
}

impl Not for M8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(avx!(_mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))))
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
    fn rays(_: Avx2, v: &[f32; LANES]) -> Self {
        Self(avx!(_mm256_loadu_ps(v.as_ptr())))
    }

    #[inline(always)]
    fn store(self, row: &mut [f32; BLOCK]) {
        avx!(_mm256_storeu_ps(row.as_mut_ptr(), self.0));
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
        avx!({
            let four = _mm_min_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        })
    }

    #[inline(always)]
    fn flipped(self, sign: Self) -> Self {
        Self(avx!(_mm256_xor_ps(self.0, _mm256_and_ps(sign.0, _mm256_set1_ps(-0.0)))))
    }

    #[inline(always)]
    fn below(self, o: Self) -> M8 {
        M8(avx!(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, o.0)))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> M8 {
        M8(avx!(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, o.0)))
    }

    #[inline(always)]
    fn equals(self, o: Self) -> M8 {
        M8(avx!(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, o.0)))
    }

    #[inline(always)]
    fn differs(self, o: Self) -> M8 {
        M8(avx!(_mm256_cmp_ps::<_CMP_NEQ_OQ>(self.0, o.0)))
    }

    #[inline(always)]
    fn shares(self) -> [[f32; LANES]; 2] {
        let mut out = [0.0; LANES];
        avx!(_mm256_storeu_ps(out.as_mut_ptr(), self.0));
        [out; 2]
    }

    #[inline(always)]
    fn or_else(self, mask: M8, other: Self) -> Self {
        Self(avx!(_mm256_blendv_ps(other.0, self.0, mask.0)))
    }

    #[inline(always)]
    fn bits(mask: M8) -> u32 {
        avx!(_mm256_movemask_ps(mask.0)) as u32
    }
}

/// Eight numbers in two halves.
#[derive(Clone, Copy)]
pub(super) struct D8([__m256d; 2]);

macro_rules! operator8 {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl std::ops::$trait for D8 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(avx!([$instruction(self.0[0], o.0[0]), $instruction(self.0[1], o.0[1])]))
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
        let first = avx!($instruction);
        let $half = second;
        D8([first, avx!($instruction)])
    }};
    ($v:expr, $o:expr, $half:ident, $other:ident => $instruction:expr) => {{
        let ([$half, second], [$other, second_other]) = ($v.0, $o.0);
        let first = avx!($instruction);
        let ($half, $other) = (second, second_other);
        D8([first, avx!($instruction)])
    }};
}

impl Eight for D8 {
    type Token = Avx2;
    type Mask = Self;

    #[inline(always)]
    fn splat(_: Avx2, v: f64) -> Self {
        Self([avx!(_mm256_set1_pd(v)); 2])
    }

    #[inline(always)]
    fn new(_: Avx2, v: &[f64; LANES]) -> Self {
        let (halves, _) = v.as_chunks::<4>();
        Self(avx!([_mm256_loadu_pd(halves[0].as_ptr()), _mm256_loadu_pd(halves[1].as_ptr())]))
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        let mut out = [0.0; LANES];
        let (halves, _) = out.as_chunks_mut::<4>();
        for (half, v) in halves.iter_mut().zip(self.0) {
            avx!(_mm256_storeu_pd(half.as_mut_ptr(), v));
        }
        out
    }

    #[inline(always)]
    fn narrowed(self) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        let (halves, _) = out.as_chunks_mut::<4>();
        for (half, v) in halves.iter_mut().zip(self.0) {
            avx!(_mm_storeu_ps(half.as_mut_ptr(), _mm256_cvtpd_ps(v)));
        }
        out
    }

    #[inline(always)]
    fn gathered<const N: usize>(token: Avx2, table: &[f64; N], at: &[u32; LANES]) -> Self {
        Self::new(token, &at.map(|i| table[i as usize % N]))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        halves!(self, v => _mm256_andnot_pd(_mm256_set1_pd(-0.0), v))
    }

    #[inline(always)]
    fn negated(self) -> Self {
        halves!(self, v => _mm256_xor_pd(_mm256_set1_pd(-0.0), v))
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        halves!(self, o, v, w => _mm256_max_pd(v, w))
    }

    #[inline(always)]
    fn below(self, o: Self) -> Self {
        halves!(self, o, v, w => _mm256_cmp_pd::<_CMP_LT_OQ>(v, w))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> Self {
        halves!(self, o, v, w => _mm256_cmp_pd::<_CMP_LE_OQ>(v, w))
    }

    #[inline(always)]
    fn or_else(self, mask: Self, o: Self) -> Self {
        let blend = |i: usize| avx!(_mm256_blendv_pd(o.0[i], self.0[i], mask.0[i]));
        Self([blend(0), blend(1)])
    }

    #[inline(always)]
    fn exponents(self) -> Self {
        halves!(self, v => _mm256_and_pd(v, _mm256_castsi256_pd(_mm256_set1_epi64x(EXPONENT as i64))))
    }

    #[inline(always)]
    fn inverse_powers(self) -> Self {
        halves!(self, v => {
            _mm256_castsi256_pd(_mm256_sub_epi64(_mm256_set1_epi64x(TURN as i64), _mm256_castpd_si256(v)))
        })
    }

    #[inline(always)]
    fn bits(mask: Self) -> u8 {
        avx!(_mm256_movemask_pd(mask.0[0]) | _mm256_movemask_pd(mask.0[1]) << 4) as u8
    }
}
