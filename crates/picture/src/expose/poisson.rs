//! Poisson numbers of any mean, with the same bits on every machine.
//!
//! Means below 10 are drawn by inversion: the probabilities of 0, 1, 2 … are taken away from a uniform number one after the other. Larger
//! means are drawn by transformed rejection (PTRS; Hörmann 1993, *The transformed rejection method for generating Poisson random variables*,
//! Insurance: Mathematics and Economics 12), which accepts a proposal with exactly the probability that the distribution asks for. Neither is
//! an approximation by a normal distribution. What is left are the 53 bits of a uniform number and the rounding of a probability.
//!
//! The probability of k is computed as in Loader 2000 (*Fast and Accurate Computation of Binomial Probabilities*). The error of Stirling's
//! formula and the deviance are computed by themselves, so that no large logarithms cancel. All of it is + − × ÷ √ and the exponential and
//! logarithm of `etalon_optics::exponential`.

use std::f64::consts::TAU;

use etalon_optics::{exp_neg, neg_ln};

use super::random::Stream;

/// Means from here on are drawn by rejection, for which Hörmann's constants hold.
const REJECTION_FROM: f64 = 10.0;

/// What is less probable than this is not drawn by inversion: a uniform number has 53 bits.
const LEAST_PROBABILITY: f64 = 1.0 / (1_u64 << 60) as f64;

/// A Poisson number of a mean from 0 to 2³¹.
pub(super) fn poisson(mean: f64, stream: &mut Stream) -> f64 {
    if mean < REJECTION_FROM { by_inversion(mean, stream) } else { by_rejection(mean, stream) }
}

fn by_inversion(mean: f64, stream: &mut Stream) -> f64 {
    let (mut k, mut probability, mut left) = (0.0, exp_neg(mean), stream.uniform());
    while left >= probability && (k < mean || probability > LEAST_PROBABILITY) {
        left -= probability;
        k += 1.0;
        probability *= mean / k;
    }
    k
}

fn by_rejection(mean: f64, stream: &mut Stream) -> f64 {
    let b = 0.931 + 2.53 * mean.sqrt();
    let a = -0.059 + 0.02483 * b;
    let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
    let squeeze = 0.9277 - 3.6224 / (b - 2.0);
    loop {
        let u = stream.uniform() - 0.5;
        let v = stream.uniform();
        let to_edge = 0.5 - u.abs();
        let k = ((2.0 * a / to_edge + b) * u + mean + 0.43).floor();
        if to_edge >= 0.07 && v <= squeeze {
            return k;
        }
        if k < 0.0 || to_edge < 0.013 && v > to_edge {
            continue;
        }
        if v * inverse_alpha / (a / (to_edge * to_edge) + b) <= probability_of(k, mean) {
            return k;
        }
    }
}

/// The probability of `k`, a whole number, under a mean of at least 10. Its relative error is below 1e-13.
fn probability_of(k: f64, mean: f64) -> f64 {
    // Stirling's series has its full accuracy from 10 on.
    if k < 10.0 {
        return (1..=k as u32).fold(exp_neg(mean), |probability, i| probability * mean / f64::from(i));
    }
    exp_neg(stirling_error(k) + deviance(k, mean)) / (TAU * k).sqrt()
}

/// ln k! − ln(√(2πk) kᵏ e⁻ᵏ) for k ≥ 10, to 2e-14.
fn stirling_error(k: f64) -> f64 {
    let q = 1.0 / (k * k);
    (1.0 / 12.0 - (1.0 / 360.0 - (1.0 / 1260.0 - (1.0 / 1680.0 - 1.0 / 1188.0 * q) * q) * q) * q) / k
}

/// k ln(k/m) + m − k, which is never negative.
fn deviance(k: f64, mean: f64) -> f64 {
    let difference = k - mean;
    let v = difference / (k + mean);
    if v.abs() < 0.1 {
        // k ln(k/m) = 2k artanh v = 2k(v + v³/3 + v⁵/5 + …), and 2kv − (k − m) = (k − m)v.
        let v2 = v * v;
        let series = (1..=10).rev().fold(0.0, |sum, j| (sum + 1.0 / f64::from(2 * j + 1)) * v2);
        return difference * v + 2.0 * k * v * series;
    }
    let logarithm = if k < mean { -neg_ln(k / mean) } else { neg_ln(mean / k) };
    k * logarithm + mean - k
}

#[cfg(test)]
mod tests {
    use super::super::random::{NoiseKind, PixelPlace};
    use super::*;
    use etalon_oracle::statistics::{Estimate, chi_square_verdict, z_verdict};

    /// ln k! as a sum of logarithms of the platform: another way than that of the sampler.
    fn ln_factorials(most: usize) -> Vec<f64> {
        let mut sums = vec![0.0; most + 1];
        (1..=most).for_each(|k| sums[k] = sums[k - 1] + (k as f64).ln());
        sums
    }

    fn draw(mean: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..count).map(move |i| {
            let place = PixelPlace { column: (i % 1024) as i32, row: (i / 1024) as i32, plane: 0 };
            poisson(mean, &mut Stream::new(11, place, 0, NoiseKind::Shot))
        })
    }

    #[test]
    fn probabilities_are_those_of_the_definition() {
        let ln_factorials = ln_factorials(20_000);
        for mean in [10.0, 37.3, 1000.0, 12_345.6] {
            for k in (0..20_000).step_by(7) {
                let want = k as f64 * f64::ln(mean) - mean - ln_factorials[k];
                let got = probability_of(k as f64, mean);
                // The sums of logarithms of the definition cancel to some 1e-11.
                assert!(want < -700.0 || (got.ln() - want).abs() < 1e-9, "{k} of {mean}: {} is not {want}", got.ln());
            }
        }
        // Both sides of a change of formula agree.
        for mean in [10.0, 22.0] {
            let ratio = probability_of(10.0, mean) / probability_of(9.0, mean) / (mean / 10.0);
            assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
        }
    }

    /// χ² against the distribution, at a significance of 1e-6 for each mean. 200,000 numbers each see a relative departure of the
    /// probabilities of some 2 % in root mean square.
    #[test]
    fn numbers_have_the_distribution_of_poisson() {
        let n = 200_000;
        for mean in [0.01, 0.7, 3.0, 9.99, 10.0, 12.5, 100.0, 3000.0] {
            let most = (mean + 12.0 * f64::sqrt(mean) + 12.0) as usize;
            let ln_factorials = ln_factorials(most);
            let mut observed = vec![0_u64; most + 1];
            draw(mean, n).for_each(|k| observed[k as usize] += 1);
            let expected: Vec<f64> =
                (0..=most).map(|k| f64::from(n) * (k as f64 * f64::ln(mean) - mean - ln_factorials[k]).exp()).collect();
            let verdict = chi_square_verdict("Poisson", &observed, &expected, 1e-6, &format!("mean {mean}"));
            assert!(verdict.pass, "{verdict:?}");
        }
    }

    /// Mean and variance of large means, at a significance of 1e-6 each. 100,000 numbers see a bias of the mean of 0.02 σ and of the variance
    /// of 3 %.
    #[test]
    fn large_means_have_their_mean_and_variance() {
        let n = 100_000;
        for mean in [1e5, 3.7e6, 2e9] {
            let (mut sum, mut squares) = (0.0, 0.0);
            for k in draw(mean, n) {
                let z = (k - mean) / f64::sqrt(mean);
                assert!(k == k.floor() && z.abs() < 9.0, "{k}");
                sum += z;
                squares += z * z;
            }
            let count = f64::from(n);
            // The fourth moment of z is 3 + 1/mean.
            for (got, truth, deviation) in [(sum / count, 0.0, 1.0_f64), (squares / count, 1.0, 2.0_f64.sqrt())] {
                let verdict = z_verdict("moments", &Estimate::new(got, deviation / count.sqrt()), truth, 0.0, 1e-6);
                assert!(verdict.pass, "mean {mean}: {verdict:?}");
            }
        }
    }

    #[test]
    fn no_light_raises_no_electrons_and_every_loop_ends() {
        assert!(draw(0.0, 1000).all(|k| k == 0.0));
        assert!(draw(9.999_999, 100_000).all(|k| k < 60.0));
        assert!(draw(f64::from(1_u32 << 31), 1000).all(|k| k > 2.1e9));
    }
}
