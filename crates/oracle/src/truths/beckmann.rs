//! Facets whose slopes are Gaussian, and facets that hide each other from each direction by itself.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{Scene, black, conductor, level_square, parallelogram, sphere},
};
use crate::{
    laws::{Masking, anisotropic_ggx_albedo, anisotropic_ggx_mirrors, beckmann_albedo, beckmann_mirrors},
    vector::Vec3,
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![highlight()];
    list.extend(plates());
    list.extend(furnaces());
    list
}

/// A direction at `tilt_deg` off +z, `turn_deg` from +x toward +y.
fn direction(tilt_deg: f64, turn_deg: f64) -> Vec3 {
    let ((sin, cos), (sin_turn, cos_turn)) = (tilt_deg.to_radians().sin_cos(), turn_deg.to_radians().sin_cos());
    [sin * cos_turn, sin * sin_turn, cos]
}

/// A material with further keys.
fn with(mut material: Value, further: &Value) -> Value {
    for (key, value) in further.as_object().into_iter().flatten() {
        material[key] = value.clone();
    }
    material
}

/// f cos θ of facets seen along the normal, from their slope and from what Smith (1967) defines masking by: the share of slopes q along the
/// light that exceed its own, (1/κ)∫_κ^∞ (q − κ) p(q) dq, κ = cot θ, by Simpson's rule.
fn highlight_by_slopes([u, v]: [f64; 2], tilt_deg: f64, turn_deg: f64) -> f64 {
    let (tilt, turn) = (tilt_deg.to_radians(), turn_deg.to_radians());
    let (tan, cos_h) = ((0.5 * tilt).tan(), (0.5 * tilt).cos());
    let [x, y] = [tan * turn.cos() / u, tan * turn.sin() / v];
    let of_normals = (-x * x - y * y).exp() / (PI * u * v) / cos_h.powi(4);
    // Along the light slopes are Gaussian, too.
    let width = (u * turn.cos()).hypot(v * turn.sin());
    let (kappa, steps) = (1.0 / tilt.tan(), 2000);
    let step = 8.0 * width / f64::from(steps);
    let steep = |i: i32| {
        let q = kappa + step * f64::from(i);
        let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        weight * (q - kappa) * (-(q / width).powi(2)).exp() / (width * PI.sqrt())
    };
    let lambda = (0..=steps).map(steep).sum::<f64>() * step / (3.0 * kappa);
    0.25 * of_normals / (1.0 + lambda)
}

fn highlight() -> Truth {
    let (widths, tilt_deg, turn_deg) = ([0.6, 0.3], 50.0, 25.0);
    let metal = json!({ "alpha_u": 0.6, "alpha_v": 0.3, "distribution": "beckmann", "multiple_scattering": "lost" });
    let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1)
        .thing(json!({
            "shape": level_square([0.0; 3], 1.0, true),
            "material": with(conductor(1e-12, 3.0), &metal),
        }))
        .directional_light(direction(tilt_deg, turn_deg).map(|v| -v), 1.0)
        .spp(64);
    let (o, i) = ([0.0, 0.0, 1.0], direction(tilt_deg, turn_deg));
    let value = |[u, v]: [f64; 2]| beckmann_mirrors([u, v], o, i, Masking::Correlated) * i[2];
    Truth::new(
        "beckmann-metal-highlight",
        &scene,
        value(widths),
        "D(h) G₁/4, D = e^(−tan²θ_h (cos²φ/α_u² + sin²φ/α_v²))/(π α_u α_v cos⁴θ_h), for α_u = 0.6, α_v = 0.3, light 50° off the normal, 25° \
         from u toward v",
    )
    .because(
        "Seen along the normal, light from one direction shows the density of the facets half way. No facet is hidden from a viewer on the \
         normal, so G is Smith's G₁ of the light alone, 2/(1 + erf a + e^(−a²)/(a√π)), a = 1/(α tan θ) of the width that the light meets.",
    )
    .confirmed("the density of slopes and Smith's integral over those that are steeper than the light", 1e-9, move || {
        highlight_by_slopes(widths, tilt_deg, turn_deg)
    })
    .or_else("GGX of the same widths", anisotropic_ggx_mirrors(widths, o, i) * i[2])
    .or_else("α taken for the standard deviation of slopes", value(widths.map(|alpha| alpha * f64::sqrt(2.0))))
    .or_else("widths exchanged", value([widths[1], widths[0]]))
    .or_else("cos³ instead of cos⁴", value(widths) * f64::cos(25.0_f64.to_radians()))
    .sees(1e-3)
}

/// A plate of some material, seen 70° off its normal in uniform light; black below.
fn plates() -> Vec<Truth> {
    const TILT_DEG: f64 = 70.0;
    let o = direction(TILT_DEG, 0.0);
    let scene = |material: Value| {
        Scene::orthographic(o.map(|v| 2.0 * v), [0.0; 3], 0.1)
            .thing(json!({ "shape": level_square([0.0; 3], 50.0, true), "material": material }))
            .object(parallelogram([-60.0, -60.0, -0.01], [120.0, 0.0, 0.0], [0.0, 120.0, 0.0]), black())
            .sky(1.0)
    };
    // By midpoints over directions of light, 1600², in a program of its own; 800² say the same to 4e-7.
    let truth = |name: &str, material: Value, value: f64, again: fn() -> f64| {
        Truth::new(name, &scene(material), value, "∫ D(h) R G(o, i)/(4 cos θₒ) dω_i, seen 70° off the normal")
            .because(
                "In uniform light a surface shows its albedo: what its facets reflect at the first meeting. What they refract is absorbed.",
            )
            .confirmed("midpoints over the slopes of facets, 640²", 5e-5, again)
            .sees(5e-3)
    };
    let metal = |alpha: f64, distribution: &str, masking: &str| {
        let further = json!({
            "alpha": alpha, "distribution": distribution, "masking": masking, "multiple_scattering": "lost",
        });
        with(conductor(1e-12, 3.0), &further)
    };
    let glass = |further: Value| {
        with(json!({ "type": "dielectric", "interior": 1.5, "multiple_scattering": "lost", "alpha": 0.8 }), &further)
    };
    let coat =
        |further: Value| with(json!({ "type": "plastic", "reflectance": 0, "coat": 1.5, "alpha": 0.8 }), &further);
    macro_rules! of {
        ($albedo:ident, $alpha:expr, $eta:expr, $masking:ident) => {
            || $albedo([$alpha; 2], direction(TILT_DEG, 0.0), $eta, Masking::$masking).reflected
        };
    }
    let gaussian = json!({ "distribution": "beckmann" });
    let gaussian_apart = json!({ "distribution": "beckmann", "masking": "separable" });
    let apart = json!({ "masking": "separable" });
    vec![
        truth(
            "beckmann-metal-lost",
            metal(0.8, "beckmann", "correlated"),
            0.870_329,
            of!(beckmann_albedo, 0.8, None, Correlated),
        )
        .or_else("GGX of the same width", 0.608_268)
        .or_else("masking by G₁G₁", 0.859_806)
        .or_else("what meets several facets given back", 1.0)
        .claims(Claim::CorrelatedMasking),
        truth(
            "beckmann-metal-of-separable-masking",
            metal(0.8, "beckmann", "separable"),
            0.859_806,
            of!(beckmann_albedo, 0.8, None, Separable),
        )
        .or_else("masking correlated in height", 0.870_329),
        truth(
            "ggx-metal-of-separable-masking",
            metal(0.4, "ggx", "separable"),
            0.756_180,
            of!(anisotropic_ggx_albedo, 0.4, None, Separable),
        )
        .or_else("masking correlated in height", 0.772_776),
        truth(
            "beckmann-glass-reflects",
            glass(gaussian.clone()),
            0.061_401,
            of!(beckmann_albedo, 0.8, Some(1.5), Correlated),
        )
        .or_else("GGX of the same width", 0.038_749)
        .or_else("masking by G₁G₁", 0.059_834)
        .claims(Claim::CorrelatedMasking)
        .claims(Claim::AveragesPolarisation)
        .sees(0.01),
        truth(
            "ggx-glass-of-separable-masking",
            glass(apart),
            0.034_186,
            of!(anisotropic_ggx_albedo, 0.8, Some(1.5), Separable),
        )
        .or_else("masking correlated in height", 0.038_749)
        .claims(Claim::AveragesPolarisation)
        .sees(0.01),
        truth("beckmann-coat-reflects", coat(gaussian), 0.061_401, of!(beckmann_albedo, 0.8, Some(1.5), Correlated))
            .or_else("GGX of the same width", 0.038_749)
            .claims(Claim::CorrelatedMasking)
            .claims(Claim::AveragesPolarisation)
            .sees(0.01),
        truth(
            "beckmann-coat-of-separable-masking",
            coat(gaussian_apart),
            0.059_834,
            of!(beckmann_albedo, 0.8, Some(1.5), Separable),
        )
        .or_else("masking correlated in height", 0.061_401)
        .claims(Claim::AveragesPolarisation)
        .sees(0.01),
    ]
}

/// Bodies that absorb nothing, which cannot be seen in uniform light.
fn furnaces() -> Vec<Truth> {
    let ball = |material: Value| {
        Scene::pinhole([0.0, 0.0, 5.0], [0.0; 3], 16.0)
            .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": material }))
            .sky(1.0)
            .film(16, 16)
            .spp(512)
    };
    let because = "A surface that absorbs nothing sends all light somewhere, some of it after it met several facets; in uniform light that \
                   is L.";
    let metal = json!({ "alpha": 0.9, "distribution": "beckmann", "multiple_scattering": "compensated" });
    let glass = json!({
        "type": "dielectric", "interior": 1.5, "alpha": 0.6, "distribution": "beckmann", "masking": "correlated",
        "multiple_scattering": "compensated",
    });
    let plastic = json!({ "type": "plastic", "reflectance": 1, "coat": 1.5, "alpha": 0.5, "distribution": "beckmann" });
    vec![
        Truth::new("furnace-beckmann-metal", &ball(with(conductor(1e-12, 3.0), &metal)), 1.0, "L = 1")
            .because(because)
            .or_else("light that meets several facets is lost", 0.71)
            .allows(5e-4, "tables of lost light give back up to 1.5e-4 too little; and single precision")
            .claims(Claim::LosslessRoughMetal)
            .sees(0.005),
        Truth::new("furnace-beckmann-glass", &ball(glass), 1.0, "L = 1")
            .because(because)
            .or_else("n² of the way in not undone", 2.25)
            .allows(1e-3, "tables of lost light give back up to 1.5e-4 too little at each of some seven meetings with the surface")
            .claims(Claim::LosslessRoughGlass)
            .sees(0.01),
        Truth::new("furnace-beckmann-plastic", &ball(plastic), 1.0, "L = 1")
            .because("All that the coat lets in leaves by it again.")
            .allows(1e-3, "the coat's table is known to 1.5e-4, and is met several times; and single precision")
            .sees(0.005),
    ]
}
