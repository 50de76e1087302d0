//! Spheres.

use super::{ShapeError, check_points, check_radius, outward};
use crate::Aabb;
use crate::query::Query;
use crate::ray::{ExactPoint, RawHit};
use etalon_optics::{Real, Vec3};

/// A full sphere; its outward side is the outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    centre: Vec3<f64>,
    radius: f64,
}

impl Sphere {
    /// A sphere about `centre` (m) of `radius` (m).
    ///
    /// # Errors
    /// If a number is not finite or out of range, or the radius is not positive.
    pub fn new(centre: Vec3<f64>, radius: f64) -> Result<Self, ShapeError> {
        check_points(&[centre])?;
        check_radius(radius)?;
        Ok(Self { centre, radius })
    }

    /// Centre, m.
    pub fn centre(&self) -> Vec3<f64> {
        self.centre
    }

    /// Radius, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Surface area, m².
    pub fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * self.radius * self.radius
    }

    /// The smallest box around the sphere, rounded outward.
    pub fn bounds(&self) -> Aabb {
        let r = Vec3::splat(self.radius);
        let (lower, upper) = (self.centre - r, self.centre + r);
        Aabb {
            min: Vec3::new(lower.x.next_down(), lower.y.next_down(), lower.z.next_down()),
            max: Vec3::new(upper.x.next_up(), upper.y.next_up(), upper.z.next_up()),
        }
    }

    /// The roots of |o + t·d − c|² = r².
    ///
    /// The discriminant is r² less the squared distance of the line from the centre, that distance taken from the
    /// perpendicular vector (Haines, Günther & Akenine-Möller, *Precision Improvements for Ray/Sphere Intersection*,
    /// Ray Tracing Gems, 2019, ch. 7), and of the two roots the one nearer to zero comes from their product, so that
    /// neither cancels. Differences of squares are taken of the squares: they err by as little as products of sum and
    /// difference, since the distances are themselves roots of rounded squares, and wait for no root. An origin on the surface, as far as rounding tells, may have its root there on either side of
    /// zero: a ray that leaves this sphere therefore drops the nearer root by name, and has the other one if and only
    /// if it starts toward the centre.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64, leaves: bool) -> Option<RawHit> {
        self.intersect_line(query.origin, query.direction, t_max, leaves)
    }

    /// [`Sphere::intersect`] of the ray of a query by its origin and its direction.
    #[inline(always)]
    pub(crate) fn intersect_line(&self, origin: Vec3<f64>, d: Vec3<f64>, t_max: f64, leaves: bool) -> Option<RawHit> {
        let to_centre = self.centre - origin;
        let d2 = d.length_squared();
        // What comes later waits for no other division. This one must not be rounded twice: the line's distance hangs on it.
        let (t_middle, per_d2) = (to_centre.dot(d) / d2, 1.0 / d2);
        let perpendicular = d * t_middle - to_centre;
        let r2 = self.radius * self.radius;
        let quarter = r2 - perpendicular.length_squared();
        // NaN: an origin so far away that the arithmetic overflows.
        if quarter < 0.0 || quarter.is_nan() {
            return None;
        }
        let half_chord = (quarter * per_d2).sqrt();
        let hit = |t: f64| (0.0 < t && t < t_max).then_some(RawHit { t, uv: [0.0; 2] });
        if leaves {
            return if t_middle > 0.0 { hit(t_middle + half_chord) } else { None };
        }
        let product = (to_centre.length_squared() - r2) * per_d2;
        if t_middle > 0.0 {
            let far = t_middle + half_chord;
            let near = product / far;
            hit(if near > 0.0 { near } else { far })
        } else if product < 0.0 {
            // The origin is inside and the centre behind: the only root ahead.
            hit(product / (t_middle - half_chord))
        } else {
            None
        }
    }

    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        let normal = outward(p - self.centre);
        let position = self.centre + normal * self.radius;
        // The normal's length is 1 to 3u, its product with r and the sum add one u each.
        let error = (position.abs() + Vec3::splat(self.radius) * 6.0) * f64::UNIT_ROUNDOFF;
        ExactPoint { position, error, normal, curvature: 1.0 / self.radius }
    }
}
