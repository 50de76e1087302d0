//! Sixteen floats of AVX-512.

use super::vector::Vector;
use etalon_simd::Avx512;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

/// Sixteen floats. They exist for a token alone.
#[derive(Clone, Copy)]
pub(super) struct F16(pub(super) __m512, pub(super) Avx512);

macro_rules! operator {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl $trait for F16 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(self.1.$instruction(self.0, o.0), self.1)
            }
        }
    };
}
operator!(Add, add, _mm512_add_ps);
operator!(Sub, sub, _mm512_sub_ps);
operator!(Mul, mul, _mm512_mul_ps);
operator!(Div, div, _mm512_div_ps);

impl Vector for F16 {
    type Token = Avx512;
    const WIDTH: usize = 16;

    #[inline(always)]
    fn splat(t: Avx512, v: f32) -> Self {
        Self(t._mm512_set1_ps(v), t)
    }

    #[inline(always)]
    fn load<const W: usize>(t: Avx512, row: &[f32; W], at: usize) -> Self {
        let whole = &row.as_chunks::<16>().0[at / 16 % (W / 16)];
        Self(t._mm512_loadu_ps(whole), t)
    }

    #[inline(always)]
    fn lanes_with<const W: usize>(t: Avx512, row: &[u32; W], at: usize, v: u32) -> u32 {
        let whole = &row.as_chunks::<16>().0[at / 16 % (W / 16)];
        u32::from(t._mm512_cmpeq_epi32_mask(t._mm512_loadu_si512(whole), t._mm512_set1_epi32(v as i32)))
    }

    #[inline(always)]
    fn to_row<const W: usize>(self, at: usize) -> [f32; W] {
        let mut row = [0.0; W];
        let whole = &mut row.as_chunks_mut::<16>().0[at / 16 % (W / 16)];
        self.1._mm512_storeu_ps(whole, self.0);
        row
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(self.1._mm512_min_ps(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(self.1._mm512_max_ps(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn only(self, lanes: u32) -> Self {
        Self(self.1._mm512_maskz_mov_ps(lanes as __mmask16, self.0), self.1)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.1._mm512_abs_ps(self.0), self.1)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.1._mm512_sqrt_ps(self.0), self.1)
    }

    #[inline(always)]
    fn below(self, o: Self) -> u32 {
        u32::from(self.1._mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> u32 {
        u32::from(self.1._mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, o.0))
    }
}
