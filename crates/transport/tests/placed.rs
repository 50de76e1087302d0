//! Where a scene stands, how large it is and how often a part of it is placed must not matter.

use etalon_optics::{RefractiveIndex, Spectrum};
use etalon_scene::{
    CompoundLens, LensCoating, LensSurface, LightKind, NamedFile, Projection, Scene, Transform, parse_with_files,
};
use etalon_transport::{Control, EffectName, Film, Study, prepare, prepare_study};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::sync::Arc;

fn parse(json: &Value) -> Scene {
    let (scene, warnings) = etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{e}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

fn render(scene: &Scene) -> Film {
    render_without(scene, &[])
}

fn render_without(scene: &Scene, without: &[EffectName]) -> Film {
    // Lamps in balls are aimed at where the balls are the scene's own, so that other numbers lead to the same picture.
    let study = Study { by_cosine_alone: true, without: without.to_vec(), ..Study::default() };
    let prepared = prepare_study(scene, &study).unwrap();
    let film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
    assert_eq!((film.counters.nonfinite, film.counters.cut_paths), (0, 0));
    film
}

/// A room lit by a lamp, with more objects, groups and instances in it.
fn room(objects: &Value, groups: &Value, instances: &Value) -> Scene {
    let wall = |origin: [f64; 3], u: [f64; 3], v: [f64; 3], reflectance: f64| {
        json!({
            "material": {"type": "lambert", "reflectance": reflectance},
            "shape": {"type": "parallelogram", "origin_m": origin, "u_m": u, "v_m": v}
        })
    };
    let mut all = vec![
        wall([-1.0, 0.0, -1.0], [0.0, 0.0, 5.0], [2.0, 0.0, 0.0], 0.7),
        wall([-1.0, 2.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 5.0], 0.7),
        wall([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], 0.5),
        wall([-1.0, 0.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 5.0], 0.3),
        wall([1.0, 0.0, -1.0], [0.0, 0.0, 5.0], [0.0, 2.0, 0.0], 0.6),
    ];
    all.extend(objects.as_array().unwrap().iter().cloned());
    parse(&json!({
        "etalon": 1,
        "camera": {
            "type": "perspective", "position_m": [0.1, 1.0, 3.5], "look_at_m": [0.0, 0.9, 0.0],
            "vertical_fov_deg": 40, "lens": {"radius_m": 0.02, "focus_distance_m": 3.5}
        },
        "film": {"width": 40, "height": 30},
        "materials": {
            "white": {"type": "lambert", "reflectance": 0.8},
            "gold": {"type": "conductor", "metal": "Au"},
            "glass": {"type": "dielectric", "interior": "N-BK7"},
            "black": {"type": "black"}
        },
        "objects": all,
        "groups": groups,
        "instances": instances,
        "lights": [{"type": "point", "position_m": [0.5, 1.5, 1.5], "intensity": 0.2}],
        "integrator": {"spp": 16, "seed": 11}
    }))
}

/// A lamp of triangles, a lamp that is a ball, a glass ball, a metal block and a disk.
fn furniture(transform: &Value) -> Value {
    let object = |shape: Value, material: &str, radiance: f64| {
        let mut object = json!({"shape": shape, "material": material, "transform": transform});
        if radiance > 0.0 {
            object["emission"] = json!({"radiance": radiance});
        }
        object
    };
    let corners = json!([[-0.2, 0.9, -0.2], [0.2, 0.9, -0.2], [0.2, 0.9, 0.2], [-0.2, 0.9, 0.2]]);
    let lamp = json!({"type": "mesh", "vertices_m": corners, "triangles": [[0, 1, 2], [0, 2, 3]]});
    let disk = json!({"type": "disk", "center_m": [0.3, 0.1, 0.3], "normal": [1, 2, 1], "radius_m": 0.15});
    // Normals that are not the triangles'.
    let roof = json!({
        "type": "mesh", "triangles": [[0, 2, 1], [0, 3, 2], [0, 1, 3]],
        "vertices_m": [[-0.1, 0.6, 0.3], [-0.4, 0.5, 0.2], [0.1, 0.5, 0.2], [-0.1, 0.5, 0.6]],
        "normals": [[0, 1, 0.1], [-1, 1, 0], [1, 0.9, -0.2], [0, 0.5, 1]]
    });
    json!([
        object(roof, "white", 0.0),
        object(lamp, "black", 6.0),
        object(json!({"type": "sphere", "center_m": [0.3, 0.7, 0.1], "radius_m": 0.08}), "black", 9.0),
        object(json!({"type": "sphere", "center_m": [0.0, 0.3, 0.0], "radius_m": 0.25}), "glass", 0.0),
        object(json!({"type": "box", "min_m": [-0.5, 0.0, -0.3], "max_m": [-0.3, 0.5, 0.0]}), "gold", 0.0),
        object(disk, "white", 0.0)
    ])
}

#[test]
fn placed_lamps_glass_and_metal_render_as_if_they_were_written_out() {
    let steps = json!([
        {"scale": [-0.9, 0.9, 0.9]}, {"rotate": {"axis": [1, 4, 2], "angle_deg": 25}}, {"translate_m": [0.1, 0.4, 0.3]}
    ]);
    let written = room(&furniture(&steps), &json!({}), &json!([]));
    // Scaled down within, up outside, by what is no power of two.
    let small = json!([{"scale": 1e-4}]);
    let mut large = json!([{"scale": 1e4}]);
    large.as_array_mut().unwrap().extend(steps.as_array().unwrap().iter().cloned());
    for (groups, instances) in [
        (json!({"all": {"objects": furniture(&json!([]))}}), json!([{"group": "all", "transform": steps}])),
        (
            json!({
                "inner": {"objects": furniture(&json!([]))},
                "outer": {"instances": [{"group": "inner", "transform": small}]}
            }),
            json!([{"group": "outer", "transform": large}]),
        ),
    ] {
        let placed = room(&json!([]), &groups, &instances);
        // Connections look for bodies of the scene's own, and shadow rays through glass for lamps of its own.
        let without = [EffectName::SpecularConnections, EffectName::RefractedShadows];
        let [a, b] = [&written, &placed].map(|scene| render_without(scene, &without));
        let largest = a.pixels().map(|p| p.xyz()[1]).fold(0.0, f64::max);
        let differing = a.pixels().zip(b.pixels()).filter(|(p, q)| {
            // Paths differ by roundings, which mirrors and lenses of the scene do not make larger than this; now and then
            // one tips a decision of roulette.
            (0..3).any(|c| (p.xyz()[c] - q.xyz()[c]).abs() > 1e-6 * largest)
        });
        let differing = differing.count();
        assert!(differing <= 2, "{differing} of {} pixels differ", a.pixels().count());
        assert_eq!(a.counters.paths, b.counters.paths);
        // With them the pictures are the same but for noise: z beyond 5 has a probability of 6e-7.
        let [a, b] = [&written, &placed].map(|scene| mean_and_variance(&render(scene)));
        assert!((a.0 - b.0).abs() < 5.0 * (a.1 + b.1).sqrt(), "{a:?} and {b:?}");
    }
}

/// Gas of a grid in a box that fills the picture, which the light of a sky comes through.
fn gas(steps: &Value, placed_by_instance: bool) -> Scene {
    let own = if placed_by_instance { json!([]) } else { steps.clone() };
    let density = json!({"type": "grid", "file": "gas.vol", "scale": 0.2, "transform": own});
    let medium = json!({"absorption_per_m": 0.7, "scattering_per_m": 0.1, "density": density});
    let body = json!({
        "shape": {"type": "box", "min_m": [-1, -1.5, -2], "max_m": [1, 1.5, 2]}, "transform": own,
        "material": {"type": "boundary", "medium": medium}
    });
    let (objects, groups, instances) = match placed_by_instance {
        false => (json!([body]), json!({}), json!([])),
        true => (json!([]), json!({"gas": {"objects": [body]}}), json!([{"group": "gas", "transform": steps}])),
    };
    let scene = json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 20], "look_at_m": [0, 0, 0], "height_m": 3},
        "film": {"width": 12, "height": 12},
        "objects": objects, "groups": groups, "instances": instances,
        "lights": [{"type": "environment", "radiance": 1}],
        "integrator": {"spp": 16}
    });
    let mut bytes = b"VOL\x03".to_vec();
    [1_i32, 3, 4, 5, 1].iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    [-1.0_f32, -1.5, -2.0, 1.0, 1.5, 2.0].iter().for_each(|corner| bytes.extend(corner.to_le_bytes()));
    (0..60_u16).for_each(|i| bytes.extend(f32::from(i * 7 % 11).to_le_bytes()));
    let files = [NamedFile { name: "gas.vol".to_owned(), bytes }];
    parse_with_files(&scene.to_string(), "test", &files, None).unwrap_or_else(|errors| panic!("{errors}")).scene
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// An instance takes the cells of its gas to where the transform of the grid itself takes them.
    #[test]
    fn grids_lie_where_instances_put_them(
        scale in prop::array::uniform3(0.5..2.0_f64), mirrors in any::<bool>(), angle in -179.0..179.0_f64,
        axis in prop::array::uniform3(0.1..1.0_f64), moved in prop::array::uniform3(-0.5..0.5_f64),
    ) {
        let [x, y, z] = scale;
        let steps = json!([
            {"scale": [if mirrors { -x } else { x }, y, z]}, {"rotate": {"axis": axis, "angle_deg": angle}}, {"translate_m": moved}
        ]);
        let [written, placed] = [false, true].map(|placed| render(&gas(&steps, placed)));
        let values = |film: &Film| -> Vec<f64> { film.pixels().map(|pixel| pixel.xyz()[1]).collect() };
        // Paths differ by roundings; now and then one tips a decision.
        let differing = values(&written).iter().zip(values(&placed)).filter(|(p, q)| (**p - q).abs() > 1e-9).count();
        prop_assert!(differing <= 1, "{differing} of 144 pixels differ");
    }
}

/// Mean Y of a picture, and its variance by the scatter of replicates.
fn mean_and_variance(film: &Film) -> (f64, f64) {
    let pixels = film.pixels().count() as f64;
    let mean = film.pixels().map(|p| p.xyz()[1]).sum::<f64>() / pixels;
    let variance = film.pixels().filter_map(|p| Some(p.variance(|xyz| xyz)?.0[1])).sum::<f64>();
    (mean, variance / (pixels * pixels))
}

/// The scene `factor` times as large, as bright as before.
fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let larger = |v: &mut [f64; 3]| v.iter_mut().for_each(|c| *c *= factor);
    let grow = |t: &mut Transform| {
        t.linear.iter_mut().for_each(larger);
        larger(&mut t.translation_m);
    };
    larger(&mut scene.camera.position_m);
    match &mut scene.camera.projection {
        Projection::Perspective { lens, .. } => {
            if let Some(lens) = lens {
                lens.radius_m *= factor;
                lens.focus_distance_m *= factor;
            }
        }
        Projection::Orthographic { height_m } => *height_m *= factor,
        Projection::CompoundLens(lens) => {
            let lens = Arc::make_mut(lens);
            lens.film_distance_m *= factor;
            lens.film_height_m *= factor;
            for surface in &mut lens.surfaces {
                surface.curvature_per_m /= factor;
                surface.thickness_m *= factor;
                surface.semi_aperture_m *= factor;
                // A₄ is in m⁻³, each further one has two powers more.
                let powers = (3..).step_by(2);
                surface.aspheric.iter_mut().zip(powers).for_each(|(a, power)| *a /= factor.powi(power));
            }
        }
    }
    scene.objects.iter_mut().for_each(|object| grow(&mut object.transform));
    scene.instances.iter_mut().for_each(|instance| grow(&mut instance.transform));
    for light in &mut scene.lights {
        if let LightKind::Point { position_m, intensity } = &mut light.kind {
            larger(position_m);
            let Spectrum::Constant(value) = intensity else { panic!("a constant intensity") };
            *value *= factor * factor;
        }
    }
    scene
}

/// A biconvex lens, aspheric behind, that sees the room.
fn compound_lens() -> Projection {
    let surface = |radius_m: f64, thickness_m: f64, medium: RefractiveIndex, is_stop: bool| LensSurface {
        curvature_per_m: 1.0 / radius_m,
        conic: 0.0,
        aspheric: if is_stop { Vec::new() } else { vec![40.0, -1e4] },
        thickness_m,
        medium,
        semi_aperture_m: 0.01,
        is_stop,
    };
    let glass = RefractiveIndex::named("N-BK7").unwrap();
    Projection::CompoundLens(Arc::new(CompoundLens {
        surfaces: vec![surface(0.05, 0.005, glass, true), surface(-0.05, 0.0, RefractiveIndex::VACUUM, false)],
        coating: LensCoating::Bare,
        film_distance_m: 0.048,
        film_height_m: 0.03,
        reference_nm: 587.5618,
    }))
}

/// Scenes of all kinds: shapes, lamps, cameras, instances, a place away from the origin.
fn scenes() -> Vec<Scene> {
    let identity = json!([]);
    let moved = json!([{"rotate": {"axis": [1, 4, 2], "angle_deg": 25}}, {"translate_m": [0.1, 0.4, 0.3]}]);
    let groups = json!({"all": {"objects": furniture(&identity)}});
    let instances = json!([{"group": "all", "transform": moved}]);
    let plain = room(&furniture(&moved), &json!({}), &json!([]));
    let instanced = room(&json!([]), &groups, &instances);
    let mut away = plain.clone();
    let shift = [37.25, -5.5, 1000.0];
    let displace = |p: &mut [f64; 3]| (0..3).for_each(|k| p[k] += shift[k]);
    displace(&mut away.camera.position_m);
    away.objects.iter_mut().for_each(|object| displace(&mut object.transform.translation_m));
    if let LightKind::Point { position_m, .. } = &mut away.lights[0].kind {
        displace(position_m);
    }
    let mut flat = instanced.clone();
    flat.camera.projection = Projection::Orthographic { height_m: 2.0 };
    let mut through_glass = plain.clone();
    through_glass.camera.projection = compound_lens();
    vec![plain, instanced, away, flat, through_glass]
}

#[test]
fn scaling_a_scene_by_a_power_of_two_changes_no_bit_of_its_image() {
    for mut scene in scenes() {
        scene.integrator.spp = 4;
        let film = render(&scene);
        for exponent in [-20, -7, 1, 20] {
            assert!(render(&scaled(&scene, 2.0_f64.powi(exponent))) == film, "2^{exponent}");
        }
    }
}

#[test]
fn zeros_of_both_signs_in_the_camera_change_no_bit_of_an_image() {
    for mut scene in scenes() {
        scene.camera.forward = [0.0, 0.0, -1.0];
        scene.camera.up = [0.0, 1.0, 0.0];
        let film = render(&scene);
        scene.camera.forward = [-0.0, -0.0, -1.0];
        scene.camera.up = [-0.0, 1.0, -0.0];
        assert!(render(&scene) == film);
    }
}

#[test]
fn a_replay_tells_positions_in_the_world() {
    let scene = &scenes()[2];
    let large = scaled(scene, 4096.0);
    let vertices = |scene: &Scene| -> Vec<[f64; 3]> {
        let replay = prepare(scene).unwrap().replay(20, 15, 0);
        let position = |event| match event {
            etalon_transport::replay::Event::Vertex { position_m, .. } => Some(position_m),
            _ => None,
        };
        replay.events.into_iter().filter_map(position).collect()
    };
    let (one, other) = (vertices(scene), vertices(&large));
    assert!(!one.is_empty());
    for (p, q) in one.iter().zip(&other) {
        assert!((p[2] - 1000.0).abs() < 6.0, "{p:?} is not where the room is");
        assert_eq!(p.map(|c| c * 4096.0), *q);
    }
}
