//! Pixel filters, sampled by importance: a sample belongs to one pixel and its weight is one (Ernst et al. 2006), so
//! every pixel is a plain mean with an honest error.

use etalon_scene::Filter;

/// Cells of the tabulated inverse distribution.
const CELLS: usize = 512;
/// Where the Gaussian is cut, in standard deviations.
const GAUSSIAN_CUT: f64 = 3.0;

/// Draws an offset from the pixel's centre along one axis.
#[derive(Clone, Debug)]
pub enum FilterSampler {
    /// Uniform over the pixel.
    Box,
    /// Offsets at probabilities i/`CELLS`; the density is constant between them.
    Table(Vec<f64>),
}

impl FilterSampler {
    /// A sampler of this filter, which is the product of one function in x and y.
    pub fn new(filter: &Filter) -> Self {
        match *filter {
            Filter::Box => Self::Box,
            Filter::Tent { radius_px } => Self::tabulate(radius_px, |x| 1.0 - x / radius_px),
            Filter::Gaussian { sigma_px } => {
                Self::tabulate(GAUSSIAN_CUT * sigma_px, |x| (-0.5 * (x / sigma_px).powi(2)).exp())
            }
        }
    }

    /// The largest offset from the pixel's centre along one axis, pixels.
    pub(crate) fn reach_px(filter: &Filter) -> f64 {
        match *filter {
            Filter::Box => 0.5,
            Filter::Tent { radius_px } => radius_px,
            Filter::Gaussian { sigma_px } => GAUSSIAN_CUT * sigma_px,
        }
    }

    /// Inverts the distribution of the even function `f`, given on [0, radius].
    fn tabulate(radius: f64, f: impl Fn(f64) -> f64) -> Self {
        let steps = 64 * CELLS;
        let at = |i: usize| (2.0 * i as f64 / steps as f64 - 1.0) * radius;
        let mut cdf = vec![0.0];
        for i in 0..steps {
            cdf.push(cdf[i] + f((0.5 * (at(i) + at(i + 1))).abs()));
        }
        let total = cdf[steps];
        let invert = |p: f64| {
            let target = p * total;
            let i = cdf.partition_point(|&c| c <= target).clamp(1, steps) - 1;
            at(i) + (at(i + 1) - at(i)) * ((target - cdf[i]) / (cdf[i + 1] - cdf[i])).min(1.0)
        };
        Self::Table((0..=CELLS).map(|i| invert(i as f64 / CELLS as f64)).collect())
    }

    /// The density with which offsets are drawn at one, in pixels: what light at this distance from the centre of a pixel counts there.
    pub fn density(&self, offset: f64) -> f64 {
        match self {
            Self::Box => f64::from((-0.5..0.5).contains(&offset)),
            Self::Table(offsets) => {
                let above = offsets.partition_point(|&edge| edge <= offset);
                if above == 0 || above == offsets.len() {
                    return 0.0;
                }
                1.0 / (CELLS as f64 * (offsets[above] - offsets[above - 1]))
            }
        }
    }

    /// The offset in pixels for `u` in [0, 1).
    pub fn offset(&self, u: f64) -> f64 {
        match self {
            Self::Table(offsets) => {
                let x = u * CELLS as f64;
                let i = x as usize;
                offsets[i] + (x - i as f64) * (offsets[i + 1] - offsets[i])
            }
            Self::Box => u - 0.5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The share of the offsets between two is the integral of the density.
    #[test]
    fn as_many_offsets_are_drawn_as_the_density_says() {
        for filter in [Filter::Box, Filter::Tent { radius_px: 1.5 }, Filter::Gaussian { sigma_px: 0.5 }] {
            let sampler = FilterSampler::new(&filter);
            let reach = FilterSampler::reach_px(&filter);
            let steps = 20_000;
            let width = 2.0 * reach / f64::from(steps);
            let at = |step: i32| -reach + (f64::from(step) + 0.5) * width;
            let mut drawn_below = 0.0;
            for step in 0..steps {
                drawn_below += sampler.density(at(step)) * width;
                if step % 1000 == 999 {
                    let edge = at(step) + 0.5 * width;
                    let share = f64::from(
                        (0..10_000).filter(|i| sampler.offset((f64::from(*i) + 0.5) / 1e4) < edge).count() as u32,
                    ) / 1e4;
                    // A ten thousandth of the offsets lies between two of those counted; a cell's end may lie within a step.
                    assert!(
                        (drawn_below - share).abs() < 1e-3,
                        "{filter:?} below {edge}: {drawn_below} is not {share}"
                    );
                }
            }
            assert_eq!(sampler.density(reach * 1.001), 0.0);
        }
    }

    /// Second moments against the filters' own: box 1/12, tent r²/6, Gaussian cut at 3σ: σ²·0.973335…. The table's cells
    /// spread each moment by less than 1e-4.
    #[test]
    fn offsets_have_the_filters_variance_and_no_bias() {
        let n = 100_000;
        for (filter, variance) in [
            (Filter::Box, 1.0 / 12.0),
            (Filter::Tent { radius_px: 1.0 }, 1.0 / 6.0),
            (Filter::Tent { radius_px: 2.0 }, 4.0 / 6.0),
            (Filter::Gaussian { sigma_px: 0.5 }, 0.25 * 0.973_335_6),
        ] {
            let sampler = FilterSampler::new(&filter);
            let offsets: Vec<f64> = (0..n).map(|i| sampler.offset((f64::from(i) + 0.5) / f64::from(n))).collect();
            let mean = offsets.iter().sum::<f64>() / f64::from(n);
            let second = offsets.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
            assert!(mean.abs() < 1e-6, "{filter:?}: {mean}");
            assert!((second / variance - 1.0).abs() < 1e-3, "{filter:?}: {second} is not {variance}");
        }
    }
}
