//! Furnaces with media: what scatters without loss changes nothing where all light is alike. And media of changing density that glow.

use std::f64::consts::FRAC_PI_2;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    media::{ball, boundary, forward, framed, isotropic, medium, vol},
    scene::{Scene, block, cylinder, glass, rough_glass, solid, sphere, triangular_prism},
};
use crate::quadrature::interval;
use crate::transfer::ball_transmittance;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = balls();
    list.extend([box_in_a_furnace(), rod_in_a_furnace(), mesh_in_a_furnace()]);
    list.extend([glowing_smoke(), glowing_air()]);
    list
}

const LOST: &str = "scattered light is lost";

/// A scene in which all light has the radiance 1.
fn truth(name: &str, scene: Scene) -> Truth {
    Truth::new(name, &scene.spp(64), 1.0, "1")
        .because("Where all light has the radiance 1, scattering without loss changes nothing.")
        .sees(0.01)
        .no_brighter_than(1.0)
}

/// Balls, most of them seen as a disk in a square picture.
fn balls() -> Vec<Truth> {
    let double = json!({ "type": "double-henyey-greenstein", "g": [0.85, -0.3], "weight": 0.8 });
    let table = json!({ "type": "tabulated", "angles_deg": [0, 30, 90, 180], "values": [9, 2, 0.5, 1] });
    let rayleigh = json!({ "type": "rayleigh" });
    let of_phase = |name: &str, phase: &Value| {
        truth(name, ball(boundary(&medium(2.0, 0.0, phase)))).or_else(LOST, framed(ball_transmittance(2.0)))
    };
    let within = |name: &str, mut material: Value| {
        material["medium"] = medium(4.0, 0.0, &forward(0.5));
        truth(name, ball(material))
    };
    let mut dense = medium(2.0, 0.0, &forward(0.6));
    dense["density"] = json!({ "type": "grid", "file": "smoke.vol", "scale": 2.5,
        "transform": [{ "translate_m": [0.1, 0, 0] }, { "scale": 1.5 }] });
    let numbers: Vec<f32> = (0..60_u16).map(|i| f32::from(i * 7 % 11)).collect();
    let smoke = vol([3, 4, 5], [[-1.0; 3], [1.0; 3]], &numbers);
    let mut air = medium(3.0, 0.0, &isotropic());
    air["density"] = json!({ "type": "exponential", "scale_height_m": 0.5, "base_m": [0, -1, 0], "up": [0, 2, 1] });
    let inside = Scene::orthographic([0.0; 3], [0.0, 0.0, -1.0], 0.1)
        .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": boundary(&medium(3.0, 0.0, &forward(-0.4))) }));
    let nested = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0)
        .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": solid(1.5, 1) }))
        .thing({
            let mut milk = solid(1.33, 2);
            milk["medium"] = medium(5.0, 0.0, &forward(0.7));
            json!({ "shape": sphere([0.2, 0.0, 0.0], 0.7), "material": milk })
        })
        .sky(1.0);
    vec![
        of_phase("fog-in-a-furnace", &isotropic()),
        of_phase("forward-fog-in-a-furnace", &forward(0.8)),
        of_phase("two-peaked-fog-in-a-furnace", &double),
        of_phase("air-in-a-furnace", &rayleigh),
        of_phase("fog-of-a-table-in-a-furnace", &table),
        truth("smoke-of-a-grid-in-a-furnace", ball(boundary(&dense)).file("smoke.vol", smoke)),
        truth("thinning-air-in-a-furnace", ball(boundary(&air))),
        truth("eye-in-fog-in-a-furnace", inside.sky(1.0)),
        within("milk-in-glass-in-a-furnace", glass(1.5)).claims(Claim::AveragesPolarisation),
        within("milk-in-rough-glass-in-a-furnace", rough_glass(1.5, 0.3))
            .allows(2e-3, "tables of what facets lose err by up to 5e-4 at each of a few crossings; single precision")
            .claims(Claim::AveragesPolarisation)
            .claims(Claim::LosslessRoughGlass),
        truth("milk-by-priority-in-a-furnace", nested).claims(Claim::AveragesPolarisation).claims(Claim::Priorities),
    ]
}

/// A body that fills a square picture of 2 m, under a sky of 1. The eye looks down on it.
fn filling(shape: &Value, filled: &Value) -> Scene {
    Scene::orthographic([0.0, 0.0, 9.0], [0.0; 3], 2.0)
        .thing(json!({ "shape": shape, "material": boundary(filled) }))
        .sky(1.0)
}

fn box_in_a_furnace() -> Truth {
    let scene = filling(&block([-1.5, -1.2, -0.6], [1.1, 2.0, 0.4]), &medium(1.5, 0.0, &forward(0.7)));
    truth("box-of-forward-fog-in-a-furnace", scene).or_else(LOST, (-1.5_f64).exp())
}

/// A rod along x: above y it is 2√(1 − y²) thick.
fn rod_in_a_furnace() -> Truth {
    let scene = filling(&cylinder([-2.0, 0.0, 0.0], [2.0, 0.0, 0.0], 1.0), &medium(1.0, 0.0, &forward(-0.5)));
    // y = sin φ.
    let passed = interval(|angle| angle.cos() * (-2.0 * angle.cos()).exp(), 0.0, FRAC_PI_2, 1e-12).value;
    truth("rod-of-backward-fog-in-a-furnace", scene).or_else(LOST, passed)
}

/// A prism along z, of triangles.
fn mesh_in_a_furnace() -> Truth {
    let prism = triangular_prism([[-4.0, -2.0], [4.0, -2.0], [0.0, 5.0]], [-0.5, 0.5]);
    let scene = filling(&prism, &medium(2.0, 0.0, &json!({ "type": "rayleigh" })));
    truth("mesh-of-air-in-a-furnace", scene).or_else(LOST, (-2.0_f64).exp())
}

/// Hot matter from z = −1 to 1, whose density changes with height alone, before a black background. `files` are what `density` names.
fn glowing(
    name: &str,
    density: Value,
    files: &[(&str, Vec<u8>)],
    of_height: impl Fn(f64) -> f64 + Send + Sync + Copy + 'static,
) -> Truth {
    const PER_M: f64 = 0.8;
    let column = move |from: f64| interval(of_height, from, 1.0, 1e-12).value;
    let depth = PER_M * column(-1.0);
    let hot = json!({ "absorption_per_m": PER_M, "source_radiance": 2.0, "density": density });
    let scene = Scene::orthographic([0.0, 0.0, 9.0], [0.0; 3], 1e-3)
        .thing(json!({ "shape": block([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0]), "material": boundary(&hot) }));
    let scene = files.iter().fold(scene, |scene, (name, bytes)| scene.file(name, bytes.clone()));
    Truth::new(name, &scene, -2.0 * (-depth).exp_m1(), "B(1 − e^(−σx)), x the column of the density, B = 2, σ = 0.8/m")
        .because("Matter of one temperature shows its source radiance as far as it lets nothing through, wherever it is dense.")
        .confirmed("a sum over heights of what each sends up", 1e-6, move || {
            let n = 4000;
            let step = 2.0 / f64::from(n);
            let sent = |z: f64| PER_M * of_height(z) * 2.0 * (-PER_M * column(z)).exp();
            step * (0..n).map(|i| sent(-1.0 + (f64::from(i) + 0.5) * step)).sum::<f64>()
        })
        .or_else("the same density everywhere, for what shines and what absorbs", -2.0 * (-2.0 * PER_M).exp_m1())
        .or_else("what shines is not absorbed on its way", 2.0 * depth)
        .sees(5e-3)
}

/// Two layers of cells, whose middles lie at z = ±½.
fn glowing_smoke() -> Truth {
    let file = vol([1, 1, 2], [[-2.0, -2.0, -1.0], [2.0, 2.0, 1.0]], &[1.6, 0.3]);
    let density = json!({ "type": "grid", "file": "hot-layers.vol" });
    glowing("glowing-smoke-of-a-grid", density, &[("hot-layers.vol", file)], |z| 1.6 - 1.3 * (z + 0.5).clamp(0.0, 1.0))
}

fn glowing_air() -> Truth {
    let density = json!({ "type": "exponential", "scale_height_m": 0.7, "base_m": [0, 0, -1], "up": [0, 0, 1] });
    glowing("glowing-air-that-thins-upward", density, &[], |z| (-(z + 1.0) / 0.7).exp())
}
