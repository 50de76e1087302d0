//! Pixel filters, sampled by importance: a sample belongs to one pixel (Ernst et al. 2006), so every pixel is a plain mean with an honest error.
//!
//! Offsets are drawn by the magnitude of the filter. Where the filter is nowhere negative, all samples have the weight one. Other filters are
//! divided at their zeros. All samples of such a part have the same weight, and it is negative where the filter is.

use etalon_optics::Real;
use etalon_scene::Filter;
use std::f64::consts::PI;

/// Cells of the tabulated inverse distribution.
const CELLS: usize = 512;
/// The same of a filter that may be negative somewhere, whose parts have cells in proportion to their integrals. Its ends are flat: cells there
/// are wide.
const SIGNED_CELLS: usize = 8192;
/// Steps of the integral of a part.
const STEPS: usize = 64 * CELLS;
/// Steps among which the zeros of a filter are sought, each narrower than a hundredth of a part.
const STEPS_OF_SEARCH: usize = 8192;
/// Where the Gaussian is cut, in standard deviations.
const GAUSSIAN_CUT: f64 = 3.0;

/// Draws an offset from the pixel's centre along one axis.
#[derive(Clone, Debug)]
pub enum FilterSampler {
    /// Uniform over the pixel.
    Box,
    /// By a table.
    Table(FilterTable),
}

/// Cells of equal probability, in which density and weight are constant.
#[derive(Clone, Debug)]
pub struct FilterTable {
    /// The edges of the cells.
    offsets: Vec<f64>,
    /// What a sample of each cell counts for; empty if all count for one.
    weights: Vec<f64>,
    /// The sum of the weights of the cells before each, and of all: it ends with their number.
    weights_below: Vec<f64>,
}

impl FilterSampler {
    /// A sampler of this filter, which is the product of one function in x and y.
    pub fn new(filter: &Filter) -> Self {
        let reach = Self::reach_px(filter);
        match *filter {
            Filter::Box => Self::Box,
            Filter::Tent { radius_px } => Self::Table(FilterTable::new(reach, |x| 1.0 - x / radius_px)),
            Filter::Gaussian { sigma_px } => {
                Self::Table(FilterTable::new(reach, |x| (-0.5 * (x / sigma_px).powi(2)).exp()))
            }
            Filter::Mitchell { radius_px, b, c } => {
                Self::Table(FilterTable::signed(reach, |x| mitchell(2.0 * x / radius_px, b, c)))
            }
            Filter::Lanczos { lobes } => Self::Table(FilterTable::signed(reach, |x| lanczos(x, f64::from(lobes)))),
        }
    }

    /// The largest offset from the pixel's centre along one axis, pixels.
    pub(crate) fn reach_px(filter: &Filter) -> f64 {
        match *filter {
            Filter::Box => 0.5,
            Filter::Tent { radius_px } | Filter::Mitchell { radius_px, .. } => radius_px,
            Filter::Gaussian { sigma_px } => GAUSSIAN_CUT * sigma_px,
            Filter::Lanczos { lobes } => f64::from(lobes),
        }
    }

    /// Whether samples have weights, since the filter is negative somewhere.
    pub(crate) fn has_weights(&self) -> bool {
        matches!(self, Self::Table(table) if !table.weights.is_empty())
    }

    /// The share of the offsets that are below one.
    fn share_below(&self, offset: f64) -> f64 {
        match self {
            Self::Box => (offset + 0.5).clamp(0.0, 1.0),
            Self::Table(table) => table.share_below(offset),
        }
    }

    /// The shares of the offsets below the first and below the last that lead to a place on a film of `size` pixels from `centre`.
    fn on_film(&self, centre: f64, size: f64) -> [f64; 2] {
        [self.share_below(-centre), self.share_below(size - centre)]
    }

    /// The number that [`FilterSampler::offset`] takes for an offset on the film.
    fn number_on_film(&self, u: f64, centre: f64, size: f64) -> f64 {
        let [first, last] = self.on_film(centre, size);
        (first + u * (last - first)).min(f64::ONE_MINUS_EPSILON)
    }

    /// The offset in pixels for `u` in [0, 1) of a pixel with its centre there, among those that lead to a place on a film of `size` pixels.
    pub(crate) fn offset_on_film(&self, u: f64, centre: f64, size: f64) -> f64 {
        self.offset(self.number_on_film(u, centre, size))
    }

    /// The weight of the sample that [`FilterSampler::offset_on_film`] draws.
    pub(crate) fn weight_on_film(&self, u: f64, centre: f64, size: f64) -> f64 {
        match self {
            Self::Table(table) if !table.weights.is_empty() => {
                let [first, last] = self.on_film(centre, size);
                table.weight(self.number_on_film(u, centre, size)) / table.mean_weight(first, last)
            }
            _ => 1.0,
        }
    }

    /// What light at this distance from the centre of a pixel counts there, where light from beyond the film does not count.
    pub(crate) fn value_on_film(&self, offset: f64, centre: f64, size: f64) -> f64 {
        let [first, last] = self.on_film(centre, size);
        match self {
            Self::Table(table) if !table.weights.is_empty() => {
                self.value(offset) / ((last - first) * table.mean_weight(first, last))
            }
            _ => self.value(offset) / (last - first),
        }
    }

    /// What light at this distance from the centre of a pixel, in pixels, counts there: the density of the offsets times their weight.
    pub fn value(&self, offset: f64) -> f64 {
        match self {
            Self::Box => f64::from((-0.5..0.5).contains(&offset)),
            Self::Table(table) => table.value(offset),
        }
    }

    /// The offset in pixels for `u` in [0, 1).
    pub fn offset(&self, u: f64) -> f64 {
        match self {
            Self::Table(table) => table.offset(u),
            Self::Box => u - 0.5,
        }
    }

    /// What the sample counts for whose offset is drawn by `u`.
    pub fn weight(&self, u: f64) -> f64 {
        match self {
            Self::Table(table) => table.weight(u),
            Self::Box => 1.0,
        }
    }
}

impl FilterTable {
    /// Of the even function `f`, given on [0, radius], that is positive there.
    fn new(radius: f64, f: impl Fn(f64) -> f64) -> Self {
        let offsets = tabulate(0.0, radius, CELLS, f);
        Self { offsets, weights: Vec::new(), weights_below: Vec::new() }
    }

    /// Of the even function `f`, given on [0, radius], that may be negative somewhere.
    fn signed(radius: f64, f: impl Fn(f64) -> f64) -> Self {
        let zeros = zeros(radius, &f);
        let is_positive = zeros.is_empty();
        let mut edges: Vec<f64> = zeros.iter().rev().map(|zero| -zero).collect();
        edges.insert(0, -radius);
        edges.extend(zeros.into_iter().chain([radius]));
        let parts = || edges.windows(2).map(|edges| [0.5 * (edges[0] + edges[1]), 0.5 * (edges[1] - edges[0])]);
        let integrals: Vec<f64> = parts().map(|[middle, half]| integral(middle, half, &f)).collect();
        let magnitude: f64 = integrals.iter().map(|integral| integral.abs()).sum();
        let total: f64 = integrals.iter().sum();
        let cells: Vec<usize> = integrals
            .iter()
            .map(|integral| (SIGNED_CELLS as f64 * integral.abs() / magnitude).round().max(1.0) as usize)
            .collect();
        let count: usize = cells.iter().sum();
        let (mut offsets, mut weights, mut weights_below) = (vec![-radius], Vec::new(), vec![0.0]);
        for (([middle, half], integral), cells) in parts().zip(integrals).zip(cells) {
            offsets.extend_from_slice(&tabulate(middle, half, cells, &f)[1..]);
            // Each cell is drawn as often as any other.
            let weight = integral / total * (count as f64 / cells as f64);
            for _ in 0..cells {
                weights.push(weight);
                weights_below.push(weights_below[weights_below.len() - 1] + weight);
            }
        }
        if is_positive {
            (weights, weights_below) = (Vec::new(), Vec::new());
        }
        Self { offsets, weights, weights_below }
    }

    fn cells(&self) -> usize {
        self.offsets.len() - 1
    }

    fn share_below(&self, offset: f64) -> f64 {
        match self.offsets.partition_point(|&edge| edge <= offset) {
            0 => 0.0,
            above if above == self.offsets.len() => 1.0,
            above => {
                let (low, high) = (self.offsets[above - 1], self.offsets[above]);
                ((above - 1) as f64 + (offset - low) / (high - low)) / self.cells() as f64
            }
        }
    }

    fn value(&self, offset: f64) -> f64 {
        let above = self.offsets.partition_point(|&edge| edge <= offset);
        if above == 0 || above == self.offsets.len() {
            return 0.0;
        }
        let density = 1.0 / (self.cells() as f64 * (self.offsets[above] - self.offsets[above - 1]));
        self.weights.get(above - 1).map_or(density, |weight| weight * density)
    }

    fn offset(&self, u: f64) -> f64 {
        let x = u * self.cells() as f64;
        let i = x as usize;
        self.offsets[i] + (x - i as f64) * (self.offsets[i + 1] - self.offsets[i])
    }

    fn weight(&self, u: f64) -> f64 {
        self.weights.get((u * self.cells() as f64) as usize).copied().unwrap_or(1.0)
    }

    /// The mean weight of the samples that are drawn by numbers between two.
    fn mean_weight(&self, first: f64, last: f64) -> f64 {
        let below = |u: f64| {
            let x = u * self.cells() as f64;
            let i = (x as usize).min(self.cells() - 1);
            self.weights_below[i] + (x - i as f64) * self.weights[i]
        };
        (below(last) - below(first)) / (self.cells() as f64 * (last - first))
    }
}

/// Places of the steps of the part of a filter that reaches `half` to both sides of `middle`.
fn step(i: usize, middle: f64, half: f64) -> f64 {
    middle + (2.0 * i as f64 / STEPS as f64 - 1.0) * half
}

/// The integral over such a part of the even function `f`, by midpoints.
fn integral(middle: f64, half: f64, f: impl Fn(f64) -> f64) -> f64 {
    let at = |i| step(i, middle, half);
    (0..STEPS).map(|i| f((0.5 * (at(i) + at(i + 1))).abs()) * (at(i + 1) - at(i))).sum()
}

/// The edges of cells over which the even function `f` has equal integrals, in a part where it does not change its sign.
fn tabulate(middle: f64, half: f64, cells: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let at = |i: usize| step(i, middle, half);
    let mut cdf = vec![0.0];
    for i in 0..STEPS {
        cdf.push(cdf[i] + f((0.5 * (at(i) + at(i + 1))).abs()).abs());
    }
    let total = cdf[STEPS];
    let invert = |p: f64| {
        let target = p * total;
        let i = cdf.partition_point(|&c| c <= target).clamp(1, STEPS) - 1;
        at(i) + (at(i + 1) - at(i)) * ((target - cdf[i]) / (cdf[i + 1] - cdf[i])).min(1.0)
    };
    (0..=cells).map(|i| invert(i as f64 / cells as f64)).collect()
}

/// Where a function changes its sign between 0 and `radius`, by bisection.
fn zeros(radius: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    // The middles of steps, lest one of them is a zero.
    let at = |i: usize| (i as f64 + 0.5) / STEPS_OF_SEARCH as f64 * radius;
    let changes = (1..STEPS_OF_SEARCH).filter(|&i| f(at(i - 1)) * f(at(i)) < 0.0);
    let bisect = |i: usize| {
        let (mut low, mut high) = (at(i - 1), at(i));
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (low + high);
            if f(low) * f(middle) > 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    changes.map(bisect).collect()
}

/// The cubic of Mitchell and Netravali (1988) at a distance of up to 2.
fn mitchell(x: f64, b: f64, c: f64) -> f64 {
    let [cubic, square, linear, constant] = if x < 1.0 {
        [12.0 - 9.0 * b - 6.0 * c, -18.0 + 12.0 * b + 6.0 * c, 0.0, 6.0 - 2.0 * b]
    } else {
        [-b - 6.0 * c, 6.0 * b + 30.0 * c, -12.0 * b - 48.0 * c, 8.0 * b + 24.0 * c]
    };
    (((cubic * x + square) * x + linear) * x + constant) / 6.0
}

/// The sine over its argument, times the same that is as wide as the filter: sin(πx)/(πx) · sin(πx/n)/(πx/n).
fn lanczos(x: f64, lobes: f64) -> f64 {
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    sinc(x) * sinc(x / lobes)
}

#[cfg(test)]
mod tests;
