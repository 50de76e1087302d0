//! The filters of leaves, once for all instruction sets.

use super::vector::Vector;
use super::{Candidates, Filters};
use crate::frame::FrameRay;
use crate::wide::{LEAF_WIDTH, Leaf8};

/// The primitives of a leaf that the ray may hit in [0, `limit`], and the triangles that it certainly hits in
/// (0, `certain_limit`). The primitive that the ray leaves may be among them.
///
/// For triangles it is Woop's projection in `f32` with error bounds: an edge function errs by [`leaf_error`]. The distance, a
/// mean of the vertices' weighted by the edge functions, errs by at most three times that times their spread, over the
/// determinant, and by less than 3δ for the rounding of distances, sum and quotient.
#[inline(always)]
pub(super) fn candidates<F: Filters>(
    filters: F,
    ray: &FrameRay,
    leaf: &Leaf8,
    limit: f32,
    certain_limit: f32,
) -> Candidates {
    let all = |v| F::Vector::splat(filters.into(), v);
    let mut unbounded = u32::from(leaf.others);
    if leaf.spheres != 0 {
        unbounded |= u32::from(leaf.spheres) & spheres(filters, ray, leaf, limit);
    }
    let a = project(filters, ray, &leaf.vertices[0]);
    let b = project(filters, ray, &leaf.vertices[1]);
    let c = project(filters, ray, &leaf.vertices[2]);
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    let error = leaf_error(ray.error, leaf.extent);
    let (least, most) = (u.min(v).min(w), u.max(v).max(w));
    let met = all(-error).at_most(least) | most.at_most(all(error));
    if met == 0 {
        return Candidates { mask: unbounded, unbounded, certain: 0, near: [0.0; LEAF_WIDTH], far: [0.0; LEAF_WIDTH] };
    }
    let det = u + v + w;
    let reciprocal = all(ray.shear[2]) / det;
    let t = (u * a[2] + v * b[2] + w * c[2]) * reciprocal;
    let depth = a[2].max(b[2]).max(c[2]) - a[2].min(b[2]).min(c[2]) + all(2.0 * ray.error);
    let t_error = all(6.0 * error) * depth * reciprocal.abs() + all(3.0 * ray.error);
    let determined = all(6.0 * error).below(det.abs());
    let (near, far) = (t - t_error, t + t_error);
    let met = met & !(determined & (all(limit).below(near) | far.below(all(0.0))));
    let inside = all(error).below(least) | most.below(all(-error));
    let ahead = all(0.0).below(near) & far.below(all(certain_limit));
    Candidates {
        mask: met | unbounded,
        unbounded: unbounded | met & !determined,
        certain: met & determined & inside & ahead,
        near: near.to_array(),
        far: far.to_array(),
    }
}

/// A vertex in the projection of the ray: z is not yet scaled.
#[inline(always)]
fn project<F: Filters>(filters: F, ray: &FrameRay, vertex: &[[f32; LEAF_WIDTH]; 3]) -> [F::Vector; 3] {
    let [kx, ky, kz] = ray.axes;
    let all = |v| F::Vector::splat(filters.into(), v);
    let from_origin = |row: usize, k: usize| F::Vector::load(filters.into(), &vertex[row]) - all(ray.start_along[k]);
    let (x, y, z) = (from_origin(kx, 0), from_origin(ky, 1), from_origin(kz, 2));
    [x - all(ray.shear[0]) * z, y - all(ray.shear[1]) * z, z]
}

#[inline(always)]
fn edge<V: Vector>(p: [V; 3], q: [V; 3]) -> V {
    p[0] * q[1] - p[1] * q[0]
}

/// The lanes whose spheres the ray may meet.
#[inline(always)]
fn spheres<F: Filters>(filters: F, ray: &FrameRay, leaf: &Leaf8, limit: f32) -> u32 {
    let all = |v| F::Vector::splat(filters.into(), v);
    let [sx, sy, sz] = ray.shear;
    let [x, y, z] = project(filters, ray, &leaf.vertices[0]);
    let along = x * all(sx) + y * all(sy);
    let flat = all(1.0 / (1.0 + sx * sx + sy * sy));
    let squared = x * x + y * y - along * along * flat;
    let (slack, factor) = sphere_bounds(ray.error);
    let reach = F::Vector::load(filters.into(), &leaf.vertices[1][0]) + all(slack);
    let middle = (z + along * flat) * all(sz);
    squared.at_most(reach * reach * all(factor))
        & (middle - reach).at_most(all(limit))
        & all(0.0).at_most(middle + reach)
}

/// Bound on the error of the edge functions of a leaf's triangles in the projection of a ray that meets the leaf's box.
///
/// `error` is the bound δ on the error of a projected coordinate. With e the largest of them, an edge function
/// (cx·by − cy·bx) errs by at most 4δe + 2δ² for its factors and 4ue² for its rounding; e is below twice the reach of the
/// ray, of which δ is at least 10 roundoffs, so that 5δe + 2δ² covers both. A vertex is no farther than the `extent` of
/// the box along any axis from a point of the ray, which projects to zero, so that e is at most twice the extent, plus
/// twice the slack with which the ray may miss the box, below 3δ: its 3ε a distance (`frame`).
#[inline(always)]
fn leaf_error(error: f32, extent: f32) -> f32 {
    error * (12.0 * extent + 32.0 * error)
}

/// Bounds for spheres in the projection of a ray: on the error of a centre's distance from the ray and of its place along
/// it, and a relative one on the squared distance.
///
/// A centre relative to the origin and sheared, (x, y), errs by δ in each coordinate, its distance from the ray,
/// √(x² + y² − (x·sx + y·sy)²/(1 + sx² + sy²)), by no more than √2·δ and, since the difference is at least a third of
/// x² + y², by 30 roundoffs of itself; the radius errs by one. Along the ray the centre errs by at most 4δ.
#[inline(always)]
fn sphere_bounds(error: f32) -> (f32, f32) {
    (6.0 * error, 1.0 + 32.0 * f32::EPSILON)
}
