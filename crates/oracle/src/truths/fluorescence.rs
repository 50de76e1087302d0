//! Surfaces that give light back at other wavelengths: how much, at which, how often, and with what polarisation.
//!
//! A photometric sensor tells the wavelengths apart: light between two of them counts as ∫ȳ dλ there over all of it.

use std::f64::consts::{FRAC_1_PI, PI};

use serde_json::{Value, json};

use super::{
    Claim, Quantity, Truth, photometric_weight,
    scene::{Scene, block, level_square, sphere},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list =
        vec![photons(), lit_by_a_lamp(), measured_matrix(), behind_a_filter(), half_of_a_blend(), one_side()];
    list.extend(rooms());
    list.extend([two_steps(), through_a_polariser()]);
    list.into_iter().map(|truth| truth.claims(Claim::Fluorescence).claims(Claim::PhotometricSensor)).collect()
}

/// A spectrum that is zero outside its table.
fn table(rows: &[[f64; 2]]) -> Value {
    let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<_>>();
    json!({ "type": "tabulated", "wavelengths_nm": column(0), "values": column(1), "outside": "zero" })
}

/// One value between two wavelengths, nm.
fn band(from_nm: f64, to_nm: f64, value: f64) -> Value {
    table(&[[from_nm, value], [to_nm, value]])
}

fn dye(absorption: &Value, emission: &Value, quantum_yield: f64) -> Value {
    json!({ "absorption": absorption, "emission": emission, "quantum_yield": quantum_yield })
}

fn fluorescent(dyes: &[Value]) -> Value {
    json!({ "type": "fluorescent", "fluorophores": dyes })
}

/// ∫ f dλ by Simpson's rule over each nanometre: exact for cubics between whole ones.
fn integral(from_nm: u32, to_nm: u32, f: impl Fn(f64) -> f64) -> f64 {
    // From within, where a table ends.
    let inside = |nm: f64| nm.clamp(f64::from(from_nm).next_up(), f64::from(to_nm).next_down());
    (from_nm..to_nm).map(f64::from).map(|nm| (f(inside(nm)) + 4.0 * f(nm + 0.5) + f(inside(nm + 1.0))) / 6.0).sum()
}

/// What the sensor makes of radiance 1 between two wavelengths.
fn seen(from_nm: u32, to_nm: u32) -> f64 {
    integral(from_nm, to_nm, photometric_weight)
}

/// A triangle from `a` over 1 at `b` to `c`.
fn triangle([a, b, c]: [f64; 3]) -> impl Fn(f64) -> f64 {
    move |nm: f64| {
        if nm <= b { ((nm - a) / (b - a)).max(0.0) } else { ((c - nm) / (c - b)).max(0.0) }
    }
}

/// A large square at z = 0 that faces up, seen from straight above.
fn plate(material: &Value) -> Scene {
    Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1e-3)
        .thing(json!({ "shape": level_square([0.0; 3], 10.0, true), "material": material }))
        .film(16, 16)
        .spp(256)
}

fn sky(radiance: &Value) -> Value {
    json!({ "type": "environment", "radiance": radiance })
}

const TRIANGLE: [f64; 3] = [500.0, 540.0, 620.0];

/// What absorbs 0.9 from 370 to 430 nm and emits a triangle.
fn yellow(quantum_yield: f64) -> Value {
    let [a, b, c] = TRIANGLE;
    dye(&band(370.0, 430.0, 0.9), &table(&[[a, 0.0], [b, 1.0], [c, 0.0]]), quantum_yield)
}

/// What the sensor sees of that dye under light of radiance 1 from 380 to 420 nm.
fn yellow_light(quantum_yield: f64) -> f64 {
    let [a, b, c] = TRIANGLE;
    // ∫ a λ dλ, and ∫ e λ dλ: the triangle's area times the mean of its corners.
    let excited = 0.9 * (420.0_f64.powi(2) - 380.0_f64.powi(2)) / 2.0;
    let photons = (c - a) / 2.0 * (a + b + c) / 3.0;
    let shape = triangle(TRIANGLE);
    quantum_yield * excited / photons * integral(500, 620, |nm| photometric_weight(nm) * shape(nm))
}

/// The same, photon by photon.
fn yellow_photons(quantum_yield: f64) -> f64 {
    const STEP_NM: f64 = 0.125;
    let shape = triangle(TRIANGLE);
    let out: Vec<(f64, f64)> = (0..960)
        .map(|i| 500.0 + STEP_NM * (f64::from(i) + 0.5))
        // Energy over wavelengths is photons over wavelength.
        .map(|nm| (nm, shape(nm) * nm))
        .collect();
    let all: f64 = out.iter().map(|(_, photons)| photons).sum();
    let absorbed: f64 = (0..320).map(|i| 380.0 + STEP_NM * (f64::from(i) + 0.5)).map(|nm| 0.9 * STEP_NM * nm).sum();
    out.iter().map(|(nm, photons)| absorbed * quantum_yield * photons / all / nm * photometric_weight(*nm)).sum()
}

const PHOTONS: &str = "Each photon that a dye absorbs gives Q photons, spread as e(λ)λ over wavelengths, and a photon's energy goes as 1/λ: \
                       Φ(λᵢ, λₒ) = Q a(λᵢ) λᵢ e(λₒ)/∫eλdλ. A diffuse plate under a sky of radiance L shows ∫ΦL dλᵢ.";

fn photons() -> Truth {
    let scene = plate(&fluorescent(&[yellow(0.8)])).light(sky(&band(380.0, 420.0, 1.0)));
    let [a, _, c] = TRIANGLE;
    let shape = triangle(TRIANGLE);
    let as_energy = 0.8 * 0.9 * 40.0 / ((c - a) / 2.0) * integral(500, 620, |nm| photometric_weight(nm) * shape(nm));
    Truth::new(
        "dye-under-a-sky",
        &scene,
        yellow_light(0.8),
        "Q ∫aλdλ/∫eλdλ · ∫ȳe dλ/∫ȳ dλ, Q = 0.8, a = 0.9 from 380 to 420 nm",
    )
    .because(PHOTONS)
    .confirmed("photon by photon", 1e-5, || yellow_photons(0.8))
    .or_else("the share of energy taken for that of photons", as_energy)
    .or_else("a quantum yield of 1", yellow_light(1.0))
    .or_else("light reflected at its own wavelength", 0.9 * seen(380, 420))
    .no_brighter_than(1.0)
    .sees(5e-3)
}

/// By shadow rays alone.
fn lit_by_a_lamp() -> Truth {
    let light = json!({ "type": "directional", "direction": [0, 0.6, -0.8], "irradiance": band(380.0, 420.0, 5.0) });
    let scene = plate(&fluorescent(&[yellow(0.8)])).light(light);
    let value = 5.0 * 0.8 * FRAC_1_PI * yellow_light(0.8);
    Truth::new("dye-in-the-sun", &scene, value, "E cos θ/π · ∫Φ dλᵢ, E = 5 W·m⁻²·nm⁻¹ from 380 to 420 nm, cos θ = 0.8")
        .because(PHOTONS)
        .confirmed("photon by photon", 1e-5, || 4.0 / PI * yellow_photons(0.8))
        .or_else("nothing is given back", 0.0)
        .or_else("no cosine", value / 0.8)
        .no_brighter_than(5.0)
        .sees(5e-3)
}

/// Rows that differ in shape, so that no product of a spectrum of absorption and one of emission gives the same.
fn measured_matrix() -> Truth {
    let (excitation, emission) = ([400.0, 450.0, 500.0], [480.0, 530.0, 600.0, 660.0]);
    let rows = [[0.0, 2e-3, 1e-3, 0.0], [1e-3, 4e-3, 2e-3, 0.0], [0.0, 0.0, 3e-3, 2e-3]];
    let material = json!({ "type": "fluorescent", "reflectance": 0.1,
        "reradiation": { "excitation_nm": excitation, "emission_nm": emission, "per_nm": rows } });
    let scene = plate(&material).light(sky(&table(&[[400.0, 1.0], [500.0, 2.0]])));
    let light = |nm: f64| if (400.0..=500.0).contains(&nm) { 1.0 + (nm - 400.0) / 100.0 } else { 0.0 };
    // Between the nodes of excitation light and Φ are linear: Simpson's rule over each of the two stretches is exact.
    let row = move |k: usize, nm: f64| {
        let Some(j) = (0..3).find(|j| (emission[*j]..=emission[j + 1]).contains(&nm)) else { return 0.0 };
        let t = (nm - emission[j]) / (emission[j + 1] - emission[j]);
        (1.0 - t) * rows[k][j] + t * rows[k][j + 1]
    };
    let given_back = move |nm: f64| {
        (0..2)
            .map(|k| {
                let middle = 0.5 * (row(k, nm) + row(k + 1, nm)) * light(425.0 + 50.0 * k as f64);
                let ends = row(k, nm) * light(excitation[k]) + row(k + 1, nm) * light(excitation[k + 1]);
                50.0 / 6.0 * (ends + 4.0 * middle)
            })
            .sum::<f64>()
    };
    let reflected = 0.1 * integral(400, 500, |nm| photometric_weight(nm) * light(nm));
    let value = reflected + integral(480, 660, |nm| photometric_weight(nm) * given_back(nm));
    let separable = |nm: f64| {
        // The mean row, excited as each row is in sum.
        let mean: f64 = (0..3).map(|k| row(k, nm)).sum::<f64>() / 3.0;
        mean * integral(400, 500, light)
    };
    Truth::new("measured-reradiation", &scene, value, "ρ∫ȳL dλ + ∫∫ȳ(λₒ)Φ(λᵢ, λₒ)L(λᵢ) dλᵢ dλₒ, over ∫ȳ dλ")
        .because("Light of every wavelength is given back by its own row of Φ, bilinear between the values stated, beside what is reflected.")
        .confirmed("a sum over squares of a quarter of a nanometre", 1e-4, move || {
            let phi = |i: f64, o: f64| {
                let k = usize::from(i >= 450.0);
                let s = (i - excitation[k]) / 50.0;
                (1.0 - s) * row(k, o) + s * row(k + 1, o)
            };
            let mut sum = reflected;
            for o in (0..720).map(|j| 480.0 + 0.25 * (f64::from(j) + 0.5)) {
                let back: f64 = (0..400).map(|j| 400.0 + 0.25 * (f64::from(j) + 0.5)).map(|i| phi(i, o) * light(i)).sum();
                sum += photometric_weight(o) * back / 16.0;
            }
            sum
        })
        .or_else("rows and columns exchanged, or one row for all", reflected + integral(480, 660, |nm| photometric_weight(nm) * separable(nm)))
        .or_else("only reflected", reflected)
        .no_brighter_than(2.0)
        .sees(5e-3)
}

/// Light goes in at one wavelength and comes out at another, through the same absorbing slab.
fn behind_a_filter() -> Truth {
    let absorption = json!({ "type": "tabulated", "wavelengths_nm": [360, 450, 480, 830], "values": [3, 3, 0.5, 0.5] });
    let slab = json!({ "type": "boundary", "medium": { "absorption_per_m": absorption, "scattering_per_m": 0 } });
    let light = json!({ "type": "directional", "direction": [0, 0, -1], "irradiance": band(380.0, 420.0, 5.0) });
    let scene = plate(&fluorescent(&[yellow(0.8)])).light(light).thing(json!({
        "shape": block([-2.0, -2.0, 0.5], [2.0, 2.0, 1.0]),
        "material": slab }));
    let through = |per_m: f64| (-0.5 * per_m).exp();
    let bare = 5.0 * FRAC_1_PI * yellow_light(0.8);
    Truth::new("dye-behind-a-filter", &scene, bare * through(3.0) * through(0.5), "e^(−0.5·3) on the way in, e^(−0.5·0.5) on the way out, times E/π ∫Φ dλᵢ")
        .because("A slab absorbs light of the wavelength that it has on its way: of the excitation before the plate, of what is given back after it.")
        .confirmed("photon by photon, a hundred thousand thin layers each way", 1e-3, || {
            let layers = |per_m: f64| (1.0 - per_m * 0.5e-5_f64).powi(100_000);
            5.0 / PI * yellow_photons(0.8) * layers(3.0) * layers(0.5)
        })
        .or_else("both ways at the wavelength of excitation", bare * through(3.0) * through(3.0))
        .or_else("both ways at the wavelength that is seen", bare * through(0.5) * through(0.5))
        .claims(Claim::Absorption)
        .no_brighter_than(5.0)
        .sees(5e-3)
}

fn half_of_a_blend() -> Truth {
    let material = json!({ "type": "blend", "weight": 0.25,
        "first": { "type": "lambert", "reflectance": 0.3 },
        "second": { "type": "blend", "first": fluorescent(&[yellow(0.8)]), "second": fluorescent(&[yellow(0.4)]), "weight": 0.5 } });
    let scene = plate(&material).light(sky(&band(380.0, 420.0, 1.0)));
    let reflected = 0.75 * 0.3 * seen(380, 420);
    Truth::new(
        "dyes-in-a-blend",
        &scene,
        reflected + 0.25 * yellow_light(0.6),
        "¾ · 0.3 reflected, and ¼ of two dyes with the mean yield 0.6",
    )
    .because("Parts of a blend lie side by side: each gives back what its share of the surface receives.")
    .confirmed("part by part, photon by photon", 1e-5, move || {
        reflected + 0.125 * yellow_photons(0.8) + 0.125 * yellow_photons(0.4)
    })
    .or_else("a dye for the whole surface", reflected + yellow_light(0.6))
    .or_else("the first dye alone", reflected + 0.25 * yellow_light(0.8))
    .or_else("no dye", reflected)
    .no_brighter_than(1.0)
    .sees(0.01)
}

/// Two surfaces seen from behind: one fluoresces on its back, the other on its front.
fn one_side() -> Truth {
    let sided = |sides: &str| {
        let mut material = fluorescent(&[yellow(0.8)]);
        material["sides"] = json!(sides);
        material
    };
    let square = |y: f64| json!({ "type": "parallelogram", "origin_m": [1.0, y, 0.0], "u_m": [-2.0, 0.0, 0.0], "v_m": [0.0, 1.0, 0.0] });
    let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1.0)
        .thing(json!({ "shape": square(0.0), "material": sided("back") }))
        .thing(json!({ "shape": square(-1.0), "material": sided("front") }))
        .light(sky(&band(380.0, 420.0, 1.0)))
        .film(16, 16)
        .spp(256);
    Truth::new(
        "dye-on-one-side",
        &scene,
        0.5 * yellow_light(0.8),
        "half of ∫Φ dλᵢ: the lower half of the picture shows the back of what fluoresces on its front",
    )
    .because(PHOTONS)
    .confirmed("photon by photon", 1e-5, || 0.5 * yellow_photons(0.8))
    .or_else("both sides", yellow_light(0.8))
    .no_brighter_than(1.0)
    .sees(0.01)
}

/// Albedo ½ up to 500 nm and 0.8 from 550 nm on.
fn walls() -> Value {
    json!({ "type": "tabulated", "wavelengths_nm": [360, 500, 550, 830], "values": [0.5, 0.5, 0.8, 0.8] })
}

/// A closed room whose walls shine with radiance 1 from 400 to 500 nm, and give 0.3 of what they receive there back from 550 to 650 nm.
fn room() -> Scene {
    let material = json!({ "type": "fluorescent", "reflectance": walls(), "reradiation":
        { "excitation_nm": [400, 500], "emission_nm": [550, 650], "per_nm": [[0.003, 0.003], [0.003, 0.003]] } });
    Scene::pinhole([0.6, 0.0, 0.0], [0.0; 3], 30.0)
        .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": material, "emission": { "radiance": band(400.0, 500.0, 1.0), "sides": "both" } }))
        .film(16, 16)
        .spp(256)
}

/// The balance of two bands, reflection by reflection.
fn reflections() -> f64 {
    let (mut blue, mut red) = (0.0, 0.0);
    for _ in 0..400 {
        (blue, red) = (1.0 + 0.5 * blue, 0.8 * red + 0.3 * blue);
    }
    blue * seen(400, 500) + red * seen(550, 650)
}

fn rooms() -> [Truth; 2] {
    let ball = json!({ "shape": sphere([0.0; 3], 0.3), "material": { "type": "dielectric", "interior": "N-BK7" } });
    [("fluorescent-room", room()), ("glass-ball-in-a-fluorescent-room", room().thing(ball))].map(|(name, scene)| {
        let (blue, red) = (seen(400, 500), seen(550, 650));
        let truth = Truth::new(name, &scene, 2.0 * blue + 3.0 * red, "2 from 400 to 500 nm and 3 from 550 to 650 nm, of L = (1 − D)⁻¹E, D = [[0.5, 0], [0.3, 0.8]], E = (1, 0)")
            .because(
                "In a closed room that shines alike everywhere all radiance is the same, L = E + DL, with reflectances on the diagonal of D and \
                 the transfer of fluorescence beside it. Clear glass changes nothing there: its ways lead from wall to wall.",
            )
            .confirmed("reflection by reflection", 1e-10, reflections)
            .or_else("nothing is given back", 2.0 * blue)
            .or_else("given back once, and not reflected then", 2.0 * blue + 0.6 * red)
            .or_else("excited by the lamps alone", 2.0 * blue + 1.5 * red)
            .no_brighter_than(3.0)
            .sees(0.01);
        if name.starts_with("glass") { truth.claims(Claim::Dispersion) } else { truth }
    })
}

/// Ultraviolet to blue, and blue to red.
fn two_steps() -> Truth {
    let material = json!({ "type": "fluorescent", "reflectance": 0.4, "fluorophores": [
        dye(&band(380.0, 400.0, 0.5), &band(440.0, 480.0, 1.0), 1.0),
        dye(&band(440.0, 480.0, 0.3), &band(600.0, 640.0, 1.0), 0.9),
    ] });
    let scene = Scene::pinhole([0.6, 0.0, 0.0], [0.0; 3], 30.0)
        .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": material, "emission": { "radiance": band(380.0, 400.0, 1.0), "sides": "both" } }))
        .film(16, 16)
        .spp(256);
    // Radiances of 1/(1 − 0.4), and between bands ∫λᵢ dλᵢ / ∫λ dλ.
    let kept = 1.0 / 0.6;
    let first = 0.5 * 20.0 * 390.0 / (40.0 * 460.0);
    let second = 0.9 * 0.3 * 40.0 * 460.0 / (40.0 * 620.0);
    let [violet, blue, red] = [kept, kept * kept * first, kept * kept * kept * first * second];
    let value = violet * seen(380, 400) + blue * seen(440, 480) + red * seen(600, 640);
    Truth::new("fluorescence-in-two-steps", &scene, value, "E/(1 − ρ), times D₁/(1 − ρ), times D₂/(1 − ρ): ρ = 0.4, D₁ = 0.212, D₂ = 0.2003")
        .because("In a closed room L = (1 − D)⁻¹E. What one dye gives back excites another, so light reaches the eye that has changed its wavelength twice.")
        .confirmed("reflection by reflection, nanometre by nanometre", 1e-6, || {
            let nm = |i: usize| 380.5 + i as f64;
            let within = |i: usize, [from, to]: [f64; 2]| f64::from(u8::from((from..to).contains(&nm(i))));
            let mut light = vec![0.0; 300];
            for _ in 0..200 {
                let photons = |band: [f64; 2]| (0..300).map(|i| within(i, band) * light[i] * nm(i)).sum::<f64>();
                let (to_blue, to_red) = (0.5 * photons([380.0, 400.0]), 0.27 * photons([440.0, 480.0]));
                // Spread as photons over all of the band, each with the energy of its wavelength.
                light = (0..300)
                    .map(|i| {
                        within(i, [380.0, 400.0]) + 0.4 * light[i]
                            + within(i, [440.0, 480.0]) * to_blue / (40.0 * 460.0)
                            + within(i, [600.0, 640.0]) * to_red / (40.0 * 620.0)
                    })
                    .collect();
            }
            (0..300).map(|i| light[i] * seen(380 + i as u32, 381 + i as u32)).sum()
        })
        .or_else("one step alone", value - red * seen(600, 640))
        .or_else("no factor between energies", violet * seen(380, 400)
            + kept * kept * 0.25 * seen(440, 480) + kept.powi(3) * 0.25 * 0.27 * seen(600, 640))
        .no_brighter_than(2.0)
        .sees(0.02)
}

/// Light that was given back is unpolarised, whatever excited it; the polariser before the eye makes it what it lets pass.
fn through_a_polariser() -> Truth {
    let polariser = json!({ "type": "polariser", "axis": [1, 0, 0] });
    let light = json!({ "type": "directional", "direction": [0.8, 0, -0.6], "irradiance": band(380.0, 420.0, 5.0) });
    let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1e-3)
        .up([0.0, 1.0, 0.0])
        .thing(json!({ "shape": level_square([0.0; 3], 10.0, true), "material": fluorescent(&[yellow(0.8)]) }))
        .thing(json!({ "shape": level_square([0.0, 0.0, 1.0], 0.01, true), "material": polariser }))
        .light(light)
        .set("film", "stokes", json!(true))
        .film(4, 4)
        .spp(4096);
    let value = 0.5 * 5.0 * 0.6 * FRAC_1_PI * yellow_light(0.8);
    Truth::new("dye-through-a-polariser-s1", &scene, value, "½ E cos θ/π · ∫Φ dλᵢ, all of it along the axis")
        .because("What a dye emits has no memory of what excited it: unpolarised, half of it passes a polariser, and then swings along its axis.")
        .confirmed("photon by photon", 1e-5, || 1.5 / PI * yellow_photons(0.8))
        .or_else("the other sign", -value)
        .or_else("nothing that is polarised", 0.0)
        .claims(Claim::CarriesPolarisation)
        .reads(Quantity::Stokes1)
        .sees(5e-3)
}
