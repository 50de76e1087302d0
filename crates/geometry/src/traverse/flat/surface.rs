//! The surfaces of few primitives at eight hits: the operations of each shape's own, in their order, on what they share.

use super::FLAT_LIMIT;
use super::eight::Eight;
use crate::lanes::lanes_of;
use crate::ray::ExactPoint;
use crate::shapes::planar;
use crate::traverse::{Filters, Job};
use crate::{Hits, LANES, Primitive, PrimitiveId, Rays, SurfacePoint, SurfacePoints};
use etalon_optics::{Real, Vec3};
use std::array::from_fn;

/// What the surface of a flat shape is made of: see [`planar::surface`].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Plane {
    normal: [f64; 3],
    point: [f64; 3],
    size: f64,
    /// 1 for a plane, 0 for what is none.
    flat: f64,
}

/// The planes of primitives.
#[derive(Debug)]
pub(crate) struct SurfaceTable {
    planes: Vec<Plane>,
}

impl SurfaceTable {
    pub(super) fn new(primitives: &[Primitive]) -> Self {
        let none = Plane { normal: [0.0; 3], point: [0.0; 3], size: 0.0, flat: 0.0 };
        let plane = |p: &Primitive| match p.plane() {
            Some((point, normal, size)) => {
                Plane { normal: normal.to_array(), point: point.to_array(), size, flat: 1.0 }
            }
            None => none,
        };
        let mut planes: Vec<_> = primitives.iter().map(plane).collect();
        planes.resize(FLAT_LIMIT, none);
        Self { planes }
    }

    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.planes.as_slice())
    }

    /// The surface of a primitive near a point.
    #[inline]
    pub(super) fn at(&self, primitives: &[Primitive], id: PrimitiveId, p: Vec3<f64>) -> ExactPoint {
        match self.planes[id.0 as usize] {
            Plane { normal, point, size, flat } if flat > 0.0 => {
                planar::surface(p, Vec3::from_array(point), Vec3::from_array(normal), size)
            }
            _ => primitives[id.0 as usize].surface(p),
        }
    }
}

/// The surfaces at the hits.
pub(super) struct Surfaces<'a> {
    pub(super) table: &'a SurfaceTable,
    pub(super) primitives: &'a [Primitive],
    pub(super) rays: &'a Rays,
    pub(super) hits: &'a Hits,
    pub(super) active: u8,
    pub(super) label: u32,
}

impl Job for Surfaces<'_> {
    type Output = SurfacePoints;

    #[inline(always)]
    fn run<F: Filters>(self, _: F) -> SurfacePoints {
        let Self { table, primitives, rays, hits, active, label } = self;
        let ids: [usize; LANES] = from_fn(|l| hits.surface[l].primitive.0 as usize % FLAT_LIMIT);
        let planes: &[Plane; FLAT_LIMIT] = table.planes.as_slice().try_into().expect("a plane for each id");
        let mut out = SurfacePoints { surface: hits.surface, label: [label; LANES], ..SurfacePoints::NONE };
        let of = |f: fn(&Plane) -> f64| Eight(from_fn(|l| f(&planes[ids[l]])));
        let flat = of(|p| p.flat).0;
        let n = [of(|p| p.normal[0]), of(|p| p.normal[1]), of(|p| p.normal[2])];
        let point = [of(|p| p.point[0]), of(|p| p.point[1]), of(|p| p.point[2])];
        let t = Eight(hits.t);
        let p: [Eight; 3] = from_fn(|k| Eight(rays.origin[k]) + Eight(rays.direction[k]) * t);
        let away: [Eight; 3] = from_fn(|k| p[k] - point[k]);
        let height = away[0] * n[0] + away[1] * n[1] + away[2] * n[2];
        let position: [Eight; 3] = from_fn(|k| p[k] - n[k] * height);
        let reach = Eight::largest(away).max(of(|p| p.size));
        let u = Eight::splat(f64::UNIT_ROUNDOFF);
        let error: [Eight; 3] = from_fn(|k| (p[k].abs() + position[k].abs() + Eight::splat(16.0) * reach) * u);
        let distance = n[0].abs() * error[0] + n[1].abs() * error[1] + n[2].abs() * error[2];
        let distance = distance * Eight::splat(1.0 + 8.0 * f64::UNIT_ROUNDOFF);
        // The next number up, of one that is not negative.
        out.position_error = distance.0.map(|d| f64::from_bits(d.to_bits() + 1));
        out.position = position.map(|x| x.0);
        out.normal = n.map(|x| x.0);
        let all_flat = flat.iter().fold(1.0, |a, &b| a * b) == 1.0;
        if !all_flat {
            for l in lanes_of(active) {
                if flat[l] == 0.0 {
                    let ray = rays.get(l);
                    let point = primitives[ids[l]].surface(ray.origin + ray.direction * hits.t[l]);
                    out.set(l, &SurfacePoint::rounded(&point, hits.surface[l], label));
                }
            }
        }
        out
    }
}
