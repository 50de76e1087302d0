//! Whether two pictures differ beyond their noise: Welch's t tile by tile, and the spread of all p-values (Jung, Hanika &
//! Dachsbacher 2020, *Detecting Bias in Monte Carlo Renderers using Welch's t-test*).

use etalon_oracle::statistics::{normal_two_sided_tail, sidak, student_two_sided_tail};
use etalon_picture::{ERROR_PREFIX, ErrorInfo, ExrFile};
use serde::Serialize;

/// Half a unit in the last place of `f32`, relative: by this the file's values may be off.
const HALF_ULP: f64 = 1.0 / (1_u64 << 24) as f64;

/// One channel of one picture with the standard errors of its pixels.
pub(super) struct Measured<'a> {
    values: &'a [f32],
    errors: &'a [f32],
    /// Degrees of freedom of each pixel's error; `None` if the file does not tell: then the errors count as known.
    freedom: Option<f64>,
    /// Most pixels whose errors have a part in common.
    correlated: f64,
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
        })
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
    /// Whether there is noise at all: without, p is 0 or 1 and says nothing about the distribution of p-values.
    #[serde(skip)]
    noisy: bool,
}

/// The outcome for one channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelTest {
    /// Its name.
    pub channel: String,
    /// Tiles that were tested.
    pub tiles: usize,
    /// Tiles in which a pixel's error is not known.
    pub untested_tiles: usize,
    /// The tile with the smallest p-value.
    pub worst: Option<TileTest>,
    /// Probability that the smallest p-value of so many tiles is that small if the pictures show the same.
    pub p_worst: f64,
    /// Probability that so many p-values are that small together: it sees a small difference spread over many tiles.
    pub p_spread: f64,
}

impl ChannelTest {
    /// The smaller of both probabilities.
    pub fn p(&self) -> f64 {
        self.p_worst.min(self.p_spread)
    }
}

/// Significance of each of a channel's two questions, so that all channels together have `significance`.
pub(super) fn each(significance: f64, channels: usize) -> f64 {
    sidak(significance, 2 * channels)
}

/// Tests one channel of two pictures of the same width, tile by tile.
pub(super) fn test(channel: &str, a: &Measured<'_>, b: &Measured<'_>, width: usize, side: usize) -> ChannelTest {
    let height = a.values.len() / width;
    let mut tiles = Vec::new();
    let mut untested = 0;
    for y0 in (0..height).step_by(side) {
        for x0 in (0..width).step_by(side) {
            let (x1, y1) = ((x0 + side).min(width), (y0 + side).min(height));
            let pixels: Vec<usize> = (y0..y1).flat_map(|y| (x0..x1).map(move |x| y * width + x)).collect();
            match welch(a, b, &pixels, [x0, x1, y0, y1]) {
                Some(tile) => tiles.push(tile),
                None => untested += 1,
            }
        }
    }
    let worst = tiles.iter().copied().min_by(|a, b| a.p.total_cmp(&b.p));
    let noisy: Vec<f64> = tiles.iter().filter(|tile| tile.noisy).map(|tile| tile.p).collect();
    ChannelTest {
        channel: channel.to_owned(),
        tiles: tiles.len(),
        untested_tiles: untested,
        // 1 − (1 − p)ⁿ without cancellation.
        p_worst: worst.map_or(1.0, |tile| -((-tile.p).ln_1p() * tiles.len() as f64).exp_m1()),
        p_spread: too_many_small(noisy),
        worst,
    }
}

/// `None` where an error is not known. A value that is not finite equals nothing: its tile differs with certainty.
fn welch(a: &Measured<'_>, b: &Measured<'_>, pixels: &[usize], crop: [usize; 4]) -> Option<TileTest> {
    let sum = |values: &[f32]| pixels.iter().map(|&pixel| f64::from(values[pixel])).sum::<f64>();
    let rounding: f64 = pixels
        .iter()
        .map(|&pixel| HALF_ULP * (f64::from(a.values[pixel]).abs() + f64::from(b.values[pixel]).abs()))
        .sum();
    let (sum_a, sum_b) = (sum(a.values), sum(b.values));
    let ((variance_a, squares_a), (variance_b, squares_b)) = (a.spread(pixels), b.spread(pixels));
    let variance = variance_a + variance_b;
    let n = pixels.len() as f64;
    if !(sum_a.is_finite() && sum_b.is_finite()) {
        return Some(TileTest { crop, means: [sum_a / n, sum_b / n], t: f64::INFINITY, p: 0.0, noisy: false });
    }
    if !variance.is_finite() {
        return None;
    }
    let difference = sum_a - sum_b;
    let beyond = (difference.abs() - rounding).max(0.0).copysign(difference);
    let t = if beyond == 0.0 { 0.0 } else { beyond / variance.sqrt() };
    let p = if variance == 0.0 {
        f64::from(u8::from(beyond == 0.0))
    } else if squares_a + squares_b == 0.0 {
        normal_two_sided_tail(t)
    } else {
        student_two_sided_tail(t, freedom([a, b], variance, squares_a + squares_b))
    };
    Some(TileTest { crop, means: [sum_a / n, sum_b / n], t, p, noisy: variance > 0.0 })
}

/// Degrees of freedom of a sum of variances, `squares` being the sum of the squares of each over its own ν + 2: (Σσ²)² over Σσ⁴/ν, both
/// without bias (Welch 1947, *The generalization of "Student's" problem*). (ΣV)² is 2·ΣV²/(ν + 2) too large as well, hence the 2: without
/// it a single pixel with four replicates would have five degrees of freedom, not three. No sum has fewer than the least of its parts,
/// however they hang together.
fn freedom(pictures: [&Measured<'_>; 2], variance: f64, squares: f64) -> f64 {
    let least = pictures.iter().filter_map(|picture| picture.freedom).fold(f64::INFINITY, f64::min);
    (variance * variance / squares - 2.0).max(least)
}

/// One-sided Kolmogorov–Smirnov: whether p-values are smaller than uniform ones. Larger ones, as errors give that were
/// overestimated because of single outliers, are no sign of a difference. P(D⁺ > d) ≈ exp(−2nd²) (Smirnov 1939).
fn too_many_small(mut p: Vec<f64>) -> f64 {
    p.sort_by(f64::total_cmp);
    let n = p.len() as f64;
    let d = p.iter().enumerate().map(|(i, p)| (i + 1) as f64 / n - p).fold(0.0, f64::max);
    if p.is_empty() { 1.0 } else { (-2.0 * n * d * d).exp() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_oracle::Uniform;

    /// Two pictures of 64 × 64 pixels around 1, the second with a bias in some of its tiles; their errors are estimated from
    /// four replicates that are normally distributed with standard error `noise` of the mean.
    fn pair(seed: u64, noise: f64, bias: impl Fn(usize) -> f64) -> [(Vec<f32>, Vec<f32>); 2] {
        pair_of_blocks(seed, noise, bias, 1)
    }

    /// The same, where all pixels of a block of `side` × `side` have the same noise.
    fn pair_of_blocks(seed: u64, noise: f64, bias: impl Fn(usize) -> f64, side: usize) -> [(Vec<f32>, Vec<f32>); 2] {
        let mut numbers = Uniform::new(seed);
        let mut normal = || {
            let (u, v) = (1.0 - numbers.number(), numbers.number());
            (-2.0 * u.ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
        };
        [0.0, 1.0].map(|biased| {
            let blocks: Vec<[f64; 4]> = (0..64 * 64 / (side * side)).map(|_| [0; 4].map(|_| normal())).collect();
            (0..64 * 64)
                .map(|pixel| {
                    let block = pixel / 64 / side * (64 / side) + pixel % 64 / side;
                    let own = blocks[block].map(|normal| 1.0 + biased * bias(pixel) + 2.0 * noise * normal);
                    let mean = own.iter().sum::<f64>() / 4.0;
                    let squares: f64 = own.iter().map(|x| (x - mean) * (x - mean)).sum();
                    (mean as f32, (squares / 12.0).sqrt() as f32)
                })
                .unzip()
        })
    }

    fn channel(pair: &[(Vec<f32>, Vec<f32>); 2]) -> ChannelTest {
        channel_in_tiles(pair, 16, 1.0)
    }

    fn channel_in_tiles(pair: &[(Vec<f32>, Vec<f32>); 2], side: usize, correlated: f64) -> ChannelTest {
        let [a, b] =
            [0, 1].map(|i| Measured { values: &pair[i].0, errors: &pair[i].1, freedom: Some(3.0), correlated });
        test("Y", &a, &b, 64, side)
    }

    /// 400 pairs of equal pictures at 5 %: 20 false alarms are expected, five standard deviations of the binomial are 22.
    #[test]
    fn false_alarms_are_as_many_as_stated() {
        let alarms = (0..400).filter(|&seed| channel(&pair(seed, 0.1, |_| 0.0)).p() < each(0.05, 1)).count();
        assert!((2..=42).contains(&alarms), "{alarms} of 400");
    }

    /// 100 pairs at 5 %: 5 false alarms are expected, more than 16 once in 100,000 times. It sees that a single pixel was given five degrees
    /// of freedom instead of three: then 44 of these pairs are called different.
    #[test]
    fn false_alarms_are_as_many_as_stated_where_tiles_are_single_pixels() {
        for side in [1, 2] {
            let channel = |seed| channel_in_tiles(&pair(3000_u64 + seed, 0.1, |_| 0.0), side, 1.0);
            let alarms = (0..100).filter(|&seed| channel(seed).p() < each(0.05, 1)).count();
            assert!(alarms <= 16, "{alarms} of 100 in tiles of {side}");
        }
    }

    /// Where all of a block's noise is common the bound on its error is reached: 400 pairs at 5 %, as above, for tiles of sixteen blocks and
    /// of one. Told that pixels are independent, the test calls all of them different.
    #[test]
    fn false_alarms_are_as_many_as_stated_where_pixels_share_their_noise() {
        let pair = |seed| pair_of_blocks(5000_u64 + seed, 0.1, |_| 0.0, 4);
        for side in [16, 4] {
            let alarms = (0..400).filter(|&seed| channel_in_tiles(&pair(seed), side, 16.0).p() < each(0.05, 1)).count();
            assert!((2..=42).contains(&alarms), "{alarms} of 400 in tiles of {side}");
            let alarms = (0..20).filter(|&seed| channel_in_tiles(&pair(seed), side, 1.0).p() < each(1e-3, 1)).count();
            assert!(alarms >= 19, "{alarms} of 20 in tiles of {side}");
        }
    }

    /// The p-values of tiles are uniform: five standard deviations of a count of 6400 at 10 % are 120.
    #[test]
    fn one_tile_in_ten_has_a_p_value_below_a_tenth() {
        let below = (0..400)
            .map(|seed| {
                let [a, b] = pair(1000 + seed, 0.1, |_| 0.0);
                let [a, b] =
                    [&a, &b].map(|p| Measured { values: &p.0, errors: &p.1, freedom: Some(3.0), correlated: 1.0 });
                (0..16)
                    .filter(|tile| {
                        let pixels: Vec<usize> = (0..256).map(|i| tile * 256 + i).collect();
                        welch(&a, &b, &pixels, [0; 4]).unwrap().p < 0.1
                    })
                    .count()
            })
            .sum::<usize>();
        assert!((520..=760).contains(&below), "{below} of 6400");
    }

    #[test]
    fn a_bias_in_one_tile_is_found_there_and_a_small_one_everywhere_by_its_spread() {
        // The difference of two tiles has a standard error of .1·√2/16 = .0088: .06 is 6.8 of them.
        let in_tile = |pixel: usize| if pixel % 64 / 16 == 2 && pixel / 64 / 16 == 1 { 0.06 } else { 0.0 };
        let found = channel(&pair(5, 0.1, in_tile));
        assert!(found.p_worst < 1e-6, "{found:?}");
        assert_eq!(found.worst.unwrap().crop, [32, 48, 16, 32]);
        // 1.5 standard errors in each of 16 tiles.
        let found = channel(&pair(6, 0.1, |_| 0.0133));
        assert!(found.p_spread < 1e-3 && found.p_worst > 1e-3, "{found:?}");
    }

    #[test]
    fn rounding_to_f32_is_no_difference_and_unknown_errors_are_not_tested() {
        let (a, b) = (vec![0.1_f32; 256], vec![0.1_f32.next_up(); 256]);
        let exact = vec![0.0_f32; 256];
        let measured = |values, errors| Measured { values, errors, freedom: Some(3.0), correlated: 1.0 };
        assert_eq!(test("R", &measured(&a, &exact), &measured(&b, &exact), 16, 16).p(), 1.0);
        let far = vec![0.2_f32; 256];
        assert_eq!(test("R", &measured(&a, &exact), &measured(&far, &exact), 16, 16).p(), 0.0);
        let unknown = vec![f32::INFINITY; 256];
        let outcome = test("R", &measured(&a, &unknown), &measured(&far, &exact), 16, 16);
        assert_eq!((outcome.tiles, outcome.untested_tiles, outcome.p()), (0, 1, 1.0));
    }

    /// Whatever its error is said to be, also in both pictures alike.
    #[test]
    fn a_value_that_is_not_finite_differs_from_all_values() {
        let plain = vec![0.1_f32; 256];
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let with = (0..256).map(|pixel| if pixel == 77 { value } else { 0.1 }).collect::<Vec<_>>();
            for error in [0.0, 0.1, f32::INFINITY, f32::NAN] {
                let errors = vec![error; 256];
                let measured = |values| Measured { values, errors: &errors, freedom: Some(3.0), correlated: 1.0 };
                for (a, b) in [(&with, &plain), (&plain, &with), (&with, &with)] {
                    let outcome = test("R", &measured(a), &measured(b), 16, 16);
                    assert_eq!((outcome.untested_tiles, outcome.p()), (0, 0.0), "{value} ± {error}");
                }
            }
        }
    }
}
