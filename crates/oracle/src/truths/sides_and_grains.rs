//! Which side of a surface reflects, seen from the front, and which way its grain or its grooves lie.

use std::f64::consts::PI;

use serde_json::json;

use super::{
    Claim, Truth,
    measured_files::{Azimuths, Made},
    photometric_weight,
    principled_lobes::{DIFFUSE, Surface, direction, grazing},
    scene::{Scene, black, brushed_metal, disk, lambert, level_square, mirror, sphere},
    tiles::{mean, row_of, with},
};
use crate::{
    laws::{anisotropic_ggx_mirrors, fresnel_exact},
    quadrature::interval,
    vector::{Vec3, add, dot, normalize, scale},
};

pub(super) fn truths() -> Vec<Truth> {
    vec![
        brushed_coat(),
        mirrored_grain(),
        principled(),
        measured(),
        dye(),
        disc(),
        cloth(),
        sheet(true),
        sheet(false),
        walls(),
    ]
}

const UP: Vec3 = [0.0, 0.0, 1.0];

/// In the light of a distant lamp of irradiance 1.
fn lit(scene: Scene, toward: Vec3) -> Scene {
    scene.directional_light(toward.map(|x| -x), 1.0).spp(64)
}

/// A direction turned about z, clockwise seen from above: as a grain sees it that is turned the other way.
fn turned([x, y, z]: Vec3, degrees: f64) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [cos * x + sin * y, cos * y - sin * x, z]
}

/// Slopes of the facet half way between two directions along a grain that is turned, and across it, by tangents.
fn slopes(o: Vec3, i: Vec3, turned_deg: f64) -> [f64; 2] {
    let [x, y] = [0, 1].map(|k| (o[k] + i[k]) / (o[2] + i[2]));
    let (length, azimuth) = (x.hypot(y), y.atan2(x) - turned_deg.to_radians());
    [length * azimuth.cos(), length * azimuth.sin()]
}

/// D of two widths by slopes, and (√(1 + a²) − 1)/2 of a direction.
fn density([along, across]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    let part = (along / a).powi(2) + (across / b).powi(2);
    (1.0 + along * along + across * across).powi(2) / (PI * a * b * (1.0 + part).powi(2))
}

fn hidden(w: Vec3, turned_deg: f64, [a, b]: [f64; 2]) -> f64 {
    let (tan, azimuth) = (w[0].hypot(w[1]) / w[2], w[1].atan2(w[0]) - turned_deg.to_radians());
    0.5 * ((1.0 + (tan * (a * azimuth.cos()).hypot(b * azimuth.sin())).powi(2)).sqrt() - 1.0)
}

/// A brushed coat over black.
fn brushed_coat() -> Truth {
    const WIDTHS: [f64; 2] = [0.5, 0.1];
    const TURN_DEG: f64 = 35.0;
    let (o, i) = (direction(45.0, 10.0), direction(50.0, 165.0));
    let coat = json!({
        "type": "plastic", "reflectance": 0, "coat": 1.5, "alpha_u": WIDTHS[0], "alpha_v": WIDTHS[1], "tangent_rotation_deg": TURN_DEG,
    });
    let scene = Scene::orthographic(scale(2.0, o), [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": coat }))
        .film(16, 16);
    let of = move |widths: [f64; 2], turn_deg: f64| {
        let share = fresnel_exact(dot(o, normalize(add(o, i))), 1.5).reflectance();
        share * anisotropic_ggx_mirrors(widths, turned(o, turn_deg), turned(i, turn_deg)) * i[2]
    };
    let shared = (WIDTHS[0] * WIDTHS[1]).sqrt();
    Truth::new(
        "brushed-coat-over-black-in-the-sun",
        &lit(scene, i),
        of(WIDTHS, TURN_DEG),
        "F D G₂/(4 cos θ_o), α = ½ along a line 35° from u toward v, 0.1 across it, n = 1.5",
    )
    .because("Over a black base a coat in the light of a distant lamp of irradiance 1 shows what its facets reflect.")
    .confirmed("slopes of facets by tangents", 1e-9, move || {
        let d = (0.5 * (1.0 + dot(o, i))).sqrt();
        let facets = density(slopes(o, i, TURN_DEG), WIDTHS) * fresnel_exact(d, 1.5).reflectance();
        facets / ((1.0 + hidden(o, TURN_DEG, WIDTHS) + hidden(i, TURN_DEG, WIDTHS)) * 4.0 * o[2])
    })
    .or_else("the grain not turned", of(WIDTHS, 0.0))
    .or_else("turned the other way", of(WIDTHS, -TURN_DEG))
    .or_else("the widths exchanged", of([WIDTHS[1], WIDTHS[0]], TURN_DEG))
    .or_else("one width", of([shared; 2], TURN_DEG))
    .claims(Claim::AnisotropicFacets)
    .claims(Claim::CorrelatedMasking)
    .claims(Claim::AveragesPolarisation)
    .sees(2e-3)
}

/// Brushed metal where v grows to the right of u, as on the other half of a mirrored model.
fn mirrored_grain() -> Truth {
    const WIDTHS: [f64; 2] = [0.5, 0.1];
    const TURN_DEG: f64 = 35.0;
    let (o, i) = (direction(45.0, 10.0), direction(50.0, 165.0));
    let sheet = json!({
        "type": "mesh", "vertices_m": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "uvs": [[0, 1], [1, 1], [1, 0], [0, 0]],
    });
    let scene = Scene::orthographic(scale(2.0, o), [0.0; 3], 0.1)
        .thing(json!({ "shape": sheet, "material": brushed_metal(WIDTHS, TURN_DEG, false) }))
        .film(16, 16);
    let of = move |widths: [f64; 2], turn_deg: f64| {
        anisotropic_ggx_mirrors(widths, turned(o, turn_deg), turned(i, turn_deg)) * i[2]
    };
    Truth::new(
        "brushed-metal-of-mirrored-coordinates-in-the-sun",
        &lit(scene, i),
        of(WIDTHS, -TURN_DEG),
        "D G₂/(4 cos θ_o), α = ½ along a line 35° from u toward v, which is to its right, 0.1 across it",
    )
    .because("A grain is turned from growing u toward growing v. Seen from the front v grows to the right of u, so it is turned clockwise.")
    .confirmed("slopes of facets by tangents", 1e-9, move || {
        let facets = density(slopes(o, i, -TURN_DEG), WIDTHS);
        facets / ((1.0 + hidden(o, -TURN_DEG, WIDTHS) + hidden(i, -TURN_DEG, WIDTHS)) * 4.0 * o[2])
    })
    .or_else("turned as if v grew to the left", of(WIDTHS, TURN_DEG))
    .or_else("the grain not turned", of(WIDTHS, 0.0))
    .or_else("the widths exchanged", of([WIDTHS[1], WIDTHS[0]], -TURN_DEG))
    .claims(Claim::AnisotropicFacets)
    .claims(Claim::CorrelatedMasking)
    .sees(2e-3)
}

/// Metal with a grain that reflects on its front, beside metal that reflects on its back. The eye is straight above.
fn principled() -> Truth {
    let surface = Surface { base: 0.7, index: 1.5, alpha: [0.45, 0.15], turned_deg: -50.0, metallic: 0.8, ..DIFFUSE };
    let i = direction(40.0, 100.0);
    let on = |sides: &str| with(surface.json(), &json!({ "sides": sides }));
    let scene = row_of(&[on("front"), on("back")]);
    let of = |other: Surface| 0.5 * other.f_cos(UP, i);
    let value = of(surface);
    Truth::new(
        "principled-grain-on-the-front-and-on-the-back",
        &lit(scene, i),
        value,
        "½ f cos θ_i, α = 0.45 along a line 50° from u away from v, 0.15 across it, and ½ · 0",
    )
    .because("From the front a surface that reflects on its back is black. Beside it the lobes of the other are those of its front.")
    .confirmed("slopes of facets by tangents", 1e-9, move || {
        let d = (0.5 * (1.0 + i[2])).sqrt();
        let facets = density(slopes(UP, i, -50.0), surface.alpha) / (1.0 + hidden(i, -50.0, surface.alpha)) / 4.0;
        0.5 * (surface.fresnel(d) * facets + surface.base_lobes(1.0, i[2], d) * i[2])
    })
    .or_else("both reflect", 2.0 * value)
    .or_else("neither reflects", 0.0)
    .or_else("the grain not turned", of(Surface { turned_deg: 0.0, ..surface }))
    .or_else("turned the other way", of(Surface { turned_deg: 50.0, ..surface }))
    .or_else("the widths exchanged", of(Surface { alpha: [0.15, 0.45], ..surface }))
    .sees(2e-3)
}

/// A sheet that is a mirror on its front and matte on its back, under a sky of 1.
fn sheet(from_its_front: bool) -> Truth {
    const MIRROR: f64 = 0.9;
    const MATTE: f64 = 0.4;
    let sheet = json!({ "type": "two-sided", "front": mirror(MIRROR), "back": lambert(MATTE) });
    let scene = Scene::orthographic([0.4, 0.0, 2.0], [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 1.0, from_its_front), "material": sheet }))
        .sky(1.0);
    let (name, value, other) = match from_its_front {
        true => ("two-sided-sheet-from-its-front", MIRROR, MATTE),
        false => ("two-sided-sheet-from-its-back", MATTE, MIRROR),
    };
    Truth::new(name, &scene, value, "ρ of the side that is seen")
        .because("Under an even sky of 1 a surface shows the share of light that the side toward the eye reflects.")
        .or_else("the other side", other)
        .or_else("both sides at once", 0.5 * (MIRROR + MATTE))
        .or_else("black from there", 0.0)
        .sees(2e-3)
}

/// A round room whose walls shine inward, with another reflectance outside.
fn walls() -> Truth {
    const INSIDE: f64 = 0.5;
    const OUTSIDE: f64 = 0.2;
    let wall = json!({ "type": "two-sided", "front": lambert(OUTSIDE), "back": lambert(INSIDE) });
    let scene = Scene::pinhole([0.1, 0.2, -0.3], [0.5, -0.6, 0.9], 90.0)
        .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": wall, "emission": { "radiance": 0.5, "sides": "back" } }))
        .spp(256);
    Truth::new("room-with-two-sided-walls", &scene, 1.0, "Le/(1 − ρ), Le = ρ = ½ inside")
        .because("A closed room whose walls all emit Le and reflect ρ diffusely is evenly bright. What its outside reflects does not count.")
        .or_else("the outside's reflectance", 0.5 / (1.0 - OUTSIDE))
        .or_else("walls that are black inside", 0.5)
        .sees(0.01)
}

/// A measured grain that is turned and reflects on both sides, beside one that reflects on its back alone.
fn measured() -> Truth {
    const TURN_DEG: f64 = 25.0;
    let made = Made::grey(Azimuths::All);
    let (o, i) = (direction(50.0, 90.0), direction(35.0, 210.0));
    let square =
        |y: f64| json!({ "type": "parallelogram", "origin_m": [-1, y, 0], "u_m": [2, 0, 0], "v_m": [0, 1, 0] });
    let on = |sides: &str| json!({ "type": "measured", "file": made.name(), "sides": sides, "tangent_rotation_deg": TURN_DEG });
    // Each has the half of the picture on one side of y = 0.
    let scene = Scene::orthographic(scale(2.0, o), [0.0; 3], 0.2)
        .up([0.0, 1.0, 0.0])
        .thing(json!({ "shape": square(0.0), "material": on("both") }))
        .thing(json!({ "shape": square(-1.0), "material": on("back") }))
        .file(&made.name(), made.file())
        .film(16, 16);
    let of = |made: &Made, degrees: f64| 0.5 * made.f_cos(turned(o, degrees), turned(i, degrees));
    let value = of(&made, TURN_DEG);
    let again = made.clone();
    Truth::new(
        "measured-grain-on-both-sides-and-on-the-back",
        &lit(scene, i),
        value,
        "½ S(V⁻¹(q)) D(q)/(4σ(p)), azimuths from a line 25° from u toward v, and ½ · 0",
    )
    .because("From the front a surface that reflects on its back is black. Beside it azimuths count from the direction of growing u, turned.")
    .confirmed("slopes of facets, and sums of densities", 1e-6, move || {
        const STEPS: u32 = 4000;
        let (o, i) = (turned(o, TURN_DEG), turned(i, TURN_DEG));
        let mut places = again.places(o, i);
        let slope = (o[0] + i[0]).hypot(o[1] + i[1]) / (o[2] + i[2]);
        places.facet[0] = (slope.atan() / (0.5 * PI)).sqrt();
        let [x, y] = places.facet;
        let at = |step: u32, to: f64| to * (f64::from(step) + 0.5) / f64::from(STEPS);
        let sum = |to: f64, of: &dyn Fn(f64) -> f64| (0..STEPS).map(|step| of(at(step, to))).sum::<f64>() * to;
        let visible = |x: f64, y: f64| Made::visible(places.viewer, [x, y]);
        let row = |to: f64| sum(to, &|x| visible(x, y));
        let column = |to: f64| sum(to, &|y| visible(0.5, y));
        let place = [row(x) / row(1.0), column(y) / column(1.0)];
        0.5 * Made::share(places.viewer, place) * again.ndf([x, y]) / (4.0 * again.sigma(places.sigma))
    })
    .or_else("both reflect", 2.0 * value)
    .or_else("neither reflects", 0.0)
    .or_else("the grain not turned", of(&made, 0.0))
    .or_else("turned the other way", of(&made, -TURN_DEG))
    .sees(5e-3)
}

/// A dye on the front beside one on the back, in the light of a distant violet lamp.
fn dye() -> Truth {
    let (absorbs, [a, b, c], yield_of, irradiance) = ([400.0, 440.0], [480.0, 540.0, 620.0], 0.7, 8.0);
    let table = |rows: &[[f64; 2]]| {
        let [nm, values] = [0, 1].map(|k| rows.iter().map(|row| row[k]).collect::<Vec<_>>());
        json!({ "type": "tabulated", "wavelengths_nm": nm, "values": values, "outside": "zero" })
    };
    let band = |value: f64| table(&absorbs.map(|nm| [nm, value]));
    let on = |sides: &str| {
        let dye = json!({ "absorption": band(0.8), "emission": table(&[[a, 0.0], [b, 1.0], [c, 0.0]]), "quantum_yield": yield_of });
        json!({ "type": "fluorescent", "fluorophores": [dye], "sides": sides })
    };
    let light = json!({ "type": "directional", "direction": [0, 0.6, -0.8], "irradiance": band(irradiance) });
    let scene = row_of(&[on("front"), on("back")]).light(light).spp(1024);
    let triangle = move |nm: f64| ((nm - a) / (b - a)).min((c - nm) / (c - b)).max(0.0);
    // Photons that are absorbed, over those of the shape that is emitted: its area times the mean of its corners.
    let excited = 0.8 * (absorbs[1] * absorbs[1] - absorbs[0] * absorbs[0]) / 2.0;
    let photons = (c - a) / 2.0 * (a + b + c) / 3.0;
    let seen = |step_nm: f64| {
        let n = ((c - a) / step_nm).round() as u32;
        let at = |k: u32| a + step_nm * (f64::from(k) + 0.5);
        (0..n).map(at).map(|nm| step_nm * photometric_weight(nm) * triangle(nm)).sum::<f64>()
    };
    let of =
        move |excited: f64, photons: f64, seen: f64| 0.5 * irradiance * 0.8 / PI * yield_of * excited / photons * seen;
    let value = of(excited, photons, seen(0.01));
    Truth::new(
        "dyes-on-the-front-and-on-the-back-in-the-sun",
        &scene,
        value,
        "½ E cos θ/π · Q ∫aλ dλ/∫eλ dλ · ∫ȳe dλ/∫ȳ dλ, E = 8 W·m⁻²·nm⁻¹ from 400 to 440 nm, and ½ · 0",
    )
    .because("Each photon that the front absorbs leaves with the chance Q, at wavelengths as the dye emits them, as diffuse light. From the front the dye on the back is black.")
    .confirmed("sums over wavelengths", 1e-4, move || {
        let sum = |from: f64, to: f64, f: &dyn Fn(f64) -> f64| {
            let n = (to - from) as u32 * 4;
            (0..n).map(|k| from + 0.25 * (f64::from(k) + 0.5)).map(|nm| 0.25 * f(nm)).sum::<f64>()
        };
        let seen = sum(a, c, &|nm| photometric_weight(nm) * triangle(nm));
        of(sum(absorbs[0], absorbs[1], &|nm| 0.8 * nm), sum(a, c, &|nm| nm * triangle(nm)), seen)
    })
    .or_else("both give light back", 2.0 * value)
    .or_else("neither gives light back", 0.0)
    .or_else("the share of energy taken for that of photons", of(0.8 * (absorbs[1] - absorbs[0]), (c - a) / 2.0, seen(0.01)))
    .or_else("a quantum yield of 1", value / yield_of)
    .claims(Claim::Fluorescence)
    .claims(Claim::PhotometricSensor)
    .no_brighter_than(irradiance)
    .sees(5e-3)
}

/// A clear disc with circular grooves, and a lamp behind it where an order of one wavelength goes.
fn disc() -> Truth {
    let (nm, period_nm, turn) = (480.0, 1400.0, -130.0_f64.to_radians());
    let radial = [turn.cos(), turn.sin()];
    let place = [0.4 * radial[0], 0.4 * radial[1], 0.0];
    let wo = normalize([0.15, -0.25, 0.9]);
    let orders = [(0, 0.3), (1, 0.12), (-1, 0.35)]
        .map(|(order, efficiency)| json!({ "order": order, "efficiency": efficiency }));
    let material = json!({
        "type": "grating", "period_nm": period_nm, "orders": orders, "grooves": "circles", "light": "transmitted", "reflectance": 0.9,
    });
    // Along the disc, the directions toward eye and lamp add up to −λ/Λ along the radius.
    let [x, y] = [0, 1].map(|k| -nm / period_nm * radial[k] - wo[k]);
    let toward = [x, y, -(1.0 - x * x - y * y).sqrt()];
    let from = |direction: Vec3, distance: f64| add(place, scale(distance, direction));
    let scene = Scene::orthographic(from(wo, 2.0), place, 1e-3)
        .thing(json!({ "shape": disk([0.0; 3], UP, 1.0), "material": material }))
        .lamp(disk(from(toward, 3.0), scale(-1.0, toward), 0.15), black(), 1.0, "front")
        .film(16, 16)
        .spp(256)
        .band([nm - 5e-4, nm + 5e-4]);
    let value = 0.9 * 0.35;
    Truth::new(
        "clear-disc-with-circular-grooves",
        &scene,
        value,
        "0.9 η of m = −1: Λ = 1400 nm, λ = 480 nm, across the grooves along the radius, through the disc",
    )
    .because(
        "Light leaves a grating in its orders alone: along the surface, the directions toward eye and lamp add up to mλ/Λ across the grooves. There \
         solid angles times cosines are equal, so a lamp of radiance 1 shows the efficiency of the order that leads to it.",
    )
    .confirmed("the efficiency where the cone about the grooves leads to the lamp", 1e-12, move || {
        // Along the grooves and across them: light keeps its angle with the grooves, and turns about them.
        let (along, across) = (radial[0] * wo[1] - radial[1] * wo[0], radial[0] * wo[0] + radial[1] * wo[1]);
        let gamma = along.asin();
        let beta = (-nm / period_nm / gamma.cos() - across.atan2(wo[2]).sin()).asin();
        let (along, across) = (-gamma.sin(), gamma.cos() * beta.sin());
        let lamp = [
            radial[0] * across - radial[1] * along,
            radial[1] * across + radial[0] * along,
            -gamma.cos() * beta.cos(),
        ];
        let apart = (0..3).map(|k| (lamp[k] - toward[k]).powi(2)).sum::<f64>().sqrt();
        if apart < 1e-12 { value } else { 0.0 }
    })
    .or_else("straight grooves, or reflected light", 0.0)
    .or_else("the opposite order", 0.9 * 0.12)
    .or_else("the factor left out", 0.35)
    .claims(Claim::Gratings)
    .sees(0.02)
}

/// D65 from 380 to 780 nm in steps of 10 nm, relative to 560 nm (ISO/CIE 11664-2); linear in between.
const D65: [f64; 41] = [
    49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354,
    107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886,
    83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856, 75.087, 63.5927, 46.4182,
    66.8054, 63.3828,
];

/// Cloth that is dark in blue and bright in red, at a wavelength of each: the tint is its reflectance over its luminance.
fn cloth() -> Truth {
    const TINT: f64 = 0.75;
    let (low, high, edge) = (0.2, 0.7, [540.0, 580.0]);
    let reflects = move |nm: f64| low + (high - low) * ((nm - edge[0]) / (edge[1] - edge[0])).clamp(0.0, 1.0);
    let daylight = |nm: f64| {
        let x = ((nm - 380.0) / 10.0).clamp(0.0, 39.999_999);
        let i = x as usize;
        photometric_weight(nm) * (D65[i] + (x - i as f64) * (D65[i + 1] - D65[i]))
    };
    // From nanometre to nanometre.
    let sum = |of: &dyn Fn(f64) -> f64| (380..=780).map(f64::from).map(|nm| daylight(nm) * of(nm)).sum::<f64>();
    let luminance = sum(&reflects) / sum(&|_| 1.0);
    let nm = 460.0;
    let surface = Surface { sheen: 0.9, base: low, ..DIFFUSE };
    let (o, i) = (direction(72.0, 20.0), direction(68.0, 195.0));
    let material = with(
        surface.json(),
        &json!({
            "reflectance": { "type": "tabulated", "wavelengths_nm": edge, "values": [low, high], "outside": "clamp" }, "sheen_tint": TINT,
        }),
    );
    let scene = Scene::orthographic(scale(2.0, o), [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": material }))
        .film(16, 16)
        .band([nm - 5e-4, nm + 5e-4]);
    let of = move |tint: f64| Surface { sheen: 0.9 * tint, ..surface }.f_cos(o, i);
    let tint = move |over: f64| 1.0 - TINT + TINT * low / over;
    let value = of(tint(luminance));
    let d = dot(o, normalize(add(o, i)));
    Truth::new(
        "cloth-with-a-tinted-sheen-in-blue",
        &lit(scene, i),
        value,
        "diffuse light and 0.9 (¼ + ¾ · 0.2/Y)(1 − cos θ_d)⁵ cos θ_i at 460 nm, Y = ∫ρ S ȳ dλ/∫S ȳ dλ of D65",
    )
    .because("Of the sheen the share of the tint has the colour of the base over its luminance under D65. Where the base is dark it is less.")
    .confirmed("the luminance by the means of ȳ S on both sides of the edge, and the lobes one by one", 2e-4, move || {
        // ρ is low before the edge, high beyond it, and a line between: integrals of ȳ S alone.
        let share = |from: f64, to: f64, of: &dyn Fn(f64) -> f64| {
            let whole = |nm: f64| interval(|x| daylight(x) * of(x), nm, nm + 10.0, 1e-9).value;
            (0..((to - from) / 10.0) as u32).map(|k| whole(from + 10.0 * f64::from(k))).sum::<f64>()
        };
        let all = share(380.0, 780.0, &|_| 1.0);
        let ramp = share(edge[0], edge[1], &|nm| (nm - edge[0]) / (edge[1] - edge[0]));
        let y = low + (high - low) * (ramp + share(edge[1], 780.0, &|_| 1.0)) / all;
        Surface { sheen: 0.0, ..surface }.f_cos(o, i) + 0.9 * tint(y) * grazing(d) * i[2]
    })
    .allows(1e-3 * value, "the table of D65 in steps of 10 nm differs from that of 5 nm by some 1e-4 in its luminance")
    .or_else("a white sheen", of(1.0))
    .or_else("the base itself as tint", of(1.0 - TINT + TINT * low))
    .or_else("all of the sheen tinted", of(low / luminance))
    .or_else("the mean of the reflectance over wavelengths for its luminance", of(tint(mean(&[low, high]))))
    .sees(3e-3)
}
