//! Light exchanged between two surfaces of finite size, read off all of the receiver at once.

use std::f64::consts::PI;

use super::{
    Truth,
    irradiance::{disk_irradiance, lambert_polygon, sphere_irradiance},
    scene::{Scene, black, disk, lambert, level_square, parallelogram, sphere},
};
use crate::{
    quadrature,
    vector::{Vec3, sub},
};

const ALBEDO: f64 = 0.5;

/// The view factor of equal parallel squares of side 1 at distance 1 (Howell, C-11 with X = Y = 1):
/// F = (2/π)(ln √(4/3) + 2√2·atan(1/√2) − 2·atan 1).
fn facing_squares() -> f64 {
    let two = 2.0_f64.sqrt();
    2.0 / PI * (0.5 * (4.0_f64 / 3.0).ln() + 2.0 * two * (1.0 / two).atan() - 2.0 * 1.0_f64.atan())
}

/// The view factor of perpendicular unit squares with a common edge (Howell, C-14 with H = W = 1):
/// F = (1/π)(π/2 − √2·atan(1/√2) + ¼ln(¾)).
fn perpendicular_squares() -> f64 {
    let two = 2.0_f64.sqrt();
    (0.5 * PI - two * (1.0 / two).atan() + 0.25 * 0.75_f64.ln()) / PI
}

/// The view factor from a disk of radius r₁ to a coaxial one of radius r₂ at distance h (Howell, C-41):
/// ½(X − √(X² − 4(r₂/r₁)²)), X = 1 + (h² + r₂²)/r₁².
fn coaxial_disks(from: f64, to: f64, distance: f64) -> f64 {
    let x = 1.0 + (distance * distance + to * to) / (from * from);
    let ratio = to / from;
    // The difference of nearly equal numbers for small disks, turned round.
    2.0 * ratio * ratio / (x + (x * x - 4.0 * ratio * ratio).sqrt())
}

/// The mean of an irradiance over π, over a square.
fn mean_over_square(low: f64, high: f64, irradiance: impl Fn(f64, f64) -> f64) -> f64 {
    let sides = [low, high];
    let total = quadrature::rectangle(irradiance, sides, sides, 1e-9, 400_000).value;
    total / (PI * (high - low).powi(2))
}

pub(super) fn truths() -> Vec<Truth> {
    let because = "Reciprocity: the mean irradiance of the receiver is πLe times its view factor to the emitter. Seen in parallel rays \
         from an angle, the receiver fills the picture exactly, so the picture's mean is ρF.";
    // The square [−½, ½]² from 60° off its normal: 1 wide, ½ high.
    let oblique = |azimuth: Vec3, at: Vec3| {
        let eye = [at[0] + 3.0 * 0.75_f64.sqrt() * azimuth[0], at[1] + 3.0 * 0.75_f64.sqrt() * azimuth[1], at[2] + 1.5];
        Scene::orthographic(eye, at, 0.5).up([0.0, 0.0, 1.0]).film(64, 32).spp(512)
    };
    let facing = oblique([0.0, -1.0, 0.0], [0.0; 3]).object(level_square([0.0; 3], 0.5, true), lambert(ALBEDO)).lamp(
        level_square([0.0, 0.0, 1.0], 0.5, false),
        black(),
        1.0,
        "front",
    );
    let corner = oblique([1.0, 0.0, 0.0], [0.5, 0.0, 0.0])
        .object(parallelogram([0.0, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), lambert(ALBEDO))
        .lamp(parallelogram([0.0, -0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]), black(), 1.0, "front");
    let up = [0.0, 0.0, 1.0];
    let polygon_at =
        move |corners: [Vec3; 4], x: f64, y: f64| lambert_polygon(&corners.map(|corner| sub(corner, [x, y, 0.0])), up);
    let ceiling = [[-0.5, -0.5, 1.0], [0.5, -0.5, 1.0], [0.5, 0.5, 1.0], [-0.5, 0.5, 1.0]];
    let wall = [[-0.5, -0.5, 0.0], [-0.5, 0.5, 0.0], [-0.5, 0.5, 1.0], [-0.5, -0.5, 1.0]];

    // A disk of radius 1 from acos ⅓ off its normal: 2 wide, ⅔ high; the picture also holds the black corners around it.
    let over_disk = || {
        let (sine, cosine) = ((8.0_f64 / 9.0).sqrt(), 1.0 / 3.0);
        Scene::orthographic([0.0, -6.0 * sine, 6.0 * cosine], [0.0; 3], 2.0 / 3.0)
            .up(up)
            .film(96, 32)
            .spp(512)
            .object(disk([0.0; 3], up, 1.0), lambert(ALBEDO))
    };
    let rings = |irradiance: fn(f64) -> f64| {
        move || ALBEDO * 0.5 * quadrature::interval(|r| irradiance(r) * r, 0.0, 1.0, 1e-12).value
    };
    let because_disk = "As for squares; the disk fills π/4 of the picture, whose rest is black.";
    let disks = over_disk().lamp(disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0), black(), 1.0, "front");
    let small = over_disk().lamp(disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 0.5), black(), 1.0, "front");
    let ball = over_disk().lamp(sphere([0.0, 0.0, 2.0], 0.5), black(), 1.0, "front");
    // F(sphere → disk) = ½(1 − 1/√(1 + (r/h)²)), turned round by the ratio of areas 4R²/r².
    let from_ball = 4.0 * 0.25 * 0.5 * (1.0 - 1.0 / 1.25_f64.sqrt());
    vec![
        Truth::new("view-factor-facing-squares", &facing, ALBEDO * facing_squares(), "ρF, F = .199824896")
            .because(because)
            .confirmed("Lambert's formula averaged over the receiver", 1e-7, move || {
                ALBEDO * mean_over_square(-0.5, 0.5, |x, y| polygon_at(ceiling, x, y))
            })
            .or_else("the middle taken for the mean", ALBEDO * polygon_at(ceiling, 0.0, 0.0) / PI),
        Truth::new(
            "view-factor-perpendicular-squares",
            &corner,
            ALBEDO * perpendicular_squares(),
            "ρF, F = .200043776",
        )
        .because(because)
        .confirmed("Lambert's formula averaged over the receiver", 1e-5, move || {
            ALBEDO * mean_over_square(-0.5, 0.5, |x, y| polygon_at(wall, x, y))
        })
        .or_else("the middle taken for the mean", ALBEDO * polygon_at(wall, 0.0, 0.0) / PI),
        Truth::new(
            "view-factor-disks",
            &disks,
            ALBEDO * 0.25 * PI * coaxial_disks(1.0, 1.0, 1.0),
            "ρF·π/4, F = .381966011",
        )
        .because(because_disk)
        .confirmed("irradiance averaged over rings", 1e-9, rings(|r| disk_irradiance(1.0, 1.0, r)))
        .or_else("the middle taken for the mean", ALBEDO * 0.25 * PI * 0.5),
        Truth::new(
            "view-factor-unequal-disks",
            &small,
            ALBEDO * 0.25 * PI * coaxial_disks(1.0, 0.5, 1.0),
            "ρF·π/4, r₂ = ½",
        )
        .because(because_disk)
        .confirmed("irradiance averaged over rings", 1e-9, rings(|r| disk_irradiance(0.5, 1.0, r)))
        .or_else("reciprocity without the ratio of areas", ALBEDO * 0.25 * PI * coaxial_disks(0.5, 1.0, 1.0)),
        Truth::new(
            "view-factor-disk-and-sphere",
            &ball,
            ALBEDO * 0.25 * PI * from_ball,
            "ρF·π/4, F = (4R²/r²)·½(1 − 1/√(1 + r²/h²))",
        )
        .because(because_disk)
        .confirmed(
            "irradiance averaged over rings",
            1e-9,
            rings(|r| sphere_irradiance(0.5, 2.0_f64.hypot(r), (r / 2.0).atan())),
        )
        .or_else("the middle taken for the mean", ALBEDO * 0.25 * PI / 16.0),
    ]
}
