//! One ray against all primitives, as many at once as a vector holds.

use crate::query::Query;
use crate::ray::Found;
use crate::small_scene::*;
use crate::traverse::best::Best;
use crate::traverse::{Filters, Job, intersect_shape, occludes};
use crate::{Primitive, PrimitiveId};

/// The closest hit.
pub(super) struct Closest<'a> {
    pub(super) flat: &'a SmallScene,
    pub(super) primitives: &'a [Primitive],
    pub(super) query: &'a Query,
}

/// Whether anything is hit.
pub(super) struct Any<'a> {
    pub(super) flat: &'a SmallScene,
    pub(super) primitives: &'a [Primitive],
    pub(super) query: &'a Query,
}

/// Calls a function with what is known of each vector of primitives, and their ids, until it wants no more.
#[inline(always)]
fn each<V: Wide>(flat: &SmallScene, token: V::Token, beams: &Beams<V>, mut f: impl FnMut(Known<V>, V) -> bool) {
    let mut left = flat.flat_count;
    for block in &flat.flats {
        let mut at = 0;
        while at < BLOCK.min(left) {
            let shape = FlatsIn::new(block, |row| V::load(token, row, at));
            if f(flats(beams, &shape), shape.id) {
                return;
            }
            at += V::WIDTH;
        }
        left = left.saturating_sub(BLOCK);
    }
    let mut left = flat.sphere_count;
    if left == 0 {
        return;
    }
    let chords = SphereFilter::new(token, beams);
    for block in &flat.spheres {
        let mut at = 0;
        while at < BLOCK.min(left) {
            let shape = SpheresIn::new(block, |row| V::load(token, row, at));
            if f(spheres(beams, &chords, &shape), shape.id) {
                return;
            }
            at += V::WIDTH;
        }
        left = left.saturating_sub(BLOCK);
    }
}

/// Calls a function with the ids of a mask's lanes, until it wants no more.
#[inline(always)]
fn each_id<V: Wide>(ids: V, mut mask: u32, mut f: impl FnMut(PrimitiveId) -> bool) -> bool {
    if mask == 0 {
        return false;
    }
    let mut row = [0.0; BLOCK];
    ids.store(&mut row);
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize % BLOCK;
        mask &= mask - 1;
        if f(PrimitiveId(row[lane] as i32 as u32)) {
            return true;
        }
    }
    false
}

impl Job for Closest<'_> {
    type Output = Option<Found>;

    #[inline(always)]
    fn run<F: Filters>(self, filters: F) -> Option<Found> {
        let Self { flat, primitives, query } = self;
        let mut best = Best::new(query.t_max);
        let Some(beam) = flat.beam(query) else {
            return alone(primitives, query, best);
        };
        let token = filters.into();
        let all = |v| F::Wide::splat(token, v);
        let beams = Beams::new(beam.map(all), token);
        let nothing = all(f32::INFINITY);
        // Of the nearest that is certain in each lane: its ends and which it is; and the nearest that any other may be.
        let (mut far, mut near, mut id, mut other) = (all(f32::MAX), nothing, all(NO_ID), nothing);
        each(flat, token, &beams, |known, of| {
            let nearer = known.far.below_where(known.certain, far);
            other = other.min_where(known.met, near.or_else(nearer, known.near));
            far = known.far.or_else(nearer, far);
            near = known.near.or_else(nearer, near);
            id = of.or_else(nearer, id);
            false
        });
        let limit = all(far.least());
        let open = F::Wide::bits(other.at_most(limit));
        let candidates = F::Wide::bits(near.at_most(limit));
        if open == 0 && candidates & candidates.wrapping_sub(1) == 0 {
            each_id(id, candidates, |id| {
                let hit =
                    intersect_shape(filters, &primitives[id.0 as usize], query, best.limit(id), query.leaves == id);
                if let Some(hit) = hit {
                    best.set(hit, id);
                }
                true
            });
        } else {
            // `f32` does not tell. What it leaves open is decided in turn.
            each(flat, token, &beams, |known, ids| {
                let open = known.met & known.near.at_most(limit);
                each_id(ids, F::Wide::bits(open), |id| {
                    best.test(primitives, query, id);
                    false
                })
            });
        }
        for &id in &flat.others {
            best.test(primitives, query, id);
        }
        best.found()
    }
}

/// Every primitive alone.
#[cold]
#[inline(never)]
fn alone(primitives: &[Primitive], query: &Query, mut best: Best) -> Option<Found> {
    for i in 0..primitives.len() as u32 {
        best.test(primitives, query, PrimitiveId(i));
    }
    best.found()
}

impl Job for Any<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<F: Filters>(self, filters: F) -> bool {
        let Self { flat, primitives, query } = self;
        let Some(beam) = flat.beam(query) else {
            return (0..primitives.len() as u32).any(|i| occludes(primitives, query, PrimitiveId(i)));
        };
        let token = filters.into();
        let beams = Beams::new(beam.map(|v| F::Wide::splat(token, v)), token);
        let mut hit = false;
        each(flat, token, &beams, |known, ids| {
            let counts = !ids.equals(beams.aims_at);
            hit = F::Wide::bits(known.certain & counts) != 0
                || each_id(ids, F::Wide::bits(known.met & counts), |id| occludes(primitives, query, id));
            hit
        });
        hit || flat.others.iter().any(|&id| occludes(primitives, query, id))
    }
}
