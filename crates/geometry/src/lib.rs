//! Shapes, robust intersection and the ray accelerator.
//!
//! The door is [`Geometry`]: it is built once from primitives in `f64` and answers closest-hit and occlusion queries for
//! rays of either scalar type. No query uses a scene epsilon: a hit carries a bound on the error of its position, and a
//! ray that leaves a surface knows the primitive and the bound that it left.

use etalon_optics::{Real, Vec3};

/// Index of a primitive, in the order given to [`Geometry::build`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitiveId(pub u32);

impl PrimitiveId {
    /// No primitive: a ray that starts in free space, a shadow ray toward no surface.
    pub const NONE: Self = Self(u32::MAX);
}

/// A half-line `origin + t·direction`, 0 < t < `t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray<R> {
    /// Start.
    pub origin: Vec3<R>,
    /// Direction, of any length; t counts in units of it.
    pub direction: Vec3<R>,
    /// End, exclusive.
    pub t_max: R,
    /// The primitive that the ray leaves (a sphere left to the inside is still hit at its far side).
    pub leaves: PrimitiveId,
    /// The primitive at which a shadow ray aims: it never occludes.
    pub aims_at: PrimitiveId,
}

/// A closest hit, before its surface is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<R> {
    /// Ray parameter.
    pub t: R,
    /// The primitive.
    pub primitive: PrimitiveId,
    /// Surface parameters (barycentric weights of b and c in a triangle; a and b of a parallelogram; else 0).
    pub uv: [R; 2],
}

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<R> {
    /// Position, m.
    pub position: Vec3<R>,
    /// Bound on the distance between `position` and the true surface, m.
    pub position_error: R,
    /// Unit geometric normal, on the shape's own outward side (not turned toward the ray).
    pub normal: Vec3<R>,
    /// The primitive.
    pub primitive: PrimitiveId,
}
