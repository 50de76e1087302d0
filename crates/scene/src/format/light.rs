//! Lights without a surface.

use super::spectra::{Role, Spectra};
use super::spectrum::SpectrumForm;
use crate::json::{Direction, Optional, Reader, Required};
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
    let mut resolve = |form: &'f Option<SpectrumForm>| spectra.resolve(form.as_ref()?, Role::Emission, reader);
    let (name, kind) = match form {
        LightForm::Point(point) => {
            let intensity = resolve(&point.intensity)?;
            (&point.name, LightKind::Point { position_m: point.position_m?, intensity })
        }
        LightForm::Directional(light) => {
            let irradiance = resolve(&light.irradiance)?;
            (&light.name, LightKind::Directional { direction: light.direction?.0, irradiance })
        }
        LightForm::Environment(light) => (&light.name, LightKind::Environment { radiance: resolve(&light.radiance)? }),
    };
    let name = name.clone().checked()?.unwrap_or_else(|| format!("lights[{index}]"));
    Some(Light { name, kind })
}
