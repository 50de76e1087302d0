//! Henyey & Greenstein, *Diffuse Radiation in the Galaxy*, ApJ 93, 70 (1941): (1 − g²)/(1 + g² − 2g cos θ)^(3/2)/4π.

use std::f64::consts::PI;

/// One of a mean cosine g.
#[derive(Clone, Copy, Debug)]
pub(super) struct HenyeyGreenstein {
    pub g: f64,
}

impl HenyeyGreenstein {
    #[inline]
    pub(super) fn density(&self, cos: f64) -> f64 {
        let g = self.g;
        // 1 + g² − 2g cos θ, of which a peak leaves little: as a sum of what is not below 0.
        let squared = match g > 0.0 {
            true => (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos),
            false => (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cos),
        };
        (1.0 - g) * (1.0 + g) / (4.0 * PI * squared * squared.sqrt())
    }

    /// Inverts the distribution: with s = 2u − 1, cos θ = (s(1 + g²) + ½g(s²(1 + g²) + 3 − g²))/(1 + gs)². This is the usual formula
    /// multiplied out, so that nothing is divided by g.
    #[inline]
    pub(super) fn cosine(&self, u: f64) -> f64 {
        let (g, s) = (self.g, 2.0 * u - 1.0);
        let one_plus = 1.0 + g * g;
        let below = 1.0 + g * s;
        (s * one_plus + 0.5 * g * (s * s * one_plus + 3.0 - g * g)) / (below * below)
    }
}
