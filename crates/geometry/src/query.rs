//! A ray prepared for the intersection tests, which are all computed in `f64`.

use crate::double_double::product_difference;
use crate::vec4::{AXES, Axis, Four, larger, projection_axis};
use crate::{Aabb, PrimitiveId, Ray, SurfaceId};
use etalon_optics::{Real, Vec3};

/// A ray in `f64`, its direction scaled by a power of two (exactly), and the shear that maps it to the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query {
    pub(crate) origin: Vec3<f64>,
    /// Direction with its largest component in [1, 2).
    pub(crate) direction: Vec3<f64>,
    /// The direction as it was given.
    pub(crate) given: Vec3<f64>,
    /// Ray parameter = parameter along [`Query::direction`] × `scale`, a power of two.
    pub(crate) scale: f64,
    /// End, exclusive, along [`Query::direction`].
    pub(crate) t_max: f64,
    /// The primitive left, and the one aimed at, if they are not within an instance.
    pub(crate) leaves: PrimitiveId,
    pub(crate) aims_at: PrimitiveId,
    /// The same wherever they are.
    pub(crate) leaves_placed: SurfaceId,
    pub(crate) aims_at_placed: SurfaceId,
    pub(crate) time: f64,
    pub(crate) projection: Projection,
}

/// The shear that maps a ray to the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    /// The axis along which the direction is largest, an index into [`AXES`].
    pub(crate) axis: usize,
    /// Two slopes and 1/(the direction's largest component).
    shear: [f64; 3],
    /// The origin along the axes.
    start: [f64; 3],
}

impl Query {
    /// Prepares a ray; `None` if no point of it can be computed with: a component is NaN or infinite, the origin lies beyond
    /// [`MAX_ORIGIN`], the direction is zero or its magnitude outside 2^±900, or `t_max` is not positive.
    #[inline(always)]
    pub(crate) fn new<R: Real>(ray: &Ray<R>) -> Option<Self> {
        let (origin, direction) = (ray.origin.to_f64(), ray.direction.to_f64());
        let t_max = ray.t_max.to_f64();
        let a = direction.abs();
        let magnitude = larger(larger(a.x, a.y), a.z);
        let exponent = (magnitude.to_bits() >> 52) as i64 - 1023;
        // Sums are finite only if their terms are.
        let reach = origin.abs();
        let sums = [reach.x + reach.y + reach.z, a.x + a.y + a.z];
        let usable = sums[0] < MAX_ORIGIN && sums[1].is_finite() && exponent.abs() <= 900 && t_max > 0.0;
        if !usable {
            return None;
        }
        let scale = power_of_two(-exponent);
        let given = direction;
        let direction = given * scale;
        let axis = projection_axis([a.x, a.y, a.z, 0.0]);
        Some(Self {
            origin,
            direction,
            given,
            scale,
            t_max: t_max * power_of_two(exponent),
            leaves: ray.leaves.own(),
            aims_at: ray.aims_at.own(),
            leaves_placed: ray.leaves,
            aims_at_placed: ray.aims_at,
            time: ray.time,
            projection: Projection::new(origin, direction, axis),
        })
    }
}

impl Query {
    /// Where it enters a box, 0 from within, if that is before `t_max`, to rounding.
    #[inline]
    pub(crate) fn entry(&self, bounds: &Aabb, t_max: f64) -> Option<f64> {
        let (mut near, mut far) = (0.0_f64, t_max);
        for k in 0..3 {
            let (d, o) = (self.direction[k], self.origin[k]);
            let (lower, upper) = (bounds.min[k] - o, bounds.max[k] - o);
            if d != 0.0 {
                let (t0, t1) = (lower / d, upper / d);
                near = near.max(t0.min(t1));
                far = far.min(t0.max(t1));
            } else if lower > 0.0 || upper < 0.0 {
                return None;
            }
        }
        // The smallest numbers are rounded to their like, not to a share of themselves.
        (near <= far * (1.0 + 8.0 * f64::EPSILON) + f64::MIN_POSITIVE).then_some(near)
    }
}

impl Projection {
    /// The projection of a ray whose direction's largest component is in [1, 2), and along `axis`.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3<f64>, direction: Vec3<f64>, axis: usize) -> Self {
        let (d, o) = (direction.to_array(), origin.to_array());
        let [kx, ky, kz] = AXES[axis % AXES.len()];
        let (kx, ky, kz) = (kx as usize, ky as usize, kz as usize);
        Self::along(axis, [o[kx], o[ky], o[kz]], [d[kx], d[ky], d[kz]])
    }

    /// [`Projection::new`] of an origin and a direction given along the axes.
    #[inline(always)]
    pub(crate) fn along(axis: usize, start: [f64; 3], [dx, dy, dz]: [f64; 3]) -> Self {
        let rz = 1.0 / dz;
        Self { axis, shear: [dx * rz, dy * rz, rz], start }
    }

    /// The axes of the projection, the direction's largest component last.
    #[inline(always)]
    pub(crate) fn axes(&self) -> [Axis; 3] {
        AXES[self.axis % AXES.len()]
    }

    /// Up to four vertices, lanes of their coordinates along the axes, relative to the origin and sheared so that the ray runs
    /// along z and z counts ray parameters; and the magnitudes to which the rounding errors of their x and y are relative.
    ///
    /// The result depends on nothing but the ray and the vertex: shapes that share a vertex agree on it to the bit.
    #[inline(always)]
    pub(crate) fn project<F: Four>(&self, token: F::Token, v: [F; 3]) -> ([F; 3], F) {
        let all = |v| F::splat(token, v);
        let (x, y, z) = (v[0] - all(self.start[0]), v[1] - all(self.start[1]), v[2] - all(self.start[2]));
        let magnitudes = x.abs().max(y.abs()).max(z.abs());
        let (x, y) = (x - all(self.shear[0]) * z, y - all(self.shear[1]) * z);
        ([x, y, z * all(self.shear[2])], magnitudes)
    }
}

/// Origins within this (2²⁰⁰, in the 1-norm) keep every product of an intersection test finite.
pub(crate) const MAX_ORIGIN: f64 = (1_u128 << 100) as f64 * (1_u128 << 100) as f64;

/// The edge function of two projected points where it rounds to zero: twice the signed area of the triangle that the ray and the
/// edge span in projection, x₁·y₂ − y₁·x₂.
///
/// Both products are rounded before the difference. Rounding is monotonic, so the sign is never wrong, only zero where the exact
/// value may not be; and swapping the ends swaps the sign exactly. Both are needed for watertightness, and a fused multiply-add
/// would break them (Woop, Benthin & Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013). A zero is computed again,
/// exactly: the edge of a triangle that is tiny beside its distance from the ray would otherwise seem to pass through the ray.
#[cold]
#[inline(never)]
pub(crate) fn exact_edge(p: [f64; 2], o: [f64; 2]) -> f64 {
    product_difference(p[0], o[1], p[1], o[0])
}

/// 2ᵉ for |e| ≤ 1022.
#[inline]
pub(crate) fn power_of_two(e: i64) -> f64 {
    debug_assert!(e.abs() <= 1022);
    f64::from_bits(((e + 1023) as u64) << 52)
}
