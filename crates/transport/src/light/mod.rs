//! Lights that shadow rays aim at: one kind a file, one door, [`Light`].
//!
//! Everything here is computed in `f64`. A density is always a function of the reference point and the direction alone, the same function
//! for a sampled direction and for one that the BSDF found: the two can not disagree.

mod area;
mod beam;
mod cone;
mod directional;
mod environment;
mod lit_part;
mod luminaire;
mod moving;
mod point;
mod sky;
mod slide;
mod spot;
mod table;
mod tree;

pub use area::{AreaLight, Emitter, ImageOf};
pub use beam::BeamLight;
pub use directional::DirectionalLight;
pub use environment::{Brightness, EnvironmentLight, Look};
pub use luminaire::LuminaireLight;
pub use moving::MovingLight;
pub use point::PointLight;
pub use sky::{SkyLight, SkyLook};
pub use slide::SlideLight;
pub use spot::SpotLight;
pub use table::LightTable;

pub(crate) use lit_part::LitPart;
pub(crate) use moving::Link;
pub(crate) use table::{visible_sum, weighted_sum};

use crate::frame::SceneFrame;
use crate::media::Way;
use crate::mis::{Density, Heuristic};
use crate::spectral::{Colour, PathSpectrum};
use etalon_geometry::SurfaceId;
use etalon_optics::{Spectrum, Vec3};
use etalon_scene::{EnvironmentImage, LightKind, LightSampling};
use std::sync::Arc;
use tree::LightBounds;

/// Where a shadow ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// At a point.
    Point(Vec3<f64>),
    /// Nowhere: the light is infinitely far away.
    Infinity,
}

impl Target {
    /// How shadow rays that end there are weighed against the walk.
    #[inline(always)]
    pub(crate) fn heuristic(&self) -> Heuristic {
        Heuristic::of(*self == Self::Infinity)
    }

    /// How far it is from a point.
    pub fn distance(&self, from: Vec3<f64>) -> f64 {
        match self {
            Self::Point(point) => (*point - from).length(),
            Self::Infinity => f64::INFINITY,
        }
    }
}

/// A direction toward a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit vector toward the light.
    pub wi: Vec3<f64>,
    /// Density of `wi` in sr⁻¹, or a delta.
    pub density: Density,
    /// Where the shadow ray ends.
    pub target: Target,
    /// The light's own surface, which does not shadow itself.
    pub surface: SurfaceId,
    /// What the light's spectrum is multiplied by: 1 for radiance, 1/d² for a point's intensity.
    pub scale: f64,
    /// What the light's spectrum is multiplied by at each wavelength, if it is not the same in all directions.
    pub colour: Option<Colour>,
}

/// Where all light of a lamp without area comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// From a point, though the lamp may begin elsewhere.
    Point(Vec3<f64>),
    /// From infinity, in the direction of this unit vector.
    Direction(Vec3<f64>),
}

impl Source {
    /// The unit vector toward it.
    pub(crate) fn toward(&self, from: Vec3<f64>) -> Vec3<f64> {
        match self {
            Self::Point(point) => {
                let way = *point - from;
                way / way.length()
            }
            Self::Direction(toward) => *toward,
        }
    }

    /// How far it is.
    pub(crate) fn distance(&self, from: Vec3<f64>) -> f64 {
        match self {
            Self::Point(point) => Target::Point(*point).distance(from),
            Self::Direction(_) => f64::INFINITY,
        }
    }
}

/// What each kind of light answers; see the methods of [`Light`].
trait LightSource {
    fn sample(&self, from: Vec3<f64>, u: [f64; 2], time: f64) -> Option<LightSample>;

    /// Less than 1 only of skies.
    fn bright_share(&self, _wi: Vec3<f64>) -> f64 {
        1.0
    }

    /// 0 of a light whose position or direction is a single one.
    fn density(&self, _from: Vec3<f64>, _wi: Vec3<f64>, _time: f64) -> f64 {
        0.0
    }

    fn spectrum(&self) -> &PathSpectrum;

    /// Only for lights with a surface.
    fn emitter(&self) -> Option<&Emitter> {
        None
    }

    fn can_be_met(&self) -> bool {
        self.emitter().is_some()
    }

    /// Its position, if it is a point.
    fn position(&self) -> Option<Vec3<f64>> {
        None
    }

    /// Where its light comes from, if it has no area.
    fn source(&self) -> Option<Source> {
        self.position().map(Source::Point)
    }

    /// The part of a way that its light comes to, as distances along it, if it has no area and begins somewhere.
    fn lit_part(&self, way: &Way) -> Option<[f64; 2]> {
        self.position().map(|_| [0.0, way.length])
    }

    /// Whether there may be such a part.
    fn lights_parts(&self) -> bool {
        self.position().is_some()
    }

    /// Where it is and where it shines, with a power of 1; `None` if it is nowhere, or not always at one place.
    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    /// What the spectrum is to be multiplied by for the light's power in a scene of this radius.
    fn power_factor(&self, scene_radius: f64) -> f64;
}

/// A light that shadow rays aim at.
#[derive(Clone, Debug)]
pub enum Light {
    /// A shape whose surface emits.
    Area(AreaLight),
    /// A point.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(SpotLight),
    /// A point with a table of intensities.
    Luminaire(LuminaireLight),
    /// One of these points with an image before it.
    Slide(Box<SlideLight>),
    /// Parallel light.
    Directional(DirectionalLight),
    /// A beam that begins at an aperture.
    Beam(BeamLight),
    /// An image of everything around.
    Environment(Arc<EnvironmentLight>),
    /// A sky by formula.
    Sky(Arc<SkyLight>),
    /// A shape whose surface emits and that moves.
    Moving(MovingLight),
}

macro_rules! each {
    ($of:expr, $light:ident => $result:expr) => {
        match $of {
            Light::Area($light) => $result,
            Light::Point($light) => $result,
            Light::Spot($light) => $result,
            Light::Luminaire($light) => $result,
            Light::Slide($light) => {
                let $light = $light.as_ref();
                $result
            }
            Light::Directional($light) => $result,
            Light::Beam($light) => $result,
            Light::Environment($light) => {
                let $light = $light.as_ref();
                $result
            }
            Light::Sky($light) => {
                let $light = $light.as_ref();
                $result
            }
            Light::Moving($light) => $result,
        }
    };
}

impl Light {
    /// Draws a direction from `from` toward the light with `u` in [0, 1)² at a time of the shutter's, from 0 to 1; `None` where
    /// none of its light arrives. Of a sky that is not [for shadow rays alone](EnvironmentLight::new), only what is brighter than its mean
    /// is found.
    pub fn sample(&self, from: Vec3<f64>, u: [f64; 2], time: f64) -> Option<LightSample> {
        each!(self, light => LightSource::sample(light, from, u, time))
    }

    /// The share of its light from the direction `wi` by which [`Light::sample`] draws directions: of a sky what is above the mean, as its cells
    /// interpolate that; of other lights all.
    pub fn bright_share(&self, wi: Vec3<f64>) -> f64 {
        each!(self, light => LightSource::bright_share(light, wi))
    }

    /// The density in sr⁻¹ with which [`Light::sample`] draws the direction `wi`, which meets the light at that time, from `from`.
    pub fn density(&self, from: Vec3<f64>, wi: Vec3<f64>, time: f64) -> f64 {
        each!(self, light => LightSource::density(light, from, wi, time))
    }

    /// The spectrum that [`LightSample::scale`] multiplies; of an image, that of its white.
    pub fn spectrum(&self) -> &PathSpectrum {
        each!(self, light => LightSource::spectrum(light))
    }

    /// Its position, if it is a point.
    #[inline]
    pub(crate) fn position(&self) -> Option<Vec3<f64>> {
        each!(self, light => LightSource::position(light))
    }

    /// The part of a way that its light comes to, as distances along it, if it has no area and begins somewhere.
    pub(crate) fn lit_part(&self, way: &Way) -> Option<[f64; 2]> {
        each!(self, light => LightSource::lit_part(light, way))
    }

    /// Whether ways have a part that its light comes to: see [`Light::lit_part`].
    pub(crate) fn lights_parts(&self) -> bool {
        each!(self, light => LightSource::lights_parts(light))
    }

    /// Where its light comes from, if it has no area.
    pub(crate) fn source(&self) -> Option<Source> {
        each!(self, light => LightSource::source(light))
    }

    /// What an emitting surface emits; `None` for a light without a surface.
    #[inline]
    pub fn emitter(&self) -> Option<&Emitter> {
        each!(self, light => LightSource::emitter(light))
    }

    /// The shape and what it emits, of a light with a surface that does not move.
    #[inline]
    pub(crate) fn area(&self) -> Option<&AreaLight> {
        match self {
            Self::Area(light) => Some(light),
            _ => None,
        }
    }

    fn bounds(&self) -> Option<LightBounds> {
        each!(self, light => LightSource::bounds(light))
    }

    /// Whether a path may run into it.
    pub fn can_be_met(&self) -> bool {
        each!(self, light => LightSource::can_be_met(light))
    }

    fn power_factor(&self, scene_radius: f64) -> f64 {
        each!(self, light => LightSource::power_factor(light, scene_radius))
    }

    /// What shadow rays aim at of a light of the scene without a surface, and what paths find of it that leave the scene. Directions
    /// are of the world, positions and lengths in the frame. `known` finds the light of an image that was made before.
    pub(crate) fn of_scene(
        kind: &LightKind,
        frame: &SceneFrame,
        (range_nm, sampling): ([f64; 2], LightSampling),
        known: impl Fn(&EnvironmentImage) -> Option<Arc<EnvironmentLight>>,
    ) -> (Option<Self>, Option<Environment>) {
        let spectrum = |spectrum: &Spectrum| PathSpectrum::new(spectrum, range_nm);
        let target = match kind {
            LightKind::Point { position_m, intensity } => {
                Self::Point(PointLight::new(*position_m, spectrum(intensity), frame))
            }
            LightKind::Spot { position_m, axis, half_angles_rad, intensity } => Self::Spot(SpotLight {
                point: PointLight::new(*position_m, spectrum(intensity), frame),
                axis: Vec3::from_array(*axis),
                cosines: half_angles_rad.map(f64::cos),
            }),
            LightKind::Luminaire { position_m, nadir, planes, photometry, intensity } if !kind.is_zero() => {
                Self::Luminaire(LuminaireLight {
                    point: PointLight::new(*position_m, spectrum(intensity), frame),
                    nadir: Vec3::from_array(*nadir),
                    planes: planes.map(Vec3::from_array),
                    table: Arc::clone(photometry),
                    flux_lm: photometry.flux_lm(),
                    cos_reach: photometry.reach_rad().cos(),
                })
            }
            LightKind::Directional { direction, irradiance } => Self::Directional(DirectionalLight {
                toward: -Vec3::from_array(*direction),
                irradiance: spectrum(irradiance),
            }),
            LightKind::Beam(beam) => Self::Beam(BeamLight::new(beam, spectrum(&beam.power), frame)),
            // A black sky is none, nor is a dark luminaire.
            _ if kind.is_zero() => return (None, None),
            LightKind::Luminaire { .. } => return (None, None),
            LightKind::Slide(slide) => {
                let (lamp, _) = Self::of_scene(&slide.lamp, frame, (range_nm, sampling), known);
                let light = lamp.and_then(|lamp| SlideLight::new(lamp, slide));
                return (light.map(|light| Self::Slide(Box::new(light))), None);
            }
            LightKind::Sky(sky) => return Self::of_sky(SkyLight::new(sky, range_nm, sampling)),
            LightKind::Daylight(sky) => return Self::of_sky(SkyLight::daylight(sky, range_nm, sampling)),
            LightKind::Environment { radiance } => return (None, Some(spectrum(radiance).into())),
            LightKind::ImageEnvironment(image) => {
                let light = known(image).unwrap_or_else(|| Arc::new(EnvironmentLight::new(image, range_nm, sampling)));
                let radiance = EnvironmentRadiance::Image(Arc::clone(&light));
                return (Some(Self::Environment(light)), Some(Environment { radiance, light: None }));
            }
        };
        (Some(target), None)
    }

    fn of_sky(light: SkyLight) -> (Option<Self>, Option<Environment>) {
        let light = Arc::new(light);
        let radiance = EnvironmentRadiance::Sky(Arc::clone(&light));
        (Some(Self::Sky(light)), Some(Environment { radiance, light: None }))
    }
}

/// Light from infinity, as a path that leaves the scene finds it.
#[derive(Clone, Debug)]
pub(crate) struct Environment {
    pub radiance: EnvironmentRadiance,
    /// Its number among the lights that shadow rays aim at. A constant one is no target: the BSDF's own directions are its
    /// best samples.
    pub light: Option<u32>,
}

/// Radiance from infinity.
#[derive(Clone, Debug)]
pub(crate) enum EnvironmentRadiance {
    /// The same from every direction.
    Uniform(PathSpectrum),
    /// As an image says.
    Image(Arc<EnvironmentLight>),
    /// As a formula says.
    Sky(Arc<SkyLight>),
}

impl Environment {
    /// States the numbers of skies among the lights that shadow rays aim at. Both have them in the order of the scene.
    pub(crate) fn number(skies: &mut [Self], lights: &[Light]) {
        for (index, light) in lights.iter().enumerate() {
            let is_same = |sky: &Self| match (&sky.radiance, light) {
                (EnvironmentRadiance::Image(of), Light::Environment(light)) => Arc::ptr_eq(of, light),
                (EnvironmentRadiance::Sky(of), Light::Sky(light)) => Arc::ptr_eq(of, light),
                _ => false,
            };
            if let Some(sky) = skies.iter_mut().find(|sky| sky.light.is_none() && is_same(sky)) {
                sky.light = Some(index as u32);
            }
        }
    }
}

impl EnvironmentRadiance {
    /// The image, if it is one.
    #[inline(always)]
    pub(crate) fn image(&self) -> Option<&EnvironmentLight> {
        match self {
            Self::Image(light) => Some(light),
            Self::Uniform(_) | Self::Sky(_) => None,
        }
    }

    /// [`Light::bright_share`] of a direction in which it is so bright.
    pub(crate) fn bright_share(&self, seen: Brightness) -> f64 {
        match self {
            Self::Uniform(_) => 1.0,
            Self::Image(light) => light.above().share(seen),
            Self::Sky(light) => light.above().share(seen),
        }
    }

    /// The spectrum, of an image that of its white, of a sky that of [`Light::spectrum`].
    pub(crate) fn spectrum(&self) -> &PathSpectrum {
        match self {
            Self::Uniform(spectrum) => spectrum,
            Self::Image(light) => light.white(),
            Self::Sky(light) => LightSource::spectrum(light.as_ref()),
        }
    }
}

impl From<PathSpectrum> for Environment {
    fn from(spectrum: PathSpectrum) -> Self {
        Self { radiance: EnvironmentRadiance::Uniform(spectrum), light: None }
    }
}
