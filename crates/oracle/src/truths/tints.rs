//! Tints: shares that are left of what glass, panes and metals reflect and pass, and of what coats reflect.

use serde_json::{Value, json};

use super::scene::{Scene, black, block, brushed_metal, disk, grey_hdr, level_square, parallelogram, shown, sphere};
use super::surfaces::{plate, thing};
use super::{Claim, Truth};
use crate::laws::{FresnelPowers, Masking, beckmann_albedo, fresnel_exact};
use crate::quadrature::interval;
use crate::vector::{Vec3, dot};
use std::f64::consts::PI;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = plates();
    list.extend(panes());
    list.push(metal());
    list.push(lamp());
    list.push(point());
    list.push(coat());
    list.push(rough_coat());
    list
}

const INDEX: f64 = 1.5;

/// A share that is `first` up to 550 nm and `second` from 551 nm on.
fn step(first: f64, second: f64) -> Value {
    json!({ "type": "tabulated", "wavelengths_nm": [380, 550, 551, 720], "values": [first, first, second, second] })
}

/// A plate that is seen head-on in uniform light, below and above the step of its tints.
fn plates() -> Vec<Truth> {
    let material = json!({
        "type": "dielectric", "interior": INDEX, "reflected_tint": step(0.9, 0.5), "transmitted_tint": step(0.3, 0.8),
    });
    let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1)
        .thing(json!({ "shape": block([-9.0, -9.0, -0.2], [9.0, 9.0, 0.0]), "material": material }))
        .sky(1.0)
        .film(8, 8)
        .spp(1 << 11);
    let head_on = fresnel_exact(1.0, INDEX).reflectance();
    [("blue", [430.0, 500.0], [0.9, 0.3]), ("red", [600.0, 670.0], [0.5, 0.8])]
        .map(|(name, band, [r, t])| {
            let of = move |r: f64, t: f64| r * head_on + t * t * (1.0 - head_on).powi(2) / (1.0 - r * head_on);
            Truth::new(format!("tinted-plate-in-{name}"), &scene.clone().band(band), of(r, t), "rR + t²(1 − R)²/(1 − rR)")
                .because("What a tinted face reflects is rR, what it passes t(1 − R); light goes to and fro between two of them.")
                .confirmed("reflections one by one", 1e-12, move || {
                    let inside = |k: i32| (r * head_on).powi(k) * (t * (1.0 - head_on)).powi(2);
                    r * head_on + (0..60).map(inside).sum::<f64>()
                })
                .or_else("no tint", 1.0)
                .or_else("the tint of one face only", r * head_on + t * (1.0 - head_on).powi(2) / (1.0 - r * head_on))
                .or_else("only what passes is tinted", of(1.0, t))
                .or_else("the tints exchanged", of(t, r))
                .sees(2e-3)
        })
        .into()
}

/// Panes in uniform light, of which a gradient or a chequerboard is the tint.
fn panes() -> Vec<Truth> {
    let (sine, cosine) = 60_f64.to_radians().sin_cos();
    let FresnelPowers { r_s, r_p, .. } = fresnel_exact(cosine, INDEX);
    let passes = 0.5 * ((1.0 - r_s) / (1.0 + r_s) + (1.0 - r_p) / (1.0 + r_p));
    // The middle of the parallelogram, (½, ½), is where the picture is.
    let pane = parallelogram([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let of = |name: &str, keys: Value, [r, t]: [f64; 2]| {
        let mut material = json!({ "type": "thin-dielectric", "index": INDEX });
        for (key, value) in keys.as_object().expect("keys") {
            material[key] = value.clone();
        }
        let scene = Scene::orthographic([2.0 * sine, 0.0, 2.0 * cosine], [0.0; 3], 1e-3)
            .thing(json!({ "shape": pane, "material": material }))
            .sky(1.0)
            .film(8, 8)
            .spp(1 << 10);
        let value = r * (1.0 - passes) + t * passes;
        Truth::new(name, &scene, value, "r 2R/(1 + R) + t (1 − R)/(1 + R), the mean of s and p")
            .because(
                "A pane's tints multiply what it reflects and what it passes, reflections between its faces included.",
            )
            .confirmed("the beams one by one", 1e-9, move || {
                let beams = |r: f64| (0..200).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum::<f64>();
                let through = 0.5 * (beams(r_s) + beams(r_p));
                r + (t - r) * through
            })
            .or_else("no tint", 1.0)
            .or_else("the tints exchanged", t * (1.0 - passes) + r * passes)
            .or_else("the tint of two faces", r * (1.0 - passes) + t * t * passes)
            .sees(2e-3)
    };
    let gradient = json!({ "transmitted_tint": { "type": "gradient", "from": 0.2, "to": 0.6, "along": "u" } });
    let board = json!({
        "reflected_tint": { "type": "checker", "first": 0.25, "second": 0.75, "uv_offset": [0.25, -0.25] }, "transmitted_tint": 0.9,
    });
    vec![of("pane-tinted-by-a-gradient", gradient, [1.0, 0.4]), of("pane-that-reflects-by-a-board", board, [0.75, 0.9])]
}

/// A ball of rough metal that loses nothing but by its tint.
fn metal() -> Truth {
    let mut material = brushed_metal([0.4, 0.4], 0.0, true);
    material.as_object_mut().expect("a metal").retain(|key, _| !key.starts_with("alpha"));
    material["alpha"] = json!(0.4);
    material["reflected_tint"] = json!(0.6);
    let ball = json!({ "shape": sphere([0.0; 3], 1.0), "material": material });
    let scene = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 1.2).thing(ball);
    // Shadow rays aim at images, not at a constant sky.
    let scene = scene
        .light(json!({ "type": "environment", "image": { "file": "even.hdr" } }))
        .file("even.hdr", grey_hdr(8, &[1.0; 32]));
    Truth::new("tinted-metal-in-uniform-light", &scene.film(16, 16).spp(256), 0.6, "rL = 0.6")
        .because("A metal that reflects all light, that which meets several facets included, shows its surround times its tint.")
        .or_else("no tint", 1.0)
        .or_else("the tint twice", 0.36)
        .claims(Claim::PhotometricSensor)
        .sees(3e-3)
}

/// What a pane of index 1.5 lets pass, the mean of s and p.
fn through_a_pane(cosine: f64) -> f64 {
    let FresnelPowers { r_s, r_p, .. } = fresnel_exact(cosine, INDEX);
    0.5 * ((1.0 - r_s) / (1.0 + r_s) + (1.0 - r_p) / (1.0 + r_p))
}

fn pane(scene: Scene, tint: f64) -> Scene {
    let material = json!({ "type": "thin-dielectric", "index": INDEX, "transmitted_tint": tint });
    scene.thing(json!({ "shape": level_square([0.0, 0.0, 0.5], 2000.0, false), "material": material }))
}

/// A disk lamp above a tinted pane, which shadow rays and paths both find.
fn lamp() -> Truth {
    const TINT: f64 = 0.4;
    let rim = (0.8_f64 / 1.5).atan();
    let irradiance = |from: f64, to: f64| {
        2.0 * PI * interval(|a| through_a_pane(a.cos()) * a.cos() * a.sin(), from, to, 1e-12).value
    };
    let scene = pane(Scene::light_meter(), TINT)
        .lamp(disk([0.0, 0.0, 1.5], [0.0, 0.0, -1.0], 0.8), black(), 1.0, "front")
        .spp(1 << 10);
    let value = TINT * shown(irradiance(0.0, rim));
    Truth::new("disk-lamp-behind-a-tinted-pane", &scene, value, "t (ρ/π) 2πL ∫ ½Σ (1 − R)/(1 + R) cos θ sin θ dθ")
        .because("A tint multiplies what comes through, whether a shadow ray or a path finds it.")
        .confirmed("rings of the lamp, at the sine in the middle of each", 1e-6, move || {
            let sine = |k: f64| {
                let radius = 0.8 * k / 20_000.0;
                radius / radius.hypot(1.5)
            };
            let ring = |k: u32| {
                let [near, middle, far] = [0.0, 0.5, 1.0].map(|part| sine(f64::from(k) + part));
                through_a_pane((1.0 - middle * middle).sqrt()) * (far * far - near * near)
            };
            TINT * shown(PI * (0..20_000).map(ring).sum::<f64>())
        })
        .or_else("no tint", value / TINT)
        .or_else("only paths are tinted", 0.5 * value * (1.0 + 1.0 / TINT))
        .or_else("dark", 0.0)
        .sees(0.01)
}

/// A point lamp above it, which specular connections find.
fn point() -> Truth {
    const TINT: f64 = 0.4;
    let lamp: Vec3 = [1.5, 0.0, 2.0];
    let distance = dot(lamp, lamp).sqrt();
    let value = TINT * shown(2.0 / distance.powi(3) * through_a_pane(2.0 / distance));
    let scene = pane(Scene::light_meter(), TINT).point_light(lamp, 1.0).spp(1 << 8);
    Truth::new("lamp-behind-a-tinted-pane", &scene, value, "t (ρ/π) I h/d³ ½Σ (1 − R)/(1 + R) of s and p")
        .because("A tint multiplies what a lamp without area sends through a pane.")
        .confirmed("the passes to and fro, one by one", 1e-9, move || {
            let FresnelPowers { r_s, r_p, .. } = fresnel_exact(2.0 / distance, INDEX);
            let beams = |r: f64| (0..60).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum::<f64>();
            TINT * shown((2.0 / distance).powi(3) / 4.0 * 0.5 * (beams(r_s) + beams(r_p)))
        })
        .or_else("no tint", value / TINT)
        .or_else("dark", 0.0)
        .sees(0.01)
}

/// Plastic whose smooth coat has a chequerboard for its tint.
fn coat() -> Truth {
    const TINT: f64 = 0.3;
    const GROUND: f64 = 0.5;
    let reflected = fresnel_exact(60_f64.to_radians().cos(), INDEX).reflectance();
    let board = json!({ "type": "checker", "first": 0.9, "second": TINT, "uv_offset": [0.25, -0.25] });
    let material = json!({ "type": "plastic", "reflectance": GROUND, "coat": INDEX, "internal_reflection": "uncoloured",
        "reflected_tint": board });
    // The middle of the square, (½, ½), is where the picture is.
    let scene = plate(60.0, false).thing(json!({ "shape": level_square([0.0; 3], 10.0, true), "material": material }));
    let of = move |tint: f64| tint * reflected + GROUND * (1.0 - reflected);
    Truth::new("tinted-coat-under-a-sky", &scene, of(TINT), "tR + ρ(1 − R), 60°, n = 1.5, t = 0.3, ρ = ½")
        .because(
            "A tint takes a share of what the coat mirrors, and none of what it lets in: of this ρ leaves, all in all.",
        )
        .confirmed("adding up the light between base and coat, T_avg by quadrature", 1e-6, move || {
            let passed = |mu: f64| 1.0 - fresnel_exact(mu, INDEX).reflectance();
            let mean = interval(|mu| 2.0 * mu * passed(mu), 0.0, 1.0, 1e-10).value;
            let back = 1.0 - mean / (INDEX * INDEX);
            let base: f64 = (0..200).map(|k| mean * GROUND * back.powi(k)).sum();
            TINT * reflected + (1.0 - reflected) * base / (INDEX * INDEX)
        })
        .or_else("no tint", of(1.0))
        .or_else("the other fields", of(0.9))
        .or_else("the ground tinted, too", TINT * of(1.0))
        .claims(Claim::AveragesPolarisation)
        .sees(2e-3)
}

/// Plastic that is black under a rough coat.
fn rough_coat() -> Truth {
    const TINT: f64 = 0.6;
    let (sine, cosine) = 70_f64.to_radians().sin_cos();
    let material = json!({ "type": "plastic", "reflectance": 0, "coat": INDEX, "alpha": 0.8, "distribution": "beckmann",
        "masking": "separable", "reflected_tint": TINT });
    // That of `beckmann-coat-of-separable-masking`.
    let untinted = 0.059_834;
    Truth::new(
        "tinted-rough-coat-under-a-sky",
        &plate(70.0, false).thing(thing(material)),
        TINT * untinted,
        "t ∫ D(h) R G(o, i)/(4 cos θₒ) dω_i, seen 70° off the normal, t = 0.6",
    )
    .because("What the facets of a coat reflect is tinted, whichever of its directions is drawn.")
    .confirmed("midpoints over the slopes of facets, 640²", 5e-5, move || {
        TINT * beckmann_albedo([0.8; 2], [sine, 0.0, cosine], Some(INDEX), Masking::Separable).reflected
    })
    .or_else("no tint", untinted)
    .or_else("the tint twice", TINT * TINT * untinted)
    .claims(Claim::AveragesPolarisation)
    .sees(0.01)
}
