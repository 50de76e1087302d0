//! Eight floats, four floats and four numbers of AVX2.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::avx2::Avx2;
use super::vector::Vector;
use crate::frame::Lanes4;
use crate::query::Four;
use std::arch::x86_64::*;

/// Eight floats. Its operations, and whatever else here uses vector instructions, are inlined by force into functions that
/// are compiled for AVX2. They exist for a token alone, which [`Filters`] hands on.
#[derive(Clone, Copy)]
pub(super) struct F8(pub(super) __m256);

macro_rules! operator {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl std::ops::$trait for F8 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                // SAFETY: arithmetic of AVX, whose presence is proved where an `F8` comes from.
                Self(unsafe { $instruction(self.0, o.0) })
            }
        }
    };
}
operator!(Add, add, _mm256_add_ps);
operator!(Sub, sub, _mm256_sub_ps);
operator!(Mul, mul, _mm256_mul_ps);
operator!(Div, div, _mm256_div_ps);

impl F8 {
    /// Into a row from `at` on, a multiple of eight.
    #[inline(always)]
    pub(super) fn store<const W: usize>(self, row: &mut [f32; W], at: usize) {
        let half = &mut row.as_chunks_mut::<8>().0[at / 8 % (W / 8)];
        // SAFETY: as for the operators; eight floats are writable at the reference, aligned or not.
        unsafe { _mm256_storeu_ps(half.as_mut_ptr(), self.0) };
    }

    /// The larger of each pair of numbers as integers, in a cycle instead of four: numbers that are not negative are ordered as
    /// they are, one that is negative is below them all.
    #[inline(always)]
    pub(super) fn max_bits(self, o: Self) -> Self {
        // SAFETY: as for the operators; where an `F8` comes from AVX2 is proved too.
        Self(unsafe { _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(self.0), _mm256_castps_si256(o.0))) })
    }

    /// The smaller of each pair, likewise.
    #[inline(always)]
    pub(super) fn min_bits(self, o: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(self.0), _mm256_castps_si256(o.0))) })
    }

    /// The lanes that are not above, likewise, one bit each.
    #[inline(always)]
    pub(super) fn at_most_bits(self, o: Self) -> u32 {
        // SAFETY: as above.
        let above = unsafe { _mm256_cmpgt_epi32(_mm256_castps_si256(self.0), _mm256_castps_si256(o.0)) };
        // SAFETY: as above.
        Self::mask(unsafe { _mm256_castsi256_ps(above) }) ^ 0xFF
    }

    #[inline(always)]
    fn mask(v: __m256) -> u32 {
        // SAFETY: as for the operators.
        (unsafe { _mm256_movemask_ps(v) }) as u32
    }
}

impl Vector for F8 {
    type Token = Avx2;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(_: Avx2, v: f32) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_set1_ps(v) })
    }

    #[inline(always)]
    fn load<const W: usize>(_: Avx2, row: &[f32; W], at: usize) -> Self {
        let half = &row.as_chunks::<8>().0[at / 8 % (W / 8)];
        // SAFETY: the token proves AVX2; eight floats are readable at the reference, aligned or not.
        Self(unsafe { _mm256_loadu_ps(half.as_ptr()) })
    }

    #[inline(always)]
    fn lanes_with<const W: usize>(_: Avx2, row: &[u32; W], at: usize, v: u32) -> u32 {
        let half = &row.as_chunks::<8>().0[at / 8 % (W / 8)];
        // SAFETY: the token proves AVX2; eight numbers are readable at the reference, aligned or not.
        let same = unsafe { _mm256_cmpeq_epi32(_mm256_loadu_si256(half.as_ptr().cast()), _mm256_set1_epi32(v as i32)) };
        // SAFETY: as above.
        Self::mask(unsafe { _mm256_castsi256_ps(same) })
    }

    #[inline(always)]
    fn to_row<const W: usize>(self, at: usize) -> [f32; W] {
        let mut row = [0.0; W];
        self.store(&mut row, at);
        row
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_min_ps(self.0, o.0) })
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_max_ps(self.0, o.0) })
    }

    #[inline(always)]
    fn only(self, lanes: u32) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe {
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let chosen = _mm256_and_si256(_mm256_set1_epi32(lanes as i32), bits);
            _mm256_and_ps(self.0, _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, bits)))
        })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn below(self, o: Self) -> u32 {
        // SAFETY: as for the operators.
        Self::mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, o.0) })
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> u32 {
        // SAFETY: as for the operators.
        Self::mask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, o.0) })
    }
}

/// Four numbers, likewise.
#[derive(Clone, Copy)]
pub(super) struct D4(__m256d);

macro_rules! operator4 {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl std::ops::$trait for D4 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                // SAFETY: arithmetic of AVX, whose presence is proved where a `D4` comes from.
                Self(unsafe { $instruction(self.0, o.0) })
            }
        }
    };
}
operator4!(Add, add, _mm256_add_pd);
operator4!(Sub, sub, _mm256_sub_pd);
operator4!(Mul, mul, _mm256_mul_pd);

impl Four for D4 {
    type Token = Avx2;
    type Narrow = F4;

    #[inline(always)]
    fn splat(_: Avx2, v: f64) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_set1_pd(v) })
    }

    #[inline(always)]
    fn new(_: Avx2, v: [f64; 4]) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_setr_pd(v[0], v[1], v[2], v[3]) })
    }

    #[inline(always)]
    fn widened(token: Avx2, v: [f32; 4]) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_cvtps_pd(F4::new(token, v).0) })
    }

    #[inline(always)]
    fn narrowed(self) -> F4 {
        // SAFETY: as for the operators.
        F4(unsafe { _mm256_cvtpd_ps(self.0) })
    }

    #[inline(always)]
    fn differs(self, o: F4) -> F4 {
        // SAFETY: as for the operators.
        F4(unsafe {
            let differs = _mm256_cmp_pd::<_CMP_NEQ_UQ>(_mm256_cvtps_pd(o.0), self.0);
            _mm256_cvtpd_ps(_mm256_and_pd(differs, _mm256_set1_pd(1.0)))
        })
    }

    #[inline(always)]
    fn signs(self) -> [u32; 2] {
        // SAFETY: as for the operators.
        unsafe {
            // Without a closure, which would be called, and be compiled without AVX.
            let zero = _mm256_setzero_pd();
            let below = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, zero));
            let above = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(self.0, zero));
            [below as u32, above as u32]
        }
    }

    #[inline(always)]
    fn all_at_most(self, limit: f64) -> bool {
        // SAFETY: as for the operators.
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, _mm256_set1_pd(limit))) == 0b1111 }
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        let mut out = [0.0; 4];
        // SAFETY: as for the operators; four numbers are writable at the reference, aligned or not.
        unsafe { _mm256_storeu_pd(out.as_mut_ptr(), self.0) };
        out
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_max_pd(self.0, o.0) })
    }

    #[inline(always)]
    fn turned(self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_permute4x64_pd::<0b01_01_00_10>(self.0) })
    }

    #[inline(always)]
    fn next(self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_permute4x64_pd::<0b00_11_10_01>(self.0) })
    }

    #[inline(always)]
    fn along(self, axis: usize) -> Self {
        // By halves: no instruction of AVX2 moves whole numbers to where other numbers tell.
        const ORDERS: [[i32; 8]; 4] =
            [[2, 3, 4, 5, 0, 1, 6, 7], [4, 5, 0, 1, 2, 3, 6, 7], [0, 1, 2, 3, 4, 5, 6, 7], [0, 1, 2, 3, 4, 5, 6, 7]];
        let order = &ORDERS[axis % ORDERS.len()];
        // SAFETY: as for the operators; eight integers are readable at the reference, aligned or not.
        unsafe {
            let order = _mm256_loadu_si256(order.as_ptr().cast());
            Self(_mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(self.0), order)))
        }
    }
}

/// Four floats, likewise.
#[derive(Clone, Copy)]
pub(super) struct F4(pub(super) __m128);

/// An instruction on an `F4`.
macro_rules! sse {
    ($instruction:expr) => {{
        // SAFETY: SSE is part of x86-64; where an `F4` comes from AVX2 is proved.
        unsafe { $instruction }
    }};
}

impl F4 {
    #[inline(always)]
    fn splat(v: f32) -> __m128 {
        sse!(_mm_set1_ps(v))
    }
}

impl Lanes4 for F4 {
    type Token = Avx2;

    #[inline(always)]
    fn new(_: Avx2, [a, b, c, d]: [f32; 4]) -> Self {
        Self(sse!(_mm_setr_ps(a, b, c, d)))
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 4] {
        let mut out = [0.0; 4];
        // SAFETY: four floats are writable at the reference, aligned or not.
        unsafe { _mm_storeu_ps(out.as_mut_ptr(), self.0) };
        out
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(sse!(_mm_andnot_ps(Self::splat(-0.0), self.0)))
    }

    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        Self(sse!(_mm_add_ps(self.0, o.0)))
    }

    #[inline(always)]
    fn difference(self, o: Self) -> Self {
        Self(sse!(_mm_sub_ps(self.0, o.0)))
    }

    #[inline(always)]
    fn product(self, o: Self) -> Self {
        Self(sse!(_mm_mul_ps(self.0, o.0)))
    }

    #[inline(always)]
    fn times(self, factor: f32) -> Self {
        Self(sse!(_mm_mul_ps(self.0, Self::splat(factor))))
    }

    #[inline(always)]
    fn plus(self, v: f32) -> Self {
        Self(sse!(_mm_add_ps(self.0, Self::splat(v))))
    }

    #[inline(always)]
    fn at_least(self, v: f32) -> Self {
        Self(sse!(_mm_max_ps(self.0, Self::splat(v))))
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self(sse!(_mm_div_ps(Self::splat(1.0), self.0)))
    }

    #[inline(always)]
    fn signed_as(self, o: Self) -> Self {
        Self(sse!(_mm_or_ps(self.0, _mm_and_ps(Self::splat(-0.0), o.0))))
    }

    #[inline(always)]
    fn all_at_most(self, limit: f32) -> bool {
        sse!(_mm_movemask_ps(_mm_cmple_ps(self.0, Self::splat(limit)))) == 0b1111
    }

    #[inline(always)]
    fn negative(self) -> usize {
        sse!(_mm_movemask_ps(self.0)) as usize & 0b111
    }

    #[inline(always)]
    fn turned(self, axis: usize) -> Self {
        const ORDERS: [[i32; 4]; 4] = [[1, 2, 0, 3], [2, 0, 1, 3], [0, 1, 2, 3], [0, 1, 2, 3]];
        let order = &ORDERS[axis % ORDERS.len()];
        // SAFETY: as for the other operations; four integers are readable at the reference, aligned or not.
        Self(unsafe { _mm_permutevar_ps(self.0, _mm_loadu_si128(order.as_ptr().cast())) })
    }
}
