//! Light paths bring the light that camera paths drop. Scenes with various lamps, cameras and surfaces are rendered with and without them, and
//! must come to the same light. And a picture with light paths has the same bytes however it is divided.

use super::find_specular_objects;
use crate::film::{Film, PixelRect};
use crate::render::{Control, Extent};
use crate::scene::prepare::Prepared;
use crate::{Study, prepare_study};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn scene(view: Value, lamp: Value, objects: Value, more: Value) -> Value {
    let mut scene = json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 1.4, 1.6], "look_at_m": [0, 0, 0], "vertical_fov_deg": 50},
        "film": {"width": 24, "height": 24},
        "materials": {
            "floor": {"type": "lambert", "reflectance": 0.5},
            "varnish": {"type": "plastic", "reflectance": 0.5},
            "rough glass": {"type": "dielectric", "interior": 1.5, "alpha": 0.4},
            "satin": {"type": "conductor", "reflectance": {"type": "rgb", "rgb": [0.9, 0.6, 0.3]}, "alpha": 0.4},
            "glass": {"type": "dielectric", "interior": 1.5},
            "flint": {"type": "dielectric", "interior": "N-BK7"},
            "pane": {"type": "thin-dielectric", "index": 1.5},
            "mirror": {"type": "mirror", "reflectance": 0.9},
            "brass": {"type": "conductor", "reflectance": {"type": "rgb", "rgb": [0.9, 0.7, 0.4]}},
            "green glass": {"type": "dielectric", "interior": 1.5, "transmitted_tint": {"type": "rgb", "rgb": [0.4, 0.9, 0.5]}},
            "coated": {"type": "dielectric", "interior": 1.5, "thin_film": [{"thickness_nm": 100, "index": 1.38}]},
            "black": {"type": "black"}
        },
        "objects": objects,
        "integrator": {"spp": 256, "replicates": 16, "light_tracing": "always"}
    });
    let objects = scene["objects"].as_array_mut().unwrap();
    objects.push(json!({"material": "floor", "shape": {"type": "parallelogram", "origin_m": [-2, 0, 2], "u_m": [4, 0, 0], "v_m": [0, 0, -4]}}));
    match lamp.get("shape").is_some() {
        true => objects.push(lamp),
        false => scene["lights"] = json!([lamp]),
    }
    for (key, value) in view.as_object().unwrap().iter().chain(more.as_object().unwrap()) {
        if value.get("type").is_some() || value.is_array() {
            scene[key] = value.clone();
        }
        for (inner, value) in value.as_object().into_iter().flatten() {
            scene[key][inner] = value.clone();
        }
    }
    scene
}

fn prepared(scene: &Value, study: &Study) -> Prepared {
    let scene = etalon_scene::parse(&scene.to_string(), "test").unwrap_or_else(|errors| panic!("{errors}")).0;
    prepare_study(&scene, study).unwrap()
}

fn sphere(center: [f64; 3], radius: f64, material: &str) -> Value {
    json!({"material": material, "shape": {"type": "sphere", "center_m": center, "radius_m": radius}})
}

fn wall(material: &str) -> Value {
    json!({"material": material, "shape": {"type": "parallelogram", "origin_m": [-0.9, 0, 0.7], "u_m": [0, 1.2, 0], "v_m": [0, 0, -1.4]}})
}

fn lamp(radius: f64) -> Value {
    let mut lamp = sphere([0.8, 1.1, -0.3], radius, "black");
    lamp["emission"] = json!({"radiance": 4.0 / (radius * radius)});
    lamp
}

/// A ball of few faces that is smooth by its normals, with 8 columns and 4 rows.
fn smooth_ball(center: [f64; 3], radius: f64, material: &str) -> Value {
    let at = |row: usize, column: usize| {
        let (polar, azimuth) = (PI * row as f64 / 4.0, PI * column as f64 / 4.0);
        [polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin()]
    };
    let normals: Vec<[f64; 3]> = (0..=4).flat_map(|row| (0..8).map(move |column| at(row, column))).collect();
    let vertices: Vec<_> = normals.iter().map(|n| [0, 1, 2].map(|axis| center[axis] + radius * n[axis])).collect();
    let quad = |(row, column): (usize, usize)| {
        let [a, b] = [row, row + 1].map(|row| 8 * row + column);
        let [c, d] = [row, row + 1].map(|row| 8 * row + (column + 1) % 8);
        // At the poles, two corners are one.
        [(row > 0).then_some([a, c, b]), (row < 3).then_some([b, c, d])].into_iter().flatten()
    };
    let triangles: Vec<_> = (0..4).flat_map(|row| (0..8).map(move |column| (row, column))).flat_map(quad).collect();
    json!({"material": material, "shape": {"type": "mesh", "vertices_m": vertices, "triangles": triangles, "normals": normals}})
}

/// Scenes by their names.
fn scenes() -> Vec<(&'static str, Value)> {
    let none = || json!({});
    let ball = |material| json!([sphere([0.0, 0.45, 0.0], 0.3, material)]);
    let depth = |depth: u32| json!({"integrator": {"max_depth": depth}});
    let point = || json!({"type": "point", "position_m": [0.8, 1.1, -0.3], "intensity": 2});
    let prism = || {
        json!([{"material": "flint", "shape": {"type": "mesh", "vertices_m":
        [[-0.3, 0.3, -0.4], [0.3, 0.3, -0.4], [0.0, 0.8, -0.4], [-0.3, 0.3, 0.4], [0.3, 0.3, 0.4], [0.0, 0.8, 0.4]],
        "triangles": [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]}}])
    };
    let both = json!([sphere([0.0, 0.45, 0.0], 0.3, "glass"), wall("mirror"), sphere([0.6, 0.2, 0.5], 0.2, "satin")]);
    let lens = json!({"camera": {"lens": {"radius_m": 0.08, "focus_distance_m": 1.5}}});
    let sun = || json!({"type": "directional", "direction": [-0.5, -1, 0.2], "irradiance": 3});
    let sky = || json!({"type": "environment", "sky": {"cie_type": 12, "sun_direction": [0.6, 0.7, -0.2], "zenith_luminance_cd_per_m2": 4000}});
    let spot = json!({"type": "spot", "position_m": [0.8, 1.1, -0.3], "direction": [-1.2, -0.6, 0.3], "half_angle_deg": 30, "intensity": 4});
    let ring = |material: &str| json!({"material": material, "shape": {"type": "cylinder", "start_m": [0, 0.001, 0], "end_m": [0, 0.3, 0], "radius_m": 0.4, "capped": false}});
    let disk = json!({"material": "mirror", "shape": {"type": "disk", "center_m": [-0.6, 0.6, 0], "normal": [1, -0.4, 0], "radius_m": 0.4}});
    let bent = json!({"material": "mirror", "shape": {"type": "mesh", "vertices_m": [[-0.9, 0, 0.7], [-0.9, 0, -0.7], [-0.9, 1.2, 0.7], [-0.9, 1.2, -0.7]],
        "triangles": [[0, 1, 2], [1, 3, 2]], "normals": [[1, 1, 0.5], [1, -0.3, 0], [1, 0, -2], [1, -1, 0.3]]}});
    let placed = json!({
        "groups": {
            "prism": {"objects": prism()},
            "ball and prism": {
                "objects": [sphere([0.0, 0.0, 0.0], 0.2, "glass")],
                "instances": [{"group": "prism", "transform": [{"scale": [0.7, -0.5, 1.2]}, {"translate_m": [0.5, 0.4, 0.2]}]}]
            }
        },
        "instances": [
            {"group": "ball and prism", "transform": [{"scale": 1.3}, {"translate_m": [-0.3, 0.5, 0]}]},
            {"group": "prism", "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": 50}}, {"translate_m": [-0.3, -0.2, 0.6]}]}
        ]
    });
    let above = json!({"camera": {"type": "orthographic", "position_m": [0, 1.4, 1.6], "look_at_m": [0, 0, 0], "height_m": 2.5}});
    vec![
        ("mirror wall", scene(none(), lamp(0.1), json!([wall("mirror")]), none())),
        ("mirror wall and a lamp without area", scene(none(), point(), json!([wall("mirror")]), none())),
        ("ball of glass", scene(none(), lamp(0.2), ball("glass"), none())),
        ("ball of mirror under a lens", scene(lens, lamp(0.2), ball("mirror"), none())),
        ("pane", scene(none(), lamp(0.2), json!([wall("pane")]), none())),
        ("prism", scene(none(), lamp(0.3), prism(), none())),
        ("placed glass", scene(none(), lamp(0.3), json!([]), placed)),
        (
            "ball of glass, smooth by its normals",
            scene(none(), lamp(0.3), json!([smooth_ball([0.0, 0.45, 0.0], 0.3, "glass")]), none()),
        ),
        (
            "ball of mirror, smooth by its normals",
            scene(none(), point(), json!([smooth_ball([0.0, 0.45, 0.0], 0.3, "mirror")]), none()),
        ),
        ("mirror with normals that lean far", scene(none(), lamp(0.3), json!([bent]), none())),
        ("glass, mirror and rough metal", scene(none(), lamp(0.3), both.clone(), none())),
        ("the same, of few bounces", scene(none(), lamp(0.3), both.clone(), depth(4))),
        ("the same, of three edges", scene(none(), lamp(0.3), both.clone(), depth(3))),
        ("from above", scene(above, lamp(0.2), ball("glass"), none())),
        (
            "wide filter",
            scene(json!({"film": {"filter": {"type": "gaussian", "sigma_px": 0.6}}}), lamp(0.2), ball("glass"), none()),
        ),
        (
            "wide filter without a border",
            scene(
                json!({"film": {"filter": {"type": "gaussian", "sigma_px": 1.5}, "sample_border": false}}),
                lamp(0.2),
                ball("glass"),
                none(),
            ),
        ),
        (
            "filter that is negative somewhere",
            scene(json!({"film": {"filter": {"type": "mitchell"}}}), lamp(0.2), ball("glass"), none()),
        ),
        (
            "filter that is negative somewhere, without a border",
            scene(
                json!({"film": {"filter": {"type": "lanczos", "lobes": 2}, "sample_border": false}}),
                lamp(0.2),
                ball("glass"),
                none(),
            ),
        ),
        (
            "beside rough glass and varnish",
            scene(
                none(),
                lamp(0.3),
                json!([
                    wall("mirror"),
                    sphere([0.1, 0.3, 0.3], 0.25, "rough glass"),
                    sphere([0.6, 0.2, 0.5], 0.2, "varnish")
                ]),
                none(),
            ),
        ),
        ("brass ring in the sun", scene(none(), sun(), json!([ring("brass")]), none())),
        ("spot and a disk", scene(none(), spot, json!([disk]), none())),
        ("tinted glass under a clear sky", scene(none(), sky(), ball("green glass"), none())),
        ("plate with a film under a sky", scene(none(), sky(), json!([wall("coated")]), none())),
        ("camera in the glass", scene(none(), lamp(0.3), json!([sphere([0.0, 0.5, 0.0], 2.4, "glass")]), none())),
    ]
}

/// The mean of Y over each quarter of the picture, and its standard error, by the replicates of each pixel.
fn quarters(film: &Film) -> [(f64, f64); 4] {
    let [half_width, half_height] = [film.width() / 2, film.height() / 2];
    [[0, 0], [half_width, 0], [0, half_height], [half_width, half_height]].map(|[x0, y0]| {
        let rect = PixelRect { x0, y0, x1: x0 + half_width, y1: y0 + half_height };
        let of_replicate = |replicate: usize| {
            let means = rect
                .pixels()
                .map(|(x, y)| film.pixel(x, y).sums()[replicate])
                .map(|sum| sum.xyz[1] / f64::from(sum.count));
            means.sum::<f64>() / rect.area() as f64
        };
        let means: Vec<f64> = (0..film.replicates() as usize).map(of_replicate).collect();
        let count = means.len() as f64;
        let mean = means.iter().sum::<f64>() / count;
        let scatter: f64 = means.iter().map(|own| (own - mean) * (own - mean)).sum();
        (mean, (scatter / (count * (count - 1.0))).sqrt())
    })
}

/// 24 scenes of four quarters: with 5.5 standard errors of 30 degrees of freedom, one of them is beyond by chance in 1e-4 of all runs. The
/// errors are 0.1 % to 4 % of the means, so that a missing n² or a weight counted twice would be seen.
#[test]
fn light_paths_bring_what_camera_paths_drop() {
    for (name, scene) in scenes() {
        let with = prepared(&scene, &Study::default());
        assert!(with.light_paths_per_pixel() > 0.0, "{name}");
        let mut without = scene.clone();
        without["integrator"]["light_tracing"] = json!("never");
        without["integrator"]["spp"] = json!(1024);
        without["integrator"]["seed"] = json!(1);
        let without = prepared(&without, &Study::default());
        assert_eq!(without.light_paths_per_pixel(), 0.0);
        let [a, b] =
            [&with, &without].map(|prepared| prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap());
        for (quarter, ((mean, error), (expected, expected_error))) in
            quarters(&a).into_iter().zip(quarters(&b)).enumerate()
        {
            let error = error.hypot(expected_error);
            assert!(
                (mean - expected).abs() <= 5.5 * error,
                "{name}, quarter {quarter}: {mean} is not {expected} ± {error}"
            );
        }
        // They bring a part of the light that counts.
        let brought: f64 = with.light_paths_noise(with.whole_rect()).unwrap().y;
        let all = quarters(&a).iter().map(|(mean, _)| mean / 4.0).sum::<f64>();
        assert!(brought > 0.01 * all, "{name}: {brought} of {all}");
    }
}

/// A lamp at a point, d from a plane mirror, lights a floor at right angles to the mirror as one at its image does: I cos θ / r². The camera sees
/// ρ/π of that, and the lamp's own light is kept away by a black sheet.
#[test]
fn the_image_of_a_lamp_in_a_mirror_lights_a_floor_as_a_lamp_does() {
    let mut scene = scene(
        json!({"camera": {"position_m": [0.5, 0.5, 0], "look_at_m": [0.5, 0, 0], "up": [0, 0, 1], "vertical_fov_deg": 40}, "film": {"width": 8, "height": 8}}),
        json!({"type": "point", "position_m": [0.2, 0.8, 0], "intensity": 3}),
        json!([
            {"material": "mirror", "shape": {"type": "parallelogram", "origin_m": [-0.6, 0, 0.2], "u_m": [0, 0.8, 0], "v_m": [0, 0, -0.4]}},
            {"material": "black", "shape": {"type": "parallelogram", "origin_m": [0.15, 0.6, -0.1], "u_m": [0.25, 0, 0], "v_m": [0, 0, 0.2]}}
        ]),
        json!({}),
    );
    scene["integrator"]["spp"] = json!(4096);
    let prepared = prepared(&scene, &Study::default());
    let film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
    // The image is at x = −1.4 and y = 0.8. The camera looks straight down: the mean is over a square of the floor about x = 0.5.
    let half = 0.5 * 20.0_f64.to_radians().tan();
    let at = |step: i32| half * ((f64::from(step) + 0.5) / 50.0 - 1.0);
    let irradiance = |x: f64, z: f64| 3.0 * 0.8 / ((x + 1.9).powi(2) + 0.64 + z * z).powf(1.5);
    let mean_irradiance: f64 = (0..10_000).map(|i| irradiance(at(i % 100), at(i / 100))).sum::<f64>() / 1e4;
    let expected = 0.9 * 0.5 / PI * mean_irradiance;
    let quarters = quarters(&film);
    let mean = quarters.iter().map(|(mean, _)| mean / 4.0).sum::<f64>();
    let error = quarters.iter().map(|(_, error)| error * error).sum::<f64>().sqrt() / 4.0;
    // The sum over the square errs by less than 1e-4.
    assert!((mean - expected).abs() <= 5.0 * error + 1e-4 * expected, "{mean} is not {expected} ± {error}");
    assert!(error < 0.01 * expected, "{error} of {expected}");
}

/// Tiles, threads, stages, kernels and effects that are forced: all leave the same bytes.
#[test]
fn a_picture_with_light_paths_has_the_same_bytes_however_it_is_rendered() {
    let (_, mut scene) = scenes().into_iter().find(|(name, _)| *name == "glass, mirror and rough metal").unwrap();
    scene["integrator"]["spp"] = json!(16);
    let render = |study: &Study, threads: usize, stages: &[u32]| {
        let prepared = prepared(&scene, study);
        let mut film = prepared.film();
        for samples in stages.windows(2) {
            let extent =
                Extent { samples: samples[0]..samples[1], threads: Some(threads), rect: prepared.whole_rect() };
            prepared.render_onto(&mut film, &extent, &|_| Control::Continue).unwrap();
        }
        film.xyz().collect::<Vec<_>>()
    };
    let whole = render(&Study::default(), 1, &[0, 16]);
    assert_eq!(whole, render(&Study::default(), 3, &[0, 5, 6, 16]));
    let scalar = Study { path_loop: Some(crate::PathLoop::Scalar), ..Study::default() };
    assert_eq!(whole, render(&scalar, 2, &[0, 16]));
    for effect in [crate::EffectName::Lens, crate::EffectName::Motion, crate::EffectName::Absorption] {
        let forced = Study { force: vec![effect], ..Study::default() };
        assert_eq!(whole, render(&forced, 2, &[0, 16]), "{effect}");
    }
    // One sample again.
    let alone = prepared(&scene, &Study::default());
    let (x, y) = (15, 6);
    let sums = (0..16).fold([0.0; 3], |sum, sample| {
        let replay = alone.replay(x, y, sample);
        [0, 1, 2].map(|c| sum[c] + replay.xyz[c] + replay.light_paths_xyz.unwrap()[c])
    });
    let of_film = whole[(y * 24 + x) as usize];
    assert!((0..3).all(|c| (sums[c] / 16.0 - of_film[c]).abs() < 1e-12), "{sums:?} {of_film:?}");
    // A tile knows only its own pixels.
    let prepared = prepared(&scene, &Study::default());
    let mut film = prepared.film();
    let rect = PixelRect { x0: 5, y0: 7, x1: 13, y1: 20 };
    let extent = Extent { samples: 0..16, threads: Some(2), rect };
    prepared.render_onto(&mut film, &extent, &|_| Control::Continue).unwrap();
    for (x, y) in rect.pixels() {
        assert_eq!(film.pixel(x, y).xyz(), whole[(y * film.width() + x) as usize]);
    }
}

/// Where light paths are not possible, the reason is told if they were asked for.
#[test]
fn why_no_light_paths_are_traced_is_told() {
    let (_, right) = scenes().swap_remove(0);
    let told = |change: &dyn Fn(&mut Value)| {
        let mut scene = right.clone();
        change(&mut scene);
        prepared(&scene, &Study::default()).warnings.join("\n")
    };
    assert_eq!(told(&|_| ()), "");
    for (change, reason) in [
        (
            &(|scene: &mut Value| scene["integrator"]["path_reuse"] = json!("2x2")) as &dyn Fn(&mut Value),
            "pixels share paths",
        ),
        (&|scene| scene["objects"][0]["opacity"] = json!(0.5), "lets a part of the light pass"),
        (&|scene| scene["objects"][0]["material"] = json!("floor"), "no smooth mirror"),
        (&|scene| scene["film"]["bands_nm"] = json!([400, 700, 10]), "keeps bands"),
        (&|scene| scene["medium"] = json!({"absorption_per_m": 0.1}), "absorbs or scatters"),
    ] {
        let told = told(change);
        assert!(told.contains("no light paths are traced") && told.contains(reason), "{reason}: {told}");
    }
}

/// Groups within groups place a ball 4¹² times. What has no specular object is not searched, and too many of them are not listed.
#[test]
fn balls_without_number_are_neither_searched_nor_listed() {
    let told = |material: &str| {
        let mut scene = scene(json!({}), lamp(0.1), json!([wall("mirror")]), json!({}));
        let mut groups = json!({"0": {"objects": [sphere([0.0, 0.0, 0.0], 1e-6, material)]}});
        for level in 1..=12 {
            let placed = |x: f64| json!({"group": (level - 1).to_string(), "transform": [{"translate_m": [x, 0, 0]}]});
            groups[level.to_string()] = json!({"instances": [placed(0.1), placed(0.2), placed(0.3), placed(0.4)]});
        }
        scene["groups"] = groups;
        scene["instances"] = json!([{"group": "12"}]);
        let prepared = prepared(&scene, &Study::default());
        (prepared.light_paths_per_pixel() > 0.0, prepared.warnings.join("\n"))
    };
    assert_eq!(told("floor"), (true, String::new()));
    let (traced, warning) = told("glass");
    assert!(!traced && warning.contains("more than four million primitives"), "{warning}");
}

/// Each point of the specular objects is as likely as any other.
#[test]
fn paths_begin_evenly_over_the_area_of_the_specular_objects() {
    let scene = scene(json!({}), lamp(0.1), json!([sphere([0.0, 0.45, 0.0], 0.3, "glass"), wall("mirror")]), json!({}));
    let prepared = prepared(&scene, &Study::default());
    let specular_objects = find_specular_objects(&prepared).unwrap();
    let count = 10_000;
    let (mut on_ball, mut upper) = (0, 0);
    for i in 0..count {
        let u = (f64::from(i) + 0.5) / f64::from(count);
        let on_shape = [(u * 1009.0).fract(), (u * 8999.0).fract()];
        let (surface, point) = specular_objects.point(&prepared.geometry, u, on_shape).unwrap();
        if let etalon_geometry::Primitive::Sphere(_) = prepared.geometry.primitive_of(surface) {
            on_ball += 1;
            upper += i32::from(prepared.frame.to_world_m(point).y > 0.45);
        }
    }
    // 4πr² of the ball against the wall's 1.2 · 1.4.
    let share = 4.0 * PI * 0.09 / (4.0 * PI * 0.09 + 1.68);
    assert!((f64::from(on_ball) / f64::from(count) - share).abs() < 1e-3, "{on_ball}");
    assert!((f64::from(upper) / f64::from(on_ball) - 0.5).abs() < 0.02, "{upper} of {on_ball}");
}
