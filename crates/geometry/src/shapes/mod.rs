//! The shapes, one a file: data in `f64` world space, intersection tests without cancellation, and directions drawn toward them.

mod cylinder;
mod disk;
mod parallelogram;
pub(crate) mod planar;
mod sampler;
mod sphere;
mod triangle;

pub use cylinder::Cylinder;
pub use disk::Disk;
pub use parallelogram::Parallelogram;
pub use planar::PlanarSampler;
pub use sampler::{DirectionDensity, ShapeSample, ShapeSampler};
pub use sphere::{Sphere, SphereSampler};
pub use triangle::Triangle;

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
    #[error("a coordinate or a length is too large or too small (beyond 2^±120 m)")]
    OutOfRange,
    /// The shape has no area, so no normal.
    #[error("the shape has no area")]
    NoArea,
    /// The placement of an instance cannot be inverted.
    #[error("the transform flattens the object")]
    Singular,
    /// An instance of a geometry without primitives.
    #[error("the instance places nothing")]
    Empty,
    /// Poses of a motion that no smooth motion joins, or that are none.
    #[error("no motion connects the keyframes")]
    Unjoinable,
}

/// A shape as the filters in `f32` see it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FilterShape {
    /// Its vertices.
    Triangle([Vec3<f64>; 3]),
    /// A corner and its two neighbours.
    Parallelogram([Vec3<f64>; 3]),
    /// A corner of the square around it, and its two neighbours.
    Disk([Vec3<f64>; 3]),
    /// Its centre and radius.
    Sphere(Vec3<f64>, f64),
    /// There is no filter for it.
    Other,
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

/// A map of space that takes shapes to shapes of their kind.
pub trait ShapeMap {
    /// The image of a point.
    fn point(&self, p: Vec3<f64>) -> Vec3<f64>;
    /// The image of a vector.
    fn vector(&self, v: Vec3<f64>) -> Vec3<f64>;
    /// The image of a normal under a similarity, of any length.
    fn normal(&self, n: Vec3<f64>) -> Vec3<f64>;
    /// The image of a length under a similarity.
    fn length(&self, length: f64) -> f64;
    /// Whether it turns left hands into right ones.
    fn mirrors(&self) -> bool;
}

/// Two edges or corners in the order that keeps the surface's outward side outward.
fn oriented<T>(map: &impl ShapeMap, first: T, second: T) -> (T, T) {
    if map.mirrors() { (second, first) } else { (first, second) }
}
