//! The exact test of eight rays, each with a triangle of its own: the operations of [`Triangle`](crate::Triangle)'s test, in their
//! order.

use super::FLAT_LIMIT;
use super::eight::{Eight, Which, both};
use crate::query::AXES;
use crate::shapes::planar::is_determined;
use crate::{LANES, Primitive};
use std::array::from_fn;

/// The corners of triangles, one row of coordinates for each.
#[derive(Debug)]
pub(super) struct Corners(Vec<[[f64; 4]; 4]>);

/// Eight rays as [`Query`](crate::query::Query) prepares them.
pub(super) struct Eights {
    /// An index into [`AXES`].
    pub(super) axis: [usize; LANES],
    /// Along the axes.
    pub(super) start: [Eight; 3],
    pub(super) shear: [Eight; 3],
    pub(super) t_max: Eight,
}

/// What the test finds: whether it is certain, and a hit.
pub(super) struct Decided {
    pub(super) hit: Which,
    pub(super) t: Eight,
    pub(super) uv: [Eight; 2],
}

impl Corners {
    pub(super) fn new(primitives: &[Primitive]) -> Self {
        let corners = |p: &Primitive| match p {
            Primitive::Triangle(t) => {
                let [a, b, c] = t.vertices().map(|v| [v.x, v.y, v.z, 0.0]);
                [a, b, c, [0.0; 4]]
            }
            // NaN hits nothing here.
            _ => [[f64::NAN; 4]; 4],
        };
        let mut rows: Vec<_> = primitives.iter().map(corners).collect();
        rows.resize(FLAT_LIMIT, [[f64::NAN; 4]; 4]);
        Self(rows)
    }

    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }

    /// Tests the triangle of each ray.
    #[inline(always)]
    pub(super) fn triangles(&self, rays: &Eights, ids: &[usize; LANES]) -> Decided {
        let table: &[[[f64; 4]; 4]; FLAT_LIMIT] = self.0.as_slice().try_into().expect("a row for each id");
        let corner = |i: usize| {
            let along = |k: usize| {
                Eight(from_fn(|l| table[ids[l] % FLAT_LIMIT][i][AXES[rays.axis[l] % AXES.len()][k] % 4]))
                    - rays.start[k]
            };
            let r = [along(0), along(1), along(2)];
            let projected = [r[0] - rays.shear[0] * r[2], r[1] - rays.shear[1] * r[2], r[2] * rays.shear[2]];
            (projected, Eight::largest(r))
        };
        let ([ax, ay, za], ma) = corner(0);
        let ([bx, by, zb], mb) = corner(1);
        let ([cx, cy, zc], mc) = corner(2);
        let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        let det = (u + v) + w;
        let t_det = (u * za + v * zb) + w * zc;
        let t = t_det / det;
        let extent = Eight::largest([ax, bx, cx]).max(Eight::largest([ay, by, cy]));
        let depth = za.max(zb).max(zc) + za.negated().max(zb.negated()).max(zc.negated());
        let magnitude = ma.max(mb).max(mc);
        let zero = Eight::splat(0.0);
        // Edges through the ray, as far as rounding tells, are for the test of one.
        let above = both(both(zero.below(u), zero.below(v)), zero.below(w));
        let below = both(both(u.below(zero), v.below(zero)), w.below(zero));
        let inside: Which = from_fn(|l| above[l] | below[l]);
        let determined =
            from_fn(|l| is_determined(magnitude.0[l], extent.0[l], depth.0[l], t_det.0[l].abs(), det.0[l].abs()));
        let in_range = both(zero.below(t), t.below(rays.t_max));
        Decided { hit: both(both(inside, determined), in_range), t, uv: [v / det, w / det] }
    }
}
