//! Scenes of few primitives, without a tree: every primitive is filtered in `f32`, and only what may be the closest hit is
//! decided in `f64`.
//!
//! Here are the primitives in blocks, what the filters tell of a ray and a block, and the tables for exact tests of eight rays at once. The
//! queries are in `traverse/small_scene/`. Their answer is that of testing each primitive alone
//! ([`Geometry::closest_flat`](crate::Geometry::closest_flat)), to the bit, for one ray and for eight.

mod block;
mod eight;
mod exact;
mod filter;
mod surface_table;
mod wide;

use crate::frame::{Frame, above, below};
use crate::query::Query;
use crate::shapes::FilterShape;
use crate::vec4::larger;
use crate::{Aabb, PrimitiveId};
pub(crate) use block::{BLOCK, Flats, Kind, NO_ID, Spheres};
#[cfg(target_arch = "x86_64")]
pub(crate) use eight::{EXPONENT, TURN};
pub(crate) use eight::{Eight, PlainEight, axes};
use etalon_optics::Vec3;
pub(crate) use exact::{Corners, Decided, Eights};
pub(crate) use filter::*;
use std::sync::OnceLock;
pub(crate) use surface_table::{IS_PLANE, POINT, ROW, SIZE, SurfaceTable};
pub(crate) use wide::Wide;

/// Most primitives of a small scene.
pub(crate) const FLAT_LIMIT: usize = 128;
/// Largest component of an origin in the accelerator's frame: beyond, the filters would be blurred.
pub(crate) const MOST_REACH: f64 = 1024.0;

/// The primitives of a small scene.
#[derive(Debug)]
pub(crate) struct SmallScene {
    pub(crate) frame: Frame,
    pub(crate) flats: Vec<Flats>,
    pub(crate) flat_count: usize,
    pub(crate) spheres: Vec<Spheres>,
    pub(crate) sphere_count: usize,
    /// Primitives without a filter.
    pub(crate) others: Vec<PrimitiveId>,
    /// At least as large as any component of a corner or centre in the frame, and at least 1.
    pub(crate) reach: f64,
    /// What hits and their surfaces take from few primitives: made when it is first asked for, as most geometries that are placed
    /// by instances never are.
    tables: OnceLock<Box<Tables>>,
}

/// What exact tests and surfaces of eight rays at once read.
#[derive(Debug)]
pub(crate) struct Tables {
    pub(crate) corners: Corners,
    pub(crate) surfaces: SurfaceTable,
}

impl SmallScene {
    /// Sorts up to [`FLAT_LIMIT`] shapes by kind.
    pub(crate) fn new(shapes: impl ExactSizeIterator<Item = FilterShape>, bounds: Aabb) -> Self {
        assert!(shapes.len() <= FLAT_LIMIT, "a small scene has few primitives");
        let frame = Frame::around(bounds);
        let mut scene = Self {
            frame,
            flats: Vec::new(),
            flat_count: 0,
            spheres: Vec::new(),
            sphere_count: 0,
            others: Vec::new(),
            reach: 1.0,
            tables: OnceLock::new(),
        };
        for (index, shape) in shapes.enumerate() {
            let id = PrimitiveId(index as u32);
            let (kind, corners) = match shape {
                FilterShape::Triangle(vertices) => (Kind::Triangle, vertices),
                FilterShape::Parallelogram(corners) => (Kind::Parallelogram, corners),
                FilterShape::Disk(corners) => (Kind::Disk, corners),
                FilterShape::Sphere(centre, radius) => {
                    if scene.sphere_count.is_multiple_of(BLOCK) {
                        scene.spheres.push(Spheres::EMPTY);
                    }
                    let block = &mut scene.spheres[scene.sphere_count / BLOCK];
                    block.set(scene.sphere_count % BLOCK, &frame, id, centre, radius);
                    scene.sphere_count += 1;
                    continue;
                }
                FilterShape::Other => {
                    scene.others.push(id);
                    continue;
                }
            };
            if scene.flat_count.is_multiple_of(BLOCK) {
                scene.flats.push(Flats::EMPTY);
            }
            scene.flats[scene.flat_count / BLOCK].set(scene.flat_count % BLOCK, &frame, id, corners, kind);
            scene.flat_count += 1;
            // The corners of the square around a disk may lie out of the box.
            let furthest = corners.iter().flat_map(|&p| frame.point(p)).fold(0.0, |m: f32, c| c.abs().max(m));
            scene.reach = scene.reach.max(f64::from(furthest));
        }
        scene
    }

    /// Memory held beside the struct itself, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        self.flats.len() * size_of::<Flats>()
            + self.spheres.len() * size_of::<Spheres>()
            + self.others.len() * size_of::<PrimitiveId>()
            + self.tables.get().map_or(0, |tables| tables.corners.memory_bytes() + tables.surfaces.memory_bytes())
    }

    /// Wrong on purpose: for rays that start at the middle of the frame the filters' errors are bounded by next to nothing.
    #[cfg(test)]
    pub(crate) fn forget_rounding(&mut self) {
        self.reach = 1e-6;
    }

    /// The tables, of a primitive's shape for the filters and its plane.
    #[inline(always)]
    pub(crate) fn tables<S, P>(&self, shapes: impl FnOnce() -> S, planes: impl FnOnce() -> P) -> &Tables
    where
        S: Iterator<Item = FilterShape>,
        P: Iterator<Item = Option<(Vec3<f64>, Vec3<f64>, f64)>>,
    {
        self.tables
            .get_or_init(|| Box::new(Tables { corners: Corners::new(shapes()), surfaces: SurfaceTable::new(planes()) }))
    }

    /// What a ray is to the filters; none if it starts too far away for them.
    #[inline(always)]
    pub(crate) fn beam(&self, query: &Query) -> Option<Beam> {
        let origin = self.frame.place(query.origin).to_array();
        let own = larger(larger(origin[0].abs(), origin[1].abs()), origin[2].abs());
        if own > MOST_REACH {
            return None;
        }
        let id = |id: PrimitiveId| if id.0 < FLAT_LIMIT as u32 { id.0 as f32 } else { NO_ID };
        let [limit, certain_limit] = limits(query.t_max, &self.frame);
        let [x, y, z] = origin.map(|c| c as f32);
        let [dx, dy, dz] = query.direction.to_array().map(|c| c as f32);
        let reach = above(own + self.reach);
        Some([x, y, z, dx, dy, dz, reach, limit, certain_limit, id(query.leaves), id(query.aims_at)])
    }
}

/// Accepted distances err by up to 2⁻³⁰ of themselves.
pub(crate) const SLACK: f64 = 1.0 / (1_u64 << 29) as f64;
/// Beyond this nothing is in the frame.
pub(crate) const FURTHEST: f64 = 1e30;

/// A distance in the frame not below that of any hit up to `t` along a [`Query`], and one not above that of any beyond.
#[inline(always)]
pub(crate) fn limits(t: f64, frame: &Frame) -> [f32; 2] {
    let t = t * frame.scale();
    let t = if t < FURTHEST { t } else { FURTHEST };
    [above(t * (1.0 + SLACK)), below(t * (1.0 - SLACK))]
}
