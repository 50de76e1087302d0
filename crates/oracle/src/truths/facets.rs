//! Brushed metal: GGX facets that are wider along one direction of the surface than across it.

use std::f64::consts::PI;

use serde_json::json;

use super::{
    Claim, Truth,
    scene::{Scene, black, brushed_metal, lambert, level_square, sphere},
};
use crate::{
    laws::{Masking, anisotropic_ggx_albedo, anisotropic_ggx_mirrors},
    quadrature::{Cone, directions},
    vector::Vec3,
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = highlights();
    list.extend(plates());
    list.push(ball());
    list.push(blend());
    list
}

/// A direction at `tilt_deg` off +z, `turn_deg` from +x toward +y.
pub(super) fn direction(tilt_deg: f64, turn_deg: f64) -> Vec3 {
    let ((sin, cos), (sin_turn, cos_turn)) = (tilt_deg.to_radians().sin_cos(), turn_deg.to_radians().sin_cos());
    [sin * cos_turn, sin * sin_turn, cos]
}

/// Widths of facets along the grain and across it, and the angle of the grain from x, degrees.
type Grain = ([f64; 2], f64);

/// f cos θ for facets that reflect everything, seen along the normal.
pub(super) fn highlight((alpha, rotation_deg): Grain, tilt_deg: f64, turn_deg: f64) -> f64 {
    let i = direction(tilt_deg, turn_deg - rotation_deg);
    anisotropic_ggx_mirrors(alpha, [0.0, 0.0, 1.0], i) * i[2]
}

/// The same from the slope of the facet between, tan(θ/2) along the light: its density among slopes, over the Jacobian of slopes to normals
/// and of normals to directions, and masking by Walter's G₁ of the width that the light meets.
pub(super) fn highlight_by_slopes((alpha, rotation_deg): Grain, tilt_deg: f64, turn_deg: f64) -> f64 {
    let (tilt, turn) = (tilt_deg.to_radians(), (turn_deg - rotation_deg).to_radians());
    let (tan, cos_h) = ((0.5 * tilt).tan(), (0.5 * tilt).cos());
    let [x, y] = [tan * turn.cos() / alpha[0], tan * turn.sin() / alpha[1]];
    let of_slopes = 1.0 / (PI * alpha[0] * alpha[1] * (1.0 + x * x + y * y).powi(2));
    let of_normals = of_slopes / cos_h.powi(4);
    let width = (alpha[0] * turn.cos()).hypot(alpha[1] * turn.sin());
    let masking = 2.0 / (1.0 + (1.0 + (width * tilt.tan()).powi(2)).sqrt());
    0.25 * of_normals * masking
}

fn highlights() -> Vec<Truth> {
    const BECAUSE: &str = "Seen along the normal, light from one direction shows the density of the facets half way: f cos θ = D(h) G/4, \
                           h the bisector. D = 1/(π α_u α_v e²), e = h_u²/α_u² + h_v²/α_v² + h_n² (Heitz 2014). No facet is hidden from a \
                           viewer on the normal, so G is Smith's G₁ of the light alone, correlated or not.";
    const HOW: &str = "the density of slopes, its Jacobians and Walter's G₁";
    let plate = |name: &str, grain: Grain, tilt_deg: f64, turn_deg: f64| {
        let light = direction(tilt_deg, turn_deg).map(|v| -v);
        let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1)
            .object(level_square([0.0; 3], 1.0, true), brushed_metal(grain.0, grain.1, false))
            .directional_light(light, 1.0)
            .spp(64);
        let ([u, v], rotation) = grain;
        let formula = format!(
            "D(h) G₁/4 for α_u = {u}, α_v = {v}, turned by {rotation}°, light {tilt_deg}° off the normal, {turn_deg}° from u toward v"
        );
        Truth::new(name, &scene, highlight(grain, tilt_deg, turn_deg), formula)
            .because(BECAUSE)
            .confirmed(HOW, 1e-12, move || highlight_by_slopes(grain, tilt_deg, turn_deg))
            .claims(Claim::AnisotropicFacets)
    };
    let (along, turned) = (([0.6, 0.15], 0.0), ([0.6, 0.15], 30.0));
    let value = |grain: Grain| highlight(grain, 50.0, 25.0);
    let [u, v] = along.0;
    let mean = f64::sqrt(u * v);
    vec![
        plate("brushed-metal-highlight", along, 50.0, 25.0)
            .or_else("widths exchanged", value(([v, u], 0.0)))
            .or_else("one width, the geometric mean of both", value(([mean; 2], 0.0)))
            .or_else("density over α_u² instead of α_u α_v", value(along) * v / u)
            .or_else("widths taken for square roots of α", value(([u * u, v * v], 0.0)))
            .sees(1e-3),
        plate("brushed-metal-turned", turned, 50.0, 25.0)
            .or_else("the rotation left out", value(along))
            .or_else("turned the other way", value((along.0, -30.0)))
            .or_else("widths exchanged", value(([v, u], 30.0)))
            .or_else("the rotation taken for radians", value((along.0, 30.0_f64.to_degrees())))
            .sees(1e-3),
    ]
}

fn plates() -> Vec<Truth> {
    const GRAIN: [f64; 2] = [0.9, 0.1];
    const TILT_DEG: f64 = 75.0;
    // By midpoints over the disk that GGX's facets fill evenly for a viewer (Heitz 2018), 4000², in a program of its own.
    let plate = |name: &str, rotation_deg: f64, turn_deg: f64, value: f64| {
        let eye = direction(TILT_DEG, turn_deg).map(|v| 2.0 * v);
        let scene = Scene::orthographic(eye, [0.0; 3], 0.1)
            .object(level_square([0.0; 3], 1.0, true), brushed_metal(GRAIN, rotation_deg, false))
            .sky(1.0);
        let [u, v] = GRAIN;
        let formula = format!(
            "∫ D G₂/(4 cos θ_o) dω for α_u = {u}, α_v = {v}, turned by {rotation_deg}°, seen {TILT_DEG}° off the normal, {turn_deg}° from u \
             toward v"
        );
        let seen_along = direction(TILT_DEG, turn_deg - rotation_deg);
        Truth::new(name, &scene, value, formula)
            .because(
                "In uniform light a surface shows its albedo: that of facets that reflect everything, where light that meets a second one is \
                 lost.",
            )
            .confirmed("midpoints over the slopes of facets, 640²", 5e-5, move || {
                anisotropic_ggx_albedo(GRAIN, seen_along, None, Masking::Correlated).reflected
            })
            .or_else("no masking of the light that leaves", 1.0)
            .claims(Claim::AnisotropicFacets)
            .claims(Claim::CorrelatedMasking)
    };
    vec![
        plate("brushed-metal-along-its-grain", 0.0, 0.0, 0.773_858)
            .or_else("widths exchanged", 0.561_371)
            .or_else("masking by G₁G₁", 0.705_090),
        plate("brushed-metal-across-its-grain", 0.0, 90.0, 0.561_371)
            .or_else("widths exchanged", 0.773_858)
            .or_else("masking by G₁G₁", 0.558_322)
            .sees(4e-3),
        plate("brushed-metal-aslant", 40.0, 60.0, 0.766_368)
            .or_else("widths exchanged", 0.644_846)
            .or_else("the rotation left out", 0.688_155)
            .or_else("turned the other way", 0.591_810),
    ]
}

/// What the tables of lost light give back too little, on the mean over the picture.
const TABLES: f64 = 5e-4;

fn ball() -> Truth {
    let alpha = [0.8, 0.1];
    let scene = Scene::pinhole([0.0, 0.0, 5.0], [0.0; 3], 16.0)
        .object(sphere([0.0; 3], 1.0), brushed_metal(alpha, 20.0, true))
        .sky(1.0);
    // Without a closed form: the mean albedo over a ball whose grain lies at every angle, to 0.02.
    let lost = 0.67;
    Truth::new("furnace-brushed-metal", &scene, 1.0, "L = 1")
        .because(
            "Facets that reflect everything send all light somewhere, some of it after it met several. A convex body that absorbs nothing \
             cannot be seen in uniform light.",
        )
        .or_else("light that meets several facets is lost", lost)
        .allows(TABLES, "tables of lost light give back up to 5e-4 too little; and single precision")
        .sees(0.005)
        .claims(Claim::AnisotropicFacets)
        .claims(Claim::LosslessRoughMetal)
}

/// A surface of which a part is matte and the rest polished, below a lamp.
fn blend() -> Truth {
    const ALPHA: [f64; 2] = [0.06; 2];
    const ALBEDO: f64 = 0.9;
    const METAL: f64 = 0.3;
    const TILT_DEG: f64 = 8.0;
    const HALF_ANGLE_DEG: f64 = 10.0;
    const FAR_M: f64 = 2.0;
    let axis = direction(TILT_DEG, 0.0);
    let material = json!({
        "type": "blend", "first": lambert(ALBEDO), "second": brushed_metal(ALPHA, 0.0, false), "weight": METAL,
    });
    let lamp = sphere(axis.map(|x| FAR_M * x), FAR_M * HALF_ANGLE_DEG.to_radians().sin());
    let scene = Scene::orthographic([0.0, 0.0, 0.5], [0.0; 3], 1e-4)
        .thing(json!({ "shape": level_square([0.0; 3], 1e-3, true), "material": material }))
        .lamp(lamp, black(), 1.0, "front");
    let cone = Cone::new(axis, HALF_ANGLE_DEG.to_radians());
    let matte = ALBEDO * HALF_ANGLE_DEG.to_radians().sin().powi(2) * axis[2];
    let metal = directions(|i| anisotropic_ggx_mirrors(ALPHA, [0.0, 0.0, 1.0], i) * i[2], cone, 1e-8, 1_000_000).value;
    let mixed = |share: f64| (1.0 - share) * matte + share * metal;
    Truth::new(
        "blend-of-matte-and-polished-below-a-lamp",
        &scene,
        mixed(METAL),
        "(1 − w) ρ sin²σ cos θ + w ∫ D(h) G₁/4 dω over the lamp, σ = 10°, θ = 8°",
    )
    .because(
        "A blend scatters what its parts do, each by its share: the matte part by the lamp's form factor, the polished one by the \
         density of the facets half way to each place of the lamp.",
    )
    .confirmed("midpoints over the lamp, facets by their slopes", 1e-5, move || {
        const STEPS: u32 = 400;
        let part = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
        let at = |h: f64, turn: f64| {
            let [x, y, z] = cone.direction(h, 2.0 * PI * turn);
            let tilt_deg = x.hypot(y).atan2(z).to_degrees();
            (1.0 - METAL) * ALBEDO / PI * z + METAL * highlight_by_slopes((ALPHA, 0.0), tilt_deg, 0.0)
        };
        let sum: f64 = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))).map(|(i, j)| at(part(i), part(j))).sum();
        2.0 * PI * (1.0 - HALF_ANGLE_DEG.to_radians().cos()) * sum / f64::from(STEPS).powi(2)
    })
    .or_else("shares exchanged", mixed(1.0 - METAL))
    .or_else("the matte part alone", matte)
    .or_else("the polished part alone", metal)
    .sees(2e-3)
}
