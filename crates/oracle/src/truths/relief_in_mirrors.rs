//! Normal and bump maps on mirrors under an overcast sky, whose brightness says where a normal points; and what maps lose of the sun and
//! of an even sky.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Truth,
    scene::{Scene, grey_hdr, grey_png, lambert, mirror, radiance_hdr, rgba_png},
    textures::{Wrap, decoded},
    tiles::{mean, row, tile, with},
};
use crate::{
    quadrature::interval,
    vector::{Vec3, dot, frame, normalize, scale},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = heights();
    list.push(normals());
    list.extend(losses());
    list
}

/// Where the sky has its zenith: so tilted that no two normals of a tile show the same.
const ZENITH: Vec3 = [0.45, 0.3, 0.84];
/// What the tiles reflect, each its own share.
const SHARES: [f64; 6] = [0.95, 0.5, 0.8, 0.35, 0.65, 0.2];

/// What a mirror with this normal shows to an eye straight above it: 1 + 2 cos Z where it mirrors the eye to.
fn seen(normal: Vec3) -> f64 {
    let n = normalize(normal);
    let to_sky = [2.0 * n[2] * n[0], 2.0 * n[2] * n[1], 2.0 * n[2] * n[2] - 1.0];
    1.0 + 2.0 * dot(to_sky, normalize(ZENITH))
}

/// The same by angles on the sphere: twice the normal's angle from the eye, and the zenith's from there.
fn seen_by_angles(normal: Vec3) -> f64 {
    let angle = |v: Vec3| (v[0].hypot(v[1]).atan2(v[2]), v[1].atan2(v[0]));
    let ((tilt, turn), (far, away)) = (angle(normal), angle(ZENITH));
    let (sin, cos) = (2.0 * tilt).sin_cos();
    1.0 + 2.0 * (cos * far.cos() + sin * far.sin() * (turn - away).cos())
}

fn shown(normals: &[Vec3], seen: fn(Vec3) -> f64) -> f64 {
    let tiles: Vec<f64> = normals.iter().zip(SHARES).map(|(&normal, share)| share * seen(normal)).collect();
    mean(&tiles)
}

/// Mirrors under maps of one kind, and the sky.
fn mirrors(kind: &str, maps: &[(Value, Value)]) -> Scene {
    let sky = json!({ "cie_type": 16, "up": ZENITH, "zenith_radiance": 3 });
    let under = row(maps.len(), 2.0).light(json!({ "type": "environment", "sky": sky })).spp(256);
    maps.iter().enumerate().fold(under, |scene, (at, (shape, map))| {
        let shape = if shape.is_null() { tile(at, 0.0) } else { shape.clone() };
        let mut object = json!({ "shape": shape, "material": mirror(SHARES[at]) });
        object[kind] = map.clone();
        scene.thing(object)
    })
}

const BECAUSE: &str = "A mirror is seen in the direction that its normal turns the eye's ray to. The overcast sky shows 1 + 2 cos Z there, Z \
                       the angle from its zenith, which is tilted.";

fn truth(name: &str, scene: &Scene, normals: &[Vec3], formula: &str) -> Truth {
    let again = normals.to_vec();
    let flat = vec![[0.0, 0.0, 1.0]; normals.len()];
    let turned: Vec<Vec3> = normals.iter().map(|n| [-n[0], -n[1], n[2]]).collect();
    Truth::new(name, scene, shown(normals, seen), formula)
        .because(BECAUSE)
        .confirmed("angles on the sphere", 1e-12, move || shown(&again, seen_by_angles))
        .or_else("the normal of the shape", shown(&flat, seen))
        .or_else("hills for pits", shown(&turned, seen))
        .sees(1e-3)
}

/// A list with one of its normals replaced.
fn instead(normals: &[Vec3], at: usize, normal: Vec3) -> f64 {
    let mut normals = normals.to_vec();
    normals[at] = normal;
    shown(&normals, seen)
}

/// Coordinates that show the middle of an image: from 0.4 to 0.6 along both, and a tile away for each of `beyond`.
fn middle(map: Value, beyond: f64) -> Value {
    with(map, &json!({ "uv_scale": [0.2, 0.2], "uv_offset": [0.4 + beyond, 0.4 + beyond] }))
}

fn slope(along_u: f64, along_v: f64) -> Vec3 {
    [-along_u, -along_v, 1.0]
}

fn heights() -> Vec<Truth> {
    const HEIGHT_M: f64 = 3.0;
    // Per texel of four, where a tile is a fifth of the image.
    let of_step = |step: f64| HEIGHT_M * step * 4.0 * 0.2;
    let steps = [1.0, 2.0, 1.5].map(|step| step / 16.0);
    let texels: Vec<[f64; 3]> = (0..4).map(|column| steps.map(|step| step * f64::from(column + 1))).collect();
    let bytes = [20_u8, 70, 120, 170];
    let alphas = bytes.map(|byte| [255, 0, 10, byte]);
    let coloured = |channel: &str| {
        let map = json!({ "file": "three-slopes.hdr", "height_m": HEIGHT_M, "channel": channel, "wrap": "clamp" });
        (Value::Null, middle(map, 0.0))
    };
    let of_alpha = |channel: &str, height_m: f64| {
        let map = json!({ "file": "alphas.png", "height_m": height_m, "channel": channel, "wrap": "clamp" });
        (Value::Null, middle(map, 0.0))
    };
    let maps = [
        of_alpha("auto", HEIGHT_M),
        of_alpha("alpha", -HEIGHT_M),
        coloured("green"),
        coloured("blue"),
        coloured("luminance"),
        coloured("mean"),
    ];
    let luminance = 0.2126 * steps[0] + 0.7152 * steps[1] + 0.0722 * steps[2];
    let even = mean(&steps);
    let by_alpha = of_step(50.0 / 255.0);
    let along = |step: f64| slope(of_step(step), 0.0);
    let right =
        [slope(by_alpha, 0.0), slope(-by_alpha, 0.0), along(steps[1]), along(steps[2]), along(luminance), along(even)];
    let scene = mirrors("bump_map", &maps)
        .file("three-slopes.hdr", radiance_hdr(4, &texels))
        .file("alphas.png", rgba_png(&alphas));
    let channels = truth(
        "mirrors-bent-by-channels-of-an-image",
        &scene,
        &right,
        "mean of R(1 + 2 cos Z), n ∝ (−h′, 0, 1), h′ of alpha twice, of green, blue, luminance and the mean",
    )
    .allows(5e-5, "luminances of primaries of four digits; single precision")
    .or_else("red for alpha, which is flat", instead(&right, 0, slope(0.0, 0.0)))
    .or_else("white is high whatever the sign of the height", instead(&right, 1, right[0]))
    .or_else("red for green", instead(&right, 2, along(steps[0])))
    .or_else("green for blue", instead(&right, 3, along(steps[1])))
    .or_else("the mean for the luminance", instead(&right, 4, along(even)))
    .or_else("the luminance for the mean", instead(&right, 5, along(luminance)));

    // Between the second and the third texel, one texel about the place is from the one to the other.
    let encoded = |file: &str, encoding: &str| {
        let map = json!({
            "file": file, "height_m": 1e3 * HEIGHT_M, "channel": "red", "encoding": encoding, "wrap": "clamp", "uv_scale": [2e-4, 1],
            "uv_offset": [0.4999, 0],
        });
        (Value::Null, map)
    };
    // Grows by 1/8 a texel along u and 1/16 along v, four texels a side.
    let ramp: Vec<f64> =
        (0..4).rev().flat_map(|row| (0..4).map(move |column| f64::from(2 * column + row + 1) / 16.0)).collect();
    let on_ramp = || json!({ "file": "ramp.hdr", "height_m": HEIGHT_M });
    // By the angle of a triangle of sides 3, 4 and 5, about the middle.
    let turn = json!({ "wrap": "clamp", "uv_matrix": [[0.12, 0.16], [-0.16, 0.12]], "uv_offset": [0.36, 0.52] });
    let beyond = |wrap: &str, wrap_v: &str| {
        (Value::Null, middle(with(on_ramp(), &json!({ "wrap": wrap, "wrap_v": wrap_v })), 1.0))
    };
    let maps = [
        encoded("greys.png", "auto"),
        encoded("four-greys.hdr", "srgb"),
        (Value::Null, with(on_ramp(), &turn)),
        beyond("mirror", "repeat"),
        beyond("repeat", "clamp"),
        beyond("clamp", "mirror"),
    ];
    let greys = [0.125, 0.25, 0.5, 0.625];
    let (along_u, along_v) = (of_step(0.125), of_step(0.0625));
    let of_turn = |sine: f64| slope(0.6 * along_u - sine * along_v, sine * along_u + 0.6 * along_v);
    let step = |from: f64, to: f64| slope(of_step(to - from), 0.0);
    let [low, high] = [bytes[1], bytes[2]].map(|byte| f64::from(byte) / 255.0);
    let wrapped = |wrap: [Wrap; 2]| {
        let sign = wrap.map(|wrap| match wrap {
            Wrap::Repeat => 1.0,
            Wrap::Mirror => -1.0,
            Wrap::Clamp => 0.0,
        });
        slope(sign[0] * along_u, sign[1] * along_v)
    };
    let right = [
        step(decoded(low), decoded(high)),
        step(decoded(greys[1]), decoded(greys[2])),
        of_turn(0.8),
        wrapped([Wrap::Mirror, Wrap::Repeat]),
        wrapped([Wrap::Repeat, Wrap::Clamp]),
        wrapped([Wrap::Clamp, Wrap::Mirror]),
    ];
    let scene = mirrors("bump_map", &maps)
        .file("greys.png", grey_png(&bytes))
        .file("four-greys.hdr", grey_hdr(4, &greys))
        .file("ramp.hdr", grey_hdr(4, &ramp));
    let places = truth(
        "mirrors-bent-by-encodings-and-edges-of-an-image",
        &scene,
        &right,
        "mean of R(1 + 2 cos Z), n ∝ (−∂h/∂x, −∂h/∂y, 1), by two curves, turned, and beyond the edges: mirrored, repeated, ended",
    )
    .or_else("bytes taken as they are", instead(&right, 0, step(low, high)))
    .or_else("the curve left out", instead(&right, 1, step(greys[1], greys[2])))
    .or_else("turned the other way", instead(&right, 2, of_turn(-0.8)))
    .or_else("not turned", instead(&right, 2, slope(along_u, along_v)))
    .or_else("repeated for mirrored along u", instead(&right, 3, wrapped([Wrap::Repeat; 2])))
    .or_else("mirrored along v too", instead(&right, 3, wrapped([Wrap::Mirror; 2])))
    .or_else("repeated along v too", instead(&right, 4, wrapped([Wrap::Repeat; 2])))
    .or_else("ended along u too", instead(&right, 4, wrapped([Wrap::Clamp; 2])))
    .or_else("ended along v too", instead(&right, 5, wrapped([Wrap::Clamp; 2])))
    .or_else("mirrored along both", instead(&right, 5, wrapped([Wrap::Mirror; 2])));
    vec![channels, places]
}

fn normals() -> Truth {
    let of = |texel: [f64; 3]| texel.map(|x| 2.0 * x - 1.0);
    let tilted = [0.625, 0.4375, 0.9375];
    let two = [[0.75, 0.5, 0.9375], [0.5, 0.3125, 0.875]];
    let bytes = [190_u8, 170, 250, 255];
    let high = [0.75, 0.625, 0.984_375];
    // The texture coordinate u falls along x.
    let mirrored = json!({
        "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "uvs": [[1, 0], [0, 0], [0, 1], [1, 1]],
    });
    let turn = json!({ "file": "two-more-normals.hdr", "wrap": "clamp", "filter": "nearest", "uv_matrix": [[0.6, 0.8], [-0.8, 0.6]] });
    let maps = [
        (mirrored, json!({ "file": "another-tilted-normal.hdr", "bitangent": "across-u" })),
        (Value::Null, json!({ "file": "normal-by-bytes.png", "encoding": "auto" })),
        (Value::Null, json!({ "file": "normal-by-the-curve.hdr", "encoding": "srgb" })),
        (Value::Null, turn),
    ];
    let scene = mirrors("normal_map", &maps)
        .file("another-tilted-normal.hdr", radiance_hdr(1, &[tilted]))
        .file("normal-by-bytes.png", rgba_png(&[bytes]))
        .file("normal-by-the-curve.hdr", radiance_hdr(1, &[high]))
        .file("two-more-normals.hdr", radiance_hdr(2, &two));
    let [x, y, z] = of(tilted);
    let byte = [0, 1, 2].map(|k| f64::from(bytes[k]) / 255.0);
    let single = [[-x, -y, z], of(byte.map(decoded)), of(high.map(decoded))];
    let [left, right] = two.map(of);
    // The left one's share of the tile: below 0.6 u + 0.8 v = ½.
    let corner = 0.5 * (0.5 / 0.6) * (0.5 / 0.8);
    let all = move |single: [Vec3; 3], share: f64, seen: fn(Vec3) -> f64| {
        let of_two = share * seen(left) + (1.0 - share) * seen(right);
        (shown(&single, seen) * 3.0 + SHARES[3] * of_two) / 4.0
    };
    let instead = |at: usize, normal: Vec3| {
        let mut normals = single;
        normals[at] = normal;
        all(normals, corner, seen)
    };
    Truth::new(
        "mirrors-bent-by-normals-of-an-image",
        &scene,
        all(single, corner, seen),
        "mean of R(1 + 2 cos Z), n of the map along u, its bitangent and z; of the last tile A of one normal, 1 − A of another",
    )
    .because(BECAUSE)
    .confirmed("angles on the sphere", 1e-12, move || all(single, corner, seen_by_angles))
    .or_else("the normal of the shape", all([[0.0, 0.0, 1.0]; 3], corner, seen))
    .or_else("green along v", instead(0, [-x, y, z]))
    .or_else("red along x", instead(0, [x, y, z]))
    .or_else("bytes taken as they are", instead(1, of(byte)))
    .or_else("the curve left out", instead(2, of(high)))
    .or_else("not turned", all(single, 0.5, seen))
    .or_else("turned the other way", all(single, 1.0 - 0.5 * (1.0 / 6.0) * 0.125, seen))
    .sees(1e-3)
}

const ALBEDO: f64 = 0.7;

/// Of a Lambert surface under an even sky whose normal is tilted by β: ρ/π ∫ n·l G dω over light above surface and tilted plane alike.
fn dimmed_sky(normal: Vec3, a: f64) -> f64 {
    let n = normalize(normal);
    let (sin_b, cos_b) = (n[0].hypot(n[1]), n[2]);
    let ring = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        // Azimuths up to which n·l is above 0, and its integral over them.
        let limit = (-cos * cos_b / (sin * sin_b)).clamp(-1.0, 1.0).acos();
        let dim = 2.0 / (1.0 + (1.0 + a * (sin / cos).powi(2)).sqrt());
        sin * dim * 2.0 * (sin * sin_b * limit.sin() + cos * cos_b * limit)
    };
    let edge = 0.5 * PI - sin_b.asin();
    let parts = interval(ring, 1e-9, edge, 1e-11).value + interval(ring, edge, 0.5 * PI - 1e-9, 1e-11).value;
    ALBEDO / PI * parts
}

/// The same over directions around the tilted normal, each as likely as Lambert's law has it.
fn dimmed_sky_by_directions(normal: Vec3, a: f64) -> f64 {
    const STEPS: u32 = 1500;
    let n = normalize(normal);
    let (s, t) = frame(n);
    let step = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
    let all = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (step(i), 2.0 * PI * step(j))));
    let dim = |(squared, azimuth): (f64, f64)| {
        let (sin, cos) = (squared.sqrt(), (1.0 - squared).sqrt());
        let z = sin * (azimuth.cos() * s[2] + azimuth.sin() * t[2]) + cos * n[2];
        if z > 0.0 { 2.0 / (1.0 + (1.0 + a * (1.0 / (z * z) - 1.0)).sqrt()) } else { 0.0 }
    };
    ALBEDO * all.map(dim).sum::<f64>() / f64::from(STEPS).powi(2)
}

/// Maps that lose light: of the sun, and what is left of an even sky where it is dimmed.
fn losses() -> Vec<Truth> {
    // Along u, along v and outward: parts along the surface of (¼, −½, ¾), times 2; or a slope of ½ a texel's width along u.
    let normal_map = || ("normal_map", json!({ "file": "steep-normal.hdr", "strength": 2 }), [0.5, -1.0, 0.75]);
    let bump_map =
        || ("bump_map", json!({ "file": "ramp-along-u.hdr", "height_m": 1.2, "wrap": "clamp" }), [-1.2, 0.0, 1.0]);
    let scene = |kind: &'static str, map: &Value, terminator: &str| {
        let mut object = json!({ "shape": tile(0, 0.0), "material": lambert(ALBEDO) });
        object[kind] = with(map.clone(), &json!({ "terminator": terminator }));
        let scene = Scene::orthographic([0.5, 0.5, 2.0], [0.5, 0.5, 0.0], 0.2).thing(object).film(16, 16);
        match kind {
            "normal_map" => scene.file("steep-normal.hdr", radiance_hdr(1, &[[0.625, 0.25, 0.875]])),
            _ => scene.file("ramp-along-u.hdr", grey_hdr(4, &[0.25, 0.5, 0.75, 1.0])),
        }
    };
    let lost = |name: &str, (kind, map, normal): (&'static str, Value, Vec3), to_light: Vec3| {
        let (n, l) = (normalize(normal), normalize(to_light));
        let below = ALBEDO * dot(n, [l[0], l[1], -l[2]]);
        let value = ALBEDO * dot(n, l);
        let scene = scene(kind, &map, "lost").directional_light(scale(-1.0, l), PI).spp(64);
        Truth::new(name, &scene, value, "ρ n·l")
            .because(
                "A Lambert surface scatters around its changed normal n: in parallel light of irradiance π from l it shows ρ n·l. Light that would \
                 come from the mirror image of l in the surface has been lost.",
            )
            .confirmed("the lengths of the sum and the difference", 1e-12, move || {
                let sum: f64 = (0..3).map(|k| (n[k] + l[k]).powi(2)).sum();
                let difference: f64 = (0..3).map(|k| (n[k] - l[k]).powi(2)).sum();
                ALBEDO * 0.25 * (sum - difference)
            })
            .or_else("light mirrored back", value + below)
            .or_else("the normal of the shape", ALBEDO * l[2])
            .sees(1e-3)
    };
    let shadowed = |name: &str, (kind, map, normal): (&'static str, Value, Vec3)| {
        let n = normalize(normal);
        let a = ((n[0] * n[0] + n[1] * n[1]) / (n[2] * n[2]) / 8.0).min(1.0);
        let value = dimmed_sky(normal, a);
        Truth::new(name, &scene(kind, &map, "shadowed").sky(1.0).spp(1024), value, "ρ/π ∫ n·l 2/(1 + √(1 + a tan²θ)) dω, a = tan²β/8")
            .because(
                "Of an even sky of radiance 1 the changed normal n gathers n·l dω/π from above the surface and above the plane across it. Facets of \
                 the width √a hide a part of what comes at θ to the surface's own normal (Estevez, Lecocq & Stein 2019).",
            )
            .confirmed("sums over directions around the changed normal", 1e-3, move || dimmed_sky_by_directions(normal, a))
            .or_else("not dimmed", ALBEDO * 0.5 * (1.0 + n[2]))
            .or_else("light mirrored back", ALBEDO)
            .or_else("not an eighth", dimmed_sky(normal, (8.0 * a).min(1.0)))
            .sees(3e-3)
    };
    vec![
        lost("normal-map-that-loses-the-low-sun", normal_map(), [0.4, -0.8, 0.3]),
        lost("bump-map-that-loses-the-low-sun", bump_map(), [-0.9, 0.2, 0.35]),
        shadowed("normal-map-with-shadows-under-a-sky", normal_map()),
        shadowed("bump-map-with-shadows-under-a-sky", bump_map()),
    ]
}
