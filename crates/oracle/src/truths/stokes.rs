//! S₁, S₂ and S₃ of the light that arrives, each with its sign.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use super::{
    Claim, Quantity, Truth, companions,
    companions::Light,
    scene::{Scene, black, conductor, disk, glass, level_square},
};
use crate::laws::fresnel_exact;
use crate::vector::{Vec3, scale};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = polariser();
    list.extend(retarder());
    list.extend(reflection());
    let mut list: Vec<Truth> = list.into_iter().map(|truth| truth.claims(Claim::CarriesPolarisation)).collect();
    list.extend(metal());
    list.extend(companions::truths());
    list
}

pub(super) const PARAMETERS: [Quantity; 3] = [Quantity::Stokes1, Quantity::Stokes2, Quantity::Stokes3];

/// S₁, S₂ and S₃ of a field (x to the right, y up, seen against the light) whose intensity is 1 at amplitude 1, by its values over a period.
/// A field that turns clockwise has x·dy/dt − y·dx/dt below 0.
pub(super) fn stokes_of(field: impl Fn(f64) -> [f64; 2]) -> [f64; 3] {
    const STEPS: u32 = 4096;
    let at = |i: u32| field(TAU * f64::from(i) / f64::from(STEPS));
    let mut sums = [0.0; 3];
    for i in 0..STEPS {
        let ([x, y], [next_x, next_y]) = (at(i), at(i + 1));
        sums[0] += x * x - y * y;
        sums[1] += 2.0 * x * y;
        // The area of the triangle that the field sweeps, over that of the chord's arc.
        sums[2] -= (x * next_y - y * next_x) / (TAU / f64::from(STEPS)).sin();
    }
    sums.map(|sum| sum / f64::from(STEPS))
}

/// A direction in the sheet at this angle from the right upward.
fn axis(degrees: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!([cos, sin, 0.0])
}

/// Sheets from the nearest to the farthest, seen from above with x to the right, and a lamp of radiance 1 behind them.
fn sheets(sheets: &[Value]) -> Scene {
    let first = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1).up([0.0, 1.0, 0.0]).film(4, 4).spp(4096).set(
        "film",
        "stokes",
        json!(true),
    );
    let square = |k: usize| level_square([0.0, 0.0, 1.0 - 0.2 * k as f64], 1.0, true);
    sheets
        .iter()
        .enumerate()
        .fold(first, |scene, (k, sheet)| scene.thing(json!({ "shape": square(k), "material": sheet })))
        .lamp(level_square([0.0, 0.0, -1.0], 1.0, true), black(), 1.0, "front")
}

/// A truth for each parameter that is not 0, and its sign among the mistakes.
fn each(name: &str, scene: &Scene, values: [f64; 3], formulas: [&str; 3], because: &'static str) -> Vec<Truth> {
    (0..3)
        .map(|i| {
            let value = values[i];
            let truth = Truth::new(format!("{name}-s{}", i + 1), scene, value, formulas[i])
                .because(because)
                .reads(PARAMETERS[i])
                .sees(5e-3);
            if value == 0.0 {
                truth.or_else("half of the light", 0.25)
            } else {
                truth.or_else("the other sign", -value)
            }
        })
        .collect()
}

fn polariser() -> Vec<Truth> {
    let angle = 20.0_f64;
    let scene = sheets(&[json!({ "type": "polariser", "axis": axis(angle) })]);
    let twice = (2.0 * angle).to_radians();
    let values = [0.5 * twice.cos(), 0.5 * twice.sin(), 0.0];
    each("polariser-at-20-degrees", &scene, values, ["½ cos 40°", "½ sin 40°", "0"], "Behind a polariser the light swings along its axis, at an angle ψ to the rows of the picture: S₁ = S₀ cos 2ψ, S₂ = S₀ sin 2ψ.")
        .into_iter()
        .enumerate()
        .map(|(i, truth)| {
            let truth = match i {
                0 => truth.or_else("turned by the angle, not by twice the angle", 0.5 * angle.to_radians().cos()),
                1 => truth.or_else("turned by the angle, not by twice the angle", 0.5 * angle.to_radians().sin()),
                _ => return truth,
            };
            truth.confirmed("the field over a period", 1e-9, move || {
                let (sin, cos) = angle.to_radians().sin_cos();
                // Half of the light, whose mean square over a period is ½ of its amplitude's.
                stokes_of(|phase| [cos * phase.cos(), sin * phase.cos()])[i]
            })
        })
        .collect()
}

fn retarder() -> Vec<Truth> {
    let (fast, delay) = (30.0_f64, 60.0_f64);
    let plate = json!({ "type": "retarder", "axis": axis(fast), "retardance_deg": delay });
    let scene = sheets(&[plate, json!({ "type": "polariser", "axis": axis(0.0) })]);
    let (twice, delay) = ((2.0 * fast).to_radians(), delay.to_radians());
    let (sin, cos) = twice.sin_cos();
    let values =
        [0.5 * (cos * cos + sin * sin * delay.cos()), 0.5 * sin * cos * (1.0 - delay.cos()), 0.5 * sin * delay.sin()];
    let formulas = ["½(cos² 60° + sin² 60° cos 60°)", "½ sin 60° cos 60° (1 − cos 60°)", "½ sin 60° sin 60°"];
    each("wave-plate", &scene, values, formulas, "Light along the rows meets a plate whose fast axis is at φ above them, and which delays the part across it by δ: in the plate's axes \
         (S₁, S₂, S₃) = (cos 2φ, −sin 2φ cos δ, sin 2φ sin δ), turned back by 2φ. The part along the fast axis is ahead, and the field turns from \
         there clockwise, the shorter way to what lags behind with the opposite sign.")
        .into_iter()
        .enumerate()
        .map(|(i, truth)| {
            let truth = truth.confirmed("the field over a period", 1e-6, move || {
                let (sin, cos) = fast.to_radians().sin_cos();
                // The parts along the axes at (cos, sin) and (−sin, cos); the second lags.
                stokes_of(|phase| {
                    let (first, second) = (cos * phase.cos(), -sin * (phase - delay).cos());
                    [first * cos - second * sin, first * sin + second * cos]
                })[i]
            });
            match i {
                0 => truth.or_else("the plate left out", 0.5),
                1 => truth.or_else("the plate left out", 0.0),
                _ => truth.or_else("a quarter of a wave", 0.5 * sin),
            }
        })
        .collect()
}

/// A pane of glass over black, seen at 70° by a camera that is rolled by 25°.
fn reflection() -> Vec<Truth> {
    let (incidence, roll) = (70.0_f64.to_radians(), 25.0_f64.to_radians());
    let (sin, cos) = incidence.sin_cos();
    // In the plane of y and z. Without roll the picture's right is x, and its upper side (0, cos, sin).
    let up = [roll.sin(), roll.cos() * cos, roll.cos() * sin];
    let scene = Scene::orthographic([0.0, -2.0 * sin, 2.0 * cos], [0.0; 3], 0.1)
        .up(up)
        .film(4, 4)
        .spp(4096)
        .set("film", "stokes", json!(true))
        .object(level_square([0.0; 3], 10.0, true), glass(1.5))
        .object(level_square([0.0, 0.0, -0.1], 10.0, true), black())
        .sky(1.0);
    let fresnel = fresnel_exact(incidence.cos(), 1.5);
    let more = 0.5 * (fresnel.r_s - fresnel.r_p);
    let values = [more * (2.0 * roll).cos(), more * (2.0 * roll).sin(), 0.0];
    each("glass-seen-by-a-rolled-camera", &scene, values, ["½(R_s − R_p) cos 50°", "½(R_s − R_p) sin 50°", "0"], "Of unpolarised light a surface sends back R_s across the plane of incidence and R_p in it. Across it is x, which lies at the roll's angle \
         above the rows of the picture.")
        .into_iter()
        .enumerate()
        .map(|(i, truth)| match i {
            0 => truth.or_else("the roll left out", more).confirmed("Fresnel's amplitudes", 1e-9, move || {
                let cos_t = (1.0 - (sin / 1.5).powi(2)).sqrt();
                let s = ((cos - 1.5 * cos_t) / (cos + 1.5 * cos_t)).powi(2);
                let p = ((1.5 * cos - cos_t) / (1.5 * cos + cos_t)).powi(2);
                0.5 * (s - p) * (roll.cos().powi(2) - roll.sin().powi(2))
            }),
            1 => truth.or_else("the roll left out", 0.0),
            _ => truth,
        })
        .collect()
}

/// Light at 45° to the plane of incidence, reflected at 60° by a metal whose phases show in S₂ and S₃.
fn metal() -> Vec<Truth> {
    let (n, k, cos) = (0.6_f64, 2.4_f64, 0.5_f64);
    let (half, sin) = (std::f64::consts::FRAC_1_SQRT_2, (1.0 - cos * cos).sqrt());
    let toward: Vec3 = [0.0, sin, cos];
    // The camera's right is x, which is s; upward is p. Seen against the light that arrives, p is on the other side.
    let scene = Scene::orthographic([0.0, -2.0 * sin, 2.0 * cos], [0.0; 3], 0.1)
        .up([0.0, cos, sin])
        .film(4, 4)
        .spp(4096)
        .set("film", "stokes", json!(true))
        .object(level_square([0.0; 3], 10.0, true), conductor(n, k))
        .thing(json!({
            "shape": disk(toward, toward, 1.0),
            "material": { "type": "polariser", "axis": [half, -half * cos, half * sin] },
        }))
        .lamp(disk(scale(1.5, toward), scale(-1.0, toward), 2.0), black(), 1.0, "front");
    // q² = (n + ik)² − sin²θ, q = a + ib.
    let (re, im) = (n * n - k * k - sin * sin, 2.0 * n * k);
    let a = (0.5 * (re.hypot(im) + re)).sqrt();
    let b = 0.5 * im / a;
    let over = |[x, y]: [f64; 2], [u, v]: [f64; 2]| {
        let square = u * u + v * v;
        [(x * u + y * v) / square, (y * u - x * v) / square]
    };
    let (m_re, m_im) = ((n * n - k * k) * cos, im * cos);
    let (s, p) = (over([cos - a, -b], [cos + a, b]), over([m_re - a, m_im - b], [m_re + a, m_im + b]));
    let square = |[x, y]: [f64; 2]| x * x + y * y;
    let product = [s[0] * p[0] + s[1] * p[1], s[1] * p[0] - s[0] * p[1]];
    let base = Truth::new("polarised-light-on-metal", &scene, 0.0, "").claims(Claim::CarriesPolarisation);
    let light = Light {
        stokes: [0.25 * (square(s) - square(p)), 0.5 * product[0], 0.5 * product[1]],
        formula: "¼(|r_s|² − |r_p|²), ½ Re r_s r_p*, ½ Im r_s r_p*",
        because: "Behind a polariser at 45° to the plane of incidence s and p have equal amplitudes. The metal multiplies them by r_s and r_p: \
                  S₂ + iS₃ = 2E_xE_y* in fields that run as e^(−iωt).",
        mistakes: &[
            ("a perfect conductor", [0.0, -0.5, 0.0]),
            ("reflected without phases", [0.25 * (square(s) - square(p)), -0.5 * (square(s) * square(p)).sqrt(), 0.0]),
        ],
        sees: 0.01,
        how: ("the field over a period, r_p from r_p/r_s = (sin² θ − q cos θ)/(sin² θ + q cos θ)", 1e-6),
    };
    companions::companions(&base, &light, move || {
        let r_s = (((a - cos).powi(2) + b * b) / ((a + cos).powi(2) + b * b)).sqrt();
        let ratio = over([sin * sin - a * cos, -b * cos], [sin * sin + a * cos, b * cos]);
        stokes_of(|phase| [half * r_s * phase.cos(), half * r_s * (ratio[0] * phase.cos() + ratio[1] * phase.sin())])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_that_turns_clockwise_is_right_handed() {
        let [s1, s2, s3] = stokes_of(|phase| [phase.cos(), -phase.sin()]);
        assert!(s1.abs() < 1e-9 && s2.abs() < 1e-9 && (s3 - 1.0).abs() < 1e-9, "{s1}, {s2}, {s3}");
    }
}
