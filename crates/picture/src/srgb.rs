//! Linear light to what a screen shows.

use crate::{Picture, PictureError, Sample};

/// A picture of 8-bit RGB pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgb8 {
    /// Width, pixels.
    pub width: usize,
    /// Height, pixels.
    pub height: usize,
    /// Red, green and blue of each pixel in turn, row after row from the top: 3 · width · height bytes.
    pub pixels: Vec<u8>,
}

/// Encodes a linear value for an sRGB display (IEC 61966-2-1:1999): 12.92·x up to 0.0031308, 1.055·x^(1/2.4) − 0.055
/// above. Nothing is clamped: values below 0 keep the linear branch, values above 1 the power.
#[must_use]
pub fn encode_srgb(linear: f64) -> f64 {
    if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Decodes an sRGB value to linear light (IEC 61966-2-1:1999), the inverse of [`encode_srgb`].
#[must_use]
pub fn decode_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// What the 8 bits of an [`Rgb8`] could not hold, in pixels; one pixel can count in more than one of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clipping {
    /// Pixels with a component too bright to show.
    pub above: usize,
    /// Pixels with a negative component: colours outside the display's gamut.
    pub below: usize,
    /// Pixels with a NaN or infinite component.
    pub non_finite: usize,
    /// Pixels with any of these.
    pub any: usize,
    /// Pixels of the picture.
    pub of: usize,
}

/// Makes an 8-bit sRGB picture of channels `R`, `G`, `B`: linear values times 2^`exposure_ev`, encoded, clipped to the
/// range that can be shown and rounded to the nearest of 256 levels.
///
/// A pixel counts as clipped when that moved a component further than rounding does, half a level. NaN and −∞ show as 0,
/// +∞ as 255, and are counted apart.
///
/// # Errors
/// A missing channel.
pub fn encode_srgb8<T: Sample>(picture: &Picture<T>, exposure_ev: f64) -> Result<(Rgb8, Clipping), PictureError> {
    let scale = exposure_ev.exp2();
    encode_with(picture, |rgb| rgb.map(|linear| scale * linear))
}

/// [`encode_srgb8`] with any function from the picture's linear light to that of the screen.
pub(crate) fn encode_with<T: Sample>(
    picture: &Picture<T>,
    light: impl Fn([f64; 3]) -> [f64; 3],
) -> Result<(Rgb8, Clipping), PictureError> {
    let channels = [picture.require("R")?, picture.require("G")?, picture.require("B")?];
    let mut clipping = Clipping { of: picture.width() * picture.height(), ..Clipping::default() };
    let mut pixels = Vec::with_capacity(3 * clipping.of);
    for index in 0..clipping.of {
        let linear = channels.map(|channel| channel[index].to_f64());
        let finite = linear.map(f64::is_finite);
        let levels = light(linear).map(|value| 255.0 * encode_srgb(value));
        let (mut above, mut below) = (false, false);
        for (level, finite) in levels.into_iter().zip(finite) {
            above |= finite && level > 255.5;
            below |= finite && level < -0.5;
            // Saturates, and takes NaN to 0.
            pixels.push(level.round() as u8);
        }
        let non_finite = finite != [true; 3];
        clipping.above += usize::from(above);
        clipping.below += usize::from(below);
        clipping.non_finite += usize::from(non_finite);
        clipping.any += usize::from(above || below || non_finite);
    }
    Ok((Rgb8 { width: picture.width(), height: picture.height(), pixels }, clipping))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn encoding_gives_the_published_levels() {
        // Level of linear 0.18, 0.5 and of the segment's joint, computed by hand to 9 digits.
        for (linear, encoded) in
            [(0.0, 0.0), (1.0, 1.0), (0.18, 0.461356130), (0.5, 0.735356983), (0.0031308, 0.040449936)]
        {
            assert!((encode_srgb(linear) - encoded).abs() < 1e-9, "{linear} encodes to {}", encode_srgb(linear));
        }
    }

    #[test]
    fn the_two_branches_meet_where_the_standard_says() {
        // The standard rounds its constants; the step they leave at the joint is 3e-8.
        let below = encode_srgb(0.0031308);
        let above = encode_srgb(0.0031308_f64.next_up());
        assert!((above - below).abs() < 5e-8);
    }

    #[test]
    fn clipping_counts_pixels_and_tells_its_kinds_apart() {
        let inf = f32::INFINITY;
        let pixels = [
            [0.0, 0.5, 1.0],      // shown
            [2.0, 3.0, 0.0],      // above, once
            [1.0005, 0.0, 0.0],   // above by less than half a level: 255.06
            [-0.1, 0.0, 0.0],     // below
            [-1e-4, 0.0, 0.0],    // below by less than half a level: −0.33
            [-0.1, 2.0, 0.0],     // both
            [f32::NAN, 0.0, inf], // not finite
            [-inf, 0.0, 0.0],     // not finite
        ];
        let picture = Picture::from_rgb(4, 2, &pixels).unwrap();
        let (shown, clipping) = encode_srgb8(&picture, 0.0).unwrap();
        assert_eq!(clipping, Clipping { above: 2, below: 2, non_finite: 2, any: 5, of: 8 });
        assert_eq!(shown.pixels[..3], [0, 188, 255]);
        assert_eq!(shown.pixels[18..], [0, 0, 255, 0, 0, 0]);
    }

    #[test]
    fn one_stop_doubles_the_light() {
        let dim = Picture::from_rgb(1, 1, &[[0.1_f64, 0.2, 0.4]]).unwrap();
        let bright = Picture::from_rgb(1, 1, &[[0.2_f64, 0.4, 0.8]]).unwrap();
        assert_eq!(encode_srgb8(&dim, 1.0).unwrap(), encode_srgb8(&bright, 0.0).unwrap());
        assert_eq!(encode_srgb8(&dim, 0.0).unwrap(), encode_srgb8(&bright, -1.0).unwrap());
    }

    proptest! {
        #[test]
        fn decoding_inverts_encoding(linear in 0.0..4.0_f64) {
            // The standard's rounded constants make the branches overlap by 3e-8 near the joint; elsewhere the inverse
            // is good to rounding.
            let near_joint = (linear - 0.0031308).abs() < 1e-7;
            let tolerance = if near_joint { 1e-7 } else { 1e-13 };
            prop_assert!((decode_srgb(encode_srgb(linear)) - linear).abs() < tolerance);
        }

        #[test]
        fn every_level_is_the_nearest_to_the_formula(linear in -0.5..1.5_f32, exposure_ev in -3.0..3.0_f64) {
            let picture = Picture::from_rgb(1, 1, &[[linear; 3]]).unwrap();
            let (shown, clipping) = encode_srgb8(&picture, exposure_ev).unwrap();
            let light = f64::from(linear) * 2.0_f64.powf(exposure_ev);
            let ideal = if light <= 0.0031308 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
            let level = f64::from(shown.pixels[0]);
            // Half a level, and the rounding of two ways to write the exposure.
            prop_assert!((level - 255.0 * ideal.clamp(0.0, 1.0)).abs() <= 0.5 + 1e-9);
            prop_assert_eq!(clipping.any == 1, !(-0.5..=255.5).contains(&(255.0 * ideal)));
        }
    }
}
