//! Images of the sky in rows: directions toward one, and what paths find of it that leave the scene.

use super::lamps::LightSamples;
use super::level::{Level, stages};
use super::rows::{Mask, W, lanes};
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
    /// Directions toward a sky for the paths of `mask`, in place of those that are there. As many are computed side by side as are cast at once, and only those that are
    /// wanted: the texels of each are far from those of the others.
    fn aim_at_sky(sky: &EnvironmentLight, u: [&[f64; W]; 2], mask: Mask, skies: &mut SkyLights, light_samples: &mut LightSamples) {
        let mut left = mask;
        while left != 0 {
            let mut from = [left.trailing_zeros() as usize; LANES];
            let count = LANES.min(left.count_ones() as usize);
            for (place, lane) in lanes(left).take(LANES).enumerate() {
                from[place] = lane;
                left &= !(1 << lane);
            }
            let (mut u0, mut u1) = ([0.0; LANES], [0.0; LANES]);
            for place in 0..LANES {
                (u0[place], u1[place]) = (u[0][from[place] % W], u[1][from[place] % W]);
            }
            let (wi, looks) = sky.sample_row([&u0, &u1]);
            for place in 0..count {
                let lane = from[place] % W;
                light_samples.wi.set(lane, wi[place]);
                light_samples.density.0[lane] = looks[place].density;
                skies.looks[lane] = looks[place];
            }
        }
    }

    /// What a sky shows along the rays of `mask`.
    fn look_at_sky(sky: &EnvironmentLight, directions: &[[f64; LANES]; 3], mask: u8, looks: &mut [Look; LANES]) {
        let [x, y, z] = directions;
        // The others look where one of these does: what they would see would have to be fetched.
        let first = mask.trailing_zeros() as usize % LANES;
        let mut wi = [Vec3::ZERO; LANES];
        for lane in 0..LANES {
            let from = if mask >> lane & 1 == 1 { lane } else { first };
            wi[lane] = Vec3::new(x[from], y[from], z[from]);
        }
        *looks = sky.look_row(&wi);
    }
}
