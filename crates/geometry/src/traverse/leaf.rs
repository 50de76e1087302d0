//! The filters of leaves, once for all instruction sets.

use super::vector::Vector;
use super::{Candidates, Filters, Narrow, Row};
use crate::PrimitiveId;
use crate::bvh::leaf::{Leaf, NO_ID};
use crate::bvh::node::{SPHERES, TRIANGLES};
use crate::frame::FrameRay;
use crate::vec4::{AXES, Lanes4};

/// The primitives of a leaf that the ray may hit in [0, `limit`], and the flat shapes and spheres that it certainly hits in
/// (0, `certain_limit`). The primitive that the ray leaves is not among them unless it may be hit again, and never certain.
#[inline(always)]
pub(super) fn candidates<F: Filters, const KIND: u8, const W: usize>(
    filters: F,
    ray: &FrameRay<Narrow<F>>,
    chords: &SphereFilter,
    leaf: &Leaf<W>,
    limit: f32,
    certain_limit: f32,
    leaves: PrimitiveId,
) -> Candidates<W> {
    let width = F::Vector::WIDTH;
    if width == W {
        return candidates_at::<F, KIND, W>(filters, ray, chords, (leaf, 0), limit, certain_limit, leaves);
    }
    let mut found = candidates_at::<F, KIND, W>(filters, ray, chords, (leaf, 0), limit, certain_limit, leaves);
    // Lanes are filled from the first on.
    if leaf.ids()[width % W] != NO_ID {
        let rest = candidates_at::<F, KIND, W>(filters, ray, chords, (leaf, width), limit, certain_limit, leaves);
        found.mask |= rest.mask << width;
        found.missed |= rest.missed << width;
        found.unbounded = found.unbounded & ((1 << width) - 1) | rest.unbounded << width;
        found.certain |= rest.certain << width;
        found.near.0[width..].copy_from_slice(&rest.near.0[width..]);
        found.far.0[width..].copy_from_slice(&rest.far.0[width..]);
    }
    found
}

/// [`candidates`] in the lanes of a leaf from `at` on, as many as a vector has. The first bit of its masks stands for the lane `at`; in its
/// rows each lane has its own place.
#[inline(always)]
fn candidates_at<F: Filters, const KIND: u8, const W: usize>(
    filters: F,
    ray: &FrameRay<Narrow<F>>,
    chords: &SphereFilter,
    (leaf, at): (&Leaf<W>, usize),
    limit: f32,
    certain_limit: f32,
    leaves: PrimitiveId,
) -> Candidates<W> {
    // By lanes: a ray that leaves a primitive comes by it most often, at no time that could be foretold.
    let own = F::Vector::lanes_with(filters.into(), leaf.ids(), at, leaves.0);
    if KIND == TRIANGLES {
        let mut found = flats::<F, true, W>(filters, ray, (leaf, at), limit, certain_limit);
        found.mask &= !own;
        return found;
    }
    if KIND == SPHERES {
        return spheres(filters, ray, chords, (leaf, at), own, limit, certain_limit);
    }
    let others = lanes::<F>(leaf.others(), at);
    let mut found = if leaf.flats() != 0 {
        flats::<F, false, W>(filters, ray, (leaf, at), limit, certain_limit)
    } else {
        spheres(filters, ray, chords, (leaf, at), own, limit, certain_limit)
    };
    if leaf.flats() != 0 && leaf.spheres() != 0 {
        // Mixed leaves are rare: of their spheres no distance is known.
        let balls = spheres(filters, ray, chords, (leaf, at), own, limit, certain_limit);
        let met = balls.mask & lanes::<F>(leaf.spheres(), at);
        found.mask |= met;
        found.missed &= !met;
        found.certain &= !met;
        found.unbounded |= met;
    }
    found.mask |= others;
    found.missed &= !others;
    found.certain &= !others;
    found.unbounded |= others;
    found.mask &= !(own & lanes::<F>(leaf.flats(), at));
    found.certain &= !own;
    found
}

/// The lanes of a vector among those of a leaf.
#[inline(always)]
fn lanes<F: Filters>(mask: u32, at: usize) -> u32 {
    mask >> at & ((1 << F::Vector::WIDTH) - 1)
}

/// [`candidates`] among the flat shapes: Woop's projection in `f32` with error bounds.
///
/// A point of the plane is within a triangle of edge functions u, v, w if none has another sign than the rest; within the
/// parallelogram of the same three corners if v and w have, and their differences from u + v + w: u + w and u + v, the lesser of
/// which is u + min(v, w). They err by twice as much, and the fourth corner may be twice as deep as the others.
///
/// An edge function errs by [`leaf_error`]. The distance, a mean of the vertices' weighted by the edge functions, errs by at
/// most three times that times their spread, over the determinant, and by less than 3δ for the rounding of distances, sum and
/// quotient.
#[inline(always)]
fn flats<F: Filters, const TRIANGLES_ONLY: bool, const W: usize>(
    filters: F,
    ray: &FrameRay<Narrow<F>>,
    (leaf, at): (&Leaf<W>, usize),
    limit: f32,
    certain_limit: f32,
) -> Candidates<W> {
    let all = |v| F::Vector::splat(filters.into(), v);
    let a = project(filters, ray, leaf.vertex(0), at);
    let b = project(filters, ray, leaf.vertex(1), at);
    let c = project(filters, ray, leaf.vertex(2), at);
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    let delta = ray.error + leaf.error();
    let mut error = leaf_error(delta, leaf.extent());
    let (mut least, mut most) = (v.min(w), v.max(w));
    if TRIANGLES_ONLY || leaf.quads() == 0 {
        (least, most) = (least.min(u), most.max(u));
    } else {
        error *= 2.0;
        let quads = lanes::<F>(leaf.quads(), at);
        least = least.min(u + least.only(quads));
        most = most.max(u + most.only(quads));
    }
    let met = all(-error).at_most(least) | most.at_most(all(error));
    if met == 0 {
        return Candidates::NONE;
    }
    let det = u + v + w;
    let reciprocal = all(-ray.per_depth) / det;
    let t = (u * a[2] + v * b[2] + w * c[2]) * reciprocal;
    // Along an axis vertices are no farther apart than the extent, to rounding.
    let t_error = all(6.0 * error * (leaf.extent() + 2.0 * delta)) * reciprocal.abs() + all(3.0 * delta);
    let determined = all(6.0 * error).below(det.abs());
    let (near, far) = (t - t_error, t + t_error);
    let missed = determined & (all(limit).below(near) | far.below(all(0.0)));
    let inside = all(error).below(least) | most.below(all(-error));
    let ahead = all(0.0).below(near) & far.below(all(certain_limit));
    Candidates {
        mask: met,
        missed,
        unbounded: !determined,
        certain: determined & inside & ahead & if TRIANGLES_ONLY { u32::MAX } else { !lanes::<F>(leaf.disks(), at) },
        near: Row(near.to_row(at)),
        far: Row(far.to_row(at)),
    }
}

/// A vertex in the projection of the ray, all its coordinates negated (an instruction subtracts what it reads from memory, not
/// from it): z is not yet scaled.
#[inline(always)]
fn project<F: Filters, const W: usize>(
    filters: F,
    ray: &FrameRay<Narrow<F>>,
    vertex: &[[f32; W]; 3],
    at: usize,
) -> [F::Vector; 3] {
    let [kx, ky, kz] = AXES[ray.axis % AXES.len()];
    let (start, slopes) = (ray.start_along.to_array(), ray.slopes.to_array());
    let x = from_origin(filters, start[0], &vertex[kx as usize], at);
    let y = from_origin(filters, start[1], &vertex[ky as usize], at);
    let z = from_origin(filters, start[2], &vertex[kz as usize], at);
    let (sx, sy) = (F::Vector::splat(filters.into(), slopes[0]), F::Vector::splat(filters.into(), slopes[1]));
    [x - sx * z, y - sy * z, z]
}

/// The origin's coordinate less the vertices'. No closure, which may be called, and be compiled without vector instructions.
#[inline(always)]
fn from_origin<F: Filters, const W: usize>(filters: F, start: f32, row: &[f32; W], at: usize) -> F::Vector {
    F::Vector::splat(filters.into(), start) - F::Vector::load(filters.into(), row, at)
}

#[inline(always)]
fn edge<V: Vector>(p: [V; 3], q: [V; 3]) -> V {
    p[0] * q[1] - p[1] * q[0]
}

/// What spheres ask of a ray of slopes s: n = 1 + s², n times the squared distance from the ray of a point that projects to (x, y)
/// as the form a·x² − 2b·xy + c·y², and −1/(the largest component of the direction) over n, which takes the place abreast of the
/// point from what it is along the slopes.
pub(super) struct SphereFilter {
    n: f32,
    form: [f32; 3],
    per_n: f32,
}

impl SphereFilter {
    /// For a tree without spheres nothing is computed.
    #[inline(always)]
    pub(super) fn new<L: Lanes4>(ray: &FrameRay<L>, spheres: bool) -> Self {
        if !spheres {
            return Self { n: 1.0, form: [0.0; 3], per_n: 0.0 };
        }
        let [sx, sy, _, _] = ray.slopes.to_array();
        let (sx2, sy2) = (sx * sx, sy * sy);
        let n = 1.0 + sx2 + sy2;
        Self { n, form: [1.0 + sy2, sx * sy, 1.0 + sx2], per_n: -ray.per_depth / n }
    }
}

/// [`candidates`] among the spheres.
///
/// With δ the bound on the error of a projected coordinate, the slopes s of the projection and n = 1 + s² ∈ [1, 3],
/// a centre that projects to (x, y) is at the distance d from the ray of which n·d² = (1 + sy²)·x² − 2·sx·sy·xy + (1 + sx²)·y²,
/// and abreast of it at z + (x·sx + y·sy)/n. The distance errs by no more than √2·δ, the radius and its sum with the slack by two
/// roundoffs of the radius, of which δ is at least 12: by less than 1.6δ together. The place along the ray errs by at most 4δ, and
/// by 4 roundoffs of itself, whose magnitude is below that of which δ is at least 12.
///
/// Of radii 6δ smaller and larger 4.4δ are left. They change n·r² by at least 100 roundoffs of it. The form, which is not below
/// x² + y² and whose terms add up to at most three times that, errs by 18 roundoffs of itself, which matter where it is not above
/// n·r², and that is computed to 8. The other 74 and more are of the square of the half chord, too, and their half pays for the 16
/// roundoffs by which the half chord √((r² − d²)/n) errs.
#[inline(always)]
fn spheres<F: Filters, const W: usize>(
    filters: F,
    ray: &FrameRay<Narrow<F>>,
    &SphereFilter { n, form: [a, b, c], per_n }: &SphereFilter,
    (leaf, at): (&Leaf<W>, usize),
    own: u32,
    limit: f32,
    certain_limit: f32,
) -> Candidates<W> {
    let all = |v| F::Vector::splat(filters.into(), v);
    let ([sx, sy, _, _], sz) = (ray.slopes.to_array(), -ray.per_depth);
    let [x, y, z] = project(filters, ray, leaf.vertex(0), at);
    let radius = F::Vector::load(filters.into(), &leaf.vertex(1)[0], at);
    // n times the squares of the distance, of the radii and of the half chords.
    let squared = x * (all(a) * x - all(b) * y) + y * (all(c) * y - all(b) * x);
    let delta = ray.error + leaf.error();
    let slack = all(6.0 * delta);
    let (inner, outer) = (radius - slack, radius + slack);
    let outer_squared = outer * outer * all(n);
    let middle = z * all(sz) + (x * all(sx) + y * all(sy)) * all(per_n);
    let t_error = all(8.0 * delta);
    // A sphere that the ray leaves is hit again only if its centre is ahead.
    let met = squared.at_most(outer_squared) & !(own & middle.below(all(-8.0 * delta)));
    if met == 0 {
        return Candidates::NONE;
    }
    // Lanes of NaN are none of `met`, or not certain.
    let longer = (outer_squared - squared).sqrt() * all(per_n.abs());
    let shortest = inner * inner * all(n) - squared;
    let shorter = shortest.sqrt() * all(per_n.abs());
    let (mut near, mut far) = (middle - longer - t_error, middle - shorter + t_error);
    let farther = middle + longer + t_error;
    let missed = !(near.at_most(all(limit)) & all(0.0).at_most(farther));
    let pierced = all(0.0).below(shortest) & all(0.0).below(inner);
    // Around the origin, where the first root is certainly behind, the second is the hit.
    let around = met & pierced & far.below(all(0.0)) & !missed;
    if around != 0 {
        near = near.only(!around) + (middle + shorter - t_error).only(around);
        far = far.only(!around) + farther.only(around);
    }
    // A root is the hit only where it is certainly ahead, and not of the sphere left.
    let certain = pierced & !own & all(0.0).below(near) & far.below(all(certain_limit));
    Candidates {
        mask: met & !missed,
        missed: 0,
        unbounded: 0,
        certain,
        near: Row(near.to_row(at)),
        far: Row(far.to_row(at)),
    }
}

/// Bound on the error of the edge functions of a leaf's flat shapes in the projection of a ray that meets the leaf's box.
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
