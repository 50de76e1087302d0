//! Exposure in stops, chosen by hand or from the picture.

use crate::PictureError;

/// The luminance that [`auto_exposure`] gives to the middle of a picture: 18 %, the reflectance of a photographer's grey card.
pub const MIDDLE_GREY: f64 = 0.18;

/// Largest exposure, stops.
pub const MAX_STOPS: f64 = 1000.0;

/// Pixels that are more stops below the bright end do not count for [`auto_exposure`].
const STOPS_BELOW: f64 = 10.0;

/// The percentile that [`auto_exposure`] takes for the bright end.
const BRIGHT_END: f64 = 0.95;

/// By how much a picture is brightened: by 2^EV in linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// A number of stops, EV; each doubles the light.
    Stops(f64),
    /// As [`auto_exposure`] says.
    Auto,
}

impl Exposure {
    /// The factor 2^EV by which linear light is multiplied.
    ///
    /// ```
    /// use etalon_picture::develop::Exposure;
    ///
    /// assert_eq!(Exposure::gain(1.0), 2.0);
    /// assert_eq!(Exposure::gain(-2.0), 0.25);
    /// ```
    #[must_use]
    pub fn gain(stops: f64) -> f64 {
        stops.exp2()
    }
}

/// The exposure that makes the middle of a picture 18 % grey, in stops: EV = log₂(0.18 / L), rounded to 0.01.
///
/// L is the log-average luminance exp(mean(ln Y)) of Reinhard, Stark, Shirley & Ferwerda 2002 (*Photographic tone reproduction for
/// digital images*, ACM TOG 21(3), equation 1), made robust. Let B be the value of rank ⌊0.95·(n − 1)⌋ among the n luminances that are
/// finite and above 0. A luminance above B counts as B. A luminance below B / 2¹⁰ does not count. So neither single bright pixels nor a
/// black background decide the exposure: of two or more pixels the brightest is never B.
///
/// `None` for a picture without light.
///
/// ```
/// use etalon_picture::develop::auto_exposure;
///
/// assert_eq!(auto_exposure([0.09; 100]), Some(1.0));
/// // One pixel that is a million times brighter, and a black half, change nothing.
/// let with_lamp = [vec![0.09; 99], vec![9e4], vec![0.0; 100]].concat();
/// assert_eq!(auto_exposure(with_lamp), Some(1.0));
/// assert_eq!(auto_exposure([0.0; 100]), None);
/// ```
#[must_use]
pub fn auto_exposure(luminances: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut lit: Vec<f64> = luminances.into_iter().filter(|y| y.is_finite() && *y > 0.0).collect();
    let bright = percentile(&mut lit, BRIGHT_END)?;
    let least = bright * (-STOPS_BELOW).exp2();
    let counted = lit.iter().filter(|y| **y >= least).map(|y| y.min(bright).log2());
    let (count, sum) = counted.fold((0_usize, 0.0), |(count, sum), stops| (count + 1, sum + stops));
    let stops = MIDDLE_GREY.log2() - sum / count as f64;
    Some((100.0 * stops).round() / 100.0)
}

/// [`auto_exposure`], with what to say where there is no light.
pub(crate) fn auto_or_refuse(luminances: impl IntoIterator<Item = f64>) -> Result<f64, PictureError> {
    auto_exposure(luminances).ok_or_else(|| {
        PictureError::develop("the exposure cannot be chosen automatically: no pixel has a finite luminance above 0")
    })
}

/// The value of rank ⌊share·(n − 1)⌋, from 0, among n values, which end in another order. `None` of no values.
pub(crate) fn percentile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let rank = (share * last as f64) as usize;
    Some(*values.select_nth_unstable_by(rank, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_black_picture_has_no_exposure() {
        assert_eq!(auto_exposure([]), None);
        assert_eq!(auto_exposure([0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY]), None);
        assert!(auto_or_refuse([0.0]).unwrap_err().to_string().contains("no pixel"));
    }

    proptest! {
        #[test]
        fn twice_the_light_takes_a_stop_less(
            luminances in prop::collection::vec(1e-6..1e6_f64, 1..200),
            stops in -8..8_i32,
        ) {
            let ev = auto_exposure(luminances.iter().copied()).unwrap();
            let brighter = auto_exposure(luminances.iter().map(|y| y * f64::from(stops).exp2())).unwrap();
            // Both are rounded to 0.01.
            prop_assert!((ev - f64::from(stops) - brighter).abs() < 0.0101, "{} {}", ev, brighter);
        }

        #[test]
        fn it_lies_between_the_extremes_and_ignores_what_is_no_light(
            luminances in prop::collection::vec(1e-3..1e3_f64, 1..100),
        ) {
            let ev = auto_exposure(luminances.iter().copied()).unwrap();
            let [low, high] = luminances.iter().fold([f64::INFINITY, 0.0], |[l, h], y| [f64::min(l, *y), f64::max(h, *y)]);
            prop_assert!((0.18 / high).log2() - 0.01 <= ev && ev <= (0.18 / low).log2() + 0.01);
            let with = luminances.iter().copied().chain([f64::NAN, f64::INFINITY, -3.0, 0.0]);
            prop_assert_eq!(auto_exposure(with), Some(ev));
        }

        #[test]
        fn one_bright_pixel_moves_it_little(
            luminances in prop::collection::vec(0.1..1.0_f64, 20..100),
            firefly in 1.0..1e12_f64,
        ) {
            let ev = auto_exposure(luminances.iter().copied()).unwrap();
            let with = auto_exposure(luminances.iter().copied().chain([firefly])).unwrap();
            // It counts as another of the bright pixels, which lie at most log₂ 10 stops above any; and the percentile moves by a rank.
            let n = luminances.len() as f64;
            prop_assert!((ev - with).abs() < 0.02 + 10.0_f64.log2() * (1.0 / n + 0.06), "{} {}", ev, with);
        }
    }
}
