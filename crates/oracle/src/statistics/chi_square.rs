//! χ² goodness of fit with pooled cells, whose expectations may be known only within bounds.

use super::{
    POWER,
    tails::{chi_square_upper_tail, chi_square_upper_tail_quantile, normal_upper_tail_quantile},
};
use crate::Verdict;

/// Fewest samples expected in a cell for its χ² term to be trusted (Cochran 1954).
const FEWEST_EXPECTED: f64 = 5.0;

/// What a cell is expected to hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Count.
    pub count: f64,
    /// How far from it the true expectation may be; 0 where it is exact.
    pub error: f64,
}

impl From<f64> for Expected {
    /// An exact expectation.
    fn from(count: f64) -> Self {
        Self { count, error: 0.0 }
    }
}

/// Result of a χ² goodness-of-fit test.
#[derive(Clone, Debug, PartialEq)]
pub struct ChiSquare {
    /// Σ (observed − expected)²/expected over the pooled cells, the least that expectations within their errors allow;
    /// infinite when something fell where nothing may.
    pub statistic: f64,
    /// √(Σ error²/expected/N): the relative departure of the cell probabilities, in root mean square, that the errors of the
    /// expectations may hide.
    pub hidden: f64,
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
/// Where an expectation is known within an error only, each cell is given the benefit of it: the statistic is the least that
/// any expectations within their errors have, so that the test of a right subject stays as significant as it says; what that may
/// hide is [`ChiSquare::hidden`].
///
/// Cells that expect fewer than five are pooled with one another, smallest first. A sample in a cell that expects exactly
/// zero is a contradiction: the statistic is infinite and p is 0. Expected counts are *not* rescaled to the observed total:
/// a density that does not integrate to 1 is itself an error to be found.
///
/// # Panics
/// When the two slices differ in length.
#[must_use]
pub fn chi_square<E: Copy + Into<Expected>>(observed: &[u64], expected: &[E]) -> ChiSquare {
    assert_eq!(observed.len(), expected.len(), "one expectation a cell");
    let expected: Vec<Expected> = expected.iter().map(|&cell| cell.into()).collect();
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|&a, &b| expected[a].count.total_cmp(&expected[b].count));
    let mut pools = Pools::default();
    let (mut count, mut pool) = (0_u64, Expected::from(0.0));
    for (place, &index) in order.iter().enumerate() {
        let cell = expected[index];
        if cell.count.is_nan() || cell.error.is_nan() {
            pools.close(index, observed[index], f64::NAN.into());
            continue;
        }
        if cell.count <= 0.0 && cell.error <= 0.0 {
            if observed[index] > 0 {
                pools.close(index, observed[index], 0.0.into());
            }
            continue;
        }
        count += observed[index];
        pool = Expected { count: pool.count + cell.count.max(0.0), error: pool.error + cell.error };
        let last = place + 1 == order.len();
        if pool.count >= FEWEST_EXPECTED || last {
            pools.close(index, count, pool);
            (count, pool) = (0, 0.0.into());
        }
    }
    pools.result(observed.iter().sum())
}

/// Terms of the statistic, pool by pool.
#[derive(Default)]
struct Pools {
    statistic: f64,
    hidden: f64,
    closed: usize,
    worst: Option<(f64, (usize, u64, f64))>,
}

impl Pools {
    /// Adds the term of a pool, named by the last of its cells.
    fn close(&mut self, index: usize, observed: u64, expected: Expected) {
        let count = observed as f64;
        // (o − e)²/e has its only minimum at e = o, so the least is at the possible expectation nearest to it. A NaN stays.
        let (least, most) = ((expected.count - expected.error).max(0.0), expected.count + expected.error);
        let nearest = if count < least {
            least
        } else if count > most {
            most
        } else {
            expected.count + (count - expected.count)
        };
        let term = if nearest == count { 0.0 } else { (count - nearest).powi(2) / nearest };
        self.statistic += term;
        if expected.error > 0.0 {
            self.hidden += expected.error * expected.error / expected.count;
        }
        self.closed += 1;
        if self.worst.is_none_or(|(held, _)| term > held) {
            self.worst = Some((term, (index, observed, expected.count)));
        }
    }

    fn result(self, samples: u64) -> ChiSquare {
        let degrees_of_freedom = self.closed.saturating_sub(1) as f64;
        ChiSquare {
            statistic: self.statistic,
            hidden: (self.hidden / samples.max(1) as f64).sqrt(),
            degrees_of_freedom,
            p: if self.statistic.is_nan() {
                f64::NAN
            } else if self.statistic.is_infinite() {
                0.0
            } else if self.closed < 2 {
                1.0
            } else {
                chi_square_upper_tail(self.statistic, degrees_of_freedom)
            },
            pooled_cells: self.closed,
            worst_cell: self.worst.map_or((0, 0, 0.0), |(_, cell)| cell),
        }
    }
}

/// The χ² test as a verdict. The resolvable bias is Cohen's effect size w = √Σ(q − p)²/p, the relative departure of the
/// cell probabilities q from the expected p in root mean square: what chance hides and what the errors of the expectations may
/// hide, added up. A test that loses more by the latter than by chance does not pass.
pub fn chi_square_verdict<E: Copy + Into<Expected>>(
    law: impl Into<String>,
    observed: &[u64],
    expected: &[E],
    significance: f64,
    context: &str,
) -> Verdict {
    let test = chi_square(observed, expected);
    let samples: u64 = observed.iter().sum();
    let chance = (noncentrality_needed(test.degrees_of_freedom, significance) / samples.max(1) as f64).sqrt();
    let seen = chance + test.hidden;
    let (cell, count, expectation) = test.worst_cell;
    let evidence = format!(
        "{context}: χ² of {samples} samples in {} cells; worst cell {cell} holds {count} where {expectation:.1} are \
         expected; a root-mean-square relative departure of {seen:.2e} would be seen with power {POWER}, {:.1e} of it hidden by \
         what the expectations are not known to",
        test.pooled_cells, test.hidden
    );
    let verdict = Verdict::tested(law, test.statistic, test.p, significance, seen, evidence);
    if verdict.pass && test.hidden > chance {
        return verdict.without_power("the cells' expectations are not known well enough");
    }
    verdict
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
    fn an_expectation_known_within_bounds_gives_its_cell_the_benefit_of_them() {
        let about = |count, error| Expected { count, error };
        // 130 of 100 ± 10: what is left is (130 − 110)²/110; 60: (60 − 90)²/90; within the bounds: nothing.
        let test = chi_square(&[130, 60, 95], &[about(100.0, 10.0), about(100.0, 10.0), about(100.0, 10.0)]);
        assert!((test.statistic - (400.0 / 110.0 + 900.0 / 90.0)).abs() < 1e-12);
        assert!((test.hidden - (3.0_f64 / 285.0).sqrt()).abs() < 1e-12);
        // An unknown expectation is no contradiction, but what exceeds it is.
        assert_eq!(chi_square(&[100, 1], &[about(100.0, 0.0), about(0.0, 2.0)]).statistic, 0.0);
        let pooled = chi_square(&[100, 12], &[about(100.0, 0.0), about(0.0, 2.0)]);
        assert!(pooled.pooled_cells == 1 && (pooled.statistic - 100.0 / 102.0).abs() < 1e-12);
        // What is known too badly to be tested does not pass.
        assert!(!chi_square_verdict("", &[100, 100], &[about(100.0, 90.0); 2], 1e-6, "").pass);
        assert!(chi_square_verdict("", &[100, 100], &[about(100.0, 1.0); 2], 1e-6, "").pass);
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
