//! A geometry within another, placed by an affine map.
//!
//! Rays are taken into the instance's own coordinates with their direction as the map leaves it, not normalised: the ray
//! parameter is then the same on both sides. What the map and its inverse round is part of the error bound of every
//! point that comes back, so that a ray leaves an instanced surface as safely as any other.

use super::Geometry;
use crate::query::Query;
use crate::{Aabb, MAX_COORDINATE, Motion, Placement, Ray, ShapeError, SurfaceId};
use std::borrow::Cow;
use std::sync::Arc;

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
    pub(crate) fn inward(&self, surface: SurfaceId) -> SurfaceId {
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
        Query::new(&Ray {
            time: query.time,
            origin: placement.local_point(query.origin),
            direction: placement.local_vector(query.direction),
            t_max,
            leaves: self.inward(query.leaves_placed),
            aims_at: self.inward(query.aims_at_placed),
        })
    }

    /// Where a ray enters the bounds, if it does before `t_max`, to rounding.
    ///
    /// Every test of the instance asks this too, with a tree around it or without: where the ray's rounding in the
    /// instance's coordinates would let it hit something while it passes by outside, both agree that it does not.
    pub(crate) fn entry(&self, query: &Query, t_max: f64) -> Option<f64> {
        query.entry(self.bounds_at(query.time), t_max)
    }
}
