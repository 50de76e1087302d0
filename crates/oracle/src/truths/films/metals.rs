//! Films on metals, and layers that are of metal themselves.

use serde_json::{Value, json};

use super::{SHOWS, at, coated, luminance, named, reflecting};
use crate::laws::{CoatedInterface, FilmLayer};
use crate::truths::scene::{conductor, glass};
use crate::truths::{Claim, Truth};

pub(super) fn metals() -> Vec<Truth> {
    let (n, k) = (2.2, 2.9);
    let oxide = CoatedInterface { incident: 1.0, layers: vec![[2.4, 0.0, 60.0]], substrate: [n, k] };
    let metal = || coated(conductor(n, k), &oxide.layers);
    let bare = CoatedInterface { layers: Vec::new(), ..oxide.clone() };
    let mut list = Vec::new();
    let all = oxide.clone();
    list.push(
        Truth::new(
            "anodised-titanium",
            &reflecting(metal(), 1.0, true),
            luminance(|nm| oxide.waves(nm, 1.0).reflectance()),
            "ȳ-weighted mean of R(λ): n 1, 2.4, 2.2 + 2.9i; 60 nm",
        )
        .because(SHOWS)
        .confirmed("the wave equation", 1e-6, move || luminance(|nm| all.by_wave_equation(nm, 1.0).reflectance()))
        .or_else("the film left out", bare.waves(550.0, 1.0).reflectance())
        .claims(Claim::PhotometricSensor)
        .sees(5e-3),
    );
    for nm in [430.0, 620.0] {
        let again = oxide.clone();
        let half = CoatedInterface { layers: vec![[2.4, 0.0, 30.0]], ..oxide.clone() };
        list.push(
            Truth::new(
                format!("anodised-titanium-at-70-degrees-and-{nm}-nanometres"),
                &reflecting(metal(), 0.34, true).band(at(nm)),
                oxide.waves(nm, 0.34).reflectance(),
                format!("Airy: n 1, 2.4, 2.2 + 2.9i; 60 nm at {nm} nm, cos θ = 0.34"),
            )
            .because(SHOWS)
            .confirmed("the wave equation", 1e-6, move || again.by_wave_equation(nm, 0.34).reflectance())
            .or_else("the film left out", bare.waves(nm, 0.34).reflectance())
            .or_else("half of the phase", half.waves(nm, 0.34).reflectance())
            .sees(2e-3),
        );
    }
    list
}

/// Layers of metal on glass, by name and by a table.
pub(super) fn layers_of_metal() -> Vec<Truth> {
    let truth = |name: String, layer: Value, nm: f64, [n, k, thickness]: FilmLayer| {
        let mut material = glass(1.5);
        material["thin_film"] = json!([layer]);
        let stack = CoatedInterface::single(1.0, [n, k, thickness], 1.5);
        let again = stack.clone();
        Truth::new(
            name,
            &reflecting(material, 1.0, true).band(at(nm)),
            stack.waves(nm, 1.0).reflectance(),
            format!("Airy: {} at {nm} nm", named(&stack)),
        )
        .because(SHOWS)
        .confirmed("the wave equation", 1e-6, move || again.by_wave_equation(nm, 1.0).reflectance())
        .or_else("k left out", CoatedInterface::single(1.0, [n, 0.0, thickness], 1.5).waves(nm, 1.0).reflectance())
        .or_else(
            "the metal, endlessly thick",
            CoatedInterface { layers: Vec::new(), substrate: [n, k], ..stack }.waves(nm, 1.0).reflectance(),
        )
        .sees(0.01)
    };
    // The rows of Johnson and Christy (1972) at 2.38 eV and 2.26 eV, of Rakić (1995) at 2.2 eV: n, k.
    let mut list: Vec<Truth> = [
        ("Ag", 520.9, 0.05, 3.324),
        ("Au", 520.9, 0.62, 2.081),
        ("Cu", 548.6, 1.02, 2.577),
        ("Al", 563.57, 1.0728, 6.7839),
    ]
    .into_iter()
    .map(|(metal, nm, n, k)| {
        let layer = json!({ "thickness_nm": 12, "metal": metal });
        truth(format!("layer-of-{}-on-glass", metal.to_lowercase()), layer, nm, [n, k, 12.0])
            .allows(2e-4, "wavelengths of the rows are rounded to a tenth of a nanometre")
    })
    .collect();
    let table = json!({ "thickness_nm": 30, "wavelengths_nm": [500, 600], "n": [2, 3], "k": [0.5, 1.5], "outside_fit": "clamp" });
    list.push(
        truth("layer-of-a-table-beyond-its-rows".to_owned(), table, 650.0, [3.0, 1.5, 30.0])
            .or_else("continued", CoatedInterface::single(1.0, [3.5, 2.0, 30.0], 1.5).waves(650.0, 1.0).reflectance()),
    );
    list
}
