//! χ² goodness of fit with pooled cells.

use super::{
    POWER,
    tails::{chi_square_upper_tail, chi_square_upper_tail_quantile, normal_upper_tail_quantile},
};
use crate::Verdict;

/// Fewest samples expected in a cell for its χ² term to be trusted (Cochran 1954).
const FEWEST_EXPECTED: f64 = 5.0;

/// Result of a χ² goodness-of-fit test.
#[derive(Clone, Debug, PartialEq)]
pub struct ChiSquare {
    /// Σ (observed − expected)²/expected over the pooled cells; infinite when something fell where nothing may.
    pub statistic: f64,
    /// Pooled cells less one.
    pub degrees_of_freedom: f64,
    /// P(χ² at least this large) under the expectation.
    pub p: f64,
    /// Cells left after pooling.
    pub pooled_cells: usize,
    /// The cell with the largest single term: its index and observed and expected counts.
    pub worst_cell: (usize, u64, f64),
}

/// Pearson's χ² of counts against expected counts.
///
/// Cells that expect fewer than five are pooled with one another, smallest first. A sample in a cell that expects exactly
/// zero is a contradiction: the statistic is infinite and p is 0. Expected counts are *not* rescaled to the observed total:
/// a density that does not integrate to 1 is itself an error to be found.
///
/// # Panics
/// When the two slices differ in length.
#[must_use]
pub fn chi_square(observed: &[u64], expected: &[f64]) -> ChiSquare {
    assert_eq!(observed.len(), expected.len(), "one expectation a cell");
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|&a, &b| expected[a].total_cmp(&expected[b]));
    let mut result =
        ChiSquare { statistic: 0.0, degrees_of_freedom: 0.0, p: f64::NAN, pooled_cells: 0, worst_cell: (0, 0, 0.0) };
    let mut worst_term = -1.0;
    let (mut pooled_observed, mut pooled_expected) = (0_u64, 0.0_f64);
    let mut close = |index: usize, count: u64, expectation: f64| {
        let term = (count as f64 - expectation).powi(2) / expectation;
        result.statistic += term;
        result.pooled_cells += 1;
        if term > worst_term {
            worst_term = term;
            result.worst_cell = (index, count, expectation);
        }
    };
    for (place, &index) in order.iter().enumerate() {
        if expected[index].is_nan() {
            close(index, observed[index], f64::NAN);
            continue;
        }
        if expected[index] <= 0.0 {
            if observed[index] > 0 {
                close(index, observed[index], 0.0);
            }
            continue;
        }
        pooled_observed += observed[index];
        pooled_expected += expected[index];
        let last = place + 1 == order.len();
        if pooled_expected >= FEWEST_EXPECTED || (last && pooled_expected > 0.0) {
            close(index, pooled_observed, pooled_expected);
            (pooled_observed, pooled_expected) = (0, 0.0);
        }
    }
    result.degrees_of_freedom = result.pooled_cells.saturating_sub(1) as f64;
    result.p = if result.statistic.is_nan() {
        f64::NAN
    } else if result.statistic.is_infinite() {
        0.0
    } else if result.pooled_cells < 2 {
        1.0
    } else {
        chi_square_upper_tail(result.statistic, result.degrees_of_freedom)
    };
    result
}

/// The χ² test as a verdict. The resolvable bias is Cohen's effect size w = √Σ(q − p)²/p, the relative departure of the
/// cell probabilities q from the expected p in root mean square.
pub fn chi_square_verdict(
    law: impl Into<String>,
    observed: &[u64],
    expected: &[f64],
    significance: f64,
    context: &str,
) -> Verdict {
    let test = chi_square(observed, expected);
    let samples: u64 = observed.iter().sum();
    let seen = (noncentrality_needed(test.degrees_of_freedom, significance) / samples.max(1) as f64).sqrt();
    let (cell, count, expectation) = test.worst_cell;
    let evidence = format!(
        "{context}: χ² of {samples} samples in {} cells; worst cell {cell} holds {count} where {expectation:.1} are \
         expected; a root-mean-square relative departure of {seen:.2e} would be seen with power {POWER}",
        test.pooled_cells
    );
    Verdict::tested(law, test.statistic, test.p, significance, seen, evidence)
}

/// Noncentrality λ at which the test has [`POWER`], from the normal approximation of the noncentral χ²
/// (mean k + λ, variance 2(k + 2λ)).
fn noncentrality_needed(degrees_of_freedom: f64, significance: f64) -> f64 {
    let freedom = degrees_of_freedom.max(1.0);
    let critical = chi_square_upper_tail_quantile(significance, freedom);
    let z = normal_upper_tail_quantile(1.0 - POWER);
    let misses = |lambda: f64| freedom + lambda - critical < z * (2.0 * (freedom + 2.0 * lambda)).sqrt();
    let (mut low, mut high) = (0.0, 1e9);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if misses(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Uniform;

    #[test]
    fn mendels_peas_have_their_textbook_value() {
        // 315, 108, 101, 32 against 9 : 3 : 3 : 1 of 556; χ² = .470 with 3 degrees of freedom.
        let expected = [9.0, 3.0, 3.0, 1.0].map(|share| 556.0 * share / 16.0);
        let test = chi_square(&[315, 108, 101, 32], &expected);
        assert!((test.statistic - 0.470_024).abs() < 1e-6);
        assert!((test.p - 0.925_4).abs() < 1e-4);
    }

    #[test]
    fn small_cells_are_pooled_and_impossible_ones_are_fatal() {
        let test = chi_square(&[1, 0, 2, 3, 94], &[1.0, 1.0, 1.0, 3.0, 94.0]);
        assert_eq!(test.pooled_cells, 2);
        assert_eq!(chi_square(&[100, 1], &[100.0, 0.0]).p, 0.0);
        assert_eq!(chi_square(&[100, 0], &[100.0, 0.0]).p, 1.0);
        assert!(chi_square(&[100, 1], &[100.0, f64::NAN]).p.is_nan());
    }

    #[test]
    fn an_expectation_that_does_not_sum_to_the_total_is_caught() {
        let observed = [10_000_u64; 10];
        assert!(!chi_square_verdict("", &observed, &[10_300.0; 10], 1e-6, "").pass);
        assert!(chi_square_verdict("", &observed, &[10_000.0; 10], 1e-6, "").pass);
    }

    #[test]
    fn the_stated_power_is_the_real_one() {
        // 20 cells, half of them raised and half lowered by the resolvable effect: at most a few of 300 runs may miss it.
        let (cells, samples, significance) = (20_u32, 4000_u32, 1e-3);
        let expected = vec![f64::from(samples) / f64::from(cells); cells as usize];
        let effect = chi_square_verdict("", &[200; 20], &expected, significance, "").resolvable_bias;
        let mut numbers = Uniform::new(3);
        let mut missed = 0;
        for _ in 0..300 {
            let mut observed = vec![0_u64; cells as usize];
            for _ in 0..samples {
                let raised = numbers.number() < 0.5 * (1.0 + effect);
                let slot = (numbers.number() * f64::from(cells / 2)) as usize;
                observed[2 * slot + usize::from(raised)] += 1;
            }
            missed += u32::from(chi_square_verdict("", &observed, &expected, significance, "").pass);
        }
        assert!(missed <= 4, "missed {missed} of 300");
    }
}
