//! Specular connections: the plan calls for them where pictures show that light comes by them, they find the light that closed forms tell, and a
//! picture without light knows nothing of its error.

use etalon_scene::Scene;
use etalon_transport::{Control, EffectName, ImageError, PathLoop, Prepared, Study, prepare_study};
use proptest::prelude::*;
use serde_json::{Value, json};

fn parse(scene: &Value) -> Scene {
    etalon_scene::parse(&scene.to_string(), "test").unwrap_or_else(|errors| panic!("{errors}")).0
}

/// Where a lamp without area may stand, and what it may be.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lamp {
    Point,
    Spot,
    Directional,
    /// With an area, in the same place.
    Sphere,
}

const WITHOUT_AREA: [Lamp; 3] = [Lamp::Point, Lamp::Spot, Lamp::Directional];

fn lights(lamp: Lamp, height: f64, direction: [f64; 3]) -> Value {
    match lamp {
        Lamp::Point => json!([{"type": "point", "name": "lamp", "position_m": [0, height, 0], "intensity": 1}]),
        Lamp::Spot => json!([{"type": "spot", "name": "lamp", "position_m": [0, height, 0], "direction": direction,
            "half_angle_deg": 60, "intensity": 1}]),
        Lamp::Directional => json!([{"type": "directional", "name": "lamp", "direction": direction, "irradiance": 1}]),
        Lamp::Sphere => json!([]),
    }
}

/// A white patch of floor that the camera sees, and a lamp above a sheet of `material` that keeps all other light from it.
fn behind(material: Value, lamp: Lamp) -> Value {
    room(
        material,
        lamp,
        lights(lamp, 2.0, [0.0, -1.0, 0.0]),
        [0.0, 2.0, 0.0],
        json!([
        {"name": "sheet", "material": "smooth", "shape": {"type": "parallelogram",
            "origin_m": [-50, 1, 50], "u_m": [100, 0, 0], "v_m": [0, 0, -100]}}]),
        0.0,
    )
}

/// The same beside a black disk that shades it from the lamp, which shines on a sheet of `material` above.
fn below(material: Value, lamp: Lamp) -> Value {
    room(
        material,
        lamp,
        // Straight up, the floor would hide parallel light from itself.
        lights(lamp, 1.0, [-0.3, 1.0, 0.0]),
        [0.0, 1.0, 0.0],
        json!([
        {"name": "sheet", "material": "smooth", "shape": {"type": "parallelogram",
            "origin_m": [-50, 2, 50], "u_m": [100, 0, 0], "v_m": [0, 0, -100]}},
        {"name": "shade", "material": "black", "shape": {"type": "disk", "center_m": [0, 0.5, 0], "normal": [0, 1, 0], "radius_m": 0.7}}]),
        1.0,
    )
}

fn room(material: Value, lamp: Lamp, lights: Value, at: [f64; 3], mut objects: Value, x: f64) -> Value {
    let list = objects.as_array_mut().unwrap();
    list.push(json!({"name": "floor", "material": "white",
        "shape": {"type": "disk", "center_m": [x, 0, 0], "normal": [0, 1, 0], "radius_m": 0.1}}));
    if lamp == Lamp::Sphere {
        list.push(json!({"name": "lamp", "material": "black", "emission": {"radiance": 1},
            "shape": {"type": "sphere", "center_m": at, "radius_m": 0.2}}));
    }
    json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [x + 0.05, 0.3, 0], "look_at_m": [x, 0, 0], "up": [0, 0, 1], "height_m": 0.05},
        "film": {"width": 8, "height": 8},
        "materials": {"white": {"type": "lambert", "reflectance": 1}, "black": {"type": "black"}, "smooth": material},
        "objects": objects,
        "lights": lights,
        "integrator": {"spp": 64}
    })
}

/// On both loops, where there are two.
fn prepared(scene: &Scene) -> Vec<Prepared> {
    prepared_without(scene, &[])
}

/// The same without some effects.
fn prepared_without(scene: &Scene, without: &[EffectName]) -> Vec<Prepared> {
    let loops = [PathLoop::Scalar, PathLoop::Batch].map(|path_loop| Study {
        path_loop: Some(path_loop),
        without: without.to_vec(),
        ..Study::default()
    });
    let prepared: Vec<_> = loops.iter().filter_map(|study| prepare_study(scene, study).ok()).collect();
    assert!(!prepared.is_empty());
    prepared
}

fn error(prepared: &Prepared) -> ImageError {
    let whole = prepared.whole(None);
    let film = prepared.render(&whole, &|_| Control::Continue).unwrap();
    let error = film.error(whole.rect).unwrap();
    assert_eq!(error.is_known(), error.found_light());
    if !error.is_known() {
        assert_eq!((error.relative_rmse, error.interval), (f64::INFINITY, [0.0, f64::INFINITY]));
        assert_eq!(error.noisiest, None);
    }
    error
}

/// What lets light pass, and whether in single directions.
fn sheets() -> Vec<(Value, bool)> {
    vec![
        (json!({"type": "dielectric", "interior": 1.5}), true),
        (json!({"type": "thin-dielectric", "index": 1.5}), true),
        (json!({"type": "polariser", "axis": [1, 0, 0]}), true),
        (json!({"type": "retarder", "axis": [1, 0, 0], "retardance_deg": 90}), true),
        (json!({"type": "dielectric", "interior": 1.5, "alpha": 0.3}), false),
    ]
}

/// What reflects light, and whether in single directions.
fn mirrors() -> Vec<(Value, bool)> {
    vec![
        (json!({"type": "mirror"}), true),
        (json!({"type": "conductor", "metal": "Au"}), true),
        (json!({"type": "conductor", "reflectance": 0.9}), true),
        (json!({"type": "dielectric", "interior": 1.5}), true),
        (json!({"type": "thin-dielectric", "index": 1.5}), true),
        (json!({"type": "conductor", "metal": "Au", "alpha": 0.3}), false),
        (json!({"type": "plastic", "reflectance": 0.5, "alpha": 0.3}), false),
        (json!({"type": "lambert", "reflectance": 0.5}), false),
    ]
}

/// The plan calls for connections exactly where they find light: without them the picture is black.
#[test]
fn connections_are_called_for_where_they_find_light() {
    let scenes = sheets().into_iter().map(|(kind, smooth)| (behind as fn(Value, Lamp) -> Value, kind, smooth));
    let scenes =
        scenes.chain(mirrors().into_iter().map(|(kind, smooth)| (below as fn(Value, Lamp) -> Value, kind, smooth)));
    for (place, kind, smooth) in scenes {
        for lamp in WITHOUT_AREA {
            let scene = parse(&place(kind.clone(), lamp));
            for prepared in prepared(&scene) {
                assert_eq!(prepared.plan().runs(EffectName::SpecularConnections), smooth, "{kind} {lamp:?}");
                assert!(error(&prepared).found_light(), "{kind} {lamp:?}");
            }
            for prepared in prepared_without(&scene, &[EffectName::SpecularConnections]) {
                assert_eq!(error(&prepared).found_light(), !smooth, "{kind} {lamp:?}");
            }
        }
        for prepared in prepared(&parse(&place(kind.clone(), Lamp::Sphere))) {
            assert!(!prepared.plan().runs(EffectName::SpecularConnections));
            assert!(error(&prepared).is_known(), "{kind} under a lamp with an area");
        }
    }
}

/// Why they are called for, and that both loops find the same light to the bit.
#[test]
fn a_smooth_coat_and_a_second_lamp_call_for_them_too() {
    let coated = parse(&below(json!({"type": "plastic", "reflectance": 0.5}), Lamp::Point));
    let mut scene = below(json!({"type": "mirror"}), Lamp::Point);
    scene["lights"].as_array_mut().unwrap().push(json!({"type": "environment", "radiance": 1}));
    for (scene, surface) in [(coated, "a smooth coat"), (parse(&scene), "a mirror")] {
        let films: Vec<_> = prepared(&scene)
            .iter()
            .map(|prepared| {
                let effects = &prepared.plan().effects;
                let effect = effects.iter().find(|effect| effect.name == EffectName::SpecularConnections).unwrap();
                assert_eq!(effect.because, format!("light \"lamp\" by way of \"sheet\", {surface}"));
                prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap()
            })
            .collect();
        let [scalar, batch] = &films[..] else { panic!("there are two loops") };
        let rect = etalon_transport::PixelRect { x0: 0, y0: 0, x1: 8, y1: 8 };
        assert_eq!(scalar.tile(rect), batch.tile(rect));
        assert_eq!(scalar.counters, batch.counters);
    }
}

/// Lamps and surfaces that call for nothing: outside the cone of a spot, dark, black or fully transparent; of paths too short to show it.
#[test]
fn what_certainly_sees_no_lamp_calls_for_nothing() {
    let called_for = |change: &dyn Fn(&mut Value)| {
        let mut scene = behind(json!({"type": "mirror"}), Lamp::Spot);
        scene["objects"][0]["shape"] = json!({"type": "sphere", "center_m": [0, 1, 0], "radius_m": 0.5});
        change(&mut scene);
        prepared(&parse(&scene))[0].plan().runs(EffectName::SpecularConnections)
    };
    assert!(called_for(&|_| ()));
    assert!(!called_for(&|scene| scene["lights"][0]["intensity"] = 0.into()));
    assert!(!called_for(&|scene| scene["materials"]["smooth"]["reflectance"] = 0.into()));
    assert!(!called_for(&|scene| scene["objects"][0]["opacity"] = 0.into()));
    assert!(!called_for(&|scene| scene["integrator"]["max_depth"] = 2.into()));
    assert!(called_for(&|scene| scene["integrator"]["max_depth"] = 3.into()));
    // From 1 m away, a ball of 0.5 m reaches 30° from its middle, and the cone 60°: to 90° they meet.
    for (degrees, expected) in [(89.9_f64, true), (90.1, false)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        assert_eq!(
            called_for(&|scene| scene["lights"][0]["direction"] = json!([sin, -cos, 0.0])),
            expected,
            "{degrees}°"
        );
    }
    // A mesh by the ball around its box, a cylinder by the one around its ends.
    let beside = json!([1, 0, 0]);
    let shapes = [
        json!({"type": "box", "min_m": [-0.3, 0.7, -0.3], "max_m": [0.3, 1.3, 0.3]}),
        json!({"type": "cylinder", "start_m": [0, 0.8, 0], "end_m": [0, 1.2, 0], "radius_m": 0.2}),
        json!({"type": "disk", "center_m": [0, 1, 0], "normal": [0, 1, 0], "radius_m": 0.4}),
        json!({"type": "parallelogram", "origin_m": [-0.3, 1, -0.3], "u_m": [0.6, 0, 0], "v_m": [0, 0, 0.6]}),
    ];
    for shape in shapes {
        let with = |direction: &Value| {
            called_for(&|scene| {
                scene["objects"][0]["shape"] = shape.clone();
                scene["lights"][0]["direction"] = direction.clone();
                scene["lights"][0]["half_angle_deg"] = 30.into();
            })
        };
        assert_eq!((with(&json!([0, -1, 0])), with(&beside)), (true, false), "{shape}");
    }
    // What an instance places is anywhere.
    let placed = called_for(&|scene| {
        scene["lights"][0]["direction"] = json!([0, 1, 0]);
        let sheet = scene["objects"].as_array_mut().unwrap().remove(0);
        scene["groups"] = json!({"things": {"objects": [sheet]}});
        scene["instances"] = json!([{"group": "things"}]);
    });
    assert!(placed);
}

fn materials() -> impl Strategy<Value = (Value, bool)> {
    prop_oneof![
        (0.1..1.0).prop_map(|r| (json!({"type": "mirror", "reflectance": r}), true)),
        (1.1..2.5).prop_map(|n| (json!({"type": "dielectric", "interior": n}), true)),
        (1.1..2.5).prop_map(|n| (json!({"type": "thin-dielectric", "index": n}), true)),
        (0.1..1.0).prop_map(|r| (json!({"type": "plastic", "reflectance": r}), true)),
        (0.1..1.0).prop_map(|r| (json!({"type": "lambert", "reflectance": r}), false)),
        (0.1..1.0).prop_map(|a| (json!({"type": "conductor", "metal": "Ag", "alpha": a}), false)),
        Just((json!({"type": "black"}), false)),
    ]
}

/// Whether a material of [`materials`] scatters in every direction.
fn scatters_everywhere(kind: &Value) -> bool {
    matches!(kind["type"].as_str(), Some("plastic" | "lambert" | "conductor"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever stands around, as long as all of it is dark nothing is known of the error; lit by the sky as well it is. A lamp without area, a
    /// smooth ball and one that scatters in every direction call for connections.
    #[test]
    fn a_scene_is_known_as_far_as_it_is_lit(
        balls in prop::collection::vec((materials(), [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], 0.1..0.5), 1..6),
        lamps in prop::collection::vec([-2.0..2.0_f64, -2.0..2.0, -2.0..2.0], 0..3),
        seed in 0_u64..1000,
    ) {
        let mut materials = json!({});
        let mut objects = Vec::new();
        for (index, ((kind, _), center, radius)) in balls.iter().enumerate() {
            materials[format!("m{index}")] = kind.clone();
            objects.push(json!({"material": format!("m{index}"), "shape": {"type": "sphere", "center_m": center, "radius_m": radius}}));
        }
        let mut lights: Vec<Value> =
            lamps.iter().map(|at| json!({"type": "point", "position_m": at, "intensity": 0})).collect();
        let scene = |lights: &[Value]| {
            parse(&json!({
                "etalon": 1,
                "camera": {"type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 30},
                "film": {"width": 12, "height": 8},
                "materials": materials, "objects": objects, "lights": lights,
                "integrator": {"spp": 8, "seed": seed}
            }))
        };
        for prepared in prepared(&scene(&lights)) {
            prop_assert!(!error(&prepared).is_known());
            prop_assert!(!prepared.plan().runs(EffectName::SpecularConnections));
        }
        lights.iter_mut().for_each(|light| light["intensity"] = json!(1e-3));
        lights.push(json!({"type": "environment", "radiance": 1}));
        let smooth = balls.iter().any(|((_, smooth), ..)| *smooth);
        let lit = balls.iter().any(|((kind, _), ..)| scatters_everywhere(kind));
        for prepared in prepared(&scene(&lights)) {
            let error = error(&prepared);
            prop_assert!(error.is_known() && error.has_interval());
            prop_assert_eq!(prepared.plan().runs(EffectName::SpecularConnections), smooth && lit && !lamps.is_empty());
        }
    }
}

/// Mean Y of a picture, and its standard error by the scatter of replicates, pixels taken for independent.
fn mean_y(scene: &Value) -> (f64, f64) {
    let prepared = &prepared(&parse(scene))[1];
    let film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
    let pixels = film.pixels().count() as f64;
    let mean = film.pixels().map(|pixel| pixel.xyz()[1]).sum::<f64>() / pixels;
    let variance = film.pixels().map(|pixel| pixel.variance(|xyz| xyz).unwrap().0[1]).sum::<f64>();
    (mean, variance.sqrt() / pixels)
}

/// A chain may begin behind the surface that a path has met. What is there absorbs, whether the solid has a priority or not. |z| < 5 fails by
/// chance in 6e-7 of all runs. Without absorption on the chain there would be six times as much light.
#[test]
fn a_chain_through_a_rough_surface_is_in_the_medium_behind_it() {
    let scene = |priority: bool| {
        let mut glass =
            json!({"type": "dielectric", "interior": 1.3, "alpha": 0.4, "medium": {"absorption_per_m": 1.5}});
        if priority {
            glass["priority"] = 1.into();
        }
        json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 3, 0], "look_at_m": [0, 0, 0], "up": [0, 0, 1], "height_m": 0.5},
            "film": {"width": 16, "height": 16},
            "materials": {"glass": glass, "mirror": {"type": "mirror"}},
            "objects": [
                {"name": "block", "material": "glass", "shape": {"type": "box", "min_m": [-2, -1, -2], "max_m": [2, 1, 2]}},
                {"name": "mirror", "material": "mirror",
                    "shape": {"type": "disk", "center_m": [0, 0.3, 0], "normal": [0, 1, 0], "radius_m": 1}}
            ],
            "lights": [{"type": "spot", "name": "lamp", "position_m": [0.1, 0.8, 0], "direction": [0, -1, 0], "half_angle_deg": 50, "intensity": 1}],
            "integrator": {"spp": 256, "max_depth": 3}
        })
    };
    let [(plain, error), (nested, nested_error)] = [false, true].map(|priority| mean_y(&scene(priority)));
    assert!(plain > 20.0 * error, "{plain} ± {error}");
    assert!((plain - nested).abs() < 5.0 * error.hypot(nested_error), "{plain} ± {error}, {nested} ± {nested_error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// A flat mirror shows a lamp behind itself. |z| < 5 fails by chance in 6e-7 of the cases; that the patch is no point makes 0.2 %.
    #[test]
    fn a_mirror_shows_the_image_of_a_lamp(
        tilt in [-0.4..0.4_f64, -0.4..0.4],
        height in 1.5..3.0_f64,
        lamp in [-0.8..0.8_f64, 0.6..1.0, -0.8..0.8],
        reflectance in 0.3..1.0_f64,
    ) {
        let length = (1.0 + tilt[0] * tilt[0] + tilt[1] * tilt[1]).sqrt();
        // Downward, toward the patch and the lamp.
        let normal = [tilt[0] / length, -1.0 / length, tilt[1] / length];
        let depth = (0..3).map(|k| (lamp[k] - [0.0, height, 0.0][k]) * normal[k]).sum::<f64>();
        prop_assume!(depth > 0.05);
        let image = [0, 1, 2].map(|k| lamp[k] - 2.0 * depth * normal[k]);
        let shown = |at: [f64; 3]| at[1] / at.map(|c| c * c).iter().sum::<f64>().powf(1.5);
        let expected = 0.5 / std::f64::consts::PI * (shown(lamp) + reflectance * shown(image));
        let (mean, error) = mean_y(&json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0.05, 0.3, 0], "look_at_m": [0, 0, 0], "up": [0, 0, 1], "height_m": 0.02},
            "film": {"width": 8, "height": 8},
            "materials": {"grey": {"type": "lambert", "reflectance": 0.5}, "mirror": {"type": "mirror", "reflectance": reflectance}},
            "objects": [
                {"material": "grey", "shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 1, 0], "radius_m": 0.1}},
                {"material": "mirror", "shape": {"type": "disk", "center_m": [0, height, 0], "normal": normal, "radius_m": 60}}
            ],
            "lights": [{"type": "point", "position_m": lamp, "intensity": 1}],
            "integrator": {"spp": 256, "max_depth": 3}
        }));
        prop_assert!((mean - expected).abs() < 5.0 * error + 2e-3 * expected, "{mean} ± {error}, not {expected}");
    }
}
