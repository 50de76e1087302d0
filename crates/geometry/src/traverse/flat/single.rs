//! One ray against all primitives, as many at once as a vector holds.

use super::filter::*;
use super::{BLOCK, FLAT_LIMIT, Flat, Wide};
use crate::geometry::{Best, Found};
use crate::query::Query;
use crate::traverse::{Filters, Job, occludes};
use crate::{Primitive, PrimitiveId};

/// The closest hit.
pub(super) struct Closest<'a> {
    pub(super) flat: &'a Flat,
    pub(super) primitives: &'a [Primitive],
    pub(super) query: &'a Query,
}

/// Whether anything is hit.
pub(super) struct Any<'a> {
    pub(super) flat: &'a Flat,
    pub(super) primitives: &'a [Primitive],
    pub(super) query: &'a Query,
}

/// One ray in all lanes.
#[inline(always)]
fn beams<V: Wide>(token: V::Token, beam: &Beam) -> Beams<V> {
    Beams::new(token, |at| V::splat(token, beam[at]))
}

/// Calls a function with what is known of each vector of primitives, their ids and the lanes that they are.
#[inline(always)]
fn each<'a, V: Wide>(
    flat: &'a Flat,
    token: V::Token,
    beams: &Beams<V>,
    mut f: impl FnMut(Known<V>, &'a [f32; BLOCK], usize) -> bool,
) {
    let mut left = flat.flat_count;
    for block in &flat.flats {
        let mut at = 0;
        while at < BLOCK.min(left) {
            if f(flats(beams, &FlatsIn::new(block, |row| V::load(token, row, at))), &block.id, at) {
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
    let chords = Chords::new(token, beams);
    for block in &flat.spheres {
        let mut at = 0;
        while at < BLOCK.min(left) {
            if f(spheres(beams, &chords, &SpheresIn::new(block, |row| V::load(token, row, at))), &block.id, at) {
                return;
            }
            at += V::WIDTH;
        }
        left = left.saturating_sub(BLOCK);
    }
}

/// Vectors that a flat geometry fills at most: one for each eight, and one more for each kind.
const MOST: usize = FLAT_LIMIT / 8 + 2;

impl Job for Closest<'_> {
    type Output = Option<Found>;

    #[inline(always)]
    fn run<F: Filters>(self, filters: F) -> Option<Found> {
        let Self { flat, primitives, query } = self;
        let mut best = Best::new(query.t_max);
        let Some(beam) = flat.beam(query) else {
            for i in 0..primitives.len() as u32 {
                best.test(primitives, query, PrimitiveId(i));
            }
            return best.found();
        };
        let token = filters.into();
        let beams = beams::<F::Wide>(token, &beam);
        let nothing = F::Wide::splat(token, f32::INFINITY);
        let mut limit = nothing;
        let mut near = [[0.0; BLOCK]; MOST];
        let mut met = [0_u32; MOST];
        let mut ids: [&[f32]; MOST] = [&[]; MOST];
        let mut count = 0;
        each(flat, token, &beams, |known, id, at| {
            limit = known.far.or_else(known.certain, nothing).min(limit);
            known.near.store(&mut near[count]);
            met[count] = F::Wide::bits(known.met);
            ids[count] = &id[at..];
            count += 1;
            false
        });
        let mut least = [0.0; BLOCK];
        limit.store(&mut least);
        let limit = least[..F::Wide::WIDTH].iter().fold(f32::INFINITY, |a, &b| if b < a { b } else { a });
        for group in 0..count {
            let mut mask = met[group];
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize % BLOCK;
                mask &= mask - 1;
                if near[group][lane] <= limit {
                    best.test(primitives, query, PrimitiveId(ids[group][lane] as u32));
                }
            }
        }
        for &id in &flat.others {
            best.test(primitives, query, id);
        }
        best.found()
    }
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
        let beams = beams::<F::Wide>(token, &beam);
        let mut hit = false;
        each(flat, token, &beams, |known, id, at| {
            let aims_at = F::Wide::load(token, id, at).equals(beams.aims_at);
            if F::Wide::bits(known.certain & !aims_at) != 0 {
                hit = true;
                return true;
            }
            let mut mask = F::Wide::bits(known.met & !aims_at);
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if occludes(primitives, query, PrimitiveId(id[(at + lane) % BLOCK] as u32)) {
                    hit = true;
                    return true;
                }
            }
            false
        });
        hit || flat.others.iter().any(|&id| occludes(primitives, query, id))
    }
}
