//! The accelerator's own frame, and rays in it.
//!
//! Boxes and their traversal are in `f32`, in a frame centred on the scene and scaled by an exact power of two so that
//! every coordinate lies in [−1, 1]. A ray enters it with bounds on all that was rounded on the way, so that a box test
//! never rejects a box that holds a primitive which the `f64` test would accept.

mod ray;
mod set_out;

use crate::Aabb;
use crate::query::power_of_two;
use etalon_optics::Vec3;
use ray::PROJECTION_ERROR;
pub(crate) use ray::{Entry, LEAST_DISTANCE};
pub(crate) use set_out::{BoxRay, FrameRay};
use std::array::from_fn;

/// A box in the accelerator's frame, rounded outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Box32 {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Box32 {
    /// Half the surface area; zero for the empty box.
    #[inline]
    pub(crate) fn half_area(&self) -> f32 {
        let sides = self.sides();
        if sides[0] < 0.0 { 0.0 } else { half_area(sides) }
    }

    /// Its sides.
    #[inline]
    pub(crate) fn sides(&self) -> [f32; 3] {
        from_fn(|k| self.max[k] - self.min[k])
    }
}

/// Half the surface area of a box with these sides.
#[inline(always)]
pub(crate) fn half_area([x, y, z]: [f32; 3]) -> f32 {
    x * y + y * z + z * x
}

/// A translation and a scaling by a power of two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    centre: Vec3<f64>,
    scale: f64,
    unscale: f64,
    /// Whether nothing is translated, and `f32` holds the scale.
    scales: bool,
}

/// Boxes are widened by this much (2⁻⁴²): more than [`ray::SLACK`], and more than a ray whose direction component was clamped to
/// [`ray::MIN_DIRECTION`] can leave its slab by within the frame.
///
/// An origin that `f32` represents is therefore taken as it is, and a box that ends at it is not entered: all that is in the box
/// lies farther back. For a ray that leaves a plane this spares the way down to the plane's other primitives.
const BOX_MARGIN: f64 = 1.0 / (1_u64 << 42) as f64;

impl Frame {
    /// The frame in which a box becomes no larger than [−1, 1], and centred unless it holds the origin.
    ///
    /// About the origin nothing is translated, so that coordinates which `f32` represents stay exact.
    pub(crate) fn around(bounds: Aabb) -> Self {
        let centre = if bounds.contains(Vec3::ZERO) { Vec3::ZERO } else { bounds.centre() };
        let half = (bounds.max - centre).abs().max((bounds.min - centre).abs()).max_component();
        let exponent = if half > 0.0 { (half.to_bits() >> 52) as i64 - 1022 } else { 0 };
        let exponent = exponent.clamp(-500, 500);
        let scales = centre == Vec3::ZERO && exponent.abs() <= 100;
        Self { centre, scale: power_of_two(-exponent), unscale: power_of_two(exponent), scales }
    }

    /// A box in this frame, rounded outward.
    pub(crate) fn enclose(&self, b: Aabb) -> Box32 {
        let lower = (b.min - self.centre) * self.scale;
        let upper = (b.max - self.centre) * self.scale;
        Box32 { min: from_fn(|k| round_down(lower[k] - BOX_MARGIN)), max: from_fn(|k| round_up(upper[k] + BOX_MARGIN)) }
    }

    /// A point in this frame.
    #[inline(always)]
    pub(crate) fn place(&self, p: Vec3<f64>) -> Vec3<f64> {
        (p - self.centre) * self.scale
    }

    /// What is at the origin of this frame, m.
    #[inline(always)]
    pub(crate) fn centre(&self) -> Vec3<f64> {
        self.centre
    }

    /// A metre in units of this frame.
    #[inline(always)]
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// A point in this frame, rounded.
    pub(crate) fn point(&self, p: Vec3<f64>) -> [f32; 3] {
        self.place(p).to_array().map(|c| c as f32)
    }

    /// Whether the coordinates of a point in this frame are exact in `f32`.
    pub(crate) fn is_exact(&self, p: Vec3<f64>) -> bool {
        self.centre == Vec3::ZERO && self.unscaled(self.point(p)) == p
    }

    /// The part of a leaf in the bound on the error of its vertices' projected coordinates, if none is larger than `magnitude`.
    pub(crate) fn projection_error(magnitude: f32) -> f32 {
        above(f64::from(magnitude) * PROJECTION_ERROR)
    }

    /// A length in this frame, rounded.
    pub(crate) fn length(&self, l: f64) -> f32 {
        (l * self.scale) as f32
    }

    /// What a unit of this frame is, m.
    #[inline(always)]
    pub(crate) fn unscale(&self) -> f64 {
        self.unscale
    }

    /// A box of this frame where it is, to rounding.
    pub(crate) fn unscaled_box(&self, b: Box32) -> Aabb {
        Aabb { min: self.unscaled(b.min) + self.centre, max: self.unscaled(b.max) + self.centre }
    }

    /// The point of which [`Frame::point`] gave the coordinates, if they are exact.
    fn unscaled(&self, p: [f32; 3]) -> Vec3<f64> {
        Vec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2])) * self.unscale
    }
}

/// The largest `f32` not above `v`.
#[inline]
pub(crate) fn round_down(v: f64) -> f32 {
    let r = v as f32;
    if f64::from(r) > v { r.next_down() } else { r }
}

/// The smallest `f32` not below `v`.
#[inline]
pub(crate) fn round_up(v: f64) -> f32 {
    let r = v as f32;
    if f64::from(r) < v { r.next_up() } else { r }
}

/// An `f32` not above `v` by at most two roundoffs, without a branch: a ray's rounding is as good as random.
#[inline(always)]
pub(crate) fn below(v: f64) -> f32 {
    lowered(v as f32)
}

/// An `f32` not below `v` by at most two roundoffs, without a branch.
#[inline(always)]
pub(crate) fn above(v: f64) -> f32 {
    raised(v as f32)
}

/// [`below`] of what was rounded to `r`.
#[inline(always)]
pub(crate) fn lowered(r: f32) -> f32 {
    r - (r.abs() * f32::EPSILON + f32::MIN_POSITIVE)
}

/// [`above`] of what was rounded to `r`.
#[inline(always)]
pub(crate) fn raised(r: f32) -> f32 {
    r + (r.abs() * f32::EPSILON + f32::MIN_POSITIVE)
}
