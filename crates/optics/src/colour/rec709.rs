//! Linear Rec. 709 and the sRGB transfer function.
//!
//! The matrices follow from the chromaticities that Recommendation ITU-R BT.709-6 states (§1.3, §1.4), with its
//! four-digit white (0.3127, 0.3290): it is what an EXR file's `chromaticities` say and what every reader assumes.
//! D65 by the CIE's own table has (0.31273, 0.32902), so a D65-lit perfect reflector has an RGB that differs from
//! (1, 1, 1) by up to 2.6·10⁻⁴; that is the rounding in the Recommendation, not an error of the renderer.

use super::matrix::{Matrix, inverse, multiply};

/// Chromaticities (x, y) of the red, green and blue primaries of Rec. 709.
pub const REC709_PRIMARIES_XY: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
/// Chromaticity (x, y) of the white of Rec. 709.
pub const REC709_WHITE_XY: [f64; 2] = [0.3127, 0.3290];

/// Takes linear Rec. 709 to XYZ; (1, 1, 1) has Y = 1.
pub const XYZ_FROM_REC709: Matrix = rgb_to_xyz_matrix(xyz_of_chromaticity(REC709_WHITE_XY));
/// Takes XYZ to linear Rec. 709.
pub const REC709_FROM_XYZ: Matrix = inverse(&XYZ_FROM_REC709);

/// Takes linear RGB of the Rec. 709 primaries to XYZ such that (1, 1, 1) becomes `white` (SMPTE RP 177).
pub(crate) const fn rgb_to_xyz_matrix(white: [f64; 3]) -> Matrix {
    primaries_to_xyz(REC709_PRIMARIES_XY, white)
}

/// Takes linear RGB of these primaries to XYZ such that (1, 1, 1) becomes `white` (SMPTE RP 177).
const fn primaries_to_xyz(p: [[f64; 2]; 3], white: [f64; 3]) -> Matrix {
    let mut m = [[0.0; 3]; 3];
    let mut c = 0;
    while c < 3 {
        m[0][c] = p[c][0] / p[c][1];
        m[1][c] = 1.0;
        m[2][c] = (1.0 - p[c][0] - p[c][1]) / p[c][1];
        c += 1;
    }
    let s = multiply(&inverse(&m), white);
    c = 0;
    while c < 3 {
        m[0][c] *= s[c];
        m[1][c] *= s[c];
        m[2][c] *= s[c];
        c += 1;
    }
    m
}

/// Luminance of a linear Rec. 709 colour by the four digits of the Recommendation (§3.2); of (1, 1, 1) it is 1.
#[inline(always)]
pub fn rec709_luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// XYZ of a chromaticity (x, y) with Y = 1: (x/y, 1, (1 − x − y)/y).
pub const fn xyz_of_chromaticity([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// Takes linear RGB of primaries with these chromaticities (x, y) to XYZ, such that (1, 1, 1) becomes the white with Y = 1
/// (SMPTE RP 177).
///
/// `None` where there is no such matrix: coordinates that are not finite, a y of 0, primaries on a line.
pub fn xyz_from_rgb(primaries_xy: [[f64; 2]; 3], white_xy: [f64; 2]) -> Option<Matrix> {
    let matrix = primaries_to_xyz(primaries_xy, xyz_of_chromaticity(white_xy));
    let usable = |m: &Matrix| m.iter().flatten().all(|v| v.is_finite());
    (usable(&matrix) && usable(&inverse(&matrix))).then_some(matrix)
}

/// Linear Rec. 709 of an XYZ; negative where the colour is outside the gamut.
#[inline]
pub fn rec709_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    multiply(&REC709_FROM_XYZ, xyz)
}

/// XYZ of a linear Rec. 709 colour.
#[inline]
pub fn rec709_to_xyz(rgb: [f64; 3]) -> [f64; 3] {
    multiply(&XYZ_FROM_REC709, rgb)
}

/// The sRGB transfer function: from linear light to a signal, both in [0, 1] (IEC 61966-2-1). Negative values mirror.
pub fn srgb_encode(linear: f64) -> f64 {
    let v = linear.abs();
    let signal = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    signal.copysign(linear)
}

/// The inverse of [`srgb_encode`]: from a signal to linear light.
pub fn srgb_decode(signal: f64) -> f64 {
    let v = signal.abs();
    let linear = if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    linear.copysign(signal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn matrices_agree_with_the_published_four_digits() {
        // IEC 61966-2-1, §5.2.
        let published = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        for i in 0..3 {
            for j in 0..3 {
                assert!((XYZ_FROM_REC709[i][j] - published[i][j]).abs() < 5.1e-5, "{i} {j}");
            }
        }
    }

    #[test]
    fn matrices_are_inverse_and_white_is_white() {
        for rgb in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, 0.5, 0.7]] {
            let back = rec709_from_xyz(rec709_to_xyz(rgb));
            for c in 0..3 {
                assert!((back[c] - rgb[c]).abs() < 1e-15);
            }
        }
        let white = rec709_to_xyz([1.0; 3]);
        let sum = white[0] + white[1] + white[2];
        assert_relative_eq!(white[1], 1.0, epsilon = 1e-15);
        assert_relative_eq!(white[0] / sum, REC709_WHITE_XY[0], epsilon = 1e-15);
        assert_relative_eq!(white[1] / sum, REC709_WHITE_XY[1], epsilon = 1e-15);
    }

    #[test]
    fn primaries_decide_the_matrix() {
        assert_eq!(xyz_from_rgb(REC709_PRIMARIES_XY, REC709_WHITE_XY), Some(XYZ_FROM_REC709));
        // ITU-R BT.2020-2, table 4: the weights of the luminance.
        let wide = xyz_from_rgb([[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]], REC709_WHITE_XY).unwrap();
        for (c, weight) in [0.2627, 0.6780, 0.0593].into_iter().enumerate() {
            assert!((wide[1][c] - weight).abs() < 5e-5, "{c}: {}", wide[1][c]);
        }
        for primaries in
            [[[0.3, 0.3]; 3], [[0.1, 0.1], [0.2, 0.2], [0.4, 0.4]], [[0.64, 0.0], [0.3, 0.6], [0.15, 0.06]]]
        {
            assert_eq!(xyz_from_rgb(primaries, REC709_WHITE_XY), None, "{primaries:?}");
        }
        assert_eq!(xyz_from_rgb(REC709_PRIMARIES_XY, [f64::NAN, 0.3]), None);
    }

    #[test]
    fn the_srgb_transfer_function_round_trips_and_mirrors() {
        for i in 0..=255 {
            let signal = f64::from(i) / 255.0;
            // The two branches of the standard meet only to 3e-8; powf adds a few roundoffs.
            assert!((srgb_encode(srgb_decode(signal)) - signal).abs() < 1e-7, "{i}");
            assert_eq!(srgb_decode(-signal), -srgb_decode(signal));
        }
        assert_relative_eq!(srgb_decode(0.5), 0.214_041_140_482_232_55, max_relative = 1e-14);
        assert_relative_eq!(srgb_encode(0.18), 0.461_356_129_500_441_64, max_relative = 1e-14);
        assert_eq!(srgb_encode(0.0), 0.0);
        assert_relative_eq!(srgb_encode(1.0), 1.0, epsilon = 2e-16);
    }
}
