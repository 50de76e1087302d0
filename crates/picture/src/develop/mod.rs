//! Developing: from the linear light of a picture to what a screen shows.
//!
//! [`develop`] does it all, in this order:
//!
//! 1. the colour of the file as linear Rec. 709 ([`colour_of`]), or one spectral band of it ([`band_at`]);
//! 2. white balance ([`white_balance`]), by a light or by a patch of the whole picture;
//! 3. crop ([`crop`](fn@crop)); automatic exposure ([`auto_exposure`]) looks at what is left;
//! 4. scale ([`scale`](fn@scale)), in linear light;
//! 5. exposure ([`Exposure`]), a tone curve ([`ToneCurve`]) and sRGB ([`encode_srgb8`](crate::encode_srgb8)).
//!
//! A [`Map`] shows numbers instead, the luminance or its standard error ([`luminance_errors`]), in a perceptually uniform [`palette`] with a
//! legend. [`spectrum_of`] tells the bands of a pixel or region.
//!
//! NaN and infinities are counted, never passed over in silence ([`NotFinite`]).
//!
//! ```
//! use etalon_picture::develop::{Exposure, Settings, develop};
//! use etalon_picture::{Attributes, ExrFile, Picture};
//!
//! let file = ExrFile { picture: Picture::from_rgb(1, 1, &[[0.25; 3]])?, attributes: Attributes::new() };
//! let developed = develop(&file, &Settings { exposure: Exposure::Stops(2.0), ..Settings::default() })?;
//! assert_eq!(developed.image.pixels, [255; 3]);
//! # Ok::<(), etalon_picture::PictureError>(())
//! ```

mod band;
mod colour;
mod crop;
mod error_map;
mod exposure;
mod false_colour;
mod glyphs;
mod legend;
mod palette;
mod scale;
mod spectrum;
mod tone_curve;
mod white_balance;

pub use band::{SpectralBand, band_at, bands_of};
pub(crate) use band::{band_edges_nm, no_bands};
pub use colour::{colour_of, is_radiance, luminance_unit};
pub use crop::{Rect, crop};
pub use error_map::{ErrorKind, luminance_errors};
pub use exposure::{Exposure, MAX_STOPS, MIDDLE_GREY, auto_exposure};
pub use false_colour::{Axis, ColourScale, NOT_FINITE, short_number};
pub use legend::with_legend;
pub use palette::palette;
pub use scale::{MAX_SCALED_PIXELS, scale, scaled_size};
pub use spectrum::{BandMean, spectrum_of};
pub use tone_curve::{ToneCurve, agx, agx_curve, filmic};
pub use white_balance::{TEMPERATURES_K, White, WhiteBalance, patch_xyz, white_balance};

use etalon_optics::colour::{Matrix, multiply};

use crate::srgb::encode_with;
use crate::{Clipping, ExrFile, Picture, PictureError, Rgb8, Sample};

/// How a picture is developed. The default shows all of it as it is, in sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The part that is shown; all of it if `None`.
    pub crop: Option<Rect>,
    /// Factor on the number of pixels of each side.
    pub scale: f64,
    /// The wavelength, nm, of the spectral band that is shown, as grey or in a map; the colour if `None`.
    pub band_nm: Option<f64>,
    /// What light looks white. Not used for a band or a map.
    pub white_balance: WhiteBalance,
    /// How much the picture is brightened. Not used for a map.
    pub exposure: Exposure,
    /// How bright parts are brought into the range of the screen. Not used for a map.
    pub curve: ToneCurve,
    /// Numbers in false colour, instead of a picture.
    pub map: Option<Map>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            crop: None,
            scale: 1.0,
            band_nm: None,
            white_balance: WhiteBalance::None,
            exposure: Exposure::Stops(0.0),
            curve: ToneCurve::Linear,
            map: None,
        }
    }
}

/// Numbers shown in false colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The standard error, or the luminance or band itself if `None`.
    pub error: Option<ErrorKind>,
    /// How values are spread over the palette.
    pub axis: Axis,
    /// The values at the ends of the palette; those of [`ColourScale::fitting`] if `None`.
    pub range: Option<[f64; 2]>,
}

/// A picture for a screen, and what was done and lost on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Developed {
    /// Its pixels.
    pub image: Rgb8,
    /// What became of the values.
    pub tone: Tone,
    /// The centre of the band that is shown, nm.
    pub band_nm: Option<f64>,
    /// Pixels of the part shown, before it is scaled, that are not finite.
    pub not_finite: NotFinite,
}

/// How values became levels.
#[derive(Clone, Debug, PartialEq)]
pub enum Tone {
    /// By exposure and tone curve.
    Picture {
        /// The exposure, stops.
        exposure_ev: f64,
        /// What 8 bits could not hold.
        clipping: Clipping,
    },
    /// By false colour.
    Map {
        /// What the numbers are, with their unit.
        title: String,
        /// The values at the ends of the palette.
        range: [f64; 2],
        /// Finite values below the range, in pixels of the result.
        below: usize,
        /// Finite values above it.
        above: usize,
    },
}

/// Pixels with a NaN or an infinity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NotFinite {
    /// How many there are.
    pub count: usize,
    /// Column and row of the first, in the whole picture.
    pub first: Option<[usize; 2]>,
}

/// Develops a picture: see the [module](self).
///
/// # Errors
/// A file that lacks what is asked for. A rectangle outside of the picture. A size that is too large. An automatic exposure or range where
/// there is no light.
pub fn develop(file: &ExrFile, settings: &Settings) -> Result<Developed, PictureError> {
    let whole = Rect { x: 0, y: 0, width: file.picture.width(), height: file.picture.height() };
    let shown = settings.crop.unwrap_or(whole);
    shown.check_within(whole.width, whole.height)?;
    let size = match settings.scale {
        // Also of a picture that is larger than what may be made.
        1.0 => (shown.width, shown.height),
        factor => scaled_size(shown.width, shown.height, factor)?,
    };
    match settings.map {
        Some(map) => develop_map(file, settings, map, shown, size),
        None => develop_picture(file, settings, shown, size),
    }
}

fn develop_picture(
    file: &ExrFile,
    settings: &Settings,
    shown: Rect,
    size: (usize, usize),
) -> Result<Developed, PictureError> {
    let (picture, band_nm) = match settings.band_nm {
        None => (colour_of(file)?, None),
        Some(nm) => {
            let band = band_at(&file.picture, nm)?;
            let mut grey = Picture::new(file.picture.width(), file.picture.height())?;
            for name in ["R", "G", "B"] {
                grey.insert(name, band.samples.to_vec())?;
            }
            (grey, Some(band.centre_nm))
        }
    };
    let matrix = match settings.band_nm {
        None => white_balance::matrix_for(settings.white_balance, &picture)?,
        Some(_) => None,
    };
    let part = if settings.crop.is_some() { crop(&picture, shown)? } else { picture };
    let not_finite = not_finite(&part, shown);
    let balanced = |rgb: [f64; 3]| -> [f64; 3] { matrix.as_ref().map_or(rgb, |m: &Matrix| multiply(m, rgb)) };
    let exposure_ev = match settings.exposure {
        Exposure::Stops(stops) => stops,
        Exposure::Auto => {
            exposure::auto_or_refuse(colour::rgb_pixels(&part)?.map(|rgb| colour::luminance(balanced(rgb))))?
        }
    };
    let scaled = resize(part, size)?;
    let gain = Exposure::gain(exposure_ev);
    let light = |rgb: [f64; 3]| settings.curve.apply(balanced(rgb).map(|v| gain * v));
    let (image, clipping) = encode_with(&scaled, light)?;
    Ok(Developed { image, tone: Tone::Picture { exposure_ev, clipping }, band_nm, not_finite })
}

fn develop_map(
    file: &ExrFile,
    settings: &Settings,
    map: Map,
    shown: Rect,
    size: (usize, usize),
) -> Result<Developed, PictureError> {
    let numbers = numbers(file, settings.band_nm, map.error)?;
    let part = crop(&numbers.picture, shown)?;
    let not_finite = not_finite(&part, shown);
    let scaled = resize(part, size)?;
    let values: Vec<f64> = match (map.error, scaled.channel("error")) {
        (Some(kind), Some(errors)) => {
            errors.iter().zip(scaled.require("value")?).map(|(error, value)| kind.of(*error, *value)).collect()
        }
        _ => scaled.require("value")?.to_vec(),
    };
    let scale = match map.range {
        Some(range) => ColourScale::new(map.axis, range).map_err(PictureError::develop)?,
        None => ColourScale::fitting(map.axis, values.iter().copied()).ok_or_else(|| {
            PictureError::develop(format!(
                "there is no value to choose a range from ({}): give --range LOW:HIGH",
                numbers.title
            ))
        })?,
    };
    let pixels = values.iter().flat_map(|value| scale.colour(*value)).collect();
    let image = Rgb8 { width: size.0, height: size.1, pixels };
    let [low, high] = scale.range();
    let count = |of: &dyn Fn(f64) -> bool| values.iter().filter(|v| v.is_finite() && of(**v)).count();
    let (below, above) = (count(&|v| v < low), count(&|v| v > high));
    let image = with_legend(&image, &scale, &numbers.title, values.iter().any(|v| !v.is_finite()));
    let tone = Tone::Map { title: numbers.title, range: scale.range(), below, above };
    Ok(Developed { image, tone, band_nm: numbers.band_nm, not_finite })
}

/// What a map shows.
struct Numbers {
    /// Channels `value` and, for an error, `error`.
    picture: Picture<f64>,
    title: String,
    band_nm: Option<f64>,
}

fn numbers(file: &ExrFile, band_nm: Option<f64>, error: Option<ErrorKind>) -> Result<Numbers, PictureError> {
    let wide = |samples: &[f32]| samples.iter().map(|v| f64::from(*v)).collect::<Vec<f64>>();
    let (values, errors, what, unit, band_nm) = match band_nm {
        Some(nm) => {
            let band = band_at(&file.picture, nm)?;
            let errors = error.map(|_| error_map::band_errors(file, &band)).transpose()?.map(wide);
            let unit = if is_radiance(&file.attributes) { "W/(m² sr nm)" } else { "channel units" };
            let what = format!("radiance at {} nm", band.centre_nm);
            (wide(band.samples), errors, what, unit, Some(band.centre_nm))
        }
        None => {
            let scale = luminance_unit(&file.attributes);
            let scaled = |values: Vec<f64>| values.into_iter().map(|v| scale.unwrap_or(1.0) * v).collect::<Vec<f64>>();
            let errors = error.map(|_| luminance_errors(file)).transpose()?.map(scaled);
            let values = scaled(error_map::luminances(&colour_of(file)?)?);
            let unit = if scale.is_some() { "cd/m²" } else { "channel units" };
            (values, errors, "luminance".to_owned(), unit, None)
        }
    };
    let title = match error {
        None => format!("{what}, {unit}"),
        Some(ErrorKind::Absolute) => format!("standard error of {what}, {unit}"),
        Some(ErrorKind::Relative) => format!("relative standard error of {what}"),
    };
    let mut picture = Picture::new(file.picture.width(), file.picture.height())?;
    picture.insert("value", values)?;
    if let Some(errors) = errors {
        picture.insert("error", errors)?;
    }
    Ok(Numbers { picture, title, band_nm })
}

fn resize<T: Sample>(picture: Picture<T>, (width, height): (usize, usize)) -> Result<Picture<T>, PictureError> {
    if (picture.width(), picture.height()) == (width, height) { Ok(picture) } else { scale(&picture, width, height) }
}

/// The pixels of a part of a picture with any channel that is not finite.
fn not_finite<T: Sample>(part: &Picture<T>, place: Rect) -> NotFinite {
    let mut found = NotFinite::default();
    for i in 0..part.width() * part.height() {
        if part.channels().iter().any(|channel| !channel.samples[i].to_f64().is_finite()) {
            found.count += 1;
            found.first.get_or_insert([place.x + i % part.width(), place.y + i / part.width()]);
        }
    }
    found
}

#[cfg(test)]
mod tests;
