//! How wrong a film is, by the scatter of its independent replicates.
//!
//! The relative error of a picture is E = √(mean over pixels of Var(Y)) / mean Y: the root mean square over all pixels of
//! the standard error of luminance, in units of the picture's own mean luminance. Pixels are independent of each other (or in blocks, where
//! they share paths), so the mean of many poorly known variances is well known.
//!
//! A picture in which no sample found light has an unknown error, not none: its samples cannot tell whether there is light that they
//! missed.

mod interval;

use crate::film::{Film, Pixel, PixelRect, XyzSum};
use std::f64::consts::PI;

/// Side of the tiles among which the noisiest is sought, pixels.
pub const REGION: u32 = 16;

/// [`ImageError::tail_index`] above which the interval of a picture's error is too short in most renders. Measured: below, the
/// mean luminance of pictures with caustics lies in its 95 % interval in 92 to 98 % of all renders; above, in 22 to 98 %
/// (`docs/accuracy.md`, `tests/coverage.rs`).
pub const HEAVY_TAIL: f64 = 0.15;
/// [`ImageError::pixel_tail_index`] above which the intervals of single pixels are too short. Chosen on the ready-made scenes: below, and
/// with a tail index below [`HEAVY_TAIL`], 95 % intervals hold the truth in 93 to 97 % of all pixels. Judged on drawn scenes
/// (`docs/accuracy.md`).
pub const HEAVY_PIXEL_TAIL: f64 = 0.02;

/// The share of one of four replicates in the scatter of all, above which it stands alone. The largest possible is ¾.
const ALONE: f64 = 0.74;
/// How often it does so if replicates are normal. Their residuals are then a random direction in space. It lies within a cone about one of
/// the eight corners of a cube, whose cosine is √([`ALONE`]/¾): 4(1 − √(0.74/0.75)).
const ALONE_BY_CHANCE: f64 = 0.026_756_153_132_975_86;

/// Where chance finds light: replicates of pixels that must have found some before the interval of the error is stated. After k finds
/// the interval of their true number is about k·exp(±2/√k). That holds for many. After one find the interval of the error would end at
/// 2.7 times the error; the exact one ends at 6.3 times.
pub const FEWEST_LIT: u64 = 16;

/// The error of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageError {
    /// E, the relative root mean square error. Infinite where it is unknown: no sample found light, or only so little or so much that
    /// squares are beyond the range of `f64`.
    pub relative_rmse: f64,
    /// 95 % confidence interval of E; 0 to infinity where it is unknown: E itself is, or light was found by chance in fewer than
    /// [`FEWEST_LIT`] replicates of pixels.
    pub interval: [f64; 2],
    /// The picture's level: its mean Y.
    pub mean_y: f64,
    /// 95 % confidence interval of it; `None` where that of E is unknown.
    pub mean_y_interval: Option<[f64; 2]>,
    /// How far the squared error is carried by single replicates: 0 for normally distributed ones, 1 if each pixel's error
    /// is one outlier among its replicates. Rare bright paths do this, and then both errors and intervals are too small in
    /// most renders and too large in the few that found such a path. `None` with fewer than four replicates.
    pub tail_index: Option<f64>,
    /// The share of noisy pixels whose error is one outlier among their replicates, beyond what chance makes: 0 for normally distributed
    /// replicates, 1 if it is so in all pixels. Above [`HEAVY_PIXEL_TAIL`] the intervals of single pixels are too short, though that of
    /// the picture may be right. Where a pixel has not met any of its rare paths yet, its own replicates cannot tell; those of others do.
    /// `None` with fewer than four replicates.
    pub pixel_tail_index: Option<f64>,
    /// Pixels with noise, of which that is a share: it scatters by 0.16/√pixels.
    pub noisy_pixels: u64,
    /// The noisiest tile; `None` where E is unknown.
    pub noisiest: Option<Region>,
    /// Pixels of which nothing is known, having fewer than two replicates with samples; not counted in E.
    pub unknown_pixels: u64,
}

impl ImageError {
    /// Whether anything is known of E.
    pub fn is_known(&self) -> bool {
        self.relative_rmse.is_finite()
    }

    /// Whether any sample found light.
    pub fn found_light(&self) -> bool {
        self.mean_y != 0.0
    }

    /// Whether the interval of E says something.
    pub fn has_interval(&self) -> bool {
        self.interval[1].is_finite()
    }

    /// Whether rare bright paths make the picture's interval unreliable.
    pub fn is_heavy_tailed(&self) -> bool {
        self.tail_index.is_some_and(|index| index > HEAVY_TAIL)
    }

    /// Whether rare bright paths make the intervals of single pixels unreliable: those of the picture, or an index that is too large by
    /// three standard errors. Where rare paths carry the error of the picture, most pixels have met none of theirs.
    pub fn has_heavy_tailed_pixels(&self) -> bool {
        let chance = 3.0 * (ALONE_BY_CHANCE * (1.0 - ALONE_BY_CHANCE) / self.noisy_pixels as f64).sqrt();
        self.is_heavy_tailed() || self.pixel_tail_index.is_some_and(|index| index > HEAVY_PIXEL_TAIL + chance)
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
    carried: Carried,
    /// Σ of variance times largest share of one group of replicates.
    outlier: f64,
    /// Pixels that have such a share, and those where it is above [`ALONE`].
    grouped: u64,
    alone: u64,
    /// Replicates of pixels that found light, and all replicates of the pixels where at least one did.
    lit: u64,
    tried: u64,
}

impl ErrorSum {
    /// Takes in a pixel.
    pub fn push(&mut self, pixel: Pixel<'_>) {
        let Some(([variance], freedom)) = pixel.variance(|xyz| [xyz[1]]) else {
            self.unknown += 1;
            return;
        };
        let y = pixel.xyz()[1];
        let lit = pixel.sums().iter().filter(|sum| sum.xyz[1] != 0.0).count() as u64;
        if lit > 0 {
            self.lit += lit;
            self.tried += u64::from(freedom) + 1;
        }
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
        self.carried.push(variance, f64::from(freedom));
        if let Some(share) = outlier_share(pixel) {
            self.outlier += variance * share;
            self.grouped += 1;
            self.alone += u64::from(share > ALONE);
        }
    }

    /// The same of a picture to which light is added: `y` in the mean over pixels, which has a variance that is known.
    #[must_use]
    pub fn with(&self, y: f64, variance: f64) -> Self {
        let pixels = self.pixels as f64;
        Self {
            y: self.y + pixels * y,
            y_y: self.y_y + 2.0 * y * self.y + pixels * y * y,
            variance: self.variance + pixels * variance,
            variance_variance: self.variance_variance + 2.0 * variance * self.variance + pixels * variance * variance,
            y_variance: self.y_variance + y * self.variance + variance * self.y + pixels * y * variance,
            ..*self
        }
    }

    /// E; `None` if nothing is known of it.
    pub fn relative_rmse(&self) -> Option<f64> {
        // A sum of squares that is 0 has no pixel, or no light; one that is subnormal or infinite says nothing of variances.
        let known = self.y_y.is_normal().then(|| self.mean_variance().sqrt() / self.mean_y());
        known.filter(|relative_rmse| relative_rmse.is_finite())
    }

    /// Whether light was found so rarely, and by so few replicates of the pixels that found any, that the law of large numbers says
    /// nothing of E yet.
    fn is_found_by_few(&self) -> bool {
        self.lit < FEWEST_LIT && 2 * self.lit <= self.tried
    }

    /// Relative standard error of E where these are all pixels of the picture: only the scatter of replicates is chance. Infinite
    /// where it is unknown.
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
        if self.relative_rmse().is_none() || self.is_found_by_few() {
            return f64::INFINITY;
        }
        if self.variance == 0.0 {
            return 0.0;
        }
        let (y, v) = (self.y, self.variance);
        let square = of_y / (y * y) + 0.25 * of_variance / (v * v) - covariance / (y * v);
        // Unbiased estimates of something positive may be too small, and negative, by chance: not below what normal replicates
        // would give.
        square.max(0.25 * self.normal_uncertainty / (v * v)).sqrt()
    }

    /// 95 % confidence interval of E where these are all pixels of the picture. Up to `correlated` of them have a common part of error. The interval is 0 to
    /// infinity where it is unknown.
    ///
    /// ln E is, to first order, a sum over pixels. If B of them have a common part of error, its variance is at most B times that of independent ones (Cauchy
    /// and Schwarz). That is the variance of a picture with B times fewer independent pixels.
    pub fn interval(&self, correlated: u32) -> [f64; 2] {
        let together = f64::from(correlated);
        let relative_rmse = self.relative_rmse().unwrap_or(f64::INFINITY);
        interval::of_positive(relative_rmse, self.uncertainty() * together.sqrt(), self.carried.freedom() / together)
    }

    /// 95 % confidence interval of the mean Y, as [`ErrorSum::interval`]; `None` where that is unknown.
    pub fn mean_y_interval(&self, correlated: u32) -> Option<[f64; 2]> {
        let (n, together) = (self.pixels as f64, f64::from(correlated));
        // Of a sum of independent estimates of variance (Satterthwaite 1946, *An Approximate Distribution of Estimates of Variance Components*).
        let freedom = 2.0 * self.variance * self.variance / self.normal_uncertainty / together;
        let (variance, skew) = (self.variance / (n * n) * together, self.skew / (n * n * n) * together * together);
        let interval = interval::of_mean(self.mean_y(), variance, skew, freedom);
        self.uncertainty().is_finite().then_some(interval)
    }

    /// See [`ImageError::tail_index`].
    pub fn tail_index(&self) -> Option<f64> {
        // The largest share of four normal residuals in their sum of squares is, in the mean, ¾ of the mean squared cosine
        // between a random direction and the nearest of a cube's corners: (1 + 6 E|xy|)/3 with E|xy| = 2/(3π).
        let normal = 0.25 * (1.0 + 4.0 / PI);
        (self.grouped > 0 && self.variance > 0.0).then(|| (self.outlier / self.variance - normal) / (0.75 - normal))
    }

    /// See [`ImageError::pixel_tail_index`].
    pub fn pixel_tail_index(&self) -> Option<f64> {
        (self.grouped > 0).then(|| {
            let share = self.alone as f64 / self.grouped as f64;
            (share - ALONE_BY_CHANCE) / (1.0 - ALONE_BY_CHANCE)
        })
    }

    /// Mean Y of the pixels that are known.
    pub fn mean_y(&self) -> f64 {
        self.y / self.pixels as f64
    }

    fn mean_variance(&self) -> f64 {
        self.variance / self.pixels as f64
    }
}

/// How many pixels carry what is known of the error: few, where few have met bright paths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Carried {
    /// The first variance that is not 0: the fourth powers of others are in units of its own.
    unit: f64,
    /// Σ of squared variances, and of their variances if replicates were distributed normally.
    squares: f64,
    uncertainty: f64,
}

impl Carried {
    /// An estimated variance v with ν degrees of freedom. For normal replicates the mean of v² is (ν + 2)/ν σ⁴, and that of v⁴ is
    /// (ν + 2)(ν + 4)(ν + 6)/ν³ σ⁸. So v⁴ · 8(ν + 3)/((ν + 4)(ν + 6)) is in the mean the variance of v².
    fn push(&mut self, variance: f64, freedom: f64) {
        if variance == 0.0 {
            return;
        }
        if self.unit == 0.0 {
            self.unit = variance;
        }
        let square = (variance / self.unit).powi(2);
        self.squares += square;
        self.uncertainty += square * square * 8.0 * (freedom + 3.0) / ((freedom + 4.0) * (freedom + 6.0));
    }

    /// Degrees of freedom of Σv², by which E's interval is known: twice its square over its variance.
    fn freedom(&self) -> f64 {
        2.0 * self.squares * self.squares / self.uncertainty
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
        if all.pixels == 0 {
            return None;
        }
        let known = all.relative_rmse();
        let relative_rmse = known.unwrap_or(f64::INFINITY);
        let (variance, rect, sum) = noisiest;
        let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        Some(ImageError {
            relative_rmse,
            interval: all.interval(self.correlated_pixels()),
            mean_y: all.mean_y(),
            mean_y_interval: all.mean_y_interval(self.correlated_pixels()),
            tail_index: all.tail_index(),
            pixel_tail_index: all.pixel_tail_index(),
            noisy_pixels: all.grouped,
            noisiest: known.map(|_| Region {
                rect,
                relative_rmse: share(variance.sqrt(), all.mean_y()),
                share: share(sum.variance, all.variance),
            }),
            unknown_pixels: all.unknown,
        })
    }
}

#[cfg(test)]
mod tests;
