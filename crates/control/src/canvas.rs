//! A picture under way: its film, and how far each of its tiles is.
//!
//! Tiles know nothing of each other, so a picture can be divided among machines by tiles, cut off between any two pieces of
//! one, kept, and continued elsewhere: the sums are the same numbers in the same order.

use crate::sample_allocation::SampleAllocation;
use etalon_transport::render::TILE;
use etalon_transport::sampler::mix;
use etalon_transport::{Control, Counters, Film, PixelRect, Prepared, Splats, ThreadError, TileSums};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Camera paths after which a tile is put down, so that a stop need not wait for all of a tile's samples.
const PATHS_OF_PIECE: u64 = 1 << 15;

/// A share of a picture's tiles: number `index` of `of`, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which, below `of`.
    pub index: u32,
    /// Of how many.
    pub of: u32,
}

impl Shard {
    /// The only one.
    pub const WHOLE: Self = Self { index: 0, of: 1 };
}

/// How far a tile is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tile {
    /// Its pixels.
    pub rect: PixelRect,
    /// Samples that each of its pixels has taken: the numbers 0 up to this.
    pub samples: u32,
    /// What was counted on the way.
    pub counters: Counters,
}

/// Hears what a piece of a tile took and what the tile holds now, and says whether to go on.
type OnPiece<'a> = dyn Fn(&Counters, PixelRect, &TileSums) -> Control + Sync + 'a;

/// A picture under way. It may be read while others work on it.
#[derive(Debug)]
pub struct Canvas {
    rect: PixelRect,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    film: Film,
    tiles: Vec<Tile>,
}

/// The tiles of a share of `rect`: each tile belongs to one share, shares differ by one tile at most, and the tiles of each
/// are strewn over the whole picture, so that all take about as long.
pub fn tiles_of(rect: PixelRect, shard: Shard) -> Vec<PixelRect> {
    let tiles = rect.tiles(TILE);
    let mut strewn: Vec<usize> = (0..tiles.len()).collect();
    strewn.sort_by_key(|&tile| mix(tile as u64));
    let mut own: Vec<usize> = strewn.into_iter().skip(shard.index as usize).step_by(shard.of as usize).collect();
    own.sort_unstable();
    own.into_iter().map(|tile| tiles[tile]).collect()
}

impl Canvas {
    /// The same of a film that has nothing yet, for tiles that were rendered elsewhere.
    pub fn of_share(film: Film, rect: PixelRect, shard: Shard, allocation: Option<&SampleAllocation>) -> Self {
        let tiles = tiles_of(rect, shard)
            .into_iter()
            .flat_map(|tile| allocation.map_or_else(|| vec![tile], |allocation| allocation.parts(tile)))
            .map(|rect| Tile { rect, samples: 0, counters: Counters::default() })
            .collect();
        Self { rect, state: Mutex::new(State { film, tiles }) }
    }

    /// Nothing of a share of `rect` yet; where the samples are spread by `allocation`, in tiles whose pixels take the same.
    pub fn new(prepared: &Prepared, rect: PixelRect, shard: Shard, allocation: Option<&SampleAllocation>) -> Self {
        Self::of_share(prepared.film(), rect, shard, allocation)
    }

    /// The pixels that the whole picture has.
    pub fn rect(&self) -> PixelRect {
        self.rect
    }

    /// Number of tiles.
    pub fn tiles(&self) -> usize {
        self.state().tiles.len()
    }

    /// Pixels of all tiles.
    pub fn area(&self) -> u64 {
        self.state().tiles.iter().map(|tile| tile.rect.area()).sum()
    }

    /// Camera paths of all tiles where each pixel takes as many samples as `samples` says for its tile.
    pub fn paths(&self, samples: &dyn Fn(PixelRect) -> u32) -> u64 {
        self.state().tiles.iter().map(|tile| tile.rect.area() * u64::from(samples(tile.rect))).sum()
    }

    /// How far tile number `number` is, and its sums, at one moment.
    pub fn tile(&self, number: usize) -> (Tile, TileSums) {
        let state = self.state();
        let tile = state.tiles[number].clone();
        let sums = state.film.tile(tile.rect);
        (tile, sums)
    }

    /// Takes up a tile where it was put down: `false` if this canvas has no such tile, has begun it already, or keeps other
    /// sums.
    pub fn take_up(&self, tile: &Tile, sums: &TileSums) -> bool {
        let mut state = self.state();
        let Some(number) = state.tiles.iter().position(|own| own.rect == tile.rect && own.samples == 0) else {
            return false;
        };
        if !state.film.fits(tile.rect, sums) {
            return false;
        }
        state.put(number, tile, sums);
        state.film.counters.merge(&tile.counters);
        true
    }

    /// Whether every tile has as many samples as `samples` says for it.
    pub fn has_reached(&self, samples: &dyn Fn(PixelRect) -> u32) -> bool {
        self.state().tiles.iter().all(|tile| tile.samples >= samples(tile.rect))
    }

    /// Fewest and most samples that a pixel has.
    pub fn samples(&self) -> [u32; 2] {
        let state = self.state();
        let samples = || state.tiles.iter().map(|tile| tile.samples);
        [samples().min().unwrap_or(0), samples().max().unwrap_or(0)]
    }

    /// Lets `look` see the film, while nobody else can.
    pub fn with_film<T>(&self, look: impl FnOnce(&Film) -> T) -> T {
        look(&self.state().film)
    }

    /// The film, with what was counted on all tiles.
    pub fn into_film(self) -> Film {
        self.state.into_inner().unwrap_or_else(PoisonError::into_inner).film
    }

    /// Renders each tile on to the number of samples a pixel that `samples` says for it, by pieces. `on_piece` hears what a piece of a tile took and what the tile
    /// holds now; once it says stop, pieces that are under way are finished and no other is begun.
    pub fn advance(
        &self,
        prepared: &Prepared,
        samples: &(dyn Fn(PixelRect) -> u32 + Sync),
        threads: Option<usize>,
        on_piece: &OnPiece<'_>,
    ) -> Result<(), ThreadError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
        let stopped = AtomicBool::new(false);
        for round in prepared.light_rounds(&self.missing(samples)) {
            if stopped.load(Ordering::Relaxed) {
                break;
            }
            let splats = pool.install(|| prepared.splats(round.clone(), self.rect));
            let target = |rect: PixelRect| samples(rect).min(round.end);
            self.advance_by(prepared, &target, &splats, &pool, (&stopped, on_piece));
        }
        Ok(())
    }

    /// The samples that tiles lack of what `samples` says for them.
    fn missing(&self, samples: &(dyn Fn(PixelRect) -> u32 + Sync)) -> Vec<Range<u32>> {
        self.state().tiles.iter().map(|tile| tile.samples..samples(tile.rect)).collect()
    }

    /// [`Canvas::advance`] by samples whose light paths are traced.
    fn advance_by(
        &self,
        prepared: &Prepared,
        samples: &(dyn Fn(PixelRect) -> u32 + Sync),
        splats: &Splats,
        pool: &rayon::ThreadPool,
        (stopped, on_piece): (&AtomicBool, &OnPiece<'_>),
    ) {
        pool.install(|| {
            (0..self.tiles()).into_par_iter().for_each(|number| {
                if stopped.load(Ordering::Relaxed) {
                    return;
                }
                let (mut tile, mut sums) = self.tile(number);
                let samples = samples(tile.rect);
                let piece = (PATHS_OF_PIECE / tile.rect.area()).max(1) as u32;
                while tile.samples < samples && !stopped.load(Ordering::Relaxed) {
                    let until = tile.samples.saturating_add(piece).min(samples);
                    let counters = prepared.render_tile(tile.rect, tile.samples..until, splats, &mut sums);
                    tile.samples = until;
                    tile.counters.merge(&counters);
                    {
                        let mut state = self.state();
                        state.put(number, &tile, &sums);
                        state.film.counters.merge(&counters);
                    }
                    if on_piece(&counters, tile.rect, &sums) == Control::Stop {
                        stopped.store(true, Ordering::Relaxed);
                    }
                }
            });
        });
    }

    /// A thread that panicked has left whole tiles only.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn put(&mut self, number: usize, tile: &Tile, sums: &TileSums) {
        self.film.put(tile.rect, sums);
        self.tiles[number] = tile.clone();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_hold_every_tile_once_and_are_alike_in_size() {
        let rect = PixelRect { x0: 5, y0: 0, x1: 200, y1: 90 };
        for of in [1, 3, 16] {
            let allocation: Vec<_> = (0..of).map(|index| tiles_of(rect, Shard { index, of })).collect();
            let (least, most) = (allocation.iter().map(Vec::len).min(), allocation.iter().map(Vec::len).max());
            assert!(most.unwrap() - least.unwrap() <= 1);
            let mut all: Vec<_> = allocation.concat();
            all.sort_unstable_by_key(|tile| (tile.y0, tile.x0));
            assert_eq!(all, rect.tiles(TILE));
        }
        // Strewn: no share of three lies in one half of the picture.
        for index in 0..3 {
            let own = tiles_of(rect, Shard { index, of: 3 });
            assert!(own.iter().any(|tile| tile.x1 < 100) && own.iter().any(|tile| tile.x0 > 100));
        }
    }
}
