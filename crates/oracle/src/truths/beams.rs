//! Beams: even and Gaussian ones, parallel and widening, on plates across and askew.

use std::f64::consts::PI;

use serde_json::json;

use super::{
    Truth,
    scene::{Scene, shown},
};
use crate::vector::{Vec3, cross, dot, normalize};

const POWER: f64 = 3.0;

/// A beam whose aperture, of the radius `radius_m`, is 2 m before the plate along the axis; the axis misses the plate by `aside_m`.
#[derive(Clone, Copy)]
struct Beam {
    radius_m: f64,
    half_angle_deg: f64,
    gaussian: bool,
    /// Angle between the axis and the plate's normal.
    askew_deg: f64,
    aside_m: f64,
}

impl Beam {
    const DEPTH_M: f64 = 2.0;

    /// The axis, and the direction across it in which the plate lies.
    fn axes(&self) -> [Vec3; 2] {
        let (sin, cos) = self.askew_deg.to_radians().sin_cos();
        // In the plane of the axis and the normal, where an askew plate makes the most of the widening.
        [[0.6 * sin, 0.8 * sin, -cos], [0.6 * cos, 0.8 * cos, sin]]
    }

    fn position(&self) -> Vec3 {
        let [axis, across] = self.axes();
        [0, 1, 2].map(|k| -Self::DEPTH_M * axis[k] - self.aside_m * across[k])
    }

    /// Φ p(r/w)/(πw²) for a beam of the radius w.
    fn across(&self, distance_m: f64, radius_m: f64) -> f64 {
        let squared = (distance_m / radius_m).powi(2);
        let share = match self.gaussian {
            true => 2.0 * (-2.0 * squared).exp(),
            false => f64::from(u8::from(squared < 1.0)),
        };
        POWER * share / (PI * radius_m * radius_m)
    }

    /// What the plate receives: that of a plane across the axis, by how much more of the ray's tube the plate cuts.
    fn irradiance(&self) -> f64 {
        let widening = self.half_angle_deg.to_radians().tan();
        let across = self.across(self.aside_m, self.radius_m + Self::DEPTH_M * widening);
        let [axis, side] = self.axes();
        // The ray, scaled so that it advances by 1 along the axis.
        let slope = self.aside_m * widening / (self.radius_m + Self::DEPTH_M * widening);
        across * -(axis[2] + slope * side[2])
    }

    /// The irradiance of the aperture itself at a distance from the axis: the profile, over its integral by quadrature.
    fn at_the_aperture(&self, distance_m: f64) -> f64 {
        let profile = |r: f64| if self.gaussian { (-2.0 * (r / self.radius_m).powi(2)).exp() } else { 1.0 };
        // A Gaussian one has lost all but 1e-31 of its power at six radii.
        let reach_m = if self.gaussian { 6.0 * self.radius_m } else { self.radius_m };
        let whole = crate::quadrature::interval(|r| 2.0 * PI * r * profile(r), 0.0, reach_m, 1e-12).value;
        POWER * profile(distance_m) / whole
    }

    /// The same as [`Beam::irradiance`], from the aperture: where the rays of two short edges on the plate left it, and the flux between them.
    fn by_the_aperture(&self) -> f64 {
        let widening = self.half_angle_deg.to_radians().tan();
        let ([axis, side], position) = (self.axes(), self.position());
        let third = normalize(cross(axis, side));
        // Back along the ray to the aperture: the distances from the axis shrink in proportion to the width of the beam.
        let left_at = |x: f64, y: f64| {
            let from: Vec3 = [x - position[0], y - position[1], -position[2]];
            let width = self.radius_m + dot(from, axis) * widening;
            [dot(from, side), dot(from, third)].map(|aside| aside * self.radius_m / width)
        };
        let h = 1e-4;
        let along = |plus: [f64; 2], minus: [f64; 2]| [0, 1].map(|k| (plus[k] - minus[k]) / (2.0 * h));
        let (dx, dy) = (along(left_at(h, 0.0), left_at(-h, 0.0)), along(left_at(0.0, h), left_at(0.0, -h)));
        let [a, b] = left_at(0.0, 0.0);
        self.at_the_aperture(a.hypot(b)) * (dx[0] * dy[1] - dx[1] * dy[0]).abs()
    }

    fn scene(&self) -> Scene {
        Scene::light_meter()
            .light(json!({
                "type": "beam", "position_m": self.position(), "direction": self.axes()[0], "radius_m": self.radius_m,
                "half_angle_deg": self.half_angle_deg, "profile": if self.gaussian { "gaussian" } else { "uniform" }, "power": POWER,
            }))
            .film(16, 16)
            .spp(64)
    }
}

pub(super) fn truths() -> Vec<Truth> {
    let make = |name: &str, beam: Beam, formula: &str| {
        let value = shown(beam.irradiance());
        let scene = beam.scene();
        let parallel = Beam { half_angle_deg: 0.0, ..beam };
        let truth = Truth::new(name, &scene, value, formula)
            .because("The flux of a beam is the same through every plane across it: Φ p(r/w)/(πw²), with the cosine of a plate that is askew.")
            .sees(1e-3);
        if value == 0.0 {
            return truth.or_else("a Gaussian beam", shown(Beam { gaussian: true, ..parallel }.irradiance()));
        }
        let by_the_aperture = shown(beam.by_the_aperture());
        let truth = truth
            .confirmed(
                "the flux that left the aperture between the rays of the plate's edges, by differences",
                1e-7,
                move || by_the_aperture,
            )
            .or_else(
                "the radius taken for a diameter",
                shown(Beam { radius_m: 0.5 * beam.radius_m, ..parallel }.irradiance()),
            );
        match beam.half_angle_deg > 0.0 {
            true => truth.or_else("parallel", shown(parallel.irradiance())),
            false => {
                truth.or_else("the other profile", shown(Beam { gaussian: !beam.gaussian, ..parallel }.irradiance()))
            }
        }
    };
    let parallel =
        |radius_m, gaussian, askew_deg, aside_m| Beam { radius_m, half_angle_deg: 0.0, gaussian, askew_deg, aside_m };
    vec![
        make("beam-inside-its-edge", parallel(0.4, false, 0.0, 0.36), "(ρ/π) Φ/(πw²)"),
        make("beam-beyond-its-edge", parallel(0.4, false, 0.0, 0.44), "0"),
        make("beam-askew", parallel(0.4, false, 50.0, 0.1), "(ρ/π) Φ cos 50°/(πw²)"),
        make("gaussian-beam-off-its-axis", parallel(0.5, true, 0.0, 0.35), "(ρ/π) 2Φ exp(−2r²/w²)/(πw²)"),
        make(
            "gaussian-beam-that-widens-askew",
            Beam { radius_m: 0.2, half_angle_deg: 10.0, gaussian: true, askew_deg: 40.0, aside_m: 0.2 },
            "(ρ/π) 2Φ exp(−2r²/w²)/(πw²) (cos 40° − s sin 40°), w = 0.2 + 2 tan 10°, s = 0.2 tan 10°/w",
        ),
    ]
}
