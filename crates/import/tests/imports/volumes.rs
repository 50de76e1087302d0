//! What is inside of bodies of glTF: media that absorb and scatter.

use super::{imported, model, scene};
use etalon_scene::{MaterialKind, Medium, PhaseFunction};
use serde_json::{Value, json};

/// What a material with such extensions becomes, its medium, and what is listed of its inside.
fn filled(surface: Value, extensions: Value) -> (MaterialKind, Option<Medium>, Vec<String>) {
    let mut model = model();
    model["materials"][0] = json!({ "name": "body", "pbrMetallicRoughness": surface, "extensions": extensions });
    let imported = imported(&model).unwrap();
    let said = imported.left_out.iter().filter(|l| l.place.contains("KHR_materials_volume"));
    let said = said.map(|l| format!("{}: {}", l.place, l.what)).collect();
    let material = scene(&imported).materials.into_iter().find(|material| material.name == "body").unwrap();
    (material.kind, material.medium.map(|medium| *medium), said)
}

fn near(found: f64, known: f64) {
    assert!((found - known).abs() < 1e-6, "{found} is not {known}");
}

/// Half of the light is left after 0.1 m.
fn half() -> Value {
    json!({ "thicknessFactor": 1, "attenuationDistance": 0.1, "attenuationColor": [0.5, 0.5, 0.5] })
}

/// A medium without end reflects this share of even light if one scattering leaves ρ: 1 − 2√(1 − ρ)∫H(μ)μ dμ, by Chandrasekhar's H.
fn reflected(rho: f64) -> f64 {
    const N: usize = 200;
    let mu = |i: usize| (i as f64 + 0.5) / N as f64;
    let mut h = vec![1.0; N];
    for _ in 0..400 {
        let next = |i: usize| {
            let sum: f64 = (0..N).map(|j| mu(j) * h[j] / (mu(i) + mu(j))).sum::<f64>() / N as f64;
            1.0 / ((1.0 - rho).sqrt() + 0.5 * rho * sum)
        };
        // Half-steps do not swing.
        h = (0..N).map(|i| 0.5 * (h[i] + next(i))).collect();
    }
    1.0 - 2.0 * (1.0 - rho).sqrt() * (0..N).map(|i| h[i] * mu(i)).sum::<f64>() / N as f64
}

#[test]
fn glass_that_scatters_has_the_extinction_of_its_volume_and_the_albedo_of_its_colour() {
    for colour in [0.1, 0.2, 0.5, 0.9] {
        let (kind, medium, listed) = filled(
            json!({ "metallicFactor": 0 }),
            json!({ "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_volume": half(),
                "KHR_materials_volume_scatter": { "multiscatterColor": [colour, colour, colour], "scatterAnisotropy": 0.3 } }),
        );
        assert!(matches!(kind, MaterialKind::RoughDielectric { .. }), "{kind:?}");
        let medium = medium.expect("a medium");
        let [absorbed, scattered] = [&medium.absorption, &medium.scattering].map(|spectrum| spectrum.eval(550.0));
        near(absorbed + scattered, 2.0_f64.ln() / 0.1);
        assert_eq!(medium.phase, PhaseFunction::HenyeyGreenstein { g: 0.3 });
        // The message says how near the colour is.
        let off = reflected(scattered / (absorbed + scattered)) - colour;
        assert!(off.abs() < 0.0022, "{colour} becomes {off} more");
        assert!(listed.len() == 1 && listed[0].contains("has that colour within 0.0021"), "{listed:?}");
    }
}

/// The colour of the draft's own example. Its formula gives these numbers.
#[test]
fn channels_scatter_by_the_formula_of_the_draft() {
    let mut model = model();
    model["materials"][0]["name"] = json!("body");
    model["materials"][0]["pbrMetallicRoughness"] = json!({ "metallicFactor": 0 });
    model["materials"][0]["extensions"] = json!({ "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume": half(), "KHR_materials_volume_scatter": { "multiscatterColor": [0.572, 0.227, 0.075] } });
    let scene: Value = serde_json::from_str(&imported(&model).unwrap().text).unwrap();
    let medium = &scene["materials"]["body"]["medium"];
    for (c, known) in [0.941_841, 0.658_829, 0.306_839].into_iter().enumerate() {
        near(medium["albedo"]["rgb"][c].as_f64().unwrap(), known);
    }
    assert!(medium["phase"].is_null(), "{medium}");
}

#[test]
fn a_body_that_passes_light_diffusely_is_filled() {
    let diffuse = json!({ "diffuseTransmissionFactor": 0.8 });
    let scatter = json!({ "multiscatterColor": [0.5, 0.5, 0.5] });
    let (kind, medium, listed) = filled(
        json!({ "metallicFactor": 0 }),
        json!({ "KHR_materials_diffuse_transmission": diffuse, "KHR_materials_volume": half(), "KHR_materials_volume_scatter": scatter }),
    );
    assert!(matches!(kind, MaterialKind::Blend { .. }), "{kind:?}");
    let medium = medium.expect("a medium");
    near(medium.absorption.eval(500.0) + medium.scattering.eval(500.0), 2.0_f64.ln() / 0.1);
    near(medium.scattering.eval(500.0) / (2.0_f64.ln() / 0.1), 0.911_709);
    assert_eq!(listed.len(), 1, "{listed:?}");
    // Without scattering it absorbs, if it is no sheet.
    for (thickness, fills) in [(1, true), (0, false)] {
        let mut volume = half();
        volume["thicknessFactor"] = json!(thickness);
        let (_, medium, listed) = filled(
            json!({ "metallicFactor": 0 }),
            json!({ "KHR_materials_diffuse_transmission": diffuse, "KHR_materials_volume": volume }),
        );
        assert_eq!((medium.is_some(), listed), (fills, vec![]));
        if let Some(medium) = medium {
            near(medium.absorption.eval(500.0), 2.0_f64.ln() / 0.1);
        }
    }
}

#[test]
fn scattering_that_cannot_be_is_listed_by_its_name() {
    let scatter = json!({ "multiscatterColor": [0.5, 0.5, 0.5] });
    for (surface, extensions, words) in [
        (json!({}), json!({ "KHR_materials_volume": half() }), "the material does not transmit light"),
        (
            json!({ "metallicFactor": 1 }),
            json!({ "KHR_materials_volume": half(), "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 1 } }),
            "the material does not transmit light",
        ),
        (
            json!({ "metallicFactor": 0 }),
            json!({ "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_volume": { "thicknessFactor": 1 } }),
            "without a distance in KHR_materials_volume",
        ),
    ] {
        let mut extensions = extensions;
        extensions["KHR_materials_volume_scatter"] = scatter.clone();
        let (_, medium, listed) = filled(surface, extensions);
        let of_it: Vec<&String> = listed.iter().filter(|l| l.contains("KHR_materials_volume_scatter:")).collect();
        assert!(medium.is_none() && of_it.len() == 1 && of_it[0].contains(words), "{listed:?}");
    }
    // Black scatters nothing: the glass only absorbs.
    let (_, medium, listed) = filled(
        json!({ "metallicFactor": 0 }),
        json!({ "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_volume": half(), "KHR_materials_volume_scatter": {} }),
    );
    let medium = medium.expect("a medium");
    near(medium.absorption.eval(500.0), 2.0_f64.ln() / 0.1);
    assert_eq!((medium.scattering.eval(500.0), listed), (0.0, vec![]));
}
