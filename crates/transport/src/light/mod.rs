//! Lights that shadow rays aim at: one kind a file, one door, [`Light`].
//!
//! Everything here is computed in `f64`, which solid angles of near, far and enclosing lights need. A density is always a function of the reference point and the direction
//! alone, the same function for a sampled direction and for one that the BSDF found: the two can not disagree.

mod cylinder;
mod directional;
mod disk;
mod environment;
mod moving;
mod parallelogram;
mod planar;
mod point;
mod sphere;
mod spot;
mod table;
mod tree;
mod triangle;

pub use cylinder::CylinderLight;
pub use directional::DirectionalLight;
pub use disk::DiskLight;
pub use environment::{EnvironmentLight, Look};
pub use moving::MovingLight;
pub use parallelogram::ParallelogramLight;
pub use point::PointLight;
pub use sphere::SphereLight;
pub use spot::SpotLight;
pub use table::LightTable;
pub use triangle::TriangleLight;

pub(crate) use moving::Link;
pub(crate) use planar::{Aim, Flat};
pub(crate) use sphere::Round;
pub(crate) use table::visible_sum;

use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::{Aabb, SurfaceId};
use etalon_optics::Vec3;
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
    /// The colour that an image of everything around shows there, in shares of the light's spectrum.
    pub colour: Option<[f64; 3]>,
}

/// A light that shadow rays aim at.
#[derive(Clone, Debug)]
pub enum Light {
    /// An emitting sphere.
    Sphere(SphereLight),
    /// An emitting parallelogram.
    Parallelogram(ParallelogramLight),
    /// An emitting disk.
    Disk(DiskLight),
    /// An emitting triangle.
    Triangle(TriangleLight),
    /// An emitting cylinder.
    Cylinder(CylinderLight),
    /// A point.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(SpotLight),
    /// Parallel light.
    Directional(DirectionalLight),
    /// An image of everything around.
    Environment(Arc<EnvironmentLight>),
    /// An emitter that moves.
    Moving(MovingLight),
}

impl Light {
    /// Draws a direction from `from` toward the light with `u` in [0, 1)² at a time of the shutter's, from 0 to 1; `None` where
    /// none of its light arrives.
    pub fn sample(&self, from: Vec3<f64>, u: [f64; 2], time: f64) -> Option<LightSample> {
        match self {
            Self::Sphere(light) => light.sample(from, u),
            Self::Parallelogram(light) => light.sample(from, u),
            Self::Disk(light) => light.sample(from, u),
            Self::Triangle(light) => light.sample(from, u),
            Self::Cylinder(light) => light.sample(from, u),
            Self::Point(light) => light.sample(from),
            Self::Spot(light) => light.sample(from),
            Self::Directional(light) => Some(light.sample()),
            Self::Environment(light) => light.sample(u),
            Self::Moving(light) => light.sample(from, u, time),
        }
    }

    /// The light as far as its points and their densities depend on it, where it is a parallelogram or a triangle.
    #[inline]
    pub(crate) fn flat(&self) -> Option<Flat> {
        match self {
            Self::Parallelogram(light) => Some(light.flat()),
            Self::Triangle(light) => Some(light.flat()),
            _ => None,
        }
    }

    /// The same of a disk: its middle and two radii stand for the corner and the edges.
    #[inline]
    pub(crate) fn disk(&self) -> Option<Flat> {
        match self {
            Self::Disk(light) => Some(light.flat()),
            _ => None,
        }
    }

    /// The same of a sphere.
    #[inline]
    pub(crate) fn round(&self) -> Option<Round> {
        match self {
            Self::Sphere(light) => Some(light.round()),
            _ => None,
        }
    }

    /// The density in sr⁻¹ with which [`Light::sample`] draws the direction `wi`, which meets the light at that time, from `from`.
    pub fn density(&self, from: Vec3<f64>, wi: Vec3<f64>, time: f64) -> f64 {
        match self {
            Self::Sphere(light) => light.density(from),
            Self::Parallelogram(light) => light.density(from, wi),
            Self::Disk(light) => light.density(from, wi),
            Self::Triangle(light) => light.density(from, wi),
            Self::Cylinder(light) => light.density(from, wi),
            Self::Environment(light) => light.look(wi).density,
            Self::Moving(light) => light.density(from, wi, time),
            Self::Point(_) | Self::Spot(_) | Self::Directional(_) => 0.0,
        }
    }

    /// The spectrum that [`LightSample::scale`] multiplies; of an image, that of its white.
    pub fn spectrum(&self) -> &PathSpectrum {
        match self {
            Self::Sphere(light) => &light.emitter.radiance,
            Self::Parallelogram(light) => &light.emitter.radiance,
            Self::Disk(light) => &light.emitter.radiance,
            Self::Triangle(light) => &light.emitter.radiance,
            Self::Cylinder(light) => &light.emitter.radiance,
            Self::Point(light) => &light.intensity,
            Self::Spot(light) => &light.point.intensity,
            Self::Directional(light) => &light.irradiance,
            Self::Environment(light) => light.white(),
            Self::Moving(light) => light.own().spectrum(),
        }
    }

    /// What an emitting surface emits; `None` for a light without a surface.
    pub fn emitter(&self) -> Option<&Emitter> {
        match self {
            Self::Sphere(light) => Some(&light.emitter),
            Self::Parallelogram(light) => Some(&light.emitter),
            Self::Disk(light) => Some(&light.emitter),
            Self::Triangle(light) => Some(&light.emitter),
            Self::Cylinder(light) => Some(&light.emitter),
            Self::Moving(light) => light.emitter(),
            Self::Point(_) | Self::Spot(_) | Self::Directional(_) | Self::Environment(_) => None,
        }
    }

    /// Where it is and where it shines, with a power of 1; `None` if it is nowhere, or not always at one place.
    fn place(&self) -> Option<LightBounds> {
        let x = Vec3::new(1.0, 0.0, 0.0);
        let surface = |bounds: Aabb, emitter: &Emitter, normal: Option<Vec3<f64>>| LightBounds {
            bounds,
            axis: normal.map_or(x, |normal| if emitter.front { normal } else { -normal }),
            // Normals of what is round point everywhere.
            cos_normals: if normal.is_some() { 1.0 } else { -1.0 },
            cos_shines: 0.0,
            both_sides: emitter.front && emitter.back,
            power: 1.0,
        };
        let point = |position| LightBounds {
            bounds: Aabb { min: position, max: position },
            axis: x,
            cos_normals: -1.0,
            cos_shines: 0.0,
            both_sides: false,
            power: 1.0,
        };
        match self {
            Self::Sphere(light) => Some(surface(light.bounds(), &light.emitter, None)),
            Self::Cylinder(light) => Some(surface(light.bounds(), &light.emitter, None)),
            Self::Disk(light) => Some(surface(light.bounds(), &light.emitter, Some(light.normal()))),
            Self::Parallelogram(light) => {
                Some(surface(light.flat().bounds(), &light.emitter, Some(light.flat().normal)))
            }
            Self::Triangle(light) => Some(surface(light.flat().bounds(), &light.emitter, Some(light.flat().normal))),
            Self::Point(light) => Some(point(light.position)),
            Self::Spot(light) => Some(LightBounds {
                axis: light.axis,
                cos_normals: light.cosines[0],
                cos_shines: light.cos_beyond_inner(),
                ..point(light.point.position)
            }),
            Self::Directional(_) | Self::Environment(_) | Self::Moving(_) => None,
        }
    }

    /// Whether a path may run into it.
    pub fn can_be_met(&self) -> bool {
        self.emitter().is_some() || matches!(self, Self::Environment(_))
    }

    /// What the spectrum is to be multiplied by for the light's power in a scene of this radius.
    fn power_factor(&self, scene_radius: f64) -> f64 {
        use std::f64::consts::PI;
        match self {
            Self::Sphere(light) => light.emitter.brightness() * PI * light.area(),
            Self::Parallelogram(light) => light.emitter.brightness() * PI * light.area(),
            Self::Disk(light) => light.emitter.brightness() * PI * light.area(),
            Self::Triangle(light) => light.emitter.brightness() * PI * light.area(),
            Self::Cylinder(light) => light.emitter.brightness() * PI * light.area(),
            Self::Point(light) => 4.0 * PI * light.per_m * light.per_m,
            Self::Spot(light) => light.power_factor(),
            Self::Directional(_) => PI * scene_radius * scene_radius,
            Self::Environment(light) => light.total() * PI * scene_radius * scene_radius,
            Self::Moving(light) => light.own().power_factor(scene_radius) * light.area_factor(),
        }
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
}

impl EnvironmentRadiance {
    /// The spectrum, of an image that of its white.
    pub(crate) fn spectrum(&self) -> &PathSpectrum {
        match self {
            Self::Uniform(spectrum) => spectrum,
            Self::Image(light) => light.white(),
        }
    }
}

impl From<PathSpectrum> for Environment {
    fn from(spectrum: PathSpectrum) -> Self {
        Self { radiance: EnvironmentRadiance::Uniform(spectrum), light: None }
    }
}

/// What every emitting surface has: its radiance, its emitting sides and where it is.
#[derive(Clone, Debug)]
pub struct Emitter {
    /// Emitted radiance, W·m⁻²·sr⁻¹·nm⁻¹.
    pub radiance: Arc<PathSpectrum>,
    /// Whether the side that the normal points into emits.
    pub front: bool,
    /// Whether the other side emits.
    pub back: bool,
    /// The surface.
    pub surface: SurfaceId,
    /// Where an image says what it emits.
    pub image: Option<ImageOf>,
}

/// An image of what an emitting surface emits, of which `radiance` is the white.
#[derive(Clone, Copy, Debug)]
pub struct ImageOf {
    /// The number of the object that has it.
    pub object: u32,
    /// About the mean luminance of its colours over the surface, which only decides how often the surface is aimed at.
    pub mean: f64,
}

impl Emitter {
    /// Whether light leaves along `direction` from a point whose normal is `n`.
    pub fn emits_along(&self, n: Vec3<f64>, direction: Vec3<f64>) -> bool {
        if n.dot(direction) > 0.0 { self.front } else { self.back }
    }

    /// What the spectrum and the area are to be multiplied by for what all sides emit.
    fn brightness(&self) -> f64 {
        let sides = f64::from(u8::from(self.front)) + f64::from(u8::from(self.back));
        sides * self.image.map_or(1.0, |image| image.mean)
    }
}
