//! How the samples of a picture are spread over its regions, where not every pixel takes the same number.
//!
//! Shares must be settled before the first sample that is kept, by nothing that those samples say.

use etalon_transport::PixelRect;
use etalon_transport::render::TILE;
use std::ops::Range;

/// Side of a region, pixels; it divides a tile's.
pub const REGION_SIDE: u32 = 8;

/// A weight for each region of a picture: its pixels take samples in proportion to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SampleAllocation {
    rect: PixelRect,
    columns: u32,
    /// Region by region, row by row; none is zero.
    weights: Vec<u32>,
    /// Sum of the weights over pixels.
    total: u64,
}

impl SampleAllocation {
    /// The regions of the pixels `rect`, row by row.
    pub fn regions(rect: PixelRect) -> Vec<PixelRect> {
        rect.tiles(REGION_SIDE)
    }

    /// A weight for each of [`SampleAllocation::regions`].
    ///
    /// # Panics
    ///
    /// If there are not as many weights as regions, or one is zero: its pixels would stay black, and the picture be biased.
    pub fn new(rect: PixelRect, weights: Vec<u32>) -> Self {
        let regions = Self::regions(rect);
        assert_eq!(weights.len(), regions.len(), "one weight for each region");
        assert!(weights.iter().all(|&weight| weight > 0), "every region takes part");
        let total = regions.iter().zip(&weights).map(|(region, &weight)| region.area() * u64::from(weight)).sum();
        Self { rect, columns: (rect.x1 - rect.x0).div_ceil(REGION_SIDE), weights, total }
    }

    /// The pixels that these shares are for.
    pub fn rect(&self) -> PixelRect {
        self.rect
    }

    /// The weights, region by region.
    pub fn weights(&self) -> &[u32] {
        &self.weights
    }

    /// Samples of the pixel in column `x` and row `y` where the mean of all pixels is to be `mean`: whole rounds of the
    /// replicates, so that all weigh alike. It grows with `mean`, so that a picture can be rendered in stages.
    pub fn samples(&self, x: u32, y: u32, mean: u32, replicates: u32) -> u32 {
        let region = (y - self.rect.y0) / REGION_SIDE * self.columns + (x - self.rect.x0) / REGION_SIDE;
        self.of_weight(self.weights[region as usize], mean, replicates)
    }

    fn of_weight(&self, weight: u32, mean: u32, replicates: u32) -> u32 {
        let wanted = u128::from(mean) * u128::from(weight) * u128::from(self.rect.area());
        let rounds = wanted.div_ceil(u128::from(self.total) * u128::from(replicates));
        u32::try_from(rounds * u128::from(replicates)).unwrap_or(u32::MAX)
    }

    /// Fewest and most samples of a pixel for a mean of `mean`.
    pub fn least_and_most(&self, mean: u32, replicates: u32) -> [u32; 2] {
        let of = |weight: Option<&u32>| weight.map_or(0, |&weight| self.of_weight(weight, mean, replicates));
        [of(self.weights.iter().min()), of(self.weights.iter().max())]
    }

    /// The largest mean with which no pixel takes more than `most` samples.
    pub fn largest_mean(&self, most: u32, replicates: u32) -> u32 {
        let most = most / replicates * replicates;
        let heaviest = self.weights.iter().copied().max().unwrap_or(1);
        let mean =
            u128::from(most) * u128::from(self.total) / (u128::from(heaviest) * u128::from(self.rect.area().max(1)));
        u32::try_from(mean).unwrap_or(u32::MAX).min(most)
    }

    /// Samples of all pixels together for a mean of `mean`; a little more than the mean says, for rounds are whole.
    pub fn paths(&self, mean: u32, replicates: u32) -> u64 {
        let of =
            |(region, &weight): (PixelRect, &u32)| region.area() * u64::from(self.of_weight(weight, mean, replicates));
        Self::regions(self.rect).into_iter().zip(&self.weights).map(of).sum()
    }

    /// The tiles of `rect` whose pixels take the same samples, each with those between two means of all pixels.
    pub fn tiles(&self, rect: PixelRect, means: Range<u32>, replicates: u32) -> Vec<(PixelRect, Range<u32>)> {
        let parts = rect.tiles(TILE).into_iter().flat_map(|tile| self.parts(tile));
        let up_to = |tile: &PixelRect, mean| self.samples(tile.x0, tile.y0, mean, replicates);
        parts.map(|tile| (tile, up_to(&tile, means.start)..up_to(&tile, means.end))).collect()
    }

    /// Cuts a tile into parts whose pixels take the same number of samples at every stage: the tile itself, if it can be.
    pub(crate) fn parts(&self, tile: PixelRect) -> Vec<PixelRect> {
        let next = |at: u32, origin: u32, end: u32| (origin + ((at - origin) / REGION_SIDE + 1) * REGION_SIDE).min(end);
        let mut parts = Vec::new();
        let mut y0 = tile.y0;
        while y0 < tile.y1 {
            let y1 = next(y0, self.rect.y0, tile.y1);
            let mut x0 = tile.x0;
            while x0 < tile.x1 {
                let x1 = next(x0, self.rect.x0, tile.x1);
                parts.push(PixelRect { x0, y0, x1, y1 });
                x0 = x1;
            }
            y0 = y1;
        }
        let weight = |part: &PixelRect| {
            let (column, row) = ((part.x0 - self.rect.x0) / REGION_SIDE, (part.y0 - self.rect.y0) / REGION_SIDE);
            self.weights[(row * self.columns + column) as usize]
        };
        let alike = parts.windows(2).all(|pair| weight(&pair[0]) == weight(&pair[1]));
        if alike { vec![tile] } else { parts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECT: PixelRect = PixelRect { x0: 3, y0: 5, x1: 30, y1: 25 };

    fn allocation() -> SampleAllocation {
        let regions = SampleAllocation::regions(RECT);
        SampleAllocation::new(RECT, (0..regions.len() as u32).map(|i| 16 + i * i % 77).collect())
    }

    #[test]
    fn the_mean_of_all_pixels_is_the_one_asked_for_but_for_whole_rounds() {
        let allocation = allocation();
        for (mean, replicates) in [(1, 1), (7, 4), (256, 4), (1000, 8)] {
            let counts: Vec<u64> =
                RECT.pixels().map(|(x, y)| u64::from(allocation.samples(x, y, mean, replicates))).collect();
            let total: u64 = counts.iter().sum();
            assert_eq!(total, allocation.paths(mean, replicates));
            assert!(counts.iter().all(|count| *count > 0 && count % u64::from(replicates) == 0));
            let excess = total as f64 / RECT.area() as f64 - f64::from(mean);
            assert!((0.0..f64::from(replicates)).contains(&excess), "{excess}");
            let [least, most] = allocation.least_and_most(mean, replicates).map(u64::from);
            assert_eq!((counts.iter().min(), counts.iter().max()), (Some(&least), Some(&most)));
        }
        let largest = allocation.largest_mean(i32::MAX as u32, 4);
        let [_, most] = allocation.least_and_most(largest, 4);
        assert!(most <= i32::MAX as u32 && most > i32::MAX as u32 - 64, "{most}");
    }

    #[test]
    fn the_parts_of_tiles_cover_each_pixel_once_and_do_not_cross_regions() {
        let allocation = allocation();
        for size in [5, 8, 16] {
            let parts: Vec<PixelRect> = RECT.tiles(size).into_iter().flat_map(|tile| allocation.parts(tile)).collect();
            let mut pixels: Vec<_> = parts.iter().flat_map(PixelRect::pixels).collect();
            pixels.sort_unstable();
            let mut all: Vec<_> = RECT.pixels().collect();
            all.sort_unstable();
            assert_eq!(pixels, all);
            for part in parts {
                let count = allocation.samples(part.x0, part.y0, 64, 4);
                assert!(part.pixels().all(|(x, y)| allocation.samples(x, y, 64, 4) == count));
            }
        }
        let even = SampleAllocation::new(RECT, vec![9; SampleAllocation::regions(RECT).len()]);
        assert_eq!(even.parts(RECT), [RECT]);
        assert!(RECT.pixels().all(|(x, y)| even.samples(x, y, 60, 4) == 60));
    }
}
