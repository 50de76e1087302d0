//! Light that is scattered once, or only absorbed.

use std::f64::consts::PI;

use crate::quadrature::interval;

/// π times the radiance that a slab sends back along μ, scattered once, over the irradiance of a beam along μ₀:
/// ¼ϖp(1 − e^(−τ(1/μ + 1/μ₀)))/(μ + μ₀). `phase` is the phase function's value (of the mean 1) between the two directions.
#[must_use]
pub fn scattered_once(depth: f64, albedo: f64, phase: f64, mu: f64, mu_0: f64) -> f64 {
    0.25 * albedo * phase * -(-depth * (1.0 / mu + 1.0 / mu_0)).exp_m1() / (mu + mu_0)
}

/// The radiance along a ray that passes a point lamp of intensity 1 at the distance h, in fog of these coefficients (m⁻¹) that scatters
/// isotropically, once. The ray begins `from` before its nearest point and ends `to` behind it, metres.
///
/// σ_s/(4π)∫ e^(−σ_t(s + d))/d² ds. Where nothing is lost on the way it is σ_s(θ_b − θ_a)/(4πh), θ the angles seen from the lamp.
#[must_use]
pub fn glow_of_point_lamp(scattering: f64, extinction: f64, h: f64, from: f64, to: f64) -> f64 {
    // Over the angle, ds/d² = dθ/h.
    let (first, last) = ((-from / h).atan(), (to / h).atan());
    let glow = |theta: f64| {
        let way = from + h * theta.tan() + h / theta.cos();
        (-extinction * way).exp()
    };
    scattering / (4.0 * PI * h) * interval(glow, first, last, 1e-13).value
}

/// The mean share of isotropic light that comes through a ball which only absorbs, 2x being the optical depth of its diameter:
/// (1 − (1 + 2x)e^(−2x))/2x².
#[must_use]
pub fn ball_transmittance(x: f64) -> f64 {
    (1.0 - (1.0 + 2.0 * x) * (-2.0 * x).exp()) / (2.0 * x * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_scattered_once_is_the_integral_over_depths() {
        for (depth, mu, mu_0) in [(0.3, 1.0, 1.0), (2.0, 0.4, 0.9), (20.0, 0.7, 0.2)] {
            let quadrature =
                interval(|t| 0.25 * 0.8 * 1.3 * (-t / mu - t / mu_0).exp() / (mu * mu_0), 0.0, depth, 1e-13).value;
            let closed = scattered_once(depth, 0.8, 1.3, mu, mu_0);
            assert!((closed / quadrature - 1.0).abs() < 1e-10, "{closed} is not {quadrature}");
        }
    }

    #[test]
    fn the_glow_of_a_lamp_in_thin_fog_is_the_angle_seen_from_it() {
        let (h, from, to): (f64, f64, f64) = (0.5, 2.0, 1.0);
        let angle = (to / h).atan() + (from / h).atan();
        let known = 0.1 * angle / (4.0 * PI * h);
        assert!((glow_of_point_lamp(0.1, 0.0, h, from, to) / known - 1.0).abs() < 1e-13);
        // With losses, over the way.
        let along = |s: f64| {
            let d2 = h * h + s * s;
            0.1 / (4.0 * PI * d2) * (-0.7 * (from + s + d2.sqrt())).exp()
        };
        let over_the_way = interval(along, -from, to, 1e-14).value;
        assert!((glow_of_point_lamp(0.1, 0.7, h, from, to) / over_the_way - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_ball_lets_through_the_mean_over_its_chords() {
        for x in [0.01, 0.5, 3.0] {
            let chords = interval(|c| 2.0 * c * (-2.0 * x * c).exp(), 0.0, 1.0, 1e-14).value;
            assert!((ball_transmittance(x) / chords - 1.0).abs() < 1e-9, "{x}");
        }
        // Thin: the mean chord is 4V/S = 4r/3.
        let x = 1e-4;
        assert!(((1.0 - ball_transmittance(x)) / (4.0 / 3.0 * x) - 1.0).abs() < 1e-3);
    }
}
