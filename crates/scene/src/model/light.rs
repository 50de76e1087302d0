//! Lights without a surface, and what the rest of the renderer asks of them.

use std::sync::Arc;

use etalon_optics::Spectrum;

use super::{CieSky, DaylightSky, EnvironmentImage, SlideLight};
use crate::luminaire::Photometry;

/// A light without a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the file, or `lights[i]`.
    pub name: String,
    /// What it is.
    pub kind: LightKind,
}

/// What a light without a surface is.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// The same intensity in every direction, from a point.
    Point {
        /// Position, m.
        position_m: [f64; 3],
        /// Radiant intensity, W·sr⁻¹·nm⁻¹.
        intensity: Spectrum,
    },
    /// A point that shines into a cone, less and less towards its edge.
    Spot {
        /// Position, m.
        position_m: [f64; 3],
        /// Unit vector along the axis of the cone.
        axis: [f64; 3],
        /// Half angles, rad, at which the intensity begins to fall and is 0; in [0, π], ordered.
        half_angles_rad: [f64; 2],
        /// Radiant intensity along the axis, W·sr⁻¹·nm⁻¹.
        intensity: Spectrum,
    },
    /// A point whose intensity a table says for each direction.
    Luminaire {
        /// Position, m.
        position_m: [f64; 3],
        /// Unit vector along which the polar angle of the table is 0.
        nadir: [f64; 3],
        /// Unit vectors across it: where the azimuth is 0, and a quarter turn.
        planes: [[f64; 3]; 2],
        /// The table, cd.
        photometry: Arc<Photometry>,
        /// Radiant intensity that 1 cd of the table stands for, W·sr⁻¹·nm⁻¹.
        intensity: Spectrum,
    },
    /// One of these points with an image before it.
    Slide(Box<SlideLight>),
    /// Parallel light.
    Directional {
        /// Unit vector in which the light travels.
        direction: [f64; 3],
        /// Irradiance on a plane at right angles to it, W·m⁻²·nm⁻¹.
        irradiance: Spectrum,
    },
    /// A beam, parallel or widening, that begins at an aperture.
    Beam(Beam),
    /// The same radiance from every direction at infinity.
    Environment {
        /// Radiance, W·m⁻²·sr⁻¹·nm⁻¹.
        radiance: Spectrum,
    },
    /// Radiance from infinity that an image says for each direction.
    ImageEnvironment(EnvironmentImage),
    /// A standard sky of the CIE.
    Sky(CieSky),
    /// A sky with the colours of daylight.
    Daylight(DaylightSky),
}

/// A beam of light, such as of a laser or a collimator. Its rays are parallel, or come from one point behind the aperture.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    /// Middle of the aperture, m.
    pub position_m: [f64; 3],
    /// Unit vector along the axis.
    pub direction: [f64; 3],
    /// Radius at the aperture, m; of a Gaussian profile that at which irradiance has fallen to 1/e² of that on the axis.
    pub radius_m: f64,
    /// Angle between the axis and the rays that leave the aperture at this radius, rad; in [0, π/2).
    pub half_angle_rad: f64,
    /// How irradiance falls across the beam.
    pub profile: BeamProfile,
    /// Power, W·nm⁻¹.
    pub power: Spectrum,
}

/// How the irradiance of a beam falls across it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BeamProfile {
    /// The same up to the radius, nothing beyond.
    #[default]
    Uniform,
    /// exp(−2r²/w²), with the radius w.
    Gaussian,
}

/// A cone that holds all the light of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightCone {
    /// The point, m.
    pub position_m: [f64; 3],
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// Half angle, rad.
    pub half_angle_rad: f64,
}

impl LightKind {
    /// The spectrum of what it sends; of an image that of its white, of a sky that of its zenith or of its mean daylight.
    pub fn spectrum(&self) -> &Spectrum {
        match self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } | Self::Luminaire { intensity, .. } => {
                intensity
            }
            Self::Directional { irradiance, .. } => irradiance,
            Self::Slide(slide) => slide.lamp.spectrum(),
            Self::Beam(beam) => &beam.power,
            Self::Environment { radiance } => radiance,
            Self::ImageEnvironment(image) => &image.white,
            Self::Sky(sky) => &sky.zenith,
            Self::Daylight(sky) => &sky.mean,
        }
    }

    /// The same, to be changed.
    pub fn spectrum_mut(&mut self) -> &mut Spectrum {
        match self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } | Self::Luminaire { intensity, .. } => {
                intensity
            }
            Self::Directional { irradiance, .. } => irradiance,
            Self::Slide(slide) => slide.lamp.spectrum_mut(),
            Self::Beam(beam) => &mut beam.power,
            Self::Environment { radiance } => radiance,
            Self::ImageEnvironment(image) => &mut image.white,
            Self::Sky(sky) => &mut sky.zenith,
            Self::Daylight(sky) => &mut sky.mean,
        }
    }

    /// Whether its light comes to each place from a single direction. Then no path runs into it: only shadow rays find it. Every
    /// other light without a surface is at infinity, where paths find it that leave the scene.
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Point { .. }
            | Self::Spot { .. }
            | Self::Luminaire { .. }
            | Self::Slide(_)
            | Self::Directional { .. }
            | Self::Beam(_) => true,
            Self::Environment { .. } | Self::ImageEnvironment(_) | Self::Sky(_) | Self::Daylight(_) => false,
        }
    }

    /// The image that says what it sends into each direction, if there is one.
    pub fn image(&self) -> Option<&EnvironmentImage> {
        match self {
            Self::ImageEnvironment(image) => Some(image),
            _ => None,
        }
    }

    /// The same, to be changed.
    pub fn image_mut(&mut self) -> Option<&mut EnvironmentImage> {
        match self {
            Self::ImageEnvironment(image) => Some(image),
            _ => None,
        }
    }

    /// The slide before it, if there is one.
    pub fn slide(&self) -> Option<&SlideLight> {
        match self {
            Self::Slide(slide) => Some(slide),
            _ => None,
        }
    }

    /// The same, to be changed.
    pub fn slide_mut(&mut self) -> Option<&mut SlideLight> {
        match self {
            Self::Slide(slide) => Some(slide),
            _ => None,
        }
    }

    /// Where it is, m, if it is a point.
    pub fn position_m(&self) -> Option<[f64; 3]> {
        match self {
            Self::Point { position_m, .. } | Self::Spot { position_m, .. } | Self::Luminaire { position_m, .. } => {
                Some(*position_m)
            }
            Self::Slide(slide) => slide.lamp.position_m(),
            _ => None,
        }
    }

    /// A cone beyond which it sends nothing, if there is one.
    pub fn cone(&self) -> Option<LightCone> {
        match *self {
            // Either cone holds all of its light.
            Self::Slide(ref slide) => {
                let cones = slide.cone().into_iter().chain(slide.lamp.cone());
                cones.min_by(|a, b| a.half_angle_rad.total_cmp(&b.half_angle_rad))
            }
            Self::Spot { position_m, axis, half_angles_rad: [_, half_angle_rad], .. } => {
                Some(LightCone { position_m, axis, half_angle_rad })
            }
            // Files end beyond the last lit angle, where the intensity may have fallen to nothing.
            Self::Luminaire { position_m, nadir, ref photometry, .. } => {
                Some(LightCone { position_m, axis: nadir, half_angle_rad: photometry.reach_rad() })
            }
            _ => None,
        }
    }

    /// Whether shadow rays aim at it although it is everywhere at infinity: it is not the same from all directions.
    pub fn is_uneven_sky(&self) -> bool {
        matches!(self, Self::ImageEnvironment(_) | Self::Sky(_) | Self::Daylight(_))
    }

    /// Whether its spectrum is not the same in all directions.
    pub fn has_colours(&self) -> bool {
        match self {
            Self::ImageEnvironment(sky) => !sky.image.is_grey(),
            Self::Daylight(sky) => !sky.mean.is_zero(),
            Self::Slide(slide) => !slide.image.is_grey(),
            _ => false,
        }
    }

    /// Whether it sends nothing.
    pub fn is_zero(&self) -> bool {
        if matches!(self, Self::Luminaire { photometry, .. } if photometry.most_cd() == 0.0) {
            return true;
        }
        if let Self::Slide(slide) = self {
            return slide.is_zero();
        }
        self.image().map_or_else(|| self.spectrum().is_zero(), EnvironmentImage::is_zero)
    }
}
