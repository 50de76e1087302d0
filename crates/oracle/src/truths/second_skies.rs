//! What lies below the horizon of a sky of daylight, skies by images of two texels, and rooms rendered in other ways.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    cie171::LUX,
    meters::measured,
    scene::{Scene, grey_hdr, grey_png, lambert, shown, sphere},
    textures::decoded,
};
use crate::{quadrature::interval, vector::normalize};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![ground(), from_pole_to_pole(), around()];
    list.extend(rooms());
    list
}

/// The ground of a sky of daylight, straight below the eye: a share of the zenith's luminance.
fn ground() -> Truth {
    const TURBIDITY: f64 = 3.5;
    let (up, sun, share, scale) = ([0.2, -0.1, 1.0], [0.6, 0.3, 0.9], 0.45, 1.6);
    let [up_unit, sun_unit] = [up, sun].map(normalize);
    let of = |turbidity: f64| {
        let angle = up_unit.iter().zip(sun_unit).map(|(a, b)| a * b).sum::<f64>().acos();
        let chi = (4.0 / 9.0 - turbidity / 120.0) * (PI - 2.0 * angle);
        1000.0 * ((4.0453 * turbidity - 4.9710) * chi.tan() - 0.2155 * turbidity + 2.4192) / LUX
    };
    let daylight = json!({ "turbidity": TURBIDITY, "sun_direction": sun, "up": up, "ground": share, "scale": scale });
    let down = up.map(|x: f64| -x);
    let meter = json!({ "type": "radiance", "position_m": [0, 0, 0], "direction": down, "full_angle_deg": 20 });
    let scene = measured(&[meter]).light(json!({ "type": "environment", "daylight": daylight })).spp(1 << 12);
    let zenith = of(TURBIDITY);
    let value = share * scale * zenith;
    Truth::new("ground-below-daylight", &scene, value, "0.45 · 1.6 · 1000((4.0453 T − 4.9710) tan χ − 0.2155 T + 2.4192) cd/m², χ = (4/9 − T/120)(π − 2θₛ), over 683.002 lm/W · ∫ȳ dλ")
        .because("The ground has a share of the zenith's luminance, which the paper states by turbidity and the sun's angle; the scale multiplies all directions.")
        .confirmed("the angle by half the distance between both directions, and the tangent by sine and cosine", 1e-12, move || {
            let apart = up_unit.iter().zip(sun_unit).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            let chi = (4.0 / 9.0 - TURBIDITY / 120.0) * (PI - 4.0 * (0.5 * apart).asin());
            let kilo = (4.0453 * TURBIDITY - 4.9710) * chi.sin() / chi.cos() - 0.2155 * TURBIDITY + 2.4192;
            share * scale * 1000.0 * kilo / LUX
        })
        .allows(1e-4 * value, "2e-5 for single precision, and spectra are drawn as straight lines between nanometres")
        .or_else("the scale left out", share * zenith)
        .or_else("the share left out", scale * zenith)
        .or_else("a black ground", 0.0)
        .or_else("another turbidity", share * scale * of(TURBIDITY + 0.5))
        .claims(Claim::PhotometricSensor)
        .sees(3e-3)
}

/// A sky of one column and two rows, at the poles: linear in the angle from the one to the other.
fn from_pole_to_pole() -> Truth {
    let (top, bottom, scale) = (0.25, 0.75, 1.5);
    let image = json!({
        "file": "sky-of-two-rows.hdr", "encoding": "srgb", "projection": "latitude-longitude-at-poles", "scale": scale, "up": [0, 0, 1],
        "forward": [0, 1, 0],
    });
    let scene = Scene::light_meter()
        .light(json!({ "type": "environment", "image": image }))
        .file("sky-of-two-rows.hdr", grey_hdr(1, &[top, bottom]))
        .film(16, 16)
        .spp(1024);
    // 2π∫ (a + (b − a)θ/π) cos θ sin θ dθ over the upper half.
    let of = |a: f64, b: f64, scale: f64| shown(scale * (PI * a + 0.25 * PI * (b - a)));
    let (a, b) = (decoded(top), decoded(bottom));
    let by_bands = move |middle: f64, wide: f64| {
        let at = move |theta: f64| {
            let t = ((theta - middle) / wide + 0.5).clamp(0.0, 1.0);
            2.0 * PI * (a + t * (b - a)) * theta.cos() * theta.sin()
        };
        interval(at, 0.0, 0.25 * PI, 1e-11).value + interval(at, 0.25 * PI, 0.5 * PI, 1e-11).value
    };
    // Rows that are bands have their centres an eighth of a turn from the poles.
    let bands = shown(scale * by_bands(0.5 * PI, 0.5 * PI));
    Truth::new("sky-from-pole-to-pole-by-the-curve-of-srgb", &scene, of(a, b, scale), "(ρ/π) 1.5 (πa + π(b − a)/4), a and b decoded(¼) and decoded(¾)")
        .because("From a row at the one pole to a row at the other the radiance changes in proportion to the angle. A plate gathers L cos θ dω.")
        .confirmed("quadrature over the angle from the pole", 1e-9, move || shown(scale * by_bands(0.5 * PI, PI)))
        .allows(1e-4, "wavelengths and directions are drawn; colours of D65")
        .or_else("the curve left out", of(top, bottom, scale))
        .or_else("upside down", of(b, a, scale))
        .or_else("rows are bands", bands)
        .or_else("the scale left out", of(a, b, 1.0))
        .claims(Claim::PhotometricSensor)
        .sees(5e-3)
}

/// A sky of four columns whose bytes are taken as they are.
fn around() -> Truth {
    let (bytes, scale) = ([40_u8, 200, 90, 250], 2.0);
    let image = json!({ "file": "sky-of-four-columns.png", "encoding": "linear", "scale": scale, "up": [0, 0, 1], "forward": [0, 1, 0] });
    let scene = Scene::light_meter()
        .light(json!({ "type": "environment", "image": image }))
        .file("sky-of-four-columns.png", grey_png(&bytes))
        .film(16, 16)
        .spp(1024);
    let of = |curve: fn(f64) -> f64| bytes.iter().map(|&byte| curve(f64::from(byte) / 255.0)).sum::<f64>() / 4.0;
    let value = shown(scale * PI * of(|x| x));
    Truth::new("sky-of-four-columns-as-they-are-written", &scene, value, "ρ · 2 · the mean of 40, 200, 90 and 250 over 255")
        .because("Around a plate's normal the radiance goes from column to column and back. Its mean over all azimuths is that of the columns, at each height.")
        .confirmed("midpoints of azimuths between the columns", 1e-9, move || {
            let column = |i: usize| f64::from(bytes[i % 4]) / 255.0;
            let at = |k: usize| (k as f64 + 0.5) / 250.0;
            let mean = (0..1000).map(|k| column(k / 250) * (1.0 - at(k % 250)) + column(k / 250 + 1) * at(k % 250)).sum::<f64>() / 1000.0;
            0.5 * scale * mean
        })
        .allows(1e-4, "wavelengths and directions are drawn; colours of D65")
        .or_else("decoded as sRGB", shown(scale * PI * of(decoded)))
        .or_else("the scale left out", 0.5 * value)
        .claims(Claim::PhotometricSensor)
        .sees(5e-3)
}

/// A room whose walls shine and reflect, to a few edges of each path, as a scene can ask for it.
fn rooms() -> Vec<Truth> {
    const ALBEDO: f64 = 0.6;
    const RADIANCE: f64 = 0.5;
    let make = |name: &str, keys: [(&'static str, Value); 2], edges: u32| {
        let room = Scene::pinhole([0.3, 0.1, 0.2], [0.9, 0.3, 0.6], 90.0)
            .lamp(sphere([0.0; 3], 1.0), lambert(ALBEDO), RADIANCE, "both")
            .film(16, 16)
            .spp(256)
            .depth(edges);
        let scene = keys.into_iter().fold(room, |scene, (key, word)| scene.set("integrator", key, word));
        let sum = |edges: u32| RADIANCE * (1.0 - ALBEDO.powi(edges as i32)) / (1.0 - ALBEDO);
        Truth::new(name, &scene, sum(edges), format!("L(1 − ρᵐ)/(1 − ρ), m = {edges}, L = ½, ρ = 0.6"))
            .because("In a closed room whose walls emit L and reflect ρ each further edge of a path adds ρ times what the one before has added. How the picture is rendered changes nothing.")
            .confirmed("edge by edge", 1e-12, move || (0..edges as i32).map(|k| RADIANCE * ALBEDO.powi(k)).sum())
            .or_else("one edge fewer", sum(edges - 1))
            .or_else("one edge more", sum(edges + 1))
            .or_else("without a limit", RADIANCE / (1.0 - ALBEDO))
            .no_brighter_than(RADIANCE / (1.0 - ALBEDO))
            .sees(3e-3)
    };
    vec![
        make(
            "room-to-three-edges-by-path-reuse-2x2",
            [("path_reuse", json!("2x2")), ("sampler", json!("independent"))],
            3,
        ),
        make("room-to-four-edges-by-path-reuse-4x2", [("path_reuse", json!("4x2")), ("sampler", json!("sobol"))], 4),
    ]
}
