//! The exponential function and the logarithm, without the platform's mathematics library.

use std::f64::consts::LOG2_E;

/// ln 2 in two parts, the first with 20 trailing zero bits, so that multiples of it up to 2²⁰ are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// Beyond this e⁻ˣ has no full precision any more.
const MOST: f64 = 708.0;

/// e⁻ˣ for x ≥ 0, up to infinity; 0 where it would be below 3·10⁻³⁰⁸.
///
/// The argument is reduced to within ½ ln 2 of a multiple of ln 2, where the Taylor series to x¹³ leaves 5e-18. The error is
/// below 4 unit roundoffs of the result.
#[inline]
pub fn exp_neg(x: f64) -> f64 {
    if x > MOST {
        return 0.0;
    }
    let k = (x * LOG2_E + 0.5) as u64;
    let r = k as f64 * LN_2[0] - x + k as f64 * LN_2[1];
    // 1/n! from n = 13 to 0.
    const FACTORIALS: [f64; 14] = [
        1.0 / 6_227_020_800.0,
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ];
    let series = FACTORIALS.into_iter().fold(0.0, |sum, coefficient| sum * r + coefficient);
    series * f64::from_bits((1023 - k) << 52)
}

/// 1 − e⁻ˣ for x ≥ 0, up to infinity, to 8 unit roundoffs: thin layers keep what they take away.
#[inline]
pub fn one_minus_exp_neg(x: f64) -> f64 {
    if x > 0.25 {
        return 1.0 - exp_neg(x);
    }
    // x − x²/2! + x³/3! − … to x¹², whose next term is below 1e-17 of the sum.
    let mut sum = 0.0;
    for n in (2..=12).rev() {
        sum = (1.0 - sum) * x / f64::from(n);
    }
    x * (1.0 - sum)
}

/// −ln x for x from the smallest normal number to 1; infinity at 0.
///
/// x = 2ᵏm with m in [√½, √2) and ln m = 2 artanh((m − 1)/(m + 1)), whose series to the 23rd power leaves 1e-20. The error is below 3 unit
/// roundoffs of the result.
#[inline]
pub fn neg_ln(x: f64) -> f64 {
    if x <= 0.0 {
        return f64::INFINITY;
    }
    let bits = x.to_bits();
    // Exponent and mantissa, such that the mantissa is in [√½, √2).
    const SQRT_HALF_BITS: u64 = 0x3fe6_a09e_667f_3bcd;
    let shifted = bits.wrapping_sub(SQRT_HALF_BITS) as i64 >> 52;
    let m = f64::from_bits(bits.wrapping_sub((shifted as u64) << 52));
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let series = (1..=11).rev().fold(0.0, |sum, n| (sum + 1.0 / f64::from(2 * n + 1)) * s2);
    let k = shifted as f64;
    -(k * LN_2[0] + (2.0 * s + (2.0 * s * series + k * LN_2[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_library_s_to_rounding() {
        for i in 0..700_000 {
            let x = f64::from(i) * 0.001 + 1e-7;
            let (got, want) = (exp_neg(x), (-x).exp());
            assert!((got / want - 1.0).abs() <= 2.0 * f64::EPSILON, "{x}: {got} is not {want}");
        }
        assert_eq!((exp_neg(0.0), exp_neg(f64::INFINITY), exp_neg(1e300)), (1.0, 0.0, 0.0));
        // Thin layers keep what they take away.
        assert!(((1.0 - exp_neg(1e-9)) / 1e-9 - 1.0).abs() < 2e-7);
    }

    #[test]
    fn what_is_taken_away_is_the_library_s_to_rounding() {
        for i in 0..200_000 {
            let x = f64::from(i) * 5e-6 + 1e-9;
            let (got, want) = (one_minus_exp_neg(x), -(-x).exp_m1());
            assert!((got / want - 1.0).abs() <= 4.0 * f64::EPSILON, "{x}: {got} is not {want}");
        }
        assert_eq!((one_minus_exp_neg(0.0), one_minus_exp_neg(f64::INFINITY)), (0.0, 1.0));
    }

    #[test]
    fn the_logarithm_is_the_library_s_to_rounding() {
        for i in 1..1_000_000 {
            let x = f64::from(i) * 1e-6;
            let (got, want) = (neg_ln(x), -x.ln());
            assert!((got - want).abs() <= 2.0 * f64::EPSILON * want.abs(), "{x}: {got} is not {want}");
        }
        for x in [f64::MIN_POSITIVE, 1e-300, 0.5_f64.powi(48), 1.0 - 0.5_f64.powi(48)] {
            assert!((neg_ln(x) / -x.ln() - 1.0).abs() <= 2.0 * f64::EPSILON, "{x}");
        }
        assert_eq!((neg_ln(1.0), neg_ln(0.0)), (0.0, f64::INFINITY));
    }
}
