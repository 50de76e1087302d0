//! The filters in plain Rust.

use super::best::Best;
use super::compiled::Compiled;
use super::instance::{closest_in_instance, occludes_in_instance};
use super::node_hits::{HitMask, Row};
use super::vector::Vector;
use super::{Filters, Job, Start, any_far_with, any_with, closest_far_with, closest_with};
use crate::bvh::node::{NODE_WIDTH, Node16};
use crate::frame::{BoxRay, LEAST_DISTANCE};
use crate::geometry::{InstanceNode, WideTree};
use crate::query::Query;
use crate::small_scene::{BLOCK, PlainEight, Wide};
use crate::vec4::{Lanes4, Plain, Plain4};
use crate::{LANES, Primitive};
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Sub};

/// Plain Rust.
#[derive(Clone, Copy)]
pub(super) struct Portable;

impl From<Portable> for () {
    fn from(_: Portable) {}
}

/// Eight floats.
#[derive(Clone, Copy)]
pub(super) struct Floats([f32; LANES]);

macro_rules! operator {
    ($trait:ident, $f:ident, $operator:tt) => {
        impl $trait for Floats {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                Self(from_fn(|i| self.0[i] $operator o.0[i]))
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Vector for Floats {
    type Token = Portable;
    const WIDTH: usize = LANES;

    #[inline(always)]
    fn splat(_: Portable, v: f32) -> Self {
        Self([v; LANES])
    }

    #[inline(always)]
    fn load<const W: usize>(_: Portable, row: &[f32; W], at: usize) -> Self {
        Self(row.as_chunks().0[at / LANES % (W / LANES)])
    }

    #[inline(always)]
    fn lanes_with<const W: usize>(_: Portable, row: &[u32; W], at: usize, v: u32) -> u32 {
        let half = &row.as_chunks::<LANES>().0[at / LANES % (W / LANES)];
        (0..LANES).fold(0, |mask, i| mask | u32::from(half[i] == v) << i)
    }

    #[inline(always)]
    fn to_row<const W: usize>(self, at: usize) -> [f32; W] {
        let mut row = [0.0; W];
        row.as_chunks_mut().0[at / LANES % (W / LANES)] = self.0;
        row
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(from_fn(|i| if self.0[i] < o.0[i] { self.0[i] } else { o.0[i] }))
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(from_fn(|i| if self.0[i] > o.0[i] { self.0[i] } else { o.0[i] }))
    }

    #[inline(always)]
    fn only(self, lanes: u32) -> Self {
        Self(from_fn(|i| if lanes >> i & 1 == 1 { self.0[i] } else { 0.0 }))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }

    #[inline(always)]
    fn below(self, o: Self) -> u32 {
        (0..LANES).fold(0, |mask, i| mask | u32::from(self.0[i] < o.0[i]) << i)
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> u32 {
        (0..LANES).fold(0, |mask, i| mask | u32::from(self.0[i] <= o.0[i]) << i)
    }
}

impl Wide for Floats {
    type Token = Portable;
    type Mask = u32;
    const WIDTH: usize = LANES;

    #[inline(always)]
    fn splat(_: Portable, v: f32) -> Self {
        Self([v; LANES])
    }

    #[inline(always)]
    fn load(_: Portable, row: &[f32; BLOCK], at: usize) -> Self {
        Self(from_fn(|i| row[(at + i) % BLOCK]))
    }

    #[inline(always)]
    fn shared(_: Portable, row: &[f32; BLOCK], at: usize) -> Self {
        Self([row[at % BLOCK]; LANES])
    }

    #[inline(always)]
    fn rays(_: Portable, v: &[f32; LANES]) -> Self {
        Self(*v)
    }

    #[inline(always)]
    fn store(self, row: &mut [f32; BLOCK]) {
        row[..LANES].copy_from_slice(&self.0);
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
        self.0.iter().fold(f32::INFINITY, |a, &b| if b < a { b } else { a })
    }

    #[inline(always)]
    fn flipped(self, sign: Self) -> Self {
        Self(from_fn(|i| if sign.0[i].is_sign_negative() { -self.0[i] } else { self.0[i] }))
    }

    #[inline(always)]
    fn below(self, o: Self) -> u32 {
        Vector::below(self, o)
    }

    #[inline(always)]
    fn at_most(self, o: Self) -> u32 {
        Vector::at_most(self, o)
    }

    #[inline(always)]
    fn equals(self, o: Self) -> u32 {
        (0..LANES).fold(0, |mask, i| mask | u32::from(self.0[i] == o.0[i]) << i)
    }

    #[inline(always)]
    fn differs(self, o: Self) -> u32 {
        (0..LANES).fold(0, |mask, i| mask | u32::from(self.0[i] != o.0[i]) << i)
    }

    #[inline(always)]
    fn shares(self) -> [[f32; LANES]; 2] {
        [self.0; 2]
    }

    #[inline(always)]
    fn or_else(self, mask: u32, other: Self) -> Self {
        Self(from_fn(|i| if mask >> i & 1 == 1 { self.0[i] } else { other.0[i] }))
    }

    #[inline(always)]
    fn bits(mask: u32) -> u32 {
        mask & ((1 << LANES) - 1)
    }
}

impl Filters for Portable {
    type Ray = BoxRay<Plain>;
    type NodeHits = HitMask;
    type Vector = Floats;
    type Wide = Floats;
    type Eight = PlainEight;
    type Four = Plain4;

    #[inline(always)]
    fn ray(self, ray: &BoxRay<Plain>) -> BoxRay<Plain> {
        *ray
    }

    #[inline(always)]
    fn enter(self, ray: &BoxRay<Plain>, node: &Node16, limit: f32) -> HitMask {
        let [origin_near, origin_far] = [ray.origin_near, ray.origin_far].map(Plain::to_array);
        let [reciprocal_near, reciprocal_far] = [ray.reciprocal_near, ray.reciprocal_far].map(Plain::to_array);
        let mut out = HitMask { mask: 0, near: Row([LEAST_DISTANCE; NODE_WIDTH]) };
        let mut far = [limit; NODE_WIDTH];
        for k in 0..3 {
            let entry = node.planes(k, Node16::entry_planes(ray.negative)[k]);
            let exit = node.planes(k, Node16::entry_planes(ray.negative)[k] ^ NODE_WIDTH);
            for lane in 0..NODE_WIDTH {
                let near = (origin_near[k] - entry[lane]) * reciprocal_near[k];
                out.near.0[lane] = if near > out.near.0[lane] { near } else { out.near.0[lane] };
                let exit = (origin_far[k] - exit[lane]) * reciprocal_far[k];
                far[lane] = if exit < far[lane] { exit } else { far[lane] };
            }
        }
        for lane in 0..NODE_WIDTH {
            out.mask |= u32::from(out.near.0[lane] <= far[lane]) << lane;
        }
        out
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
}

impl Compiled for Portable {
    fn closest<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit> {
        closest_with(self, tree, primitives, start)
    }

    fn any<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
        any_with(self, tree, primitives, start)
    }

    fn run<J: Job>(self, job: J) -> J::Output {
        job.run(self)
    }

    fn closest_far<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit> {
        closest_far_with(self, tree, primitives, start)
    }

    fn any_far<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> bool {
        any_far_with(self, tree, primitives, start)
    }

    #[inline(never)]
    fn closest_in_instance(
        self,
        best: &mut Best,
        instance_node: &InstanceNode,
        primitives: &[Primitive],
        query: &Query,
    ) -> bool {
        closest_in_instance(self, best, instance_node, primitives, query)
    }

    #[inline(never)]
    fn occludes_in_instance(self, instance_node: &InstanceNode, primitives: &[Primitive], query: &Query) -> bool {
        occludes_in_instance(self, instance_node, primitives, query)
    }
}
