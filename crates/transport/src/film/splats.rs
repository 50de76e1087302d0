//! What light paths bring to pixels, sorted by pixel and sample.

use super::PixelRect;

/// What the light paths of some samples bring to the pixels of a rectangle.
#[derive(Clone, Debug)]
pub struct Splats {
    pub(crate) rect: PixelRect,
    /// Where the entries of each pixel begin, and the end of the last; empty where no light paths are traced.
    pub(crate) starts: Vec<usize>,
    /// By pixel, then by the place of the sample among those asked for: number of the sample, CIE XYZ.
    pub(crate) entries: Vec<(u32, [f64; 3])>,
    /// Rays of all kinds that the light paths took, and how many paths there were.
    pub rays: u64,
    /// See `rays`.
    pub paths: u64,
}

impl Splats {
    /// Where no light paths are traced.
    pub const NONE: Self = Self {
        rect: PixelRect { x0: 0, y0: 0, x1: 0, y1: 0 },
        starts: Vec::new(),
        entries: Vec::new(),
        rays: 0,
        paths: 0,
    };

    /// What a sample of a pixel receives, CIE XYZ.
    #[inline]
    pub(crate) fn of(&self, x: u32, y: u32, sample: u32) -> Option<[f64; 3]> {
        let rect = &self.rect;
        if self.entries.is_empty() || x < rect.x0 || x >= rect.x1 || y < rect.y0 || y >= rect.y1 {
            return None;
        }
        let pixel = ((y - rect.y0) * (rect.x1 - rect.x0) + (x - rect.x0)) as usize;
        let of_pixel = &self.entries[self.starts[pixel]..self.starts[pixel + 1]];
        let place = of_pixel.binary_search_by_key(&sample, |(sample, _)| *sample).ok()?;
        Some(of_pixel[place].1)
    }

    /// What each pixel receives, row by row: the samples in which it receives anything, and CIE XYZ.
    pub(crate) fn by_pixel(&self) -> impl Iterator<Item = &[(u32, [f64; 3])]> {
        self.starts.windows(2).map(|bounds| &self.entries[bounds[0]..bounds[1]])
    }

    /// The mean over `samples` samples of what each pixel receives, and its variance from one sample to another, row by row.
    pub(crate) fn moments(&self, samples: u32, of: impl Fn([f64; 3]) -> f64) -> impl Iterator<Item = (f64, f64)> {
        let samples = f64::from(samples);
        self.by_pixel().map(move |of_pixel| {
            // Samples that bring nothing are among them.
            let sum: f64 = of_pixel.iter().map(|(_, xyz)| of(*xyz)).sum();
            let squares: f64 = of_pixel.iter().map(|(_, xyz)| of(*xyz) * of(*xyz)).sum();
            (sum / samples, ((squares - sum * sum / samples) / (samples - 1.0)).max(0.0))
        })
    }
}
