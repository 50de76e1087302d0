//! Things seen by their own light or lit from one side: size, phase, temperature.

use std::f64::consts::PI;

use super::{
    Truth,
    scene::{Scene, black, disk, lambert, shown, sphere},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = far_spheres();
    list.extend(phases());
    list.push(planck());
    list.extend(["light", "mis"].map(eclipse));
    list
}

fn far_spheres() -> Vec<Truth> {
    [1e1, 1e3, 1e5]
        .map(|distance: f64| {
            // tan of the sphere's angular radius, and of half the field of view that makes the sphere's image half of the picture.
            let angular = 1.0 / (distance * distance - 1.0).sqrt();
            let half_view = angular * (0.5 * PI).sqrt();
            let fov_deg = 2.0 * half_view.atan().to_degrees();
            let scene =
                Scene::pinhole([0.0, 0.0, distance], [0.0; 3], fov_deg).lamp(sphere([0.0; 3], 1.0), black(), 1.0, "front");
            Truth::new(format!("far-sphere-at-{distance:.0}-radii"), &scene, 0.5, "π·tan²α/(4·tan²(fov/2)), sin α = R/d")
                .because(
                    "Seen along its axis a sphere's image is a disk of radius tan α. The field of view is chosen so that the disk is \
                     half of the square picture.",
                )
                .or_else("4.7 % of the rays miss, as b² − ac in single precision does at 1e3", 0.4765)
        })
        .into()
}

/// Phase function of a Lambert sphere (Schönberg 1929): its brightness at phase angle α relative to the full phase.
fn phase(alpha_rad: f64) -> f64 {
    (alpha_rad.sin() + (PI - alpha_rad) * alpha_rad.cos()) / PI
}

fn phases() -> Vec<Truth> {
    [("full", 0.0), ("half", 90.0), ("crescent", 135.0)]
        .map(|(name, degrees): (&str, f64)| {
            let alpha = degrees.to_radians();
            let light = [-alpha.sin(), 0.0, -alpha.cos()];
            let scene = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0)
                .object(sphere([0.0; 3], 1.0), lambert(0.6))
                .directional_light(light, 1.0);
            // Albedo/π · ⅔ · disk's share π/4 of the picture.
            let value = 0.6 / 6.0 * phase(alpha);
            Truth::new(format!("moon-{name}"), &scene, value, format!("(ρE/6)(sin α + (π − α)cos α)/π, α = {degrees}°"))
                .because(
                    "A Lambert sphere in parallel light, seen at the phase angle α, integrated over its disk (Schönberg 1929). The disk \
                     fills π/4 of the picture.",
                )
                .confirmed("quadrature over the visible lit part", 1e-6, move || {
                    // Over longitude from the viewer's meridian and latitude: the light's cosine times the viewer's.
                    let integrand = |longitude: f64, latitude: f64| {
                        let lit = latitude.cos().powi(2) * (longitude - alpha).cos().max(0.0) * longitude.cos();
                        lit * latitude.cos()
                    };
                    let total = crate::quadrature::rectangle(
                        integrand,
                        [alpha - 0.5 * PI, 0.5 * PI],
                        [-0.5 * PI, 0.5 * PI],
                        1e-10,
                        400_000,
                    );
                    0.6 / PI * total.value / 4.0
                })
                .or_else("cosine of the light left out", {
                    // The lit part of the disk, (1 + cos α)/2 of it, evenly bright.
                    0.6 / PI * 0.25 * PI * 0.5 * (1.0 + alpha.cos())
                })
        })
        .into()
}

/// Planck's spectral radiance, W·m⁻²·sr⁻¹·nm⁻¹, from the exact SI values of h, c and k.
pub(super) fn planck_radiance(wavelength_nm: f64, temperature_k: f64) -> f64 {
    const H: f64 = 6.626_070_15e-34;
    const C: f64 = 299_792_458.0;
    const K: f64 = 1.380_649e-23;
    let lambda = wavelength_nm * 1e-9;
    2.0 * H * C * C / lambda.powi(5) / (H * C / (lambda * K * temperature_k)).exp_m1() * 1e-9
}

fn planck() -> Truth {
    let band = [559.995, 560.005];
    let scene = Scene::pinhole([0.0, 0.0, 1.0], [0.0; 3], 20.0)
        .thermal_lamp(disk([0.0; 3], [0.0, 0.0, 1.0], 1.0), 5000.0, 1e-4)
        .band(band)
        .spp(64);
    Truth::new(
        "planck-5000-kelvin-at-560-nanometres",
        &scene,
        1e-4 * planck_radiance(560.0, 5000.0),
        "1e-4·2hc²/λ⁵/(e^(hc/λkT) − 1)",
    )
    .because(
        "Planck's law with the exact constants of the SI; over a hundredth of a nanometre it is linear in λ to 1e-10.",
    )
    .confirmed("Wien's law and the series of photon numbers Σe^(−kx)", 1e-9, || {
        // First and second radiation constants of CODATA 2018 for spectral radiance.
        let (c1l, c2) = (1.191_042_972_397_188e-16, 1.438_776_877_503_933e-2);
        let x: f64 = c2 / (560e-9 * 5000.0);
        let photons: f64 = (1..40).map(|k| (-f64::from(k) * x).exp()).sum();
        1e-4 * c1l / 560e-9_f64.powi(5) * photons * 1e-9
    })
    .or_else("Wien's approximation", {
        let x: f64 = 1.438_776_877e-2 / (560e-9 * 5000.0);
        1e-4 * planck_radiance(560.0, 5000.0) * (1.0 - (-x).exp())
    })
    .sees(4e-3)
}

/// A plate below a ball lamp of which a black disk hides all but the rim, as in an annular eclipse.
fn eclipse(how: &'static str) -> Truth {
    const DISTANCE_M: f64 = 2.0;
    const DISK_M: f64 = 0.5;
    /// Of the lamp's solid angle.
    const SEEN: f64 = 0.04;
    let lamp = (1.0 - 1.0 / (DISTANCE_M * DISTANCE_M)).sqrt();
    let hidden = 1.0 - (1.0 - SEEN) * (1.0 - lamp);
    let irradiance = |cosine: f64| PI * (1.0 - cosine * cosine);
    let scene = Scene::light_meter()
        .lamp(sphere([0.0, 0.0, DISTANCE_M], 1.0), black(), 1.0, "front")
        .object(disk([0.0, 0.0, DISK_M], [0.0, 0.0, 1.0], DISK_M * hidden.acos().tan()), black())
        .light_sampling(how)
        .spp(4096);
    Truth::new(
        format!("rim-of-a-ball-lamp-around-a-disk-by-{how}"),
        &scene,
        shown(irradiance(lamp) - irradiance(hidden)),
        "(ρ/π) πL (sin²α − sin²β), sin α = ½, 1 − cos β = 0.96 (1 − cos α)",
    )
    .because(
        "From straight below, ball and disk fill round cones about the same axis, and a cone of half angle α brings πL sin²α. The ring between \
         them has a twenty-fifth of the ball's solid angle.",
    )
    .confirmed("rings of directions", 1e-8, move || {
        let (from, to) = (hidden.acos(), lamp.acos());
        let rings = 1000;
        let step = (to - from) / f64::from(rings);
        let ring = |k: u32| PI * (2.0 * (from + step * (f64::from(k) + 0.5))).sin();
        shown((0..rings).map(ring).sum::<f64>() * step)
    })
    .or_else("the rim of the ball is never found", 0.0)
    .or_else("the disk hides nothing", shown(irradiance(lamp)))
    .or_else("light of the rim arrives as that of the middle would", shown(2.0 * PI * SEEN * (1.0 - lamp)))
    .sees(0.02)
}
