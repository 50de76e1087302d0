//! What a ray is in the accelerator's frame.

/// A ray in the accelerator's frame; fourth lanes are not used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameRay<L> {
    /// What the test of boxes needs.
    pub(crate) boxes: BoxRay<L>,
    /// [`Projection::axis`](crate::query::Projection::axis).
    pub(crate) axis: usize,
    /// The origin along the axes of the projection, the direction's largest component last.
    pub(crate) start_along: L,
    /// The projection's two slopes, rounded.
    pub(crate) slopes: L,
    /// 1/(the largest component of [`Query::direction`](crate::query::Query::direction)), rounded.
    pub(crate) per_depth: f32,
    /// The ray's part of the bound on the error of a vertex's projected coordinates.
    pub(crate) error: f32,
    /// [`Frame::distance`](super::Frame::distance) of the end.
    pub(crate) limit: f32,
    /// A distance not above that of any hit beyond the end.
    pub(crate) certain_limit: f32,
    /// By how much the origin was moved along the ray.
    pub(crate) start: f64,
    /// [`Query::t_max`](crate::query::Query::t_max).
    pub(crate) t_max: f64,
    /// [`Query::scale`](crate::query::Query::scale).
    pub(crate) t_scale: f64,
}

/// What the test of boxes needs of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxRay<L> {
    /// The origin displaced along the ray by more than its error: for the planes where the ray enters boxes.
    pub(crate) origin_near: L,
    /// The origin displaced against the ray by more than its error: for the planes where the ray leaves boxes.
    pub(crate) origin_far: L,
    /// −1/direction, finite, with the other sign than the direction's sign bit, and a little smaller: a distance ahead comes out
    /// no larger than it is. Negative because an instruction subtracts what it reads from memory, not from it.
    pub(crate) reciprocal_near: L,
    /// The same, a little larger: a distance ahead comes out no smaller than it is.
    pub(crate) reciprocal_far: L,
    /// The direction's sign bits, that of x lowest.
    pub(crate) negative: usize,
}
