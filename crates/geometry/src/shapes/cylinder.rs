//! Circular cylinders, open or closed.

use super::{DirectionDensity, ShapeError, ShapeMap, ShapeSample, check_points, check_radius, outward, planar};
use crate::query::Query;
use crate::ray::{ExactPoint, PrimitiveId, RawHit, Ray, SurfaceId, SurfacePoint};
use crate::warp::concentric_disk;
use crate::{Aabb, MIN_LENGTH};
use etalon_optics::{Frame, Real, Vec3};

/// A right circular cylinder, closed by two disks or open at both ends, seen by rays from both sides; its outward side is the
/// outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Cylinder {
    centre: Vec3<f64>,
    /// Unit vector.
    axis: Vec3<f64>,
    radius: f64,
    half_length: f64,
    capped: bool,
}

impl Cylinder {
    /// A cylinder of `radius` (m) about the line from `start` to `end` (m), with disks at its ends or without.
    ///
    /// # Errors
    /// If a number is not finite or out of range, the ends coincide, or the radius is not positive.
    pub fn new(start: Vec3<f64>, end: Vec3<f64>, radius: f64, capped: bool) -> Result<Self, ShapeError> {
        check_points(&[start, end])?;
        check_radius(radius)?;
        let along = (end - start) * 0.5;
        let magnitude = along.abs().max_component();
        if magnitude == 0.0 {
            return Err(ShapeError::NoArea);
        }
        if magnitude < MIN_LENGTH {
            return Err(ShapeError::OutOfRange);
        }
        let half_length = (along / magnitude).length() * magnitude;
        let centre = start * 0.5 + end * 0.5;
        Ok(Self { centre, axis: (along / magnitude).normalized(), radius, half_length, capped })
    }

    /// The middle, m.
    pub fn centre(&self) -> Vec3<f64> {
        self.centre
    }

    /// Unit vector from the start to the end.
    pub fn axis(&self) -> Vec3<f64> {
        self.axis
    }

    /// Radius, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Half the length, m.
    pub fn half_length(&self) -> f64 {
        self.half_length
    }

    /// The middles of the ends, m.
    pub fn ends(&self) -> [Vec3<f64>; 2] {
        [self.centre - self.axis * self.half_length, self.centre + self.axis * self.half_length]
    }

    /// Whether disks close its ends.
    pub fn is_capped(&self) -> bool {
        self.capped
    }

    /// Area of the outside, m².
    pub fn area(&self) -> f64 {
        let caps = if self.capped { self.radius } else { 0.0 };
        2.0 * std::f64::consts::PI * self.radius * (2.0 * self.half_length + caps)
    }

    /// A box around the cylinder, rounded outward.
    pub fn bounds(&self) -> Aabb {
        let a = self.axis;
        // r·√(1 − x²) = r·√(y² + z²), which does not cancel.
        let across = Vec3::new(a.y * a.y + a.z * a.z, a.z * a.z + a.x * a.x, a.x * a.x + a.y * a.y);
        let reach = |along: f64, across: f64| {
            (along.abs() * self.half_length + across.sqrt() * self.radius) * (1.0 + 16.0 * f64::UNIT_ROUNDOFF)
        };
        let half = Vec3::new(reach(a.x, across.x), reach(a.y, across.y), reach(a.z, across.z));
        let (lower, upper) = (self.centre - half, self.centre + half);
        Aabb {
            min: Vec3::new(lower.x.next_down(), lower.y.next_down(), lower.z.next_down()),
            max: Vec3::new(upper.x.next_up(), upper.y.next_up(), upper.z.next_up()),
        }
    }

    /// Where the line of a ray is within the infinite cylinder, and where between the planes of the ends; `None` if it never
    /// is within the cylinder. Parallel to the axis or to the planes the whole line may be within.
    ///
    /// Across the axis this is a circle, solved as a sphere is: the discriminant from the perpendicular vector, the smaller
    /// root from the product of both. What the rounding of the axis takes from a direction along it displaces the ray by a few
    /// roundoffs of the distance, no more.
    #[inline]
    fn spans(&self, query: &Query) -> Option<([f64; 2], [f64; 2])> {
        let (o, d) = (query.origin - self.centre, query.direction);
        let (oz, dz) = (o.dot(self.axis), d.dot(self.axis));
        let (ox, dx) = (o - self.axis * oz, d - self.axis * dz);
        let (distance, d2) = (ox.length(), dx.length_squared());
        let round = if d2 < PARALLEL {
            // NaN: an origin out of reach.
            if distance > self.radius || distance.is_nan() {
                return None;
            }
            ALL
        } else {
            let middle = -ox.dot(dx) / d2;
            let closest = (ox + dx * middle).length();
            let quarter = (self.radius - closest) * (self.radius + closest);
            if quarter < 0.0 || quarter.is_nan() {
                return None;
            }
            let half_chord = (quarter / d2).sqrt();
            let product = (distance - self.radius) * (distance + self.radius) / d2;
            if middle > 0.0 {
                let far = middle + half_chord;
                [product / far, far]
            } else {
                let near = middle - half_chord;
                // Both zero: the line touches the cylinder at the origin.
                [near, if near == 0.0 { 0.0 } else { product / near }]
            }
        };
        let flat = if dz == 0.0 {
            if oz.abs() > self.half_length {
                return None;
            }
            ALL
        } else {
            let (a, b) = ((-self.half_length - oz) / dz, (self.half_length - oz) / dz);
            if a < b { [a, b] } else { [b, a] }
        };
        Some((round, flat))
    }

    /// A closed cylinder is convex: a line is within it for one stretch, the common one of both spans, so that no ray slips
    /// through between the wall and a disk. A ray that leaves it drops the nearer end by name, and has the farther one if and
    /// only if it starts inward, as for a sphere. So does a ray that leaves the wall of an open one.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64, leaves: bool) -> Option<RawHit> {
        let (round, flat) = self.spans(query)?;
        let t = if self.capped {
            let (near, far) = (round[0].max(flat[0]), round[1].min(flat[1]));
            match () {
                () if near > far => None,
                () if leaves => (near + far > 0.0).then_some(far),
                () => Some(if near > 0.0 { near } else { far }),
            }
        } else {
            let on_wall = |t: &f64| 0.0 < *t && flat[0] <= *t && *t <= flat[1];
            // Of a line that touches the wall the two may have changed places.
            let (near, far) = (round[0].min(round[1]), round[0].max(round[1]));
            if leaves {
                (near + far > 0.0).then_some(far).filter(on_wall)
            } else {
                [near, far].into_iter().find(on_wall)
            }
        };
        // The limit comes last: which of the points counts must not depend on it.
        t.filter(|&t| 0.0 < t && t < t_max).map(|t| RawHit { t, uv: [0.0; 2] })
    }

    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        let o = p - self.centre;
        let oz = o.dot(self.axis);
        let across = o - self.axis * oz;
        let distance = across.length();
        if self.capped && (oz.abs() - self.half_length).abs() < (distance - self.radius).abs() {
            let side = 1.0_f64.copysign(oz);
            let end = self.centre + self.axis * (self.half_length * side);
            return planar::surface(p, end, self.axis * side, self.radius.max(self.half_length));
        }
        let normal = outward(across);
        let position = self.centre + self.axis * oz + normal * self.radius;
        // The height errs by 3u of the offset, the foot on the axis by 4u of the height; the normal's length by 3u, its
        // direction by what the offset's roundings are of the radius, which displaces along the surface only.
        let error =
            (position.abs() + Vec3::splat(self.radius * 6.0 + o.abs().max_component() * 8.0)) * f64::UNIT_ROUNDOFF;
        ExactPoint { position, error, normal, curvature: 1.0 / self.radius }
    }

    /// Its image under a similarity.
    pub(crate) fn mapped(&self, map: &impl ShapeMap) -> Result<Self, ShapeError> {
        let [start, end] = self.ends().map(|p| map.point(p));
        Self::new(start, end, map.length(self.radius), self.capped)
    }

    /// The first point of the cylinder alone along a ray.
    fn met_alone(&self, ray: &Ray<f64>) -> Option<SurfacePoint<f64>> {
        let query = Query::new(ray)?;
        let hit = self.intersect(&query, query.t_max, ray.leaves == ALONE)?;
        let t = hit.t * query.scale;
        (t < f64::INFINITY).then(|| SurfacePoint::rounded(&self.surface(ray.at(t)), ALONE, 0, ray.time))
    }

    /// The point that a direction meets first, and the density of the direction: the sum of d²/(|cos|·A) over the points
    /// that it meets, which are two at most.
    fn seen(&self, from: Vec3<f64>, wi: Vec3<f64>) -> Option<(SurfacePoint<f64>, f64)> {
        let share = |point: &SurfacePoint<f64>| {
            let toward = point.position - from;
            toward.length_squared() / (wi.dot(point.normal).abs() * self.area())
        };
        let first = self.met_alone(&Ray::free(from, wi))?;
        let mut density = share(&first);
        if let Some(second) = self.met_alone(&first.spawn(wi)) {
            density += share(&second);
        }
        Some((first, density))
    }

    /// A point uniform on the area gives the direction, and the direction the point that is seen. No sample is lost on points that
    /// hide behind others.
    ///
    /// The square of the distance of a uniform point of the unit disk from its middle is uniform too, and independent of its
    /// direction: the one chooses the height or the place on a cap, the other the place around the axis.
    pub(super) fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> ShapeSample {
        let [x, y] = concentric_disk(u);
        let squared = x * x + y * y;
        let around = if squared > 0.0 {
            let r = squared.sqrt();
            [x / r, y / r]
        } else {
            [1.0, 0.0]
        };
        let (radius, half_length) = (self.radius, self.half_length);
        let cap_share = if self.capped { 0.5 * radius / (2.0 * half_length + radius) } else { 0.0 };
        let wall_share = 1.0 - 2.0 * cap_share;
        let (reach, height) = if squared < wall_share {
            (radius, half_length * (2.0 * squared / wall_share - 1.0))
        } else {
            // The last step may round to just above 1.
            let rest = (squared - wall_share) / cap_share;
            let (side, rest) = if rest < 1.0 { (-1.0, rest) } else { (1.0, (rest - 1.0).min(1.0)) };
            (radius * rest.sqrt(), half_length * side)
        };
        let frame = Frame::from_normal(self.axis);
        let point = self.centre + (frame.s * around[0] + frame.t * around[1]) * reach + frame.n * height;
        let toward = point - from;
        let distance = toward.length();
        let wi = toward / distance;
        let Some((first, density)) = (distance != 0.0).then(|| self.seen(from, wi)).flatten() else {
            return ShapeSample { point, wi, density: 0.0, front: false, valid: false };
        };
        // Along the surface up to rounding, the density is infinite.
        let valid = density > 0.0 && density.is_finite();
        ShapeSample { point: first.position, wi, density, front: first.normal.dot(-wi) > 0.0, valid }
    }

    pub(super) fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> DirectionDensity {
        match self.seen(from, wi) {
            Some((first, density)) => DirectionDensity { density, front: first.normal.dot(-wi) > 0.0 },
            None => DirectionDensity { density: 0.0, front: false },
        }
    }
}

/// The cylinder, where nothing else is there.
const ALONE: SurfaceId = SurfaceId { instance: 0, primitive: PrimitiveId(0) };

/// Squared sine below which a ray is as good as parallel to the axis: its wall would be beyond all coordinates.
const PARALLEL: f64 = 1e-280;
/// A whole line.
const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
