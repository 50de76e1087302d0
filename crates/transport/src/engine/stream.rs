//! The samples of a tile in their order: handed out to paths, and taken back.
//!
//! Paths end in any order, but a pixel's sums are in the order of its samples: what is finished early waits.

use crate::film::PixelRect;
use std::ops::Range;

/// Most samples that may be under way or wait for others: many times the paths in a set, so that one long path does not hold up
/// the rest.
const WINDOW: u64 = 1024;

/// One sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Number of the pixel in the tile.
    pub pixel: usize,
    pub x: u32,
    pub y: u32,
    pub sample: u32,
}

/// Goes through the samples of a tile, pixel by pixel.
#[derive(Clone, Debug)]
pub(super) struct Cursor {
    tile: PixelRect,
    samples: Range<u32>,
    next: Place,
    left: u64,
}

impl Cursor {
    pub(super) fn new(tile: PixelRect, samples: Range<u32>) -> Self {
        let left = tile.area() * u64::from(samples.end.saturating_sub(samples.start));
        let next = Place { pixel: 0, x: tile.x0, y: tile.y0, sample: samples.start };
        Self { tile, samples, next, left }
    }

    /// How many of them a window should hold: a power of two.
    pub(super) fn window(&self) -> usize {
        self.left.clamp(1, WINDOW).next_power_of_two() as usize
    }
}

impl Iterator for Cursor {
    type Item = Place;

    #[inline(always)]
    fn next(&mut self) -> Option<Place> {
        self.left = self.left.checked_sub(1)?;
        let place = self.next;
        self.next.sample += 1;
        if self.next.sample == self.samples.end {
            self.next = Place { pixel: place.pixel + 1, x: place.x + 1, y: place.y, sample: self.samples.start };
            if self.next.x == self.tile.x1 {
                (self.next.x, self.next.y) = (self.tile.x0, place.y + 1);
            }
        }
        Some(place)
    }
}

/// What has been finished and waits for its turn.
#[derive(Debug)]
pub(super) struct Window<T> {
    waiting: Vec<Option<T>>,
    /// Number of the sample whose turn it is.
    turn: u32,
}

impl<T: Copy> Window<T> {
    /// A window on so many samples: a power of two, so that numbers may run over.
    pub(super) fn new(size: usize) -> Self {
        Self { waiting: vec![None; size], turn: 0 }
    }

    /// The place of a sample among those of the window.
    #[inline(always)]
    pub(super) fn place(&self, number: u32) -> usize {
        number as usize % self.waiting.len()
    }

    /// Whether a sample of this number may be begun.
    #[inline(always)]
    pub(super) fn admits(&self, number: u32) -> bool {
        (number.wrapping_sub(self.turn) as usize) < self.waiting.len()
    }

    /// Takes what sample number `number`, an admitted one, came to.
    #[inline(always)]
    pub(super) fn put(&mut self, number: u32, result: T) {
        let place = self.place(number);
        self.waiting[place] = Some(result);
    }

    /// The number of the sample whose turn it is and what it came to, if it is finished.
    #[inline(always)]
    pub(super) fn take(&mut self) -> Option<(u32, T)> {
        let number = self.turn;
        let place = self.place(number);
        let result = self.waiting[place].take()?;
        self.turn = number.wrapping_add(1);
        Some((number, result))
    }
}
