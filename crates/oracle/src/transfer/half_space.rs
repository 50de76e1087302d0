//! A half-space that scatters alike in all directions.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::quadrature::{gauss_legendre, interval};

/// Endless matter below a plane, whose scattering is isotropic. What comes back depends on the albedo alone, on no length.
///
/// H(μ) = exp(−(μ/π)∫₀^{π/2} ln(1 − ϖ t cot t)/(cos² t + μ² sin² t) dt), the solution of Chandrasekhar's equation
/// H(μ) = 1 + ½ϖ μ H(μ)∫₀¹ H(μ′)/(μ + μ′) dμ′ (*Radiative Transfer*, 1950, ch. V).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    albedo: f64,
}

impl HalfSpace {
    /// Of this albedo of a single scattering, in [0, 1].
    #[must_use]
    pub fn new(albedo: f64) -> Self {
        Self { albedo }
    }

    /// Chandrasekhar's H-function.
    #[must_use]
    pub fn h(&self, mu: f64) -> f64 {
        if mu == 0.0 {
            return 1.0;
        }
        // The integrand has a peak of width μ at π/2, and at ϖ = 1 a logarithm at 0: t = u² flattens that, tan s = μ tan t the peak.
        let logarithm = |t: f64| {
            // 1 − t cot t, by its series where that cancels.
            let rest = if t < 1e-3 { t * t / 3.0 } else { 1.0 - t / t.tan() };
            (1.0 - self.albedo + self.albedo * rest).ln()
        };
        // dt/(cos² t + μ² sin² t) = ds/μ with tan s = μ tan t.
        let integrand = |u: f64| {
            let s = u * u;
            let t = (s.sin() / mu).atan2(s.cos());
            2.0 * u * logarithm(t)
        };
        let integral = interval(integrand, 0.0, FRAC_PI_2.sqrt(), 1e-13).value;
        (-integral / PI).exp()
    }

    /// The share of a beam that comes back, the cosine of whose angle to the normal is μ₀: 1 − H(μ₀)√(1 − ϖ).
    #[must_use]
    pub fn plane_albedo(&self, mu_0: f64) -> f64 {
        1.0 - self.h(mu_0) * (1.0 - self.albedo).sqrt()
    }

    /// The share of diffuse light that comes back: 2∫ plane albedo · μ dμ.
    #[must_use]
    pub fn diffuse_albedo(&self) -> f64 {
        gauss_legendre(48).iter().map(|(x, w)| 0.5 * (1.0 + x) * w * self.plane_albedo(0.5 * (1.0 + x))).sum()
    }

    /// The radiance along μ over that of a white Lambertian surface in the same beam: ϖ H(μ)H(μ₀)/(4(μ + μ₀)).
    #[must_use]
    pub fn radiance_factor(&self, mu: f64, mu_0: f64) -> f64 {
        0.25 * self.albedo * self.h(mu) * self.h(mu_0) / (mu + mu_0)
    }

    /// H once more, as the solution of 1/H(μ) = √(1 − ϖ) + ½ϖ∫ μ′H(μ′)/(μ + μ′) dμ′ on the nodes of a quadrature.
    #[must_use]
    pub fn h_by_iteration(&self, mu: f64) -> f64 {
        // H bends as μ ln μ at 0: nodes in μ = x⁴ gather there.
        let nodes: Vec<(f64, f64)> = gauss_legendre(64)
            .iter()
            .map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w))
            .map(|(x, w)| (x.powi(4), 4.0 * x.powi(3) * w))
            .collect();
        let inverse = |h: &[f64], mu: f64| {
            let integral: f64 = nodes.iter().zip(h).map(|(&(other, w), h)| w * other * h / (mu + other)).sum();
            (1.0 - self.albedo).sqrt() + 0.5 * self.albedo * integral
        };
        let mut h = vec![1.0; nodes.len()];
        for _ in 0..400 {
            // The mean of two steps: one alone swings.
            let next: Vec<f64> =
                nodes.iter().zip(&h).map(|(node, old)| 0.5 * (old + 1.0 / inverse(&h, node.0))).collect();
            let change = next.iter().zip(&h).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            h = next;
            if change < 1e-15 {
                break;
            }
        }
        1.0 / inverse(&h, mu)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plane albedos for the cosines 1 and ½, and the diffuse albedo.
    const PUBLISHED: [(f64, [f64; 3]); 5] = [
        (0.5, [0.115_225_9, 0.160_144_4, 0.146_544_4]),
        (0.8, [0.285_254_5, 0.367_969_8, 0.341_866_8]),
        (0.9, [0.414_947_5, 0.507_938_9, 0.478_024_5]),
        (0.99, [0.752_720_7, 0.815_139_9, 0.794_563_7]),
        (0.999, [0.912_845_3, 0.938_060_9, 0.929_713_3]),
    ];

    #[test]
    fn half_spaces_have_their_known_albedos() {
        for (albedo, [normal, slant, diffuse]) in PUBLISHED {
            let half_space = HalfSpace::new(albedo);
            assert!((half_space.plane_albedo(1.0) - normal).abs() < 6e-8, "{albedo}: {}", half_space.plane_albedo(1.0));
            assert!((half_space.plane_albedo(0.5) - slant).abs() < 6e-8, "{albedo}: {}", half_space.plane_albedo(0.5));
            assert!((half_space.diffuse_albedo() - diffuse).abs() < 6e-8, "{albedo}: {}", half_space.diffuse_albedo());
        }
        assert!((HalfSpace::new(0.9).radiance_factor(1.0, 1.0) - 0.385_072_3).abs() < 6e-8);
        assert!((HalfSpace::new(1.0).radiance_factor(1.0, 1.0) - 1.056_920_3).abs() < 6e-8);
        assert!((HalfSpace::new(1.0).diffuse_albedo() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_integral_for_h_solves_its_equation() {
        for albedo in [0.1, 0.5, 0.9, 0.999, 1.0] {
            let half_space = HalfSpace::new(albedo);
            for mu in [0.01, 0.2, 0.5, 1.0] {
                let (integral, equation) = (half_space.h(mu), half_space.h_by_iteration(mu));
                assert!((integral / equation - 1.0).abs() < 1e-8, "{albedo} {mu}: {integral} is not {equation}");
            }
        }
    }
}
