//! Materials beyond the neutral form: one-sided, coated, rough diffuse, thin; and [rough ones](rough_surfaces).

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth, rough_surfaces,
    scene::{Scene, black, disk, grey_hdr, level_square},
    walsh_reflectance,
};
use crate::{laws::fresnel_exact, quadrature::interval};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = sides();
    list.extend(coated());
    list.extend(rough_diffuse());
    list.extend(panes());
    list.extend(rough_surfaces::truths());
    list
}

/// A plate under a sky of radiance 1, seen from `tilt_deg` off its normal, from before or from behind.
pub(super) fn plate(tilt_deg: f64, behind: bool) -> Scene {
    let (sine, cosine) = tilt_deg.to_radians().sin_cos();
    let z = if behind { -2.0 * cosine } else { 2.0 * cosine };
    Scene::orthographic([2.0 * sine, 0.0, z], [0.0; 3], 0.1).sky(1.0).film(16, 16).spp(1024)
}

fn square() -> Value {
    level_square([0.0; 3], 1.0, true)
}

pub(super) fn thing(material: Value) -> Value {
    json!({ "shape": square(), "material": material })
}

fn sides() -> Vec<Truth> {
    let kinds = [
        ("lambert", json!({ "type": "lambert", "reflectance": 0.8 }), 0.8),
        ("mirror", json!({ "type": "mirror", "reflectance": 0.9 }), 0.9),
        ("conductor", json!({ "type": "conductor", "reflectance": 0.6 }), 0.6),
        ("oren-nayar", json!({ "type": "oren-nayar", "reflectance": 1, "roughness": 0.7 }), 1.0),
        ("plastic", json!({ "type": "plastic", "reflectance": 1 }), 1.0),
    ];
    let mut list = Vec::new();
    for (name, material, albedo) in kinds {
        for (sides, seen, behind) in [
            ("front", "front", false),
            ("front", "back", true),
            ("back", "front", false),
            ("back", "back", true),
            ("both", "back", true),
        ] {
            let mut material = material.clone();
            material["sides"] = json!(sides);
            let value = if sides == seen || sides == "both" { albedo } else { 0.0 };
            let truth = Truth::new(
                format!("{name}-of-side-{sides}-seen-from-the-{seen}"),
                &plate(0.0, behind).thing(thing(material)).spp(256),
                value,
                if value == 0.0 { "0" } else { "the albedo at normal incidence" },
            )
            .because(
                "Under a sky of radiance 1 a plate shows its albedo. A side that does not reflect is black and lets no light through.",
            )
            .or_else("the other side", if value == 0.0 { albedo } else { 0.0 });
            list.push(truth.sees(0.005));
        }
    }
    list
}

/// Share of diffuse light that a smooth interface to index n reflects, from outside.
fn transmitted(n: f64, mu: f64) -> f64 {
    1.0 - fresnel_exact(mu, n).reflectance()
}

/// Plastic that loses what its coat reflects back down.
fn lossy() -> Vec<Truth> {
    const N: f64 = 1.5;
    const RHO: f64 = 0.5;
    let enters = 1.0 - walsh_reflectance(N);
    // What facets of α = 0.8 reflect is that of the truth `beckmann-coat-of-separable-masking`.
    let smooth = json!({});
    let rough = json!({ "alpha": 0.8, "distribution": "beckmann", "masking": "separable" });
    [("smooth", 60.0_f64, smooth, None), ("rough", 70.0, rough, Some(0.059_834))]
        .map(|(name, tilt_deg, keys, facets)| {
            let mut material = json!({ "type": "plastic", "reflectance": RHO, "coat": N, "internal_reflection": "lost" });
            keys.as_object().into_iter().flatten().for_each(|(key, value)| material[key] = value.clone());
            let passed = transmitted(N, tilt_deg.to_radians().cos());
            let reflected = facets.unwrap_or(1.0 - passed);
            let value = reflected + passed * enters * RHO;
            Truth::new(
                format!("plastic-that-loses-light-under-a-{name}-coat"),
                &plate(tilt_deg, false).thing(thing(material)),
                value,
                format!("R + T(µ) T_avg ρ, T that of a smooth coat, {tilt_deg}°, n = 1.5, ρ = ½"),
            )
            .because(
                "The base is T(µₒ) T(µᵢ) ρ/π: of a sky of radiance 1 it gets T_avg, and of what it sends up T(µ) leaves. What the coat reflects \
                 back down is lost.",
            )
            .confirmed("T_avg by quadrature", 1e-6, move || {
                let mean = interval(|mu| 2.0 * mu * transmitted(N, mu), 0.0, 1.0, 1e-10).value;
                reflected + passed * RHO * mean
            })
            .or_else("light between coat and base comes out", reflected + passed * RHO)
            .or_else("spread over the solid angle above the coat", reflected + passed * enters * RHO / (N * N))
            .claims(Claim::AveragesPolarisation)
            .sees(2e-3)
        })
        .into()
}

fn coated() -> Vec<Truth> {
    const N: f64 = 1.5;
    let mu = 60.0_f64.to_radians().cos();
    let plastic = |rho: f64| json!({ "type": "plastic", "reflectance": rho, "coat": N });
    // Of diffuse light the coat lets in 1 − Walsh; of what would leave, it reflects 1 − that/n².
    let (enters, returns) = (1.0 - walsh_reflectance(N), 1.0 - (1.0 - walsh_reflectance(N)) / (N * N));
    let shown =
        move |rho: f64| 1.0 - transmitted(N, mu) + transmitted(N, mu) * enters * rho / (N * N * (1.0 - rho * returns));
    let half = Truth::new(
        "plastic-under-a-sky",
        &plate(60.0, false).thing(thing(plastic(0.5))),
        shown(0.5),
        "R + T(µ) ρ T_avg/(n²(1 − ρ rᵢ)), rᵢ = 1 − T_avg/n², T_avg by Walsh's closed form, 60°, n = 1.5, ρ = ½",
    )
    .because(
        "The coat mirrors R of a sky of radiance 1. The base gets T_avg of diffuse light, and all that it sends up and that the coat \
         reflects again; T/n² of its radiance leaves (Saunderson 1942 without further terms).",
    )
    .confirmed("adding up the light between base and coat, T_avg by quadrature", 1e-6, move || {
        let mean = interval(|mu| 2.0 * mu * transmitted(N, mu), 0.0, 1.0, 1e-10).value;
        let back = 1.0 - mean / (N * N);
        let base: f64 = (0..200).map(|k| mean * 0.5 * (0.5 * back).powi(k)).sum();
        1.0 - transmitted(N, mu) + transmitted(N, mu) * base / (N * N)
    })
    .or_else("light between coat and base left out", 1.0 - transmitted(N, mu) + transmitted(N, mu) * enters * 0.5 / (N * N))
    .or_else("without 1/n²", 1.0 - transmitted(N, mu) + transmitted(N, mu) * enters * 0.5 / (1.0 - 0.5 * returns))
    .or_else("an albedo of base and coat added", 0.5 + 1.0 - transmitted(N, mu))
    .claims(Claim::AveragesPolarisation)
    .sees(2e-3);
    let light = 40.0_f64.to_radians();
    let seen = 60.0_f64.to_radians();
    let direct = |rho: f64| {
        transmitted(N, light.cos()) * transmitted(N, seen.cos()) * rho * light.cos()
            / (PI * N * N * (1.0 - rho * returns))
    };
    let lit = Scene::orthographic([2.0 * seen.sin(), 0.0, 2.0 * seen.cos()], [0.0; 3], 0.1)
        .thing(thing(plastic(0.5)))
        .directional_light([0.0, light.sin(), -light.cos()], 1.0)
        .film(16, 16)
        .spp(64);
    let by_light = Truth::new("plastic-in-parallel-light", &lit, direct(0.5), "T(µₒ)T(µᵢ)ρ cos θᵢ/(π n²(1 − ρ rᵢ))")
        .because("The mirrored light goes elsewhere; what the base scatters passes the coat on the way in and on the way out.")
        .confirmed("rᵢ from inside by quadrature: total reflection and Fresnel's equations of n → 1", 1e-5, move || {
            let inside = interval(|mu| 2.0 * mu * (1.0 - transmitted(1.0 / N, mu)), 0.0, 1.0, 1e-9).value;
            let part = transmitted(N, light.cos()) * transmitted(N, seen.cos());
            part * 0.5 * light.cos() / (PI * N * N * (1.0 - 0.5 * inside))
        })
        .or_else("the coat left out", 0.5 * light.cos() / PI)
        .or_else("light between coat and base left out", direct(0.5) * (1.0 - 0.5 * returns))
        .claims(Claim::AveragesPolarisation)
        .sees(1e-3);
    let mut once = plastic(0.5);
    once["internal_reflection"] = json!("uncoloured");
    let coloured_once = Truth::new(
        "plastic-coloured-once-under-a-sky",
        &plate(60.0, false).thing(thing(once)),
        1.0 - transmitted(N, mu) + 0.5 * transmitted(N, mu),
        "R + T(µ) ρ, 60°, n = 1.5, ρ = ½",
    )
    .because(
        "The base colours light once and is white for all that the coat reflects again. So of what the coat lets in, ρ leaves, whatever the \
         share that it reflects again.",
    )
    .confirmed("adding up the light between base and coat, T_avg by quadrature", 1e-6, move || {
        let mean = interval(|mu| 2.0 * mu * transmitted(N, mu), 0.0, 1.0, 1e-10).value;
        let base: f64 = (0..200).map(|k| mean * 0.5 * (1.0 - mean / (N * N)).powi(k)).sum();
        1.0 - transmitted(N, mu) + transmitted(N, mu) * base / (N * N)
    })
    .or_else("coloured at each reflection", shown(0.5))
    .claims(Claim::AveragesPolarisation)
    .sees(2e-3);
    let mut list = vec![half, by_light, coloured_once, white_coat_before_a_sheet()];
    list.extend(lossy());
    for (name, further) in [
        ("plastic-white-under-a-smooth-coat", json!({})),
        ("plastic-white-under-a-coat-of-an-image", json!({ "roughness_image": { "file": "half.hdr" } })),
        ("plastic-white-under-a-rough-coat", json!({ "alpha": 0.3 })),
        ("plastic-white-under-a-brushed-coat", json!({ "alpha_u": 0.5, "alpha_v": 0.1, "tangent_rotation_deg": 30 })),
    ] {
        let mut material = json!({ "type": "plastic", "reflectance": 1, "coat": N });
        for (key, value) in further.as_object().into_iter().flatten() {
            material[key] = value.clone();
        }
        let with_file = |scene: Scene| {
            if name.ends_with("image") { scene.file("half.hdr", grey_hdr(1, &[0.5])) } else { scene }
        };
        let truth = Truth::new(name, &with_file(plate(60.0, false).thing(thing(material))), 1.0, "L = 1")
            .because("A white base under a coat that absorbs nothing returns all light, whatever the coat.")
            .or_else("light that the coat reflects down again is lost", 1.0 - transmitted(N, mu) * (1.0 - enters / (N * N)))
            .allows(1e-3, "tables of the coat's albedo: single directions are within 3e-4, interpolation included; and single precision")
            .sees(5e-3);
        list.push(truth);
    }
    list
}

/// A third of a white rough coat and two thirds of a sheet that passes all light, seen aslant. Facets of the coat send some light below the surface.
fn white_coat_before_a_sheet() -> Truth {
    let coat = json!({ "type": "plastic", "reflectance": 1, "coat": 1.5, "alpha": 0.8 });
    let sheet = json!({ "type": "translucent", "reflectance": 0, "transmittance": 1 });
    let blend = json!({ "type": "blend", "first": coat, "second": sheet, "weight": 2.0 / 3.0 });
    Truth::new("blend-of-a-rough-coat-and-a-sheet-in-a-furnace", &plate(75.0, false).thing(thing(blend)), 1.0, "L = 1")
        .because("Both parts return or pass all light, each for its share. What facets send below the surface enters the ground of the coat, and is no light of the sheet.")
        .or_else("no light passes the sheet", 1.0 / 3.0)
        .allows(1e-3, "tables of the coat's albedo: single directions are within 3e-4, interpolation included; and single precision")
        .sees(5e-3)
}

/// Albedo of Fujii's form with ρ = 1, by quadrature over the hemisphere.
fn fujii_albedo(r: f64, mu_o: f64) -> f64 {
    let a = 1.0 / (1.0 + r * (0.5 - 2.0 / (3.0 * PI)));
    let sine = (1.0 - mu_o * mu_o).sqrt();
    let f = move |mu: f64, phi: f64| {
        let s = sine * (1.0 - mu * mu).sqrt() * phi.cos();
        let t = if s > 0.0 { mu.max(mu_o) } else { 1.0 };
        a / PI * (1.0 + r * s / t) * mu
    };
    // Corners at cos φ = 0 and at µ = µₒ.
    let over = |from: f64, to: f64, first: f64, last: f64| {
        crate::quadrature::rectangle(f, [from, to], [first, last], 1e-9, 400_000).value
    };
    let halves = |from: f64, to: f64| over(from, to, 0.0, 0.5 * PI) + over(from, to, 0.5 * PI, PI);
    2.0 * (halves(0.0, mu_o) + halves(mu_o, 1.0))
}

/// The same in closed form, and its mean over directions (Portsmouth, Kutz and Hill 2024).
fn fujii_closed(r: f64, mu: f64) -> [f64; 2] {
    let a = 1.0 / (1.0 + r * (0.5 - 2.0 / (3.0 * PI)));
    let sine = (1.0 - mu * mu).sqrt();
    let g = sine * (mu.acos() - sine * mu - 2.0 / 3.0) + 2.0 / 3.0 * sine / mu * (1.0 - sine.powi(3));
    [a * (1.0 + r / PI * g), a * (1.0 + r * (2.0 / 3.0 - 28.0 / (15.0 * PI)))]
}

/// Light at 40° from the side opposite to the viewer and at 60°, turned by 30°.
fn rough_diffuse() -> Vec<Truth> {
    const R: f64 = 0.7;
    const RHO: f64 = 0.6;
    let (light, seen, turn) = (40.0_f64.to_radians(), 60.0_f64.to_radians(), 30.0_f64.to_radians());
    let material = |rho: f64| json!({ "type": "oren-nayar", "reflectance": rho, "roughness": R });
    let make = |name: &str, back: bool| {
        let side = if back { 1.0 } else { -1.0 };
        let to_light = [side * light.sin() * turn.cos(), light.sin() * turn.sin(), light.cos()];
        let scene = Scene::orthographic([2.0 * seen.sin(), 0.0, 2.0 * seen.cos()], [0.0; 3], 0.1)
            .thing(thing(material(RHO)))
            .directional_light(to_light.map(|x| -x), 1.0)
            .film(16, 16)
            .spp(64);
        let value = move |of_o: f64, of_i: f64, mean: f64| {
            let s = side * light.sin() * seen.sin() * turn.cos();
            let t = if s > 0.0 { light.cos().max(seen.cos()) } else { 1.0 };
            let a = 1.0 / (1.0 + R * (0.5 - 2.0 / (3.0 * PI)));
            let single = RHO * a / PI * (1.0 + R * s / t);
            let several = RHO * RHO * mean / (1.0 - RHO * (1.0 - mean));
            let lobe = several / PI * (1.0 - of_o) * (1.0 - of_i) / (1.0 - mean);
            [(single + lobe) * light.cos(), single * light.cos()]
        };
        let [of_o, mean] = fujii_closed(R, seen.cos());
        let of_i = fujii_closed(R, light.cos())[0];
        let [all, single] = value(of_o, of_i, mean);
        Truth::new(name, &scene, all, "(ρA/π(1 + r s/t) + lobe of several meetings) cos θᵢ, ρ = 0.6, r = 0.7")
            .because("Fujii's improved form of Oren and Nayar, and a lobe for light that is scattered several times (Portsmouth, Kutz and Hill 2024).")
            .confirmed("albedos by quadrature over the hemisphere", 1e-5, move || {
                let mean = interval(|mu| 2.0 * mu * fujii_closed(R, mu)[0], 1e-9, 1.0, 1e-9).value;
                value(fujii_albedo(R, seen.cos()), fujii_albedo(R, light.cos()), mean)[0]
            })
            .or_else("without the lobe", single)
            .or_else("Lambert's law", RHO / PI * light.cos())
            .sees(1e-3)
    };
    let white = Truth::new("oren-nayar-white", &plate(60.0, false).thing(thing(material(1.0))), 1.0, "L = 1")
        .because(
            "A rough surface that absorbs nothing returns all light, once what meets it several times is given back.",
        )
        .or_else("without the lobe", fujii_closed(R, seen.cos())[0])
        .sees(2e-3);
    vec![make("oren-nayar-lit-from-behind-the-viewer", true), make("oren-nayar-lit-against-the-viewer", false), white]
}

/// A pane without thickness before a lamp.
fn panes() -> Vec<Truth> {
    let n = 1.5;
    [0.0, 60.0]
        .map(|tilt_deg: f64| {
            let (sine, cosine) = tilt_deg.to_radians().sin_cos();
            let scene = Scene::orthographic([2.0 * sine, 0.0, 2.0 * cosine], [0.0; 3], 0.1)
                .thing(thing(json!({ "type": "thin-dielectric", "index": n })))
                .lamp(disk([-sine, 0.0, -cosine], [sine, 0.0, cosine], 0.5), black(), 1.0, "front")
                .film(16, 16)
                .spp(1024);
            let powers = fresnel_exact(cosine, n);
            let through = |r: f64| (1.0 - r) / (1.0 + r);
            let value = 0.5 * (through(powers.r_s) + through(powers.r_p));
            let mean = powers.reflectance();
            let mut truth = Truth::new(format!("thin-pane-at-{tilt_deg}-degrees"), &scene, value, "½Σ (1 − R)/(1 + R) of s and p")
                .because("The internal reflections of a pane add up to 2R/(1 + R), for each polarisation; the rest passes straight on.")
                .confirmed("adding up the beams one by one", 1e-12, move || {
                    let beams = |r: f64| (0..200).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum::<f64>();
                    0.5 * (beams(powers.r_s) + beams(powers.r_p))
                })
                .or_else("one face only", 1.0 - mean)
                .or_else("two faces without reflections between them", (1.0 - mean).powi(2))
                .sees(1e-3);
            if tilt_deg > 0.0 {
                truth = truth.or_else("the mean of s and p reflected to and fro", through(mean));
            }
            truth
        })
        .into()
}
