//! Tone curves: from linear light to the light of a screen, from 0 (black) to 1 (white).

use std::sync::LazyLock;

use etalon_optics::colour::{
    Matrix, REC709_FROM_XYZ, REC709_PRIMARIES_XY, REC709_WHITE_XY, inverse, multiply, product, xyz_from_rgb,
};

/// How bright parts of a picture are brought into the range of a screen. The curve acts on linear Rec. 709 after the exposure; the
/// sRGB encoding follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneCurve {
    /// None: what is above 1 is clipped, and counted.
    #[default]
    Linear,
    /// [`filmic`], on each of R, G and B. White is at 5.6; what is brighter is clipped, and counted.
    Filmic,
    /// [`agx`]. Every colour finds a place; very bright ones become white.
    Agx,
}

impl ToneCurve {
    /// The light of the screen for a linear Rec. 709 colour. With [`ToneCurve::Linear`] and [`ToneCurve::Filmic`], components outside
    /// of 0 to 1 are what the screen cannot show. Negative components stay as they are, except with [`ToneCurve::Agx`].
    ///
    /// ```
    /// use etalon_picture::develop::ToneCurve;
    ///
    /// assert_eq!(ToneCurve::Linear.apply([0.1, 0.5, 3.0]), [0.1, 0.5, 3.0]);
    /// assert_eq!(ToneCurve::Filmic.apply([0.0; 3]), [0.0; 3]);
    /// // Middle grey stays near the middle of the screen.
    /// let [grey, ..] = ToneCurve::Agx.apply([0.18; 3]);
    /// assert!((grey - 0.5_f64.powf(2.2)).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn apply(self, rgb: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Linear => rgb,
            Self::Filmic => rgb.map(filmic),
            Self::Agx => agx(rgb),
        }
    }
}

/// The curve of John Hable (*Filmic Tonemapping Operators*, 2010, made for the game Uncharted 2), of one component: f(2x) / f(11.2).
///
/// f(x) = ((x(Ax + CB) + DE) / (x(Ax + B) + DF)) − E/F. A = 0.15 shapes the shoulder, B = 0.50 and C = 0.10 the linear part,
/// D = 0.20, E = 0.02 and F = 0.30 the toe. The curve is 0 at 0, 0.128 at 0.18 and 1 at 5.6. Above that it goes on rising to 1.29. Negative
/// values stay as they are.
///
/// ```
/// use etalon_picture::develop::filmic;
///
/// assert_eq!(filmic(0.0), 0.0);
/// assert!((filmic(5.6) - 1.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn filmic(x: f64) -> f64 {
    const EXPOSURE_BIAS: f64 = 2.0;
    const WHITE: f64 = 11.2;
    if x <= 0.0 {
        return x;
    }
    let [a, b, c, d, e, f] = [0.15, 0.50, 0.10, 0.20, 0.02, 0.30];
    let curve = |x: f64| (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
    // Beyond this the quotient of the squares is A/A for every digit, and they might overflow.
    curve((EXPOSURE_BIAS * x).clamp(0.0, 1e30)) / curve(WHITE)
}

/// Stops below and above middle grey (0.18) that [`agx_curve`] spreads from 0 to 1.
const STOPS: [f64; 2] = [-10.0, 6.5];
const MIDDLE_GREY: f64 = 0.18;
/// Where middle grey lies on the axis of stops, from 0 to 1, and the signal that it gets.
const PIVOT: [f64; 2] = [-STOPS[0] / (STOPS[1] - STOPS[0]), 0.5];
/// The slope at the pivot.
const SLOPE: f64 = 2.0;
/// The powers of the toe and of the shoulder.
const POWERS: [f64; 2] = [3.0, 3.25];
/// How far the primaries are moved toward white, as a share of their distance.
const INSET: f64 = 0.2;
/// The power by which the signal is decoded to light.
const DISPLAY_POWER: f64 = 2.2;

/// From linear Rec. 709 to the amounts of the primaries moved toward white, and back.
static INSET_AND_OUTSET: LazyLock<[Matrix; 2]> = LazyLock::new(|| {
    let white = REC709_WHITE_XY;
    let toward_white = |xy: [f64; 2]| [0, 1].map(|c| xy[c] + INSET * (white[c] - xy[c]));
    let xyz = xyz_from_rgb(REC709_PRIMARIES_XY.map(toward_white), white).expect("a triangle about white");
    let inset = product(&REC709_FROM_XYZ, &xyz);
    [inset, inverse(&inset)]
});

/// AgX, after Troy Sobotka (*AgX*, the OpenColorIO configuration, 2022). Our own code of his published formula, in four steps:
///
/// 1. the colour is inset: a matrix, as if its primaries were moved by 0.2 of their distance to white, so that no component stays far
///    below the others;
/// 2. each component goes through [`agx_curve`];
/// 3. the signal becomes light by the power 2.2;
/// 4. the inverse of the first matrix is applied to that light, which gives colours their saturation back, and the result is limited to 0 to 1.
///    (Sobotka's first version leaves this step out; Blender's has it.)
///
/// ```
/// use etalon_picture::develop::agx;
///
/// // A grey stays grey, and a very bright red becomes nearly white.
/// let [r, g, b] = agx([0.5; 3]);
/// assert!((r - g).abs() < 1e-12 && (g - b).abs() < 1e-12);
/// assert!(agx([1e4, 0.0, 0.0]).iter().all(|v| *v > 0.9));
/// ```
#[must_use]
pub fn agx(rgb: [f64; 3]) -> [f64; 3] {
    let [inset, outset] = &*INSET_AND_OUTSET;
    let light = multiply(inset, rgb).map(|v| agx_curve(v).powf(DISPLAY_POWER));
    multiply(outset, light).map(|v| v.clamp(0.0, 1.0))
}

/// The signal, from 0 to 1, of one component of light by the curve of AgX.
///
/// t = (log₂(x / 0.18) + 10) / 16.5, limited to 0 to 1, is the place on the axis of stops. The curve goes through (0, 0), (20/33, 0.5)
/// with slope 2, and (1, 1): c(t) = 0.5 + s·h(2(t − 20/33) / s), h(u) = u / (1 + uᵖ)^(1/p), with p = 3 below the middle and 3.25 above, and
/// with the s that reaches the end point.
///
/// ```
/// use etalon_picture::develop::agx_curve;
///
/// assert_eq!(agx_curve(0.0), 0.0);
/// assert!((agx_curve(0.18) - 0.5).abs() < 1e-15);
/// assert_eq!(agx_curve(1e9), 1.0);
/// ```
#[must_use]
pub fn agx_curve(x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let t = (((x / MIDDLE_GREY).log2() - STOPS[0]) / (STOPS[1] - STOPS[0])).clamp(0.0, 1.0);
    // The toe is a shoulder turned by 180° about the pivot.
    let above = t >= PIVOT[0];
    let (reach, power) =
        if above { ([1.0 - PIVOT[0], 1.0 - PIVOT[1]], POWERS[1]) } else { ([PIVOT[0], PIVOT[1]], POWERS[0]) };
    let along = SLOPE * reach[0];
    let scale = (along.powf(-power) * ((along / reach[1]).powf(power) - 1.0)).powf(-1.0 / power);
    let u = SLOPE * (t - PIVOT[0]).abs() / scale;
    let rise = scale * u / (1.0 + u.powf(power)).powf(1.0 / power);
    (if above { PIVOT[1] + rise } else { PIVOT[1] - rise }).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CURVES: [ToneCurve; 3] = [ToneCurve::Linear, ToneCurve::Filmic, ToneCurve::Agx];

    #[test]
    fn end_values_are_as_stated() {
        for (curve, white, grey) in [
            (ToneCurve::Linear, 1.0, 0.18),
            // (0.36·0.104 + 0.004) / (0.36·0.554 + 0.06) − 1/15 over (11.2·1.73 + 0.004) / (11.2·2.18 + 0.06) − 1/15.
            (ToneCurve::Filmic, 5.6, 0.128_338_45),
            (ToneCurve::Agx, 0.18 * 6.5_f64.exp2(), 0.5_f64.powf(2.2)),
        ] {
            assert_eq!(curve.apply([0.0; 3])[0], 0.0, "{curve:?}");
            assert!((curve.apply([white; 3])[0] - 1.0).abs() < 1e-12, "{curve:?}");
            assert!((curve.apply([0.18; 3])[0] - grey).abs() < 1e-6, "{curve:?} {}", curve.apply([0.18; 3])[0]);
        }
        assert!((filmic(f64::MAX) - 1.287).abs() < 1e-3);
        assert_eq!(filmic(-0.3), -0.3);
        assert_eq!(agx([-5.0; 3]), [0.0; 3]);
    }

    #[test]
    fn the_curve_of_agx_is_the_published_one() {
        // A polynomial of degree 6 that others fitted to the published curve (B. Wrensch 2023, mean error 4e-6 in the square), at stops
        // around middle grey.
        let fitted = |t: f64| {
            let t2 = t * t;
            let t4 = t2 * t2;
            15.5 * t4 * t2 - 40.14 * t4 * t + 31.96 * t4 - 6.868 * t2 * t + 0.4298 * t2 + 0.1191 * t - 0.00232
        };
        for step in 0..=32 {
            let t = f64::from(step) / 32.0;
            let x = MIDDLE_GREY * (STOPS[0] + t * (STOPS[1] - STOPS[0])).exp2();
            assert!((agx_curve(x) - fitted(t)).abs() < 8e-3, "{t}: {} {}", agx_curve(x), fitted(t));
        }
        // And the matrix, to four digits: the amounts of the first row of the same author's.
        let [inset, _] = &*INSET_AND_OUTSET;
        for (found, published) in inset[0].iter().zip([0.842_479, 0.078_433_6, 0.079_223_7]) {
            assert!((found - published).abs() < 1e-4, "{found} {published}");
        }
    }

    #[test]
    fn nan_stays_nan() {
        assert!(filmic(f64::NAN).is_nan() && agx_curve(f64::NAN).is_nan());
    }

    proptest! {
        #[test]
        fn curves_rise_and_greys_stay_grey(a in 0.0..20.0_f64, step in 1e-6..5.0_f64) {
            for curve in CURVES {
                let (low, high) = (curve.apply([a; 3]), curve.apply([a + step; 3]));
                prop_assert!(low[0] <= high[0], "{:?}", curve);
                prop_assert!((low[0] - low[1]).abs() < 1e-12 && (low[1] - low[2]).abs() < 1e-12, "{:?}", curve);
            }
        }

        #[test]
        fn up_to_white_a_screen_shows_all(rgb in prop::array::uniform3(0.0..1.0_f64), white in prop::bool::ANY) {
            for (curve, most) in [(ToneCurve::Linear, 1.0), (ToneCurve::Filmic, 5.6), (ToneCurve::Agx, 1e6)] {
                let most = if white { most } else { 1.0 };
                let shown = curve.apply(rgb.map(|v| most * v));
                prop_assert!(shown.iter().all(|v| (0.0..=1.0).contains(v)), "{:?} {:?}", curve, shown);
            }
        }

        #[test]
        fn the_curve_of_agx_never_falls(stops in -14.0..10.0_f64, step in 0.0..1.0_f64) {
            prop_assert!(agx_curve(stops.exp2()) <= agx_curve((stops + step).exp2()));
        }
    }
}
