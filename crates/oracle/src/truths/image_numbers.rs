//! Images of numbers where shadow rays, facets and lobes meet them: opacities in a shadow, shares of metal, widths of facets on glass and
//! coats. Every tile has its own weight, so that no two of them can be exchanged.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    principled_lobes::{DIFFUSE, Surface, direction},
    scene::{Scene, black, conductor, grey_hdr, grey_png, lambert, rgba_png},
    textures::{decoded, patches},
    tiles::{mean, row, row_of, tile, with},
};
use crate::{
    laws::{CoatedInterface, anisotropic_ggx_mirrors, fresnel_exact},
    vector::{Vec3, add, dot, normalize},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = shadows();
    list.push(shares_of_metal());
    list.extend(widths());
    list.push(thickness());
    list
}

/// Red, green, blue and alpha of a file of eight bits.
const RGBA: [u8; 4] = [230, 64, 128, 179];
const FOUR: &str = "four-numbers.png";

fn number(byte: u8) -> f64 {
    f64::from(byte) / 255.0
}

fn channel(name: &str) -> f64 {
    let [r, g, b, a] = RGBA.map(number);
    match name {
        "red" => r,
        "green" => g,
        "blue" => b,
        "alpha" => a,
        "luminance" => 0.2126 * r + 0.7152 * g + 0.0722 * b,
        _ => (r + g + b) / 3.0,
    }
}

/// An image of two texels turned by the angle of a triangle of sides 3, 4 and 5: the left one's share is what lies below 0.6 u + 0.8 v = ½.
fn turned(file: &str) -> Value {
    json!({ "file": file, "wrap": "clamp", "filter": "nearest", "uv_matrix": [[0.6, 0.8], [-0.8, 0.6]] })
}

/// The left texel's share; that of an image turned the other way, below 0.6 u − 0.8 v = ½; and that of one that is not turned.
const LEFT: [f64; 3] = [0.5 * (0.5 / 0.6) * (0.5 / 0.8), 1.0 - 0.5 * (1.0 / 6.0) * 0.125, 0.5];

/// Floors in the sun below black sheets. The eye is between them.
fn shadows() -> Vec<Truth> {
    const ALBEDOS: [f64; 5] = [0.9, 0.4, 0.6, 0.3, 0.8];
    let scene = |sheets: &[Value]| {
        let place = |scene: Scene, (at, image): (usize, &Value)| {
            scene
                .thing(json!({ "shape": tile(at, 0.0), "material": lambert(ALBEDOS[at]) }))
                .thing(json!({ "shape": tile(at, 1.0), "material": black(), "opacity_image": image }))
        };
        let sun = row(sheets.len(), 0.5).directional_light([0.0, 0.0, -1.0], PI).spp(256);
        sheets.iter().enumerate().fold(sun, place)
    };
    let shown = |opacities: [f64; 5]| mean(&[0, 1, 2, 3, 4].map(|at| ALBEDOS[at] * (1.0 - opacities[at])));
    let truth = |name: &str, scene: &Scene, opacities: [f64; 5], formula: &str| {
        Truth::new(name, scene, shown(opacities), formula)
            .because("In parallel light of irradiance π a Lambert floor shows its albedo. Of the light above a sheet its opacity is missing below it.")
            .or_else("no shadow", shown([0.0; 5]))
            .or_else("the share that passes taken for the opacity", shown(opacities.map(|x| 1.0 - x)))
            .claims(Claim::Masks)
            .sees(5e-3)
    };
    let names = ["alpha", "green", "blue", "luminance", "mean"];
    let of = |names: [&str; 5]| shown(names.map(channel));
    let channels = scene(&names.map(|name| json!({ "file": FOUR, "channel": name }))).file(FOUR, rgba_png(&[RGBA]));
    let channels = truth(
        "shadows-by-channels-of-an-image",
        &channels,
        names.map(channel),
        "mean of ρ(1 − x), x the alpha, green, blue, luminance and mean of (230, 64, 128, 179)/255",
    )
    .allows(2e-5, "luminances of primaries of four digits; single precision")
    .or_else("red everywhere", of(["red"; 5]))
    .or_else("alpha everywhere", of(["alpha"; 5]))
    .or_else("green and blue exchanged", of(["alpha", "blue", "green", "luminance", "mean"]))
    .or_else("the mean for the luminance", of(["alpha", "green", "blue", "mean", "mean"]))
    .or_else("the luminance for the mean", of(["alpha", "green", "blue", "luminance", "luminance"]));

    // A byte by the curve of sRGB, a number of an HDR file without it and by it, two thirds of twelve texels, and a turned image.
    let (byte, [low, high]) = (160_u8, [0.25, 0.75]);
    let sheets = [
        json!({ "file": "byte-160.png", "channel": "red", "encoding": "auto" }),
        json!({ "file": "three-quarters.hdr", "channel": "red", "encoding": "auto" }),
        json!({ "file": "three-quarters.hdr", "channel": "red", "encoding": "srgb" }),
        json!({ "file": "patches.hdr", "filter": "nearest", "cutoff": 0.3 }),
        turned("two-texels.hdr"),
    ];
    let scene = scene(&sheets)
        .file("byte-160.png", grey_png(&[byte]))
        .file("three-quarters.hdr", grey_hdr(1, &[high]))
        .file("patches.hdr", patches().hdr())
        .file("two-texels.hdr", grey_hdr(2, &[low, high]));
    let there = patches().texels.iter().filter(|x| **x >= 0.3).count() as f64 / 12.0;
    let not_cut = mean(&patches().texels);
    let of_turned = move |left: f64| left * low + (1.0 - left) * high;
    let [turned, other_way, not_turned] = LEFT.map(of_turned);
    let right = [decoded(number(byte)), high, decoded(high), there, turned];
    let instead = |at: usize, x: f64| {
        let mut opacities = right;
        opacities[at] = x;
        shown(opacities)
    };
    let codes = truth(
        "shadows-by-encodings-of-an-image",
        &scene,
        right,
        "mean of ρ(1 − x), x decoded(160/255), ¾, decoded(¾), ⅔, and ¼A + ¾(1 − A), A = ½ · 0.5/0.6 · 0.5/0.8",
    )
    .confirmed("the curve of sRGB by its published values, and counted places", 1e-3, move || {
        let at = |k: u32| (f64::from(k) + 0.5) / 1000.0;
        let left =
            (0..1000).flat_map(|i| (0..1000).map(move |j| 0.6 * at(i) + 0.8 * at(j) < 0.5)).filter(|x| *x).count();
        // Of 160/255 and of ¾, rounded to six digits.
        shown([0.351_533, high, 0.522_522, 8.0 / 12.0, of_turned(left as f64 / 1e6)])
    })
    .or_else("bytes taken as they are", instead(0, number(byte)))
    .or_else("numbers of a linear file decoded", instead(1, decoded(high)))
    .or_else("the curve left out", instead(2, high))
    .or_else("not cut off", instead(3, not_cut))
    .or_else("what is cut off exchanged", instead(3, 1.0 - there))
    .or_else("turned the other way", instead(4, other_way))
    .or_else("not turned", instead(4, not_turned));
    vec![channels, codes]
}

/// Principled surfaces in the sun. f is linear in the share of metal.
fn shares_of_metal() -> Truth {
    const BASES: [f64; 6] = [0.3, 0.8, 0.5, 0.65, 0.4, 0.9];
    let (byte, [low, high]) = (128_u8, [0.25, 0.75]);
    let images = [
        json!({ "file": FOUR, "channel": "alpha" }),
        json!({ "file": FOUR, "channel": "luminance" }),
        json!({ "file": "byte-128.png", "channel": "red", "encoding": "auto" }),
        json!({ "file": "three-quarters.hdr", "channel": "red", "encoding": "srgb" }),
        json!({ "file": "three-quarters.hdr", "factor": 0.5 }),
        turned("two-texels.hdr"),
    ];
    let surface =
        |at: usize, metallic: f64| Surface { base: BASES[at], index: 1.5, alpha: [0.4; 2], metallic, ..DIFFUSE };
    let light = direction(40.0, 70.0);
    let shown = move |shares: [f64; 6]| {
        mean(&[0, 1, 2, 3, 4, 5].map(|at| surface(at, shares[at]).f_cos([0.0, 0.0, 1.0], light)))
    };
    let materials: Vec<Value> = (0..6)
        .map(|at| {
            let mut material = surface(at, 0.0).json();
            material["metallic_image"] = images[at].clone();
            material
        })
        .collect();
    let scene = row_of(&materials)
        .directional_light(light.map(|x| -x), 1.0)
        .file(FOUR, rgba_png(&[RGBA]))
        .file("byte-128.png", grey_png(&[byte]))
        .file("three-quarters.hdr", grey_hdr(1, &[high]))
        .file("two-texels.hdr", grey_hdr(2, &[low, high]))
        .spp(256);
    let [turned, other_way, not_turned] = LEFT.map(|left| left * low + (1.0 - left) * high);
    let right = [channel("alpha"), channel("luminance"), decoded(number(byte)), decoded(high), 0.5 * high, turned];
    let instead = |at: usize, x: f64| {
        let mut shares = right;
        shares[at] = x;
        shown(shares)
    };
    Truth::new(
        "metal-by-images-in-the-sun",
        &scene,
        shown(right),
        "mean of f cos θ_i, m the alpha and luminance of (230, 64, 128, 179)/255, decoded(128/255), decoded(¾), ½ · ¾, ¼A + ¾(1 − A)",
    )
    .because("f of a principled surface is linear in its share of metal, so a tile shows f of the mean share.")
    .confirmed("f by angles, of no metal and of metal alone", 1e-9, move || {
        let part = |at: usize, m: f64| surface(at, m).by_angles(0.0, 40.0, 0.0);
        mean(&[0, 1, 2, 3, 4, 5].map(|at| (1.0 - right[at]) * part(at, 0.0) + right[at] * part(at, 1.0)))
    })
    .allows(2e-5, "luminances of primaries of four digits; single precision")
    .or_else("no metal", shown([0.0; 6]))
    .or_else("the luminance for alpha", instead(0, channel("luminance")))
    .or_else("alpha for the luminance", instead(1, channel("alpha")))
    .or_else("the mean for the luminance", instead(1, channel("mean")))
    .or_else("bytes taken as they are", instead(2, number(byte)))
    .or_else("the curve left out", instead(3, high))
    .or_else("the factor left out", instead(4, high))
    .or_else("turned the other way", instead(5, other_way))
    .or_else("not turned", instead(5, not_turned))
    .sees(1e-3)
}

/// Facets of glass, or of a coat over black, in the sun: Fresnel's share of what mirrors return.
fn highlight(alpha: f64, light: Vec3) -> f64 {
    let up = [0.0, 0.0, 1.0];
    let share = fresnel_exact(dot(up, normalize(add(up, light))), 1.5).reflectance();
    share * anisotropic_ggx_mirrors([alpha; 2], up, light) * light[2]
}

/// Each number and what it means makes a width. Coats have tiles of the other half of the keys.
fn widths() -> Vec<Truth> {
    let light = direction(20.0, 110.0);
    let shown = move |widths: [f64; 4]| mean(&widths.map(|alpha| highlight(alpha, light)));
    let glass = json!({ "type": "dielectric", "interior": 1.5, "multiple_scattering": "lost" });
    let coat = json!({ "type": "plastic", "reflectance": 0, "coat": 1.5 });
    let truth = |name: &str, material: &Value, images: [Value; 4], widths: [f64; 4], formula: &str| {
        let materials = images.map(|image| with(material.clone(), &json!({ "roughness_image": image })));
        let scene = row_of(&materials).directional_light(light.map(|x| -x), 1.0).spp(256);
        let value = shown(widths);
        Truth::new(name, &scene.file(FOUR, rgba_png(&[RGBA])), value, formula)
            .because("Seen along its normal over black, a facetted interface in the sun shows F D G₂/(4 cos θ_o). Each tile has one width of facets.")
            .allows(0.012 * value, "each place is a blend of two widths of a series in the ratio 1.05²: up to 1 % at the peak; and single precision")
            .claims(Claim::CorrelatedMasking)
            .claims(Claim::AveragesPolarisation)
            .sees(0.04)
    };
    let images = [
        json!({ "file": FOUR, "channel": "alpha", "quantity": "alpha" }),
        json!({ "file": FOUR, "channel": "blue", "quantity": "alpha" }),
        json!({ "file": FOUR, "channel": "luminance" }),
        json!({ "file": FOUR, "channel": "mean", "quantity": "alpha-squared", "factor": 0.2 }),
    ];
    let [alpha, blue, luminance] = ["alpha", "blue", "luminance"].map(channel);
    let middle = 0.2 * channel("mean");
    let right = [alpha, blue, luminance * luminance, middle.sqrt()];
    let instead = move |right: [f64; 4], at: usize, x: f64| {
        let mut widths = right;
        widths[at] = x;
        shown(widths)
    };
    let of_glass = truth(
        "facets-of-glass-by-channels-of-an-image",
        &glass,
        images,
        right,
        "mean of F D G₂/4, α the alpha, the blue, the luminance squared, and the root of a fifth of the mean of (230, 64, 128, 179)/255",
    );
    let of_glass = of_glass
        .or_else("blue for alpha", instead(right, 0, blue))
        .or_else("green for blue", instead(right, 1, channel("green")))
        .or_else("the luminance taken for α", instead(right, 2, luminance))
        .or_else("the mean for the luminance", instead(right, 2, channel("mean").powi(2)))
        .or_else("the mean taken for α", instead(right, 3, middle))
        .or_else("its root once more", instead(right, 3, middle.powf(0.25)));

    let (byte, [low, high]) = (160_u8, [0.25, 0.5]);
    let with_quantity = |image: Value, quantity: &str| with(image, &json!({ "quantity": quantity }));
    let images = [
        json!({ "file": "byte-160.png", "channel": "red", "encoding": "auto", "quantity": "alpha" }),
        json!({ "file": "half.hdr", "channel": "red", "encoding": "srgb", "quantity": "alpha" }),
        json!({ "file": "half.hdr", "channel": "red", "quantity": "alpha-squared", "factor": 0.5 }),
        with_quantity(turned("two-numbers.hdr"), "alpha"),
    ];
    let [left, other_way, not_turned] = LEFT;
    let of_turned = move |left: f64| left * highlight(low, light) + (1.0 - left) * highlight(high, light);
    let right = [decoded(number(byte)), decoded(high), (0.5 * high).sqrt()];
    let all = move |[a, b, c]: [f64; 3], left: f64| {
        let facets = [a, b, c].map(|alpha| highlight(alpha, light));
        mean(&[facets[0], facets[1], facets[2], of_turned(left)])
    };
    let value = all(right, left);
    let materials = images.map(|image| with(coat.clone(), &json!({ "roughness_image": image })));
    let scene = row_of(&materials)
        .directional_light(light.map(|x| -x), 1.0)
        .file("byte-160.png", grey_png(&[byte]))
        .file("half.hdr", grey_hdr(1, &[high]))
        .file("two-numbers.hdr", grey_hdr(2, &[low, high]))
        .spp(256);
    let of_coat = Truth::new(
        "facets-of-coats-by-encodings-of-an-image",
        &scene,
        value,
        "mean of F D G₂/4, α decoded(160/255), decoded(½), √(½ · ½), and ¼ for A, ½ for 1 − A, A = ½ · 0.5/0.6 · 0.5/0.8",
    )
    .because("Over a black base a coat in the sun, seen along its normal, shows F D G₂/(4 cos θ_o). Each tile has its own widths of facets.")
    .allows(0.012 * value, "each place is a blend of two widths of a series in the ratio 1.05²: up to 1 % at the peak; and single precision")
    .or_else("bytes taken as they are", all([number(byte), right[1], right[2]], left))
    .or_else("the curve left out", all([right[0], high, right[2]], left))
    .or_else("its square taken for α", all([right[0], right[1], 0.5 * high], left))
    .or_else("turned the other way", all(right, other_way))
    .or_else("not turned", all(right, not_turned))
    .claims(Claim::CorrelatedMasking)
    .claims(Claim::AveragesPolarisation)
    .sees(0.04);
    vec![of_glass, of_coat]
}

/// Metal under films whose thickness is a channel of an image, or two texels that lie turned.
fn thickness() -> Truth {
    const NM: f64 = 550.0;
    let thick = [400.0, 620.0, 700.0];
    let images = [
        json!({ "file": FOUR, "channel": "blue" }),
        json!({ "file": FOUR, "channel": "green", "encoding": "srgb" }),
        turned("two-texels.hdr"),
    ];
    let materials: Vec<Value> = (0..3)
        .map(|at| {
            let layer = json!({ "thickness_nm": thick[at], "index": 1.46, "thickness_image": images[at] });
            with(conductor(1.5, 3.0), &json!({ "thin_film": [layer] }))
        })
        .collect();
    let scene = row_of(&materials)
        .sky(1.0)
        .spp(64)
        .band([NM - 5e-4, NM + 5e-4])
        .file(FOUR, rgba_png(&[RGBA]))
        .file("two-texels.hdr", grey_hdr(2, &[0.25, 0.75]));
    let stack =
        |thickness: f64| CoatedInterface { incident: 1.0, layers: vec![[1.46, 0.0, thickness]], substrate: [1.5, 3.0] };
    let of = move |shares: [f64; 2], left: f64, reflects: &dyn Fn(&CoatedInterface) -> f64| {
        let at = |thickness: f64| reflects(&stack(thickness));
        let halves = left * at(0.25 * thick[2]) + (1.0 - left) * at(0.75 * thick[2]);
        mean(&[at(shares[0] * thick[0]), at(shares[1] * thick[1]), halves])
    };
    let exact: fn(&CoatedInterface) -> f64 = |stack| stack.waves(NM, 1.0).reflectance();
    let right = [channel("blue"), decoded(channel("green"))];
    let [left, other_way, not_turned] = LEFT;
    Truth::new(
        "films-by-channels-of-an-image",
        &scene,
        of(right, left, &exact),
        "mean of Airy's R: n 1, 1.46, 1.5 + 3i at 550 nm, of 400 · 128/255, 620 · decoded(64/255), and ¼ of 700 nm for A, ¾ of it for 1 − A",
    )
    .because("Each place shows what a film of its own thickness reflects.")
    .confirmed("the wave equation", 1e-6, move || of(right, left, &|stack| stack.by_wave_equation(NM, 1.0).reflectance()))
    .or_else("red for blue", of([channel("red"), right[1]], left, &exact))
    .or_else("bytes taken as they are", of([right[0], channel("green")], left, &exact))
    .or_else("turned the other way", of(right, other_way, &exact))
    .or_else("not turned", of(right, not_turned, &exact))
    .or_else("the whole thickness", of([1.0; 2], left, &exact))
    .claims(Claim::ThinFilms)
    .sees(2e-3)
}
