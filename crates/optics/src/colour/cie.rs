//! The CIE 1931 2° standard observer and the CIE standard illuminants A and D65.

use crate::table::{lerp, parse_csv};
use std::sync::LazyLock;

/// Wavelengths over which the colour-matching functions are tabulated, nm; they are zero elsewhere.
pub const CIE_RANGE_NM: [f64; 2] = [360.0, 830.0];

/// x̄, ȳ, z̄ at 360, 361, …, 830 nm.
static COLOUR_MATCHING: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let rows = parse_csv::<4>(include_str!("../../data/cie-1931-2deg-1nm.csv"));
    assert!(rows.len() == 471 && rows.iter().enumerate().all(|(i, row)| row[0] == 360.0 + i as f64));
    rows.into_iter().map(|[_, x, y, z]| [x, y, z]).collect()
});

/// Relative power of D65 at 300, 305, …, 830 nm.
static D65: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let rows = parse_csv::<2>(include_str!("../../data/cie-d65-5nm.csv"));
    assert!(rows.len() == 107 && rows.iter().enumerate().all(|(i, row)| row[0] == 300.0 + 5.0 * i as f64));
    rows.into_iter().map(|[_, power]| power).collect()
});

/// The maximum luminous efficacy of radiation by the SI's 683 lm/W at 540 THz: 683.002 lm/W at the wavelength where ȳ is 1.
pub const LUMINOUS_EFFICACY: f64 = 683.002;

static Y_INTEGRAL_NM: LazyLock<f64> = LazyLock::new(|| COLOUR_MATCHING.iter().map(|row| row[1]).sum());

pub(crate) fn colour_matching_rows() -> &'static [[f64; 3]] {
    &COLOUR_MATCHING
}

/// x̄, ȳ, z̄ of the CIE 1931 2° standard observer at a wavelength in nm (CIE 018:2019), interpolated linearly between
/// the 1 nm rows; zero outside [`CIE_RANGE_NM`].
#[inline]
pub fn colour_matching(wavelength_nm: f64) -> [f64; 3] {
    let rows: &[[f64; 3]] = &COLOUR_MATCHING;
    let x = wavelength_nm - CIE_RANGE_NM[0];
    if !(0.0..=470.0).contains(&x) {
        return [0.0; 3];
    }
    let i = (x as usize).min(469);
    let t = x - i as f64;
    std::array::from_fn(|c| lerp(rows[i][c], rows[i + 1][c], t))
}

/// ∫ȳ dλ, nm: the sum of ȳ over the 471 rows at 1 nm, 106.856917.
///
/// The trapezoid rule, which is the integral of the interpolated function, differs by 2·10⁻⁸ of it. The figure
/// 106.856895 in wide use differs by 2·10⁻⁷.
#[inline]
pub fn cie_y_integral_nm() -> f64 {
    *Y_INTEGRAL_NM
}

/// XYZ of a spectrum: Σ S(λ)·(x̄, ȳ, z̄)(λ) over 1 nm from 360 to 830 nm (the summation of CIE 15:2018, §7.1), divided by
/// Σ ȳ, so that the constant spectrum 1 has Y = 1.
///
/// For a spectral radiance in W·m⁻²·sr⁻¹·nm⁻¹ the luminance is [`LUMINOUS_EFFICACY`] · [`cie_y_integral_nm`] · Y.
pub fn xyz_of(spectrum: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (i, row) in COLOUR_MATCHING.iter().enumerate() {
        let s = spectrum(CIE_RANGE_NM[0] + i as f64);
        for c in 0..3 {
            sum[c] += row[c] * s;
        }
    }
    sum.map(|v| v / *Y_INTEGRAL_NM)
}

/// Y of a spectrum, as [`xyz_of`] has it.
pub fn luminance_of(spectrum: impl Fn(f64) -> f64) -> f64 {
    xyz_of(spectrum)[1]
}

/// Relative spectral power of CIE standard illuminant D65 (100 at 560 nm), interpolated linearly between the 5 nm rows
/// (CIE 15:2018, table 5); zero outside 300 to 830 nm.
#[inline]
pub fn illuminant_d65(wavelength_nm: f64) -> f64 {
    let rows: &[f64] = &D65;
    let x = (wavelength_nm - 300.0) / 5.0;
    if !(0.0..=106.0).contains(&x) {
        return 0.0;
    }
    let i = (x as usize).min(105);
    lerp(rows[i], rows[i + 1], x - i as f64)
}

/// Relative spectral power of CIE standard illuminant A (100 at 560 nm):
/// 100·(560/λ)⁵·(exp(1.435·10⁷/(2848·560)) − 1)/(exp(1.435·10⁷/(2848·λ)) − 1) (CIE 15:2018, §4.1.1).
#[inline]
pub fn illuminant_a(wavelength_nm: f64) -> f64 {
    let exponent = |nm: f64| (1.435e7 / (2848.0 * nm)).exp_m1();
    100.0 * (560.0 / wavelength_nm).powi(5) * (exponent(560.0) / exponent(wavelength_nm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn constant_one_has_luminance_one() {
        assert!((xyz_of(|_| 1.0)[1] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_integral_of_y_is_the_published_one() {
        assert_relative_eq!(cie_y_integral_nm(), 106.856_917, epsilon = 1e-6);
        assert_relative_eq!(cie_y_integral_nm(), 106.856_895, max_relative = 3e-7);
    }

    #[test]
    fn interpolation_meets_the_rows_and_vanishes_outside() {
        assert_eq!(colour_matching(360.0), [0.000_129_9, 0.000_003_917, 0.000_606_1]);
        assert_eq!(colour_matching(555.0)[1], 1.0);
        assert_eq!(colour_matching(830.0), [0.000_001_251_141, 0.000_000_451_81, 0.0]);
        let (a, b, mid) = (colour_matching(450.0), colour_matching(451.0), colour_matching(450.5));
        for c in 0..3 {
            assert_relative_eq!(mid[c], (a[c] + b[c]) / 2.0, max_relative = 1e-15);
        }
        for outside in [359.999, 830.001, 0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(colour_matching(outside), [0.0; 3]);
        }
    }

    #[test]
    fn illuminants_are_100_at_560_nm() {
        assert_eq!(illuminant_d65(560.0), 100.0);
        assert_eq!(illuminant_a(560.0), 100.0);
        // CIE 15:2018, table T.1.
        assert_relative_eq!(illuminant_a(300.0), 0.930_483, epsilon = 5e-7);
        assert_relative_eq!(illuminant_a(780.0), 241.675, epsilon = 5e-4);
        assert_eq!(illuminant_d65(299.9), 0.0);
        assert_eq!(illuminant_d65(831.0), 0.0);
        assert_eq!(illuminant_d65(830.0), 60.3125);
    }
}
