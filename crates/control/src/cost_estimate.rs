//! What a relative error of a picture costs, from what a pilot saw.

use etalon_scene::SamplerKind;

/// The error of the picture at a number of samples, as the pilot saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PilotPoint {
    /// Samples a pixel, in the mean over the picture.
    pub samples: u32,
    /// Relative error of the picture: see [`etalon_transport::accuracy`]. Infinite where it is unknown, since no light was found.
    pub relative_rmse: f64,
    /// Relative standard error of that, by the choice of pixels and by chance. Infinite where it is unknown.
    pub uncertainty: f64,
    /// Seconds that the whole picture takes for this many samples, by the pilot's rate.
    pub seconds: f64,
}

impl PilotPoint {
    /// Whether the error is known to be so small.
    pub fn reaches(&self, relative_rmse: f64) -> bool {
        self.relative_rmse <= relative_rmse && self.uncertainty.is_finite()
    }
}

/// What a relative error costs; not a number, with intervals that end at infinity, where no error is known yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostEstimate {
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

pub(crate) fn cost_estimate(points: &[PilotPoint], target: f64, sampler: SamplerKind, fewest: u32) -> CostEstimate {
    // What found no light knows no error.
    let known: Vec<PilotPoint> = points.iter().filter(|point| point.relative_rmse.is_finite()).copied().collect();
    let points = known.as_slice();
    let Some(last) = points.last() else {
        let unknown = [f64::from(fewest), f64::INFINITY];
        return CostEstimate {
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
    let law = Law::fit(points, sampler, fewest);
    let local = law.mixture.slope(n);
    let beyond = |target: f64| match last.relative_rmse > target {
        true => law.samples_beyond(n, last.relative_rmse, target),
        false => law.mixture.samples_for(target),
    };
    let inverse = |target: f64| between(points, target).unwrap_or_else(|| beyond(target)).max(fewest);
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
    CostEstimate {
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
    let after = points.iter().position(|point| point.reaches(target))?;
    let pair = |point: PilotPoint| (f64::from(point.samples), point.relative_rmse);
    Some(crossing(pair(points[after.checked_sub(1)?]), pair(points[after]), target))
}

/// The number of samples at which the error is `target`, as a power of it between two pairs of samples and error.
fn crossing(before: (f64, f64), after: (f64, f64), target: f64) -> f64 {
    let share = (before.1 / target).ln() / (before.1 / after.1).ln();
    let samples = before.0 * (share * (after.0 / before.0).ln()).exp();
    // Not a number where there is no error left, or none was known before.
    if samples.is_finite() && before.1 > target { samples } else { after.0 }
}

/// Steps of an octave of samples at which a law tells apart how the variance falls within it.
const STEPS_OF_OCTAVE: u32 = 4;

/// The step that follows this many rounds of replicates: 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20 … Every power of two is one.
pub fn next_step(rounds: u32) -> u32 {
    let width = 1 << rounds.max(1).ilog2().saturating_sub(STEPS_OF_OCTAVE.ilog2());
    (rounds / width).saturating_add(1).saturating_mul(width)
}

/// How the variance falls with the number of samples, from octave to octave and within them: Sobol points of which there is a whole power of
/// two are spread better than the law between two such numbers says of those between.
#[derive(Clone, Copy, Debug)]
struct Law {
    mixture: Mixture,
    /// Samples of one round of replicates.
    round: f64,
    /// Samples at which the mixture is exact.
    exact_at: f64,
    /// The variance over the mixture's, at each step of an octave, as last seen.
    excess: [f64; STEPS_OF_OCTAVE as usize],
}

impl Law {
    fn fit(points: &[PilotPoint], sampler: SamplerKind, round: f64) -> Self {
        let rounds = |point: &PilotPoint| f64::from(point.samples) / round;
        let whole = |point: &&PilotPoint| rounds(point).log2().fract() == 0.0;
        let octaves: Vec<PilotPoint> = points.iter().filter(whole).copied().collect();
        if sampler == SamplerKind::Independent || octaves.is_empty() {
            let mixture = Mixture::fit(points, sampler);
            let exact_at = points.last().map_or(round, |last| f64::from(last.samples));
            return Self { mixture, round, exact_at, excess: [1.0; STEPS_OF_OCTAVE as usize] };
        }
        let mixture = Mixture::fit(&octaves, sampler);
        let mut law = Self {
            mixture,
            round,
            exact_at: octaves.last().map_or(round, |last| f64::from(last.samples)),
            excess: [1.0; STEPS_OF_OCTAVE as usize],
        };
        for point in points {
            let (step, between) = law.step(f64::from(point.samples));
            let seen = point.relative_rmse.powi(2) / mixture.variance(f64::from(point.samples));
            if step > 0 && between == 0.0 && seen.is_finite() && seen > 0.0 {
                law.excess[step] = seen;
            }
        }
        law
    }

    /// The step of its octave that this many samples are at, and how far they are from it to the next.
    fn step(&self, samples: f64) -> (usize, f64) {
        let rounds = samples / self.round;
        let of_octave = (rounds / rounds.log2().floor().exp2() - 1.0) * f64::from(STEPS_OF_OCTAVE);
        (of_octave as usize % STEPS_OF_OCTAVE as usize, of_octave.fract())
    }

    /// The variance of a number of samples that is a step of its octave.
    fn variance(&self, samples: f64) -> f64 {
        // What powers of two gain vanishes where stratification does: where the variance falls as 1/n.
        let gains = |n: f64| (2.0 * self.mixture.slope(n) - 1.0).max(0.0);
        let (now, then) = (gains(samples), gains(self.exact_at));
        let left = if then > 0.0 { (now / then).min(1.0) } else { 0.0 };
        self.mixture.variance(samples) * self.excess[self.step(samples).0].powf(left)
    }

    /// The number of samples for a relative error that is smaller than that of this many.
    fn samples_beyond(&self, samples: f64, relative_rmse: f64, target: f64) -> f64 {
        let mut before = (samples, relative_rmse);
        let mut rounds = (samples / self.round).ceil() as u32;
        while rounds < u32::MAX {
            rounds = next_step(rounds);
            let samples = f64::from(rounds) * self.round;
            let after = (samples, self.variance(samples).sqrt());
            if after.1 <= target {
                return crossing(before, after, target);
            }
            before = after;
        }
        self.mixture.samples_for(target)
    }
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
            let cost_estimate = cost_estimate(&points, law(n).sqrt(), SamplerKind::Sobol, 4);
            // The grid's step, 1/40 of the variance.
            assert!((cost_estimate.samples / n - 1.0).abs() < 0.05, "{cost_estimate:?} is not {n}");
            assert!(
                cost_estimate.samples_interval[0] <= n && n <= cost_estimate.samples_interval[1],
                "{cost_estimate:?}"
            );
            assert!((cost_estimate.seconds - 0.5 * cost_estimate.samples).abs() < 1e-9);
        }
        let cost_estimate = cost_estimate(&points, 0.01, SamplerKind::Independent, 4);
        assert!((cost_estimate.samples / (128.0 * law(128.0) * 1e4) - 1.0).abs() < 1e-6, "{cost_estimate:?}");
    }

    #[test]
    fn steps_of_octaves_hold_each_power_of_two() {
        let steps: Vec<u32> = std::iter::successors(Some(1), |&step| Some(next_step(step))).take(14).collect();
        assert_eq!(steps, [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24]);
        assert_eq!([next_step(17), next_step(1030), next_step(u32::MAX)], [20, 1280, u32::MAX]);
    }

    #[test]
    fn prices_know_that_whole_powers_of_two_are_spread_better() {
        // Between powers of two the variance is up to 1.5 of the law's, as blocks of 1, 1/2, 1/4 … that know nothing of each other have it.
        let law = |n: f64| {
            let of_octave = n / n.log2().floor().exp2();
            n.powf(-1.5) * (1.0 + 2.0 * (of_octave - 1.0) * (2.0 - of_octave))
        };
        let steps = std::iter::successors(Some(1_u32), |&step| Some(next_step(step)));
        let seen: Vec<PilotPoint> = steps
            .map(|rounds| 4 * rounds)
            .take_while(|&samples| samples <= 448)
            .map(|samples| {
                let n = f64::from(samples);
                PilotPoint { samples, relative_rmse: law(n).sqrt(), uncertainty: 0.01, seconds: 0.5 * n }
            })
            .collect();
        // The first number with so small an error, found one by one: 4096 and others shortly before a power of two.
        for (target, at_least) in [(4096.0_f64.powf(-0.75), 4000.0), (5200.0_f64.powf(-0.75), 6000.0), (0.0035, 500.0)]
        {
            let first = (448..).map(f64::from).find(|&n| law(n).sqrt() <= target).unwrap();
            let cost_estimate = cost_estimate(&seen, target, SamplerKind::Sobol, 4);
            assert!(first >= at_least);
            assert!((cost_estimate.samples / first - 1.0).abs() < 0.08, "{cost_estimate:?} is not {first}");
        }
    }

    /// Independent numbers reach an error of 1/100 of E = 1/√n with 10,000. Pilots that saw E off by up to 1.96 standard errors, which are 95 of
    /// 100, have that in their interval, and no others.
    #[test]
    fn intervals_hold_ninety_five_pilots_of_a_hundred() {
        let uncertainty = 0.05;
        let holds = |standard_errors: f64| {
            let off = (2.0 * standard_errors * uncertainty).exp();
            let seen: Vec<PilotPoint> =
                points(|n| off / n).into_iter().map(|point| PilotPoint { uncertainty, ..point }).collect();
            let [low, high] = cost_estimate(&seen, 0.01, SamplerKind::Independent, 4).samples_interval;
            (low..=high).contains(&10_000.0)
        };
        assert!([-1.95, -1.5, 0.0, 1.5, 1.95].into_iter().all(holds));
        assert!(![-1.97, 1.97].into_iter().any(holds));
    }

    #[test]
    fn a_picture_without_noise_costs_the_fewest_samples() {
        let cost_estimate = cost_estimate(&points(|_| 0.0), 0.01, SamplerKind::Sobol, 4);
        assert_eq!((cost_estimate.samples, cost_estimate.samples_interval), (4.0, [4.0, 4.0]));
    }

    /// Points that found no light are none: with them the price is that of the others, and without any it is unknown.
    #[test]
    fn points_that_found_no_light_have_no_price() {
        let seen = points(|n| 1.0 / n);
        let dark = |points: &[PilotPoint]| -> Vec<PilotPoint> {
            let unknown =
                |point: &PilotPoint| PilotPoint { relative_rmse: f64::INFINITY, uncertainty: f64::INFINITY, ..*point };
            points.iter().map(unknown).collect()
        };
        let late = [dark(&seen[..3]), seen[3..].to_vec()].concat();
        assert_eq!(
            cost_estimate(&late, 0.01, SamplerKind::Sobol, 4),
            cost_estimate(&seen[3..], 0.01, SamplerKind::Sobol, 4)
        );
        assert_eq!(between(&late, seen[3].relative_rmse), Some(f64::from(seen[3].samples)));
        let cost_estimate = cost_estimate(&dark(&seen), 0.01, SamplerKind::Sobol, 4);
        assert!(cost_estimate.samples.is_nan() && cost_estimate.seconds.is_nan());
        assert_eq!(
            (cost_estimate.samples_interval, cost_estimate.seconds_interval[1]),
            ([4.0, f64::INFINITY], f64::INFINITY)
        );
        // Nor is an error reached that is not known to be.
        let lucky = PilotPoint { uncertainty: f64::INFINITY, ..seen[0] };
        assert!(seen[0].reaches(0.9) && !lucky.reaches(0.9) && !dark(&seen)[0].reaches(f64::INFINITY));
    }
}
