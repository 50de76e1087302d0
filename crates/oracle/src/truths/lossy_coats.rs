//! Rough coats that lose what their facets hide.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::surfaces::{plate, thing};
use super::{Claim, Truth, expectation::Expectation, facets::direction, rough_surfaces::by_midpoints, scene::Scene};
use crate::laws::{Masking, anisotropic_ggx_mirrors, beckmann_albedo, beckmann_mirrors, fresnel_exact, ggx_albedo};
use crate::quadrature::gauss_legendre_half;
use crate::vector::{add, dot, normalize};

/// Index and roughness of the coat, albedo of the base, directions of the viewer and of the light.
const N: f64 = 1.5;
const ALPHA: f64 = 0.5;
const RHO: f64 = 0.5;
const SEEN_DEG: f64 = 60.0;
const LIT_DEG: f64 = 40.0;

// By midpoints over the directions of reflected and of refracted light, 800², in a program of its own; 400² say the same to 5e-6.
/// What facets reflect and let by of light from the viewer's direction, and what they let by from the light's.
const REFLECTED: f64 = 0.060_371;
const PASSED: f64 = 0.902_818;
const PASSED_LIT: f64 = 0.941_115;
/// The mean that they let by of diffuse light, and the mean that they reflect of it from below.
const PASSED_MEAN: f64 = 0.921_629;
const RETURNED: f64 = 0.447_742;
/// What enters from both directions where nothing is lost: all that facets do not reflect.
const ENTERS: f64 = 0.939_629;
const ENTERS_LIT: f64 = 0.957_136;

const TABLES: &str = "a table of what facets let by, met twice, and one of what they return lie up to 1.5e-4 below it; and single precision";

pub(super) fn truths() -> Vec<Truth> {
    let mut list = Vec::new();
    for (internal_reflection, again) in [("coloured", RHO), ("uncoloured", 1.0)] {
        list.extend(pair(internal_reflection, again));
    }
    list.push(nearly_straight_on());
    list
}

fn plastic(internal_reflection: &str) -> Value {
    json!({ "type": "plastic", "reflectance": RHO, "coat": N, "alpha": ALPHA, "distribution": "beckmann", "masking": "separable",
        "internal_reflection": internal_reflection, "multiple_scattering": "lost" })
}

/// The base under a coat that lets light in twice, of which it sends `again` up each time that the coat sends it down.
fn base(again: f64, returned: f64) -> f64 {
    RHO / (N * N * (1.0 - again * returned))
}

/// What facets reflect and let by, from outside and, of the index 1/n, from inside.
fn by_slopes(eta: f64, mu: f64) -> [f64; 2] {
    let albedo = beckmann_albedo([ALPHA; 2], [(1.0 - mu * mu).sqrt(), 0.0, mu], Some(eta), Masking::Separable);
    [albedo.reflected, albedo.refracted]
}

/// 2∫ f µ dµ of a smooth function; nodes crowd at grazing angles.
pub(super) fn mean(f: impl Fn(f64) -> f64) -> f64 {
    gauss_legendre_half(12).into_iter().map(|(x, weight)| weight * 4.0 * x.powi(3) * f(x * x)).sum()
}

fn pair(internal_reflection: &str, again: f64) -> [Truth; 2] {
    let white = |rest: f64| 1.0 - rest / (N * N);
    let sky = move |passed: f64, mean: f64, returned: f64| REFLECTED + passed * mean * base(again, returned);
    let (seen, lit) = (SEEN_DEG.to_radians().cos(), LIT_DEG.to_radians().cos());
    let under_a_sky = Truth::new(
        format!("plastic-{internal_reflection}-under-a-coat-that-hides-light"),
        &plate(SEEN_DEG, false).thing(thing(plastic(internal_reflection))),
        sky(PASSED, PASSED_MEAN, RETURNED),
        "R + T(µ) T_avg ρ/(n²(1 − ρ′ rᵢ)), Beckmann's facets of α = ½ with G₁G₁, 60°, n = 1.5, ρ = ½",
    )
    .because(
        "Facets reflect R and refract T, less what other facets hide: that is lost, so R + T < 1. From below they return rᵢ of diffuse light, which \
         is less than what does not leave.",
    )
    .confirmed("midpoints over the slopes of facets, 640²", 2e-5, move || {
        let [reflected, passed] = by_slopes(N, seen);
        let enters = mean(|mu| by_slopes(N, mu)[1]);
        let returned = mean(|mu| by_slopes(1.0 / N, mu)[0]);
        reflected + passed * enters * base(again, returned)
    })
    .or_else("what facets hide enters", sky(ENTERS, ENTERS, white(ENTERS)))
    .or_else("what facets hide below returns", sky(PASSED, PASSED_MEAN, white(PASSED_MEAN)))
    .or_else("nothing returns from the coat", sky(PASSED, PASSED_MEAN, 0.0))
    .allows(5e-4 * sky(PASSED, PASSED_MEAN, RETURNED), TABLES)
    .claims(Claim::AveragesPolarisation)
    .sees(2e-3);

    let (o, i) = (direction(SEEN_DEG, 0.0), direction(LIT_DEG, -90.0));
    let half = normalize(add(o, i));
    let mirrored =
        fresnel_exact(dot(o, half), N).reflectance() * beckmann_mirrors([ALPHA; 2], o, i, Masking::Separable) * lit;
    let direct = move |passed: f64, returned: f64| mirrored + passed * base(again, returned) * lit / PI;
    let lamp = Scene::orthographic(o.map(|v| 2.0 * v), [0.0; 3], 0.1)
        .thing(thing(plastic(internal_reflection)))
        .directional_light(i.map(|v| -v), 1.0)
        .film(16, 16)
        .spp(64);
    let in_parallel_light = Truth::new(
        format!("plastic-{internal_reflection}-whose-coat-hides-parallel-light"),
        &lamp,
        direct(PASSED * PASSED_LIT, RETURNED),
        "cos θᵢ (R D G₁G₁/(4 cos θₒ cos θᵢ) + T(µₒ) T(µᵢ) ρ/(π n²(1 − ρ′ rᵢ))), α = ½, 60° and 40°",
    )
    .because("The light passes the facets on its way in and on its way out, and each way loses what other facets hide.")
    .confirmed("midpoints over the slopes of facets, 640²", 2e-5, move || {
        let returned = mean(|mu| by_slopes(1.0 / N, mu)[0]);
        direct(by_slopes(N, seen)[1] * by_slopes(N, lit)[1], returned)
    })
    .or_else("what facets hide enters", direct(ENTERS * ENTERS_LIT, white(ENTERS)))
    .or_else("what facets hide below returns", direct(PASSED * PASSED_LIT, white(PASSED_MEAN)))
    .or_else("light loses on its way in alone", direct(PASSED_LIT, RETURNED))
    .allows(5e-4 * direct(PASSED * PASSED_LIT, RETURNED), TABLES)
    .claims(Claim::AveragesPolarisation)
    .sees(2e-3);
    [under_a_sky, in_parallel_light]
}

/// A coat of a low index, under which light goes nearly straight on, and meets other facets from below as it would from above.
fn nearly_straight_on() -> Truth {
    const N: f64 = 1.1;
    const ALPHA: f64 = 1.0;
    let (o, i) = (direction(75.0, 0.0), direction(65.0, -90.0));
    let coat =
        json!({ "type": "plastic", "reflectance": RHO, "coat": N, "alpha": ALPHA, "multiple_scattering": "lost" });
    let scene = Scene::orthographic(o.map(|v| 2.0 * v), [0.0; 3], 0.1)
        .thing(thing(coat))
        .directional_light(i.map(|v| -v), 1.0)
        .film(16, 16)
        .spp(64);
    let reflectance = fresnel_exact(dot(o, normalize(add(o, i))), N).reflectance();
    let mirrored = reflectance * anisotropic_ggx_mirrors([ALPHA; 2], o, i) * i[2];
    let shows =
        move |passed: f64, returned: f64| mirrored + passed * RHO / (N * N * (1.0 - RHO * returned)) * i[2] / PI;
    let of = move |shares: &dyn Fn(f64, f64) -> [f64; 2]| {
        shows(shares(N, o[2])[1] * shares(N, i[2])[1], mean(|mu| shares(1.0 / N, mu)[0]))
    };
    let by_facets = |eta: f64, mu: f64| {
        let albedo = ggx_albedo(ALPHA, mu, Some(eta), Masking::Correlated);
        [albedo.reflected, albedo.refracted]
    };
    let work_out = move || {
        let value = of(&by_facets);
        let enters = |mu: f64| 1.0 - by_facets(N, mu)[0];
        let returned = mean(|mu| by_facets(1.0 / N, mu)[0]);
        Expectation::new(value)
            .allows(1e-3 * value, TABLES)
            .or_else("what facets hide enters", shows(enters(o[2]) * enters(i[2]), returned))
            .or_else("the coat reflects nothing", value - mirrored)
    };
    Truth::later(
        "plastic-under-a-coat-of-a-low-index-that-hides-light",
        &scene,
        "cos θᵢ (R D G₂/(4 cos θₒ cos θᵢ) + T(µₒ) T(µᵢ) ρ/(π n²(1 − ρ rᵢ))), GGX of α = 1, 75° and 65°, n = 1.1, ρ = ½",
        work_out,
    )
    .because(
        "Nearly all light is refracted, by little. At a slant much of it meets other facets before it is through: T = ∫ (1 − R) D G₁G₁ (o·h)/cos θₒ dω_h \
         is far below 1 − R. From below facets return rᵢ of diffuse light.",
    )
    .confirmed("reflected light by midpoints over directions, refracted light over normals", 5e-3, move || {
        of(&|eta, mu| by_midpoints(ALPHA, eta, mu))
    })
    .claims(Claim::AveragesPolarisation)
    .claims(Claim::CorrelatedMasking)
    .sees(2e-3)
}
