//! An image of everything around the scene: what it shows in each direction, and directions drawn by its luminance.

mod above_mean;
mod cumulative;
mod equal_area;
pub(super) mod meridians;

use super::{LightSample, LightSampling, LightSource, Target};
use crate::mis::Density;
use crate::spectral::{Colour, PathSpectrum};
pub(super) use above_mean::AboveMean;
pub use above_mean::Brightness;
use equal_area::EqualArea;
use etalon_geometry::SurfaceId;
use etalon_optics::Vec3;
use etalon_optics::colour::rec709_luminance;
use etalon_scene::{EnvironmentImage, EnvironmentProjection, Image};
use meridians::Meridians;
use std::f64::consts::PI;
use std::sync::Arc;

/// Light from infinity by the colours of an image.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    image: Arc<Image>,
    forward: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    white: PathSpectrum,
    map: Map,
}

/// What an image of everything around shows in a direction.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Its colour, in shares of the white.
    pub colour: [f64; 3],
    /// The density in sr⁻¹ with which shadow rays are drawn in this direction.
    pub density: f64,
}

/// How directions stand in the image.
#[derive(Clone, Debug)]
enum Map {
    Meridians(Meridians),
    EqualArea(EqualArea),
}

/// The parts of a unit vector along the axes of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along {
    pub forward: f64,
    pub right: f64,
    pub up: f64,
}

impl Along {
    const UP: Self = Self { forward: 0.0, right: 0.0, up: 1.0 };
}

impl EnvironmentLight {
    /// The light of an image, at wavelengths within `range_nm`. With [`LightSampling::Mis`] shadow rays find the parts that are brighter than
    /// the mean, and leave the others to directions from BSDFs.
    pub fn new(image: &EnvironmentImage, range_nm: [f64; 2], sampling: LightSampling) -> Self {
        let [forward, right, up] = [image.forward, image.right, image.up].map(Vec3::from_array);
        let map = match image.projection {
            EnvironmentProjection::LatitudeLongitude => Map::Meridians(Meridians::new(&image.image, false, sampling)),
            EnvironmentProjection::LatitudeLongitudeAtPoles => {
                Map::Meridians(Meridians::new(&image.image, true, sampling))
            }
            EnvironmentProjection::EqualArea => Map::EqualArea(EqualArea::new(&image.image, sampling)),
        };
        Self {
            image: Arc::clone(&image.image),
            forward,
            right,
            up,
            white: PathSpectrum::new(&image.white, range_nm),
            map,
        }
    }

    /// The spectrum of a texel (1, 1, 1), W·m⁻²·sr⁻¹·nm⁻¹.
    pub fn white(&self) -> &PathSpectrum {
        &self.white
    }

    /// What of the luminance shadow rays are drawn by.
    pub(super) fn above(&self) -> &AboveMean {
        match &self.map {
            Map::Meridians(map) => map.above(),
            Map::EqualArea(map) => map.above(),
        }
    }

    /// What the image shows in the direction `wi`.
    #[inline]
    pub fn look(&self, wi: Vec3<f64>) -> Look {
        let [look] = self.look_row(&[wi]);
        look
    }

    /// What the image shows in each of these directions.
    #[inline(always)]
    pub(crate) fn look_row<const W: usize>(&self, wi: &[Vec3<f64>; W]) -> [Look; W] {
        let (forward, right, up) = (self.forward, self.right, self.up);
        let mut along = [Along::UP; W];
        for k in 0..W {
            along[k] = Along { forward: wi[k].dot(forward), right: wi[k].dot(right), up: wi[k].dot(up) };
        }
        match &self.map {
            Map::Meridians(map) => map.look(&self.image, &along),
            Map::EqualArea(map) => map.look(&self.image, &along),
        }
    }

    /// Directions that each `u` in [0, 1)² draws, and what the image shows there. Where its density is 0 there is no sample: rounding
    /// may put the edge of a cell into a black neighbour.
    #[inline(always)]
    pub(crate) fn sample_row<const W: usize>(&self, u: [&[f64; W]; 2]) -> ([Vec3<f64>; W], [Look; W]) {
        let along = match &self.map {
            Map::Meridians(map) => map.sample(&self.image, u),
            Map::EqualArea(map) => map.sample(u),
        };
        let mut wi = [Vec3::ZERO; W];
        for k in 0..W {
            let along = along[k];
            wi[k] = (self.up * along.up + (self.forward * along.forward + self.right * along.right)).renormalized();
        }
        (wi, self.look_row(&wi))
    }
}

impl Look {
    pub(crate) const BLACK: Self = Self { colour: [0.0; 3], density: 0.0 };

    /// How bright it is to shadow rays.
    #[inline(always)]
    pub(crate) fn brightness(&self) -> Brightness {
        Brightness { density: self.density, luminance: rec709_luminance(self.colour) }
    }

    /// The sample of a direction in which the image shows this; `None` where it is black.
    #[inline(always)]
    pub(crate) fn sample(self, wi: Vec3<f64>) -> Option<LightSample> {
        (self.density > 0.0).then_some(LightSample {
            colour: Some(Colour::Rgb(self.colour)),
            wi,
            density: Density::SolidAngle(self.density),
            target: Target::Infinity,
            surface: SurfaceId::NONE,
            scale: 1.0,
        })
    }
}

impl LightSource for EnvironmentLight {
    fn sample(&self, _from: Vec3<f64>, u: [f64; 2], _time: f64) -> Option<LightSample> {
        let ([wi], [look]) = self.sample_row([&[u[0]], &[u[1]]]);
        look.sample(wi)
    }

    fn density(&self, _from: Vec3<f64>, wi: Vec3<f64>, _time: f64) -> f64 {
        self.look(wi).density
    }

    fn bright_share(&self, wi: Vec3<f64>) -> f64 {
        self.above().share(self.look(wi).brightness())
    }

    /// That of its white.
    fn spectrum(&self) -> &PathSpectrum {
        &self.white
    }

    fn can_be_met(&self) -> bool {
        true
    }

    fn power_factor(&self, scene_radius: f64) -> f64 {
        self.above().whole * PI * scene_radius * scene_radius
    }
}
