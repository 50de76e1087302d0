//! Diffraction gratings: where each order of each wavelength goes, and how much light it carries.

use serde_json::{Value, json};

use super::{
    Claim, Truth, photometric_weight,
    scene::{Scene, black, disk, level_square, parallelogram},
};
use crate::vector::{Vec3, normalize, scale};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = orders();
    list.extend([spectrum(), disc()]);
    list.extend(furnaces());
    list.into_iter().map(|truth| truth.claims(Claim::Gratings)).collect()
}

/// A band so narrow that it counts as one wavelength, nm.
fn at(wavelength_nm: f64) -> [f64; 2] {
    [wavelength_nm - 5e-4, wavelength_nm + 5e-4]
}

fn grating(period_nm: f64, orders: &[(i32, f64)]) -> Value {
    let orders: Vec<_> =
        orders.iter().map(|(order, efficiency)| json!({ "order": order, "efficiency": efficiency })).collect();
    json!({ "type": "grating", "period_nm": period_nm, "orders": orders })
}

/// A large square at z = 0 that faces up, u along x and v along y, seen in parallel rays that leave it along `wo`.
fn seen(material: Value, wo: Vec3) -> Scene {
    Scene::orthographic(scale(2.0, wo), [0.0; 3], 1e-3)
        .thing(json!({ "shape": level_square([0.0; 3], 10.0, true), "material": material }))
        .film(16, 16)
        .spp(256)
}

/// The same lit by a round lamp of radiance 1 in a direction, 6° wide.
fn lit(material: Value, wo: Vec3, toward: Vec3) -> Scene {
    seen(material, wo).lamp(disk(scale(3.0, toward), scale(-1.0, toward), 0.15), black(), 1.0, "front")
}

/// The direction toward light of an order: what lies along the surface adds up to `waves` times a unit vector across the grooves.
fn toward(wo: Vec3, waves: f64, [gx, gy]: [f64; 2], transmits: bool) -> Vec3 {
    let (x, y) = (waves * gx - wo[0], waves * gy - wo[1]);
    let z = (1.0 - x * x - y * y).sqrt();
    [x, y, if transmits { -z } else { z }]
}

/// The cone about the grooves once more, by angles: light keeps its angle with the grooves, and turns about them such that
/// cos γ (sin α + sin β) = mλ/Λ.
fn by_angles(wo: Vec3, waves: f64, [gx, gy]: [f64; 2], transmits: bool) -> Vec3 {
    // Along the grooves, across them, and up.
    let (along, across) = (-gy * wo[0] + gx * wo[1], gx * wo[0] + gy * wo[1]);
    let gamma = along.asin();
    let alpha = across.atan2(wo[2]);
    let beta = (waves / gamma.cos() - alpha.sin()).asin();
    let (along, across, up) = (-gamma.sin(), gamma.cos() * beta.sin(), gamma.cos() * beta.cos());
    [-gy * along + gx * across, gx * along + gy * across, if transmits { -up } else { up }]
}

const BECAUSE: &str = "Light leaves a grating in its orders alone: along the surface, the directions toward eye and lamp add up to mλ/Λ across the grooves. \
                       There solid angles times cosines are equal, so a lamp of radiance 1 shows the efficiency of the order that leads to it.";

fn orders() -> Vec<Truth> {
    // Order, period, wavelength, toward the eye, rotation of the grooves in degrees, whether it transmits.
    let cases: [(&str, i32, f64, f64, Vec3, f64, bool); 5] = [
        ("grating-in-the-first-order", 1, 1000.0, 520.0, [0.5, 0.0, 0.75_f64.sqrt()], 0.0, false),
        ("grating-in-the-second-order-of-blue", -2, 1600.0, 440.0, [-0.2, 0.0, 0.96_f64.sqrt()], 0.0, false),
        ("grating-across-its-grooves", -1, 1600.0, 600.0, [0.3, 0.4, 0.75_f64.sqrt()], 30.0, false),
        ("grating-that-transmits", 1, 900.0, 480.0, [0.1, -0.3, 0.9_f64.sqrt()], -50.0, true),
        ("grating-in-the-zeroth-order", 0, 1000.0, 520.0, [0.3, 0.4, 0.75_f64.sqrt()], 10.0, false),
    ];
    cases
        .into_iter()
        .map(|(name, order, period_nm, nm, wo, rotation_deg, transmits)| {
            let mut material = grating(period_nm, &[(-2, 0.08), (-1, 0.15), (0, 0.3), (1, 0.22), (2, 0.05)]);
            material["groove_rotation_deg"] = json!(rotation_deg);
            material["reflectance"] = json!(0.8);
            material["light"] = json!(if transmits { "transmitted" } else { "reflected" });
            let value = 0.8 * [0.08, 0.15, 0.3, 0.22, 0.05][(order + 2) as usize];
            let across = [rotation_deg.to_radians().cos(), rotation_deg.to_radians().sin()];
            let waves = f64::from(order) * nm / period_nm;
            let scene = lit(material, wo, toward(wo, waves, across, transmits)).band(at(nm));
            let truth = Truth::new(name, &scene, value, format!("0.8 η, m = {order}, Λ = {period_nm} nm, λ = {nm} nm"))
                .because(BECAUSE)
                .confirmed("the efficiency where the cone about the grooves leads to the lamp", 1e-12, move || {
                    let (a, b) = (toward(wo, waves, across, transmits), by_angles(wo, waves, across, transmits));
                    let apart = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
                    if apart < 1e-12 { value } else { 0.0 }
                })
                .or_else("another direction", 0.0)
                .or_else("the factor left out", value / 0.8)
                .sees(0.02);
            if order == 0 {
                truth
            } else {
                truth.or_else("the opposite order", 0.8 * [0.05, 0.22, 0.3, 0.15, 0.08][(order + 2) as usize])
            }
        })
        .collect()
}

/// Grooves of 1000 nm from above, and a lamp where 500 to 600 nm go.
fn spectrum() -> Truth {
    let x_of = |nm: f64| 2.0 * (1e-3 * nm) / (1.0 - (1e-3 * nm).powi(2)).sqrt();
    let (first, last) = (x_of(500.0), x_of(600.0));
    let scene = seen(grating(1000.0, &[(1, 0.5), (0, 0.2)]), [0.0, 0.0, 1.0])
        .lamp(parallelogram([first, -0.5, 2.0], [0.0, 1.0, 0.0], [last - first, 0.0, 0.0]), black(), 1.0, "front")
        .spp(4096);
    // By trapezoids: the observer is linear between whole nanometres.
    let part = |from: u32, to: u32| -> f64 {
        let all = (from..=to).map(|nm| photometric_weight(f64::from(nm))).sum::<f64>();
        all - 0.5 * (photometric_weight(f64::from(from)) + photometric_weight(f64::from(to)))
    };
    let value = 0.5 * part(500, 600);
    Truth::new("spectrum-of-a-grating", &scene, value, "½ ∫ȳ dλ from 500 to 600 nm, over all of it")
        .because("Seen from straight above, λ = Λ sin θ goes to θ: a lamp between two angles sends the wavelengths between into the eye.")
        .confirmed("by equal steps along the lamp", 1e-5, move || {
            const STEPS: u32 = 200_000;
            let step = (last - first) / f64::from(STEPS);
            let at = |i: u32| {
                let tan = 0.5 * (first + (f64::from(i) + 0.5) * step);
                // λ = Λ tan/√(1 + tan²), and its slope along the lamp.
                let nm = 1000.0 * tan / (1.0 + tan * tan).sqrt();
                photometric_weight(nm) * 500.0 / (1.0 + tan * tan).powf(1.5) * step
            };
            0.5 * (0..STEPS).map(at).sum::<f64>()
        })
        .or_else("grooves twice as wide", 0.0)
        .or_else("all of the light", 0.5)
        .allows(2e-3 * value, "the picture is 1 mm high, and a lamp 2 m away ends by so much elsewhere at each point of it; the edges then blur by 1 nm")
        .claims(Claim::PhotometricSensor)
        .sees(0.01)
}

/// Circular grooves: at a place on a disc light is spread along the radius.
fn disc() -> Truth {
    let (nm, period_nm, turn) = (560.0, 1600.0, 60.0_f64.to_radians());
    let radial = [turn.cos(), turn.sin()];
    let place = [0.5 * radial[0], 0.5 * radial[1], 0.0];
    let wo = normalize([-0.2, 0.1, 0.9]);
    let mut material = grating(period_nm, &[(0, 0.4), (1, 0.25), (-1, 0.1)]);
    material["grooves"] = json!("circles");
    let direction = toward(wo, nm / period_nm, radial, false);
    let from = |direction: Vec3, distance: f64| [0, 1, 2].map(|i| place[i] + distance * direction[i]);
    let scene = Scene::orthographic(from(wo, 2.0), place, 1e-3)
        .thing(json!({ "shape": disk([0.0; 3], [0.0, 0.0, 1.0], 1.0), "material": material }))
        .lamp(disk(from(direction, 3.0), scale(-1.0, direction), 0.15), black(), 1.0, "front")
        .film(16, 16)
        .spp(256)
        .band(at(nm));
    Truth::new(
        "disc-with-circular-grooves",
        &scene,
        0.25,
        "η of m = 1: Λ = 1600 nm, λ = 560 nm, across the grooves along the radius",
    )
    .because(BECAUSE)
    .confirmed("the efficiency where the cone about the grooves leads to the lamp", 1e-12, move || {
        let other = by_angles(wo, nm / period_nm, radial, false);
        let apart = (0..3).map(|i| (direction[i] - other[i]).powi(2)).sum::<f64>().sqrt();
        if apart < 1e-12 { 0.25 } else { 0.0 }
    })
    .or_else("straight grooves", 0.0)
    .or_else("the opposite order", 0.1)
    .sees(0.02)
}

/// Under a sky of 1 a grating shows the efficiencies of the orders that leave it.
fn furnaces() -> Vec<Truth> {
    [(500.0, 0.9, "0.4 + 2 · 0.25"), (750.0, 0.4, "0.4")]
        .into_iter()
        .map(|(nm, value, formula)| {
            let scene = seen(grating(700.0, &[(0, 0.4), (1, 0.25), (-1, 0.25)]), [0.0, 0.0, 1.0]).sky(1.0).band(at(nm));
            Truth::new(format!("grating-under-a-sky-at-{nm}-nanometres"), &scene, value, formula)
                .because("From straight above the first orders of 700 nm grooves leave at sin θ = λ/Λ: above 700 nm there is no such angle.")
                .confirmed("whether the first order has an angle", 1e-12, move || {
                    [-1.0_f64, 0.0, 1.0].iter().filter(|m| !(*m * nm / 700.0).asin().is_nan()).map(|m| if *m == 0.0 { 0.4 } else { 0.25 }).sum()
                })
                .or_else("all orders", if nm > 700.0 { 0.9 } else { 0.4 })
                .no_brighter_than(1.0)
                .sees(5e-3)
        })
        .collect()
}
