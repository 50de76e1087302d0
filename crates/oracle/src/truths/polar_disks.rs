//! Disks whose texture coordinates are polar.

use serde_json::{Value, json};

use super::facets::{direction, highlight, highlight_by_slopes};
use super::scene::{Scene, brushed_metal, disk};
use super::{Claim, Truth};
use std::f64::consts::TAU;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = gradients();
    list.push(turned_metal());
    list
}

/// A disk of radius 1 in the plane of x and y.
fn polar() -> Value {
    let mut shape = disk([0.0; 3], [0.0, 0.0, 1.0], 1.0);
    shape["coordinates"] = json!("polar");
    shape
}

/// A picture of a small square around a place of it.
fn seen([x, y]: [f64; 2]) -> Scene {
    Scene::orthographic([x, y, 2.0], [x, y, 0.0], 1e-3)
}

/// Reflectances that say the coordinates.
fn gradients() -> Vec<Truth> {
    const PLACE: [f64; 2] = [-0.6, -0.45];
    let [x, y] = PLACE;
    let (radius, turns) = (x.hypot(y), y.atan2(x).rem_euclid(TAU) / TAU);
    let square = PLACE.map(|v| 0.5 + 0.5 * v);
    [("u", radius, square[0], "r"), ("v", turns, square[1], "φ/2π")]
        .map(|(along, value, of_square, formula)| {
            let material =
                json!({ "type": "lambert", "reflectance": { "type": "gradient", "from": 0, "to": 1, "along": along } });
            let scene = seen(PLACE).thing(json!({ "shape": polar(), "material": material })).sky(1.0).film(8, 8);
            Truth::new(format!("polar-disk-along-{along}"), &scene, value, formula)
                .because("Under a sky of radiance 1 a disk shows its albedo: here the share of the radius, or of a turn about the axis.")
                .or_else("the coordinates of the square around it", of_square)
                .or_else("the other coordinate", radius + turns - value)
                .or_else("the other way round", 1.0 - value)
                .sees(5e-3)
        })
        .into()
}

/// Metal that was turned on a lathe: its grain goes with the radius.
fn turned_metal() -> Truth {
    const WIDTHS: [f64; 2] = [0.6, 0.15];
    const TURN_DEG: f64 = 90.0;
    let (grain, tilt_deg, from_u_deg) = ((WIDTHS, 0.0), 50.0, 25.0);
    let light = direction(tilt_deg, TURN_DEG + from_u_deg).map(|v| -v);
    let metal = brushed_metal(WIDTHS, 0.0, false);
    // On the axis of y, where u grows along y and v against x.
    let scene =
        seen([0.0, 0.5]).thing(json!({ "shape": polar(), "material": metal })).directional_light(light, 1.0).spp(64);
    Truth::new(
        "metal-turned-on-a-lathe",
        &scene,
        highlight(grain, tilt_deg, from_u_deg),
        "D(h) G₁/4 for α_u = 0.6 along the radius, α_v = 0.15 around the axis, light 50° off the normal, 25° from u toward v",
    )
    .because("The tangent of a disk with polar coordinates is its radius. So its highlight is that of a plate whose grain lies along that radius.")
    .confirmed("the density of slopes, its Jacobians and Walter's G₁", 1e-12, move || {
        highlight_by_slopes(grain, tilt_deg, from_u_deg)
    })
    .or_else("the grain of the square around it", highlight(grain, tilt_deg, TURN_DEG + from_u_deg))
    .or_else("widths exchanged", highlight(([WIDTHS[1], WIDTHS[0]], 0.0), tilt_deg, from_u_deg))
    .claims(Claim::AnisotropicFacets)
    .sees(2e-3)
}
