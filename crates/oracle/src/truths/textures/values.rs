//! What the channels of an image mean: colours, numbers, masks and light.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::shown::{PATCHES, Shown, patches};
use super::{matte, square, view};
use crate::truths::scene::{Scene, black, grey_hdr, lambert, parallelogram, radiance_hdr};
use crate::truths::{Claim, Truth, irradiance, lambert_polygon};

/// What a colour shows under white light: the second row of the matrix of Rec. 709 (IEC 61966-2-1).
pub(super) const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

pub(super) fn channels() -> Vec<Truth> {
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
            .claims(Claim::PhotometricSensor)
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
pub(crate) fn decoded(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Images of numbers: the share of a blend; and an encoding that a scene asks for.
pub(super) fn numbers() -> Vec<Truth> {
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
pub(super) fn masks() -> Vec<Truth> {
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
        Truth::new(name, scene, value, formula).because(because).claims(Claim::Masks).sees(0.01)
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
pub(super) fn emission() -> Truth {
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
            image.texel(i as i64, j as i64) * lambert_polygon(&corners, [0.0, 0.0, 1.0])
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
                PATCHES[(2 - j) * 4 + i] * irradiance::parallelogram_by_quadrature(origin, u, v, [0.0; 3], up)
            };
            0.5 / PI * (0..12).map(part).sum::<f64>()
        })
        .or_else("u and v exchanged", shown(irradiance(true)))
        .sees(0.01)
}
