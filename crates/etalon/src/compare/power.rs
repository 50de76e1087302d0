//! What a comparison would have seen.

use etalon_oracle::statistics::{
    binomial_upper_tail, normal_two_sided_quantile, normal_upper_tail, sidak, student_two_sided_quantile,
};
use serde::Serialize;

use super::scales::SMALL;
use super::tiles::TileTest;

/// Probability with which a change is found that is stated as visible.
pub const POWER: f64 = 0.9;
/// Tiles that stand for all in the computation of power: each is the middle of as many by the order of their noise.
const REPRESENTATIVES: usize = 128;
/// Changes above this are not stated: that a picture is more than ten times as bright is no fine difference.
const LARGEST: f64 = 10.0;

/// The smallest relative changes that would have been found with a probability of 0.9. `None` where none up to tenfold would have been.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seen {
    /// Of one tile, whichever.
    pub in_one_tile: Option<f64>,
    /// Of every tile, brighter or darker each as it may be.
    pub in_all_tiles: Option<f64>,
}

/// The noise of the tiles of one size.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Noise {
    /// Standard error of the difference relative to the mean, and its degrees of freedom, from the least noise to the most.
    representatives: Vec<(f64, f64)>,
    tiles: usize,
    noisy: usize,
    /// Share of the tiles with light that were tested.
    tested: f64,
}

impl Noise {
    /// Of the tested tiles, where `others` were not. Black tiles do not count: nothing can change there by a part of what it is.
    pub(super) fn new(tiles: &[TileTest], others: usize) -> Self {
        let mut noise: Vec<(f64, f64)> = tiles
            .iter()
            .map(|tile| (tile.error / (0.5 * (tile.means[0] + tile.means[1])), tile.freedom))
            .filter(|(error, _)| error.is_finite() && *error >= 0.0)
            .collect();
        noise.sort_by(|a, b| a.0.total_cmp(&b.0));
        let lit = noise.len();
        let count = lit.min(REPRESENTATIVES);
        Self {
            representatives: (0..count).map(|i| noise[(2 * i + 1) * lit / (2 * count)]).collect(),
            tiles: tiles.len(),
            noisy: tiles.iter().filter(|tile| tile.noisy()).count(),
            tested: lit as f64 / (lit + others).max(1) as f64,
        }
    }

    /// What is seen if each p-value is compared with `accepted_from`, and whether small p-values are counted.
    pub(super) fn seen(&self, accepted_from: f64, counted: bool) -> Seen {
        let each = sidak(accepted_from, self.tiles.max(1));
        let limits = self.limits(each);
        let in_one = |change: f64| self.tested * self.mean_power(change, &limits);
        let small = self.limits(SMALL);
        let needed = self.count_needed(accepted_from);
        let in_all = |change: f64| {
            let share = self.mean_power(change, &small);
            let (mean, variance) = (self.noisy as f64 * share, self.noisy as f64 * share * (1.0 - share));
            normal_upper_tail((needed - 0.5 - mean) / variance.max(1e-12).sqrt())
        };
        Seen { in_one_tile: smallest(in_one), in_all_tiles: counted.then(|| smallest(in_all)).flatten() }
    }

    /// |t| from which p is below `p`, of each representative.
    fn limits(&self, p: f64) -> Vec<f64> {
        let normal = normal_two_sided_quantile(p);
        let limit = |&(_, freedom): &(f64, f64)| {
            // Closer than a thousandth to the normal distribution at the significances in use.
            if freedom > 1e5 { normal } else { student_two_sided_quantile(p, freedom) }
        };
        self.representatives.iter().map(limit).collect()
    }

    /// Probability that a tile changed by this part exceeds its limit, in the mean over all tiles.
    fn mean_power(&self, change: f64, limits: &[f64]) -> f64 {
        let found = |(&(error, freedom), &limit): (&(f64, f64), &f64)| {
            // What is brighter by a part has more noise by the same part.
            let shift = change / (error * (0.5 + 0.5 * (1.0 + change) * (1.0 + change)).sqrt());
            // The noncentral t, whose spread grows with t where the noise itself is known by few numbers (Abramowitz & Stegun 26.7.10).
            let (at, spread) = (limit * (1.0 - 0.25 / freedom), (1.0 + 0.5 * limit * limit / freedom).sqrt());
            let beyond = |shift: f64| normal_upper_tail((at - shift) / spread);
            if error == 0.0 { 1.0 } else { beyond(shift) + beyond(-shift) }
        };
        let sum: f64 = self.representatives.iter().zip(limits).map(found).sum();
        sum / self.representatives.len().max(1) as f64
    }

    /// How many small p-values call the pictures different.
    fn count_needed(&self, accepted_from: f64) -> f64 {
        let (mut low, mut high) = (0, self.noisy as u64 + 1);
        while low < high {
            let middle = low.midpoint(high);
            if binomial_upper_tail(middle, self.noisy as u64, SMALL) < accepted_from {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        low as f64
    }
}

/// The smallest change that is found with [`POWER`], to a thousandth; `found` grows with the change.
fn smallest(found: impl Fn(f64) -> f64) -> Option<f64> {
    if found(LARGEST).is_nan() || found(LARGEST) < POWER {
        return None;
    }
    let (mut low, mut high) = (1e-9_f64, LARGEST);
    while high / low > 1.001 {
        let middle = (low * high).sqrt();
        if found(middle) < POWER {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}
