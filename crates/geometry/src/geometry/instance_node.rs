//! What a ray needs to go into an instance, together where a tree's walk finds it.

use super::{Geometry, Instance, WideTree};
use crate::query::Query;
use crate::vec4::Four;
use crate::{Aabb, PrimitiveId, Ray, SurfaceId};
use etalon_optics::Vec3;
use std::sync::Arc;

/// An instance of a tree: the first two cache lines are what every ray needs that meets its box, the third what a hit needs.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct InstanceNode {
    /// Columns of L⁻¹, and a zero each.
    columns: [[f64; 4]; 3],
    translation: Vec3<f64>,
    geometry: Arc<Geometry>,
    /// [`Instance::first`].
    first: u32,
    /// [`Instance::count`].
    count: u32,
    /// The instance among the primitives of the geometry that it is part of.
    pub(crate) id: PrimitiveId,
    /// Whether it stands still and what it places has a tree, of the same instruction set.
    direct: bool,
    bounds: Aabb,
}

impl InstanceNode {
    /// For a tree whose leaves have this many lanes.
    pub(crate) fn new(instance: &Instance, id: PrimitiveId, lanes: usize) -> Self {
        let [x, y, z] = instance.placement().inverse();
        let column = |k: usize| [x[k], y[k], z[k], 0.0];
        Self {
            columns: [column(0), column(1), column(2)],
            translation: instance.placement().translation(),
            geometry: Arc::clone(instance.geometry()),
            first: instance.first,
            // 2³¹ at most.
            count: instance.count() as u32,
            id,
            direct: instance.motion().is_none() && instance.geometry().tree().is_some_and(|tree| tree.lanes() == lanes),
            bounds: instance.bounds(),
        }
    }

    /// What is placed, and its tree; none where [`Instance::closest`] has more to do than to walk that.
    #[inline(always)]
    pub(crate) fn tree(&self) -> Option<(&Geometry, &WideTree)> {
        let geometry = &*self.geometry;
        if self.direct { geometry.tree().map(|tree| (geometry, tree)) } else { None }
    }

    /// The ray that [`Instance::enter`] makes a query of, bit for bit; and its origin and its direction in lanes, a zero each.
    #[inline(always)]
    pub(crate) fn enter<F: Four>(&self, token: F::Token, query: &Query, t_max: f64) -> ([F; 2], Ray<f64>) {
        let (x, y, z) =
            (F::new(token, self.columns[0]), F::new(token, self.columns[1]), F::new(token, self.columns[2]));
        let (o, d) = (query.origin - self.translation, query.direction);
        let origin = x * F::splat(token, o.x) + y * F::splat(token, o.y) + z * F::splat(token, o.z);
        let direction = x * F::splat(token, d.x) + y * F::splat(token, d.y) + z * F::splat(token, d.z);
        let ([ox, oy, oz, _], [dx, dy, dz, _]) = (origin.to_array(), direction.to_array());
        let ray = Ray {
            origin: Vec3::new(ox, oy, oz),
            direction: Vec3::new(dx, dy, dz),
            t_max,
            leaves: self.inward(query.leaves_placed),
            aims_at: self.inward(query.aims_at_placed),
            time: query.time,
        };
        ([origin, direction], ray)
    }

    /// [`Instance::inward`].
    #[inline(always)]
    fn inward(&self, surface: SurfaceId) -> SurfaceId {
        let instance = surface.instance.wrapping_sub(self.first);
        let within = surface.instance >= self.first && surface.instance > 0 && instance < self.count;
        if within { SurfaceId { instance, primitive: surface.primitive } } else { SurfaceId::NONE }
    }

    /// A surface of what is placed where it is placed.
    #[inline(always)]
    pub(crate) fn outward(&self, surface: SurfaceId) -> SurfaceId {
        SurfaceId { instance: surface.instance + self.first, ..surface }
    }

    /// Where a ray enters the instance's bounds, if it does before `t_max`, to rounding.
    #[inline(always)]
    pub(crate) fn entry(&self, query: &Query, t_max: f64) -> Option<f64> {
        query.entry(&self.bounds, t_max)
    }
}
