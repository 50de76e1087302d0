//! A pilot: a few pixels of a picture rendered beforehand, to tell what the whole will cost.
//!
//! Its samples are other ones than the picture's, whatever its number of samples, and none of them is kept. What it decides
//! is therefore independent of every value in the picture: a picture whose number of samples a pilot chose is as unbiased
//! as one whose number was given. A rule that looked at the picture itself would prefer those in which rare bright paths
//! have not been found.

use crate::accuracy::ErrorSum;
use crate::film::{Counters, Pixel, PixelRect, XyzSum};
use crate::prepare::Prepared;
use crate::render::ThreadError;
use crate::sampler::{SOBOL_POINTS, mix};
use etalon_scene::SamplerKind;
use rayon::prelude::*;

/// Pixels that a pilot begins with, if the picture has so many.
const FIRST_PIXELS: u64 = 8192;
/// Relative standard error of the picture's error for which more pixels are taken.
const KNOWN_WELL: f64 = 0.05;
/// Largest share of the picture's pixels that more precision is bought with.
const MOST_OF_PICTURE: f64 = 0.25;
/// Samples a pixel before the error of a pilot's error is believed.
const BELIEVED_FROM: u32 = 16;
/// Fewest replicates that an error is estimated from.
const FEWEST_REPLICATES: u32 = 4;

/// The error of the picture at a number of samples, as the pilot saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PilotPoint {
    /// Samples a pixel.
    pub samples: u32,
    /// Relative error of the picture: see [`crate::accuracy`].
    pub relative_rmse: f64,
    /// Relative standard error of that, by the choice of pixels and by chance.
    pub uncertainty: f64,
    /// Seconds that the whole picture takes for so many samples, by the pilot's rate.
    pub seconds: f64,
}

/// A pilot under way.
pub struct Pilot<'a> {
    prepared: &'a Prepared,
    rect: PixelRect,
    pool: rayon::ThreadPool,
    /// Side of the blocks of which each gives one pixel a layer.
    block: u32,
    layers: u32,
    pixels: Vec<(u32, u32)>,
    /// Pixel by pixel, copy by copy, replicate by replicate.
    sums: Vec<XyzSum>,
    samples: u32,
    /// Paths traced, seconds spent on them.
    paths: u64,
    seconds: f64,
    points: Vec<PilotPoint>,
}

impl<'a> Pilot<'a> {
    /// A pilot for the pixels of `rect`, on so many threads (all cores if `None`), that has not traced anything yet.
    pub fn new(prepared: &'a Prepared, rect: PixelRect, threads: Option<usize>) -> Result<Self, ThreadError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
        let block = (rect.area() as f64 / FIRST_PIXELS as f64).sqrt().ceil() as u32;
        let mut pilot = Self {
            prepared,
            rect,
            pool,
            block: block.max(1),
            layers: 0,
            pixels: Vec::new(),
            sums: Vec::new(),
            samples: 0,
            paths: 0,
            seconds: 0.0,
            points: Vec::new(),
        };
        while pilot.pixels.is_empty() {
            pilot.add_layer();
        }
        Ok(pilot)
    }

    /// What was seen so far, by the number of samples.
    pub fn points(&self) -> &[PilotPoint] {
        &self.points
    }

    /// Seconds spent so far, by `clock`.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Fewest samples a pixel that give every replicate one.
    pub fn first_step(&self) -> u32 {
        self.replicates()
    }

    /// Goes on to `samples` a pixel, and takes more pixels where the error is not known well. `clock` tells seconds.
    pub fn advance(&mut self, samples: u32, clock: &(dyn Fn() -> f64 + Sync), on_work: &(dyn Fn(&Counters) + Sync)) {
        let start = clock();
        self.paths += self.trace(0, self.samples..samples, on_work);
        self.samples = samples;
        let mut error = self.error();
        let most = MOST_OF_PICTURE * self.rect.area() as f64;
        while samples >= BELIEVED_FROM
            && self.uncertainty(&error) > KNOWN_WELL
            && 2.0 * self.pixels.len() as f64 <= most
        {
            let first = self.pixels.len();
            // Twice the pixels: what they cost is bounded by what was spent already.
            for _ in 0..self.layers {
                self.add_layer();
            }
            self.paths += self.trace(first, 0..samples, on_work);
            error = self.error();
        }
        self.seconds += clock() - start;
        let copies = f64::from(self.copies());
        let rate = self.seconds / self.paths as f64;
        self.points.push(PilotPoint {
            samples,
            relative_rmse: error.relative_rmse().unwrap_or(f64::INFINITY) * copies.sqrt(),
            uncertainty: self.uncertainty(&error),
            seconds: rate * f64::from(samples) * self.rect.area() as f64,
        });
    }

    /// Relative standard error of the picture's error: the scatter of replicates, and what the pixels left out may hide.
    fn uncertainty(&self, error: &ErrorSum) -> f64 {
        let (chance, both) = (error.uncertainty().powi(2), error.uncertainty_of_choice().powi(2));
        let left_out = 1.0 - (self.pixels.len() as f64 / self.rect.area() as f64).min(1.0);
        (chance + (both - chance).max(0.0) * left_out).sqrt()
    }

    fn replicates(&self) -> u32 {
        self.prepared.scene.integrator.replicates
    }

    /// Independent copies of the picture's estimate, so that there are replicates enough.
    fn copies(&self) -> u32 {
        FEWEST_REPLICATES.div_ceil(self.replicates())
    }

    /// One pixel more of each block: every pixel of the picture is as likely as any other.
    fn add_layer(&mut self) {
        let (block, area) = (u64::from(self.block), u64::from(self.block) * u64::from(self.block));
        // Odd and near the golden section of the block; layers that meet a cell again only cost time.
        let stride = (area as f64 * 0.618) as u64 | 1;
        let rect = self.rect;
        for y0 in (rect.y0..rect.y1).step_by(self.block as usize) {
            for x0 in (rect.x0..rect.x1).step_by(self.block as usize) {
                let at = mix(mix(self.prepared.scene.integrator.seed) ^ (u64::from(y0) << 32 | u64::from(x0)));
                let cell = (at % area + stride * u64::from(self.layers)) % area;
                let (x, y) = (x0 + (cell % block) as u32, y0 + (cell / block) as u32);
                if x < rect.x1 && y < rect.y1 {
                    self.pixels.push((x, y));
                }
            }
        }
        self.layers += 1;
        let sums = self.pixels.len() * (self.copies() * self.replicates()) as usize;
        self.sums.resize(sums, XyzSum::default());
    }

    /// Traces the samples `samples` of the pixels from number `first` on; returns the number of paths.
    fn trace(&mut self, first: usize, samples: std::ops::Range<u32>, on_work: &(dyn Fn(&Counters) + Sync)) -> u64 {
        let (replicates, copies) = (self.replicates(), self.copies());
        let stride = (replicates * copies) as usize;
        let prepared = self.prepared;
        let kernel = prepared.kernel().render;
        // A whole number of point sets beyond every number of samples that a picture can have.
        let set = replicates * SOBOL_POINTS;
        let beyond = (i32::MAX as u32).div_ceil(set) * set;
        // Far enough apart for 2¹⁶ samples and more of each replicate.
        let copy_length = set * (u32::MAX.saturating_sub(beyond) / set / copies);
        self.pool.install(|| {
            self.pixels[first..]
                .par_iter()
                .zip(self.sums[first * stride..].par_chunks_exact_mut(stride))
                .with_min_len(16)
                .map(|(&(x, y), sums)| {
                    let pixel = PixelRect { x0: x, y0: y, x1: x + 1, y1: y + 1 };
                    let mut counters = Counters::default();
                    for (copy, sums) in sums.chunks_exact_mut(replicates as usize).enumerate() {
                        let start = beyond + copy as u32 * copy_length;
                        let range = start + samples.start..start + samples.end;
                        counters.merge(&kernel(prepared, pixel, range, sums, &mut []));
                    }
                    on_work(&counters);
                    counters.paths
                })
                .sum()
        })
    }

    fn error(&self) -> ErrorSum {
        let mut error = ErrorSum::default();
        for sums in self.sums.chunks_exact((self.replicates() * self.copies()) as usize) {
            error.push(Pixel::new(sums));
        }
        error
    }

    /// The price of a relative error, from what was seen so far.
    pub fn price(&self, relative_rmse: f64) -> Price {
        price(&self.points, relative_rmse, self.prepared.scene.integrator.sampler, self.first_step())
    }
}

/// What a relative error costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// The relative error.
    pub relative_rmse: f64,
    /// Samples a pixel, and their 95 % interval.
    pub samples: f64,
    /// See `samples`.
    pub samples_interval: [f64; 2],
    /// Seconds of rendering, and their interval.
    pub seconds: f64,
    /// See `seconds`.
    pub seconds_interval: [f64; 2],
}

/// Exponents of 1/n in the variance of n samples: independent numbers and all that stratification does not reach; edges of
/// two dimensions (Owen 1997); smooth functions of one.
const EXPONENTS: [f64; 3] = [1.0, 1.5, 3.0];

/// Two-sided 95 % of the normal distribution.
const Z_95: f64 = 1.959_963_984_540_054;

fn price(points: &[PilotPoint], target: f64, sampler: SamplerKind, fewest: u32) -> Price {
    let Some(last) = points.last() else {
        let unknown = [f64::from(fewest), f64::INFINITY];
        return Price {
            relative_rmse: target,
            samples: f64::NAN,
            samples_interval: unknown,
            seconds: f64::NAN,
            seconds_interval: [0.0, f64::INFINITY],
        };
    };
    let n = f64::from(last.samples);
    let second_per_sample = last.seconds / n;
    let fewest = f64::from(fewest);
    let mixture = Mixture::fit(points, sampler);
    let local = mixture.slope(n);
    let inverse = |target: f64| between(points, target).unwrap_or_else(|| mixture.samples_for(target)).max(fewest);
    // The error at the pilot's end is known to a share; beyond it, the slope may stay as steep as it is there, or the part
    // that stratification does not reach may be all that is left. Toward fewer samples there are points on both sides.
    let slack = (Z_95 * last.uncertainty).exp();
    let ratio = last.relative_rmse / target;
    let (low, high) = if ratio > 1.0 {
        (n * (ratio / slack).max(1.0).powf(1.0 / local), n * (ratio * slack).powi(2))
    } else {
        (inverse(target * slack), inverse(target / slack))
    };
    let samples = inverse(target);
    let interval = [low.min(samples).max(fewest), high.max(samples)];
    Price {
        relative_rmse: target,
        samples,
        samples_interval: interval,
        seconds: samples * second_per_sample,
        seconds_interval: interval.map(|samples| samples * second_per_sample),
    }
}

/// Where the error passed `target`, as a power of the number of samples between the two points about it; `None` if it is
/// smaller or larger than all of them.
pub(crate) fn between(points: &[PilotPoint], target: f64) -> Option<f64> {
    let after = points.iter().position(|point| point.relative_rmse <= target)?;
    let (before, after) = (points[after.checked_sub(1)?], points[after]);
    let log = |a: f64, b: f64| (a / b).ln();
    let share = log(before.relative_rmse, target) / log(before.relative_rmse, after.relative_rmse);
    let samples = f64::from(before.samples) * (share * log(f64::from(after.samples), f64::from(before.samples))).exp();
    // Not a number where there is no error left.
    Some(if samples.is_finite() { samples } else { f64::from(after.samples) })
}

/// V(n) = Σ aₖ n^−eₖ with aₖ ≥ 0: how the variance falls with the number of samples.
#[derive(Clone, Copy, Debug)]
struct Mixture([f64; 3]);

impl Mixture {
    /// The mixture that fits the squared errors best, each weighed by itself and the later ones more, exact at the last.
    fn fit(points: &[PilotPoint], sampler: SamplerKind) -> Self {
        let last = points[points.len() - 1];
        let of = |parts: &[(usize, f64)]| {
            let mut mixture = Self([0.0; 3]);
            parts.iter().for_each(|&(part, share)| {
                mixture.0[part] = share * f64::from(last.samples).powf(EXPONENTS[part]);
            });
            // In units of the last squared error, so that shares are of it.
            mixture.0 = mixture.0.map(|a| a * last.relative_rmse * last.relative_rmse);
            mixture
        };
        if sampler == SamplerKind::Independent || last.relative_rmse == 0.0 || !last.relative_rmse.is_finite() {
            return of(&[(0, 1.0)]);
        }
        let misfit = |mixture: &Self| -> f64 {
            points
                .iter()
                .filter(|point| point.relative_rmse > 0.0 && point.samples * 16 >= last.samples)
                .map(|point| {
                    let model = mixture.variance(f64::from(point.samples));
                    let log = (model / (point.relative_rmse * point.relative_rmse)).ln();
                    log * log
                })
                .sum()
        };
        // A search over a grid of shares is exact enough for a quote, and cannot leave the positive ones.
        const STEPS: usize = 40;
        let share = |step: usize| step as f64 / STEPS as f64;
        let grid = (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |j| (i, j)));
        grid.map(|(i, j)| of(&[(0, share(i)), (1, share(j)), (2, share(STEPS - i - j))]))
            .min_by(|a, b| misfit(a).total_cmp(&misfit(b)))
            .expect("the grid is not empty")
    }

    fn variance(&self, n: f64) -> f64 {
        self.0.iter().zip(EXPONENTS).map(|(a, e)| a * n.powf(-e)).sum()
    }

    /// −d ln E / d ln n.
    fn slope(&self, n: f64) -> f64 {
        let weighted: f64 = self.0.iter().zip(EXPONENTS).map(|(a, e)| 0.5 * e * a * n.powf(-e)).sum();
        let slope = weighted / self.variance(n);
        if slope.is_finite() { slope } else { 0.5 }
    }

    /// The number of samples for a relative error.
    fn samples_for(&self, target: f64) -> f64 {
        // The variance falls: bisection on the logarithm over every number of samples there can be.
        let (mut low, mut high) = (0.0_f64, 60.0_f64);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if self.variance(middle.exp()) > target * target { low = middle } else { high = middle }
        }
        high.exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(of: impl Fn(f64) -> f64) -> Vec<PilotPoint> {
        (2..=7)
            .map(|j| {
                let samples = 1_u32 << j;
                let n = f64::from(samples);
                PilotPoint { samples, relative_rmse: of(n).sqrt(), uncertainty: 0.01, seconds: 0.5 * n }
            })
            .collect()
    }

    #[test]
    fn prices_follow_the_law_of_the_variance() {
        // Both terms alike at n = 64: at E² = 2⁻¹⁴ the first alone would need 2¹⁴ samples.
        let law = |n: f64| 1.0 / n + 8.0 * n.powf(-1.5);
        let points = points(law);
        for n in [100.0, 1000.0, 10_000.0_f64] {
            let price = price(&points, law(n).sqrt(), SamplerKind::Sobol, 4);
            // The grid's step, 1/40 of the variance.
            assert!((price.samples / n - 1.0).abs() < 0.05, "{price:?} is not {n}");
            assert!(price.samples_interval[0] <= n && n <= price.samples_interval[1], "{price:?}");
            assert!((price.seconds - 0.5 * price.samples).abs() < 1e-9);
        }
        let price = price(&points, 0.01, SamplerKind::Independent, 4);
        assert!((price.samples / (128.0 * law(128.0) * 1e4) - 1.0).abs() < 1e-6, "{price:?}");
    }

    #[test]
    fn a_picture_without_noise_costs_the_fewest_samples() {
        let price = price(&points(|_| 0.0), 0.01, SamplerKind::Sobol, 4);
        assert_eq!((price.samples, price.samples_interval), (4.0, [4.0, 4.0]));
    }
}
