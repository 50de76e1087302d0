//! The queries of a [`Geometry`], for one ray and for eight.

use crate::lanes::lanes_of;
use crate::query::Query;
use crate::ray::RawHit;
use crate::{Geometry, Hit, Hits, Passed, Ray, Rays, SurfacePoint, SurfacePoints, traverse};
use etalon_optics::Real;

impl Geometry {
    /// The closest hit along a ray.
    ///
    /// A ray of which no point is defined (NaN, zero direction) hits nothing, nor does one that starts beyond 2²⁰⁰ m or
    /// whose direction is outside 2^±900; nor is there a hit whose parameter `R` cannot represent.
    pub fn closest_hit<R: Real>(&self, ray: &Ray<R>) -> Option<Hit<R>> {
        if let Some(tree) = self.tree() {
            return traverse::closest(self.level(), tree, self.primitives(), ray);
        }
        let query = Query::new(ray)?;
        let (hit, surface) = self.closest(&query)?;
        Hit::new(RawHit { t: hit.t * query.scale, ..hit }, surface)
    }

    /// Calls `visit` for every hit with `from` ≤ t < `t_max`, in no particular order. `visit` returns the end of the distances
    /// that still matter, which becomes the new `t_max`: that of the ray to see all hits, 0 to see no more.
    ///
    /// A sphere or a cylinder may be hit twice. Distances are those that [`Geometry::closest_hit`] finds, bit for bit.
    pub fn all_hits(&self, ray: &Ray<f64>, from: f64, mut visit: impl FnMut(Hit<f64>) -> f64) {
        let Some(query) = Query::new(ray) else { return };
        let mut end = query.t_max;
        self.all(&query, from / query.scale, &mut |hit, surface| {
            if let Some(hit) = Hit::new(RawHit { t: hit.t * query.scale, ..hit }, surface) {
                end = visit(hit) / query.scale;
            }
            end
        });
    }

    /// The closest hit that a walk along a ray has not yet passed; of several at the same distance, that of the lowest
    /// [`SurfaceId`](crate::SurfaceId).
    ///
    /// The ray stays as it is, so what lies at the same distance as a surface that the walk passes is still ahead of it: each
    /// surface is met exactly once, however many coincide.
    pub fn next_hit(&self, ray: &Ray<f64>, passed: &Passed) -> Option<Hit<f64>> {
        if passed.is_nothing() {
            return self.closest_hit(ray);
        }
        let mut next: Option<Hit<f64>> = None;
        self.all_hits(ray, passed.from(), |hit| {
            let closer = next.is_none_or(|next| (hit.t, hit.surface) < (next.t, next.surface));
            if closer && !passed.holds(&hit) {
                next = Some(hit);
            }
            next.map_or(ray.t_max, |next| next.t.next_up())
        });
        next
    }

    /// Whether anything but the surface aimed at lies on a ray before `t_max`.
    pub fn occluded<R: Real>(&self, ray: &Ray<R>) -> bool {
        match self.tree() {
            Some(tree) => traverse::any(self.level(), tree, self.primitives(), ray),
            None => Query::new(ray).is_some_and(|query| self.any(&query)),
        }
    }

    /// [`Geometry::closest_hit`] and [`Geometry::occluded`] by testing every primitive (what instances place is not taken
    /// apart): for tests.
    #[doc(hidden)]
    pub fn one_by_one(&self, ray: &Ray<f64>) -> (Option<Hit<f64>>, bool) {
        let Some(query) = Query::new(ray) else { return (None, false) };
        let hit = self.closest_flat(&query).map(|(RawHit { t, uv }, surface)| Hit { t: t * query.scale, surface, uv });
        (hit.filter(|hit| hit.t < f64::INFINITY), self.any_flat(&query))
    }

    /// The surface at a hit, as [`Geometry::closest_hit`] returned it for `ray`.
    ///
    /// # Panics
    /// If the hit is not one of this geometry's with this ray.
    pub fn surface<R: Real>(&self, ray: &Ray<R>, hit: &Hit<R>) -> SurfacePoint<R> {
        // What the rounding of t displaces along the ray would turn the normal of a curved surface.
        let refine = R::UNIT_ROUNDOFF.to_f64() > f64::UNIT_ROUNDOFF;
        let primitive = self.primitives().get(hit.surface.primitive.0 as usize).filter(|_| hit.surface.instance == 0);
        if let Some(primitive) = primitive.filter(|p| !(refine && p.is_curved())) {
            let p = ray.origin.to_f64() + ray.direction.to_f64() * hit.t.to_f64();
            let point = match self.small_scene() {
                Some(small) => small.surface(self.primitives(), hit.surface.primitive, p),
                None => primitive.surface(p),
            };
            return SurfacePoint::rounded(&point, hit.surface, self.label(), ray.time);
        }
        let found = Query::new(ray)
            .and_then(|query| self.exact_point(&query, hit.t.to_f64() / query.scale, refine, hit.surface));
        let Some((point, label)) = found else { panic!("the hit is of another geometry or another ray") };
        SurfacePoint::rounded(&point, hit.surface, label, ray.time)
    }
}

impl Geometry {
    /// [`Geometry::closest_hit`] of the rays in the lanes of `active`, one bit each.
    pub fn closest_hits(&self, rays: &Rays, active: u8) -> Hits {
        if let Some(tree) = self.tree() {
            return traverse::closest_hits(self.level(), tree, self.primitives(), rays, active);
        }
        let (mut hits, undecided) = match self.small_scene() {
            Some(small) => small.closest_hits(self.level(), self.primitives(), rays, active),
            None => (Hits::NONE, active),
        };
        for lane in lanes_of(undecided) {
            hits.set(lane, self.closest_hit(&rays.get(lane)).as_ref());
        }
        hits
    }

    /// [`Geometry::occluded`] of the rays in the lanes of `active`: one bit for each lane, zero in the others.
    pub fn any_hits(&self, rays: &Rays, active: u8) -> u8 {
        if let Some(tree) = self.tree() {
            return traverse::any_hits(self.level(), tree, self.primitives(), rays, active);
        }
        let (hits, undecided) = match self.small_scene() {
            Some(small) => small.any_hits(self.level(), rays, active),
            None => (0, active),
        };
        lanes_of(undecided).fold(hits, |mask, lane| mask | u8::from(self.occluded(&rays.get(lane))) << lane)
    }

    /// [`Geometry::surface`] at the hits in the lanes of `active`, as [`Geometry::closest_hits`] returned them for `rays`.
    ///
    /// # Panics
    /// If one is not a hit of this geometry's with its ray.
    pub fn surfaces(&self, rays: &Rays, hits: &Hits, active: u8) -> SurfacePoints {
        if let Some(small) = self.small_scene() {
            let primitives = self.primitives();
            let known = |&lane: &usize| {
                hits.surface[lane].instance == 0 && (hits.surface[lane].primitive.0 as usize) < primitives.len()
            };
            assert!(
                active & !hits.mask == 0 && lanes_of(active).all(|l| known(&l)),
                "a surface is asked for where there is a hit"
            );
            return small.surfaces(self.level(), primitives, rays, hits, active, self.label());
        }
        let mut points = SurfacePoints::NONE;
        for lane in lanes_of(active) {
            let hit = hits.get(lane).expect("a surface is asked for where there is a hit");
            points.set(lane, &self.surface(&rays.get(lane), &hit));
        }
        points
    }
}
