//! Sixteen floats of AVX-512.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::avx512::Avx512;
use super::vector::Vector;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

/// Sixteen floats. They exist for a token alone.
#[derive(Clone, Copy)]
pub(super) struct F16(pub(super) __m512);

/// An instruction on an [`F16`], or on what is made of one.
macro_rules! avx512 {
    ($instruction:expr) => {{
        // SAFETY: an instruction of AVX-512 (F, DQ), whose presence is proved where an `F16` comes from; what it reads or writes is
        // within the array named, whose length its type tells.
        unsafe { $instruction }
    }};
}
pub(super) use avx512;

macro_rules! operator {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl $trait for F16 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(avx512!($instruction(self.0, o.0)))
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
    fn splat(_: Avx512, v: f32) -> Self {
        Self(avx512!(_mm512_set1_ps(v)))
    }

    #[inline(always)]
    fn load<const W: usize>(_: Avx512, row: &[f32; W], at: usize) -> Self {
        let whole = &row.as_chunks::<16>().0[at / 16 % (W / 16)];
        Self(avx512!(_mm512_loadu_ps(whole.as_ptr())))
    }

    #[inline(always)]
    fn lanes_with<const W: usize>(_: Avx512, row: &[u32; W], at: usize, v: u32) -> u32 {
        let whole = &row.as_chunks::<16>().0[at / 16 % (W / 16)];
        u32::from(avx512!(_mm512_cmpeq_epi32_mask(
            _mm512_loadu_si512(whole.as_ptr().cast()),
            _mm512_set1_epi32(v as i32)
        )))
    }

    #[inline(always)]
    fn to_row<const W: usize>(self, at: usize) -> [f32; W] {
        let mut row = [0.0; W];
        let whole = &mut row.as_chunks_mut::<16>().0[at / 16 % (W / 16)];
        avx512!(_mm512_storeu_ps(whole.as_mut_ptr(), self.0));
        row
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(avx512!(_mm512_min_ps(self.0, o.0)))
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(avx512!(_mm512_max_ps(self.0, o.0)))
    }

    #[inline(always)]
    fn only(self, lanes: u32) -> Self {
        Self(avx512!(_mm512_maskz_mov_ps(lanes as __mmask16, self.0)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(avx512!(_mm512_abs_ps(self.0)))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(avx512!(_mm512_sqrt_ps(self.0)))
    }

    #[inline(always)]
    fn below(self, o: Self) -> u32 {
        u32::from(avx512!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, o.0)))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> u32 {
        u32::from(avx512!(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, o.0)))
    }
}
