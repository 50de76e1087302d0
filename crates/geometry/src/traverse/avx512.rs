//! The filters in AVX-512: all children of a node at once.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::avx2::{Avx2, prefetch};
use super::compiled::{Compiled, compiled};
use super::lanes256::{D4, F4};
use super::lanes512::F16;
use super::met::{Met, Row};
use super::wide512::D8;
use super::within::{closest_within, occludes_within};
use super::{Filters, Job, Start, any_far_with, any_with, closest_far_with, closest_with};
use crate::Primitive;
use crate::best::Best;
use crate::frame::{BoxRay, LEAST_DISTANCE, Lanes4};
use crate::portal::Portal;
use crate::query::Query;
use crate::wide::{NODE_WIDTH, Node16, WideTree};
use std::arch::x86_64::*;

/// Proof that the processor has AVX-512 (F, VL and DQ), and AVX2: [`Avx512::detect`] alone makes one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(Avx2);

impl From<Avx512> for Avx2 {
    fn from(token: Avx512) -> Self {
        token.0
    }
}

impl Avx512 {
    #[inline(always)]
    pub(super) fn detect() -> Option<Self> {
        let present = std::arch::is_x86_feature_detected!("avx512f")
            && std::arch::is_x86_feature_detected!("avx512vl")
            && std::arch::is_x86_feature_detected!("avx512dq");
        Avx2::detect().filter(|_| present).map(Self)
    }
}

compiled!(Avx512, "avx512f,avx512vl,avx512dq,avx2,bmi1");

/// A ray broadcast to all lanes.
#[derive(Clone, Copy)]
pub(super) struct Ray16 {
    origin_near: [__m512; 3],
    origin_far: [__m512; 3],
    reciprocal_near: [__m512; 3],
    reciprocal_far: [__m512; 3],
    /// [`BoxRay::entry`].
    entry: [usize; 3],
}

/// [`Met`] in registers: what is met is moved to the front of a vector, which takes half as long as to store distances and to load
/// those of the children that a mask tells.
#[derive(Clone, Copy)]
pub(super) struct Met16 {
    mask: __mmask16,
    /// The bits of all children's distances.
    near: __m512i,
}

impl Met16 {
    /// The children met, and their distances.
    #[inline(always)]
    fn front(&self, node: &Node16) -> [__m512i; 2] {
        // SAFETY: what is entered has been computed with AVX-512; sixteen numbers are readable at the reference.
        unsafe {
            let children = _mm512_loadu_si512(node.children.0.as_ptr().cast());
            [_mm512_maskz_compress_epi32(self.mask, children), _mm512_maskz_compress_epi32(self.mask, self.near)]
        }
    }
}

impl Met for Met16 {
    #[inline(always)]
    fn mask(&self) -> u32 {
        u32::from(self.mask)
    }

    #[inline(always)]
    fn first(&self, node: &Node16) -> u32 {
        // SAFETY: as above.
        (unsafe { _mm_cvtsi128_si32(_mm512_castsi512_si128(self.front(node)[0])) }) as u32
    }

    #[inline(always)]
    fn pair<const SECOND: bool>(&self, node: &Node16) -> [u64; 2] {
        // SAFETY: as above.
        unsafe {
            let [children, near] = self.front(node);
            let (children, near) = (_mm512_castsi512_si128(children), _mm512_castsi512_si128(near));
            let pair = if SECOND { _mm_unpackhi_epi32(children, near) } else { _mm_unpacklo_epi32(children, near) };
            [_mm_cvtsi128_si64(pair) as u64, _mm_extract_epi64::<1>(pair) as u64]
        }
    }

    #[inline(always)]
    fn all(&self, node: &Node16) -> Row<u64, NODE_WIDTH> {
        let mut out = Row([0; NODE_WIDTH]);
        let [children, near] = self.front(node);
        // SAFETY: as above; eight numbers are writable at each half of the array.
        unsafe {
            let lower = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            let upper = _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
            let (halves, _) = out.0.as_chunks_mut::<8>();
            _mm512_storeu_si512(halves[0].as_mut_ptr().cast(), _mm512_permutex2var_epi32(children, lower, near));
            _mm512_storeu_si512(halves[1].as_mut_ptr().cast(), _mm512_permutex2var_epi32(children, upper, near));
        }
        out
    }
}

/// Each of three numbers, in all lanes.
#[inline(always)]
fn broadcast(_: Avx512, v: F4) -> [__m512; 3] {
    let [x, y, z, _] = v.to_array();
    // SAFETY: the token proves AVX-512.
    unsafe { [_mm512_set1_ps(x), _mm512_set1_ps(y), _mm512_set1_ps(z)] }
}

impl Filters for Avx512 {
    type Ray = Ray16;
    type Met = Met16;
    type Vector = F16;
    type Wide = F16;
    type Eight = D8;
    type Four = D4;

    #[inline(always)]
    fn ray(self, ray: &BoxRay<F4>) -> Ray16 {
        Ray16 {
            origin_near: broadcast(self, ray.origin_near),
            origin_far: broadcast(self, ray.origin_far),
            reciprocal_near: broadcast(self, ray.reciprocal_near),
            reciprocal_far: broadcast(self, ray.reciprocal_far),
            entry: ray.entry(),
        }
    }

    #[inline(always)]
    fn enter(self, ray: &Ray16, node: &Node16, limit: f32) -> Met16 {
        // The children's numbers lie in a cache line of their own, which would be asked for only once the mask is known.
        prefetch(&node.children);
        // SAFETY: the token proves AVX-512; sixteen floats are readable at each row of planes, aligned or not.
        unsafe {
            let plane = |k: usize, from: usize| _mm512_loadu_ps(node.planes(k, from).as_ptr());
            let slab = |plane: __m512, origin: __m512, reciprocal: __m512| {
                _mm512_mul_ps(_mm512_sub_ps(origin, plane), reciprocal)
            };
            let near = |k: usize| slab(plane(k, ray.entry[k]), ray.origin_near[k], ray.reciprocal_near[k]);
            let far = |k: usize| slab(plane(k, ray.entry[k] ^ NODE_WIDTH), ray.origin_far[k], ray.reciprocal_far[k]);
            // As integers: numbers that are not negative are ordered as they are, one that is negative is below them all, and
            // one instruction takes a cycle instead of four.
            let (near, far) = (|k| _mm512_castps_si512(near(k)), |k| _mm512_castps_si512(far(k)));
            let least = _mm512_castps_si512(_mm512_set1_ps(LEAST_DISTANCE));
            let most = _mm512_castps_si512(_mm512_set1_ps(limit));
            let near = _mm512_max_epi32(_mm512_max_epi32(near(0), near(1)), _mm512_max_epi32(near(2), least));
            let far = _mm512_min_epi32(_mm512_min_epi32(far(0), far(1)), _mm512_min_epi32(far(2), most));
            Met16 { mask: _mm512_cmple_epi32_mask(near, far), near }
        }
    }

    #[inline(always)]
    fn prefetch<T>(self, item: &T) {
        prefetch(item);
    }
}
