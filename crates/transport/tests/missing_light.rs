//! Light that no path finds: what the plan says of it is what pictures show, and a picture without light knows nothing of its error.

use etalon_scene::Scene;
use etalon_transport::plan::Lost;
use etalon_transport::{Control, ImageError, PathLoop, Prepared, Study, prepare_study};
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
        lights(lamp, 1.0, [0.0, 1.0, 0.0]),
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
    let loops =
        [PathLoop::Scalar, PathLoop::Batch].map(|path_loop| Study { path_loop: Some(path_loop), ..Study::default() });
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

/// What lets light pass, and what of it is missing.
fn sheets() -> Vec<(Value, Option<Lost>)> {
    vec![
        (json!({"type": "dielectric", "interior": 1.5}), Some(Lost::ReflectedAndTransmitted)),
        (json!({"type": "thin-dielectric", "index": 1.5}), Some(Lost::ReflectedAndTransmitted)),
        (json!({"type": "polariser", "axis": [1, 0, 0]}), Some(Lost::Transmitted)),
        (json!({"type": "retarder", "axis": [1, 0, 0], "retardance_deg": 90}), Some(Lost::Transmitted)),
        (json!({"type": "dielectric", "interior": 1.5, "alpha": 0.3}), None),
    ]
}

/// What reflects light, and what of it is missing.
fn mirrors() -> Vec<(Value, Option<Lost>)> {
    vec![
        (json!({"type": "mirror"}), Some(Lost::Reflected)),
        (json!({"type": "conductor", "metal": "Au"}), Some(Lost::Reflected)),
        (json!({"type": "conductor", "reflectance": 0.9}), Some(Lost::Reflected)),
        (json!({"type": "dielectric", "interior": 1.5}), Some(Lost::ReflectedAndTransmitted)),
        (json!({"type": "thin-dielectric", "index": 1.5}), Some(Lost::ReflectedAndTransmitted)),
        (json!({"type": "conductor", "metal": "Au", "alpha": 0.3}), None),
        (json!({"type": "plastic", "reflectance": 0.5, "alpha": 0.3}), None),
        (json!({"type": "lambert", "reflectance": 0.5}), None),
    ]
}

/// The plan says that a lamp's light is missing exactly where it is: the picture is black, and lit with a lamp that has an area or a
/// surface that is rough.
#[test]
fn what_the_plan_says_is_missing_is_missing() {
    let scenes = sheets().into_iter().map(|(kind, lost)| (behind as fn(Value, Lamp) -> Value, kind, lost));
    let scenes =
        scenes.chain(mirrors().into_iter().map(|(kind, lost)| (below as fn(Value, Lamp) -> Value, kind, lost)));
    for (place, kind, lost) in scenes {
        for lamp in WITHOUT_AREA {
            for prepared in prepared(&parse(&place(kind.clone(), lamp))) {
                let missing = &prepared.plan().missing_light;
                let error = error(&prepared);
                match lost {
                    Some(lost) => {
                        assert_eq!((missing.pairs, missing.listed.len()), (1, 1), "{kind} {lamp:?}");
                        let pair = &missing.listed[0];
                        assert_eq!(
                            (pair.light.as_str(), pair.object.as_str(), pair.material.as_str()),
                            ("lamp", "sheet", "smooth")
                        );
                        assert_eq!(pair.lost, lost);
                    }
                    None => assert_eq!(missing.pairs, 0, "{kind} {lamp:?}"),
                }
                assert_eq!(error.found_light(), lost.is_none(), "{kind} {lamp:?}");
            }
        }
        for prepared in prepared(&parse(&place(kind.clone(), Lamp::Sphere))) {
            assert_eq!(prepared.plan().missing_light.pairs, 0);
            assert!(error(&prepared).is_known(), "{kind} under a lamp with an area");
        }
    }
}

/// A smooth coat is a part of what the surface reflects: the rest is found, and another lamp too.
#[test]
fn missing_light_is_named_although_other_light_is_found() {
    let coated = parse(&below(json!({"type": "plastic", "reflectance": 0.5}), Lamp::Point));
    let mut scene = below(json!({"type": "mirror"}), Lamp::Point);
    scene["lights"].as_array_mut().unwrap().push(json!({"type": "environment", "radiance": 1}));
    for (scene, surface) in [(coated, "a smooth coat"), (parse(&scene), "a mirror")] {
        for prepared in prepared(&scene) {
            let missing = &prepared.plan().missing_light;
            assert_eq!((missing.pairs, missing.listed[0].surface), (1, surface));
            assert!(error(&prepared).is_known());
        }
    }
}

/// Lamps and surfaces that are no pair: outside the cone of a spot, dark, black or fully transparent; of paths too short to show it.
#[test]
fn what_can_certainly_not_be_missing_is_not_named() {
    let pairs = |change: &dyn Fn(&mut Value)| {
        let mut scene = behind(json!({"type": "mirror"}), Lamp::Spot);
        scene["objects"][0]["shape"] = json!({"type": "sphere", "center_m": [0, 1, 0], "radius_m": 0.5});
        change(&mut scene);
        prepared(&parse(&scene))[0].plan().missing_light.pairs
    };
    assert_eq!(pairs(&|_| ()), 1);
    assert_eq!(pairs(&|scene| scene["lights"][0]["intensity"] = 0.into()), 0);
    assert_eq!(pairs(&|scene| scene["materials"]["smooth"]["reflectance"] = 0.into()), 0);
    assert_eq!(pairs(&|scene| scene["objects"][0]["opacity"] = 0.into()), 0);
    assert_eq!(pairs(&|scene| scene["integrator"]["max_depth"] = 2.into()), 0);
    assert_eq!(pairs(&|scene| scene["integrator"]["max_depth"] = 3.into()), 1);
    // From 1 m away, a ball of 0.5 m reaches 30° from its middle, and the cone 60°: to 90° they meet.
    for (degrees, expected) in [(89.9_f64, 1), (90.1, 0)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        assert_eq!(pairs(&|scene| scene["lights"][0]["direction"] = json!([sin, -cos, 0.0])), expected, "{degrees}°");
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
            pairs(&|scene| {
                scene["objects"][0]["shape"] = shape.clone();
                scene["lights"][0]["direction"] = direction.clone();
                scene["lights"][0]["half_angle_deg"] = 30.into();
            })
        };
        assert_eq!((with(&json!([0, -1, 0])), with(&beside)), (1, 0), "{shape}");
    }
    // What an instance places is anywhere.
    let placed = pairs(&|scene| {
        scene["lights"][0]["direction"] = json!([0, 1, 0]);
        let sheet = scene["objects"].as_array_mut().unwrap().remove(0);
        scene["groups"] = json!({"things": {"objects": [sheet]}});
        scene["instances"] = json!([{"group": "things"}]);
    });
    assert_eq!(placed, 1);
}

/// What a study leaves out is an approximation, not missing light.
#[test]
fn what_a_study_leaves_out_is_not_named() {
    use etalon_transport::EffectName::{Environment, ShadowRays, SpecularChains};
    let scene = parse(&below(json!({"type": "mirror"}), Lamp::Point));
    for (without, pairs) in [(ShadowRays, 0), (SpecularChains, 0), (Environment, 1)] {
        let study = Study { without: vec![without], ..Study::default() };
        assert_eq!(prepare_study(&scene, &study).unwrap().plan().missing_light.pairs, pairs, "{without}");
    }
}

/// However many lamps and surfaces there are, the plan lists 64 pairs and counts the rest.
#[test]
fn many_pairs_are_counted() {
    let mut scene = behind(json!({"type": "mirror"}), Lamp::Point);
    let more = |what: &Value, count: usize| Value::from(vec![what.clone(); count]);
    scene["lights"] = more(&scene["lights"][0], 30);
    let objects = scene["objects"].clone();
    scene["objects"] = more(&objects[0], 20);
    scene["objects"].as_array_mut().unwrap().push(objects[1].clone());
    let missing = prepared(&parse(&scene))[0].plan().missing_light.clone();
    assert_eq!((missing.pairs, missing.listed.len()), (600, 64));
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

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever stands around, as long as all of it is dark nothing is known of the error; lit by the sky as well it is, and each lamp
    /// without area is a pair with each smooth ball.
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
            prop_assert_eq!(prepared.plan().missing_light.pairs, 0);
        }
        lights.iter_mut().for_each(|light| light["intensity"] = json!(1e-3));
        lights.push(json!({"type": "environment", "radiance": 1}));
        let smooth = balls.iter().filter(|((_, smooth), ..)| *smooth).count();
        for prepared in prepared(&scene(&lights)) {
            let error = error(&prepared);
            prop_assert!(error.is_known() && error.has_interval());
            prop_assert_eq!(prepared.plan().missing_light.pairs, (smooth * lamps.len()) as u64);
        }
    }
}
