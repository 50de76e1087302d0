//! Materials: what surfaces do to light.

mod parts;

use super::{Grating, Medium, NumberTexture, Parameter, ParameterMut, SpectrumTexture, ThinFilm};
use crate::measured::MeasuredSurface;
use etalon_optics::{ComplexIndex, Fluorescence, RefractiveIndex, Spectrum};
use std::iter;

/// The least width α of a rough surface's facets. Tests check lobes down to this width.
pub const LEAST_ALPHA: f64 = 1e-4;

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// What it is.
    pub kind: MaterialKind,
    /// What fills the side that the surface normal points away from, if it does anything to light.
    pub medium: Option<Box<Medium>>,
    /// What fills the side that the surface normal points into. Without it, what fills the space around does.
    pub exterior_medium: Option<Box<Medium>>,
}

impl Material {
    /// The media that it states.
    pub fn media(&self) -> impl Iterator<Item = &Medium> {
        [&self.medium, &self.exterior_medium].into_iter().filter_map(|medium| medium.as_deref())
    }

    /// The media that it states, to be changed.
    pub fn media_mut(&mut self) -> impl Iterator<Item = &mut Medium> {
        [&mut self.medium, &mut self.exterior_medium].into_iter().filter_map(|medium| medium.as_deref_mut())
    }
}

/// How the slopes of facets are distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FacetDistribution {
    /// That of Trowbridge & Reitz (1975), with long tails.
    #[default]
    Ggx,
    /// Beckmann's: a Gaussian of variance α²/2 along each axis.
    Beckmann,
}

/// How facets hide each other from light that comes in and goes out on the same side: by Smith's masking of both directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FacetMasking {
    /// A facet of some height is seen from one direction where it is likely to be seen from the other.
    #[default]
    Correlated,
    /// As if the height of a facet for one direction were not that for the other: the product of both, which is darker at grazing angles.
    Separable,
}

/// The facets of a rough surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    /// Widths α along the tangent and across it, each in [[`LEAST_ALPHA`], 1].
    pub alpha: [f64; 2],
    /// Angle of the tangent from the direction of growing u toward that of growing v, rad.
    pub rotation_rad: f64,
    /// How their slopes are distributed.
    pub distribution: FacetDistribution,
    /// How they hide each other.
    pub masking: FacetMasking,
}

impl Microfacets {
    /// GGX facets of these widths along the tangent and across it, the tangent turned by an angle.
    pub fn ggx(alpha: [f64; 2], rotation_rad: f64) -> Self {
        Self { alpha, rotation_rad, distribution: FacetDistribution::Ggx, masking: FacetMasking::Correlated }
    }

    /// Whether the surface is the same when it is turned about its normal: then it needs no tangent.
    pub fn is_isotropic(&self) -> bool {
        self.alpha[0] == self.alpha[1]
    }
}

impl From<f64> for Microfacets {
    fn from(alpha: f64) -> Self {
        Self::ggx([alpha; 2], 0.0)
    }
}

/// What becomes of light that a coat reflects back down to its ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InternalReflection {
    /// The ground colours it again each time: ρ/(1 − ρ rᵢ) in all, rᵢ the share that the coat reflects back.
    #[default]
    Coloured,
    /// The ground colours it once, as if it were white for what comes after: ρ/(1 − rᵢ) in all.
    Uncoloured,
    /// It is lost. The ground is lit and seen through the coat as if that were smooth, and its light is not spread over the n² times larger
    /// solid angle above the coat: T(µₒ) T(µᵢ) ρ/π.
    Lost,
}

/// How much a principled surface has of each lobe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrincipledLobes {
    /// Share of metal, from 0 to 1.
    pub metallic: f64,
    /// Share of what a dielectric reflects that has the colour of the base, from 0 to 1.
    pub specular_tint: f64,
    /// Share of the diffuse light that comes as from below the surface, from 0 to 1.
    pub flatness: f64,
    /// Sheen at grazing angles, at least 0.
    pub sheen: f64,
    /// Share of the sheen that has the colour of the base, from 0 to 1.
    pub sheen_tint: f64,
    /// Strength of the clear coat, at least 0; 1 reflects 0.04 of the light head-on.
    pub clear_coat: f64,
    /// Width of the coat's facets, at least [`LEAST_ALPHA`] and below 1.
    pub clear_coat_alpha: f64,
}

impl PrincipledLobes {
    /// Whether a lobe has the colour of the base but not its luminance.
    pub fn has_tints(&self) -> bool {
        self.specular_tint > 0.0 || self.sheen_tint > 0.0
    }
}

/// What a surface does to light.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Ideal diffuse reflection on both sides.
    Lambert {
        /// Albedo, in [0, 1] at every wavelength.
        reflectance: SpectrumTexture,
    },
    /// Ideal mirror on both sides.
    Mirror {
        /// Reflectance, in [0, 1] at every wavelength, at every angle.
        reflectance: SpectrumTexture,
    },
    /// Smooth metal: Fresnel reflection, seen from vacuum.
    Conductor {
        /// Its index.
        metal: Metal,
        /// What coats it.
        film: Option<ThinFilm>,
    },
    /// Smooth interface between two transparent media.
    Dielectric {
        /// Medium on the side that the surface normal points away from.
        interior: RefractiveIndex,
        /// Medium on the side that the surface normal points into.
        exterior: RefractiveIndex,
        /// Given, the object is a closed solid of `interior` that is tracked among others: where several overlap, the
        /// highest priority fills the place, of equal ones the later object. `exterior` is then vacuum and means nothing.
        priority: Option<u32>,
        /// What lies between the two.
        film: Option<ThinFilm>,
    },
    /// Rough metal, seen from vacuum.
    RoughConductor {
        /// Its index.
        metal: Metal,
        /// Its facets.
        facets: Microfacets,
        /// Whether light that meets several facets is counted.
        compensated: bool,
        /// What coats each facet.
        film: Option<ThinFilm>,
    },
    /// Rough interface between two transparent media.
    RoughDielectric {
        /// Medium on the side that the surface normal points away from.
        interior: RefractiveIndex,
        /// Medium on the side that the surface normal points into.
        exterior: RefractiveIndex,
        /// Its facets.
        facets: Microfacets,
        /// Whether light that meets several facets is counted.
        compensated: bool,
        /// As of a smooth one.
        priority: Option<u32>,
        /// What lies between the two on each facet; `compensated` is then false.
        film: Option<ThinFilm>,
    },
    /// Rough diffuse reflection on both sides (EON).
    OrenNayar {
        /// Albedo parameter, in [0, 1] at every wavelength.
        reflectance: SpectrumTexture,
        /// Roughness, in [0, 1].
        roughness: f64,
    },
    /// Diffuse reflection and diffuse transmission, alike on both sides.
    Translucent {
        /// Share of light that comes back, in [0, 1] at every wavelength.
        reflectance: SpectrumTexture,
        /// Share that leaves on the other side; the two add up to at most 1.
        transmittance: SpectrumTexture,
    },
    /// A diffuse ground under a clear coat, on both sides, seen from vacuum.
    Plastic {
        /// Albedo of the ground, in [0, 1] at every wavelength.
        reflectance: SpectrumTexture,
        /// Index of the coat.
        coat: RefractiveIndex,
        /// The coat's facets; `None` is a smooth coat.
        facets: Option<Microfacets>,
        /// What becomes of light that the coat reflects back down.
        internal_reflection: InternalReflection,
        /// Whether light that the coat's facets hide from one another enters the ground; otherwise it is lost.
        compensated: bool,
    },
    /// A pane without thickness.
    ThinDielectric {
        /// Index relative to what surrounds it.
        index: RefractiveIndex,
        /// What coats both of its faces, each with the first layer outermost.
        film: Option<ThinFilm>,
    },
    /// A sheet without thickness that passes light straight on, what swings along its axis in another way than the rest.
    PolarisingSheet {
        /// The axis, a unit vector in the object's own coordinates; its part along the surface counts.
        axis: [f64; 3],
        /// What it does.
        sheet: PolarisingSheet,
    },
    /// A diffraction grating on both sides.
    Grating {
        /// Factor on the efficiencies of its orders, in [0, 1] at every wavelength.
        reflectance: SpectrumTexture,
        /// What it does.
        grating: Grating,
    },
    /// Diffuse reflection on both sides, and light that is given back at another wavelength, as diffuse.
    Fluorescent {
        /// Share of light reflected at its own wavelength; with what comes back at others at most 1.
        reflectance: SpectrumTexture,
        /// What comes back at others.
        fluorescence: Fluorescence,
    },
    /// A measured BRDF, alike on both sides.
    Measured {
        /// What was measured, and how it lies.
        surface: MeasuredSurface,
    },
    /// Lobes that are added, on both sides, seen from vacuum: Burley's principled surface.
    Principled {
        /// The base's albedo, in [0, 1] at every wavelength, which of a metal is what it reflects head-on.
        reflectance: SpectrumTexture,
        /// The surface's index, at least 1.
        index: RefractiveIndex,
        /// Its facets.
        facets: Microfacets,
        /// How much there is of each lobe.
        lobes: Box<PrincipledLobes>,
    },
    /// Materials side by side, finer than can be seen: everywhere the two between whose places a number lies, in linear
    /// proportion; the first below its place, the last above.
    Blend {
        /// At least two, each with the number at which it stands alone, increasing.
        parts: Vec<(f64, MaterialKind)>,
        /// The number.
        by: NumberTexture,
    },
    /// A surface whose sides differ. Neither lets light through.
    TwoSided {
        /// What it is on the side that the surface normal points into.
        front: Box<MaterialKind>,
        /// On the other side.
        back: Box<MaterialKind>,
    },
    /// A metal, an interface or a pane, of whose light a share is left; or plastic, of whose coat's reflection one is.
    Tinted {
        /// What it is without.
        kind: Box<MaterialKind>,
        /// Share that is left of what it reflects, in [0, 1] at every wavelength.
        reflected: SpectrumTexture,
        /// Share that is left of what it passes.
        transmitted: SpectrumTexture,
    },
    /// No surface at all, only the boundary of a medium: light passes as if it were not there.
    Boundary {
        /// Among solids that have one: it then takes part in what fills a place, and the index there is that of the others.
        priority: Option<u32>,
    },
    /// Reflects nothing (an emitter that is only a light, an absorber).
    Black,
}

/// A side of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The one that the surface normal points into.
    Front,
    /// The one that the surface normal points away from.
    Back,
}

/// What a metal reflects.
#[derive(Clone, Debug, PartialEq)]
pub enum Metal {
    /// n + ik.
    Index(ComplexIndex),
    /// What it reflects head-on, R: it has the index 1 + ik with k = 2√(R/(1 − R)) that does.
    Reflectance(SpectrumTexture),
}

impl Metal {
    /// The most that a metal of a given reflectance returns head-on: no index reflects all.
    pub const MOST_REFLECTANCE: f64 = 0.9999;

    /// The k of n = 1 that reflects a share in [0, 1] of light head-on, at most [`Metal::MOST_REFLECTANCE`].
    #[inline]
    pub fn k_of(reflectance: f64) -> f64 {
        let share = reflectance.clamp(0.0, Self::MOST_REFLECTANCE);
        2.0 * (share / (1.0 - share)).sqrt()
    }
}

/// What a sheet does to light that swings along its axis and across it.
#[derive(Clone, Debug, PartialEq)]
pub enum PolarisingSheet {
    /// Lets the former pass.
    Polariser {
        /// Share that passes of light that swings along the axis, in [0, 1] at every wavelength.
        transmittance: Spectrum,
        /// What passes of light that swings across the axis, over that share, in [0, 1].
        extinction: f64,
    },
    /// Delays the latter.
    Retarder {
        /// By this angle, rad.
        retardance_rad: f64,
        /// At this wavelength only, nm, at others in inverse proportion, as a plate of fixed thickness does; `None` is at all.
        at_nm: Option<f64>,
    },
}

/// Makes a function that lists the parameters of a material: each material states its own here, once.
macro_rules! parameters {
    ($(#[$doc:meta])* $name:ident, $of:ident, $iter:ident, ($($by:tt)+)) => {
        $(#[$doc])*
        pub fn $name($($by)+ self) -> Vec<$of<'_>> {
            match self {
                Self::Lambert { reflectance } | Self::Mirror { reflectance } | Self::OrenNayar { reflectance, .. } => {
                    vec![$of::Reflectance(reflectance)]
                }
                Self::Translucent { reflectance, transmittance } => {
                    vec![$of::Reflectance(reflectance), $of::Reflectance(transmittance)]
                }
                Self::Plastic { reflectance, coat, .. } => vec![$of::Reflectance(reflectance), $of::Coat(coat)],
                Self::Principled { reflectance, index, .. } => {
                    vec![$of::Reflectance(reflectance), $of::Principled(index)]
                }
                Self::Conductor { metal, film } | Self::RoughConductor { metal, film, .. } => {
                    iter::once($of::Metal(metal)).chain(film.into_iter().map($of::Film)).collect()
                }
                Self::Dielectric { interior, exterior, film, .. }
                | Self::RoughDielectric { interior, exterior, film, .. } => {
                    let interface = iter::once($of::Interface([interior, exterior]));
                    interface.chain(film.into_iter().map($of::Film)).collect()
                }
                Self::ThinDielectric { index, film } => {
                    iter::once($of::Coat(index)).chain(film.into_iter().map($of::Film)).collect()
                }
                Self::PolarisingSheet { sheet, .. } => vec![$of::Sheet(sheet)],
                Self::Grating { reflectance, grating } => vec![$of::Reflectance(reflectance), $of::Grating(grating)],
                Self::Fluorescent { reflectance, fluorescence } => {
                    vec![$of::Reflectance(reflectance), $of::Fluorescence(fluorescence)]
                }
                Self::Measured { surface } => vec![$of::Measured(surface)],
                Self::Blend { parts, .. } => parts.$iter().flat_map(|(_, part)| part.$name()).collect(),
                Self::TwoSided { front, back } => front.$name().into_iter().chain(back.$name()).collect(),
                Self::Tinted { kind, reflected, transmitted } => {
                    let tints = [$of::Reflectance(reflected), $of::Reflectance(transmitted)];
                    tints.into_iter().chain(kind.$name()).collect()
                }
                Self::Boundary { .. } | Self::Black => Vec::new(),
            }
        }
    };
}

impl MaterialKind {
    parameters! {
        /// The numbers by which it treats wavelengths, of a blend those of all its parts.
        parameters, Parameter, iter, (&)
    }

    parameters! {
        /// As [`MaterialKind::parameters`], to be changed.
        parameters_mut, ParameterMut, iter_mut, (&mut)
    }
}
