//! Images of everything around: where each texel lies, how the image is turned, what light its texels give.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    expectation::Expectation,
    scene::{PLATE_ALBEDO, Scene, black, grey_hdr, sphere},
    sphere_irradiance,
};
use crate::{
    quadrature::{Cone, directions, interval},
    vector::{Vec3, add, cross, dot, normalize, scale},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = seen();
    list.extend(on_a_plate());
    list.extend(beside_a_lamp());
    list.extend(bright_in_grey());
    list.into_iter().map(|truth| truth.claims(Claim::PhotometricSensor)).collect()
}

/// Thirty-two numbers without a pattern, multiples of 1/16.
fn texels() -> Vec<f64> {
    (0..32_u32).map(|i| f64::from((i * i * 7 + 5 * i + 3) % 16 + 1) / 16.0).collect()
}

/// How an image lies in the world.
#[derive(Clone, Copy)]
struct Pose {
    up: Vec3,
    forward: Vec3,
    rotation_deg: f64,
    mirrored: bool,
}

const PLAIN: Pose = Pose { up: [0.0, 1.0, 0.0], forward: [0.0, 0.0, -1.0], rotation_deg: 0.0, mirrored: false };

impl Pose {
    /// Right, forward and up.
    fn axes(self) -> [Vec3; 3] {
        let up = normalize(self.up);
        let level = add(self.forward, scale(-dot(self.forward, up), up));
        let (forward, left) = (normalize(level), cross(up, normalize(level)));
        // Counter-clockwise, seen with `up` toward the viewer: forward turns toward the left.
        let (sin, cos) = self.rotation_deg.to_radians().sin_cos();
        let turned = add(scale(cos, forward), scale(sin, left));
        let right = scale(if self.mirrored { -1.0 } else { 1.0 }, cross(turned, up));
        [right, turned, up]
    }

    /// The shares of a direction to the right, forward and up.
    fn along(self, d: Vec3) -> [f64; 3] {
        self.axes().map(|axis| dot(d, axis))
    }
}

/// The image of 8 × 4 texels by longitude and latitude, interpolated. `at_poles`: the first and last row lie at the poles.
fn by_latitude(texels: &[f64], at_poles: bool, [right, forward, up]: [f64; 3]) -> f64 {
    let (u, polar) = (0.5 + right.atan2(forward) / TAU, up.clamp(-1.0, 1.0).acos() / PI);
    let x = u * 8.0 - 0.5;
    let y = if at_poles { polar * 3.0 } else { (polar * 4.0 - 0.5).clamp(0.0, 3.0) };
    let (i, j) = (x.floor(), y.floor().min(2.0));
    let texel = |i: f64, j: f64| texels[j as usize * 8 + (i.rem_euclid(8.0)) as usize];
    let row = |j: f64| (1.0 - (x - i)) * texel(i, j) + (x - i) * texel(i + 1.0, j);
    (1.0 - (y - j)) * row(j) + (y - j) * row(j + 1.0)
}

/// The square of 4 × 4 texels of equal solid angle: the square of side 2 about the origin, |x| + |y| = √(1 − cos) in the upper half, the
/// angle by the share of it that is |y|; the lower half folded outward.
fn by_area(texels: &[f64], [right, forward, up]: [f64; 3]) -> f64 {
    let turn = forward.abs().atan2(right.abs()) / (0.5 * PI);
    let r = (1.0 - up.abs()).max(0.0).sqrt();
    let (x, y) = (r * (1.0 - turn), r * turn);
    let (x, y) = if up < 0.0 { (1.0 - y, 1.0 - x) } else { (x, y) };
    let (x, y) = (x.copysign(right), y.copysign(forward));
    let place = |x: f64| ((0.5 + 0.5 * x) * 4.0).floor().clamp(0.0, 3.0) as usize;
    texels[place(y) * 4 + place(x)]
}

type Look = fn(&[f64], [f64; 3]) -> f64;

fn pose_json(pose: Pose, image: Value) -> Value {
    let mut image = image;
    (image["up"], image["forward"]) = (json!(pose.up), json!(pose.forward));
    (image["rotation_deg"], image["mirrored"]) = (json!(pose.rotation_deg), json!(pose.mirrored));
    json!({ "type": "environment", "image": image })
}

/// Pictures of the sky itself.
fn seen() -> Vec<Truth> {
    let turned = Pose { up: [0.3, 0.2, 1.0], forward: [1.0, 0.5, 0.2], rotation_deg: 40.0, mirrored: false };
    let mirrored = Pose { mirrored: true, ..turned };
    let (view, half) = (normalize([0.5, 0.3, -1.0]), 0.7);
    let (right, up) = {
        let right = normalize(cross(view, [0.0, 1.0, 0.0]));
        (right, cross(right, view))
    };
    let mean = move |steps: u32, look: Look, image: &[f64], pose: Pose| {
        let axes = pose.axes();
        let at = |k: u32| half * (2.0 * (f64::from(k) + 0.5) / f64::from(steps) - 1.0);
        let row = |j: u32| {
            let ray = |i: u32| normalize(add(view, add(scale(at(i), right), scale(at(j), up))));
            let seen = |ray: Vec3| look(image, axes.map(|axis| dot(ray, axis)));
            (0..steps).map(|i| seen(ray(i))).sum::<f64>()
        };
        (0..steps).map(row).sum::<f64>() / f64::from(steps).powi(2)
    };
    let latitude: Look = |image, along| by_latitude(image, false, along);
    let poles: Look = |image, along| by_latitude(image, true, along);
    let area: Look = |image, along| by_area(&image[..16], along);
    let cases: [(&str, &str, Look, Pose, f64); 7] = [
        ("sky-image", "latitude-longitude", latitude, PLAIN, 1.0),
        ("sky-image-twice-as-bright", "latitude-longitude", latitude, PLAIN, 2.0),
        ("sky-image-turned", "latitude-longitude", latitude, turned, 1.0),
        ("sky-image-turned-and-mirrored", "latitude-longitude", latitude, mirrored, 1.0),
        ("sky-image-with-rows-at-the-poles", "latitude-longitude-at-poles", poles, turned, 1.0),
        ("sky-image-of-equal-areas", "equal-area", area, PLAIN, 1.0),
        ("sky-image-of-equal-areas-turned-and-mirrored", "equal-area", area, mirrored, 1.0),
    ];
    cases
        .into_iter()
        .map(|(name, projection, look, pose, factor)| {
            let image = texels();
            let (file, bytes) = match projection {
                "equal-area" => ("sky-4x4.hdr", grey_hdr(4, &image[..16])),
                _ => ("sky-8x4.hdr", grey_hdr(8, &image)),
            };
            let mut description = json!({ "file": file, "projection": projection });
            if factor != 1.0 {
                description["scale"] = json!(factor);
            }
            let scene = Scene::pinhole([0.0; 3], view, 2.0 * half.atan().to_degrees())
                .light(pose_json(pose, description))
                .file(file, bytes)
                .spp(1024);
            let own = image.clone();
            let (exact, steps) = if projection == "equal-area" { (3e-3, 1200) } else { (2e-4, 400) };
            let work_out = move || {
                let with = |pose: Pose| factor * mean(80, look, &image, pose);
                let value = factor * mean(steps, look, &image, pose);
                let mut expectation = Expectation::new(value)
                    .allows(exact * 0.1 * value, "the mean over a grid of rays is known to a tenth of what two grids differ by; and single precision")
                    .or_else("left and right exchanged", with(Pose { mirrored: !pose.mirrored, ..pose }))
                    .or_else("turned by an eighth of a turn", with(Pose { rotation_deg: pose.rotation_deg + 45.0, ..pose }))
                    .or_else("upside down", with(Pose { up: scale(-1.0, pose.up), mirrored: !pose.mirrored, ..pose }));
                if pose.rotation_deg != 0.0 {
                    expectation =
                        expectation.or_else("turned the other way", with(Pose { rotation_deg: -pose.rotation_deg, ..pose }));
                }
                if factor != 1.0 {
                    expectation = expectation.or_else("the scale left out", value / factor);
                }
                expectation
            };
            Truth::later(name, &scene, "mean over the picture of the image in the direction of each ray", work_out)
                .because(
                    "A ray that meets nothing shows the image where its direction lies on it: longitude and latitude, between the centres of \
                     texels, or the texel of a map of equal areas (Clarberg 2008). Grey light has the luminance of its number.",
                )
                .confirmed("the same on another grid of rays", exact, move || factor * mean(777, look, &own, pose))
                .sees(0.01)
        })
        .collect()
}

const BRIGHT: f64 = 32.0;
const UPRIGHT: Pose = Pose { up: [0.0, 0.0, 1.0], forward: [0.6, -0.8, 0.0], rotation_deg: 0.0, mirrored: false };

/// ∫ over polar angles of the tent of a row about a centre, constant beyond it toward the pole, times cos θ sin θ.
fn of_row(row: f64) -> f64 {
    let centre = (row + 0.5) * PI / 4.0;
    let tent = move |theta: f64| {
        let off = (theta - centre) / (PI / 4.0);
        let weight = if row == 0.0 && off < 0.0 { 1.0 } else { (1.0 - off.abs()).max(0.0) };
        weight * theta.cos() * theta.sin()
    };
    let up_to = |from: f64, to: f64| interval(tent, from, to, 1e-12).value;
    let last = (centre + PI / 4.0).min(0.5 * PI);
    up_to(0.0, centre) + up_to(centre, last)
}

fn shown(irradiance: f64) -> f64 {
    PLATE_ALBEDO * irradiance / PI
}

/// A light meter under an image of which one texel shines, and a lamp on the other side, where the image is black.
fn beside_a_lamp() -> Vec<Truth> {
    const LAMP: f64 = 150.0;
    let (tilt, distance_m, radius_m) = (40_f64.to_radians(), 2.0, 0.3);
    let mut image = vec![0.0; 32];
    image[8 + 3] = BRIGHT;
    let from_sky = BRIGHT * TAU / 8.0 * of_row(1.0);
    let from_lamp = LAMP * sphere_irradiance(radius_m, distance_m, tilt);
    let level = scale(-tilt.sin(), UPRIGHT.forward);
    let toward = [level[0], level[1], tilt.cos()];
    let lamp = sphere(scale(distance_m, toward), radius_m);
    ["mis", "light", "bsdf"]
        .map(|how| {
            let image = image.clone();
            let scene = Scene::light_meter()
                .light(pose_json(UPRIGHT, json!({ "file": "bright-3-1.hdr", "projection": "latitude-longitude" })))
                .file("bright-3-1.hdr", grey_hdr(8, &image))
                .lamp(lamp.clone(), black(), LAMP, "front")
                .light_sampling(how)
                .spp(4096);
            let value = shown(from_sky + from_lamp);
            let formula = "(ρ/π)(L 2π/8 ∫ tent(θ) cos θ sin θ dθ + L′ π(R/d)² cos β)";
            Truth::new(format!("sky-with-one-bright-texel-beside-a-lamp-by-{how}"), &scene, value, formula)
                .because("Light adds up: what a sky throws on a plate does not depend on a lamp that hides a black part of it.")
                .confirmed("quadrature over the directions above", 1e-3, move || {
                    let cone = Cone { axis: [0.0, 0.0, 1.0], one_minus_cos: 1.0 };
                    let rim = (1.0 - (radius_m / distance_m).powi(2)).sqrt();
                    let radiance = |d: Vec3| {
                        if dot(d, toward) > rim { LAMP } else { by_latitude(&image, false, UPRIGHT.along(d)) }
                    };
                    shown(directions(|d: Vec3| radiance(d) * d[2].max(0.0), cone, 1e-3, 3_000_000).value)
                })
                .or_else("the sky counted twice", shown(2.0 * from_sky + from_lamp))
                .or_else("the lamp counted twice", shown(from_sky + 2.0 * from_lamp))
                .sees(0.01)
        })
        .into()
}

/// A light meter under an image.
fn meter(file: &str, width: usize, texels: &[f64], projection: &str, how: &'static str) -> Scene {
    Scene::light_meter()
        .light(pose_json(UPRIGHT, json!({ "file": file, "projection": projection })))
        .file(file, grey_hdr(width, texels))
        .light_sampling(how)
        .spp(4096)
}

/// A light meter under an image of which one texel shines.
fn on_a_plate() -> Vec<Truth> {
    let upright = UPRIGHT;
    let mut list = Vec::new();
    for (name, column, row, how) in [
        ("sky-with-one-bright-texel", 3_usize, 1_usize, "mis"),
        ("sky-with-one-bright-texel-by-light", 3, 1, "light"),
        ("sky-with-one-bright-texel-by-bsdf", 3, 1, "bsdf"),
        ("sky-with-one-bright-texel-at-the-seam", 0, 1, "mis"),
        ("sky-with-one-bright-texel-at-the-pole", 5, 0, "mis"),
        ("sky-with-one-bright-texel-at-the-pole-by-light", 5, 0, "light"),
    ] {
        let mut image = vec![0.0; 32];
        image[row * 8 + column] = BRIGHT;
        let file = format!("bright-{column}-{row}.hdr");
        let value = shown(BRIGHT * TAU / 8.0 * of_row(row as f64));
        list.push(
            Truth::new(name, &meter(&file, 8, &image, "latitude-longitude", how), value, "(ρ/π) L 2π/8 ∫ tent(θ) cos θ sin θ dθ")
                .because(
                    "Interpolation makes one bright texel a tent in longitude and in latitude, constant from its centre to the pole in the row \
                     there; irradiance is the integral of radiance times cos θ.",
                )
                .confirmed("quadrature over the directions above", 1e-4, move || {
                    let cone = Cone { axis: [0.0, 0.0, 1.0], one_minus_cos: 1.0 };
                    let integrand = |d: Vec3| by_latitude(&image, false, upright.along(d)) * d[2].max(0.0);
                    shown(directions(integrand, cone, 1e-7, 3_000_000).value)
                })
                .or_else("as large as a texel in the middle", shown(BRIGHT * TAU / 8.0 * PI / 4.0))
                .sees(0.02),
        );
    }
    // A texel of the inner ring: |x| and |y| from 0 to ½, cos θ = 1 − (|x| + |y|)²; its mean is 1 − 1/6 − 1/8.
    let mut image = vec![0.0; 16];
    image[2 * 4 + 1] = BRIGHT;
    let value = shown(BRIGHT * PI / 4.0 * (1.0 - 1.0 / 6.0 - 1.0 / 8.0));
    for how in ["mis", "light"] {
        let image = image.clone();
        list.push(
            Truth::new(
                format!("sky-of-equal-areas-with-one-bright-texel-by-{how}"),
                &meter("bright-of-equal-areas.hdr", 4, &image, "equal-area", how),
                value,
                "(ρ/π) L π/4 (1 − 1/6 − 1/8)",
            )
            .because("Each of sixteen texels is π/4 sr; in one next to the middle cos θ = 1 − (|x| + |y|)², |x| and |y| from 0 to ½.")
            .confirmed("quadrature over the directions above", 2e-3, move || {
                let cone = Cone { axis: [0.0, 0.0, 1.0], one_minus_cos: 1.0 };
                let integrand = |d: Vec3| by_area(&image, upright.along(d)) * d[2].max(0.0);
                shown(directions(integrand, cone, 1e-4, 3_000_000).value)
            })
            .or_else("the height taken for that of the middle of the texel", shown(BRIGHT * PI / 4.0 * 0.75))
            .sees(0.01),
        );
    }
    list
}

/// A light meter under a grey image of which one texel is brighter. Shadow rays may leave the grey to paths.
fn bright_in_grey() -> Vec<Truth> {
    const GREY: f64 = 1.0;
    let by_rows = |bright: f64, grey: f64| grey * PI + bright * TAU / 8.0 * of_row(1.0);
    let by_areas = |bright: f64, grey: f64| grey * PI + bright * PI / 4.0 * (1.0 - 1.0 / 6.0 - 1.0 / 8.0);
    let by_rows_of: Look = |image, along| by_latitude(image, false, along);
    let mut list = Vec::new();
    for how in ["mis", "light", "bsdf"] {
        let skies: [(&str, &str, usize, usize, f64, f64, Look); 2] = [
            (
                "grey-sky",
                "latitude-longitude",
                8,
                8 + 3,
                by_rows(BRIGHT, 0.0),
                by_rows(BRIGHT - GREY, GREY),
                by_rows_of,
            ),
            (
                "grey-sky-of-equal-areas",
                "equal-area",
                4,
                2 * 4 + 1,
                by_areas(BRIGHT, 0.0),
                by_areas(BRIGHT - GREY, GREY),
                by_area,
            ),
        ];
        for (name, projection, width, place, of_bright, value, look) in skies {
            let mut image = vec![GREY; width * 4];
            image[place] = BRIGHT;
            let scene = meter(&format!("{name}.hdr"), width, &image, projection, how);
            let truth = Truth::new(
                format!("{name}-with-one-bright-texel-by-{how}"),
                &scene,
                shown(value),
                "(ρ/π)(π L + (L′ − L) E₁), E₁ of a texel of radiance 1",
            )
            .because("Light adds up: a grey sky, and what one texel shines with beyond that.")
            .confirmed("quadrature over the directions above", 2e-3, move || {
                let cone = Cone { axis: [0.0, 0.0, 1.0], one_minus_cos: 1.0 };
                let integrand = |d: Vec3| look(&image, UPRIGHT.along(d)) * d[2].max(0.0);
                shown(directions(integrand, cone, 1e-4, 3_000_000).value)
            })
            .or_else("the bright texel alone", shown(of_bright))
            .or_else("the grey found twice", shown(value + GREY * PI))
            .sees(0.01);
            list.push(truth);
        }
    }
    list
}
