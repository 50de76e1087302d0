//! Affine maps that place a geometry within another, and what they round.

use crate::double_double::{cross, dot, widen};
use crate::ray::ExactPoint;
use crate::shapes::check_points;
use crate::{Aabb, MAX_COORDINATE, ShapeError};
use etalon_optics::{Real, Vec3};

/// Beyond this (2⁵⁰) for the largest component of |L|·|L⁻¹|, `f64` cannot tell where a placed surface is.
const MAX_CONDITION: f64 = (1_u64 << 50) as f64;

/// An affine map p ↦ L·p + T from the coordinates of what is placed to those where it is placed, and its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Rows of L.
    linear: [Vec3<f64>; 3],
    translation: Vec3<f64>,
    /// Rows of L⁻¹, each right to a few unit roundoffs of the largest.
    inverse: [Vec3<f64>; 3],
    /// What L·L⁻¹ of a similarity that was not inverted with care may differ from the identity, as an operator; else 0.
    looseness: f64,
}

/// See [`Placement::of_similarity`]: RᵀR − I of a rotation that is the sum of three matrices, each the product of two, has
/// entries below 40 unit roundoffs, as an operator three times that.
const LOOSENESS: f64 = 128.0 * f64::UNIT_ROUNDOFF;

impl Placement {
    /// The map with these rows of L and this T (m).
    ///
    /// # Errors
    /// If a number is not finite or out of range, or L cannot be inverted in double precision.
    pub fn new(linear: [[f64; 3]; 3], translation_m: [f64; 3]) -> Result<Self, ShapeError> {
        let linear = linear.map(Vec3::from_array);
        let translation = Vec3::from_array(translation_m);
        check_points(&[linear[0], linear[1], linear[2], translation])?;
        let placement = Self::of(linear, translation);
        if !placement.inverse.iter().all(|row| row.is_finite()) {
            return Err(ShapeError::Singular);
        }
        let condition = placement.spread(Vec3::splat(1.0)).max_component();
        if condition.is_nan() || condition > MAX_CONDITION {
            return Err(ShapeError::Singular);
        }
        check_points(&placement.inverse)?;
        // The determinant of an inverse within that range is at most 6·MAX_COORDINATE³. If that of L is less than one over it, products
        // were lost that double precision cannot hold, and the inverse is one of nothing.
        const LEAST_DETERMINANT: f64 = 1.0 / (8.0 * MAX_COORDINATE * MAX_COORDINATE * MAX_COORDINATE);
        if determinant(&linear).abs() < LEAST_DETERMINANT {
            return Err(ShapeError::Singular);
        }
        Ok(placement)
    }

    /// The map with these rows of L and this T, which can be inverted.
    pub(crate) fn of(linear: [Vec3<f64>; 3], translation: Vec3<f64>) -> Self {
        let rows = linear.map(widen);
        // The columns of the inverse are these over the determinant.
        let columns = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])];
        let determinant = dot(rows[0], columns[0]);
        let inverse = [0, 1, 2].map(|i| Vec3::from_array(columns.map(|column| column[i].ratio(determinant))));
        Self { linear, translation, inverse, looseness: 0.0 }
    }

    /// [`Placement::of`] for L that is a multiple of a rotation to rounding: L⁻¹ is Lᵀ over the square of the factor.
    pub(crate) fn of_similarity(linear: [Vec3<f64>; 3], translation: Vec3<f64>) -> Self {
        let [a, b, c] = linear;
        let per_square = 3.0 / (a.length_squared() + b.length_squared() + c.length_squared());
        let inverse = [Vec3::new(a.x, b.x, c.x), Vec3::new(a.y, b.y, c.y), Vec3::new(a.z, b.z, c.z)];
        Self { linear, translation, inverse: inverse.map(|row| row * per_square), looseness: LOOSENESS }
    }

    /// Rows of L⁻¹.
    pub(crate) fn inverse(&self) -> [Vec3<f64>; 3] {
        self.inverse
    }

    /// Rows of L.
    pub fn linear(&self) -> [Vec3<f64>; 3] {
        self.linear
    }

    /// T, m.
    pub fn translation(&self) -> Vec3<f64> {
        self.translation
    }

    /// L·p + T.
    pub fn point(&self, p: Vec3<f64>) -> Vec3<f64> {
        product(&self.linear, p) + self.translation
    }

    /// L·v.
    pub fn vector(&self, v: Vec3<f64>) -> Vec3<f64> {
        product(&self.linear, v)
    }

    /// L⁻¹·(p − T).
    #[inline]
    pub(crate) fn local_point(&self, p: Vec3<f64>) -> Vec3<f64> {
        product(&self.inverse, p - self.translation)
    }

    /// L⁻¹·v.
    #[inline]
    pub(crate) fn local_vector(&self, v: Vec3<f64>) -> Vec3<f64> {
        product(&self.inverse, v)
    }

    /// L⁻ᵀ·n to any scale: right for any map, and a mirror leaves the outward side outward.
    pub(crate) fn normal(&self, n: Vec3<f64>) -> Vec3<f64> {
        let normal = transposed_product(&self.inverse, n);
        normal / normal.abs().max_component()
    }

    /// |L|·|L⁻¹|·|L|·v for v ≥ 0, at least |L|·v: what a relative error of the inverse map makes of a vector.
    fn spread(&self, v: Vec3<f64>) -> Vec3<f64> {
        let forward = magnitudes(&self.linear);
        product(&forward, product(&magnitudes(&self.inverse), v))
    }

    /// A box around the image of some boxes within one, wide enough for the rounding of points and of rays that start near it.
    pub(crate) fn bounds(&self, inner: Aabb, outline: &[Aabb]) -> Aabb {
        let forward = magnitudes(&self.linear);
        let image = |b: &Aabb| {
            let centre = b.centre();
            let half = (b.max - centre).max(centre - b.min);
            let (middle, reach) = (self.point(centre), product(&forward, half));
            Aabb { min: middle - reach, max: middle + reach }
        };
        let image = outline.iter().map(image).fold(Aabb::EMPTY, Aabb::union);
        let far = product(&forward, inner.min.abs().max(inner.max.abs()));
        let mut margin = (self.spread(far) + far + self.translation.abs()) * (32.0 * f64::UNIT_ROUNDOFF);
        if self.looseness > 0.0 {
            margin += Vec3::splat(far.length() * self.looseness);
        }
        Aabb { min: image.min - margin, max: image.max + margin }
    }

    /// A point of a placed surface where it is placed.
    ///
    /// The map errs by 4u of |L|·|p| + |T|. A ray that leaves the point is taken back by L⁻¹·(o − T), which errs by u of
    /// the difference and, the inverse being rounded too, by less than 8u of |L⁻¹| times it: seen from outside by
    /// |L|·|L⁻¹| times as much.
    pub(crate) fn outward(&self, p: &ExactPoint) -> ExactPoint {
        let forward = magnitudes(&self.linear);
        let turned = product(&forward, p.position.abs());
        let mut rounding = ((turned + self.translation.abs()) * 4.0 + self.spread(turned) * 10.0) * f64::UNIT_ROUNDOFF;
        if self.looseness > 0.0 {
            rounding += Vec3::splat(turned.length() * self.looseness);
        }
        // The inverse transpose: right for any map, and a mirror leaves the outward side outward.
        let normal = transposed_product(&self.inverse, p.normal);
        let shrink = normal.abs().max_component();
        // An error δ outside is L⁻¹·δ inside and leaves a curved surface there by ½κ|L⁻¹·δ|², outside by that over
        // |L⁻ᵀ·n|.
        let stretch: f64 = self.inverse.iter().map(|row| row.length_squared()).sum();
        ExactPoint {
            position: self.point(p.position),
            error: product(&forward, p.error) + rounding,
            normal: (normal / shrink).normalized(),
            curvature: if p.curvature == 0.0 { 0.0 } else { p.curvature * stretch / normal.length() },
        }
    }
}

fn determinant(rows: &[Vec3<f64>; 3]) -> f64 {
    let rows = rows.map(widen);
    dot(rows[0], cross(rows[1], rows[2])).ratio(1.0.into())
}

fn product(rows: &[Vec3<f64>; 3], v: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(rows[0].dot(v), rows[1].dot(v), rows[2].dot(v))
}

fn transposed_product(rows: &[Vec3<f64>; 3], v: Vec3<f64>) -> Vec3<f64> {
    rows[0] * v.x + rows[1] * v.y + rows[2] * v.z
}

fn magnitudes(rows: &[Vec3<f64>; 3]) -> [Vec3<f64>; 3] {
    rows.map(Vec3::abs)
}
