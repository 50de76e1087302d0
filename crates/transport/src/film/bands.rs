//! Means over bands of wavelengths.

use super::Film;

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

impl Film {
    /// Sums for bands that each replicate of a pixel has.
    pub fn bands(&self) -> u32 {
        self.bands
    }

    /// What the pixel in column `x` and row `y` knows of band `band`; after the bands of S₀ come those of S₁, S₂ and S₃, if there are
    /// any.
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
}
