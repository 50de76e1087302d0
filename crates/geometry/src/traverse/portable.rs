//! The filters in plain Rust; the wording of reference for the other instruction sets.

use super::{Candidates, Entered, Filters, leaf_error, sphere_bounds};
use crate::frame::FrameRay;
use crate::wide::{Leaf8, Node8, OTHER, SPHERE, WIDTH};
use crate::{Primitive, PrimitiveId};

/// Plain Rust.
#[derive(Clone, Copy)]
pub(super) struct Portable;

impl Filters for Portable {
    type Ray = (FrameRay, PrimitiveId);

    #[inline(always)]
    fn ray(self, ray: &FrameRay, leaves: PrimitiveId) -> (FrameRay, PrimitiveId) {
        (*ray, leaves)
    }

    #[inline(always)]
    fn enter(self, (ray, _): &Self::Ray, node: &Node8, limit: f32) -> Entered {
        let mut out = Entered { mask: 0, near: [0.0; WIDTH] };
        let mut far = [limit; WIDTH];
        for k in 0..3 {
            let entry = &node.planes[k][ray.negative[k]];
            let exit = &node.planes[k][1 - ray.negative[k]];
            for lane in 0..WIDTH {
                let near = (entry[lane] - ray.origin_near[k]) * ray.reciprocal_near[k];
                out.near[lane] = if near > out.near[lane] { near } else { out.near[lane] };
                let exit = (exit[lane] - ray.origin_far[k]) * ray.reciprocal_far[k];
                far[lane] = if exit < far[lane] { exit } else { far[lane] };
            }
        }
        for lane in 0..WIDTH {
            out.mask |= u32::from(out.near[lane] <= far[lane]) << lane;
        }
        out
    }

    #[inline(always)]
    fn prefetch(self, _: &Primitive) {}

    /// Woop's projection in `f32` with error bounds: an edge function errs by [`leaf_error`]. The distance, a mean of the
    /// vertices' weighted by the edge functions, errs by at most three times that times their spread, over the determinant,
    /// and by less than 3δ for the rounding of distances, sum and quotient.
    #[inline(always)]
    fn candidates(self, (ray, leaves): &Self::Ray, leaf: &Leaf8, limit: f32, certain_limit: f32) -> Candidates {
        let mut out = Candidates { mask: 0, certain: 0, near: [0.0; WIDTH], far: [0.0; WIDTH] };
        let error = leaf_error(ray.error, leaf.extent);
        for lane in 0..WIDTH {
            let id = leaf.ids[lane];
            if id == u32::MAX {
                continue;
            }
            if id & SPHERE != 0 {
                let [x, y, z] = [0, 1, 2].map(|k| leaf.vertices[0][ray.axes[k]][lane] - ray.origin[k]);
                let (x, y) = (x - ray.shear[0] * z, y - ray.shear[1] * z);
                let along = x * ray.shear[0] + y * ray.shear[1];
                let flat = 1.0 / (1.0 + ray.shear[0] * ray.shear[0] + ray.shear[1] * ray.shear[1]);
                let squared = x * x + y * y - along * along * flat;
                let (slack, factor) = sphere_bounds(ray.error);
                let reach = leaf.vertices[1][0][lane] + slack;
                let middle = (z + along * flat) * ray.shear[2];
                let missed = squared > reach * reach * factor || middle - reach > limit || middle + reach < 0.0;
                out.mask |= u32::from(!missed) << lane;
                continue;
            }
            if id & OTHER != 0 {
                out.mask |= 1 << lane;
                continue;
            }
            if leaf.id(lane) == *leaves {
                continue;
            }
            let [a, b, c] = [0, 1, 2].map(|i| {
                let [x, y, z] = [0, 1, 2].map(|k| leaf.vertices[i][ray.axes[k]][lane] - ray.origin[k]);
                [x - ray.shear[0] * z, y - ray.shear[1] * z, ray.shear[2] * z]
            });
            let edge = |p: [f32; 3], q: [f32; 3]| p[0] * q[1] - p[1] * q[0];
            let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
            let (least, most) = (u.min(v).min(w), u.max(v).max(w));
            if least < -error && most > error {
                continue;
            }
            let det = u + v + w;
            let reciprocal = 1.0 / det;
            let t = (u * a[2] + v * b[2] + w * c[2]) * reciprocal;
            let depth = a[2].max(b[2]).max(c[2]) - a[2].min(b[2]).min(c[2]) + 2.0 * ray.error;
            let t_error = 6.0 * error * depth * reciprocal.abs() + 3.0 * ray.error;
            let (near, far) = (t - t_error, t + t_error);
            let determined = det.abs() > 6.0 * error;
            if determined && (near > limit || far < 0.0) {
                continue;
            }
            out.mask |= 1 << lane;
            out.near[lane] = if determined { near } else { 0.0 };
            out.far[lane] = far;
            let inside = least > error || most < -error;
            let certain = determined && inside && near > 0.0 && far < certain_limit;
            out.certain |= u32::from(certain) << lane;
        }
        out
    }
}
