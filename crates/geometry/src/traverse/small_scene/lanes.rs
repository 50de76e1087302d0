//! Eight rays against each primitive in turn.

use crate::frame::{lowered, raised};
use crate::lanes::lanes_of;
use crate::query::{MAX_ORIGIN, Query, power_of_two};
use crate::small_scene::*;
use crate::traverse::{Filters, Job};
use crate::{Hits, LANES, Primitive, PrimitiveId, Rays, SurfaceId};
use std::array::from_fn;

/// The closest hits; and the lanes that have to be asked for one by one.
pub(super) struct Closest<'a> {
    pub(super) flat: &'a SmallScene,
    pub(super) corners: &'a Corners,
    pub(super) primitives: &'a [Primitive],
    pub(super) rays: &'a Rays,
    pub(super) active: u8,
}

/// Whether anything is hit; and the lanes that have to be asked for one by one.
pub(super) struct Any<'a> {
    pub(super) flat: &'a SmallScene,
    pub(super) rays: &'a Rays,
    pub(super) active: u8,
}

/// Eight rays with their directions scaled by powers of two, as [`Query`] does it.
struct Prepared<E: Eight> {
    origin: [E; 3],
    direction: [E; 3],
    /// Powers of two.
    scale: E,
    t_max: E,
    /// Where x, and where else y, is the largest component of the direction.
    along: [E::Mask; 2],
    /// Rows of what a [`Beam`] holds.
    beams: [[f32; LANES]; size_of::<Beam>() / 4],
    /// The lanes whose rays the filters can do with.
    usable: u8,
}

impl<E: Eight> Prepared<E> {
    #[inline(always)]
    fn new(token: E::Token, flat: &SmallScene, rays: &Rays, active: u8) -> Self {
        let all = |v| E::splat(token, v);
        let (origin, given) = (E::rows(token, &rays.origin), E::rows(token, &rays.direction));
        let t = E::new(token, &rays.t_max);
        let magnitude = E::largest(given);
        // The power of two below, and its inverse, as in `Query`.
        let unit = magnitude.exponents();
        let scale = unit.inverse_powers();
        let sum = |[x, y, z]: [E; 3]| x.abs() + y.abs() + z.abs();
        let usable = sum(origin).below(all(MAX_ORIGIN))
            & sum(given).below(all(f64::INFINITY))
            & all(power_of_two(-900)).at_most(magnitude)
            & magnitude.below(all(power_of_two(901)))
            & all(0.0).below(t);
        let direction = axes(|k| given[k] * scale);
        let (centre, per_m) = (flat.frame.centre().to_array(), all(flat.frame.scale()));
        let place = axes(|k| (origin[k] - all(centre[k])) * per_m);
        let own = E::largest(place);
        let usable = E::bits(usable & own.at_most(all(MOST_REACH)));
        let t_max = t * unit;
        let ends = limits(token, t_max * per_m);
        let mut beams = [[0.0; LANES]; size_of::<Beam>() / 4];
        for k in 0..3 {
            beams[ORIGIN + k] = place[k].narrowed();
            beams[DIRECTION + k] = direction[k].narrowed();
        }
        beams[REACH] = (own + all(flat.reach)).narrowed().map(raised);
        // Those that are not wanted end before they begin.
        let wanted = active & usable;
        beams[LIMIT] = from_fn(|l| if wanted >> l & 1 == 1 { ends[0][l] } else { -1.0 });
        beams[CERTAIN_LIMIT] = ends[1];
        beams[LEAVES] = rays.leaves.map(id_of);
        beams[AIMS_AT] = rays.aims_at.map(id_of);
        // As `projection_axis` has it.
        let [x, y, z] = axes(|k| given[k].abs());
        let (along_y, reaches_z) = (x.max(z).below(y), x.below(z) & y.at_most(z));
        // Where both, y comes first; where neither, x.
        let one = all(1.0);
        let none = all(0.0).or_else(along_y | reaches_z, one);
        Self { origin, direction, scale, t_max, along: [one.at_most(none), along_y], beams, usable }
    }

    /// For the exact test.
    #[inline(always)]
    fn exact(&self, token: E::Token) -> Eights<E> {
        let [along_x, along_y] = self.along;
        let turned = |[x, y, z]: [E; 3]| -> [E; 3] {
            let choose = |a: E, b: E, c: E| a.or_else(along_x, b.or_else(along_y, c));
            [choose(y, z, x), choose(z, x, y), choose(x, y, z)]
        };
        let [dx, dy, dz] = turned(self.direction);
        let rz = E::splat(token, 1.0) / dz;
        let (x, y) = (E::bits(along_x), E::bits(along_y));
        let axis = from_fn(|l| if x >> l & 1 == 1 { 0 } else { 2 - u32::from(y >> l & 1) });
        Eights { axis, start: turned(self.origin), shear: [dx * rz, dy * rz, rz], t_max: self.t_max }
    }
}

/// The id of a surface as a number, if it is one of a small scene's.
#[inline(always)]
fn id_of(SurfaceId { instance, primitive }: SurfaceId) -> f32 {
    let id = if instance == 0 { primitive.0 } else { PrimitiveId::NONE.0 };
    if id < FLAT_LIMIT as u32 { id as i32 as f32 } else { NO_ID }
}

/// [`crate::small_scene::limits`] of eight.
#[inline(always)]
fn limits<E: Eight>(token: E::Token, t: E) -> [[f32; LANES]; 2] {
    let all = |v| E::splat(token, v);
    let t = t.or_else(t.below(all(FURTHEST)), all(FURTHEST));
    [(t * all(1.0 + SLACK)).narrowed().map(raised), (t * all(1.0 - SLACK)).narrowed().map(lowered)]
}

/// Calls a function with what is known of the eight rays and each share of primitives, and their ids.
#[inline(always)]
fn each<V: Wide>(
    flat: &SmallScene,
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
    let chords = SphereFilter::new(token, beams);
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
        let token = filters.into();
        let prepared = Prepared::<F::Eight>::new(filters.into(), flat, rays, active);
        let all = |v| F::Wide::splat(token, v);
        let beams = Beams::new(from_fn(|at| F::Wide::rays(token, &prepared.beams[at])), token);
        let nothing = all(f32::INFINITY);
        // Of the nearest that is certain: its ends and which it is; and the nearest that any other may be.
        let (mut far, mut near, mut id, mut other) = (all(f32::MAX), nothing, all(NO_ID), nothing);
        each(
            flat,
            token,
            &beams,
            |known, of| {
                let nearer = known.far.below_where(known.certain, far);
                other = other.min_where(known.met, near.or_else(nearer, known.near));
                far = known.far.or_else(nearer, far);
                near = known.near.or_else(nearer, near);
                id = of.or_else(nearer, id);
            },
            || false,
        );
        let ([far, far2], [near, near2], [id, id2], [other, other2]) =
            (far.shares(), near.shares(), id.shares(), other.shares());
        let two = F::Wide::SHARE == 2;
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let second: [bool; LANES] = from_fn(|l| two & (far2[l] < far[l]));
        let end: [f32; LANES] = from_fn(|l| least(far[l], far2[l]));
        let loser: [f32; LANES] =
            from_fn(|l| if two { if second[l] { near[l] } else { near2[l] } } else { f32::INFINITY });
        let next: [f32; LANES] = from_fn(|l| least(loser[l], least(other[l], other2[l])));
        let id: [f32; LANES] = from_fn(|l| if second[l] { id2[l] } else { id[l] });
        let ids: [u32; LANES] = from_fn(|l| id[l] as i32 as u32 % FLAT_LIMIT as u32);
        let open = (0..LANES).fold(0_u8, |mask, l| mask | u8::from(next[l] <= end[l]) << l);
        let found = (0..LANES).fold(0_u8, |mask, l| mask | u8::from(id[l] >= 0.0) << l);
        let wanted = active & prepared.usable;
        let mut undecided = open & wanted | active & !prepared.usable;
        let found = found & wanted & !undecided;
        let mut hits = Hits::NONE;
        if found == 0 {
            return (hits, undecided);
        }
        let Decided { hit, t, uv } = corners.triangles(filters.into(), &prepared.exact(filters.into()), &ids);
        let t = t * prepared.scale;
        let finite = t.below(F::Eight::splat(filters.into(), f64::INFINITY));
        hits.t = t.to_array();
        hits.uv = [uv[0].to_array(), uv[1].to_array()];
        hits.surface = ids.map(|id| PrimitiveId(id).into());
        hits.mask = F::Eight::bits(hit & finite) & found;
        for l in lanes_of(found & !hits.mask) {
            let ray = rays.get(l);
            let query = Query::new(&ray).expect("it was prepared");
            let id = PrimitiveId(ids[l]);
            match primitives[ids[l] as usize].intersect(&query, query.t_max, query.leaves == id) {
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

impl Job for Any<'_> {
    type Output = (u8, u8);

    #[inline(always)]
    fn run<F: Filters>(self, filters: F) -> (u8, u8) {
        let Self { flat, rays, active } = self;
        let prepared = Prepared::<F::Eight>::new(filters.into(), flat, rays, active);
        let token = filters.into();
        let beams = Beams::new(from_fn(|at| F::Wide::rays(token, &prepared.beams[at])), token);
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
