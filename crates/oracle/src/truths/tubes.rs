//! Round tubes and rods: light from their sides and ends, and within.

use std::f64::consts::PI;

use super::{
    Truth,
    irradiance::{cylinder_by_quadrature, cylinder_factor, disk_irradiance, rectangle_corner_factor},
    scene::{PLATE_ALBEDO, Scene, black, cylinder, lambert},
};
use crate::quadrature::interval;

pub(super) fn truths() -> Vec<Truth> {
    let room = Scene::pinhole([0.1, 0.2, -0.3], [0.5, -0.6, 0.9], 90.0)
        .lamp(cylinder([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.7), lambert(0.5), 0.5, "back")
        .spp(256);
    let above = Scene::light_meter().lamp(cylinder([0.0, -2.0, 3.0], [0.0, 2.0, 3.0], 1.0), black(), 1.0, "front");
    let end_on = Scene::light_meter().lamp(cylinder([0.0, 0.0, 2.0], [0.0, 0.0, 5.0], 1.0), black(), 1.0, "front");
    let mut list = vec![
        Truth::new("room-tube", &room, 1.0, "Le/(1 − ρ), Le = ρ = ½")
            .because(
                "A closed room whose walls all emit Le and reflect ρ diffusely is evenly bright, whatever its shape: here a round \
                 tube with both ends closed.",
            )
            .or_else("emission found by shadow rays and by BSDF rays, both in full", 1.5)
            .sees(0.01),
        // E = 2πF from the two halves, and the plate shows (ρ/π)·E.
        Truth::new("cylinder-light", &above, 2.0 * PLATE_ALBEDO * cylinder_factor(2.0, 3.0), "(ρ/π)·2πF(l/r, h/r)")
            .because(
                "A rod over a plate that its middle stands above: twice the configuration factor of an element to a cylinder of \
                 finite length whose one end is over the element (Howell, A Catalog of Radiation Heat Transfer Configuration \
                 Factors, B-30). Its ends cannot be seen.",
            )
            .confirmed("quadrature over the visible side", 1e-8, || PLATE_ALBEDO / PI * cylinder_by_quadrature(2.0, 3.0))
            .or_else("a rod without ends: the infinite cylinder", PLATE_ALBEDO / 3.0)
            .or_else(
                "a strip as wide as the rod in place of it",
                4.0 * PLATE_ALBEDO * rectangle_corner_factor(1.0 / 3.0, 2.0 / 3.0),
            ),
        Truth::new("cylinder-light-end-on", &end_on, PLATE_ALBEDO / PI * disk_irradiance(1.0, 2.0, 0.0), "(ρ/π)·πr²/(r² + h²)")
            .because("Seen along its axis a closed rod is the disk that ends it: no ray from the axis meets its side from outside.")
            .or_else("the rod open: its inside is dark", 0.0)
            .or_else("the farther end in place of the nearer", PLATE_ALBEDO / PI * disk_irradiance(1.0, 5.0, 0.0)),
    ];
    list.extend(["start", "end"].map(long_rod));
    list
}

/// A long rod over a plate on its axis, its start or its end below. Its light is found by drawing points of it alone.
fn long_rod(below: &str) -> Truth {
    // Heights of its ends over its radius.
    let [near, far] = [2.0, 20.0];
    let [start, end] = if below == "start" { [near, far] } else { [far, near] };
    let scene = Scene::light_meter()
        .lamp(cylinder([0.0, 0.0, start], [0.0, 0.0, end], 1.0), black(), 1.0, "front")
        .light_sampling("light");
    let shown = |irradiance: f64| PLATE_ALBEDO / PI * irradiance;
    // Of directions by their tangent, which leave the rod by its far end or by its side. Drawn by area, they have the densities d²/cos there, and at
    // the near end.
    let drawn = |tangent: f64| {
        let seen = near * near;
        let [drawn, known] = match tangent < 1.0 / far {
            true => [2.0 * far * far, far * far],
            false => [tangent.powi(-3); 2],
        };
        drawn / (seen + known)
    };
    let of_drawn = |t: f64| 2.0 * PI * t / (1.0 + t * t).powi(2) * drawn(t);
    let skipped =
        interval(of_drawn, 0.0, 1.0 / far, 1e-12).value + interval(of_drawn, 1.0 / far, 1.0 / near, 1e-12).value;
    Truth::new(
        format!("long-rod-with-its-{below}-below-by-light"),
        &scene,
        shown(disk_irradiance(1.0, near, 0.0)),
        "(ρ/π)·πr²/(r² + h²)",
    )
    .because("From its axis only the near end of a closed rod is seen: a disk. Directions toward it are drawn by points on it and by points behind it.")
    .confirmed("rings of the disk", 1e-8, move || {
        let rings = 100_000;
        let ring = |k: u32| {
            let r = (f64::from(k) + 0.5) / f64::from(rings);
            2.0 * PI * r * near * near / (r * r + near * near).powi(2)
        };
        shown((0..rings).map(ring).sum::<f64>() / f64::from(rings))
    })
    .or_else("no point of the near end is drawn, and twice as many of the far end", shown(skipped))
    .or_else("the farther end in place of the nearer", shown(disk_irradiance(1.0, far, 0.0)))
    .sees(0.02)
}
