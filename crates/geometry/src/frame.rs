//! The accelerator's own frame, and rays in it.
//!
//! Boxes and their traversal are in `f32`, in a frame centred on the scene and scaled by an exact power of two so that
//! every coordinate lies in [−1, 1]. A ray enters it with bounds on all that was rounded on the way, so that a box test
//! never rejects a box that holds a primitive which the `f64` test would accept.

use crate::Aabb;
use crate::query::{Query, larger, power_of_two};
use etalon_optics::Vec3;
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
        let [x, y, z] = from_fn(|k| self.max[k] - self.min[k]);
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }
}

/// A translation and a scaling by a power of two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    centre: Vec3<f64>,
    scale: f64,
    unscale: f64,
}

/// Boxes are widened by this much (2⁻⁴²): more than [`SLACK`], and more than a ray whose direction component was clamped to
/// [`MIN_DIRECTION`] can leave its slab by within the frame.
///
/// An origin that `f32` represents is therefore taken as it is, and a box that ends at it is not entered: all that is in the box
/// lies farther back. For a ray that leaves a plane this spares the way down to the plane's other primitives.
const BOX_MARGIN: f64 = 1.0 / (1_u64 << 42) as f64;
/// Least distance at which boxes are entered: above zero, so that those that end at the origin are not.
pub(crate) const LEAST_DISTANCE: f32 = f32::MIN_POSITIVE;
/// Smallest direction component that is divided by: 1e-18 of the largest, at most, for all usual directions.
const MIN_DIRECTION: f32 = 1e-21;
/// Relative widening of the distances of a box: (b − o)·(1/d·factor) errs by 5 roundoffs (the difference, `d` as `f32`,
/// its reciprocal, the two products), 2.5ε, and in second order.
const NEAR_FACTOR: f32 = 1.0 - 3.0 * f32::EPSILON;
/// See [`NEAR_FACTOR`].
const FAR_FACTOR: f32 = 1.0 + 3.0 * f32::EPSILON;

impl Frame {
    /// The frame in which a box becomes no larger than [−1, 1], and centred unless it holds the origin.
    ///
    /// About the origin nothing is translated, so that coordinates which `f32` represents stay exact.
    pub(crate) fn around(bounds: Aabb) -> Self {
        let centre = if bounds.contains(Vec3::ZERO) { Vec3::ZERO } else { bounds.centre() };
        let half = (bounds.max - centre).abs().max((bounds.min - centre).abs()).max_component();
        let exponent = if half > 0.0 { (half.to_bits() >> 52) as i64 - 1022 } else { 0 };
        let exponent = exponent.clamp(-500, 500);
        Self { centre, scale: power_of_two(-exponent), unscale: power_of_two(exponent) }
    }

    /// A box in this frame, rounded outward.
    pub(crate) fn enclose(&self, b: Aabb) -> Box32 {
        let lower = (b.min - self.centre) * self.scale;
        let upper = (b.max - self.centre) * self.scale;
        Box32 { min: from_fn(|k| round_down(lower[k] - BOX_MARGIN)), max: from_fn(|k| round_up(upper[k] + BOX_MARGIN)) }
    }

    /// A point in this frame, rounded.
    pub(crate) fn point(&self, p: Vec3<f64>) -> [f32; 3] {
        ((p - self.centre) * self.scale).to_array().map(|c| c as f32)
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

    /// The point of which [`Frame::point`] gave the coordinates, if they are exact.
    fn unscaled(&self, p: [f32; 3]) -> Vec3<f64> {
        Vec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2])) * self.unscale
    }

    /// A ray in this frame; `None` if it certainly misses the whole frame.
    #[inline(always)]
    pub(crate) fn enter(&self, q: &Query) -> Option<FrameRay> {
        let mut o = frame_coordinates(q.origin, self);
        let mut reach = max_magnitude(o);
        let mut start = 0.0;
        let mut slack = SLACK;
        if reach > NEAR_REACH {
            (o, slack, start) = approach(o, q.direction.to_array(), (reach + 2.0) * (128.0 * f64::EPSILON))?;
            reach = max_magnitude(o);
        }
        let origin = o.map(|o| o as f32);
        let inexact = |k: usize| if slack > SLACK || f64::from(origin[k]) != o[k] { 1.0 } else { 0.0 };
        let inexact = [inexact(0), inexact(1), inexact(2)];
        // Most directions need not be scaled: their reciprocals are.
        let usual = (USUAL_SCALE..=1.0 / USUAL_SCALE).contains(&q.scale);
        let (direction, unit) = if usual { (q.given, q.scale.recip() as f32) } else { (q.direction, 1.0) };
        let direction = direction.to_array().map(|d| d as f32);
        let [kx, ky, kz] = q.axes.map(|k| k.min(2));
        let slope = 1.0 / direction[kz];
        Some(FrameRay {
            origin,
            inexact,
            direction,
            unit,
            slack: above(slack),
            axes: [kx, ky, kz],
            start_along: [origin[kx], origin[ky], origin[kz]],
            shear: [direction[kx] * slope, direction[ky] * slope, slope * unit],
            error: above(reach * PROJECTION_ERROR + 2.0 * slack),
            scale: self.scale,
            start,
        })
    }
}

/// Bound on the error of the projected coordinates of a vertex, over the sum of the largest magnitudes of its own and of the
/// origin's.
///
/// Relative to the origin they are below that sum, and err by two roundoffs of it (the vertex, the origin and the difference
/// are rounded); shearing adds nine (the slope four, for the two components, the reciprocal and the product, the other
/// difference two, the product, the sum two). One more is for the rounding of the bound.
const PROJECTION_ERROR: f64 = 12.0 * 0.5 * f32::EPSILON as f64;

/// A ray whose origin's coordinates in the frame are below this is near the frame.
const NEAR_REACH: f64 = 4.0;
/// The f64 tests are right for a ray displaced by a few u of the distances involved: 256u of them is allowed.
const SLACK: f64 = (NEAR_REACH + 2.0) * (128.0 * f64::EPSILON);
/// Directions whose scale to [`Query::direction`] is no smaller than this, nor larger than its inverse, are taken as they
/// are.
const USUAL_SCALE: f64 = 1.0 / 256.0;

#[inline(always)]
fn frame_coordinates(p: Vec3<f64>, frame: &Frame) -> [f64; 3] {
    ((p - frame.centre) * frame.scale).to_array()
}

#[inline(always)]
fn max_magnitude(v: [f64; 3]) -> f64 {
    larger(larger(v[0].abs(), v[1].abs()), v[2].abs())
}

/// Moves the origin of a ray from far away to near the frame, in `f64`: from there its `f32` origin would blur the boxes.
/// Returns the origin, the slack and the distance moved; `None` if the ray misses the frame.
#[cold]
#[inline(never)]
fn approach(o: [f64; 3], d: [f64; 3], slack: f64) -> Option<([f64; 3], f64, f64)> {
    let (near, far) = crossing(o, d, 1.0 + slack);
    if near > far || far < 0.0 {
        return None;
    }
    let start = (near - 1.0).max(0.0);
    let moved: [f64; 3] = from_fn(|k| o[k] + d[k] * start);
    let slack = slack.min(16.0);
    let known = max_magnitude(moved) < 64.0;
    // An origin so far away that nothing is known of where the ray passes meets every box.
    Some(if known { (moved, slack, start) } else { ([0.0; 3], 16.0, 0.0) })
}

/// A ray in the accelerator's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameRay {
    /// The origin, rounded.
    origin: [f32; 3],
    /// 1 where that changed it, or where it is not known, else 0.
    inexact: [f32; 3],
    /// The direction as it was given, or [`Query::direction`]; rounded.
    direction: [f32; 3],
    /// Parameters along [`Query::direction`] for one along `direction`.
    unit: f32,
    /// Bound on the error of the origin before it was rounded.
    slack: f32,
    /// The axes of the watertight projection, the direction's largest component last.
    pub(crate) axes: [usize; 3],
    /// The origin along `axes`.
    pub(crate) start_along: [f32; 3],
    /// The projection's slopes and 1/(the direction's largest component), rounded.
    pub(crate) shear: [f32; 3],
    /// The ray's part of the bound on the error of a vertex's projected coordinates.
    pub(crate) error: f32,
    scale: f64,
    start: f64,
}

/// What the test of boxes needs of a ray; the fourth lanes are not used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxRay {
    /// The origin displaced along the ray by more than its error: for the planes where the ray enters boxes.
    pub(crate) origin_near: [f32; 4],
    /// The origin displaced against the ray by more than its error: for the planes where the ray leaves boxes.
    pub(crate) origin_far: [f32; 4],
    /// 1/direction, finite, with the sign of the direction's sign bit, and a little smaller: a distance ahead comes out
    /// no larger than it is.
    pub(crate) reciprocal_near: [f32; 4],
    /// The same, a little larger: a distance ahead comes out no smaller than it is.
    pub(crate) reciprocal_far: [f32; 4],
    /// The direction's sign bits.
    pub(crate) negative: [usize; 3],
}

impl FrameRay {
    /// What the test of boxes needs.
    #[inline(always)]
    pub(crate) fn for_boxes<L: Lanes4>(&self) -> BoxRay {
        let ([ox, oy, oz], [dx, dy, dz]) = (self.origin, self.direction);
        let (o, d) = (L::new([ox, oy, oz, 0.0]), L::new([dx, dy, dz, 1.0]));
        let [ix, iy, iz] = self.inexact;
        // Unless it is exact the origin is displaced along the ray and against it by more than its error: an `f32` ε of it covers its rounding and
        // that of the displaced one, half an ε each; another one, second orders.
        let error = o.abs().times(2.0 * f32::EPSILON).plus(self.slack);
        let displaced = error.product(L::new([ix, iy, iz, 0.0])).signed_as(d);
        let reciprocal = d.abs().at_least(MIN_DIRECTION).signed_as(d).reciprocal();
        let unit = self.unit;
        BoxRay {
            origin_near: o.sum(displaced).to_array(),
            origin_far: o.difference(displaced).to_array(),
            reciprocal_near: reciprocal.times(unit * NEAR_FACTOR).to_array(),
            reciprocal_far: reciprocal.times(unit * FAR_FACTOR).to_array(),
            negative: d.negative(),
        }
    }

    /// A distance in this frame that is not below the distance of any hit up to `t` of the [`Query`].
    #[inline]
    pub(crate) fn distance(&self, t: f64) -> f32 {
        // Accepted distances err by up to 2⁻³⁰ of themselves.
        const WIDER: f64 = 1.0 + 1.0 / (1_u64 << 29) as f64;
        above(t * self.scale * WIDER - self.start).max(0.0)
    }

    /// A distance in this frame that is not above the distance of any hit beyond `t` of the [`Query`].
    #[inline]
    pub(crate) fn distance_below(&self, t: f64) -> f32 {
        const NARROWER: f64 = 1.0 - 1.0 / (1_u64 << 29) as f64;
        let t = t * self.scale * NARROWER - self.start;
        // Beyond this nothing is in the frame.
        below(if t < 1e30 { t } else { 1e30 })
    }
}

/// Four floats, whatever the instruction set.
pub(crate) trait Lanes4: Copy {
    fn new(v: [f32; 4]) -> Self;
    fn to_array(self) -> [f32; 4];
    fn abs(self) -> Self;
    fn sum(self, o: Self) -> Self;
    fn difference(self, o: Self) -> Self;
    fn product(self, o: Self) -> Self;
    fn times(self, factor: f32) -> Self;
    fn plus(self, v: f32) -> Self;
    fn at_least(self, v: f32) -> Self;
    fn reciprocal(self) -> Self;
    /// The magnitudes of positive numbers with the sign bits of others.
    fn signed_as(self, o: Self) -> Self;
    /// The sign bits of the first three.
    fn negative(self) -> [usize; 3];
}

/// [`Lanes4`] in plain Rust.
#[derive(Clone, Copy)]
pub(crate) struct Plain([f32; 4]);

impl Lanes4 for Plain {
    #[inline(always)]
    fn new(v: [f32; 4]) -> Self {
        Self(v)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 4] {
        self.0
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i] + o.0[i]))
    }

    #[inline(always)]
    fn difference(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i] - o.0[i]))
    }

    #[inline(always)]
    fn product(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i] * o.0[i]))
    }

    #[inline(always)]
    fn times(self, factor: f32) -> Self {
        Self(self.0.map(|v| v * factor))
    }

    #[inline(always)]
    fn plus(self, v: f32) -> Self {
        Self(self.0.map(|w| w + v))
    }

    #[inline(always)]
    fn at_least(self, v: f32) -> Self {
        Self(self.0.map(|w| if w > v { w } else { v }))
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self(self.0.map(|v| 1.0 / v))
    }

    #[inline(always)]
    fn signed_as(self, o: Self) -> Self {
        Self(from_fn(|i| self.0[i].copysign(o.0[i])))
    }

    #[inline(always)]
    fn negative(self) -> [usize; 3] {
        from_fn(|i| usize::from(self.0[i].is_sign_negative()))
    }
}

/// Where a line crosses the box [−`half`, `half`]³.
fn crossing(o: [f64; 3], d: [f64; 3], half: f64) -> (f64, f64) {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        if d[k] != 0.0 {
            let (t0, t1) = ((-half - o[k]) / d[k], (half - o[k]) / d[k]);
            near = near.max(t0.min(t1));
            far = far.min(t0.max(t1));
        } else if o[k].abs() > half {
            return (f64::INFINITY, f64::NEG_INFINITY);
        }
    }
    // Each bound errs by a few u of itself.
    let error = |t: f64| t.abs() * (8.0 * f64::EPSILON);
    (near - error(near), far + error(far))
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
fn below(v: f64) -> f32 {
    let r = v as f32;
    r - (r.abs() * f32::EPSILON + f32::MIN_POSITIVE)
}

/// An `f32` not below `v` by at most two roundoffs, without a branch.
#[inline(always)]
fn above(v: f64) -> f32 {
    let r = v as f32;
    r + (r.abs() * f32::EPSILON + f32::MIN_POSITIVE)
}
