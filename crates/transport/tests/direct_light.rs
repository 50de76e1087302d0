//! What shadow rays bring to surfaces within media and between them, and by each model of wavelengths.

use etalon_optics::colour::colour_matching;
use etalon_oracle::laws::fresnel_exact;
use etalon_oracle::truths::truths;
use etalon_transport::{Carried, PathLoop, Study};
use serde_json::{Value, json};
use std::f64::consts::PI;

use crate::common::rendering::{mean_y, parse, render};

fn read(scene: &Value) -> f64 {
    mean_y(&render(&parse(&scene.to_string()), &Study::default()))
}

/// A lamp in a ball of rough glass is seen on its surface by shadow rays that go through the ball; one before the ball by shadow rays that
/// are outside of it. Both stand aside, so that no cosine is 1 but the viewer's. The paths are the same in clear glass.
#[test]
fn a_lamp_within_rough_glass_is_dimmed_by_the_way_to_it_and_one_before_it_is_not() {
    let shown = |lamp_z_m: f64, absorption_per_m: f64| {
        read(&json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 0.001},
            "film": {"width": 4, "height": 4},
            "objects": [{
                "shape": {"type": "sphere", "center_m": [0, 0, 0], "radius_m": 1},
                "material": {"type": "dielectric", "interior": 1.5, "alpha": 0.4, "absorption_per_m": absorption_per_m}
            }],
            "lights": [{"type": "point", "position_m": [0.5, 0, lamp_z_m], "intensity": 1}],
            "integrator": {"spp": 64, "max_depth": 2, "roulette": false}
        }))
    };
    for (lamp_z_m, length_m, footprint) in [(0.0, 1.25_f64.sqrt(), 3e-4), (4.0, 0.0, 0.0)] {
        let (clear, dim) = (shown(lamp_z_m, 1e-300), shown(lamp_z_m, 0.7));
        assert!(clear > 0.0, "a lamp at {lamp_z_m} m is not seen");
        // The ways from a footprint of a millimetre differ by .45 mm at most; and rounding of an exponential and of some sums.
        let share = dim / clear / (-0.7_f64 * length_m).exp();
        assert!((share - 1.0).abs() < footprint + 1e-9, "{lamp_z_m}: {dim} of {clear}");
    }
}

/// A shadow ray that goes on behind a boundary which changes no medium still ends at its lamp: what is beyond casts no shadow.
#[test]
fn what_is_beyond_a_lamp_casts_no_shadow_when_the_ray_has_crossed_a_boundary_on_its_way() {
    let within = |priority: u32, from_m: f64, to_m: f64, absorption_per_m: f64| {
        json!({
            "shape": {"type": "box", "min_m": [-from_m, -from_m, -from_m], "max_m": [from_m, from_m, to_m]},
            "material": {
                "type": "dielectric", "interior": 1, "priority": priority, "absorption_per_m": absorption_per_m
            }
        })
    };
    let shown = read(&json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 3.25], "direction": [0, 0, -1], "height_m": 0.001},
        "film": {"width": 2, "height": 2},
        "objects": [
            within(1, 9.0, 9.0, 0.5),
            // Filled by the other, whose priority is higher.
            within(0, 8.0, 4.0, 3.0),
            {"shape": {"type": "disk", "center_m": [0, 0, 3], "normal": [0, 0, 1], "radius_m": 1},
                "material": {"type": "lambert", "reflectance": 0.5}},
            {"shape": {"type": "disk", "center_m": [0, 0, 6], "normal": [0, 0, 1], "radius_m": 1}, "material": {"type": "black"}}
        ],
        "lights": [{"type": "point", "position_m": [0, 0, 5], "intensity": 1}],
        "integrator": {"spp": 4, "max_depth": 2, "roulette": false}
    }));
    let truth = 0.5 / PI / 4.0 * (-0.5_f64 * 2.25).exp();
    // A footprint of a millimetre: its edge is 1e-7 farther from the lamp.
    assert!((shown / truth - 1.0).abs() < 1e-6, "{shown} is not {truth}");
}

/// Where two solids share a face, that of the higher priority says whether it is smooth or rough. Seen from within the upper one, a small lamp
/// within the lower one shows T(n_u/n_l)² through a smooth face; a rough one bends light by up to half the tilt of
/// its facets, over a hundred times the lamp's solid angle.
#[test]
fn the_higher_priority_decides_what_a_shared_face_does() {
    let (upper_n, lower_n) = (1.0_f64, 2.0_f64);
    let transmitted = 1.0 - ((upper_n - lower_n) / (upper_n + lower_n)).powi(2);
    let truth = transmitted * (upper_n / lower_n).powi(2);
    let solid = |n: f64, rough: bool, priority: u32, z_m: [f64; 2]| {
        json!({
            "shape": {"type": "box", "min_m": [-1, -1, z_m[0]], "max_m": [1, 1, z_m[1]]},
            "material": {"type": "dielectric", "interior": n, "alpha": if rough { 0.6 } else { 0.0 }, "priority": priority}
        })
    };
    for upper_is_rough in [false, true] {
        for upper_decides in [false, true] {
            for order in [[0, 1, 2], [2, 1, 0]] {
                let objects = [
                    solid(upper_n, upper_is_rough, if upper_decides { 2 } else { 1 }, [0.0, 1.0]),
                    solid(lower_n, !upper_is_rough, if upper_decides { 1 } else { 2 }, [-1.0, 0.0]),
                    json!({
                        "shape": {"type": "disk", "center_m": [0, 0, -0.5], "normal": [0, 0, 1], "radius_m": 0.01},
                        "material": {"type": "black"}, "emission": {"radiance": 1, "sides": "front"}
                    }),
                ];
                let shown = read(&json!({
                    "etalon": 1,
                    "camera": {"type": "orthographic", "position_m": [0, 0, 0.5], "direction": [0, 0, -1], "height_m": 0.001},
                    "film": {"width": 4, "height": 4},
                    "objects": order.map(|i: usize| objects[i].clone()),
                    "integrator": {"spp": 256, "max_depth": 2, "roulette": false}
                }));
                let what = format!("upper rough: {upper_is_rough}, decides: {upper_decides}, {order:?}: {shown}");
                if upper_is_rough == upper_decides {
                    assert!((0.0..0.1 * truth).contains(&shown), "{what}");
                } else {
                    // One of nine paths is reflected: 4096 of them scatter by .6 %.
                    assert!((shown / truth - 1.0).abs() < 0.03, "{what} is not {truth}");
                }
            }
        }
    }
}

/// A lamp that directions and shadow rays both find counts once, whatever the lanes of a path stand for.
#[test]
fn every_model_of_wavelengths_finds_a_square_lamp_once() {
    let truth = truths().into_iter().find(|truth| truth.name == "square-light").expect("it is a truth");
    for carried in [Carried::OneWavelength, Carried::FourWavelengths, Carried::ThreeChannels] {
        let mut scene = parse(&truth.scene);
        scene.integrator.spp = 64;
        let shown = mean_y(&render(&scene, &Study { carried: Some(carried), ..Study::default() }));
        // 16,384 paths and more of one value in [0, 2] that scatter by .3.
        assert!((shown / truth.value() - 1.0).abs() < 0.02, "{carried:?}: {shown} is not {}", truth.value());
    }
}

/// A lit wall behind a slanting pane of a glass that disperses: each path that has been bent carries one wavelength, with the weight of all.
/// The wall shows ρ/π·I cos θ/d² through two faces, ∫ȳT² dλ/∫ȳ dλ of it.
#[test]
fn what_is_lit_behind_a_dispersing_pane_is_dimmed_by_its_faces_alone() {
    let (a, b_um2, cos) = (1.6, 0.05, 0.8);
    let scene = parse(
        &json!({
            "etalon": 1,
            "camera": {
                "type": "orthographic", "position_m": [0, -0.5, 100], "direction": [0, 0.6, -cos], "up": [1, 0, 0],
                "height_m": 0.001
            },
            "film": {"width": 4, "height": 4},
            "objects": [
                {"shape": {"type": "box", "min_m": [-5, -5, 99], "max_m": [5, 5, 99.01]},
                    "material": {"type": "dielectric", "interior": {"type": "cauchy", "a": a, "b_um2": b_um2, "range_nm": [300, 900]}}},
                {"shape": {"type": "parallelogram", "origin_m": [-500, -500, 0], "u_m": [1000, 0, 0], "v_m": [0, 1000, 0]},
                    "material": {"type": "lambert", "reflectance": 0.5}}
            ],
            // Aside, so that the pane casts no shadow on what is seen.
            "lights": [{"type": "point", "position_m": [0, -5000, 5000], "intensity": 1e8}],
            "integrator": {"spp": 1024, "max_depth": 4, "roulette": false}
        })
        .to_string(),
    );
    let (seen_m, lamp_m) = (-0.5 + 100.0 * 0.6 / cos, [-5000.0_f64, 5000.0]);
    let square = (lamp_m[0] - seen_m).powi(2) + lamp_m[1].powi(2);
    let lit = 0.5 / PI * 1e8 * lamp_m[1] / square.powf(1.5);
    let [mut passed, mut whole] = [0.0; 2];
    for nm in 360..=830 {
        let (nm, y) = (f64::from(nm), colour_matching(f64::from(nm))[1]);
        let face = fresnel_exact(cos, a + b_um2 * 1e6 / (nm * nm));
        passed += y * face.transmittance().powi(2);
        whole += y;
    }
    let truth = lit * passed / whole;
    for path_loop in [PathLoop::Scalar, PathLoop::Batch] {
        let shown = mean_y(&render(&scene, &Study { path_loop: Some(path_loop), ..Study::default() }));
        // 16,384 paths, of which one in five is reflected and the others carry eight times one wavelength's ȳ or nothing.
        assert!((shown / truth - 1.0).abs() < 0.03, "{path_loop:?}: {shown} is not {truth}");
    }
}

/// A lamp seen through rough glass that disperses, where lanes have densities of their own: what shadow rays and directions find is weighed so that it
/// counts once.
#[test]
fn a_lamp_behind_rough_dispersing_glass_counts_once() {
    let shown = |light_sampling: &str, seed: u64, path_loop: PathLoop| {
        let scene = json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 5], "direction": [0, 0, -1], "height_m": 1.2},
            "film": {"width": 16, "height": 16},
            "objects": [
                {"shape": {"type": "sphere", "center_m": [0, 0, 0], "radius_m": 1},
                    "material": {"type": "dielectric", "alpha": 0.1, "multiple_scattering": "lost",
                        "interior": {"type": "cauchy", "a": 1.5, "b_um2": 0.05, "range_nm": [300, 900]}}},
                {"shape": {"type": "sphere", "center_m": [1, 0, -3], "radius_m": 0.7},
                    "material": {"type": "black"}, "emission": {"radiance": 1}}
            ],
            "integrator": {"spp": 256, "max_depth": 3, "roulette": false, "light_sampling": light_sampling, "seed": seed}
        });
        let study = Study { path_loop: Some(path_loop), ..Study::default() };
        mean_y(&render(&parse(&scene.to_string()), &study))
    };
    let of = |sampling: &str| {
        let means: Vec<f64> = (0..16).map(|seed| shown(sampling, seed, PathLoop::Scalar)).collect();
        let mean = means.iter().sum::<f64>() / 16.0;
        let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 15.0 / 16.0;
        (mean, variance)
    };
    let [(bsdf, noise), (mis, rest)] = ["bsdf", "mis"].map(of);
    // Five standard errors; each is .15 % of what is shown.
    assert!((mis - bsdf).abs() < 5.0 * (noise + rest).sqrt(), "{mis} is not {bsdf}");
    assert_eq!(shown("mis", 0, PathLoop::Batch), shown("mis", 0, PathLoop::Scalar));
}

/// A surface that is partly a mirror is lit by shadow rays as much as the rest of it scatters: a point light, which nothing else finds.
#[test]
fn what_scatters_of_a_blend_is_lit_by_shadow_rays() {
    let shown = read(&json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 0.001},
        "film": {"width": 2, "height": 2},
        "materials": {"mirror": {"type": "mirror"}, "paint": {"type": "lambert", "reflectance": 0.5}},
        "objects": [{
            "shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 0, 1], "radius_m": 1},
            "material": {"type": "blend", "first": "mirror", "second": "paint", "weight": 0.25}
        }],
        "lights": [{"type": "point", "position_m": [0, 0, 5], "intensity": 1}],
        "integrator": {"spp": 4, "max_depth": 2, "roulette": false}
    }));
    let truth = 0.25 * 0.5 / PI / 25.0;
    // As above: the footprint's edge.
    assert!((shown / truth - 1.0).abs() < 1e-6, "{shown} is not {truth}");
}

/// A metal under water, seen along its normal from within the water, returns the |(N − n)/(N + n)|² of its index N beside the water's n, alone
/// and as half of a surface whose other half is black.
#[test]
fn metals_reflect_as_their_index_beside_that_of_what_they_stand_in_says() {
    let (n, k, water) = (0.4_f64, 2.5_f64, 1.6_f64);
    let shown = |metal: Value| {
        read(&json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 0.001},
            "film": {"width": 16, "height": 16},
            "materials": {
                "metal": {"type": "conductor", "wavelengths_nm": [300, 900], "n": [n, n], "k": [k, k]}, "black": {"type": "black"}
            },
            "objects": [
                {"shape": {"type": "box", "min_m": [-9, -9, -9], "max_m": [9, 9, 9]},
                    "material": {"type": "dielectric", "interior": water, "priority": 0}},
                {"shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 0, 1], "radius_m": 1}, "material": metal},
                {"shape": {"type": "disk", "center_m": [0, 0, 5], "normal": [0, 0, -1], "radius_m": 1},
                    "material": {"type": "black"}, "emission": {"radiance": 1}}
            ],
            "integrator": {"spp": 64, "max_depth": 2, "roulette": false}
        }))
    };
    let reflectance = ((n - water).powi(2) + k * k) / ((n + water).powi(2) + k * k);
    // In air it would be 0.81, not 0.75.
    let whole = shown(json!("metal"));
    assert!((whole / reflectance - 1.0).abs() < 1e-6, "{whole} is not {reflectance}");
    let half = shown(json!({"type": "blend", "first": "metal", "second": "black", "weight": 0.5}));
    // Which half a path takes is chosen 16384 times: the mean scatters by .8 % at most, and may be off by five times that.
    assert!((half / (0.5 * reflectance) - 1.0).abs() < 0.04, "{half} is not half of {reflectance}");
}
