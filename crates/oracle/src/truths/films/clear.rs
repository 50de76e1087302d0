//! Clear films: one, several, and seen from both sides.

use serde_json::json;

use super::{SHOWS, airy, at, coated, luminance, named, passing, reflecting};
use crate::laws::{CoatedInterface, FilmWaves};
use crate::truths::scene::{Scene, glass, glass_in, sphere};
use crate::truths::{Claim, Truth};

pub(super) fn one_film() -> Vec<Truth> {
    let mut list = Vec::new();
    let quarter_nm = 550.0 / (4.0 * 1.38);
    for nm in [450.0, 550.0, 650.0] {
        let scene = reflecting(coated(glass(1.5), &[[1.38, 0.0, quarter_nm]]), 1.0, true).band(at(nm));
        let value = airy([1.0, 1.38, 1.5], quarter_nm, nm);
        list.push(
            Truth::new(
                format!("quarter-wave-of-magnesium-fluoride-at-{nm}-nanometres"),
                &scene,
                value,
                format!("Airy: n 1, 1.38, 1.5; 550/(4 · 1.38) nm at {nm} nm"),
            )
            .because(SHOWS)
            .confirmed("the wave equation", 1e-7, move || {
                CoatedInterface::single(1.0, [1.38, 0.0, quarter_nm], 1.5).by_wave_equation(nm, 1.0).reflectance()
            })
            .or_else("the film left out", 0.04)
            .or_else("half of the phase", airy([1.0, 1.38, 1.5], 0.5 * quarter_nm, nm))
            .sees(0.05),
        );
    }
    for nm in [500.0, 600.0, 700.0] {
        let scene = reflecting(coated(glass(1.0), &[[1.33, 0.0, 300.0]]), 1.0, true).band(at(nm));
        let value = airy([1.0, 1.33, 1.0], 300.0, nm);
        list.push(
            Truth::new(
                format!("soap-film-at-{nm}-nanometres"),
                &scene,
                value,
                format!("Airy: n 1, 1.33, 1; 300 nm at {nm} nm"),
            )
            .because(SHOWS)
            .confirmed("the wave equation", 1e-7, move || {
                CoatedInterface::single(1.0, [1.33, 0.0, 300.0], 1.0).by_wave_equation(nm, 1.0).reflectance()
            })
            .or_else("half of the phase", airy([1.0, 1.33, 1.0], 150.0, nm))
            .or_else("two faces without interference", 2.0 * 0.020_056 / 1.020_056)
            .sees(0.05),
        );
    }
    let soap = CoatedInterface::single(1.0, [1.33, 0.0, 420.0], 1.0);
    let scene = reflecting(coated(glass(1.0), &soap.layers), 0.5, true);
    let at_cosine = |of: &CoatedInterface, cos: f64| luminance(|nm| of.waves(nm, cos).reflectance());
    let again = soap.clone();
    list.push(
        Truth::new(
            "soap-film-at-60-degrees",
            &scene,
            at_cosine(&soap, 0.5),
            "ȳ-weighted mean of R(λ): n 1, 1.33, 1; 420 nm, 60°",
        )
        .because(SHOWS)
        .confirmed("the wave equation", 1e-6, move || luminance(|nm| again.by_wave_equation(nm, 0.5).reflectance()))
        .or_else("the phase of normal incidence", {
            let thicker = [1.33, 0.0, 420.0 / (1.0 - 0.75 / (1.33_f64 * 1.33)).sqrt()];
            at_cosine(&CoatedInterface::single(1.0, thicker, 1.0), 0.5)
        })
        .claims(Claim::PhotometricSensor),
    );
    let ball = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0)
        .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": coated(glass(1.0), &[[1.33, 0.0, 420.0]]) }))
        .sky(1.0)
        .spp(64);
    list.push(
        Truth::new("soap-bubble-in-a-furnace", &ball, 1.0, "R + T = 1")
            .because("Where all light has the radiance 1, a film that absorbs nothing changes nothing, whatever it reflects.")
            .sees(0.002),
    );
    list
}

pub(super) fn stacks() -> Vec<Truth> {
    let truth = |name: &str, stack: &CoatedInterface, (nm, cos): (f64, f64)| {
        let material = coated(glass_in(stack.substrate[0], stack.incident), &stack.layers);
        let scene = reflecting(material, cos, true).band(at(nm));
        let again = stack.clone();
        Truth::new(
            name,
            &scene,
            stack.waves(nm, cos).reflectance(),
            format!("Rouard: {} at {nm} nm, cos θ = {cos}", named(stack)),
        )
        .because(SHOWS)
        .confirmed("the wave equation", 1e-6, move || again.by_wave_equation(nm, cos).reflectance())
        .sees(0.01)
    };
    let pair =
        CoatedInterface { incident: 1.0, layers: vec![[2.35, 0.0, 60.0], [1.46, 0.0, 90.0]], substrate: [1.52, 0.0] };
    let reversed = CoatedInterface { layers: vec![pair.layers[1], pair.layers[0]], ..pair.clone() };
    let (high, low) = ([2.35, 0.0, 58.5], [1.46, 0.0, 94.2]);
    let mirror = CoatedInterface { layers: [[high, low]; 3].concat(), ..pair.clone() };
    let mut list = vec![
        truth("two-layers-on-glass", &pair, (520.0, 0.8))
            .or_else("the order of the layers turned", reversed.waves(520.0, 0.8).reflectance())
            .or_else(
                "half of the phase",
                CoatedInterface {
                    layers: pair.layers.iter().map(|[n, k, d]| [*n, *k, 0.5 * d]).collect(),
                    ..pair.clone()
                }
                .waves(520.0, 0.8)
                .reflectance(),
            ),
        truth("dielectric-mirror-of-six-layers", &mirror, (560.0, 0.9)).or_else(
            "the order of the layers turned",
            CoatedInterface { layers: [[low, high]; 3].concat(), ..pair }.waves(560.0, 0.9).reflectance(),
        ),
    ];
    // Beyond the critical angle light tunnels through a gap.
    let gap = CoatedInterface::single(1.5, [1.0, 0.0, 100.0], 1.5);
    let (cos, nm): (f64, f64) = (0.6, 500.0);
    let again = gap.clone();
    list.push(
        Truth::new(
            "light-that-tunnels-through-a-gap",
            &passing(coated(glass_in(1.5, 1.5), &gap.layers), cos, true).band(at(nm)),
            gap.waves(nm, cos).transmittance(),
            "frustrated total reflection: n 1.5, 1, 1.5; 100 nm at 500 nm, sin θ = 0.8",
        )
        .because("In the gap the wave decays, n sin θ = 1.2 being above 1; what is left of it behind goes on. A lamp of radiance 1 shows the share.")
        .confirmed("the wave equation", 1e-6, move || again.by_wave_equation(nm, cos).transmittance())
        .or_else("total reflection", 0.0)
        .or_else("no gap", 1.0)
        .sees(0.01),
    );
    list
}

/// A film that absorbs, on glass: from before it and from behind.
pub(super) fn from_both_sides() -> Vec<Truth> {
    let front =
        CoatedInterface { incident: 1.0, layers: vec![[0.3, 2.8, 15.0], [1.46, 0.0, 90.0]], substrate: [1.52, 0.0] };
    let behind = front.from_behind();
    let (nm, cos) = (540.0, 0.9);
    // The light in the glass is denser by n².
    let through = |waves: FilmWaves, from: f64, to: f64| waves.transmittance() * (from / to).powi(2);
    let material = || coated(glass(1.52), &front.layers);
    let mut list = Vec::new();
    for (name, stack, other, up) in [("from-before", &front, &behind, true), ("from-behind", &behind, &front, false)] {
        let (again, once_more) = (stack.clone(), stack.clone());
        let (from, to) = (stack.incident, stack.substrate[0]);
        list.push(
            Truth::new(
                format!("film-that-absorbs-seen-{name}"),
                &reflecting(material(), cos, up).band(at(nm)),
                stack.waves(nm, cos).reflectance(),
                format!("Rouard: {} at {nm} nm, cos θ = {cos}", named(stack)),
            )
            .because(SHOWS)
            .confirmed("the wave equation", 1e-6, move || again.by_wave_equation(nm, cos).reflectance())
            .or_else("as from the other side", other.waves(nm, cos).reflectance())
            .or_else(
                "the order of the layers turned",
                CoatedInterface { layers: other.layers.clone(), ..stack.clone() }.waves(nm, cos).reflectance(),
            )
            .sees(0.01),
        );
        list.push(
            Truth::new(
                format!("film-that-absorbs-seen-through-{name}"),
                &passing(material(), cos, up).band(at(nm)),
                through(stack.waves(nm, cos), from, to),
                format!("Rouard's T (n₁/n₂)²: {} at {nm} nm, cos θ = {cos}", named(stack)),
            )
            .because("A lamp of radiance 1 behind a film shows the share that passes, radiance being scaled by n² on the way.")
            .confirmed("the wave equation", 1e-6, move || through(once_more.by_wave_equation(nm, cos), from, to))
            .or_else("what is not reflected passes", (1.0 - stack.waves(nm, cos).reflectance()) * (from / to).powi(2))
            .sees(0.01),
        );
    }
    list
}
