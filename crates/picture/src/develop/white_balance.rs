//! White balance by chromatic adaptation.

use etalon_optics::Illuminant;
use etalon_optics::colour::{
    Matrix, REC709_FROM_XYZ, REC709_WHITE_XY, XYZ_FROM_REC709, adaptation, daylight_chromaticity, product,
    rec709_to_xyz, xyz_of, xyz_of_chromaticity,
};
use etalon_optics::spectrum::Blackbody;

use super::Rect;
use super::colour::rgb_pixels;
use super::crop::crop;
use crate::{Picture, PictureError, Sample};

/// Temperatures that [`White::Temperature`] may have, K.
pub const TEMPERATURES_K: [f64; 2] = [1000.0, 100_000.0];

/// The second radiation constant of today over that of the time when the daylight illuminants were named.
const RADIATION_CONSTANTS: f64 = 1.4388 / 1.4380;

/// What light is to look white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WhiteBalance {
    /// Colours stay as they are: the white of Rec. 709 looks white.
    #[default]
    None,
    /// A light.
    Light(White),
    /// The mean colour of these pixels.
    Patch(Rect),
}

/// A light by its name or temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum White {
    /// D65, E or A, from their spectra.
    Illuminant(Illuminant),
    /// Daylight of a nominal temperature, K, on the CIE locus: D50, D55, D75.
    Daylight(u16),
    /// A black body of this temperature, K.
    Temperature(f64),
    /// A light of this CIE 1931 chromaticity x, y. It has no name.
    Chromaticity([f64; 2]),
}

impl White {
    /// The light with this name: `A`, `D50`, `D55`, `D65`, `D75`, `E`, or a temperature such as `3200K`.
    ///
    /// # Errors
    /// A sentence that says what the names are.
    ///
    /// ```
    /// use etalon_picture::develop::White;
    ///
    /// assert_eq!(White::named("D50"), Ok(White::Daylight(5000)));
    /// assert_eq!(White::named("3200K"), Ok(White::Temperature(3200.0)));
    /// assert!(White::named("tungsten").is_err());
    /// ```
    pub fn named(name: &str) -> Result<Self, String> {
        if let Some(illuminant) = Illuminant::named(&name.to_uppercase()) {
            return Ok(Self::Illuminant(illuminant));
        }
        match name.to_uppercase().as_str() {
            "D50" => return Ok(Self::Daylight(5000)),
            "D55" => return Ok(Self::Daylight(5500)),
            "D75" => return Ok(Self::Daylight(7500)),
            _ => {}
        }
        let unknown =
            || "a light is A, D50, D55, D65, D75, E, or the temperature of a black body such as 3200K".to_owned();
        let number = name.strip_suffix(['K', 'k']).ok_or_else(unknown)?;
        let kelvin: f64 = number.trim_end().parse().map_err(|_| unknown())?;
        let [least, most] = TEMPERATURES_K;
        if (least..=most).contains(&kelvin) {
            Ok(Self::Temperature(kelvin))
        } else {
            Err(format!("the temperature of a black body is from {least} K to {most} K"))
        }
    }

    /// Its XYZ, with Y = 1.
    ///
    /// ```
    /// use etalon_picture::develop::White;
    ///
    /// let [x, y, z] = White::named("A")?.xyz();
    /// assert!((x / (x + y + z) - 0.44758).abs() < 2e-5);
    /// # Ok::<(), String>(())
    /// ```
    #[must_use]
    pub fn xyz(self) -> [f64; 3] {
        match self {
            Self::Illuminant(illuminant) => xyz_of(|nm| illuminant.eval(nm)),
            Self::Daylight(nominal_k) => {
                let locus = daylight_chromaticity(f64::from(nominal_k) * RADIATION_CONSTANTS);
                xyz_of_chromaticity(locus.expect("named daylights are on the locus"))
            }
            Self::Temperature(kelvin) => {
                let body = Blackbody::new(kelvin, 1.0).expect("a temperature that was checked");
                let xyz = xyz_of(|nm| body.eval(nm));
                xyz.map(|v| v / xyz[1])
            }
            Self::Chromaticity(xy) => xyz_of_chromaticity(xy),
        }
    }
}

/// The matrix on linear Rec. 709 that makes a light white: complete chromatic adaptation by CAT16
/// ([`etalon_optics::colour::adaptation`]) from its XYZ to the white of Rec. 709 (D65). The luminance of that light stays as it is.
///
/// `None` for an XYZ that no light has which could look white: without positive luminance or cone responses.
///
/// ```
/// use etalon_optics::colour::{multiply, rec709_from_xyz};
/// use etalon_picture::develop::{White, white_balance};
///
/// let lamp = White::named("A")?.xyz();
/// let balanced = multiply(&white_balance(lamp).unwrap(), rec709_from_xyz(lamp));
/// assert!(balanced.iter().all(|v| (v - 1.0).abs() < 1e-12));
/// # Ok::<(), String>(())
/// ```
#[must_use]
pub fn white_balance(white_xyz: [f64; 3]) -> Option<Matrix> {
    // Written so that NaN is refused too.
    let positive = white_xyz[1] > 0.0 && white_xyz[1].is_finite();
    let white = positive.then(|| white_xyz.map(|v| v / white_xyz[1]))?;
    let adapted = adaptation(white, xyz_of_chromaticity(REC709_WHITE_XY))?;
    Some(product(&REC709_FROM_XYZ, &product(&adapted, &XYZ_FROM_REC709)))
}

/// The mean XYZ of a patch of a picture in linear Rec. 709. Pixels that are not finite do not count.
///
/// # Errors
/// If the patch is not within the picture, or none of its pixels is finite.
pub fn patch_xyz<T: Sample>(picture: &Picture<T>, rect: Rect) -> Result<[f64; 3], PictureError> {
    let patch = crop(picture, rect)?;
    let (mut sum, mut count) = ([0.0; 3], 0_usize);
    for rgb in rgb_pixels(&patch)?.filter(|rgb| rgb.iter().all(|v| v.is_finite())) {
        (0..3).for_each(|c| sum[c] += rgb[c]);
        count += 1;
    }
    if count == 0 {
        return Err(PictureError::develop(format!("the patch {rect} has no finite pixel")));
    }
    Ok(rec709_to_xyz(sum.map(|v| v / count as f64)))
}

/// The matrix for a picture, or none where nothing changes.
pub(crate) fn matrix_for<T: Sample>(
    balance: WhiteBalance,
    picture: &Picture<T>,
) -> Result<Option<Matrix>, PictureError> {
    let white = match balance {
        WhiteBalance::None => return Ok(None),
        WhiteBalance::Light(white) => white.xyz(),
        WhiteBalance::Patch(rect) => patch_xyz(picture, rect)?,
    };
    match white_balance(white) {
        Some(matrix) => Ok(Some(matrix)),
        None => Err(PictureError::develop(format!(
            "the patch cannot be the white: its mean XYZ is {:.4}, {:.4}, {:.4}",
            white[0], white[1], white[2]
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_optics::colour::{multiply, rec709_from_xyz};
    use proptest::prelude::*;

    const NAMES: [&str; 9] = ["A", "D50", "D55", "D65", "D75", "E", "1000K", "3200K", "100000K"];

    #[test]
    fn every_named_light_becomes_neutral_and_keeps_its_luminance() {
        for name in NAMES {
            let white = White::named(name).unwrap().xyz();
            let rgb = rec709_from_xyz(white.map(|v| 0.3 * v));
            let balanced = multiply(&white_balance(white).unwrap(), rgb);
            assert!(balanced.iter().all(|v| (v - 0.3).abs() < 1e-12), "{name}: {balanced:?}");
        }
    }

    #[test]
    fn names_are_read_and_others_refused() {
        assert_eq!(White::named("d65"), Ok(White::Illuminant(Illuminant::D65)));
        assert_eq!(White::named("4000 K"), Ok(White::Temperature(4000.0)));
        for bad in ["", "K", "D60", "3200", "-5K", "nanK", "infK", "999K", "1e6K"] {
            assert!(White::named(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_patch_becomes_neutral_and_a_black_one_is_refused() {
        let grey = [0.4_f32, 0.2, 0.1];
        let mut pixels = vec![[1.0_f32; 3]; 16];
        [5, 6].into_iter().for_each(|i| pixels[i] = grey);
        pixels[9] = [f32::NAN, 0.2, 0.1];
        pixels[10] = grey;
        pixels[0] = [0.0; 3];
        let picture = Picture::from_rgb(4, 4, &pixels).unwrap();
        let rect = |x, y, width, height| WhiteBalance::Patch(Rect { x, y, width, height });
        let matrix = matrix_for(rect(1, 1, 2, 2), &picture).unwrap().unwrap();
        let [r, g, b] = multiply(&matrix, grey.map(f64::from));
        assert!((r - g).abs() < 1e-12 && (g - b).abs() < 1e-12, "{r} {g} {b}");
        for (balance, says) in [
            (rect(0, 0, 1, 1), "cannot be the white"),
            (rect(1, 2, 1, 1), "no finite pixel"),
            (rect(3, 3, 2, 1), "4 × 4"),
        ] {
            let error = matrix_for(balance, &picture).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
        assert_eq!(matrix_for(WhiteBalance::None, &picture).unwrap(), None);
    }

    proptest! {
        #[test]
        fn any_mixture_of_light_becomes_neutral(rgb in prop::array::uniform3(0.01..1.0_f64)) {
            let matrix = white_balance(rec709_to_xyz(rgb)).unwrap();
            let [r, g, b] = multiply(&matrix, rgb);
            prop_assert!((r - g).abs() < 1e-12 && (g - b).abs() < 1e-12, "{} {} {}", r, g, b);
        }
    }
}
