//! Scattering matrices from tables: what polarised light becomes that is scattered once by a right angle.
//!
//! Expectations follow the field itself: amplitudes S₁ across the plane of scattering and S₂ within it, of waves e^(−iωt) (Bohren & Huffman
//! 1983, eq. 3.12). The scene is given the matrix that they make (eq. 3.16).

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::media::{boundary, medium};
use super::scene::{Scene, block, parallelogram};
use super::{Claim, Quantity, Truth};

/// A complex number: its real and its imaginary part.
type Complex = [f64; 2];

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

fn phase(degrees: f64) -> Complex {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [cos, sin]
}

/// What scatters: amplitudes at a right angle, and the light that it scatters beside, unpolarised, over F₁₁ of the amplitudes. `turned` is the
/// amplitude by which the field across goes on within the plane, and that within across it: of grains and their mirror images, as many of
/// either sign.
#[derive(Clone, Copy)]
struct Particle {
    across: Complex,
    within: Complex,
    turned: f64,
    beside: f64,
}

impl Particle {
    /// F₁₁, F₁₂, F₂₂, F₃₃, F₃₄ and F₄₄.
    fn matrix(&self) -> [f64; 6] {
        let squared = |z: Complex| z[0] * z[0] + z[1] * z[1];
        let [s1, s2] = [squared(self.across), squared(self.within)];
        let product = times(self.across, [self.within[0], -self.within[1]]);
        let (mean, turned) = (0.5 * (s1 + s2), self.turned * self.turned);
        [
            (mean + turned) * (1.0 + self.beside),
            0.5 * (s2 - s1),
            mean - turned,
            product[0] + turned,
            -product[1],
            product[0] - turned,
        ]
    }

    /// A table that has this matrix at a right angle, and passes all light on as it is forward and back.
    fn table(&self) -> Value {
        let at = self.matrix();
        let row = |k: usize, end: f64| json!([end, at[k], end]);
        json!({
            "type": "tabulated", "angles_deg": [0, 90, 180], "values": row(0, 1.0), "f12": row(1, 0.0), "f22": row(2, 1.0),
            "f33": row(3, 1.0), "f34": row(4, 0.0), "f44": row(5, 1.0),
        })
    }

    /// The table's value at a right angle, sr⁻¹.
    fn density(&self) -> f64 {
        let [f11, ..] = self.matrix();
        f11 / (2.0 * PI * (1.0 + f11))
    }

    /// The same by Bohren & Huffman's matrix, over F₁₁: of light of intensity 1 whose Q, U and V these are in the plane of scattering. The picture's
    /// right is the opposite of the field's direction within that plane, which turns the sign of U.
    fn times_stokes(&self, [q, u, v]: [f64; 3]) -> [f64; 4] {
        let [f11, f12, f22, f33, f34, f44] = self.matrix();
        [f11 + f12 * q, f12 + f22 * q, -(f33 * u + f34 * v), f44 * v - f34 * u].map(|s| s / f11)
    }

    /// S₀ to S₃ in a picture whose rows lie within the plane of scattering, for light of intensity 1 whose field this is across that plane
    /// and within it.
    fn scattered(&self, [across, within]: [Complex; 2]) -> [f64; 4] {
        let [f11, ..] = self.matrix();
        let mean = f11 / (1.0 + self.beside);
        let of_sign = |sign: f64| {
            let with = |own: Complex, other: Complex| {
                [own[0] + sign * self.turned * other[0], own[1] + sign * self.turned * other[1]]
            };
            // Seen from where it goes, the field within the plane points to the left.
            let left = with(times(within, self.within), across);
            let up = with(times(across, self.across), within);
            let right = [-left[0], -left[1]];
            let squared = |z: Complex| z[0] * z[0] + z[1] * z[1];
            let product = times(right, [up[0], -up[1]]);
            [
                squared(right) + squared(up) + mean * self.beside,
                squared(right) - squared(up),
                2.0 * product[0],
                2.0 * product[1],
            ]
        };
        let [one, other] = [1.0, -1.0].map(of_sign);
        [0, 1, 2, 3].map(|k| 0.5 * (one[k] + other[k]) / f11)
    }
}

const DEPTH: f64 = 0.5;
const PER_M: f64 = 0.4;
/// Sheets before the air, 2 m in size.
fn sheet(x: f64) -> Value {
    parallelogram([x, -1.0, -1.25], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0])
}

pub(super) fn truths() -> Vec<Truth> {
    let sphere = Particle { across: [1.0, 0.0], within: times([0.6, 0.0], phase(50.0)), turned: 0.0, beside: 0.0 };
    let grain = Particle { beside: 0.7, ..sphere };
    let turning = Particle { turned: 0.8, ..sphere };
    let half = 0.5_f64.sqrt();
    // Light along x, seen along z. Its field across the plane of scattering lies along y, that within it along z.
    let slanting = json!({ "type": "polariser", "axis": [0, 1, 1] });
    let across = json!({ "type": "polariser", "axis": [0, 1, 0] });
    // It delays what swings within the plane by a quarter of a period.
    let quarter = json!({ "type": "retarder", "axis": [0, 1, 0], "retardance_deg": 90 });
    let [one, none, part] = [[1.0, 0.0], [0.0, 0.0], [half, 0.0]];
    let mut list = Vec::new();
    for (name, particle, sheets, field, stokes) in [
        (
            "circular-light-scattered-by-spheres",
            sphere,
            vec![quarter.clone(), slanting.clone()],
            [part, times(part, phase(90.0))],
            [0.0, 0.0, -1.0],
        ),
        (
            "circular-light-scattered-by-grains-that-turn-it",
            turning,
            vec![quarter, slanting.clone()],
            [part, times(part, phase(90.0))],
            [0.0, 0.0, -1.0],
        ),
        ("slanting-light-scattered-by-spheres", sphere, vec![slanting.clone()], [part, part], [0.0, 1.0, 0.0]),
        ("light-across-scattered-by-grains", grain, vec![across], [one, none], [-1.0, 0.0, 0.0]),
        ("slanting-light-scattered-by-grains", grain, vec![slanting], [part, part], [0.0, 1.0, 0.0]),
    ] {
        let seen = particle.scattered(field);
        // Half of the irradiance passes the polariser; the light comes to a slab of endless height through 0.5 m of it.
        let by_depths = move || {
            let n = 20_000;
            let step = DEPTH / f64::from(n);
            let sent = (0..n).map(|i| PER_M * step * (-PER_M * (f64::from(i) + 0.5) * step).exp()).sum::<f64>();
            0.5 * PI * particle.density() * sent * (-PER_M * 0.5_f64).exp()
        };
        let single = 0.5 * particle.density() * PI * (1.0 - (-PER_M * DEPTH).exp()) * (-PER_M * 0.5_f64).exp();
        // Two sheets are harder to find a way through than one.
        let sees = if sheets.len() > 1 { 0.1 } else { 0.05 };
        let deepest = 2 + sheets.len() as u32;
        let mut scene = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 1e-3)
            .thing(json!({
                "shape": block([-0.5, -0.9, -DEPTH], [0.5, 0.9, 0.0]), "material": boundary(&medium(PER_M, 0.0, &particle.table())),
            }))
            .directional_light([1.0, 0.0, 0.0], PI)
            .depth(deepest)
            .film(8, 8)
            .spp(64)
            .set("film", "stokes", json!(true));
        for (number, material) in sheets.into_iter().enumerate() {
            scene = scene.thing(json!({ "shape": sheet(-1.0 - number as f64), "material": material }));
        }
        for (k, quantity) in
            [Quantity::Radiance, Quantity::Stokes1, Quantity::Stokes2, Quantity::Stokes3].into_iter().enumerate()
        {
            let value = single * seen[k];
            if k > 0 && seen[k].abs() < 1e-6 {
                continue;
            }
            let name = if k == 0 { name.to_owned() } else { format!("{name}-s{k}") };
            let truth = Truth::new(name, &scene, value, "p(90°) E/2 ∫ e^(−σs) σ ds e^(−σa) over the field's S")
                .because(
                    "Spheres multiply the field across the plane of scattering and that within it by two complex numbers; grains of any \
                     orientation add light that is not polarised.",
                )
                .confirmed("the Stokes vector times the matrix, depth by depth", 1e-8, move || {
                    by_depths() * particle.times_stokes(stokes)[k]
                })
                .reads(quantity)
                .claims(Claim::CarriesPolarisation)
                .claims(Claim::SpecularConnections)
                .claims(Claim::Scattering)
                .allows(1e-5 * single, "single precision; the picture is 1 mm wide")
                .sees(sees);
            let [.., f33, _, f44] = particle.matrix();
            list.push(match k {
                0 => truth.or_else("nothing comes through the sheets", 0.0),
                3 if f33 != f44 => {
                    truth.or_else("F₄₄ taken for F₃₃", value * f33 / f44).or_else("light not polarised", 0.0)
                }
                _ => truth.or_else("the other sign", -value).or_else("light not polarised", 0.0),
            });
        }
    }
    list
}
