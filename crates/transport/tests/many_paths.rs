//! Many paths at once against one at a time: the same films and the same counts, bit for bit, on the ready-made scenes and on
//! scenes made up by chance.

use crate::common::chance::{Chance, made};
use etalon_scene::{NamedFile, SamplerKind, Scene, parse_with_files};
use etalon_transport::{Control, EffectName, Film, PathLoop, Prepared, Study, prepare_study};

/// The ready-made scenes, small.
fn ready_made() -> Vec<(String, Scene)> {
    crate::common::ready_made([22, 17], 4)
}

fn render(prepared: &Prepared) -> Film {
    prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap()
}

/// The film of many paths at once must be that of one at a time.
fn agrees(name: &str, scene: &Scene, study: &Study) {
    let prepared = |path_loop| {
        let study = Study { path_loop: Some(path_loop), ..study.clone() };
        let prepared = prepare_study(scene, &study).unwrap();
        assert_eq!(prepared.plan().path_loop.name, path_loop);
        prepared
    };
    let [batch, scalar] = [PathLoop::Batch, PathLoop::Scalar].map(|path_loop| render(&prepared(path_loop)));
    assert_eq!(batch.counters, scalar.counters, "{name}");
    // Sums of all replicates and bands, as bits: zeros of either sign are told apart.
    let bits = |film: &Film| -> Vec<u64> {
        film.pixels().flat_map(|pixel| pixel.sums().to_vec()).flat_map(|sum| sum.xyz.map(f64::to_bits)).collect()
    };
    assert!(batch == scalar && bits(&batch) == bits(&scalar), "{name}: the films differ");
}

#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_on_every_ready_made_scene() {
    let forced = |effect| Study { force: vec![effect], ..Study::default() };
    for (name, mut scene) in ready_made() {
        agrees(&name, &scene, &Study::default());
        let plan = prepare_study(&scene, &Study::default()).unwrap();
        for effect in [EffectName::Wavelengths, EffectName::Dispersion, EffectName::NestedDielectrics] {
            // Another model of lanes than the scene's own, or another walk along rays.
            if !plan.plan().runs(effect) {
                agrees(&format!("{name}, {effect}"), &scene, &forced(effect));
            }
        }
        agrees(&format!("{name}, polarised"), &scene, &Study { polarised: true, ..Study::default() });
        scene.integrator.sampler = SamplerKind::Independent;
        (scene.integrator.replicates, scene.integrator.spp) = (1, 5);
        agrees(&format!("{name}, independent numbers"), &scene, &Study::default());
    }
}

#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_on_scenes_made_up_by_chance() {
    let mut chance = Chance(7);
    for number in 0..40 {
        let json = chance.scene();
        let scene = made(&json);
        let study = Study { polarised: chance.below(4) == 0, ..Study::default() };
        agrees(&format!("scene {number}: {json:#}"), &scene, &study);
    }
}

/// Samples have weights, also those of pixels that share paths, and what they bring beside their colour.
#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_with_filters_that_are_negative_somewhere() {
    for (filter, sample_border) in [("mitchell", true), ("lanczos", false)] {
        for further in [r#""stokes": true"#, r#""bands_nm": [450, 650, 50]"#, r#""comment": """#] {
            for path_reuse in ["none", "2x2"] {
                let text = format!(
                    r#"{{
                    "etalon": 1,
                    "film": {{ "width": 22, "height": 17, "filter": {{ "type": "{filter}" }}, "sample_border": {sample_border}, {further} }},
                    "integrator": {{ "spp": 4, "path_reuse": "{path_reuse}" }},
                    "camera": {{ "type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 45 }},
                    "objects": [
                        {{ "shape": {{ "type": "sphere", "center_m": [0, 0, 0], "radius_m": 1 }}, "material": {{ "type": "lambert", "reflectance": 0.5 }} }},
                        {{ "shape": {{ "type": "sphere", "center_m": [1, 3, 1], "radius_m": 0.4 }}, "material": {{ "type": "black" }},
                           "emission": {{ "radiance": 20 }} }}
                    ] }}"#
                );
                let shares = path_reuse != "none";
                if shares && further.contains("stokes") {
                    continue;
                }
                let scene =
                    parse_with_files(&text, filter, &[], None).unwrap_or_else(|errors| panic!("{errors}")).scene;
                agrees(&format!("{filter}, {further}, {path_reuse}"), &scene, &Study::default());
            }
        }
    }
}

/// Camera rays go straight past lamps, in a medium and where pixels share paths.
#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_where_the_camera_sees_no_lights() {
    for (medium, path_reuse) in
        [(r#""medium": { "scattering_per_m": 0.05, "absorption_per_m": 0.02 },"#, "none"), ("", "none"), ("", "2x2")]
    {
        let text = format!(
            r#"{{
            "etalon": 1, "film": {{ "width": 22, "height": 17 }}, {medium}
            "integrator": {{ "spp": 4, "hide_lights": true, "path_reuse": "{path_reuse}" }},
            "camera": {{ "type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 45 }},
            "lights": [{{ "type": "environment", "radiance": 0.5 }}],
            "objects": [
                {{ "shape": {{ "type": "sphere", "center_m": [0, 0, 0], "radius_m": 1 }}, "material": {{ "type": "lambert", "reflectance": 0.5 }} }},
                {{ "shape": {{ "type": "sphere", "center_m": [-1, 0, 1], "radius_m": 0.4 }}, "material": {{ "type": "mirror" }} }},
                {{ "shape": {{ "type": "sphere", "center_m": [0.3, 0.8, 2], "radius_m": 0.4 }}, "material": {{ "type": "black" }},
                   "emission": {{ "radiance": 20 }} }}
            ] }}"#
        );
        let scene = parse_with_files(&text, "hidden", &[], None).unwrap_or_else(|errors| panic!("{errors}")).scene;
        agrees(&format!("{medium} {path_reuse}"), &scene, &Study::default());
    }
}

/// A shell of glass that holds milk, which states the glass, with a bubble that states the milk and a ball in it.
#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_where_glass_states_what_is_outside_of_it() {
    for scattering in [0.0, 1.5] {
        let text = format!(
            r#"{{
            "etalon": 1, "film": {{ "width": 22, "height": 17 }}, "integrator": {{ "spp": 4 }},
            "camera": {{ "type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 45 }},
            "lights": [{{ "type": "environment", "radiance": 0.5 }}],
            "materials": {{
                "milk": {{ "type": "dielectric", "interior": 1.34, "exterior": 1.5, "exterior_medium": {{ "absorption_per_m": 0.3 }},
                    "medium": {{ "absorption_per_m": 0.5, "scattering_per_m": {scattering} }} }},
                "bubble": {{ "type": "dielectric", "interior": 1, "exterior": 1.34,
                    "exterior_medium": {{ "absorption_per_m": 0.5, "scattering_per_m": {scattering} }} }}
            }},
            "objects": [
                {{ "shape": {{ "type": "sphere", "radius_m": 1 }}, "material": {{ "type": "dielectric", "interior": 1.5 }} }},
                {{ "shape": {{ "type": "sphere", "radius_m": 0.8 }}, "material": "milk" }},
                {{ "shape": {{ "type": "sphere", "center_m": [-0.3, 0, 0.3], "radius_m": 0.2 }}, "material": "bubble" }},
                {{ "shape": {{ "type": "sphere", "center_m": [0.3, 0, 0], "radius_m": 0.2 }}, "material": {{ "type": "lambert", "reflectance": 0.5 }} }},
                {{ "shape": {{ "type": "sphere", "center_m": [0.3, 2.8, 2], "radius_m": 0.4 }}, "material": {{ "type": "black" }},
                   "emission": {{ "radiance": 20 }} }}
            ] }}"#
        );
        let scene = parse_with_files(&text, "stated", &[], None).unwrap_or_else(|errors| panic!("{errors}")).scene;
        agrees(&format!("scattering {scattering}"), &scene, &Study::default());
    }
}

/// In blends, on one side, turned, below lamps, with and without polarisation.
#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_on_measured_surfaces() {
    let truths = etalon_oracle::truths::truths();
    let file = |name: &str| {
        let truth = truths.iter().find(|truth| truth.name == name).expect("a truth");
        NamedFile { name: format!("{name}.bsdf"), bytes: truth.files[0].bytes.clone() }
    };
    let files = [file("measured-brdf-of-a-colour-in-the-sun"), file("measured-grain-in-the-sun")];
    let [colour, grain] = [0, 1].map(|i| files[i].name.clone());
    let text = format!(
        r#"{{
        "etalon": 1, "film": {{ "width": 22, "height": 17 }}, "integrator": {{ "spp": 4 }},
        "camera": {{ "type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 45 }},
        "materials": {{
            "colour": {{ "type": "measured", "file": "{colour}" }},
            "grain": {{ "type": "measured", "file": "{grain}", "sides": "both", "tangent_rotation_deg": 20 }},
            "mixed": {{ "type": "blend", "first": "grain", "second": {{ "type": "conductor", "metal": "Au" }}, "weight": 0.4 }}
        }},
        "objects": [
            {{ "shape": {{ "type": "sphere", "center_m": [-1, 0, 0], "radius_m": 1 }}, "material": "colour" }},
            {{ "shape": {{ "type": "sphere", "center_m": [1, 0, 0], "radius_m": 0.9 }}, "material": "mixed" }},
            {{ "shape": {{ "type": "parallelogram", "origin_m": [-4, -1, 4], "u_m": [8, 0, 0], "v_m": [0, 0, -8] }}, "material": "grain" }},
            {{ "shape": {{ "type": "sphere", "center_m": [1, 3, 1], "radius_m": 0.4 }}, "material": {{ "type": "black" }},
               "emission": {{ "radiance": 20 }} }}
        ],
        "lights": [{{ "type": "environment", "radiance": 0.3 }}, {{ "type": "directional", "direction": [-1, -2, -1], "irradiance": 2 }}] }}"#
    );
    let scene = parse_with_files(&text, "measured", &files, None).unwrap_or_else(|errors| panic!("{errors}")).scene;
    agrees("measured surfaces", &scene, &Study::default());
    agrees("measured surfaces, polarised", &scene, &Study { polarised: true, ..Study::default() });
}
