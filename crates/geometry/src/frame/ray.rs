//! Rays in the accelerator's frame.

use super::{BoxRay, Frame, FrameRay, above, below};
use crate::query::Query;
use crate::vec4::{Four, Lanes4, larger, projection_axis};
use etalon_optics::Vec3;
use std::array::from_fn;
use std::cmp::Ordering;

/// Least distance at which boxes are entered: above zero, so that those that end at the origin are not.
pub(crate) const LEAST_DISTANCE: f32 = f32::MIN_POSITIVE;
/// Smallest direction component that is divided by: 1e-18 of the largest, at most, for all usual directions.
pub(super) const MIN_DIRECTION: f32 = 1e-21;
/// Relative widening of the distances of a box: (b − o)·(1/d·factor) errs by 5 roundoffs (the difference, `d` as `f32`,
/// its reciprocal, the two products), 2.5ε, and in second order.
const NEAR_FACTOR: f32 = 1.0 - 3.0 * f32::EPSILON;
/// See [`NEAR_FACTOR`].
const FAR_FACTOR: f32 = 1.0 + 3.0 * f32::EPSILON;

impl Frame {
    /// A ray in this frame; `None` if it certainly misses the whole frame.
    #[inline(always)]
    pub(crate) fn enter<L: Lanes4>(&self, token: L::Token, q: &Query) -> Option<FrameRay<L>> {
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
        // Most directions need not be scaled: their reciprocals are.
        let usual = (USUAL_SCALE..=1.0 / USUAL_SCALE).contains(&q.scale);
        let (direction, unit) = if usual { (q.given, q.scale.recip() as f32) } else { (q.direction, 1.0) };
        let limits = [self.distance(start, q.t_max), self.distance_below(start, q.t_max)];
        Some(self.ray(RayParts {
            origin: L::new(token, [origin[0], origin[1], origin[2], 0.0]),
            inexact: Some(L::new(token, [inexact(0), inexact(1), inexact(2), 0.0])),
            direction: L::new(token, [direction.x as f32, direction.y as f32, direction.z as f32, 0.0]),
            unit,
            factors: [-NEAR_FACTOR * unit, -FAR_FACTOR * unit],
            limits,
            axis: q.projection.axis,
            reach,
            slack,
            start,
            t_max: q.t_max,
            t_scale: q.scale,
        }))
    }

    /// What [`Frame::enter`] gives for the [`Query`] of a ray, given by its origin and its direction in three lanes and its end
    /// as a function of parameters along [`Query::direction`] for one along the direction; at less cost, but only for rays
    /// that start near the frame and whose direction needs no scaling. `None` for any other.
    #[inline(always)]
    pub(crate) fn enter_near<F: Four>(
        &self,
        token: F::Token,
        [origin, direction]: [F; 2],
        t_max: impl FnOnce(f64) -> f64,
    ) -> Option<FrameRay<F::Narrow>> {
        let Vec3 { x, y, z } = self.centre;
        let o = (origin - F::new(token, [x, y, z, 0.0])) * F::splat(token, self.scale);
        let (reach, magnitudes) = (o.abs(), direction.abs());
        // Bits of numbers that are not negative are ordered as they are, and compared sooner.
        let bits = magnitudes.to_array().map(f64::to_bits);
        let magnitude = larger(larger(bits[0], bits[1]), bits[2]);
        // False if a component is NaN.
        let near = reach.all_at_most(NEAR_REACH) && magnitudes.all_at_most(1.0 / USUAL_SCALE);
        if !(near && magnitude >= USUAL_SCALE.to_bits()) {
            return None;
        }
        // The power of two below, and its inverse: the exponent alone, and that turned about zero.
        const EXPONENT: u64 = 0x7FF << 52;
        let exponent = magnitude & EXPONENT;
        let (unit, t_scale) = (f64::from_bits(exponent), f64::from_bits((2046 << 52) - exponent));
        let t_max = t_max(unit);
        // A NaN is none either.
        if t_max.partial_cmp(&0.0) != Some(Ordering::Greater) {
            return None;
        }
        let origin = o.narrowed();
        let axis = projection_axis(bits);
        // What is multiplied by the unit has its exponent added, which takes half as long as to round the unit and to multiply.
        let power = ((exponent >> 52) as u32).wrapping_sub(1023) << 23;
        Some(self.ray(RayParts {
            origin,
            inexact: Some(o.differs(origin)),
            direction: direction.narrowed(),
            unit: f32::from_bits(1.0_f32.to_bits().wrapping_add(power)),
            factors: scaled_factors(power),
            limits: self.limits(t_max),
            axis,
            reach: reach.largest(),
            slack: SLACK,
            start: 0.0,
            t_max,
            t_scale,
        }))
    }

    /// [`Frame::enter_near`] of a ray in `f32`, three lanes and a zero each, in a frame that only scales: no number is rounded (if
    /// not by less than [`SLACK`], where one is all but zero).
    #[inline(always)]
    pub(crate) fn enter_exact<L: Lanes4>(
        &self,
        [origin, direction]: [L; 2],
        t_max: impl FnOnce(f64) -> f64,
    ) -> Option<FrameRay<L>> {
        if !self.scales {
            return None;
        }
        let origin = origin.times(self.scale as f32);
        let (reach, magnitudes) = (origin.abs(), direction.abs());
        let [rx, ry, rz, _] = reach.to_array();
        // Bits of numbers that are not negative are ordered as they are, and compared sooner.
        let [ax, ay, az, _] = magnitudes.to_array().map(f32::to_bits);
        let magnitude = larger(larger(ax, ay), az);
        let near = reach.all_at_most(NEAR_REACH as f32) && magnitudes.all_at_most(1.0 / USUAL_SCALE as f32);
        if !(near && magnitude >= (USUAL_SCALE as f32).to_bits()) {
            return None;
        }
        // See `enter_near`.
        let power = (magnitude & 0xFF << 23).wrapping_sub(1.0_f32.to_bits());
        let double = 1.0_f64.to_bits() as i64;
        let exponent = i64::from(power as i32) << 29;
        let (unit, t_scale) = (f64::from_bits((double + exponent) as u64), f64::from_bits((double - exponent) as u64));
        let t_max = t_max(unit);
        if t_max.partial_cmp(&0.0) != Some(Ordering::Greater) {
            return None;
        }
        Some(self.ray(RayParts {
            origin,
            inexact: None,
            direction,
            unit: f32::from_bits(1.0_f32.to_bits().wrapping_add(power)),
            factors: scaled_factors(power),
            limits: self.limits(t_max),
            axis: projection_axis([ax, ay, az, 0]),
            reach: f64::from(larger(larger(rx, ry), rz)),
            slack: SLACK,
            start: 0.0,
            t_max,
            t_scale,
        }))
    }

    /// What [`Frame::enter`] gives for the [`Query`] of a ray, as [`Frame::enter_near`] does, wherever the ray starts: a frame is
    /// small beside the distances from which rays meet an instance.
    #[inline(always)]
    pub(crate) fn enter_anywhere<F: Four>(
        &self,
        token: F::Token,
        [origin, direction]: [F; 2],
        t_max: f64,
    ) -> Entry<F::Narrow> {
        let Vec3 { x, y, z } = self.centre;
        let o = (origin - F::new(token, [x, y, z, 0.0])) * F::splat(token, self.scale);
        let (reach, magnitudes) = (o.abs(), direction.abs());
        let bits = magnitudes.to_array().map(f64::to_bits);
        let magnitude = larger(larger(bits[0], bits[1]), bits[2]);
        // False if a component is NaN.
        let usual = reach.all_at_most(AFAR) && magnitudes.all_at_most(GREATEST);
        if !(usual && magnitude >= (1.0 / GREATEST).to_bits()) {
            return Entry::Unknown;
        }
        // See `enter_near`.
        const EXPONENT: u64 = 0x7FF << 52;
        let exponent = magnitude & EXPONENT;
        let (unit, t_scale) = (f64::from_bits(exponent), f64::from_bits((2046 << 52) - exponent));
        let t_max = t_max * unit;
        if t_max.partial_cmp(&0.0) != Some(Ordering::Greater) {
            return Entry::Unknown;
        }
        let axis = projection_axis(bits);
        let direction = direction * F::splat(token, t_scale);
        let farthest = reach.largest();
        let mut parts = RayParts {
            origin: o.narrowed(),
            inexact: None,
            direction: direction.narrowed(),
            unit: 1.0,
            factors: [-NEAR_FACTOR, -FAR_FACTOR],
            limits: [0.0; 2],
            axis,
            reach: farthest,
            slack: SLACK,
            start: 0.0,
            t_max,
            t_scale,
        };
        if farthest > NEAR_REACH {
            // To the plane that the frame's [−1, 1]³ turns towards the ray along its largest component. What the ray meets of the
            // frame is up to 2 beyond that plane, so up to 2 aside of where the ray passes it, and up to 1 from the axis: a ray that
            // passes it farther than 3 from the axis misses all. So does one that starts beyond the plane, but more than 4
            // away along some axis: it is behind the frame, or as much as 3 aside, and gets no nearer than 1 by the frame's end.
            let along = axis.min(2);
            let per_unit = 1.0 / direction.to_array()[along];
            let start = -(o.to_array()[along] * per_unit) - per_unit.abs();
            let moved = o + direction * F::splat(token, start);
            // Of NaN neither holds.
            if !(start > 0.0 && moved.abs().all_at_most(NEAR_REACH)) {
                return Entry::Misses;
            }
            parts.origin = moved.narrowed();
            parts.inexact = Some(F::splat(token, 1.0).narrowed());
            parts.reach = moved.abs().largest();
            parts.slack = (farthest + 2.0) * (128.0 * f64::EPSILON);
            parts.start = start;
        } else {
            parts.inexact = Some(o.differs(parts.origin));
        }
        parts.limits = [self.distance(parts.start, t_max), self.distance_below(parts.start, t_max)];
        Entry::Ray(self.ray(parts))
    }

    /// [`Frame::distance`] and [`Frame::distance_below`] of a start at zero.
    #[inline(always)]
    fn limits(&self, t_max: f64) -> [f32; 2] {
        // 4 roundoffs cover what accepted distances err by, the rounding to `f32`, and that of the product and of the sum.
        let distance = (t_max * self.scale) as f32;
        let known = if distance < FARTHEST { distance } else { FARTHEST };
        let error = |distance: f32| distance * (2.0 * f32::EPSILON) + f32::MIN_POSITIVE;
        [distance + error(distance), known - error(known)]
    }

    #[inline(always)]
    fn ray<L: Lanes4>(&self, parts: RayParts<L>) -> FrameRay<L> {
        let RayParts { origin, inexact, direction, unit, factors, limits, axis, reach, slack, start, t_max, t_scale } =
            parts;
        // Unless it is exact the origin is displaced along the ray and against it by more than its error: an `f32` ε of it
        // covers its rounding and that of the displaced one, half an ε each; another one, second orders.
        let [origin_near, origin_far] = match inexact {
            Some(inexact) => {
                let error = origin.abs().times(2.0 * f32::EPSILON).plus(above(slack));
                let displaced = error.product(inexact).signed_as(direction);
                [origin.sum(displaced), origin.difference(displaced)]
            }
            None => [origin; 2],
        };
        let reciprocal = direction.abs().at_least(MIN_DIRECTION).signed_as(direction).reciprocal();
        // Of the largest component, which is not clamped.
        let slope = reciprocal.turned(axis).to_array()[2];
        FrameRay {
            boxes: BoxRay {
                origin_near,
                origin_far,
                reciprocal_near: reciprocal.times(factors[0]),
                reciprocal_far: reciprocal.times(factors[1]),
                negative: direction.negative(),
            },
            axis,
            start_along: origin.turned(axis),
            slopes: direction.turned(axis).times(slope),
            per_depth: slope * unit,
            // A little more than what is stated, for the rounding of the reach, the product and the sum.
            error: reach as f32 * (PROJECTION_ERROR as f32 * (1.0 + 8.0 * f32::EPSILON)) + above(2.0 * slack),
            limit: limits[0],
            certain_limit: limits[1],
            start,
            t_max,
            t_scale,
        }
    }

    /// A distance in this frame that is not below the distance of any hit up to `t` of the [`Query`] of a ray that was moved by
    /// [`FrameRay::start`].
    #[inline]
    pub(crate) fn distance(&self, start: f64, t: f64) -> f32 {
        // Accepted distances err by up to 2⁻³⁰ of themselves.
        const WIDER: f64 = 1.0 + 1.0 / (1_u64 << 29) as f64;
        above(t * self.scale * WIDER - start).max(0.0)
    }

    /// A distance in this frame that is not above the distance of any hit beyond `t` of the [`Query`].
    #[inline]
    fn distance_below(&self, start: f64, t: f64) -> f32 {
        const NARROWER: f64 = 1.0 - 1.0 / (1_u64 << 29) as f64;
        let t = t * self.scale * NARROWER - start;
        let farthest = f64::from(FARTHEST);
        below(if t < farthest { t } else { farthest })
    }
}

/// What [`Frame::enter_anywhere`] finds of a ray.
pub(crate) enum Entry<L> {
    /// The ray in the frame.
    Ray(FrameRay<L>),
    /// It certainly misses the whole frame.
    Misses,
    /// [`Frame::enter`] knows.
    Unknown,
}

/// Rays from as far as this, in units of the frame (2²⁰), are moved near it without a second thought: what their origins err by is
/// below 2⁻²⁴.
const AFAR: f64 = (1_u32 << 20) as f64;
/// Directions up to this (2²⁰⁰), and down to its inverse, can be scaled by powers of two.
const GREATEST: f64 = (1_u128 << 100) as f64 * (1_u128 << 100) as f64;

/// The negative factors of near and far distances times a power of two, the bits that it adds.
#[inline(always)]
fn scaled_factors(power: u32) -> [f32; 2] {
    [-NEAR_FACTOR, -FAR_FACTOR].map(|factor| f32::from_bits(factor.to_bits().wrapping_add(power)))
}

/// Beyond this nothing is in the frame.
const FARTHEST: f32 = 1e30;

/// What a [`FrameRay`] is made of: three lanes of the origin, rounded; 1 in those where that changed it, or where it is not known,
/// else 0, or none if it changed none; the direction as it was given or [`Query::direction`], rounded; parameters along [`Query::direction`] for one along
/// that, times one, and times the negative factors of near and far distances; the end, not too near and not too far; the axis of the projection; the largest magnitude of the origin and the bound on its error before it was rounded; and
/// fields of the same names.
struct RayParts<L> {
    origin: L,
    inexact: Option<L>,
    direction: L,
    unit: f32,
    factors: [f32; 2],
    limits: [f32; 2],
    axis: usize,
    reach: f64,
    slack: f64,
    start: f64,
    t_max: f64,
    t_scale: f64,
}

/// Bound on the error of the projected coordinates of a vertex, over the sum of the largest magnitudes of its own and of the
/// origin's.
///
/// Relative to the origin they are below that sum, and err by two roundoffs of it (the vertex, the origin and the difference
/// are rounded); shearing adds nine (the slope four, for the two components, the reciprocal and the product, the other
/// difference two, the product, the sum two). One more is for the rounding of the bound.
pub(super) const PROJECTION_ERROR: f64 = 12.0 * 0.5 * f32::EPSILON as f64;

/// A ray whose origin's coordinates in the frame are below this is near the frame.
const NEAR_REACH: f64 = 4.0;
/// The f64 tests are right for a ray displaced by a few u of the distances involved: 256u of them is allowed.
pub(super) const SLACK: f64 = (NEAR_REACH + 2.0) * (128.0 * f64::EPSILON);
/// Directions whose scale to [`Query::direction`] is no smaller than this, nor larger than its inverse, are taken as they
/// are.
const USUAL_SCALE: f64 = 1.0 / 256.0;

#[inline(always)]
fn frame_coordinates(p: Vec3<f64>, frame: &Frame) -> [f64; 3] {
    frame.place(p).to_array()
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
