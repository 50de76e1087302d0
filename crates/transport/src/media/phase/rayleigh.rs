//! Scattering by what is much smaller than the wavelength (Rayleigh 1871): 3(1 + cos²θ)/16π.

use crate::polarisation::mueller::{Matrix, pair};
use std::f64::consts::PI;

#[inline]
pub(super) fn density(cos: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos * cos)
}

/// Inverts the distribution: the root of c³ + 3c = 8u − 4, by Newton's method. From c = (8u − 4)/4 on, which is not below the root on its
/// own side of 0, six steps leave nothing but rounding.
#[inline]
pub(super) fn cosine(u: f64) -> f64 {
    let sum = 8.0 * u - 4.0;
    let mut c = 0.25 * sum;
    for _ in 0..6 {
        c -= (c * (c * c + 3.0) - sum) / (3.0 * (c * c + 1.0));
    }
    c
}

/// What it does to polarisation, over its first element, in frames whose x is across the plane of scattering: light that swings across it
/// is scattered alike everywhere, light that swings within it as cos²θ (Chandrasekhar, *Radiative Transfer*, §16).
#[inline]
pub(super) fn mueller(cos: f64) -> Matrix {
    let squared = cos * cos;
    let sum = 1.0 + squared;
    pair((1.0 - squared) / sum, 2.0 * cos / sum, 0.0)
}
