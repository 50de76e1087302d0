//! A density that falls exponentially with the height: e^(−h/H).

use super::Way;
use crate::frame::SceneFrame;
use etalon_optics::{Vec3, exp_neg, neg_ln, one_minus_exp_neg};
use etalon_scene::ExponentialDensity;

/// See the module; in the frame.
#[derive(Clone, Debug)]
pub(crate) struct Exponential {
    base: Vec3<f64>,
    /// Upward, as long as one over the scale height.
    up: Vec3<f64>,
}

/// e^(−h) for any h; infinity where it is too large.
fn of_height(height: f64) -> f64 {
    if height >= 0.0 { exp_neg(height) } else { exp_neg(-height).recip() }
}

impl Exponential {
    pub(super) fn new(density: &ExponentialDensity, frame: &SceneFrame) -> Self {
        let scale_height = density.scale_height_m * frame.per_m();
        Self { base: frame.point(Vec3::from_array(density.base_m)), up: Vec3::from_array(density.up) / scale_height }
    }

    pub(super) fn at(&self, place: Vec3<f64>) -> f64 {
        of_height((place - self.base).dot(self.up))
    }

    /// In scale heights: where a way begins, and by how much it rises in each unit of length.
    fn heights(&self, way: &Way) -> (f64, f64) {
        ((way.origin - self.base).dot(self.up), way.direction.dot(self.up))
    }

    /// From its lower end up, whichever end that is: ρ e^(−x) over the rise x of the way.
    pub(super) fn column(&self, way: &Way) -> f64 {
        let (height, rise) = self.heights(way);
        if rise == 0.0 {
            let density = of_height(height);
            return if density > 0.0 { density * way.length } else { 0.0 };
        }
        let low = if rise > 0.0 { height } else { height + rise * way.length };
        let density = of_height(low);
        if density == 0.0 {
            return 0.0;
        }
        density * one_minus_exp_neg(rise.abs() * way.length) / rise.abs()
    }

    /// Upward 1 − e^(−x) = y, downward e^x − 1 = y, y the column over the density and the scale height along the way.
    pub(super) fn distance(&self, way: &Way, column: f64) -> f64 {
        let (height, rise) = self.heights(way);
        let density = of_height(height);
        if rise == 0.0 {
            return column / density;
        }
        let steep = rise.abs();
        if rise < 0.0 && height > 600.0 {
            // From where there is nothing; 1 is nothing beside e^x.
            return (height - neg_ln(column * steep)) / steep;
        }
        let y = column * steep / density;
        let x = match (rise > 0.0, y < 1e-4) {
            // To y⁴: the next term is below 1e-16 of the first.
            (true, true) => y * (1.0 + y * (0.5 + y * (1.0 / 3.0 + 0.25 * y))),
            (false, true) => y * (1.0 - y * (0.5 - y * (1.0 / 3.0 - 0.25 * y))),
            (true, false) => neg_ln((1.0 - y).max(0.0)),
            (false, false) => neg_ln((1.0 + y).recip()),
        };
        (x / steep).min(way.length)
    }
}
