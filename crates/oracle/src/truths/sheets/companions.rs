//! S₁, S₂ and S₃ of light behind the same sheets, and of the same without the sheet next to the eye.

use serde_json::Value;

use crate::truths::Truth;
use crate::truths::companions::{Light, companions, keeping_stokes};
use crate::truths::stokes::stokes_of;

type Mistakes = Vec<(&'static str, [f64; 3])>;

/// A sheet as this module reckons with it: its axis from x toward y.
#[derive(Clone, Copy)]
enum Sheet {
    Polariser { degrees: f64, transmittance: f64, extinction: f64 },
    Retarder { degrees: f64, delay_deg: f64 },
}

const fn polariser(degrees: f64) -> Sheet {
    Sheet::Polariser { degrees, transmittance: 1.0, extinction: 0.0 }
}

const fn grey(degrees: f64) -> Sheet {
    Sheet::Polariser { degrees, transmittance: 0.8, extinction: 0.1 }
}

const fn plate(degrees: f64, delay_deg: f64) -> Sheet {
    Sheet::Retarder { degrees, delay_deg }
}

/// S₁, S₂ and S₃ of a lamp of radiance 1 behind sheets, the first next to the eye: the two halves of its light as complex amplitudes along x
/// and y of fields that run as e^(−iωt), and what they do over a period.
fn by_fields(sheets: &[Sheet]) -> [f64; 3] {
    let half = |mut field: [[f64; 2]; 2]| {
        for sheet in sheets.iter().rev() {
            let (Sheet::Polariser { degrees, .. } | Sheet::Retarder { degrees, .. }) = *sheet;
            let (sin, cos) = degrees.to_radians().sin_cos();
            let turned = |[x, y]: [[f64; 2]; 2], sin: f64| [0, 1].map(|i| cos * x[i] + sin * y[i]);
            let (along, across) = (turned(field, sin), turned([field[1], field[0]], -sin));
            let times = |[re, im]: [f64; 2], [a, b]: [f64; 2]| [re * a - im * b, re * b + im * a];
            let (along, across) = match *sheet {
                Sheet::Polariser { transmittance: t, extinction, .. } => {
                    (along.map(|e| e * t.sqrt()), across.map(|e| e * (t * extinction).sqrt()))
                }
                Sheet::Retarder { delay_deg, .. } => {
                    let (sin, cos) = delay_deg.to_radians().sin_cos();
                    (along, times(across, [cos, sin]))
                }
            };
            field = [turned([along, across], -sin), turned([across, along], sin)];
        }
        stokes_of(|phase| field.map(|[re, im]| re * phase.cos() + im * phase.sin()))
    };
    let (x, y) = (half([[1.0, 0.0], [0.0; 2]]), half([[0.0; 2], [1.0, 0.0]]));
    [0, 1, 2].map(|i| x[i] + y[i])
}

/// Light of an intensity that swings along a line at this angle from x toward y.
fn swings(intensity: f64, degrees: f64) -> [f64; 3] {
    let (sin, cos) = (2.0 * degrees).to_radians().sin_cos();
    [intensity * cos, intensity * sin, 0.0]
}

/// Half of the lamp's light, which swings at `rear` degrees, behind a plate whose fast axis is at `fast`.
fn delayed(rear: f64, fast: f64, delay_deg: f64) -> [f64; 3] {
    let (sin, cos) = (2.0 * (fast - rear)).to_radians().sin_cos();
    let delay = delay_deg.to_radians();
    let [q, u] = [cos * cos + sin * sin * delay.cos(), sin * cos * (1.0 - delay.cos())];
    let (turn_sin, turn_cos) = (2.0 * rear).to_radians().sin_cos();
    [q * turn_cos - u * turn_sin, q * turn_sin + u * turn_cos, sin * delay.sin()].map(|s| 0.5 * s)
}

const NEAREST: &str = "Behind a polariser light swings along its axis, at an angle ψ to the rows of the picture: S₁ = S₀ cos 2ψ, \
                       S₂ = S₀ sin 2ψ, whatever it met before.";
const DELAYED: &str = "Of light that swings at α a plate whose fast axis is at φ delays the part across that by δ: in frames along the light's line \
                       (S₁, S₂, S₃) = ½(cos²2β + sin²2β cos δ, sin 2β cos 2β (1 − cos δ), sin 2β sin δ), β = φ − α.";

/// The truth, then those that read the other parameters of its film.
pub(super) fn with_companions(truth: Truth) -> Vec<Truth> {
    let mut list = same_scene(&truth);
    list.extend(without_the_nearest(&truth));
    list.insert(0, truth);
    list
}

fn because_of(
    base: &Truth,
    because: &'static str,
    formula: &str,
    (stokes, mistakes): ([f64; 3], &[(&'static str, [f64; 3])]),
    sheets: Vec<Sheet>,
) -> Vec<Truth> {
    let how = ("the field over a period, by amplitudes", 1e-6);
    companions(base, &Light { stokes, formula, because, mistakes, sees: 5e-3, how }, move || by_fields(&sheets))
}

/// Angles at which a sheet that is turned by 60° about a line at 45° to its axis acts, at which it would if its axis were as it is seen, and at
/// which it does when it is not turned.
fn turned_deg() -> [f64; 3] {
    [0.5_f64.atan().to_degrees(), 2.0_f64.atan().to_degrees(), 45.0]
}

fn same_scene(truth: &Truth) -> Vec<Truth> {
    let s0 = truth.value();
    let [at, seen, level] = turned_deg();
    let malus = |degrees: f64| 0.5 * degrees.to_radians().cos().powi(2);
    let last = "the sheet next to the lamp taken for the nearest";
    let (stokes, mistakes, sheets): ([f64; 3], Mistakes, Vec<Sheet>) = match truth.name.as_str() {
        // What `polariser-at-20-degrees-s1` and its companions read.
        "polariser-alone" => return Vec::new(),
        "polariser-of-a-transmittance-and-an-extinction" => (
            swings(0.36, 20.0),
            vec![
                ("the extinction left out", swings(0.4, 20.0)),
                ("the extinction not divided by T", swings(0.35, 20.0)),
                ("all of the light along the axis", swings(0.44, 20.0)),
                ("turned by the angle, not by twice the angle", swings(0.36, 10.0)),
            ],
            vec![grey(20.0)],
        ),
        "two-polarisers" => (swings(s0, 10.0), vec![(last, swings(s0, 45.0))], vec![polariser(10.0), polariser(45.0)]),
        "two-polarisers-with-an-extinction" => {
            // Of the sheet at 60°: ½T(1 + ε), and ½T(1 − ε) along it. Of the nearer one by amplitudes 1 : √ε.
            let (all, most) = (0.44, swings(0.36, 60.0));
            let of = |share: f64| [0.4 * (0.9 * all + 1.1 * most[0]), 0.8 * share * most[1], 0.0];
            (
                of(0.1_f64.sqrt()),
                vec![
                    ("the extinction for the amplitude across the axis", of(0.1)),
                    ("depolarised between them", [0.4 * 0.9 * all, 0.0, 0.0]),
                    ("all of the light along the nearer axis", [s0, 0.0, 0.0]),
                ],
                vec![grey(0.0), grey(60.0)],
            )
        }
        "three-polarisers" => (swings(s0, 90.0), Vec::new(), vec![polariser(90.0), polariser(30.0), polariser(0.0)]),
        "two-crossed-polarisers" => (
            [0.0; 3],
            vec![("the nearer one left out", swings(0.5, 0.0)), ("the farther one left out", swings(0.5, 90.0))],
            Vec::new(),
        ),
        "quarter-wave-between-crossed-polarisers" => (
            swings(s0, 90.0),
            vec![("the plate left out", [0.0; 3])],
            vec![polariser(90.0), plate(45.0, 90.0), polariser(0.0)],
        ),
        "retarder-between-crossed-polarisers" => (
            swings(s0, 90.0),
            vec![("the plate left out", [0.0; 3])],
            vec![polariser(90.0), plate(30.0, 130.0), polariser(0.0)],
        ),
        "retarder-at-another-wavelength" => (
            swings(s0, 90.0),
            vec![("the same delay at every wavelength", swings(0.1875, 90.0))],
            vec![polariser(90.0), plate(30.0, 110.0), polariser(0.0)],
        ),
        "two-quarter-waves-that-undo-each-other" => (
            swings(0.5, 0.0),
            vec![("both of one hand", [0.0; 3])],
            vec![polariser(0.0), plate(-45.0, 90.0), plate(45.0, 90.0), polariser(0.0)],
        ),
        "two-quarter-waves-of-one-hand" => ([0.0; 3], vec![("of both hands", swings(0.5, 0.0))], Vec::new()),
        "polariser-turned-about-a-line-aslant" => (
            swings(s0, at),
            vec![
                ("the axis as it is seen", swings(malus(seen - 10.0), seen)),
                ("not tilted", swings(malus(level - 10.0), level)),
            ],
            vec![polariser(at), polariser(10.0)],
        ),
        "retarder-turned-about-a-line-aslant" => (
            swings(s0, 100.0),
            vec![("the plate left out", [0.0; 3]), (last, swings(s0, 10.0))],
            vec![polariser(100.0), plate(at, 100.0), polariser(10.0)],
        ),
        name => panic!("{name} has no companions"),
    };
    because_of(truth, NEAREST, "S₀ times cos 2ψ, sin 2ψ", (stokes, &mistakes), sheets)
}

/// What comes to the polariser next to the eye.
fn without_the_nearest(truth: &Truth) -> Vec<Truth> {
    let [at, seen, level] = turned_deg();
    // The sheet next to the eye is the first of the scene's objects, or stands behind the lamp in their list.
    let (name, nearest) = (truth.name.as_str(), if truth.name.starts_with("retarder-turned") { 3 } else { 0 });
    let (rear, fast, delay_deg, mistakes): (f64, f64, f64, Mistakes) = match name {
        "quarter-wave-between-crossed-polarisers" => (0.0, 45.0, 90.0, vec![("a half wave", swings(0.5, 90.0))]),
        "retarder-between-crossed-polarisers" => {
            (0.0, 30.0, 130.0, vec![("the delay taken for twice as much", delayed(0.0, 30.0, 260.0))])
        }
        "retarder-at-another-wavelength" => (
            0.0,
            30.0,
            110.0,
            vec![
                ("the same delay at every wavelength", delayed(0.0, 30.0, 90.0)),
                ("in proportion to the wavelength", delayed(0.0, 30.0, 90.0 * 450.0 / 550.0)),
            ],
        ),
        "two-quarter-waves-of-one-hand" => (0.0, 45.0, 180.0, vec![("one of the two", delayed(0.0, 45.0, 90.0))]),
        "retarder-turned-about-a-line-aslant" => (
            10.0,
            at,
            100.0,
            vec![("the axis as it is seen", delayed(10.0, seen, 100.0)), ("not tilted", delayed(10.0, level, 100.0))],
        ),
        _ => return Vec::new(),
    };
    let remove = |scene: &mut Value| {
        scene["objects"].as_array_mut().expect("a list").remove(nearest);
    };
    let base = keeping_stokes(truth, &format!("{name}-not-analysed"), remove);
    let mut all_mistakes = vec![("the plate left out", swings(0.5, rear))];
    all_mistakes.extend(mistakes);
    let formula = format!("of the plate at {fast:.3}° by δ = {delay_deg}° behind a polariser at {rear}°, turned by 2α");
    because_of(&base, DELAYED, &formula, (delayed(rear, fast, delay_deg), &all_mistakes), {
        vec![plate(fast, delay_deg), polariser(rear)]
    })
}
