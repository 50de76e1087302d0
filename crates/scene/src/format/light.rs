//! Lights without a surface.

use std::f64::consts::{PI, TAU};
use std::ops::Bound;

use glam::DVec3;

use super::environment::{EnvironmentLight, environment};
use super::photometric::{photometric, stated};
use super::slide::{SlideForm, behind_slide};
use super::spectra::{BRIGHTEST, Spectra};
use super::spectrum::SpectrumForm;
use crate::files::Files;
use crate::json::{Code, Direction, NonNegative, Optional, Reader, Required, Rule, Spanned};
use crate::linear::unit;
use crate::model::{Beam, BeamProfile, Light, LightKind};

crate::record! {
    /// The same intensity in every direction, from a point.
    pub(crate) struct PointLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// Position, m.
        position_m: Required<[f64; 3]>,
        /// Radiant intensity, W·sr⁻¹·nm⁻¹. Either this, `intensity_cd` or `flux_lm`.
        intensity: Optional<Box<SpectrumForm>>,
        /// Luminous intensity, cd.
        intensity_cd: Optional<Spanned<NonNegative>>,
        /// Luminous flux into all directions, lm.
        flux_lm: Optional<Spanned<NonNegative>>,
        /// The spectrum of what is stated in photometric units, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
        /// An image before it.
        slide: Optional<SlideForm>,
    } with [Rule::OneOf(&["intensity", "intensity_cd", "flux_lm"]), Rule::NotBoth("intensity", "spectrum")]
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
        /// Radiant intensity along the axis, W·sr⁻¹·nm⁻¹. Either this, `intensity_cd` or `flux_lm`.
        intensity: Optional<Box<SpectrumForm>>,
        /// Luminous intensity along the axis, cd.
        intensity_cd: Optional<Spanned<NonNegative>>,
        /// Luminous flux of the whole cone, lm.
        flux_lm: Optional<Spanned<NonNegative>>,
        /// The spectrum of what is stated in photometric units, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
        /// Angle from the axis at which nothing is left of the intensity, degrees.
        half_angle_deg: Required<HalfAngle>,
        /// Angle from the axis at which the intensity begins to fall, degrees; four fifths of the other if left out.
        inner_half_angle_deg: Optional<Spanned<InnerAngle>>,
        /// An image before it.
        slide: Optional<SlideForm>,
    } with [Rule::OneOf(&["intensity", "intensity_cd", "flux_lm"]), Rule::NotBoth("intensity", "spectrum")]
}

crate::record! {
    /// A point whose luminous intensity a file says for each direction.
    pub(crate) struct LuminaireLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// An IES file (LM-63, photometry of type C) or a EULUMDAT file (`.ldt`), relative to this file's folder.
        file: Required<Spanned<String>>,
        /// Position, m.
        position_m: Required<[f64; 3]>,
        /// Where its vertical angle is 0: down, as it usually hangs; only the direction counts.
        nadir: Required<Spanned<Direction>> = "[0, -1, 0]",
        /// Where its horizontal angle is 0; only its part across `nadir` counts. Seen from above, horizontal angles run counter-clockwise.
        forward: Required<Spanned<Direction>> = "[0, 0, -1]",
        /// Factor on the intensities of the file.
        scale: Required<NonNegative> = "1",
        /// The spectrum of its light, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
        /// An image before it.
        slide: Optional<SlideForm>,
    }
}

crate::record! {
    /// Parallel light, from infinitely far.
    pub(crate) struct DirectionalLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// The direction in which the light travels; only the direction counts.
        direction: Required<Direction>,
        /// Irradiance on a plane at right angles to it, W·m⁻²·nm⁻¹. Either this or `illuminance_lx`.
        irradiance: Optional<Box<SpectrumForm>>,
        /// Illuminance on a plane at right angles to it, lx.
        illuminance_lx: Optional<Spanned<NonNegative>>,
        /// The spectrum of what is stated in photometric units, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
    } with [Rule::OneOf(&["irradiance", "illuminance_lx"]), Rule::NotBoth("irradiance", "spectrum")]
}

crate::number! {
    /// Radius of a beam in metres.
    pub(crate) struct BeamRadius in (Bound::Excluded(0.0), Bound::Unbounded);
}

crate::number! {
    /// Half of the angle by which a beam widens, in degrees.
    pub(crate) struct BeamAngle in (Bound::Included(0.0), Bound::Excluded(90.0));
}

crate::record! {
    /// A beam of light that begins at an aperture, such as of a laser or a collimator.
    pub(crate) struct BeamLight + comment {
        /// Its name, for messages.
        name: Optional<String>,
        /// Middle of the aperture, m.
        position_m: Required<[f64; 3]>,
        /// The direction of the axis; only the direction counts.
        direction: Required<Direction>,
        /// Radius at the aperture, m; of a Gaussian profile that at which irradiance has fallen to 1/e² of that on the axis.
        radius_m: Required<BeamRadius>,
        /// Angle between the axis and the rays at this radius, degrees; 0 is a parallel beam.
        half_angle_deg: Required<BeamAngle> = "0",
        /// How irradiance falls across the beam.
        profile: Required<BeamProfile> = r#""uniform""#,
        /// Power, W·nm⁻¹. Either this or `flux_lm`.
        power: Optional<Box<SpectrumForm>>,
        /// Luminous flux, lm.
        flux_lm: Optional<Spanned<NonNegative>>,
        /// The spectrum of what is stated in photometric units, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
    } with [Rule::OneOf(&["power", "flux_lm"]), Rule::NotBoth("power", "spectrum")]
}

crate::variants! {
    /// A light without a surface.
    pub(crate) enum LightForm by "type" {
        "point" => Point(PointLight),
        "spot" => Spot(SpotLight),
        "luminaire" => Luminaire(LuminaireLight),
        "directional" => Directional(DirectionalLight),
        "beam" => Beam(BeamLight),
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
            let keys = [(&point.intensity_cd, 1.0), (&point.flux_lm, 0.5 / TAU)];
            let intensity = stated(&point.intensity, &keys, &point.spectrum, spectra, reader)?;
            let lamp = LightKind::Point { position_m: point.position_m?, intensity };
            (&point.name, behind_slide(lamp, &point.slide, spectra, files, reader)?)
        }
        LightForm::Spot(spot) => {
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
            // 2π(1 − ½cos inner − ½cos outer), as a sum of squares that loses no digits of narrow cones.
            let of_cones: f64 = half_angles_rad.iter().map(|angle| (0.5 * angle).sin().powi(2)).sum();
            let keys = [(&spot.intensity_cd, 1.0), (&spot.flux_lm, 1.0 / (TAU * of_cones))];
            let intensity = stated(&spot.intensity, &keys, &spot.spectrum, spectra, reader)?;
            let (position_m, axis) = (spot.position_m?, spot.direction?.0);
            let lamp = LightKind::Spot { position_m, axis, half_angles_rad, intensity };
            (&spot.name, behind_slide(lamp, &spot.slide, spectra, files, reader)?)
        }
        LightForm::Luminaire(light) => {
            let lamp = luminaire(light, spectra, files, reader)?;
            (&light.name, behind_slide(lamp, &light.slide, spectra, files, reader)?)
        }
        LightForm::Directional(light) => {
            let keys = [(&light.illuminance_lx, 1.0)];
            let irradiance = stated(&light.irradiance, &keys, &light.spectrum, spectra, reader)?;
            (&light.name, LightKind::Directional { direction: light.direction?.0, irradiance })
        }
        LightForm::Beam(beam) => {
            let power = stated(&beam.power, &[(&beam.flux_lm, 1.0)], &beam.spectrum, spectra, reader)?;
            let radius_m = beam.radius_m?.0;
            // A Gaussian beam has twice the mean on its axis.
            let brightest = 2.0 * power.max_over(spectra.range_nm?) / (PI * radius_m * radius_m);
            if brightest > BRIGHTEST || brightest.is_nan() {
                let message = format!("an irradiance of {brightest:e} is more than {BRIGHTEST:e}");
                reader.error(Code::OutOfRange, beam.at.head(), message);
                return None;
            }
            let kind = Beam {
                position_m: beam.position_m?,
                direction: beam.direction?.0,
                radius_m,
                half_angle_rad: beam.half_angle_deg?.0.to_radians(),
                profile: beam.profile?,
                power,
            };
            (&beam.name, LightKind::Beam(kind))
        }
        LightForm::Environment(light) => (&light.name, environment(light, spectra, files, reader)?),
    };
    let name = name.clone().checked()?.unwrap_or_else(|| format!("lights[{index}]"));
    Some(Light { name, kind })
}

crate::keywords!(BeamProfile {
    /// The same irradiance up to the radius, none beyond.
    "uniform" => Self::Uniform,
    /// exp(−2r²/w²), with the radius w; it ends where this is 1e-12.
    "gaussian" => Self::Gaussian,
});

/// Below this sine of the angle between `up` and `forward`, the turn of an image hangs on digits that nobody meant.
const PARALLEL: f64 = 1e-6;

/// The unit vector of the part of a direction, the key `of`, across the unit vector `axis`, the key `to`.
pub(super) fn across(
    axis: DVec3,
    to: &str,
    of: &str,
    direction: Spanned<Direction>,
    reader: &mut Reader<'_>,
) -> Option<DVec3> {
    let toward = DVec3::from(direction.value.0);
    let across = toward - axis * toward.dot(axis);
    if across.length() < PARALLEL {
        let hint = format!("give a \"{of}\" across \"{to}\"");
        reader.error_hint(Code::DegenerateView, direction.at, format!("\"{of}\" is along \"{to}\""), hint);
        return None;
    }
    // Once more, since rounding left a little along the axis.
    let across = unit(across)?;
    unit(across - axis * across.dot(axis))
}

fn luminaire<'f>(
    form: &'f LuminaireLight,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<LightKind> {
    let photometry = files.photometry(form.file.as_ref()?, reader);
    let axes = form.nadir.zip(form.forward).and_then(|(nadir, forward)| {
        let nadir = DVec3::from(nadir.value.0);
        let forward = across(nadir, "nadir", "forward", forward, reader)?;
        // A quarter turn on, counter-clockwise seen from above.
        Some([nadir, forward, forward.cross(nadir)].map(|axis| axis.to_array()))
    });
    let intensity = photometric(form.scale?.0, form.at, &form.spectrum, spectra, reader);
    let ([nadir, forward, left], photometry) = (axes?, photometry?);
    let brightest = intensity.as_ref()?.max_over(spectra.range_nm?) * photometry.most_cd();
    if brightest > BRIGHTEST {
        let message = format!("an intensity of {brightest:e} is more than {BRIGHTEST:e}");
        reader.error(Code::OutOfRange, form.at.head(), message);
        return None;
    }
    Some(LightKind::Luminaire {
        position_m: form.position_m?,
        nadir,
        planes: [forward, left],
        photometry,
        intensity: intensity?,
    })
}
