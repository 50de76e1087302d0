//! Skies by formula: the standard skies of the CIE and daylight. Directions are drawn by a table of the luminance.
//!
//! The table has a row at the zenith and one at the horizon, and is interpolated as an image of everything around is. It gives the density
//! of directions and no light, so its coarseness costs noise alone. As of images, shadow rays aim at what is brighter than the mean.

use super::environment::meridians::Meridians;
use super::environment::{AboveMean, Along, Brightness};
use super::{LightSample, LightSampling, LightSource, Target};
use crate::mis::Density;
use crate::spectral::{Colour, PathSpectrum};
use etalon_geometry::SurfaceId;
use etalon_optics::{Frame, Real, Vec3};
use etalon_scene::{CieSky, DaylightLook, DaylightPattern, DaylightSky, Image, Perez, Texels};
use std::f64::consts::PI;

/// Columns and rows of the table; a row lies at the horizon.
const TABLE: [u32; 2] = [256, 129];

/// A sky by formula.
#[derive(Clone, Debug)]
pub struct SkyLight {
    spectrum: PathSpectrum,
    pattern: Pattern,
    /// The zenith, and two axes of the horizon.
    axes: Frame<f64>,
    table: Image,
    map: Meridians,
}

/// Radiance by direction.
#[derive(Clone, Debug)]
enum Pattern {
    /// Of one colour, relative to the zenith.
    Cie {
        up: Vec3<f64>,
        /// `None` of the traditional overcast sky.
        perez: Option<Perez>,
        /// From below the horizon.
        ground: f64,
    },
    /// Of the colours of daylight, relative to the mean daylight of the sky's spectrum.
    Daylight(Box<DaylightPattern>),
}

/// Radiance in a direction, relative to the sky's spectrum.
struct Shown {
    relative: f64,
    colour: Option<Colour>,
    /// In what directions are drawn by, to any scale.
    luminance: f64,
}

impl From<f64> for Shown {
    fn from(relative: f64) -> Self {
        Self { relative, colour: None, luminance: relative }
    }
}

impl From<DaylightLook> for Shown {
    fn from(DaylightLook { luminance, mean, weights }: DaylightLook) -> Self {
        Self { relative: mean, colour: Some(Colour::Daylight(weights)), luminance }
    }
}

impl Pattern {
    #[inline]
    fn eval(&self, wi: Vec3<f64>) -> Shown {
        match self {
            Self::Cie { up, .. } => {
                let cos = wi.dot(*up);
                if cos < 0.0 { self.ground() } else { self.at(wi, cos) }
            }
            Self::Daylight(pattern) => pattern.look(wi).into(),
        }
    }

    /// The same in a direction above the horizon, of this cosine to the zenith.
    fn at(&self, wi: Vec3<f64>, cos: f64) -> Shown {
        match self {
            Self::Cie { perez: Some(perez), .. } => perez.at(wi, cos).into(),
            Self::Cie { perez: None, .. } => ((1.0 + 2.0 * cos) / 3.0).into(),
            Self::Daylight(pattern) => pattern.at(wi, cos).into(),
        }
    }

    /// The same from below the horizon.
    fn ground(&self) -> Shown {
        match self {
            Self::Cie { ground, .. } => (*ground).into(),
            Self::Daylight(pattern) => pattern.ground().into(),
        }
    }
}

/// What a sky shows in a direction.
#[derive(Clone, Copy, Debug)]
pub struct SkyLook {
    /// Its radiance, relative to the sky's spectrum.
    pub relative: f64,
    /// Its colour, where it is not everywhere the same.
    pub colour: Option<Colour>,
    /// How bright it is to shadow rays.
    pub brightness: Brightness,
}

impl SkyLight {
    /// The light of a standard sky, at wavelengths within `range_nm`. For `sampling` see [`EnvironmentLight::new`](super::EnvironmentLight::new).
    pub fn new(sky: &CieSky, range_nm: [f64; 2], sampling: LightSampling) -> Self {
        let up = Vec3::from_array(sky.up);
        let pattern = Pattern::Cie { up, perez: sky.perez(), ground: sky.ground };
        Self::of_pattern(pattern, up, PathSpectrum::new(&sky.zenith, range_nm), sampling)
    }

    /// The light of a sky with the colours of daylight, at wavelengths within `range_nm`.
    pub fn daylight(sky: &DaylightSky, range_nm: [f64; 2], sampling: LightSampling) -> Self {
        let pattern = Pattern::Daylight(Box::new(sky.pattern()));
        Self::of_pattern(pattern, Vec3::from_array(sky.up), PathSpectrum::new(&sky.mean, range_nm), sampling)
    }

    fn of_pattern(pattern: Pattern, up: Vec3<f64>, spectrum: PathSpectrum, sampling: LightSampling) -> Self {
        let axes = Frame::from_normal(up);
        let [columns, rows] = TABLE;
        let texels = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))).map(|(row, column)| {
            // The horizon's own row counts as above it.
            let horizon = 2 * row + 1 == rows;
            let polar = PI * f64::from(row) / f64::from(rows - 1);
            let turns = (f64::from(column) + 0.5) / f64::from(columns);
            let (sin, cos) = f64::sin_cos_turns(turns);
            let (level, height) = if horizon { (1.0, 0.0) } else { (polar.sin(), polar.cos()) };
            let along = Along { forward: -cos * level, right: -sin * level, up: height };
            let below = 2 * row + 1 > rows;
            let shown = if below { pattern.ground() } else { pattern.at(world(&axes, along), height) };
            [shown.luminance as f32; 3]
        });
        let table = Image::new(columns, rows, Texels::F32(texels.collect()));
        let map = Meridians::new(&table, true, sampling);
        Self { spectrum, pattern, axes, table, map }
    }

    /// What the sky shows in the direction `wi`.
    #[inline]
    pub fn look(&self, wi: Vec3<f64>) -> SkyLook {
        let along = Along { forward: wi.dot(self.axes.s), right: wi.dot(self.axes.t), up: wi.dot(self.axes.n) };
        let [look] = self.map.look(&self.table, &[along]);
        let Shown { relative, colour, luminance } = self.pattern.eval(wi);
        SkyLook { relative, colour, brightness: Brightness { density: look.density, luminance } }
    }

    /// What of the luminance shadow rays are drawn by.
    pub(super) fn above(&self) -> &AboveMean {
        self.map.above()
    }

    /// The direction that `u` in [0, 1)² draws.
    fn direction(&self, u: [f64; 2]) -> Vec3<f64> {
        let [along] = self.map.sample(&self.table, [&[u[0]], &[u[1]]]);
        world(&self.axes, along).renormalized()
    }
}

fn world(axes: &Frame<f64>, along: Along) -> Vec3<f64> {
    axes.n * along.up + (axes.s * along.forward + axes.t * along.right)
}

impl SkyLook {
    /// The sample of a direction in which a sky shows this. The interpolated table reaches below the horizon, where there may be no light.
    fn sample(self, wi: Vec3<f64>) -> Option<LightSample> {
        let Self { relative, colour, brightness: Brightness { density, .. } } = self;
        (density > 0.0 && relative > 0.0).then_some(LightSample {
            colour,
            wi,
            density: Density::SolidAngle(density),
            target: Target::Infinity,
            surface: SurfaceId::NONE,
            scale: relative,
        })
    }
}

impl LightSource for SkyLight {
    fn sample(&self, _from: Vec3<f64>, u: [f64; 2], _time: f64) -> Option<LightSample> {
        let wi = self.direction(u);
        self.look(wi).sample(wi)
    }

    fn density(&self, _from: Vec3<f64>, wi: Vec3<f64>, _time: f64) -> f64 {
        self.look(wi).brightness.density
    }

    fn bright_share(&self, wi: Vec3<f64>) -> f64 {
        self.above().share(self.look(wi).brightness)
    }

    /// That of the zenith, of daylight its mean.
    fn spectrum(&self) -> &PathSpectrum {
        &self.spectrum
    }

    fn can_be_met(&self) -> bool {
        true
    }

    fn power_factor(&self, scene_radius: f64) -> f64 {
        self.above().whole * PI * scene_radius * scene_radius
    }
}
