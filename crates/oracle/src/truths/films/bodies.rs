//! Films on facets, on panes, with images of their thickness, on solids that touch, and in polarised light.

use std::sync::{Arc, LazyLock};

use serde_json::{Value, json};

use super::{at, by_wave_equation, coated, luminance, passing, reflecting, seen};
use crate::laws::{CoatedInterface, FilmLayer, FilmWaves, SingleScattering, coated_ggx_albedo};
use crate::truths::expectation::Expectation;
use crate::truths::scene::{Scene, black, block, conductor, disk, glass, grey_hdr, level_square, shown, solid};
use crate::truths::stokes::{PARAMETERS, stokes_of};
use crate::truths::{Claim, Truth};
use crate::vector::{Vec3, scale};

/// Facets that each carry the film.
pub(super) fn rough() -> Vec<Truth> {
    const BECAUSE: &str = "Each facet reflects and passes what a flat coated interface does at the angle at which light meets it; facets that others \
                           hide from the way out are lost.";
    const AGAIN: &str = "the wave equation at 64 angles, linear between them";
    let (nm, mu, alpha) = (480.0, 0.8, 0.4);
    let oxide = CoatedInterface { incident: 1.0, layers: vec![[2.4, 0.0, 60.0]], substrate: [2.2, 2.9] };
    let mut metal = coated(conductor(2.2, 2.9), &oxide.layers);
    (metal["alpha"], metal["multiple_scattering"]) = (json!(alpha), json!("lost"));
    let of_metal = move |stack: &CoatedInterface| {
        coated_ggx_albedo(alpha, mu, None, |cos| [stack.waves(nm, cos).reflectance(), 0.0]).reflected
    };
    let bare = CoatedInterface { layers: Vec::new(), ..oxide.clone() };
    let again = oxide.clone();
    let mut list = vec![
        Truth::later(
            "anodised-titanium-that-is-rough",
            &reflecting(metal, mu, true).band(at(nm)),
            "∫ R(o·h) D G₂/(4 cos θ_o) dω: α = 0.4, n 1, 2.4, 2.2 + 2.9i; 60 nm at 480 nm, cos θ = 0.8",
            move || Expectation::new(of_metal(&oxide)).or_else("the film left out", of_metal(&bare)),
        )
        .because(BECAUSE)
        .confirmed(AGAIN, 2e-4, move || coated_ggx_albedo(alpha, mu, None, by_wave_equation(&again, nm)).reflected)
        .allows(1e-5, "the quadrature errs by 1e-5")
        .claims(Claim::CorrelatedMasking)
        .sees(0.01),
    ];
    let (mu, alpha) = (0.7, 0.3);
    let mut rough = coated(glass(1.5), &[[2.35, 0.0, 60.0], [1.46, 0.0, 90.0]]);
    rough["alpha"] = json!(alpha);
    let stack =
        CoatedInterface { incident: 1.0, layers: vec![[2.35, 0.0, 60.0], [1.46, 0.0, 90.0]], substrate: [1.5, 0.0] };
    let of_glass = move |stack: &CoatedInterface| {
        coated_ggx_albedo(alpha, mu, Some(1.5), |cos| {
            let waves = stack.waves(nm, cos);
            [waves.reflectance(), waves.transmittance()]
        })
    };
    let turned = CoatedInterface { layers: vec![stack.layers[1], stack.layers[0]], ..stack.clone() };
    let (again, once_more) = (stack.clone(), stack.clone());
    // Both truths read the same quadratures.
    let shares = Arc::new(LazyLock::new(move || [&stack, &turned].map(of_glass)));
    let expected = |share: fn(&SingleScattering) -> f64| {
        let shares = Arc::clone(&shares);
        move || {
            let [found, mistaken] = &**shares;
            Expectation::new(share(found)).or_else("the order of the layers turned", share(mistaken))
        }
    };
    let name = "coated-glass-that-is-rough";
    let formula = "∫ D (o·h)/cos θ_o [R G₂(o, r) or T G₁G₁(o, t)] dω: α = 0.3, n 1, 2.35 (60 nm), 1.46 (90 nm), 1.5 at 480 nm, cos θ = 0.7";
    list.push(
        Truth::later(
            name,
            &reflecting(rough.clone(), mu, true).band(at(nm)),
            formula,
            expected(|found| found.reflected),
        )
        .because(BECAUSE)
        .confirmed(AGAIN, 2e-3, move || coated_ggx_albedo(alpha, mu, Some(1.5), by_wave_equation(&again, nm)).reflected)
        .allows(1e-5, "the quadrature errs by 1e-5")
        .claims(Claim::CorrelatedMasking)
        .sees(0.01),
    );
    list.push(
        Truth::later(
            format!("{name}-seen-through"),
            &passing(rough, mu, true).band(at(nm)),
            format!("{formula}, over n²"),
            expected(|found| found.refracted / 2.25),
        )
        .because(BECAUSE)
        .confirmed(AGAIN, 2e-3, move || {
            coated_ggx_albedo(alpha, mu, Some(1.5), by_wave_equation(&once_more, nm)).refracted / 2.25
        })
        .allows(1e-5, "the quadrature errs by 1e-5")
        .sees(0.01),
    );
    list
}

/// What a pane that is coated on both faces reflects and passes in all orders.
fn closed(face: &CoatedInterface, nm: f64, cos: f64) -> [f64; 2] {
    let n = face.substrate[0];
    let cos_within = (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
    let (outer, inner) = (face.by_wave_equation(nm, cos), face.from_behind().by_wave_equation(nm, cos_within));
    let share = |[re, im]: [f64; 2]| re * re + im * im;
    let of = |p: usize| {
        let (r, within, t) = (share(outer.reflected[p]), share(inner.reflected[p]), share(outer.transmitted[p]));
        let through = t * t / (1.0 - within * within);
        [r + through * within, through]
    };
    [0, 1].map(|k| 0.5 * (of(0)[k] + of(1)[k]))
}

/// Panes that are coated on both faces: within a film waves add, between the faces only powers.
pub(super) fn panes() -> Vec<Truth> {
    let face =
        CoatedInterface { incident: 1.0, layers: vec![[1.9, 0.0, 140.0], [1.38, 0.0, 95.0]], substrate: [1.52, 0.0] };
    let pane = |face: &CoatedInterface, nm: f64, cos: f64| {
        let cos_within = (1.0 - (1.0 - cos * cos) / (1.52 * 1.52)).sqrt();
        let (outer, inner) = (face.waves(nm, cos), face.from_behind().waves(nm, cos_within));
        let share = |[re, im]: [f64; 2]| re * re + im * im;
        let mut shares = [0.0; 2];
        for p in 0..2 {
            // Order by order.
            let (r, within, t) = (share(outer.reflected[p]), share(inner.reflected[p]), share(outer.transmitted[p]));
            let (mut up, mut down, mut light) = (r, 0.0, t);
            for _ in 0..60 {
                down += light * t;
                light *= within;
                up += light * t;
                light *= within;
            }
            shares[0] += 0.5 * up;
            shares[1] += 0.5 * down;
        }
        shares
    };
    let mut material = coated(json!({ "type": "thin-dielectric", "index": 1.52 }), &face.layers);
    material["comment"] = json!("coated on both faces");
    let turned = CoatedInterface { layers: vec![face.layers[1], face.layers[0]], ..face.clone() };
    let (nm, cos) = (500.0, 0.5);
    let (right, wrong) = (pane(&face, nm, cos), pane(&turned, nm, cos));
    let truth = |name: &str, scene: &Scene, i: usize| {
        Truth::new(name, scene, right[i], "the orders of reflection between two coated faces, for s and for p: n 1, 1.9 (140 nm), 1.38 (95 nm), 1.52 at 500 nm, 60°")
            .because("A pane is thicker than waves are coherent: between its faces powers add. Within a film amplitudes do.")
            .confirmed("R + T²R′/(1 − R′²) and T²/(1 − R′²), by the wave equation", 1e-6, {
                let face = face.clone();
                move || closed(&face, nm, cos)[i]
            })
            .or_else("the order of the layers turned", wrong[i])
            .sees(0.01)
    };
    let below = Scene::light_meter()
        .thing(json!({ "shape": level_square([0.0, 0.0, 0.5], 2000.0, true), "material": material.clone() }))
        .directional_light([0.75_f64.sqrt(), 0.0, -cos], 1.0)
        .spp(1 << 10);
    let (bare, mean) = (CoatedInterface { layers: Vec::new(), ..face.clone() }, |face: &CoatedInterface| {
        luminance(|nm| pane(face, nm, cos)[1])
    });
    let sun = Truth::new(
        "sun-behind-a-coated-pane",
        &below,
        shown(cos * mean(&face)),
        "(ρ/π) E cos θ ∫ T ȳ dλ / ∫ ȳ dλ: all orders of reflection between two coated faces, θ = 60°",
    )
    .because("Each wavelength of sunlight is dimmed by its own share, for s and for p. The pane is seen by no path: a shadow ray meets it.")
    .confirmed("T²/(1 − R′²), by the wave equation", 1e-5, {
        let face = face.clone();
        move || shown(cos * luminance(|nm| closed(&face, nm, cos)[1]))
    })
    .or_else("no film", shown(cos * mean(&bare)))
    .sees(2e-3);
    vec![
        sun,
        truth("coated-pane", &reflecting(material.clone(), cos, true).band(at(nm)), 0),
        truth("coated-pane-seen-through", &passing(material, cos, false).band(at(nm)), 1),
    ]
}

/// Films whose thickness is an image, and films of solids that touch others.
pub(super) fn places() -> Vec<Truth> {
    let shares = [0.25, 0.5, 0.75, 1.0];
    let mut film = coated(conductor(1.5, 3.0), &[[1.46, 0.0, 400.0]]);
    film["thin_film"][0]["thickness_image"] = json!({ "file": "thickness.hdr", "channel": "red", "filter": "nearest" });
    let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 2.0)
        .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": film }))
        .file("thickness.hdr", grey_hdr(4, &shares))
        .sky(1.0)
        .film(16, 16)
        .spp(256)
        .band(at(550.0));
    let stack =
        |thickness: f64| CoatedInterface { incident: 1.0, layers: vec![[1.46, 0.0, thickness]], substrate: [1.5, 3.0] };
    let mean = |of: fn(&CoatedInterface, f64, f64) -> FilmWaves| {
        shares.iter().map(|share| 0.25 * of(&stack(400.0 * share), 550.0, 1.0).reflectance()).sum::<f64>()
    };
    let by_image = Truth::new(
        "film-whose-thickness-is-an-image",
        &scene,
        mean(CoatedInterface::waves),
        "mean of Airy's R for 100, 200, 300 and 400 nm: n 1, 1.46, 1.5 + 3i at 550 nm",
    )
    .because("Each quarter of the square shows what a film of its own thickness reflects.")
    .confirmed("the wave equation", 1e-6, move || {
        shares.iter().map(|share| 0.25 * stack(400.0 * share).by_wave_equation(550.0, 1.0).reflectance()).sum()
    })
    .or_else("the mean thickness everywhere", stack(250.0).waves(550.0, 1.0).reflectance())
    .sees(5e-3);

    // Water over coated glass: an eye and a lamp within the water.
    let layers: [FilmLayer; 2] = [[2.35, 0.0, 70.0], [1.46, 0.0, 60.0]];
    let coated_glass = coated(solid(1.52, 2), &layers);
    let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 0.1)
        .thing(json!({ "shape": block([-10.0, -10.0, 0.0], [10.0, 10.0, 5.0]), "material": solid(1.33, 1) }))
        .thing(json!({ "shape": block([-10.0, -10.0, -5.0], [10.0, 10.0, 0.0]), "material": coated_glass }))
        // Nothing comes back from within the glass.
        .thing(json!({ "shape": level_square([0.0, 0.0, -1.0], 9.0, true), "material": black() }))
        .lamp(level_square([0.0, 0.0, 2.0], 1.0, false), black(), 1.0, "front")
        .film(16, 16)
        .spp(1024)
        .band(at(530.0));
    let stack = CoatedInterface { incident: 1.33, layers: layers.to_vec(), substrate: [1.52, 0.0] };
    let turned = CoatedInterface { layers: vec![layers[1], layers[0]], ..stack.clone() };
    let in_air = CoatedInterface { incident: 1.0, ..stack.clone() };
    let again = stack.clone();
    let under_water = Truth::new(
        "coated-solid-under-water",
        &scene,
        stack.waves(530.0, 1.0).reflectance(),
        "Rouard: n 1.33, 2.35 (70 nm), 1.46 (60 nm), 1.52 at 530 nm",
    )
    .because("The film lies between the glass that carries it and whatever touches that: here water, whose boundary coincides with the glass's.")
    .confirmed("the wave equation", 1e-6, move || again.by_wave_equation(530.0, 1.0).reflectance())
    .or_else("as if the glass stood in vacuum", in_air.waves(530.0, 1.0).reflectance())
    .or_else("the order of the layers turned", turned.waves(530.0, 1.0).reflectance())
    .claims(Claim::Priorities)
    .sees(0.01);
    vec![by_image, under_water]
}

/// Light at 45° to the plane of incidence, reflected and passed on at 60°: its phases show in S₂ and S₃.
pub(super) fn polarised() -> Vec<Truth> {
    const BECAUSE: &str = "Behind a polariser at 45° to the plane of incidence s and p have equal amplitudes. The film sends each on with a modulus and a \
                           phase of its own: S₁ ∝ |a_s|² − |a_p|², S₂ + iS₃ ∝ 2a_s a_p* in fields that run as e^(−iωt).";
    let (cos, nm): (f64, f64) = (0.5, 520.0);
    let sin = (1.0 - cos * cos).sqrt();
    // The camera's right is x, which is s; its upper side is y × … : p.
    let lit = |material: Value, toward: Vec3, axis: Vec3| {
        let sheet = json!({ "type": "polariser", "axis": axis });
        seen(material, cos, true)
            .up([0.0, cos, sin])
            .film(4, 4)
            .spp(4096)
            .band(at(nm))
            .set("film", "stokes", json!(true))
            .thing(json!({ "shape": disk(toward, toward, 1.0), "material": sheet }))
            .lamp(disk(scale(1.5, toward), scale(-1.0, toward), 2.0), black(), 1.0, "front")
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let oxide = CoatedInterface { incident: 1.0, layers: vec![[2.4, 0.0, 85.0]], substrate: [2.2, 2.9] };
    let film =
        CoatedInterface { incident: 1.0, layers: vec![[0.3, 2.0, 20.0], [2.2, 0.0, 70.0]], substrate: [1.0, 0.0] };
    let mut list = Vec::new();
    for (name, scene, waves) in [
        (
            "polarised-light-on-anodised-titanium",
            // Seen against the light that arrives, p is on the other side.
            lit(coated(conductor(2.2, 2.9), &oxide.layers), [0.0, sin, cos], [half, -half * cos, half * sin]),
            oxide.waves(nm, cos).reflected,
        ),
        (
            "polarised-light-through-a-film",
            lit(coated(glass(1.0), &film.layers), [0.0, sin, -cos], [half, half * cos, half * sin]),
            film.waves(nm, cos).transmitted,
        ),
    ] {
        let [s, p] = waves;
        let product = [s[0] * p[0] + s[1] * p[1], s[1] * p[0] - s[0] * p[1]];
        let square = |[re, im]: [f64; 2]| re * re + im * im;
        let values = [0.25 * (square(s) - square(p)), 0.5 * product[0], 0.5 * product[1]];
        for i in 0..3 {
            list.push(
                Truth::new(
                    format!("{name}-s{}", i + 1),
                    &scene,
                    values[i],
                    ["¼(|a_s|² − |a_p|²)", "½ Re a_s a_p*", "½ Im a_s a_p*"][i],
                )
                .because(BECAUSE)
                .reads(PARAMETERS[i])
                .confirmed("the field over a period", 1e-6, move || {
                    let part = |[re, im]: [f64; 2], phase: f64| half * (re * phase.cos() + im * phase.sin());
                    stokes_of(|phase| [part(s, phase), part(p, phase)])[i]
                })
                .or_else("the other sign", -values[i])
                .claims(Claim::CarriesPolarisation)
                .sees(0.01),
            );
        }
    }
    list
}
