//! Polarisers and retarders, alone and one behind another, before a lamp.

mod companions;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{Scene, black, level_square, parallelogram},
};
use crate::vector::{Vec3, cross, dot, normalize};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = polarisers();
    list.extend(retarders());
    list.extend(tilted());
    // Beside each those that read the other parameters of its film, so that one render serves all.
    list.into_iter()
        .map(|truth| truth.claims(Claim::CarriesPolarisation))
        .flat_map(companions::with_companions)
        .collect()
}

/// The direction in the sheet at this angle from x toward y.
fn axis(degrees: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!([cos, sin, 0.0])
}

/// Sheets from the nearest to the farthest, and a lamp of radiance 1 behind them.
fn scene(sheets: &[Value]) -> Scene {
    let first =
        Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1).film(16, 16).spp(256).set("film", "stokes", json!(true));
    let lamp = level_square([0.0, 0.0, -1.0], 1.0, true);
    sheets
        .iter()
        .enumerate()
        .fold(first, |scene, (k, sheet)| {
            scene
                .thing(json!({ "shape": level_square([0.0, 0.0, 1.0 - 0.2 * k as f64], 1.0, true), "material": sheet }))
        })
        .lamp(lamp, black(), 1.0, "front")
}

fn polariser(degrees: f64) -> Value {
    json!({ "type": "polariser", "axis": axis(degrees) })
}

fn polarisers() -> Vec<Truth> {
    const BECAUSE: &str = "A polariser passes T of the light along its axis and T times its extinction across it; of what swings at an angle φ to \
                           the axis it passes cos²φ (Malus).";
    let grey =
        |degrees: f64| json!({ "type": "polariser", "axis": axis(degrees), "transmittance": 0.8, "extinction": 0.1 });
    let truth = |name: &str, sheets: &[Value], value: f64, formula: &str| {
        Truth::new(name, &scene(sheets), value, formula).because(BECAUSE).or_else("the sheets left out", 1.0).sees(2e-3)
    };
    let square = |degrees: f64| degrees.to_radians().cos().powi(2);
    // Two of T = 0.8 and ε = 0.1 with their axes φ apart: ½T²((1 + ε²)cos²φ + 2ε sin²φ).
    let pair = |degrees: f64| 0.5 * 0.64 * (1.01 * square(degrees) + 0.2 * (1.0 - square(degrees)));
    vec![
        truth("polariser-alone", &[polariser(20.0)], 0.5, "½"),
        truth("polariser-of-a-transmittance-and-an-extinction", &[grey(20.0)], 0.44, "½ T(1 + ε), T = 0.8, ε = 0.1")
            .or_else("the extinction left out", 0.4)
            .or_else("the extinction not divided by T", 0.45),
        truth("two-polarisers", &[polariser(10.0), polariser(45.0)], 0.5 * square(35.0), "½ cos² 35°")
            .confirmed("½(1 + cos 2φ)/2", 1e-12, || 0.25 * (1.0 + 70.0_f64.to_radians().cos()))
            .or_else("each takes half", 0.25)
            .or_else("the angle between them turned", 0.5 * square(55.0)),
        truth(
            "two-polarisers-with-an-extinction",
            &[grey(0.0), grey(60.0)],
            pair(60.0),
            "½T²((1 + ε²)cos²φ + 2ε sin²φ)",
        )
        .confirmed("components along and across each axis, one by one", 1e-12, move || {
            let (c2, s2) = (square(60.0), 1.0 - square(60.0));
            // Of the first, T along and Tε across; each is shared between both axes of the second.
            let (along, across) = (0.5 * 0.8, 0.5 * 0.08);
            along * (c2 * 0.8 + s2 * 0.08) + across * (s2 * 0.8 + c2 * 0.08)
        })
        .or_else("depolarised between them", 0.44 * 0.44),
        truth(
            "three-polarisers",
            &[polariser(90.0), polariser(30.0), polariser(0.0)],
            0.5 * square(60.0) * square(30.0),
            "½ cos² 60° cos² 30°",
        )
        .or_else("crossed, as if the middle one were not there", 0.0)
        // Nine of ten paths end at a sheet: to see 0.2 % would take half a minute.
        .sees(5e-3),
        truth("two-crossed-polarisers", &[polariser(90.0), polariser(0.0)], 0.0, "0"),
    ]
}

fn retarders() -> Vec<Truth> {
    const BECAUSE: &str = "Between crossed polarisers a wave plate whose fast axis is at φ to the first lets ½ sin²2φ sin²(δ/2) through; \
                           between parallel ones ½(1 − sin²2φ sin²(δ/2)).";
    let plate = |degrees: f64, delay_deg: f64| json!({ "type": "retarder", "axis": axis(degrees), "retardance_deg": delay_deg });
    let crossed = |degrees: f64, delay_deg: f64| {
        0.5 * (2.0 * degrees).to_radians().sin().powi(2) * (0.5 * delay_deg).to_radians().sin().powi(2)
    };
    let truth = |name: &str, scene: &Scene, value: f64, formula: &str| {
        let truth = Truth::new(name, scene, value, formula).because(BECAUSE).sees(2e-3);
        if value == 0.0 { truth.or_else("the plates left out", 0.5) } else { truth.or_else("all light stopped", 0.0) }
    };
    let between = |sheet: Value| scene(&[polariser(90.0), sheet, polariser(0.0)]);
    let mut dispersive = plate(30.0, 90.0);
    dispersive["at_nm"] = json!(550);
    let at_450 = 90.0 * 550.0 / 450.0;
    // Circularly polarised light: a quarter of a wave at 45°, then back by another of the other hand, or on by one of the same.
    let twice = |degrees: f64| scene(&[polariser(0.0), plate(degrees, 90.0), plate(45.0, 90.0), polariser(0.0)]);
    vec![
        truth(
            "quarter-wave-between-crossed-polarisers",
            &between(plate(45.0, 90.0)),
            crossed(45.0, 90.0),
            "½ sin²90° sin²45°",
        ),
        truth(
            "retarder-between-crossed-polarisers",
            &between(plate(30.0, 130.0)),
            crossed(30.0, 130.0),
            "½ sin²60° sin²65°",
        )
        .confirmed("the field's two components with their phases", 1e-12, || {
            let (s, c) = 30.0_f64.to_radians().sin_cos();
            // x → x cos, y parts along fast and slow: amplitude along y is sc(1 − e^{iδ}).
            let delta = 130.0_f64.to_radians();
            0.5 * (s * c).powi(2) * ((1.0 - delta.cos()).powi(2) + delta.sin().powi(2))
        })
        .or_else("the delay taken for twice as much", crossed(30.0, 260.0))
        .or_else("the axis counted from the other polariser, doubled", crossed(60.0, 65.0)),
        truth(
            "retarder-at-another-wavelength",
            &between(dispersive).band([449.9995, 450.0005]),
            crossed(30.0, at_450),
            "½ sin²60° sin²(45° · 550/450)",
        )
        .or_else("the same delay at every wavelength", crossed(30.0, 90.0))
        .or_else("in proportion to the wavelength", crossed(30.0, 90.0 * 450.0 / 550.0)),
        truth(
            "two-quarter-waves-that-undo-each-other",
            &twice(-45.0),
            0.5,
            "½: the second plate gives back what the first took",
        ),
        truth(
            "two-quarter-waves-of-one-hand",
            &twice(45.0),
            0.0,
            "0: together half a wave, which turns the light by 90°",
        ),
    ]
}

/// Sheets turned by 60° about an axis at 45° to their own.
fn tilted() -> Vec<Truth> {
    const BECAUSE: &str = "Wires in a sheet absorb what swings along them; what passes swings across both the ray and the wires. They lie in the \
                           sheet, across its axis. So of a sheet that is turned by τ about the y axis, and whose axis is at 45° to that, light along \
                           z passes that swings along (1, cos τ); the axis itself is seen along (cos τ, 1).";
    let (sin, cos) = 60.0_f64.to_radians().sin_cos();
    // The sheet's side that is turned, and its normal.
    let (side, normal): (Vec3, Vec3) = ([cos, 0.0, -sin], [sin, 0.0, cos]);
    let own: Vec3 = [cos, 1.0, -sin];
    let shape = parallelogram([-cos, -1.0, 1.5 + sin], side.map(|x| 2.0 * x), [0.0, 2.0, 0.0]);
    let [true_deg, seen_deg] = [cos.atan().to_degrees(), (1.0 / cos).atan().to_degrees()];
    // In front of others, which are level.
    let before =
        |material: Value, others: &[Value]| scene(others).thing(json!({ "shape": shape, "material": material }));
    let square = |degrees: f64| degrees.to_radians().cos().powi(2);
    let first_deg = 10.0_f64;
    let polarised = Truth::new(
        "polariser-turned-about-a-line-aslant",
        &before(json!({ "type": "polariser", "axis": own }), &[polariser(first_deg)]),
        0.5 * square(true_deg - first_deg),
        "½ cos²(ψ − 10°), tan ψ = cos 60°",
    )
    .because(BECAUSE)
    .confirmed("the field's direction across the wires, by vectors", 1e-12, move || {
        let passes = normalize(cross([0.0, 0.0, 1.0], cross(normal, own)));
        let (sin, cos) = first_deg.to_radians().sin_cos();
        0.5 * dot(passes, [cos, sin, 0.0]).powi(2)
    })
    .or_else("the axis as it is seen", 0.5 * square(seen_deg - first_deg))
    .or_else("not tilted", 0.5 * square(45.0 - first_deg))
    .sees(2e-3);
    // Between crossed polarisers, the nearer one in front of the plate at 100°.
    let (delay_deg, rear_deg) = (100.0_f64, 10.0_f64);
    let crossed = move |degrees: f64| {
        let (turn, delay) = ((2.0 * (degrees - rear_deg)).to_radians(), (0.5 * delay_deg).to_radians());
        0.5 * (turn.sin() * delay.sin()).powi(2)
    };
    let plate = json!({ "type": "retarder", "axis": own, "retardance_deg": delay_deg });
    let nearest = level_square([0.0, 0.0, 1.8], 0.2, true);
    let delayed = before(plate, &[polariser(rear_deg)])
        .thing(json!({ "shape": nearest, "material": polariser(rear_deg + 90.0) }));
    let delayed = Truth::new(
        "retarder-turned-about-a-line-aslant",
        &delayed,
        crossed(true_deg),
        "½ sin²2(ψ − 10°) sin² 50°, tan ψ = cos 60°",
    )
    .because(BECAUSE)
    .confirmed("the field's two parts with their phases, by vectors", 1e-12, move || {
        let fast = normalize(cross([0.0, 0.0, 1.0], cross(normal, own)));
        let slow = cross([0.0, 0.0, 1.0], fast);
        let (sin, cos) = rear_deg.to_radians().sin_cos();
        let (from, to): (Vec3, Vec3) = ([cos, sin, 0.0], [-sin, cos, 0.0]);
        let [a, b] = [fast, slow].map(|part| dot(from, part) * dot(to, part));
        0.5 * (a * a + b * b + 2.0 * a * b * delay_deg.to_radians().cos())
    })
    .or_else("the axis as it is seen", crossed(seen_deg))
    .or_else("not tilted", crossed(45.0))
    .sees(2e-3);
    vec![polarised, delayed]
}
