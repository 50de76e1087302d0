//! Media in bodies that move, grow and are placed by instances.

use std::f64::consts::{FRAC_PI_2, PI};

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    media::{boundary, isotropic, medium},
    scene::{Scene, black, block, level_square, sphere},
};
use crate::quadrature::interval;
use crate::transfer::{Fluxes, IsotropicSlab, Slab, henyey_greenstein, legendre_moments};

const WIDE: &str = "light from between the black square and the slab, 2·10⁴ m wide; single precision";

pub(super) fn truths() -> Vec<Truth> {
    let mut list = stretched_slab();
    list.extend([growing_slab(), passing_ball()]);
    list
}

/// A block 2 · 10⁴ m wide whose depth is 1 m until it is placed.
fn block_of(filled: &Value) -> Value {
    json!({ "shape": block([-1e4, -1e4, -1.0], [1e4, 1e4, 0.0]), "material": boundary(filled) })
}

fn view() -> Scene {
    Scene::orthographic([0.0, 0.0, 4.0], [0.0; 3], 1e-3).sky(1.0)
}

/// Half of the depth that a slab needs, drawn out to twice its size by its placement.
fn stretched_slab() -> Vec<Truth> {
    let [half, one, two] = [0.5, 1.0, 2.0].map(fluxes);
    let place = json!([{ "scale": [1, 1, 2] }, { "translate_m": [0.3, 0, 0.5] }]);
    let placed = |scene: Scene| {
        let filled = medium(0.5, 0.0, &isotropic());
        scene
            .whole("groups", json!({ "slab": { "objects": [block_of(&filled)] } }))
            .whole("instances", json!([{ "group": "slab", "transform": place }]))
    };
    let below = level_square([0.0, 0.0, -3.0], 1e4, true);
    let above = level_square([0.0, 0.0, 5.0], 1e4, false);
    [
        ("stretched-slab-reflected", below, one.reflected, half.reflected, two.reflected),
        ("stretched-slab-transmitted", above, one.transmitted, half.transmitted, two.transmitted),
    ]
    .map(|(name, dark, value, unstretched, twice)| {
        Truth::new(name, &placed(view().object(dark, black())), value, "doubling: τ = 1, ϖ = 1")
            .because("An instance of a block of half the depth that is stretched to twice its length is a slab of depth 1: a mean free path is a length of the world.")
            .confirmed("the integral equation for the source function", 1e-5, move || {
                let again = IsotropicSlab::new(1.0, 1.0).of_beam(1.0);
                if name == "stretched-slab-reflected" { again.reflected } else { again.transmitted }
            })
            .or_else("distances in the coordinates of the group", unstretched)
            .or_else("stretched twice", twice)
            .sees(0.04)
            .allows(1e-4, WIDE)
            .no_brighter_than(1.0)
            .claims(Claim::Scattering)
    })
    .into()
}

/// A slab whose depth grows steadily from ¼ to 6 while the shutter is open.
fn growing_slab() -> Truth {
    let (first, last) = (0.25, 6.0);
    let transmitted = |depth: f64| fluxes(depth).transmitted;
    // Gauss's rule of six nodes: the transmittance is smooth in the depth.
    let gauss = [
        (0.238_619_186_083_196_9, 0.467_913_934_572_691),
        (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
        (0.932_469_514_203_152_1, 0.171_324_492_379_170_4),
    ];
    let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
    let both = |x: f64| transmitted(middle - half * x) + transmitted(middle + half * x);
    let value = gauss.iter().map(|&(x, weight)| 0.5 * weight * both(x)).sum::<f64>();
    let stretched = |depth: f64| json!([{ "scale": [1, 1, depth] }]);
    let keys =
        [(0.0, first), (1.0, last)].map(|(time_s, depth)| json!({ "time_s": time_s, "transform": stretched(depth) }));
    let filled = medium(1.0, 0.0, &isotropic());
    let scene = view()
        .shutter([0.0, 1.0])
        .moving(&[block_of(&filled)], &keys)
        .object(level_square([0.0, 0.0, 5.0], 1e4, false), black());
    Truth::new("slab-that-grows-transmitted", &scene, value, "∫ T(τ) dτ/5.75 from ¼ to 6, by doubling")
        .because("A block of fog is drawn out from ¼ m to 6 m. A medium within it stays as dense as it was, so the depth is its length.")
        .confirmed("Simpson's rule of 16 intervals", 2e-4, move || {
            let at = |k: u32| transmitted(first + (last - first) * f64::from(k) / 16.0);
            let weight = |k: u32| if k.is_multiple_of(16) { 1.0 } else if k.is_multiple_of(2) { 2.0 } else { 4.0 };
            (0..=16).map(|k| weight(k) * at(k)).sum::<f64>() / 48.0
        })
        .or_else("as the shutter opens", transmitted(first))
        .or_else("in the middle of the time", transmitted(middle))
        .or_else("as the shutter closes", transmitted(last))
        .sees(0.03)
        .allows(1e-4, WIDE)
        .no_brighter_than(1.0)
        .claims(Claim::Scattering)
        .claims(Claim::WholeFormat)
        .claims(Claim::Motion)
}

/// A ball of dark gas that passes before the eye.
fn passing_ball() -> Truth {
    let dark = 1.3_f64;
    let passed = |x: f64| (-2.0 * dark * (1.0 - x * x).max(0.0).sqrt()).exp();
    let value = interval(passed, 0.0, 1.0, 1e-12).value;
    let moved = |x: f64| json!([{ "translate_m": [x, 0, 0] }]);
    let keys = [(0.0, -1.0), (0.5, 1.0)].map(|(time_s, x)| json!({ "time_s": time_s, "transform": moved(x) }));
    let gas = json!({ "shape": sphere([0.0; 3], 1.0), "material": boundary(&medium(0.0, dark, &isotropic())) });
    let scene = Scene::orthographic([0.0, 0.0, 4.0], [0.0; 3], 1e-6).sky(1.0).shutter([0.0, 0.5]).moving(&[gas], &keys);
    Truth::new("ball-of-dark-gas-passing", &scene, value, "½∫ e^(−2σ√(1 − x²)) dx from −1 to 1, σ = 1.3")
        .because("From the time when its edge touches the line of sight to that when it leaves, the gas takes its share of every chord in turn.")
        .confirmed("midpoints of the angle at which the chord is met", 1e-8, move || {
            // x = sin φ: no root is left whose slope grows without bound.
            let n = 20_000;
            let at = |i: u32| 0.5 * PI * (f64::from(i) + 0.5) / f64::from(n);
            let of = |angle: f64| (-2.0 * dark * angle.cos()).exp() * angle.cos();
            0.5 * PI / f64::from(n) * (0..n).map(|i| of(at(i))).sum::<f64>()
        })
        .or_else("in the middle of the time", passed(0.0))
        .or_else("as the shutter opens", 1.0)
        .or_else("its mean chord", (-dark * FRAC_PI_2).exp())
        .sees(0.02)
        .claims(Claim::WholeFormat)
        .claims(Claim::Motion)
}

/// What becomes of a beam that meets a slab which absorbs nothing.
fn fluxes(depth: f64) -> Fluxes {
    Slab::new(depth, 1.0, &legendre_moments(|x| henyey_greenstein(0.0, x), 96), 1.0).of_beam()
}
