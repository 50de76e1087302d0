//! Lights without a surface.

use std::ops::Bound;

use glam::DVec3;

use super::spectra::{BRIGHTEST, Role, Spectra};
use super::spectrum::SpectrumForm;
use crate::files::Files;
use crate::json::{Code, Direction, NonNegative, Optional, Reader, Required, Rule, Spanned};
use crate::linear::unit;
use crate::model::{EnvironmentImage, EnvironmentProjection, Light, LightKind};
use crate::texture::Encoding;

crate::record! {
    /// The same intensity in every direction, from a point.
    pub(crate) struct PointLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// Position, m.
        position_m: Required<[f64; 3]>,
        /// Radiant intensity, W·sr⁻¹·nm⁻¹.
        intensity: Required<SpectrumForm>,
    }
}

crate::number! {
    /// Half of a cone's angle in degrees.
    pub(crate) struct HalfAngle in (Bound::Excluded(0.0), Bound::Included(180.0));
}

crate::number! {
    /// Half of an inner cone's angle in degrees.
    pub(crate) struct InnerAngle in (Bound::Included(0.0), Bound::Included(180.0));
}

crate::record! {
    /// A point that shines into a cone, less and less towards its edge.
    pub(crate) struct SpotLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// Position, m.
        position_m: Required<[f64; 3]>,
        /// The direction of the cone's axis; only the direction counts.
        direction: Required<Direction>,
        /// Radiant intensity along the axis, W·sr⁻¹·nm⁻¹.
        intensity: Required<SpectrumForm>,
        /// Angle from the axis at which nothing is left of the intensity, degrees.
        half_angle_deg: Required<HalfAngle>,
        /// Angle from the axis at which the intensity begins to fall, degrees; four fifths of the other if left out.
        inner_half_angle_deg: Optional<Spanned<InnerAngle>>,
    }
}

crate::record! {
    /// Parallel light, from infinitely far.
    pub(crate) struct DirectionalLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// The direction in which the light travels; only the direction counts.
        direction: Required<Direction>,
        /// Irradiance on a plane at right angles to it, W·m⁻²·nm⁻¹.
        irradiance: Required<SpectrumForm>,
    }
}

crate::record! {
    /// Radiance from infinitely far: the same from every direction, or as an image says.
    pub(crate) struct EnvironmentLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// Radiance from every direction, W·m⁻²·sr⁻¹·nm⁻¹. Either this or `image`.
        radiance: Optional<SpectrumForm>,
        /// An image of all directions. Either this or `radiance`.
        image: Optional<EnvironmentImageForm>,
    } with [Rule::OneOf(&["radiance", "image"])]
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

crate::variants! {
    /// A light without a surface.
    pub(crate) enum LightForm by "type" {
        "point" => Point(PointLight),
        "spot" => Spot(SpotLight),
        "directional" => Directional(DirectionalLight),
        "environment" => Environment(EnvironmentLight),
    }
}

/// The light of a form, the `index`-th of the file.
pub(crate) fn light<'f>(
    form: &'f LightForm,
    index: usize,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Light> {
    let (name, kind) = match form {
        LightForm::Point(point) => {
            let intensity = spectra.resolve(point.intensity.as_ref()?, Role::Emission, reader)?;
            (&point.name, LightKind::Point { position_m: point.position_m?, intensity })
        }
        LightForm::Spot(spot) => {
            let intensity = spectra.resolve(spot.intensity.as_ref()?, Role::Emission, reader)?;
            let outer = spot.half_angle_deg?.0;
            let inner = match spot.inner_half_angle_deg.clone().checked()? {
                Some(inner) if inner.value.0 > outer => {
                    let message = format!("the inner angle of {}° is wider than the cone's {outer}°", inner.value.0);
                    reader.error(Code::OutOfRange, inner.at, message);
                    return None;
                }
                Some(inner) => inner.value.0,
                None => 0.8 * outer,
            };
            let half_angles_rad = [inner, outer].map(f64::to_radians);
            let (position_m, axis) = (spot.position_m?, spot.direction?.0);
            (&spot.name, LightKind::Spot { position_m, axis, half_angles_rad, intensity })
        }
        LightForm::Directional(light) => {
            let irradiance = spectra.resolve(light.irradiance.as_ref()?, Role::Emission, reader)?;
            (&light.name, LightKind::Directional { direction: light.direction?.0, irradiance })
        }
        LightForm::Environment(light) => {
            let kind = match (&light.radiance, &light.image) {
                (Optional::Given(radiance), Optional::Absent) => {
                    LightKind::Environment { radiance: spectra.resolve(radiance, Role::Emission, reader)? }
                }
                (Optional::Absent, Optional::Given(image)) => {
                    LightKind::ImageEnvironment(environment_image(image, spectra, files, reader)?)
                }
                _ => return None,
            };
            (&light.name, kind)
        }
    };
    let name = name.clone().checked()?.unwrap_or_else(|| format!("lights[{index}]"));
    Some(Light { name, kind })
}

crate::keywords!(EnvironmentProjection {
    /// Longitude along its rows, latitude along its columns; the first row is a band that begins at the pole.
    "latitude-longitude" => Self::LatitudeLongitude,
    /// The same with the centres of the first and the last row at the poles.
    "latitude-longitude-at-poles" => Self::LatitudeLongitudeAtPoles,
    /// A square whose texels are all of the same solid angle (Clarberg 2008), each of its own colour.
    "equal-area" => Self::EqualArea,
});

/// Below this sine of the angle between `up` and `forward`, the turn of an image hangs on digits that nobody meant.
const PARALLEL: f64 = 1e-6;

fn environment_image(
    form: &EnvironmentImageForm,
    spectra: &mut Spectra<'_>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<EnvironmentImage> {
    let file = form.file.as_ref()?;
    let image = form.encoding.and_then(|encoding| files.image(file, encoding, reader));
    let axes = form.up.zip(form.forward).and_then(|(up, forward)| {
        let (up, toward) = (DVec3::from(up.value.0), DVec3::from(forward.value.0));
        let across = toward - up * toward.dot(up);
        if across.length() < PARALLEL {
            let hint = "give a \"forward\" across \"up\"";
            reader.error_hint(Code::DegenerateView, forward.at, "\"forward\" is along \"up\"", hint);
            return None;
        }
        // Once more, since rounding left a little along `up`.
        let across = unit(across)?;
        let forward = unit(across - up * across.dot(up))?;
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
