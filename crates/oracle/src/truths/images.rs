//! Every option of every kind of image of numbers, and of normals: channels, encodings, wrapping, filters, scales.
//!
//! The coordinates of a surface are multiplied by almost nothing and moved, so that the whole picture shows one place of the image.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{PLATE_ALBEDO, Scene, black, grey_hdr, grey_png, lambert, parallelogram, radiance_hdr, rgba_png},
    textures::{Shown, Wrap, decoded, patches},
};
use crate::{
    laws::anisotropic_ggx_mirrors,
    vector::{Vec3, dot, normalize, scale},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list: Vec<Truth> = KINDS
        .into_iter()
        .flat_map(|kind| [places(kind), channels(kind), encodings(kind), vec![turned(kind)]].concat())
        .collect();
    list.extend(normals());
    list.extend(heights());
    list.extend(skies());
    list
}

/// What a number of an image means.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Opacity,
    Weight,
    Roughness,
}

const KINDS: [Kind; 3] = [Kind::Opacity, Kind::Weight, Kind::Roughness];

/// f cos θ of facets that reflect everything, along the normal, in light 20° off it.
fn highlight(alpha: f64) -> f64 {
    let tilt = 20.0_f64.to_radians();
    anisotropic_ggx_mirrors([alpha; 2], [0.0, 0.0, 1.0], [tilt.sin(), 0.0, tilt.cos()]) * tilt.cos()
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Opacity => "opacity-image",
            Self::Weight => "weight-image",
            Self::Roughness => "roughness-image",
        }
    }

    /// What a picture shows where the number is `x`.
    fn shown(self, x: f64) -> f64 {
        match self {
            Self::Opacity => 1.0 - x,
            Self::Weight => 0.2 + 0.7 * x,
            Self::Roughness => highlight(x),
        }
    }

    fn scene(self, image: Value) -> Scene {
        let square = parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let view = Scene::orthographic([0.5, 0.5, 2.0], [0.5, 0.5, 0.0], 0.4).film(16, 16).spp(1024);
        let tilt = 20.0_f64.to_radians();
        match self {
            Self::Opacity => {
                view.sky(1.0).thing(json!({ "shape": square, "material": black(), "opacity_image": image }))
            }
            Self::Weight => view.sky(1.0).thing(json!({
                "shape": square,
                "material": { "type": "blend", "first": lambert(0.2), "second": lambert(0.9), "weight_image": image },
            })),
            Self::Roughness => {
                let mut image = image;
                image["quantity"] = json!("alpha");
                let metal = json!({
                    "type": "conductor", "wavelengths_nm": [300, 900], "n": [1e-12, 1e-12], "k": [3, 3], "roughness_image": image,
                    "multiple_scattering": "lost",
                });
                view.thing(json!({ "shape": square, "material": metal }))
                    .directional_light([-tilt.sin(), 0.0, -tilt.cos()], 1.0)
            }
        }
    }

    fn truth(self, name: &str, scene: &Scene, x: f64, others: &[(&'static str, f64)]) -> Truth {
        let others: Vec<(&'static str, f64)> = others.iter().map(|&(what, other)| (what, self.shown(other))).collect();
        self.shows(name, scene, (self.shown(x), format!("at the number {x}")), &others)
    }

    /// A truth by what a picture shows, with its formula.
    fn shows(
        self,
        name: &str,
        scene: &Scene,
        (value, formula): (f64, String),
        others: &[(&'static str, f64)],
    ) -> Truth {
        let mut truth = Truth::new(format!("{}-{name}", self.name()), scene, value, formula)
            .because("The whole picture shows one number of the image: the opacity of a black sheet before a sky, the share of a blend, or α of a metal.")
            .sees(0.01);
        if self == Self::Opacity {
            truth = truth.claims(Claim::Masks);
        }
        let mut apart = 0.0;
        if self == Self::Roughness {
            apart = 0.012 * value;
            truth = truth.allows(
                apart,
                "each place is a blend of two widths of a series in the ratio 1.05²: up to 1 % at the peak; and single precision",
            );
            truth.must_see = 0.04;
        }
        for &(what, other) in others {
            if (other - value).abs() > 2.5 * apart + 0.01 * value {
                truth = truth.or_else(what, other);
            }
        }
        truth
    }
}

/// Coordinates that show the place [u, v] of the image everywhere.
fn at(mut image: Value, [u, v]: [f64; 2]) -> Value {
    (image["uv_scale"], image["uv_offset"]) = (json!([1e-6, 1e-6]), json!([u, v]));
    image
}

/// Turned by the angle of a triangle of sides 3, 4 and 5, so that its middle column lies at 0.8 u + 0.6 v = ½ − `shift`.
fn turn(mut image: Value, shift: f64) -> Value {
    (image["wrap"], image["filter"]) = (json!("clamp"), json!("nearest"));
    (image["uv_matrix"], image["uv_offset"]) = (json!([[0.8, 0.6], [-0.6, 0.8]]), json!([shift, 0]));
    image
}

/// An image of two texels that lies turned: the line between them cuts a corner off the picture.
fn turned(kind: Kind) -> Truth {
    // Of the picture, which shows 0.3 to 0.7, the line 0.8 u + 0.6 v = 0.58 cuts off ½ of one side and ⅔ of the other.
    let (file, numbers, share) = ("two-numbers.hdr", [0.25, 0.5], 1.0 / 6.0);
    let scene = kind.scene(turn(json!({ "file": file }), -0.08)).file(file, grey_hdr(2, &numbers));
    let [left, right] = numbers.map(|x| kind.shown(x));
    let shown = |share: f64| share * left + (1.0 - share) * right;
    let formula = "⅙ of the left number's and ⅚ of the right one's".to_owned();
    // Not turned, the line would be at u = 0.58, of 0.3 to 0.7.
    kind.shows(
        "turned",
        &scene,
        (shown(share), formula),
        &[("turned the other way", shown(1.0)), ("not turned", shown(0.7)), ("the right number alone", shown(0.0))],
    )
}

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

fn places(kind: Kind) -> Vec<Truth> {
    let file = "patches.hdr";
    let mut list = Vec::new();
    for bilinear in [true, false] {
        for k in 0..3 {
            // Of each wrapping along u another along v; the place lies beyond two edges.
            let wrap = [WRAPS[k], WRAPS[(k + 1) % 3]];
            let image = Shown { wrap, bilinear, ..patches() };
            let place = [1.3, -0.2];
            let with =
                |wrap: [Wrap; 2], bilinear: bool| Shown { wrap, bilinear, ..image.clone() }.at(place[0], place[1]);
            let words = json!({
                "file": file, "wrap": wrap[0].name(), "wrap_v": wrap[1].name(), "filter": if bilinear { "bilinear" } else { "nearest" },
            });
            let name =
                format!("{}-and-{}-{}", wrap[0].name(), wrap[1].name(), if bilinear { "bilinear" } else { "nearest" });
            let scene = kind.scene(at(words, place)).file(file, image.hdr());
            list.push(kind.truth(
                &name,
                &scene,
                image.at(place[0], place[1]),
                &[
                    ("wrapping of u and v exchanged", with([wrap[1], wrap[0]], bilinear)),
                    ("the other filter", with(wrap, !bilinear)),
                    ("repeated", with([Wrap::Repeat; 2], bilinear)),
                ],
            ));
        }
    }
    list
}

/// Red, green, blue and alpha of a file of eight bits.
const RGBA: [u8; 4] = [51, 102, 204, 153];

fn channels(kind: Kind) -> Vec<Truth> {
    let file = "four-channels.png";
    let [r, g, b, a] = RGBA.map(|byte| f64::from(byte) / 255.0);
    // The luminance of Rec. 709.
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    [
        ("red", r),
        ("green", g),
        ("blue", b),
        ("alpha", a),
        ("auto", a),
        ("luminance", luminance),
        ("mean", (r + g + b) / 3.0),
    ]
    .map(|(channel, x)| {
        let scene = kind.scene(json!({ "file": file, "channel": channel })).file(file, rgba_png(&[RGBA]));
        let others = [("red", r), ("green", g), ("blue", b)];
        kind.truth(&format!("channel-{channel}"), &scene, x, &others)
            .allows(1e-4, "luminances of primaries of four digits; and single precision")
    })
    .into()
}

fn encodings(kind: Kind) -> Vec<Truth> {
    let file = "grey-128.png";
    let x = 128.0 / 255.0;
    [("linear", x), ("srgb", decoded(x)), ("auto", decoded(x))]
        .map(|(encoding, value)| {
            let scene = kind
                .scene(json!({ "file": file, "channel": "red", "encoding": encoding }))
                .file(file, grey_png(&[128]));
            kind.truth(
                &format!("encoding-{encoding}"),
                &scene,
                value,
                &[("as it is written", x), ("by the curve of sRGB", decoded(x))],
            )
        })
        .into()
}

const TO_LIGHT: Vec3 = [0.3, 0.5, 0.8];

fn lit(object: Value) -> Scene {
    Scene::orthographic([0.5, 0.5, 2.0], [0.5, 0.5, 0.0], 0.2)
        .thing(object)
        .directional_light(scale(-1.0, normalize(TO_LIGHT)), PI)
        .film(16, 16)
        .spp(64)
}

fn square() -> Value {
    parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
}

fn matte(normal: Vec3) -> f64 {
    0.8 * dot(normalize(normal), normalize(TO_LIGHT)).max(0.0)
}

const RELIEF: &str =
    "A Lambert surface scatters around its shading normal n: in parallel light of irradiance π from l it shows ρ n·l.";

fn normals() -> Vec<Truth> {
    let truth = |name: String, map: Value, file: &str, bytes: Vec<u8>, normal: Vec3| {
        let scene = lit(json!({ "shape": square(), "material": lambert(0.8), "normal_map": map })).file(file, bytes);
        Truth::new(name, &scene, matte(normal), "ρ n·l")
            .because(RELIEF)
            .or_else("the normal of the shape", matte([0.0, 0.0, 1.0]))
            .sees(2e-3)
    };
    // Two columns of three rows of other normals.
    let texels: [[f64; 3]; 6] = [
        [0.75, 0.5, 0.875],
        [0.5, 0.75, 0.75],
        [0.25, 0.5, 0.9375],
        [0.5, 0.25, 0.875],
        [0.625, 0.625, 0.75],
        [0.375, 0.625, 0.875],
    ];
    let mut list = Vec::new();
    for bilinear in [true, false] {
        for k in 0..3 {
            let (wrap, place) = ([WRAPS[k], WRAPS[(k + 1) % 3]], [1.4, -0.3]);
            let of_channel = |channel: usize| {
                let numbers: Vec<f64> = texels.iter().map(|texel| texel[channel]).collect();
                Shown { wrap, bilinear, ..Shown::new(2, &numbers) }.at(place[0], place[1])
            };
            let normal = [0, 1, 2].map(|channel| 2.0 * of_channel(channel) - 1.0);
            let filter = if bilinear { "bilinear" } else { "nearest" };
            let map =
                json!({ "file": "normals.hdr", "wrap": wrap[0].name(), "wrap_v": wrap[1].name(), "filter": filter });
            let name = format!("normal-map-{}-and-{}-{filter}", wrap[0].name(), wrap[1].name());
            list.push(truth(name, at(map, place), "normals.hdr", radiance_hdr(2, &texels), normal));
        }
    }
    // Turned about: where each of two texels shows its normal follows, the axes in which it is stated do not.
    let two = [[0.75, 0.5, 0.875], [0.5, 0.25, 0.75]];
    let of = |texel: [f64; 3]| texel.map(|x| 2.0 * x - 1.0);
    let along_the_image = |[x, y, z]: Vec3| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, z];
    let [left, right] = two.map(|texel| matte(of(texel)));
    let map = turn(json!({ "file": "two-normals.hdr" }), -0.14);
    let scene = lit(json!({ "shape": square(), "material": lambert(0.8), "normal_map": map }));
    // Of the picture, which shows 0.4 to 0.6, the line 0.8 u + 0.6 v = 0.64 cuts off ½ of one side and ⅔ of the other.
    list.push(
        Truth::new(
            "normal-map-turned",
            &scene.file("two-normals.hdr", radiance_hdr(2, &two)),
            left / 6.0 + right * 5.0 / 6.0,
            "⅙ ρ n₁·l + ⅚ ρ n₂·l",
        )
        .because(RELIEF)
        .or_else("turned the other way", left)
        .or_else("normals turned with the image", {
            let [left, right] = two.map(|texel| matte(along_the_image(of(texel))));
            left / 6.0 + right * 5.0 / 6.0
        })
        .sees(2e-3),
    );
    let bytes = [200_u8, 100, 230, 255];
    for encoding in ["linear", "srgb", "auto"] {
        let number = |byte: u8| {
            let x = f64::from(byte) / 255.0;
            if encoding == "linear" { x } else { decoded(x) }
        };
        let normal = [0, 1, 2].map(|k| 2.0 * number(bytes[k]) - 1.0);
        let map = json!({ "file": "normal.png", "encoding": encoding });
        list.push(truth(format!("normal-map-encoding-{encoding}"), map, "normal.png", rgba_png(&[bytes]), normal));
    }
    list
}

fn heights() -> Vec<Truth> {
    const HEIGHT_M: f64 = 0.8;
    let truth = |name: String, map: Value, file: &str, bytes: Vec<u8>, slopes: [f64; 2]| {
        let scene = lit(json!({ "shape": square(), "material": lambert(0.8), "bump_map": map })).file(file, bytes);
        let value = matte([-slopes[0], -slopes[1], 1.0]);
        Truth::new(name, &scene, value, "ρ n·l, n ∝ (−∂h/∂x, −∂h/∂y, 1)")
            .because(RELIEF)
            .or_else("white is deep", matte([slopes[0], slopes[1], 1.0]))
            .sees(2e-3)
    };
    // Grows by 1/8 a texel along u and 1/16 along v, four texels a side.
    let ramp: Vec<f64> =
        (0..4).rev().flat_map(|row| (0..4).map(move |column| f64::from(2 * column + row + 1) / 16.0)).collect();
    let (along_u, along_v) = (HEIGHT_M * 0.125 / 0.25, HEIGHT_M * 0.0625 / 0.25);
    let mut list = Vec::new();
    for (wrap, factor, wrap_v, factor_v) in
        [("repeat", 1.0, "mirror", -1.0), ("mirror", -1.0, "clamp", 0.0), ("clamp", 0.0, "repeat", 1.0)]
    {
        // One width of the image away.
        let map =
            json!({ "file": "ramp.hdr", "height_m": HEIGHT_M, "wrap": wrap, "wrap_v": wrap_v, "uv_offset": [1, 1] });
        let name = format!("bump-map-{wrap}-and-{wrap_v}");
        list.push(truth(name, map, "ramp.hdr", grey_hdr(4, &ramp), [factor * along_u, factor_v * along_v]));
    }
    // Turned about the middle, by the angle of a triangle of sides 3, 4 and 5: u′ = 0.8 u + 0.6 v, v′ = −0.6 u + 0.8 v.
    let map = json!({
        "file": "ramp.hdr", "height_m": HEIGHT_M, "wrap": "clamp", "uv_matrix": [[0.8, 0.6], [-0.6, 0.8]], "uv_offset": [-0.2, 0.4],
    });
    let turned = |sine: f64| [0.8 * along_u - sine * along_v, sine * along_u + 0.8 * along_v];
    let turned_map = truth("bump-map-turned".to_owned(), map, "ramp.hdr", grey_hdr(4, &ramp), turned(0.6));
    let shown = |[x, y]: [f64; 2]| matte([-x, -y, 1.0]);
    list.push(
        turned_map
            .or_else("turned the other way", shown(turned(-0.6)))
            .or_else("not turned", shown([along_u, along_v])),
    );
    // Each channel with a slope of its own along u.
    let slopes = [2.0, 1.0, 3.0];
    let texels: Vec<[f64; 3]> = (0..4).map(|column| slopes.map(|slope| slope * f64::from(column + 1) / 16.0)).collect();
    let luminance = 0.2126 * slopes[0] + 0.7152 * slopes[1] + 0.0722 * slopes[2];
    for (channel, slope) in
        [("red", 2.0), ("green", 1.0), ("blue", 3.0), ("mean", 2.0), ("luminance", luminance), ("auto", luminance)]
    {
        let map = json!({ "file": "slopes.hdr", "height_m": HEIGHT_M, "channel": channel, "wrap": "clamp" });
        let bytes = radiance_hdr(4, &texels);
        let name = format!("bump-map-channel-{channel}");
        list.push(truth(name, map, "slopes.hdr", bytes, [HEIGHT_M * slope / 16.0 / 0.25, 0.0]));
    }
    // Alpha that grows evenly over four texels, and grey texels with the curve of sRGB.
    let bytes = [20_u8, 70, 120, 170];
    let slope = |number: fn(f64) -> f64| {
        let heights = bytes.map(|byte| number(f64::from(byte) / 255.0));
        HEIGHT_M * (heights[2] - heights[1]) / 0.25
    };
    let alpha = json!({ "file": "alphas.png", "height_m": HEIGHT_M, "channel": "alpha", "wrap": "clamp" });
    let alphas = bytes.map(|byte| [255, 0, 10, byte]);
    list.push(truth("bump-map-channel-alpha".to_owned(), alpha, "alphas.png", rgba_png(&alphas), [slope(|x| x), 0.0]));
    for encoding in ["linear", "srgb", "auto"] {
        let number: fn(f64) -> f64 = if encoding == "linear" { |x| x } else { decoded };
        // In the middle between the second and the third centre: one texel about it is from the one to the other.
        let map = json!({
            "file": "greys.png", "height_m": 1e3 * HEIGHT_M, "encoding": encoding, "wrap": "clamp", "uv_scale": [1e-3, 1],
            "uv_offset": [0.4995, 0],
        });
        let name = format!("bump-map-encoding-{encoding}");
        list.push(truth(name, map, "greys.png", grey_png(&bytes), [slope(number), 0.0]));
    }
    list
}

/// The encoding of an image environment.
fn skies() -> Vec<Truth> {
    let x = 128.0 / 255.0;
    [("linear", x), ("srgb", decoded(x)), ("auto", decoded(x))]
        .map(|(encoding, value)| {
            let image = json!({ "file": "grey-128.png", "encoding": encoding });
            let scene = Scene::light_meter()
                .light(json!({ "type": "environment", "image": image }))
                .file("grey-128.png", grey_png(&[128]))
                .spp(1024);
            Truth::new(format!("sky-image-encoding-{encoding}"), &scene, PLATE_ALBEDO * value, "ρ L")
                .because("A Lambert plate under a sky of the same radiance everywhere shows ρ times that.")
                .or_else("the other encoding", PLATE_ALBEDO * if encoding == "linear" { decoded(x) } else { x })
                .claims(Claim::PhotometricSensor)
                .sees(0.005)
        })
        .into()
}
