//! Whole renders against each other: what must not change a byte, and what must not change the mean.

use etalon_oracle::statistics::Welford;
use etalon_scene::{LightSampling, SamplerKind, Scene};
use etalon_transport::film::PixelRect;
use etalon_transport::replay::Event;
use etalon_transport::{Control, Extent, Film, PathLoop, Prepared, Study, prepare, prepare_study};
use serde_json::{Value, json};

fn parse(json: &Value) -> Scene {
    let (scene, warnings) = etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{e:?}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

/// A room with every material, kind of light and a lens: whatever depends on an order shows in it.
fn room() -> Scene {
    let wall = |origin: [f64; 3], u: [f64; 3], v: [f64; 3], material: &str| {
        json!({
            "material": material,
            "shape": {"type": "parallelogram", "origin_m": origin, "u_m": u, "v_m": v}
        })
    };
    parse(&json!({
        "etalon": 1,
        "camera": {
            "type": "perspective", "position_m": [0.0, 1.0, 3.5], "look_at_m": [0.0, 0.9, 0.0],
            "vertical_fov_deg": 40, "lens": {"radius_m": 0.02, "focus_distance_m": 3.5}
        },
        "film": {"width": 40, "height": 30, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "materials": {
            "white": {"type": "lambert", "reflectance": 0.7},
            "red": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.6, 0.1, 0.1]}},
            "mirror": {"type": "mirror", "reflectance": 0.9},
            "gold": {"type": "conductor", "metal": "Au"},
            "glass": {"type": "dielectric", "interior": "N-BK7"},
            "black": {"type": "black"}
        },
        "objects": [
            wall([-1.0, 0.0, -1.0], [0.0, 0.0, 5.0], [2.0, 0.0, 0.0], "white"),
            wall([-1.0, 2.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 5.0], "white"),
            wall([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], "white"),
            wall([-1.0, 0.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 5.0], "red"),
            wall([1.0, 0.0, -1.0], [0.0, 0.0, 5.0], [0.0, 2.0, 0.0], "mirror"),
            {
                "material": "black", "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": 8}},
                "shape": {"type": "disk", "center_m": [0.0, 1.99, 0.0], "normal": [0, -1, 0], "radius_m": 0.3}
            },
            {
                "material": "black", "emission": {"radiance": {"type": "blackbody", "temperature_k": 3000, "scale": 0.01}},
                "shape": {"type": "sphere", "center_m": [-0.6, 1.2, 0.4], "radius_m": 0.1}
            },
            {"material": "glass", "shape": {"type": "sphere", "center_m": [0.4, 0.4, 0.4], "radius_m": 0.4}},
            {"material": "gold", "shape": {"type": "box", "min_m": [-0.7, 0.0, -0.5], "max_m": [-0.2, 0.6, 0.0]}}
        ],
        "lights": [
            {"type": "point", "position_m": [0.5, 1.5, 1.5], "intensity": 0.2},
            {"type": "directional", "direction": [0.1, -0.4, -1.0], "irradiance": 0.3},
            {"type": "environment", "radiance": 0.2}
        ],
        "integrator": {"spp": 8, "seed": 11}
    }))
}

/// A diffuse room with two lamps and no caustic, in which every way of finding light has a small variance.
fn diffuse_room() -> Scene {
    let mut scene = room();
    let white = scene.materials.iter().position(|m| m.name == "white").unwrap();
    let black = scene.materials.iter().position(|m| m.name == "black").unwrap();
    for object in &mut scene.objects {
        if object.material != black {
            object.material = white;
        }
    }
    scene.lights.truncate(0);
    scene
}

fn render(prepared: &Prepared, extent: &Extent) -> Film {
    prepared.render(extent, &|_| Control::Continue).unwrap()
}

#[test]
fn threads_stages_and_replays_give_the_same_bytes() {
    for sampler in [SamplerKind::Sobol, SamplerKind::Independent] {
        let mut scene = room();
        scene.integrator.sampler = sampler;
        let prepared = prepare(&scene).unwrap();
        let whole = prepared.whole(Some(1));
        let film = render(&prepared, &whole);
        assert_eq!(film.counters.nonfinite, 0);
        assert_eq!(film.counters.cut_paths, 0);
        assert_eq!(film.counters.paths, 40 * 30 * 8);
        for threads in [2, 3, 7] {
            assert_eq!(render(&prepared, &Extent { threads: Some(threads), ..whole.clone() }), film);
        }
        // A copy, by the threads of a pool of the caller's.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let copy = prepared.clone();
        assert_eq!(pool.install(|| render(&copy, &whole)), film);
        // Two stages of samples.
        let mut staged = render(&prepared, &Extent { samples: 0..3, ..whole.clone() });
        prepared.render_onto(&mut staged, &Extent { samples: 3..8, ..whole.clone() }, &|_| Control::Continue).unwrap();
        assert_eq!(staged, film);
        // A crop that cuts through tiles.
        let rect = PixelRect { x0: 5, y0: 9, x1: 23, y1: 28 };
        let crop = render(&prepared, &Extent { rect, ..whole.clone() });
        for (x, y) in rect.pixels() {
            assert_eq!(crop.pixel(x, y), film.pixel(x, y));
        }
        // Each path alone.
        for (x, y) in [(0, 0), (20, 15), (39, 29), (25, 20)] {
            let mut sums = [[0.0; 3]; 4];
            for sample in 0..8 {
                let replay = prepared.replay(x, y, sample);
                let of_light_paths = replay.light_paths_xyz.unwrap_or_default();
                (0..3).for_each(|c| sums[sample as usize % 4][c] += replay.xyz[c] + of_light_paths[c]);
                assert!(!replay.events.is_empty());
                // What the path found adds up to what it brings, but for rounding.
                let light = |event: &Event| if let Event::Light { luminance, .. } = event { *luminance } else { 0.0 };
                let found: f64 = replay.events.iter().map(light).sum();
                assert!((found - replay.xyz[1]).abs() <= 1e-12 * replay.xyz[1], "{found} is not {}", replay.xyz[1]);
            }
            assert!(film.pixel(x, y).sums().iter().zip(sums).all(|(sum, expected)| sum.xyz == expected));
        }
    }
}

#[test]
fn a_stopped_render_keeps_the_pieces_that_it_finished() {
    let prepared = prepare(&room()).unwrap();
    let film = prepared.render(&prepared.whole(Some(1)), &|_| Control::Stop).unwrap();
    let done = film.pixels().filter(|p| p.count() > 0).count();
    assert_eq!(done, 16 * 16);
    assert!(film.pixels().all(|p| p.count() == 0 || p.count() == 8));
}

/// Mean Y of the film over independent seeds.
fn mean_y(scene: &Scene, seeds: std::ops::Range<u64>) -> Welford {
    let mut estimate = Welford::default();
    // Each seed is a replicate.
    let mut scene = scene.clone();
    scene.integrator.replicates = 1;
    let mut prepared = prepare(&scene).unwrap();
    for seed in seeds {
        prepared.reseed(seed);
        let whole = prepared.whole(None);
        estimate.push(render(&prepared, &whole).mean_y(whole.rect));
    }
    estimate
}

/// Ways of finding light, samplers, filters and roulette must agree in the mean. |z| < 5 for each of five variants
/// over 32 seeds each; the standard errors, asserted below 0.4 %, would show a bias of 3 % for sure and 2 % as a rule.
#[test]
fn every_strategy_has_the_same_mean() {
    let base = diffuse_room();
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = base.clone();
        change(&mut scene);
        scene
    };
    let reference = mean_y(&base, 0..32);
    let variants = [
        ("light", with(&|s| s.integrator.light_sampling = LightSampling::Light)),
        ("bsdf", with(&|s| s.integrator.light_sampling = LightSampling::Bsdf)),
        ("independent", with(&|s| s.integrator.sampler = SamplerKind::Independent)),
        ("no roulette", with(&|s| (s.integrator.roulette, s.integrator.max_depth) = (false, Some(64)))),
        ("box filter", with(&|s| s.film.filter = etalon_scene::Filter::Tent { radius_px: 0.75 })),
    ];
    for (name, scene) in variants {
        let variant = mean_y(&scene, 100..132);
        let error = variant.standard_error().hypot(reference.standard_error());
        let (a, b) = (variant.estimate().mean, reference.estimate().mean);
        assert!(error < 0.004 * b || name == "bsdf" && error < 0.02 * b, "{name}: the test sees too little, {error}");
        assert!(((a - b) / error).abs() < 5.0, "{name}: {a} against {b} ± {error}");
    }
}

/// A closed room with Le = ρ = 1/2: each edge of the path adds half of what the one before did, Le(1 − ρⁿ)/(1 − ρ) after n.
/// The room is a sphere that lights itself, so every point lies on the light up to rounding: neither sampling may lose or
/// double what the other finds (a predicate that took half of the points for outside read 0.70 at n = 2).
#[test]
fn a_room_that_is_a_lamp_shows_the_series_cut_after_n_terms() {
    for (n, light_sampling, sides) in [
        (1, "mis", "both"),
        (2, "mis", "back"),
        (2, "mis", "both"),
        (2, "light", "back"),
        (3, "bsdf", "back"),
        (5, "mis", "back"),
        (8, "mis", "both"),
    ] {
        let scene = parse(&json!({
            "etalon": 1,
            "camera": {
                "type": "perspective", "position_m": [0, 0, 0.5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 60
            },
            "film": {"width": 4, "height": 4},
            "materials": {"grey": {"type": "lambert", "reflectance": 0.5}},
            "objects": [{
                "material": "grey", "emission": {"radiance": 0.5, "sides": sides},
                "shape": {"type": "sphere", "center_m": [0.1, 0.2, 0.3], "radius_m": 1}
            }],
            "integrator": {"spp": 64, "max_depth": n, "roulette": false, "light_sampling": light_sampling}
        }));
        let estimate = mean_y(&scene, 0..16);
        let truth = 1.0 - 0.5_f64.powi(n);
        let (mean, error) = (estimate.mean(), estimate.standard_error());
        // A room that is grey has no noise of wavelengths, and two of these none at all: all that is left then is that Y is
        // normalised by a sum that differs by 2e-8 from the integral. The next term of the series would be 0.4 % at n = 8.
        let rounding = 3e-8 * truth;
        assert!(error < 3e-4 * truth, "{n} {light_sampling}: the test sees too little, {error}");
        assert!(
            (mean - truth).abs() < 5.0 * error + rounding,
            "{n} {light_sampling} {sides}: {mean} ± {error} is not {truth}"
        );
    }
}

#[test]
fn a_room_without_absorption_ends_and_says_so() {
    let scene = parse(&json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0, 0.5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 60},
        "film": {"width": 1, "height": 1},
        "materials": {"mirror": {"type": "mirror", "reflectance": 1}},
        "objects": [{"material": "mirror", "shape": {"type": "sphere", "center_m": [0, 0, 0], "radius_m": 1}}],
        "lights": [{"type": "environment", "radiance": 1}],
        "integrator": {"spp": 2}
    }));
    let prepared = prepare(&scene).unwrap();
    let film = render(&prepared, &prepared.whole(Some(1)));
    assert_eq!((film.counters.cut_paths, film.counters.cut_throughput), (2, 1.0));
    assert_eq!(film.mean_y(prepared.whole(None).rect), 0.0);
}

#[test]
fn a_path_that_is_cut_tells_what_its_light_would_have_been_multiplied_by() {
    // The camera's ray meets 65,536 walls, the last of which cuts it: it has been reflected by one less.
    let reflectance = 0.9999_f64;
    let truth = reflectance.powi(65_535);
    let scene = parse(&json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0, 0.5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 60},
        "film": {"width": 1, "height": 1},
        "materials": {"mirror": {"type": "mirror", "reflectance": reflectance}},
        "objects": [{"material": "mirror", "shape": {"type": "sphere", "center_m": [0, 0, 0], "radius_m": 1}}],
        "lights": [{"type": "environment", "radiance": 1}],
        "integrator": {"spp": 2, "roulette": false}
    }));
    for path_loop in [PathLoop::Scalar, PathLoop::Batch] {
        let prepared = prepare_study(&scene, &Study { path_loop: Some(path_loop), ..Study::default() }).unwrap();
        let counters = render(&prepared, &prepared.whole(Some(1))).counters;
        assert_eq!(counters.cut_paths, 2);
        // A rounding at each reflection, and those of the spectrum that the reflectance is given as.
        assert!((counters.cut_throughput / truth - 1.0).abs() < 1e-9, "{path_loop:?}: {}", counters.cut_throughput);
    }
}
