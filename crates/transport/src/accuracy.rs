//! How wrong a film is, by the scatter of its independent replicates.
//!
//! The relative error of a picture is E = √(mean over pixels of Var(Y)) / mean Y: the root mean square over all pixels of
//! the standard error of luminance, in units of the picture's own mean luminance. Pixels are independent of each other (or in blocks, where
//! they share paths), so the mean of many poorly known variances is well known.

use crate::film::{Film, Pixel, PixelRect, XyzSum};
use std::f64::consts::PI;

/// Side of the tiles among which the noisiest is sought, pixels.
pub const REGION: u32 = 16;

/// Two-sided 95 % of the normal distribution.
const Z_95: f64 = 1.959_963_984_540_054;

/// [`ImageError::tail_index`] above which the interval of a picture's error is too short in most renders. Measured: below, the
/// mean luminance of pictures with caustics lies in its 95 % interval in 93 to 97 % of all renders; above, in 4 to 92 %
/// (`docs/accuracy.md`, `tests/coverage.rs`).
pub const HEAVY_TAIL: f64 = 0.15;
/// [`ImageError::pixel_tail_index`] above which the intervals of single pixels are too short. Measured: below, 95 % intervals
/// hold the truth in 93 to 97 % of all pixels; with caustics found by chance, above, in 31 to 79 %.
pub const HEAVY_PIXEL_TAIL: f64 = 0.05;

/// The error of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageError {
    /// E, the relative root mean square error.
    pub relative_rmse: f64,
    /// 95 % confidence interval of E.
    pub interval: [f64; 2],
    /// The picture's level: its mean Y.
    pub mean_y: f64,
    /// How far the squared error is carried by single replicates: 0 for normally distributed ones, 1 if each pixel's error
    /// is one outlier among its replicates. Rare bright paths do this, and then both errors and intervals are too small in
    /// most renders and too large in the few that found such a path. `None` with fewer than four replicates.
    pub tail_index: Option<f64>,
    /// The same with every noisy pixel counted alike, whatever its part in the error of the picture: above
    /// [`HEAVY_PIXEL_TAIL`] the intervals of single pixels are too short, though that of the picture may be right. Where a pixel
    /// has not met any of its rare paths yet, its own replicates cannot tell; those of others do.
    pub pixel_tail_index: Option<f64>,
    /// Pixels with noise, over which that is a mean: it scatters by ½/√pixels.
    pub noisy_pixels: u64,
    /// The noisiest tile.
    pub noisiest: Region,
    /// Pixels of which nothing is known, having fewer than two replicates with samples; not counted in E.
    pub unknown_pixels: u64,
}

impl ImageError {
    /// Whether rare bright paths make the picture's interval unreliable.
    pub fn is_heavy_tailed(&self) -> bool {
        self.tail_index.is_some_and(|index| index > HEAVY_TAIL)
    }

    /// Whether rare bright paths make the intervals of single pixels unreliable, by three standard errors.
    pub fn has_heavy_tailed_pixels(&self) -> bool {
        let chance = 1.5 / (self.noisy_pixels as f64).sqrt();
        self.pixel_tail_index.is_some_and(|index| index > HEAVY_PIXEL_TAIL + chance)
    }
}

/// A tile and its share of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The tile.
    pub rect: PixelRect,
    /// Its root mean square error in units of the whole picture's mean Y.
    pub relative_rmse: f64,
    /// Its share of the squared error of the picture.
    pub share: f64,
}

/// Gathers the errors of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorSum {
    pixels: u64,
    unknown: u64,
    /// Σ of the level and of the variance over pixels, and of their squares and product.
    y: f64,
    y_y: f64,
    variance: f64,
    variance_variance: f64,
    y_variance: f64,
    /// Σ over pixels of the variance of each one's variance, and of its covariance with the level, as replicates tell them.
    uncertainty: f64,
    skew: f64,
    /// The first if replicates were distributed normally.
    normal_uncertainty: f64,
    /// Σ of variance times largest share of one group of replicates.
    outlier: f64,
    /// Σ of those shares, and pixels that have one.
    outlier_of_pixels: f64,
    grouped: u64,
}

impl ErrorSum {
    /// Takes in a pixel.
    pub fn push(&mut self, pixel: Pixel<'_>) {
        let Some(([variance], freedom)) = pixel.variance(|xyz| [xyz[1]]) else {
            self.unknown += 1;
            return;
        };
        let y = pixel.xyz()[1];
        self.pixels += 1;
        self.y += y;
        self.y_y += y * y;
        self.variance += variance;
        self.variance_variance += variance * variance;
        self.y_variance += y * variance;
        let (uncertainty, skew) = higher_moments(pixel, freedom + 1).unwrap_or((variance * variance, 0.0));
        self.uncertainty += uncertainty;
        self.skew += skew;
        // Var(V) = 2σ⁴/ν, and V² is in the mean (ν + 2)/ν times σ⁴.
        self.normal_uncertainty += 2.0 / f64::from(freedom + 2) * variance * variance;
        if let Some(share) = outlier_share(pixel) {
            self.outlier += variance * share;
            self.outlier_of_pixels += share;
            self.grouped += 1;
        }
    }

    /// E; `None` if nothing is known. A black picture without any error has E = 0.
    pub fn relative_rmse(&self) -> Option<f64> {
        (self.pixels > 0).then(|| if self.variance == 0.0 { 0.0 } else { self.mean_variance().sqrt() / self.mean_y() })
    }

    /// Relative standard error of E where these are all pixels of the picture: only the scatter of replicates is chance.
    pub fn uncertainty(&self) -> f64 {
        self.relative(self.variance, self.uncertainty, self.skew)
    }

    /// Relative standard error of E for a picture of which these pixels are a random choice.
    pub fn uncertainty_of_choice(&self) -> f64 {
        let n = self.pixels as f64;
        let about_means = |product: f64, a: f64, b: f64| product - a * b / n;
        self.relative(
            about_means(self.y_y, self.y, self.y),
            about_means(self.variance_variance, self.variance, self.variance),
            about_means(self.y_variance, self.y, self.variance),
        )
    }

    /// To first order, from the variances of Σy and of Σvariance and their covariance: ln E = ½ ln Σvariance − ln Σy + ….
    fn relative(&self, of_y: f64, of_variance: f64, covariance: f64) -> f64 {
        if self.variance == 0.0 {
            return 0.0;
        }
        let (y, v) = (self.y, self.variance);
        let square = of_y / (y * y) + 0.25 * of_variance / (v * v) - covariance / (y * v);
        // Unbiased estimates of something positive may be too small, and negative, by chance: not below what normal replicates
        // would give.
        square.max(0.25 * self.normal_uncertainty / (v * v)).sqrt()
    }

    /// See [`ImageError::tail_index`].
    pub fn tail_index(&self) -> Option<f64> {
        (self.grouped > 0 && self.variance > 0.0).then(|| Self::index(self.outlier / self.variance))
    }

    /// See [`ImageError::pixel_tail_index`].
    pub fn pixel_tail_index(&self) -> Option<f64> {
        (self.grouped > 0).then(|| Self::index(self.outlier_of_pixels / self.grouped as f64))
    }

    fn index(share: f64) -> f64 {
        // The largest share of four normal residuals in their sum of squares is, in the mean, ¾ of the mean squared cosine
        // between a random direction and the nearest of a cube's corners: (1 + 6 E|xy|)/3 with E|xy| = 2/(3π).
        let normal = 0.25 * (1.0 + 4.0 / PI);
        (share - normal) / (0.75 - normal)
    }

    /// Mean Y of the pixels that are known.
    pub fn mean_y(&self) -> f64 {
        self.y / self.pixels as f64
    }

    fn mean_variance(&self) -> f64 {
        self.variance / self.pixels as f64
    }
}

/// Unbiased estimates of the variance of [`Pixel::variance`] of Y and of its covariance with the mean, from the
/// k-statistics of the replicates' means, whatever their distribution: the variance is k₂/n, Var(k₂) is estimated by
/// (2n·k₂² + (n − 1)k₄)/(n(n + 1)) and Cov(mean, k₂) by k₃/n (Stuart & Ord, *Kendall's Advanced Theory of Statistics* I,
/// chapter 12). `None` with fewer than four replicates, which have no k₄.
fn higher_moments(pixel: Pixel<'_>, held: u32) -> Option<(f64, f64)> {
    if held < 4 {
        return None;
    }
    let n = f64::from(held);
    let mean = pixel.xyz()[1];
    let (mut m2, mut m3, mut m4) = (0.0, 0.0, 0.0);
    for sum in pixel.sums().iter().filter(|sum| sum.count > 0) {
        let d = sum.xyz[1] / f64::from(sum.count) - mean;
        m2 += d * d / n;
        m3 += d * d * d / n;
        m4 += d * d * d * d / n;
    }
    let k2 = m2 * n / (n - 1.0);
    let k3 = m3 * n * n / ((n - 1.0) * (n - 2.0));
    let k4 = n * n * ((n + 1.0) * m4 - 3.0 * (n - 1.0) * m2 * m2) / ((n - 1.0) * (n - 2.0) * (n - 3.0));
    Some(((2.0 * n * k2 * k2 + (n - 1.0) * k4) / (n * (n + 1.0)) / (n * n), k3 / (n * n)))
}

/// The largest share that one of four groups of replicates has in the scatter of all: ¾ at most.
fn outlier_share(pixel: Pixel<'_>) -> Option<f64> {
    let mut groups = [XyzSum::default(); 4];
    for (replicate, sum) in pixel.sums().iter().enumerate() {
        groups[replicate % 4].xyz[1] += sum.xyz[1];
        groups[replicate % 4].count += sum.count;
    }
    if groups.iter().any(|group| group.count == 0) {
        return None;
    }
    let means = groups.map(|group| group.xyz[1] / f64::from(group.count));
    let mean = means.iter().sum::<f64>() / 4.0;
    let squares = means.map(|m| (m - mean) * (m - mean));
    let sum: f64 = squares.iter().sum();
    (sum > 0.0).then(|| squares.iter().fold(0.0, |a: f64, &b| a.max(b)) / sum)
}

impl Film {
    /// The error of the picture in a rectangle; `None` if no pixel has two replicates with samples.
    pub fn error(&self, rect: PixelRect) -> Option<ImageError> {
        let mut all = ErrorSum::default();
        let mut noisiest = (0.0, rect, ErrorSum::default());
        for tile in rect.tiles(REGION) {
            let mut sum = ErrorSum::default();
            for (x, y) in tile.pixels() {
                all.push(self.pixel(x, y));
                sum.push(self.pixel(x, y));
            }
            let variance = if sum.pixels > 0 { sum.mean_variance() } else { 0.0 };
            if variance > noisiest.0 || noisiest.2.pixels == 0 {
                noisiest = (variance, tile, sum);
            }
        }
        let relative_rmse = all.relative_rmse()?;
        let (variance, rect, sum) = noisiest;
        let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        Some(ImageError {
            relative_rmse,
            // ln E is, to first order, a sum over pixels: among B of them with a common part of error its variance is at most B times
            // that of independent ones (Cauchy and Schwarz).
            interval: interval(relative_rmse, all.uncertainty() * f64::from(self.correlated_pixels()).sqrt()),
            mean_y: all.mean_y(),
            tail_index: all.tail_index(),
            pixel_tail_index: all.pixel_tail_index(),
            noisy_pixels: all.grouped,
            noisiest: Region {
                rect,
                relative_rmse: share(variance.sqrt(), all.mean_y()),
                share: share(sum.variance, all.variance),
            },
            unknown_pixels: all.unknown,
        })
    }
}

/// The 95 % interval of a positive quantity that is known to a relative standard error: normal in its logarithm.
pub fn interval(value: f64, relative_error: f64) -> [f64; 2] {
    let factor = (Z_95 * relative_error).exp();
    [value / factor, value * factor]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::TileSums;
    use etalon_oracle::Uniform;
    use etalon_oracle::statistics::Welford;

    /// A film whose replicates hold one sample of Y each.
    fn film(width: u32, replicates: u32, mut y: impl FnMut(u32) -> f64) -> Film {
        let mut film = Film::new(width, width, replicates);
        let rect = PixelRect { x0: 0, y0: 0, x1: width, y1: width };
        for (index, (x, y_px)) in rect.pixels().enumerate() {
            let sums: Vec<XyzSum> =
                (0..replicates).map(|_| XyzSum { xyz: [0.0, y(index as u32), 0.0], count: 1 }).collect();
            film.put(
                PixelRect { x0: x, y0: y_px, x1: x + 1, y1: y_px + 1 },
                &TileSums { xyz: sums, ..Default::default() },
            );
        }
        film
    }

    fn whole(film: &Film) -> PixelRect {
        PixelRect { x0: 0, y0: 0, x1: film.width(), y1: film.height() }
    }

    #[test]
    fn the_variance_of_the_mean_is_the_textbook_one_and_knows_covariance() {
        let sums = [[1.0, 2.0], [2.0, 3.0], [3.0, 7.0]].map(|[x, y]| XyzSum { xyz: [2.0 * x, 2.0 * y, 0.0], count: 2 });
        let film = {
            let mut film = Film::new(1, 1, 3);
            film.put(PixelRect { x0: 0, y0: 0, x1: 1, y1: 1 }, &TileSums { xyz: sums.to_vec(), ..Default::default() });
            film
        };
        let pixel = film.pixel(0, 0);
        assert_eq!(pixel.xyz(), [2.0, 4.0, 0.0]);
        let (variance, freedom) = pixel.variance(|[x, y, _]| [x, y, x + y, x - y]).unwrap();
        // Sample variances 1 and 7, covariance 2.5; over three.
        let expected = [1.0, 7.0, 13.0, 3.0].map(|v| v / 3.0);
        assert!(variance.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{variance:?}");
        assert_eq!(freedom, 2);
    }

    #[test]
    fn one_replicate_knows_nothing_and_two_are_enough() {
        assert_eq!(film(2, 1, |_| 1.0).error(PixelRect { x0: 0, y0: 0, x1: 2, y1: 2 }), None);
        let mut values = [1.0, 3.0].into_iter().cycle();
        let film = film(2, 2, |_| values.next().unwrap());
        let error = film.error(whole(&film)).unwrap();
        // Means 2, standard errors 1.
        assert_eq!((error.relative_rmse, error.mean_y, error.tail_index), (0.5, 2.0, None));
        assert_eq!(film.linear_rec709_error().len(), 4);
    }

    /// Normal and rare contributions of known variance: in 400 trials each, the interval of E must hold it in 95 % ± 4 %
    /// (3.7 standard deviations of the binomial).
    #[test]
    fn the_interval_of_the_error_holds_the_truth_whatever_the_distribution() {
        let mut numbers = Uniform::new(5);
        for (name, rare) in [("normal", false), ("rare", true)] {
            let mut held = 0;
            let mut index = Welford::new();
            for _ in 0..400 {
                let film = film(32, 4, |_| {
                    let u = numbers.number();
                    if rare {
                        if u < 0.1 { 10.0 } else { 0.0 }
                    } else {
                        1.0 + 0.3 * (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * PI * numbers.number()).cos()
                    }
                });
                let error = film.error(whole(&film)).unwrap();
                let truth = if rare { (10.0_f64 - 1.0).sqrt() / 2.0 } else { 0.15 };
                held += u32::from(error.interval[0] <= truth && truth <= error.interval[1]);
                index.push(error.tail_index.unwrap());
            }
            assert!((365..=395).contains(&held), "{name}: {held} of 400");
            // 1024 pixels of normal replicates scatter by 0.01 about zero; one in ten is an outlier where it falls alone.
            let error = index.standard_error();
            assert!(
                if rare { index.mean() > 0.5 } else { index.mean().abs() < 5.0 * error },
                "{name}: {} ± {error}",
                index.mean()
            );
        }
    }

    #[test]
    fn the_noisiest_tile_is_found() {
        let mut numbers = Uniform::new(7);
        let film = film(64, 4, |pixel| {
            let (x, y) = (pixel % 64, pixel / 64);
            let noise = if (32..48).contains(&x) && (16..32).contains(&y) { 0.5 } else { 0.1 };
            1.0 + noise * (numbers.number() - 0.5)
        });
        let error = film.error(whole(&film)).unwrap();
        assert_eq!(error.noisiest.rect, PixelRect { x0: 32, y0: 16, x1: 48, y1: 32 });
        // 25 against 15 tiles of 1.
        assert!((error.noisiest.share - 25.0 / 40.0).abs() < 0.03, "{error:?}");
    }

    #[test]
    fn a_picture_without_noise_has_no_error() {
        let film = film(8, 4, |_| 0.25);
        let error = film.error(whole(&film)).unwrap();
        assert_eq!((error.relative_rmse, error.interval), (0.0, [0.0, 0.0]));
        assert!(!error.is_heavy_tailed());
    }
}
