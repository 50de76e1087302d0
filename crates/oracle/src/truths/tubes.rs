//! Round tubes and rods: light from their sides and ends, and within.

use std::f64::consts::PI;

use super::{
    Truth,
    irradiance::{cylinder_by_quadrature, cylinder_factor, disk_irradiance, rectangle_corner_factor},
    scene::{PLATE_ALBEDO, Scene, black, cylinder, lambert},
};

pub(super) fn truths() -> Vec<Truth> {
    let room = Scene::pinhole([0.1, 0.2, -0.3], [0.5, -0.6, 0.9], 90.0)
        .lamp(cylinder([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.7), lambert(0.5), 0.5, "back")
        .spp(256);
    let above = Scene::light_meter().lamp(cylinder([0.0, -2.0, 3.0], [0.0, 2.0, 3.0], 1.0), black(), 1.0, "front");
    let end_on = Scene::light_meter().lamp(cylinder([0.0, 0.0, 2.0], [0.0, 0.0, 5.0], 1.0), black(), 1.0, "front");
    vec![
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
    ]
}
