//! Hard cases that need a light, a film or a whole render: those that no other test of this crate holds us to.

use etalon_geometry::{Parallelogram, PrimitiveId};
use etalon_optics::Vec3;
use etalon_oracle::laws;
use etalon_oracle::quadrature;
use etalon_transport::light::{AreaLight, Emitter, Light};
use etalon_transport::mis::{Density, power_heuristic};
use etalon_transport::spectral::PathSpectrum;
use etalon_transport::{Control, Film, prepare};
use serde_json::{Value, json};

/// Hard case 28: the solid angle of a square light of side over distance 1e4 to 1e-5 is ∫∫ du/pdf(u), whatever the way of
/// sampling, to 1e-6; and 4·asin(a²/(1 + a²)) with a half the side.
#[test]
fn a_square_light_fills_its_solid_angle_from_ten_thousand_sides_across_to_a_hundred_thousandth() {
    for side in [1e4, 1e2, 1.0, 1e-2, 1e-4, 1e-5] {
        let (a, from) = (0.5 * side, Vec3::ZERO);
        let corner = Vec3::new(-a, -a, 1.0);
        let shape = Parallelogram::new(corner, Vec3::new(side, 0.0, 0.0), Vec3::new(0.0, side, 0.0)).unwrap();
        let emitter = Emitter {
            radiance: PathSpectrum::Constant(1.0).into(),
            front: true,
            back: true,
            surface: PrimitiveId(0).into(),
            image: None,
        };
        let light = Light::Area(AreaLight::new(&shape.into(), emitter).unwrap());
        let per_sample = |u: f64, v: f64| match light.sample(from, [u, v], 0.0).map(|sample| sample.density) {
            Some(Density::SolidAngle(density)) => 1.0 / density,
            other => panic!("a light in plain view has a density: {other:?}"),
        };
        // A quarter of the light, folded towards its middle, where a wide one has its peak: u = ½ + t²/2.
        let folded = |s: f64, t: f64| 4.0 * s * t * per_sample(0.5 + 0.5 * s * s, 0.5 + 0.5 * t * t);
        let truth = if a > 1.0 {
            // 4·asin(a²/(1 + a²)) near 2π, turned round: asin x = π/2 − 2·asin √((1 − x)/2).
            let rest = (0.5 / (1.0 + a * a)).sqrt().asin();
            4.0 * (std::f64::consts::FRAC_PI_2 - 2.0 * rest)
        } else {
            4.0 * (a * a / (1.0 + a * a)).asin()
        };
        let found = quadrature::rectangle(folded, [0.0, 1.0], [0.0, 1.0], 1e-8 * truth, 2_000_000).value;
        assert!((found / truth - 1.0).abs() < 1e-6, "side {side:e}: {found:e} is not {truth:e}");
    }
}

/// Hard case 32, from 1e-25 to 1e25 and beyond.
#[test]
fn the_weights_of_two_ways_of_sampling_add_up() {
    laws::mis_weights_add_up(power_heuristic, f64::EPSILON, 1).assert();
}

/// A room with glass, a mirror, a lens and lights of several kinds; `zero` is how it writes 0.
fn room(zero: f64) -> Value {
    let at = |v: [f64; 3]| v.map(|x| if x == 0.0 { zero } else { x });
    let wall = |origin: [f64; 3], u: [f64; 3], v: [f64; 3], reflectance: f64| {
        json!({
            "material": {"type": "lambert", "reflectance": reflectance},
            "shape": {"type": "parallelogram", "origin_m": at(origin), "u_m": at(u), "v_m": at(v)}
        })
    };
    json!({
        "etalon": 1,
        "camera": {
            "type": "perspective", "position_m": at([0.0, 0.0, 2.0]), "direction": at([0.0, 0.0, -1.0]),
            "up": at([0.0, 1.0, 0.0]), "vertical_fov_deg": 60,
            "lens": {"radius_m": 0.0625, "focus_distance_m": 2.0}
        },
        "film": {"width": 24, "height": 16},
        "objects": [
            wall([-1.5, -1.0, -1.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], 0.7),
            wall([-1.5, -1.0, -1.0], [0.0, 0.0, 3.0], [3.0, 0.0, 0.0], 0.5),
            wall([1.5, -1.0, -1.0], [0.0, 0.0, 3.0], [0.0, 2.0, 0.0], 0.3),
            {
                "material": {"type": "dielectric", "interior": "N-BK7"},
                "shape": {"type": "sphere", "center_m": at([0.0, 0.0, 0.0]), "radius_m": 0.5}
            },
            {
                "material": {"type": "mirror", "reflectance": 0.9},
                "shape": {"type": "box", "min_m": at([-1.25, -1.0, -0.75]), "max_m": at([-0.75, 0.0, 0.0])}
            },
            {
                "material": {"type": "black"}, "emission": {"radiance": 3},
                "shape": {"type": "disk", "center_m": at([0.0, 0.9375, 0.0]), "normal": at([0.0, -1.0, 0.0]),
                          "radius_m": 0.25}
            }
        ],
        "lights": [
            {"type": "point", "position_m": at([0.0, 0.5, 1.0]), "intensity": 0.25},
            {"type": "directional", "direction": at([0.0, -1.0, 0.0]), "irradiance": 0.25},
            {"type": "environment", "radiance": 0.125}
        ],
        "integrator": {"spp": 4, "seed": 5}
    })
}

fn film(json: &Value) -> Film {
    let (scene, _) = etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{e:?}"));
    let prepared = prepare(&scene).unwrap();
    prepared.render(&prepared.whole(Some(1)), &|_| Control::Continue).unwrap()
}

/// Hard case 15 for whole pictures: zeros of either sign in positions and directions.
#[test]
fn the_sign_of_a_zero_changes_no_bit_of_the_film() {
    let (plus, minus) = (film(&room(0.0)), film(&room(-0.0)));
    let differing = plus.xyz().zip(minus.xyz()).filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0, "pixels that differ");
}

/// A ball of dispersive glass in a uniform sky cannot be seen: the hero that is left alone by dispersion counts for all
/// four wavelengths. 32² × 64 paths: the standard error is asserted below 0.4 %, and a hero that counts for itself alone
/// reads a third.
#[test]
fn dispersive_glass_cannot_be_seen_in_uniform_light() {
    let mut scene = json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 22},
        "film": {"width": 32, "height": 32},
        "objects": [{
            "material": {"type": "dielectric", "interior": "N-SF11"},
            "shape": {"type": "sphere", "center_m": [0, 0, 0], "radius_m": 1}
        }],
        "lights": [{"type": "environment", "radiance": 1}],
        "integrator": {"spp": 16, "wavelength_range_nm": [380, 780]}
    });
    let mut means = etalon_oracle::statistics::Welford::new();
    for seed in 0..8 {
        scene["integrator"]["seed"] = seed.into();
        let film = film(&scene);
        means.push(film.xyz().map(|xyz| xyz[1]).sum::<f64>() / 1024.0);
    }
    assert!(means.standard_error() < 4e-3, "{}", means.standard_error());
    // The range leaves out 3e-6 of ȳ.
    assert!((means.mean() - 1.0).abs() < 6.0 * means.standard_error() + 1e-5, "{}", means.mean());
}

/// A ball of some dielectrics under a sky of radiance 1, seen whole; and what prepares it warns of.
fn balls(balls: &[(f64, Value)]) -> (f64, Vec<String>) {
    let names: Vec<_> = (0..balls.len()).map(|i| format!("ball {i}")).collect();
    let materials: serde_json::Map<_, _> = names.iter().cloned().zip(balls.iter().map(|(_, m)| m.clone())).collect();
    let objects: Vec<_> = names
        .iter()
        .zip(balls)
        .map(|(name, (radius, _))| {
            json!({"name": name, "material": name,
                   "shape": {"type": "sphere", "center_m": [0, 0, 0], "radius_m": radius}})
        })
        .collect();
    let scene = json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20},
        "film": {"width": 16, "height": 16}, "materials": materials, "objects": objects,
        "lights": [{"type": "environment", "radiance": 1}], "integrator": {"spp": 64}
    });
    let scene = etalon_scene::parse(&scene.to_string(), "test").unwrap_or_else(|errors| panic!("{errors}")).0;
    let prepared = prepare(&scene).unwrap();
    let film: Film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
    assert_eq!(film.counters.nonfinite, 0);
    let mean = film.xyz().map(|xyz| xyz[1]).sum::<f64>() / f64::from(film.width() * film.height());
    (mean, prepared.warnings().to_vec())
}

/// A lossless ball in a furnace shows the furnace (case 4), whatever its index is of all that may be given.
#[test]
fn the_furnace_holds_to_the_ends_of_the_range_of_indices() {
    let [least, most] = etalon_optics::INDEX_RANGE;
    for (interior, exterior) in [(most, 1.0), (least, 1.0), (most, least), (least, most), (1.5, 1.0)] {
        let glass = json!({"type": "dielectric", "interior": interior, "exterior": exterior});
        // The sky lies in vacuum: seen from within another medium its radiance is what it is.
        let (mean, warnings) = balls(&[(1.0, glass)]);
        assert!((mean - 1.0).abs() < 1e-6, "{interior} in {exterior}: {mean}");
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}

/// Case 6 beyond what positions can tell apart: a shell that is thinner than that is named, one that is thicker is right.
#[test]
fn a_shell_too_thin_to_be_met_is_named() {
    let shell = |thickness: f64| {
        let (glass, hollow) = (
            json!({"type": "dielectric", "interior": 1.5}),
            json!({"type": "dielectric", "interior": 1.0, "exterior": 1.5}),
        );
        balls(&[(1.0, glass), (1.0 - thickness, hollow)])
    };
    for thickness in [1e-3, 1e-9, 1e-12] {
        let (mean, warnings) = shell(thickness);
        assert!((mean - 1.0).abs() < 1e-6, "{thickness:e}: {mean}");
        assert!(warnings.is_empty(), "{warnings:?}");
    }
    for thickness in [1e-15, 2e-16, 0.0] {
        let (_, warnings) = shell(thickness);
        assert_eq!(warnings.len(), 1, "{thickness:e}: {warnings:?}");
        assert!(warnings[0].contains("\"ball 0\" and \"ball 1\" coincide"), "{}", warnings[0]);
    }
}
