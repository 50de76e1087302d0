//! Light in photometric units, luminaires from files, standard skies.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};

use super::cie171::LUX;
use super::expectation::Expectation;
use super::meters::measured;
use super::prisms::CIE_Y;
use super::scene::{black, disk, sphere};
use super::skylight::{Sky, by_midpoints, direction};
use super::{Claim, Truth, disk_irradiance, sphere_irradiance};
use crate::quadrature::{Cone, directions};
use crate::vector::{Vec3, cross, dot, length, normalize, sub};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = units();
    list.extend(luminaires());
    list.extend(skies());
    list
}

const UP: Vec3 = [0.0, 0.0, 1.0];

fn meter(position: Vec3, normal: Vec3) -> Value {
    json!({ "type": "irradiance", "position_m": position, "normal": normal })
}

/// 683.002 lm/W times the sum of the table of ȳ.
fn lux_by_table() -> f64 {
    683.002 * CIE_Y.iter().sum::<f64>()
}

/// A light in photometric units, of some spectrum: lx, or cd/m², at the meter.
fn units() -> Vec<Truth> {
    let daylight = json!({ "type": "illuminant", "name": "D65", "scale": 3 });
    let hot = json!({ "type": "blackbody", "temperature_k": 2856, "scale": 1e-6 });
    let line =
        json!({ "type": "tabulated", "wavelengths_nm": [540, 550, 560], "values": [0, 5, 0], "outside": "zero" });
    let point = |key: &str, value: f64, spectrum: Option<&Value>| {
        let mut light = json!({ "type": "point", "position_m": [0, 0, 2] });
        light[key] = json!(value);
        if let Some(spectrum) = spectrum {
            light["spectrum"] = spectrum.clone();
        }
        light
    };
    let spot = |key: &str, value: f64| {
        let mut light = json!({
            "type": "spot", "position_m": [0, 0, 2], "direction": [0, 0, -1], "half_angle_deg": 60, "inner_half_angle_deg": 20, "spectrum": hot,
        });
        light[key] = json!(value);
        light
    };
    let cones = TAU * (1.0 - 0.5 * (20_f64.to_radians().cos() + 0.5));
    let list = [
        ("candela-of-a-point", point("intensity_cd", 300.0, None), 75.0, "I/h² = 300 cd/4 m²"),
        ("candela-of-a-point-of-daylight", point("intensity_cd", 300.0, Some(&daylight)), 75.0, "I/h² = 300 cd/4 m²"),
        ("candela-of-a-narrow-line", point("intensity_cd", 300.0, Some(&line)), 75.0, "I/h² = 300 cd/4 m²"),
        ("lumens-of-a-point", point("flux_lm", 1200.0, Some(&hot)), 300.0 / PI / 4.0, "Φ/(4πh²)"),
        ("candela-of-a-spot", spot("intensity_cd", 300.0), 75.0, "I/h² on its axis"),
        ("lumens-of-a-spot", spot("flux_lm", 1200.0), 300.0 / cones, "Φ/(2π(1 − ½cos 20° − ½cos 60°)h²)"),
        (
            "lux-of-parallel-light",
            json!({ "type": "directional", "direction": [0, 0, -1], "illuminance_lx": 400, "spectrum": daylight }),
            400.0,
            "E",
        ),
        (
            "lumens-of-a-beam",
            json!({ "type": "beam", "position_m": [0, 0, 2], "direction": [0, 0, -1], "radius_m": 0.5, "flux_lm": 1200, "spectrum": hot }),
            1200.0 / (PI * 0.25),
            "Φ/(πw²)",
        ),
        (
            "candela-per-square-metre-of-a-sky",
            json!({ "type": "environment", "luminance_cd_per_m2": 500, "spectrum": hot }),
            500.0 * PI,
            "πL",
        ),
    ];
    let mut truths: Vec<Truth> = list
        .into_iter()
        .map(|(name, light, lux, formula)| truth(name, measured(&[meter([0.0; 3], UP)]).light(light), lux, formula))
        .collect();
    let lamp = json!({
        "shape": disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 0.5), "material": black(),
        "emission": { "luminance_cd_per_m2": 2000, "spectrum": daylight, "sides": "front" },
    });
    let lux = 2000.0 * disk_irradiance(0.5, 1.0, 0.0);
    truths.push(truth(
        "candela-per-square-metre-of-a-disk",
        measured(&[meter([0.0; 3], UP)]).thing(lamp),
        lux,
        "πL r²/(r² + h²)",
    ));
    truths
}

fn truth(name: &str, scene: super::scene::Scene, lux: f64, formula: &str) -> Truth {
    let value = lux / LUX;
    Truth::new(name, &scene, value, format!("{formula}, over 683.002 lm/W · ∫ȳ dλ"))
        .because(
            "Photometric numbers weigh a spectrum by ȳ, with 683.002 lm/W; a sensor of CIE Y that answers 1 to a constant spectrum of 1 reads \
             them over 683.002 ∫ȳ, whatever the spectrum is.",
        )
        .confirmed("the table of ȳ, summed", 1e-6, move || lux / lux_by_table())
        .or_else("a factor of 683 left out", 683.002 * value)
        .or_else("the peak at 555 nm taken for the spectrum: lumens per watt for lux", value * 106.856_917)
        .claims(Claim::PhotometricSensor)
        .allows(3e-4 * value, "spectra are drawn as straight lines between nanometres, and ȳ too")
        .sees(0.005)
}

const VERTICAL: [f64; 4] = [0.0, 30.0, 60.0, 90.0];
const HORIZONTAL: [f64; 5] = [0.0, 90.0, 180.0, 270.0, 360.0];
/// cd, before the factors of the file, 2 and 0.5.
const INTENSITIES: [[f64; 4]; 5] = [
    [100.0, 90.0, 60.0, 10.0],
    [100.0, 50.0, 20.0, 5.0],
    [100.0, 120.0, 150.0, 80.0],
    [100.0, 70.0, 30.0, 0.0],
    [100.0, 90.0, 60.0, 10.0],
];

/// A file of these intensities at some horizontal angles.
fn ies(horizontal: &[f64], columns: &[[f64; 4]]) -> Vec<u8> {
    let line = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let rows: Vec<String> = columns.iter().map(|column| line(column)).collect();
    format!(
        "IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n1 -1 2 4 {} 1 2 0 0 0\n0.5 1 20\n{}\n{}\n{}\n",
        horizontal.len(),
        line(&VERTICAL),
        line(horizontal),
        rows.join("\n")
    )
    .into_bytes()
}

/// The same as a EULUMDAT file without symmetry: cd/klm of 500 lm, and a conversion factor of 2.
fn eulumdat() -> Vec<u8> {
    let mut lines: Vec<String> =
        ["none", "1", "0", "4", "90", "4", "30", "", "", "", "", ""].map(str::to_owned).to_vec();
    lines.extend((0..9).map(|_| "100".to_owned()));
    lines.extend(["100", "80", "2", "0", "1", "1", "none", "500", "", "", "0"].map(str::to_owned));
    lines.extend((0..10).map(|_| "0".to_owned()));
    lines.extend(HORIZONTAL[..4].iter().chain(&VERTICAL).chain(INTENSITIES[..4].as_flattened()).map(f64::to_string));
    lines.join("\n").into_bytes()
}

/// The intensity of the whole table at angles in degrees.
fn intensity(vertical: f64, horizontal: f64) -> f64 {
    if vertical > 90.0 {
        return 0.0;
    }
    let row = ((vertical / 30.0) as usize).min(2);
    let column = ((horizontal / 90.0) as usize).min(3);
    let (down, across) = (vertical / 30.0 - row as f64, horizontal / 90.0 - column as f64);
    let along = |column: usize| {
        let [a, b] = [INTENSITIES[column][row], INTENSITIES[column][row + 1]];
        a * (1.0 - down) + b * down
    };
    along(column) * (1.0 - across) + along(column + 1) * across
}

/// A luminaire at a place, turned, seen from the origin by a meter that faces it.
fn luminaires() -> Vec<Truth> {
    struct Placed {
        nadir: Vec3,
        forward: Vec3,
        position: Vec3,
    }
    // Vertical and horizontal angle, degrees, of the way to the origin; horizontal angles counter-clockwise from above or clockwise.
    let angles = |placed: &Placed, clockwise: bool| {
        let nadir = normalize(placed.nadir);
        let level = sub(placed.forward, nadir.map(|c| c * dot(placed.forward, nadir)));
        let forward = normalize(level);
        // Seen from above, against the nadir, up is −nadir; up × forward is a quarter turn on.
        let left = cross(nadir.map(|c| -c), forward);
        let way = placed.position.map(|c| -c);
        let (x, y) = (dot(way, forward), dot(way, left) * if clockwise { -1.0 } else { 1.0 });
        let vertical = x.hypot(y).atan2(dot(way, nadir)).to_degrees();
        (vertical, y.atan2(x).to_degrees().rem_euclid(360.0))
    };
    let hanging = Placed { nadir: [0.0, -1.0, 0.0], forward: [0.0, 0.0, -1.0], position: [0.7, 2.0, 0.4] };
    let turned = Placed { nadir: [0.2, 0.3, -1.0], forward: [1.0, 0.4, 0.1], position: [0.5, -0.8, 2.0] };
    let symmetric = |fold: fn(f64) -> f64| move |vertical: f64, horizontal: f64| intensity(vertical, fold(horizontal));
    type Table = Box<dyn Fn(f64, f64) -> f64>;
    type Case = (&'static str, Placed, &'static str, Vec<u8>, Table, f64);
    let cases: Vec<Case> = vec![
        ("luminaire-that-hangs", hanging, "whole.ies", ies(&HORIZONTAL, &INTENSITIES), Box::new(intensity), 1.0),
        ("luminaire-that-is-turned", turned, "whole.ies", ies(&HORIZONTAL, &INTENSITIES), Box::new(intensity), 1.5),
        (
            "luminaire-of-eulumdat",
            Placed { nadir: [0.1, 0.0, -1.0], forward: [0.0, 1.0, 0.0], position: [-0.9, 0.3, 1.5] },
            "whole.ldt",
            eulumdat(),
            Box::new(intensity),
            1.0,
        ),
        (
            "luminaire-with-one-mirror-plane",
            Placed { nadir: [0.0, 0.0, -1.0], forward: [0.0, 1.0, 0.0], position: [-0.9, 0.3, 1.5] },
            "half.ies",
            ies(&HORIZONTAL[..3], &INTENSITIES[..3]),
            Box::new(symmetric(|h| if h > 180.0 { 360.0 - h } else { h })),
            1.0,
        ),
        (
            "luminaire-with-two-mirror-planes",
            Placed { nadir: [0.0, 0.0, -1.0], forward: [0.0, 1.0, 0.0], position: [-0.5, 0.9, 1.5] },
            "quarter.ies",
            ies(&HORIZONTAL[..2], &INTENSITIES[..2]),
            Box::new(symmetric(|h| {
                let half = if h > 180.0 { 360.0 - h } else { h };
                if half > 90.0 { 180.0 - half } else { half }
            })),
            1.0,
        ),
        (
            "luminaire-that-is-the-same-all-around",
            Placed { nadir: [0.0, 0.0, -1.0], forward: [0.0, 1.0, 0.0], position: [-0.5, 0.9, 1.5] },
            "around.ies",
            ies(&HORIZONTAL[..1], &INTENSITIES[2..3]),
            Box::new(|vertical, _| intensity(vertical, 180.0)),
            1.0,
        ),
    ];
    cases
        .into_iter()
        .map(|(name, placed, file, bytes, table, scale)| {
            let d = length(placed.position);
            let toward = placed.position.map(|c| c / d);
            let (vertical, horizontal) = angles(&placed, false);
            let (_, mirrored) = angles(&placed, true);
            let lux = scale * table(vertical, horizontal) / (d * d);
            let mut light = json!({ "type": "luminaire", "file": file, "position_m": placed.position });
            if placed.nadir != [0.0, -1.0, 0.0] {
                (light["nadir"], light["forward"]) = (json!(placed.nadir), json!(placed.forward));
            }
            if scale != 1.0 {
                (light["scale"], light["spectrum"]) = (json!(scale), json!({ "type": "illuminant", "name": "A" }));
            }
            let scene = measured(&[meter([0.0; 3], toward)]).light(light).file(file, bytes);
            let mut truth = truth(name, scene, lux, "I(γ, C)/d², linear in both angles between those of the file")
                .or_else("the factors of the file left out twice", 2.0 * lux / LUX)
                .or_else("upside down", scale * table(180.0 - vertical, horizontal) / (d * d) / LUX);
            let clockwise = scale * table(vertical, mirrored) / (d * d);
            if (clockwise - lux).abs() > 0.02 * lux {
                truth = truth.or_else("horizontal angles clockwise", clockwise / LUX);
            }
            truth
        })
        .collect()
}

/// The same beside a lamp, which hides a part of the sky.
fn beside_a_lamp(normal: Vec3) -> Vec<Truth> {
    const LAMP: f64 = 40.0;
    let sky = Sky::new(12, direction(35.0, 20.0));
    let (toward, distance_m, radius_m) = (direction(50.0, 250.0), 2.0, 0.5);
    let beta = dot(toward, normal).acos();
    let from_lamp = LAMP * sphere_irradiance(radius_m, distance_m, beta);
    let work_out = move || {
        let hidden = |direction: Vec3| sky.relative(direction) * dot(direction, normal);
        let hidden = directions(hidden, Cone::new(toward, (radius_m / distance_m).asin()), 1e-7, 100_000).value;
        let from_sky = 3.0 * (sky.irradiance(normal) - hidden);
        let value = from_sky + from_lamp;
        Expectation::new(value)
            .or_else("the sky counted twice", 2.0 * from_sky + from_lamp)
            .or_else("the sky seen through the lamp", value + 3.0 * hidden)
            .allows(2e-5 * value, "2e-5 for single precision, 2e-5 for the quadrature")
    };
    let form = json!({ "cie_type": 12, "up": UP, "zenith_radiance": 3, "sun_direction": sky.sun });
    ["mis", "light"]
        .map(|how| {
            let scene = measured(&[meter([0.0; 3], normal)])
                .light(json!({ "type": "environment", "sky": form }))
                .lamp(sphere(toward.map(|c| distance_m * c), radius_m), black(), LAMP, "front")
                .light_sampling(how);
            let formula = "∫ L(Z, χ) cos θ dω beside the lamp + L′ π(R/d)² cos β";
            Truth::later(format!("standard-sky-beside-a-lamp-by-{how}"), &scene, formula, work_out)
                .because("Light adds up: the lamp's own, and that of the sky from where the lamp is not.")
                .confirmed("midpoints over both angles", 1e-3, move || {
                    let rim = (1.0 - (radius_m / distance_m).powi(2)).sqrt();
                    by_midpoints(normal, |d| if dot(d, toward) > rim { LAMP } else { 3.0 * sky.relative(d) })
                })
                .sees(0.005)
        })
        .into()
}

/// Tilted meters in the open under some of the skies.
fn skies() -> Vec<Truth> {
    let normal = normalize([0.5, -0.3, 0.6]);
    let mut list = Vec::new();
    for (number, how, ground) in [
        (1, "mis", 0.0),
        (4, "light", 0.0),
        (5, "mis", 0.3),
        (8, "mis", 0.0),
        (12, "mis", 0.2),
        (15, "mis", 0.0),
        (15, "light", 0.0),
        (15, "bsdf", 0.0),
        (16, "mis", 0.1),
    ] {
        let mut sky = Sky::new(number, direction(35.0, 20.0));
        sky.ground = ground;
        // What lies below the horizon gives a plane of tilt β the configuration factor (1 − cos β)/2.
        let below = ground * PI * 0.5 * (1.0 - normal[2]);
        let mut form = json!({ "cie_type": number, "up": UP, "zenith_radiance": 3 });
        let has_sun = ![1, 3, 5, 16].contains(&number);
        if has_sun {
            form["sun_direction"] = json!(sky.sun);
        }
        if ground > 0.0 {
            form["ground"] = json!(ground);
        }
        let scene = measured(&[meter([0.0; 3], normal)])
            .light(json!({ "type": "environment", "sky": form }))
            .light_sampling(how);
        let work_out = move || {
            let value = 3.0 * (sky.irradiance(normal) + below);
            let uniform = 3.0 * (0.5 * PI * (1.0 + normal[2]) + below) + if number == 5 { 0.3 } else { 0.0 };
            let expectation = Expectation::new(value)
                .or_else("the uniform sky", uniform)
                .allows(2e-5 * value, "2e-5 for single precision, 2e-5 for the quadrature");
            if !has_sun {
                return expectation;
            }
            let mut turned = Sky::new(number, [-sky.sun[0], -sky.sun[1], sky.sun[2]]);
            turned.ground = ground;
            expectation.or_else("the sun on the other side", 3.0 * (turned.irradiance(normal) + below))
        };
        let formula = "∫ L(Z, χ) cos θ dω, L = L₀ φ(Z) f(χ)/(φ(0) f(Zₛ))";
        let truth = Truth::later(format!("standard-sky-{number}-by-{how}"), &scene, formula, work_out)
            .because("The luminance of a standard sky is a gradation by the angle from the zenith times an indicatrix by that from the sun (CIE S 011).")
            .confirmed("midpoints over both angles", 3e-4, move || 3.0 * (sky.irradiance_by_midpoints(normal) + below))
            .sees(0.005);
        list.push(truth);
    }
    list.extend(beside_a_lamp(normal));
    // In photometric units, the zenith elsewhere: a meter that faces it.
    let up = normalize([0.3, 1.0, -0.2]);
    let lux = 4000.0 * 7.0 * PI / 9.0;
    let form = json!({ "cie_type": 16, "up": [0.3, 1.0, -0.2], "zenith_luminance_cd_per_m2": 4000, "spectrum": { "type": "illuminant", "name": "D65" } });
    let scene = measured(&[meter([0.0; 3], up)]).light(json!({ "type": "environment", "sky": form }));
    list.push(
        truth("overcast-sky-in-photometric-units", scene, lux, "7πL/9").or_else("an even sky", PI * 4000.0 / LUX),
    );
    let upright = json!({ "cie_type": 1, "zenith_luminance_cd_per_m2": 4000 });
    let level = 4000.0 * Sky::new(1, UP).irradiance(UP);
    let scene = measured(&[meter([0.0; 3], [0.0, 1.0, 0.0])]).light(json!({ "type": "environment", "sky": upright }));
    list.push(truth("overcast-sky-with-y-up", scene, level, "∫ L cos θ dω").or_else("an even sky", PI * 4000.0 / LUX));
    list
}
