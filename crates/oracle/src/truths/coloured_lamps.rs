//! Lamps in photometric units at single wavelengths, where the shape of their spectrum shows: 683.002 lm/W · ∫ S ȳ dλ says only how much of
//! it there is.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    cie171::LUX,
    photometric_weight,
    scene::{Scene, black, disk, shown},
    tiles::mean,
};
use crate::vector::Vec3;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = points();
    list.extend(from_afar());
    list.extend([surface(), whites(), constant()]);
    list
}

/// A body at 2400 K: power per nanometre at a wavelength, nm, in any unit (Planck).
fn hot(nm: f64) -> f64 {
    (1e-3 * nm).powi(-5) / (1.438_776_877e7 / (nm * 2400.0)).exp_m1()
}

fn hot_form() -> Value {
    json!({ "type": "blackbody", "temperature_k": 2400, "scale": 7 })
}

/// A line from 400 to 700 nm, and what lies beyond.
fn rising(nm: f64) -> f64 {
    0.5 + 2.5 * ((nm - 400.0) / 300.0).clamp(0.0, 1.0)
}

fn rising_form() -> Value {
    json!({ "type": "tabulated", "wavelengths_nm": [400, 700], "values": [0.5, 3], "outside": "clamp", "scale": 2 })
}

/// The mean of a spectrum as the observer weighs it, from nanometre to nanometre.
fn weighed(spectrum: fn(f64) -> f64) -> f64 {
    (360..=830).map(f64::from).map(|nm| photometric_weight(nm) * spectrum(nm)).sum()
}

/// The same by Simpson's rule over each nanometre.
fn weighed_by_simpson(spectrum: fn(f64) -> f64) -> f64 {
    let at = |nm: f64| photometric_weight(nm) * spectrum(nm);
    (360..830).map(f64::from).map(|nm| (at(nm) + 4.0 * at(nm + 0.5) + at(nm + 1.0)) / 6.0).sum()
}

/// A light at a wavelength: what it would show at every wavelength if it were white, in lx or cd/m² on the way.
struct AtWavelength {
    name: &'static str,
    scene: Scene,
    nm: f64,
    spectrum: fn(f64) -> f64,
    /// What the picture shows of it in units of 683.002 lm/W · ∫ȳ dλ.
    white: f64,
    formula: &'static str,
    mistakes: Vec<(&'static str, f64)>,
}

fn truth(lamp: AtWavelength) -> Truth {
    let AtWavelength { nm, spectrum, white, .. } = lamp;
    let white = white / LUX;
    let value = white * spectrum(nm) / weighed(spectrum);
    let formula = format!("{} · S(λ)/∫ S ȳ dλ · ∫ȳ dλ at {nm} nm, over 683.002 lm/W · ∫ȳ dλ", lamp.formula);
    let truth = Truth::new(lamp.name, &lamp.scene.band([nm - 5e-4, nm + 5e-4]), value, formula)
        .because(
            "A photometric number is 683.002 lm/W · ∫ S ȳ dλ of a spectrum S, whose scale does not count. At one wavelength the lamp has its share of S.",
        )
        .confirmed("Simpson's rule over each nanometre", 2e-4, move || white * spectrum(nm) / weighed_by_simpson(spectrum))
        .allows(3e-4 * value, "spectra are drawn as straight lines between nanometres, and ȳ too")
        .or_else("the same at every wavelength", white)
        .or_else("the power at the peak of ȳ taken for that of all", white * spectrum(nm) / spectrum(555.0))
        .sees(2e-3);
    lamp.mistakes.into_iter().fold(truth, |truth, (what, factor)| truth.or_else(what, factor * value))
}

fn lit(light: Value) -> Scene {
    Scene::light_meter().light(light).film(16, 16).spp(64)
}

/// Lamps at a point, with slides before two of them.
fn points() -> Vec<Truth> {
    let point = json!({ "type": "point", "position_m": [0, 0, 2], "flux_lm": 1200, "spectrum": hot_form() });
    // 0.5 m beside the plate: u = ½ − ½ · ¼/½ of the slide, whose half width is ½ at a depth of 1.
    let slide = |along: &str, aspect: f64| {
        json!({
            "image": { "type": "gradient", "from": 0.2, "to": 1, "along": along }, "direction": [0, 0, -1],
            "horizontal_fov_deg": 2.0 * 0.5_f64.atan().to_degrees(), "aspect": aspect, "even_on": "sphere",
        })
    };
    let (r2, cos) = (4.25_f64, 2.0 / 4.25_f64.sqrt());
    let gobo = json!({
        "type": "spot", "position_m": [0.5, 0, 2], "direction": [0, 0, -1], "half_angle_deg": 60, "inner_half_angle_deg": 30,
        "intensity_cd": 300, "spectrum": rising_form(), "slide": slide("u", 1.0),
    });
    let through = 0.2 + 0.8 * 0.25;
    // 30° off its axis, between 20° and 60°.
    let cosine = |degrees: f64| degrees.to_radians().cos();
    let x = (cosine(30.0) - 0.5) / (cosine(20.0) - 0.5);
    let cones = TAU * (1.0 - 0.5 * (cosine(20.0) + 0.5));
    let soft = json!({
        "type": "spot", "position_m": [-2.0 * 30_f64.to_radians().tan(), 0, 2], "direction": [0, 0, -1], "half_angle_deg": 60,
        "inner_half_angle_deg": 20, "flux_lm": 1200, "spectrum": hot_form(),
    });
    let on_plate = 1200.0 / cones * x * x * (3.0 - 2.0 * x) * cosine(30.0).powi(3) / 4.0;
    // A cone that falls in proportion to the angle, 0.4 m beside the plate: v = ½ + ½ · 0.2/¼ of a slide half as high.
    let (far2, tilt_deg) = (4.16_f64, 0.2_f64.atan().to_degrees());
    let ies = b"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 0\n0 60\n0\n400 0\n".to_vec();
    let luminaire = json!({
        "type": "luminaire", "file": "cone.ies", "position_m": [0, -0.4, 2], "nadir": [0, 0, -1], "forward": [1, 0, 0], "scale": 2.5,
        "spectrum": rising_form(), "slide": slide("v", 2.0),
    });
    let of_file = 2.5 * 400.0 * (1.0 - tilt_deg / 60.0) * (2.0 / far2.sqrt()) / far2;
    vec![
        truth(AtWavelength {
            name: "lumens-of-a-point-in-red",
            scene: lit(point),
            nm: 650.0,
            spectrum: hot,
            white: shown(1200.0 / (4.0 * PI) / 4.0),
            formula: "(ρ/π) Φ/(4πh²)",
            mistakes: vec![("a factor of 4π left out", 4.0 * PI), ("over a half-space", 2.0)],
        }),
        truth(AtWavelength {
            name: "candela-of-a-spot-with-a-gobo-in-blue",
            scene: lit(gobo),
            nm: 450.0,
            spectrum: rising,
            white: shown(300.0 * through * cos / r2),
            formula: "(ρ/π) I C cos θ/r²",
            mistakes: vec![
                ("the slide left out", 1.0 / through),
                ("left and right exchanged", 0.8 / through),
                ("evenly on a screen", cos.powi(-3)),
            ],
        }),
        truth(AtWavelength {
            name: "lumens-of-a-soft-spot-in-green",
            scene: lit(soft),
            nm: 530.0,
            spectrum: hot,
            white: shown(on_plate),
            formula: "(ρ/π) Φ/(2π(1 − ½cos 20° − ½cos 60°)) (3x² − 2x³) cos³30°/h²",
            mistakes: vec![
                ("the flux of a cone without a soft edge", (1.0 - 0.5 * (cosine(20.0) + 0.5)) / 0.5),
                ("lumens over the whole sphere", cones / (4.0 * PI)),
                ("as on its axis", 1.0 / (x * x * (3.0 - 2.0 * x))),
            ],
        }),
        truth(AtWavelength {
            name: "luminaire-scaled-behind-a-slide-in-red",
            scene: lit(luminaire).file("cone.ies", ies),
            nm: 640.0,
            spectrum: rising,
            white: shown(of_file * (0.2 + 0.8 * 0.9)),
            formula: "(ρ/π) 2.5 I(γ) C(v) cos γ/r²",
            mistakes: vec![
                ("the scale left out", 1.0 / 2.5),
                ("the slide left out", 1.0 / 0.92),
                ("upside down", 0.28 / 0.92),
                ("the other coordinate", 0.6 / 0.92),
            ],
        }),
    ]
}

/// Parallel light, a beam, and skies.
fn from_afar() -> Vec<Truth> {
    let sun =
        json!({ "type": "directional", "direction": [0.6, 0, -0.8], "illuminance_lx": 400, "spectrum": hot_form() });
    let beam = json!({
        "type": "beam", "position_m": [0.3, 0, 2], "direction": [0, 0, -1], "radius_m": 0.5, "profile": "gaussian", "flux_lm": 1200,
        "spectrum": rising_form(),
    });
    let off_axis = (-2.0_f64 * 0.36).exp();
    let sky = json!({ "type": "environment", "luminance_cd_per_m2": 500, "spectrum": hot_form() });
    let overcast = json!({
        "type": "environment",
        "sky": { "cie_type": 16, "up": [0, 0, 1], "zenith_luminance_cd_per_m2": 4000, "spectrum": rising_form() },
    });
    let look = Scene::pinhole([0.0; 3], [0.0, 0.0, -1.0], 60.0).light(sky).film(16, 16).spp(64);
    vec![
        truth(AtWavelength {
            name: "lux-of-parallel-light-in-violet",
            scene: lit(sun),
            nm: 420.0,
            spectrum: hot,
            white: shown(400.0 * 0.8),
            formula: "(ρ/π) E cos θ",
            mistakes: vec![("the cosine left out", 1.25)],
        }),
        truth(AtWavelength {
            name: "lumens-of-a-gaussian-beam-in-red",
            scene: lit(beam),
            nm: 690.0,
            spectrum: rising,
            white: shown(1200.0 * 2.0 * off_axis / (PI * 0.25)),
            formula: "(ρ/π) 2Φ e^(−2r²/w²)/(πw²)",
            mistakes: vec![("an even beam", 0.5 / off_axis), ("as on its axis", 1.0 / off_axis)],
        }),
        truth(AtWavelength {
            name: "candela-per-square-metre-of-a-sky-in-green",
            scene: look,
            nm: 510.0,
            spectrum: hot,
            white: 500.0,
            formula: "L",
            mistakes: vec![("divided by π", 1.0 / PI)],
        }),
        truth(AtWavelength {
            name: "overcast-sky-in-blue",
            scene: lit(overcast).spp(256),
            nm: 470.0,
            spectrum: rising,
            white: shown(7.0 * PI / 9.0 * 4000.0),
            formula: "(ρ/π) 7πL/9",
            mistakes: vec![("an even sky", 9.0 / 7.0)],
        }),
    ]
}

/// A lamp with a surface, seen at a slant.
fn surface() -> Truth {
    let lamp = json!({
        "shape": disk([0.0; 3], [0.0, 0.0, 1.0], 1.0), "material": black(),
        "emission": { "luminance_cd_per_m2": 2000, "spectrum": hot_form(), "sides": "front" },
    });
    truth(AtWavelength {
        name: "candela-per-square-metre-of-a-lamp-in-orange",
        scene: Scene::orthographic([1.0, 0.0, 2.0], [0.0; 3], 0.1).thing(lamp).film(16, 16).spp(64),
        nm: 600.0,
        spectrum: hot,
        white: 2000.0,
        formula: "L",
        mistakes: vec![("divided by π", 1.0 / PI), ("by the cosine", 0.8_f64.sqrt())],
    })
}

/// Parallel light of a colour of each white, which is the same colour by another spectrum.
fn whites() -> Truth {
    const COLOURS: [[f64; 3]; 3] = [[0.2, 0.9, 0.4], [1.0, 0.3, 0.1], [0.1, 0.5, 1.5]];
    const SCALES: [f64; 3] = [2.0, 0.75, 3.0];
    let directions: [Vec3; 3] = [[0.6, 0.0, -0.8], [0.0, -0.28, -0.96], [-0.8, 0.0, -0.6]];
    let sun = |scene: Scene, (at, white): (usize, &str)| {
        let irradiance = json!({ "type": "rgb", "rgb": COLOURS[at], "white": white, "scale": SCALES[at] });
        scene.light(json!({ "type": "directional", "direction": directions[at], "irradiance": irradiance }))
    };
    let scene = ["D65", "E", "A"].into_iter().enumerate().fold(Scene::light_meter().film(16, 16).spp(1024), sun);
    let of = move |luminance: &dyn Fn(usize) -> f64| {
        shown((0..3).map(|at| SCALES[at] * luminance(at) * -directions[at][2]).sum())
    };
    let [y_r, y_g, y_b] = [0.2126, 0.7152, 0.0722];
    let value = of(&|at| y_r * COLOURS[at][0] + y_g * COLOURS[at][1] + y_b * COLOURS[at][2]);
    Truth::new("three-suns-of-three-whites", &scene, value, "(ρ/π) Σ s cos θ (0.2126 R + 0.7152 G + 0.0722 B)")
        .because("An emission of a colour has the luminance of its channels times its scale, whichever white gives its spectrum the structure.")
        .confirmed("channel by channel", 1e-12, move || {
            [y_r, y_g, y_b].iter().enumerate().map(|(k, y)| y * of(&|at| COLOURS[at][k])).sum()
        })
        .allows(3e-4 * value, "the luminances of the primaries are rounded to four digits, and an upsampled colour is met to 1e-4")
        .or_else("red and blue exchanged", of(&|at| y_b * COLOURS[at][0] + y_g * COLOURS[at][1] + y_r * COLOURS[at][2]))
        .or_else("the suns of E and A left out", of(&|at| if at == 0 { y_r * 0.2 + y_g * 0.9 + y_b * 0.4 } else { 0.0 }))
        .or_else("the mean of the channels", of(&|at| mean(&COLOURS[at])))
        .or_else("the green channel alone", of(&|at| COLOURS[at][1]))
        .claims(Claim::PhotometricSensor)
        .sees(2e-3)
}

/// A point and a disk whose light is the same at every wavelength, as objects of the format say it.
fn constant() -> Truth {
    let same = |value: f64| json!({ "type": "constant", "value": value });
    let lamp = json!({
        "shape": disk([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 1.0), "material": black(), "emission": { "radiance": same(2.5), "sides": "front" },
    });
    let point = json!({ "type": "point", "position_m": [1, 0, 1], "intensity": same(7.0) });
    let value = shown(7.0 * 0.5_f64.sqrt() / 2.0 + 2.5 * PI / 10.0);
    Truth::new("point-and-disk-of-constants", &Scene::light_meter().light(point).thing(lamp).film(16, 16).spp(1024), value, "(ρ/π)(I cos θ/r² + πL a²/(a² + h²))")
        .because("A point 45° off the normal gives I cos θ/r², a disk above the plate πL times the squared sine of its half angle.")
        .confirmed("rings of the disk", 1e-6, || {
            const STEPS: u32 = 4000;
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
            let ring = |r: f64| TAU * r * 9.0 / (r * r + 9.0).powi(2) / f64::from(STEPS);
            shown(7.0 / 2.0 * (0.25 * PI).cos() + 2.5 * (0..STEPS).map(at).map(ring).sum::<f64>())
        })
        .or_else("the values left out", shown(0.5_f64.sqrt() / 2.0 + PI / 10.0))
        .or_else("the point's value for both", shown(7.0 * 0.5_f64.sqrt() / 2.0 + 0.7 * PI))
        .or_else("the disk's value for both", shown(2.5 * 0.5_f64.sqrt() / 2.0 + 0.25 * PI))
        .claims(Claim::WholeFormat)
        .sees(2e-3)
}
