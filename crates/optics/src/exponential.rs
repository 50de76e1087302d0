//! The exponential function, without the platform's mathematics library.

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
}
