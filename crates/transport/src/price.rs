//! What a relative error of a picture costs, from what a pilot saw.

use crate::pilot::PilotPoint;
use etalon_scene::SamplerKind;

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

pub(crate) fn price(points: &[PilotPoint], target: f64, sampler: SamplerKind, fewest: u32) -> Price {
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
