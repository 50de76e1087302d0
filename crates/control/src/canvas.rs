//! A picture under way: its film, and how far each of its tiles is.
//!
//! Tiles know nothing of each other, so a picture can be divided among machines by tiles, cut off between any two pieces of
//! one, kept, and continued elsewhere: the sums are the same numbers in the same order.

use crate::sample_allocation::SampleAllocation;
use etalon_transport::render::TILE;
use etalon_transport::sampler::mix;
use etalon_transport::{Control, Counters, Film, Piece, PixelRect, Prepared, ThreadError, TileSums};
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, MutexGuard, PoisonError};

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
        state.film.put(tile.rect, sums);
        state.film.counters.merge(&tile.counters);
        state.tiles[number] = tile.clone();
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

    /// Renders each tile on to the number of samples a pixel that `samples` says for it. `on_piece` hears of each piece of a tile; once it says stop,
    /// pieces that are under way are finished and no other is begun.
    pub fn advance(
        &self,
        prepared: &Prepared,
        samples: &dyn Fn(PixelRect) -> u32,
        threads: Option<usize>,
        on_piece: &(dyn Fn(&Piece<'_>) -> Control + Sync),
    ) -> Result<(), ThreadError> {
        let missing = |tile: &Tile| (tile.rect, tile.samples..samples(tile.rect));
        let tiles: Vec<_> = self.state().tiles.iter().map(missing).collect();
        prepared.render_tiles(&tiles, threads, &|number| self.tile(number).1, &|piece| {
            self.state().add(piece);
            on_piece(piece)
        })
    }

    /// A thread that panicked has left whole pieces only.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn add(&mut self, piece: &Piece<'_>) {
        let tile = &mut self.tiles[piece.number];
        tile.samples = piece.samples.end;
        tile.counters.merge(piece.counters);
        self.film.add(piece);
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
