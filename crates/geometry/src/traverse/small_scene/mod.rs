//! Queries of scenes of few primitives, without a tree.

mod lanes;
mod single;
mod surface;

use super::job::run;
use crate::query::Query;
use crate::ray::{ExactPoint, Found};
use crate::small_scene::{SmallScene, Tables};
use crate::{Hits, Primitive, PrimitiveId, Rays, SurfacePoints};
use etalon_optics::Vec3;
use etalon_simd::Level;

/// The tables, made when they are first asked for.
#[inline(always)]
fn tables<'a>(scene: &'a SmallScene, primitives: &[Primitive]) -> &'a Tables {
    scene.tables(|| primitives.iter().map(Primitive::filter_shape), || primitives.iter().map(Primitive::plane))
}

impl SmallScene {
    /// The closest hit, in the units of the query.
    pub(crate) fn closest(&self, level: Level, primitives: &[Primitive], query: &Query) -> Option<Found> {
        run(level, single::Closest { flat: self, primitives, query })
    }

    /// Whether anything but the primitive aimed at is hit.
    pub(crate) fn any(&self, level: Level, primitives: &[Primitive], query: &Query) -> bool {
        run(level, single::Any { flat: self, primitives, query })
    }

    /// The closest hits of the rays in the lanes of `active`, and the lanes that were not decided.
    pub(crate) fn closest_hits(&self, level: Level, primitives: &[Primitive], rays: &Rays, active: u8) -> (Hits, u8) {
        if !self.others.is_empty() {
            return (Hits::NONE, active);
        }
        let corners = &tables(self, primitives).corners;
        run(level, lanes::Closest { flat: self, corners, primitives, rays, active })
    }

    /// The lanes of `active` where anything but the primitive aimed at is hit, and those that were not decided.
    pub(crate) fn any_hits(&self, level: Level, rays: &Rays, active: u8) -> (u8, u8) {
        if self.others.is_empty() { run(level, lanes::Any { flat: self, rays, active }) } else { (0, active) }
    }

    /// The surfaces at the hits in the lanes of `active`.
    pub(crate) fn surfaces(
        &self,
        level: Level,
        primitives: &[Primitive],
        rays: &Rays,
        hits: &Hits,
        active: u8,
        label: u32,
    ) -> SurfacePoints {
        let table = &tables(self, primitives).surfaces;
        run(level, surface::Surfaces { table, primitives, rays, hits, active, label })
    }

    /// The surface of a primitive near a point.
    #[inline]
    pub(crate) fn surface(&self, primitives: &[Primitive], id: PrimitiveId, p: Vec3<f64>) -> ExactPoint {
        tables(self, primitives).surfaces.at(id, p, || primitives[id.0 as usize].surface(p))
    }
}
