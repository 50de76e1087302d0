//! The surfaces of few primitives at eight hits: the operations of each shape's own, in their order, on what they share.

use crate::lanes::lanes_of;
use crate::small_scene::{Eight, FLAT_LIMIT, IS_PLANE, POINT, ROW, SIZE, SurfaceTable, axes};
use crate::traverse::{Filters, Job};
use crate::{Hits, LANES, Primitive, Rays, SurfacePoint, SurfacePoints};
use etalon_optics::Real;

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
    fn run<F: Filters>(self, filters: F) -> SurfacePoints {
        let Self { table, primitives, rays, hits, active, label } = self;
        let token = filters.into();
        let all = |v| F::Eight::splat(token, v);
        let ids = hits.surface.map(|s| s.primitive.0 % FLAT_LIMIT as u32);
        let planes = table.rows();
        // Functions and not closures, which may be left outside without the caller's vector instructions.
        let n: [F::Eight; 3] = three(token, planes, &ids, 0);
        let point: [F::Eight; 3] = three(token, planes, &ids, POINT);
        let (origin, direction) = (F::Eight::rows(token, &rays.origin), F::Eight::rows(token, &rays.direction));
        let t = F::Eight::new(token, &hits.t);
        let p = axes(|k| origin[k] + direction[k] * t);
        let away = axes(|k| p[k] - point[k]);
        let height = away[0] * n[0] + away[1] * n[1] + away[2] * n[2];
        let position = axes(|k| p[k] - n[k] * height);
        let reach = F::Eight::largest(away).max(number::<F::Eight>(token, planes, &ids, SIZE)) * all(16.0);
        let u = all(f64::UNIT_ROUNDOFF);
        let error = axes(|k| (p[k].abs() + position[k].abs() + reach) * u);
        let distance = n[0].abs() * error[0] + n[1].abs() * error[1] + n[2].abs() * error[2];
        let distance = distance * all(1.0 + 8.0 * f64::UNIT_ROUNDOFF);
        let mut out = SurfacePoints {
            position: axes(|k| position[k].to_array()),
            // The next number up, of one that is not negative.
            position_error: distance.to_array().map(|d| f64::from_bits(d.to_bits().wrapping_add(1))),
            normal: axes(|k| n[k].to_array()),
            surface: hits.surface,
            label: [label; LANES],
        };
        let is_plane = F::Eight::bits(all(0.0).below(number::<F::Eight>(token, planes, &ids, IS_PLANE)));
        for l in lanes_of(active & !is_plane) {
            let ray = rays.get(l);
            let point = primitives[ids[l] as usize].surface(ray.origin + ray.direction * hits.t[l]);
            out.set(l, &SurfacePoint::rounded(&point, hits.surface[l], label, ray.time));
        }
        out
    }
}

/// Number `k` of each surface's row.
#[inline(always)]
fn number<E: Eight>(token: E::Token, planes: &[f64; ROW * FLAT_LIMIT], ids: &[u32; LANES], k: u32) -> E {
    E::gathered(token, planes, &ids.map(|id| id * ROW as u32 + k))
}

/// The three from number `k` on.
#[inline(always)]
fn three<E: Eight>(token: E::Token, planes: &[f64; ROW * FLAT_LIMIT], ids: &[u32; LANES], k: u32) -> [E; 3] {
    [number(token, planes, ids, k), number(token, planes, ids, k + 1), number(token, planes, ids, k + 2)]
}
