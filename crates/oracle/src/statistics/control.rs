//! Control variates: noise that is shared with something whose mean is known.

use super::{Estimate, Welford};

/// The mean of the first of each pair, with what it shares with the second taken off: the second's mean is known.
///
/// The regression of the first on the second, read where the second has its known mean (Lavenberg & Welch 1981): for jointly
/// normal pairs it is unbiased, and its error, s²(1/n + (x̄ − μ)²/Σ(xᵢ − x̄)²), has n − 2 degrees of freedom. A second that
/// shares nothing costs one of them; one that does not vary is left alone.
#[must_use]
pub fn with_control(pairs: &[(f64, f64)], known_mean: f64) -> Estimate {
    let values: Welford = pairs.iter().map(|pair| pair.0).collect();
    let controls: Welford = pairs.iter().map(|pair| pair.1).collect();
    let n = pairs.len() as f64;
    let spread: f64 = pairs.iter().map(|(_, x)| (x - controls.mean()).powi(2)).sum();
    if pairs.len() < 3 || spread == 0.0 {
        return values.estimate();
    }
    let shared: f64 = pairs.iter().map(|(y, x)| (x - controls.mean()) * (y - values.mean())).sum();
    let (slope, off) = (shared / spread, controls.mean() - known_mean);
    let residual: f64 =
        pairs.iter().map(|(y, x)| (y - values.mean() - slope * (x - controls.mean())).powi(2)).sum::<f64>() / (n - 2.0);
    Estimate {
        mean: values.mean() - slope * off,
        standard_error: (residual * (1.0 / n + off * off / spread)).sqrt(),
        degrees_of_freedom: Some(n - 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Uniform,
        statistics::{student_two_sided_tail, uniformity},
    };

    /// A normal number by the sum of twelve uniform ones, near enough for moments.
    fn normal(numbers: &mut Uniform) -> f64 {
        (0..12).map(|_| numbers.number()).sum::<f64>() - 6.0
    }

    #[test]
    fn what_is_shared_goes_and_the_p_values_stay_uniform() {
        let mut numbers = Uniform::new(5);
        for (shared, gain) in [(0.0, 1.0), (3.0, 3.0), (-10.0, 9.0)] {
            let (mut p_values, mut spread, mut plain) = (Vec::new(), Welford::new(), Welford::new());
            for _ in 0..1000 {
                let pairs: Vec<(f64, f64)> = (0..16)
                    .map(|_| {
                        let x = normal(&mut numbers);
                        (7.0 + shared * x + normal(&mut numbers), 2.0 + x)
                    })
                    .collect();
                let estimate = with_control(&pairs, 2.0);
                let t = (estimate.mean - 7.0) / estimate.standard_error;
                p_values.push(student_two_sided_tail(t, 14.0));
                spread.push(estimate.mean);
                plain.push(pairs.iter().map(|pair| pair.0).sum::<f64>() / 16.0);
            }
            // One chance in ten thousand for each of three: wrong degrees of freedom or a forgotten term fail by far.
            assert!(uniformity(&p_values).1 > 1e-4, "{shared}: {:?}", uniformity(&p_values));
            let gained = (plain.variance() / spread.variance()).sqrt();
            assert!(gained > 0.85 * gain, "{shared}: {gained}");
        }
    }

    #[test]
    fn a_control_of_another_mean_moves_the_estimate_and_one_that_does_not_vary_is_left_alone() {
        let pairs: Vec<(f64, f64)> = (0..10).map(|i| (2.0 * f64::from(i) + 1.0, f64::from(i))).collect();
        // On a line without noise the value where the control is 4 is 9.
        let estimate = with_control(&pairs, 4.0);
        assert!((estimate.mean - 9.0).abs() < 1e-13 && estimate.standard_error < 1e-13);
        let still: Vec<(f64, f64)> = pairs.iter().map(|(y, _)| (*y, 1.0)).collect();
        let plain: Welford = pairs.iter().map(|pair| pair.0).collect();
        assert_eq!(with_control(&still, 0.0), plain.estimate());
        assert!(with_control(&[(f64::NAN, 0.0), (1.0, 1.0), (1.0, 2.0)], 0.0).mean.is_nan());
    }
}
