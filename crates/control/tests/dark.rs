//! Pictures in which no light is found, or late: what a pilot knows then, and which limit ends the render.

use etalon_control::{Adaptivity, Limits, Pilot, Reached, SettleError, Watch, render_within};
use etalon_transport::{Counters, Prepared, prepare};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicU64, Ordering};

/// A white patch of floor that the camera sees, with these objects and lights above it.
fn floor(objects: &Value, lights: &Value, integrator: &Value) -> Prepared {
    let mut objects = objects.as_array().unwrap().clone();
    objects.push(json!({"material": "white",
        "shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 1, 0], "radius_m": 0.1}}));
    let json = json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0.05, 0.3, 0], "look_at_m": [0, 0, 0], "up": [0, 0, 1], "height_m": 0.05},
        "film": {"width": 8, "height": 8},
        "materials": {
            "white": {"type": "lambert", "reflectance": 1}, "black": {"type": "black"},
            "grey": {"type": "lambert", "reflectance": 0.5}, "glass": {"type": "dielectric", "interior": 1.5}
        },
        "objects": objects,
        "lights": lights,
        "integrator": integrator
    });
    let (scene, _) = etalon_scene::parse(&json.to_string(), "floor").unwrap_or_else(|errors| panic!("{errors}"));
    prepare(&scene).unwrap()
}

/// A ball around the camera and a lamp outside, a lamp that faces away, and a spot behind glass that faces away.
fn black() -> [Prepared; 3] {
    let ball = json!({"material": "grey", "shape": {"type": "sphere", "radius_m": 1}});
    let point = json!({"type": "point", "position_m": [0, 2, 0], "intensity": 1});
    // Its normal points up, and the floor is below.
    let away = json!({"material": "black", "emission": {"radiance": 1},
        "shape": {"type": "disk", "center_m": [0, 1, 0], "normal": [0, 1, 0], "radius_m": 1}});
    let glass = json!({"material": "glass",
        "shape": {"type": "parallelogram", "origin_m": [-50, 1, 50], "u_m": [100, 0, 0], "v_m": [0, 0, -100]}});
    // Connections through the glass are searched for, and those that are found carry nothing.
    let spot =
        json!({"type": "spot", "position_m": [0, 2, 0], "direction": [0, 1, 0], "half_angle_deg": 60, "intensity": 1});
    let spp = json!({"spp": 64});
    [
        floor(&json!([ball]), &json!([point]), &spp),
        floor(&json!([away]), &json!([]), &spp),
        floor(&json!([glass]), &json!([spot]), &spp),
    ]
}

fn limits(samples: u32, seconds: Option<f64>, adaptivity: Adaptivity) -> Limits {
    Limits { samples, relative_rmse: Some(0.1), seconds, adaptivity }
}

#[test]
fn a_picture_without_light_reaches_no_error() {
    for (prepared, adaptivity) in black().iter().zip([Adaptivity::Never, Adaptivity::Auto, Adaptivity::Always]) {
        let rect = prepared.whole(None).rect;
        let within = |limits: Limits| render_within(prepared, rect, &limits, None, &|| 0.0, &());
        // Nothing else would ever end it.
        let refused = within(limits(Limits::ANY_SAMPLES, None, adaptivity)).unwrap_err();
        assert!(matches!(refused, SettleError::NoLight { paths } if paths >= 1 << 22), "{refused}");
        // Samples do, and a time does.
        let done = within(limits(32, None, adaptivity)).unwrap();
        assert_eq!((done.samples, done.reached), (32, Reached::Samples));
        assert!(done.predicted.unwrap().cost_estimate.samples.is_nan() && !done.film.error(rect).unwrap().is_known());
        let paths = AtomicU64::new(0);
        struct Paths<'a>(&'a AtomicU64);
        impl Watch for Paths<'_> {
            fn work(&self, counters: &Counters) {
                self.0.fetch_add(counters.paths, Ordering::Relaxed);
            }
        }
        // A millionth of a second each.
        let clock = || 1e-6 * paths.load(Ordering::Relaxed) as f64;
        let limits = limits(Limits::ANY_SAMPLES, Some(0.1), adaptivity);
        let done = render_within(prepared, rect, &limits, None, &clock, &Paths(&paths)).unwrap();
        assert_eq!(done.reached, Reached::Time);
    }
}

/// A pilot goes on until it finds light, and knows an error then.
#[test]
fn a_pilot_that_finds_light_late_knows_no_error_before() {
    // Seen from afar the lamp fills 10⁻⁵ of the sky, and is found by chance.
    let lamp = json!({"material": "black", "emission": {"radiance": 1},
        "shape": {"type": "sphere", "center_m": [0, 2, 0], "radius_m": 0.006}});
    let prepared = floor(&json!([lamp]), &json!([]), &json!({"light_sampling": "bsdf", "max_depth": 2}));
    let mut pilot = Pilot::new(&prepared, prepared.whole(None).rect, None, None).unwrap();
    (2..=18).for_each(|step| pilot.advance(1 << step, &|| 0.0, &|_| ()));
    let points = pilot.points();
    assert!(points[0].relative_rmse.is_infinite() && !points[0].reaches(1.0));
    let last = points.last().unwrap();
    assert!(last.relative_rmse.is_finite() && last.uncertainty.is_finite() && !pilot.found_no_light());
    assert!(pilot.cost_estimate(0.1).samples.is_finite());
}
