//! Eight rays against each primitive in turn.

use super::eight::{Eight, Which, bits, both};
use super::exact::{Corners, Decided, Eights};
use super::filter::*;
use super::{BLOCK, FLAT_LIMIT, FURTHEST, Flat, MOST_REACH, NO_ID, SLACK, Wide};
use crate::frame::{lowered, raised};
use crate::lanes::lanes_of;
use crate::query::{MAX_ORIGIN, Query, power_of_two};
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

/// Eight rays with their directions scaled by powers of two, as [`Query`] does it.
struct Prepared {
    direction: [Eight; 3],
    /// Powers of two.
    scale: Eight,
    t_max: Eight,
    /// Where x, and where else y, is the largest component of the direction.
    along: [Which; 2],
    /// Rows of what a [`Beam`] holds.
    beams: [[f32; LANES]; size_of::<Beam>() / 4],
    /// The lanes whose rays the filters can do with.
    usable: u8,
}

impl Prepared {
    #[inline(always)]
    fn new(flat: &Flat, rays: &Rays, active: u8) -> Self {
        const EXPONENT: u64 = 0x7FF << 52;
        let given = rays.direction.map(Eight);
        let a = given.map(Eight::abs);
        let magnitude = Eight::largest(given);
        // The power of two below, and its inverse, as in `Query`.
        let unit = Eight(magnitude.0.map(|m| f64::from_bits(m.to_bits() & EXPONENT)));
        let scale = Eight(unit.0.map(|u| f64::from_bits((2046_u64 << 52).wrapping_sub(u.to_bits()))));
        let o = rays.origin.map(Eight);
        let [reach, sum] = [o.map(Eight::abs), a].map(|[x, y, z]| x + y + z);
        let t = Eight(rays.t_max);
        let usable = both(
            both(reach.below(Eight::splat(MAX_ORIGIN)), sum.below(Eight::splat(f64::INFINITY))),
            both(
                both(
                    Eight::splat(power_of_two(-900)).at_most(magnitude),
                    magnitude.below(Eight::splat(power_of_two(901))),
                ),
                Eight::splat(0.0).below(t),
            ),
        );
        let direction = given.map(|d| d * scale);
        let (centre, per_m) = (flat.frame.centre().to_array(), Eight::splat(flat.frame.scale()));
        let place: [Eight; 3] = from_fn(|k| (o[k] - Eight::splat(centre[k])) * per_m);
        let own = Eight::largest(place);
        let near = both(usable, own.at_most(Eight::splat(MOST_REACH)));
        let t_max = t * unit;
        let ends = limits(t_max, flat.frame.scale());
        let id = |ids: &[SurfaceId; LANES]| -> [f32; LANES] {
            let own: [u32; LANES] =
                from_fn(|l| if ids[l].instance == 0 { ids[l].primitive.0 } else { PrimitiveId::NONE.0 });
            from_fn(|l| if own[l] < FLAT_LIMIT as u32 { own[l] as i32 as f32 } else { NO_ID })
        };
        let reach = (own + Eight::splat(flat.reach)).narrowed();
        let mut beams = [[0.0; LANES]; size_of::<Beam>() / 4];
        for k in 0..3 {
            beams[ORIGIN + k] = place[k].narrowed();
            beams[DIRECTION + k] = direction[k].narrowed();
        }
        beams[REACH] = reach.map(raised);
        // Those that are not wanted end before they begin.
        beams[LIMIT] = from_fn(|l| if near[l] & (active >> l & 1 == 1) { ends[0][l] } else { -1.0 });
        beams[CERTAIN_LIMIT] = ends[1];
        beams[LEAVES] = id(&rays.leaves);
        beams[AIMS_AT] = id(&rays.aims_at);
        // As `projection_axis` has it.
        let [x, y, z] = a;
        let (along_y, along_z) = (x.max(z).below(y), both(x.below(z), y.at_most(z)));
        let along = [from_fn(|l| !along_y[l] & !along_z[l]), along_y];
        Self { direction, scale, t_max, along, beams, usable: bits(near) }
    }
}

/// [`super::limits`] of eight.
#[inline(always)]
fn limits(t: Eight, per_m: f64) -> [[f32; LANES]; 2] {
    let t = t * Eight::splat(per_m);
    let most = Eight::splat(FURTHEST);
    let t = t.or_else(t.below(most), most);
    [(t * Eight::splat(1.0 + SLACK)).narrowed().map(raised), (t * Eight::splat(1.0 - SLACK)).narrowed().map(lowered)]
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
        let t = t * prepared.scale;
        hits.t = t.0;
        hits.uv = uv.map(|w| w.0);
        hits.surface = ids.map(|id| PrimitiveId(id as u32).into());
        hits.mask = bits(both(hit, t.below(Eight::splat(f64::INFINITY)))) & found;
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
        let [along_x, along_y] = self.along;
        let turned = |[x, y, z]: [Eight; 3]| -> [Eight; 3] {
            let choose = |a: Eight, b: Eight, c: Eight| a.or_else(along_x, b.or_else(along_y, c));
            [choose(y, z, x), choose(z, x, y), choose(x, y, z)]
        };
        let [dx, dy, dz] = turned(self.direction);
        let rz = Eight::splat(1.0) / dz;
        let axis = from_fn(|l| if along_x[l] { 0 } else { 2 - usize::from(along_y[l]) });
        Eights { axis, start: turned(rays.origin.map(Eight)), shear: [dx * rz, dy * rz, rz], t_max: self.t_max }
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
