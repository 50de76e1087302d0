//! The driver of all renders: tiles over all cores, piece by piece.

use crate::film::{Counters, Film, PixelRect, TileSums};
use crate::render::{Extent, TILE};
use crate::scene::prepare::Prepared;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Camera paths after which a tile is put down, so that a stop need not wait for all of a tile's samples.
const PATHS_OF_PIECE: u64 = 1 << 15;

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// Begin no further piece.
    Stop,
}

/// A piece of a tile: some of its samples, rendered.
#[derive(Debug)]
pub struct Piece<'a> {
    /// Number of the tile in the list that the driver was given.
    pub number: usize,
    /// The pixels of the tile.
    pub rect: PixelRect,
    /// The samples.
    pub samples: Range<u32>,
    /// What they took.
    pub counters: &'a Counters,
    /// What the tile holds now.
    pub sums: &'a TileSums,
}

/// No thread pool could be had.
#[derive(Debug, thiserror::Error)]
#[error("cannot start the threads of the render: {0}")]
pub struct ThreadError(#[from] rayon::ThreadPoolBuildError);

impl Prepared {
    /// Renders samples of each tile on `threads` threads; `None` is one for each core. `sums_of` says what a tile holds before, by its number, and
    /// `on_piece` keeps what it holds after each piece. Once this says stop, pieces that are under way are finished and no other is begun.
    /// If the caller is a thread of a pool of rayon's, that pool does the work instead.
    ///
    /// Samples given in ascending ranges leave the same bytes as one range, and tiles the same in any order.
    pub fn render_tiles(
        &self,
        tiles: &[(PixelRect, Range<u32>)],
        threads: Option<usize>,
        sums_of: &(dyn Fn(usize) -> TileSums + Sync),
        on_piece: &(dyn Fn(&Piece<'_>) -> Control + Sync),
    ) -> Result<(), ThreadError> {
        let Some(all) = tiles.iter().map(|(rect, _)| *rect).reduce(PixelRect::union) else { return Ok(()) };
        let stopped = AtomicBool::new(false);
        let goes_on = || !stopped.load(Ordering::Relaxed);
        let of_tiles: Vec<_> = tiles.iter().map(|(_, samples)| samples.clone()).collect();
        let render = || {
            for round in self.light_rounds(&of_tiles) {
                if !goes_on() {
                    break;
                }
                let splats = self.splats(round.clone(), all);
                let advance = |(number, (rect, samples)): (usize, &(PixelRect, Range<u32>))| {
                    let own = samples.start.max(round.start)..samples.end.min(round.end);
                    if own.is_empty() || !goes_on() {
                        return;
                    }
                    let mut sums = sums_of(number);
                    for piece in pieces(*rect, own).take_while(|_| goes_on()) {
                        let counters = &self.render_tile(*rect, piece.clone(), &splats, &mut sums);
                        let piece = Piece { number, rect: *rect, samples: piece, counters, sums: &sums };
                        if on_piece(&piece) == Control::Stop {
                            stopped.store(true, Ordering::Relaxed);
                        }
                    }
                };
                tiles.par_iter().enumerate().for_each(advance);
            }
        };
        match rayon::current_thread_index() {
            Some(_) => render(),
            None => rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?.install(render),
        }
        Ok(())
    }

    /// Renders `extent` onto a new film. `control` hears what each finished piece took.
    pub fn render(
        &self,
        extent: &Extent,
        control: &(dyn Fn(&Counters) -> Control + Sync),
    ) -> Result<Film, ThreadError> {
        let mut film = self.film();
        self.render_onto(&mut film, extent, control)?;
        Ok(film)
    }

    /// Adds `extent` to a film of the scene's size: [`Prepared::render_tiles`].
    pub fn render_onto(
        &self,
        film: &mut Film,
        extent: &Extent,
        control: &(dyn Fn(&Counters) -> Control + Sync),
    ) -> Result<(), ThreadError> {
        let tiles = extent.rect.tiles(TILE).into_iter().map(|tile| (tile, extent.samples.clone()));
        self.render_tiles_onto(film, &tiles.collect::<Vec<_>>(), extent.threads, control)
    }

    /// As [`Prepared::render_onto`], with samples for each tile.
    pub fn render_tiles_onto(
        &self,
        film: &mut Film,
        tiles: &[(PixelRect, Range<u32>)],
        threads: Option<usize>,
        control: &(dyn Fn(&Counters) -> Control + Sync),
    ) -> Result<(), ThreadError> {
        let film = Mutex::new(film);
        // A thread that panicked has left whole pieces only.
        let film = || film.lock().unwrap_or_else(PoisonError::into_inner);
        self.render_tiles(tiles, threads, &|number| film().tile(tiles[number].0), &|piece| {
            film().add(piece);
            control(piece.counters)
        })
    }
}

/// Samples of a tile in pieces.
fn pieces(rect: PixelRect, samples: Range<u32>) -> impl Iterator<Item = Range<u32>> {
    let most = (PATHS_OF_PIECE / rect.area()).max(1) as u32;
    samples.clone().step_by(most as usize).map(move |start| start..start.saturating_add(most).min(samples.end))
}

impl Film {
    /// Keeps what a tile holds after a piece, and counts what the piece took.
    pub fn add(&mut self, piece: &Piece<'_>) {
        self.put(piece.rect, piece.sums);
        self.counters.merge(piece.counters);
    }
}
