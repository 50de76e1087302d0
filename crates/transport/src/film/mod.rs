//! Where samples are summed: in `f64`, in the order of their numbers, nothing clamped.

pub mod accuracy;
mod bands;
mod counters;
pub mod filter;
mod splats;
mod stokes;
mod tile;

pub use bands::{Band, BandSum};
pub use counters::{Counters, NONFINITE_LOCATED, NonFinite};
pub use splats::Splats;
pub use stokes::StokesSum;
pub(crate) use tile::Sums;
pub use tile::TileSums;

use etalon_optics::colour;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A rectangle of pixels, `x0 ≤ x < x1` and `y0 ≤ y < y1`, y counted from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelRect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl PixelRect {
    /// Number of pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.x1 - self.x0) * u64::from(self.y1 - self.y0)
    }

    /// The smallest rectangle that holds both.
    pub fn union(self, other: Self) -> Self {
        Self {
            x0: self.x0.min(other.x0),
            y0: self.y0.min(other.y0),
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
        }
    }

    /// The pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let r = *self;
        (r.y0..r.y1).flat_map(move |y| (r.x0..r.x1).map(move |x| (x, y)))
    }

    /// Cuts the rectangle into tiles of at most `size` × `size`, row by row.
    pub fn tiles(&self, size: u32) -> Vec<Self> {
        let mut tiles = Vec::new();
        for y0 in (self.y0..self.y1).step_by(size as usize) {
            for x0 in (self.x0..self.x1).step_by(size as usize) {
                tiles.push(Self { x0, y0, x1: (x0 + size).min(self.x1), y1: (y0 + size).min(self.y1) });
            }
        }
        tiles
    }
}

/// What one replicate of one pixel has gathered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct XyzSum {
    /// Sum of the samples' CIE XYZ.
    pub xyz: [f64; 3],
    /// Finite samples summed.
    pub count: u32,
}

impl XyzSum {
    pub(crate) fn add(&mut self, xyz: [f64; 3]) {
        (0..3).for_each(|c| self.xyz[c] += xyz[c]);
        self.count += 1;
    }
}

/// One pixel: the sums of its independent replicates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel<'a>(&'a [XyzSum]);

impl<'a> Pixel<'a> {
    /// The pixel with these sums, one a replicate.
    pub fn new(sums: &'a [XyzSum]) -> Self {
        Self(sums)
    }

    /// The sums, one a replicate.
    pub fn sums(&self) -> &'a [XyzSum] {
        self.0
    }

    /// Finite samples of all replicates.
    pub fn count(&self) -> u32 {
        self.0.iter().map(|sum| sum.count).sum()
    }

    /// Mean CIE XYZ, Y = 1 for a constant radiance of 1 W·m⁻²·sr⁻¹·nm⁻¹; zero where nothing was sampled.
    pub fn xyz(&self) -> [f64; 3] {
        let count = f64::from(self.count());
        if count == 0.0 {
            [0.0; 3]
        } else {
            [0, 1, 2].map(|c| self.0.iter().map(|sum| sum.xyz[c]).sum::<f64>() / count)
        }
    }

    /// Mean as linear Rec. 709.
    pub fn linear_rec709(&self) -> [f32; 3] {
        colour::rec709_from_xyz(self.xyz()).map(|v| v as f32)
    }

    /// Variance of the mean of `of`, a linear function of XYZ, and its degrees of freedom; `None` with fewer than two
    /// replicates that hold samples.
    ///
    /// K independent replicates of nₖ samples each and means mₖ scatter about the mean m = Σnₖmₖ/N by
    /// E Σnₖ(mₖ − m)² = (K − 1)·N·Var(m), if the variance of each falls with its number of samples; these differ by one at
    /// most, unless samples that were not finite are missing. A covariance of X, Y and Z is in it, since `of` is applied to
    /// the means of each replicate.
    pub fn variance<const N: usize>(&self, of: impl Fn([f64; 3]) -> [f64; N]) -> Option<([f64; N], u32)> {
        let mean = of(self.xyz());
        let (mut scatter, mut held) = ([0.0; N], 0_u32);
        for sum in self.0.iter().filter(|sum| sum.count > 0) {
            let count = f64::from(sum.count);
            let own = of(sum.xyz.map(|v| v / count));
            (0..N).for_each(|c| scatter[c] += count * (own[c] - mean[c]) * (own[c] - mean[c]));
            held += 1;
        }
        let freedom = held.checked_sub(1).filter(|&freedom| freedom > 0)?;
        let scale = 1.0 / (f64::from(freedom) * f64::from(self.count()));
        Some((scatter.map(|s| s * scale), freedom))
    }
}

/// An image in the making: for each pixel the sums of R independent replicates, 32·R bytes, 72·R more
/// with Stokes parameters and 16·R·B more with B bands.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    replicates: u32,
    bands: u32,
    /// Most pixels whose errors have a part in common.
    correlated: u32,
    /// Pixel by pixel, in each replicate by replicate.
    sums: Vec<XyzSum>,
    /// The same of the other Stokes parameters; empty if they are not recorded.
    stokes: Vec<StokesSum>,
    /// The same, in each band by band.
    band_sums: Vec<BandSum>,
    /// What was counted on the way.
    pub counters: Counters,
}

impl Film {
    /// A black film.
    pub fn new(width: u32, height: u32, replicates: u32) -> Self {
        Self::with_bands(width, height, replicates, 0)
    }

    /// A black film that keeps this many sums for bands beside those for colour.
    pub fn with_bands(width: u32, height: u32, replicates: u32, bands: u32) -> Self {
        let number = width as usize * height as usize * replicates as usize;
        Self {
            width,
            height,
            replicates,
            bands,
            correlated: 1,
            sums: vec![XyzSum::default(); number],
            stokes: Vec::new(),
            band_sums: vec![BandSum::default(); number * bands as usize],
            counters: Counters::default(),
        }
    }

    /// The same, of pixels that share paths in blocks of this width and height, if any do: their errors are not independent.
    pub fn sharing(self, block: Option<[u32; 2]>) -> Self {
        Self { correlated: block.map_or(1, |[width, height]| width * height), ..self }
    }

    /// Most pixels whose errors have a part in common: 1 if the errors of all pixels are independent.
    pub fn correlated_pixels(&self) -> u32 {
        self.correlated
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Independent replicates of each pixel.
    pub fn replicates(&self) -> u32 {
        self.replicates
    }

    /// Where the replicates of a pixel are.
    fn replicates_of(&self, x: u32, y: u32) -> Range<usize> {
        let start = (y as usize * self.width as usize + x as usize) * self.replicates as usize;
        start..start + self.replicates as usize
    }

    /// The pixel in column `x` and row `y`.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel<'_> {
        Pixel(&self.sums[self.replicates_of(x, y)])
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel<'_>> {
        self.sums.chunks_exact(self.replicates as usize).map(Pixel)
    }

    /// Bytes of a film in memory, without Stokes parameters.
    pub fn bytes(width: u32, height: u32, replicates: u32, bands: u32) -> u64 {
        let sums = u64::from(width) * u64::from(height) * u64::from(replicates);
        sums * (size_of::<XyzSum>() as u64 + u64::from(bands) * size_of::<BandSum>() as u64)
    }

    /// Mean CIE XYZ of each pixel: see [`Pixel::xyz`].
    pub fn xyz(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.pixels().map(|pixel| pixel.xyz())
    }

    /// Linear Rec. 709 of each pixel, row by row from the top.
    pub fn linear_rec709(&self) -> Vec<[f32; 3]> {
        self.pixels().map(|pixel| pixel.linear_rec709()).collect()
    }

    /// Standard error of linear Rec. 709 of each pixel, row by row from the top: infinite where fewer than two replicates
    /// hold samples, since nothing is known there.
    pub fn linear_rec709_error(&self) -> Vec<[f32; 3]> {
        let error = |pixel: Pixel<'_>| match pixel.variance(colour::rec709_from_xyz) {
            Some((variance, _)) => variance.map(|v| v.sqrt() as f32),
            None => [f32::INFINITY; 3],
        };
        self.pixels().map(error).collect()
    }

    /// Mean Y over the pixels of a rectangle, however many samples each has: the mean radiance where the scene is the same at
    /// every wavelength. Not a number where a pixel has none.
    pub fn mean_y(&self, rect: PixelRect) -> f64 {
        let mean = |pixel: Pixel<'_>| {
            let sum: f64 = pixel.sums().iter().map(|part| part.xyz[1]).sum();
            sum / f64::from(pixel.count())
        };
        rect.pixels().map(|(x, y)| mean(self.pixel(x, y))).sum::<f64>() / rect.area() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn very_many_samples_keep_their_mean() {
        // Hard case 31.
        etalon_oracle::laws::film_mean_is_exact(|samples| {
            let mut sum = XyzSum::default();
            samples.for_each(|sample| sum.add([0.0, sample, 0.0]));
            sum.xyz[1] / f64::from(sum.count)
        })
        .assert();
    }

    #[test]
    fn as_many_pixels_have_errors_in_common_as_a_block_has() {
        let film = || Film::new(8, 8, 2);
        assert_eq!(film().sharing(Some([4, 2])).correlated_pixels(), 8);
        assert_eq!(film().sharing(None).correlated_pixels(), 1);
    }

    /// Numbers that are all different, in a tile of this many sums.
    fn tile(sums: usize, bands: usize) -> TileSums {
        let mut number = 0.0;
        let mut next = || {
            number += 1.0;
            number
        };
        TileSums {
            xyz: (0..sums).map(|i| XyzSum { xyz: [next(), next(), next()], count: i as u32 }).collect(),
            stokes: (0..sums).map(|_| [0; 3].map(|_| [0; 3].map(|_| next()))).collect(),
            bands: (0..sums * bands).map(|i| BandSum { radiance: next(), count: i as u32 }).collect(),
        }
    }

    #[test]
    fn what_a_tile_keeps_goes_to_bytes_and_back_and_to_its_place() {
        let (rect, corner) = (PixelRect { x0: 1, y0: 1, x1: 3, y1: 3 }, PixelRect { x0: 0, y0: 0, x1: 1, y1: 1 });
        let tile = tile(8, 3);
        let bytes = tile.to_bytes();
        assert_eq!(TileSums::from_bytes(&bytes, 4, 2, 3).as_ref(), Some(&tile));
        assert_eq!(TileSums::from_bytes(&bytes[1..], 4, 2, 3), None);
        let plain = TileSums { stokes: Vec::new(), ..tile.clone() };
        assert_eq!(TileSums::from_bytes(&plain.to_bytes(), 4, 2, 3).as_ref(), Some(&plain));
        let mut film = Film::with_bands(4, 3, 2, 3).recording_stokes();
        let untouched = film.tile(corner);
        assert!(film.fits(rect, &tile) && !film.fits(rect, &plain) && !film.fits(corner, &tile));
        film.put(rect, &tile);
        assert_eq!(film.tile(rect), tile);
        assert_eq!(film.tile(corner), untouched);
    }

    /// The standard error of the mean of replicates that know as much each.
    #[test]
    fn a_band_has_the_error_that_its_replicates_tell() {
        let band = |sums: [(f64, u32); 4]| {
            let mut film = Film::with_bands(1, 1, 4, 1);
            let bands = sums.map(|(radiance, count)| BandSum { radiance, count }).to_vec();
            film.put(PixelRect { x0: 0, y0: 0, x1: 1, y1: 1 }, &TileSums { bands, stokes: Vec::new(), ..tile(4, 0) });
            film.band(0, 0, 0)
        };
        // Means of 1, 2, 4 and 5, whose variance is 10/3; then of 1, 2 and 6, whose variance is 7.
        let all = band([(5.0, 5), (10.0, 5), (20.0, 5), (25.0, 5)]);
        assert!(
            all.radiance == 3.0 && all.count == 20 && (all.error - (10.0_f64 / 12.0).sqrt()).abs() < 1e-15,
            "{all:?}"
        );
        let three = band([(5.0, 5), (10.0, 5), (0.0, 0), (30.0, 5)]);
        assert!(three.radiance == 3.0 && (three.error - (7.0_f64 / 3.0).sqrt()).abs() < 1e-15, "{three:?}");
        assert_eq!(band([(5.0, 5), (0.0, 0), (0.0, 0), (0.0, 0)]).error, f64::INFINITY);
        assert_eq!(band([(0.0, 0); 4]), Band { error: f64::INFINITY, ..Band::default() });
    }

    #[test]
    fn tiles_cover_every_pixel_once() {
        let rect = PixelRect { x0: 3, y0: 1, x1: 40, y1: 38 };
        let mut seen: Vec<_> = rect.tiles(16).iter().flat_map(PixelRect::pixels).collect();
        seen.sort_unstable();
        let mut all: Vec<_> = rect.pixels().collect();
        all.sort_unstable();
        assert_eq!(seen, all);
        assert_eq!(rect.area(), all.len() as u64);
    }
}
