//! Images over surfaces: their filter, their wrapping, where they lie on shapes of every kind, what their channels mean.
//!
//! An image as the albedo of a convex Lambert body under a sky of radiance 1 is seen as it is: each place shows its own albedo.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};

use super::{
    Truth,
    scene::{Scene, black, grey_hdr, lambert, parallelogram, radiance_hdr, sphere},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = filters();
    list.extend(wraps());
    list.extend(round());
    list.extend(placed());
    list.extend(channels());
    list.extend(numbers());
    list.extend(masks());
    list.push(emission());
    list.extend(patterns());
    list
}

/// Chequerboards and even changes of a colour, on a plate under a sky of radiance 1: each place shows its albedo.
fn patterns() -> Vec<Truth> {
    // Three by three fields are seen of a board on [0, 1]², five of them the first.
    let plate = |reflectance: Value| {
        let shape = json!({ "type": "parallelogram", "origin_m": [-1, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0] });
        Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 2.0)
            .thing(json!({ "shape": shape, "material": { "type": "lambert", "reflectance": reflectance } }))
            .sky(1.0)
            .film(48, 48)
            .spp(64)
    };
    let board = plate(json!({ "type": "checker", "first": 0.8, "second": 0.2, "uv_scale": [1.5, 1.5] }));
    let fields = |first: f64| (first * 0.8 + (9.0 - first) * 0.2) / 9.0;
    // Of a grid of places in fields of a third.
    let by_places = || {
        let field = |k: u32| 3 * (2 * k + 1) / 60;
        let shown = |i: u32, j: u32| if (field(i) + field(j)).is_multiple_of(2) { 0.8 } else { 0.2 };
        (0..30).flat_map(|i| (0..30).map(move |j| (i, j))).map(|(i, j)| shown(i, j)).sum::<f64>() / 900.0
    };
    // A shift by half a unit of the board along u exchanges its fields, along v as well.
    let shifted =
        plate(json!({ "type": "checker", "first": 0.8, "second": 0.2, "uv_scale": [1.5, 1.5], "uv_offset": [0.5, 0] }));
    let ramp = |along: &str| {
        let (scale, offset) = if along == "u" { ([2, 1], [-0.25, 0.5]) } else { ([1, 2], [0.5, -0.25]) };
        plate(json!({
            "type": "gradient", "from": 0.2, "to": [0.8, 0.8, 0.8], "along": along, "uv_scale": scale,
            "uv_offset": offset,
        }))
    };
    // 2t − ¼ reaches 0 at ⅛ and 1 at ⅝; of the other coordinate t + ½ reaches 1 at ½.
    let mean = 0.125 * 0.2 + 0.5 * 0.5 + 0.375 * 0.8;
    let ramp_by_places = || {
        let at = |k: u32| ((f64::from(k) + 0.5) / 4000.0 * 2.0 - 0.25).clamp(0.0, 1.0);
        (0..4000).map(|k| 0.2 + 0.6 * at(k)).sum::<f64>() / 4000.0
    };
    let because = "A plane under an even sky shows its albedo, and the picture the mean of it.";
    let mut list = vec![
        Truth::new("chequerboard-of-nine-fields", &board, fields(5.0), "(5 · 0.8 + 4 · 0.2)/9")
            .because(because)
            .confirmed("the fields of 900 places", 1e-12, by_places)
            .or_else("colours exchanged", fields(4.0))
            .sees(2e-3),
        Truth::new("chequerboard-shifted-by-a-field", &shifted, fields(4.0), "(4 · 0.8 + 5 · 0.2)/9")
            .because(because)
            .confirmed("what the nine fields leave of both colours", 1e-12, move || 1.0 - by_places())
            .or_else("not shifted", fields(5.0))
            .sees(2e-3),
    ];
    for along in ["u", "v"] {
        list.push(
            Truth::new(
                format!("gradient-along-{along}"),
                &ramp(along),
                mean,
                "⅛ · 0.2 + ½ · 0.5 + ⅜ · 0.8: it changes between ⅛ and ⅝",
            )
            .because(because)
            .confirmed("4000 midpoints", 1e-6, ramp_by_places)
            .or_else("ends exchanged", 1.0 - mean)
            .or_else("not shifted", 0.5 * 0.5 + 0.5 * 0.8)
            .or_else("along the other coordinate", 0.5 * 0.65 + 0.5 * 0.8)
            .sees(2e-3),
        );
    }
    list
}

/// What an image continues as beyond its edges.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

impl Wrap {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Repeat => "repeat",
            Self::Mirror => "mirror",
            Self::Clamp => "clamp",
        }
    }

    /// The texel that stands at place `i` of an endless row.
    fn texel(self, i: i64, n: i64) -> usize {
        let at = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Mirror => (i.rem_euclid(2 * n)).min(2 * n - 1 - i.rem_euclid(2 * n)),
            Self::Clamp => i.clamp(0, n - 1),
        };
        at as usize
    }
}

/// An image of numbers, rows from the top, as a surface shows it.
#[derive(Clone)]
pub(super) struct Shown {
    pub(super) width: usize,
    pub(super) texels: Vec<f64>,
    pub(super) wrap: [Wrap; 2],
    pub(super) bilinear: bool,
}

/// ∫ of the tent function max(0, 1 − |x|) from −∞.
fn under_tent(x: f64) -> f64 {
    match x {
        _ if x <= -1.0 => 0.0,
        _ if x <= 0.0 => 0.5 * (1.0 + x).powi(2),
        _ if x <= 1.0 => 1.0 - 0.5 * (1.0 - x).powi(2),
        _ => 1.0,
    }
}

impl Shown {
    pub(super) fn new(width: usize, texels: &[f64]) -> Self {
        Self { width, texels: texels.to_vec(), wrap: [Wrap::Repeat; 2], bilinear: true }
    }

    fn height(&self) -> usize {
        self.texels.len() / self.width
    }

    /// The texel in a column and a row counted from below.
    fn texel(&self, column: i64, row: i64) -> f64 {
        let (w, h) = (self.width, self.height());
        let column = self.wrap[0].texel(column, w as i64);
        let row = self.wrap[1].texel(row, h as i64);
        self.texels[(h - 1 - row) * w + column]
    }

    /// The mean over a rectangle of texture coordinates: each texel weighs as the integral of its tent, or its box, over it.
    fn mean(&self, u: [f64; 2], v: [f64; 2]) -> f64 {
        let weights = |from: f64, to: f64, count: usize| -> Vec<(i64, f64)> {
            let (from, to) = (from * count as f64, to * count as f64);
            (from.floor() as i64 - 2..=to.ceil() as i64 + 2)
                .map(|i| {
                    let centre = i as f64 + 0.5;
                    let part = if self.bilinear {
                        under_tent(to - centre) - under_tent(from - centre)
                    } else {
                        (to.min(centre + 0.5) - from.max(centre - 0.5)).max(0.0)
                    };
                    (i, part / (to - from))
                })
                .collect()
        };
        let (columns, rows) = (weights(u[0], u[1], self.width), weights(v[0], v[1], self.height()));
        let of_row = |j: i64| columns.iter().map(|&(i, weight)| weight * self.texel(i, j)).sum::<f64>();
        rows.iter().map(|&(j, weight)| weight * of_row(j)).sum()
    }

    /// The value at a place, by interpolation between the four centres around it.
    pub(super) fn at(&self, u: f64, v: f64) -> f64 {
        let (x, y) = (u * self.width as f64, v * self.height() as f64);
        if !self.bilinear {
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (i, j, s, t) = (x.floor() as i64, y.floor() as i64, x - x.floor(), y - y.floor());
        let row = |j: i64| (1.0 - s) * self.texel(i, j) + s * self.texel(i + 1, j);
        (1.0 - t) * row(j) + t * row(j + 1)
    }

    /// The mean over a picture whose places have these texture coordinates, by midpoints.
    fn over(&self, steps: u32, uv: impl Fn(f64, f64) -> [f64; 2]) -> f64 {
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let row = |j: u32| {
            (0..steps)
                .map(|i| {
                    let [u, v] = uv(at(i), at(j));
                    self.at(u, v)
                })
                .sum::<f64>()
        };
        (0..steps).map(row).sum::<f64>() / f64::from(steps).powi(2)
    }

    pub(super) fn hdr(&self) -> Vec<u8> {
        grey_hdr(self.width, &self.texels)
    }

    /// The albedo in the scene's words.
    fn albedo(&self, file: &str) -> Value {
        json!({
            "type": "image", "file": file, "filter": if self.bilinear { "bilinear" } else { "nearest" },
            "wrap": self.wrap[0].name(), "wrap_v": self.wrap[1].name(),
        })
    }
}

/// Twelve numbers without a pattern, exact in the file.
const PATCHES: [f64; 12] = [0.125, 0.875, 0.25, 0.5, 0.75, 0.0625, 0.9375, 0.375, 0.625, 0.1875, 0.8125, 0.4375];

pub(super) fn patches() -> Shown {
    Shown::new(4, &PATCHES)
}

fn matte(reflectance: Value) -> Value {
    json!({ "type": "lambert", "reflectance": reflectance })
}

/// The unit square, its texture coordinates x and y, and a view of the part [x] × [y] of it: square.
fn square() -> Value {
    parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
}

/// A view of a square of side `side_m` about a place of the plane z = 0, from above, in a sky of radiance 1.
fn view(centre: [f64; 2], side_m: f64) -> Scene {
    let [x, y] = centre;
    Scene::orthographic([x, y, 2.0], [x, y, 0.0], side_m).sky(1.0).film(16, 16).spp(1024)
}

const BECAUSE: &str = "Each place of a Lambert plane under a sky of radiance 1 shows its albedo. Bilinear interpolation is a sum of tents \
                       over the centres of texels, which lie half a texel from the edges, so the mean over a rectangle of the surface is a \
                       sum of integrals of tents; with the nearest texel it is a sum of areas.";
const HOW: &str = "interpolation at midpoints of the picture";

/// A truth about a picture that shows [u] × [v] of an image evenly.
fn flat(name: &str, scene: &Scene, image: &Shown, u: [f64; 2], v: [f64; 2]) -> Truth {
    let value = image.mean(u, v);
    let (own, tolerance) = (image.clone(), if image.bilinear { 1e-5 } else { 3e-3 });
    let formula = format!("mean of the image over u from {} to {}, v from {} to {}", u[0], u[1], v[0], v[1]);
    Truth::new(name, scene, value, formula)
        .because(BECAUSE)
        .confirmed(HOW, tolerance, move || own.over(1000, |a, b| [u[0] + a * (u[1] - u[0]), v[0] + b * (v[1] - v[0])]))
        .sees(0.01)
}

fn filters() -> Vec<Truth> {
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

fn wraps() -> Vec<Truth> {
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

fn round() -> Vec<Truth> {
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

fn placed() -> Vec<Truth> {
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

/// What a colour shows under white light: the second row of the matrix of Rec. 709 (IEC 61966-2-1).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

fn channels() -> Vec<Truth> {
    let colour = [0.75, 0.25, 0.5];
    let shown: f64 = (0..3).map(|k| LUMINANCE[k] * colour[k]).sum();
    let sum = |order: [usize; 3]| (0..3).map(|k| LUMINANCE[k] * colour[order[k]]).sum::<f64>();
    let under = |reflectance: Value| {
        Scene::orthographic([0.5, 0.5, 2.0], [0.5, 0.5, 0.0], 0.4)
            .light(json!({ "type": "environment", "radiance": { "type": "illuminant", "name": "D65" } }))
            .thing(json!({ "shape": square(), "material": matte(reflectance) }))
            .film(16, 16)
            .spp(4096)
    };
    let because = "A colour of Rec. 709 shows its luminance, 0.2126 R + 0.7152 G + 0.0722 B, under D65 of luminance 1 to a sensor of CIE Y.";
    let truth = |name: &str, scene: &Scene, value: f64| {
        Truth::new(name, scene, value, "0.2126 R + 0.7152 G + 0.0722 B")
            .because(because)
            .allows(
                2e-4 * value,
                "the luminances of the primaries are rounded to four digits, and an upsampled colour is met to 1e-4",
            )
            .claims(super::Claim::PhotometricSensor)
            .sees(0.005)
    };
    let file = "colour.hdr";
    let of_image = json!({ "type": "image", "file": file, "encoding": "linear" });
    let factor = json!({ "type": "image", "file": file, "factor": [0.5, 1, 0.25] });
    let scaled = LUMINANCE[0] * 0.375 + LUMINANCE[1] * 0.25 + LUMINANCE[2] * 0.125;
    let image = || radiance_hdr(1, &[colour]);
    vec![
        truth("colour-of-a-reflectance", &under(json!({ "type": "rgb", "rgb": colour })), shown)
            .or_else("red and blue exchanged", sum([2, 1, 0]))
            .or_else("red and green exchanged", sum([1, 0, 2])),
        truth("colour-of-an-image", &under(of_image).file(file, image()), shown)
            .or_else("red and blue exchanged", sum([2, 1, 0]))
            .or_else("red and green exchanged", sum([1, 0, 2]))
            .or_else("decoded as sRGB", (0..3).map(|k| LUMINANCE[k] * decoded(colour[k])).sum()),
        truth("colour-of-an-image-times-factors", &under(factor).file(file, image()), scaled)
            .or_else("the factors left out", shown),
    ]
}

/// The curve of sRGB (IEC 61966-2-1).
pub(super) fn decoded(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Images of numbers: the share of a blend; and an encoding that a scene asks for.
fn numbers() -> Vec<Truth> {
    let image = patches();
    let file = "patches.hdr";
    let (u, v) = ([0.2, 0.6], [0.25, 0.65]);
    let seen = |material: Value| {
        view([0.4, 0.45], 0.4).thing(json!({ "shape": square(), "material": material })).file(file, image.hdr())
    };
    let blend = |weight: (&str, Value)| {
        let mut blend = json!({ "type": "blend", "first": lambert(0.2), "second": lambert(0.9) });
        blend[weight.0] = weight.1;
        blend
    };
    let mean = image.mean(u, v);
    let by_image = seen(blend(("weight_image", json!({ "file": file, "factor": 0.5 }))));
    let plain = view([0.4, 0.45], 0.4).thing(json!({ "shape": square(), "material": blend(("weight", json!(0.3))) }));
    let mixed = 0.2 + 0.7 * 0.5 * mean;
    let of_channels = [[0.25, 0.5, 0.75]];
    let rgb_file = "three-numbers.hdr";
    let by_channel = |channel: &str, share: f64| {
        let weight = json!({ "file": rgb_file, "channel": channel });
        let scene = view([0.4, 0.45], 0.4)
            .thing(json!({ "shape": square(), "material": blend(("weight_image", weight)) }))
            .file(rgb_file, radiance_hdr(1, &of_channels));
        Truth::new(format!("blend-by-the-channel-{channel}"), &scene, 0.2 + 0.7 * share, "0.2 + 0.7 w")
            .because("A blend of two Lambert surfaces has the mixed albedo; its share is the number in one channel of the image, (¼, ½, ¾).")
            .or_else("another channel", 0.2 + 0.7 * if share == 0.5 { 0.25 } else { 0.5 })
            .sees(0.005)
    };
    let encoded = json!({ "type": "image", "file": "one-grey.hdr", "encoding": "srgb", "filter": "nearest" });
    let encoded = view([0.4, 0.45], 0.4)
        .thing(json!({ "shape": square(), "material": matte(encoded) }))
        .file("one-grey.hdr", grey_hdr(1, &[0.5]));
    vec![
        Truth::new("blend-of-two-albedos", &plain, 0.41, "0.7·0.2 + 0.3·0.9")
            .because("A blend of two Lambert surfaces has the mixed albedo.")
            .or_else("the weight taken for the first one's", 0.69)
            .or_else("both in full", 1.1)
            .sees(0.005),
        Truth::new("blend-by-an-image", &by_image, mixed, "0.2 + 0.7·½·mean of the image")
            .because("A blend of two Lambert surfaces has the mixed albedo; its share at each place is half of the image's number.")
            .or_else("the factor left out", 0.2 + 0.7 * mean)
            .or_else("the image taken for the first one's share", 0.9 - 0.7 * 0.5 * mean)
            .sees(0.01),
        by_channel("red", 0.25),
        by_channel("green", 0.5),
        by_channel("blue", 0.75),
        by_channel("mean", 0.5),
        Truth::new("texture-with-the-curve-of-srgb", &encoded, decoded(0.5), "((0.5 + 0.055)/1.055)^2.4")
            .because("The scene says that the numbers of the image have the curve of sRGB.")
            .confirmed("the published value of the curve at ½", 1e-6, || 0.214_041_14)
            .or_else("taken as they are", 0.5)
            .or_else("encoded instead of decoded", 1.055 * 0.5_f64.powf(1.0 / 2.4) - 0.055),
    ]
}

/// A sheet that lets light pass where its image says so, before a lamp.
fn masks() -> Vec<Truth> {
    let image = patches();
    let file = "patches.hdr";
    let (u, v) = ([0.2, 0.6], [0.25, 0.65]);
    let make = |further: &[(&str, Value)], opacity: Option<f64>| {
        let mut number = json!({ "file": file });
        for (key, value) in further {
            number[*key] = value.clone();
        }
        let mut sheet = json!({ "shape": square(), "material": black(), "opacity_image": number });
        if let Some(opacity) = opacity {
            sheet["opacity"] = json!(opacity);
        }
        view([0.4, 0.45], 0.4).thing(sheet).file(file, image.hdr())
    };
    let mean = image.mean(u, v);
    let nearest = Shown { bilinear: false, ..image.clone() };
    let over = |limit: f64| Shown {
        texels: PATCHES.map(|value| f64::from(u8::from(value >= limit))).to_vec(),
        bilinear: false,
        ..image.clone()
    };
    let because = "A black sheet before a sky of radiance 1 shows 1 less its opacity.";
    let truth = |name: &str, scene: &Scene, value: f64, formula: &str| {
        Truth::new(name, scene, value, formula).because(because).claims(super::Claim::Masks).sees(0.01)
    };
    vec![
        truth("mask-by-an-image", &make(&[], None), 1.0 - mean, "1 − mean of the image")
            .or_else("the share that passes taken for the opacity", mean),
        truth("mask-by-an-image-times-an-opacity", &make(&[], Some(0.5)), 1.0 - 0.5 * mean, "1 − ½·mean of the image")
            .or_else("the opacity left out", 1.0 - mean)
            .or_else("the image left out", 0.5),
        truth(
            "mask-by-the-nearest-texel",
            &make(&[("filter", json!("nearest"))], None),
            1.0 - nearest.mean(u, v),
            "1 − mean of the image",
        )
        .or_else("bilinear", 1.0 - mean),
        truth(
            "mask-cut-off",
            &make(&[("filter", json!("nearest")), ("cutoff", json!(0.6))], None),
            1.0 - over(0.6).mean(u, v),
            "1 − share of texels from 0.6 on",
        )
        .or_else("not cut off", 1.0 - nearest.mean(u, v))
        .or_else("what is cut off exchanged", over(0.6).mean(u, v)),
    ]
}

/// A light meter under a lamp with an image.
fn emission() -> Truth {
    let image = patches();
    let file = "patches.hdr";
    let lamp = json!({
        "shape": parallelogram([-1.0, -0.5, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]),
        "material": black(),
        "emission": { "radiance": { "type": "image", "file": file, "filter": "nearest" } },
    });
    let scene = Scene::light_meter().thing(lamp).file(file, image.hdr()).spp(4096);
    // u along y, v along x: column i of four and row j of three from below.
    let irradiance = |turned: bool| -> f64 {
        let part = |i: usize, j: usize| {
            let (x, y) = if turned { (i, j) } else { (j, i) };
            let (nx, ny) = if turned { (4.0, 3.0) } else { (3.0, 4.0) };
            let (x0, x1) = (2.0 * x as f64 / nx - 1.0, 2.0 * (x + 1) as f64 / nx - 1.0);
            let (y0, y1) = (2.0 * y as f64 / ny - 0.5, 2.0 * (y + 1) as f64 / ny - 0.5);
            let corners = [[x0, y0, 1.0], [x1, y0, 1.0], [x1, y1, 1.0], [x0, y1, 1.0]];
            image.texel(i as i64, j as i64) * super::lambert_polygon(&corners, [0.0, 0.0, 1.0])
        };
        (0..12).map(|k| part(k % 4, k / 4)).sum()
    };
    let shown = |irradiance: f64| 0.5 * irradiance / PI;
    Truth::new("lamp-with-an-image", &scene, shown(irradiance(false)), "(ρ/π) Σ texel × irradiance of its rectangle")
        .because("Irradiances of twelve rectangles by Lambert's formula add up, each as bright as its texel.")
        .confirmed("quadrature over the twelve rectangles", 1e-6, move || {
            let part = |k: usize| {
                let (i, j) = (k % 4, k / 4);
                let origin = [2.0 * j as f64 / 3.0 - 1.0, 0.5 * i as f64 - 0.5, 1.0];
                let (u, v) = ([2.0 / 3.0, 0.0, 0.0], [0.0, 0.5, 0.0]);
                let up = [0.0, 0.0, 1.0];
                PATCHES[(2 - j) * 4 + i] * super::irradiance::parallelogram_by_quadrature(origin, u, v, [0.0; 3], up)
            };
            0.5 / PI * (0..12).map(part).sum::<f64>()
        })
        .or_else("u and v exchanged", shown(irradiance(true)))
        .sees(0.01)
}
