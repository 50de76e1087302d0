//! A beam of rays that are parallel, or come from one point behind the aperture.
//!
//! A plane across the axis where the beam has the radius w receives E(r) = Φ·p(r/w)/(πw²), with p = 1 up to r = w, or p = 2·exp(−2r²/w²). A
//! ray at the angle α to the axis brings E/cos α to a surface at right angles to it, so that the flux through every such plane is Φ. Rays
//! do not diffract: far from its waist, this is the beam of a laser.

use super::cone::Cone;
use super::{LightSample, LightSource, Source, Target};
use crate::frame::SceneFrame;
use crate::media::Way;
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::{Ray, SurfaceId};
use etalon_optics::{Frame, Real, Vec3, exp_neg};
use etalon_scene::{Beam, BeamProfile};
use std::f64::consts::PI;

/// 2r²/w² at which a Gaussian profile ends: −ln 1e-12.
const LARGEST_EXPONENT: f64 = 27.631_021_115_928_547;

/// The radius within which 99 % of the light of a Gaussian beam are, over w.
const MOST_OF_A_GAUSSIAN: f64 = 1.5;

/// A beam.
#[derive(Clone, Debug)]
pub struct BeamLight {
    /// Middle of the aperture.
    pub position: Vec3<f64>,
    /// Unit vector along the axis.
    pub axis: Vec3<f64>,
    /// Radius at the aperture.
    pub radius: f64,
    /// Tangent of the angle between the axis and the rays at this radius.
    pub tangent: f64,
    /// How irradiance falls across the beam.
    pub profile: BeamProfile,
    /// Power, W·nm⁻¹.
    pub power: PathSpectrum,
    /// Units of length in a metre, a power of two.
    pub per_m: f64,
}

impl BeamLight {
    /// A beam of the world, in the frame.
    pub(super) fn new(beam: &Beam, power: PathSpectrum, frame: &SceneFrame) -> Self {
        Self {
            position: frame.point(Vec3::from_array(beam.position_m)),
            axis: Vec3::from_array(beam.direction),
            radius: beam.radius_m * frame.per_m(),
            tangent: beam.half_angle_rad.tan(),
            profile: beam.profile,
            power,
            per_m: frame.per_m(),
        }
    }

    /// A ray of the beam, for `u` in [0, 1)²; where most of its light is, though not in proportion to it.
    pub(crate) fn ray(&self, u: [f64; 2]) -> Ray<f64> {
        let (sin, cos) = f64::sin_cos_turns(u[1]);
        let frame = Frame::from_normal(self.axis);
        let across = (frame.s * cos + frame.t * sin) * u[0].sqrt();
        let direction = self.axis + across * self.tangent;
        Ray::free(self.position + across * self.radius, direction / direction.length())
    }

    /// The part of a way that the beam lights after mirrors and glass have sent its middle ray on along `passed`: nearly, since glass
    /// stretches beams. The beam has come at least as far as `passed` begins from the aperture.
    pub(crate) fn passed_part(&self, passed: &Ray<f64>, way: &Way) -> Option<[f64; 2]> {
        /// Factor on the radius and the tangent.
        const STRETCHED: f64 = 2.0;
        /// Added to the tangent, for what glass spreads.
        const SPREADS: f64 = 1e-3;
        let depth = (passed.origin - self.position).length();
        let radius = STRETCHED * (depth * self.tangent + self.radius);
        let tangent = STRETCHED * self.tangent + SPREADS;
        Cone { position: passed.origin, axis: passed.direction, radius, tangent }.part(way)
    }

    /// p at a squared distance from the axis, in units of the squared radius.
    fn share(&self, squared: f64) -> f64 {
        match self.profile {
            BeamProfile::Uniform if squared <= 1.0 => 1.0,
            BeamProfile::Gaussian if 2.0 * squared <= LARGEST_EXPONENT => 2.0 * exp_neg(2.0 * squared),
            BeamProfile::Uniform | BeamProfile::Gaussian => 0.0,
        }
    }
}

impl LightSource for BeamLight {
    fn sample(&self, from: Vec3<f64>, _u: [f64; 2], _time: f64) -> Option<LightSample> {
        let beyond = from - self.position;
        let depth = beyond.dot(self.axis);
        if depth <= 0.0 || depth.is_nan() {
            return None;
        }
        let across = beyond - self.axis * depth;
        let width = self.radius + depth * self.tangent;
        let share = self.share(across.length_squared() / (width * width));
        if share == 0.0 {
            return None;
        }
        // The ray through this place leaves the aperture as far from the axis as the beam was narrower there.
        let start = self.position + across * (self.radius / width);
        let way = start - from;
        let length = way.length();
        // cos α = depth / length.
        let scale = self.per_m * self.per_m * share / (PI * width * width) * (length / depth);
        Some(LightSample {
            colour: None,
            wi: way / length,
            density: Density::Delta,
            target: Target::Point(start),
            surface: SurfaceId::NONE,
            scale,
        })
    }

    fn source(&self) -> Option<Source> {
        Some(match self.tangent > 0.0 {
            true => Source::Point(self.position - self.axis * (self.radius / self.tangent)),
            false => Source::Direction(-self.axis),
        })
    }

    fn lit_part(&self, way: &Way) -> Option<[f64; 2]> {
        let wide = match self.profile {
            BeamProfile::Uniform => 1.0,
            BeamProfile::Gaussian => MOST_OF_A_GAUSSIAN,
        };
        let (radius, tangent) = (wide * self.radius, wide * self.tangent);
        Cone { position: self.position, axis: self.axis, radius, tangent }.part(way)
    }

    fn lights_parts(&self) -> bool {
        true
    }

    fn spectrum(&self) -> &PathSpectrum {
        &self.power
    }

    fn power_factor(&self, _scene_radius: f64) -> f64 {
        self.per_m * self.per_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A plane across a beam receives all of its power, wherever it is. By 4000 rings out to four radii: the ring at the edge of an
        /// even beam counts whole or not at all, which is 2·4/4000 of the flux.
        #[test]
        fn every_plane_across_a_beam_receives_its_power(
            radius in 0.01..2.0_f64,
            tangent in prop_oneof![Just(0.0), 0.0..2.0_f64],
            depth in 0.01..10.0_f64,
            gaussian in any::<bool>(),
            exponent in -3..4,
        ) {
            let per_m = 2_f64.powi(exponent);
            let beam = BeamLight {
                position: Vec3::new(0.5, -1.0, 2.0),
                axis: Vec3::new(0.48, 0.6, 0.64),
                radius: radius * per_m,
                tangent,
                profile: if gaussian { BeamProfile::Gaussian } else { BeamProfile::Uniform },
                power: PathSpectrum::Constant(1.0),
                per_m,
            };
            let (depth, side) = (depth * per_m, Vec3::new(0.8, 0.0, -0.6));
            let width = beam.radius + depth * tangent;
            let step = 4.0 * width / 4000.0;
            let flux: f64 = (0..4000)
                .map(|ring| {
                    let r = (f64::from(ring) + 0.5) * step;
                    let from = beam.position + beam.axis * depth + side * r;
                    let area_m2 = std::f64::consts::TAU * r * step / (per_m * per_m);
                    beam.sample(from, [0.0; 2], 0.0).map_or(0.0, |sample| sample.scale * -sample.wi.dot(beam.axis) * area_m2)
                })
                .sum();
            prop_assert!((flux - 1.0).abs() < 2.1e-3, "{flux}");
            // Nothing comes out of the back.
            prop_assert!(beam.sample(beam.position - beam.axis * depth, [0.0; 2], 0.0).is_none());
        }
    }
}
