//! The samples of pixels in their order: handed out to paths, and taken back.
//!
//! Paths end in any order, but a pixel's sums are in the order of its samples: what is finished early waits.

use crate::integrator::film_entry::SampleId;
use crate::integrator::tracer::PixelSamples;

/// Most samples that may be under way or wait for others: many times the paths in a set, so that one long path does not hold up
/// the rest.
const WINDOW: u64 = 1024;

/// Goes through the samples of pixels, one pixel after the other.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    all_samples: &'a [PixelSamples],
    /// How many pixels take turns that begin there, sample by sample; empty if each is alone.
    block_pixels: &'a [usize],
    /// Those whose turn it is: the first, and the one after the last.
    group: [usize; 2],
    next: SampleId,
    left: u64,
}

impl<'a> Cursor<'a> {
    /// Of pixels of which `block_pixels` tells who take turns: they have the same samples.
    pub(super) fn new(all_samples: &'a [PixelSamples], block_pixels: &'a [usize]) -> Self {
        let left = all_samples.iter().map(|pixel_samples| u64::from(pixel_samples.count())).sum();
        let next = SampleId { pixel_samples: 0, x: 0, y: 0, sample: 0 };
        let mut cursor = Self { all_samples, block_pixels, group: [0; 2], next, left };
        cursor.go_to(0);
        cursor
    }

    /// How many of them a window should hold: a power of two.
    pub(super) fn window(&self) -> usize {
        self.left.clamp(1, WINDOW).next_power_of_two() as usize
    }

    /// The first sample of this pixel, or of the next that has one.
    #[inline(always)]
    fn go_to(&mut self, first: usize) {
        for (pixel_samples, PixelSamples { x, y, samples }) in self.all_samples.iter().enumerate().skip(first) {
            if !samples.is_empty() {
                self.next = SampleId { pixel_samples, x: *x, y: *y, sample: samples.start };
                self.group =
                    [pixel_samples, pixel_samples + self.block_pixels.get(pixel_samples).copied().unwrap_or(1)];
                return;
            }
        }
    }
}

impl Iterator for Cursor<'_> {
    type Item = SampleId;

    #[inline(always)]
    fn next(&mut self) -> Option<SampleId> {
        self.left = self.left.checked_sub(1)?;
        let place = self.next;
        let [first, end] = self.group;
        if place.pixel_samples + 1 < end {
            self.next.pixel_samples += 1;
        } else {
            self.next.pixel_samples = first;
            self.next.sample += 1;
            if self.next.sample == self.all_samples[first].samples.end {
                self.go_to(end);
                return Some(place);
            }
        }
        if end - first > 1 {
            (self.next.x, self.next.y) =
                (self.all_samples[self.next.pixel_samples].x, self.all_samples[self.next.pixel_samples].y);
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
    /// A window on this many samples: a power of two, so that numbers may run over.
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
