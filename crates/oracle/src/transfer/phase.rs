//! Phase functions as functions of the cosine of the angle of scattering, and as sums of Legendre polynomials.

/// Henyey & Greenstein (1941), of the mean 1 over the sphere: (1 − g²)/(1 + g² − 2g cos θ)^(3/2). `cosine` is that of the angle by which light
/// is turned.
#[must_use]
pub fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cosine).powf(1.5)
}

/// The Legendre moments ½∫p(μ)P_k(μ)dμ of a phase function of the mean 1, k from 0 to `count` − 1.
#[must_use]
pub fn legendre_moments(phase: impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
    let mut moments = vec![0.0; count];
    // Enough nodes for a peak of Henyey & Greenstein's function at g = 0.9.
    for (x, weight) in crate::quadrature::gauss_legendre(256) {
        let value = 0.5 * weight * phase(x);
        for (moment, legendre) in moments.iter_mut().zip(legendre(x, count)) {
            *moment += value * legendre;
        }
    }
    moments
}

/// P_0 to P_(count − 1) at x.
pub(super) fn legendre(x: f64, count: usize) -> Vec<f64> {
    let mut values = Vec::with_capacity(count);
    let (mut previous, mut value) = (0.0, 1.0);
    for k in 0..count {
        values.push(value);
        let k = k as f64;
        (previous, value) = (value, ((2.0 * k + 1.0) * x * value - k * previous) / (k + 1.0));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_moments_of_henyey_and_greenstein_are_the_powers_of_g() {
        for g in [0.0_f64, 0.5, -0.3, 0.85] {
            for (k, moment) in legendre_moments(|x| henyey_greenstein(g, x), 40).into_iter().enumerate() {
                assert!((moment - g.powi(k as i32)).abs() < 1e-12, "{g} {k}: {moment}");
            }
        }
    }
}
