//! Indices and metals by name: behind an interface, at a slant, and as layers too thick to see through. Tints, masking and wave plates in
//! places that the other truths leave out.

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    furnaces::conductor_reflectance,
    principled_lobes::{GLOSSY, Surface, direction},
    scene::{Scene, black, conductor, level_square, sphere},
    tiles::with,
};
use crate::{laws::fresnel_exact, vector::scale};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = eyes();
    list.extend(slanting());
    list.extend(thick_layers());
    list.extend([pane(), masking(), wave_plate()]);
    list
}

/// A band so narrow that it counts as one wavelength, nm.
fn at(nm: f64) -> [f64; 2] {
    [nm - 5e-4, nm + 5e-4]
}

/// n of diamond where its fit ends (Peter 1923), n of water, and Cauchy's and Sellmeier's formulas.
fn sellmeier(terms: [[f64; 2]; 2], nm: f64) -> f64 {
    let square = (1e-3 * nm).powi(2);
    (1.0 + terms.iter().map(|[b, c]| b * square / (square - c)).sum::<f64>()).sqrt()
}

/// Eyes in a ball of one index within another.
fn eyes() -> Vec<Truth> {
    const D: f64 = 587.5618;
    let named = |name: &str| json!({ "type": "glass", "name": name });
    let clamped = |index: Value| with(index, &json!({ "outside_fit": "clamp" }));
    let terms = [[0.7, 0.012], [0.9, 90.0]];
    let [b, c] = [0, 1].map(|k| terms.map(|term| term[k]));
    let of_sellmeier = json!({ "type": "sellmeier", "b": b, "c_um2": c, "range_nm": [580, 640] });
    let of_cauchy = json!({ "type": "cauchy", "a": 1.3, "b_um2": 0.006, "c_um4": 3e-4, "range_nm": [470, 700] });
    let cauchy = |nm: f64| 1.3 + 0.006 / (1e-3 * nm).powi(2) + 3e-4 / (1e-3 * nm).powi(4);
    let diamond = |nm: f64| sellmeier([[0.3306, 0.175 * 0.175], [4.3356, 0.106 * 0.106]], nm);
    let eye = |name: &str, inside: Value, outside: Value, nm: f64, [n, around]: [f64; 2], digits: f64| {
        let glass = json!({ "type": "dielectric", "interior": inside, "exterior": outside });
        let scene = Scene::pinhole([0.1, -0.2, 0.1], [1.0, 0.3, 0.6], 50.0)
            .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": glass }))
            .sky(1.0)
            .spp(256)
            .film(16, 16)
            .band(at(nm));
        let value = (n / around).powi(2);
        Truth::new(name, &scene, value, format!("(n/n′)² = ({n}/{around})² at {nm} nm"))
            .because("A ray that goes from a medium of index n′ into one of n keeps L/n². The eye sees the sky of radiance 1 around the ball (n/n′)² times as bright, whatever the way in.")
            .allows(2.0 * value * digits, "the digits of the published indices")
            .or_else("the medium around left out", n * n)
            .or_else("indices exchanged", value.recip())
            .or_else("radiance not scaled", 1.0)
            .sees(2e-3)
    };
    // Schott's data sheets; Malitson (1965) for fused silica; Daimon and Masumura (2007) for water at 20 °C.
    let (sf11, silica, bk7, water) = (1.784_72, 1.458_46, 1.516_80, 1.333_4);
    let (edge, ends) = (diamond(760.0), [sellmeier(terms, 580.0), cauchy(470.0)]);
    let beyond = |n: f64, around: f64| (n / around).powi(2);
    vec![
        eye("eye-in-sf11-within-silica", named("N-SF11"), named("fused-silica"), D, [sf11, silica], 1e-5)
            .or_else("another glass inside", beyond(bk7, silica))
            .or_else("another glass around", beyond(sf11, bk7)),
        eye("eye-in-bk7-within-water", named("N-BK7"), named("water"), D, [bk7, water], 1e-4)
            .or_else("another glass inside", beyond(silica, water))
            .or_else("ice around", beyond(bk7, 1.309)),
        eye(
            "eye-in-diamond-beyond-its-fit-within-a-constant",
            clamped(named("diamond")),
            json!({ "type": "constant", "value": 1.7 }),
            800.0,
            [edge, 1.7],
            1e-6,
        )
        .or_else("the index of the middle of its fit", beyond(diamond(500.0), 1.7)),
        eye("eye-in-two-formulas-beyond-their-fits", clamped(of_sellmeier), clamped(of_cauchy), 450.0, ends, 1e-7)
            .or_else("both formulas continued", beyond(sellmeier(terms, 450.0), cauchy(450.0)))
            .or_else("Sellmeier's continued", beyond(sellmeier(terms, 450.0), ends[1]))
            .or_else("Cauchy's continued", beyond(ends[0], cauchy(450.0))),
    ]
}

/// A plane that is seen at a slant in the light of an even sky, over black.
fn plane(material: &Value, tilt_deg: f64, nm: f64) -> Scene {
    Scene::orthographic(scale(2.0, direction(tilt_deg, 30.0)), [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 10.0, true), "material": material }))
        .object(level_square([0.0, 0.0, -0.1], 10.0, true), black())
        .sky(1.0)
        .film(16, 16)
        .spp(64)
        .band(at(nm))
}

/// (R_s + R_p)/2 of a metal by the angle of a complex ray: r_s = −sin(θ − θ′)/sin(θ + θ′), r_p = tan(θ − θ′)/tan(θ + θ′).
fn by_complex_angle(n: f64, k: f64, cosine: f64) -> f64 {
    // sin θ′ = sin θ/(n + ik), cos θ′ by its root.
    let sine = (1.0 - cosine * cosine).sqrt();
    let m2 = n * n + k * k;
    let within = [sine * n / m2, -sine * k / m2];
    let square = |[re, im]: [f64; 2]| [re * re - im * im, 2.0 * re * im];
    let [re, im] = square(within);
    let (re, im) = (1.0 - re, -im);
    let modulus = re.hypot(im);
    let root = [(0.5 * (modulus + re)).sqrt(), (0.5 * (modulus - re)).sqrt() * im.signum()];
    let norm2 = |[re, im]: [f64; 2]| re * re + im * im;
    // sin(θ ∓ θ′) and cos(θ ∓ θ′).
    let sin = |sign: f64| [0, 1].map(|p| sine * root[p] + sign * cosine * within[p]);
    let cos = |sign: f64| [0, 1].map(|p| cosine * root[p] - sign * sine * within[p]);
    let r_s = norm2(sin(-1.0)) / norm2(sin(1.0));
    0.5 * r_s * (1.0 + norm2(cos(1.0)) / norm2(cos(-1.0)))
}

/// Bare metals at a slant, one of them tinted.
fn slanting() -> Vec<Truth> {
    let shows = "A flat metal in uniform unpolarised light shows its reflectance times its tint.";
    let truth = |name: &str, material: &Value, tilt_deg: f64, nm: f64, [n, k, tint]: [f64; 3]| {
        let cosine = tilt_deg.to_radians().cos();
        let value = tint * conductor_reflectance(n, k, cosine);
        Truth::new(
            name,
            &plane(material, tilt_deg, nm),
            value,
            format!("{tint} (R_s + R_p)/2, n = {n}, k = {k} at {nm} nm and {tilt_deg}°"),
        )
        .because(shows)
        .confirmed("the angle of the complex ray", 1e-12, move || tint * by_complex_angle(n, k, cosine))
        .or_else("k left out", tint * conductor_reflectance(n, 0.0, cosine))
        .or_else("as from straight ahead", tint * conductor_reflectance(n, k, 1.0))
        .sees(1e-3)
    };
    // Rakić (1995) at 2.2 eV.
    let (n, k, tint) = (1.0728, 6.7839, 0.6);
    let aluminium = json!({ "type": "conductor", "metal": "Al", "reflected_tint": tint });
    let table = json!({ "type": "conductor", "wavelengths_nm": [500, 600], "n": [0.4, 0.9], "k": [2.5, 4], "outside_fit": "clamp" });
    let cosine = 75_f64.to_radians().cos();
    vec![
        truth("tinted-aluminium-at-60-degrees", &aluminium, 60.0, 563.57, [n, k, tint])
            .or_else("no tint", conductor_reflectance(n, k, 0.5))
            .or_else("the tint twice", tint * tint * conductor_reflectance(n, k, 0.5)),
        truth("metal-of-a-table-before-its-rows-at-75-degrees", &table, 75.0, 450.0, [0.4, 2.5, 1.0])
            .or_else("the last row", conductor_reflectance(0.9, 4.0, cosine))
            .or_else("continued", conductor_reflectance(0.15, 1.75, cosine)),
    ]
}

/// Layers of 2 µm of metal, which hide what is below them, at a slant.
fn thick_layers() -> Vec<Truth> {
    const BELOW: [f64; 2] = [2.2, 1.1];
    let truth = |name: String, layer: &Value, nm: f64, [n, k]: [f64; 2]| {
        let layer = with(layer.clone(), &json!({ "thickness_nm": 2000 }));
        let material = with(conductor(BELOW[0], BELOW[1]), &json!({ "thin_film": [layer] }));
        let cosine = 0.6;
        let value = conductor_reflectance(n, k, cosine);
        let tilt_deg = cosine.acos().to_degrees();
        Truth::new(
            name,
            &plane(&material, tilt_deg, nm),
            value,
            format!("(R_s + R_p)/2, n = {n}, k = {k} at {nm} nm, cos θ = 0.6"),
        )
        .because("A layer that light does not get through reflects as its metal does, whatever is below it.")
        .confirmed("the angle of the complex ray", 1e-12, move || by_complex_angle(n, k, cosine))
        .or_else("the layer left out", conductor_reflectance(BELOW[0], BELOW[1], cosine))
        .or_else("k left out", conductor_reflectance(n, 0.0, cosine))
        .claims(Claim::ThinFilms)
        .sees(2e-3)
    };
    // The rows of Johnson and Christy (1972) at 2.38 eV and 2.26 eV, of Rakić (1995) at 2.2 eV: n, k.
    let metals = [
        ("Ag", 520.9, 0.05, 3.324),
        ("Au", 520.9, 0.62, 2.081),
        ("Cu", 548.6, 1.02, 2.577),
        ("Al", 563.57, 1.0728, 6.7839),
    ];
    let mut list: Vec<Truth> = metals
        .into_iter()
        .map(|(metal, nm, n, k)| {
            let name = format!("thick-layer-of-{}-at-a-slant", metal.to_lowercase());
            truth(name, &json!({ "metal": metal }), nm, [n, k])
                .allows(2e-4, "wavelengths of the rows are rounded to a tenth of a nanometre")
        })
        .collect();
    let table = json!({ "wavelengths_nm": [500, 600], "n": [0.4, 0.9], "k": [2.5, 4], "outside_fit": "clamp" });
    list.push(
        truth("thick-layer-of-a-table-before-its-rows".to_owned(), &table, 450.0, [0.4, 2.5])
            .or_else("the last row", conductor_reflectance(0.9, 4.0, 0.6))
            .or_else("continued", conductor_reflectance(0.15, 1.75, 0.6)),
    );
    list
}

/// A pane before black: what it reflects of the sky alone.
fn pane() -> Truth {
    let (index, tint, cosine) = (1.7, 0.35, 0.5);
    let shares = fresnel_exact(cosine, index);
    let both = |r: f64| 2.0 * r / (1.0 + r);
    let reflects = 0.5 * (both(shares.r_s) + both(shares.r_p));
    let material = json!({ "type": "thin-dielectric", "index": index, "reflected_tint": tint });
    Truth::new(
        "tinted-reflection-of-a-pane-at-60-degrees",
        &plane(&material, 60.0, 550.0).spp(1024),
        tint * reflects,
        "0.35 · the mean of 2R/(1 + R) for s and p, n = 1.7, 60°",
    )
    .because("A pane mirrors 2R/(1 + R), of which its tint leaves a share. Of what it passes nothing comes back.")
    .confirmed("the beams one by one", 1e-12, move || {
        let beams = |r: f64| r + (0..200).map(|k| (1.0 - r).powi(2) * r.powi(2 * k + 1)).sum::<f64>();
        0.5 * tint * (beams(shares.r_s) + beams(shares.r_p))
    })
    .or_else("no tint", reflects)
    .or_else("one face", tint * 0.5 * (shares.r_s + shares.r_p))
    .or_else("the tint of each face", {
        let beams = |r: f64| tint * r + (0..200).map(|k| (1.0 - r).powi(2) * (tint * r).powi(2 * k + 1)).sum::<f64>();
        0.5 * (beams(shares.r_s) + beams(shares.r_p))
    })
    .or_else("averaged before the passes", tint * both(0.5 * (shares.r_s + shares.r_p)))
    .claims(Claim::AveragesPolarisation)
    .sees(5e-3)
}

/// A highlight of glass whose facets hide each other direction by direction.
fn masking() -> Truth {
    let (o, i, apart) = (65.0, 55.0, 150.0);
    let surface = Surface { index: 1.5, alpha: [0.7; 2], ..GLOSSY };
    let (to_viewer, to_light) = (direction(o, 20.0), direction(i, 20.0 + apart));
    let glass = json!({
        "type": "dielectric", "interior": 1.5, "alpha": 0.7, "masking": "separable", "multiple_scattering": "lost",
    });
    let scene = Scene::orthographic(scale(2.0, to_viewer), [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 10.0, true), "material": glass }))
        .directional_light(to_light.map(|x| -x), 1.0)
        .film(16, 16)
        .spp(64);
    let value = surface.f_cos(to_viewer, to_light);
    let lambda = |deg: f64| 0.5 * ((1.0 + (0.7 * deg.to_radians().tan()).powi(2)).sqrt() - 1.0);
    let (l_o, l_i) = (lambda(o), lambda(i));
    let correlated = value * (1.0 + l_o) * (1.0 + l_i) / (1.0 + l_o + l_i);
    Truth::new("glass-of-separable-masking-in-the-sun", &scene, value, "F D G₁ G₁/(4 cos θ_o), α = 0.7, n = 1.5")
        .because("In the light of a distant lamp of irradiance 1 a facetted interface shows f cos θ_i; over nothing at all there is no more.")
        .confirmed("spherical triangles", 1e-9, move || surface.by_angles(o, i, apart))
        .or_else("masking correlated in height", correlated)
        .or_else("no masking", value * (1.0 + l_o) * (1.0 + l_i))
        .or_else("masking of the viewer alone", value * (1.0 + l_i))
        .claims(Claim::AveragesPolarisation)
        .sees(2e-3)
}

/// A plate that is half a wave at 500 nm between parallel polarisers, in red.
fn wave_plate() -> Truth {
    const NM: f64 = 640.0;
    const AXIS_DEG: f64 = 25.0;
    let axis = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        json!([cos, sin, 0.0])
    };
    let polariser = json!({ "type": "polariser", "axis": axis(0.0) });
    let plate = json!({ "type": "retarder", "axis": axis(AXIS_DEG), "retardance_deg": 180, "at_nm": 500 });
    let place = |scene: Scene, (k, sheet): (usize, &Value)| {
        scene.thing(json!({ "shape": level_square([0.0, 0.0, 1.0 - 0.2 * k as f64], 1.0, true), "material": sheet }))
    };
    let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1).film(16, 16).spp(64).band(at(NM));
    let scene = [polariser.clone(), plate, polariser].iter().enumerate().fold(scene, place);
    let scene = scene.lamp(level_square([0.0, 0.0, -1.0], 1.0, true), black(), 1.0, "front");
    let of = |delay_deg: f64| {
        0.5 - 0.5 * (2.0 * AXIS_DEG).to_radians().sin().powi(2) * (0.5 * delay_deg).to_radians().sin().powi(2)
    };
    let delay = 180.0 * 500.0 / NM;
    Truth::new("wave-plate-in-red-between-parallel-polarisers", &scene, of(delay), "½(1 − sin²2φ sin²(δ/2)), φ = 25°, δ = 180° · 500/640")
        .because("The delay of a plate is in inverse proportion to the wavelength. What a polariser passes of the delayed wave follows from its two parts.")
        .confirmed("the field's two components with their phases", 1e-12, move || {
            let ((s, c), delay) = (AXIS_DEG.to_radians().sin_cos(), delay.to_radians());
            // Light along x has the parts c and s along both axes; s is late.
            let field = [c * c + s * s * delay.cos(), s * s * delay.sin()];
            0.5 * (field[0] * field[0] + field[1] * field[1])
        })
        .or_else("the same delay at every wavelength", of(180.0))
        .or_else("in proportion to the wavelength", of(180.0 * NM / 500.0))
        .or_else("the plate left out", of(0.0))
        .claims(Claim::CarriesPolarisation)
        .sees(3e-3)
}
