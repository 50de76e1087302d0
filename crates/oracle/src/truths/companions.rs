//! S₁, S₂ and S₃, each with its sign, of scenes whose S₀ other truths read.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::expectation::{Expectation, Expected};
use super::scene::{Scene, block, glass, shown};
use super::stokes::PARAMETERS;
use super::{Claim, Truth, air, glass as plates, irradiance::stack_transmittance, prisms};
use crate::laws::{FresnelPowers, fresnel_exact};
use crate::vector::{Vec3, cross, dot, normalize};

/// What the camera is rolled by where the light would else have S₁ alone.
pub(super) const ROLL_DEG: f64 = 25.0;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = plates_at_an_angle();
    list.extend(prism());
    list.extend(air_at_a_right_angle());
    list.extend(lamp_above_a_plate());
    list
}

/// The light of a picture, and what is said of it.
#[derive(Clone, Copy)]
pub(super) struct Light<'a> {
    /// S₁, S₂ and S₃.
    pub(super) stokes: [f64; 3],
    pub(super) formula: &'a str,
    pub(super) because: &'static str,
    /// What mistakes make of the three.
    pub(super) mistakes: &'a [(&'static str, [f64; 3])],
    pub(super) sees: f64,
    /// How the three are confirmed, and to what relative difference.
    pub(super) how: (&'static str, f64),
}

/// A truth for each parameter of the light of `base`'s scene, whose film keeps them: its name with `-s1`, `-s2` or `-s3`. One that is 0 is left
/// out unless a mistake changes it. `again` gives the three by other means.
pub(super) fn companions(
    base: &Truth,
    light: &Light<'_>,
    again: impl Fn() -> [f64; 3] + Clone + Send + Sync + 'static,
) -> Vec<Truth> {
    let all = || light.mistakes.iter().map(|(_, stokes)| *stokes).chain([light.stokes]);
    let largest = all().flatten().fold(0.0, |most: f64, s| most.max(s.abs()));
    let differ = |a: f64, b: f64| (a - b).abs() > 1e-3 * largest;
    let mut list = Vec::new();
    for (i, quantity) in PARAMETERS.into_iter().enumerate() {
        let is_zero = !differ(light.stokes[i], 0.0);
        let value = if is_zero { 0.0 } else { light.stokes[i] };
        if is_zero && !all().any(|stokes| differ(stokes[i], 0.0)) {
            continue;
        }
        let mut truth = Truth {
            name: format!("{}-s{}", base.name, i + 1),
            expected: Expected::Known(Expectation::new(value)),
            formula: format!("S{}: {}", ['₁', '₂', '₃'][i], light.formula),
            second_opinion: None,
            ..base.clone()
        }
        .because(light.because)
        .reads(quantity)
        .sees(light.sees);
        if is_zero {
            truth = truth.allows(1e-6 * largest, "single precision: terms that are not 0 cancel");
        } else {
            let again = again.clone();
            let (how, tolerance) = light.how;
            truth = truth
                .confirmed(how, tolerance, move || again()[i])
                .or_else("the other sign", -value)
                .or_else("light not polarised", 0.0);
        }
        for &(what, stokes) in light.mistakes.iter().filter(|(_, stokes)| differ(stokes[i], value)) {
            truth = truth.or_else(what, stokes[i]);
        }
        list.push(truth);
    }
    list
}

/// A truth's scene with a film that keeps the Stokes parameters, changed, under another name. Its value is that of S₀ as before.
pub(super) fn keeping_stokes(truth: &Truth, name: &str, change: impl FnOnce(&mut Value)) -> Truth {
    let mut scene: Value = serde_json::from_str(&truth.scene).expect("a truth's scene is JSON");
    scene["film"]["stokes"] = json!(true);
    change(&mut scene);
    let scene = serde_json::to_string_pretty(&scene).expect("a JSON value always prints");
    let mut claims = truth.claims.clone();
    if !claims.contains(&Claim::WholeFormat) {
        claims.push(Claim::WholeFormat);
    }
    Truth { name: name.to_owned(), scene, claims, ..truth.clone() }
}

/// Rolls the camera by [`ROLL_DEG`], from `right` away from `up`, over a film of 8 × 8 pixels of this many samples.
pub(super) fn rolled(scene: &mut Value, right: Vec3, up: Vec3, spp: u32) {
    let (sin, cos) = ROLL_DEG.to_radians().sin_cos();
    scene["camera"]["up"] = json!([0, 1, 2].map(|i: usize| cos * up[i] + sin * right[i]));
    small(scene, spp);
}

fn small(scene: &mut Value, spp: u32) {
    scene["film"]["width"] = json!(8);
    scene["film"]["height"] = json!(8);
    scene["integrator"]["spp"] = json!(spp);
}

/// The Stokes parameters that a rolled camera sees of light, from those of a camera without roll.
pub(super) fn seen_rolled([s1, s2, s3]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = (2.0 * ROLL_DEG).to_radians().sin_cos();
    [s1 * cos - s2 * sin, s1 * sin + s2 * cos, s3]
}

/// Light of an intensity that swings along a line at an angle to the right of the camera without roll.
pub(super) fn swings_rolled(intensity: f64, degrees: f64) -> [f64; 3] {
    let (sin, cos) = (degrees + ROLL_DEG).to_radians().sin_cos();
    [intensity * (cos * cos - sin * sin), intensity * 2.0 * sin * cos, 0.0]
}

fn find(list: &[Truth], name: &str) -> Truth {
    list.iter().find(|truth| truth.name == name).unwrap_or_else(|| panic!("no truth is named {name}")).clone()
}

/// Light through a plate: of all orders more of p than of s. The camera's right is p before it is rolled.
fn plates_at_an_angle() -> Vec<Truth> {
    let list = plates::truths();
    let of_degrees = |degrees: f64, sees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let name = format!("plate-at-{degrees}-degrees-polarised");
        let base = keeping_stokes(&find(&list, &name), &name, |scene| {
            rolled(scene, [cosine, 0.0, -sine], [0.0, 1.0, 0.0], 1024);
        });
        let powers = fresnel_exact(cosine, 1.5);
        let more = 0.5 * (stack_transmittance(&[powers.r_p; 2]) - stack_transmittance(&[powers.r_s; 2]));
        let first = 0.5 * ((1.0 - powers.r_p).powi(2) - (1.0 - powers.r_s).powi(2));
        let light = Light {
            stokes: seen_rolled([more, 0.0, 0.0]),
            formula: "½((1 − R_p)/(1 + R_p) − (1 − R_s)/(1 + R_s)) times cos 50°, sin 50°",
            because: "A plate passes (1 − R)/(1 + R) of each polarisation, more of that which swings in the plane of incidence. \
                      That plane lies at the roll's angle above the rows of the picture.",
            mistakes: &[
                ("the roll left out", [more, 0.0, 0.0]),
                ("one face alone", seen_rolled([0.5 * (powers.r_s - powers.r_p), 0.0, 0.0])),
            ],
            sees,
            how: ("the beams one by one, as light along two lines", 1e-9),
        };
        let with_orders = [light.mistakes, &[("first pass only", seen_rolled([first, 0.0, 0.0]))]].concat();
        // At 45° the orders add 3 % to the difference of the polarisations.
        let mistakes = if degrees > 45.0 { &with_orders[..] } else { light.mistakes };
        companions(&base, &Light { mistakes, ..light }, move || {
            let beams = |r: f64| (0..4000).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum::<f64>();
            let [p, s] = [(powers.r_p, 0.0), (powers.r_s, 90.0)].map(|(r, at)| swings_rolled(0.5 * beams(r), at));
            [0, 1, 2].map(|i| p[i] + s[i])
        })
    };
    [(45.0, 0.1), (75.0, 0.05), (89.0, 0.2)].into_iter().flat_map(|(degrees, sees)| of_degrees(degrees, sees)).collect()
}

/// Light through both faces of a prism. The camera's right lies in the plane of incidence.
fn prism() -> Vec<Truth> {
    let name = "prism-bk7-polarised";
    let base = keeping_stokes(&find(&prisms::truths(), name), name, |scene| small(scene, 1024));
    let n = prisms::bk7(587.5618);
    let powers = fresnel_exact((0.5 * n).asin().cos(), n);
    let light = Light {
        stokes: [0.25 * (powers.t_p.powi(2) - powers.t_s.powi(2)), 0.0, 0.0],
        formula: "¼(T_p² − T_s²)",
        because: "Half of the beam lands on the strip. Each face passes T_p of what swings in the plane of incidence, along the rows of the \
                  picture, and T_s of what swings across it.",
        mistakes: &[
            ("one face alone", [0.25 * (powers.t_p - powers.t_s), 0.0, 0.0]),
            ("all of the beam", [0.5 * (powers.t_p.powi(2) - powers.t_s.powi(2)), 0.0, 0.0]),
        ],
        sees: 0.05,
        how: ("Fresnel's amplitudes by the sines and tangents of both angles", 1e-9),
    };
    companions(&base, &light, move || {
        let (outside, inside) = ((0.5 * n).asin(), PI / 6.0);
        let r_s = ((outside - inside).sin() / (outside + inside).sin()).powi(2);
        let r_p = ((outside - inside).tan() / (outside + inside).tan()).powi(2);
        [0.25 * ((1.0 - r_p).powi(2) - (1.0 - r_s).powi(2)), 0.0, 0.0]
    })
}

/// Light that air scattered by a right angle, behind polarisers and without one.
fn air_at_a_right_angle() -> Vec<Truth> {
    let list = air::truths();
    let [across, along, slanting] = ["a-polariser-across", "a-polariser-along", "a-slanting-polariser"]
        .map(|by| find(&list, &format!("air-at-a-right-angle-by-{by}")));
    let seen = across.value();
    let opinion = across.second_opinion.clone().expect("it is confirmed by dipoles");
    let light = Light {
        stokes: [0.0; 3],
        formula: "3σ/(16π) E ∫ e^(−σs) ds e^(−σa), times sin²φ behind a polariser at φ, along its axis",
        because: "Scattered by a right angle, light swings across the plane of scattering, along the columns of the picture. Behind a \
                  polariser it swings along that one's axis.",
        mistakes: &[],
        sees: 0.01,
        how: ("dipoles in light of every direction of swing, depth by depth", 1e-8),
    };
    let behind = |truth: &Truth, degrees: f64, share: f64, mistakes: &[(&'static str, [f64; 3])]| {
        let base = keeping_stokes(truth, &truth.name, |scene| small(scene, 1024));
        let (sin, cos) = (2.0 * degrees).to_radians().sin_cos();
        let opinion = opinion.clone();
        companions(
            &base,
            &Light { stokes: [share * seen * cos, share * seen * sin, 0.0], mistakes, ..light },
            move || {
                let (sin, cos) = degrees.to_radians().sin_cos();
                [cos * cos - sin * sin, 2.0 * sin * cos, 0.0].map(|turned| share * turned * opinion.value())
            },
        )
    };
    let unpolarised = ("light not polarised before the polariser", [0.5 * seen, 0.0, 0.0]);
    let left_out = ("the polariser left out", [-seen, 0.0, 0.0]);
    let mut list = behind(&across, 90.0, 1.0, &[("light not polarised before the polariser", [-0.5 * seen, 0.0, 0.0])]);
    list.extend(behind(&along, 0.0, 0.0, &[unpolarised, left_out, ("polarised within the plane", [seen, 0.0, 0.0])]));
    list.extend(behind(&slanting, 45.0, 0.5, &[left_out]));
    // Without the polariser, which is the second object.
    let bare = keeping_stokes(&across, "air-at-a-right-angle-by-a-rolled-camera", |scene| {
        rolled(scene, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1024);
        scene["objects"].as_array_mut().expect("a list").truncate(1);
        scene["integrator"]["max_depth"] = json!(2);
    });
    let unanalysed = Light {
        stokes: seen_rolled([-seen, 0.0, 0.0]),
        formula: "3σ/(16π) E ∫ e^(−σs) ds e^(−σa), times −cos 50°, −sin 50°",
        because: "Scattered by a right angle, light swings across the plane of scattering alone: along y, which lies at the roll's angle \
                  to the columns of the picture.",
        mistakes: &[("the roll left out", [-seen, 0.0, 0.0])],
        ..light
    };
    list.extend(companions(&bare, &unanalysed, move || swings_rolled(opinion.value(), 90.0)));
    list
}

/// The meter of `lamp-above-a-plate-in-polarised-light`, a Lambert plate: light that a plate of glass has polarised leaves it unpolarised.
fn lamp_above_a_plate() -> Vec<Truth> {
    const LAMP_M: f64 = 2.0;
    const THICKNESS_M: f64 = 0.4;
    const ASIDE_M: f64 = 1.1;
    const INDEX: f64 = 1.5;
    let scene = Scene::light_meter()
        .object(block([-200.0, -200.0, 0.6], [200.0, 200.0, 0.6 + THICKNESS_M]), glass(INDEX))
        .point_light([ASIDE_M, 0.0, LAMP_M], 1.0)
        .film(8, 8)
        .spp(64)
        .set("film", "stokes", json!(true));
    // What a plate that kept polarisation would show of the direct beam, in frames across the rays to the lamp and to the eye.
    let tangent = |sine: f64| sine / (1.0 - sine * sine).sqrt();
    let aside = |sine: f64| (LAMP_M - THICKNESS_M) * tangent(sine) + THICKNESS_M * tangent(sine / INDEX);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if aside(middle) < ASIDE_M { low = middle } else { high = middle }
    }
    let (sine, cosine) = (low, (1.0 - low * low).sqrt());
    let FresnelPowers { t_s, t_p, .. } = fresnel_exact(cosine, INDEX);
    let inside = sine / INDEX;
    let spreads = (LAMP_M - THICKNESS_M) / cosine.powi(3) + THICKNESS_M / (INDEX * (1.0 - inside * inside).powf(1.5));
    let more = 0.5 * (t_s * t_s - t_p * t_p) * sine / cosine / (ASIDE_M * spreads);
    let (to_eye, to_lamp): (Vec3, Vec3) = ([0.0, -(0.75_f64.sqrt()), 0.5], [sine, 0.0, cosine]);
    let across = normalize(cross(to_eye, to_lamp));
    let angle = |of: Vec3, x: Vec3, along: Vec3| dot(of, cross(along, x)).atan2(dot(of, x));
    let turned = 2.0 * (angle([0.0, 1.0, 0.0], across, to_lamp.map(|x| -x)) + angle(across, [1.0, 0.0, 0.0], to_eye));
    let kept = [turned.cos(), turned.sin(), 0.0].map(|turned| shown(more) * turned);
    let base = Truth::new("lamp-above-a-plate-in-polarised-light", &scene, 0.0, "0")
        .claims(Claim::CarriesPolarisation)
        .claims(Claim::SpecularConnections);
    let light = Light {
        stokes: [0.0; 3],
        formula: "0",
        because: "A Lambert surface forgets how light swings that it scatters.",
        mistakes: &[("polarisation kept by the Lambert plate", kept)],
        sees: 0.01,
        how: ("", 0.0),
    };
    companions(&base, &light, || [0.0; 3])
}
