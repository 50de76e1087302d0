//! Two renderings of the same thing: Welch's t-test tile by tile.

use super::{
    Welford, normal_two_sided_quantile, resolvable_bias, sidak,
    tails::{kolmogorov_upper_tail, student_two_sided_tail},
};
use crate::Verdict;

/// Welch's t-test of two means with unequal variances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WelchT {
    /// Difference of the means over its standard error.
    pub t: f64,
    /// Welch–Satterthwaite degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Two-sided p-value.
    pub p: f64,
}

/// Whether two streams have the same mean (Welch 1947). Two noise-free equal streams agree with p = 1, two noise-free
/// different ones disagree with p = 0.
#[must_use]
pub fn welch_t(a: &Welford, b: &Welford) -> WelchT {
    let (va, vb) = (a.variance() / a.count() as f64, b.variance() / b.count() as f64);
    let difference = a.mean() - b.mean();
    if va + vb == 0.0 {
        let (t, p) = if difference == 0.0 { (0.0, 1.0) } else { (difference * f64::INFINITY, 0.0) };
        return WelchT { t, degrees_of_freedom: f64::INFINITY, p };
    }
    let t = difference / (va + vb).sqrt();
    let freedom = (va + vb).powi(2) / (va * va / (a.count() as f64 - 1.0) + vb * vb / (b.count() as f64 - 1.0));
    WelchT { t, degrees_of_freedom: freedom, p: student_two_sided_tail(t, freedom) }
}

/// Whether p-values are uniform on [0, 1], as they are when every null hypothesis holds: Kolmogorov–Smirnov, returning the
/// statistic D and its p-value. NaN among the values gives NaN.
///
/// The values must come from continuous statistics; those of noise-free tiles (exactly 0 or 1) must be left out.
#[must_use]
pub fn uniformity(p_values: &[f64]) -> (f64, f64) {
    if p_values.iter().any(|p| p.is_nan()) {
        return (f64::NAN, f64::NAN);
    }
    if p_values.is_empty() {
        return (0.0, 1.0);
    }
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let gap = |(i, p): (usize, &f64)| (p - i as f64 / n).abs().max(((i + 1) as f64 / n - p).abs());
    let d = sorted.iter().enumerate().map(gap).fold(0.0, f64::max);
    (d, kolmogorov_upper_tail(d, sorted.len()))
}

/// Whether two renderings agree, tile by tile: each tile's Welch t at a Šidák-corrected significance, and the p-values of
/// all tiles uniform, which sees a small bias spread over the image that no single tile shows (Jung, Hanika & Dachsbacher
/// 2020, "Detecting Bias in Monte Carlo Renderers using Welch's t-test").
///
/// The budget is halved between the two questions. The resolvable bias is that of the noisiest tile, in its own units.
///
/// # Panics
/// When the renderings have different numbers of tiles.
pub fn tiles_agree(law: impl Into<String>, a: &[Welford], b: &[Welford], significance: f64) -> Verdict {
    assert_eq!(a.len(), b.len(), "the same tiles");
    let law = law.into();
    let half = sidak(significance, 2);
    let each = sidak(half, a.len());
    let tests: Vec<WelchT> = a.iter().zip(b).map(|(a, b)| welch_t(a, b)).collect();
    let noisy: Vec<f64> = tests.iter().filter(|t| t.degrees_of_freedom.is_finite()).map(|t| t.p).collect();
    let nan = tests.iter().position(|t| t.p.is_nan());
    if let Some(tile) = nan {
        return Verdict::broken(law, format!("tile {tile} has no p-value: {:?} against {:?}", a[tile], b[tile]));
    }
    let (worst, test) =
        tests.iter().enumerate().min_by(|x, y| x.1.p.total_cmp(&y.1.p)).expect("an image has at least one tile");
    let noise = a.iter().zip(b).map(|(a, b)| a.standard_error().hypot(b.standard_error())).fold(0.0, f64::max);
    let seen = resolvable_bias(noise, each);
    let (d, p_uniform) = uniformity(&noisy);
    let evidence = format!(
        "{} tiles; worst is tile {worst}: {:.6} against {:.6}, t {:.2}, p {:e} (accepted from {each:e}, |t| about {:.2}); \
         p-values uniform with p {p_uniform:e} (Kolmogorov–Smirnov D {d:.4})",
        tests.len(),
        a[worst].mean(),
        b[worst].mean(),
        test.t,
        test.p,
        normal_two_sided_quantile(each),
    );
    // The smallest of n p-values as one p-value, so that both questions stand on the same scale.
    let p_worst = -((-test.p).ln_1p() * tests.len() as f64).exp_m1();
    let p = p_worst.min(p_uniform);
    Verdict::tested(law, test.t, p, half, seen, evidence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Uniform;

    #[test]
    fn welch_reduces_to_student_for_equal_spread_and_to_one_sample_when_one_side_is_exact() {
        let a: Welford = [1.0, 2.0, 3.0, 4.0].into_iter().collect();
        let b: Welford = [2.0, 3.0, 4.0, 5.0].into_iter().collect();
        let test = welch_t(&a, &b);
        // Both variances are 5/3: t = −1/√(2·5/12), ν = 2(n − 1).
        assert!((test.t + (6.0_f64 / 5.0).sqrt()).abs() < 1e-14);
        assert!((test.degrees_of_freedom - 6.0).abs() < 1e-12);
        // P(|T₆| > 1.0954) by the elementary form for even ν, with θ = atan(t/√6).
        let theta = (test.t.abs() / 6.0_f64.sqrt()).atan();
        let c2 = theta.cos().powi(2);
        let p = 1.0 - theta.sin() * (1.0 + 0.5 * c2 + 0.375 * c2 * c2);
        assert!((test.p - p).abs() < 1e-10, "{} {p}", test.p);
        let exact: Welford = [2.0; 5].into_iter().collect();
        assert!((welch_t(&a, &exact).degrees_of_freedom - 3.0).abs() < 1e-12);
    }

    fn image(seed: u64, bias: f64) -> Vec<Welford> {
        let mut numbers = Uniform::new(seed);
        (0..256).map(|_| (0..64).map(|_| numbers.number() + bias).collect()).collect()
    }

    #[test]
    fn equal_renderings_agree_and_a_bias_below_every_tiles_noise_is_seen_by_uniformity() {
        assert!(tiles_agree("", &image(1, 0.0), &image(2, 0.0), 1e-6).pass);
        // .04 is .8 standard errors of one tile's difference: no tile shows it.
        let verdict = tiles_agree("", &image(1, 0.0), &image(2, 0.04), 1e-6);
        assert!(!verdict.pass, "{verdict}");
        assert!(verdict.statistic.abs() < 5.5, "no single tile shows it");
    }

    #[test]
    fn noise_free_tiles_must_be_equal_and_nan_is_refused() {
        let flat = |value: f64| -> Vec<Welford> { vec![[value; 4].into_iter().collect(); 4] };
        assert!(tiles_agree("", &flat(1.0), &flat(1.0), 1e-6).pass);
        assert!(!tiles_agree("", &flat(1.0), &flat(1.5), 1e-6).pass);
        assert!(!tiles_agree("", &flat(1.0), &flat(f64::NAN), 1e-6).pass);
    }
}
