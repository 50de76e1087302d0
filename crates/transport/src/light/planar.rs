//! What flat lights share: uniform points of the surface, seen as directions.

use super::{Emitter, LightSample, Target};
use crate::mis::Density;
use etalon_optics::Vec3;

/// The density in sr⁻¹ of the direction `wi` from `from` when points are uniform on a flat light of this `area`, through
/// `point` with unit normal `n`: d²/(|cos| A), with d = h/|cos| from the height h over the plane.
pub(super) fn density(from: Vec3<f64>, wi: Vec3<f64>, point: Vec3<f64>, n: Vec3<f64>, area: f64) -> f64 {
    let height = (point - from).dot(n);
    let cos = wi.dot(n).abs();
    let distance = height.abs() / cos;
    distance * distance / (cos * area)
}

/// The sample for `point` of a flat light; `None` edge-on, or where the light does not emit toward `from`.
pub(super) fn sample(
    from: Vec3<f64>,
    point: Vec3<f64>,
    n: Vec3<f64>,
    emitter: &Emitter,
    density_of: impl FnOnce(Vec3<f64>) -> f64,
) -> Option<LightSample> {
    let toward = point - from;
    let distance = toward.length();
    if distance == 0.0 || toward.dot(n) == 0.0 || !emitter.emits_along(n, -toward) {
        return None;
    }
    let wi = toward / distance;
    let density = density_of(wi);
    // In the plane of the light up to rounding, the density is infinite and the light's share zero.
    (density > 0.0 && density.is_finite()).then_some(LightSample {
        wi,
        density: Density::SolidAngle(density),
        target: Target::Point(point),
        surface: emitter.surface,
        scale: 1.0,
    })
}
