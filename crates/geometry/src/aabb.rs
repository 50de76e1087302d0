//! Axis-aligned bounding boxes.

use etalon_optics::Vec3;

/// An axis-aligned box in `f64`, both faces included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner, m.
    pub min: Vec3<f64>,
    /// Upper corner, m.
    pub max: Vec3<f64>,
}

impl Aabb {
    /// The box of no points: the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::splat(f64::INFINITY), max: Vec3::splat(f64::NEG_INFINITY) };

    /// The smallest box around some points.
    pub fn of_points(points: impl IntoIterator<Item = Vec3<f64>>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The smallest box around two boxes.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Extent along each axis, m.
    pub fn extent(self) -> Vec3<f64> {
        self.max - self.min
    }

    /// The middle of the box, m.
    pub fn centre(self) -> Vec3<f64> {
        self.min * 0.5 + self.max * 0.5
    }

    /// Whether a point lies in the box or on its faces.
    pub fn contains(self, p: Vec3<f64>) -> bool {
        (0..3).all(|k| self.min[k] <= p[k] && p[k] <= self.max[k])
    }
}
