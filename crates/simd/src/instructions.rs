//! Vector instructions as safe methods of the tokens, each under the name that it has in [`std::arch`].
//!
//! Those on values are listed by their types. The compiler checks each of them as safe code within a function that is compiled
//! for the set of the token, so that neither an instruction of another set nor one that takes a pointer can stand here.
//! Those on memory take references to arrays as large as a vector.
#![allow(unsafe_code)] // The doors to the instructions; each block says why it is sound.
#![allow(missing_docs)] // The names are those of `std::arch`, which documents them.
#![allow(clippy::too_many_arguments)] // Vectors of sixteen integers.

use crate::{Avx2, Avx512};
use std::arch::x86_64::*;

/// Instructions on values: `(parameters) -> type: names;`.
macro_rules! values {
    ($set:ident; $($parameters:tt -> $out:ty: $($name:ident $(<$constant:ident>)?)*;)*) => {
        impl $set {
            $($(values! { @ $set $name $($constant)? $parameters -> $out })*)*
        }
    };
    (@ $set:ident $name:ident $($constant:ident)? ($($x:ident: $t:ty),*) -> $out:ty) => {
        #[inline(always)]
        pub fn $name $(<const $constant: i32>)? (self, $($x: $t),*) -> $out {
            $crate::with_features! { $set => compiled {
                #[inline]
                fn safe $(<const $constant: i32>)? ($($x: $t),*) -> $out {
                    $name $(::<$constant>)? ($($x),*)
                }
            }}
            // SAFETY: the token proves that the processor has the features of the set; the function is safe otherwise.
            unsafe { safe $(::<$constant>)? ($($x),*) }
        }
    };
}

/// Instructions that read an array: `name: array -> vector;`.
macro_rules! loads {
    ($set:ident; $($name:ident: $array:ty => $vector:ty;)*) => {
        impl $set {$(
            #[inline(always)]
            pub fn $name(self, from: &$array) -> $vector {
                const { assert!(size_of::<$array>() == size_of::<$vector>()) };
                // SAFETY: the token proves that the processor has the instruction. It reads as many bytes as a vector has, which are
                // those of the array; their alignment does not matter, and any bits are numbers.
                unsafe { $name(std::ptr::from_ref(from).cast()) }
            }
        )*}
    };
}

/// Instructions that write an array: `name: array <- vector;`.
macro_rules! stores {
    ($set:ident; $($name:ident: $array:ty => $vector:ty;)*) => {
        impl $set {$(
            #[inline(always)]
            pub fn $name(self, to: &mut $array, v: $vector) {
                const { assert!(size_of::<$array>() == size_of::<$vector>()) };
                // SAFETY: the token proves that the processor has the instruction. It writes as many bytes as a vector has, which
                // are those of the array, borrowed mutably; their alignment does not matter, and any bits are numbers.
                unsafe { $name(std::ptr::from_mut(to).cast(), v) };
            }
        )*}
    };
}

values! { Avx2;
    (v: f32) -> __m128: _mm_set1_ps;
    (a: f32, b: f32, c: f32, d: f32) -> __m128: _mm_setr_ps;
    (a: __m128, b: __m128) -> __m128: _mm_add_ps _mm_sub_ps _mm_mul_ps _mm_div_ps _mm_min_ps _mm_max_ps _mm_min_ss;
    (a: __m128, b: __m128) -> __m128: _mm_and_ps _mm_andnot_ps _mm_or_ps _mm_cmple_ps _mm_movehl_ps;
    (v: __m128) -> __m128: _mm_movehdup_ps;
    (v: __m128, order: __m128i) -> __m128: _mm_permutevar_ps;
    (v: __m128) -> i32: _mm_movemask_ps;
    (v: __m128) -> f32: _mm_cvtss_f32;
    (v: __m128) -> __m256d: _mm256_cvtps_pd;
    (a: __m128i, b: __m128i) -> __m128i: _mm_unpacklo_epi32 _mm_unpackhi_epi32;
    (v: __m128i) -> i32: _mm_cvtsi128_si32;
    (v: __m128i) -> i64: _mm_cvtsi128_si64;
    (v: __m128i) -> i64: _mm_extract_epi64<AT>;

    (v: f32) -> __m256: _mm256_set1_ps;
    (a: __m256, b: __m256) -> __m256: _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_min_ps _mm256_max_ps;
    (a: __m256, b: __m256) -> __m256: _mm256_and_ps _mm256_andnot_ps _mm256_or_ps _mm256_xor_ps;
    (a: __m256, b: __m256, mask: __m256) -> __m256: _mm256_blendv_ps;
    (v: __m256) -> __m256: _mm256_sqrt_ps;
    (a: __m256, b: __m256) -> __m256: _mm256_cmp_ps<ORDER>;
    (v: __m256, order: __m256i) -> __m256: _mm256_permutevar8x32_ps;
    (v: __m256) -> i32: _mm256_movemask_ps;
    (v: __m256) -> __m128: _mm256_castps256_ps128;
    (v: __m256) -> __m128: _mm256_extractf128_ps<HALF>;
    (v: __m256) -> __m256i: _mm256_castps_si256;
    (v: __m256) -> __m256d: _mm256_castps_pd;

    () -> __m256d: _mm256_setzero_pd;
    (v: f64) -> __m256d: _mm256_set1_pd;
    (a: f64, b: f64, c: f64, d: f64) -> __m256d: _mm256_setr_pd;
    (a: __m256d, b: __m256d) -> __m256d: _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_max_pd;
    (a: __m256d, b: __m256d) -> __m256d: _mm256_and_pd _mm256_andnot_pd _mm256_or_pd _mm256_xor_pd;
    (a: __m256d, b: __m256d, mask: __m256d) -> __m256d: _mm256_blendv_pd;
    (a: __m256d, b: __m256d) -> __m256d: _mm256_cmp_pd<ORDER>;
    (v: __m256d) -> __m256d: _mm256_permute4x64_pd<ORDER>;
    (v: __m256d) -> i32: _mm256_movemask_pd;
    (v: __m256d) -> __m128: _mm256_cvtpd_ps;
    (v: __m256d) -> __m256: _mm256_castpd_ps;
    (v: __m256d) -> __m256i: _mm256_castpd_si256;

    (v: i32) -> __m256i: _mm256_set1_epi32;
    (v: i64) -> __m256i: _mm256_set1_epi64x;
    (a: i32, b: i32, c: i32, d: i32, e: i32, f: i32, g: i32, h: i32) -> __m256i: _mm256_setr_epi32;
    (a: __m256i, b: __m256i) -> __m256i: _mm256_and_si256 _mm256_sub_epi64 _mm256_min_epi32 _mm256_max_epi32;
    (a: __m256i, b: __m256i) -> __m256i: _mm256_cmpeq_epi32 _mm256_cmpgt_epi32;
    (v: __m256i) -> __m256: _mm256_castsi256_ps;
    (v: __m256i) -> __m256d: _mm256_castsi256_pd;
}

loads! { Avx2;
    _mm_loadu_si128: [u32; 4] => __m128i;
    _mm256_loadu_ps: [f32; 8] => __m256;
    _mm256_loadu_pd: [f64; 4] => __m256d;
    _mm256_loadu_si256: [u32; 8] => __m256i;
}

stores! { Avx2;
    _mm_storeu_ps: [f32; 4] => __m128;
    _mm256_storeu_ps: [f32; 8] => __m256;
    _mm256_storeu_pd: [f64; 4] => __m256d;
}

values! { Avx512;
    (v: f32) -> __m512: _mm512_set1_ps;
    (a: __m512, b: __m512) -> __m512: _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_min_ps _mm512_max_ps;
    (a: __m512, b: __m512) -> __m512: _mm512_and_ps _mm512_xor_ps;
    (v: __m512) -> __m512: _mm512_abs_ps _mm512_sqrt_ps;
    (mask: __mmask16, v: __m512) -> __m512: _mm512_maskz_mov_ps;
    (mask: __mmask16, a: __m512, b: __m512) -> __m512: _mm512_mask_blend_ps;
    (other: __m512, mask: __mmask16, a: __m512, b: __m512) -> __m512: _mm512_mask_min_ps;
    (a: __m512, b: __m512) -> __mmask16: _mm512_cmp_ps_mask<ORDER>;
    (mask: __mmask16, a: __m512, b: __m512) -> __mmask16: _mm512_mask_cmp_ps_mask<ORDER>;
    (order: __m512i, v: __m512) -> __m512: _mm512_permutexvar_ps;
    (v: __m512) -> f32: _mm512_reduce_min_ps;
    (v: __m512) -> __m512i: _mm512_castps_si512;
    (v: __m256) -> __m512: _mm512_castps256_ps512;

    (v: f64) -> __m512d: _mm512_set1_pd;
    (a: __m512d, b: __m512d) -> __m512d: _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_max_pd;
    (a: __m512d, b: __m512d) -> __m512d: _mm512_xor_pd;
    (v: __m512d) -> __m512d: _mm512_abs_pd;
    (mask: __mmask8, a: __m512d, b: __m512d) -> __m512d: _mm512_mask_blend_pd;
    (a: __m512d, b: __m512d) -> __mmask8: _mm512_cmp_pd_mask<ORDER>;
    (v: __m512d) -> __m256: _mm512_cvtpd_ps;
    (v: __m512d) -> __m512: _mm512_castpd_ps;
    (v: __m512d) -> __m512i: _mm512_castpd_si512;

    (v: i32) -> __m512i: _mm512_set1_epi32;
    (v: i64) -> __m512i: _mm512_set1_epi64;
    (a: i32, b: i32, c: i32, d: i32, e: i32, f: i32, g: i32, h: i32,
        i: i32, j: i32, k: i32, l: i32, m: i32, n: i32, o: i32, p: i32) -> __m512i: _mm512_setr_epi32;
    (a: __m512i, b: __m512i) -> __m512i: _mm512_and_si512 _mm512_sub_epi64 _mm512_min_epi32 _mm512_max_epi32;
    (a: __m512i, order: __m512i, b: __m512i) -> __m512i: _mm512_permutex2var_epi32;
    (mask: __mmask16, v: __m512i) -> __m512i: _mm512_maskz_compress_epi32;
    (a: __m512i, b: __m512i) -> __mmask16: _mm512_cmpeq_epi32_mask _mm512_cmple_epi32_mask;
    (v: __m512i) -> __m512d: _mm512_castsi512_pd;
    (v: __m512i) -> __m128i: _mm512_castsi512_si128;
}

loads! { Avx512;
    _mm512_loadu_ps: [f32; 16] => __m512;
    _mm512_loadu_pd: [f64; 8] => __m512d;
    _mm512_loadu_si512: [u32; 16] => __m512i;
}

stores! { Avx512;
    _mm512_storeu_ps: [f32; 16] => __m512;
    _mm512_storeu_pd: [f64; 8] => __m512d;
    _mm512_storeu_si512: [u64; 8] => __m512i;
}

impl Avx2 {
    /// Announces that an item will be read.
    #[inline(always)]
    pub fn prefetch<T>(self, item: &T) {
        let address = std::ptr::from_ref(item).cast::<i8>();
        // The first and the last byte, and one in each line between.
        let mut at = 0;
        while at < size_of::<T>() {
            // SAFETY: a hint, which reads nothing; the address is within the item.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(address.add(at)) };
            at += 64;
        }
        if align_of::<T>() < 64 {
            // SAFETY: as above.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(address.add(size_of::<T>().saturating_sub(1))) };
        }
    }
}
