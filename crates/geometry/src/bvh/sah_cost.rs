//! How often rays enter a box.

use crate::frame::half_area;

/// The mean chord of a scene's box, in lengths of rays.
///
/// Rays that begin anywhere in a scene, in any direction, and are ℓ long meet a convex body of surface s and volume v within it if they
/// begin in the body or in its shadow, which is s/4 wide on average (Cauchy 1832) and ℓ long: as v + ℓ s/4. To say how long rays are, the
/// scene's own mean chord is at hand, 4V/S. Fabianowski, Fowler & Dingliana (*A Cost Metric for Scene-Interior Ray Origins*, Eurographics 2009
/// short papers) let rays end where they leave the scene's box, which makes them half as long or longer; but most end long before, where
/// they hit something. What was measured with other numbers stands in `docs/log/2026-11-ray-traversal.md`.
const CHORD: f32 = 4.0;
/// A scene whose box has less volume than this, in the units of the frame, where it is about one long, has no inside.
const LEAST_VOLUME: f32 = 1e-30;

/// How often rays enter a box, relative to others of the same scene: half its surface area, by which rays from afar enter it
/// (Goldsmith & Salmon 1987), and its volume, since some begin in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SahCost {
    /// What volume is worth.
    inside: f32,
}

impl SahCost {
    /// For the boxes in a scene whose box has these sides.
    pub(crate) fn in_scene(scene: [f32; 3]) -> Self {
        let volume = volume(scene);
        Self { inside: if volume > LEAST_VOLUME { CHORD * half_area(scene) / volume } else { 0.0 } }
    }

    /// Of a box with these sides, none below zero.
    #[inline(always)]
    pub(crate) fn of(self, sides: [f32; 3]) -> f32 {
        half_area(sides) + self.inside * volume(sides)
    }
}

#[inline(always)]
fn volume([x, y, z]: [f32; 3]) -> f32 {
    x * y * z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Random;

    /// Rays of a quarter of the mean chord, from anywhere in a cube, that meet boxes farther than that from its sides: flat ones, needles
    /// and cubes.
    #[test]
    fn rays_that_begin_in_a_scene_enter_boxes_as_often_as_measured() {
        const RAYS: u32 = 1_000_000;
        const SCENE: f64 = 2.0;
        let mut random = Random::new(71);
        let length = SCENE * 4.0 / 6.0 / f64::from(CHORD);
        let measure = SahCost::in_scene([SCENE as f32; 3]);
        for sides in [[0.8, 0.8, 0.0], [0.8, 0.2, 0.1], [0.6, 0.6, 0.6], [0.02, 0.02, 1.0], [1.2, 0.8, 0.4]] {
            let met = (0..RAYS).filter(|_| {
                let origin: [f64; 3] = std::array::from_fn(|_| SCENE * (random.unit() - 0.5));
                let direction = random.direction().to_array();
                let (mut near, mut far) = (0.0_f64, length);
                for k in 0..3 {
                    let ends = [-0.5, 0.5].map(|end| (end * f64::from(sides[k]) - origin[k]) / direction[k]);
                    (near, far) = (near.max(ends[0].min(ends[1])), far.min(ends[0].max(ends[1])));
                }
                near <= far
            });
            // v + ℓ s/4 is ℓ/2 of the measure.
            let expected = 0.5 * length * f64::from(measure.of(sides)) / SCENE.powi(3);
            let found = met.count() as f64 / f64::from(RAYS);
            let error = (expected * (1.0 - expected) / f64::from(RAYS)).sqrt();
            // By chance once in a hundred thousand runs for one of them. A volume or a surface wrong by 5 % is more for the cube.
            assert!((found - expected).abs() < 4.75 * error, "{found} of {sides:?}, not {expected}");
        }
    }

    #[test]
    fn scenes_without_an_inside_have_a_measure() {
        for thickness in [0.0, f32::MIN_POSITIVE, 1e-31, 1e-29, 1e-20] {
            let measure = SahCost::in_scene([1.0, 1.0, thickness]);
            for sides in [[1.0, 1.0, thickness], [0.5, 0.25, thickness], [0.5, 0.25, 0.0]] {
                let (m, area) = (measure.of(sides), half_area(sides));
                assert!(m >= area && m <= 1.001 * (area + CHORD), "{m} of {sides:?}");
            }
        }
    }
}
