//! Where samples are summed: in `f64`, in the order of their numbers, nothing clamped.

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

/// What one replicate of one pixel has gathered of S₁, S₂ and S₃: the sums of the CIE XYZ of each.
pub type StokesSum = [[f64; 3]; 3];
/// What one replicate of one pixel has gathered in one band of wavelengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BandSum {
    /// Sum of the radiance at the wavelengths that fell into the band, W·m⁻²·sr⁻¹·nm⁻¹.
    pub radiance: f64,
    /// How many they were.
    pub count: u32,
}

impl BandSum {
    pub(crate) fn add(&mut self, radiance: f64) {
        self.radiance += radiance;
        self.count += 1;
    }
}

/// What a pixel knows of one band.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Band {
    /// Mean radiance over the band, W·m⁻²·sr⁻¹·nm⁻¹; zero where no wavelength fell into it.
    pub radiance: f64,
    /// Standard error of that; infinite where fewer than two replicates know anything.
    pub error: f64,
    /// Wavelengths that fell into it.
    pub count: u32,
}

/// All that a film keeps of a rectangle of pixels, row by row: exactly, so that a picture can be put down and taken up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileSums {
    /// Pixel by pixel, in each replicate by replicate.
    pub(crate) xyz: Vec<XyzSum>,
    /// The same of the other Stokes parameters; empty if they are not recorded.
    pub(crate) stokes: Vec<StokesSum>,
    /// Pixel by pixel, in each replicate by replicate, in each band by band.
    pub(crate) bands: Vec<BandSum>,
}

/// The sums of a rectangle that a kernel adds to: those that are not kept are empty.
pub(crate) struct Sums<'a> {
    /// See [`TileSums`].
    pub xyz: &'a mut [XyzSum],
    /// The other Stokes parameters.
    pub stokes: &'a mut [StokesSum],
    /// Bands.
    pub bands: &'a mut [BandSum],
}

/// Bytes of one sum in a file: three numbers and a count.
const XYZ_SUM_BYTES: usize = 28;
/// Bytes of the sums of the other Stokes parameters: nine numbers.
const STOKES_SUM_BYTES: usize = 72;
/// A number and a count.
const BAND_SUM_BYTES: usize = 12;

impl TileSums {
    /// To be added to.
    pub(crate) fn borrow(&mut self) -> Sums<'_> {
        Sums { xyz: &mut self.xyz, stokes: &mut self.stokes, bands: &mut self.bands }
    }

    /// The sums of the pixels with so many replicates each, row by row.
    pub fn pixels(&self, replicates: u32) -> impl Iterator<Item = Pixel<'_>> {
        self.xyz.chunks_exact(replicates as usize).map(Pixel)
    }

    /// The sums as bytes: little-endian, every bit kept.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.xyz.len() * XYZ_SUM_BYTES + self.bands.len() * BAND_SUM_BYTES);
        for sum in &self.xyz {
            sum.xyz.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            bytes.extend(sum.count.to_le_bytes());
        }
        self.stokes.iter().flatten().flatten().for_each(|v| bytes.extend(v.to_le_bytes()));
        for sum in &self.bands {
            bytes.extend(sum.radiance.to_le_bytes());
            bytes.extend(sum.count.to_le_bytes());
        }
        bytes
    }

    /// The sums that [`TileSums::to_bytes`] wrote for so many pixels, replicates and bands; `None` if the bytes are not as many
    /// as that takes.
    pub fn from_bytes(bytes: &[u8], pixels: u64, replicates: u32, bands: u32) -> Option<Self> {
        let sums = usize::try_from(pixels * u64::from(replicates)).ok()?;
        let of_bands = sums.checked_mul(bands as usize)?.checked_mul(BAND_SUM_BYTES)?;
        let (bytes, of_bands) = bytes.split_at_checked(bytes.len().checked_sub(of_bands)?)?;
        let (xyz_bytes, with_stokes) =
            (sums.checked_mul(XYZ_SUM_BYTES)?, sums.checked_mul(XYZ_SUM_BYTES + STOKES_SUM_BYTES)?);
        if bytes.len() != xyz_bytes && bytes.len() != with_stokes {
            return None;
        }
        let (bytes, stokes) = bytes.split_at(xyz_bytes);
        let number = |at: &[u8]| f64::from_le_bytes(at.try_into().expect("eight bytes"));
        let count = |at: &[u8]| u32::from_le_bytes(at.try_into().expect("four bytes"));
        let bands = of_bands
            .chunks_exact(BAND_SUM_BYTES)
            .map(|sum| BandSum { radiance: number(&sum[..8]), count: count(&sum[8..]) })
            .collect();
        let xyz = bytes
            .chunks_exact(XYZ_SUM_BYTES)
            .map(|sum| XyzSum {
                xyz: [number(&sum[..8]), number(&sum[8..16]), number(&sum[16..24])],
                count: count(&sum[24..]),
            })
            .collect();
        let stokes = stokes
            .chunks_exact(STOKES_SUM_BYTES)
            .map(|sum| [0, 1, 2].map(|s| [0, 1, 2].map(|c| number(&sum[24 * s + 8 * c..24 * s + 8 * c + 8]))))
            .collect();
        Some(Self { xyz, stokes, bands })
    }
}

/// One pixel: the sums of its independent replicates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel<'a>(&'a [XyzSum]);

impl<'a> Pixel<'a> {
    pub(crate) fn new(sums: &'a [XyzSum]) -> Self {
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

/// A sample that was not a finite number: excluded from the sums, and reported so that it can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct NonFinite {
    /// Row from the top.
    pub y: u32,
    /// Column.
    pub x: u32,
    /// Number of the sample.
    pub sample: u32,
}

/// Non-finite samples are counted without limit, and located up to this many.
pub const NONFINITE_LOCATED: usize = 16;

/// What a render counted.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Camera paths.
    pub paths: u64,
    /// Rays that looked for the nearest surface.
    pub rays: u64,
    /// Rays that asked whether a light is in sight.
    pub shadow_rays: u64,
    /// Points drawn on a lens.
    pub lens_draws: u64,
    /// Times that a light at infinity was asked for its radiance.
    pub environment_lookups: u64,
    /// Vertices at which weights of the lanes were carried, because dispersion may part them.
    pub lane_weights: u64,
    /// Boundaries that contradicted what was known of the media around a path, such as a solid left that was not entered.
    pub lost_media: u64,
    /// Paths, and shadow rays between masks, cut at the internal limit on vertices rather than ended by the scene: each may
    /// lack light.
    pub cut_paths: u64,
    /// Samples that were not finite.
    pub nonfinite: u64,
    /// The first of them, in the order of rows, columns and samples.
    pub nonfinite_at: Vec<NonFinite>,
}

impl Counters {
    /// Records a sample that is not finite.
    pub fn record_nonfinite(&mut self, at: NonFinite) {
        self.nonfinite += 1;
        self.locate(&[at]);
    }

    /// Adds another count to this one.
    pub fn merge(&mut self, other: &Self) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.shadow_rays += other.shadow_rays;
        self.lens_draws += other.lens_draws;
        self.environment_lookups += other.environment_lookups;
        self.lane_weights += other.lane_weights;
        self.lost_media += other.lost_media;
        self.cut_paths += other.cut_paths;
        self.nonfinite += other.nonfinite;
        self.locate(&other.nonfinite_at);
    }

    fn locate(&mut self, at: &[NonFinite]) {
        if !at.is_empty() {
            self.nonfinite_at.extend_from_slice(at);
            self.nonfinite_at.sort_unstable();
            self.nonfinite_at.truncate(NONFINITE_LOCATED);
        }
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

    /// The same black film, which also records S₁, S₂ and S₃.
    #[must_use]
    pub fn recording_stokes(mut self) -> Self {
        self.stokes = vec![StokesSum::default(); self.sums.len()];
        self
    }

    /// Whether S₁, S₂ and S₃ are recorded.
    pub fn records_stokes(&self) -> bool {
        !self.stokes.is_empty()
    }

    /// A black film that keeps so many sums for bands beside those for colour.
    pub fn with_bands(width: u32, height: u32, replicates: u32, bands: u32) -> Self {
        let number = width as usize * height as usize * replicates as usize;
        Self {
            width,
            height,
            replicates,
            bands,
            sums: vec![XyzSum::default(); number],
            stokes: Vec::new(),
            band_sums: vec![BandSum::default(); number * bands as usize],
            counters: Counters::default(),
        }
    }

    /// Sums for bands that each replicate of a pixel has.
    pub fn bands(&self) -> u32 {
        self.bands
    }

    /// What the pixel in column `x` and row `y` knows of band `band`.
    pub fn band(&self, x: u32, y: u32, band: u32) -> Band {
        let (replicates, bands) = (self.replicates as usize, self.bands as usize);
        let start = (y as usize * self.width as usize + x as usize) * replicates * bands + band as usize;
        let sums = || self.band_sums[start..].iter().step_by(bands).take(replicates);
        let count: u32 = sums().map(|sum| sum.count).sum();
        if count == 0 {
            return Band { error: f64::INFINITY, ..Band::default() };
        }
        let mean = sums().map(|sum| sum.radiance).sum::<f64>() / f64::from(count);
        // As in `Pixel::variance`.
        let (mut scatter, mut held) = (0.0, 0_u32);
        for sum in sums().filter(|sum| sum.count > 0) {
            let difference = sum.radiance / f64::from(sum.count) - mean;
            scatter += f64::from(sum.count) * difference * difference;
            held += 1;
        }
        let error = match held {
            1 => f64::INFINITY,
            _ => (scatter / (f64::from(held - 1) * f64::from(count))).sqrt(),
        };
        Band { radiance: mean, error, count }
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

    /// S₁, S₂ and S₃ of the pixel in column `x` and row `y`, each with its standard error, in linear Rec. 709; an error is infinite
    /// where fewer than two replicates hold samples. `None` if they are not recorded.
    pub fn stokes_rec709(&self, x: u32, y: u32) -> Option<[[[f32; 3]; 2]; 3]> {
        let range = self.replicates_of(x, y);
        let stokes = self.stokes.get(range.clone())?;
        let of = |parameter: usize| {
            // As if it were the radiance of a pixel.
            let sums: Vec<XyzSum> = stokes
                .iter()
                .zip(&self.sums[range.clone()])
                .map(|(sum, of)| XyzSum { xyz: sum[parameter], count: of.count })
                .collect();
            let pixel = Pixel(&sums);
            let value = colour::rec709_from_xyz(pixel.xyz()).map(|v| v as f32);
            let error = pixel.variance(colour::rec709_from_xyz);
            [value, error.map_or([f32::INFINITY; 3], |(variance, _)| variance.map(|v| v.sqrt() as f32))]
        };
        Some([of(0), of(1), of(2)])
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel<'_>> {
        self.sums.chunks_exact(self.replicates as usize).map(Pixel)
    }

    /// All that the film keeps of a rectangle's pixels.
    pub(crate) fn tile(&self, rect: PixelRect) -> TileSums {
        let stride = (self.replicates * self.bands) as usize;
        let of_bands = |(x, y)| {
            let start = (y as usize * self.width as usize + x as usize) * stride;
            &self.band_sums[start..start + stride]
        };
        let stokes = match self.records_stokes() {
            true => rect.pixels().flat_map(|(x, y)| &self.stokes[self.replicates_of(x, y)]).copied().collect(),
            false => Vec::new(),
        };
        TileSums {
            xyz: rect.pixels().flat_map(|(x, y)| self.pixel(x, y).sums()).copied().collect(),
            stokes,
            bands: if stride == 0 { Vec::new() } else { rect.pixels().flat_map(of_bands).copied().collect() },
        }
    }

    pub(crate) fn put(&mut self, rect: PixelRect, tile: &TileSums) {
        let replicates = self.replicates as usize;
        for ((x, y), sums) in rect.pixels().zip(tile.xyz.chunks_exact(replicates)) {
            let range = self.replicates_of(x, y);
            self.sums[range].copy_from_slice(sums);
        }
        for ((x, y), sums) in rect.pixels().zip(tile.stokes.chunks_exact(replicates)) {
            let range = self.replicates_of(x, y);
            self.stokes[range].copy_from_slice(sums);
        }
        let stride = replicates * self.bands as usize;
        for ((x, y), sums) in rect.pixels().zip(tile.bands.chunks_exact(stride.max(1))) {
            let start = (y as usize * self.width as usize + x as usize) * stride;
            self.band_sums[start..start + stride].copy_from_slice(sums);
        }
    }

    /// Whether `tile` is what this film keeps of `rect`, by its size.
    pub(crate) fn fits(&self, rect: PixelRect, tile: &TileSums) -> bool {
        let sums = rect.area() * u64::from(self.replicates);
        let stokes = if self.records_stokes() { sums } else { 0 };
        let [xyz_held, stokes_held, bands_held] = [tile.xyz.len(), tile.stokes.len(), tile.bands.len()];
        xyz_held as u64 == sums && stokes_held as u64 == stokes && bands_held as u64 == sums * u64::from(self.bands)
    }

    /// Bytes of a film in memory, without Stokes parameters.
    pub fn bytes(width: u32, height: u32, replicates: u32, bands: u32) -> u64 {
        let sums = u64::from(width) * u64::from(height) * u64::from(replicates);
        sums * (size_of::<XyzSum>() as u64 + u64::from(bands) * size_of::<BandSum>() as u64)
    }

    /// Bytes that Stokes parameters add to them.
    pub fn stokes_bytes(width: u32, height: u32, replicates: u32) -> u64 {
        u64::from(width) * u64::from(height) * u64::from(replicates) * size_of::<StokesSum>() as u64
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
    fn tiles_cover_every_pixel_once() {
        let rect = PixelRect { x0: 3, y0: 1, x1: 40, y1: 38 };
        let mut seen: Vec<_> = rect.tiles(16).iter().flat_map(PixelRect::pixels).collect();
        seen.sort_unstable();
        let mut all: Vec<_> = rect.pixels().collect();
        all.sort_unstable();
        assert_eq!(seen, all);
        assert_eq!(rect.area(), all.len() as u64);
    }

    #[test]
    fn located_samples_do_not_depend_on_the_order_of_merging() {
        let at = |i: u32| NonFinite { y: i % 7, x: i % 5, sample: i };
        let count = |order: &mut dyn Iterator<Item = u32>| {
            let mut total = Counters::default();
            for i in order {
                let mut one = Counters::default();
                one.record_nonfinite(at(i));
                total.merge(&one);
            }
            total
        };
        let forward = count(&mut (0..100));
        assert_eq!(forward, count(&mut (0..100).rev()));
        assert_eq!((forward.nonfinite, forward.nonfinite_at.len()), (100, NONFINITE_LOCATED));
    }
}
