//! What a scene calls for, and what will therefore be simulated.
//!
//! Effects are derived, never declared. Each light, camera and film says in an exhaustive `match` what it calls for
//! ([`evidence`](self)). Materials say it by their [properties](crate::bsdf::Properties) and
//! [parameters](etalon_scene::Parameter). What nothing calls for is not done. A [`Study`] may have it otherwise.

mod evidence;
mod grey;
pub(crate) mod kernels;
mod study;
mod three_channels;

pub use study::{Carried, Study, StudyError};

pub(crate) use grey::OneLaneFilm;
pub(crate) use study::simulated;
pub(crate) use three_channels::CHANNELS_NM;

use etalon_scene::{LightSampling, Projection, SamplerKind, Scene};
use kernels::KernelKind;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// Something that light may do, or that finds it, which a scene may or may not call for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EffectName {
    /// Wavelengths differ in more than the spectrum of all light.
    Wavelengths,
    /// Wavelengths go different ways.
    Dispersion,
    /// Thin films reflect some wavelengths more than others: their waves interfere.
    Interference,
    /// Surfaces give light back at other wavelengths than those that they take it in at.
    Fluorescence,
    /// The camera's aperture has an extent.
    Lens,
    /// Shadow rays look for direct light.
    ShadowRays,
    /// Multiple importance sampling weighs them against the walk that finds the same light.
    Mis,
    /// Light comes from infinity.
    Environment,
    /// Mirrors, metals and glass hand light on in single directions.
    SpecularChains,
    /// Light of lamps without area is looked for by way of mirrors and smooth interfaces.
    SpecularConnections,
    /// Shadow rays go through glass.
    RefractedShadows,
    /// Solids of different media touch, overlap or hold each other.
    NestedDielectrics,
    /// Media absorb light on its way, or emit some.
    Absorption,
    /// Media scatter light on its way.
    Scattering,
    /// Light is polarised by what reflects and refracts it.
    Polarisation,
    /// Images vary what surfaces reflect.
    Textures,
    /// Meshes are shaded by the normals of their vertices.
    ShadingNormals,
    /// Surfaces let a share of the paths pass.
    Masks,
    /// Groups of objects are placed where they are met, instead of being copied.
    Instances,
    /// Things move while the shutter is open.
    Motion,
    /// A pixel looks beyond its own square.
    WideFilter,
    /// The film keeps bands of wavelengths apart.
    Bands,
}

impl EffectName {
    /// All of them, in the order of a plan.
    pub const ALL: [Self; 22] = [
        Self::Wavelengths,
        Self::Dispersion,
        Self::Interference,
        Self::Fluorescence,
        Self::Lens,
        Self::ShadowRays,
        Self::Mis,
        Self::Environment,
        Self::SpecularChains,
        Self::SpecularConnections,
        Self::RefractedShadows,
        Self::NestedDielectrics,
        Self::Absorption,
        Self::Scattering,
        Self::Polarisation,
        Self::Textures,
        Self::ShadingNormals,
        Self::Masks,
        Self::Instances,
        Self::Motion,
        Self::WideFilter,
        Self::Bands,
    ];

    /// The name on the command line and in files.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Wavelengths => "wavelengths",
            Self::Dispersion => "dispersion",
            Self::Interference => "interference",
            Self::Fluorescence => "fluorescence",
            Self::Lens => "lens",
            Self::ShadowRays => "shadow-rays",
            Self::Mis => "mis",
            Self::Environment => "environment",
            Self::SpecularChains => "specular-chains",
            Self::SpecularConnections => "specular-connections",
            Self::RefractedShadows => "refracted-shadows",
            Self::NestedDielectrics => "nested-dielectrics",
            Self::Absorption => "absorption",
            Self::Scattering => "scattering",
            Self::Polarisation => "polarisation",
            Self::Textures => "textures",
            Self::ShadingNormals => "shading-normals",
            Self::Masks => "masks",
            Self::Instances => "instances",
            Self::Motion => "motion",
            Self::WideFilter => "wide-filter",
            Self::Bands => "bands",
        }
    }

    /// What a picture lacks that is rendered without it although the scene calls for it.
    pub const fn lost_without(self) -> &'static str {
        match self {
            Self::Wavelengths => "every spectrum is replaced by its mean, weighted by the eye: no colours",
            Self::Dispersion => "every index of refraction is that of one wavelength",
            Self::Interference => "thin films are left out: what they coat is bare",
            Self::Fluorescence => "surfaces that fluoresce only reflect",
            Self::Lens => "everything is in focus",
            Self::ShadowRays => {
                "lights without a surface are left out; the others are found by chance, with more noise"
            }
            Self::Mis => "the mean is the same, with more noise where shadow rays sample badly",
            Self::Environment => "light from infinity is left out",
            Self::SpecularChains => "mirrors, metals and glass are black",
            Self::SpecularConnections => {
                "what mirrors and glass throw of lamps without area on other surfaces is missing"
            }
            Self::RefractedShadows => "the mean is the same, with more noise where light comes through glass",
            Self::NestedDielectrics => "each solid is treated as if it stood in vacuum",
            Self::Absorption => "media take no light away and emit none, however thick they are",
            Self::Scattering => "light goes straight through media: no fog, no milk",
            Self::Polarisation => "light is treated as unpolarised at every surface",
            Self::Textures => "each image is replaced by its mean colour",
            Self::ShadingNormals => "meshes show their triangles",
            Self::Masks => "every surface is opaque",
            Self::Instances => "instances are left out",
            Self::Motion => "everything stands still, at the middle of the shutter time",
            Self::WideFilter => "each pixel is a square (box filter)",
            Self::Bands => "the film keeps only the colour",
        }
    }

    /// Whether there is anything to be done for it in a scene that does not call for it.
    pub const fn can_be_forced(self) -> bool {
        match self {
            Self::Wavelengths | Self::Dispersion | Self::Lens | Self::ShadowRays | Self::Mis | Self::Environment => {
                true
            }
            Self::NestedDielectrics | Self::Absorption | Self::Polarisation | Self::Motion => true,
            // They are what the surfaces, or the film, are made of.
            Self::SpecularChains
            | Self::SpecularConnections
            | Self::RefractedShadows
            | Self::Interference
            | Self::Fluorescence
            | Self::Textures
            | Self::ShadingNormals
            | Self::Masks
            | Self::Instances
            | Self::WideFilter
            | Self::Bands
            | Self::Scattering => false,
        }
    }
}

impl fmt::Display for EffectName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl FromStr for EffectName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|name| name.as_str() == text).ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|name| name.as_str()).collect();
            format!("there is no effect \"{text}\"; the effects are {}", names.join(", "))
        })
    }
}

impl Serialize for EffectName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

/// An effect, as the plan has it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Effect {
    /// Its name.
    pub name: EffectName,
    /// Whether it will be simulated.
    pub on: bool,
    /// The object and the number that called for it, or why nothing did.
    pub because: String,
    /// Where a study decided otherwise than the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub study: Option<Decision>,
}

/// What a study decided on an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decision {
    /// Simulated although nothing calls for it.
    Forced,
    /// Left out although the scene calls for it.
    LeftOut,
}

/// What the lanes of a path stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LaneModel {
    /// One lane: radiance is a number times the one spectrum of all light.
    One,
    /// Wavelengths that always go the same way.
    Shared,
    /// Wavelengths that dispersion may part from the hero's path.
    Hero,
    /// No wavelengths: red, green and blue, for study.
    ThreeChannels,
}

/// How paths are traced: two ways to the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PathLoop {
    /// One path at a time: the specification.
    Scalar,
    /// Many at once.
    Batch,
}

impl PathLoop {
    /// Its name on the command line and in files.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Batch => "batch",
        }
    }
}

/// The loop that traces the paths.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChosenLoop {
    /// Which.
    pub name: PathLoop,
    /// Why.
    pub because: &'static str,
}

/// What will be simulated, why, and with what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// The kernel, by name.
    pub kernel: &'static str,
    /// What its lanes stand for.
    pub lane_model: LaneModel,
    /// Lanes that a path carries.
    pub lanes: usize,
    /// How paths are traced.
    pub path_loop: ChosenLoop,
    /// Width and height of the blocks of pixels that share paths, if any do.
    pub path_reuse: Option<[u32; 2]>,
    /// Range of the wavelengths, nm.
    pub wavelength_range_nm: [f64; 2],
    /// Number sequence.
    pub sampler: &'static str,
    /// How direct light is found.
    pub light_sampling: &'static str,
    /// Most path edges, if there is a limit.
    pub max_depth: Option<u32>,
    /// Whether the ways straight through panes are among them.
    pub count_panes: bool,
    /// Whether Russian roulette ends paths.
    pub roulette: bool,
    /// Whether the film holds S₁, S₂ and S₃.
    pub stokes: bool,
    /// Each effect, on or off, with what called for it.
    pub effects: Vec<Effect>,
    /// What a study left out although the scene calls for it, with what the picture lacks: it is an approximation.
    pub approximations: Vec<String>,
}

/// Why the pixels of a scene cannot share paths; `None` if they can.
fn reuse_unsupported(scene: &Scene, kernel: &KernelKind, runs: impl Fn(EffectName) -> bool) -> Option<&'static str> {
    match () {
        () if matches!(scene.camera.projection, Projection::CompoundLens(_)) => Some("the camera has a compound lens"),
        () if kernel.polarised => Some("polarisation is traced"),
        () if !kernel.shares_paths => Some("a study decides what paths carry"),
        () if runs(EffectName::Fluorescence) => Some("surfaces fluoresce"),
        () if runs(EffectName::NestedDielectrics) => Some("dielectrics are nested"),
        () if runs(EffectName::Absorption) => Some("media absorb"),
        () if runs(EffectName::Scattering) => Some("media scatter"),
        () if runs(EffectName::Motion) => Some("something moves while the shutter is open"),
        () if runs(EffectName::Masks) => Some("surfaces have an opacity below 1"),
        () => None,
    }
}

/// Many paths at once, unless the study wants otherwise.
fn chosen_loop(scene: &Scene, study: &Study) -> ChosenLoop {
    match study.path_loop {
        _ if !scene.receivers.is_empty() => {
            ChosenLoop { name: PathLoop::Scalar, because: "paths begin at meters, not at a camera" }
        }
        Some(name) => ChosenLoop { name, because: "chosen by --loop" },
        None => ChosenLoop { name: PathLoop::Batch, because: "it is the fastest" },
    }
}

impl Plan {
    /// Reads a scene, as it is before the study takes anything from it.
    ///
    /// # Errors
    /// If the study contradicts the scene or itself.
    pub fn new(scene: &Scene, study: &Study) -> Result<Self, StudyError> {
        study.check(scene)?;
        let mut approximations = Vec::new();
        let effects: Vec<Effect> = EffectName::ALL
            .into_iter()
            .map(|name| {
                let evidence = match name {
                    EffectName::Polarisation => evidence::polarisation(scene, study.polarised),
                    _ => evidence::of(name, scene),
                };
                let (called_for, because) = match evidence {
                    Ok(called_for) => (true, called_for),
                    Err(otherwise) => (false, otherwise),
                };
                let study = match called_for {
                    true if study.leaves_out(name) => Some(Decision::LeftOut),
                    false if study.force.contains(&name) => Some(Decision::Forced),
                    _ => None,
                };
                if study == Some(Decision::LeftOut) {
                    approximations.push(format!("{name}: {}", name.lost_without()));
                }
                let on = called_for && study != Some(Decision::LeftOut) || study == Some(Decision::Forced);
                Effect { name, on, because, study }
            })
            .collect();
        let runs = |name| effects.iter().any(|effect: &Effect| effect.name == name && effect.on);
        // Without wavelengths there is none that could go another way.
        let parts_lanes = |name, of: fn(&Scene) -> bool| runs(name) && of(&simulated(scene, study));
        let lane_model = if runs(EffectName::Dispersion)
            || parts_lanes(EffectName::Interference, evidence::films_part_lanes)
            || parts_lanes(EffectName::Scattering, evidence::media_part_lanes)
        {
            LaneModel::Hero
        } else if runs(EffectName::Wavelengths) || runs(EffectName::Polarisation) || runs(EffectName::Fluorescence) {
            LaneModel::Shared
        } else {
            LaneModel::One
        };
        let i = &scene.integrator;
        let polarised = runs(EffectName::Polarisation);
        if study.carried.is_some() && polarised {
            let because = "--carry has no polarised variant".to_owned();
            return Err(StudyError::Contradicted { effect: EffectName::Polarisation, because });
        }
        let kernel = kernels::choose(lane_model, polarised, study.carried);
        if kernel.lanes == LaneModel::ThreeChannels {
            approximations.push("spectra: light and surfaces have three channels instead".to_owned());
        }
        let path_loop = chosen_loop(scene, study);
        let path_reuse = i.path_reuse.block_px();
        if let (Some(_), Some(because)) = (path_reuse, reuse_unsupported(scene, kernel, runs)) {
            return Err(StudyError::PathReuse(because));
        }
        let &KernelKind { name, lanes, lane_count, .. } = kernel;
        Ok(Self {
            kernel: name,
            lane_model: lanes,
            lanes: lane_count,
            path_loop,
            path_reuse,
            wavelength_range_nm: i.wavelength_range_nm,
            sampler: match i.sampler {
                SamplerKind::Sobol => "sobol",
                SamplerKind::Independent => "independent",
            },
            light_sampling: match study.light_sampling(i.light_sampling) {
                LightSampling::Mis => "mis",
                LightSampling::Light => "light",
                LightSampling::Bsdf => "bsdf",
            },
            max_depth: i.max_depth,
            count_panes: i.count_panes,
            roulette: i.roulette,
            stokes: runs(EffectName::Polarisation) && (study.polarised || scene.film.stokes),
            effects,
            approximations,
        })
    }

    /// Whether an effect will be simulated.
    pub fn runs(&self, name: EffectName) -> bool {
        self.effects.iter().any(|effect| effect.name == name && effect.on)
    }

    /// Whether a study leaves out an effect that the scene calls for.
    pub(crate) fn leaves_out(&self, name: EffectName) -> bool {
        self.effects.iter().any(|effect| effect.name == name && effect.study == Some(Decision::LeftOut))
    }

    /// Whether an effect will be simulated that nothing calls for.
    pub(crate) fn forces(&self, name: EffectName) -> bool {
        self.effects.iter().any(|effect| effect.name == name && effect.study == Some(Decision::Forced))
    }
}
