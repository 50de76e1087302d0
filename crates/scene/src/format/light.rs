//! Lights without a surface.

use std::ops::Bound;

use super::spectra::{Role, Spectra};
use super::spectrum::SpectrumForm;
use crate::json::{Code, Direction, Optional, Reader, Required, Spanned};
use crate::model::{Light, LightKind};

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
    /// The same radiance from every direction, from infinitely far.
    pub(crate) struct EnvironmentLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// Radiance, W·m⁻²·sr⁻¹·nm⁻¹.
        radiance: Required<SpectrumForm>,
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
        LightForm::Environment(light) => (
            &light.name,
            LightKind::Environment { radiance: spectra.resolve(light.radiance.as_ref()?, Role::Emission, reader)? },
        ),
    };
    let name = name.clone().checked()?.unwrap_or_else(|| format!("lights[{index}]"));
    Some(Light { name, kind })
}
