//! A ray prepared for the intersection tests, which are all computed in `f64`.

use crate::{PrimitiveId, Ray};
use etalon_optics::{Real, Vec3};

/// What an intersection test finds, in the parameters of [`Query`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RawHit {
    /// Parameter along [`Query::direction`].
    pub(crate) t: f64,
    /// Surface parameters.
    pub(crate) uv: [f64; 2],
}

/// A ray in `f64`, its direction scaled by a power of two (exactly), and the shear that maps it to the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query {
    pub(crate) origin: Vec3<f64>,
    /// Direction with its largest component in [1, 2).
    pub(crate) direction: Vec3<f64>,
    /// Ray parameter = parameter along [`Query::direction`] × `scale`, a power of two.
    pub(crate) scale: f64,
    /// End, exclusive, along [`Query::direction`].
    pub(crate) t_max: f64,
    pub(crate) leaves: PrimitiveId,
    pub(crate) aims_at: PrimitiveId,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Query {
    /// Prepares a ray; `None` if no point of it is defined: a component is NaN or infinite, the direction is zero or its
    /// magnitude outside 2^±900, or `t_max` is not positive.
    #[inline]
    pub(crate) fn new<R: Real>(ray: &Ray<R>) -> Option<Self> {
        let (origin, direction) = (ray.origin.to_f64(), ray.direction.to_f64());
        let t_max = ray.t_max.to_f64();
        let magnitude = direction.abs().max_component();
        let exponent = (magnitude.to_bits() >> 52) as i64 - 1023;
        let usable = origin.is_finite() && direction.is_finite() && exponent.abs() <= 900 && t_max > 0.0;
        if !usable {
            return None;
        }
        let scale = power_of_two(-exponent);
        let direction = direction * scale;
        let a = direction.abs();
        let kz = if a.x >= a.y && a.x >= a.z { 0 } else { 1 + usize::from(a.z > a.y) };
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        let rz = 1.0 / direction[kz];
        Some(Self {
            origin,
            direction,
            scale,
            t_max: t_max * power_of_two(exponent),
            leaves: ray.leaves,
            aims_at: ray.aims_at,
            axes: [kx, ky, kz],
            shear: [direction[kx] * rz, direction[ky] * rz, rz],
        })
    }

    /// The axes of the projection, the direction's largest component last.
    #[inline]
    pub(crate) fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// The projection's two slopes and 1/(the direction's largest component).
    #[inline]
    pub(crate) fn shear(&self) -> [f64; 3] {
        self.shear
    }

    /// A vertex relative to the origin, sheared so that the ray runs along z and z counts ray parameters; and the
    /// magnitude to which the rounding errors of its x and y are relative.
    ///
    /// The result depends on nothing but the ray and the vertex: triangles that share a vertex agree on it to the bit.
    #[inline]
    pub(crate) fn project(&self, vertex: Vec3<f64>) -> Projected {
        let v = vertex - self.origin;
        let [kx, ky, kz] = self.axes;
        let z = v[kz];
        let (x, y) = (v[kx], v[ky]);
        Projected {
            x: x - self.shear[0] * z,
            y: y - self.shear[1] * z,
            z: z * self.shear[2],
            magnitude: x.abs().max(y.abs()).max(z.abs()),
        }
    }
}

/// A vertex in the sheared frame of a [`Query`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projected {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) z: f64,
    pub(crate) magnitude: f64,
}

impl Projected {
    /// Twice the signed area of the triangle that the ray and the edge from `self` to `o` span in projection.
    ///
    /// Both products are rounded before the difference. Rounding is monotonic, so the sign is never wrong, only zero
    /// where the exact value may not be; and swapping the ends swaps the sign exactly. Both are needed for
    /// watertightness, and a fused multiply-add would break them (Woop, Benthin & Wald, *Watertight Ray/Triangle
    /// Intersection*, JCGT 2(1), 2013).
    #[inline]
    pub(crate) fn edge(self, o: Self) -> f64 {
        self.x * o.y - self.y * o.x
    }
}

/// 2ᵉ for |e| ≤ 1022.
#[inline]
pub(crate) fn power_of_two(e: i64) -> f64 {
    debug_assert!(e.abs() <= 1022);
    f64::from_bits(((e + 1023) as u64) << 52)
}
