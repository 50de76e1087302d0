//! A query through a whole geometry: by its tree, as a small scene, or primitive by primitive.

use super::best::Best;
use super::{Visit, all_of, occludes};
use crate::query::Query;
use crate::ray::{ExactPoint, Found};
use crate::{Geometry, PrimitiveId, SurfaceId};

impl Geometry {
    /// The surface at parameter `t` of a query, and the label of the geometry that it belongs to; `refine` if `t` is
    /// rounded to less than `f64`.
    pub(crate) fn exact_point(
        &self,
        query: &Query,
        mut t: f64,
        refine: bool,
        surface: SurfaceId,
    ) -> Option<(ExactPoint, u32)> {
        if surface.instance > 0 {
            let (_, instance) = self.instance_of(surface)?;
            return instance.exact_point(query, t, refine, surface);
        }
        let primitive = self.primitives().get(surface.primitive.0 as usize)?;
        if refine && primitive.is_curved() {
            let precise = primitive.intersect(query, query.t_max, query.leaves == surface.primitive);
            t = precise.map_or(t, |hit| hit.t);
        }
        Some((primitive.surface(query.origin + query.direction * t), self.label()))
    }

    /// The closest hit, by testing every primitive: the specification that the tree is held against.
    pub(crate) fn closest_flat(&self, query: &Query) -> Option<Found> {
        let mut best = Best::new(query.t_max);
        for i in 0..self.len() as u32 {
            best.test(self.primitives(), query, PrimitiveId(i));
        }
        best.found()
    }

    /// Whether anything occludes, by testing every primitive.
    pub(crate) fn any_flat(&self, query: &Query) -> bool {
        (0..self.len() as u32).any(|i| occludes(self.primitives(), query, PrimitiveId(i)))
    }

    pub(crate) fn closest(&self, query: &Query) -> Option<Found> {
        match (self.tree(), self.small_scene()) {
            (Some(tree), _) => super::closest(self.level(), tree, self.primitives(), query),
            (_, Some(small)) => small.closest(self.level(), self.primitives(), query),
            _ => self.closest_flat(query),
        }
    }

    /// See [`all`](super::all).
    pub(crate) fn all(&self, query: &Query, from: f64, visit: &mut Visit<'_>) -> f64 {
        if let Some(tree) = self.tree() {
            return super::all(self.level(), tree, self.primitives(), query, from, visit);
        }
        let ids = 0..self.len() as u32;
        ids.fold(query.t_max, |end, id| all_of(self.primitives(), query, PrimitiveId(id), (from, end), visit))
    }

    /// Whether anything but the surface aimed at is hit.
    pub(crate) fn any(&self, query: &Query) -> bool {
        match (self.tree(), self.small_scene()) {
            (Some(tree), _) => super::any(self.level(), tree, self.primitives(), query),
            (_, Some(small)) => small.any(self.level(), self.primitives(), query),
            _ => self.any_flat(query),
        }
    }
}
