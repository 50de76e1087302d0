//! Pixel filters, sampled by importance: a sample belongs to one pixel and its weight is one (Ernst et al. 2006), so
//! every pixel is a plain mean with an honest error.

use etalon_optics::Real;
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

    /// The share of the offsets that are below one.
    fn share_below(&self, offset: f64) -> f64 {
        match self {
            Self::Box => (offset + 0.5).clamp(0.0, 1.0),
            Self::Table(offsets) => match offsets.partition_point(|&edge| edge <= offset) {
                0 => 0.0,
                above if above == offsets.len() => 1.0,
                above => {
                    let (low, high) = (offsets[above - 1], offsets[above]);
                    ((above - 1) as f64 + (offset - low) / (high - low)) / CELLS as f64
                }
            },
        }
    }

    /// The shares of the offsets below the first and below the last that lead to a place on a film of `size` pixels from `centre`.
    fn on_film(&self, centre: f64, size: f64) -> [f64; 2] {
        [self.share_below(-centre), self.share_below(size - centre)]
    }

    /// The offset in pixels for `u` in [0, 1) of a pixel with its centre there, among those that lead to a place on a film of `size` pixels.
    pub(crate) fn offset_on_film(&self, u: f64, centre: f64, size: f64) -> f64 {
        let [first, last] = self.on_film(centre, size);
        self.offset((first + u * (last - first)).min(f64::ONE_MINUS_EPSILON))
    }

    /// The density with which [`FilterSampler::offset_on_film`] draws an offset to a place on the film.
    pub(crate) fn density_on_film(&self, offset: f64, centre: f64, size: f64) -> f64 {
        let [first, last] = self.on_film(centre, size);
        self.density(offset) / (last - first)
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

    /// Of a pixel at the edge of a film, and of one that is all of it, by the tent's own integrals.
    #[test]
    fn offsets_on_a_film_stay_on_it_and_are_drawn_as_their_density_says() {
        // ∫ of 1 − |x|/2 from 0 to x.
        let tent = |x: f64| x - 0.25 * x * x.abs();
        let sampler = FilterSampler::new(&Filter::Tent { radius_px: 2.0 });
        for (centre, size) in [(0.5_f64, 1.0_f64), (0.5, 9.0), (1.5, 9.0), (8.5, 9.0), (4.5, 9.0)] {
            let [low, high] = [(-centre).max(-2.0), (size - centre).min(2.0)];
            let n = 10_000;
            let drawn = |i: i32| sampler.offset_on_film((f64::from(i) + 0.5) / f64::from(n), centre, size);
            assert!((0..n).map(drawn).all(|offset| (low - 1e-12..=high + 1e-12).contains(&offset)));
            for place in [0.1, 0.4, 0.8] {
                let offset = low + place * (high - low);
                let exact = (tent(offset) - tent(low)) / (tent(high) - tent(low));
                let share = (0..n).filter(|i| drawn(*i) < offset).count() as f64 / f64::from(n);
                // A ten thousandth lies between two of those counted; the cells of the table change shares by less.
                assert!((share - exact).abs() < 2e-4, "{centre} of {size}, below {offset}: {share} is not {exact}");
                let height = 1.0 - 0.5 * offset.abs();
                let density = height / (tent(high) - tent(low));
                let found = sampler.density_on_film(offset, centre, size);
                // It is constant in a cell, which is 2/(512 h) wide where the tent is h high. Over half of that the tent changes by this part.
                let cell = 1.0 / (2.0 * CELLS as f64 * height * height);
                assert!(
                    (found / density - 1.0).abs() < 1.1 * cell,
                    "{centre} of {size}, at {offset}: {found} is not {density}"
                );
            }
        }
        assert!(sampler.offset_on_film(f64::ONE_MINUS_EPSILON, 4.5, 9.0) <= 2.0);
        assert_eq!(FilterSampler::Box.offset_on_film(0.25, 0.5, 4.0), -0.25);
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
