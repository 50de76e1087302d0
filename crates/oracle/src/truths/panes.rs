//! Panes that no limit on edges counts: light comes straight through any number of them, and what they reflect is one edge more. And how a pane
//! polarises.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::companions::{self, Light, ROLL_DEG};
use super::expectation::Expectation;
use super::scene::{Scene, black, disk, lambert, level_square, shown, sphere};
use super::{Claim, Truth};
use crate::laws::fresnel_exact;
use crate::quadrature::{Cone, directions, interval};
use crate::vector::{length, scale};

const INDEX: f64 = 1.5;
/// Far enough that no light comes by way of an edge.
const FAR_M: f64 = 2000.0;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![
        three_panes_in_a_row(),
        disk_lamp(),
        behind_one_and_behind_two(),
        lamp_at_a_point("never").claims(Claim::SpecularConnections),
        lamp_at_a_point("always").claims(Claim::SpecularConnections),
    ];
    list.extend(between_two_lamps());
    list
}

fn pane(height_m: f64, half_m: f64) -> Value {
    let material = json!({ "type": "thin-dielectric", "index": INDEX });
    json!({ "shape": level_square([0.0, 0.0, height_m], half_m, false), "material": material })
}

/// A scene whose paths have at most `edges` edges. Those through panes do not count.
fn limited(scene: Scene, edges: u32) -> Scene {
    scene.depth(edges).set("integrator", "count_panes", json!(false))
}

/// What a pane lets pass of unpolarised light: all reflections between its faces included.
fn passes(cosine: f64) -> f64 {
    let powers = fresnel_exact(cosine, INDEX);
    let through = |r: f64| (1.0 - r) / (1.0 + r);
    0.5 * (through(powers.r_s) + through(powers.r_p))
}

/// The same, added up beam by beam.
fn passes_beam_by_beam(cosine: f64) -> f64 {
    let powers = fresnel_exact(cosine, INDEX);
    let through = |r: f64| (0..60).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum::<f64>();
    0.5 * (through(powers.r_s) + through(powers.r_p))
}

/// A lamp below three panes, and a brighter one above, which the panes would reflect.
fn three_panes_in_a_row() -> Truth {
    let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 0.1)
        .thing(pane(0.3, FAR_M))
        .thing(pane(0.2, FAR_M))
        .thing(pane(0.1, FAR_M))
        .lamp(disk([0.0; 3], [0.0, 0.0, 1.0], 0.5), black(), 1.0, "front")
        .lamp(disk([0.0, 0.0, 2.0], [0.0, 0.0, -1.0], 0.5), black(), 3.0, "front")
        .film(16, 16)
        .spp(1024);
    let reflectance = fresnel_exact(1.0, INDEX).reflectance();
    let once = (1.0 - reflectance) / (1.0 + reflectance);
    Truth::new("three-panes-that-no-limit-counts", &limited(scene, 1), once.powi(3), "((1 − R)/(1 + R))³")
        .because(
            "One edge is left: straight through the panes to the lamp. What two panes reflect to and fro has three.",
        )
        .confirmed("the passes to and fro within each pane, one by one", 1e-12, || passes_beam_by_beam(1.0).powi(3))
        .or_else("panes counted", 0.0)
        .or_else("what panes reflect to and fro as well", (1.0 - reflectance) / (1.0 + 5.0 * reflectance))
        .or_else("the lamp above reflected once by each pane", {
            let reflected = 1.0 - once;
            once.powi(3) + 3.0 * reflected * (1.0 + once.powi(2) + once.powi(4))
        })
        .sees(2e-3)
}

/// A lamp with an area, found by shadow rays through the pane and by chance.
fn disk_lamp() -> Truth {
    const LAMP_M: f64 = 1.5;
    const RADIUS_M: f64 = 1.2;
    let scene = Scene::light_meter()
        .thing(pane(0.5, FAR_M))
        .lamp(disk([0.0, 0.0, LAMP_M], [0.0, 0.0, -1.0], RADIUS_M), black(), 1.0, "front")
        .spp(1 << 10);
    let irradiance = |transmittance: fn(f64) -> f64| {
        let of_ring = |theta: f64| transmittance(theta.cos()) * theta.cos() * theta.sin();
        2.0 * PI * interval(of_ring, 0.0, (RADIUS_M / LAMP_M).atan(), 1e-12).value
    };
    Truth::new(
        "disk-lamp-behind-a-pane-that-no-limit-counts",
        &limited(scene, 2),
        shown(irradiance(passes)),
        "(ρ/π) 2πL ∫ ½Σ (1 − R)/(1 + R) cos θ sin θ dθ",
    )
    .because("Two edges, to the plate and straight on to the lamp: the pane between them is none.")
    .confirmed("the passes to and fro within the pane, one by one", 1e-9, move || {
        shown(irradiance(passes_beam_by_beam))
    })
    .or_else("panes counted", 0.0)
    .or_else("no pane", shown(irradiance(|_| 1.0)))
    .sees(5e-3)
}

/// A small lamp behind a pane, and a wide one behind the same and another: as edges, the second pane would be one too many.
fn behind_one_and_behind_two() -> Truth {
    const HEIGHT_M: f64 = 1.5;
    const WIDE_M: f64 = 0.6;
    const SMALL_M: f64 = 0.05;
    const BRIGHT: f64 = 100.0;
    let small = [1.5, 0.0, HEIGHT_M];
    let scene = Scene::light_meter()
        .thing(pane(0.5, FAR_M))
        .thing(pane(0.6, 0.4))
        .lamp(disk([0.0, 0.0, HEIGHT_M], [0.0, 0.0, -1.0], WIDE_M), black(), 1.0, "front")
        .lamp(sphere(small, SMALL_M), black(), BRIGHT, "front")
        .set("integrator", "light_tracing", json!("never"));
    let (distance, axis) = (length(small), scale(1.0 / length(small), small));
    let cone = Cone::new(axis, (SMALL_M / distance).asin());
    let of_small = move |transmittance: fn(f64) -> f64| {
        BRIGHT * directions(|d| transmittance(d[2]) * d[2], cone, 1e-9, 100_000).value
    };
    let of_wide = |transmittance: fn(f64) -> f64, panes: i32| {
        let of_ring = |theta: f64| transmittance(theta.cos()).powi(panes) * theta.cos() * theta.sin();
        2.0 * PI * interval(of_ring, 0.0, (WIDE_M / HEIGHT_M).atan(), 1e-12).value
    };
    let work_out = move || {
        let (small, wide) = (of_small(passes), of_wide(passes, 2));
        Expectation::new(shown(small + wide))
            .allows(1e-6, "the quadrature over the small lamp; and single precision")
            .or_else("panes counted", shown(small))
            .or_else("the wide lamp behind one pane", shown(small + of_wide(passes, 1)))
            .or_else("no panes", shown(of_small(|_| 1.0) + of_wide(|_| 1.0, 0)))
    };
    Truth::later(
        "lamps-behind-one-pane-and-behind-two-that-no-limit-counts",
        &limited(scene, 3),
        "(ρ/π) (L ∫ T cos θ dω + 2πL′ ∫ T² cos θ sin θ dθ), T = ½Σ (1 − R)/(1 + R)",
        work_out,
    )
    .because("Two edges, to the plate and straight on to a lamp. What panes reflect to and fro takes two more, and the limit is one.")
    .confirmed("the passes to and fro within the panes, and the small lamp as it is in its middle", 1e-3, move || {
        let solid_angle = 2.0 * PI * cone.one_minus_cos;
        shown(BRIGHT * passes_beam_by_beam(axis[2]) * axis[2] * solid_angle + of_wide(passes_beam_by_beam, 2))
    })
    .sees(0.01)
}

/// A lamp without area, searched for through the pane, or found from the lamp.
fn lamp_at_a_point(light_paths: &str) -> Truth {
    const LAMP_M: f64 = 0.9;
    const HALF_M: f64 = 0.15;
    let scene = Scene::orthographic([0.0, 0.0, 0.4], [0.0; 3], 2.0 * HALF_M)
        .up([0.0, 1.0, 0.0])
        .object(level_square([0.0; 3], 0.2, true), lambert(0.5))
        .thing(pane(0.6, HALF_M))
        .point_light([0.0, 0.0, LAMP_M], 1.0)
        .set("integrator", "light_tracing", json!(light_paths))
        .film(16, 16)
        .spp(256);
    // The mean of T I h/r³ over the square.
    let mean = |transmittance: fn(f64) -> f64| {
        let at = |x: f64, y: f64| {
            let distance = (x * x + y * y + LAMP_M * LAMP_M).sqrt();
            transmittance(LAMP_M / distance) * LAMP_M / distance.powi(3)
        };
        let row = |x: f64| interval(|y| at(x, y), 0.0, HALF_M, 1e-12).value;
        interval(row, 0.0, HALF_M, 1e-12).value / (HALF_M * HALF_M)
    };
    Truth::new(
        format!("lamp-at-a-point-behind-a-pane-that-no-limit-counts-with-light-paths-{light_paths}"),
        &limited(scene, 2),
        shown(mean(passes)),
        "(ρ/π) ∫ ½Σ (1 − R)/(1 + R) I h/r³ dA / A",
    )
    .because("Two edges, to the floor and straight on to the lamp: the pane between them is none. What floor and pane send to each other has more.")
    .confirmed("the passes to and fro within the pane, one by one", 1e-9, move || shown(mean(passes_beam_by_beam)))
    .or_else("panes counted", 0.0)
    .or_else("no pane", shown(mean(|_| 1.0)))
    .sees(5e-3)
}

/// S₁ and S₂ of a pane at 60°, seen by a rolled camera: a lamp behind it, and one of three times the radiance before it.
fn between_two_lamps() -> Vec<Truth> {
    let (cosine, sine) = (0.5_f64, 0.75_f64.sqrt());
    let (sin, cos) = ROLL_DEG.to_radians().sin_cos();
    // The camera's right is p before it is rolled.
    let scene = Scene::orthographic([sine, 0.0, cosine], [0.0; 3], 1e-3)
        .up([sin * cosine, cos, -sin * sine])
        .thing(pane(0.0, 10.0))
        .lamp(level_square([0.0, 0.0, -1.0], 20.0, true), black(), 1.0, "front")
        .lamp(disk([-3.0 * sine, 0.0, 3.0 * cosine], [sine, 0.0, -cosine], 0.5), black(), 3.0, "front")
        .set("film", "stokes", json!(true))
        .film(8, 8)
        .spp(1024);
    let powers = fresnel_exact(cosine, INDEX);
    let through = |r: f64| (1.0 - r) / (1.0 + r);
    let more = 0.5 * (through(powers.r_p) - through(powers.r_s));
    let seen = |behind: f64, before: f64| companions::seen_rolled([(behind - before) * more, 0.0, 0.0]);
    let base = Truth::new("pane-between-two-lamps", &scene, 0.0, "").claims(Claim::CarriesPolarisation);
    let light = Light {
        stokes: seen(1.0, 3.0),
        formula: "(1 − 3)·½((1 − R_p)/(1 + R_p) − (1 − R_s)/(1 + R_s)) times cos 50°, sin 50°",
        because: "A pane passes (1 − R)/(1 + R) of each polarisation and reflects the rest: of the lamp behind it more of p is seen, of the \
                  one before it as much more of s.",
        mistakes: &[
            ("the reflected light not polarised", seen(1.0, 0.0)),
            ("what passes not polarised", seen(0.0, 3.0)),
            ("one face alone", companions::seen_rolled([powers.r_p - powers.r_s, 0.0, 0.0])),
        ],
        sees: 0.05,
        how: ("the beams one by one, as light along two lines", 1e-9),
    };
    companions::companions(&base, &light, move || {
        let beams = |r: f64| (0..60).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum::<f64>();
        // Of each half, what passes and three times what does not.
        let halves = [(powers.r_p, 0.0), (powers.r_s, 90.0)];
        let [p, s] =
            halves.map(|(r, degrees)| companions::swings_rolled(0.5 * (beams(r) + 3.0 * (1.0 - beams(r))), degrees));
        [0, 1, 2].map(|i| p[i] + s[i])
    })
}
