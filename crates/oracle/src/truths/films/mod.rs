//! Thin films on glass, on metal, on facets and alone: what they reflect, what they pass, and in which phase.

mod bodies;
mod clear;
mod metals;

use serde_json::{Value, json};

use super::{
    Claim, Truth, photometric_weight,
    scene::{Scene, black, level_square},
};
use crate::laws::{CoatedInterface, FilmLayer};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = clear::one_film();
    list.extend(clear::stacks());
    list.extend(clear::from_both_sides());
    list.extend(metals::metals());
    list.extend(metals::layers_of_metal());
    list.extend(bodies::rough());
    list.extend(bodies::panes());
    list.extend(bodies::places());
    list.extend(bodies::polarised());
    list.into_iter().map(|truth| truth.claims(Claim::ThinFilms)).collect()
}

/// A band so narrow that it counts as one wavelength, nm.
fn at(wavelength_nm: f64) -> [f64; 2] {
    [wavelength_nm - 5e-4, wavelength_nm + 5e-4]
}

/// A material with layers from the outermost to the innermost.
fn coated(mut material: Value, layers: &[FilmLayer]) -> Value {
    let layer = |[n, k, thickness_nm]: &FilmLayer| match *k {
        0.0 => json!({ "thickness_nm": thickness_nm, "index": n }),
        k => json!({ "thickness_nm": thickness_nm, "wavelengths_nm": [300, 900], "n": [n, n], "k": [k, k] }),
    };
    material["thin_film"] = layers.iter().map(layer).collect();
    material
}

/// A large square at z = 0 seen in parallel rays from above at a cosine to its normal; it faces up, or down.
fn seen(material: Value, cos: f64, faces_up: bool) -> Scene {
    let sin = (1.0 - cos * cos).sqrt();
    Scene::orthographic([0.0, -2.0 * sin, 2.0 * cos], [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 10.0, faces_up), "material": material }))
        .film(16, 16)
        .spp(1024)
}

/// What it reflects of a sky of 1, over black.
fn reflecting(material: Value, cos: f64, faces_up: bool) -> Scene {
    seen(material, cos, faces_up).object(level_square([0.0, 0.0, -0.1], 10.0, true), black()).sky(1.0)
}

/// What it passes of a lamp of 1 below it.
fn passing(material: Value, cos: f64, faces_up: bool) -> Scene {
    seen(material, cos, faces_up).lamp(level_square([0.0, 0.0, -0.1], 10.0, true), black(), 1.0, "front")
}

const SHOWS: &str = "Under a sky of radiance 1, over black, a flat interface shows the share of unpolarised light that it reflects: the waves that \
                     the faces of its layers reflect add with their phases.";

/// R at normal incidence of one film by Airy's closed form.
fn airy([n0, n1, n2]: [f64; 3], thickness_nm: f64, nm: f64) -> f64 {
    let (a, b) = ((n0 - n1) / (n0 + n1), (n1 - n2) / (n1 + n2));
    let both = 2.0 * a * b * (4.0 * std::f64::consts::PI * n1 * thickness_nm / nm).cos();
    (a * a + b * b + both) / (1.0 + a * a * b * b + both)
}

/// `n 1, 2.35 (60 nm), 1.5`.
fn named(stack: &CoatedInterface) -> String {
    let index = |n: f64, k: f64| if k == 0.0 { format!("{n}") } else { format!("{n} + {k}i") };
    let layers = stack.layers.iter().map(|[n, k, thickness]| format!("{} ({thickness} nm), ", index(*n, *k)));
    format!("n {}, {}{}", stack.incident, layers.collect::<String>(), index(stack.substrate[0], stack.substrate[1]))
}

/// The mean of a function of the wavelength as the observer weighs it.
fn luminance(of: impl Fn(f64) -> f64) -> f64 {
    (0..=470).map(|i| f64::from(360 + i)).map(|nm| photometric_weight(nm) * of(nm)).sum()
}

/// Shares of unpolarised light by the wave equation at 64 cosines, linear between them.
fn by_wave_equation(stack: &CoatedInterface, nm: f64) -> impl Fn(f64) -> [f64; 2] + use<> {
    let at = |i: u32| stack.by_wave_equation(nm, (f64::from(i) / 64.0).max(1e-3));
    let table: Vec<[f64; 2]> = (0..=64).map(at).map(|waves| [waves.reflectance(), waves.transmittance()]).collect();
    move |cos| {
        let i = ((cos * 64.0) as usize).min(63);
        let share = cos * 64.0 - i as f64;
        [0, 1].map(|k| table[i][k] + share * (table[i + 1][k] - table[i][k]))
    }
}
