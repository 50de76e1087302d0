//! What a traversal starts with.

use crate::frame::{Frame, FrameRay};
use crate::query::{Projection, Query};
use crate::ray::{Found, RawHit};
use crate::vec4::{Four, Lanes4};
use crate::{Hit, PrimitiveId, Ray, SurfaceId};
use etalon_optics::{Real, Vec3};

/// What a traversal starts with: a ray, or a query made of one.
pub(crate) trait Start: Copy {
    /// What is told of a hit.
    type Hit;
    /// A hit, its distance in the units of the start, as it is told; none if it is too far away for that.
    fn told(self, hit: RawHit, surface: SurfaceId) -> Option<Self::Hit>;
    /// The query; none if it cannot be computed with.
    fn query(self) -> Option<Query>;
    /// The ray in a frame by [`Frame::enter_near`].
    fn enter_near<F: Four>(self, token: F::Token, frame: &Frame) -> Option<FrameRay<F::Narrow>>;
    /// [`Query::origin`] and [`Query::direction`]; `scale` is [`Query::scale`].
    fn line(self, scale: f64) -> [Vec3<f64>; 2];
    /// The origin and the direction, three lanes and a zero each.
    fn lanes<F: Four>(self, token: F::Token) -> [F; 2];
    /// [`Query::projection`]; `scale` is [`Query::scale`], `axis` that of the projection.
    ///
    /// In vectors: to choose coordinates in memory takes three times as many instructions.
    #[inline(always)]
    fn projection<F: Four>(self, token: F::Token, scale: f64, axis: usize) -> Projection {
        let [origin, direction] = self.lanes::<F>(token);
        let start = origin.along(axis).to_array();
        let [x, y, z, _] = (direction * F::splat(token, scale)).along(axis).to_array();
        Projection::along(axis, [start[0], start[1], start[2]], [x, y, z])
    }
    /// A distance along the query's direction in the units of what it starts with; `scale` is [`Query::scale`].
    #[inline(always)]
    fn distance(self, scale: f64, t: f64) -> f64 {
        t * scale
    }
    /// [`Query::leaves`].
    fn leaves(self) -> PrimitiveId;
    /// [`Query::aims_at`].
    fn aims_at(self) -> PrimitiveId;
}

impl Start for &Query {
    type Hit = Found;

    #[inline(always)]
    fn told(self, hit: RawHit, surface: SurfaceId) -> Option<Found> {
        Some((hit, surface))
    }

    #[inline(always)]
    fn query(self) -> Option<Query> {
        Some(*self)
    }

    #[inline(always)]
    fn enter_near<F: Four>(self, token: F::Token, frame: &Frame) -> Option<FrameRay<F::Narrow>> {
        frame.enter_near(token, self.lanes::<F>(token), |_| self.t_max)
    }

    #[inline(always)]
    fn lanes<F: Four>(self, token: F::Token) -> [F; 2] {
        [lanes::<f64, F>(token, self.origin), lanes::<f64, F>(token, self.given)]
    }

    #[inline(always)]
    fn line(self, _: f64) -> [Vec3<f64>; 2] {
        [self.origin, self.direction]
    }

    #[inline(always)]
    fn projection<F: Four>(self, _: F::Token, _: f64, _: usize) -> Projection {
        self.projection
    }

    #[inline(always)]
    fn distance(self, _: f64, t: f64) -> f64 {
        t
    }

    #[inline(always)]
    fn leaves(self) -> PrimitiveId {
        self.leaves
    }

    #[inline(always)]
    fn aims_at(self) -> PrimitiveId {
        self.aims_at
    }
}

impl<R: Real> Start for &Ray<R> {
    type Hit = Hit<R>;

    #[inline(always)]
    fn told(self, hit: RawHit, surface: SurfaceId) -> Option<Hit<R>> {
        Hit::new(hit, surface)
    }

    #[inline(always)]
    fn query(self) -> Option<Query> {
        Query::new(self)
    }

    #[inline(always)]
    fn enter_near<F: Four>(self, token: F::Token, frame: &Frame) -> Option<FrameRay<F::Narrow>> {
        let t_max = |unit| self.t_max.to_f64() * unit;
        if size_of::<R>() == size_of::<f32>() {
            // They come from `f32`. No closure, which may be called, and be compiled without vector instructions.
            let ([ox, oy, oz], [dx, dy, dz]) = (self.origin.to_f64().to_array(), self.direction.to_f64().to_array());
            let origin = F::Narrow::new(token, [ox as f32, oy as f32, oz as f32, 0.0]);
            let direction = F::Narrow::new(token, [dx as f32, dy as f32, dz as f32, 0.0]);
            if let Some(ray) = frame.enter_exact([origin, direction], t_max) {
                return Some(ray);
            }
        }
        frame.enter_near(token, self.lanes::<F>(token), t_max)
    }

    #[inline(always)]
    fn lanes<F: Four>(self, token: F::Token) -> [F; 2] {
        [lanes::<R, F>(token, self.origin), lanes::<R, F>(token, self.direction)]
    }

    #[inline(always)]
    fn line(self, scale: f64) -> [Vec3<f64>; 2] {
        [self.origin.to_f64(), self.direction.to_f64() * scale]
    }

    #[inline(always)]
    fn leaves(self) -> PrimitiveId {
        self.leaves.own()
    }

    #[inline(always)]
    fn aims_at(self) -> PrimitiveId {
        self.aims_at.own()
    }
}

/// Three numbers and a zero.
#[inline(always)]
fn lanes<R: Real, F: Four>(token: F::Token, v: Vec3<R>) -> F {
    let Vec3 { x, y, z } = v.to_f64();
    if size_of::<R>() == size_of::<f32>() {
        // Exact: they come from `f32`. All are widened at once.
        F::widened(token, [x as f32, y as f32, z as f32, 0.0])
    } else {
        F::new(token, [x, y, z, 0.0])
    }
}

/// A query that is made only when a test in `f64` asks for it: most rays that hit nothing need none, nor do most that
/// something hides.
pub(super) struct Deferred<S> {
    pub(super) start: S,
    query: Option<Query>,
}

impl<S: Start> Deferred<S> {
    #[inline(always)]
    pub(super) fn new(start: S) -> Self {
        Self { start, query: None }
    }

    /// [`Deferred::get`] where it is seldom asked for.
    #[inline(never)]
    pub(super) fn get_apart(&mut self) -> &Query {
        self.get()
    }

    /// The query of a start that has entered a frame.
    pub(super) fn get(&mut self) -> &Query {
        let start = self.start;
        self.query.get_or_insert_with(|| start.query().expect("what is in a frame can be computed with"))
    }
}
