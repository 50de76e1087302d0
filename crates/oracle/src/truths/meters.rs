//! What meters read: irradiance at points and on grids, flux, mean radiance of a cone.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Truth, disk_irradiance, lambert_polygon,
    scene::{Scene, black, disk, lambert, level_square, parallelogram, sphere},
};
use crate::quadrature::{interval, rectangle};
use crate::vector::Vec3;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = from_points();
    list.extend(from_surfaces());
    list.extend(fluxes());
    list.extend(cones());
    list
}

/// A meter that faces this way.
fn at(position: Vec3, normal: Vec3) -> Value {
    json!({ "type": "irradiance", "position_m": position, "normal": normal })
}

/// A scene that is only measured: its camera takes no part.
pub(super) fn measured(meters: &[Value]) -> Scene {
    Scene::camera(
        json!({ "type": "perspective", "position_m": [0, 0, 9], "direction": [0, 0, -1], "vertical_fov_deg": 30 }),
    )
    .whole("meters", json!(meters))
    .film(1, 1)
    .spp(1 << 18)
}

const UP: Vec3 = [0.0, 0.0, 1.0];

fn from_points() -> Vec<Truth> {
    // 1.5 m aside and 2 m above: d = 2.5 m.
    let value = 7.0 * 2.0 / 2.5_f64.powi(3);
    let aside = || measured(&[at([0.5, 1.0, 3.0], UP)]).point_light([2.0, 1.0, 5.0], 7.0);
    let tilted = 5.0 * (0.6 * 0.28 + 0.8 * 0.96);
    // On a floor that fills the plane of the meter, which must neither hide the light nor shine on it.
    let floor = parallelogram([-5.0, -5.0, 0.1 + 0.2], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]);
    let on_floor = measured(&[at([0.5, 1.0, 0.3], UP)]).object(floor, lambert(0.8)).point_light([2.0, 1.0, 2.3], 7.0);
    vec![
        Truth::new("meter-under-a-point", &aside(), value, "I h/d³ = 7 · 2/2.5³")
            .because("A point of intensity I gives I/d² across its light, times the cosine h/d on a plane at the depth h below it.")
            .confirmed("the angle's cosine to the third over h²", 1e-12, || 7.0 * 1.5_f64.atan2(2.0).cos().powi(3) / 4.0)
            .or_else("the cosine left out", 7.0 / 6.25)
            .or_else("radiance instead of irradiance", value / PI)
            .or_else("dark", 0.0)
            .sees(1e-4),
        Truth::new("meter-with-its-back-to-a-point", &measured(&[at([0.5, 1.0, 3.0], [0.0, 0.0, -1.0])]).point_light([2.0, 1.0, 5.0], 7.0), 0.0, "0")
            .because("A meter sees the side that its normal points into.")
            .or_else("both sides", value),
        Truth::new("meter-in-parallel-light", &measured(&[at([0.5, 1.0, 3.0], [0.28, 0.0, 0.96])]).directional_light([-0.6, 0.0, -0.8], 5.0), tilted, "E n·l = 5 (0.6 · 0.28 + 0.8 · 0.96)")
            .because("Parallel light gives its irradiance times the cosine.")
            .confirmed("the cosine of the difference of the angles", 1e-12, || {
                5.0 * (0.6_f64.atan2(0.8) - 0.28_f64.atan2(0.96)).cos()
            })
            .or_else("the cosine left out", 5.0)
            .or_else("the normal along z", 4.0)
            .sees(1e-4),
        Truth::new("meter-on-a-floor", &on_floor, value, "I h/d³ = 7 · 2/2.5³")
            .because("A plane neither lights nor hides itself, though rounding puts the meter to either side of it.")
            .or_else("hidden by the floor", 0.0)
            .or_else("the light of the floor counted", 1.8 * value)
            .sees(1e-4),
    ]
}

fn from_surfaces() -> Vec<Truth> {
    let lamp = || disk([1.0, 0.0, 2.0], [0.0, 0.0, -1.0], 0.75);
    let value = 3.0 * disk_irradiance(0.75, 2.0, 1.0);
    let by_quadrature = move || {
        let over = |r: f64, phi: f64| {
            let (x, y) = (1.0 + r * phi.cos(), r * phi.sin());
            r * 4.0 / (x * x + y * y + 4.0).powi(2)
        };
        3.0 * rectangle(over, [0.0, 0.75], [0.0, 2.0 * PI], 1e-11, 2_000_000).value
    };
    let under =
        |how: &'static str| measured(&[at([0.0; 3], UP)]).lamp(lamp(), black(), 3.0, "front").light_sampling(how);
    // Half of the sky below the horizon of a tilted plane is hidden by a black ground without end, up to the angle of view: (1 + cos)/2.
    let ground = || disk([0.0, 0.0, -1e-3], UP, 1e4);
    let tilt: f64 = 1.0;
    let half_sky = PI * 2.0 * 0.5 * (1.0 + tilt.cos());
    let furnace = 0.5 * PI / (1.0 - 0.6);
    let room = |depth: Option<u32>| {
        let scene =
            measured(&[at([0.3, 0.2, -0.4], [0.6, 0.0, 0.8])]).lamp(sphere([0.0; 3], 1.0), lambert(0.6), 0.5, "both");
        depth.map_or(scene.clone(), |depth| scene.depth(depth))
    };
    // The centres of four cells of a square of 2 m, below a lamp.
    let grid = json!({ "type": "irradiance-grid", "origin_m": [0, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0], "columns": 2, "rows": 2 });
    let square = |x: f64, y: f64, z: f64, h: f64| {
        lambert_polygon(&[[x - h, y - h, z], [x + h, y - h, z], [x + h, y + h, z], [x - h, y + h, z]], UP)
    };
    let cells = 0.25 * 2.0 * (2.0 * square(0.0, -0.5, 1.5, 0.25) + 2.0 * square(-1.0, -0.5, 1.5, 0.25));
    let cells_by_sum = || {
        let of = |x: f64, y: f64| {
            let point = |a: f64, b: f64| {
                let d2 = (a - x).powi(2) + (b - y).powi(2) + 2.25;
                2.0 * 2.25 / (d2 * d2)
            };
            rectangle(point, [0.25, 0.75], [-0.25, 0.25], 1e-11, 2_000_000).value
        };
        0.25 * (of(0.5, -0.5) + of(1.5, -0.5) + of(0.5, 0.5) + of(1.5, 0.5))
    };
    let mut list: Vec<Truth> = [("mis", "meter-under-a-disk"), ("light", "meter-under-a-disk-by-light"), ("bsdf", "meter-under-a-disk-by-bsdf")]
        .into_iter()
        .map(|(how, name)| {
            Truth::new(name, &under(how), value, "L (π/2)(1 − (Z − 2R²)/√(Z² − 4R²))")
                .because("Irradiance from a disk on a plane parallel to it (Howell, B-13): shadow rays and the meter's own directions find it.")
                .confirmed("quadrature over the disk", 1e-8, by_quadrature)
                .or_else("as on the axis", 3.0 * disk_irradiance(0.75, 2.0, 0.0))
                .or_else("radiance instead of irradiance", value / PI)
                .sees(0.005)
        })
        .collect();
    list.push(
        Truth::new(
            "meter-tilted-above-a-ground",
            &measured(&[at([0.0, 0.0, 0.1], [tilt.sin(), 0.0, tilt.cos()])]).object(ground(), black()).sky(2.0),
            half_sky,
            "πL (1 + cos β)/2",
        )
        .because("Of an even sky a plane tilted by β above a black ground sees the configuration factor (1 + cos β)/2.")
        .confirmed("quadrature over the visible half-space", 1e-6, move || {
            let over = |theta: f64, phi: f64| {
                let cos = theta.sin() * phi.cos() * tilt.sin() + theta.cos() * tilt.cos();
                2.0 * cos.max(0.0) * theta.sin()
            };
            rectangle(over, [0.0, 0.5 * PI], [0.0, 2.0 * PI], 1e-8, 4_000_000).value
        })
        .or_else("level", 2.0 * PI)
        .or_else("cos β", 2.0 * PI * tilt.cos())
        .allows(1e-4 * half_sky, "the ground ends at 10 km, and the meter is 0.1 m above it")
        .sees(0.003),
    );
    list.push(
        Truth::new("meter-in-a-furnace", &room(None), furnace, "πL/(1 − ρ)")
            .because("In a closed room whose walls emit L and reflect ρ the radiance is L/(1 − ρ) everywhere.")
            .confirmed("the sum over the orders of reflection", 1e-9, || {
                (0..60).map(|k| 0.5 * PI * 0.6_f64.powi(k)).sum()
            })
            .or_else("no reflection", 0.5 * PI)
            .or_else("one too few", furnace * 0.6)
            .no_brighter_than(0.5 / 0.4)
            .sees(0.005),
    );
    for (depth, name, sum) in [(1, "meter-in-a-furnace-by-one-edge", 1.0), (2, "meter-in-a-furnace-by-two-edges", 1.6)]
    {
        list.push(
            Truth::new(name, &room(Some(depth)), 0.5 * PI * sum, format!("πL · {sum}"))
                .because("The limit on depth counts edges from the meter to a light: one is direct light, two adds one reflection.")
                .or_else("one edge fewer", 0.5 * PI * (sum - 0.6_f64.powi(depth as i32 - 1)))
                .or_else("one edge more", 0.5 * PI * (sum + 0.6_f64.powi(depth as i32)))
                .sees(0.005),
        );
    }
    list.push(
        Truth::new(
            "meters-on-a-grid",
            &measured(&[grid]).lamp(level_square([0.5, 0.0, 1.5], 0.25, false), black(), 2.0, "front"),
            cells,
            "mean of Lambert's formula at the centres of four cells",
        )
        .because(
            "A grid is read at the centres of its cells, here at 0.5 and 1.5 m along x and at −0.5 and 0.5 m along y.",
        )
        .confirmed("quadrature over the lamp", 1e-8, cells_by_sum)
        .or_else("at the corners", 0.25 * 2.0 * 2.0 * (square(0.5, -1.0, 1.5, 0.25) + square(-1.5, -1.0, 1.5, 0.25)))
        .sees(0.005),
    );
    list
}

fn fluxes() -> Vec<Truth> {
    // A rectangle of 2 × 1 m, a corner of which is 1.5 m below a point: Ω = atan(ab/(h√(a² + b² + h²))).
    let (a, b, h) = (2.0_f64, 1.0_f64, 1.5_f64);
    let solid_angle = (a * b / (h * (a * a + b * b + h * h).sqrt())).atan();
    let meter = json!({ "type": "flux", "origin_m": [1, 1, 0], "u_m": [2, 0, 0], "v_m": [0, 1, 0] });
    let flux = 3.0 * solid_angle;
    let by_quadrature = move || {
        3.0 * rectangle(|x, y| h / (x * x + y * y + h * h).powf(1.5), [0.0, a], [0.0, b], 1e-11, 2_000_000).value
    };
    let at_middle = 3.0 * a * b * h / (0.25 * (a * a + b * b) + h * h).powf(1.5);
    // Parallel light across a leaning parallelogram: E times the area seen along it.
    let leaning = json!({ "type": "flux", "origin_m": [0, 0, 0], "u_m": [2, 0, 1], "v_m": [0.5, 1.5, 0] });
    vec![
        Truth::new(
            "flux-of-a-point",
            &measured(&[meter]).point_light([1.0, 1.0, 1.5], 3.0),
            flux,
            "I Ω, Ω = atan(ab/(h√(a² + b² + h²)))",
        )
        .because("The flux into a solid angle is intensity times that; a rectangle below a corner fills Ω.")
        .confirmed("quadrature of irradiance over the rectangle", 1e-8, by_quadrature)
        .or_else("the irradiance in its middle, times the area", at_middle)
        .or_else("mean irradiance", flux / (a * b))
        .sees(0.005),
        Truth::new(
            "flux-of-parallel-light",
            &measured(&[leaning]).directional_light([0.6, 0.0, -0.8], 2.0),
            2.0 * (0.6 * 1.5 + 0.8 * 3.0),
            "E |(u × v)·l|, u × v = (−1.5, 0.5, 3)",
        )
        .because("Parallel light gives its irradiance times the area that is seen along it.")
        .confirmed("the area as seen along the light, from its corners", 1e-12, || {
            // Across the light: y, and x′ = 0.8 x + 0.6 z.
            let along = |[x, _, z]: Vec3| 0.8 * x + 0.6 * z;
            let (u, v) = ([2.0, 0.0, 1.0], [0.5, 1.5, 0.0]);
            2.0 * (along(u) * v[1] - u[1] * along(v)).abs()
        })
        .or_else("the cosine left out", 2.0 * (1.5_f64 * 1.5 + 0.25 + 9.0).sqrt())
        .or_else("the area of its edges' lengths", 2.0 * 5.0_f64.sqrt() * 2.5_f64.sqrt())
        .sees(1e-4),
    ]
}

fn cones() -> Vec<Truth> {
    let full_deg = 30.0_f64;
    let meter =
        json!({ "type": "radiance", "position_m": [0, 0, 0], "direction": [1, 2, 2], "full_angle_deg": full_deg });
    // A ball lamp on the axis that takes the cone of sine 1/10 of it.
    let lamp = |radius: f64| {
        measured(std::slice::from_ref(&meter)).lamp(
            sphere([5.0 / 3.0, 10.0 / 3.0, 10.0 / 3.0], radius),
            black(),
            4.0,
            "front",
        )
    };
    let cap = |half: f64| 2.0 * (0.5 * half).sin().powi(2);
    let share = cap(0.1_f64.asin()) / cap(0.5 * full_deg.to_radians());
    vec![
        Truth::new("radiance-of-a-cone", &lamp(0.5), 4.0 * share, "L (1 − cos a)/(1 − cos b), sin a = 0.1, b = 15°")
            .because("The mean over a cone, evenly in solid angle, of a lamp that fills a narrower one.")
            .confirmed("quadrature over the polar angle", 1e-9, move || {
                let solid = |half: f64| interval(f64::sin, 0.0, half, 1e-13).value;
                4.0 * solid(0.1_f64.asin()) / solid(0.5 * full_deg.to_radians())
            })
            .or_else("the angle taken for half of it", 4.0 * cap(0.1_f64.asin()) / cap(full_deg.to_radians()))
            .or_else("evenly in the angle", 4.0 * 0.1_f64.asin() / (0.5 * full_deg.to_radians()))
            .sees(0.005),
        Truth::new("radiance-of-a-cone-that-is-filled", &lamp(3.0), 4.0, "L")
            .because("A cone that a lamp fills has its radiance.")
            .or_else("a factor of π", 4.0 * PI)
            .sees(1e-4),
    ]
}
