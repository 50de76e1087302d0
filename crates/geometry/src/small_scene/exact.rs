//! The exact test of eight rays, each with a triangle of its own: the operations of [`Triangle`](crate::Triangle)'s test, in their
//! order.

use super::FLAT_LIMIT;
use super::eight::Eight;
use crate::LANES;
use crate::shapes::FilterShape;
use crate::shapes::planar::{T_DETERMINED, W_DETERMINED};
use std::array::from_fn;

/// The corners of triangles, one row of coordinates for each.
#[derive(Debug)]
pub(crate) struct Corners(Vec<f64>);

/// Eight rays as [`Query`](crate::query::Query) prepares them.
pub(crate) struct Eights<E> {
    /// The axis along which each direction is largest.
    pub(crate) axis: [u32; LANES],
    /// Along the axes of the projection.
    pub(crate) start: [E; 3],
    pub(crate) shear: [E; 3],
    pub(crate) t_max: E,
}

/// What the test finds: whether it is certain, and a hit.
pub(crate) struct Decided<E: Eight> {
    pub(crate) hit: E::Mask,
    pub(crate) t: E,
    pub(crate) uv: [E; 2],
}

/// Numbers of a triangle: four for each corner.
const ROW: usize = 16;

impl Corners {
    pub(crate) fn new(shapes: impl Iterator<Item = FilterShape>) -> Self {
        // NaN hits nothing here.
        let mut table = vec![f64::NAN; ROW * FLAT_LIMIT];
        for (row, shape) in table.chunks_mut(ROW).zip(shapes) {
            if let FilterShape::Triangle(vertices) = shape {
                for (corner, vertex) in row.chunks_mut(4).zip(vertices) {
                    corner[..3].copy_from_slice(&vertex.to_array());
                }
            }
        }
        Self(table)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }

    /// Tests the triangle of each ray.
    #[inline(always)]
    pub(crate) fn triangles<E: Eight>(&self, token: E::Token, rays: &Eights<E>, ids: &[u32; LANES]) -> Decided<E> {
        let table: &[f64; ROW * FLAT_LIMIT] = self.0.as_slice().try_into().expect("a row for each id");
        let kz = rays.axis;
        let kx = kz.map(|k| if k == 2 { 0 } else { k + 1 });
        let ky = kz.map(|k| if k == 0 { 2 } else { k - 1 });
        let axes = [&kx, &ky, &kz];
        // Functions and not closures, which may be left outside without the caller's vector instructions.
        let ([ax, ay, za], ma) = corner::<E>(token, table, rays, ids, axes, 0);
        let ([bx, by, zb], mb) = corner::<E>(token, table, rays, ids, axes, 4);
        let ([cx, cy, zc], mc) = corner::<E>(token, table, rays, ids, axes, 8);
        let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        let det = (u + v) + w;
        let t_det = (u * za + v * zb) + w * zc;
        let t = t_det / det;
        let extent = E::largest([ax, bx, cx]).max(E::largest([ay, by, cy]));
        let depth = za.max(zb).max(zc) + za.negated().max(zb.negated()).max(zc.negated());
        let magnitude = ma.max(mb).max(mc);
        let zero = E::splat(token, 0.0);
        // Edges through the ray, as far as rounding tells, are for the test of one.
        let above = zero.below(u) & zero.below(v) & zero.below(w);
        let below = u.below(zero) & v.below(zero) & w.below(zero);
        // `planar::is_determined`.
        let error = magnitude * extent;
        let determined = (error * depth * E::splat(token, T_DETERMINED)).at_most(t_det.abs())
            & (error * E::splat(token, W_DETERMINED)).at_most(det.abs());
        let in_range = zero.below(t) & t.below(rays.t_max);
        Decided { hit: (above | below) & determined & in_range, t, uv: [v / det, w / det] }
    }
}

/// A corner of each triangle as its ray sees it, along the axes of the projection, and its largest distance along them.
#[inline(always)]
fn corner<E: Eight>(
    token: E::Token,
    table: &[f64; ROW * FLAT_LIMIT],
    rays: &Eights<E>,
    ids: &[u32; LANES],
    [kx, ky, kz]: [&[u32; LANES]; 3],
    corner: u32,
) -> ([E; 3], E) {
    let x = coordinate::<E>(token, table, ids, kx, corner) - rays.start[0];
    let y = coordinate::<E>(token, table, ids, ky, corner) - rays.start[1];
    let z = coordinate::<E>(token, table, ids, kz, corner) - rays.start[2];
    ([x - rays.shear[0] * z, y - rays.shear[1] * z, z * rays.shear[2]], E::largest([x, y, z]))
}

/// The coordinate along `axis` of a corner of each triangle.
#[inline(always)]
fn coordinate<E: Eight>(
    token: E::Token,
    table: &[f64; ROW * FLAT_LIMIT],
    ids: &[u32; LANES],
    axis: &[u32; LANES],
    corner: u32,
) -> E {
    E::gathered(token, table, &from_fn(|l| ids[l] * ROW as u32 + corner + axis[l]))
}
