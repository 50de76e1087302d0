//! What a traversal starts with.

use crate::frame::{Frame, FrameRay, Lanes4};
use crate::query::{Four, Projection, Query};
use crate::{PrimitiveId, Ray};
use etalon_optics::{Real, Vec3};

/// What a traversal starts with: a ray, or a query made of one.
pub(crate) trait Start: Copy {
    /// The query; none if it cannot be computed with.
    fn query(self) -> Option<Query>;
    /// The ray in a frame by [`Frame::enter_near`].
    fn enter_near<F: Four>(self, token: F::Token, frame: &Frame) -> Option<FrameRay<F::Narrow>>;
    /// [`Query::origin`] and [`Query::direction`]; `scale` is [`Query::scale`].
    fn line(self, scale: f64) -> [Vec3<f64>; 2];
    /// [`Query::projection`]; `scale` is [`Query::scale`], `axis` that of the projection.
    #[inline(always)]
    fn projection(self, scale: f64, axis: usize) -> Projection {
        let [origin, direction] = self.line(scale);
        Projection::new(origin, direction, axis)
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
    #[inline(always)]
    fn query(self) -> Option<Query> {
        Some(*self)
    }

    #[inline(always)]
    fn enter_near<F: Four>(self, token: F::Token, frame: &Frame) -> Option<FrameRay<F::Narrow>> {
        let lanes = [lanes::<f64, F>(token, self.origin), lanes::<f64, F>(token, self.given)];
        frame.enter_near(token, lanes, |_| self.t_max)
    }

    #[inline(always)]
    fn line(self, _: f64) -> [Vec3<f64>; 2] {
        [self.origin, self.direction]
    }

    #[inline(always)]
    fn projection(self, _: f64, _: usize) -> Projection {
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
    #[inline(always)]
    fn query(self) -> Option<Query> {
        Query::new(self)
    }

    #[inline(always)]
    fn enter_near<F: Four>(self, token: F::Token, frame: &Frame) -> Option<FrameRay<F::Narrow>> {
        let t_max = |unit| self.t_max.to_f64() * unit;
        if size_of::<R>() == size_of::<f32>() {
            // They come from `f32`.
            let lanes = [self.origin, self.direction]
                .map(|v| F::Narrow::new(token, [v.x.to_f64() as f32, v.y.to_f64() as f32, v.z.to_f64() as f32, 0.0]));
            if let Some(ray) = frame.enter_exact(lanes, t_max) {
                return Some(ray);
            }
        }
        let lanes = [lanes::<R, F>(token, self.origin), lanes::<R, F>(token, self.direction)];
        frame.enter_near(token, lanes, t_max)
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
