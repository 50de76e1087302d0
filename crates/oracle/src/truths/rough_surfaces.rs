//! Roughness of metals and glass as scenes state it: what facets reflect, lose and give back.

use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    expectation::Expectation,
    furnaces::{conductor_by_real_formulas, conductor_reflectance},
    lossy_coats::mean,
    scene::{Scene, black, grey_hdr, level_square, parallelogram, sphere},
    surfaces::{plate, thing},
    walsh_reflectance,
};
use crate::laws::{
    Masking, anisotropic_ggx_albedo, anisotropic_ggx_mirrors, coated_ggx_albedo, fresnel_exact, ggx_albedo,
};
use crate::vector::{Vec3, add, dot, normalize, scale};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = rough_metal();
    list.push(absorbing_metal());
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

/// Rough metal that absorbs: what meets several facets loses more than what meets one.
fn absorbing_metal() -> Truth {
    const ALPHA: f64 = 0.9;
    const TILT_DEG: f64 = 60.0;
    // n + ik, which reflects half of the light at normal incidence.
    const N: f64 = 1.0;
    const K: f64 = 2.0;
    let mu = TILT_DEG.to_radians().cos();
    let metal = json!({ "type": "conductor", "wavelengths_nm": [300, 900], "n": [N, N], "k": [K, K], "alpha": ALPHA });
    // Of what facets reflect of one direction, what they would if they absorbed nothing, the mean of that, and the mean reflectance of one.
    let of = |single: f64, whole: f64, whole_mean: f64, facet_mean: f64| {
        let several = facet_mean * facet_mean * whole_mean / (1.0 - facet_mean * (1.0 - whole_mean));
        [0.0, several, facet_mean].map(|share| single + (1.0 - whole) * share)
    };
    let facet_mean = |reflectance: fn(f64, f64, f64) -> f64| mean(|mu| reflectance(N, K, mu));
    let work_out = move || {
        let whole = |mu: f64| ggx_albedo(ALPHA, mu, None, Masking::Correlated).reflected;
        let facet = |cosine: f64| [conductor_reflectance(N, K, cosine), 0.0];
        let single = coated_ggx_albedo(ALPHA, mu, None, facet).reflected;
        let [lost, value, grey] = of(single, whole(mu), mean(whole), facet_mean(conductor_reflectance));
        Expectation::new(value)
            .allows(5e-4 * value, "a single direction is returned to 1e-4 by tables; and single precision")
            .or_else("what meets several facets absorbed as by one", grey)
            .or_else("what meets several facets lost", lost)
            .or_else("nothing of that absorbed", single + 1.0 - whole(mu))
    };
    Truth::later(
        "rough-metal-that-absorbs-compensated",
        &plate(TILT_DEG, false).thing(thing(metal)),
        "∫ F D (o·h)/cos θₒ G dω_h + (1 − E(µ)) F² E_avg/(1 − F (1 − E_avg)), F the mean reflectance of a facet, α = 0.9, n + ik = 1 + 2i",
        work_out,
    )
    .because(
        "Light that leaves after k facets has been reflected by each. Of what meets a facet the share E_avg leaves, and the rest meets another: the \
         series from the second facet on is F² E_avg Σ (F (1 − E_avg))ᵏ (Kulla & Conty 2017).",
    )
    .confirmed("the BRDF over directions of light, and the series term by term", 2e-3, move || {
        let o = |mu: f64| [(1.0_f64 - mu * mu).sqrt(), 0.0, mu];
        let over = |mu: f64, reflectance: &dyn Fn(f64) -> f64| {
            const STEPS: u32 = 300;
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
            let of = |a: u32, b: u32| {
                // Even over cos² and over half of the azimuths.
                let (cosine, turn) = (at(a).sqrt(), PI * at(b));
                let sine = (1.0 - cosine * cosine).sqrt();
                let i = [sine * turn.cos(), sine * turn.sin(), cosine];
                reflectance(dot(i, normalize(add(o(mu), i)))) * anisotropic_ggx_mirrors([ALPHA; 2], o(mu), i)
            };
            let sum: f64 = (0..STEPS).flat_map(|a| (0..STEPS).map(move |b| (a, b))).map(|(a, b)| of(a, b)).sum();
            sum * PI / f64::from(STEPS * STEPS)
        };
        let (single, whole) = (over(mu, &|cosine| conductor_by_real_formulas(N, K, cosine)), over(mu, &|_| 1.0));
        let (facet, leaves) = (facet_mean(conductor_by_real_formulas), mean(|mu| over(mu, &|_| 1.0)));
        let series: f64 = (2..200).map(|facets| facet.powi(facets) * (1.0 - leaves).powi(facets - 2) * leaves).sum();
        single + (1.0 - whole) * series
    })
    .claims(Claim::CorrelatedMasking)
    .claims(Claim::AveragesPolarisation)
    .claims(Claim::LosslessRoughMetal)
    .sees(5e-3)
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
        face_that_loses_nothing(),
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

/// The same face, which gives back what its facets lose: on this side the little that does not cross.
fn face_that_loses_nothing() -> Truth {
    const N: f64 = 1.5;
    const ALPHA: f64 = 0.8;
    const TILT_DEG: f64 = 60.0;
    let mu = TILT_DEG.to_radians().cos();
    let glass = json!({ "type": "dielectric", "interior": N, "alpha": ALPHA });
    let scene = plate(TILT_DEG, false)
        .thing(json!({ "shape": level_square([0.0; 3], 50.0, true), "material": glass }))
        .object(parallelogram([-60.0, -60.0, -0.01], [120.0, 0.0, 0.0], [0.0, 120.0, 0.0]), black());
    // Of shares that facets reflect and refract, from above and from below.
    let of = move |shares: &dyn Fn(f64, f64) -> [f64; 2], crossing: f64| {
        let lost = |eta: f64, mu: f64| 1.0 - shares(eta, mu).iter().sum::<f64>();
        let [above, below] = [N, 1.0 / N].map(|eta| mean(|mu| lost(eta, mu)));
        shares(N, mu)[0] + lost(N, mu) * (1.0 - crossing * below / above.max(below))
    };
    let crosses = 1.0 - walsh_reflectance(N);
    let work_out = move || {
        let shares = |eta: f64, mu: f64| {
            let albedo = ggx_albedo(ALPHA, mu, Some(eta), Masking::Correlated);
            [albedo.reflected, albedo.refracted]
        };
        let value = of(&shares, crosses);
        Expectation::new(value)
            .allows(5e-4 * value, "a single direction is returned to 1e-4 by tables; and single precision")
            .or_else("what meets several facets lost", shares(N, mu)[0])
            .or_else("all of that on this side", of(&shares, 0.0))
            .or_else("half of that on either side", of(&shares, 0.5))
    };
    Truth::later(
        "rough-glass-reflects-and-gives-back",
        &scene,
        "∫ D(h) (o·h)/cos θₒ R G(o, r) dω_h + ℓ(µ) (1 − T B/max(A, B)), α = 0.8, n = 1.5",
        work_out,
    )
    .because(
        "Of light that facets lose from outside the share T B/max(A, B) crosses: A and B are the mean losses of diffuse light from outside and from \
         inside, T is Fresnel's mean transmittance from outside. The rest comes back. From inside T/n² takes the place of T and A that of B, so that \
         light goes both ways alike.",
    )
    .confirmed("reflected light by midpoints over directions, refracted light over normals", 5e-3, move || {
        let mean_transmittance = mean(|mu| fresnel_exact(mu, N).transmittance());
        of(&|eta, mu| by_midpoints(ALPHA, eta, mu), mean_transmittance)
    })
    .claims(Claim::CorrelatedMasking)
    .claims(Claim::AveragesPolarisation)
    .claims(Claim::LosslessRoughGlass)
    .sees(0.01)
}

/// What GGX facets between two media reflect and refract of light from the cosine `mu`, by midpoints over directions of the one and over normals of
/// facets for the other.
pub(super) fn by_midpoints(alpha: f64, eta: f64, mu: f64) -> [f64; 2] {
    const STEPS: u32 = 240;
    let o = [(1.0 - mu * mu).sqrt(), 0.0, mu];
    let seen = |w: Vec3| 2.0 / (1.0 + (1.0 + alpha * alpha * (1.0 / (w[2] * w[2]) - 1.0)).sqrt());
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
    // Over half of the azimuths.
    let direction = |cosine: f64, turn: u32| {
        let (sin, cos) = (PI * at(turn)).sin_cos();
        let sine = (1.0 - cosine * cosine).sqrt();
        [sine * cos, sine * sin, cosine]
    };
    let reflected = |i: Vec3| {
        let reflectance = fresnel_exact(dot(i, normalize(add(o, i))), eta).reflectance();
        reflectance * anisotropic_ggx_mirrors([alpha; 2], o, i)
    };
    let refracted = |h: Vec3| {
        let oh = dot(o, h);
        let square = 1.0 - (1.0 - oh * oh) / (eta * eta);
        if oh <= 0.0 || square <= 0.0 {
            return 0.0;
        }
        let i = add(scale(-1.0 / eta, o), scale(oh / eta - square.sqrt(), h));
        if i[2] >= 0.0 {
            return 0.0;
        }
        let spread = h[2] * h[2] * (alpha * alpha - 1.0) + 1.0;
        let density = alpha * alpha / (PI * spread * spread);
        oh / mu * density * fresnel_exact(oh, eta).transmittance() * seen(o) * seen(i)
    };
    let mut sums = [0.0; 2];
    for (a, b) in (0..STEPS).flat_map(|a| (0..STEPS).map(move |b| (a, b))) {
        // Even over cos², and over cos.
        sums[0] += PI * reflected(direction(at(a).sqrt(), b));
        sums[1] += 2.0 * PI * refracted(direction(at(a), b));
    }
    sums.map(|sum| sum / f64::from(STEPS * STEPS))
}
