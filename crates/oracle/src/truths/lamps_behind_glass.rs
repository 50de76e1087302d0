//! Lamps with an area, and skies, behind panes, plates and water: what a level plate receives of them.

use std::f64::consts::PI;

use serde_json::json;

use super::scene::{PLATE_ALBEDO, Scene, black, block, disk, glass, grey_hdr, level_square, shown};
use super::{Claim, Truth};
use crate::laws::{FresnelPowers, fresnel_exact};
use crate::quadrature::interval;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = behind_a_pane();
    list.extend(behind_a_plate());
    list.push(above_water());
    list.push(two_lamps_above_water());
    list
}

const INDEX: f64 = 1.5;
const WATER: f64 = 1.33;
/// Far enough that no light comes by way of an edge.
const FAR_M: f64 = 2000.0;

/// ∫ T cos θ 2π sin θ dθ of a lamp of radiance 1 that fills the directions up to an angle.
fn irradiance(up_to: f64, transmittance: impl Fn(f64) -> f64) -> f64 {
    2.0 * PI * interval(|theta| transmittance(theta.cos()) * theta.cos() * theta.sin(), 0.0, up_to, 1e-12).value
}

/// π Σ T Δ(sin²θ) over rings of a lamp, whose light arrives by the sine that `sine` says.
fn by_rings(radius_m: f64, sine: impl Fn(f64) -> f64, transmittance: impl Fn(f64) -> f64) -> f64 {
    const RINGS: u32 = 12_000;
    let at = |ring: f64| sine(radius_m * ring / f64::from(RINGS));
    let of_ring = |ring: u32| {
        let [near, middle, far] = [0.0, 0.5, 1.0].map(|part| at(f64::from(ring) + part));
        transmittance((1.0 - middle * middle).sqrt()) * (far * far - near * near)
    };
    PI * (0..RINGS).map(of_ring).sum::<f64>()
}

/// The number in [0, 1) where a growing function takes a value.
fn solve(function: impl Fn(f64) -> f64, value: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0 - 1e-12);
    for _ in 0..90 {
        let middle = 0.5 * (low + high);
        if function(middle) < value { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The tangent of an angle, by its sine.
fn tangent(sine: f64) -> f64 {
    sine / (1.0 - sine * sine).sqrt()
}

fn behind_a_pane() -> Vec<Truth> {
    const LAMP_M: f64 = 1.5;
    const RADIUS_M: f64 = 0.8;
    let pane = json!({ "type": "thin-dielectric", "index": INDEX });
    let below =
        |scene: Scene| scene.thing(json!({ "shape": level_square([0.0, 0.0, 0.5], FAR_M, false), "material": pane }));
    let of_both = |through: fn(f64) -> f64, cosine: f64| {
        let FresnelPowers { r_s, r_p, .. } = fresnel_exact(cosine, INDEX);
        0.5 * (through(r_s) + through(r_p))
    };
    let passes = move |cosine: f64| of_both(|r| (1.0 - r) / (1.0 + r), cosine);
    let by_beams = move |cosine: f64| of_both(|r| (0..60).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum(), cosine);
    let rim = (RADIUS_M / LAMP_M).atan();
    let sine_to = |radius: f64| radius / radius.hypot(LAMP_M);
    let because = "Light goes straight on. A pane lets (1 − R)/(1 + R) of each polarisation pass, all reflections between its faces included.";
    let sky = below(Scene::light_meter())
        .light(json!({ "type": "environment", "image": { "file": "even.hdr" } }))
        .file("even.hdr", grey_hdr(8, &[1.0; 32]))
        // What shines from below the pane would reflect.
        .object(level_square([0.0, 0.0, -0.01], FAR_M, true), black())
        .spp(1 << 10);
    vec![
        Truth::new(
            "disk-lamp-behind-a-pane",
            &below(Scene::light_meter())
                .lamp(disk([0.0, 0.0, LAMP_M], [0.0, 0.0, -1.0], RADIUS_M), black(), 1.0, "front")
                .spp(1 << 10),
            shown(irradiance(rim, passes)),
            "(ρ/π) 2πL ∫ ½Σ (1 − R)/(1 + R) cos θ sin θ dθ",
        )
        .because(because)
        .confirmed("rings of the lamp, the passes to and fro one by one", 1e-6, move || {
            shown(by_rings(RADIUS_M, sine_to, by_beams))
        })
        .or_else("dark", 0.0)
        .or_else("no pane", shown(irradiance(rim, |_| 1.0)))
        .or_else("counted twice", 2.0 * shown(irradiance(rim, passes)))
        .sees(0.01),
        Truth::new(
            "sky-behind-a-pane",
            &sky,
            shown(irradiance(0.5 * PI, passes)),
            "(ρ/π) 2πL ∫ ½Σ (1 − R)/(1 + R) cos θ sin θ dθ",
        )
        .because(because)
        .confirmed("rings of the sky, the passes to and fro one by one", 1e-6, move || {
            shown(by_rings(1.0, |sine| sine, by_beams))
        })
        .or_else("dark", 0.0)
        .or_else("no pane", PLATE_ALBEDO)
        .claims(Claim::PhotometricSensor)
        .sees(0.01),
    ]
}

/// A plate of glass between the meter and a disk that shines.
struct Plate;

impl Plate {
    const LAMP_M: f64 = 1.6;
    const RADIUS_M: f64 = 0.9;
    const BOTTOM_M: f64 = 0.5;
    const THICKNESS_M: f64 = 0.4;
    /// Times that light goes to and fro, beyond which less than 1e-12 is left.
    const ORDERS: i32 = 12;

    /// How far aside of the meter light begins that arrives by the sine of this angle, after going to and fro inside some times.
    fn aside(sine: f64, order: i32) -> f64 {
        (Self::LAMP_M - Self::THICKNESS_M) * tangent(sine)
            + f64::from(2 * order + 1) * Self::THICKNESS_M * tangent(sine / INDEX)
    }

    fn irradiance(share: fn(&FresnelPowers, i32) -> f64) -> f64 {
        let of_order = |order: i32| {
            let rim = solve(|sine| Self::aside(sine, order), Self::RADIUS_M);
            irradiance(rim.asin(), |cosine| share(&fresnel_exact(cosine, INDEX), order))
        };
        (0..Self::ORDERS).map(of_order).sum()
    }

    fn by_rings(share: fn(&FresnelPowers, i32) -> f64) -> f64 {
        let of_order = |order: i32| {
            let sine = |radius: f64| solve(|sine| Self::aside(sine, order), radius);
            by_rings(Self::RADIUS_M, sine, |cosine| share(&fresnel_exact(cosine, INDEX), order))
        };
        (0..Self::ORDERS).map(of_order).sum()
    }

    fn scene() -> Scene {
        let top = Self::BOTTOM_M + Self::THICKNESS_M;
        Scene::light_meter()
            .object(block([-FAR_M, -FAR_M, Self::BOTTOM_M], [FAR_M, FAR_M, top]), glass(INDEX))
            .lamp(disk([0.0, 0.0, Self::LAMP_M], [0.0, 0.0, -1.0], Self::RADIUS_M), black(), 1.0, "front")
            .spp(1 << 10)
    }
}

fn behind_a_plate() -> Vec<Truth> {
    fn of(r: f64, order: i32) -> f64 {
        (1.0 - r).powi(2) * r.powi(2 * order)
    }
    fn averaged(powers: &FresnelPowers, order: i32) -> f64 {
        of(powers.reflectance(), order)
    }
    fn polarised(powers: &FresnelPowers, order: i32) -> f64 {
        0.5 * (of(powers.r_s, order) + of(powers.r_p, order))
    }
    let because = "From each direction θ the lamp is seen that light left (h − t) tan θ + (2k + 1) t tan θ' aside, and its radiance is the \
         same behind both faces but for what they reflect: (1 − R)² R²ᵏ of it comes after k times to and fro.";
    let truth = |name: &str, share: fn(&FresnelPowers, i32) -> f64| {
        Truth::new(name, &Plate::scene(), shown(Plate::irradiance(share)), "(ρ/π) 2πL Σ ∫ (1 − R)² R²ᵏ cos θ sin θ dθ")
            .because(because)
            .confirmed("rings of the lamp", 1e-6, move || shown(Plate::by_rings(share)))
            .or_else("dark", 0.0)
            .or_else("the lamp as seen without the plate's thickness", {
                let rim = (Plate::RADIUS_M / Plate::LAMP_M).atan();
                shown(irradiance(rim, |cosine| (1.0 - fresnel_exact(cosine, INDEX).reflectance()).powi(2)))
            })
            .sees(0.01)
    };
    vec![
        truth("disk-lamp-behind-a-plate", averaged).claims(Claim::AveragesPolarisation),
        truth("disk-lamp-behind-a-plate-in-polarised-light", polarised).claims(Claim::CarriesPolarisation),
    ]
}

/// The same below two lamps, of which the lower hides the middle of the upper. Light that leaves the water beside the lower one comes from the
/// upper one, though it is aimed at the lower.
fn two_lamps_above_water() -> Truth {
    const DEEP_M: f64 = 0.5;
    /// Height above the water, radius and radiance of each.
    const LAMPS: [[f64; 3]; 2] = [[0.5, 0.4, 1.0], [0.7, 0.9, 4.0]];
    let scene = LAMPS.iter().fold(
        Scene::light_meter()
            .object(block([-FAR_M, -FAR_M, -1.0], [FAR_M, FAR_M, DEEP_M]), glass(WATER))
            .object(level_square([0.0, 0.0, -0.5], 0.9 * FAR_M, true), black())
            .spp(1 << 10),
        |scene, &[above, radius, radiance]| {
            scene.lamp(disk([0.0, 0.0, DEEP_M + above], [0.0, 0.0, -1.0], radius), black(), radiance, "front")
        },
    );
    let aside = |above: f64| move |sine: f64| above * tangent(sine) + DEEP_M * tangent(sine / WATER);
    let passes = |cosine: f64| 1.0 - fresnel_exact(cosine, WATER).reflectance();
    let [[lower, lower_radius, dark], [upper, upper_radius, bright]] = LAMPS;
    let rims = [solve(aside(lower), lower_radius).asin(), solve(aside(upper), upper_radius).asin()];
    let value = shown(
        dark * irradiance(rims[0], passes) + bright * (irradiance(rims[1], passes) - irradiance(rims[0], passes)),
    );
    Truth::new("two-disk-lamps-above-water", &scene, value, "(ρ/π) 2π (∫ L₁ (1 − R) cos θ sin θ dθ + ∫ L₂ (1 − R) cos θ sin θ dθ)")
        .because("As below one lamp. The lower lamp fills the directions up to its rim, the upper one those from there to its own.")
        .confirmed("rings of each lamp", 1e-6, move || {
            // Where the upper lamp begins beside the lower.
            let begins = aside(upper)(solve(aside(lower), lower_radius));
            let of_upper = |radius: f64| by_rings(radius, |radius| solve(aside(upper), radius), passes);
            let of_lower = by_rings(lower_radius, |radius| solve(aside(lower), radius), passes);
            shown(dark * of_lower + bright * (of_upper(upper_radius) - of_upper(begins)))
        })
        .or_else("dark", 0.0)
        .or_else("the lower lamp alone", shown(dark * irradiance(rims[0], passes)))
        .or_else("the upper lamp whole", shown(bright * irradiance(rims[1], passes)))
        .sees(0.01)
}

/// The meter lies in water, a lamp hangs above it.
fn above_water() -> Truth {
    const DEEP_M: f64 = 0.5;
    const ABOVE_M: f64 = 0.7;
    const RADIUS_M: f64 = 0.6;
    let scene = Scene::light_meter()
        .object(block([-FAR_M, -FAR_M, -1.0], [FAR_M, FAR_M, DEEP_M]), glass(WATER))
        // What comes back from the ground of the water is not in the formula.
        .object(level_square([0.0, 0.0, -0.5], 0.9 * FAR_M, true), black())
        .lamp(disk([0.0, 0.0, DEEP_M + ABOVE_M], [0.0, 0.0, -1.0], RADIUS_M), black(), 1.0, "front")
        .spp(1 << 10);
    let aside = |sine: f64| ABOVE_M * tangent(sine) + DEEP_M * tangent(sine / WATER);
    let passes = |cosine: f64| 1.0 - fresnel_exact(cosine, WATER).reflectance();
    let value = shown(irradiance(solve(aside, RADIUS_M).asin(), passes));
    Truth::new("disk-lamp-above-water", &scene, value, "(ρ/π) 2πL ∫ (1 − R) cos θ sin θ dθ")
        .because(
            "Radiance is n² times as large in water, and n² cos θ' sin θ' dθ' = cos θ sin θ dθ. The rim of the lamp is seen by the light that \
             leaves it at the angle where h tan θ + d tan θ' is its radius.",
        )
        .confirmed("rings of the lamp", 1e-6, move || {
            shown(by_rings(RADIUS_M, |radius| solve(aside, radius), passes))
        })
        .or_else("dark", 0.0)
        .or_else("radiance not spread by n²", value / (WATER * WATER))
        .or_else("a lamp that is seen straight", shown(irradiance((RADIUS_M / (DEEP_M + ABOVE_M)).atan(), passes)))
        .sees(0.01)
}
