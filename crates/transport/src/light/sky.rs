//! A standard sky of the CIE: its radiance by formula, directions drawn by a table of it.
//!
//! The table has a row at the zenith and one at the horizon, and is interpolated as an image of everything around is. It gives the density
//! of directions and no light, so its coarseness costs noise alone.

use super::environment::Along;
use super::environment::meridians::Meridians;
use super::{LightSample, LightSource, Target};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::SurfaceId;
use etalon_optics::{Frame, Real, Vec3, atan2_turns, exp_neg};
use etalon_scene::{CieSky, Image, SkyCoefficients, Texels};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Columns and rows of the table; a row lies at the horizon.
const TABLE: [u32; 2] = [256, 129];

/// A standard sky.
#[derive(Clone, Debug)]
pub struct SkyLight {
    zenith: PathSpectrum,
    shape: Shape,
    /// The zenith, and two axes of the horizon.
    axes: Frame<f64>,
    table: Image,
    map: Meridians,
}

/// Radiance by direction, relative to the zenith.
#[derive(Clone, Copy, Debug)]
struct Shape {
    up: Vec3<f64>,
    sun: Vec3<f64>,
    /// `None` of the traditional overcast sky.
    coefficients: Option<SkyCoefficients>,
    /// e^(dπ/2).
    at_right_angles: f64,
    /// One over what the formula gives at the zenith.
    scale: f64,
    /// From below the horizon.
    ground: f64,
}

impl Shape {
    fn new(sky: &CieSky) -> Self {
        let coefficients = sky.coefficients();
        let at_right_angles = coefficients.map_or(0.0, |k| exp_neg(-k.d * FRAC_PI_2));
        let up = Vec3::from_array(sky.up);
        let sun = Vec3::from_array(sky.sun);
        let raw = Self { up, sun, coefficients, at_right_angles, scale: 1.0, ground: sky.ground };
        Self { scale: 1.0 / raw.eval(up), ..raw }
    }

    /// Relative to the zenith.
    #[inline]
    fn eval(&self, wi: Vec3<f64>) -> f64 {
        let cos = wi.dot(self.up);
        if cos < 0.0 { self.ground } else { self.at(wi, cos) }
    }

    /// The same in a direction above the horizon, of this cosine to the zenith.
    fn at(&self, wi: Vec3<f64>, cos: f64) -> f64 {
        let Some(SkyCoefficients { a, b, c, d, e }) = self.coefficients else {
            return (1.0 + 2.0 * cos) / 3.0;
        };
        // At the horizon the exponential is 0, as its limit.
        let gradation = 1.0 + a * exp_neg(-b / cos);
        let toward = wi.dot(self.sun);
        let chi = atan2_turns(wi.cross(self.sun).length(), toward) * TAU;
        let indicatrix = 1.0 + c * (exp_neg(-d * chi) - self.at_right_angles) + e * toward * toward;
        gradation * indicatrix * self.scale
    }
}

/// What a sky shows in a direction.
#[derive(Clone, Copy, Debug)]
pub struct SkyLook {
    /// Its radiance, relative to the zenith.
    pub relative: f64,
    /// The density in sr⁻¹ with which shadow rays are drawn in this direction.
    pub density: f64,
}

impl SkyLight {
    /// The light of a sky, at wavelengths within `range_nm`.
    pub fn new(sky: &CieSky, range_nm: [f64; 2]) -> Self {
        let shape = Shape::new(sky);
        let axes = Frame::from_normal(shape.up);
        let [columns, rows] = TABLE;
        let texels = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))).map(|(row, column)| {
            // The horizon's own row counts as above it.
            let horizon = 2 * row + 1 == rows;
            let polar = PI * f64::from(row) / f64::from(rows - 1);
            let turns = (f64::from(column) + 0.5) / f64::from(columns);
            let (sin, cos) = f64::sin_cos_turns(turns);
            let (level, height) = if horizon { (1.0, 0.0) } else { (polar.sin(), polar.cos()) };
            let along = Along { forward: -cos * level, right: -sin * level, up: height };
            let relative = if 2 * row + 1 > rows { sky.ground } else { shape.at(world(&axes, along), height) };
            [relative as f32; 3]
        });
        let table = Image::new(columns, rows, Texels::F32(texels.collect()));
        let map = Meridians::new(&table, true);
        Self { zenith: PathSpectrum::new(&sky.zenith, range_nm), shape, axes, table, map }
    }

    /// What the sky shows in the direction `wi`.
    #[inline]
    pub fn look(&self, wi: Vec3<f64>) -> SkyLook {
        let along = Along { forward: wi.dot(self.axes.s), right: wi.dot(self.axes.t), up: wi.dot(self.axes.n) };
        let [look] = self.map.look(&self.table, &[along]);
        SkyLook { relative: self.shape.eval(wi), density: look.density }
    }

    /// The radiance of the zenith, W·m⁻²·sr⁻¹·nm⁻¹.
    pub fn zenith(&self) -> &PathSpectrum {
        &self.zenith
    }
}

fn world(axes: &Frame<f64>, along: Along) -> Vec3<f64> {
    axes.n * along.up + (axes.s * along.forward + axes.t * along.right)
}

impl LightSource for SkyLight {
    fn sample(&self, _from: Vec3<f64>, u: [f64; 2], _time: f64) -> Option<LightSample> {
        let [along] = self.map.sample(&self.table, [&[u[0]], &[u[1]]]);
        let wi = world(&self.axes, along).renormalized();
        let SkyLook { relative, density } = self.look(wi);
        // The interpolated table reaches below the horizon, where there may be no light.
        (density > 0.0 && relative > 0.0).then_some(LightSample {
            colour: None,
            wi,
            density: Density::SolidAngle(density),
            target: Target::Infinity,
            surface: SurfaceId::NONE,
            scale: relative,
        })
    }

    fn density(&self, _from: Vec3<f64>, wi: Vec3<f64>, _time: f64) -> f64 {
        self.look(wi).density
    }

    /// That of the zenith.
    fn spectrum(&self) -> &PathSpectrum {
        &self.zenith
    }

    fn can_be_met(&self) -> bool {
        true
    }

    fn power_factor(&self, scene_radius: f64) -> f64 {
        self.map.total() * PI * scene_radius * scene_radius
    }
}
