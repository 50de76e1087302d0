//! A spot: a point whose intensity falls smoothly to nothing at the edge of a cone.
//!
//! I(θ) = I₀·(3x² − 2x³) with x = (cos θ − cos θ_outer)/(cos θ_inner − cos θ_outer) cut to [0, 1]: I₀ within the inner angle,
//! nothing beyond the outer. Its power is 2πI₀·(1 − ½cos θ_inner − ½cos θ_outer).

use super::cone::Cone;
use super::tree::LightBounds;
use super::{LightSample, LightSource, PointLight};
use crate::media::Way;
use crate::spectral::PathSpectrum;
use etalon_optics::Vec3;

/// A spot light.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// The point, with the intensity along the axis.
    pub point: PointLight,
    /// Unit vector along the axis.
    pub axis: Vec3<f64>,
    /// Cosines of the inner and the outer half angle; the inner one at least as large.
    pub cosines: [f64; 2],
}

impl SpotLight {
    /// I(θ)/I₀.
    fn falloff(&self, cos: f64) -> f64 {
        let [inner, outer] = self.cosines;
        if cos >= inner {
            return 1.0;
        }
        if cos <= outer {
            return 0.0;
        }
        let x = (cos - outer) / (inner - outer);
        x * x * (3.0 - 2.0 * x)
    }

    /// Cosine of the angle between the inner and the outer cone.
    fn cos_beyond_inner(&self) -> f64 {
        let [inner, outer] = self.cosines;
        inner * outer + ((1.0 - inner * inner) * (1.0 - outer * outer)).max(0.0).sqrt()
    }
}

impl LightSource for SpotLight {
    fn sample(&self, from: Vec3<f64>, u: [f64; 2], time: f64) -> Option<LightSample> {
        let sample = self.point.sample(from, u, time)?;
        let falloff = self.falloff(-sample.wi.dot(self.axis));
        (falloff > 0.0).then_some(LightSample { scale: sample.scale * falloff, ..sample })
    }

    fn spectrum(&self) -> &PathSpectrum {
        &self.point.intensity
    }

    fn position(&self) -> Option<Vec3<f64>> {
        Some(self.point.position)
    }

    fn lit_part(&self, way: &Way) -> Option<[f64; 2]> {
        let [_, outer] = self.cosines;
        if outer <= 0.0 {
            return Some([0.0, way.length]);
        }
        let tangent = ((1.0 - outer) * (1.0 + outer)).sqrt() / outer;
        Cone { position: self.point.position, axis: self.axis, radius: 0.0, tangent }.part(way)
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(LightBounds {
            axis: self.axis,
            cos_normals: self.cosines[0],
            cos_shines: self.cos_beyond_inner(),
            ..self.point.bounds()?
        })
    }

    fn power_factor(&self, _scene_radius: f64) -> f64 {
        let [inner, outer] = self.cosines;
        std::f64::consts::TAU * self.point.per_m * self.point.per_m * (1.0 - 0.5 * (inner + outer))
    }
}
