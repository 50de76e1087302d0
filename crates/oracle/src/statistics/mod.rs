//! Tests that state what they could have seen.
//!
//! A suite spends one significance budget ([`Budget`]): the probability that a right subject fails anything at all. Every
//! test reports the smallest bias it would have caught with probability [`POWER`].

mod chi_square;
mod estimate;
mod power;
mod tails;
mod welch;

pub use chi_square::{ChiSquare, Expected, chi_square, chi_square_verdict};
pub use estimate::{Estimate, Welford};
pub use power::{Budget, POWER, SUITE_SIGNIFICANCE, resolvable_bias, samples_needed, sidak};
pub use tails::{
    binomial_upper_tail, chi_square_upper_tail, chi_square_upper_tail_quantile, kolmogorov_upper_tail,
    normal_two_sided_quantile, normal_two_sided_tail, normal_upper_tail, normal_upper_tail_quantile,
    poisson_mean_bound, student_two_sided_quantile, student_two_sided_tail,
};
pub use welch::{WelchT, tiles_agree, uniformity, welch_t};

use crate::Verdict;

/// The z-test: an estimate against an exact value, two-sided, with an allowance for what is not noise.
///
/// `tolerance` is an absolute bound on deterministic error that the caller accepts and can justify (rounding to f32, a
/// finite stand-in for an infinite plane); 0 for none. The statistic is z of what exceeds it. An estimate with few degrees
/// of freedom is judged by Student's t instead of the normal distribution.
pub fn z_verdict(
    law: impl Into<String>,
    estimate: &Estimate,
    truth: f64,
    tolerance: f64,
    significance: f64,
) -> Verdict {
    let deviation = estimate.mean - truth;
    let excess = (deviation.abs() - tolerance).max(0.0);
    let z = if excess == 0.0 { 0.0 } else { excess.copysign(deviation) / estimate.standard_error };
    let p = match estimate.degrees_of_freedom {
        // Neither NaN nor a negative standard error may read as agreement.
        _ if !deviation.is_finite() || estimate.standard_error.is_nan() || estimate.standard_error < 0.0 => f64::NAN,
        Some(freedom) => student_two_sided_tail(z, freedom),
        None => normal_two_sided_tail(z),
    };
    let seen = tolerance
        + match estimate.degrees_of_freedom {
            Some(freedom) => {
                let tails = [
                    student_two_sided_quantile(significance, freedom),
                    student_two_sided_quantile(2.0 * (1.0 - POWER), freedom),
                ];
                (tails[0] + tails[1]) * estimate.standard_error
            }
            None => resolvable_bias(estimate.standard_error, significance),
        };
    let evidence = format!(
        "measured {:.10} ± {:.2e}, truth {truth:.10}, difference {deviation:+.3e} (allowance {tolerance:.1e}); a bias of \
         {seen:.2e} would be seen with power {POWER}",
        estimate.mean, estimate.standard_error,
    );
    Verdict::tested(law, z, p, significance, seen, evidence)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn z_has_the_textbook_value() {
        let estimate = Estimate::new(1.02, 0.01);
        let verdict = z_verdict("x", &estimate, 1.0, 0.0, 1e-6);
        assert!((verdict.statistic - 2.0).abs() < 1e-12);
        assert!((verdict.p.unwrap() - 0.045_500_263_896_358_4).abs() < 1e-11);
        assert!(verdict.pass);
        assert!(!z_verdict("x", &estimate, 1.1, 0.0, 1e-6).pass);
    }

    #[test]
    fn few_degrees_of_freedom_see_less() {
        let many = Estimate::new(1.0, 0.01);
        let few = Estimate { degrees_of_freedom: Some(15.0), ..many };
        let seen = |estimate: &Estimate| z_verdict("x", estimate, 1.0, 0.0, 1e-8).resolvable_bias;
        assert!(seen(&few) > 1.5 * seen(&many));
        assert!((seen(&Estimate { degrees_of_freedom: Some(1e6), ..many }) / seen(&many) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_noise_free_estimate_is_held_to_the_allowance_alone() {
        let exact = Estimate::new(1.000_000_1, 0.0);
        assert!(z_verdict("x", &exact, 1.0, 1e-6, 1e-6).pass);
        assert!(!z_verdict("x", &exact, 1.0, 1e-8, 1e-6).pass);
        assert!(z_verdict("x", &Estimate::new(1.0, 0.0), 1.0, 0.0, 1e-6).pass);
    }

    #[test]
    fn not_a_number_never_agrees() {
        for (mean, error) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (1.0, -1.0)] {
            assert!(!z_verdict("x", &Estimate::new(mean, error), 1.0, 1.0, 1e-6).pass);
        }
    }
}
