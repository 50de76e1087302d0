//! Cameras whose keys act together: sensors with lenses, turned and moving lenses of many surfaces, filters over a corner; and a grid of meters.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    lens_tracer::{Lens, Surface, spherical},
    meters::measured,
    scene::{Scene, black, disk, parallelogram},
    tiles::with,
};
use crate::{
    quadrature::interval,
    vector::{Vec3, add, length, scale, sub},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![edge_out_of_focus(), passing(), from_above(), rolled(), moving_left(), asphere(), grid()];
    list.extend(filters());
    list
}

/// The share of a unit disk beyond the distance x of a chord from its middle.
fn beyond(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    (x.acos() - x * (1.0 - x * x).sqrt()) / PI
}

/// A pixel beside the middle of a wide picture, and the edge of a lamp behind the plane of focus.
fn edge_out_of_focus() -> Truth {
    const COLUMNS: u32 = 2;
    let (f, focus, depth, sensor_m, edge) = (0.05, 2.0, 5.0, 6e-4, 0.02);
    let scene = Scene::camera(json!({
        "type": "perspective", "position_m": [0, 0, 0], "direction": [0, 0, -1], "sensor_width_m": sensor_m, "focal_length_m": f,
        "lens": { "f_number": 2, "focus_distance_m": focus },
    }))
    .lamp(parallelogram([edge, -5.0, -depth], [5.0, 0.0, 0.0], [0.0, 10.0, 0.0]), black(), 1.0, "front")
    .film(COLUMNS, 1)
    .spp(1 << 16);
    let image = f * focus / (focus - f);
    let pixel = |sensor_m: f64, image: f64| sensor_m * depth / image / f64::from(COLUMNS);
    let blur = |radius: f64| radius * (depth - focus) / focus;
    // The pixel is from 0 to w, the circle of confusion has the radius c.
    let seen = move |w: f64, c: f64| {
        let at = |x: f64| beyond((edge - x) / c);
        let kink = (edge - c).clamp(0.0, w);
        (interval(at, 0.0, kink, 1e-12).value + interval(at, kink, w, 1e-12).value) / w
    };
    let (w, c) = (pixel(sensor_m, image), blur(0.5 * f / 2.0));
    Truth::new("edge-out-of-focus-on-a-sensor-by-its-width", &scene, seen(w, c), "(1/w)∫ S((e − x)/c) dx from 0 to w, S(t) = (acos t − t√(1 − t²))/π, w = W z (z_f − f)/(2 f z_f), c = (f/2N)(z − z_f)/z_f")
        .because(
            "The sensor stands where the lens forms the image of its plane of focus, and a pixel is half of its width. Each point of the pixel \
             sees a circle of radius c at the depth of the lamp, of which a part lies beyond the edge.",
        )
        .confirmed("counted points of pixel and lens", 2e-3, move || {
            let at = |k: u32, n: u32| (f64::from(k) + 0.5) / f64::from(n);
            let lens: Vec<f64> = (0..400).flat_map(|i| (0..400).map(move |j| [2.0 * at(i, 400) - 1.0, 2.0 * at(j, 400) - 1.0])).filter(|[x, y]| x.hypot(*y) < 1.0).map(|[x, _]| c * x).collect();
            let share = |k: u32| lens.iter().filter(|x| w * at(k, 60) + **x > edge).count() as f64 / lens.len() as f64;
            (0..60).map(share).sum::<f64>() / 60.0
        })
        .or_else("the width of the sensor taken for its height", seen(2.0 * w, c))
        .or_else("the sensor at the focal length", seen(pixel(sensor_m, f), c))
        .or_else("the diameter of the aperture taken for its radius", seen(w, 2.0 * c))
        .or_else("a pinhole", 1.0 - edge / w)
        .reads_pixels([1, 2, 0, 1])
        .sees(0.01)
}

/// A wide picture by its horizontal angle, that moves away from a lamp while the shutter is open.
fn passing() -> Truth {
    let fov = 2.0 * 0.5_f64.atan().to_degrees();
    // From x = 0 to 0.6 m between 1 s and 2 s.
    let scene = Scene::camera(json!({
        "type": "perspective", "position_m": [0, 0, 0], "direction": [0, 0, -1], "horizontal_fov_deg": fov, "shutter_s": [1, 2],
        "keyframes": [
            { "time_s": 0.5, "transform": [{ "translate_m": [-0.3, 0, 0] }] }, { "time_s": 2.5, "transform": [{ "translate_m": [0.9, 0, 0] }] },
        ],
    }))
    .lamp(parallelogram([-0.4, -0.2, -1.0], [0.3, 0.0, 0.0], [0.0, 0.4, 0.0]), black(), 1.0, "front")
    .film(32, 16)
    .spp(256);
    // The picture is 1 m wide and ½ m high at the lamp; of the lamp's width what is right of x − ½ is in view.
    let in_view = |x: f64, half: f64| (-0.1 - (-0.4_f64).max(x - half)).clamp(0.0, 0.3);
    let seen = move |from: f64, to: f64, half: f64| {
        let n = 60_000;
        let at = |k: u32| from + (to - from) * (f64::from(k) + 0.5) / f64::from(n);
        let width = (0..n).map(|k| in_view(at(k), half)).sum::<f64>() / f64::from(n);
        width * 0.4 / (2.0 * half * half)
    };
    Truth::new("wide-picture-that-passes-a-lamp", &scene, 0.1, "0.4 (0.1 · 0.3 + ½ · 0.3²)/(0.6 · ½)")
        .because("The left edge of the picture, half a metre beside the eye, reaches the lamp after a tenth of a metre and leaves it behind after four tenths.")
        .confirmed("60,000 times, each with its view", 1e-6, move || seen(0.0, 0.6, 0.5))
        .or_else("the angle taken for the vertical one", seen(0.0, 0.6, 1.0))
        .or_else("it stands still as the shutter opens", 0.24)
        .or_else("all of the keyframes' time", seen(-0.3, 0.9, 0.5))
        .or_else("in the middle of the time", 0.08)
        .claims(Claim::Motion)
        .sees(0.01)
}

/// Parallel rays straight down, in a mirror: the upper left quarter of the picture.
fn from_above() -> Truth {
    let scene = Scene::camera(json!({
        "type": "orthographic", "position_m": [0.5, 3, -0.2], "direction": [0, -2, 0], "up": [0.3, 0, -1], "height_m": 2, "mirrored": true,
    }));
    // Along the picture's own axes: to the right and up, as they are without a mirror.
    let up = scale(1.0 / 1.09_f64.sqrt(), [0.3, 0.0, -1.0]);
    let right = [-up[2], 0.0, up[0]];
    let place = |x: f64, y: f64| add([0.5, 0.0, -0.2], add(scale(x, right), scale(y, up)));
    let lamp = parallelogram(place(0.25, -0.2), scale(0.5, right), scale(0.8, up));
    let scene = scene.lamp(lamp, black(), 1.0, "front").film(8, 8).spp(1024);
    Truth::new("mirrored-picture-from-straight-above", &scene, 0.3, "0.5 · 0.6 of a square metre")
        .because("In a mirrored picture what is to the right stands to the left. Of a lamp from 0.25 to 0.75 m to the right and −0.2 to 0.6 m up, the upper left quarter of the picture shows what lies above its middle.")
        .or_else("not mirrored, or turned by half a turn", 0.0)
        .or_else("upside down", 0.1)
        .reads_pixels([0, 4, 0, 4])
        .sees(5e-3)
}

/// A hole before a film, from a file, rolled so that x is up.
fn hole(further: &Value) -> Scene {
    let camera = json!({
        "type": "compound-lens", "position_m": [0, 0, 0], "look_at_m": [0, 0, -5], "up": [2, 0, 0], "lens_file": "hole.lens.json",
        "sensor_height_m": 1e-3, "film_distance_m": 0.05,
    });
    let hole = json!({ "surfaces": [{ "semi_aperture_mm": 0.002, "stop": true }], "coating": "none" });
    Scene::camera(with(camera, further)).file("hole.lens.json", hole.to_string().into_bytes()).film(8, 8).spp(1024)
}

/// The picture is 2 cm wide and high at the lamp, 1 m away.
const NARROW: &str = "cos⁴ over the field, 1e-4 in its mean; the hole blurs the edges alike on both sides";

/// The upper right quarter of a picture in a mirror.
fn rolled() -> Truth {
    let lamp = parallelogram([0.002, 0.001, -1.0], [0.006, 0.0, 0.0], [0.0, 0.008, 0.0]);
    let scene = hole(&json!({ "mirrored": true })).lamp(lamp, black(), 1.0, "front");
    Truth::new("compound-lens-rolled-in-a-mirror", &scene, 0.48, "0.6 · 0.8 of a square centimetre")
        .because("Looking along −z with x up, y is to the left, and in a mirror to the right. The upper right quarter of the picture shows a centimetre along both.")
        .allows(2e-4 * 0.48, NARROW)
        .or_else("not mirrored", 0.0)
        .or_else("y up", 0.0)
        .or_else("half a turn off", 0.0)
        .reads_pixels([4, 8, 0, 4])
        .sees(0.01)
}

/// The same without a mirror, moving to the left.
fn moving_left() -> Truth {
    // By 2 cm between 1 s and 3 s.
    let scene = hole(&json!({
        "shutter_s": [1, 3],
        "keyframes": [
            { "time_s": 0, "transform": [{ "translate_m": [0, -0.01, 0] }] }, { "time_s": 4, "transform": [{ "translate_m": [0, 0.03, 0] }] },
        ],
    }))
    .lamp(parallelogram([-0.004, 0.01, -1.0], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0]), black(), 1.0, "front");
    let in_view = |from: f64, to: f64| {
        let at = |k: u32| from + (to - from) * (f64::from(k) + 0.5) / 10_000.0;
        let width = |y: f64| ((0.02 - y).min(0.01) - (0.01 - y).max(-0.01)).max(0.0) / 0.02;
        (0..10_000).map(|k| 0.5 * width(at(k))).sum::<f64>() / 10_000.0
    };
    Truth::new("compound-lens-that-moves-to-its-left", &scene, 0.1875, "½ · ½(½ · ½ + ½): half of the height, while the lamp comes into view and while it is in it")
        .because("A lamp of half the picture's width, beyond its left edge as the shutter opens, comes into view in the first half of the time and stays in it.")
        .confirmed("the part in view at 10,000 times", 1e-6, move || in_view(0.0, 0.02))
        .allows(2e-4 * 0.1875, NARROW)
        .or_else("it stands still as the shutter opens", 0.0)
        .or_else("it stands in the middle of the time", 0.25)
        .or_else("all of the keyframes' time", in_view(-0.01, 0.03))
        .or_else("to the right", 0.0)
        .claims(Claim::Motion)
        .sees(0.02)
}

/// A paraboloid whose coefficients make the rest of a hyperboloid.
fn asphere() -> Truth {
    let (index, radius, semi_aperture, sensor) = (1.6, 24.0, 9.0, 0.01);
    let film = radius / (index - 1.0);
    let lens = |conic: f64, aspheric: Vec<f64>| {
        let rear = Surface { conic, aspheric, ..spherical(-radius, 0.0, 1.0, 11.0) };
        Lens { surfaces: vec![spherical(0.0, 6.0, index, semi_aperture), rear], film }
    };
    let (distance, c) = (1e5, -1.0 / radius);
    let disk_radius = 0.125 / film * distance * 1e-3;
    let share = move |lens: &Lens| lens.share_from_disk(1.1 * semi_aperture, distance, disk_radius * 1e3);
    // The hyperboloid has 1 + κ = 1 − n², the paraboloid 0: what the series of the one has beyond ρ² is missing in the other.
    let k: f64 = 1.0 - index * index;
    let series = [1.0 / 8.0, 1.0 / 16.0, 5.0 / 128.0, 7.0 / 256.0, 21.0 / 1024.0, 33.0 / 2048.0];
    let powers: Vec<f64> = (1_i32..).zip(series).map(|(i, factor)| factor * k.powi(i) * c.powi(2 * i + 1)).collect();
    let form = json!({
        "coating": "ideal",
        "surfaces": [
            { "thickness_mm": 6, "medium": index, "semi_aperture_mm": semi_aperture, "stop": true },
            { "radius_mm": -radius, "conic": -1, "aspheric": powers, "semi_aperture_mm": 11 },
        ],
    });
    let scene = Scene::camera(json!({
        "type": "compound-lens", "position_m": [0, 0, 0], "direction": [0, 0, -1], "lens": form,
        "sensor_height_m": sensor * 1e-3, "film_distance_m": film * 1e-3,
    }))
    .lamp(disk([0.0, 0.0, -distance * 1e-3], [0.0, 0.0, 1.0], disk_radius), black(), 1.0, "both")
    .film(16, 16)
    .spp(1024);
    let own = lens(-1.0, powers.clone());
    Truth::new("compound-lens-of-a-paraboloid-with-coefficients", &scene, 1.0, "1: κ = −1 and the series of κ = −n² beyond ρ², up to ρ¹⁴")
        .because(
            "A hyperboloid of eccentricity n behind a plane sends all rays along the axis to one point, at R/(n − 1). The middle of the film \
             sees a small distant disk through all of the lens, as bright as a uniform field.",
        )
        .confirmed("rays traced in the meridian", 1e-9, move || share(&own))
        .or_else("the coefficients left out", share(&lens(-1.0, Vec::new())))
        .or_else("the conic constant left out", share(&lens(0.0, powers)))
        .or_else("a sphere", share(&lens(0.0, Vec::new())))
        .sees(5e-3)
}

/// Six meters on a parallelogram whose corners are not right, below a point.
fn grid() -> Truth {
    let (origin, u, v): (Vec3, Vec3, Vec3) = ([0.5, -1.0, 0.2], [3.0, 0.0, 0.0], [1.0, 2.0, 0.0]);
    let (lamp, intensity) = ([1.0, 0.3, 1.7], 10.0);
    let meters = |columns: u32, rows: u32| json!({ "type": "irradiance-grid", "origin_m": origin, "u_m": u, "v_m": v, "columns": columns, "rows": rows });
    let place = move |a: f64, b: f64| add(origin, add(scale(a, u), scale(b, v)));
    let falls = move |at: Vec3| {
        let way = sub(lamp, at);
        intensity * way[2] / length(way).powi(3)
    };
    let over = move |columns: u32, rows: u32, shift: f64| {
        let at = |k: u32, n: u32| (f64::from(k) + shift) / f64::from(n);
        let all = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
        all.map(|(i, j)| falls(place(at(i, columns), at(j, rows)))).sum::<f64>() / f64::from(columns * rows)
    };
    Truth::new(
        "meters-on-a-skew-grid-below-a-point",
        &measured(&[meters(3, 2)]).point_light(lamp, intensity).spp(1 << 12),
        over(3, 2, 0.5),
        "mean of I h/d³ at origin + (i + ½)u/3 + (j + ½)v/2",
    )
    .because("A grid is read at the centres of its cells, three along u and two along v.")
    .confirmed("the cosines to the third over h² at the six centres", 1e-12, move || {
        // From the corner, in metres.
        let centres = [[0.75, 0.5], [1.75, 0.5], [2.75, 0.5], [1.25, 1.5], [2.25, 1.5], [3.25, 1.5]];
        let of = |[x, y]: [f64; 2]| intensity * ((x - 0.5).hypot(y - 1.3) / 1.5).atan().cos().powi(3) / 2.25;
        centres.map(of).iter().sum::<f64>() / 6.0
    })
    .or_else("columns and rows exchanged", over(2, 3, 0.5))
    .or_else("at the corners of the cells", over(3, 2, 0.0))
    .or_else("at the centre of all", falls(place(0.5, 0.5)))
    .or_else("edges at right angles", {
        let at = |i: u32, j: u32| add(origin, [f64::from(i) + 0.5, f64::from(j) + 0.5, 0.0]);
        (0..6).map(|k| falls(at(k % 3, k / 3))).sum::<f64>() / 6.0
    })
    .or_else("seen from below", 0.0)
    .sees(1e-3)
}

/// A pixel over the corner of a lamp: filters are products along both axes.
fn filters() -> Vec<Truth> {
    const CORNER: [f64; 2] = [0.25, -0.35];
    let make = |name: &str, filter: Value, share: fn(f64) -> f64, formula: &str| {
        let scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1.0)
            .lamp(parallelogram([CORNER[0], CORNER[1], 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]), black(), 1.0, "front")
            .set("film", "filter", filter)
            .film(1, 1)
            .spp(1 << 18);
        Truth::new(name, &scene, share(CORNER[0]) * share(CORNER[1]), formula)
            .because("The pixel shows the share of its filter that lies over the lamp, along one axis times along the other.")
            .or_else("a box", 0.25 * 0.85)
            .or_else("one axis alone", share(CORNER[0]))
            .sees(0.01)
    };
    // Share of a function that ends at a distance which lies beyond a place; its halves are alike.
    fn beyond(at: fn(f64) -> f64, x: f64, ends: &[f64]) -> f64 {
        let to = |x: f64| {
            let mut from = 0.0;
            let mut sum = 0.0;
            for end in ends {
                sum += interval(at, from, x.min(*end).max(from), 1e-12).value;
                from = *end;
            }
            sum
        };
        0.5 - 0.5 * x.signum() * to(x.abs()) / to(f64::INFINITY)
    }
    fn midpoints(at: fn(f64) -> f64, x: f64, end: f64) -> f64 {
        let sum = |from: f64| {
            let step = (end - from) / 100_000.0;
            (0..100_000).map(|k| at(from + step * (f64::from(k) + 0.5))).sum::<f64>() * step
        };
        sum(x) / sum(-end)
    }
    // Of b = ½ and c = ¼ over a distance of 1½ instead of 2.
    fn mitchell(x: f64) -> f64 {
        cubic(x.abs() * 2.0 / 1.5)
    }
    fn cubic(t: f64) -> f64 {
        let near = (12.0 - 4.5 - 1.5) * t.powi(3) + (6.0 + 1.5 - 18.0) * t * t + 5.0;
        let far = -2.0 * t.powi(3) + 10.5 * t * t - 18.0 * t + 10.0;
        if t < 1.0 { near } else { far }
    }
    fn wide(x: f64) -> f64 {
        cubic(x.abs())
    }
    fn lanczos(x: f64) -> f64 {
        if x == 0.0 { 1.0 } else { ((PI * x).sin() / (PI * x)).powi(2) }
    }
    fn lanczos_of_three(x: f64) -> f64 {
        if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) * (PI * x / 3.0).sin() / (PI * x / 3.0) }
    }
    let both = |share: fn(f64) -> f64| share(CORNER[0]) * share(CORNER[1]);
    let lobes = json!({ "type": "lanczos", "lobes": 1 });
    let narrow = json!({ "type": "mitchell", "radius_px": 1.5, "b": 0.5, "c": 0.25 });
    vec![
        make(
            "filter-mitchell-over-a-corner",
            narrow,
            |x| beyond(mitchell, x, &[0.75, 1.5]),
            "∏ ∫ of the cubic of b = ½, c = ¼ that ends at 1½ pixels, from 0.25 on and from −0.35 on",
        )
        .confirmed("midpoints", 1e-6, || CORNER.map(|x| midpoints(mitchell, x, 1.5)).iter().product())
        .or_else("a radius of 2", both(|x| beyond(wide, x, &[1.0, 2.0]))),
        make(
            "filter-lanczos-of-one-lobe-over-a-corner",
            lobes,
            |x| beyond(lanczos, x, &[1.0]),
            "∏ ∫ of sinc²(x) to 1, from 0.25 on and from −0.35 on",
        )
        .confirmed("midpoints", 1e-6, || CORNER.map(|x| midpoints(lanczos, x, 1.0)).iter().product())
        .or_else("three lobes", both(|x| beyond(lanczos_of_three, x, &[1.0, 2.0, 3.0]))),
    ]
}
