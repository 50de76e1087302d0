//! Sixteen floats of AVX-512 as the filters of flat geometries want them.

use super::lanes512::F16;
use super::vector::Vector;
use crate::LANES;
use crate::small_scene::{BLOCK, EXPONENT, Eight, TURN, Wide};
use etalon_simd::Avx512;
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

/// Sixteen truths, a bit each.
#[derive(Clone, Copy)]
pub(super) struct M16(__mmask16);

impl BitAnd for M16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(self.0 & o.0)
    }
}

impl BitOr for M16 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(self.0 | o.0)
    }
}

impl Not for M16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Wide for F16 {
    type Token = Avx512;
    type Mask = M16;
    const WIDTH: usize = 16;

    #[inline(always)]
    fn splat(token: Avx512, v: f32) -> Self {
        Vector::splat(token, v)
    }

    #[inline(always)]
    fn load(token: Avx512, row: &[f32; BLOCK], at: usize) -> Self {
        Vector::load(token, row, at)
    }

    #[inline(always)]
    fn shared(t: Avx512, row: &[f32; BLOCK], at: usize) -> Self {
        let (pairs, _) = row.as_chunks::<2>();
        let [a, b] = pairs[at / 2 % LANES];
        let both = f64::from_bits(u64::from(b.to_bits()) << 32 | u64::from(a.to_bits()));
        Self(t._mm512_castpd_ps(t._mm512_set1_pd(both)), t)
    }

    #[inline(always)]
    fn rays(t: Avx512, v: &[f32; LANES]) -> Self {
        let eight = t.avx2()._mm256_loadu_ps(v);
        let twice = t._mm512_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
        Self(t._mm512_permutexvar_ps(twice, t._mm512_castps256_ps512(eight)), t)
    }

    #[inline(always)]
    fn store(self, row: &mut [f32; BLOCK]) {
        self.1._mm512_storeu_ps(row, self.0);
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
        self.1._mm512_reduce_min_ps(self.0)
    }

    #[inline(always)]
    fn flipped(self, sign: Self) -> Self {
        let t = self.1;
        Self(t._mm512_xor_ps(self.0, t._mm512_and_ps(sign.0, t._mm512_set1_ps(-0.0))), t)
    }

    #[inline(always)]
    fn below(self, o: Self) -> M16 {
        M16(self.1._mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> M16 {
        M16(self.1._mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn equals(self, o: Self) -> M16 {
        M16(self.1._mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn differs(self, o: Self) -> M16 {
        M16(self.1._mm512_cmp_ps_mask::<_CMP_NEQ_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn below_where(self, mask: M16, o: Self) -> M16 {
        M16(self.1._mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(mask.0, self.0, o.0))
    }

    #[inline(always)]
    fn at_most_where(self, mask: M16, o: Self) -> M16 {
        M16(self.1._mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(mask.0, self.0, o.0))
    }

    #[inline(always)]
    fn min_where(self, mask: M16, o: Self) -> Self {
        Self(self.1._mm512_mask_min_ps(self.0, mask.0, self.0, o.0), self.1)
    }

    #[inline(always)]
    fn shares(self) -> [[f32; LANES]; 2] {
        let t = self.1;
        let mut out = [0.0; 2 * LANES];
        let turn = t._mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 1, 3, 5, 7, 9, 11, 13, 15);
        t._mm512_storeu_ps(&mut out, t._mm512_permutexvar_ps(turn, self.0));
        let (halves, _) = out.as_chunks();
        [halves[0], halves[1]]
    }

    #[inline(always)]
    fn or_else(self, mask: M16, other: Self) -> Self {
        Self(self.1._mm512_mask_blend_ps(mask.0, other.0, self.0), self.1)
    }

    #[inline(always)]
    fn bits(mask: M16) -> u32 {
        u32::from(mask.0)
    }
}

/// Eight numbers. They exist for a token alone.
#[derive(Clone, Copy)]
pub(super) struct D8(__m512d, Avx512);

/// Eight truths, a bit each.
#[derive(Clone, Copy)]
pub(super) struct Q8(__mmask8);

macro_rules! operator8 {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl $trait for D8 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(self.1.$instruction(self.0, o.0), self.1)
            }
        }
    };
}
operator8!(Add, add, _mm512_add_pd);
operator8!(Sub, sub, _mm512_sub_pd);
operator8!(Mul, mul, _mm512_mul_pd);
operator8!(Div, div, _mm512_div_pd);

impl BitAnd for Q8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(self.0 & o.0)
    }
}

impl BitOr for Q8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(self.0 | o.0)
    }
}

impl D8 {
    #[inline(always)]
    fn bits_of(self) -> __m512i {
        self.1._mm512_castpd_si512(self.0)
    }

    #[inline(always)]
    fn of_bits(t: Avx512, bits: __m512i) -> Self {
        Self(t._mm512_castsi512_pd(bits), t)
    }
}

impl Eight for D8 {
    type Token = Avx512;
    type Mask = Q8;

    #[inline(always)]
    fn splat(t: Avx512, v: f64) -> Self {
        Self(t._mm512_set1_pd(v), t)
    }

    #[inline(always)]
    fn new(t: Avx512, v: &[f64; LANES]) -> Self {
        Self(t._mm512_loadu_pd(v), t)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        let mut out = [0.0; LANES];
        self.1._mm512_storeu_pd(&mut out, self.0);
        out
    }

    #[inline(always)]
    fn narrowed(self) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        self.1.avx2()._mm256_storeu_ps(&mut out, self.1._mm512_cvtpd_ps(self.0));
        out
    }

    #[inline(always)]
    fn gathered<const N: usize>(token: Avx512, table: &[f64; N], at: &[u32; LANES]) -> Self {
        // Not by the instruction for it, which takes more than twice as long on processors of our day.
        Self::new(token, &at.map(|i| table[i as usize % N]))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.1._mm512_abs_pd(self.0), self.1)
    }

    #[inline(always)]
    fn negated(self) -> Self {
        let t = self.1;
        Self(t._mm512_xor_pd(self.0, t._mm512_set1_pd(-0.0)), t)
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(self.1._mm512_max_pd(self.0, o.0), self.1)
    }

    #[inline(always)]
    fn below(self, o: Self) -> Q8 {
        Q8(self.1._mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> Q8 {
        Q8(self.1._mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, o.0))
    }

    #[inline(always)]
    fn or_else(self, mask: Q8, o: Self) -> Self {
        Self(self.1._mm512_mask_blend_pd(mask.0, o.0, self.0), self.1)
    }

    #[inline(always)]
    fn exponents(self) -> Self {
        let t = self.1;
        Self::of_bits(t, t._mm512_and_si512(self.bits_of(), t._mm512_set1_epi64(EXPONENT as i64)))
    }

    #[inline(always)]
    fn inverse_powers(self) -> Self {
        let t = self.1;
        Self::of_bits(t, t._mm512_sub_epi64(t._mm512_set1_epi64(TURN as i64), self.bits_of()))
    }

    #[inline(always)]
    fn bits(mask: Q8) -> u8 {
        mask.0
    }
}
