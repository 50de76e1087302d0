//! Filter and wrapping, and where images lie on shapes of every kind.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};

use super::shown::{Shown, Wrap, patches};
use super::{BECAUSE, HOW, flat, matte, square, view};
use crate::truths::Truth;
use crate::truths::scene::{Scene, sphere};

pub(super) fn filters() -> Vec<Truth> {
    let (u, v) = ([0.2, 0.6], [0.25, 0.65]);
    let make = |name: &str, bilinear: bool| {
        let image = Shown { bilinear, ..patches() };
        let file = "patches.hdr";
        let scene = view([0.4, 0.45], 0.4)
            .thing(json!({ "shape": square(), "material": matte(image.albedo(file)) }))
            .file(file, image.hdr());
        let half = [0.5 / 4.0, 0.5 / 3.0];
        let shifted = image.mean([u[0] + half[0], u[1] + half[0]], [v[0] + half[1], v[1] + half[1]]);
        let other = Shown { bilinear: !bilinear, ..image.clone() };
        flat(name, &scene, &image, u, v)
            .or_else("half a texel off", shifted)
            .or_else("upside down", image.mean(u, [1.0 - v[1], 1.0 - v[0]]))
            .or_else("left and right exchanged", image.mean([1.0 - u[1], 1.0 - u[0]], v))
            .or_else("the other filter", other.mean(u, v))
    };
    vec![make("texture-bilinear", true), make("texture-nearest", false)]
}

pub(super) fn wraps() -> Vec<Truth> {
    let file = "patches.hdr";
    // The surface's coordinates times 3 less 1.2: the picture shows u and v from −0.45 to 0.9 and 0.6 to 1.95.
    let make = |name: &str, wrap: [Wrap; 2], others: [Wrap; 2]| {
        let image = Shown { wrap, ..patches() };
        let mut albedo = image.albedo(file);
        (albedo["uv_scale"], albedo["uv_offset"]) = (json!([3, 3]), json!([-1.2, -1.2]));
        let scene = view([0.475, 0.825], 0.45)
            .thing(json!({ "shape": square(), "material": matte(albedo) }))
            .file(file, image.hdr());
        let to = |x: f64| 3.0 * x - 1.2;
        let (u, v) = ([to(0.25), to(0.7)], [to(0.6), to(1.05).min(to(1.0))]);
        (image, scene, u, v, name.to_owned(), others)
    };
    [
        make("texture-repeated", [Wrap::Repeat; 2], [Wrap::Clamp; 2]),
        make("texture-mirrored-at-its-edges", [Wrap::Mirror; 2], [Wrap::Repeat; 2]),
        make("texture-mirrored-along-u-clamped-along-v", [Wrap::Mirror, Wrap::Clamp], [Wrap::Clamp, Wrap::Mirror]),
        make("texture-clamped-along-u-repeated-along-v", [Wrap::Clamp, Wrap::Repeat], [Wrap::Repeat, Wrap::Clamp]),
    ]
    .into_iter()
    .map(|(image, scene, u, v, name, others)| {
        // A ninth of the picture lies beyond the square, above it, and shows the sky, 1.
        let beyond = 0.05 / 0.45;
        let with = |wrap: [Wrap; 2]| {
            let image = Shown { wrap, ..image.clone() };
            (1.0 - beyond) * image.mean(u, v) + beyond
        };
        let own = image.clone();
        Truth::new(
            &name,
            &scene,
            with(image.wrap),
            "8/9 of the mean of the endless image over its part in view, and 1/9 of the sky",
        )
        .because(BECAUSE)
        .confirmed(HOW, 1e-5, move || {
            let part = own.over(1000, |a, b| [u[0] + a * (u[1] - u[0]), v[0] + b * (v[1] - v[0])]);
            (1.0 - beyond) * part + beyond
        })
        .or_else("another wrapping", with(others))
        .sees(0.005)
    })
    .collect()
}

/// The mean of an image over a picture by Gauss's rule in small panels, without the corners of the interpolation: 1e-6.
fn round_truth(
    name: &str,
    scene: &Scene,
    image: &Shown,
    uv: fn(f64, f64) -> [f64; 2],
    other: fn(f64, f64) -> [f64; 2],
) -> Truth {
    let (own, again) = (image.clone(), image.clone());
    let value = own.over(500, uv);
    Truth::new(name, scene, value, "mean over the picture of the image at the texture coordinates of each place")
        .because(
            "Each place of a convex Lambert body under a sky of radiance 1 shows its albedo. The texture coordinates of the place that a \
             parallel ray meets follow from the shape.",
        )
        .confirmed("the same places by other functions, on another grid", 1e-4, move || again.over(1111, other))
        .or_else("upside down", image.over(100, |a, b| [uv(a, b)[0], 1.0 - uv(a, b)[1]]))
        .or_else("left and right exchanged", image.over(100, |a, b| [1.0 - uv(a, b)[0], uv(a, b)[1]]))
        .or_else("a quarter of a turn off", image.over(100, |a, b| [uv(a, b)[0] + 0.25, uv(a, b)[1]]))
        .sees(0.01)
}

pub(super) fn round() -> Vec<Truth> {
    let image = patches();
    let file = "patches.hdr";
    let with = |shape: Value, eye: [f64; 3], at: [f64; 3], height: f64| {
        Scene::orthographic(eye, at, height)
            .sky(1.0)
            .film(16, 16)
            .spp(1024)
            .thing(json!({ "shape": shape, "material": matte(image.albedo(file)) }))
            .file(file, image.hdr())
    };
    // The ball is seen along −z, x to the right: x from 0.1 to 0.7 and y from −0.1 to 0.5.
    let ball = with(sphere([0.0; 3], 1.0), [0.4, 0.2, 3.0], [0.4, 0.2, 0.0], 0.6);
    let on_ball = |a: f64, b: f64| {
        let (x, y) = (0.1 + 0.6 * a, -0.1 + 0.6 * b);
        let z = (1.0 - x * x - y * y).sqrt();
        [0.5 + x.atan2(z) / TAU, 1.0 - y.acos() / PI]
    };
    let on_ball_again = |a: f64, b: f64| {
        let (x, y) = (0.1 + 0.6 * a, -0.1 + 0.6 * b);
        [0.5 + (x / (1.0 - y * y).sqrt()).asin() / TAU, 0.5 + y.asin() / PI]
    };
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = json!({
        "type": "mesh", "vertices_m": corners, "triangles": [[0, 1, 2], [0, 2, 3]],
        "uvs": [[0.1, 0.2], [0.9, 0.2], [0.9, 1.0], [0.1, 1.0]],
    });
    let meshed = with(mesh, [0.5, 0.4, 2.0], [0.5, 0.4, 0.0], 0.5);
    let to = |x: f64| 0.1 + 0.8 * x;
    vec![
        round_truth("texture-on-a-sphere", &ball, &image, on_ball, on_ball_again),
        flat("texture-on-a-mesh", &meshed, &image, [to(0.25), to(0.75)], [0.2 + 0.8 * 0.15, 0.2 + 0.8 * 0.65])
            .or_else("the mesh's own coordinates left out", image.mean([0.25, 0.75], [0.15, 0.65])),
    ]
}

pub(super) fn placed() -> Vec<Truth> {
    let image = patches();
    let file = "patches.hdr";
    // The square becomes x from −0.8 to 0, y from 0 to 1.6, mirrored: u = −x/0.8, v = y/1.6.
    let material = matte(image.albedo(file));
    let step = json!([{ "scale": [-0.8, 1.6, 1] }]);
    let (u, v) = ([0.375, 0.875], [0.25, 0.5]);
    let own = view([-0.5, 0.6], 0.4)
        .thing(json!({ "shape": square(), "material": material, "transform": step }))
        .file(file, image.hdr());
    let by_instance = view([-0.5, 0.6], 0.4)
        .set("groups", "sheet", json!({ "objects": [{ "shape": square(), "material": material }] }))
        .file(file, image.hdr());
    let placed = json!([{ "group": "sheet", "transform": step }]);
    let truth = |name: &str, scene: &Scene| {
        flat(name, scene, &image, u, v)
            .or_else("the image not mirrored", image.mean([1.0 - u[1], 1.0 - u[0]], v))
            .or_else("the image not stretched", image.mean([0.3, 0.7], [0.4, 0.8]))
    };
    vec![
        truth("texture-mirrored-and-stretched", &own),
        truth("texture-of-a-mirrored-and-stretched-instance", &by_instance.whole("instances", placed)),
    ]
}
