//! Roughness of metals and glass as scenes state it: what facets reflect, lose and give back.

use std::sync::{Arc, LazyLock};

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    expectation::Expectation,
    furnaces::conductor_reflectance,
    scene::{Scene, black, grey_hdr, level_square, parallelogram, sphere},
    surfaces::{plate, thing},
};
use crate::laws::{Masking, anisotropic_ggx_albedo, anisotropic_ggx_mirrors, fresnel_exact, ggx_albedo};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = rough_metal();
    list.extend(rough_glass());
    list
}

fn rough_metal() -> Vec<Truth> {
    let (tilt_deg, mu) = (60.0_f64, 0.5);
    // n + ik that reflects everything at every angle.
    let perfect = |further: Value| {
        let mut metal = json!({ "type": "conductor", "wavelengths_nm": [300, 900], "n": [1e-12, 1e-12], "k": [3, 3] });
        for (key, value) in further.as_object().into_iter().flatten() {
            metal[key] = value.clone();
        }
        metal
    };
    let mut list = Vec::new();
    for alpha in [0.3, 0.9] {
        // Both truths read the same quadrature.
        let lost = Arc::new(LazyLock::new(move || ggx_albedo(alpha, mu, None, Masking::Correlated).reflected));
        let scene = |how: &str| {
            plate(tilt_deg, false).thing(thing(perfect(json!({ "alpha": alpha, "multiple_scattering": how }))))
        };
        list.push(
            Truth::later(format!("rough-metal-of-{alpha}-lost"), &scene("lost"), "∫ D(h) (o·h)/cos θₒ G(o, r) dω_h", {
                let lost = Arc::clone(&lost);
                move || {
                    Expectation::new(**lost)
                        .or_else("masking not correlated", ggx_albedo(alpha, mu, None, Masking::Separable).reflected)
                }
            })
                .because("Facets that reflect everything, met once: the directional albedo of GGX with Smith's masking, correlated in height.")
                .allows(2e-5, "the quadrature over facets is known to 1e-5; and single precision")
                .or_else("what meets several facets given back", 1.0)
                .claims(Claim::CorrelatedMasking)
                .sees(2e-3),
        );
        list.push(
            Truth::later(format!("rough-metal-of-{alpha}-compensated"), &scene("compensated"), "L = 1", move || {
                Expectation::new(1.0).or_else("lost", **lost)
            })
            .because("A metal that reflects everything returns all light once what meets several facets is given back.")
            .allows(
                1e-3,
                "a single direction is returned to 1e-4 and diffuse light to 1.5e-4, by tables; and single precision",
            )
            .claims(Claim::LosslessRoughMetal)
            .sees(3e-3),
        );
    }
    // A constant roughness by an image, and by number, in parallel light.
    let highlight = |alpha: f64| {
        let tilt = 20.0_f64.to_radians();
        anisotropic_ggx_mirrors([alpha; 2], [0.0, 0.0, 1.0], [tilt.sin(), 0.0, tilt.cos()]) * tilt.cos()
    };
    let lit = |material: Value| {
        let tilt = 20.0_f64.to_radians();
        Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1)
            .thing(thing(material))
            .directional_light([-tilt.sin(), 0.0, -tilt.cos()], 1.0)
            .film(16, 16)
            .spp(256)
    };
    for (name, further, image) in [
        ("roughness-by-number", json!({ "alpha": 0.25 }), None),
        ("roughness-by-an-image-of-roughness", json!({ "roughness_image": { "file": "half.hdr" } }), Some(0.5)),
        (
            "roughness-by-an-image-of-alpha",
            json!({ "roughness_image": { "file": "half.hdr", "quantity": "alpha", "factor": 0.5 } }),
            Some(0.5),
        ),
        (
            "roughness-by-an-image-of-alpha-squared",
            json!({ "roughness_image": { "file": "half.hdr", "quantity": "alpha-squared", "factor": 0.125 } }),
            Some(0.5),
        ),
    ] {
        let mut further = further;
        further["multiple_scattering"] = json!("lost");
        let mut scene = lit(perfect(further));
        if let Some(grey) = image {
            scene = scene.file("half.hdr", grey_hdr(1, &[grey]));
        }
        let value = highlight(0.25);
        let mut truth = Truth::new(name, &scene, value, "D(h) G₁/4, α = 0.25, light 20° off the normal")
            .because("Seen along the normal, light from one direction shows the density of the facets half way, and Smith's G₁ of the light.")
            .or_else("α taken for roughness", highlight(0.5))
            .or_else("roughness taken for α", highlight(0.0625))
            .sees(0.01);
        if image.is_some() {
            truth = truth.allows(0.01 * value, "each place is a blend of two widths of a series in the ratio 1.05²: up to 1 % at the peak; and single precision");
            truth.must_see = 0.03;
        }
        list.push(truth);
    }
    // A reflectance at normal incidence, seen at a slant.
    let tilt = 75.0_f64;
    let (r, cosine) = (0.6_f64, tilt.to_radians().cos());
    let k = 2.0 * (r / (1.0 - r)).sqrt();
    list.push(
        Truth::new(
            "metal-by-its-reflectance",
            &plate(tilt, false).thing(thing(json!({ "type": "conductor", "reflectance": r }))),
            conductor_reflectance(1.0, k, cosine),
            "Fresnel's (R_s + R_p)/2 of n = 1, k = 2√(R/(1 − R)) at 75°, R = 0.6",
        )
        .because("The metal of index 1 + ik that reflects R at normal incidence: R = k²/(4 + k²).")
        .or_else("the same at every angle", r)
        .claims(Claim::AveragesPolarisation)
        .sees(1e-3),
    );
    list
}

/// The outer face of a half space of rough glass over black: what it reflects of a sky of radiance 1.
fn rough_glass() -> Vec<Truth> {
    let tilt = 60.0_f64.to_radians();
    let (o, mu) = ([tilt.sin(), 0.0, tilt.cos()], tilt.cos());
    let scene = |further: Value| {
        let mut glass = json!({ "type": "dielectric", "interior": 1.5, "multiple_scattering": "lost" });
        for (key, value) in further.as_object().into_iter().flatten() {
            glass[key] = value.clone();
        }
        plate(60.0, false)
            .thing(json!({ "shape": level_square([0.0; 3], 50.0, true), "material": glass }))
            .object(parallelogram([-60.0, -60.0, -0.01], [120.0, 0.0, 0.0], [0.0, 120.0, 0.0]), black())
    };
    let because = "What facets of glass reflect at the first meeting, by Fresnel's equations and Smith's masking; what they refract is absorbed behind.";
    let smooth = fresnel_exact(mu, 1.5).reflectance();
    let round = move || {
        Expectation::new(ggx_albedo(0.4, mu, Some(1.5), Masking::Correlated).reflected).or_else("smooth", smooth)
    };
    // Two truths read both, along the grain and across it.
    let albedos = Arc::new(LazyLock::new(move || {
        [[0.6, 0.15], [0.15, 0.6]]
            .map(|alpha| anisotropic_ggx_albedo(alpha, o, Some(1.5), Masking::Correlated).reflected)
    }));
    let brushed = |own: usize, mistake: &'static str| {
        let albedos = Arc::clone(&albedos);
        move || Expectation::new(albedos[own]).or_else("smooth", smooth).or_else(mistake, albedos[1 - own])
    };
    let formula = "∫ D(h) (o·h)/cos θₒ R G(o, r) dω_h";
    let finished = |truth: Truth| {
        truth
            .because(because)
            .allows(2e-5, "the quadrature over facets is known to 1e-5; and single precision")
            .claims(Claim::CorrelatedMasking)
            .claims(Claim::AveragesPolarisation)
            .sees(0.01)
    };
    let turned = |turn: f64| scene(json!({ "alpha_u": 0.6, "alpha_v": 0.15, "tangent_rotation_deg": turn }));
    let (along, across) = ("brushed-glass-reflects-along-the-grain", "brushed-glass-reflects-across-the-grain");
    let ball = Scene::pinhole([0.0, 0.0, 5.0], [0.0; 3], 16.0)
        .thing(json!({
            "shape": sphere([0.0; 3], 1.0),
            "material": { "type": "dielectric", "interior": 1.5, "roughness_image": { "file": "half.hdr" }, "multiple_scattering": "compensated" },
        }))
        .file("half.hdr", grey_hdr(1, &[0.5]))
        .sky(1.0)
        .film(16, 16)
        .spp(512);
    vec![
        finished(Truth::later("rough-glass-reflects", &scene(json!({ "alpha": 0.4 })), formula, round)),
        finished(Truth::later(along, &turned(0.0), formula, brushed(0, "widths exchanged"))),
        finished(Truth::later(across, &turned(90.0), formula, brushed(1, "not turned"))),
        Truth::new("furnace-glass-of-roughness-by-an-image", &ball, 1.0, "L = 1")
            .because("A rough interface that absorbs nothing sends all light somewhere; in uniform light that is L.")
            .or_else("n² of the way in not undone", 2.25)
            .allows(1e-3, "tables of lost light give back up to 1.5e-4 too little at each of some seven meetings with the surface")
            .claims(Claim::LosslessRoughGlass)
            .sees(0.01),
    ]
}
