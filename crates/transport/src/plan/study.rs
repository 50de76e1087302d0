//! Renders of what a scene does not call for, and without what it does: for study.

use super::{EffectName, evidence};
use etalon_optics::colour::colour_matching;
use etalon_optics::{ComplexIndex, RefractiveIndex, Spectrum};
use etalon_scene::{Filter, LightKind, LightSampling, MaterialKind, Projection, Scene};

/// What to simulate otherwise than a scene calls for. Empty by default.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Study {
    /// Effects to simulate although nothing calls for them. They change no bit of the picture, but for
    /// [`EffectName::Wavelengths`], which changes the noise.
    pub force: Vec<EffectName>,
    /// Effects to leave out although the scene calls for them: the picture is then an approximation.
    pub without: Vec<EffectName>,
}

/// Why a study makes no sense.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StudyError {
    /// Forced and left out.
    #[error("{0} cannot be forced and left out at once")]
    Both(EffectName),
    /// Nothing to force.
    #[error("{0} cannot be forced: it is what surfaces and film are made of, and without them there is nothing to do")]
    NothingToForce(EffectName),
    /// The integrator's setting stands against it.
    #[error("{effect} cannot be forced: {because}")]
    Contradicted {
        /// The effect.
        effect: EffectName,
        /// What stands against it.
        because: String,
    },
}

impl Study {
    /// Whether an effect is left out if the scene calls for it.
    pub(super) fn leaves_out(&self, name: EffectName) -> bool {
        // Wavelengths that differ in nothing go the same way.
        let implied = name == EffectName::Dispersion && self.without.contains(&EffectName::Wavelengths);
        self.without.contains(&name) || implied
    }

    /// How direct light is found, where the scene says `stated`.
    pub(super) fn light_sampling(&self, stated: LightSampling) -> LightSampling {
        match stated {
            _ if self.without.contains(&EffectName::ShadowRays) => LightSampling::Bsdf,
            LightSampling::Mis if self.without.contains(&EffectName::Mis) => LightSampling::Light,
            other => other,
        }
    }

    pub(super) fn check(&self, scene: &Scene) -> Result<(), StudyError> {
        for &effect in &self.force {
            if self.leaves_out(effect) {
                return Err(StudyError::Both(effect));
            }
            let Err(because) = evidence::of(effect, scene) else { continue };
            if !effect.can_be_forced() {
                return Err(StudyError::NothingToForce(effect));
            }
            let sampling = scene.integrator.light_sampling;
            let contradicted = match effect {
                EffectName::Mis => sampling != LightSampling::Mis,
                EffectName::ShadowRays => sampling == LightSampling::Bsdf,
                EffectName::Lens => matches!(scene.camera.projection, Projection::Orthographic { .. }),
                _ => false,
            };
            if contradicted {
                return Err(StudyError::Contradicted { effect, because });
            }
        }
        Ok(())
    }
}

/// The scene that is simulated: what a study leaves out is taken from it.
pub(crate) fn simulated(scene: &Scene, study: &Study) -> Scene {
    let mut scene = scene.clone();
    scene.integrator.light_sampling = study.light_sampling(scene.integrator.light_sampling);
    for &effect in &study.without {
        leave_out(effect, &mut scene);
    }
    scene
}

fn leave_out(effect: EffectName, scene: &mut Scene) {
    let range_nm = scene.integrator.wavelength_range_nm;
    match effect {
        EffectName::Wavelengths => {
            for material in &mut scene.materials {
                match &mut material.kind {
                    MaterialKind::Lambert { reflectance } | MaterialKind::Mirror { reflectance } => {
                        *reflectance = grey(reflectance, range_nm);
                    }
                    MaterialKind::Conductor { index } | MaterialKind::RoughConductor { index, .. } => {
                        *index = grey_metal(index, range_nm);
                    }
                    MaterialKind::Dielectric { .. } | MaterialKind::RoughDielectric { .. } | MaterialKind::Black => {}
                }
            }
            leave_out(EffectName::Dispersion, scene);
            let grouped = scene.groups.iter_mut().flat_map(|group| &mut group.objects);
            for emission in scene.objects.iter_mut().chain(grouped).filter_map(|object| object.emission.as_mut()) {
                emission.radiance = grey(&emission.radiance, range_nm);
            }
            for light in &mut scene.lights {
                match &mut light.kind {
                    LightKind::Point { intensity: spectrum, .. }
                    | LightKind::Directional { irradiance: spectrum, .. }
                    | LightKind::Environment { radiance: spectrum } => *spectrum = grey(spectrum, range_nm),
                }
            }
        }
        EffectName::Dispersion => {
            for material in &mut scene.materials {
                match &mut material.kind {
                    MaterialKind::Dielectric { interior, exterior, .. }
                    | MaterialKind::RoughDielectric { interior, exterior, .. } => {
                        for index in [interior, exterior] {
                            let n = index.eval(middle(range_nm));
                            *index = RefractiveIndex::constant(n).expect("an index of refraction is positive");
                        }
                    }
                    MaterialKind::Lambert { .. }
                    | MaterialKind::Mirror { .. }
                    | MaterialKind::Conductor { .. }
                    | MaterialKind::RoughConductor { .. }
                    | MaterialKind::Black => {}
                }
            }
        }
        EffectName::Lens => match &mut scene.camera.projection {
            Projection::Perspective { lens, .. } => *lens = None,
            Projection::Orthographic { .. } => {}
        },
        EffectName::ShadowRays => {
            scene.lights.retain(|light| match light.kind {
                LightKind::Point { .. } | LightKind::Directional { .. } => false,
                LightKind::Environment { .. } => true,
            });
        }
        // The integrator's setting, which `Study::light_sampling` has changed.
        EffectName::Mis => {}
        EffectName::Environment => scene.lights.retain(|light| match light.kind {
            LightKind::Environment { .. } => false,
            LightKind::Point { .. } | LightKind::Directional { .. } => true,
        }),
        EffectName::SpecularChains => {
            for material in &mut scene.materials {
                match material.kind {
                    MaterialKind::Mirror { .. } | MaterialKind::Conductor { .. } | MaterialKind::Dielectric { .. } => {
                        material.kind = MaterialKind::Black;
                    }
                    MaterialKind::Lambert { .. }
                    | MaterialKind::RoughConductor { .. }
                    | MaterialKind::RoughDielectric { .. }
                    | MaterialKind::Black => {}
                }
            }
        }
        EffectName::NestedDielectrics => {
            for material in &mut scene.materials {
                match &mut material.kind {
                    MaterialKind::Dielectric { priority, .. } => *priority = None,
                    MaterialKind::RoughConductor { .. } | MaterialKind::RoughDielectric { .. } => {}
                    MaterialKind::Lambert { .. }
                    | MaterialKind::Mirror { .. }
                    | MaterialKind::Conductor { .. }
                    | MaterialKind::Black => {}
                }
            }
        }
        EffectName::WideFilter => scene.film.filter = Filter::Box,
    }
}

/// The helium line d, at which catalogues state indices, or the wavelength of the range nearest to it.
fn middle([first, last]: [f64; 2]) -> f64 {
    587.5618_f64.clamp(first, last)
}

/// The mean over the range, weighted by ȳ (plainly, where the eye sees nothing).
fn grey(spectrum: &Spectrum, range_nm: [f64; 2]) -> Spectrum {
    let mean = |weight: &dyn Fn(f64) -> f64| {
        let (sum, total) = super::grey::steps(range_nm)
            .fold((0.0, 0.0), |(sum, total), nm| (sum + weight(nm) * spectrum.eval(nm), total + weight(nm)));
        (total > 0.0).then(|| sum / total)
    };
    let mean = mean(&|nm| colour_matching(nm)[1]).or_else(|| mean(&|_| 1.0)).unwrap_or(0.0);
    Spectrum::Constant(mean)
}

fn grey_metal(index: &ComplexIndex, range_nm: [f64; 2]) -> ComplexIndex {
    let (n, k) = index.eval(middle(range_nm));
    let [first, last] = range_nm;
    ComplexIndex::tabulated(vec![first, last], vec![n; 2], vec![k; 2]).expect("a metal at one wavelength is a metal")
}
