//! Eight floats of AVX2 as the filters of flat geometries want them.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::avx2::{Avx2, F8};
use super::flat::{BLOCK, Wide};
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
        let (halves, _) = row.as_chunks::<8>();
        Vector::load(token, &halves[at / 8 % 2])
    }

    #[inline(always)]
    fn shared(token: Avx2, row: &[f32; BLOCK], at: usize) -> Self {
        Vector::splat(token, row[at % BLOCK])
    }

    #[inline(always)]
    fn rays(token: Avx2, v: &[f32; LANES]) -> Self {
        Vector::load(token, v)
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
    fn abs(self) -> Self {
        Vector::abs(self)
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
    fn or_else(self, mask: M8, other: Self) -> Self {
        Self(avx!(_mm256_blendv_ps(other.0, self.0, mask.0)))
    }

    #[inline(always)]
    fn bits(mask: M8) -> u32 {
        avx!(_mm256_movemask_ps(mask.0)) as u32
    }
}
