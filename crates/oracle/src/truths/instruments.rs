//! Cameras as scenes state them, pixel filters, and meshes from files.

use serde_json::{Value, json};

use std::f64::consts::PI;

use super::{
    Truth,
    scene::{Scene, black, disk, lambert, parallelogram},
};
use crate::quadrature::interval;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = filters();
    list.extend(edges());
    list.extend(cameras());
    list.extend(meshes());
    list
}

/// One pixel of side 1 m before a lamp that begins right of its middle.
fn filters() -> Vec<Truth> {
    let make = |name: &str, filter: Value, edge: f64, value: f64, formula: &str| {
        let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1.0)
            .lamp(parallelogram([edge, -10.0, 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]), black(), 1.0, "front")
            .set("film", "filter", filter)
            .film(1, 1)
            .spp(1 << 20);
        Truth::new(name, &scene, value, formula)
            .because("The pixel shows the share of its filter that lies over the lamp, along one axis.")
            .or_else("a box", (0.5 - edge).clamp(0.0, 1.0))
            .sees(0.01)
    };
    // The integral of a tent of radius 1 from x: (1 − x)²/2.
    let tent = |x: f64, r: f64| 0.5 * (1.0 - x / r).powi(2);
    // A Gaussian of standard deviation 1 cut at 3, from x, by quadrature.
    let density = |t: f64| (-0.5 * t * t).exp();
    let gaussian = move |x: f64, sigma: f64| {
        interval(density, x / sigma, 3.0, 1e-12).value / interval(density, -3.0, 3.0, 1e-12).value
    };
    let by_grid = move |x: f64, sigma: f64| {
        let sum = |from: f64| {
            (0..60_000).map(|i| from + (3.0 - from) * (f64::from(i) + 0.5) / 60_000.0).map(density).sum::<f64>()
                * (3.0 - from)
        };
        sum(x / sigma) / sum(-3.0)
    };
    let named = |kind: &str, key: &str, width: f64| json!({ "type": kind, key: width });
    // The integral of Mitchell's filter from x to its end at 2, and that of its magnitude if it changes its sign at 1 only.
    let catmull_rom = |x: f64| mitchell_from(x, 0.0, 0.5);
    let of_magnitude = |x: f64, from: &dyn Fn(f64) -> f64| {
        let half = from(0.0) - 2.0 * from(1.0);
        (if x < 1.0 { from(x) - 2.0 * from(1.0) } else { -from(x) }) / (2.0 * half)
    };
    let third = 1.0 / 3.0;
    let mitchell = move |x: f64| mitchell_from(x, third, third);
    let by_steps = |x: f64, b: f64, c: f64| {
        interval(|t| mitchell_at(t, b, c), x, x.max(1.0), 1e-12).value
            + interval(|t| mitchell_at(t, b, c), x.max(1.0), 2.0, 1e-12).value
    };
    vec![
        make(
            "filter-mitchell",
            json!({ "type": "mitchell" }),
            0.3,
            mitchell(0.3),
            "∫ of (7t³ − 12t² + 16/3)/6 to 1, and of (−7t³/3 + 12t² − 20t + 32/3)/6 from 1 to 2",
        )
        .confirmed("quadrature", 1e-9, move || by_steps(0.3, third, third))
        .or_else("a Gaussian of σ ½", gaussian(0.3, 0.5))
        .or_else("the B-spline", mitchell_from(0.3, 1.0, 0.0)),
        make(
            "filter-catmull-rom",
            json!({ "type": "mitchell", "b": 0, "c": 0.5 }),
            -1.2,
            1.0 - catmull_rom(1.2),
            "1 − ∫ of (−3t³ + 15t² − 24t + 12)/6 from 1.2 to 2, which is negative",
        )
        .confirmed("quadrature", 1e-9, move || 1.0 - by_steps(1.2, 0.0, 0.5))
        .or_else("its magnitude", 1.0 - of_magnitude(1.2, &catmull_rom))
        .or_else("cut where it is negative", 1.0),
        make(
            "filter-mitchell-of-one-pixel",
            json!({ "type": "mitchell", "radius_px": 1, "b": 0.25, "c": 0.75 }),
            0.2,
            mitchell_from(0.4, 0.25, 0.75),
            "that of a radius of 2, from 2 · 0.2",
        )
        .confirmed("quadrature", 1e-9, move || by_steps(0.4, 0.25, 0.75))
        .or_else("a radius of 2", mitchell_from(0.2, 0.25, 0.75))
        .or_else("b and c exchanged", mitchell_from(0.4, 0.75, 0.25)),
        make(
            "filter-lanczos",
            json!({ "type": "lanczos" }),
            0.6,
            lanczos(0.6, 3.0, 3) / lanczos(-3.0, 3.0, 3),
            "∫ of sinc(t) sinc(t/3) from 0.6 to 3, over that from −3 to 3",
        )
        .confirmed("midpoints", 1e-6, || lanczos_by_midpoints(0.6, 3.0) / lanczos_by_midpoints(-3.0, 3.0))
        .or_else("two lobes", lanczos(0.6, 2.0, 2) / lanczos(-2.0, 2.0, 2))
        .or_else("not windowed", lanczos(0.6, 3.0, u32::MAX) / lanczos(-3.0, 3.0, u32::MAX)),
        make("filter-tent", named("tent", "radius_px", 1.0), 0.3, tent(0.3, 1.0), "(1 − 0.3)²/2")
            .or_else("a tent of radius ½", tent(0.3, 0.5)),
        make("filter-tent-of-two-pixels", named("tent", "radius_px", 2.0), 0.7, tent(0.7, 2.0), "(1 − 0.35)²/2")
            .or_else("a tent of radius 1", tent(0.7, 1.0)),
        make(
            "filter-gaussian",
            named("gaussian", "sigma_px", 0.5),
            0.6,
            gaussian(0.6, 0.5),
            "(Φ(3) − Φ(1.2))/(Φ(3) − Φ(−3))",
        )
        .confirmed("midpoints", 1e-6, move || by_grid(0.6, 0.5))
        .or_else("variance taken for standard deviation", gaussian(0.6, 0.5_f64.sqrt())),
        make(
            "filter-gaussian-to-its-cut",
            named("gaussian", "sigma_px", 0.5),
            1.6,
            0.0,
            "0: beyond three standard deviations",
        )
        .or_else("not cut", 6.87e-4),
        make("filter-box", json!({ "type": "box" }), 0.3, 0.2, "½ − 0.3").or_else("a tent", tent(0.3, 1.0)),
    ]
    .into_iter()
    .map(|truth| {
        let first = usize::from(truth.name == "filter-box");
        truth.changed(move |mut expectation| {
            expectation.mistakes.drain(..first);
            let value = expectation.value;
            expectation.mistakes.retain(|mistake| (mistake.value - value).abs() > 1e-4);
            expectation
        })
    })
    .collect()
}

/// Mitchell's and Netravali's cubic at a distance.
fn mitchell_at(t: f64, b: f64, c: f64) -> f64 {
    let t = t.abs();
    let near = (12.0 - 9.0 * b - 6.0 * c) * t.powi(3) + (12.0 * b + 6.0 * c - 18.0) * t * t + 6.0 - 2.0 * b;
    let far =
        (-b - 6.0 * c) * t.powi(3) + (6.0 * b + 30.0 * c) * t * t - (12.0 * b + 48.0 * c) * t + 8.0 * b + 24.0 * c;
    (if t < 1.0 { near } else { far }) / 6.0
}

/// Its integral from a distance to its end at 2, term by term.
fn mitchell_from(x: f64, b: f64, c: f64) -> f64 {
    let near =
        |t: f64| (3.0 - 2.25 * b - 1.5 * c) * t.powi(4) + (4.0 * b + 2.0 * c - 6.0) * t.powi(3) + (6.0 - 2.0 * b) * t;
    let far = |t: f64| {
        (-0.25 * b - 1.5 * c) * t.powi(4) + (2.0 * b + 10.0 * c) * t.powi(3) - (6.0 * b + 24.0 * c) * t * t
            + (8.0 * b + 24.0 * c) * t
    };
    let of_near = if x < 1.0 { near(1.0) - near(x) } else { 0.0 };
    (of_near + far(2.0) - far(x.max(1.0))) / 6.0
}

/// Lanczos's filter at a distance, with a window of so many pixels.
fn lanczos_at(t: f64, window: u32) -> f64 {
    let sinc = |t: f64| if t == 0.0 { 1.0 } else { (PI * t).sin() / (PI * t) };
    sinc(t) * sinc(t / f64::from(window))
}

/// Its integral from one place to another, by quadrature.
fn lanczos(from: f64, to: f64, window: u32) -> f64 {
    interval(|t| lanczos_at(t, window), from, to, 1e-12).value
}

/// The same of a window of 3, by midpoints.
fn lanczos_by_midpoints(from: f64, to: f64) -> f64 {
    let step = (to - from) / 60_000.0;
    (0..60_000).map(|i| from + step * (f64::from(i) + 0.5)).map(|t| lanczos_at(t, 3)).sum::<f64>() * step
}

/// Films whose pixels get no light from beyond them, before a lamp that begins right of the middle and goes on beyond all edges. Pixels have a side of 1 m.
fn edges() -> Vec<Truth> {
    let make = |name: &str, width: u32, filter: Value, edge: f64, value: f64, formula: &str| {
        let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1.0)
            .lamp(parallelogram([edge, -10.0, 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]), black(), 1.0, "front")
            .set("film", "filter", filter)
            .set("film", "sample_border", json!(false))
            .film(width, 1)
            .spp(1 << 20);
        Truth::new(name, &scene, value, formula)
            .because("What lies on the film of a pixel's filter is all of it. The pixel shows the share of that which lies over the lamp.")
            .sees(0.01)
    };
    // The integral of a tent of radius 2 from 0 to x.
    let tent = |x: f64| x - 0.25 * x * x;
    // Of a Gaussian of standard deviation ½, from a to b: by quadrature, or by midpoints.
    let density = |x: f64| (-2.0 * x * x).exp();
    let exact = move |a: f64, b: f64| interval(density, a, b, 1e-12).value;
    let midpoints = move |a: f64, b: f64| {
        (0..60_000).map(|i| a + (b - a) * (f64::from(i) + 0.5) / 60_000.0).map(density).sum::<f64>() * (b - a)
            / 60_000.0
    };
    // The lamp begins 0.4 m left of the middle of the right pixel, and 0.6 m right of that of the left one.
    fn both(share: impl Fn(f64, f64) -> f64) -> f64 {
        0.5 * (share(-0.4, 0.5) / share(-1.5, 0.5) + share(0.6, 1.5) / share(-0.5, 1.5))
    }
    let beyond = 0.5 * (exact(-0.4, 1.5) + exact(0.6, 1.5)) / exact(-1.5, 1.5);
    vec![
        make(
            "filter-without-a-border",
            1,
            json!({ "type": "tent", "radius_px": 2 }),
            0.3,
            (tent(0.5) - tent(0.3)) / (2.0 * tent(0.5)),
            "(T(½) − T(0.3))/2T(½) with T(x) = x − x²/4",
        )
        .or_else("light from beyond the film", 0.5 * (1.0_f64 - 0.15).powi(2))
        .or_else("a box", 0.2)
        .or_else("what lies beyond the film is black", 0.5 * (tent(0.5) - tent(0.3))),
        make(
            "filter-of-two-pixels-without-a-border",
            2,
            json!({ "type": "gaussian", "sigma_px": 0.5 }),
            0.1,
            both(exact),
            "the mean of G(−0.4, ½)/G(−1½, ½) and G(0.6, 1½)/G(−½, 1½), G the integral of exp(−2x²)",
        )
        .confirmed("midpoints", 1e-6, move || both(midpoints))
        .or_else("light from beyond the film", beyond),
        make(
            "filter-lanczos-without-a-border",
            2,
            json!({ "type": "lanczos", "lobes": 2 }),
            0.1,
            both(|a, b| lanczos(a, b, 2)),
            "the mean of L(−0.4, ½)/L(−1½, ½) and L(0.6, 1½)/L(−½, 1½), L the integral of sinc(x) sinc(x/2)",
        )
        .confirmed("midpoints", 1e-6, move || {
            both(|a, b| {
                (0..60_000)
                    .map(|i| a + (b - a) * (f64::from(i) + 0.5) / 60_000.0)
                    .map(|t| lanczos_at(t, 2))
                    .sum::<f64>()
                    * (b - a)
                    / 60_000.0
            })
        })
        .or_else(
            "light from beyond the film",
            0.5 * (lanczos(-0.4, 2.0, 2) + lanczos(0.6, 2.0, 2)) / lanczos(-2.0, 2.0, 2),
        )
        .or_else("weights of the whole filter", {
            let share = |a: f64, b: f64, from: f64, to: f64| {
                let magnitude = |a: f64, b: f64| {
                    let near = lanczos(a.max(-1.0), b.min(1.0), 2);
                    near - (lanczos(a, b, 2) - near)
                };
                lanczos(a, b, 2) / magnitude(from, to) * (magnitude(-2.0, 2.0) / lanczos(-2.0, 2.0, 2))
            };
            0.5 * (share(-0.4, 0.5, -1.5, 0.5) + share(0.6, 1.5, -0.5, 1.5))
        }),
    ]
}

/// A square of side 0.4 m at a distance of 1 m, its corner in the middle of the picture.
fn cameras() -> Vec<Truth> {
    let window = || {
        json!({
            "shape": parallelogram([-0.4, -0.4, -1.0], [0.4, 0.0, 0.0], [0.0, 0.4, 0.0]), "material": black(),
            "emission": { "radiance": 1, "sides": "front" },
        })
    };
    let view = |further: Value| {
        let mut camera = json!({ "type": "perspective", "position_m": [0, 0, 0], "direction": [0, 0, -3] });
        for (key, value) in further.as_object().into_iter().flatten() {
            camera[key] = value.clone();
        }
        Scene::camera(camera)
    };
    let truth = |name: &str, scene: Scene, value: f64, formula: &str| {
        Truth::new(name, &scene, value, formula)
            .because("At distance 1 the picture is as wide and high as twice the tangents of half the angles of view; pixels are square.")
            .or_else("the field of view doubled", 0.25 * value)
            .sees(0.01)
    };
    let fov = 2.0 * 0.5_f64.atan().to_degrees();
    // A picture of 2 × 1 at distance 1, or of 1 × ½.
    let wide = |scene: Scene| scene.thing(window()).film(64, 32).spp(1024);
    // A 50 mm lens at f/2 in focus at 2 m: aperture of radius 12.5 mm; its sensor lies at f z/(z − f).
    let (f, z) = (0.05, 2.0);
    let image = f * z / (z - f);
    let sensor_m = 0.04;
    let half = 0.5 * sensor_m / image;
    let blurred = |radius: f64| {
        Scene::camera(json!({
            "type": "perspective", "position_m": [0, 0, 0], "direction": [0, 0, -1], "sensor_height_m": 1e-7, "focal_length_m": f,
            "lens": { "f_number": 2, "focus_distance_m": z },
        }))
        .lamp(disk([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], radius), black(), 1.0, "front")
        .spp(1024)
    };
    let confusion = 0.5 * f / 2.0 * (5.0 - z) / z;
    vec![
        truth("camera-by-its-direction", wide(view(json!({ "vertical_fov_deg": fov }))), 0.08, "0.16/2"),
        truth("camera-by-its-horizontal-angle", wide(view(json!({ "horizontal_fov_deg": fov }))), 0.2, "0.4 · 0.25/½: the picture cuts the square")
            .or_else("taken for the vertical angle", 0.08),
        truth("camera-by-the-height-of-its-sensor", wide(view(json!({ "sensor_height_m": 0.024, "focal_length_m": 0.024 }))), 0.08, "0.16/2")
            .or_else("taken for its width", 0.32),
        truth("camera-by-the-width-of-its-sensor", wide(view(json!({ "sensor_width_m": 0.024, "focal_length_m": 0.024 }))), 0.2, "0.4 · 0.25/½: the picture cuts the square")
            .or_else("taken for its height", 0.08),
        {
            // From x = −1 to x = 1 m while the shutter is open, past a lamp from 0.25 to 0.75 m.
            let scene = Scene::camera(json!({
                "type": "perspective", "position_m": [-1, 0, 0], "direction": [0, 0, -1], "vertical_fov_deg": 1e-4, "shutter_s": [0, 2],
                "keyframes": [{ "time_s": 0 }, { "time_s": 2, "transform": [{ "translate_m": [2, 0, 0] }] }],
            }))
            .lamp(parallelogram([0.25, -1.0, -1.0], [0.5, 0.0, 0.0], [0.0, 2.0, 0.0]), black(), 1.0, "front")
            .film(16, 16)
            .spp(1024);
            Truth::new("camera-that-moves-past-a-lamp", &scene, 0.25, "0.5/2")
                .because("A camera that moves at 1 m/s for two seconds is before a lamp half a metre wide for a quarter of the time.")
                .or_else("it stands still", 0.0)
                .or_else("it stands in the middle", 1.0)
                .claims(super::Claim::Motion)
                .sees(0.01)
        },
        truth(
            "camera-turned-by-its-up",
            wide(view(json!({ "vertical_fov_deg": fov, "up": [1, 0, 0] }))),
            0.08,
            "0.16/2",
        ),
        Truth::new(
            "camera-orthographic-by-its-direction",
            &Scene::camera(json!({ "type": "orthographic", "position_m": [0, 0, 1], "direction": [0, 0, -1], "height_m": 1 }))
                .thing(window())
                .film(32, 32)
                .spp(1024),
            0.16,
            "0.4²",
        )
        .because("Parallel rays show a square of side 0.4 m in a picture of 1 m² in its size.")
        .or_else("half as high", 0.04)
        .sees(0.01),
        {
            let scene = Scene::camera(json!({
                "type": "perspective", "position_m": [0, 0, 0], "direction": [0, 0, -1], "sensor_height_m": sensor_m, "focal_length_m": f,
                "lens": { "radius_m": 0.001, "focus_distance_m": z },
            }))
            .thing(json!({
                "shape": parallelogram([-0.4, -0.4, -z], [0.4, 0.0, 0.0], [0.0, 0.4, 0.0]), "material": black(),
                "emission": { "radiance": 1, "sides": "front" },
            }))
            .film(32, 32)
            .spp(1024);
            let share = |half: f64| (0.4 / (2.0 * half * z)).powi(2);
            Truth::new("camera-that-focuses-near", &scene, share(half), "(0.4 (f z/(z − f))/(sensor · z))²")
                .because("With a lens the sensor is where the image of the plane in focus is formed, f z/(z − f), not at f.")
                .or_else("the sensor at the focal length", share(0.5 * sensor_m / f))
                .sees(0.01)
        },
        Truth::new("camera-by-its-f-number", &blurred(0.01), (0.01 / confusion).powi(2), "(s/c)², c = a|z − z_f|/z_f, a = f/(2N)")
            .because("The aperture's diameter is the focal length over the f-number; rays from all of it fill a circle of radius a|z − z_f|/z_f.")
            .or_else("the f-number taken for that of the radius", (0.005 / confusion).powi(2))
            .sees(0.02),
    ]
}

/// Squares from files, lit from one side.
fn meshes() -> Vec<Truth> {
    let lit = |shape: Value, further: Value| {
        let mut object = json!({ "shape": shape, "material": lambert(0.8) });
        for (key, value) in further.as_object().into_iter().flatten() {
            object[key] = value.clone();
        }
        Scene::orthographic([0.5, 0.5, 2.0], [0.5, 0.5, 0.0], 0.2)
            .thing(object)
            .directional_light([-0.6, 0.0, -0.8], PI)
            .film(16, 16)
            .spp(64)
    };
    // Two groups: a square at z = 0, its normals tilted toward +x, and one above it that is turned away from the light.
    let obj = "o low\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0.6 0 0.8\nf 1//1 2//1 3//1 4//1\n\
               o high\nv 0 0 0.5\nv 1 0 0.5\nv 1 1 0.5\nv 0 1 0.5\nvn -0.6 0 0.8\nf 5//2 6//2 7//2 8//2\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    let of = |file: &str, group: Option<&str>, shading: &str| {
        let mut shape = json!({ "type": "mesh", "file": file, "shading": shading });
        if let Some(group) = group {
            shape["group"] = json!(group);
        }
        shape
    };
    let truth = |name: &str, scene: Scene, cosine: f64| {
        Truth::new(name, &scene, 0.8 * cosine, format!("ρ n·l = 0.8 · {cosine}"))
            .because("A Lambert surface in parallel light of irradiance π shows ρ n·l, n the normal that its vertices have, or its own.")
            .sees(1e-3)
    };
    let light = [0.6, 0.8];
    vec![
        truth("mesh-of-an-obj-file-low", lit(of("squares.obj", Some("low"), "auto"), json!({})).file("squares.obj", obj.into()), 1.0)
            .or_else("its own normal", 0.8 * light[1])
            .or_else("the other group", 0.8 * 0.28),
        truth("mesh-of-an-obj-file-high", lit(of("squares.obj", None, "auto"), json!({})).file("squares.obj", obj.into()), 0.28)
            .or_else("its own normal", 0.8 * light[1])
            .or_else("the lower square", 0.8),
        truth("mesh-of-an-obj-file-flat", lit(of("squares.obj", Some("low"), "flat"), json!({})).file("squares.obj", obj.into()), light[1])
            .or_else("the normals of its vertices", 0.8),
        truth("mesh-of-a-ply-file", lit(of("square.ply", None, "smooth"), json!({})).file("square.ply", ply.into()), light[1])
            .or_else("nothing", 0.0),
        truth(
            "mesh-of-a-ply-file-turned",
            lit(
                of("square.ply", None, "auto"),
                json!({ "transform": [{ "translate_m": [-0.5, 0, 0] }, { "rotate": { "axis": [0, 1, 0], "angle_deg": 30 } }, { "translate_m": [0.5, 0, 0] }] }),
            )
            .file("square.ply", ply.into()),
            0.6 * 0.5 + 0.8 * 0.75_f64.sqrt(),
        )
        .or_else("not turned", 0.8 * light[1])
        .or_else("turned the other way", 0.8 * (0.8 * 0.75_f64.sqrt() - 0.3)),
    ]
}
