//! How much a test may cost and what it can see.

use super::tails::{normal_two_sided_quantile, normal_upper_tail_quantile};

/// Significance of a whole suite: the probability that a right subject fails any of its tests.
pub const SUITE_SIGNIFICANCE: f64 = 1e-6;

/// Power at which every resolvable bias is quoted: the probability that a bias of that size is caught.
pub const POWER: f64 = 0.999;

/// Significance of each of `tests` independent tests so that all together have `significance` (Šidák 1967); for dependent
/// tests it is still on the safe side of Bonferroni's bound to first order.
#[must_use]
pub fn sidak(significance: f64, tests: usize) -> f64 {
    // 1 − (1 − α)^(1/n) without cancellation.
    -((-significance).ln_1p() / tests.max(1) as f64).exp_m1()
}

/// One significance budget, shared evenly by the tests of a suite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    total: f64,
    tests: usize,
}

impl Budget {
    /// [`SUITE_SIGNIFICANCE`] over this many tests.
    #[must_use]
    pub const fn for_tests(tests: usize) -> Self {
        Self { total: SUITE_SIGNIFICANCE, tests }
    }

    /// Another total over this many tests.
    #[must_use]
    pub const fn new(total: f64, tests: usize) -> Self {
        Self { total, tests }
    }

    /// The significance of one test.
    #[must_use]
    pub fn each(&self) -> f64 {
        sidak(self.total, self.tests)
    }

    /// A budget for the parts that one of these tests consists of.
    #[must_use]
    pub fn split(&self, parts: usize) -> Self {
        Self { total: self.each(), tests: parts }
    }
}

/// Smallest bias of a mean that a two-sided z-test catches with probability [`POWER`]: (z_α + z_β)·standard error.
#[must_use]
pub fn resolvable_bias(standard_error: f64, significance: f64) -> f64 {
    (normal_two_sided_quantile(significance) + normal_upper_tail_quantile(1.0 - POWER)) * standard_error
}

/// Samples needed so that a two-sided z-test catches a bias with probability [`POWER`]:
/// N = ((z_α + z_β)·σ/δ)², rounded up.
#[must_use]
pub fn samples_needed(standard_deviation: f64, bias: f64, significance: f64) -> u64 {
    let root = resolvable_bias(standard_deviation, significance) / bias.abs();
    (root * root).ceil() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Uniform, Verdict, statistics::*};

    #[test]
    fn a_budget_is_spent_exactly() {
        let each = sidak(1e-6, 50);
        assert!((1.0 - (1.0 - each).powi(50) - 1e-6).abs() < 1e-13);
        assert!((each - 2.000_000_98e-8).abs() < 1e-15);
        assert_eq!(Budget::for_tests(1).each(), sidak(1e-6, 1));
        let nested = Budget::new(1e-6, 10).split(5);
        assert!((nested.each() / sidak(1e-6, 50) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn samples_follow_from_the_bias_to_be_seen() {
        // z_α = 4.8916 at 1e-6, z_β = 3.0902 at power .999: (7.9819·1/1e-2)² = 637 100.
        let needed = samples_needed(1.0, 1e-2, 1e-6);
        assert!((637_000..637_300).contains(&needed), "{needed}");
    }

    #[test]
    fn the_stated_power_is_the_real_one() {
        // 2000 z-tests of uniform means with exactly the resolvable bias at significance .01: .1 % ± .07 % may miss it.
        let (n, significance) = (200_u32, 0.01);
        let standard_error = (1.0 / 12.0 / f64::from(n)).sqrt();
        let bias = resolvable_bias(standard_error, significance);
        let mut numbers = Uniform::new(11);
        let mut missed = 0;
        let mut false_alarms = 0;
        for _ in 0..2000 {
            let sample: Welford = (0..n).map(|_| numbers.number()).collect();
            let estimate = Estimate::new(sample.mean(), standard_error);
            let judge = |truth: f64| -> Verdict { z_verdict("", &estimate, truth, 0.0, significance) };
            missed += u32::from(judge(0.5 + bias).pass);
            false_alarms += u32::from(!judge(0.5).pass);
        }
        // Binomial with means 2 and 20: the bounds are five standard deviations out.
        assert!(missed <= 9, "missed {missed}");
        assert!((1..=42).contains(&false_alarms), "false alarms {false_alarms}");
    }
}
