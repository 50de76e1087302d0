//! A Gaussian beam through a prism, line by line.

use super::super::{
    Claim, Truth,
    prisms::{BK7_B, BK7_C, bk7, half_deviation, refracted},
    scene::{Scene, extruded, sellmeier_glass, shown},
};
use crate::{
    laws::fresnel_exact,
    vector::{Vec3, add, dot, scale},
};
use serde_json::json;
use std::f64::consts::PI;

/// A Gaussian beam that goes through a prism of N-BK7 at least deviation for 587.5618 nm, in another line; the meter stands where the axis would
/// land by that wavelength.
pub(super) fn beams_through_a_prism() -> Vec<Truth> {
    const DISTANCE_M: f64 = 1.0;
    const RADIUS_M: f64 = 0.01;
    let design = half_deviation(bk7(587.5618));
    let incidence = design + 30.0_f64.to_radians();
    // The incidence inside the second face, and the angle of what leaves it, for an index.
    let inside = |n: f64| 60.0_f64.to_radians() - (incidence.sin() / n).asin();
    let leaves = move |n: f64| (n * inside(n).sin()).asin();
    let share = |distance: f64, radius: f64| 2.0 * (-2.0 * (distance / radius).powi(2)).exp() / (PI * radius * radius);
    let at = move |n: f64, [x, y]: [f64; 2]| {
        let error = leaves(n) - incidence;
        // The first face widens the beam by cos t/cos i, the second narrows it by cos i'/cos t'.
        let first = (incidence.sin() / n).asin();
        let narrower = first.cos() / incidence.cos() * leaves(n).cos() / inside(n).cos();
        // How far the axis lands from the meter toward the prism's base, and where the ray came in that lands at the meter.
        let moved = exit_shift(n, incidence);
        let aside = moved * incidence.cos() + (DISTANCE_M - moved * incidence.sin()) * error.tan() + x;
        let across = aside * error.cos() / narrower;
        let transmitted =
            fresnel_exact(incidence.cos(), n).transmittance() * fresnel_exact(inside(n).cos(), 1.0 / n).transmittance();
        share(across.hypot(y), RADIUS_M) / narrower * error.cos() * transmitted
    };
    let irradiance = move |n: f64| over_the_film(|place| at(n, place));
    [486.1327, 587.5618, 656.2725]
        .map(|wavelength_nm| {
            let n = bk7(wavelength_nm);
            let traced = move || {
                shown(over_the_film(|[x, y]| prism_by_rays(n, design, [DISTANCE_M, x], |b| share(b.hypot(y), RADIUS_M))))
            };
            Truth::new(
                format!("gaussian-beam-through-a-prism-at-{wavelength_nm}-nanometres"),
                &prism_scene(design, DISTANCE_M, RADIUS_M).band([wavelength_nm - 5e-4, wavelength_nm + 5e-4]),
                shown(irradiance(n)),
                "(ρ/π) T₁T₂ 2Φ exp(−2b²/w²)/(πw²), b where the ray came in that lands at the meter",
            )
            .because(
                "A prism bends each line by an angle of its own. The meter faces the light of the design line along its axis, so that light of another \
                 line lands beside it by about the distance times the difference of the angles.",
            )
            .confirmed("Snell's law in vector form at both faces, from the meter back to the beam", 1e-6, traced)
            .or_else("the index of another line", shown(irradiance(bk7(if wavelength_nm > 600.0 { 486.1327 } else { 656.2725 }))))
            .or_else("index too large by 1e-3", shown(irradiance(n + 1e-3)))
            .or_else("dark", 0.0)
            .claims(Claim::AveragesPolarisation)
            .claims(Claim::Dispersion)
            .sees(1e-3)
        })
        .into()
}

/// The mean over what the film sees of the meter: 0.1 mm across, and twice as much along y, since it looks from 60° beside the normal.
fn over_the_film(at: impl Fn([f64; 2]) -> f64) -> f64 {
    // Gauss's three places and weights, which are exact to the fifth power.
    let places = [(-0.6_f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6_f64.sqrt(), 5.0 / 18.0)];
    let mean =
        |(x, of_x): (f64, f64)| places.map(|(y, of_y)| of_x * of_y * at([0.5e-4 * x, 1e-4 * y])).iter().sum::<f64>();
    places.into_iter().map(mean).sum()
}

/// The apex of the prism is this far above the middle ray of the design line, along that ray's bisector.
const BELOW_APEX_M: f64 = 0.4;

/// How much farther from the apex than that of the design line the axis leaves the second face, for an index.
fn exit_shift(n: f64, incidence: f64) -> f64 {
    // Both faces meet at the apex by 60°. The axis meets the first at s from it, and leaves the second at s'.
    let s = BELOW_APEX_M / 30.0_f64.to_radians().cos();
    let first = (incidence.sin() / n).asin();
    let second = 60.0_f64.to_radians() - first;
    // The triangle of the apex and the two points has the angles 60°, 90° − t and 90° − t'.
    s * first.cos() / second.cos() - s
}

/// The directions of the design line: into the prism and out of it, in a frame whose x is the ray inside and whose y points to the apex.
fn prism_ways(design: f64) -> [Vec3; 2] {
    [[design.cos(), design.sin(), 0.0], [design.cos(), -design.sin(), 0.0]]
}

/// Where the design line meets the faces, in that frame.
fn prism_faces() -> [Vec3; 2] {
    let half = BELOW_APEX_M * 30.0_f64.to_radians().tan();
    [[-half, 0.0, 0.0], [half, 0.0, 0.0]]
}

/// Irradiance beside the middle of the meter by tracing from there back to the beam, of the profile `share` over the distance from its axis.
fn prism_by_rays(n: f64, design: f64, [distance_m, aside_m]: [f64; 2], share: impl Fn(f64) -> f64) -> f64 {
    let ([inward, outward], [enters, exits]) = (prism_ways(design), prism_faces());
    let (s, c) = 30.0_f64.to_radians().sin_cos();
    let (first, second) = ([-c, s, 0.0], [c, s, 0.0]);
    // The axis of this line through the prism.
    let within = refracted(inward, first, n);
    let out = refracted(within, scale(-1.0, second), 1.0 / n);
    // The meter, and back along the direction in which all of this line leaves.
    let across = [-outward[1], outward[0], 0.0];
    let meter = add(add(exits, scale(distance_m, outward)), scale(-aside_m, across));
    let meets = |p: Vec3, d: Vec3, on: Vec3, normal: Vec3| {
        add(p, scale(dot(add(on, scale(-1.0, p)), normal) / dot(d, normal), d))
    };
    let enters_beside = |meter: Vec3| {
        let left = meets(meter, out, exits, second);
        let entered = meets(left, within, enters, first);
        let across = [-inward[1], inward[0], 0.0];
        dot(add(entered, scale(-1.0, enters)), across)
    };
    let h = 1e-4;
    let grows =
        (enters_beside(add(meter, scale(h, across))) - enters_beside(add(meter, scale(-h, across)))) / (2.0 * h);
    let transmitted = fresnel_exact(-dot(inward, first), n).transmittance()
        * fresnel_exact(dot(within, second), 1.0 / n).transmittance();
    share(enters_beside(meter)) * grows.abs() * transmitted
}

/// The prism, turned so that the design line arrives at the meter along its normal.
fn prism_scene(design: f64, distance_m: f64, radius_m: f64) -> Scene {
    let ([inward, outward], [enters, exits]) = (prism_ways(design), prism_faces());
    let meter = add(exits, scale(distance_m, outward));
    // To the meter's frame: −outward is +z, what is across it +x, the prism's axis y.
    let across = [outward[1], -outward[0], 0.0];
    let turned = |d: Vec3| [dot(d, across), d[2], -dot(d, outward)];
    let placed = |p: Vec3| turned(add(p, scale(-1.0, meter)));
    let half = 2.0 * 30.0_f64.to_radians().tan();
    let apex_side = |depth: f64, aside: f64| [aside, BELOW_APEX_M - depth, 0.0];
    let corners = [apex_side(2.0, -half), apex_side(2.0, half), apex_side(0.0, 0.0)];
    let prism = extruded(&corners.map(|corner| add(placed(corner), [0.0, -1.0, 0.0])), [0.0, 2.0, 0.0]);
    let position = placed(add(enters, scale(-0.5, inward)));
    let glass = sellmeier_glass(BK7_B, BK7_C);
    Scene::light_meter()
        .object(prism, glass)
        .light(json!({
            "type": "beam", "position_m": position, "direction": turned(inward), "radius_m": radius_m, "profile": "gaussian", "power": 1.0,
        }))
        .film(16, 16)
        .spp(1 << 10)
}
