//! All that a film keeps of a rectangle of pixels: to be added to, put down in bytes and taken up.

use super::{BandSum, Film, Pixel, PixelRect, Splats, StokesSum, XyzSum};

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
    /// What light paths add to the samples.
    pub splats: &'a Splats,
}

/// Bytes of one sum in a file: three numbers and a count.
const XYZ_SUM_BYTES: usize = 28;

/// Bytes of the sums of the other Stokes parameters: nine numbers.
const STOKES_SUM_BYTES: usize = 72;

/// A number and a count.
const BAND_SUM_BYTES: usize = 12;

impl TileSums {
    /// To be added to.
    pub(crate) fn borrow<'a>(&'a mut self, splats: &'a Splats) -> Sums<'a> {
        Sums { xyz: &mut self.xyz, stokes: &mut self.stokes, bands: &mut self.bands, splats }
    }

    /// The sums of the pixels with this many replicates each, row by row.
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

    /// The sums that [`TileSums::to_bytes`] wrote for this many pixels, replicates and bands; `None` if the bytes are not as many
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

impl Film {
    /// All that the film keeps of a rectangle's pixels.
    pub fn tile(&self, rect: PixelRect) -> TileSums {
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

    /// Replaces all that the film keeps of a rectangle's pixels.
    pub fn put(&mut self, rect: PixelRect, tile: &TileSums) {
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
    pub fn fits(&self, rect: PixelRect, tile: &TileSums) -> bool {
        let sums = rect.area() * u64::from(self.replicates);
        let stokes = if self.records_stokes() { sums } else { 0 };
        let [xyz_held, stokes_held, bands_held] = [tile.xyz.len(), tile.stokes.len(), tile.bands.len()];
        xyz_held as u64 == sums && stokes_held as u64 == stokes && bands_held as u64 == sums * u64::from(self.bands)
    }
}
