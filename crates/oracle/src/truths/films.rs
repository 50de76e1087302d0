//! Thin films on glass, on metal, on facets and alone: what they reflect, what they pass, and in which phase.

use serde_json::{Value, json};

use super::{
    Claim, Truth, photometric_weight,
    scene::{Scene, black, block, conductor, disk, glass, glass_in, grey_hdr, level_square, solid, sphere},
    stokes::{PARAMETERS, stokes_of},
};
use crate::laws::{CoatedInterface, FilmLayer, FilmWaves, coated_ggx_albedo};
use crate::vector::{Vec3, scale};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = one_film();
    list.extend(stacks());
    list.extend(from_both_sides());
    list.extend(metals());
    list.extend(layers_of_metal());
    list.extend(rough());
    list.extend(panes());
    list.extend(places());
    list.extend(polarised());
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

fn one_film() -> Vec<Truth> {
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

fn stacks() -> Vec<Truth> {
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
fn from_both_sides() -> Vec<Truth> {
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

fn metals() -> Vec<Truth> {
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

/// Layers of metal on glass, by name and by a table.
fn layers_of_metal() -> Vec<Truth> {
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

/// Facets that each carry the film.
fn rough() -> Vec<Truth> {
    const BECAUSE: &str = "Each facet reflects and passes what a flat coated interface does at the angle at which light meets it; facets that others \
                           hide from the way out are lost.";
    const AGAIN: &str = "the wave equation at 64 angles, linear between them";
    let (nm, mu, alpha) = (480.0, 0.8, 0.4);
    let oxide = CoatedInterface { incident: 1.0, layers: vec![[2.4, 0.0, 60.0]], substrate: [2.2, 2.9] };
    let mut metal = coated(conductor(2.2, 2.9), &oxide.layers);
    (metal["alpha"], metal["multiple_scattering"]) = (json!(alpha), json!("lost"));
    let of_metal = |stack: &CoatedInterface, waves: fn(&CoatedInterface, f64, f64) -> FilmWaves| {
        coated_ggx_albedo(alpha, mu, None, |cos| [waves(stack, nm, cos).reflectance(), 0.0]).reflected
    };
    let bare = CoatedInterface { layers: Vec::new(), ..oxide.clone() };
    let again = oxide.clone();
    let mut list = vec![
        Truth::new(
            "anodised-titanium-that-is-rough",
            &reflecting(metal, mu, true).band(at(nm)),
            of_metal(&oxide, CoatedInterface::waves),
            "∫ R(o·h) D G₂/(4 cos θ_o) dω: α = 0.4, n 1, 2.4, 2.2 + 2.9i; 60 nm at 480 nm, cos θ = 0.8",
        )
        .because(BECAUSE)
        .confirmed(AGAIN, 2e-4, move || coated_ggx_albedo(alpha, mu, None, by_wave_equation(&again, nm)).reflected)
        .or_else("the film left out", of_metal(&bare, CoatedInterface::waves))
        .allows(1e-5, "the quadrature errs by 1e-5")
        .claims(Claim::CorrelatedMasking)
        .sees(0.01),
    ];
    let (mu, alpha) = (0.7, 0.3);
    let mut rough = coated(glass(1.5), &[[2.35, 0.0, 60.0], [1.46, 0.0, 90.0]]);
    rough["alpha"] = json!(alpha);
    let stack =
        CoatedInterface { incident: 1.0, layers: vec![[2.35, 0.0, 60.0], [1.46, 0.0, 90.0]], substrate: [1.5, 0.0] };
    let of_glass = |stack: &CoatedInterface| {
        coated_ggx_albedo(alpha, mu, Some(1.5), |cos| {
            let waves = stack.waves(nm, cos);
            [waves.reflectance(), waves.transmittance()]
        })
    };
    let turned = CoatedInterface { layers: vec![stack.layers[1], stack.layers[0]], ..stack.clone() };
    let (found, mistaken) = (of_glass(&stack), of_glass(&turned));
    let (again, once_more) = (stack.clone(), stack);
    let name = "coated-glass-that-is-rough";
    let formula = "∫ D (o·h)/cos θ_o [R G₂(o, r) or T G₁G₁(o, t)] dω: α = 0.3, n 1, 2.35 (60 nm), 1.46 (90 nm), 1.5 at 480 nm, cos θ = 0.7";
    list.push(
        Truth::new(name, &reflecting(rough.clone(), mu, true).band(at(nm)), found.reflected, formula)
            .because(BECAUSE)
            .confirmed(AGAIN, 2e-3, move || {
                coated_ggx_albedo(alpha, mu, Some(1.5), by_wave_equation(&again, nm)).reflected
            })
            .or_else("the order of the layers turned", mistaken.reflected)
            .allows(1e-5, "the quadrature errs by 1e-5")
            .claims(Claim::CorrelatedMasking)
            .sees(0.01),
    );
    list.push(
        Truth::new(
            format!("{name}-seen-through"),
            &passing(rough, mu, true).band(at(nm)),
            found.refracted / 2.25,
            format!("{formula}, over n²"),
        )
        .because(BECAUSE)
        .confirmed(AGAIN, 2e-3, move || {
            coated_ggx_albedo(alpha, mu, Some(1.5), by_wave_equation(&once_more, nm)).refracted / 2.25
        })
        .or_else("the order of the layers turned", mistaken.refracted / 2.25)
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
fn panes() -> Vec<Truth> {
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
    vec![
        truth("coated-pane", &reflecting(material.clone(), cos, true).band(at(nm)), 0),
        truth("coated-pane-seen-through", &passing(material, cos, false).band(at(nm)), 1),
    ]
}

/// Films whose thickness is an image, and films of solids that touch others.
fn places() -> Vec<Truth> {
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
fn polarised() -> Vec<Truth> {
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
