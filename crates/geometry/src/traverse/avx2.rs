//! The filters in AVX2, eight lanes at once.
#![allow(unsafe_code)] // Vector instructions behind a token that proves their presence; see each block.

use super::{Candidates, Entered, Filters, any_with, closest_with, leaf_error, sphere_bounds};
use crate::frame::FrameRay;
use crate::query::{Query, RawHit};
use crate::wide::{EXACT, Leaf8, Node8, SPHERE, WIDTH, WideTree};
use crate::{Primitive, PrimitiveId};
use std::arch::x86_64::*;

/// Proof that the processor has AVX2: [`Avx2::detect`] alone makes one.
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

impl Avx2 {
    #[inline(always)]
    pub(super) fn detect() -> Option<Self> {
        std::arch::is_x86_feature_detected!("avx2").then_some(Self(()))
    }

    #[inline(always)]
    pub(super) fn closest(
        self,
        tree: &WideTree,
        primitives: &[Primitive],
        query: &Query,
    ) -> Option<(RawHit, PrimitiveId)> {
        // SAFETY: `self` proves that the processor has AVX2.
        unsafe { closest(self, tree, primitives, query) }
    }

    #[inline(always)]
    pub(super) fn any(self, tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
        // SAFETY: `self` proves that the processor has AVX2.
        unsafe { any(self, tree, primitives, query) }
    }
}

#[target_feature(enable = "avx2,bmi1")]
fn closest(filters: Avx2, tree: &WideTree, primitives: &[Primitive], query: &Query) -> Option<(RawHit, PrimitiveId)> {
    closest_with(filters, tree, primitives, query)
}

#[target_feature(enable = "avx2,bmi1")]
fn any(filters: Avx2, tree: &WideTree, primitives: &[Primitive], query: &Query) -> bool {
    any_with(filters, tree, primitives, query)
}

/// Eight floats. Its operations, and whatever else here uses vector instructions, are inlined by force into the two
/// functions above, the only ones compiled for AVX2. They exist for an [`Avx2`] alone, which [`Filters`] hands on.
#[derive(Clone, Copy)]
struct F8(__m256);

macro_rules! operator {
    ($trait:ident, $f:ident, $instruction:ident) => {
        impl std::ops::$trait for F8 {
            type Output = Self;
            #[inline(always)]
            fn $f(self, o: Self) -> Self {
                // SAFETY: arithmetic of AVX, whose presence is proved where an `F8` comes from.
                Self(unsafe { $instruction(self.0, o.0) })
            }
        }
    };
}
operator!(Add, add, _mm256_add_ps);
operator!(Sub, sub, _mm256_sub_ps);
operator!(Mul, mul, _mm256_mul_ps);
operator!(Div, div, _mm256_div_ps);
operator!(BitAnd, bitand, _mm256_and_ps);
operator!(BitOr, bitor, _mm256_or_ps);
operator!(BitXor, bitxor, _mm256_xor_ps);

impl F8 {
    #[inline(always)]
    fn splat(_: Avx2, v: f32) -> Self {
        // SAFETY: the token proves AVX2.
        Self(unsafe { _mm256_set1_ps(v) })
    }

    #[inline(always)]
    fn load(_: Avx2, row: &[f32; WIDTH]) -> Self {
        // SAFETY: the token proves AVX2; eight floats are readable at the reference, aligned or not.
        Self(unsafe { _mm256_loadu_ps(row.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f32; WIDTH] {
        let mut out = [0.0; WIDTH];
        // SAFETY: as for the operators; eight floats are writable at the reference, aligned or not.
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), self.0) };
        out
    }

    /// The smaller of each pair; the second if one is NaN.
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_min_ps(self.0, o.0) })
    }

    /// The larger of each pair; the second if one is NaN.
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_max_ps(self.0, o.0) })
    }

    /// All bits of the lanes that are below; false for NaN.
    #[inline(always)]
    fn below(self, o: Self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, o.0) })
    }

    /// All bits of the lanes that are not above; false for NaN.
    #[inline(always)]
    fn at_most(self, o: Self) -> Self {
        // SAFETY: as for the operators.
        Self(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, o.0) })
    }

    /// The sign bits.
    #[inline(always)]
    fn mask(self) -> u32 {
        // SAFETY: as for the operators.
        (unsafe { _mm256_movemask_ps(self.0) }) as u32
    }

    #[inline(always)]
    fn max_of(a: [Self; 3]) -> Self {
        a[0].max(a[1]).max(a[2])
    }

    #[inline(always)]
    fn min_of(a: [Self; 3]) -> Self {
        a[0].min(a[1]).min(a[2])
    }
}

/// Sets of lanes of a leaf.
struct Lanes {
    /// Empty ones, those of other primitives than triangles, and the one that the ray leaves.
    excluded: u32,
    /// Those of other primitives than triangles.
    others: u32,
    /// Those of spheres.
    spheres: u32,
}

#[inline(always)]
fn lanes(_: Avx2, ids: &[u32; WIDTH], leaves: PrimitiveId) -> Lanes {
    // SAFETY: the token proves AVX2; eight integers are readable at the reference, aligned or not.
    unsafe {
        let ids = _mm256_loadu_si256(ids.as_ptr().cast());
        let plain = _mm256_andnot_si256(_mm256_set1_epi32(EXACT as i32), ids);
        let empty = _mm256_cmpeq_epi32(ids, _mm256_set1_epi32(-1));
        let left = _mm256_cmpeq_epi32(plain, _mm256_set1_epi32(leaves.0 as i32));
        let other = _mm256_movemask_ps(_mm256_castsi256_ps(ids)) as u32;
        let empty = _mm256_movemask_ps(_mm256_castsi256_ps(empty)) as u32;
        let left = _mm256_movemask_ps(_mm256_castsi256_ps(left)) as u32;
        // The mark of spheres, moved to the sign.
        let sphere = _mm256_slli_epi32::<{ 31 - SPHERE.trailing_zeros() as i32 }>(ids);
        let sphere = _mm256_movemask_ps(_mm256_castsi256_ps(sphere)) as u32;
        let others = other & !empty;
        Lanes { excluded: other | left, others, spheres: sphere & others }
    }
}

/// The lanes whose spheres the ray may meet; as the portable filter.
#[inline(always)]
fn spheres(filters: Avx2, ray: &Ray8, leaf: &Leaf8, limit: f32) -> u32 {
    let all = |v| F8::splat(filters, v);
    let [sx, sy, sz] = ray.shear;
    let [x, y, z] = project(filters, ray, &leaf.vertices[0]);
    let along = x * all(sx) + y * all(sy);
    let flat = all(1.0 / (1.0 + sx * sx + sy * sy));
    let squared = x * x + y * y - along * along * flat;
    let (slack, factor) = sphere_bounds(ray.error);
    let reach = F8::load(filters, &leaf.vertices[1][0]) + all(slack);
    let middle = (z + along * flat) * all(sz);
    let beside = (reach * reach * all(factor)).below(squared);
    let beyond = all(limit).below(middle - reach) | (middle + reach).below(all(0.0));
    !(beside | beyond).mask()
}

/// A ray broadcast to all lanes.
#[derive(Clone, Copy)]
pub(super) struct Ray8 {
    origin_near: [F8; 3],
    origin_far: [F8; 3],
    reciprocal_near: [F8; 3],
    reciprocal_far: [F8; 3],
    /// The planes where the ray enters, 0 or 1 for each axis.
    entry: [usize; 3],
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 3],
    error: f32,
    leaves: PrimitiveId,
}

/// A vertex in the projection of the ray: z is not yet scaled.
#[inline(always)]
fn project(filters: Avx2, ray: &Ray8, vertex: &[[f32; WIDTH]; 3]) -> [F8; 3] {
    let [kx, ky, kz] = ray.axes;
    let z = F8::load(filters, &vertex[kz]) - F8::splat(filters, ray.origin[2]);
    let x = F8::load(filters, &vertex[kx]) - F8::splat(filters, ray.origin[0]);
    let y = F8::load(filters, &vertex[ky]) - F8::splat(filters, ray.origin[1]);
    [x - F8::splat(filters, ray.shear[0]) * z, y - F8::splat(filters, ray.shear[1]) * z, z]
}

#[inline(always)]
fn edge(p: [F8; 3], q: [F8; 3]) -> F8 {
    p[0] * q[1] - p[1] * q[0]
}

impl Filters for Avx2 {
    type Ray = Ray8;

    #[inline(always)]
    fn ray(self, ray: &FrameRay, leaves: PrimitiveId) -> Ray8 {
        let [nx, ny, nz] = ray.origin_near;
        let [fx, fy, fz] = ray.origin_far;
        let [rx, ry, rz] = ray.reciprocal_near;
        let [sx, sy, sz] = ray.reciprocal_far;
        Ray8 {
            origin_near: [F8::splat(self, nx), F8::splat(self, ny), F8::splat(self, nz)],
            origin_far: [F8::splat(self, fx), F8::splat(self, fy), F8::splat(self, fz)],
            reciprocal_near: [F8::splat(self, rx), F8::splat(self, ry), F8::splat(self, rz)],
            reciprocal_far: [F8::splat(self, sx), F8::splat(self, sy), F8::splat(self, sz)],
            entry: ray.negative,
            axes: ray.axes,
            origin: ray.origin,
            shear: ray.shear,
            error: ray.error,
            leaves,
        }
    }

    #[inline(always)]
    fn enter(self, ray: &Ray8, node: &Node8, limit: f32) -> Entered {
        let [ex, ey, ez] = ray.entry;
        let planes = &node.planes;
        // The children's numbers lie in a cache line of their own, which would be asked for only once the mask is known.
        // SAFETY: a hint, which reads nothing; the address is within the node.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(node.children.as_ptr().cast()) };
        let plane = |k: usize, side: usize| F8::load(self, &planes[k][side & 1]);
        let near_x = (plane(0, ex) - ray.origin_near[0]) * ray.reciprocal_near[0];
        let near_y = (plane(1, ey) - ray.origin_near[1]) * ray.reciprocal_near[1];
        let near_z = (plane(2, ez) - ray.origin_near[2]) * ray.reciprocal_near[2];
        let far_x = (plane(0, 1 - ex) - ray.origin_far[0]) * ray.reciprocal_far[0];
        let far_y = (plane(1, 1 - ey) - ray.origin_far[1]) * ray.reciprocal_far[1];
        let far_z = (plane(2, 1 - ez) - ray.origin_far[2]) * ray.reciprocal_far[2];
        let near = near_x.max(near_y).max(near_z.max(F8::splat(self, 0.0)));
        let far = far_x.min(far_y).min(far_z.min(F8::splat(self, limit)));
        Entered { mask: near.at_most(far).mask(), near: near.to_array() }
    }

    #[inline(always)]
    fn prefetch(self, primitive: &Primitive) {
        let address = std::ptr::from_ref(primitive).cast::<i8>();
        // SAFETY: a hint, which reads nothing; both addresses are within the primitive.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(address);
            _mm_prefetch::<_MM_HINT_T0>(address.add(size_of::<Primitive>() - 1));
        }
    }

    /// As the portable filter, whose doc comment derives the bounds.
    #[inline(always)]
    fn candidates(self, ray: &Ray8, leaf: &Leaf8, limit: f32, certain_limit: f32) -> Candidates {
        let Lanes { excluded, others, spheres: balls } = lanes(self, &leaf.ids, ray.leaves);
        let mut unfiltered = others;
        if balls != 0 {
            unfiltered &= !balls | spheres(self, ray, leaf, limit);
            if excluded == 0xFF {
                return Candidates { mask: unfiltered, certain: 0, near: [0.0; WIDTH], far: [0.0; WIDTH] };
            }
        }
        let all = |v| F8::splat(self, v);
        let sign = all(-0.0);
        let a = project(self, ray, &leaf.vertices[0]);
        let b = project(self, ray, &leaf.vertices[1]);
        let c = project(self, ray, &leaf.vertices[2]);
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let error = all(leaf_error(ray.error, leaf.extent));
        let minus_error = error ^ sign;
        let (least, most) = (F8::min_of([u, v, w]), F8::max_of([u, v, w]));
        let outside = least.below(minus_error) & error.below(most);
        let mask = !(outside.mask() | excluded) & 0xFF;
        if mask == 0 {
            return Candidates { mask: unfiltered, certain: 0, near: [0.0; WIDTH], far: [0.0; WIDTH] };
        }
        let magnitude = all(f32::from_bits(!0 >> 1));
        let det = u + v + w;
        let reciprocal = all(ray.shear[2]) / det;
        let t = (u * a[2] + v * b[2] + w * c[2]) * reciprocal;
        let z = [a[2], b[2], c[2]];
        let depth = F8::max_of(z) - F8::min_of(z) + all(2.0 * ray.error);
        let error6 = error * all(6.0);
        let t_error = error6 * depth * (reciprocal & magnitude) + all(3.0 * ray.error);
        let determined = error6.below(det & magnitude);
        // Undetermined distances count as zero.
        let near = (t - t_error) & determined;
        let far = t + t_error;
        let zero = all(0.0);
        let beyond = determined & (all(limit).below(near) | far.below(zero));
        let mask = mask & !beyond.mask();
        let inside = error.below(least) | most.below(minus_error);
        let certain = inside & determined & zero.below(near) & far.below(all(certain_limit));
        Candidates {
            mask: mask | unfiltered,
            certain: certain.mask() & mask,
            near: near.to_array(),
            far: far.to_array(),
        }
    }
}
