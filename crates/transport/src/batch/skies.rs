//! Images of the sky in rows: directions toward one, and what paths find of it that leave the scene.

use super::lamps::LightSamples;
use super::level::{Level, stages};
use super::rows::{Mask, W};
use crate::light::{EnvironmentLight, Light, LightSample, Look};
use etalon_geometry::LANES;
use etalon_optics::Vec3;

/// Fewest paths that look at a sky for which all of a set are computed at once.
pub(super) const FEWEST_LOOKS: u32 = 3;

/// Skies that paths look at.
pub(super) struct SkyLights {
    /// Which paths look at a sky.
    pub mask: Mask,
    /// What it shows in the directions of [`LightSamples`].
    looks: [Look; W],
}

impl SkyLights {
    pub(super) const NONE: Self = Self { mask: 0, looks: [Look::BLACK; W] };

    /// The light that a path looks at.
    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, light: &Light) {
        let is_sky = matches!(light, Light::Environment(_));
        self.mask = self.mask & !(1 << lane) | Mask::from(is_sky) << lane;
    }

    /// What a path sees of the sky; `None` where that is black.
    #[inline(always)]
    pub(super) fn sample(&self, lane: usize, wi: Vec3<f64>) -> Option<LightSample> {
        self.looks[lane].sample(wi)
    }
}

stages! {
    /// Directions toward a sky for the paths of `mask`, in place of those that are there.
    fn aim_at_sky(sky: &EnvironmentLight, u: [&[f64; W]; 2], mask: Mask, skies: &mut SkyLights, light_samples: &mut LightSamples) {
        let (wi, looks) = sky.sample_row(u);
        for lane in 0..W {
            if mask >> lane & 1 == 1 {
                light_samples.wi.set(lane, wi[lane]);
                light_samples.density.0[lane] = looks[lane].density;
                skies.looks[lane] = looks[lane];
            }
        }
    }

    /// What a sky shows along some rays.
    fn look_at_sky(sky: &EnvironmentLight, directions: &[[f64; LANES]; 3], looks: &mut [Look; LANES]) {
        let [x, y, z] = directions;
        let mut wi = [Vec3::ZERO; LANES];
        for lane in 0..LANES {
            wi[lane] = Vec3::new(x[lane], y[lane], z[lane]);
        }
        *looks = sky.look_row(&wi);
    }
}
