//! Spheres.

use super::{DirectionDensity, ShapeError, ShapeMap, ShapeSample, check_points, check_radius, outward};
use crate::Aabb;
use crate::query::Query;
use crate::ray::{ExactPoint, RawHit};
use crate::warp::{uniform_cone, uniform_sphere};
use etalon_optics::{Frame, Real, Vec3};
use std::f64::consts::PI;

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
        4.0 * PI * self.radius * self.radius
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

    /// Directions toward it from points outside.
    #[inline]
    pub fn sampler(&self) -> SphereSampler {
        SphereSampler { centre: self.centre, radius: self.radius }
    }

    /// From outside, directions are uniform in the cone that it fills; from inside, over the whole sphere of directions.
    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> ShapeSample {
        let sampler = self.sampler();
        if sampler.is_outside(from) {
            return sampler.sample(from, u);
        }
        let wi = uniform_sphere(u);
        let toward = self.centre - from;
        let b = wi.dot(toward);
        let depth = ((self.radius - toward.length()) * (self.radius + toward.length())).max(0.0);
        let root = (b * b + depth).sqrt();
        let t = if b >= 0.0 { b + root } else { depth / (root - b) };
        // From a point on the sphere itself half of all directions leave it at once.
        ShapeSample { point: from + wi * t, wi, density: 1.0 / (4.0 * PI), front: false, valid: t > 0.0 }
    }

    pub(super) fn density(&self, from: Vec3<f64>, _: Vec3<f64>) -> DirectionDensity {
        let sampler = self.sampler();
        let front = sampler.is_outside(from);
        let density = if front { cone_density(sampler.view(from).one_minus_cos) } else { 1.0 / (4.0 * PI) };
        DirectionDensity { density, front }
    }

    /// Its image under a similarity.
    pub(crate) fn mapped(&self, map: &impl ShapeMap) -> Result<Self, ShapeError> {
        Self::new(map.point(self.centre), map.length(self.radius))
    }
}

/// A sphere as far as the directions toward it from outside depend on it.
#[derive(Clone, Copy, Debug)]
pub struct SphereSampler {
    /// Centre.
    pub centre: Vec3<f64>,
    /// Radius.
    pub radius: f64,
}

/// How a sphere looks from a point outside.
struct View {
    /// Toward the centre, unit.
    axis: Vec3<f64>,
    /// Distance of the centre.
    distance: f64,
    /// 1 − cos of the half angle of the cone that it fills.
    one_minus_cos: f64,
}

impl SphereSampler {
    /// Whether a point is outside: the one predicate that sampling and density share.
    #[inline(always)]
    pub fn is_outside(&self, from: Vec3<f64>) -> bool {
        (self.centre - from).length() > self.radius
    }

    /// As seen from outside.
    #[inline(always)]
    fn view(&self, from: Vec3<f64>) -> View {
        let toward = self.centre - from;
        let distance = toward.length();
        let sin = self.radius / distance;
        // cos = √(1 − s²) and 1 − cos = s²/(1 + cos), both without cancellation (hard cases 25, 26).
        let cos = ((distance - self.radius) * (distance + self.radius)).sqrt() / distance;
        View { axis: toward / distance, distance, one_minus_cos: sin * sin / (1.0 + cos) }
    }

    /// The direction for `u` in [0, 1)², uniform in the cone that the sphere fills as seen from `from`, a point outside. It has no
    /// branches, so that a loop over points is vectorised.
    #[inline(always)]
    pub fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> ShapeSample {
        let View { axis, distance, one_minus_cos } = self.view(from);
        let local = uniform_cone(u, one_minus_cos);
        let wi = Frame::from_normal(axis).to_world(local).renormalized();
        // The nearer root of |t·wi − toward| = radius, as c/q.
        let b = distance * local.z;
        let sin_squared = local.x * local.x + local.y * local.y;
        let half_chord = self.radius * self.radius - distance * distance * sin_squared;
        let power_of_point = (distance - self.radius) * (distance + self.radius);
        // The rim itself may round to a chord just below zero; there the chord is zero.
        let t = power_of_point / (b + half_chord.sqrt_nonnegative());
        ShapeSample { point: from + wi * t, wi, density: cone_density(one_minus_cos), front: true, valid: t > 0.0 }
    }

    /// The density of the direction `wi` where [`SphereSampler::sample`] draws directions from `from`, a point outside, sr⁻¹: zero
    /// beyond the cone.
    #[inline(always)]
    pub fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        if self.is_met(from, wi) { cone_density(self.view(from).one_minus_cos) } else { 0.0 }
    }

    /// Whether a ray from outside meets it.
    #[inline(always)]
    pub fn is_met(&self, from: Vec3<f64>, wi: Vec3<f64>) -> bool {
        let toward = self.centre - from;
        let along = toward.dot(wi);
        let across = toward - wi * along;
        (along > 0.0) & (across.length_squared() < self.radius * self.radius)
    }
}

/// Density of directions uniform in a cone, sr⁻¹.
#[inline(always)]
fn cone_density(one_minus_cos: f64) -> f64 {
    1.0 / (2.0 * PI * one_minus_cos)
}
