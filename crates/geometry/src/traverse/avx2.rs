//! The filters in AVX2.

use super::best::Best;
use super::compiled::{Compiled, compiled};
use super::instance::{closest_in_instance, occludes_in_instance};
use super::lanes256::{D4, F4, F8};
use super::node_hits::{HitMask, Row};
use super::vector::Vector;
use super::wide256::D8;
use super::{Filters, Job, Start, any_far_with, any_with, closest_far_with, closest_with};
use crate::Primitive;
use crate::bvh::node::{NODE_WIDTH, Node16};
use crate::frame::{BoxRay, LEAST_DISTANCE};
use crate::geometry::{InstanceNode, WideTree};
use crate::query::Query;
use crate::vec4::Lanes4;
use etalon_simd::Avx2;

compiled!(Avx2);

/// A ray broadcast to all lanes.
#[derive(Clone, Copy)]
pub(super) struct Ray8 {
    origin_near: [F8; 3],
    origin_far: [F8; 3],
    reciprocal_near: [F8; 3],
    reciprocal_far: [F8; 3],
    /// [`Node16::entry_planes`].
    entry: [usize; 3],
}

/// Each of three numbers, in all lanes.
#[inline(always)]
fn broadcast(token: Avx2, v: F4) -> [F8; 3] {
    let [x, y, z, _] = v.to_array();
    [F8::splat(token, x), F8::splat(token, y), F8::splat(token, z)]
}

impl Filters for Avx2 {
    type Ray = Ray8;
    type NodeHits = HitMask;
    type Vector = F8;
    type Wide = F8;
    type Eight = D8;
    type Four = D4;

    #[inline(always)]
    fn ray(self, ray: &BoxRay<F4>) -> Ray8 {
        Ray8 {
            origin_near: broadcast(self, ray.origin_near),
            origin_far: broadcast(self, ray.origin_far),
            reciprocal_near: broadcast(self, ray.reciprocal_near),
            reciprocal_far: broadcast(self, ray.reciprocal_far),
            entry: Node16::entry_planes(ray.negative),
        }
    }

    #[inline(always)]
    fn enter(self, ray: &Ray8, node: &Node16, limit: f32) -> HitMask {
        // The children's numbers lie in a cache line of their own, which would be asked for only once the mask is known.
        Avx2::prefetch(self, &node.children);
        let mut out = HitMask { mask: 0, near: Row([0.0; NODE_WIDTH]) };
        let [ex, ey, ez] = ray.entry;
        for half in 0..NODE_WIDTH / F8::WIDTH {
            let at = half * F8::WIDTH;
            let plane = |k: usize, from: usize| F8::load(self, node.planes(k, from), at);
            let near_x = (ray.origin_near[0] - plane(0, ex)) * ray.reciprocal_near[0];
            let near_y = (ray.origin_near[1] - plane(1, ey)) * ray.reciprocal_near[1];
            let near_z = (ray.origin_near[2] - plane(2, ez)) * ray.reciprocal_near[2];
            let far_x = (ray.origin_far[0] - plane(0, ex ^ NODE_WIDTH)) * ray.reciprocal_far[0];
            let far_y = (ray.origin_far[1] - plane(1, ey ^ NODE_WIDTH)) * ray.reciprocal_far[1];
            let far_z = (ray.origin_far[2] - plane(2, ez ^ NODE_WIDTH)) * ray.reciprocal_far[2];
            let near = near_x.max_bits(near_y).max_bits(near_z.max_bits(F8::splat(self, LEAST_DISTANCE)));
            let far = far_x.min_bits(far_y).min_bits(far_z.min_bits(F8::splat(self, limit)));
            out.mask |= near.at_most_bits(far) << at;
            near.store(&mut out.near.0, at);
        }
        out
    }

    #[inline(always)]
    fn prefetch<T>(self, item: &T) {
        Avx2::prefetch(self, item);
    }
}
