//! What the film sees away from the axis: cos⁴, vignetting, and a camera that moves.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{camera, lens_form};
use crate::quadrature::gauss_legendre;
use crate::truths::{
    Claim, Truth,
    lens_tracer::{Lens, aperture},
    scene::{Scene, black, parallelogram},
};

/// The irradiance, over π, of a disk of radiance 1 and radius a on a parallel plane at the distance z, r from its axis (P. D. Foote 1915).
fn foote(a: f64, z: f64, r: f64) -> f64 {
    let (a2, z2, r2) = (a * a, z * z, r * r);
    let sum = z2 + r2 + a2;
    0.5 * (1.0 - (z2 + r2 - a2) / (sum * sum - 4.0 * a2 * r2).sqrt())
}

/// The mean of a function of the distance from the axis over a pixel of the film.
fn over_pixel(middle: [f64; 2], side: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss_legendre(8);
    let at = |k: usize, x: f64| middle[k] + 0.5 * side * x;
    rule.iter()
        .flat_map(|u| rule.iter().map(move |v| (u, v)))
        .map(|(u, v)| 0.25 * u.1 * v.1 * f(at(0, u.0).hypot(at(1, v.0))))
        .sum()
}

pub(super) fn truths() -> Vec<Truth> {
    let (z, sensor) = (30.0, 36.0);
    let side = sensor / 9.0;
    // The upper right pixel of nine by nine.
    let corner = ([4.0 * side; 2], [8, 9, 0, 1]);
    let sky = |lens: &Value, further: &Value| {
        Scene::camera(camera(lens, sensor * 1e-3, further)).sky(1.0).film(9, 9).spp(4096)
    };
    let film = json!({ "film_distance_m": z * 1e-3 });
    let a = 6.0;
    let axial = a * a / (a * a + z * z);
    let alone = Lens { surfaces: vec![aperture(a, 0.0)], film: z };
    let cos = |r: f64| z / z.hypot(r);
    let mean = |f: &dyn Fn(f64) -> f64| over_pixel(corner.0, side, f);
    let stop = Truth::new(
        "compound-lens-cosine-to-the-fourth",
        &sky(&lens_form(&alone, &json!(1), "none"), &film),
        mean(&|r| foote(a, z, r)) / axial,
        "½(1 − (z² + r² − a²)/√((z² + r² + a²)² − 4a²r²)) (a² + z²)/a², a = 6 mm, z = 30 mm, over a pixel at r = 22.6 mm",
    )
    .because("A stop without glass, under a uniform sky: the film sees a disk of radiance 1. Far from the axis its irradiance falls almost with cos⁴.")
    .confirmed("cos⁴/z² summed over the stop", 1e-3, move || {
        let n = 400;
        let along = |k: i32| a * (2.0 * (f64::from(k) + 0.5) / f64::from(n) - 1.0);
        let cell = (2.0 * a / f64::from(n)).powi(2);
        let of = |r: f64| {
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..n {
                    if along(i).hypot(along(j)) < a {
                        let d2 = z * z + (along(i) - r).powi(2) + along(j).powi(2);
                        sum += z * z / (d2 * d2) * cell;
                    }
                }
            }
            sum / PI
        };
        let rule = gauss_legendre(4);
        let at = |k: usize, x: f64| corner.0[k] + 0.5 * side * x;
        let pairs = rule.iter().flat_map(|u| rule.iter().map(move |v| (u, v)));
        pairs.map(|(u, v)| 0.25 * u.1 * v.1 * of(at(0, u.0).hypot(at(1, v.0)))).sum::<f64>() / axial
    })
    .or_else("no fall-off", 1.0)
    .or_else("cos³", mean(&|r| cos(r).powi(3)))
    .or_else("cos²", mean(&|r| cos(r).powi(2)))
    .reads_pixels(corner.1)
    .sees(5e-3);

    // Two apertures in a row: the film sees the stop through the other.
    let (a, b, gap) = (2.0, 2.0, 4.0);
    let two = Lens { surfaces: vec![aperture(a, gap), aperture(b, 0.0)], film: z };
    // The aperture next to the film, seen on the plane of the stop from r: magnified, and moved off the axis, away from r.
    let far = z + gap;
    let common = move |r: f64| {
        let (radius, shift) = (b * far / z, r * gap / z);
        let half_chord = |x: f64| (a * a - x * x).min(radius * radius - (x + shift).powi(2)).max(0.0).sqrt();
        let (low, high) = ((-a).max(-shift - radius), a.min(radius - shift));
        let (rule, across) = (gauss_legendre(24), gauss_legendre(6));
        let cell = |x: f64, y: f64| far * far / (far * far + (r - x).powi(2) + y * y).powi(2);
        // x = middle − half cos φ, so that the chord is smooth at both ends.
        let of_angle = |phi: f64| {
            let x = 0.5 * (low + high) - 0.5 * (high - low) * phi.cos();
            let h = half_chord(x);
            h * across.iter().map(|(v, w)| w * cell(x, h * v)).sum::<f64>() * 0.5 * (high - low) * phi.sin()
        };
        0.5 * PI * rule.iter().map(|(u, w)| w * of_angle(0.5 * PI * (1.0 + u))).sum::<f64>()
    };
    // The cone on the axis is that of the stop, which is farther and seen smaller.
    let axial = a * a / (a * a + far * far);
    let vignetted = over_pixel([3.0 * side, 0.0], side, common) / (PI * axial);
    let alone = over_pixel([3.0 * side, 0.0], side, |r| PI * foote(a, far, r)) / (PI * axial);
    let vignetting = Truth::new(
        "compound-lens-vignetting",
        &sky(&lens_form(&two, &json!(1), "none"), &film),
        vignetted,
        "∫∫ z²/(z² + (r − x)² + y²)² dx dy over what two circles of 2 mm and 2.27 mm have in common whose centres are r·4/30 apart, z = 34 mm, \
         over a pixel at r = 12 mm",
    )
    .because("From the side of the film the two apertures overlap in part.")
    .confirmed("rays counted over the aperture next to the film", 5e-3, move || {
        let n = 200;
        let along = |k: i32| b * (2.0 * (f64::from(k) + 0.5) / f64::from(n) - 1.0);
        let cell = (2.0 * b / f64::from(n)).powi(2);
        let of = |x: f64, y: f64| {
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let to = [along(i), along(j)];
                    if two.trace([x, y], to).is_some() {
                        let d2 = z * z + (to[0] - x).powi(2) + (to[1] - y).powi(2);
                        sum += z * z / (d2 * d2) * cell;
                    }
                }
            }
            sum / PI
        };
        let rule = gauss_legendre(3);
        let pairs = rule.iter().flat_map(|u| rule.iter().map(move |v| (u, v)));
        pairs.map(|(u, v)| 0.25 * u.1 * v.1 * of(3.0 * side + 0.5 * side * u.0, 0.5 * side * v.0)).sum::<f64>() / axial
    })
    .or_else("the stop alone", alone)
    .allows(5e-4, "the quadrature of a region with two corners, 1e-3 relative; single precision 2e-5 relative")
    .reads_pixels([7, 8, 4, 5])
    .sees(0.01);
    vec![stop, vignetting, moving()]
}

/// From x = −1 to 1 m while the shutter is open, past a lamp from 0.25 to 0.75 m.
fn moving() -> Truth {
    let pinhole = Lens { surfaces: vec![aperture(0.01, 0.0)], film: 50.0 };
    let further = json!({
        "film_distance_m": 0.05, "shutter_s": [0, 2],
        "keyframes": [{ "time_s": 0 }, { "time_s": 2, "transform": [{ "translate_m": [2, 0, 0] }] }],
    });
    let mut camera = camera(&lens_form(&pinhole, &json!(1), "none"), 1e-6, &further);
    camera.as_object_mut().expect("an object").remove("direction");
    (camera["position_m"], camera["look_at_m"]) = (json!([-1, 0, 0]), json!([-1, 0, -1]));
    let scene = Scene::camera(camera)
        .lamp(parallelogram([0.25, -1.0, -1.0], [0.5, 0.0, 0.0], [0.0, 2.0, 0.0]), black(), 1.0, "front")
        .film(16, 16)
        .spp(1024);
    Truth::new("compound-lens-that-moves-past-a-lamp", &scene, 0.25, "0.5/2")
        .because("A camera that moves at 1 m/s for two seconds is before a lamp half a metre wide for a quarter of the time.")
        .or_else("it stands still", 0.0)
        .or_else("it stands in the middle", 1.0)
        .claims(Claim::Motion)
        .sees(0.01)
}
