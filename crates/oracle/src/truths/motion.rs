//! What moves while the shutter is open: its picture is the mean over that time.
//!
//! Time runs from 0 to 1 s, unless a name says otherwise. Each value is an integral over time in closed form, confirmed by quadrature of
//! what is to be seen at each moment.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{Scene, black, disk, parallelogram, shown, sphere},
};
use crate::quadrature::{interval, rectangle};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![passing_bar(), turning_blade(), circling_camera(), receding_sphere(), growing_disk()];
    list.extend(
        [("camera-passing-an-edge", [0.0, 1.0]), ("camera-passing-an-edge-after-two-seconds", [2.0, 3.0])]
            .map(passing_camera),
    );
    list.extend(["mis", "light", "bsdf"].map(approaching_disk));
    list.push(departing_square());
    list.into_iter().map(|truth| truth.claims(Claim::Motion)).collect()
}

/// A keyframe, its transform a list of steps.
fn at(time_s: f64, steps: &Value) -> Value {
    json!({ "time_s": time_s, "transform": steps })
}

fn moved(v: [f64; 3]) -> Value {
    json!([{ "translate_m": v }])
}

fn turned(angle_deg: f64) -> Value {
    json!([{ "rotate": { "axis": [0, 0, 1], "angle_deg": angle_deg } }])
}

fn lamp(shape: Value, sides: &str) -> Value {
    json!({ "shape": shape, "material": black(), "emission": { "radiance": 1, "sides": sides } })
}

/// One camera pixel of a metre, looking down on the plane z = 0 about (x, y).
fn pixel(x: f64, y: f64, height_m: f64) -> Scene {
    Scene::orthographic([x, y, 3.0], [x, y, 0.0], height_m).up([0.0, 1.0, 0.0]).film(1, 1).spp(1 << 16)
}

fn passing_bar() -> Truth {
    // It crosses the pixel and goes on more slowly: 3 m in the first quarter of the time, 1 m in the rest.
    let keys = [at(0.0, &moved([-2.0, 0.0, 0.0])), at(0.25, &moved([1.0, 0.0, 0.0])), at(1.0, &moved([2.0, 0.0, 0.0]))];
    let bar = parallelogram([-0.25, -1.0, 0.0], [0.5, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let scene = pixel(0.0, 0.0, 1.0).shutter([0.0, 1.0]).moving(&[lamp(bar, "front")], &keys);
    // A point of the pixel at x is covered while |x − c(t)| < ¼. The centre passes at 12 m/s up to 1 m: all of that is fast.
    let share = 0.5 / 12.0;
    // What the bar still covers as it slows down: none, its edge is at 0.75 m then.
    let centre = |t: f64| if t < 0.25 { -2.0 + 12.0 * t } else { 1.0 + (t - 0.25) / 0.75 };
    let overlap = move |c: f64| ((c + 0.25).min(0.5) - (c - 0.25).max(-0.5)).max(0.0);
    Truth::new("bar-passing-a-pixel", &scene, share, "½ m / (12 m/s)")
        .because(
            "A point is lit while the bar, half a metre wide, is before it. The bar passes at 12 m/s: it is before each point of the \
             pixel for 1/24 s.",
        )
        .confirmed("quadrature of the covered part over time", 1e-9, move || {
            // Between the times at which its edges pass those of the pixel the covered part is linear.
            let times = [1.25, 1.75, 2.25, 2.75].map(|x: f64| x / 12.0);
            times.windows(2).map(|t| interval(|t| overlap(centre(t)), t[0], t[1], 1e-14).value).sum()
        })
        .or_else("as the shutter opens", 0.0)
        .or_else("in the middle of the time", overlap(centre(0.5)))
        .or_else("keyframes taken to be equally far apart in time", 0.5 / 6.0)
        // x = u − ½ is before the bar while |x + 2 − 12t| < ¼; with t = u that is |1.5 − 11u| < ¼.
        .or_else("time by the number that places the sample along x", 0.5 / 11.0)
}

/// A quarter plane whose edge turns through the pixel.
fn turning_blade() -> Truth {
    let (first, last) = (10.0_f64, 100.0);
    // Behind its leading edge it reaches over 90°.
    let blade = parallelogram([0.0, 0.0, 0.0], [0.0, -4.0, 0.0], [4.0, 0.0, 0.0]);
    let scene = pixel(1.0, 1.0, 0.6)
        .shutter([0.0, 1.0])
        .moving(&[lamp(blade, "both")], &[at(0.0, &turned(first)), at(1.0, &turned(last))]);
    let value = (last - 45.0) / (last - first);
    // The part of the pixel that lies below an edge at this angle.
    let below = |angle_deg: f64| {
        let slope = angle_deg.to_radians().tan();
        interval(|x| ((slope * x).clamp(0.7, 1.3) - 0.7) / 0.6, 0.7, 1.3, 1e-9).value / 0.6
    };
    let mean_angle = |of: &dyn Fn(f64) -> f64| {
        rectangle(|x, y| of(y.atan2(x).to_degrees()), [0.7, 1.3], [0.7, 1.3], 1e-9, 200_000).value / 0.36
    };
    // Matrices mixed in proportion turn by atan(u/(1 − u)).
    let mixed = mean_angle(&|angle| {
        let t = (angle - first).to_radians().tan();
        1.0 - t / (1.0 + t)
    });
    Truth::new("blade-turning-through-a-pixel", &scene, value, "(100° − 45°)/90°")
        .because(
            "The edge turns at a constant rate from 10° to 100° and passes the point at polar angle φ when (φ − 10°)/90° of the time is \
             over; from then on the point is lit. The pixel is symmetric about the diagonal, so that the mean of φ is 45°.",
        )
        .confirmed("quadrature over the pixel of the share of time", 1e-8, || {
            let mean = |x: f64, y: f64| (100.0 - y.atan2(x).to_degrees()) / 90.0;
            rectangle(mean, [0.7, 1.3], [0.7, 1.3], 1e-12, 200_000).value / 0.36
        })
        .or_else("as the shutter opens", 0.0)
        .or_else("in the middle of the time", below(55.0))
        .or_else("matrices mixed in proportion to time", mixed)
}

fn passing_camera((name, [opens, closes]): (&str, [f64; 2])) -> Truth {
    let keys = [at(opens, &moved([-1.0, 0.0, 0.0])), at(closes, &moved([3.0, 0.0, 0.0]))];
    let half = parallelogram([0.0, -9.0, 0.0], [9.0, 0.0, 0.0], [0.0, 18.0, 0.0]);
    let scene = pixel(0.0, 0.0, 1.0).shutter([opens, closes]).camera_keys(&keys).lamp(half, black(), 1.0, "front");
    let truth = Truth::new(name, &scene, 0.75, "3 m / 4 m")
        .because("The camera moves from −1 m to 3 m over a plane that is lit beyond 0 m; the middle of the picture is there for 3/4 of the time, and the two sides of it by as much more and less.")
        .confirmed("quadrature over time of the lit part", 1e-9, || {
            let lit = |c: f64| (c + 0.5).clamp(0.0, 1.0);
            [[-1.0, -0.5], [-0.5, 0.5], [0.5, 3.0]].map(|[a, b]| interval(lit, a, b, 1e-14).value).iter().sum::<f64>() / 4.0
        })
        .or_else("as the shutter opens", 0.0)
        .or_else("in the middle of the time", 1.0);
    // The camera then moves in 1/closes of the time, and rests.
    if opens > 0.0 { truth.or_else("times of keys divided by the time of closing", 1.0 - 0.25 / closes) } else { truth }
}

/// A camera that goes around what it looks at, as on a turntable: it sees one side of a card for a third of the time.
fn circling_camera() -> Truth {
    // About z by 150°, from 60° before the card's plane to 90° behind it; a key every half of it.
    let keys = [at(0.0, &turned(0.0)), at(0.5, &turned(75.0)), at(1.0, &turned(150.0))];
    // At 0° the camera stands at 60° from the plane of the card, on its bright side.
    let (sine, cosine) = (60.0_f64).to_radians().sin_cos();
    let position = [3.0 * cosine, -3.0 * sine, 0.0];
    // The card stands in the plane y = 0; seen under the angle ψ from the plane it is |sin ψ| times as wide.
    let card = parallelogram([-2.0, 0.0, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]);
    let scene = Scene::orthographic(position, [0.0; 3], 8.0)
        .up([0.0, 0.0, 1.0])
        .film(1, 1)
        .spp(1 << 18)
        .shutter([0.0, 1.0])
        .camera_keys(&keys)
        .lamp(card, black(), 1.0, "front");
    // −y is the front: the edges cross that way. From −60° to 0°: ∫ sin = 1 − cos 60°.
    let share = 16.0 / 64.0;
    let value = share * (1.0 - cosine) / 150.0_f64.to_radians();
    Truth::new("camera-circling-a-card", &scene, value, "¼(1 − cos 60°)/(150°·π/180°)")
        .because(
            "A card of 4 m that fills a quarter of the picture when it is seen head-on, under the angle ψ |sin ψ| times that. The camera \
             goes from ψ = −60° to 90° at a constant rate; only on the side of the negative angles does the card shine.",
        )
        .confirmed("quadrature over time", 1e-9, move || {
            let seen = |t: f64| share * (60.0 - 150.0 * t).to_radians().sin();
            interval(seen, 0.0, 0.4, 1e-14).value
        })
        .or_else("as the shutter opens", share * sine)
        .or_else("in the middle of the time", 0.0)
}

fn receding_sphere() -> Truth {
    let (radius, near, far) = (0.5, 1.5, 6.0);
    let keys = [at(0.0, &moved([0.0, 0.0, near])), at(1.0, &moved([0.0, 0.0, far]))];
    let scene = Scene::light_meter().shutter([0.0, 1.0]).moving(&[lamp(sphere([0.0; 3], radius), "front")], &keys);
    let e = |z: f64| PI * radius * radius / (z * z);
    Truth::new("sphere-light-receding", &scene, shown(PI * radius * radius / (near * far)), "(ρ/π)·πr²/(z₀z₁)")
        .because("A sphere of radiance 1 above a plate gives π(r/z)²; the mean over z from z₀ to z₁ at a constant rate is πr²/(z₀z₁).")
        .confirmed("quadrature over time of the cosine over the cone", 1e-8, move || {
            let of = |z: f64| {
                let sine = radius / z;
                2.0 * PI * interval(|angle| angle.sin() * angle.cos(), 0.0, sine.asin(), 1e-14).value
            };
            shown(interval(|t| of(near + (far - near) * t), 0.0, 1.0, 1e-13).value)
        })
        .or_else("as the shutter opens", shown(e(near)))
        .or_else("in the middle of the time", shown(e(0.5 * (near + far))))
}

fn approaching_disk(how: &'static str) -> Truth {
    let (radius, near, far) = (1.0, 0.75, 4.0);
    let keys = [at(0.0, &moved([0.0, 0.0, far])), at(1.0, &moved([0.0, 0.0, near]))];
    let facing = disk([0.0; 3], [0.0, 0.0, -1.0], radius);
    let scene =
        Scene::light_meter().shutter([0.0, 1.0]).moving(&[lamp(facing, "front")], &keys).light_sampling(how).spp(4096);
    let e = move |z: f64| PI * radius * radius / (z * z + radius * radius);
    let mean = PI * radius * ((far / radius).atan() - (near / radius).atan()) / (far - near);
    Truth::new(
        format!("disk-light-approaching-by-{how}"),
        &scene,
        shown(mean),
        "(ρ/π)·πR(atan z₁/R − atan z₀/R)/(z₁ − z₀)",
    )
    .because("A disk of radiance 1 above a plate gives πR²/(R² + z²), whose mean over z is that.")
    .confirmed("quadrature over time and the disk", 1e-7, move || {
        // Rings: z²/(ρ² + z²)² is the form factor of an element.
        let of = |t: f64, ring: f64| {
            let z = far + (near - far) * t;
            2.0 * PI * ring * z * z / (ring * ring + z * z).powi(2)
        };
        shown(rectangle(of, [0.0, 1.0], [0.0, radius], 1e-11, 400_000).value)
    })
    .or_else("as the shutter opens", shown(e(far)))
    .or_else("in the middle of the time", shown(e(0.5 * (near + far))))
}

fn growing_disk() -> Truth {
    let (small, large, z) = (0.25, 4.0, 1.5);
    let scaled = |s: f64| json!([{ "scale": s }, { "translate_m": [0.0, 0.0, z] }]);
    let keys = [at(0.0, &scaled(small)), at(1.0, &scaled(large))];
    let facing = disk([0.0; 3], [0.0, 0.0, -1.0], 1.0);
    let scene = Scene::light_meter().shutter([0.0, 1.0]).moving(&[lamp(facing, "front")], &keys);
    let e = move |r: f64| PI * r * r / (z * z + r * r);
    let mean = PI * (1.0 - z * ((large / z).atan() - (small / z).atan()) / (large - small));
    Truth::new("disk-light-growing", &scene, shown(mean), "(ρ/π)·π(1 − z(atan R₁/z − atan R₀/z)/(R₁ − R₀))")
        .because("A disk of radiance 1 above a plate gives πR²/(R² + z²), whose mean over R from R₀ to R₁ is that.")
        .confirmed("quadrature over time and the disk", 1e-7, move || {
            let of = |t: f64, share: f64| {
                let r = small + (large - small) * t;
                let ring = share * r;
                2.0 * PI * ring * r * z * z / (ring * ring + z * z).powi(2)
            };
            shown(rectangle(of, [0.0, 1.0], [0.0, 1.0], 1e-11, 400_000).value)
        })
        .or_else("as the shutter opens", shown(e(small)))
        .or_else("in the middle of the time", shown(e(0.5 * (small + large))))
        .or_else(
            "the area of the opening",
            shown(
                interval(
                    |t| {
                        let r = small + (large - small) * t;
                        e(r) * (small / r).powi(2)
                    },
                    0.0,
                    1.0,
                    1e-12,
                )
                .value,
            ),
        )
}

/// Irradiance of a square of half side `a` at the height `z` over the plate, from the factor of its corner.
fn square_irradiance(a: f64, z: f64) -> f64 {
    // Four corners of a/z by a/z: F = (2/2π)·(X/√(1+X²))·atan(X/√(1+X²)), E = πF.
    let x = a / z;
    let s = x / (1.0 + x * x).sqrt();
    4.0 * s * s.atan()
}

fn departing_square() -> Truth {
    let (near, far) = (0.5, 3.0);
    let keys = [at(0.0, &moved([0.0, 0.0, near])), at(1.0, &moved([0.0, 0.0, far]))];
    // Front downward.
    let facing = parallelogram([-1.0, -1.0, 0.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
    let scene = Scene::light_meter().shutter([0.0, 1.0]).moving(&[lamp(facing, "front")], &keys);
    let mean = interval(|t| square_irradiance(1.0, near + (far - near) * t), 0.0, 1.0, 1e-13).value;
    Truth::new("square-light-departing", &scene, shown(mean), "(ρ/π)·∫₀¹ 4s·atan s dt, s = 1/√(1 + z²), z = 0.5 + 2.5t")
        .because(
            "A square of half side a and radiance 1 above the middle of a plate gives 4s·atan s, s = a/√(a² + z²), the sum over its \
             corners; its mean over time by quadrature of a smooth function of one variable.",
        )
        .confirmed("Lambert's formula for polygons, its mean over time", 1e-9, move || {
            let of = |z: f64| {
                let corners = [[-1.0, -1.0, z], [-1.0, 1.0, z], [1.0, 1.0, z], [1.0, -1.0, z]];
                super::lambert_polygon(&corners, [0.0, 0.0, 1.0])
            };
            shown(interval(|t| of(near + (far - near) * t), 0.0, 1.0, 1e-13).value)
        })
        .or_else("as the shutter opens", shown(square_irradiance(1.0, near)))
        .or_else("in the middle of the time", shown(square_irradiance(1.0, 0.5 * (near + far))))
}
