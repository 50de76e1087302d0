//! A geometry within another, placed by an affine map.
//!
//! Rays are taken into the instance's own coordinates with their direction as the map leaves it, not normalised: the ray
//! parameter is then the same on both sides. What the map and its inverse round is part of the error bound of every
//! point that comes back, so that a ray leaves an instanced surface as safely as any other.

use crate::best::Found;
use crate::double_double::{cross, dot, widen};
use crate::query::{Query, RawHit};
use crate::ray::ExactPoint;
use crate::traverse::Visit;
use crate::{Aabb, Geometry, MAX_COORDINATE, Motion, Ray, ShapeError, SurfaceId};
use etalon_optics::{Real, Vec3};
use std::borrow::Cow;
use std::sync::Arc;

/// Beyond this (2⁵⁰) for the largest component of |L|·|L⁻¹|, `f64` cannot tell where a placed surface is.
const MAX_CONDITION: f64 = (1_u64 << 50) as f64;

/// The end of a ray within an instance: that outside, but no smaller than 2⁻¹²⁰. In the units there, which may be 2⁹⁰⁰ times as long, a
/// smaller one would be rounded, and what of several instances is hit first would depend on which was asked before. What is found is
/// compared with the end outside anyway.
#[inline(always)]
pub(crate) fn told_end(t_max: f64) -> f64 {
    const LEAST: f64 = 1.0 / (1_u128 << 120) as f64;
    // Never of NaN: ends are limits that have been compared.
    if t_max > LEAST { t_max } else { LEAST }
}

/// Puts a hit that rounding found before the ray has entered the instance's bounds to where it does, and tells whether it counts before
/// `t_max`. What is hit first must not depend on whether the bounds are entered before `t_max`, and an instance that is flat to one part
/// in 10³⁰ has coordinates in which rays are little but rounding.
#[inline(always)]
pub(crate) fn at_least(hit: &mut RawHit, entry: f64, t_max: f64) -> bool {
    // Where t is so small that the change of units lost it there is no hit, nor beyond an end that was not told.
    let is_ahead = hit.t > 0.0;
    hit.t = if hit.t < entry { entry } else { hit.t };
    is_ahead && hit.t < t_max
}

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
        super::shapes::check_points(&[linear[0], linear[1], linear[2], translation])?;
        let placement = Self::of(linear, translation);
        if !placement.inverse.iter().all(|row| row.is_finite()) {
            return Err(ShapeError::Singular);
        }
        let condition = placement.spread(Vec3::splat(1.0)).max_component();
        if condition.is_nan() || condition > MAX_CONDITION {
            return Err(ShapeError::Singular);
        }
        super::shapes::check_points(&placement.inverse)?;
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
    pub(crate) fn local_point(&self, p: Vec3<f64>) -> Vec3<f64> {
        product(&self.inverse, p - self.translation)
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
    fn outward(&self, p: &ExactPoint) -> ExactPoint {
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

/// A geometry that is shared, and where it is placed.
#[derive(Clone, Debug)]
pub struct Instance {
    geometry: Arc<Geometry>,
    /// Of one that moves, that in the middle of the shutter's time.
    placement: Placement,
    moving: Option<Box<Moving>>,
    bounds: Aabb,
    /// The [`SurfaceId::instance`] of its own primitives in the geometry that it is part of.
    pub(crate) first: u32,
}

/// Parts of the shutter's time, each with a box of its own.
const SLICES: usize = 16;

/// How an instance moves.
#[derive(Clone, Debug)]
struct Moving {
    motion: Arc<Motion>,
    /// Around it in each part of the shutter's time.
    slices: [Aabb; SLICES],
}

impl PartialEq for Instance {
    /// Whether both place the same geometry at the same place.
    fn eq(&self, other: &Self) -> bool {
        let same = Arc::ptr_eq(&self.geometry, &other.geometry) && self.placement == other.placement;
        same && self.motion() == other.motion()
    }
}

impl Instance {
    /// Places a geometry.
    ///
    /// # Errors
    /// If the geometry is empty, or would reach beyond [`MAX_COORDINATE`].
    pub fn new(geometry: Arc<Geometry>, placement: Placement) -> Result<Self, ShapeError> {
        let bounds = placement.bounds(geometry.bounds().ok_or(ShapeError::Empty)?, geometry.outline());
        Self { geometry, placement, moving: None, bounds, first: 0 }.checked()
    }

    /// Places a geometry that moves while the shutter is open.
    ///
    /// # Errors
    /// As [`Instance::new`].
    pub fn moving(geometry: Arc<Geometry>, motion: Arc<Motion>) -> Result<Self, ShapeError> {
        let inner = geometry.bounds().ok_or(ShapeError::Empty)?;
        let edge = |slice: usize| slice as f64 / SLICES as f64;
        let slices: [Aabb; SLICES] =
            std::array::from_fn(|i| motion.swept([edge(i), edge(i + 1)], inner, geometry.outline()));
        let bounds = slices.iter().copied().reduce(Aabb::union).unwrap_or(Aabb::EMPTY);
        let placement = motion.at(0.5);
        let moving = Some(Box::new(Moving { motion, slices }));
        Self { geometry, placement, moving, bounds, first: 0 }.checked()
    }

    fn checked(self) -> Result<Self, ShapeError> {
        let largest = self.bounds.min.abs().max(self.bounds.max.abs()).max_component();
        if largest.is_nan() || largest > MAX_COORDINATE {
            return Err(ShapeError::OutOfRange);
        }
        Ok(self)
    }

    /// What is placed.
    pub fn geometry(&self) -> &Arc<Geometry> {
        &self.geometry
    }

    /// How it is placed; one that moves, in the middle of the shutter's time.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// How it moves, if it does.
    pub fn motion(&self) -> Option<&Arc<Motion>> {
        self.moving.as_ref().map(|moving| &moving.motion)
    }

    /// How it is placed at a time from 0 to 1 of the shutter's.
    #[inline]
    pub fn placement_at(&self, time: f64) -> Cow<'_, Placement> {
        match &self.moving {
            None => Cow::Borrowed(&self.placement),
            Some(moving) => Cow::Owned(moving.motion.at(time)),
        }
    }

    /// A box around it at a time; of one that moves, around it at times near that.
    fn bounds_at(&self, time: f64) -> &Aabb {
        match &self.moving {
            None => &self.bounds,
            Some(moving) => &moving.slices[((time * SLICES as f64) as usize).min(SLICES - 1)],
        }
    }

    /// A box around it, wherever it is while the shutter is open.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How many numbers it and the instances within it take.
    pub(crate) fn count(&self) -> u64 {
        self.geometry.instance_count()
    }

    /// The surface of a ray's in the numbers of what is placed; none if it is not within this instance.
    fn inward(&self, surface: SurfaceId) -> SurfaceId {
        match surface.instance.checked_sub(self.first) {
            Some(instance) if surface.instance > 0 && u64::from(instance) < self.count() => {
                SurfaceId { instance, primitive: surface.primitive }
            }
            _ => SurfaceId::NONE,
        }
    }

    /// The query in the coordinates of what is placed, up to `t_max` of the given one; its parameter times its `scale` is
    /// that of the given one. `None` if no ray can be computed with there.
    pub(crate) fn enter(&self, query: &Query, t_max: f64) -> Option<Query> {
        let placement = self.placement_at(query.time);
        let Placement { translation, inverse, .. } = &*placement;
        Query::new(&Ray {
            time: query.time,
            origin: product(inverse, query.origin - *translation),
            direction: product(inverse, query.direction),
            t_max,
            leaves: self.inward(query.leaves_placed),
            aims_at: self.inward(query.aims_at_placed),
        })
    }

    /// Where a ray enters the bounds, if it does before `t_max`, to rounding.
    ///
    /// Every test of the instance asks this too, with a tree around it or without: where the ray's rounding in the
    /// instance's coordinates would let it hit something while it passes by outside, both agree that it does not.
    fn entry(&self, query: &Query, t_max: f64) -> Option<f64> {
        query.entry(self.bounds_at(query.time), t_max)
    }

    /// The closest hit with 0 < t < `t_max`.
    #[inline(never)]
    pub(crate) fn closest(&self, query: &Query, t_max: f64) -> Option<Found> {
        let entry = self.entry(query, t_max)?;
        let inner = self.enter(query, told_end(t_max))?;
        let (mut hit, mut surface) = self.geometry.closest(&inner)?;
        hit.t *= inner.scale;
        surface.instance += self.first;
        at_least(&mut hit, entry, t_max).then_some((hit, surface))
    }

    /// Calls `visit` for every hit at a distance from `from` on and below `t_max`, as [`all_of`](crate::traverse::all_of) does.
    pub(crate) fn all(&self, query: &Query, (from, t_max): (f64, f64), visit: &mut Visit<'_>) -> f64 {
        let Some(entry) = self.entry(query, t_max) else { return t_max };
        let Some(inner) = self.enter(query, told_end(t_max)) else { return t_max };
        let mut end = t_max;
        // A hit before the bounds are entered counts as one where they are.
        let inner_from = if entry < from { from / inner.scale } else { 0.0 };
        self.geometry.all(&inner, inner_from, &mut |mut hit, mut surface| {
            hit.t *= inner.scale;
            surface.instance += self.first;
            if at_least(&mut hit, entry, end) && hit.t >= from {
                end = visit(hit, surface);
            }
            told_end(end) / inner.scale
        });
        end
    }

    /// Whether anything but the surface aimed at is hit.
    #[inline(never)]
    pub(crate) fn occludes(&self, query: &Query) -> bool {
        self.entry(query, query.t_max).is_some()
            && self.enter(query, query.t_max).is_some_and(|inner| self.geometry.any(&inner))
    }

    /// The point of a surface within at parameter `t` of the query; see [`Geometry::exact_point`].
    pub(crate) fn exact_point(
        &self,
        query: &Query,
        t: f64,
        refine: bool,
        surface: SurfaceId,
    ) -> Option<(ExactPoint, u32)> {
        let inner = self.enter(query, query.t_max)?;
        let (point, label) = self.geometry.exact_point(&inner, t / inner.scale, refine, self.inward(surface))?;
        Some((self.placement_at(query.time).outward(&point), label))
    }
}
