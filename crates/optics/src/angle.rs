//! The angle of a vector, without the platform's mathematics library.

use std::f64::consts::PI;

/// atan(k/8)/2π for k = 0…8.
const EIGHTHS: [f64; 9] = [
    0.0,
    0.019_791_712_080_282_77,
    0.038_989_565_188_684_66,
    0.057_100_125_609_954_07,
    0.073_791_808_825_216_63,
    0.088_903_842_244_676_37,
    0.102_416_382_349_566_72,
    0.114_405_347_682_526_79,
    0.125,
];

/// The angle of the vector (x, y) from the x axis toward the y axis, in turns, in [−½, ½]; 0 for the zero vector.
///
/// The quotient of the smaller and the larger component is reduced by the addition theorem of the arctangent to within 1/16
/// of a multiple of 1/8, where its Taylor series to x¹⁵ leaves 1e-21. The error is below 4 unit roundoffs of a turn.
#[inline]
pub fn atan2_turns(y: f64, x: f64) -> f64 {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = if ay > ax { (ax, ay) } else { (ay, ax) };
    // Without branches, so that a loop over vectors is vectorised.
    let t = if large > 0.0 { small / large } else { 0.0 };
    let k = (t * 8.0 + 0.5) as usize;
    let c = k as f64 * 0.125;
    let d = (t - c) / (1.0 + t * c);
    let d2 = d * d;
    let series = [-1.0 / 15.0, 1.0 / 13.0, -1.0 / 11.0, 1.0 / 9.0, -1.0 / 7.0, 0.2, -1.0 / 3.0, 1.0]
        .into_iter()
        .fold(0.0, |sum, coefficient| sum * d2 + coefficient);
    let eighth = EIGHTHS[k.min(8)] + d * series * (0.5 / PI);
    let quarter = if ay > ax { 0.25 - eighth } else { eighth };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    half.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Real;

    #[test]
    fn angles_are_those_of_the_library_to_rounding() {
        for i in 0..100_000 {
            let turns = -0.5 + (f64::from(i) + 0.5) / 100_000.0;
            let (y, x) = (turns * 2.0 * PI).sin_cos();
            for scale in [1e-200, 1.0, 3e100] {
                let got = atan2_turns(y * scale, x * scale);
                assert!((got - turns).abs() <= 4.0 * f64::EPSILON, "{got} is not {turns}");
            }
            // The inverse of what draws directions.
            let (sin, cos) = f64::sin_cos_turns(turns + 0.5);
            assert!((atan2_turns(-sin, -cos) - turns).abs() <= 4.0 * f64::EPSILON, "{turns}");
        }
        // Small angles keep their digits.
        assert!((atan2_turns(1e-9, 1.0) * 2.0 * PI / 1e-9 - 1.0).abs() < 1e-15);
        assert_eq!((atan2_turns(0.0, 1.0), atan2_turns(1.0, 0.0), atan2_turns(0.0, 0.0)), (0.0, 0.25, 0.0));
        assert_eq!((atan2_turns(0.0, -1.0), atan2_turns(-0.0, -1.0), atan2_turns(-2.0, 0.0)), (0.5, -0.5, -0.25));
        assert_eq!(atan2_turns(-3.0, 3.0), -0.125);
    }
}
