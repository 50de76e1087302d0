//! Whether one channel of two pictures differs beyond its noise, at several scales: in tiles of a few pixels, in larger ones, and in the
//! whole picture. A change that leaves the sum of a large tile as it is shows in smaller ones. A small change of all pixels shows in larger
//! ones.

use etalon_oracle::statistics::binomial_upper_tail;
use serde::Serialize;

use super::power::{self, Seen};
use super::tiles::{Measured, TileTest, welch};

/// Sizes of tiles, each twice the one before.
const SIZES: u32 = 4;
/// A p-value counts as small up to here. Tails of t are not heavier than Student's up to about this probability, whatever symmetric
/// distribution the noise has (Efron 1969, *Student's t-test under symmetry conditions*). Beyond, they are: a tile whose noise is a single
/// outlier has |t| of about 1.
pub(super) const SMALL: f64 = 0.1;
/// Fewest tiles whose p-values are counted.
const FEWEST_COUNTED: usize = 16;
/// Degrees of freedom that a tile needs if all noise is that of one picture, see [`degrees_needed`].
const DEGREES_FOR_SKEW: f64 = 400.0;

/// The test of one channel in tiles of one size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScaleTest {
    /// Side of the tiles, pixels; `None` for the whole picture.
    pub side: Option<usize>,
    /// Tiles that were tested.
    pub tiles: usize,
    /// Tiles in which a pixel's error is not known.
    pub untested_tiles: usize,
    /// Tiles that are left to larger sizes: one picture has more noise there than the other, and its distribution may be skewed.
    pub skewed_tiles: usize,
    /// The tile with the smallest p-value.
    pub worst: Option<TileTest>,
    /// Probability that the smallest p-value of this many tiles is that small if the pictures show the same.
    pub p_worst: f64,
    /// Probability that this many p-values are below 0.1 if the pictures show the same: it sees small differences of many tiles. `None` for
    /// fewer than 16 tiles.
    pub p_spread: Option<f64>,
    /// What the test would have seen.
    pub seen: Seen,
    /// Tiles by their noise, for [`Seen`].
    #[serde(skip)]
    noise: power::Noise,
}

/// The outcome for one channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelTest {
    /// Its name.
    pub channel: String,
    /// Smallest tiles that were tested.
    pub tiles: usize,
    /// Smallest tiles in which a pixel's error is not known.
    pub untested_tiles: usize,
    /// The worst tile of the size with the smallest `p_worst`.
    pub worst: Option<TileTest>,
    /// The smallest `p_worst` of all sizes.
    pub p_worst: f64,
    /// The smallest `p_spread` of all sizes; 1 if there is none.
    pub p_spread: f64,
    /// The test of each size, the smallest first; the whole picture comes last.
    pub scales: Vec<ScaleTest>,
}

impl ChannelTest {
    /// The smaller of both probabilities.
    pub fn p(&self) -> f64 {
        self.p_worst.min(self.p_spread)
    }

    /// How many p-values it has to offer.
    pub(super) fn questions(&self) -> usize {
        self.scales.iter().map(|scale| 1 + usize::from(scale.p_spread.is_some())).sum()
    }

    /// Computes what it would have seen, each p-value being compared with `accepted_from`.
    pub(super) fn set_power(&mut self, accepted_from: f64) {
        for scale in &mut self.scales {
            scale.seen = scale.noise.seen(accepted_from, scale.p_spread.is_some());
        }
    }
}

/// The aligned square of side `side` with the upper left corner (x0, y0), in a picture of this width: its crop and its pixels.
fn square(width: usize, height: usize, [x0, y0]: [usize; 2], side: usize) -> ([usize; 4], Vec<usize>) {
    let (x1, y1) = ((x0 + side).min(width), (y0 + side).min(height));
    ([x0, x1, y0, y1], (y0..y1).flat_map(|y| (x0..x1).map(move |x| y * width + x)).collect())
}

/// Degrees of freedom from which a tile is tested where both pictures have these variances.
///
/// Noise is skewed: it often lacks light and rarely has much too much. The skew of a difference is that of the noisier picture less that of
/// the other. Of n samples a mean has the variance σ²/n and the third moment γσ³/n². So with r = Vmin/Vmax the skew of the difference is in
/// proportion to (1 − r²)/(1 + r)^1.5: 0 for equal noise, 1 if one picture has none. Skew of t falls with the root of the independent parts
/// of the sum, which degrees of freedom count.
fn degrees_needed(variances: [f64; 2]) -> f64 {
    let [a, b] = variances;
    if a.max(b) <= 0.0 {
        return 0.0;
    }
    let ratio = a.min(b) / a.max(b);
    let skew = (1.0 - ratio * ratio) / (1.0 + ratio).powf(1.5);
    DEGREES_FOR_SKEW * skew * skew
}

/// Tests one channel of two pictures of the same width in tiles of `side` pixels, of two, four and eight times that, and as a whole.
pub(super) fn test(channel: &str, a: &Measured<'_>, b: &Measured<'_>, width: usize, side: usize) -> ChannelTest {
    let height = a.pixels() / width;
    let whole = width.max(height);
    let sides = (0..SIZES).map(|size| side.saturating_mul(1 << size)).take_while(|&side| side < whole);
    let surroundings = side.saturating_mul(1 << (SIZES - 1)).min(whole);
    let mut scales: Vec<ScaleTest> = sides.map(|side| scale([a, b], width, side, Some(side), surroundings)).collect();
    scales.push(scale([a, b], width, whole, None, whole));
    let worst = scales.iter().min_by(|a, b| a.p_worst.total_cmp(&b.p_worst)).expect("the whole picture is a scale");
    ChannelTest {
        channel: channel.to_owned(),
        tiles: scales[0].tiles,
        untested_tiles: scales[0].untested_tiles,
        worst: worst.worst,
        p_worst: worst.p_worst,
        p_spread: scales.iter().filter_map(|scale| scale.p_spread).fold(1.0, f64::min),
        scales,
    }
}

/// The test in tiles of `side` pixels. Whether one picture is noisier than the other is read off squares of `surroundings` pixels.
fn scale(
    [a, b]: [&Measured<'_>; 2],
    width: usize,
    side: usize,
    stated: Option<usize>,
    surroundings: usize,
) -> ScaleTest {
    let height = a.pixels() / width;
    let (mut tiles, mut untested, mut skewed) = (Vec::new(), 0, 0);
    for y in (0..height).step_by(surroundings) {
        for x in (0..width).step_by(surroundings) {
            let ([x0, x1, y0, y1], around) = square(width, height, [x, y], surroundings);
            let needed = degrees_needed([a, b].map(|picture| picture.known_variance(&around)));
            for y in (y0..y1).step_by(side) {
                for x in (x0..x1).step_by(side) {
                    let (crop, pixels) = square(width, height, [x, y], side);
                    match welch(a, b, &pixels, crop) {
                        None => untested += 1,
                        Some(tile) if tile.freedom < needed => skewed += 1,
                        Some(tile) => tiles.push(tile),
                    }
                }
            }
        }
    }
    let worst = tiles.iter().copied().min_by(|a, b| a.p.total_cmp(&b.p));
    let counted: Vec<&TileTest> = tiles.iter().filter(|tile| tile.noisy()).collect();
    let small = counted.iter().filter(|tile| tile.p <= SMALL).count();
    ScaleTest {
        side: stated,
        tiles: tiles.len(),
        untested_tiles: untested,
        skewed_tiles: skewed,
        // 1 − (1 − p)ⁿ without cancellation.
        p_worst: worst.map_or(1.0, |tile| -((-tile.p).ln_1p() * tiles.len() as f64).exp_m1()),
        p_spread: (counted.len() >= FEWEST_COUNTED)
            .then(|| binomial_upper_tail(small as u64, counted.len() as u64, SMALL)),
        worst,
        seen: Seen::default(),
        noise: power::Noise::new(&tiles, untested + skewed),
    }
}
