//! The other three Stokes parameters of a picture.

use super::{Film, Pixel, XyzSum};
use etalon_optics::colour;

/// What one replicate of one pixel has gathered of S₁, S₂ and S₃: the sums of the CIE XYZ of each.
pub type StokesSum = [[f64; 3]; 3];

impl Film {
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

    /// Bytes that Stokes parameters add to them.
    pub fn stokes_bytes(width: u32, height: u32, replicates: u32) -> u64 {
        u64::from(width) * u64::from(height) * u64::from(replicates) * size_of::<StokesSum>() as u64
    }
}
