//! Media without an interface that hold each other, and dielectrics, by priority.

use serde_json::{Value, json};

use super::media::{isotropic, medium};
use super::scene::{Scene, black, block, level_square, shown, solid, sphere};
use super::{Claim, Truth};
use crate::laws::fresnel_exact;
use crate::transfer::{Slab, by_scattering_orders};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = absorbing();
    list.extend(with_glass());
    list.push(shadow_ray());
    list.extend(scattering());
    list.into_iter().map(|truth| truth.claims(Claim::Priorities)).collect()
}

/// The boundary of a medium among others.
fn boundary(medium: &Value, priority: u32) -> Value {
    json!({ "type": "boundary", "medium": medium, "priority": priority })
}

/// A slab, wide beyond sight, between two heights.
fn slab(from: f64, to: f64) -> Value {
    block([-1e3, -1e3, from], [1e3, 1e3, to])
}

/// An eye that looks down at a lamp of radiance 1, tilted.
fn above_a_lamp(tilt_deg: f64) -> Scene {
    let (sine, cosine) = tilt_deg.to_radians().sin_cos();
    Scene::orthographic([4.0 * sine, 0.0, 4.0 * cosine], [0.0; 3], 1e-3)
        .lamp(level_square([0.0, 0.0, -3.0], 1e3, true), black(), 1.0, "front")
        .spp(1024)
}

fn clear(per_m: f64) -> Value {
    medium(0.0, per_m, &isotropic())
}

/// Haze of 0.2/m from −2 m to 2 m holds what is from −0.5 m to 0.7 m.
fn absorbing() -> Vec<Truth> {
    const HAZE: f64 = 0.2;
    let haze = |priority| (slab(-2.0, 2.0), boundary(&clear(HAZE), priority));
    let cloud = |per_m, priority| (slab(-0.5, 0.7), boundary(&clear(per_m), priority));
    let through = |per_m: f64| (-(HAZE * 2.8 + per_m * 1.2)).exp();
    let both = |per_m: f64| (-(HAZE * 4.0 + per_m * 1.2)).exp();
    let truth = |name: &str, parts: [(Value, Value); 2], per_m: f64| {
        let scene = parts.into_iter().fold(above_a_lamp(0.0), |scene, (shape, material)| {
            scene.thing(json!({ "shape": shape, "material": material }))
        });
        Truth::new(name, &scene, through(per_m), format!("e^(−(0.2·2.8 + {per_m}·1.2))"))
            .because("Of media that overlap, the one of the highest priority fills the place, of equal priorities that of the later object.")
            .confirmed("the shares of three layers", 1e-12, move || {
                [HAZE * 1.3, per_m * 1.2, HAZE * 1.5].map(|depth| (-depth).exp()).into_iter().product()
            })
            .or_else("both fill the place", both(per_m))
            .or_else("the larger fills the place", (-HAZE * 4.0_f64).exp())
            .or_else("nothing beyond the smaller", (-(HAZE * 1.3 + per_m * 1.2)).exp())
            .sees(0.01)
            .claims(Claim::Absorption)
    };
    vec![
        truth("cloud-in-haze-by-priority", [cloud(0.8, 2), haze(1)], 0.8),
        truth("cloud-in-haze-by-order", [haze(1), cloud(0.8, 1)], 0.8),
        truth("hole-in-haze", [cloud(0.0, 7), haze(0)], 0.0),
    ]
}

/// Transmittance of a plate whose faces reflect R, and which lets τ through from face to face.
fn plate(r: f64, tau: f64) -> f64 {
    (1.0 - r).powi(2) * tau / (1.0 - (r * tau).powi(2))
}

/// Plates of glass of 0.5 m in smoke, and with smoke in them.
fn with_glass() -> Vec<Truth> {
    const SMOKE: f64 = 0.3;
    let mut list = Vec::new();
    let glass = (slab(-0.25, 0.25), solid(1.5, 3));
    for tilt_deg in [0.0_f64, 60.0] {
        let (sine, cosine) = tilt_deg.to_radians().sin_cos();
        let r = fresnel_exact(cosine, 1.5).reflectance();
        let inside = (1.0 - (sine / 1.5).powi(2)).sqrt();
        let around = (-SMOKE * 3.5 / cosine).exp();
        let scene = above_a_lamp(tilt_deg)
            .thing(json!({ "shape": slab(-2.0, 2.0), "material": boundary(&clear(SMOKE), 1) }))
            .object(glass.0.clone(), glass.1.clone());
        let truth = Truth::new(
            format!("glass-in-smoke-at-{tilt_deg}-degrees"),
            &scene,
            plate(r, 1.0) * around,
            "(1 − R)²/(1 − R²) e^(−0.3·3.5/cos θ)",
        )
        .because("Glass of a higher priority than the smoke around it holds no smoke; beams that it reflects to and fro leave it in parallel.")
        .confirmed("adding up the beams one by one", 1e-12, move || {
            (0..100).map(|k| (1.0 - r).powi(2) * r.powi(2 * k) * around).sum()
        })
        .or_else("smoke in the glass too", plate(r, (-SMOKE * 0.5 / inside).exp()) * around)
        .or_else("no smoke behind the glass", plate(r, 1.0) * (-SMOKE * 1.75 / cosine).exp())
        .or_else("no smoke", plate(r, 1.0))
        .sees(0.01)
        .claims(Claim::Absorption);
        list.push(if tilt_deg > 0.0 { truth.claims(Claim::AveragesPolarisation) } else { truth });
    }
    // Smoke of the higher priority: the index stays that of the glass.
    const DARK: f64 = 3.0;
    let r = fresnel_exact(1.0, 1.5).reflectance();
    let tau = (-DARK * 0.3_f64).exp();
    let scene = above_a_lamp(0.0)
        .object(glass.0, glass.1)
        .thing(json!({ "shape": slab(-0.1, 0.2), "material": boundary(&clear(DARK), 4) }));
    list.push(
        Truth::new("smoke-in-glass", &scene, plate(r, tau), "(1 − R)²τ/(1 − R²τ²), τ = e^(−3·0.3)")
            .because("The boundary of a medium is no surface: where it is in glass, the index is that of the glass.")
            .confirmed("adding up the beams one by one", 1e-12, move || {
                (0..100).map(|k| (1.0 - r).powi(2) * tau * (r * tau).powi(2 * k)).sum()
            })
            .or_else("no smoke", plate(r, 1.0))
            .or_else("smoke in all of the glass", plate(r, (-DARK * 0.5).exp()))
            .or_else("a bubble of index 1", plate(r, 1.0).powi(2) * tau)
            .sees(0.01)
            .claims(Claim::Absorption),
    );
    list
}

/// A lamp in a cloud in haze, and a plate outside of both.
fn shadow_ray() -> Truth {
    // From 0.7 m below the cloud's middle to the plate 5 m below: 0.3 m of cloud, then haze up to 3 m, then nothing.
    let at = |cloud: f64, haze: f64| shown(50.0 / 25.0 * f64::exp(-(2.0 * cloud + 0.4 * haze)));
    let scene = Scene::light_meter()
        .thing(json!({ "shape": sphere([0.0, 0.0, 5.7], 1.0), "material": boundary(&clear(2.0), 9) }))
        .thing(json!({ "shape": sphere([0.0, 0.0, 5.7], 3.0), "material": boundary(&clear(0.4), 3) }))
        .point_light([0.0, 0.0, 5.0], 50.0);
    Truth::new("plate-below-a-cloud-in-haze", &scene, at(0.3, 2.0), "ρ/π · I/d² e^(−(2·0.3 + 0.4·2))")
        .because("A shadow ray loses in each medium what it absorbs over its part of the way.")
        .confirmed("the shares of two layers", 1e-12, || shown(2.0 * f64::exp(-0.6) * f64::exp(-0.8)))
        .or_else("the haze from the lamp on", at(0.0, 2.3))
        .or_else("the cloud to the end of the haze", at(2.3, 0.0))
        .or_else("no haze", at(0.3, 0.0))
        .allows(1e-6 * at(0.3, 2.0), "the plate is 1 mm wide")
        .sees(0.01)
        .claims(Claim::Absorption)
}

/// A slab of two densities scatters as its optical thickness says.
fn scattering() -> Vec<Truth> {
    let haze = |albedo: f64| boundary(&medium(0.5 * albedo, 0.5 * (1.0 - albedo), &isotropic()), 0);
    let cloud = |albedo: f64| boundary(&medium(2.0 * albedo, 2.0 * (1.0 - albedo), &isotropic()), 1);
    let wide = |from: f64, to: f64| block([-1e4, -1e4, from], [1e4, 1e4, to]);
    let mut list = Vec::new();
    for albedo in [1.0, 0.9] {
        // 1.4 m of haze, 0.6 m of cloud.
        let depth = 0.5 * 1.4 + 2.0 * 0.6;
        let fluxes = Slab::new(depth, albedo, &[1.0], 1.0).of_beam();
        let thin = Slab::new(1.0, albedo, &[1.0], 1.0).of_beam();
        let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 1e-3)
            .thing(json!({ "shape": wide(-1.4, -0.8), "material": cloud(albedo) }))
            .thing(json!({ "shape": wide(-2.0, 0.0), "material": haze(albedo) }))
            .object(level_square([0.0, 0.0, -3.0], 1e4, true), black())
            .sky(1.0);
        list.push(
            Truth::new(
                format!("cloud-in-haze-of-albedo-{albedo}-reflected"),
                &scene,
                fluxes.reflected,
                format!("doubling: τ = {depth}, ϖ = {albedo}"),
            )
            .because("By reciprocity an eye sees of light of 1 on one side the share of a beam along its sight that goes to that side; it depends on the optical thickness alone.")
            .confirmed("the transfer equation, order by order", 2e-4, move || {
                by_scattering_orders(depth, albedo, |_| 1.0)[0].reflected
            })
            .or_else("the haze alone", thin.reflected)
            .sees(0.04)
            .allows(1e-4, "light from between the black square and the slab, 2·10⁴ m wide; single precision")
            .no_brighter_than(1.0)
            .claims(Claim::Scattering),
        );
    }
    let ball = |radius: f64, per_m: f64, priority: u32| json!({ "shape": sphere([0.1 * radius, 0.0, 0.0], radius), "material": boundary(&medium(per_m, 0.0, &isotropic()), priority) });
    let furnace = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0)
        .thing(ball(0.5, 5.0, 4))
        .thing(ball(0.9, 1.0, 1))
        .object(sphere([-0.3, 0.2, 0.0], 0.4), solid(1.5, 2))
        .sky(1.0)
        .spp(64);
    list.push(
        Truth::new("clouds-and-glass-in-a-furnace", &furnace, 1.0, "1")
            .because("Where all light has the radiance 1, scattering and reflection without loss change nothing.")
            .sees(0.01)
            .no_brighter_than(1.0)
            .claims(Claim::AveragesPolarisation)
            .claims(Claim::Scattering),
    );
    list
}
