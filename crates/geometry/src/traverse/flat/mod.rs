//! Geometries of few primitives, without a tree: every primitive is filtered in `f32`, and only what may be the closest hit is
//! decided in `f64`.
//!
//! The answer is that of testing each primitive alone ([`Geometry::closest_flat`](crate::Geometry::closest_flat)), to the bit,
//! for one ray and for eight.

mod block;
mod eight;
mod exact;
mod filter;
mod lanes;
mod single;
mod surface;
mod wide;

use super::level;
use crate::best::Found;
use crate::frame::{Frame, above, below};
use crate::query::Query;
use crate::ray::ExactPoint;
use crate::{Aabb, Hits, Primitive, PrimitiveId, Rays, SurfacePoints};
pub(super) use block::BLOCK;
use block::{Flats, Kind, NO_ID, Spheres};
#[cfg(target_arch = "x86_64")]
pub(in crate::traverse) use eight::{EXPONENT, TURN};
pub(in crate::traverse) use eight::{Eight, PlainEight};
use etalon_optics::Vec3;
use etalon_simd::Level;
use exact::Corners;
use filter::Beam;
use std::sync::OnceLock;
use surface::SurfaceTable;
pub(in crate::traverse) use wide::Wide;

/// Most primitives of a flat geometry.
pub(crate) const FLAT_LIMIT: usize = 128;
/// Largest component of an origin in the accelerator's frame: beyond, the filters would be blurred.
const MOST_REACH: f64 = 1024.0;

/// The primitives of a flat geometry.
#[derive(Debug)]
pub(crate) struct Flat {
    frame: Frame,
    flats: Vec<Flats>,
    flat_count: usize,
    spheres: Vec<Spheres>,
    sphere_count: usize,
    /// Primitives without a filter.
    others: Vec<PrimitiveId>,
    /// At least as large as any component of a corner or centre in the frame, and at least 1.
    reach: f64,
    /// What hits and their surfaces take from few primitives: made when it is first asked for, as most geometries that are placed
    /// by instances never are.
    tables: OnceLock<Box<Tables>>,
}

#[derive(Debug)]
struct Tables {
    corners: Corners,
    surfaces: SurfaceTable,
}

impl Flat {
    /// Sorts up to [`FLAT_LIMIT`] primitives by kind.
    pub(crate) fn new(primitives: &[Primitive], bounds: Aabb) -> Self {
        assert!(primitives.len() <= FLAT_LIMIT, "a flat geometry has few primitives");
        let frame = Frame::around(bounds);
        let mut flat = Self {
            frame,
            flats: Vec::new(),
            flat_count: 0,
            spheres: Vec::new(),
            sphere_count: 0,
            others: Vec::new(),
            reach: 1.0,
            tables: OnceLock::new(),
        };
        for (index, primitive) in primitives.iter().enumerate() {
            let id = PrimitiveId(index as u32);
            let kind = Kind::of(primitive);
            let corners = match primitive {
                Primitive::Triangle(t) => t.vertices(),
                Primitive::Parallelogram(p) => {
                    let [corner, a, _, b] = p.corners();
                    [corner, a, b]
                }
                Primitive::Disk(d) => d.square(),
                Primitive::Sphere(s) => {
                    if flat.sphere_count.is_multiple_of(BLOCK) {
                        flat.spheres.push(Spheres::EMPTY);
                    }
                    flat.spheres[flat.sphere_count / BLOCK].set(flat.sphere_count % BLOCK, &frame, id, s);
                    flat.sphere_count += 1;
                    continue;
                }
                Primitive::Cylinder(_) | Primitive::Instance(_) => {
                    flat.others.push(id);
                    continue;
                }
            };
            if flat.flat_count.is_multiple_of(BLOCK) {
                flat.flats.push(Flats::EMPTY);
            }
            flat.flats[flat.flat_count / BLOCK].set(flat.flat_count % BLOCK, &frame, id, corners, kind);
            flat.flat_count += 1;
            // The corners of the square around a disk may lie out of the box.
            let furthest = corners.iter().flat_map(|&p| frame.point(p)).fold(0.0, |m: f32, c| c.abs().max(m));
            flat.reach = flat.reach.max(f64::from(furthest));
        }
        flat
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

    #[inline(always)]
    fn tables(&self, primitives: &[Primitive]) -> &Tables {
        self.tables.get_or_init(|| {
            Box::new(Tables { corners: Corners::new(primitives), surfaces: SurfaceTable::new(primitives) })
        })
    }

    /// What a ray is to the filters; none if it starts too far away for them.
    #[inline(always)]
    fn beam(&self, query: &Query) -> Option<Beam> {
        let origin = self.frame.place(query.origin).to_array();
        let own = crate::query::larger(crate::query::larger(origin[0].abs(), origin[1].abs()), origin[2].abs());
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

    /// The closest hit, in the units of the query.
    pub(crate) fn closest(&self, level: Level, primitives: &[Primitive], query: &Query) -> Option<Found> {
        level::run(level, single::Closest { flat: self, primitives, query })
    }

    /// Whether anything but the primitive aimed at is hit.
    pub(crate) fn any(&self, level: Level, primitives: &[Primitive], query: &Query) -> bool {
        level::run(level, single::Any { flat: self, primitives, query })
    }

    /// The closest hits of the rays in the lanes of `active`, and the lanes that were not decided.
    pub(crate) fn closest_hits(&self, level: Level, primitives: &[Primitive], rays: &Rays, active: u8) -> (Hits, u8) {
        if !self.others.is_empty() {
            return (Hits::NONE, active);
        }
        let corners = &self.tables(primitives).corners;
        level::run(level, lanes::Closest { flat: self, corners, primitives, rays, active })
    }

    /// The lanes of `active` where anything but the primitive aimed at is hit, and those that were not decided.
    pub(crate) fn any_hits(&self, level: Level, rays: &Rays, active: u8) -> (u8, u8) {
        if self.others.is_empty() { level::run(level, lanes::Any { flat: self, rays, active }) } else { (0, active) }
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
        let table = &self.tables(primitives).surfaces;
        level::run(level, surface::Surfaces { table, primitives, rays, hits, active, label })
    }

    /// The surface of a primitive near a point.
    #[inline]
    pub(crate) fn surface(&self, primitives: &[Primitive], id: PrimitiveId, p: Vec3<f64>) -> ExactPoint {
        self.tables(primitives).surfaces.at(primitives, id, p)
    }
}

/// Accepted distances err by up to 2⁻³⁰ of themselves.
const SLACK: f64 = 1.0 / (1_u64 << 29) as f64;
/// Beyond this nothing is in the frame.
const FURTHEST: f64 = 1e30;

/// A distance in the frame not below that of any hit up to `t` along a [`Query`], and one not above that of any beyond.
#[inline(always)]
fn limits(t: f64, frame: &Frame) -> [f32; 2] {
    let t = t * frame.scale();
    let t = if t < FURTHEST { t } else { FURTHEST };
    [above(t * (1.0 + SLACK)), below(t * (1.0 - SLACK))]
}
