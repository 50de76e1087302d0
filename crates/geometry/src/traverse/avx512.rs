//! The filters in AVX-512: all children of a node at once.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::avx2::{Avx2, D4, F4, F8, prefetch};
use super::wide512::{D8, F16};
use super::{Entered, Filters, Job, Start, any_far_with, any_with, closest_far_with, closest_with};
use crate::Primitive;
use crate::best::Found;
use crate::frame::{BoxRay, LEAST_DISTANCE, Lanes4};
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

    #[inline(always)]
    pub(super) fn closest<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
        // SAFETY: `self` proves that the processor has AVX-512.
        unsafe { closest(self, tree, primitives, start) }
    }

    #[inline(always)]
    pub(super) fn any<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
        // SAFETY: `self` proves that the processor has AVX-512.
        unsafe { any(self, tree, primitives, start) }
    }

    #[inline(always)]
    pub(super) fn run<J: Job>(self, job: J) -> J::Output {
        // SAFETY: `self` proves that the processor has AVX-512.
        unsafe { run(self, job) }
    }
}

#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,bmi1")]
fn run<J: Job>(filters: Avx512, job: J) -> J::Output {
    job.run(filters)
}

#[target_feature(enable = "avx512f,avx512vl,avx2,bmi1")]
fn closest<S: Start>(filters: Avx512, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
    closest_with(filters, tree, primitives, start)
}

#[target_feature(enable = "avx512f,avx512vl,avx2,bmi1")]
fn any<S: Start>(filters: Avx512, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    any_with(filters, tree, primitives, start)
}

#[target_feature(enable = "avx512f,avx512vl,avx2,bmi1")]
fn closest_far<S: Start>(filters: Avx512, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
    closest_far_with(filters, tree, primitives, start)
}

#[target_feature(enable = "avx512f,avx512vl,avx2,bmi1")]
fn any_far<S: Start>(filters: Avx512, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
    any_far_with(filters, tree, primitives, start)
}

/// A ray broadcast to all lanes.
#[derive(Clone, Copy)]
pub(super) struct Ray16 {
    origin_near: [__m512; 3],
    origin_far: [__m512; 3],
    reciprocal_near: [__m512; 3],
    reciprocal_far: [__m512; 3],
    /// The planes where the ray enters, 0 or 1 for each axis.
    entry: [usize; 3],
}

impl Filters for Avx512 {
    type Ray = Ray16;
    type Vector = F8;
    type Wide = F16;
    type Eight = D8;
    type Four = D4;

    #[inline(always)]
    fn ray(self, ray: &BoxRay<F4>) -> Ray16 {
        let all = |v: F4| {
            let [x, y, z, _] = v.to_array();
            // SAFETY: the token proves AVX-512.
            unsafe { [_mm512_set1_ps(x), _mm512_set1_ps(y), _mm512_set1_ps(z)] }
        };
        Ray16 {
            origin_near: all(ray.origin_near),
            origin_far: all(ray.origin_far),
            reciprocal_near: all(ray.reciprocal_near),
            reciprocal_far: all(ray.reciprocal_far),
            entry: ray.negative,
        }
    }

    #[inline(always)]
    fn enter(self, ray: &Ray16, node: &Node16, limit: f32) -> Entered {
        // The children's numbers lie in a cache line of their own, which would be asked for only once the mask is known.
        prefetch(&node.children);
        let mut near_array = [0.0; NODE_WIDTH];
        // SAFETY: the token proves AVX-512; sixteen floats are readable at each row of planes, aligned or not, and writable
        // in the array.
        let mask = unsafe {
            let plane = |k: usize, side: usize| _mm512_loadu_ps(node.planes[k][side & 1].as_ptr());
            let slab = |plane: __m512, origin: __m512, reciprocal: __m512| {
                _mm512_mul_ps(_mm512_sub_ps(plane, origin), reciprocal)
            };
            let near = |k: usize| slab(plane(k, ray.entry[k]), ray.origin_near[k], ray.reciprocal_near[k]);
            let far = |k: usize| slab(plane(k, 1 - ray.entry[k]), ray.origin_far[k], ray.reciprocal_far[k]);
            let near =
                _mm512_max_ps(_mm512_max_ps(near(0), near(1)), _mm512_max_ps(near(2), _mm512_set1_ps(LEAST_DISTANCE)));
            let far = _mm512_min_ps(_mm512_min_ps(far(0), far(1)), _mm512_min_ps(far(2), _mm512_set1_ps(limit)));
            _mm512_storeu_ps(near_array.as_mut_ptr(), near);
            _mm512_cmp_ps_mask::<_CMP_LE_OQ>(near, far)
        };
        Entered { mask: u32::from(mask), near: near_array }
    }

    #[inline(always)]
    fn prefetch<T>(self, item: &T) {
        prefetch(item);
    }

    #[inline(always)]
    fn closest_far<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<Found> {
        // SAFETY: `self` proves that the processor has AVX-512.
        unsafe { closest_far(self, tree, primitives, start) }
    }

    #[inline(always)]
    fn any_far<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
        // SAFETY: `self` proves that the processor has AVX-512.
        unsafe { any_far(self, tree, primitives, start) }
    }
}
