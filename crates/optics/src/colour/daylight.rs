//! The CIE daylight locus.

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

    #[test]
    fn the_two_halves_meet() {
        let (below, above) =
            (daylight_chromaticity(7000.0).unwrap(), daylight_chromaticity(7000.0_f64.next_up()).unwrap());
        // To what the coefficients of the standard are rounded to.
        assert!((below[0] - above[0]).abs() < 1e-5);
    }
}
