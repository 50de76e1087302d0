//! Axial colour: a lens of one glass has another focus for each wavelength.

use serde_json::json;

use super::{biconvex, camera, lens_form};
use crate::truths::{
    Claim, Truth,
    lens_tracer::Lens,
    photometric_weight,
    prisms::bk7,
    scene::{Scene, black, disk},
};

/// The wavelength that the film is in focus for.
const FOCUS_NM: f64 = 500.0;
/// Distance and radius of the lamp, mm, and the radius of the stop.
const DISTANCE: f64 = 1e6;
const LAMP: f64 = 10.0;
const STOP: f64 = 0.1;

/// The share of the stop through which the middle of the film sees the lamp, by the axial matrix.
fn share(lens: &Lens) -> f64 {
    let [[a, b], [c, d]] = lens.matrix();
    // A ray through the middle of the film that crosses the stop at 1 is at this height at the lamp.
    let at_lamp = 1.0 + DISTANCE * (a + lens.film * c) / (b + lens.film * d);
    (LAMP / (at_lamp * STOP)).powi(2).min(1.0)
}

/// The same by rays in the meridian: the place on the last plane up to which they meet the lamp, and up to which they pass the stop.
fn traced(lens: &Lens) -> f64 {
    let reaches = |test: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, 2.0 * STOP);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if test(middle) { low = middle } else { high = middle }
        }
        low
    };
    let ray = |y: f64| lens.trace([0.0; 2], [0.0, y]);
    let passes = reaches(&|y| ray(y).is_some());
    let meets = reaches(&|y| {
        ray(y).is_some_and(|(at, direction, _)| (at[1] - direction[1] / direction[2] * (DISTANCE + at[2])).abs() < LAMP)
    });
    (meets / passes).powi(2)
}

pub(super) fn truth() -> Truth {
    let film = biconvex(bk7(FOCUS_NM), 0.0, STOP).image(DISTANCE);
    let lens = move |nm: f64| biconvex(bk7(nm), film, STOP);
    // By the midpoint rule: ȳ has a corner at each nanometre, on a border between steps.
    let over = |steps_a_nm: u32, integrand: &dyn Fn(f64) -> f64| -> f64 {
        let step = 1.0 / f64::from(steps_a_nm);
        (0..470 * steps_a_nm).map(|i| step * integrand(360.0 + step * (f64::from(i) + 0.5))).sum()
    };
    let value = over(10, &|nm| photometric_weight(nm) * share(&lens(nm)));
    // Four wavelengths a quarter of an even distribution apart, all of them along the path of the first.
    let turned = |nm: f64, lane: u32| 360.0 + (nm - 360.0 + 117.5 * f64::from(lane)) % 470.0;
    let together = |nm: f64| 0.25 * (0..4).map(|lane| photometric_weight(turned(nm, lane))).sum::<f64>();
    let kept = over(10, &|nm| together(nm) * share(&lens(nm)));

    let form = lens_form(&lens(FOCUS_NM), &json!("N-BK7"), "ideal");
    let scene = Scene::camera(camera(&form, 1e-8, &json!({ "film_distance_m": film * 1e-3 })))
        .lamp(disk([0.0, 0.0, -DISTANCE * 1e-3], [0.0, 0.0, 1.0], LAMP * 1e-3), black(), 1.0, "both")
        .film(16, 16)
        .spp(4096);
    Truth::new(
        "compound-lens-axial-colour",
        &scene,
        value,
        "∫ȳ min(1, (R/(a(1 + s(A + dC)/(B + dD))))²) dλ/∫ȳ dλ, (A, B, C, D) the axial matrix at λ, R and s the lamp's radius and distance, a the stop's radius, d the film's distance",
    )
    .because(
        "The middle of the film is the focus of 500 nm. There it sees a small distant lamp of white light through all of the stop. Other wavelengths \
         focus before the film or behind it. Their rays through the middle of the film part, and those far from the axis miss the lamp: the lens \
         shows it less bright.",
    )
    .confirmed("rays traced through the surfaces at each wavelength, found by bisection", 8e-4, move || {
        over(1, &|nm| photometric_weight(nm) * traced(&lens(nm)))
    })
    .or_else("all wavelengths along the path of the first", kept)
    .or_else("the index of 500 nm at all wavelengths", 1.0)
    .or_else("the wavelength 555 nm alone", share(&lens(555.0)))
    .allows(4e-4, "spherical aberration: rays traced through the surfaces give 3e-4 more")
    .claims(Claim::Dispersion)
    .claims(Claim::PhotometricSensor)
    .sees(0.01)
}
