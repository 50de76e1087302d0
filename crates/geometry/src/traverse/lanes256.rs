//! Eight floats, four floats and four numbers of AVX2.

use super::vector::Vector;
use crate::vec4::{Four, Lanes4};
use etalon_simd::Avx2;
use std::arch::x86_64::*;

/// Eight floats. Its operations, and whatever else here uses vector instructions, are inlined by force into functions that
/// are compiled for AVX2. They exist for a token alone, which [`Filters`] hands on.
#[derive(Clone, Copy)]
pub(super) struct F8(pub(super) __m256, pub(super) Avx2);

macro_rules! operator {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl std::ops::$trait for F8 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(self.1.$instruction(self.0, o.0), self.1)
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
        self.1._mm256_storeu_ps(half, self.0);
    }

    /// The larger of each pair of numbers as integers, in a cycle instead of four: numbers that are not negative are ordered as
    /// they are, one that is negative is below them all.
    #[inline(always)]
    pub(super) fn max_bits(self, o: Self) -> Self {
        let t = self.1;
        Self(t._mm256_castsi256_ps(t._mm256_max_epi32(t._mm256_castps_si256(self.0), t._mm256_castps_si256(o.0))), t)
    }

    /// The smaller of each pair, likewise.
    #[inline(always)]
    pub(super) fn min_bits(self, o: Self) -> Self {
        let t = self.1;
        Self(t._mm256_castsi256_ps(t._mm256_min_epi32(t._mm256_castps_si256(self.0), t._mm256_castps_si256(o.0))), t)
    }

    /// The lanes that are not above, likewise, one bit each.
    #[inline(always)]
    pub(super) fn at_most_bits(self, o: Self) -> u32 {
        let t = self.1;
        let above = t._mm256_cmpgt_epi32(t._mm256_castps_si256(self.0), t._mm256_castps_si256(o.0));
        Self::mask(t, t._mm256_castsi256_ps(above)) ^ 0xFF
    }

    #[inline(always)]
    fn mask(t: Avx2, v: __m256) -> u32 {
        t._mm256_movemask_ps(v) as u32
    }
}

impl Vector for F8 {
    type Token = Avx2;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(t: Avx2, v: f32) -> Self {
        Self(t._mm256_set1_ps(v), t)
    }

    #[inline(always)]
    fn load<const W: usize>(t: Avx2, row: &[f32; W], at: usize) -> Self {
        let half = &row.as_chunks::<8>().0[at / 8 % (W / 8)];
        Self(t._mm256_loadu_ps(half), t)
    }

    #[inline(always)]
    fn lanes_with<const W: usize>(t: Avx2, row: &[u32; W], at: usize, v: u32) -> u32 {
        let half = &row.as_chunks::<8>().0[at / 8 % (W / 8)];
        let same = t._mm256_cmpeq_epi32(t._mm256_loadu_si256(half), t._mm256_set1_epi32(v as i32));
        Self::mask(t, t._mm256_castsi256_ps(same))
    }

    #[inline(always)]
    fn to_row<const W: usize>(self, at: usize) -> [f32; W] {
        let mut row = [0.0; W];
        self.store(&mut row, at);
        row
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(self.1._mm256_min_ps(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(self.1._mm256_max_ps(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn only(self, lanes: u32) -> Self {
        let t = self.1;
        let bits = t._mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        let chosen = t._mm256_and_si256(t._mm256_set1_epi32(lanes as i32), bits);
        let mask = t._mm256_castsi256_ps(t._mm256_cmpeq_epi32(chosen, bits));
        Self(t._mm256_and_ps(self.0, mask), t)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let t = self.1;
        Self(t._mm256_andnot_ps(t._mm256_set1_ps(-0.0), self.0), t)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.1._mm256_sqrt_ps(self.0), self.1)
    }

    #[inline(always)]
    fn below(self, o: Self) -> u32 {
        Self::mask(self.1, self.1._mm256_cmp_ps::<_CMP_LT_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> u32 {
        Self::mask(self.1, self.1._mm256_cmp_ps::<_CMP_LE_OQ>(self.0, o.0))
    }
}

/// Four numbers, likewise.
#[derive(Clone, Copy)]
pub(super) struct D4(__m256d, Avx2);

macro_rules! operator4 {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl std::ops::$trait for D4 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(self.1.$instruction(self.0, o.0), self.1)
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
    fn splat(t: Avx2, v: f64) -> Self {
        Self(t._mm256_set1_pd(v), t)
    }

    #[inline(always)]
    fn new(t: Avx2, v: [f64; 4]) -> Self {
        Self(t._mm256_setr_pd(v[0], v[1], v[2], v[3]), t)
    }

    #[inline(always)]
    fn widened(token: Avx2, v: [f32; 4]) -> Self {
        Self(token._mm256_cvtps_pd(F4::new(token, v).0), token)
    }

    #[inline(always)]
    fn narrowed(self) -> F4 {
        F4(self.1._mm256_cvtpd_ps(self.0), self.1)
    }

    #[inline(always)]
    fn differs(self, o: F4) -> F4 {
        let t = self.1;
        let differs = t._mm256_cmp_pd::<_CMP_NEQ_UQ>(t._mm256_cvtps_pd(o.0), self.0);
        F4(t._mm256_cvtpd_ps(t._mm256_and_pd(differs, t._mm256_set1_pd(1.0))), t)
    }

    #[inline(always)]
    fn signs(self) -> [u32; 2] {
        let t = self.1;
        // Without a closure, which would be called, and be compiled without AVX.
        let zero = t._mm256_setzero_pd();
        let below = t._mm256_movemask_pd(t._mm256_cmp_pd::<_CMP_LT_OQ>(self.0, zero));
        let above = t._mm256_movemask_pd(t._mm256_cmp_pd::<_CMP_GT_OQ>(self.0, zero));
        [below as u32, above as u32]
    }

    #[inline(always)]
    fn all_at_most(self, limit: f64) -> bool {
        let t = self.1;
        t._mm256_movemask_pd(t._mm256_cmp_pd::<_CMP_LE_OQ>(self.0, t._mm256_set1_pd(limit))) == 0b1111
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        let mut out = [0.0; 4];
        self.1._mm256_storeu_pd(&mut out, self.0);
        out
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let t = self.1;
        Self(t._mm256_andnot_pd(t._mm256_set1_pd(-0.0), self.0), t)
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(self.1._mm256_max_pd(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn turned(self) -> Self {
        Self(self.1._mm256_permute4x64_pd::<0b01_01_00_10>(self.0), self.1)
    }

    #[inline(always)]
    fn next(self) -> Self {
        Self(self.1._mm256_permute4x64_pd::<0b00_11_10_01>(self.0), self.1)
    }

    #[inline(always)]
    fn along(self, axis: usize) -> Self {
        let t = self.1;
        // By halves: no instruction of AVX2 moves whole numbers to where other numbers tell.
        const ORDERS: [[u32; 8]; 4] =
            [[2, 3, 4, 5, 0, 1, 6, 7], [4, 5, 0, 1, 2, 3, 6, 7], [0, 1, 2, 3, 4, 5, 6, 7], [0, 1, 2, 3, 4, 5, 6, 7]];
        let order = &ORDERS[axis % ORDERS.len()];
        let order = t._mm256_loadu_si256(order);
        Self(t._mm256_castps_pd(t._mm256_permutevar8x32_ps(t._mm256_castpd_ps(self.0), order)), t)
    }
}

/// Four floats, likewise.
#[derive(Clone, Copy)]
pub(super) struct F4(__m128, Avx2);

impl F4 {
    /// The same in all lanes.
    #[inline(always)]
    fn all(self, v: f32) -> __m128 {
        self.1._mm_set1_ps(v)
    }
}

impl Lanes4 for F4 {
    type Token = Avx2;

    #[inline(always)]
    fn new(t: Avx2, [a, b, c, d]: [f32; 4]) -> Self {
        Self(t._mm_setr_ps(a, b, c, d), t)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 4] {
        let mut out = [0.0; 4];
        self.1._mm_storeu_ps(&mut out, self.0);
        out
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.1._mm_andnot_ps(self.all(-0.0), self.0), self.1)
    }

    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        Self(self.1._mm_add_ps(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn difference(self, o: Self) -> Self {
        Self(self.1._mm_sub_ps(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn product(self, o: Self) -> Self {
        Self(self.1._mm_mul_ps(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn times(self, factor: f32) -> Self {
        Self(self.1._mm_mul_ps(self.0, self.all(factor)), self.1)
    }

    #[inline(always)]
    fn plus(self, v: f32) -> Self {
        Self(self.1._mm_add_ps(self.0, self.all(v)), self.1)
    }

    #[inline(always)]
    fn at_least(self, v: f32) -> Self {
        Self(self.1._mm_max_ps(self.0, self.all(v)), self.1)
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self(self.1._mm_div_ps(self.all(1.0), self.0), self.1)
    }

    #[inline(always)]
    fn signed_as(self, o: Self) -> Self {
        let t = self.1;
        Self(t._mm_or_ps(self.0, t._mm_and_ps(self.all(-0.0), o.0)), t)
    }

    #[inline(always)]
    fn all_at_most(self, limit: f32) -> bool {
        self.1._mm_movemask_ps(self.1._mm_cmple_ps(self.0, self.all(limit))) == 0b1111
    }

    #[inline(always)]
    fn negative(self) -> usize {
        self.1._mm_movemask_ps(self.0) as usize & 0b111
    }

    #[inline(always)]
    fn turned(self, axis: usize) -> Self {
        let t = self.1;
        const ORDERS: [[u32; 4]; 4] = [[1, 2, 0, 3], [2, 0, 1, 3], [0, 1, 2, 3], [0, 1, 2, 3]];
        let order = &ORDERS[axis % ORDERS.len()];
        Self(t._mm_permutevar_ps(self.0, t._mm_loadu_si128(order)), t)
    }
}
