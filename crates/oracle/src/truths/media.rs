//! Media that scatter, emit and change from place to place.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth, air, densities, media_furnaces, published_media,
    scene::{Scene, black, block, level_square, sphere},
};
use crate::quadrature::interval;
use crate::transfer::{
    HalfSpace, IsotropicSlab, Slab, ball_transmittance, by_scattering_orders, glow_of_point_lamp, henyey_greenstein,
    legendre_moments, scattered_once,
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = media_furnaces::truths();
    list.extend(half_spaces());
    list.extend(slabs());
    list.extend(scattered_once_in_slabs());
    list.extend([glow_of_a_lamp(), glow_in_forward_fog(), mean_way_in_a_ball(), glowing_ball(), glowing_fog()]);
    list.extend(densities::truths());
    list.extend(published_media::truths());
    list.extend(air::truths());
    list.into_iter().map(|truth| truth.claims(Claim::Scattering)).collect()
}

/// The boundary of a medium without an interface.
pub(super) fn boundary(medium: &Value) -> Value {
    json!({ "type": "boundary", "medium": medium })
}

pub(super) fn medium(scattering_per_m: f64, absorption_per_m: f64, phase: &Value) -> Value {
    json!({ "scattering_per_m": scattering_per_m, "absorption_per_m": absorption_per_m, "phase": phase })
}

pub(super) fn isotropic() -> Value {
    json!({ "type": "isotropic" })
}

pub(super) fn forward(g: f64) -> Value {
    json!({ "type": "henyey-greenstein", "g": g })
}

/// Mean of a square picture that a ball's disk touches on four sides, before a sky of 1.
pub(super) fn framed(disk: f64) -> f64 {
    1.0 + 0.25 * PI * (disk - 1.0)
}

/// A ball of radius 1 m under a sky of 1, which fills the height of the picture.
pub(super) fn ball(material: Value) -> Scene {
    Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0)
        .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": material }))
        .sky(1.0)
}

/// A .vol file of a grid over a box.
pub(super) fn vol(cells: [i32; 3], box_m: [[f32; 3]; 2], values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    [1, cells[0], cells[1], cells[2], 1].iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    box_m.as_flattened().iter().chain(values).for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

/// A slab below z = 0 and wide beyond sight, seen from above at a cosine to the normal, under a sky of 1. What else there is stands below
/// it, or behind the eye.
pub(super) fn slab(depth_m: f64, medium: &Value, mu: f64) -> Scene {
    let sine = (1.0 - mu * mu).sqrt();
    Scene::orthographic([sine, 0.0, mu], [0.0; 3], 1e-3)
        .thing(json!({ "shape": block([-1e4, -1e4, -depth_m], [1e4, 1e4, 0.0]), "material": boundary(medium) }))
}

pub(super) const WIDE: &str =
    "the slab is 2·10⁴ m wide, not endless: light from beyond its edges is below 1e-6; single precision";

fn half_spaces() -> Vec<Truth> {
    let mut list = Vec::new();
    for (albedo, mu, name) in [
        (0.5, 1.0, "half-space-of-albedo-0.5"),
        (0.8, 0.5, "half-space-of-albedo-0.8-at-60-degrees"),
        (0.9, 1.0, "half-space-of-albedo-0.9"),
        (0.99, 0.5, "half-space-of-albedo-0.99-at-60-degrees"),
    ] {
        let value = HalfSpace::new(albedo).plane_albedo(mu);
        // The same in two ways.
        let filled = match mu == 1.0 {
            true => medium(albedo, 1.0 - albedo, &isotropic()),
            false => json!({ "extinction_per_m": 1, "albedo": albedo }),
        };
        let scene = slab(200.0, &filled, mu).sky(1.0);
        list.push(of_half_space(name, &scene, albedo, mu, value));
    }
    // From 2 to 9 times as thick from violet to red, which a half-space does not show.
    let table =
        |times: f64| json!({ "type": "tabulated", "wavelengths_nm": [360, 830], "values": [2.0 * times, 9.0 * times] });
    let coloured = json!({ "scattering_per_m": table(0.9), "absorption_per_m": table(0.1) });
    let value = HalfSpace::new(0.9).plane_albedo(1.0);
    let scene = slab(100.0, &coloured, 1.0).sky(1.0);
    list.push(
        of_half_space("half-space-of-coloured-extinction", &scene, 0.9, 1.0, value).claims(Claim::PhotometricSensor),
    );
    let coloured = json!({ "extinction_per_m": table(1.0), "albedo": 0.9 });
    let blue = slab(100.0, &coloured, 1.0).sky(1.0).band([400.0, 410.0]);
    list.push(of_half_space("half-space-of-coloured-extinction-in-violet", &blue, 0.9, 1.0, value));
    // Parallel light of irradiance π.
    let factor = HalfSpace::new(0.9).radiance_factor(1.0, 0.6);
    let lit = slab(200.0, &medium(0.9, 0.1, &isotropic()), 1.0).directional_light([0.8, 0.0, -0.6], PI / 0.6);
    let truth =
        Truth::new("half-space-in-parallel-light", &lit, factor, "ϖ H(μ)H(μ₀)/(4(μ + μ₀)), ϖ = 0.9, μ = 1, μ₀ = 0.6")
            .because("Chandrasekhar's law of diffuse reflection, for an irradiance of π on the surface.")
            .confirmed("Chandrasekhar's equation for H, by iteration", 4e-6, || {
                let half_space = HalfSpace::new(0.9);
                0.9 * half_space.h_by_iteration(1.0) * half_space.h_by_iteration(0.6) / 6.4
            })
            .or_else("light scattered once alone", scattered_once(200.0, 0.9, 1.0, 1.0, 0.6))
            .sees(0.03)
            .allows(1e-6, WIDE);
    list.push(truth);
    list
}

pub(super) fn of_half_space(name: &str, scene: &Scene, albedo: f64, mu: f64, value: f64) -> Truth {
    let single = |x: f64| 0.5 * albedo * (1.0 - x * (1.0 + 1.0 / x).ln());
    Truth::new(name, scene, value, format!("1 − H(μ)√(1 − ϖ), ϖ = {albedo}, μ = {mu}"))
        .because("By reciprocity an eye sees of a half-space under a sky of 1 the share of a beam along its sight that comes back.")
        .confirmed("Chandrasekhar's equation for H, by iteration", 2e-6, move || {
            1.0 - HalfSpace::new(albedo).h_by_iteration(mu) * (1.0 - albedo).sqrt()
        })
        .or_else("light scattered once alone", single(mu))
        .or_else("the albedo applied twice", HalfSpace::new(albedo * albedo).plane_albedo(mu))
        .sees(0.03)
        .allows(1e-6, WIDE)
        .no_brighter_than(1.0)
}

fn slabs() -> Vec<Truth> {
    let mut list = Vec::new();
    for (depth, albedo, g, name) in [
        (1.0, 1.0, 0.0, "slab-of-depth-1"),
        (5.0, 0.9, 0.0, "slab-of-depth-5-that-absorbs"),
        (2.0, 0.9, 0.75, "slab-that-scatters-forward"),
        (8.0, 1.0, 0.85, "slab-of-depth-8-that-scatters-forward"),
    ] {
        let moments = legendre_moments(|x| henyey_greenstein(g, x), 96);
        let fluxes = Slab::new(depth, albedo, &moments, 1.0).of_beam();
        let filled = medium(albedo, 1.0 - albedo, &if g == 0.0 { isotropic() } else { forward(g) });
        let orders = move || by_scattering_orders(depth, albedo, |x| henyey_greenstein(g, x))[0];
        // By black squares below the slab, or above the eye: from there comes no light.
        let reflects =
            slab(depth, &filled, 1.0).object(level_square([0.0, 0.0, -depth - 1.0], 1e4, true), black()).sky(1.0);
        let transmits = slab(depth, &filled, 1.0).object(level_square([0.0, 0.0, 2.0], 1e4, false), black()).sky(1.0);
        let truth = |what: &str, scene: &Scene, value: f64| {
            Truth::new(format!("{name}-{what}"), scene, value, format!("doubling: τ = {depth}, ϖ = {albedo}, g = {g}"))
                .because("By reciprocity an eye sees of light of 1 on one side the share of a beam along its sight that goes to that side.")
                .sees(0.04)
                .allows(1e-4, "light from between the black square and the slab, 2·10⁴ m wide; single precision")
                .no_brighter_than(1.0)
        };
        let reversed = Slab::new(depth, albedo, &legendre_moments(|x| henyey_greenstein(-g, x), 96), 1.0).of_beam();
        let mut reflected =
            truth("reflected", &reflects, fluxes.reflected).or_else("what goes to the other side", fluxes.transmitted);
        let mut transmitted = truth("transmitted", &transmits, fluxes.transmitted)
            .or_else("light that was not scattered alone", (-depth).exp());
        if g != 0.0 {
            reflected = reflected.or_else("the phase function reversed", reversed.reflected);
            transmitted = transmitted.or_else("the phase function reversed", reversed.transmitted);
        }
        if depth > 2.0 && g == 0.0 {
            let again = "the integral equation for the source function";
            let by_source = move || IsotropicSlab::new(depth, albedo).of_beam(1.0);
            reflected = reflected.confirmed(again, 1e-5, move || by_source().reflected);
            transmitted = transmitted.confirmed(again, 1e-5, move || by_source().transmitted);
        } else {
            let again = "the transfer equation, order by order";
            reflected = reflected.confirmed(again, 2e-4, move || orders().reflected);
            transmitted = transmitted.confirmed(again, 2e-4, move || orders().transmitted);
        }
        list.extend([reflected, transmitted]);
    }
    list
}

fn scattered_once_in_slabs() -> Vec<Truth> {
    let (depth, albedo, mu, mu_0) = (0.7, 0.8, 0.8, 0.5_f64);
    let sine = |cosine: f64| (1.0 - cosine * cosine).sqrt();
    // The eye looks along (−0.6, 0, −0.8), light travels along (−sin, 0, −cos): scattered toward (0.6, 0, 0.8).
    let cosine = 0.6 * -sine(mu_0) + mu * -mu_0;
    let scene = |phase: &Value| {
        slab(depth, &medium(albedo, 1.0 - albedo, phase), mu)
            .directional_light([-sine(mu_0), 0.0, -mu_0], PI / mu_0)
            .depth(2)
            .spp(64)
    };
    let truth = |name: &str, phase: &Value, value: f64, reversed: f64| {
        let once = |phase: f64| scattered_once(depth, albedo, phase, mu, mu_0);
        Truth::new(name, &scene(phase), once(value), "¼ϖ p(cos θ)(1 − e^(−τ(1/μ + 1/μ₀)))/(μ + μ₀)")
            .because("Each depth sends on what comes to it, and both ways take some away; paths of two edges.")
            .confirmed("a sum over depths of what each sends on", 1e-8, move || {
                let n = 20_000;
                let at = |i: i32| depth * (f64::from(i) + 0.5) / f64::from(n);
                let passes = |depth: f64| (-depth / mu_0).exp() * (-depth / mu).exp();
                // An irradiance of π across the surface.
                let sent = 0.25 / mu / mu_0 * albedo * value;
                sent * depth / f64::from(n) * (0..n).map(|i| passes(at(i))).sum::<f64>()
            })
            .or_else("nothing lost on the way to the eye", 0.25 * albedo * value * -(-depth / mu_0).exp_m1() / mu)
            .or_else("the albedo left out", once(value) / albedo)
            .or_else("the angle of scattering reversed", once(reversed))
            .sees(5e-3)
            .allows(1e-6, WIDE)
    };
    let rayleigh = |cosine: f64| 0.75 * (1.0 + cosine * cosine);
    let peaks = |cosine: f64| 0.8 * henyey_greenstein(0.6, cosine) + 0.2 * henyey_greenstein(-0.3, cosine);
    // From 3 straight back to 1 straight on, in proportion to the cosine; the mean is 2.
    let table = |cosine: f64| (2.0 - cosine) / 2.0;
    let turned = cosine.acos().to_degrees();
    vec![
        truth("scattered-once-forward", &forward(0.6), henyey_greenstein(0.6, cosine), henyey_greenstein(0.6, -cosine)),
        truth(
            "scattered-once-by-two-peaks",
            &json!({ "type": "double-henyey-greenstein", "g": [0.6, -0.3], "weight": 0.8 }),
            peaks(cosine),
            peaks(-cosine),
        ),
        truth(
            "scattered-once-as-a-table-says",
            &json!({ "type": "tabulated", "angles_deg": [0, turned, 180], "values": [1, 2.0 - cosine, 3] }),
            table(cosine),
            table(-cosine),
        ),
        truth("scattered-once-by-air", &json!({ "type": "rayleigh" }), rayleigh(cosine), 1.0),
    ]
}

fn glow_of_a_lamp() -> Truth {
    let (scattering, extinction, h, reach) = (0.4, 0.5, 0.5, 2.0);
    let value = 3.0 * glow_of_point_lamp(scattering, extinction, h, reach, reach);
    let scene = Scene::orthographic([0.0, 0.0, 5.0], [0.0; 3], 1e-3)
        .thing(json!({
            "shape": block([-50.0, -50.0, -reach], [50.0, 50.0, reach]),
            "material": boundary(&medium(scattering, extinction - scattering, &isotropic())),
        }))
        .point_light([h, 0.0, 0.0], 3.0)
        .depth(2);
    Truth::new("lamp-in-fog-beside-the-ray", &scene, value, "σₛI/(4πh) ∫ e^(−σ(s + d)) dθ")
        .because("Each place of the ray sends on σₛ/4π of what comes to it from the lamp, I e^(−σd)/d²; ds/d² is dθ/h. Paths of two edges.")
        .confirmed("a sum over places of the ray", 1e-6, move || {
            let n = 200_000;
            let step = 2.0 * reach / f64::from(n);
            let at = |i: i32| {
                let s = -reach + (f64::from(i) + 0.5) * step;
                let d2 = s * s + h * h;
                (-extinction * (s + reach + d2.sqrt())).exp() / d2
            };
            3.0 * scattering / (4.0 * PI) * step * (0..n).map(at).sum::<f64>()
        })
        .or_else("nothing lost on the way from the lamp", {
            let n = 20_000;
            let step = 2.0 * reach / f64::from(n);
            let at = |i: i32| {
                let s = -reach + (f64::from(i) + 0.5) * step;
                (-extinction * (s + reach)).exp() / (s * s + h * h)
            };
            3.0 * scattering / (4.0 * PI) * step * (0..n).map(at).sum::<f64>()
        })
        .sees(5e-3)
}

/// A lamp beside the ray, in fog that mostly scatters forward. Nearly all places of the ray lie beyond the lamp, and scatter its light back.
fn glow_in_forward_fog() -> Truth {
    let (scattering, extinction, g, h) = (0.4, 0.5, 0.6, 0.5_f64);
    let (from, to) = (-2.0, 0.1);
    // Of a place at height z, the lamp being at 0: what it sends on straight up, the fog ending at `to`.
    let glow = move |z: f64, phase: &dyn Fn(f64) -> f64| {
        let d = h.hypot(z);
        3.0 * scattering / (4.0 * PI) * phase(z / d) * (-extinction * (to - z + d)).exp() / (d * d)
    };
    let over_places = move |phase: &dyn Fn(f64) -> f64| interval(|z| glow(z, phase), from, to, 1e-13).value;
    let ahead = move |cosine: f64| henyey_greenstein(g, cosine);
    let scene = Scene::orthographic([0.0, 0.0, 5.0], [0.0; 3], 1e-3)
        .thing(json!({
            "shape": block([-50.0, -50.0, from], [50.0, 50.0, to]),
            "material": boundary(&medium(scattering, extinction - scattering, &forward(g))),
        }))
        .point_light([h, 0.0, 0.0], 3.0)
        .depth(2);
    Truth::new("lamp-in-forward-fog-beside-the-ray", &scene, over_places(&ahead), "σₛI/4π ∫ p(cos θ) e^(−σ(s + d))/d² ds")
        .because(
            "Each place of the ray sends σₛp(cos θ)/4π of what comes to it from the lamp, I e^(−σd)/d², towards the eye. θ is the angle between the ways \
             from the lamp and to the eye. Paths of two edges.",
        )
        .confirmed("a sum over angles at the lamp", 1e-6, move || {
            // dz/d² is dφ/h.
            let (first, last) = ((from / h).atan(), (to / h).atan());
            let n = 100_000;
            let step = (last - first) / f64::from(n);
            let at = |i: i32| {
                let z = h * (first + (f64::from(i) + 0.5) * step).tan();
                glow(z, &ahead) * (h * h + z * z) / h
            };
            step * (0..n).map(at).sum::<f64>()
        })
        .or_else("the angle of scattering reversed", over_places(&|cosine| ahead(-cosine)))
        .or_else("scattered alike to all sides", over_places(&|_| 1.0))
        .sees(5e-3)
}

fn mean_way_in_a_ball() -> Truth {
    const PER_M: f64 = 0.01;
    let way = 4.0 / 3.0;
    Truth::new(
        "mean-way-through-a-ball-of-fog",
        &ball(boundary(&medium(3.0, PER_M, &forward(0.3)))),
        framed(1.0 - PER_M * way),
        "1 − ¼π σₐ 4V/S",
    )
    .because(
        "The mean length of the ways of isotropic light through a body is 4V/S, whatever scatters it there (Blanco & Fournier 2003); of the light \
         of the sky, σₐ times that is absorbed.",
    )
    .or_else("scattering taken for absorption", framed(ball_transmittance(3.0 + PER_M)))
    .or_else("nothing is absorbed", 1.0)
    .allows(
        6e-4,
        "the second order of σₐ: half the mean square of ways that are longer than the ball is wide; single precision",
    )
    .sees(5e-3)
    .no_brighter_than(1.0)
}

fn glowing_ball() -> Truth {
    let x = 1.5;
    let hot = json!({ "absorption_per_m": x, "source_radiance": 2.0 });
    let value = 2.0 * framed(1.0 - ball_transmittance(x)) - 2.0 * framed(0.0);
    Truth::new(
        "ball-that-glows",
        &Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0)
            .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": boundary(&hot) })),
        value,
        "½π(1 − (1 − (1 + 2x)e^(−2x))/2x²), x = σₐr",
    )
    .because("A chord of the length c shows B(1 − e^(−σₐc)).")
    .confirmed("a sum over chords", 1e-7, move || {
        // Rings of equal area of the disk, which fills π/4 of the picture.
        let n = 200_000;
        let chord = |i: u32| 2.0 * (1.0 - (f64::from(i) + 0.5) / f64::from(n)).sqrt();
        0.25 * PI * 2.0 / f64::from(n) * (0..n).map(|i| -(-x * chord(i)).exp_m1()).sum::<f64>()
    })
    .or_else("emission not absorbed on its way", 2.0 * 0.25 * PI * x * 4.0 / 3.0)
    .sees(5e-3)
}

fn glowing_fog() -> Truth {
    let mut fog = medium(2.0, 0.5, &forward(0.4));
    fog["source_radiance"] = json!(1.0);
    let scene = Scene::orthographic([0.0; 3], [0.0, 0.0, -1.0], 0.1).whole("medium", fog).spp(64);
    Truth::new("endless-fog-that-glows", &scene, 1.0, "B")
        .because("Matter of one temperature without an end shows its source radiance, however much it scatters.")
        .confirmed("scattering by scattering", 1e-12, || (0..200).map(|k| 0.2 * 0.8_f64.powi(k)).sum())
        .or_else("the albedo applied to emission", 0.2)
        .or_else("emission of the whole extinction", 5.0)
        .sees(5e-3)
        .no_brighter_than(1.0)
}
