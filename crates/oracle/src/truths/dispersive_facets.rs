//! Rough glass that sends each wavelength elsewhere, before a lamp that both shadow rays and facets find.

use std::f64::consts::PI;

use serde_json::json;

use super::expectation::Expectation;
use super::prisms::refracted;
use super::scene::{Scene, black, level_square, sphere};
use super::{Claim, Truth, photometric_weight};
use crate::laws::fresnel_exact;
use crate::quadrature::{Cone, gauss_legendre_half};
use crate::vector::{Vec3, add, dot, normalize, scale};

const ALPHA: f64 = 0.03;
/// Of the eye from the normal, and half the angle that the lamp fills.
const TILT_DEG: f64 = 70.0;
const HALF_ANGLE_DEG: f64 = 2.5;
/// The middle of the lamp is where a smooth surface would send this wavelength.
const AIM_NM: f64 = 560.0;

/// From 1.79 at 360 nm to 1.47 at 830 nm.
fn index(nm: f64) -> f64 {
    1.4 + 0.05 / (1e-3 * nm).powi(2)
}

fn eye() -> Vec3 {
    let (sin, cos) = TILT_DEG.to_radians().sin_cos();
    [sin, 0.0, cos]
}

fn lamp() -> Cone {
    let down = refracted(scale(-1.0, eye()), [0.0, 0.0, 1.0], index(AIM_NM));
    Cone::new(down, HALF_ANGLE_DEG.to_radians())
}

/// GGX's density of facets for the cosine from the normal, and Smith's share of them that a direction sees.
fn facets(cos: f64) -> f64 {
    let e = cos * cos * (ALPHA * ALPHA - 1.0) + 1.0;
    ALPHA * ALPHA / (PI * e * e)
}

fn seen(cos: f64) -> f64 {
    let tan2 = (1.0 - cos * cos) / (cos * cos);
    2.0 / (1.0 + (1.0 + ALPHA * ALPHA * tan2).sqrt())
}

/// f cos θ of light that comes from within along `i`, by the facet that refracts it toward the eye.
fn refracts(i: Vec3, n: f64) -> f64 {
    let o = eye();
    let h = normalize(scale(-1.0, add(o, scale(n, i))));
    let h = if h[2] < 0.0 { scale(-1.0, h) } else { h };
    let (oh, ih) = (dot(o, h), dot(i, h));
    if oh <= 0.0 || ih >= 0.0 {
        return 0.0;
    }
    let passes = fresnel_exact(oh, n).transmittance() * seen(o[2]) * seen(-i[2]);
    oh * -ih / o[2] * passes * facets(h[2]) / (n * ih + oh).powi(2)
}

/// ∫ȳ of a function of the wavelength, over ∫ȳ.
fn to_the_eye(step_nm: u32, of: impl Fn(f64) -> f64) -> f64 {
    let middles = (360..830).step_by(step_nm as usize).map(|nm| f64::from(nm) + 0.5 * f64::from(step_nm));
    let weight = |nm: f64| {
        let within = (0..step_nm).map(|k| nm - 0.5 * f64::from(step_nm) + f64::from(k) + 0.5);
        within.map(photometric_weight).sum::<f64>()
    };
    middles.map(|nm| weight(nm) * of(nm)).sum()
}

/// Over the lamp's directions.
fn over_the_lamp(n: f64) -> f64 {
    const TURNS: u32 = 48;
    let cone = lamp();
    let ring = |h: f64| -> f64 {
        (0..TURNS).map(|k| refracts(cone.direction(h, 2.0 * PI * f64::from(k) / f64::from(TURNS)), n)).sum()
    };
    let rings: f64 = gauss_legendre_half(24).into_iter().map(|(h, weight)| weight * ring(h)).sum();
    2.0 * PI * cone.one_minus_cos / f64::from(TURNS) * rings
}

/// Over the facets by their slopes: those count that refract the ray from the eye into the lamp.
fn over_the_facets(n: f64) -> f64 {
    const STEPS: u32 = 400;
    const REACH: f64 = 0.16;
    let (o, cone) = (eye(), lamp());
    let slope = |k: u32| REACH * (2.0 * (f64::from(k) + 0.5) / f64::from(STEPS) - 1.0);
    let of_slopes = |x: f64, y: f64| {
        let h = normalize([-x, -y, 1.0]);
        let i = refracted(scale(-1.0, o), h, n);
        if dot(i, cone.axis) < 1.0 - cone.one_minus_cos {
            return 0.0;
        }
        let oh = dot(o, h);
        // The density of slopes is that of facets times cos⁴.
        facets(h[2]) * h[2].powi(3) * oh / o[2] * fresnel_exact(oh, n).transmittance() * seen(o[2]) * seen(-i[2])
    };
    let sum: f64 = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| of_slopes(slope(i), slope(j)))).sum();
    sum * (2.0 * REACH / f64::from(STEPS)).powi(2) / (n * n)
}

pub(super) fn truths() -> Vec<Truth> {
    let glass = json!({ "type": "cauchy", "a": 1.4, "b_um2": 0.05, "range_nm": [300, 900] });
    let material = json!({ "type": "dielectric", "interior": glass, "alpha": ALPHA, "multiple_scattering": "lost" });
    let scene = Scene::orthographic(scale(0.5, eye()), [0.0; 3], 1e-5)
        .thing(json!({ "shape": level_square([0.0; 3], 50.0, true), "material": material }))
        .lamp(sphere(lamp().axis, HALF_ANGLE_DEG.to_radians().sin()), black(), 1.0, "front")
        .film(16, 16);
    let work_out = || {
        Expectation::new(to_the_eye(1, |nm| over_the_lamp(index(nm))))
            .or_else("one index for all wavelengths, that of the middle of the lamp", over_the_lamp(index(AIM_NM)))
            .or_else("radiance not spread by n²", to_the_eye(5, |nm| index(nm).powi(2) * over_the_lamp(index(nm))))
    };
    vec![
        Truth::later(
            "lamp-in-rough-glass-of-strong-dispersion",
            &scene,
            "∫ȳ ∫ |o·h||i·h| (1 − R) D G/(cos θₒ (n i·h + o·h)²) dω dλ/∫ȳ dλ, α = 0.03, n = 1.4 + 0.05 µm²/λ²",
            work_out,
        )
        .because(
            "Facets refract light of the lamp toward the eye (Walter et al. 2007), at each wavelength by its own index: a lamp of 2.5° is narrower \
             than the spectrum is wide. A path holds several wavelengths, which facets would send to other places each.",
        )
        .confirmed("midpoints over the facets by their slopes", 1e-3, || to_the_eye(5, |nm| over_the_facets(index(nm))))
        .claims(Claim::AveragesPolarisation)
        .claims(Claim::Dispersion)
        .claims(Claim::PhotometricSensor)
        .sees(5e-3),
    ]
}
