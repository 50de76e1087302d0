//! The filters in AVX-512: all children of a node at once.

use super::best::Best;
use super::compiled::{Compiled, compiled};
use super::instance::{closest_in_instance, occludes_in_instance};
use super::lanes256::{D4, F4};
use super::lanes512::F16;
use super::node_hits::{NodeHits, Row};
use super::wide512::D8;
use super::{Filters, Job, Start, any_far_with, any_with, closest_far_with, closest_with};
use crate::Primitive;
use crate::bvh::node::{NODE_WIDTH, Node16};
use crate::frame::{BoxRay, LEAST_DISTANCE};
use crate::geometry::{InstanceNode, WideTree};
use crate::query::Query;
use crate::vec4::Lanes4;
use etalon_simd::Avx512;
use std::arch::x86_64::*;

compiled!(Avx512);

/// A ray broadcast to all lanes.
#[derive(Clone, Copy)]
pub(super) struct Ray16 {
    origin_near: [__m512; 3],
    origin_far: [__m512; 3],
    reciprocal_near: [__m512; 3],
    reciprocal_far: [__m512; 3],
    /// [`Node16::entry_planes`].
    entry: [usize; 3],
}

/// [`NodeHits`] in registers: what is met is moved to the front of a vector, which takes half as long as to store distances and to load
/// those of the children that a mask tells.
#[derive(Clone, Copy)]
pub(super) struct NodeHits16 {
    mask: __mmask16,
    /// The bits of all children's distances.
    near: __m512i,
    token: Avx512,
}

impl NodeHits16 {
    /// The children met, and their distances.
    #[inline(always)]
    fn front(&self, node: &Node16) -> [__m512i; 2] {
        let t = self.token;
        let children = t._mm512_loadu_si512(&node.children.0);
        [t._mm512_maskz_compress_epi32(self.mask, children), t._mm512_maskz_compress_epi32(self.mask, self.near)]
    }
}

impl NodeHits for NodeHits16 {
    #[inline(always)]
    fn mask(&self) -> u32 {
        u32::from(self.mask)
    }

    #[inline(always)]
    fn first(&self, node: &Node16) -> u32 {
        let t = self.token;
        t.avx2()._mm_cvtsi128_si32(t._mm512_castsi512_si128(self.front(node)[0])) as u32
    }

    #[inline(always)]
    fn pair<const SECOND: bool>(&self, node: &Node16) -> [u64; 2] {
        let (t, narrow) = (self.token, self.token.avx2());
        let [children, near] = self.front(node);
        let (children, near) = (t._mm512_castsi512_si128(children), t._mm512_castsi512_si128(near));
        let pair =
            if SECOND { narrow._mm_unpackhi_epi32(children, near) } else { narrow._mm_unpacklo_epi32(children, near) };
        [narrow._mm_cvtsi128_si64(pair) as u64, narrow._mm_extract_epi64::<1>(pair) as u64]
    }

    #[inline(always)]
    fn all(&self, node: &Node16) -> Row<u64, NODE_WIDTH> {
        let t = self.token;
        let mut out = Row([0; NODE_WIDTH]);
        let [children, near] = self.front(node);
        let lower = t._mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
        let upper = t._mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
        let (halves, _) = out.0.as_chunks_mut::<8>();
        t._mm512_storeu_si512(&mut halves[0], t._mm512_permutex2var_epi32(children, lower, near));
        t._mm512_storeu_si512(&mut halves[1], t._mm512_permutex2var_epi32(children, upper, near));
        out
    }
}

/// Each of three numbers, in all lanes.
#[inline(always)]
fn broadcast(token: Avx512, v: F4) -> [__m512; 3] {
    let [x, y, z, _] = v.to_array();
    [token._mm512_set1_ps(x), token._mm512_set1_ps(y), token._mm512_set1_ps(z)]
}

impl Filters for Avx512 {
    type Ray = Ray16;
    type NodeHits = NodeHits16;
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
            entry: Node16::entry_planes(ray.negative),
        }
    }

    #[inline(always)]
    fn enter(self, ray: &Ray16, node: &Node16, limit: f32) -> NodeHits16 {
        // The children's numbers lie in a cache line of their own, which would be asked for only once the mask is known.
        self.avx2().prefetch(&node.children);
        let slab = |plane: &[f32; NODE_WIDTH], origin: __m512, reciprocal: __m512| {
            self._mm512_mul_ps(self._mm512_sub_ps(origin, self._mm512_loadu_ps(plane)), reciprocal)
        };
        // As integers: numbers that are not negative are ordered as they are, one that is negative is below them all, and
        // one instruction takes a cycle instead of four.
        let near = |k: usize| {
            let plane = node.planes(k, ray.entry[k]);
            self._mm512_castps_si512(slab(plane, ray.origin_near[k], ray.reciprocal_near[k]))
        };
        let far = |k: usize| {
            let plane = node.planes(k, ray.entry[k] ^ NODE_WIDTH);
            self._mm512_castps_si512(slab(plane, ray.origin_far[k], ray.reciprocal_far[k]))
        };
        let least = self._mm512_castps_si512(self._mm512_set1_ps(LEAST_DISTANCE));
        let most = self._mm512_castps_si512(self._mm512_set1_ps(limit));
        let near =
            self._mm512_max_epi32(self._mm512_max_epi32(near(0), near(1)), self._mm512_max_epi32(near(2), least));
        let far = self._mm512_min_epi32(self._mm512_min_epi32(far(0), far(1)), self._mm512_min_epi32(far(2), most));
        NodeHits16 { mask: self._mm512_cmple_epi32_mask(near, far), near, token: self }
    }

    #[inline(always)]
    fn prefetch<T>(self, item: &T) {
        self.avx2().prefetch(item);
    }
}
