//! The filters in AVX2, eight lanes at once.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::{Candidates, Entered, Filters, any_with, closest_with};
use crate::frame::{FAR_FACTOR, FrameRay, NEAR_FACTOR};
use crate::query::{Query, RawHit};
use crate::wide::{Leaf8, Node8, WIDTH, WideTree};
use crate::{Primitive, PrimitiveId};
use std::arch::x86_64::*;

/// Proof that the processor has AVX2: [`Avx2::detect`] alone makes one.
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

impl Avx2 {
    #[inline(always)]
    pub(super) fn detect() -> Option<Self> {
        std::arch::is_x86_feature_detected!("avx2").then_some(Self(()))
    }

    #[inline(always)]
    pub(super) fn closest(
        self,
        tree: &WideTree,
        primitives: &[Primitive],
        query: &Query,
    ) -> Option<(RawHit, PrimitiveId)> {
        // SAFETY: `self` proves that the processor has AVX2.
        unsafe { closest(self, tree, primitives, query) }
    }

    #[inline(always)]
    pub(super) fn any(self, tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
        // SAFETY: `self` proves that the processor has AVX2.
        unsafe { any(self, tree, primitives, query) }
    }
}

#[target_feature(enable = "avx2,bmi1")]
fn closest(filters: Avx2, tree: &WideTree, primitives: &[Primitive], query: &Query) -> Option<(RawHit, PrimitiveId)> {
    closest_with(filters, tree, primitives, query)
}

#[target_feature(enable = "avx2,bmi1")]
fn any(filters: Avx2, tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    any_with(filters, tree, primitives, query)
}

/// A ray broadcast to all lanes.
#[derive(Clone, Copy)]
pub(super) struct Ray8 {
    origin_near: [__m256; 3],
    origin_far: [__m256; 3],
    reciprocal: [__m256; 3],
    /// Rows of [`Node8::planes`] where the ray enters.
    entry: [usize; 3],
    axes: [usize; 3],
    origin: [__m256; 3],
    shear: [__m256; 3],
    error: f32,
}

#[inline(always)]
fn load(row: &[f32; WIDTH]) -> __m256 {
    // SAFETY: eight floats are readable at the reference; the load need not be aligned. Only code that holds an
    // `Avx2` calls this.
    unsafe { _mm256_loadu_ps(row.as_ptr()) }
}

#[inline(always)]
fn store(v: __m256) -> [f32; WIDTH] {
    let mut out = [0.0; WIDTH];
    // SAFETY: eight floats are writable at the reference; the store need not be aligned.
    unsafe { _mm256_storeu_ps(out.as_mut_ptr(), v) };
    out
}

impl Filters for Avx2 {
    type Ray = Ray8;

    #[inline(always)]
    fn ray(self, ray: &FrameRay) -> Ray8 {
        // SAFETY: `self` proves AVX2; arithmetic only.
        let all = |v: f32| unsafe { _mm256_set1_ps(v) };
        Ray8 {
            origin_near: ray.origin_near.map(all),
            origin_far: ray.origin_far.map(all),
            reciprocal: ray.reciprocal.map(all),
            entry: [ray.negative[0], 2 + ray.negative[1], 4 + ray.negative[2]],
            axes: ray.axes,
            origin: ray.origin.map(all),
            shear: ray.shear.map(all),
            error: ray.error,
        }
    }

    #[inline(always)]
    fn enter(self, ray: &Ray8, node: &Node8, limit: f32) -> Entered {
        let [ex, ey, ez] = ray.entry;
        let planes = &node.planes;
        // SAFETY: `self` proves AVX2; arithmetic only.
        unsafe {
            let near = |k: usize, row: usize| {
                _mm256_mul_ps(_mm256_sub_ps(load(&planes[row]), ray.origin_near[k]), ray.reciprocal[k])
            };
            let far = |k: usize, row: usize| {
                _mm256_mul_ps(_mm256_sub_ps(load(&planes[row ^ 1]), ray.origin_far[k]), ray.reciprocal[k])
            };
            let entry =
                _mm256_max_ps(_mm256_max_ps(near(0, ex), near(1, ey)), _mm256_max_ps(near(2, ez), _mm256_setzero_ps()));
            let exit =
                _mm256_min_ps(_mm256_min_ps(far(0, ex), far(1, ey)), _mm256_min_ps(far(2, ez), _mm256_set1_ps(limit)));
            let entry = _mm256_mul_ps(entry, _mm256_set1_ps(NEAR_FACTOR));
            let exit = _mm256_mul_ps(exit, _mm256_set1_ps(FAR_FACTOR));
            let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32;
            Entered { mask, near: store(entry) }
        }
    }

    /// As the portable filter, whose doc comment derives the bounds.
    #[inline(always)]
    fn candidates(self, ray: &Ray8, leaf: &Leaf8, limit: f32, certain_limit: f32) -> Candidates {
        // SAFETY: `self` proves AVX2; arithmetic only, and a load of eight integers through a reference to them.
        unsafe {
            let ids = _mm256_loadu_si256(leaf.ids.as_ptr().cast());
            let empty = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(ids, _mm256_set1_epi32(-1)))) as u32;
            let unfiltered = _mm256_movemask_ps(_mm256_castsi256_ps(ids)) as u32 & !empty;

            let sign = _mm256_set1_ps(-0.0);
            let abs = |v| _mm256_andnot_ps(sign, v);
            let [kx, ky, kz] = ray.axes;
            let project = |vertex: &[[f32; WIDTH]; 3]| {
                let z = _mm256_sub_ps(load(&vertex[kz]), ray.origin[2]);
                let x = _mm256_sub_ps(_mm256_sub_ps(load(&vertex[kx]), ray.origin[0]), _mm256_mul_ps(ray.shear[0], z));
                let y = _mm256_sub_ps(_mm256_sub_ps(load(&vertex[ky]), ray.origin[1]), _mm256_mul_ps(ray.shear[1], z));
                (x, y, z)
            };
            let (ax, ay, az) = project(&leaf.vertices[0]);
            let (bx, by, bz) = project(&leaf.vertices[1]);
            let (cx, cy, cz) = project(&leaf.vertices[2]);
            let edge = |px, py, qx, qy| _mm256_sub_ps(_mm256_mul_ps(px, qy), _mm256_mul_ps(py, qx));
            let u = edge(cx, cy, bx, by);
            let v = edge(ax, ay, cx, cy);
            let w = edge(bx, by, ax, ay);
            let max3 = |a, b, c| _mm256_max_ps(_mm256_max_ps(a, b), c);
            let min3 = |a, b, c| _mm256_min_ps(_mm256_min_ps(a, b), c);
            let extent = _mm256_max_ps(max3(abs(ax), abs(bx), abs(cx)), max3(abs(ay), abs(by), abs(cy)));
            let error = _mm256_add_ps(
                _mm256_mul_ps(extent, _mm256_set1_ps(6.0 * ray.error)),
                _mm256_set1_ps(2.0 * ray.error * ray.error),
            );
            let minus_error = _mm256_xor_ps(error, sign);
            let (least, most) = (min3(u, v, w), max3(u, v, w));
            let outside = _mm256_and_ps(
                _mm256_cmp_ps::<_CMP_LT_OQ>(least, minus_error),
                _mm256_cmp_ps::<_CMP_GT_OQ>(most, error),
            );
            let mut mask = !(_mm256_movemask_ps(outside) as u32 | empty | unfiltered) & 0xFF;
            if mask == 0 {
                return Candidates { mask: unfiltered, certain: 0, near: [0.0; WIDTH] };
            }
            let det = _mm256_add_ps(_mm256_add_ps(u, v), w);
            let reciprocal = _mm256_div_ps(ray.shear[2], det);
            let weighted =
                _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(u, az), _mm256_mul_ps(v, bz)), _mm256_mul_ps(w, cz));
            let t = _mm256_mul_ps(weighted, reciprocal);
            let spread = _mm256_sub_ps(max3(az, bz, cz), min3(az, bz, cz));
            let depth = _mm256_add_ps(spread, _mm256_set1_ps(2.0 * ray.error));
            let error6 = _mm256_mul_ps(error, _mm256_set1_ps(6.0));
            let t_error = _mm256_add_ps(
                _mm256_mul_ps(_mm256_mul_ps(error6, depth), abs(reciprocal)),
                _mm256_set1_ps(3.0 * ray.error),
            );
            let determined = _mm256_cmp_ps::<_CMP_GT_OQ>(abs(det), error6);
            // Undetermined distances count as zero.
            let near = _mm256_and_ps(_mm256_sub_ps(t, t_error), determined);
            let far = _mm256_add_ps(t, t_error);
            let beyond = _mm256_and_ps(
                determined,
                _mm256_or_ps(
                    _mm256_cmp_ps::<_CMP_GT_OQ>(near, _mm256_set1_ps(limit)),
                    _mm256_cmp_ps::<_CMP_LT_OQ>(far, _mm256_setzero_ps()),
                ),
            );
            mask &= !(_mm256_movemask_ps(beyond) as u32);
            let inside =
                _mm256_or_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(least, error), _mm256_cmp_ps::<_CMP_LT_OQ>(most, minus_error));
            let between = _mm256_and_ps(
                _mm256_cmp_ps::<_CMP_GT_OQ>(near, _mm256_setzero_ps()),
                _mm256_cmp_ps::<_CMP_LT_OQ>(far, _mm256_set1_ps(certain_limit)),
            );
            let certain = _mm256_and_ps(_mm256_and_ps(inside, between), determined);
            let certain = _mm256_movemask_ps(certain) as u32 & mask;
            Candidates { mask: mask | unfiltered, certain, near: store(near) }
        }
    }
}
