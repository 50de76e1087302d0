//! Light from infinity: everywhere the same, by an image, or by the formula of a sky.

use glam::DVec3;

use super::light::across;
use super::photometric::stated;
use super::spectra::{BRIGHTEST, Spectra};
use super::spectrum::SpectrumForm;
use crate::files::Files;
use crate::json::{Code, Direction, NonNegative, Optional, Positive, Reader, Required, Rule, Spanned, Whole};
use crate::model::{CieSky, DaylightExtremes, DaylightSky, EnvironmentImage, EnvironmentProjection, LightKind};
use crate::texture::Encoding;

crate::record! {
    /// Radiance from infinitely far: the same from every direction, as an image says, or as a sky by formula.
    pub(crate) struct EnvironmentLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// Radiance from every direction, W·m⁻²·sr⁻¹·nm⁻¹. Either this, `luminance_cd_per_m2`, `image`, `sky` or `daylight`.
        radiance: Optional<Box<SpectrumForm>>,
        /// Luminance from every direction, cd·m⁻².
        luminance_cd_per_m2: Optional<Spanned<NonNegative>>,
        /// The spectrum of a luminance, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
        /// An image of all directions.
        image: Optional<EnvironmentImageForm>,
        /// A standard sky of the CIE.
        sky: Optional<SkyForm>,
        /// A sky with the colours of daylight.
        daylight: Optional<DaylightForm>,
    } with [
        Rule::OneOf(&["radiance", "luminance_cd_per_m2", "image", "sky", "daylight"]),
        Rule::Needs("spectrum", &["luminance_cd_per_m2"]),
    ]
}

crate::record! {
    /// One of the sixteen standard skies (CIE S 011, ISO 15469), without the sun itself.
    pub(crate) struct SkyForm + comment {
        /// Its number: 1 to 15, or 16, the traditional overcast sky.
        cie_type: Required<Whole<1, 16>>,
        /// Toward the sun; only the direction counts. The skies 1, 3, 5 and 16 do without it.
        sun_direction: Optional<Spanned<Direction>>,
        /// Toward the zenith; only the direction counts.
        up: Required<Direction> = "[0, 1, 0]",
        /// Radiance of the zenith, W·m⁻²·sr⁻¹·nm⁻¹. Either this or `zenith_luminance_cd_per_m2`.
        zenith_radiance: Optional<Box<SpectrumForm>>,
        /// Luminance of the zenith, cd·m⁻².
        zenith_luminance_cd_per_m2: Optional<Spanned<NonNegative>>,
        /// The spectrum of a luminance, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
        /// Radiance from below the horizon, in units of that of the zenith.
        ground: Required<Spanned<NonNegative>> = "0",
    } with [
        Rule::OneOf(&["zenith_radiance", "zenith_luminance_cd_per_m2"]),
        Rule::Needs("spectrum", &["zenith_luminance_cd_per_m2"]),
    ]
}

crate::record! {
    /// A clear or hazy sky with the colours of daylight (Preetham, Shirley & Smits 1999), without the sun itself.
    pub(crate) struct DaylightForm + comment {
        /// How much more air with its haze scatters than air alone: from 2, very clear, to 10, a thick haze.
        turbidity: Required<Spanned<Positive>> = "3",
        /// Toward the sun; only the direction counts.
        sun_direction: Required<Spanned<Direction>>,
        /// Toward the zenith; only the direction counts.
        up: Required<Direction> = "[0, 1, 0]",
        /// Radiance from below the horizon, in units of that of the zenith.
        ground: Required<Spanned<NonNegative>> = "0",
        /// Factor on the radiance of all directions; 1 is that of the real sky.
        scale: Required<NonNegative> = "1",
    }
}

crate::record! {
    /// An image of all directions.
    pub(crate) struct EnvironmentImageForm + comment {
        /// An EXR, HDR, PNG or JPEG file, relative to this file's folder.
        file: Required<Spanned<String>>,
        /// How its numbers are to be read.
        encoding: Required<Encoding> = r#""auto""#,
        /// How directions stand in it.
        projection: Required<EnvironmentProjection> = r#""latitude-longitude""#,
        /// Factor on the radiance; of 1, white (1, 1, 1) has the luminance of the constant spectrum 1.
        scale: Required<NonNegative> = "1",
        /// The direction of the image's upper edge, or in the middle of an equal-area square.
        up: Required<Spanned<Direction>> = "[0, 1, 0]",
        /// The direction in the middle of the image, or of the middle of the lower edge of an equal-area square; only its part
        /// across `up` counts.
        forward: Required<Spanned<Direction>> = "[0, 0, -1]",
        /// Whether left and right of the image change places.
        mirrored: Required<bool> = "false",
        /// Turns the whole about `up`, counter-clockwise when `up` points at the viewer, degrees.
        rotation_deg: Required<f64> = "0",
    }
}

crate::keywords!(EnvironmentProjection {
    /// Longitude along its rows, latitude along its columns; the first row is a band that begins at the pole.
    "latitude-longitude" => Self::LatitudeLongitude,
    /// The same with the centres of the first and the last row at the poles.
    "latitude-longitude-at-poles" => Self::LatitudeLongitudeAtPoles,
    /// A square whose texels are all of the same solid angle (Clarberg 2008), each of its own colour.
    "equal-area" => Self::EqualArea,
});

/// What a form says.
pub(super) fn environment<'f>(
    form: &'f EnvironmentLight,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<LightKind> {
    let given = [form.radiance.is_present(), form.luminance_cd_per_m2.is_present()];
    Some(match (given, &form.image, &form.sky, &form.daylight) {
        ([true, false] | [false, true], Optional::Absent, Optional::Absent, Optional::Absent) => {
            let keys = [(&form.luminance_cd_per_m2, 1.0)];
            let radiance = stated(&form.radiance, &keys, &form.spectrum, spectra, reader)?;
            LightKind::Environment { radiance }
        }
        ([false, false], Optional::Given(image), Optional::Absent, Optional::Absent) => {
            LightKind::ImageEnvironment(environment_image(image, spectra, files, reader)?)
        }
        ([false, false], Optional::Absent, Optional::Given(form), Optional::Absent) => {
            LightKind::Sky(sky(form, spectra, reader)?)
        }
        ([false, false], Optional::Absent, Optional::Absent, Optional::Given(form)) => {
            LightKind::Daylight(daylight(form, spectra, reader)?)
        }
        _ => return None,
    })
}

fn sky<'f>(form: &'f SkyForm, spectra: &mut Spectra<'f>, reader: &mut Reader<'_>) -> Option<CieSky> {
    let keys = [(&form.zenith_luminance_cd_per_m2, 1.0)];
    let zenith = stated(&form.zenith_radiance, &keys, &form.spectrum, spectra, reader);
    let up = form.up?.0;
    let sun = form.sun_direction.clone().checked()?;
    let number = form.cie_type?.0 as u8;
    let sky =
        CieSky { number, up, sun: sun.map_or(up, |sun| sun.value.0), zenith: zenith?, ground: form.ground?.value.0 };
    if sky.needs_sun() && sun.is_none() {
        let message = format!("the sky {number} depends on where the sun is");
        reader.error_hint(Code::MissingKey, form.at.head(), message, "add \"sun_direction\"");
        return None;
    }
    if let Some(sun) = sun {
        by_day(up, sun, reader)?;
    }
    if sky.ground * sky.zenith.max_over(spectra.range_nm?) > BRIGHTEST {
        reader.error(Code::OutOfRange, form.ground?.at, format!("the ground is brighter than {BRIGHTEST:e}"));
        return None;
    }
    Some(sky)
}

/// Complains where the sun is below the horizon.
fn by_day(up: [f64; 3], sun: Spanned<Direction>, reader: &mut Reader<'_>) -> Option<()> {
    if DVec3::from(sun.value.0).dot(DVec3::from(up)) < 0.0 {
        let hint = "this describes skies by day";
        reader.error_hint(Code::OutOfRange, sun.at, "the sun is below the horizon", hint);
        return None;
    }
    Some(())
}

/// The least share of its largest value to which a spectrum of daylight may fall in the directions that are tried. From one of these to the
/// next it changes by far less.
const DARKEST_DAYLIGHT: f64 = 0.01;

fn daylight(form: &DaylightForm, spectra: &mut Spectra<'_>, reader: &mut Reader<'_>) -> Option<DaylightSky> {
    let (turbidity, sun, up, ground) = (form.turbidity?, form.sun_direction?, form.up?.0, form.ground?);
    let [least, most] = DaylightSky::TURBIDITIES;
    if !(least..=most).contains(&turbidity.value.0) {
        let message = format!("a turbidity of {} is not from {least} to {most}", turbidity.value.0);
        reader.error(Code::OutOfRange, turbidity.at, message);
        return None;
    }
    by_day(up, sun, reader)?;
    let mean = spectra.mean_daylight(form.scale?.0, form.at, reader)?;
    let sky = DaylightSky { turbidity: turbidity.value.0, up, sun: sun.value.0, ground: ground.value.0, mean };
    let DaylightExtremes { brightest, darkest, darkest_nm } = sky.extremes(spectra.range_nm?);
    if darkest.is_nan() || darkest < DARKEST_DAYLIGHT {
        let message = format!("with a sun as low as this, the model leaves no light at {darkest_nm} nm");
        reader.error_hint(Code::OutOfRange, sun.at, message, "raise the sun, or state another turbidity");
        return None;
    }
    let brightest = brightest * sky.mean.max_over(spectra.range_nm?);
    if brightest > BRIGHTEST {
        let message = format!("a radiance of {brightest:e} is more than {BRIGHTEST:e}");
        reader.error(Code::OutOfRange, form.at.head(), message);
        return None;
    }
    Some(sky)
}

fn environment_image(
    form: &EnvironmentImageForm,
    spectra: &mut Spectra<'_>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<EnvironmentImage> {
    let file = form.file.as_ref()?;
    let image = form.encoding.and_then(|encoding| files.image(file, encoding, reader));
    let axes = form.up.zip(form.forward).and_then(|(up, forward)| {
        let up = DVec3::from(up.value.0);
        let forward = across(up, "up", "forward", forward, reader)?;
        let right = forward.cross(up);
        let (sin, cos) = form.rotation_deg?.to_radians().sin_cos();
        let turned = |along: f64, across: f64| forward * along + right * across;
        let hand = if form.mirrored? { -1.0 } else { 1.0 };
        Some([turned(cos, -sin), turned(sin, cos) * hand, up].map(|axis| axis.to_array()))
    });
    let white = spectra.daylight(form.scale?.0, form.at, reader);
    let (image, projection) = (image?, form.projection?);
    let wrong = match projection {
        EnvironmentProjection::EqualArea if image.width != image.height => Some("an equal-area image is a square"),
        EnvironmentProjection::LatitudeLongitudeAtPoles if image.height < 2 => Some("two poles need two rows"),
        _ => None,
    };
    if let Some(wrong) = wrong {
        let message = format!("{}: {wrong}, and this is {} × {}", file.value, image.width, image.height);
        reader.error(Code::OutOfRange, file.at, message);
        return None;
    }
    let texel_at = |i: usize| (i % image.width as usize, i / image.width as usize);
    if let Some(i) = image.linear_texels().position(|texel| texel.iter().any(|v| *v < 0.0)) {
        let (column, row) = texel_at(i);
        let message = format!("{}: the texel in column {column}, row {row} is below 0", file.value);
        reader.error(Code::NegativeEmission, file.at, message);
        return None;
    }
    let ([forward, right, up], white) = (axes?, white?);
    let brightest = white.max_over(spectra.range_nm?);
    if let Some(i) = image.linear_texels().position(|t| t.iter().any(|v| v * brightest > BRIGHTEST)) {
        let (column, row) = texel_at(i);
        let message = format!("{}: the texel in column {column}, row {row} is more than {BRIGHTEST:e}", file.value);
        reader.error_hint(
            Code::OutOfRange,
            file.at,
            message,
            "pictures store single-precision numbers, which cannot hold it",
        );
        return None;
    }
    Some(EnvironmentImage { image, name: file.value.clone(), projection, forward, right, up, white })
}
