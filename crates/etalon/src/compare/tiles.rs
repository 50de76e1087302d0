//! Welch's t of one tile of two pictures (Jung, Hanika & Dachsbacher 2020, *Detecting Bias in Monte Carlo Renderers using Welch's
//! t-test*).

use etalon_oracle::statistics::{normal_two_sided_tail, student_two_sided_tail};
use etalon_picture::{ERROR_PREFIX, ErrorInfo, ExrFile};
use serde::Serialize;

/// By how much a value of a file of 32-bit floats may be off, relative: 64 halves of the last place. A single rounding is off by one of
/// them. A renderer that adds its samples in 32-bit floats rounds each sum. 4096 roundings, up as often as down, are off by 64.
const SINGLE: f64 = 64.0 / (1_u64 << 24) as f64;
/// The same of 16-bit floats: half of the last place. Their samples are added in more digits.
const HALF: f64 = 1.0 / (1_u64 << 11) as f64;

/// One channel of one picture with the standard errors of its pixels.
pub(super) struct Measured<'a> {
    pub(super) values: &'a [f32],
    pub(super) errors: &'a [f32],
    /// Degrees of freedom of each pixel's error; `None` if the file does not tell: then the errors count as known.
    pub(super) freedom: Option<f64>,
    /// Most pixels whose errors have a part in common.
    pub(super) correlated: f64,
    /// By how much each value may be off because it is rounded, relative.
    pub(super) rounding: f64,
}

impl<'a> Measured<'a> {
    /// The channel `name`, if the file has it with its errors.
    pub(super) fn new(file: &'a ExrFile, name: &str) -> Option<Self> {
        let info = ErrorInfo::from_attributes(&file.attributes);
        let replicates = info.as_ref().map(|info| info.replicates);
        Some(Self {
            values: file.picture.channel(name)?,
            errors: file.picture.channel(&format!("{ERROR_PREFIX}{name}"))?,
            freedom: replicates.map(|replicates| f64::from(replicates.saturating_sub(1).max(1))),
            correlated: info.map_or(1.0, |info| f64::from(info.correlated_pixels.max(1))),
            rounding: rounding(file.picture.is_half(name)),
        })
    }

    /// How many pixels the channel has.
    pub(super) fn pixels(&self) -> usize {
        self.values.len()
    }

    /// The sum of the variances of those among some pixels whose error is known.
    pub(super) fn known_variance(&self, pixels: &[usize]) -> f64 {
        pixels.iter().map(|&pixel| f64::from(self.errors[pixel]).powi(2)).filter(|variance| variance.is_finite()).sum()
    }

    /// The variance of the sum of some pixels, and what Welch & Satterthwaite divide its square by. Among B pixels with a common part
    /// of error the variance of the sum is at most B times the sum of variances, and so is the sum of blocks' squared variances of that
    /// of pixels' (Cauchy and Schwarz): where paths are shared, differences are judged by these bounds.
    fn spread(&self, pixels: &[usize]) -> (f64, f64) {
        let (sum, squares) = self.spread_of_independent(pixels);
        (self.correlated * sum, self.correlated.powi(3) * squares)
    }

    fn spread_of_independent(&self, pixels: &[usize]) -> (f64, f64) {
        pixels.iter().fold((0.0, 0.0), |(sum, squares), &pixel| {
            let variance = f64::from(self.errors[pixel]).powi(2);
            // The square of a variance that is itself an estimate with ν degrees of freedom is (ν + 2)/ν times too large.
            let square = self.freedom.map_or(0.0, |freedom| variance * variance / (freedom + 2.0));
            (sum + variance, squares + square)
        })
    }
}

/// By how much a value may be off because it is rounded, relative.
pub(super) fn rounding(half: bool) -> f64 {
    if half { HALF } else { SINGLE }
}

/// The test of one tile in one channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TileTest {
    /// Columns x0 to x1, rows y0 to y1.
    pub crop: [usize; 4],
    /// Mean of the first and of the second picture.
    pub means: [f64; 2],
    /// Difference over its standard error; infinite where a value is not finite.
    pub t: f64,
    /// Two-sided p-value.
    pub p: f64,
    /// Standard error of the difference of the means.
    #[serde(skip)]
    pub(super) error: f64,
    /// Degrees of freedom of that error; infinite where it counts as known.
    #[serde(skip)]
    pub(super) freedom: f64,
}

impl TileTest {
    /// Whether there is noise at all: without, p is 0 or 1 and says nothing about the distribution of p-values.
    pub(super) fn noisy(&self) -> bool {
        self.error > 0.0
    }
}

/// `None` where an error is not known. A value that is not finite equals nothing: its tile differs with certainty.
pub(super) fn welch(a: &Measured<'_>, b: &Measured<'_>, pixels: &[usize], crop: [usize; 4]) -> Option<TileTest> {
    let sum = |values: &[f32]| pixels.iter().map(|&pixel| f64::from(values[pixel])).sum::<f64>();
    let off = |picture: &Measured<'_>, pixel: usize| picture.rounding * f64::from(picture.values[pixel]).abs();
    let rounding: f64 = pixels.iter().map(|&pixel| off(a, pixel) + off(b, pixel)).sum();
    let (sum_a, sum_b) = (sum(a.values), sum(b.values));
    let ((variance_a, squares_a), (variance_b, squares_b)) = (a.spread(pixels), b.spread(pixels));
    let variance = variance_a + variance_b;
    let n = pixels.len() as f64;
    if !(sum_a.is_finite() && sum_b.is_finite()) {
        let means = [sum_a / n, sum_b / n];
        return Some(TileTest { crop, means, t: f64::INFINITY, p: 0.0, error: 0.0, freedom: f64::INFINITY });
    }
    if !variance.is_finite() {
        return None;
    }
    let difference = sum_a - sum_b;
    let beyond = (difference.abs() - rounding).max(0.0).copysign(difference);
    let t = if beyond == 0.0 { 0.0 } else { beyond / variance.sqrt() };
    let squares = squares_a + squares_b;
    let freedom = if squares == 0.0 { f64::INFINITY } else { freedom([a, b], variance, squares) };
    let p = if variance == 0.0 {
        f64::from(u8::from(beyond == 0.0))
    } else if freedom.is_infinite() {
        normal_two_sided_tail(t)
    } else {
        student_two_sided_tail(t, freedom)
    };
    Some(TileTest { crop, means: [sum_a / n, sum_b / n], t, p, error: variance.sqrt() / n, freedom })
}

/// Degrees of freedom of a sum of variances, `squares` being the sum of the squares of each over its own ν + 2: (Σσ²)² over Σσ⁴/ν, both
/// without bias (Welch 1947, *The generalization of "Student's" problem*). (ΣV)² is 2·ΣV²/(ν + 2) too large as well, hence the 2: without
/// it a single pixel with four replicates would have five degrees of freedom, not three. No sum has fewer than the least of its parts,
/// however they hang together.
fn freedom(pictures: [&Measured<'_>; 2], variance: f64, squares: f64) -> f64 {
    let least = pictures.iter().filter_map(|picture| picture.freedom).fold(f64::INFINITY, f64::min);
    (variance * variance / squares - 2.0).max(least)
}
