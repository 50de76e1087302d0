//! The shapes, one a file: data in `f64` world space, and intersection tests without cancellation.

mod cylinder;
mod disk;
mod parallelogram;
pub(crate) mod planar;
mod sphere;
mod triangle;

pub use cylinder::Cylinder;
pub use disk::Disk;
pub use parallelogram::Parallelogram;
pub use sphere::Sphere;
pub use triangle::Triangle;

use crate::query::{Query, RawHit};
use crate::ray::ExactPoint;
use crate::{Aabb, Instance};
use etalon_optics::Vec3;

/// Largest magnitude of a coordinate or a length, m (2¹²⁰ ≈ 1.3e36): no product in an intersection test overflows.
pub const MAX_COORDINATE: f64 = (1_u128 << 120) as f64;
/// Smallest length of an edge or a radius, m (2⁻¹²⁰ ≈ 7.5e-37): no product in an intersection test underflows.
pub const MIN_LENGTH: f64 = 1.0 / MAX_COORDINATE;

/// Why a shape cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShapeError {
    /// A coordinate is NaN or infinite.
    #[error("a coordinate is not a finite number")]
    NotFinite,
    /// A coordinate or length is larger than [`MAX_COORDINATE`], or a length smaller than [`MIN_LENGTH`].
    #[error("a coordinate or a length is beyond what can be computed with (2^±120 m)")]
    OutOfRange,
    /// The shape has no area, so no normal.
    #[error("the shape has no area")]
    NoArea,
    /// The placement of an instance cannot be inverted.
    #[error("the placement flattens what it places")]
    Singular,
    /// An instance of a geometry without primitives.
    #[error("the instance places nothing")]
    Empty,
    /// Poses of a motion that no smooth motion joins, or that are none.
    #[error("the poses of the motion cannot be joined")]
    Unjoinable,
}

/// Checks coordinates.
pub(crate) fn check_points(points: &[Vec3<f64>]) -> Result<(), ShapeError> {
    if !points.iter().all(|p| p.is_finite()) {
        return Err(ShapeError::NotFinite);
    }
    if points.iter().any(|p| p.abs().max_component() > MAX_COORDINATE) {
        return Err(ShapeError::OutOfRange);
    }
    Ok(())
}

/// Checks a radius.
fn check_radius(radius: f64) -> Result<(), ShapeError> {
    match radius {
        r if !r.is_finite() => Err(ShapeError::NotFinite),
        r if r <= 0.0 => Err(ShapeError::NoArea),
        r if (MIN_LENGTH..=MAX_COORDINATE).contains(&r) => Ok(()),
        _ => Err(ShapeError::OutOfRange),
    }
}

/// The unit vector from an axis or a centre to a point of a round surface. One below the resolution of its place may have
/// its points rounded to its centre or next to it: any direction is as good there.
fn outward(v: Vec3<f64>) -> Vec3<f64> {
    if v.length_squared() > f64::MIN_POSITIVE { v.normalized() } else { Vec3::new(1.0, 0.0, 0.0) }
}

/// A shape that rays meet.
#[derive(Clone, Debug, PartialEq)]
pub enum Primitive {
    /// A full sphere.
    Sphere(Sphere),
    /// A parallelogram.
    Parallelogram(Parallelogram),
    /// A flat disk.
    Disk(Disk),
    /// A triangle.
    Triangle(Triangle),
    /// A cylinder.
    Cylinder(Cylinder),
    /// A geometry placed by an affine map.
    Instance(Box<Instance>),
}

macro_rules! primitive_from {
    ($($shape:ident),*) => {
        $(impl From<$shape> for Primitive {
            fn from(shape: $shape) -> Self {
                Self::$shape(shape)
            }
        })*
    };
}
primitive_from!(Sphere, Parallelogram, Disk, Triangle, Cylinder);

impl From<Instance> for Primitive {
    fn from(instance: Instance) -> Self {
        Self::Instance(Box::new(instance))
    }
}

macro_rules! each {
    ($primitive:expr, $shape:ident => $result:expr) => {
        match $primitive {
            Primitive::Sphere($shape) => $result,
            Primitive::Parallelogram($shape) => $result,
            Primitive::Disk($shape) => $result,
            Primitive::Triangle($shape) => $result,
            Primitive::Cylinder($shape) => $result,
            Primitive::Instance($shape) => $result,
        }
    };
}

impl Primitive {
    /// A box that contains the shape.
    pub fn bounds(&self) -> Aabb {
        each!(self, s => s.bounds())
    }

    /// A point, the unit normal and the size of a flat shape.
    pub(crate) fn plane(&self) -> Option<(Vec3<f64>, Vec3<f64>, f64)> {
        match self {
            Self::Triangle(s) => Some(s.plane()),
            Self::Parallelogram(s) => Some(s.plane()),
            Self::Disk(s) => Some((s.centre(), s.normal(), s.radius())),
            Self::Sphere(_) | Self::Cylinder(_) | Self::Instance(_) => None,
        }
    }

    /// Whether its normal depends on the place.
    pub(crate) fn is_curved(&self) -> bool {
        matches!(self, Self::Sphere(_) | Self::Cylinder(_))
    }

    /// The closest hit with 0 < t < `t_max`. `leaves`: the ray leaves this very primitive.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64, leaves: bool) -> Option<RawHit> {
        match self {
            Self::Triangle(s) => (!leaves).then(|| s.intersect(query, t_max)).flatten(),
            Self::Parallelogram(s) => (!leaves).then(|| s.intersect(query, t_max)).flatten(),
            Self::Disk(s) => (!leaves).then(|| s.intersect(query, t_max)).flatten(),
            Self::Sphere(s) => s.intersect(query, t_max, leaves),
            Self::Cylinder(s) => s.intersect(query, t_max, leaves),
            Self::Instance(s) => s.closest(query, t_max).map(|(hit, _)| hit),
        }
    }

    /// All crossings of the ray with the shape, at most two, the nearer first. `leaves`: the ray leaves this very primitive.
    ///
    /// The second crossing of a curved shape is the one that a ray meets which leaves the shape at the first.
    pub(crate) fn crossings(&self, query: &Query, leaves: bool) -> [Option<RawHit>; 2] {
        let first = self.intersect(query, f64::INFINITY, leaves);
        let second = match first {
            Some(first) if self.is_curved() => {
                self.intersect(query, f64::INFINITY, true).filter(|second| second.t > first.t)
            }
            _ => None,
        };
        [first, second]
    }

    /// The parameters that a hit at the point `p` of it carries, to rounding; 0 of shapes whose hits carry none.
    pub(crate) fn parameters(&self, p: Vec3<f64>) -> [f64; 2] {
        let (corner, [a, b]) = match self {
            Self::Triangle(s) => {
                let [a, b, c] = s.vertices();
                (a, [b - a, c - a])
            }
            Self::Parallelogram(s) => (s.corner(), s.edges()),
            Self::Sphere(_) | Self::Disk(_) | Self::Cylinder(_) | Self::Instance(_) => return [0.0; 2],
        };
        // p = corner + u a + v b, each by its share of a × b.
        let (n, d) = (a.cross(b), p - corner);
        let whole = n.length_squared();
        [d.cross(b).dot(n) / whole, a.cross(d).dot(n) / whole]
    }

    /// The surface at the point `p`, which lies near it.
    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        match self {
            Self::Sphere(s) => s.surface(p),
            Self::Parallelogram(s) => s.surface(p),
            Self::Disk(s) => s.surface(p),
            Self::Triangle(s) => s.surface(p),
            Self::Cylinder(s) => s.surface(p),
            Self::Instance(_) => unreachable!("a hit names the shape within an instance"),
        }
    }
}
