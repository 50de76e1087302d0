//! The exact test of eight rays, each with a triangle of its own: the operations of [`Triangle`](crate::Triangle)'s test, in their
//! order.

use super::FLAT_LIMIT;
use crate::query::{AXES, larger};
use crate::shapes::planar::is_determined;
use crate::{LANES, Primitive};
use std::array::from_fn;

/// Eight numbers.
pub(super) type Eight = [f64; LANES];

/// The corners of triangles, one row of coordinates for each.
#[derive(Debug)]
pub(super) struct Corners(Vec<[[f64; 4]; 4]>);

/// Eight rays as [`Query`](crate::query::Query) prepares them.
pub(super) struct Eights {
    pub(super) axes: [[usize; LANES]; 3],
    /// Along the axes.
    pub(super) start: [Eight; 3],
    pub(super) shear: [Eight; 3],
    pub(super) t_max: Eight,
}

/// What the test finds: whether it is certain, and a hit.
pub(super) struct Decided {
    pub(super) hit: [bool; LANES],
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
        let mut x = [[0.0; LANES]; 3];
        let mut y = [[0.0; LANES]; 3];
        let mut z = [[0.0; LANES]; 3];
        let mut magnitude = [0.0; LANES];
        for i in 0..3 {
            for l in 0..LANES {
                let corner = &table[ids[l] % FLAT_LIMIT][i];
                x[i][l] = corner[rays.axes[0][l] % 4];
                y[i][l] = corner[rays.axes[1][l] % 4];
                z[i][l] = corner[rays.axes[2][l] % 4];
            }
            for l in 0..LANES {
                let (rx, ry, rz) = (x[i][l] - rays.start[0][l], y[i][l] - rays.start[1][l], z[i][l] - rays.start[2][l]);
                magnitude[l] = larger(magnitude[l], larger(larger(rx.abs(), ry.abs()), rz.abs()));
                x[i][l] = rx - rays.shear[0][l] * rz;
                y[i][l] = ry - rays.shear[1][l] * rz;
                z[i][l] = rz * rays.shear[2][l];
            }
        }
        let mut out = Decided { hit: [false; LANES], t: [0.0; LANES], uv: [[0.0; LANES]; 2] };
        for l in 0..LANES {
            let ([ax, bx, cx], [ay, by, cy]) = ([x[0][l], x[1][l], x[2][l]], [y[0][l], y[1][l], y[2][l]]);
            let [za, zb, zc] = [z[0][l], z[1][l], z[2][l]];
            let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
            let det = (u + v) + w;
            let t_det = (u * za + v * zb) + w * zc;
            let t = t_det / det;
            let extent = from_fn::<f64, 3, _>(|i| larger(x[i][l].abs(), y[i][l].abs()));
            let extent = larger(larger(extent[0], extent[1]), extent[2]);
            let depth = larger(larger(za, zb), zc) + larger(larger(-za, -zb), -zc);
            let determined = is_determined(magnitude[l], extent, depth, t_det.abs(), det.abs());
            // Edges through the ray, as far as rounding tells, are for the test of one.
            let above = (u > 0.0) & (v > 0.0) & (w > 0.0);
            let below = (u < 0.0) & (v < 0.0) & (w < 0.0);
            out.hit[l] = (above | below) & determined & (0.0 < t) & (t < rays.t_max[l]);
            out.t[l] = t;
            out.uv[0][l] = v / det;
            out.uv[1][l] = w / det;
        }
        out
    }
}

/// The axes of the projection of each ray.
#[inline(always)]
pub(super) fn axes(axis: &[usize; LANES]) -> [[usize; LANES]; 3] {
    from_fn(|k| from_fn(|l| AXES[axis[l] % AXES.len()][k]))
}
