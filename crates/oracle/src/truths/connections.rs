//! Lights without area, seen by way of mirrors and smooth glass: plates, balls, rods, prisms, corners, and fog above a mirror.

mod prism;
mod rounds;

use std::f64::consts::PI;

use serde_json::json;

use super::{
    Claim, Truth,
    media::{boundary, isotropic, medium},
    prisms::refracted,
    scene::{Scene, block, glass, level_square, mirror, parallelogram, shown},
};
use crate::{
    laws::{FresnelPowers, fresnel_exact},
    vector::{Vec3, dot},
};
use prism::beams_through_a_prism;
use rounds::{rounds, sun_by_a_mirror_ball};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = panes();
    list.extend(mirrors());
    list.extend(rounds());
    list.extend(beams_through_a_prism());
    list.push(fog_above_a_mirror());
    list.into_iter().map(|truth| truth.claims(Claim::SpecularConnections)).collect()
}

const INDEX: f64 = 1.5;

/// A lamp of intensity 1 above a plate of glass, and the meter below, aside of the foot.
struct Plate;

impl Plate {
    const LAMP_M: f64 = 2.0;
    const BOTTOM_M: f64 = 0.6;
    const THICKNESS_M: f64 = 0.4;
    const ASIDE_M: f64 = 1.1;
    /// Times that light goes to and fro, beyond which less than 1e-12 is left.
    const ORDERS: i32 = 12;

    /// How far aside light arrives that leaves the lamp by the sine of this angle, after going to and fro inside some times.
    fn aside(sine: f64, order: i32) -> f64 {
        let tangent = |sine: f64| sine / (1.0 - sine * sine).sqrt();
        (Self::LAMP_M - Self::THICKNESS_M) * tangent(sine)
            + f64::from(2 * order + 1) * Self::THICKNESS_M * tangent(sine / INDEX)
    }

    /// The sine of the angle by which light leaves that arrives at the meter.
    fn sine(order: i32) -> f64 {
        let (mut low, mut high) = (0.0, 1.0 - 1e-9);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if Self::aside(middle, order) < Self::ASIDE_M { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// What comes through both faces, and what each reflection inside leaves.
    fn irradiance(share: impl Fn(&FresnelPowers, i32) -> f64) -> f64 {
        let of_order = |order: i32| {
            let sine = Self::sine(order);
            let cosine = (1.0 - sine * sine).sqrt();
            // d(aside)/d(sine): a tangent grows by 1/cos³.
            let inside = sine / INDEX;
            let grows = (Self::LAMP_M - Self::THICKNESS_M) / cosine.powi(3)
                + f64::from(2 * order + 1) * Self::THICKNESS_M / (INDEX * (1.0 - inside * inside).powf(1.5));
            // A ring of the width da holds the light of the angles sin θ dθ = sin θ d(sin θ)/cos θ.
            sine / cosine / (Self::ASIDE_M * grows) * share(&fresnel_exact(cosine, INDEX), order)
        };
        (0..Self::ORDERS).map(of_order).sum()
    }

    /// The same by rays that are refracted by Snell's law in vector form: the flux between neighbours over the ring that it arrives in.
    fn by_rays() -> f64 {
        let h = 1e-5;
        let lands = |angle: f64, order: i32| {
            let (sine, cosine) = angle.sin_cos();
            let inside = refracted([sine, 0.0, -cosine], [0.0, 0.0, 1.0], INDEX);
            let across = -inside[0] / inside[2] * Self::THICKNESS_M;
            sine / cosine * (Self::LAMP_M - Self::THICKNESS_M) + f64::from(2 * order + 1) * across
        };
        let of_order = |order: i32| {
            let angle = Self::sine(order).asin();
            let (near, far) = (lands(angle - h, order), lands(angle + h, order));
            let flux = (angle - h).cos() - (angle + h).cos();
            let reflectance = fresnel_exact(angle.cos(), INDEX).reflectance();
            flux / (0.5 * (far * far - near * near)) * (1.0 - reflectance).powi(2) * reflectance.powi(2 * order)
        };
        (0..Self::ORDERS).map(of_order).sum()
    }

    fn scene() -> Scene {
        let far = 200.0;
        let bottom = Self::BOTTOM_M;
        Scene::light_meter()
            .object(block([-far, -far, bottom], [far, far, bottom + Self::THICKNESS_M]), glass(INDEX))
            .point_light([Self::ASIDE_M, 0.0, Self::LAMP_M], 1.0)
            .spp(1 << 9)
    }
}

fn panes() -> Vec<Truth> {
    let because = "A ring da wide about the foot of the lamp receives the light of the angles dθ: I sin θ dθ/(a da), whatever bends it. The faces \
         transmit 1 − R each, and every time that light goes to and fro inside, R² is left of it.";
    let unpolarised = |r: f64, order: i32| (1.0 - r).powi(2) * r.powi(2 * order);
    let averaged = Plate::irradiance(|powers, order| unpolarised(powers.reflectance(), order));
    let polarised =
        Plate::irradiance(|powers, order| 0.5 * (unpolarised(powers.r_s, order) + unpolarised(powers.r_p, order)));
    // A pane that has no thickness: what is lost is 2R/(1 + R) of each polarisation.
    let distance = 2.5_f64;
    let powers = fresnel_exact(2.0 / distance, INDEX);
    let of_both = move |through: fn(f64) -> f64| 0.5 * (through(powers.r_s) + through(powers.r_p));
    let bare = 2.0 / distance.powi(3);
    let pane = json!({ "type": "thin-dielectric", "index": INDEX });
    let behind_a_pane = Scene::light_meter()
        .thing(json!({ "shape": level_square([0.0, 0.0, 1.0], 50.0, false), "material": pane }))
        .point_light([1.5, 0.0, 2.0], 1.0)
        .spp(1 << 10);
    vec![
        Truth::new("lamp-above-a-plate", &Plate::scene(), shown(averaged), "(ρ/π) Σ I sin θ dθ/(a da) (1 − R)² R²ᵏ")
            .because(because)
            .confirmed("rays refracted by vectors, the flux between neighbours", 1e-8, || shown(Plate::by_rays()))
            .or_else("dark", 0.0)
            .or_else("radiance not spread by n² behind the plate", shown(averaged) / (INDEX * INDEX))
            .claims(Claim::AveragesPolarisation)
            .sees(0.01),
        Truth::new(
            "lamp-above-a-plate-in-polarised-light",
            &Plate::scene(),
            shown(polarised),
            "the mean of that for s and for p",
        )
        .because(because)
        .or_else("dark", 0.0)
        .claims(Claim::CarriesPolarisation)
        .sees(0.01),
        Truth::new(
            "lamp-behind-a-thin-pane",
            &behind_a_pane,
            shown(bare * of_both(|r| (1.0 - r) / (1.0 + r))),
            "(ρ/π) I h/d³ ½Σ (1 − R)/(1 + R) of s and p",
        )
        .because(
            "Light goes straight on; Σ (1 − R)² R²ᵏ = (1 − R)/(1 + R) of each polarisation comes through both faces.",
        )
        .confirmed("the passes to and fro, one by one", 1e-12, move || {
            shown(bare * of_both(|r| (0..30).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum()))
        })
        .or_else("dark", 0.0)
        .or_else("no pane", shown(bare))
        .sees(0.01),
    ]
}

/// What a point of intensity 1 gives the meter at the origin, which faces up.
fn from_point(position: Vec3) -> f64 {
    position[2].max(0.0) / dot(position, position).powf(1.5)
}

fn mirrors() -> Vec<Truth> {
    let below = from_point([0.7, 0.2, 1.2]) + 0.8 * from_point([0.7, 0.2, 2.8]);
    let below_a_mirror = Scene::light_meter()
        .object(level_square([0.0, 0.0, 2.0], 60.0, false), mirror(0.8))
        .point_light([0.7, 0.2, 1.2], 1.0)
        .spp(1 << 10);
    // Two mirrors at right angles, x = 1 and y = 1.
    let lamp = [0.2, 0.4, 1.3];
    let (x, y) = (2.0 - lamp[0], 2.0 - lamp[1]);
    let first = [from_point([x, lamp[1], lamp[2]]), from_point([lamp[0], y, lamp[2]])];
    let corner = from_point(lamp) + 0.9 * first[0] + 0.7 * first[1] + 0.63 * from_point([x, y, lamp[2]]);
    let in_a_corner = Scene::light_meter()
        .object(parallelogram([1.0, -60.0, -60.0], [0.0, 0.0, 120.0], [0.0, 61.0, 0.0]), mirror(0.9))
        .object(parallelogram([-60.0, 1.0, -60.0], [0.0, 0.0, 120.0], [61.0, 0.0, 0.0]), mirror(0.7))
        .point_light(lamp, 1.0)
        .spp(1 << 10);
    vec![
        Truth::new("lamp-below-a-mirror", &below_a_mirror, shown(below), "(ρ/π) I (h/d³ + R h′/d′³)")
            .because("A flat mirror shows the lamp as far behind it as it is before it, R times as bright.")
            .confirmed("by the angles to the normal", 1e-12, || {
                let seen = |aside: f64, height: f64| aside.atan2(height).cos().powi(3) / (height * height);
                let aside = 0.7_f64.hypot(0.2);
                shown(seen(aside, 1.2) + 0.8 * seen(aside, 2.8))
            })
            .or_else("the mirror shows nothing", shown(from_point([0.7, 0.2, 1.2])))
            .or_else("the mirror loses nothing", shown(from_point([0.7, 0.2, 1.2]) + from_point([0.7, 0.2, 2.8])))
            .or_else("the lamp as far as its mirror", shown(1.8 * from_point([0.7, 0.2, 1.2])))
            .sees(0.01),
        Truth::new(
            "lamp-in-a-corner-of-mirrors",
            &in_a_corner,
            shown(corner),
            "(ρ/π) I Σ R h/d³ over the lamp and three images",
        )
        .because("Each mirror shows the lamp, and the two together show it once more behind the edge, by R₁R₂.")
        .confirmed("by the angles to the normal", 1e-12, move || {
            let seen = |a: f64, b: f64| a.hypot(b).atan2(lamp[2]).cos().powi(3) / (lamp[2] * lamp[2]);
            shown(seen(lamp[0], lamp[1]) + 0.9 * seen(x, lamp[1]) + 0.7 * seen(lamp[0], y) + 0.63 * seen(x, y))
        })
        .or_else("no image behind the edge", shown(corner - 0.63 * from_point([x, y, lamp[2]])))
        .or_else("that image twice, by each order of the mirrors", shown(corner + 0.63 * from_point([x, y, lamp[2]])))
        .sees(0.01),
        sun_by_a_mirror_ball(),
    ]
}

/// A layer of thin fog above a mirror, in parallel light.
fn fog_above_a_mirror() -> Truth {
    const DEPTH: f64 = 0.7;
    const ALBEDO: f64 = 1e-4;
    let (mu, mu_0, r) = (0.8, 0.6, 0.9);
    // What comes to an optical depth along a cosine, straight and by way of the mirror.
    let arrives = move |depth: f64, mu: f64| (-depth / mu).exp() + r * (-(2.0 * DEPTH - depth) / mu).exp();
    let of = |k: f64, at: f64| if k == 0.0 { DEPTH * at } else { at * (1.0 - (-k * DEPTH).exp()) / k };
    // ∫ e^(−ks) ds of the four products; the mirrored ones grow with depth.
    let both = 1.0 / mu + 1.0 / mu_0;
    let lost = |mu: f64| (-2.0 * DEPTH / mu).exp();
    let integral = of(both, 1.0)
        + r * of(1.0 / mu - 1.0 / mu_0, lost(mu_0))
        + r * of(1.0 / mu_0 - 1.0 / mu, lost(mu))
        + r * r * of(-both, lost(mu) * lost(mu_0));
    let radiance = move |integral: f64| ALBEDO / (4.0 * PI) * 1e4 / mu * integral;
    let straight = of(both, 1.0);
    let fog = medium(ALBEDO, 1.0 - ALBEDO, &isotropic());
    let scene = Scene::orthographic([0.6, 0.0, 3.0], [0.0, 0.0, 3.0 - 0.8], 0.1)
        .thing(json!({ "shape": block([-500.0, -500.0, 0.0], [500.0, 500.0, DEPTH]), "material": boundary(&fog) }))
        .object(level_square([0.0, 0.0, -0.1], 500.0, true), mirror(r))
        .directional_light([-0.8, 0.0, -0.6], 1e4)
        .film(16, 16)
        .spp(1 << 10);
    Truth::new("fog-above-a-mirror", &scene, radiance(integral), "(ϖE/4πμ) ∫ (e^(−s/μ₀) + R e^(−(2τ − s)/μ₀))(e^(−s/μ) + R e^(−(2τ − s)/μ)) ds")
        .because("Light comes to each depth straight and by way of the mirror, and what it scatters comes to the eye in both ways.")
        .confirmed("by quadrature over depth", 1e-9, move || {
            let scattered = |s: f64| arrives(s, mu) * arrives(s, mu_0);
            radiance(crate::quadrature::interval(scattered, 0.0, DEPTH, 1e-12).value)
        })
        .or_else("no light by way of the mirror to the fog", radiance(straight + r * of(1.0 / mu_0 - 1.0 / mu, lost(mu))))
        .or_else("nothing lost before the mirror", radiance(integral + r * of(1.0 / mu - 1.0 / mu_0, 1.0 - lost(mu_0))))
        .allows(2e-4, "light scattered twice has an albedo of 1e-4 more, the edges are 500 m away")
        .claims(Claim::Scattering)
        .sees(0.01)
}
