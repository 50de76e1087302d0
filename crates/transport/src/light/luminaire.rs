//! A luminaire: a point whose intensity a table says for each direction.

use super::tree::LightBounds;
use super::{LightSample, LightSource, PointLight};
use crate::spectral::PathSpectrum;
use etalon_optics::{Real, Vec3, atan2_turns};
use etalon_scene::Photometry;
use std::sync::Arc;

/// A point with a table of intensities.
#[derive(Clone, Debug)]
pub struct LuminaireLight {
    /// The point, with the intensity that 1 cd of the table stands for.
    pub point: PointLight,
    /// Unit vectors: where the polar angle is 0; where the azimuth is 0, and a quarter turn.
    pub nadir: Vec3<f64>,
    /// See above.
    pub planes: [Vec3<f64>; 2],
    /// The table.
    pub table: Arc<Photometry>,
    /// Its flux, lm.
    pub flux_lm: f64,
    /// Cosine of the angle from the nadir beyond which there is no light.
    pub cos_reach: f64,
}

impl LuminaireLight {
    /// Intensity in a direction away from it, in cd of the table.
    fn intensity(&self, away: Vec3<f64>) -> f64 {
        let [x, y] = self.planes.map(|plane| away.dot(plane));
        let polar = atan2_turns((x * x + y * y).sqrt_nonnegative(), away.dot(self.nadir));
        let azimuth = atan2_turns(y, x);
        self.table.eval(polar, if azimuth < 0.0 { azimuth + 1.0 } else { azimuth })
    }
}

impl LightSource for LuminaireLight {
    fn sample(&self, from: Vec3<f64>, u: [f64; 2], time: f64) -> Option<LightSample> {
        let sample = self.point.sample(from, u, time)?;
        let intensity = self.intensity(-sample.wi);
        (intensity > 0.0).then_some(LightSample { scale: sample.scale * intensity, ..sample })
    }

    fn spectrum(&self) -> &PathSpectrum {
        &self.point.intensity
    }

    fn position(&self) -> Option<Vec3<f64>> {
        self.point.position()
    }

    fn bounds(&self) -> Option<LightBounds> {
        // As bright everywhere as where it is brightest: what is drawn too often costs noise, what is never drawn light.
        Some(LightBounds { axis: self.nadir, cos_normals: self.cos_reach, cos_shines: 1.0, ..self.point.bounds()? })
    }

    fn power_factor(&self, _scene_radius: f64) -> f64 {
        self.flux_lm * self.point.per_m * self.point.per_m
    }
}
