//! A scene as a renderer without spectra has it: every spectrum replaced by a colour.
//!
//! The colours become spectra again, such that each of three wavelengths shows one channel; the kernel looks nowhere else.

use super::study::{StudyError, fix_indices, fix_lens, index_at_reference, lights_mut};
use super::{EffectName, evidence, grey};
use etalon_optics::colour::rec709_from_xyz;
use etalon_optics::spectrum::Outside;
use etalon_optics::{Illuminant, Spectrum};
use etalon_scene::{MaterialKind, Metal, ParameterMut, Scene, SpectrumTexture};

/// Wavelengths that stand for blue, green and red, nm; of metals, whose indices stay what they are, they are chosen.
pub(crate) const CHANNELS_NM: [f64; 3] = [450.0, 545.0, 610.0];

/// Whether a scene has colours that three channels can stand for.
pub(super) fn check(scene: &Scene) -> Result<(), StudyError> {
    let refused =
        |because: &str| Err(StudyError::Contradicted { effect: EffectName::Wavelengths, because: because.to_owned() });
    let [first, last] = scene.integrator.wavelength_range_nm;
    if first > CHANNELS_NM[0] || last < CHANNELS_NM[2] {
        return refused("three channels need the whole visible range");
    }
    if evidence::of(EffectName::Textures, scene).is_ok() {
        return refused("images become spectra, which three channels do not have");
    }
    if scene.lights.iter().any(|light| light.kind.slide().is_some() && light.kind.has_colours()) {
        return refused("colours of slides become spectra, which three channels do not have");
    }
    if evidence::of(EffectName::Scattering, scene).is_ok() {
        return refused("media scatter, which three channels do not follow");
    }
    if evidence::of(EffectName::Fluorescence, scene).is_ok() {
        return refused("surfaces fluoresce, which three channels do not follow");
    }
    let tinted = |kind: &MaterialKind| matches!(kind, MaterialKind::Principled { lobes, .. } if lobes.has_tints());
    if scene.materials.iter().any(|material| material.kind.parts().into_iter().any(tinted)) {
        return refused("lobes have the colour of a base over its luminance, which three channels do not know");
    }
    if scene.film.bands.is_some() {
        return refused("bands hold wavelengths, which three channels do not have");
    }
    Ok(())
}

/// Replaces every spectrum.
pub(super) fn replace(scene: &mut Scene) {
    let range_nm = scene.integrator.wavelength_range_nm;
    fix_lens(scene);
    lights_mut(scene).for_each(|spectrum| *spectrum = channels(grey::xyz_over(spectrum, range_nm), f64::INFINITY));
    scene.materials.iter_mut().for_each(|material| {
        fix_indices(&mut material.kind, range_nm);
        colour(&mut material.kind, range_nm);
    });
}

fn colour(kind: &mut MaterialKind, range_nm: [f64; 2]) {
    let shown = |spectrum: &Spectrum| channels(Illuminant::D65.xyz_of_reflectance(|nm| spectrum.eval(nm)), 1.0);
    for parameter in kind.parameters_mut() {
        match parameter {
            // Images are refused.
            ParameterMut::Reflectance(reflectance) | ParameterMut::Metal(Metal::Reflectance(reflectance)) => {
                if let SpectrumTexture::Uniform(spectrum) = reflectance {
                    *spectrum = shown(spectrum);
                }
            }
            ParameterMut::Coat(index) | ParameterMut::Principled(index) => *index = index_at_reference(index, range_nm),
            // A film is what it is at the wavelengths of the channels.
            ParameterMut::Metal(Metal::Index(_))
            | ParameterMut::Interface(_)
            | ParameterMut::Sheet(_)
            | ParameterMut::Film(_)
            // So is what was measured.
            | ParameterMut::Measured(_)
            | ParameterMut::Grating(_)
            // Refused.
            | ParameterMut::Fluorescence(_) => {}
        }
    }
}

/// A spectrum that shows each channel of a colour, cut to 0 and `most`, at its wavelength.
fn channels(xyz: [f64; 3], most: f64) -> Spectrum {
    let [red, green, blue] = rec709_from_xyz(xyz).map(|v| v.clamp(0.0, most));
    Spectrum::tabulated(CHANNELS_NM.to_vec(), vec![blue, green, red], Outside::Hold)
        .expect("channels are cut to what is valid")
}
