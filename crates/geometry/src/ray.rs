//! Rays, hits and the points that rays leave.

use etalon_optics::{Real, Vec3};

/// Index of a primitive, in the order given to [`Geometry::build`](crate::Geometry::build).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitiveId(pub u32);

impl PrimitiveId {
    /// No primitive.
    pub const NONE: Self = Self(u32::MAX);
}

/// A primitive where it is placed: which one, and by which instances.
///
/// The same triangle in two instances is two surfaces: a ray that leaves one may meet the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SurfaceId {
    /// 0: one of the geometry's own primitives. Else the number of an instance, or of an instance within instances, in the
    /// order in which [`Geometry::build`](crate::Geometry::build) was given them, depth first.
    pub instance: u32,
    /// The primitive, in the geometry that the instance places. An instance itself stands for all that is within it.
    pub primitive: PrimitiveId,
}

impl SurfaceId {
    /// No surface: a ray that starts in free space, a shadow ray toward no surface.
    pub const NONE: Self = Self { instance: 0, primitive: PrimitiveId::NONE };

    /// A surface that is no part of the geometry: no ray meets it, and no light is on it.
    pub const OUTSIDE: Self = Self { instance: u32::MAX, primitive: PrimitiveId::NONE };

    /// The primitive among those that are not within an instance.
    #[inline(always)]
    pub(crate) fn own(self) -> PrimitiveId {
        if self.instance == 0 { self.primitive } else { PrimitiveId::NONE }
    }
}

impl From<PrimitiveId> for SurfaceId {
    #[inline(always)]
    fn from(primitive: PrimitiveId) -> Self {
        Self { instance: 0, primitive }
    }
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
    /// The surface that the ray leaves (a sphere left to the inside is still hit at its far side).
    pub leaves: SurfaceId,
    /// The surface at which a shadow ray aims: it never occludes.
    pub aims_at: SurfaceId,
    /// When: from 0 as the shutter opens to 1 as it closes. Nothing depends on it where nothing moves.
    pub time: f64,
}

impl<R: Real> Ray<R> {
    /// A ray without end that starts in free space, as the shutter opens.
    #[inline]
    pub fn free(origin: Vec3<R>, direction: Vec3<R>) -> Self {
        Self { origin, direction, t_max: R::INFINITY, leaves: SurfaceId::NONE, aims_at: SurfaceId::NONE, time: 0.0 }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: R) -> Vec3<R> {
        self.origin + self.direction * t
    }
}

/// A closest hit, before its surface is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<R> {
    /// Ray parameter.
    pub t: R,
    /// What was hit.
    pub surface: SurfaceId,
    /// Surface parameters (barycentric weights of b and c in a triangle; a and b of a parallelogram; else 0).
    pub uv: [R; 2],
}

/// What an intersection test finds, in the parameters of a [`Query`](crate::query::Query).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RawHit {
    /// Parameter along [`Query::direction`](crate::query::Query::direction).
    pub(crate) t: f64,
    /// Surface parameters.
    pub(crate) uv: [f64; 2],
}

/// A hit and its surface.
pub(crate) type Found = (RawHit, SurfaceId);

impl<R: Real> Hit<R> {
    /// A hit along a ray; none if its distance is too large for the numbers of the ray.
    #[inline(always)]
    pub(crate) fn new(RawHit { t, uv: [u, v] }: RawHit, surface: SurfaceId) -> Option<Self> {
        let t = R::from_f64(t);
        (t < R::INFINITY).then(|| Self { t, surface, uv: [R::from_f64(u), R::from_f64(v)] })
    }
}

/// A point on a surface as computed in `f64`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactPoint {
    /// Position, m.
    pub(crate) position: Vec3<f64>,
    /// Bound on the error of each component of the position, m.
    pub(crate) error: Vec3<f64>,
    /// Unit normal on the outward side.
    pub(crate) normal: Vec3<f64>,
    /// The surface's largest curvature, 1/m.
    pub(crate) curvature: f64,
}

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<R> {
    /// Position, m.
    pub position: Vec3<R>,
    /// Bound on the distance between `position` and the true surface, m; infinite where `R` cannot represent the position.
    pub position_error: R,
    /// Unit geometric normal, on the shape's own outward side (not turned toward the ray).
    pub normal: Vec3<R>,
    /// What it is a point of.
    pub surface: SurfaceId,
    /// The [label](crate::Geometry::label) of the geometry whose primitive it is.
    pub label: u32,
    /// When it is there: the time of the ray that found it, and of those that leave it.
    pub time: f64,
}

impl<R: Real> SurfacePoint<R> {
    /// Rounds a surface point computed in `f64` to `R`. What the rounding adds to its error is measured, not estimated.
    #[inline(always)]
    pub(crate) fn rounded(point: &ExactPoint, surface: SurfaceId, label: u32, time: f64) -> Self {
        let ExactPoint { position, error, normal, curvature } = *point;
        let rounded: Vec3<R> = position.cast();
        let error = error + (rounded.to_f64() - position).abs();
        // To first order only the component along the normal leaves the surface; a step s along it leaves a curved one
        // by at most s²/2 times the curvature, and never by more than s.
        let squared = error.length_squared();
        let distance = normal.abs().dot(error) + (0.5 * curvature * squared).min(squared.sqrt());
        // 8 roundoffs cover this sum and the rounding of the normal along which rays are moved.
        let distance = distance * (1.0 + 8.0 * R::UNIT_ROUNDOFF.to_f64());
        // A component beyond what is representable is off by infinity, which a normal at right angles to it would make NaN.
        let distance = if rounded.is_finite() { distance } else { f64::INFINITY };
        let position_error = R::from_f64(distance).next_up();
        Self { position: rounded, position_error, normal: normal.cast(), surface, label, time }
    }

    /// The point moved off the surface to the side of `direction`, by the error bound and rounded away from the surface
    /// (Pharr, Jakob & Humphreys, *Physically Based Rendering*, 4th ed., §6.8.6).
    #[inline(always)]
    fn moved_off(&self, direction: Vec3<R>) -> Vec3<R> {
        let side = R::ONE.copysign(direction.dot(self.normal));
        let step = self.normal * (self.position_error * side);
        let moved = |p: R, s: R| match () {
            () if s > R::ZERO => (p + s).next_up(),
            () if s < R::ZERO => (p + s).next_down(),
            () => p,
        };
        Vec3::new(moved(self.position.x, step.x), moved(self.position.y, step.y), moved(self.position.z, step.z))
    }

    /// The ray without end that leaves this point along `direction`.
    ///
    /// It starts off the surface, on the side to which `direction` points, by no more than the error of the position
    /// requires, and knows the primitive that it leaves: no scene epsilon is involved.
    #[inline(always)]
    pub fn spawn(&self, direction: Vec3<R>) -> Ray<R> {
        Ray {
            origin: self.moved_off(direction),
            direction,
            t_max: R::INFINITY,
            leaves: self.surface,
            aims_at: SurfaceId::NONE,
            time: self.time,
        }
    }

    /// The shadow ray from this point to `target` on the surface `aims_at`
    /// ([`SurfaceId::NONE`] for a point in free space).
    ///
    /// Its direction is `target` − origin, not normalised, and it ends just below t = 1: short of the target by the
    /// rounding errors of the two end points and of the direction, so that a neighbour of the primitive aimed at does
    /// not hide it.
    #[inline(always)]
    pub fn spawn_to(&self, target: Vec3<R>, aims_at: SurfaceId) -> Ray<R> {
        let origin = self.moved_off(target - self.position);
        let direction = target - origin;
        // Each end is a rounded point (u a component), the direction a rounded difference (u of itself, which the two
        // ends bound): at most 2u(|target| + |origin|) in the 1-norm, and as much again for the arithmetic here.
        let reach = target.abs() + origin.abs();
        let error = R::from_f64(4.0) * R::UNIT_ROUNDOFF * (reach.x + reach.y + reach.z);
        let length = direction.abs().max_component();
        let t_max = if error < length { R::ONE_MINUS_EPSILON - error / length } else { R::ZERO };
        Ray { origin, direction, t_max, leaves: self.surface, aims_at, time: self.time }
    }
}
