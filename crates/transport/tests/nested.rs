//! Nested dielectrics: what the truths of the oracle do not show by themselves.

use etalon_oracle::truths::{Claim, Truth, truths};
use etalon_scene::Scene;
use etalon_transport::plan::EffectName;
use etalon_transport::{Film, PrepareError, Study, prepare};
use serde_json::{Value, json};

use crate::common::rendering::{mean_y, parse, render};

fn nested_truths() -> Vec<Truth> {
    let nested: Vec<_> = truths().into_iter().filter(|truth| truth.claims.contains(&Claim::Priorities)).collect();
    assert!(nested.len() >= 12);
    nested
}

/// What the sensor reads of a constant 1: less than 1 in a truth of one band of wavelengths.
fn white(truth: &Truth) -> f64 {
    truth.band_nm.map_or(1.0, |_| mean_y(&render(&parse(&truth.white_scene()), &Study::default())))
}

/// The mutant: solids that know nothing of each other. Truths without a furnace, which excuses much and in which the mutant
/// traps light for ever, must reject it.
#[test]
fn solids_that_know_nothing_of_each_other_are_rejected_and_ours_lose_no_medium() {
    let study = Study { without: vec![EffectName::NestedDielectrics], ..Study::default() };
    let mut rejected = 0;
    for truth in nested_truths() {
        let (mut scene, white) = (parse(&truth.scene), white(&truth));
        // As many paths whatever the film: 16 a pixel of 32².
        scene.integrator.spp = (1 << 14) / (scene.film.width * scene.film.height);
        let film = render(&scene, &Study::default());
        // 2¹⁴ paths of a value in [0, 1] scatter by less than 0.004; eyes in glass see no noise at all.
        let read = mean_y(&film) / white;
        let error = (read / truth.value() - 1.0).abs();
        assert!(error < 0.02, "{}: {read} is not {}", truth.name, truth.value());
        assert_eq!(film.counters.lost_media, 0, "{}", truth.name);
        if truth.name.starts_with("furnace") || truth.name.starts_with("eye") {
            continue;
        }
        scene.integrator.max_depth = Some(64);
        rejected += usize::from((mean_y(&render(&scene, &study)) / white / truth.value() - 1.0).abs() > 0.02);
    }
    assert!(rejected >= 6, "only {rejected} truths reject the mutant");
}

/// A sphere of glass with water around it, at random places: as the exact touch of two solids, and as an overlap that the
/// priority decides. The media are the same, so are the means; the paths are the same too but for their last digits.
#[test]
fn a_ball_that_overlaps_its_bath_is_the_ball_in_the_bath() {
    let scene = |objects: Value| {
        parse(
            &json!({
                "etalon": 1,
                "camera": {"type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
                "film": {"width": 24, "height": 18},
                "materials": {
                    "water": {"type": "dielectric", "interior": 1.33, "priority": 0},
                    "glass": {"type": "dielectric", "interior": "N-SF11", "priority": 1},
                    "floor": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.6, 0.3, 0.2]}},
                    "gold": {"type": "conductor", "metal": "Au"},
                    "black": {"type": "black"}
                },
                "objects": objects,
                "lights": [{"type": "environment", "radiance": 0.5}],
                "integrator": {"spp": 16, "wavelength_range_nm": [400, 700]}
            })
            .to_string(),
        )
    };
    let ball = json!({"material": "glass", "shape": {"type": "sphere", "center_m": [0, 0, 0], "radius_m": 0.5}});
    let gold = json!({"material": "gold", "shape": {"type": "sphere", "center_m": [0.7, 0, 0], "radius_m": 0.2}});
    let floor = json!({
        "material": "floor",
        "shape": {"type": "parallelogram", "origin_m": [-3, -1, 3], "u_m": [6, 0, 0], "v_m": [0, 0, -6]}
    });
    let bath = json!({"material": "water", "shape": {"type": "box", "min_m": [-1, -0.8, -1], "max_m": [1, 0.8, 1]}});
    // Wholly within the glass: overruled everywhere.
    let drop = json!({"material": "water", "shape": {"type": "sphere", "center_m": [0.1, 0.1, 0], "radius_m": 0.3}});
    let plain = render(&scene(json!([ball, gold, floor, bath])), &Study::default());
    let overruled = render(&scene(json!([drop, ball, gold, floor, bath])), &Study::default());
    let order = render(&scene(json!([bath, floor, gold, ball])), &Study::default());
    for film in [&plain, &overruled, &order] {
        assert_eq!((film.counters.lost_media, film.counters.nonfinite), (0, 0));
    }
    assert!(plain.xyz().eq(order.xyz()), "the order of objects of different priority counts");
    let different =
        plain.xyz().zip(overruled.xyz()).filter(|(a, b)| (a[1] - b[1]).abs() > 1e-6 * a[1].max(b[1])).count();
    // A face that bounds nothing moves points by a rounding, after which a path may take another turn at an edge.
    assert!(different <= 4, "{different} pixels differ");
}

/// Two balls of water that overlap in glass, as two objects and as two instances of one: each instance is a solid of its own.
#[test]
fn two_instances_of_one_solid_are_two_solids() {
    let ball = |center: [f64; 3]| json!({"material": "bubble", "shape": {"type": "sphere", "center_m": center, "radius_m": 0.5}});
    let block =
        json!({"material": "glass", "shape": {"type": "box", "min_m": [-1.0, -1.0, -1.0], "max_m": [1.0, 1.0, 1.0]}});
    let scene = |objects: Value, more: Value| {
        let mut scene = json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": [0.3, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
            "film": {"width": 24, "height": 18},
            "materials": {
                "glass": {"type": "dielectric", "interior": 1.5, "priority": 0},
                "bubble": {"type": "dielectric", "interior": 1.33, "priority": 1}
            },
            "objects": objects,
            "lights": [{"type": "environment", "radiance": 1}],
            "integrator": {"spp": 16}
        });
        scene.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        render(&parse(&scene.to_string()), &Study::default())
    };
    let plain = scene(json!([block, ball([-0.3, 0.0, 0.0]), ball([0.3, 0.0, 0.0])]), json!({}));
    let placed = scene(
        json!([block]),
        json!({
            "groups": {"ball": {"objects": [ball([0.0, 0.0, 0.0])]}},
            "instances": [
                {"group": "ball", "transform": [{"translate_m": [-0.3, 0, 0]}]},
                {"group": "ball", "transform": [{"translate_m": [0.3, 0, 0]}]}
            ]
        }),
    );
    for film in [&plain, &placed] {
        assert_eq!(film.counters.lost_media, 0);
        // Lossless in uniform light: but for the roulette, which these paths never meet, every pixel is 1 to rounding.
        assert!(film.xyz().all(|xyz| (xyz[1] - 1.0).abs() < 1e-6));
    }
}

#[test]
fn a_solid_that_is_open_is_refused_by_name() {
    let with = |shape: Value| {
        parse(
            &json!({
                "etalon": 1,
                "camera": {"type": "perspective", "position_m": [0, 1, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
                "film": {"width": 4, "height": 4},
                "materials": {"water": {"type": "dielectric", "interior": 1.33, "priority": 0}},
                "objects": [{"name": "pane", "material": "water", "shape": shape}],
                "lights": [{"type": "environment", "radiance": 0.5}]
            })
            .to_string(),
        )
    };
    let open = [
        json!({"type": "disk", "center_m": [0, 0, 0], "normal": [0, 1, 0], "radius_m": 1}),
        json!({"type": "parallelogram", "origin_m": [0, 0, 0], "u_m": [1, 0, 0], "v_m": [0, 1, 0]}),
        json!({
            "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
            "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3]]
        }),
    ];
    for shape in open {
        let error = prepare(&with(shape)).err().expect("it bounds no solid");
        assert!(matches!(&error, PrepareError::OpenSolid { object, .. } if object == "pane"), "{error}");
    }
    // The second has its first corner twice, with a zero of the other sign: the place is the same.
    let closed = [
        json!({
            "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
            "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        }),
        json!({
            "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-0.0, 0, -0.0]],
            "triangles": [[0, 2, 1], [4, 1, 3], [1, 2, 3], [4, 3, 2]]
        }),
    ];
    for shape in closed {
        assert!(prepare(&with(shape)).is_ok());
    }
}

/// A rough ball of glass in a bath of water, and a rough block of glass that stands on the water's face: `ball` and `block` are
/// their materials.
fn rough_bath(ball: &Value, order: [usize; 3]) -> Scene {
    let objects = [
        json!({"material": {"type": "dielectric", "interior": 1.33, "priority": 0}, "shape": {"type": "box", "min_m": [-1, -0.8, -1], "max_m": [1, 0.8, 1]}}),
        json!({"material": ball, "shape": {"type": "sphere", "center_m": [0.1, 0, 0], "radius_m": 0.5}}),
        json!({
            "material": {"type": "dielectric", "interior": 1.5, "alpha": 0.3, "priority": 1},
            "shape": {"type": "box", "min_m": [-0.6, 0.8, -0.6], "max_m": [0.6, 1.2, 0.6]}
        }),
    ];
    parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": [0, 1.5, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
            "film": {"width": 16, "height": 12},
            "objects": order.map(|i| objects[i].clone()),
            "lights": [{"type": "environment", "radiance": 1}],
            "integrator": {"spp": 64, "roulette": false, "max_depth": 200}
        })
        .to_string(),
    )
}

/// What absorbs nothing cannot be seen in uniform light: rough glass in water, and rough glass that touches it. Tables of light that
/// meets several facets stay below the loss by up to 0.5 % of it, a thousandth of the light or less at this width, and a path meets
/// some ten such faces.
#[test]
fn rough_solids_in_and_on_water_cannot_be_seen_in_uniform_light() {
    let ball = json!({"type": "dielectric", "interior": 1.5, "alpha": 0.3, "priority": 1});
    let film = render(&rough_bath(&ball, [0, 1, 2]), &Study::default());
    assert_eq!((film.counters.lost_media, film.counters.nonfinite), (0, 0));
    let mean = mean_y(&film);
    // 16 · 12 · 64 paths scatter by less than 0.1 each.
    assert!((-1e-2..4e-3).contains(&(mean - 1.0)), "{mean}");
}

/// A rough solid among others is the interface that states both its sides; and where faces coincide, the order of the objects does
/// not decide whether the common face is rough.
#[test]
fn a_rough_solid_is_the_interface_of_its_two_media() {
    let tracked = json!({"type": "dielectric", "interior": 1.5, "alpha": 0.3, "priority": 1});
    let stated = json!({"type": "dielectric", "interior": 1.5, "alpha": 0.3, "exterior": 1.33});
    let [tracked, stated, other_order] = [(&tracked, [0, 1, 2]), (&stated, [0, 1, 2]), (&tracked, [2, 1, 0])]
        .map(|(ball, order)| render(&rough_bath(ball, order), &Study::default()));
    let different = |other: &Film| {
        tracked.xyz().zip(other.xyz()).filter(|(a, b)| (a[1] - b[1]).abs() > 1e-6 * a[1].max(b[1])).count()
    };
    for other in [&stated, &other_order] {
        // Rounding may send a path elsewhere at an edge.
        assert!(different(other) <= 4, "{} pixels differ", different(other));
    }
    // The mutant: a ball that knows nothing of the water.
    let dry = json!({"type": "dielectric", "interior": 1.5, "alpha": 0.3});
    let mutant = render(&rough_bath(&dry, [0, 1, 2]), &Study::default());
    assert!(different(&mutant) > 30, "only {} pixels differ", different(&mutant));
}

/// White light through a prism whose glass has a priority, for which the media of each place are tracked: the spectrum is cut where it is
/// without. Carried along one path, all wavelengths together would read 0.09, a third less.
#[test]
fn glass_among_other_solids_disperses_as_glass_alone() {
    let truth = truths().into_iter().find(|truth| truth.name == "rainbow-cut-in-two").expect("it is a truth");
    let mut json: Value = serde_json::from_str(&truth.scene).unwrap();
    let mut given = 0;
    visit(&mut json, &mut |object| {
        if object.contains_key("interior") {
            object.insert("priority".into(), json!(1));
            given += 1;
        }
    });
    assert!(given > 0);
    let scene = parse(&json.to_string());
    let film = render(&scene, &Study::default());
    assert_eq!((film.counters.nonfinite, film.counters.lost_media), (0, 0));
    let read = mean_y(&film);
    // Of every path one wavelength of some 2^20 and more passes by chance: the standard error is below 0.2 %.
    assert!((read / truth.value() - 1.0).abs() < 0.02, "{read} is not {}", truth.value());
}

/// Every object of a text, the innermost first.
fn visit(json: &mut Value, change: &mut dyn FnMut(&mut serde_json::Map<String, Value>)) {
    match json {
        Value::Array(array) => array.iter_mut().for_each(|value| visit(value, change)),
        Value::Object(object) => {
            object.values_mut().for_each(|value| visit(value, change));
            change(object);
        }
        _ => {}
    }
}
