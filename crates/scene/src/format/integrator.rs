//! How to integrate.

use super::spectrum::Wavelength;
use crate::json::{Code, Nullable, Reader, Required, Spanned, Whole};
use crate::model::{Integrator, LightSampling, LightSelection, LightTracing, MOST_REPLICATES, PathReuse, SamplerKind};

crate::record! {
    /// How to integrate. The command line may override each key.
    pub(crate) struct IntegratorForm + comment {
        /// Samples a pixel.
        spp: Required<Whole<1, { u32::MAX as u64 }>> = "64",
        /// Independent replicates. Samples go to them in turn, and the differences between them give the error of each pixel.
        /// With 1 there are no error bars.
        replicates: Required<Whole<1, { MOST_REPLICATES as u64 }>> = "4",
        /// Seed of every random number.
        seed: Required<Whole<0, { u64::MAX }>> = "0",
        /// Number sequence.
        sampler: Required<SamplerKind> = r#""sobol""#,
        /// Most path edges from the camera to a light: 1 is light seen directly, 2 adds one bounce; null is no limit.
        max_depth: Required<Nullable<Whole<1, { u32::MAX as u64 }>>> = "null",
        /// Whether `max_depth` counts the way straight through a thin pane or a polarising sheet.
        count_panes: Required<bool> = "true",
        /// Whether the camera does not see lamps and skies directly. They light the scene all the same.
        hide_lights: Required<bool> = "false",
        /// Whether Russian roulette may end a path.
        roulette: Required<bool> = "true",
        /// How direct light is found.
        light_sampling: Required<LightSampling> = r#""mis""#,
        /// Which of several lights a shadow ray aims at.
        light_selection: Required<LightSelection> = r#""auto""#,
        /// Whether what mirrors and glass throw on the scene is found by paths from the lamps.
        light_tracing: Required<LightTracing> = r#""auto""#,
        /// First and last wavelength rendered, nm.
        wavelength_range_nm: Required<Spanned<[Wavelength; 2]>> = "[360, 830]",
        /// Which neighbouring pixels share paths.
        path_reuse: Required<PathReuse> = r#""none""#,
    }
}

crate::keywords!(SamplerKind {
    /// Owen-scrambled Sobol points: less noise.
    "sobol" => Self::Sobol,
    /// Independent random numbers.
    "independent" => Self::Independent,
});

crate::keywords!(LightSampling {
    /// Shadow rays and BSDF sampling, combined by multiple importance sampling.
    "mis" => Self::Mis,
    /// Shadow rays wherever they can find the light.
    "light" => Self::Light,
    /// BSDF sampling wherever it can find the light.
    "bsdf" => Self::Bsdf,
});

crate::keywords!(LightSelection {
    /// By a tree from 8 lights on that have a place, by power below.
    "auto" => Self::Auto,
    /// In proportion to their power, without regard to their place.
    "power" => Self::Power,
    /// By a tree over where they are and where they shine, for each point anew.
    "tree" => Self::Tree,
});

crate::keywords!(LightTracing {
    /// If a trial before the picture finds less noise for the time.
    "auto" => Self::Auto,
    /// Never.
    "never" => Self::Never,
    /// Wherever light paths are possible.
    "always" => Self::Always,
});

crate::keywords!(PathReuse {
    /// None: the errors of pixels are independent.
    "none" => Self::None,
    /// Blocks of 2 × 2 pixels.
    "2x2" => Self::Block2x2,
    /// Blocks of 4 × 2 pixels.
    "4x2" => Self::Block4x2,
    /// Blocks of 4 × 4 pixels.
    "4x4" => Self::Block4x4,
});

/// What the CIE 1931 observer sees, nm.
const VISIBLE_NM: [f64; 2] = [360.0, 830.0];

/// The wavelengths rendered.
pub(crate) fn wavelength_range_nm(form: &IntegratorForm, reader: &mut Reader<'_>) -> Option<[f64; 2]> {
    let range = form.wavelength_range_nm.as_ref()?;
    let [first, last] = range.value.map(|w| w.0);
    if first >= last {
        let message = format!("the range from {first} to {last} nm is empty");
        reader.error_hint(Code::OutOfRange, range.at, message, "the smaller wavelength comes first");
        return None;
    }
    Some([first, last])
}

/// Warns of wavelengths that nobody sees, in a scene where nothing makes visible ones of them.
pub(crate) fn warn_of_invisible_wavelengths(form: &IntegratorForm, reader: &mut Reader<'_>) {
    let Some(range) = &form.wavelength_range_nm else { return };
    let [first, last] = range.value.map(|w| w.0);
    if first < VISIBLE_NM[0] || last > VISIBLE_NM[1] {
        let message = format!(
            "wavelengths outside {} to {} nm are invisible and add nothing to the picture",
            VISIBLE_NM[0], VISIBLE_NM[1]
        );
        reader.warning(Code::InvisibleWavelengths, range.at, message, Some("narrow the range".to_owned()));
    }
}

/// The integrator of a form.
pub(crate) fn integrator(form: &IntegratorForm, wavelength_range_nm: Option<[f64; 2]>) -> Option<Integrator> {
    Some(Integrator {
        // The casts are within the ranges declared above.
        spp: form.spp?.0 as u32,
        replicates: form.replicates?.0 as u32,
        seed: form.seed?.0,
        sampler: form.sampler?,
        max_depth: match form.max_depth? {
            Nullable::Null => None,
            Nullable::Value(depth) => Some(depth.0 as u32),
        },
        count_panes: form.count_panes?,
        hide_lights: form.hide_lights?,
        roulette: form.roulette?,
        light_sampling: form.light_sampling?,
        light_selection: form.light_selection?,
        light_tracing: form.light_tracing?,
        wavelength_range_nm: wavelength_range_nm?,
        path_reuse: form.path_reuse?,
    })
}
