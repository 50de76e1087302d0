//! Chromatic adaptation: what a colour under one white looks like under another.

use super::matrix::{Matrix, inverse, multiply, product};

/// From XYZ to the sharpened cone responses of CAT16 (Li, Li, Wang, Xu, Luo, Cui, Melgosa, Brill & Pointer 2017, *Comprehensive
/// color solutions: CAM16, CAT16, and CAM16-UCS*, Color Research & Application 42(6), 703–718, equation 7).
const CAT16: Matrix =
    [[0.401_288, 0.650_173, -0.051_461], [-0.250_268, 1.204_414, 0.045_854], [-0.002_079, 0.048_952, 0.953_127]];

/// The matrix that takes XYZ under the white `from` to XYZ under the white `to`, with complete adaptation (D = 1):
/// M⁻¹ · diag(M·to / M·from) · M with the M of CAT16. It takes `from` to `to` exactly, but for rounding.
///
/// `None` for whites without positive cone responses, which no light has that looks white.
pub fn adaptation(from: [f64; 3], to: [f64; 3]) -> Option<Matrix> {
    let (from, to) = (multiply(&CAT16, from), multiply(&CAT16, to));
    let mut gains = [[0.0; 3]; 3];
    for c in 0..3 {
        gains[c][c] = to[c] / from[c];
        if !(from[c] > 0.0 && to[c] > 0.0 && gains[c][c].is_finite() && gains[c][c] > 0.0) {
            return None;
        }
    }
    Some(product(&inverse(&CAT16), &product(&gains, &CAT16)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{REC709_WHITE_XY, xyz_of, xyz_of_chromaticity};
    use crate::spectrum::Illuminant;
    use approx::assert_relative_eq;

    #[test]
    fn one_white_becomes_the_other() {
        let d65 = xyz_of_chromaticity(REC709_WHITE_XY);
        for illuminant in Illuminant::ALL {
            let white = xyz_of(|nm| illuminant.eval(nm));
            let adapted = multiply(&adaptation(white, d65).unwrap(), white);
            for c in 0..3 {
                assert_relative_eq!(adapted[c], d65[c], max_relative = 1e-14);
            }
        }
    }

    #[test]
    fn the_same_white_changes_nothing_and_the_way_back_undoes_it() {
        let (a, b) = ([1.098_5, 1.0, 0.355_8], [0.950_4, 1.0, 1.088_8]);
        let there_and_back = product(&adaptation(b, a).unwrap(), &adaptation(a, b).unwrap());
        for m in [adaptation(a, a).unwrap(), there_and_back] {
            for i in 0..3 {
                for j in 0..3 {
                    assert!((m[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14, "{m:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_white_is_refused() {
        let white = [1.0; 3];
        for bad in [[0.0; 3], [-9.0, 1.0, 1.0], [f64::NAN, 1.0, 1.0], [f64::INFINITY, 1.0, 1.0], [1.0, 1.0, -1.0]] {
            assert_eq!(adaptation(bad, white), None, "{bad:?}");
            assert_eq!(adaptation(white, bad), None, "{bad:?}");
        }
    }
}
