//! CIE daylight: its locus, and the spectra of daylight of any chromaticity.

use super::cie::xyz_of;
use crate::table::{lerp, parse_csv};
use std::sync::LazyLock;

/// S₀, S₁ and S₂ at 300, 310, …, 830 nm.
static COMPONENTS: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let rows = parse_csv::<4>(include_str!("../../data/cie-daylight-components-10nm.csv"));
    assert!(rows.len() == 54 && rows.iter().enumerate().all(|(i, row)| row[0] == 300.0 + 10.0 * i as f64));
    rows.into_iter().map(|[_, mean, first, second]| [mean, first, second]).collect()
});

static LUMINANCES: LazyLock<[f64; 3]> =
    LazyLock::new(|| [0, 1, 2].map(|part| xyz_of(|nm| daylight_components(nm)[part])[1]));

/// Wavelengths at which [`daylight_components`] are tabulated, nm; between them they are linear.
pub fn daylight_wavelengths_nm() -> impl Iterator<Item = f64> {
    (0..54).map(|i| 300.0 + 10.0 * f64::from(i))
}

/// The components S₀, S₁ and S₂ of daylight at a wavelength in nm (CIE 15:2018, §4.1.2), interpolated linearly between the rows at 10 nm;
/// zero outside 300 to 830 nm. Daylight is S₀ + M₁S₁ + M₂S₂ with the weights of [`daylight_weights`].
#[inline]
pub fn daylight_components(wavelength_nm: f64) -> [f64; 3] {
    let rows: &[[f64; 3]] = &COMPONENTS;
    let x = (wavelength_nm - 300.0) / 10.0;
    if !(0.0..=53.0).contains(&x) {
        return [0.0; 3];
    }
    let i = (x as usize).min(52);
    std::array::from_fn(|part| lerp(rows[i][part], rows[i + 1][part], x - i as f64))
}

/// Y of S₀, S₁ and S₂, as [`luminance_of`](super::luminance_of) has it.
pub fn daylight_luminances() -> [f64; 3] {
    *LUMINANCES
}

/// The weights M₁ and M₂ of the daylight of chromaticity (x, y) (CIE 15:2018, equations 4.5 and 4.6). Far from the locus of daylight the
/// spectrum that they give has negative values.
#[inline]
pub fn daylight_weights([x, y]: [f64; 2]) -> [f64; 2] {
    let over = 0.0241 + 0.2562 * x - 0.7341 * y;
    [(-1.3515 - 1.7703 * x + 5.9114 * y) / over, (0.0300 - 31.4424 * x + 30.0717 * y) / over]
}

/// Chromaticity (x, y) of CIE daylight of a correlated colour temperature from 4000 to 25,000 K (CIE 15:2018, §4.1.2,
/// equations 4.1 to 4.3); `None` outside of this range.
///
/// The named illuminants D50, D55, D65 and D75 are those of 1.4388/1.4380 times their nominal temperature, because the second
/// radiation constant has changed since they were defined.
pub fn daylight_chromaticity(temperature_k: f64) -> Option<[f64; 2]> {
    if !(4000.0..=25_000.0).contains(&temperature_k) {
        return None;
    }
    let per = 1e3 / temperature_k;
    let x = if temperature_k <= 7000.0 {
        0.244_063 + per * (0.099_11 + per * (2.967_8 - 4.607_0 * per))
    } else {
        0.237_040 + per * (0.247_48 + per * (1.901_8 - 2.006_4 * per))
    };
    Some([x, -3.0 * x * x + 2.87 * x - 0.275])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_daylights_have_their_published_chromaticities() {
        // CIE 15:2018, table T.3 (2° observer).
        for (nominal, x, y) in [
            (5000.0, 0.345_67, 0.358_51),
            (5500.0, 0.332_43, 0.347_44),
            (6500.0, 0.312_72, 0.329_03),
            (7500.0, 0.299_03, 0.314_88),
        ] {
            let [found_x, found_y] = daylight_chromaticity(nominal * 1.4388 / 1.4380).unwrap();
            // The published ones belong to tabulated spectra, whose values are rounded.
            assert!((found_x - x).abs() < 1.5e-4 && (found_y - y).abs() < 1.5e-4, "{nominal}: {found_x} {found_y}");
        }
        for outside in [3999.0, 25_001.0, f64::NAN, f64::INFINITY] {
            assert_eq!(daylight_chromaticity(outside), None);
        }
    }

    /// D65 was made of the components before it was tabulated: with M₁ and M₂ rounded to three decimals, at 10 nm.
    #[test]
    fn d65_is_made_of_the_components() {
        let [m1, m2] = daylight_weights(daylight_chromaticity(6500.0 * 1.4388 / 1.4380).unwrap());
        let [m1, m2] = [m1, m2].map(|m| (m * 1000.0).round() / 1000.0);
        for nm in daylight_wavelengths_nm() {
            let [s0, s1, s2] = daylight_components(nm);
            let (made, tabulated) = (s0 + m1 * s1 + m2 * s2, crate::colour::illuminant_d65(nm));
            // To what the table is rounded to.
            assert!((made - tabulated).abs() < 1e-4 * tabulated.max(1.0), "{nm}: {made} {tabulated}");
        }
    }

    #[test]
    fn daylight_has_the_chromaticity_that_it_is_asked_for() {
        for [x, y] in [[0.3127, 0.3290], [0.25, 0.26], [0.36, 0.37], [0.28, 0.31]] {
            let [m1, m2] = daylight_weights([x, y]);
            let spectrum = |nm| {
                let [s0, s1, s2] = daylight_components(nm);
                s0 + m1 * s1 + m2 * s2
            };
            let [big_x, big_y, big_z] = xyz_of(spectrum);
            let sum = big_x + big_y + big_z;
            // The coefficients of the weights have four decimals.
            assert!((big_x / sum - x).abs() < 2e-4 && (big_y / sum - y).abs() < 2e-4, "{x} {y}: {}", big_x / sum);
            let [y0, y1, y2] = daylight_luminances();
            assert!((y0 + m1 * y1 + m2 * y2 - big_y).abs() < 1e-9 * big_y);
        }
        assert_eq!([daylight_components(299.0), daylight_components(831.0)], [[0.0; 3]; 2]);
        assert_eq!(daylight_components(560.0), [100.0, 0.0, 0.0]);
    }

    #[test]
    fn the_two_halves_meet() {
        let (below, above) =
            (daylight_chromaticity(7000.0).unwrap(), daylight_chromaticity(7000.0_f64.next_up()).unwrap());
        // To what the coefficients of the standard are rounded to.
        assert!((below[0] - above[0]).abs() < 1e-5);
    }
}
