//! Sheets that scatter light diffusely to both sides: in furnaces, lit from either side, as lampshades.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Truth,
    scene::{Scene, black, disk, grey_png, level_square, sphere},
};
use crate::vector::Vec3;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = sheets();
    list.extend(before_a_disk());
    list.extend(lampshades());
    list
}

const R: f64 = 0.5;
const T: f64 = 0.3;

fn translucent(reflectance: f64, transmittance: f64) -> Value {
    json!({ "type": "translucent", "reflectance": reflectance, "transmittance": transmittance })
}

/// A level square at the origin, seen from above, 60° off its normal.
fn seen() -> Scene {
    Scene::orthographic([3.0_f64.sqrt(), 0.0, 1.0], [0.0; 3], 0.1).film(16, 16)
}

fn square(material: Value) -> Value {
    json!({ "shape": level_square([0.0; 3], 1.0, true), "material": material })
}

fn sheets() -> Vec<Truth> {
    const TOLD_APART: &str =
        "Of the irradiance E on one side the sheet gives ρE/π back from that side, and τE/π from the other.";
    let furnace = Truth::new(
        "translucent-sheet-in-a-furnace",
        &seen().thing(square(translucent(R, T))).sky(1.0).spp(256),
        R + T,
        "ρ + τ",
    )
    .because("Under a sky of radiance 1 on both sides the sheet gets π from each: it reflects ρ of the one and passes τ of the other.")
    .or_else("nothing passes", R)
    .or_else("nothing is reflected", T)
    .sees(2e-3);
    // Blue is reflected and red is passed: a side that one wavelength never goes to must be found for the others.
    let step = |low: f64, high: f64| json!({ "type": "tabulated", "wavelengths_nm": [360, 555, 556, 830], "values": [low, low, high, high] });
    let parted = json!({ "type": "translucent", "reflectance": step(0.8, 0.0), "transmittance": step(0.0, 0.8) });
    let parted = Truth::new(
        "translucent-sheet-that-parts-colours-in-a-furnace",
        &seen().thing(square(parted)).sky(1.0).spp(1024),
        0.8,
        "ρ + τ, ρ = 0.8 below 555 nm and τ = 0.8 above 556 nm",
    )
    .because("ρ + τ is 0.8 at every wavelength, also between the two where both are interpolated.")
    .or_else("one wavelength chooses the side for all", 0.4)
    .sees(3e-3);
    let (cosine, sine) = (0.75, (1.0_f64 - 0.75 * 0.75).sqrt());
    let lit = |up: f64| seen().directional_light([0.0, sine, up * cosine], PI).spp(64);
    let of_image = json!({
        "type": "translucent", "reflectance": 0.25,
        "transmittance": { "type": "image", "file": "grey-128.png", "encoding": "linear" }
    });
    let texel = 128.0 / 255.0;
    let lit = [
        ("translucent-sheet-lit-from-behind", lit(1.0).thing(square(translucent(R, T))), T, R),
        ("translucent-sheet-lit-from-before", lit(-1.0).thing(square(translucent(R, T))), R, T),
        (
            "translucent-sheet-of-an-image-lit-from-behind",
            lit(1.0).thing(square(of_image)).file("grey-128.png", grey_png(&[128])),
            texel,
            0.25,
        ),
    ]
    .map(|(name, scene, share, other)| {
        Truth::new(name, &scene, share * cosine, "τE cos θ/π from behind, ρE cos θ/π from before, E = π, cos θ = ¾")
            .because(TOLD_APART)
            .confirmed("the radiance of which the flux to that side is the share", 1e-9, move || {
                // A radiance of 1 has a flux of ∫2πµ dµ.
                let flux: f64 = (0..1000).map(|i| 2.0 * PI * (f64::from(i) + 0.5) * 1e-6).sum();
                share * PI * cosine / flux
            })
            .or_else("the share of the other side", other * cosine)
            .or_else("half of it on each side", 0.5 * share * cosine)
            .or_else("the cosine of the light left out", share)
            .sees(2e-3)
    });
    [furnace, parted].into_iter().chain(lit).collect()
}

/// By each way to find a lamp.
fn before_a_disk() -> Vec<Truth> {
    const DISTANCE: f64 = 0.5;
    ["mis", "light", "bsdf"]
        .map(|how| {
            let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 1e-3)
                .thing(square(translucent(R, T)))
                .lamp(disk([0.0, 0.0, -DISTANCE], [0.0, 0.0, 1.0], DISTANCE), black(), 4.0, "front")
                .light_sampling(how)
                .film(16, 16)
                .spp(2048);
            Truth::new(
                format!("translucent-sheet-before-a-disk-lamp-by-{how}"),
                &scene,
                T * 4.0 * 0.5,
                "τL a²/(a² + h²), a = h, L = 4",
            )
            .because("A disk of the radius a at the distance h on the axis gives the irradiance πL a²/(a² + h²); τ/π of it leaves on the far side.")
            .confirmed("rings of the disk", 1e-5, || {
                let ring = |i: u32| {
                    let (width, r) = (DISTANCE / 2000.0, (f64::from(i) + 0.5) * DISTANCE / 2000.0);
                    2.0 * PI * r * width * DISTANCE * DISTANCE / (r * r + DISTANCE * DISTANCE).powi(2)
                };
                T * 4.0 / PI * (0..2000).map(ring).sum::<f64>()
            })
            .or_else("the share that is reflected", R * 4.0 * 0.5)
            .or_else("the sides are chosen evenly, but are weighed as if they were not", T * 4.0 * 0.25)
            .sees(3e-3)
        })
        .into()
}

/// A translucent ball around a lamp is evenly bright inside and outside, also where the lamp is not in the middle: but for its direct light.
fn lampshades() -> Vec<Truth> {
    let from: Vec3 = [0.0, 0.0, 3.0];
    let single = Truth::new(
        "translucent-ball-around-a-lamp",
        &Scene::orthographic(from, [0.0; 3], 0.2)
            .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": translucent(R, T) }))
            .point_light([0.0; 3], PI)
            .film(16, 16)
            .spp(512),
        T / (1.0 - R),
        "τI/(πr²(1 − ρ)), I = π, r = 1",
    )
    .because(
        "A sphere lights itself evenly: inside, E = I/r² + ρE. Each point of the wall sends τE/π out, to where no other part of it is.",
    )
    .confirmed("adding up the passages", 1e-9, || (0..60).map(|k| T * R.powi(k)).sum())
    .or_else("only direct light", T)
    .or_else("what is reflected outside counts, too", T / (1.0 - R - T))
    .sees(3e-3);
    let (inner, outer) = (0.5_f64, [0.4, 0.5]);
    // Of what leaves the inside of the outer ball, the inner one gets its share of area.
    let share = inner * inner;
    let first = PI / (inner * inner);
    let within = move || {
        // Irradiance on the inside and the outside of the inner ball and on the inside of the outer one:
        // a = E + ρa + τb, b = c', c = share (ρb + τa) + (1 − share) c', c' = ρ₂c.
        let [rho, _] = outer;
        let per_c = rho;
        // a(1 − ρ) = E + τ ρ₂ c, and c(1 − (1 − share) ρ₂ − share ρ ρ₂) = share τ a.
        let k = 1.0 - (1.0 - share) * per_c - share * R * per_c;
        let a = first / (1.0 - R - T * per_c * share * T / k);
        share * T * a / k
    };
    let nested = Truth::new(
        "translucent-ball-in-a-translucent-ball",
        &Scene::orthographic(from, [0.0; 3], 0.2)
            .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": translucent(outer[0], outer[1]) }))
            .thing(json!({ "shape": sphere([0.0; 3], inner), "material": translucent(R, T) }))
            .point_light([0.0; 3], PI)
            .film(16, 16)
            .spp(1024),
        outer[1] * within() / PI,
        "τ₂c/π from the three irradiances of the two balls",
    )
    .because(
        "Every one of the three walls is evenly bright. The inner ball sees only the outer one, and the outer one sees the inner one with the \
         share r₁²/r₂² of its view. So the three irradiances obey three linear equations.",
    )
    .confirmed("following the light from wall to wall, 400 times", 1e-9, move || {
        let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
        for _ in 0..400 {
            let back = outer[0] * c;
            (a, b, c) = (first + R * a + T * b, back, share * (R * b + T * a) + (1.0 - share) * back);
        }
        outer[1] * c / PI
    })
    .or_else("the inner ball lets nothing back in", {
        let [rho, tau] = outer;
        let a = first / (1.0 - R);
        tau * share * T * a / (1.0 - (1.0 - share) * rho - share * R * rho) / PI
    })
    .sees(5e-3);
    vec![single, nested]
}
