//! Media that open sheets of glass state on the side that their normal points into.

use serde_json::{Value, json};

use super::media::{isotropic, medium};
use super::scene::{Scene, black, block, glass, glass_in, level_square};
use super::{Claim, Truth};
use crate::laws::fresnel_exact;
use crate::transfer::{Slab, by_scattering_orders};

const GLASS: f64 = 1.5;
const JUICE: f64 = 1.34;
const PER_M: f64 = 2.0;
/// A wall of glass, and the juice behind it.
const WALL_M: f64 = 0.1;
const DEEP_M: f64 = 0.5;

pub(super) fn truths() -> Vec<Truth> {
    vec![between_walls(), lamp_in_juice(), eye_in_juice(), plate_in_smoke(), milk()]
}

/// A level interface at a height, its front above or below.
fn sheet(scene: Scene, height_m: f64, front_up: bool, material: &Value) -> Scene {
    scene.thing(json!({ "shape": level_square([0.0, 0.0, height_m], 20.0, front_up), "material": material }))
}

/// An interface with this medium on the side of its front.
fn facing(mut material: Value, medium: &Value) -> Value {
    material["exterior_medium"] = medium.clone();
    material
}

fn juice() -> Value {
    json!({ "absorption_per_m": PER_M })
}

/// An eye that looks down, tilted, through the origin, and a lamp of radiance 1 at a height.
fn above_a_lamp(tilt_deg: f64, away_m: f64, lamp_m: f64) -> Scene {
    let (sine, cosine) = tilt_deg.to_radians().sin_cos();
    Scene::orthographic([away_m * sine, 0.0, away_m * cosine], [0.0; 3], 1e-3).lamp(
        level_square([0.0, 0.0, lamp_m], 1e3, true),
        black(),
        1.0,
        "front",
    )
}

/// What a wall lets through and what it reflects on the side of its second face, for the faces' reflectances and what it lets through from face to face.
fn wall(outer: f64, inner: f64, tau: f64) -> [f64; 2] {
    let beams = 1.0 - outer * inner * tau * tau;
    [(1.0 - outer) * (1.0 - inner) * tau / beams, inner + (1.0 - inner).powi(2) * outer * tau * tau / beams]
}

/// Two walls with a layer between them that lets `tau` through.
fn two_walls([through, reflected]: [f64; 2], tau: f64) -> f64 {
    through * through * tau / (1.0 - (reflected * tau).powi(2))
}

/// Light that goes up through layers, each of which lets a share through, with a reflectance below each and above the last: what comes out
/// after many steps from interface to interface.
fn step_by_step(faces: &[f64], layers: &[f64]) -> f64 {
    let (mut up, mut down, mut out) = (vec![0.0; layers.len()], vec![0.0; layers.len()], 0.0);
    up[0] = 1.0 - faces[0];
    for _ in 0..200 {
        let mut next = (vec![0.0; layers.len()], vec![0.0; layers.len()]);
        for (i, tau) in layers.iter().enumerate() {
            let (above, below) = (up[i] * tau, down[i] * tau);
            next.1[i] += above * faces[i + 1];
            next.0[i] += below * faces[i];
            match next.0.get_mut(i + 1) {
                Some(layer) => *layer += above * (1.0 - faces[i + 1]),
                None => out += above * (1.0 - faces[i + 1]),
            }
            if i > 0 {
                next.1[i - 1] += below * (1.0 - faces[i]);
            }
        }
        (up, down) = next;
    }
    out
}

/// Juice that both walls state and that has no surface of its own.
fn between_walls() -> Truth {
    let [outer, inner] = [GLASS, JUICE / GLASS].map(|eta| fresnel_exact(1.0, eta).reflectance());
    let tau = (-PER_M * DEEP_M).exp();
    let (top, bottom) = (-WALL_M, -WALL_M - DEEP_M);
    let (outside, inside) = (glass_in(GLASS, 1.0), facing(glass_in(GLASS, JUICE), &juice()));
    let sheets =
        [(0.0, true, &outside), (top, false, &inside), (bottom, true, &inside), (bottom - WALL_M, false, &outside)];
    let scene = sheets
        .into_iter()
        .fold(above_a_lamp(0.0, 1.0, -2.0), |scene, (height, up, material)| sheet(scene, height, up, material));
    let clear = wall(outer, inner, 1.0);
    let soaked = wall(outer, inner, (-PER_M * WALL_M).exp());
    Truth::new("juice-between-walls-of-glass", &scene, two_walls(clear, tau), "T²τ/(1 − R²τ²), τ = e^(−σd); T, R of a wall of index 1.5 between air and 1.34")
        .because("The inner faces of two walls state what is between them. Beams go to and fro in each wall and between both; on each way through the juice e^(−σd) is left.")
        .confirmed("beams step by step, from interface to interface", 1e-12, move || {
            step_by_step(&[outer, inner, inner, outer], &[1.0, tau, 1.0])
        })
        .or_else("a surface knows no medium outside of it", two_walls(clear, 1.0))
        .or_else("the medium outside taken for that inside", two_walls(soaked, 1.0))
        .or_else("the medium outside taken for that inside, too", two_walls(soaked, tau))
        .sees(0.01)
        .claims(Claim::Absorption)
}

/// A lamp in juice, seen through a wall at an angle.
fn lamp_in_juice() -> Truth {
    const TILT_DEG: f64 = 50.0;
    let (sine, cosine) = TILT_DEG.to_radians().sin_cos();
    let along = |index: f64| (1.0 - (sine / index).powi(2)).sqrt();
    let outer = fresnel_exact(cosine, GLASS).reflectance();
    let inner = fresnel_exact(along(GLASS), JUICE / GLASS).reflectance();
    let tau = (-PER_M * DEEP_M / along(JUICE)).exp();
    let scene = sheet(above_a_lamp(TILT_DEG, 1.0, -WALL_M - DEEP_M), 0.0, true, &glass_in(GLASS, 1.0));
    let scene = sheet(scene, -WALL_M, false, &facing(glass_in(GLASS, JUICE), &juice()));
    let [through, _] = wall(outer, inner, 1.0);
    Truth::new("lamp-in-juice-behind-glass", &scene, through * tau / JUICE.powi(2), "T e^(−σd/cos θ'')/1.34², T of a wall of index 1.5 between air and 1.34")
        .because("From juice to air radiance is divided by n². The juice is known only from the face of the glass that it wets; the lamp reflects nothing.")
        .confirmed("beams step by step, from interface to interface", 1e-12, move || {
            step_by_step(&[inner, outer], &[1.0]) * tau / JUICE.powi(2)
        })
        .or_else("a surface knows no medium outside of it", through / JUICE.powi(2))
        .or_else("no law of n²", through * tau)
        .or_else("n² of the glass", through * tau / GLASS.powi(2))
        .or_else("the depth taken for the way", through * (-PER_M * DEEP_M).exp() / JUICE.powi(2))
        .claims(Claim::Absorption)
        .claims(Claim::AveragesPolarisation)
        .sees(0.005)
}

/// An eye in juice that nothing but the surface before it tells of.
fn eye_in_juice() -> Truth {
    const TILT_DEG: f64 = 30.0;
    let cosine = TILT_DEG.to_radians().cos();
    let r = fresnel_exact(cosine, 1.0 / JUICE).reflectance();
    let tau = (-PER_M * DEEP_M).exp();
    let scene = sheet(above_a_lamp(TILT_DEG, DEEP_M, -1.0), 0.0, true, &facing(glass_in(1.0, JUICE), &juice()));
    let through = (1.0 - r) * JUICE.powi(2);
    let behind = (1.0 - (JUICE * TILT_DEG.to_radians().sin()).powi(2)).sqrt();
    Truth::new("eye-in-juice", &scene, through * tau, "1.34²(1 − R)e^(−σd), d = 0.5 along the sight")
        .because("A ray that meets a surface from without has come through what the surface states there. From air to juice radiance is multiplied by n².")
        .confirmed("a million layers", 1e-6, move || through * (1.0 - PER_M * DEEP_M / 1e6).powi(1_000_000))
        .allows(1e-6, "the eye is 1 mm wide and tilted: means of e^(−σd)")
        .or_else("a surface knows no medium outside of it", through)
        .or_else("no law of n²", (1.0 - r) * tau)
        .or_else("the medium outside taken for that inside", through * (-PER_M / behind).exp())
        .claims(Claim::Absorption)
        .claims(Claim::AveragesPolarisation)
        .sees(0.01)
}

/// Glass in smoke that ends above the lamp. Both the boundary of the smoke and the glass say that it is there.
fn plate_in_smoke() -> Truth {
    const SMOKE: f64 = 0.3;
    let smoke = json!({ "absorption_per_m": SMOKE });
    let slab = |half: f64| block([-20.0, -20.0, -half], [20.0, 20.0, half]);
    let scene = above_a_lamp(0.0, 4.0, -5.0)
        .thing(json!({ "shape": slab(2.0), "material": { "type": "boundary", "medium": smoke, "priority": 1 } }))
        .thing(json!({ "shape": slab(0.25), "material": facing(glass(GLASS), &smoke) }));
    let r = fresnel_exact(1.0, GLASS).reflectance();
    let plate = (1.0 - r) / (1.0 + r);
    let at = |smoke_m: f64| plate * (-SMOKE * smoke_m).exp();
    Truth::new("glass-that-states-the-smoke-around-it", &scene, at(3.5), "(1 − R)/(1 + R) e^(−0.3·3.5)")
        .because("What glass says of its outside ends where the body of smoke ends that holds it, 3 m before the lamp.")
        .confirmed("adding up the beams one by one", 1e-12, move || {
            (0..100).map(|k| (1.0 - r).powi(2) * r.powi(2 * k) * (-SMOKE * 3.5).exp()).sum()
        })
        .or_else("smoke down to the lamp", at(6.5))
        .or_else("smoke in the glass, too", plate * (-SMOKE * 4.0).exp())
        .or_else("no smoke below the glass", at(1.75))
        .or_else("no smoke", plate)
        .sees(0.01)
        .claims(Claim::Absorption)
        .claims(Claim::Priorities)
}

/// A layer of milk between two sheets that refract nothing.
fn milk() -> Truth {
    const ALBEDO: f64 = 0.9;
    let depth = 2.0;
    let white = medium(depth * ALBEDO, depth * (1.0 - ALBEDO), &isotropic());
    let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 1e-3);
    let scene = [(0.0, false), (-1.0, true)].into_iter().fold(scene, |scene, (height, up)| {
        let shape = level_square([0.0, 0.0, height], 1e4, up);
        scene.thing(json!({ "shape": shape, "material": facing(glass_in(1.0, 1.0), &white) }))
    });
    let scene = scene.object(level_square([0.0, 0.0, -2.0], 1e4, true), black()).sky(1.0);
    let reflected = |depth: f64, albedo: f64| Slab::new(depth, albedo, &[1.0], 1.0).of_beam().reflected;
    Truth::new("milk-between-open-sheets", &scene, reflected(depth, ALBEDO), "doubling: τ = 2, ϖ = 0.9")
        .because("By reciprocity an eye sees of light of 1 on one side the share of a beam along its sight that goes to that side. Sheets of an index of 1 do nothing but say what lies before them.")
        .confirmed("the transfer equation, order by order", 2e-4, move || {
            by_scattering_orders(depth, ALBEDO, |_| 1.0)[0].reflected
        })
        .or_else("a surface knows no medium outside of it", 0.0)
        .or_else("scattered once at most", reflected(depth, 1e-3) * ALBEDO / 1e-3)
        .allows(1e-4, "light from between the sheets and the black square, 2·10⁴ m wide")
        .no_brighter_than(1.0)
        .sees(0.02)
        .claims(Claim::Scattering)
}
