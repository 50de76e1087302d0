//! Media that absorb.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{Scene, black, block, glass, level_square, solid, sphere},
};
use crate::{
    laws::fresnel_exact,
    quadrature::{interval, rectangle},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = plates();
    list.extend([ball_without_refraction(), ball_of_glass(), eye_within(), lamp_within()]);
    list.extend(filled());
    list.into_iter().map(|truth| truth.claims(Claim::Absorption)).collect()
}

/// The material with this absorption coefficient inside, m⁻¹.
fn absorbing(mut material: Value, per_m: f64) -> Value {
    material["absorption_per_m"] = json!(per_m);
    material
}

/// Transmittance of a plate whose faces reflect R, and which lets τ through from face to face.
fn plate(r: f64, tau: f64) -> f64 {
    (1.0 - r).powi(2) * tau / (1.0 - (r * tau).powi(2))
}

fn plates() -> Vec<Truth> {
    const THICKNESS_M: f64 = 0.01;
    const PER_M: f64 = 50.0;
    let because = "At each pass e^(−σd/cos θ') is left, d/cos θ' being the way through the plate; the beams reflected to and fro add up to \
         (1 − R)²τ/(1 − R²τ²).";
    let scene = |tilt_deg: f64, material: Value| {
        let (sine, cosine) = tilt_deg.to_radians().sin_cos();
        Scene::orthographic([sine, 0.0, cosine], [0.0; 3], 1e-3)
            .object(block([-20.0, -20.0, -THICKNESS_M], [20.0, 20.0, 0.0]), absorbing(material, PER_M))
            .lamp(level_square([0.0, 0.0, -0.02], 1e3, true), black(), 1.0, "front")
            .spp(1024)
    };
    let mut list = Vec::new();
    for (name, tilt_deg, material) in [
        ("absorbing-plate-at-0-degrees", 0.0_f64, glass(1.5)),
        ("absorbing-plate-at-60-degrees", 60.0, glass(1.5)),
        ("absorbing-plate-by-priority", 60.0, solid(1.5, 3)),
    ] {
        let (sine, cosine) = tilt_deg.to_radians().sin_cos();
        let r = fresnel_exact(cosine, 1.5).reflectance();
        let inside = (1.0 - (sine / 1.5).powi(2)).sqrt();
        let tau = (-PER_M * THICKNESS_M / inside).exp();
        let mut truth = Truth::new(
            name,
            &scene(tilt_deg, material.clone()),
            plate(r, tau),
            "(1 − R)²τ/(1 − R²τ²), τ = e^(−σd/cos θ')",
        )
        .because(because)
        .confirmed("adding up the beams one by one", 1e-12, move || {
            (0..200).map(|k| (1.0 - r).powi(2) * tau * (r * tau).powi(2 * k)).sum()
        })
        .or_else("nothing is absorbed", plate(r, 1.0))
        .sees(0.01);
        if tilt_deg > 0.0 {
            truth = truth
                .or_else("the thickness taken for the way", plate(r, (-PER_M * THICKNESS_M).exp()))
                .or_else("the way outside taken for the way inside", plate(r, (-PER_M * THICKNESS_M / cosine).exp()))
                .claims(Claim::AveragesPolarisation);
        }
        if name.ends_with("priority") {
            truth = truth.claims(Claim::Priorities);
        }
        list.push(truth);
    }
    list
}

/// Bodies of other materials than glass, before a lamp of radiance 1.
fn filled() -> Vec<Truth> {
    const THICKNESS_M: f64 = 0.5;
    const PER_M: f64 = 2.0;
    const SHARE: f64 = 0.75;
    let tau = (-PER_M * THICKNESS_M).exp();
    let body = |material: Value| {
        json!({ "shape": block([-20.0, -20.0, -THICKNESS_M], [20.0, 20.0, 0.0]),
            "material": { "type": "filled", "material": material, "medium": { "absorption_per_m": PER_M } } })
    };
    let scene = |thing: Value| {
        Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 1e-3)
            .thing(thing)
            .lamp(level_square([0.0, 0.0, -1.0], 1e3, true), black(), 1.0, "front")
            .spp(1024)
    };
    let sieve = json!({ "type": "blend", "first": black(), "second": glass(1.0), "weight": SHARE });
    let mut holes = body(black());
    holes["opacity"] = json!(1.0 - SHARE);
    let open = [("absorbing-body-of-a-blend", body(sieve)), ("absorbing-body-with-holes", holes)].map(|(name, thing)| {
        Truth::new(name, &scene(thing), SHARE * SHARE * tau, "w² e^(−σd), w = ¾, σd = 1")
            .because("Each of two faces lets by the share w of the light, straight on. Between them the body holds a medium, of which e^(−σd) is left.")
            .confirmed("a thousand layers", 1e-3, || {
                SHARE * SHARE * (1.0 - PER_M * THICKNESS_M / 1e3).powi(1000)
            })
            .or_else("nothing is absorbed", SHARE * SHARE)
            .or_else("the faces alone keep light out", tau)
            .or_else("dark", 0.0)
            .sees(0.01)
    });
    // A face is a pane, which reflects 2R/(1 + R), light that goes to and fro in it included.
    let r = 2.0 * 0.04 / 1.04;
    let pane = body(json!({ "type": "thin-dielectric", "index": 1.5 }));
    let panes = Truth::new("absorbing-body-of-panes", &scene(pane), plate(r, tau), "(1 − r)²τ/(1 − r²τ²), r = 2R/(1 + R), τ = e^(−σd)")
        .because("The beams between two panes add up to (1 − r)²τ/(1 − r²τ²); on each way from one to the other e^(−σd) is left.")
        .confirmed("adding up the beams one by one", 1e-12, move || {
            (0..200).map(|k| (1.0 - r).powi(2) * tau * (r * tau).powi(2 * k)).sum()
        })
        .or_else("nothing is absorbed", plate(r, 1.0))
        .or_else("dark", 0.0)
        .sees(0.01);
    open.into_iter().chain([panes]).collect()
}

/// Mean of a square picture that a ball's disk touches on four sides, before a sky of 1.
fn framed(disk: f64) -> f64 {
    1.0 + 0.25 * PI * (disk - 1.0)
}

const RADIUS_M: f64 = 0.7;

fn ball_scene(index: f64, per_m: f64) -> Scene {
    Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0 * RADIUS_M)
        .object(sphere([0.0; 3], RADIUS_M), absorbing(glass(index), per_m))
        .sky(1.0)
        .spp(1024)
}

fn ball_without_refraction() -> Truth {
    const PER_M: f64 = 1.2;
    let depth = PER_M * RADIUS_M;
    let disk = (1.0 - (1.0 + 2.0 * depth) * (-2.0 * depth).exp()) / (2.0 * depth * depth);
    Truth::new(
        "absorbing-ball-of-index-1",
        &ball_scene(1.0, PER_M),
        framed(disk),
        "1 + (π/4)((1 − (1 + 2x)e^(−2x))/2x² − 1), x = σr",
    )
    .because(
        "A chord at the distance b from the axis is 2√(r² − b²) long; over the disk, ∫2c·e^(−2xc)dc with c = √(1 − b²/r²). Nothing is \
         reflected or refracted at an index of 1.",
    )
    .confirmed("quadrature over the chords", 1e-7, move || {
        let share = |b: f64, _| 2.0 * b * (-2.0 * depth * (1.0 - b * b).max(0.0).sqrt()).exp();
        framed(rectangle(share, [0.0, 1.0], [0.0, 1.0], 1e-9, 800_000).value)
    })
    .or_else("the diameter for every chord", framed((-2.0 * depth).exp()))
    .or_else("half of each chord", framed((1.0 - (1.0 + depth) * (-depth).exp()) * 2.0 / (depth * depth)))
    .or_else("nothing is absorbed", 1.0)
    .sees(0.01)
}

fn ball_of_glass() -> Truth {
    const PER_M: f64 = 0.9;
    let lit = |cosine: f64| {
        let r = fresnel_exact(cosine, 1.5).reflectance();
        let tau = (-2.0 * PER_M * RADIUS_M * (1.0 - (1.0 - cosine * cosine) / 2.25).sqrt()).exp();
        (r, tau)
    };
    // d(sin²θ) = 2 cos θ d(cos θ), but for the sign.
    let over_disk = |seen: &dyn Fn(f64, f64) -> f64| {
        let at = |cosine: f64| {
            let (r, tau) = lit(cosine);
            2.0 * cosine * seen(r, tau)
        };
        framed(interval(at, 0.0, 1.0, 1e-10).value)
    };
    let value = over_disk(&|r, tau| r + (1.0 - r).powi(2) * tau / (1.0 - r * tau));
    let once = over_disk(&|r, tau| r + (1.0 - r) * tau);
    Truth::new(
        "absorbing-ball-of-glass",
        &ball_scene(1.5, PER_M),
        value,
        "1 + (π/4)(∫(R + (1 − R)²τ/(1 − Rτ))d(sin²θ) − 1), τ = e^(−2σr cos θ')",
    )
    .because(
        "Within a ball every chord of a path makes the same angle θ' with the surface and is 2r·cos θ' long, so that under a sky of 1 a \
         ray that enters at θ sees R + (1 − R)²τ(1 + Rτ + …). Rays fill the disk evenly in sin²θ.",
    )
    .confirmed("the beams one by one, over the distance from the axis", 1e-6, move || {
        let beams = |b: f64, _: f64| {
            let (r, tau) = lit((1.0 - b * b).max(0.0).sqrt());
            let inside: f64 = (0..60).map(|k| (1.0 - r).powi(2) * tau * (r * tau).powi(k)).sum();
            2.0 * b * (r + inside)
        };
        framed(rectangle(beams, [0.0, 1.0], [0.0, 1.0], 1e-8, 800_000).value)
    })
    .or_else("absorbed on the first chord only", once)
    .or_else("nothing is absorbed", 1.0)
    .claims(Claim::AveragesPolarisation)
    .sees(0.005)
}

fn eye_within() -> Truth {
    const PER_M: f64 = 0.8;
    let scene = Scene::pinhole([0.0; 3], [0.0, 0.0, 1.0], 60.0)
        .object(sphere([0.0; 3], 1.5), absorbing(glass(1.0), PER_M))
        .sky(1.0)
        .spp(64);
    let value = (-1.5 * PER_M).exp();
    Truth::new("eye-in-an-absorbing-ball", &scene, value, "e^(−σr)")
        .because(
            "From its middle the surface of the ball is r away in every direction; an index of 1 reflects nothing.",
        )
        .confirmed("a million layers", 1e-6, || (1.0 - 1.5 * PER_M / 1e6).powi(1_000_000))
        .or_else("the eye taken to be outside", 1.0)
        .or_else("the diameter for the radius", (-3.0 * PER_M).exp())
}

fn lamp_within() -> Truth {
    const PER_M: f64 = 0.6;
    let scene = Scene::light_meter()
        .object(sphere([0.0; 3], 5.0), absorbing(glass(1.0), PER_M))
        .point_light([0.0, 0.0, 2.0], 4.0)
        .spp(256);
    // The eye is 0.01 m from the plate.
    let value = 0.5 / PI * (-PER_M * 2.01).exp();
    Truth::new("lamp-in-an-absorbing-ball", &scene, value, "(ρ/π)(I/d²)e^(−σ(d + e)), e = 0.01 from the plate to the eye")
        .because(
            "The plate, the lamp d = 2 above it and the eye are in the same medium, of index 1. The plate is smaller than 1e-3, so that \
             the way to the lamp is the same from all of it to 1e-7.",
        )
        .confirmed("a million layers", 1e-6, || 0.5 / PI * (1.0 - PER_M * 2.01 / 1e6).powi(1_000_000))
        .allows(1e-6, "the plate's extent, seen from the lamp and from the eye")
        .or_else("shadow rays are not absorbed", 0.5 / PI * (-PER_M * 0.01_f64).exp())
        .or_else("nothing is absorbed", 0.5 / PI)
}
