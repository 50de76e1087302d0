//! Spectra, glasses and metals as scenes name or tabulate them, at wavelengths where their values are published.

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    furnaces::conductor_reflectance,
    photometric_weight,
    scene::{Scene, black, block, level_square, sphere},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = glasses();
    list.extend(metals());
    list.extend(skies());
    list.extend(reflectances());
    list.extend(absorption());
    list
}

/// A band so narrow that it counts as one wavelength, nm.
fn at(wavelength_nm: f64) -> [f64; 2] {
    [wavelength_nm - 5e-4, wavelength_nm + 5e-4]
}

fn sellmeier(b: &[f64], c_um2: &[f64], wavelength_nm: f64) -> f64 {
    let square = (1e-3 * wavelength_nm).powi(2);
    (1.0 + b.iter().zip(c_um2).map(|(b, c)| b * square / (square - c)).sum::<f64>()).sqrt()
}

/// Eyes inside of balls of a glass, which see n².
fn glasses() -> Vec<Truth> {
    const D: f64 = 587.5618;
    const F: f64 = 486.1327;
    let eye = |name: String, index: Value, nm: f64, n: f64, digits: f64, source: &'static str| {
        let scene = Scene::pinhole([0.2, 0.1, 0.0], [1.0, 0.5, -1.0], 60.0)
            .thing(json!({ "shape": sphere([0.0; 3], 1.0), "material": { "type": "dielectric", "interior": index } }))
            .sky(1.0)
            .spp(256)
            .film(16, 16)
            .band(at(nm));
        Truth::new(name, &scene, n * n, format!("n² = {n}², n at {nm} nm"))
            .because(
                "An eye in a body of index n in a uniform sky of radiance 1 sees n² everywhere, whatever the way in.",
            )
            .allows(2.0 * n * digits, source)
            .or_else("radiance not scaled by n²", 1.0)
            .sees(2e-3)
    };
    let named = |name: &str, line: &str, nm: f64, n: f64, digits: f64| {
        let truth = eye(
            format!("eye-in-{}-at-{line}", name.to_lowercase()),
            json!(name),
            nm,
            n,
            digits,
            "the digits of the published index",
        );
        let glass = json!({ "type": "glass", "name": name, "outside_fit": "clamp" });
        (truth, glass)
    };
    // Schott's data sheets; Malitson (1965) for fused silica; Daimon and Masumura (2007) for water at 20 °C; Peter (1923) for diamond.
    let mut list: Vec<Truth> = [
        named("N-BK7", "d", D, 1.516_80, 1e-5),
        named("N-BK7", "f", F, 1.522_38, 1e-5),
        named("N-SF11", "d", D, 1.784_72, 1e-5),
        named("N-SF11", "f", F, 1.806_51, 1.5e-5),
        named("fused-silica", "d", D, 1.458_46, 1e-5),
        named("fused-silica", "f", F, 1.463_13, 1e-5),
        named("water", "d", D, 1.333_4, 1e-4),
        named("diamond", "d", D, 2.4175, 2e-4),
    ]
    .into_iter()
    .map(|(truth, _)| truth)
    .collect();
    for name in ["N-BK7", "N-SF11", "fused-silica", "water"] {
        let published = [("N-BK7", 1.516_80), ("N-SF11", 1.784_72), ("fused-silica", 1.458_46), ("water", 1.333_4)];
        let n = published.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, n)| *n);
        let glass = json!({ "type": "glass", "name": name });
        let title = format!("eye-in-a-glass-named-{}", name.to_lowercase());
        list.push(eye(
            title,
            glass,
            D,
            n,
            if name == "water" { 1e-4 } else { 1e-5 },
            "the digits of the published index",
        ));
    }
    // Diamond's fit ends at 760 nm; beyond it the index stays.
    let edge = sellmeier(&[0.3306, 4.3356], &[0.175 * 0.175, 0.106 * 0.106], 760.0);
    let clamped = json!({ "type": "glass", "name": "diamond", "outside_fit": "clamp" });
    list.push(eye("eye-in-diamond-beyond-its-fit".into(), clamped, 800.0, edge, 1e-6, "the last digit of the index"));
    let cauchy = |nm: f64| 1.5 + 0.005 / (1e-3 * nm).powi(2) + 2e-4 / (1e-3 * nm).powi(4);
    let of_cauchy = json!({ "type": "cauchy", "a": 1.5, "b_um2": 0.005, "c_um4": 2e-4, "range_nm": [400, 700] });
    let mut beyond = of_cauchy.clone();
    beyond["outside_fit"] = json!("clamp");
    list.push(
        eye("eye-in-a-glass-of-cauchy".into(), of_cauchy, 450.0, cauchy(450.0), 1e-7, "the last digit of the index")
            .or_else("without the second coefficient", (1.5 + 2e-4 / 0.45_f64.powi(4)).powi(2))
            .or_else("without the third coefficient", (1.5 + 0.005 / 0.45_f64.powi(2)).powi(2)),
    );
    list.push(
        eye(
            "eye-in-a-glass-of-cauchy-beyond-its-fit".into(),
            beyond,
            800.0,
            cauchy(700.0),
            1e-7,
            "the last digit of the index",
        )
        .or_else("the formula continued", cauchy(800.0).powi(2)),
    );
    let (b, c) = ([0.8, 0.9], [0.01, 100.0]);
    let of_sellmeier =
        json!({ "type": "sellmeier", "b": b, "c_um2": c, "range_nm": [500, 600], "outside_fit": "clamp" });
    list.push(
        eye(
            "eye-in-a-glass-of-sellmeier-beyond-its-fit".into(),
            of_sellmeier,
            450.0,
            sellmeier(&b, &c, 500.0),
            1e-7,
            "the last digit of the index",
        )
        .or_else("the formula continued", sellmeier(&b, &c, 450.0).powi(2)),
    );
    let constant = json!({ "type": "constant", "value": 1.7 });
    list.push(eye("eye-in-a-glass-of-one-index".into(), constant, 550.0, 1.7, 1e-7, "the last digit of the index"));
    list
}

fn metals() -> Vec<Truth> {
    // Johnson and Christy (1972) at 2.38 eV and 1.76 eV, Rakić (1995) at 2.2 eV: n, k.
    let plate = |name: String, material: Value, nm: f64, n: f64, k: f64| {
        let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1)
            .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": material }))
            .sky(1.0)
            .film(16, 16)
            .spp(64)
            .band(at(nm));
        let value = conductor_reflectance(n, k, 1.0);
        Truth::new(name, &scene, value, format!("((n − 1)² + k²)/((n + 1)² + k²), n = {n}, k = {k} at {nm} nm"))
            .because("A flat metal at normal incidence shows its reflectance under a sky of radiance 1.")
            .confirmed("the formula at normal incidence", 1e-12, move || {
                ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
            })
            .or_else("k left out", conductor_reflectance(n, 0.0, 1.0))
            .sees(1e-3)
    };
    let mut list: Vec<Truth> = [
        ("Ag", 520.9, 0.05, 3.324),
        ("Ag", 704.5, 0.04, 4.838),
        ("Au", 520.9, 0.62, 2.081),
        ("Au", 704.5, 0.13, 4.103),
        ("Cu", 548.6, 1.02, 2.577),
        ("Cu", 704.5, 0.21, 4.205),
        ("Al", 563.57, 1.0728, 6.7839),
    ]
    .into_iter()
    .map(|(metal, nm, n, k)| {
        plate(
            format!("{}-at-{nm}-nanometres", metal.to_lowercase()),
            json!({ "type": "conductor", "metal": metal }),
            nm,
            n,
            k,
        )
    })
    .collect();
    let table = json!({ "type": "conductor", "wavelengths_nm": [500, 600], "n": [0.2, 0.6], "k": [3, 2] });
    let mut beyond = table.clone();
    beyond["outside_fit"] = json!("clamp");
    list.push(
        plate("metal-of-a-table-between-its-rows".into(), table, 525.0, 0.3, 2.75)
            .or_else("the nearest row", conductor_reflectance(0.2, 3.0, 1.0)),
    );
    list.push(
        plate("metal-of-a-table-beyond-its-rows".into(), beyond, 650.0, 0.6, 2.0)
            .or_else("continued", conductor_reflectance(0.8, 1.5, 1.0)),
    );
    list
}

/// The CIE's formula of illuminant A, relative to 560 nm.
fn illuminant_a(nm: f64) -> f64 {
    (560.0 / nm).powi(5) * (1.435e7_f64 / (2848.0 * 560.0)).exp_m1() / (1.435e7 / (2848.0 * nm)).exp_m1()
}

/// D65 from 380 to 780 nm in steps of 10 nm, relative to 560 nm (ISO/CIE 11664-2); linear in between.
const D65: [f64; 41] = [
    49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354,
    107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886,
    83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856, 75.087, 63.5927, 46.4182,
    66.8054, 63.3828,
];

fn d65(nm: f64) -> f64 {
    let x = ((nm - 380.0) / 10.0).clamp(0.0, 39.999_999);
    let i = x as usize;
    0.01 * (D65[i] + (x - i as f64) * (D65[i + 1] - D65[i]))
}

/// The mean of a spectrum as the observer weighs it.
fn luminance(spectrum: fn(f64) -> f64) -> f64 {
    (0..=470).map(|i| f64::from(360 + i)).map(|nm| photometric_weight(nm) * spectrum(nm)).sum()
}

fn skies() -> Vec<Truth> {
    let sky = |name: &str, radiance: Value, band: Option<[f64; 2]>, value: f64, formula: &str| {
        let scene = Scene::pinhole([0.0; 3], [0.0, 0.0, -1.0], 60.0)
            .light(json!({ "type": "environment", "radiance": radiance }))
            .film(16, 16)
            .spp(4096);
        let scene = match band {
            Some(band) => scene.band(band),
            None => scene,
        };
        Truth::new(name, &scene, value, formula)
            .because(
                "A sky shows its own radiance. An illuminant of scale s has the luminance of the constant spectrum s; a colour with its white \
                 has the luminance of its channels.",
            )
            .claims(Claim::PhotometricSensor)
            .sees(5e-3)
    };
    let illuminant = |name: &str, scale: f64| json!({ "type": "illuminant", "name": name, "scale": scale });
    let whole = |name: &str| {
        sky(&format!("sky-of-{}", name.to_lowercase()), illuminant(name, 3.0), None, 3.0, "scale = 3")
            .or_else("the spectrum as tabulated, 100 at 560 nm", 300.0)
            .or_else("the scale left out", 1.0)
    };
    let mut list = vec![whole("D65"), whole("A"), whole("E")];
    let (of_a, of_d65) = (luminance(illuminant_a), luminance(d65));
    for (nm, name, value) in [
        (450.0, "A", illuminant_a(450.0) / of_a),
        (640.0, "A", illuminant_a(640.0) / of_a),
        (450.0, "D65", d65(450.0) / of_d65),
        (640.0, "D65", d65(640.0) / of_d65),
        (450.0, "E", 1.0),
    ] {
        list.push(
            sky(
                &format!("sky-of-{}-at-{nm}-nanometres", name.to_lowercase()),
                illuminant(name, 1.0),
                Some(at(nm)),
                value,
                "S(λ)/Σȳ S · Σȳ",
            )
            .allows(
                1e-3 * value,
                "the table of D65 in steps of 10 nm differs from that of 5 nm by some 1e-4 in its luminance",
            )
            .or_else(
                "relative to 560 nm",
                if name == "E" {
                    0.5
                } else if name == "A" {
                    illuminant_a(nm)
                } else {
                    2.0 * d65(nm)
                },
            ),
        );
    }
    let table = |outside: &str| json!({ "type": "tabulated", "wavelengths_nm": [500, 600], "values": [1, 3], "outside": outside, "scale": 0.5 });
    list.push(
        sky("sky-of-a-table-between-its-rows", table("error"), Some(at(525.0)), 0.75, "½(1 + ¼·2)")
            .or_else("the nearest row", 0.5)
            .or_else("the scale left out", 1.5),
    );
    list.push(
        sky("sky-of-a-table-clamped", table("clamp"), Some(at(650.0)), 1.5, "½·3")
            .or_else("continued", 2.0)
            .or_else("zero", 0.0),
    );
    list.push(sky("sky-of-a-table-ended", table("zero"), Some(at(650.0)), 0.0, "0").or_else("clamped", 1.5));
    list.push(
        sky("sky-of-a-constant", json!({ "type": "constant", "value": 2.5 }), None, 2.5, "2.5").or_else("one", 1.0),
    );
    let rgb = |white: &str| json!({ "type": "rgb", "rgb": [0.5, 0.25, 2], "white": white, "scale": 2 });
    let value = 2.0 * (0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 2.0);
    for white in ["D65", "E", "A"] {
        list.push(
            sky(
                &format!("sky-of-a-colour-with-white-{}", white.to_lowercase()),
                rgb(white),
                None,
                value,
                "2(0.2126 R + 0.7152 G + 0.0722 B)",
            )
            .allows(
                2e-4 * value,
                "the luminances of the primaries are rounded to four digits, and an upsampled colour is met to 1e-4",
            )
            .or_else("red and blue exchanged", 2.0 * (0.2126 * 2.0 + 0.7152 * 0.25 + 0.0722 * 0.5))
            .or_else("the scale left out", 0.5 * value),
        );
    }
    list
}

fn reflectances() -> Vec<Truth> {
    let table = json!({ "type": "tabulated", "wavelengths_nm": [400, 500, 600], "values": [0.2, 0.8, 0.4], "outside": "clamp" });
    let plate = |name: &str, reflectance: Value, nm: f64, value: f64| {
        let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 0.1)
            .set("spectra", "paint", table.clone())
            .set("spectra", "wall", json!("paint"))
            .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": "matt" }))
            .set("materials", "matt", json!({ "type": "lambert", "reflectance": reflectance }))
            .sky(1.0)
            .film(16, 16)
            .spp(64)
            .band(at(nm));
        Truth::new(name, &scene, value, "the table, linear between its rows")
            .because("A Lambert plate under a sky of radiance 1 shows its reflectance at the wavelength.")
            .sees(1e-3)
    };
    vec![
        plate("reflectance-of-a-table", table.clone(), 525.0, 0.7).or_else("the nearest row", 0.8),
        plate("reflectance-by-the-name-of-a-name", json!("wall"), 475.0, 0.65).or_else("the nearest row", 0.8),
        plate("reflectance-of-a-table-clamped", json!("paint"), 700.0, 0.4).or_else("continued", 0.0),
    ]
}

/// A plate of index 1 that absorbs by a table, before a lamp.
fn absorption() -> Vec<Truth> {
    const THICKNESS_M: f64 = 0.02;
    let plate = |name: &str, further: Value, nm: f64, value: f64, formula: &str| {
        let mut glass = json!({ "type": "dielectric", "interior": 1 });
        for (key, value) in further.as_object().into_iter().flatten() {
            glass[key] = value.clone();
        }
        let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 1e-3)
            .thing(json!({ "shape": block([-1.0, -1.0, -THICKNESS_M], [1.0, 1.0, 0.0]), "material": glass }))
            .lamp(level_square([0.0, 0.0, -0.1], 1.0, true), black(), 1.0, "front")
            .film(16, 16)
            .spp(64)
            .band(at(nm));
        Truth::new(name, &scene, value, formula)
            .because("Over d metres e^(−σd) of the light is left, at each wavelength with its own σ; a plate of index 1 reflects nothing.")
            .confirmed("dσ in a thousand steps", 1e-4, move || {
                let part = 1.0 + value.ln() / 1000.0 + 0.5 * (value.ln() / 1000.0).powi(2);
                part.powi(1000)
            })
            .or_else("nothing is absorbed", 1.0)
            .sees(1e-3)
    };
    let coefficients =
        json!({ "absorption_per_m": { "type": "tabulated", "wavelengths_nm": [400, 700], "values": [10, 70] } });
    let shares = json!({
        "transmittance": { "type": "tabulated", "wavelengths_nm": [400, 700], "values": [0.25, 0.5], "outside": "clamp" }, "transmittance_depth_m": 0.01,
    });
    let e = |x: f64| f64::exp(-x);
    vec![
        plate("coloured-absorption-in-blue", coefficients.clone(), 450.0, e(20.0 * THICKNESS_M), "e^(−20 · 0.02)")
            .or_else("the mean of the table", e(40.0 * THICKNESS_M)),
        plate("coloured-absorption-in-red", coefficients, 650.0, e(60.0 * THICKNESS_M), "e^(−60 · 0.02)")
            .or_else("the mean of the table", e(40.0 * THICKNESS_M)),
        plate("absorption-by-a-transmittance", shares.clone(), 400.0, 0.0625, "0.25², twice the depth")
            .or_else("the depth left out", 0.25)
            .or_else("in proportion to the depth", 0.5),
        plate("absorption-by-a-transmittance-in-red", shares, 700.0, 0.25, "0.5², twice the depth")
            .or_else("the depth left out", 0.5),
    ]
}
