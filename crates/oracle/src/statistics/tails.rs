//! Tail probabilities and their inverses, accurate far out where a suite's budget puts its thresholds.

use statrs::function::{beta::beta_reg, erf::erfc, gamma::gamma_ur};

/// P(Z > z) of the standard normal distribution.
#[must_use]
pub fn normal_upper_tail(z: f64) -> f64 {
    0.5 * erfc(z / std::f64::consts::SQRT_2)
}

/// P(|Z| > |z|) of the standard normal distribution.
#[must_use]
pub fn normal_two_sided_tail(z: f64) -> f64 {
    erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// The z with P(Z > z) = `p`, for p in (0, 1).
#[must_use]
pub fn normal_upper_tail_quantile(p: f64) -> f64 {
    invert_falling(normal_upper_tail, p, -40.0, 40.0)
}

/// The z ≥ 0 with P(|Z| > z) = `p`, for p in (0, 1).
#[must_use]
pub fn normal_two_sided_quantile(p: f64) -> f64 {
    normal_upper_tail_quantile(0.5 * p)
}

/// P(|T| > |t|) of Student's distribution with (not necessarily whole) degrees of freedom; NaN without any.
#[must_use]
pub fn student_two_sided_tail(t: f64, degrees_of_freedom: f64) -> f64 {
    if t.is_nan() || degrees_of_freedom.is_nan() || degrees_of_freedom <= 0.0 {
        return f64::NAN;
    }
    if degrees_of_freedom > 1e7 {
        // The normal limit: closer than 1e-6 relative at |t| = 6, and past what the beta function resolves.
        return normal_two_sided_tail(t);
    }
    let x = degrees_of_freedom / (degrees_of_freedom + t * t);
    beta_reg(0.5 * degrees_of_freedom, 0.5, x)
}

/// The t ≥ 0 with P(|T| > t) = `p` of Student's distribution, for p in (0, 1).
#[must_use]
pub fn student_two_sided_quantile(p: f64, degrees_of_freedom: f64) -> f64 {
    // Heavy tails: at one degree of freedom p = 1e-12 lies at 6e11.
    invert_falling(|log_t| student_two_sided_tail(log_t.exp(), degrees_of_freedom), p, -40.0, 40.0).exp()
}

/// P(X > x) of the χ² distribution.
#[must_use]
pub fn chi_square_upper_tail(x: f64, degrees_of_freedom: f64) -> f64 {
    if x <= 0.0 { 1.0 } else { gamma_ur(0.5 * degrees_of_freedom, 0.5 * x) }
}

/// The x with P(X > x) = `p` of the χ² distribution, for p in (0, 1).
#[must_use]
pub fn chi_square_upper_tail_quantile(p: f64, degrees_of_freedom: f64) -> f64 {
    let far = degrees_of_freedom + 60.0 * degrees_of_freedom.sqrt() + 3000.0;
    invert_falling(|x| chi_square_upper_tail(x, degrees_of_freedom), p, 0.0, far)
}

/// P(N ≥ `count`) of the number N of `trials` that succeed, each with `probability` in [0, 1].
#[must_use]
pub fn binomial_upper_tail(count: u64, trials: u64, probability: f64) -> f64 {
    if count == 0 {
        return 1.0;
    }
    if count > trials || probability <= 0.0 {
        return 0.0;
    }
    if probability >= 1.0 {
        return 1.0;
    }
    beta_reg(count as f64, (trials - count + 1) as f64, probability)
}

/// The mean of a Poisson distribution by which as few as `count` come with this probability, in (0, 1): whoever has counted so few can
/// exclude what is more frequent.
#[must_use]
pub fn poisson_mean_bound(count: u64, significance: f64) -> f64 {
    // P(N ≤ n | μ) = P(χ² > 2μ) with 2n + 2 degrees of freedom.
    0.5 * chi_square_upper_tail_quantile(significance, 2.0 * (count as f64 + 1.0))
}

/// P(D > d) of the one-sample Kolmogorov–Smirnov statistic of n values, by the asymptotic series with Stephens' (1970)
/// correction for finite n.
#[must_use]
pub fn kolmogorov_upper_tail(d: f64, n: usize) -> f64 {
    let root = (n as f64).sqrt();
    let x = (root + 0.12 + 0.11 / root) * d;
    if x < 0.2 {
        // Below this the tail is 1 to 1e-12 and the alternating series converges slowly.
        return 1.0;
    }
    let term = |k: i32| {
        let sign = if k % 2 == 1 { 1.0 } else { -1.0 };
        sign * (-2.0 * f64::from(k * k) * x * x).exp()
    };
    (2.0 * (1..=100).map(term).sum::<f64>()).clamp(0.0, 1.0)
}

/// Bisection on the logarithm of a falling tail: robust where Newton would leave the bracket.
fn invert_falling(tail: impl Fn(f64) -> f64, p: f64, mut low: f64, mut high: f64) -> f64 {
    if !(p > 0.0 && p < 1.0) {
        return f64::NAN;
    }
    loop {
        let middle = 0.5 * (low + high);
        let lies_between = low < middle && middle < high;
        if !lies_between {
            return middle;
        }
        if tail(middle) > p {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, relative: f64) {
        assert!((a - b).abs() <= relative * b.abs(), "{a} is not {b}");
    }

    #[test]
    fn tails_have_their_tabulated_values() {
        // The error function beneath is good to about 1e-10 relative. Values: Abramowitz & Stegun, tables 26.1, 26.7, 26.10 and closed forms.
        close(normal_upper_tail(1.959_963_984_540_054), 0.025, 1e-10);
        close(normal_upper_tail(6.0), 9.865_876_450_376_98e-10, 1e-10);
        close(chi_square_upper_tail(7.0, 2.0), (-3.5_f64).exp(), 1e-12);
        close(chi_square_upper_tail(9.0, 4.0), (1.0 + 4.5) * (-4.5_f64).exp(), 1e-12);
        close(chi_square_upper_tail(100.0, 2.0), (-50.0_f64).exp(), 1e-11);
        // Student with 1 and 2 degrees of freedom is elementary.
        close(student_two_sided_tail(3.0, 1.0), 1.0 - 2.0 / std::f64::consts::PI * 3.0_f64.atan(), 1e-10);
        close(student_two_sided_tail(1e4, 2.0), 1.0 - 1e4 / (2.0 + 1e8_f64).sqrt(), 1e-7);
        close(student_two_sided_tail(5.0, 1e9), normal_two_sided_tail(5.0), 1e-6);
        // Smirnov's table: the 5 % point of √n·D is 1.3581.
        close(kolmogorov_upper_tail(1.358_1 / 1e3, 1_000_000), 0.05, 1e-3);
    }

    #[test]
    fn as_few_as_were_counted_have_the_probability_stated() {
        // P(N ≤ n) = e^(−μ) Σ μᵏ/k!, term by term.
        for (count, significance) in [(0_u64, 1e-3), (1, 5.7e-9), (7, 1e-6), (300, 0.025)] {
            let mean = poisson_mean_bound(count, significance);
            let terms = (0..=count).scan(1.0, |term, k| {
                *term *= if k == 0 { 1.0 } else { mean / k as f64 };
                Some(*term)
            });
            close((-mean).exp() * terms.sum::<f64>(), significance, 1e-8);
        }
    }

    #[test]
    fn so_many_successes_have_the_probability_of_their_terms() {
        for (trials, probability) in [(16_u64, 0.1_f64), (40, 0.5)] {
            let mut term = (1.0 - probability).powi(trials as i32);
            let mut below = 0.0;
            for count in 0..=trials {
                close(binomial_upper_tail(count, trials, probability), 1.0 - below, 1e-6);
                below += term;
                term *= (trials - count) as f64 / (count + 1) as f64 * probability / (1.0 - probability);
                if below > 0.999 {
                    break;
                }
            }
        }
        assert_eq!(
            [binomial_upper_tail(5, 4, 0.3), binomial_upper_tail(0, 4, 0.0), binomial_upper_tail(1, 4, 0.0)],
            [0.0, 1.0, 0.0]
        );
    }

    #[test]
    fn quantiles_invert_their_tails() {
        close(normal_two_sided_quantile(1e-6), 4.891_638_475_698_6, 1e-10);
        close(normal_two_sided_quantile(2e-8), 5.612_001_244_174_79, 1e-9);
        for p in [0.9, 0.5, 1e-3, 1e-9] {
            close(normal_upper_tail(normal_upper_tail_quantile(p)), p, 1e-9);
            for freedom in [1.0, 7.0, 300.0] {
                close(student_two_sided_tail(student_two_sided_quantile(p, freedom), freedom), p, 1e-7);
                close(chi_square_upper_tail(chi_square_upper_tail_quantile(p, freedom), freedom), p, 1e-8);
            }
        }
        assert!(normal_upper_tail_quantile(0.0).is_nan());
    }
}
