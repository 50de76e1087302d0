//! What `f32` tells of a ray and a primitive, in each lane of a vector: of many primitives for one ray, or of some for each of
//! eight.
//!
//! **Bounds.** u is the unit roundoff, 2⁻²⁴. In the accelerator's frame no corner or centre has a component above the `reach` of
//! the geometry, at least 1, nor the origin one above its own; s is the sum of the two, so that no component of a vector from
//! the origin to a primitive exceeds it, nor does the distance of a hit (the direction's largest component is in [1, 2)).
//!
//! A component of r = corner − origin errs by 2us, of q = r × d by 20us. An edge, scaled, is below 2 and errs by 2u: its product
//! with q, an edge function, by 208us. The normal n has a largest component N ≤ 8·reach ≤ 8s: its product with d errs by 28uN ≤
//! 224us, with r by 17usN. The third edge function is the product with d less the other two: it errs by 740us with its
//! roundings. So all err by less than 768us.
//!
//! A hit at the true distance t ≤ s, found as (n·r)/(n·d), errs by (17usN + 28uN·t)/|n·d| and two roundoffs: together with
//! whatever `f64` errs by, within 48uN·s/|n·d| + 4us, if |n·d| > 48uN. Else no distance is known.

use super::block::{BLOCK, Flats, Spheres};
use super::wide::Wide;

const U: f32 = 0.5 * f32::EPSILON;

/// What the filters want to know of a ray, number by number.
pub(crate) type Beam = [f32; 11];
/// Where in a [`Beam`] are: the origin in the frame,
pub(crate) const ORIGIN: usize = 0;
/// the direction, scaled by a power of two so that its largest component is in [1, 2),
pub(crate) const DIRECTION: usize = 3;
/// s,
pub(crate) const REACH: usize = 6;
/// what is not below the distance of any hit that counts,
pub(crate) const LIMIT: usize = 7;
/// what is not above the distance of any hit that does not,
pub(crate) const CERTAIN_LIMIT: usize = 8;
/// the primitive left,
pub(crate) const LEAVES: usize = 9;
/// and the one aimed at.
pub(crate) const AIMS_AT: usize = 10;

/// One ray, or eight, in vectors.
pub(crate) struct Beams<V> {
    origin: [V; 3],
    direction: [V; 3],
    reach: V,
    edge_error: V,
    t_error: V,
    limit: V,
    certain_limit: V,
    leaves: V,
    pub(crate) aims_at: V,
    zero: V,
    one: V,
}

impl<V: Wide> Beams<V> {
    /// From a vector for each place in a [`Beam`].
    #[inline(always)]
    pub(crate) fn new(of: [V; size_of::<Beam>() / 4], token: V::Token) -> Self {
        let reach = of[REACH];
        Self {
            origin: [of[ORIGIN], of[ORIGIN + 1], of[ORIGIN + 2]],
            direction: [of[DIRECTION], of[DIRECTION + 1], of[DIRECTION + 2]],
            reach,
            edge_error: reach * V::splat(token, 768.0 * U),
            t_error: reach * V::splat(token, 4.0 * U),
            limit: of[LIMIT],
            certain_limit: of[CERTAIN_LIMIT],
            leaves: of[LEAVES],
            aims_at: of[AIMS_AT],
            zero: V::splat(token, 0.0),
            one: V::splat(token, 1.0),
        }
    }
}

/// What the spheres want to know besides.
pub(crate) struct SphereFilter<V> {
    squared: V,
    per_squared: V,
    longer: V,
    shorter: V,
    slack: V,
    t_error: V,
    larger: V,
    smaller: V,
}

impl<V: Wide> SphereFilter<V> {
    #[inline(always)]
    pub(crate) fn new(token: V::Token, beams: &Beams<V>) -> Self {
        let all = |v| V::splat(token, v);
        let squared = dot(beams.direction, beams.direction);
        let per_squared = beams.one / squared;
        Self {
            squared,
            per_squared,
            longer: per_squared * all(1.0 + 64.0 * U),
            shorter: per_squared * all(1.0 - 64.0 * U),
            slack: beams.reach * all(40.0 * U),
            t_error: beams.reach * all(64.0 * U),
            larger: all(1.0 + 64.0 * U),
            smaller: all(1.0 - 64.0 * U),
        }
    }
}

/// What is known of a ray and a primitive.
pub(crate) struct Known<V: Wide> {
    /// Where there may be a hit that counts.
    pub(crate) met: V::Mask,
    /// Where there certainly is one.
    pub(crate) certain: V::Mask,
    /// Not above its distance.
    pub(crate) near: V,
    /// Not below its distance, where it is certain.
    pub(crate) far: V,
}

/// Rows of [`Flats`] as vectors.
pub(crate) struct FlatsIn<V> {
    corner: [V; 3],
    a: [V; 3],
    minus_b: [V; 3],
    normal: [V; 3],
    t_error: V,
    triangle: V,
    pub(crate) id: V,
}

/// Rows of [`Spheres`] as vectors.
pub(crate) struct SpheresIn<V> {
    centre: [V; 3],
    radius: V,
    pub(crate) id: V,
}

impl<V> FlatsIn<V> {
    #[inline(always)]
    pub(crate) fn new(block: &Flats, row: impl Fn(&[f32; BLOCK]) -> V) -> Self {
        let three = |rows: &[[f32; BLOCK]; 3]| [row(&rows[0]), row(&rows[1]), row(&rows[2])];
        Self {
            corner: three(&block.corner),
            a: three(&block.a),
            minus_b: three(&block.minus_b),
            normal: three(&block.normal),
            t_error: row(&block.t_error),
            triangle: row(&block.triangle),
            id: row(&block.id),
        }
    }
}

impl<V> SpheresIn<V> {
    #[inline(always)]
    pub(crate) fn new(block: &Spheres, row: impl Fn(&[f32; BLOCK]) -> V) -> Self {
        let centre = [row(&block.centre[0]), row(&block.centre[1]), row(&block.centre[2])];
        Self { centre, radius: row(&block.radius), id: row(&block.id) }
    }
}

#[inline(always)]
fn dot<V: Wide>(p: [V; 3], q: [V; 3]) -> V {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
fn cross<V: Wide>(p: [V; 3], q: [V; 3]) -> [V; 3] {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

#[inline(always)]
fn minus<V: Wide>(p: [V; 3], q: [V; 3]) -> [V; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

/// Triangles, parallelograms and squares (Möller & Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection*, 1997). What a
/// ray leaves it does not meet.
#[inline(always)]
pub(crate) fn flats<V: Wide>(beams: &Beams<V>, shape: &FlatsIn<V>) -> Known<V> {
    let r = minus(shape.corner, beams.origin);
    let q = cross(r, beams.direction);
    let det = dot(shape.normal, beams.direction);
    let along_a = dot(q, shape.minus_b).flipped(det);
    let along_b = dot(q, shape.a).flipped(det);
    let depth = dot(shape.normal, r).flipped(det);
    let det = det.flipped(det);
    let (less, more) = (along_a.min(along_b), along_a.max(along_b));
    // Of a triangle their sum is at most the whole, of a parallelogram the larger.
    let least = less.min(det - (more + less * shape.triangle));
    let error = beams.edge_error;
    let zero = beams.zero;
    let within = zero.at_most_where(shape.id.differs(beams.leaves), least + error);
    let known = shape.t_error.below(det);
    let inverse = beams.one / det;
    let t = depth * inverse;
    let t_error = shape.t_error * inverse * beams.reach + beams.t_error;
    let (near, far) = (t - t_error, t + t_error);
    let in_reach = near.at_most_where(zero.at_most_where(within, far), beams.limit);
    let inside = error.below_where(known & within, least);
    let certain = far.below_where(zero.below_where(inside, near), beams.certain_limit);
    Known { met: in_reach | (within & !known), certain, near: near.or_else(known, zero), far }
}

/// Spheres.
///
/// The line passes the centre at a distance |q|/|d| that errs by 35us; both radii between which the true one lies, 40us off, and
/// q² itself, 64 roundoffs off, leave room for every rounding of what follows. The place abreast of the centre errs by 50us.
#[inline(always)]
pub(crate) fn spheres<V: Wide>(beams: &Beams<V>, chords: &SphereFilter<V>, shape: &SpheresIn<V>) -> Known<V> {
    let r = minus(shape.centre, beams.origin);
    let q = cross(r, beams.direction);
    let squared = dot(q, q);
    let (inner, outer) = (shape.radius - chords.slack, shape.radius + chords.slack);
    let longest = outer * outer * chords.squared - squared * chords.smaller;
    let shortest = inner * inner * chords.squared - squared * chords.larger;
    let middle = dot(r, beams.direction) * chords.per_squared;
    // NaN where the line may miss the sphere, or misses it.
    let (longer, shorter) = (longest.sqrt() * chords.longer, shortest.sqrt() * chords.shorter);
    let through = beams.zero.below(shortest) & beams.zero.below(inner);
    let t_error = chords.t_error;
    let first = middle - shorter + t_error;
    let leaves = shape.id.equals(beams.leaves);
    // The nearer end is behind the origin, or left: what counts is the farther one.
    let second = through & (leaves | first.below(beams.zero));
    let near = (middle + shorter - t_error).or_else(second, middle - longer - t_error);
    let last = middle + longer + t_error;
    let far = last.or_else(second, first);
    // One that is left is met again if its centre is ahead.
    let away = leaves & (middle + t_error).below(beams.zero);
    let toward = !leaves | beams.zero.below(middle - t_error);
    let met = beams.zero.at_most(longest) & beams.zero.at_most(last) & near.at_most(beams.limit) & !away;
    let certain = met & through & toward & beams.zero.below(near) & far.below(beams.certain_limit);
    Known { met, certain, near, far }
}
