//! Eight rays against each primitive in turn.

use super::exact::{Corners, Decided, Eights, axes};
use super::filter::*;
use super::{BLOCK, FLAT_LIMIT, Flat, MOST_REACH, NO_ID, Wide, limits};
use crate::frame::above;
use crate::lanes::lanes_of;
use crate::query::{MAX_ORIGIN, Query, larger, power_of_two, projection_axis};
use crate::traverse::{Filters, Job};
use crate::{Hits, LANES, Primitive, PrimitiveId, Rays, SurfaceId};
use std::array::from_fn;

/// The closest hits; and the lanes that have to be asked for one by one.
pub(super) struct Closest<'a> {
    pub(super) flat: &'a Flat,
    pub(super) corners: &'a Corners,
    pub(super) primitives: &'a [Primitive],
    pub(super) rays: &'a Rays,
    pub(super) active: u8,
}

/// Whether anything is hit; and the lanes that have to be asked for one by one.
pub(super) struct Any<'a> {
    pub(super) flat: &'a Flat,
    pub(super) rays: &'a Rays,
    pub(super) active: u8,
}

type Eight = [f64; LANES];

/// Eight rays with their directions scaled by powers of two, as [`Query`] does it.
struct Prepared {
    direction: [Eight; 3],
    /// Powers of two.
    scale: Eight,
    t_max: Eight,
    axis: [usize; LANES],
    /// Rows of what [`Beam`] holds.
    beams: [[f32; LANES]; size_of::<Beam>() / 4],
    /// The lanes whose rays the filters can do with.
    usable: u8,
}

impl Prepared {
    #[inline(always)]
    fn new(flat: &Flat, rays: &Rays, active: u8) -> Self {
        let mut out = Self {
            direction: [[0.0; LANES]; 3],
            scale: [0.0; LANES],
            t_max: [0.0; LANES],
            axis: [0; LANES],
            beams: [[0.0; LANES]; size_of::<Beam>() / 4],
            usable: 0,
        };
        let centre = flat.frame.centre().to_array();
        let per_unit = flat.frame.scale();
        for l in 0..LANES {
            let d = [rays.direction[0][l], rays.direction[1][l], rays.direction[2][l]];
            let o = [rays.origin[0][l], rays.origin[1][l], rays.origin[2][l]];
            let a = d.map(f64::abs);
            let magnitude = larger(larger(a[0], a[1]), a[2]);
            let exponent = (magnitude.to_bits() >> 52) as i64 - 1023;
            let sums = [o[0].abs() + o[1].abs() + o[2].abs(), a[0] + a[1] + a[2]];
            let usable = (sums[0] < MAX_ORIGIN)
                & (sums[1] < f64::INFINITY)
                & (-900..=900).contains(&exponent)
                & (rays.t_max[l] > 0.0);
            let exponent = if usable { exponent } else { 0 };
            let scale = power_of_two(-exponent);
            let direction = d.map(|c| c * scale);
            let place: [f64; 3] = from_fn(|k| (o[k] - centre[k]) * per_unit);
            let own = larger(larger(place[0].abs(), place[1].abs()), place[2].abs());
            let near = usable & (own <= MOST_REACH);
            let t_max = rays.t_max[l] * power_of_two(exponent);
            let [limit, certain_limit] = limits(t_max, &flat.frame);
            let id = |s: SurfaceId| {
                if (s.instance == 0) & (s.primitive.0 < FLAT_LIMIT as u32) {
                    s.primitive.0 as i32 as f32
                } else {
                    NO_ID
                }
            };
            for k in 0..3 {
                out.direction[k][l] = direction[k];
                out.beams[ORIGIN + k][l] = place[k] as f32;
                out.beams[DIRECTION + k][l] = direction[k] as f32;
            }
            out.scale[l] = scale;
            out.t_max[l] = t_max;
            out.axis[l] = projection_axis(a);
            out.beams[REACH][l] = above(own + flat.reach);
            // Those that are not wanted end before they begin.
            let wanted = near & (active >> l & 1 == 1);
            out.beams[LIMIT][l] = if wanted { limit } else { -1.0 };
            out.beams[CERTAIN_LIMIT][l] = certain_limit;
            out.beams[LEAVES][l] = id(rays.leaves[l]);
            out.beams[AIMS_AT][l] = id(rays.aims_at[l]);
            out.usable |= u8::from(near) << l;
        }
        out
    }
}

/// Calls a function with what is known of the eight rays and each share of primitives, and their ids.
#[inline(always)]
fn each<V: Wide>(
    flat: &Flat,
    token: V::Token,
    beams: &Beams<V>,
    mut f: impl FnMut(Known<V>, V),
    enough: impl Fn() -> bool,
) {
    let mut left = flat.flat_count;
    for block in &flat.flats {
        let mut at = 0;
        while at < BLOCK.min(left) {
            let shape = FlatsIn::new(block, |row| V::shared(token, row, at));
            f(flats(beams, &shape), shape.id);
            at += V::SHARE;
        }
        left = left.saturating_sub(BLOCK);
        if enough() {
            return;
        }
    }
    let mut left = flat.sphere_count;
    if left == 0 {
        return;
    }
    let chords = Chords::new(token, beams);
    for block in &flat.spheres {
        let mut at = 0;
        while at < BLOCK.min(left) {
            let shape = SpheresIn::new(block, |row| V::shared(token, row, at));
            f(spheres(beams, &chords, &shape), shape.id);
            at += V::SHARE;
        }
        left = left.saturating_sub(BLOCK);
        if enough() {
            return;
        }
    }
}

impl Job for Closest<'_> {
    type Output = (Hits, u8);

    #[inline(always)]
    fn run<F: Filters>(self, filters: F) -> (Hits, u8) {
        let Self { flat, corners, primitives, rays, active } = self;
        let prepared = Prepared::new(flat, rays, active);
        let token = filters.into();
        let all = |v| F::Wide::splat(token, v);
        let beams = Beams::new(token, |at| F::Wide::rays(token, &prepared.beams[at]));
        let nothing = all(f32::INFINITY);
        // Of the nearest that is certain: its ends and which it is; and the nearest that any other may be.
        let (mut far, mut near, mut id, mut other) = (all(f32::MAX), nothing, all(NO_ID), nothing);
        each(
            flat,
            token,
            &beams,
            |known, of| {
                let nearer = known.certain & known.far.below(far);
                other = near.or_else(nearer, known.near.or_else(known.met, nothing)).min(other);
                far = known.far.or_else(nearer, far);
                near = known.near.or_else(nearer, near);
                id = of.or_else(nearer, id);
            },
            || false,
        );
        let store = |v: F::Wide| {
            let mut row = [0.0; BLOCK];
            v.store(&mut row);
            row
        };
        let (far, near, id, other) = (store(far), store(near), store(id), store(other));
        let mut ids = [0; LANES];
        let (mut found, mut undecided) = (0_u8, 0_u8);
        for l in 0..LANES {
            let (mut best, mut next) = (l * F::Wide::SHARE, f32::INFINITY);
            next = if other[best] < next { other[best] } else { next };
            for p in 1..F::Wide::SHARE {
                let lane = l * F::Wide::SHARE + p;
                let (winner, loser) = if far[lane] < far[best] { (lane, best) } else { (best, lane) };
                next = if near[loser] < next { near[loser] } else { next };
                next = if other[lane] < next { other[lane] } else { next };
                best = winner;
            }
            ids[l] = id[best] as i32 as usize % FLAT_LIMIT;
            found |= u8::from(id[best] >= 0.0) << l;
            undecided |= u8::from(next <= far[best]) << l;
        }
        let wanted = active & prepared.usable;
        undecided = undecided & wanted | active & !prepared.usable;
        found &= wanted & !undecided;
        let mut hits = Hits::NONE;
        if found == 0 {
            return (hits, undecided);
        }
        let Decided { hit, t, uv } = corners.triangles(&prepared.exact(rays), &ids);
        for l in 0..LANES {
            hits.t[l] = t[l] * prepared.scale[l];
            hits.surface[l] = PrimitiveId(ids[l] as u32).into();
            hits.mask |= u8::from(hit[l] & (hits.t[l] < f64::INFINITY)) << l;
        }
        hits.uv = uv;
        hits.mask &= found;
        for l in lanes_of(found & !hits.mask) {
            let ray = rays.get(l);
            let query = Query::new(&ray).expect("it was prepared");
            let id = PrimitiveId(ids[l] as u32);
            match primitives[ids[l]].intersect(&query, query.t_max, query.leaves == id) {
                Some(hit) if hit.t * query.scale < f64::INFINITY => {
                    let hit = crate::Hit { t: hit.t * query.scale, surface: id.into(), uv: hit.uv };
                    hits.set(l, Some(&hit));
                }
                _ => undecided |= 1 << l,
            }
        }
        (hits, undecided)
    }
}

impl Prepared {
    /// For the exact test.
    #[inline(always)]
    fn exact(&self, rays: &Rays) -> Eights {
        let axes = axes(&self.axis);
        let along = |v: &[Eight; 3], k: usize| -> Eight { from_fn(|l| v[axes[k][l] % 3][l]) };
        let start = from_fn(|k| along(&rays.origin, k));
        let [dx, dy, dz] = from_fn(|k| along(&self.direction, k));
        let rz: Eight = from_fn(|l| 1.0 / dz[l]);
        let shear = [from_fn(|l| dx[l] * rz[l]), from_fn(|l| dy[l] * rz[l]), rz];
        Eights { axes, start, shear, t_max: self.t_max }
    }
}

impl Job for Any<'_> {
    type Output = (u8, u8);

    #[inline(always)]
    fn run<F: Filters>(self, filters: F) -> (u8, u8) {
        let Self { flat, rays, active } = self;
        let prepared = Prepared::new(flat, rays, active);
        let token = filters.into();
        let beams = Beams::new(token, |at| F::Wide::rays(token, &prepared.beams[at]));
        let (certain, met) = (std::cell::Cell::new(0_u32), std::cell::Cell::new(0_u32));
        let rays_of = |bits: u32| {
            (0..F::Wide::SHARE).fold(0_u8, |mask, p| {
                (0..LANES).fold(mask, |mask, l| mask | ((bits >> (l * F::Wide::SHARE + p) & 1) as u8) << l)
            })
        };
        let wanted = active & prepared.usable;
        each(
            flat,
            token,
            &beams,
            |known, id| {
                let counts = !id.equals(beams.aims_at);
                certain.set(certain.get() | F::Wide::bits(known.certain & counts));
                met.set(met.get() | F::Wide::bits(known.met & counts));
            },
            || rays_of(certain.get()) & wanted == wanted,
        );
        let hit = rays_of(certain.get()) & wanted;
        let undecided = rays_of(met.get()) & wanted & !hit | active & !prepared.usable;
        (hit, undecided)
    }
}
