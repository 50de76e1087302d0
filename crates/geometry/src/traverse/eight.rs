//! The rays of eight lanes through a tree, one after the other: as single rays, but set out from the lanes themselves and without a
//! call for each. To gather a ray in memory first, and to read it back in vectors, costs as much as two nodes.

use super::compiled::Compiled;
use super::start::Start;
use super::{Job, any_with, closest_with};
use crate::frame::{Frame, FrameRay};
use crate::geometry::WideTree;
use crate::lanes::{Hits, LANES, Rays, lanes_of, vector};
use crate::query::Query;
use crate::ray::RawHit;
use crate::vec4::Four;
use crate::{Hit, Primitive, PrimitiveId, SurfaceId};
use etalon_optics::Vec3;

/// A ray in a lane.
#[derive(Clone, Copy)]
struct Lane<'a> {
    rays: &'a Rays,
    lane: usize,
}

impl Start for Lane<'_> {
    type Hit = Hit<f64>;

    #[inline(always)]
    fn told(self, hit: RawHit, surface: SurfaceId) -> Option<Hit<f64>> {
        Hit::new(hit, surface)
    }

    #[inline(always)]
    fn query(self) -> Option<Query> {
        Query::new(&self.rays.get(self.lane))
    }

    #[inline(always)]
    fn enter_near<F: Four>(self, token: F::Token, frame: &Frame) -> Option<FrameRay<F::Narrow>> {
        frame.enter_near(token, self.lanes::<F>(token), |unit| self.rays.t_max[self.lane % LANES] * unit)
    }

    #[inline(always)]
    fn lanes<F: Four>(self, token: F::Token) -> [F; 2] {
        let ([ox, oy, oz], [dx, dy, dz], lane) = (&self.rays.origin, &self.rays.direction, self.lane % LANES);
        [F::new(token, [ox[lane], oy[lane], oz[lane], 0.0]), F::new(token, [dx[lane], dy[lane], dz[lane], 0.0])]
    }

    #[inline(always)]
    fn line(self, scale: f64) -> [Vec3<f64>; 2] {
        let lane = self.lane % LANES;
        [vector(&self.rays.origin, lane), vector(&self.rays.direction, lane) * scale]
    }

    #[inline(always)]
    fn leaves(self) -> PrimitiveId {
        self.rays.leaves[self.lane % LANES].own()
    }

    #[inline(always)]
    fn aims_at(self) -> PrimitiveId {
        self.rays.aims_at[self.lane % LANES].own()
    }
}

/// The closest hits of the rays in the lanes of `active`.
pub(super) struct Closest<'a> {
    pub(super) tree: &'a WideTree,
    pub(super) primitives: &'a [Primitive],
    pub(super) rays: &'a Rays,
    pub(super) active: u8,
}

impl Job for Closest<'_> {
    type Output = Hits;

    #[inline(always)]
    fn run<F: Compiled>(self, filters: F) -> Hits {
        let Self { tree, primitives, rays, active } = self;
        let mut hits = Hits::NONE;
        for lane in lanes_of(active) {
            let found = closest_with(filters, tree, primitives, Lane { rays, lane });
            if let Some(hit) = found {
                hits.set(lane, Some(&hit));
            }
        }
        hits
    }
}

/// Whether anything hides the ends of the rays in the lanes of `active`, one bit each.
pub(super) struct Any<'a> {
    pub(super) tree: &'a WideTree,
    pub(super) primitives: &'a [Primitive],
    pub(super) rays: &'a Rays,
    pub(super) active: u8,
}

impl Job for Any<'_> {
    type Output = u8;

    #[inline(always)]
    fn run<F: Compiled>(self, filters: F) -> u8 {
        let Self { tree, primitives, rays, active } = self;
        let mut hidden = 0;
        for lane in lanes_of(active) {
            hidden |= u8::from(any_with(filters, tree, primitives, Lane { rays, lane })) << lane;
        }
        hidden
    }
}
