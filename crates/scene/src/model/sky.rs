//! Skies by the CIE's standard: luminance by direction, relative to the zenith.

use etalon_optics::{Spectrum, Vec3, atan2_turns, exp_neg};
use std::f64::consts::{FRAC_PI_2, TAU};

/// One of the sixteen standard skies (CIE S 011/E:2003, ISO 15469:2004), without the sun itself.
#[derive(Clone, Debug, PartialEq)]
pub struct CieSky {
    /// Its number: 1 to 15, or 16, the traditional overcast sky.
    pub number: u8,
    /// Unit vector toward the zenith.
    pub up: [f64; 3],
    /// Unit vector toward the sun, not below the horizon. Five of the skies do not depend on it.
    pub sun: [f64; 3],
    /// Radiance of the zenith, W·m⁻²·sr⁻¹·nm⁻¹: the spectrum of the whole sky.
    pub zenith: Spectrum,
    /// Radiance from below the horizon, in units of that of the zenith.
    pub ground: f64,
}

/// The numbers of [`Perez`]'s formula, for the angle Z from the zenith and χ from the sun. In those of the CIE the offset is e^(dπ/2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyCoefficients {
    /// Gradation from the zenith to the horizon.
    pub a: f64,
    /// See `a`; below 0.
    pub b: f64,
    /// Indicatrix about the sun.
    pub c: f64,
    /// See `c`; below 0.
    pub d: f64,
    /// See `c`.
    pub e: f64,
}

/// Perez's formula, (1 + a e^(b/cos Z)) (1 + c (e^(dχ) − offset) + e cos²χ) times a scale (Perez, Seals & Michalsky, *All-weather model for
/// sky luminance distribution*, Solar Energy 50, 1993). The skies of the CIE and other models share it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perez {
    up: Vec3<f64>,
    sun: Vec3<f64>,
    coefficients: SkyCoefficients,
    offset: f64,
    scale: f64,
}

impl Perez {
    /// The formula that has this value at the zenith, for unit vectors toward it and toward the sun. `offset` is what e^(dχ) is
    /// diminished by.
    pub fn new(zenith: f64, [up, sun]: [Vec3<f64>; 2], coefficients: SkyCoefficients, offset: f64) -> Self {
        let raw = Self { up, sun, coefficients, offset, scale: 1.0 };
        Self { scale: zenith / raw.eval(up), ..raw }
    }

    /// Its value in the direction of a unit vector, not below the horizon.
    #[inline]
    pub fn eval(&self, wi: Vec3<f64>) -> f64 {
        self.at(wi, wi.dot(self.up))
    }

    /// The same, of a direction of this cosine to the zenith, from 0.
    #[inline]
    pub fn at(&self, wi: Vec3<f64>, cos: f64) -> f64 {
        let SkyCoefficients { a, b, c, d, e } = self.coefficients;
        // At the horizon the exponential is 0, as its limit.
        let gradation = 1.0 + a * exp_neg(-b / cos);
        let toward = wi.dot(self.sun);
        let chi = atan2_turns(wi.cross(self.sun).length(), toward) * TAU;
        let indicatrix = 1.0 + c * (exp_neg(-d * chi) - self.offset) + e * toward * toward;
        gradation * indicatrix * self.scale
    }
}

/// a and b of the six gradations.
const GRADATIONS: [[f64; 2]; 6] = [[4.0, -0.7], [1.1, -0.8], [0.0, -1.0], [-1.0, -0.55], [-1.0, -0.32], [-1.0, -0.15]];

/// c, d and e of the six indicatrices.
const INDICATRICES: [[f64; 3]; 6] =
    [[0.0, -1.0, 0.0], [2.0, -1.5, 0.15], [5.0, -2.5, 0.3], [10.0, -3.0, 0.45], [16.0, -3.0, 0.3], [24.0, -2.8, 0.15]];

/// Gradation and indicatrix of the skies 1 to 15, counted from 1 as the standard does.
const SKIES: [[usize; 2]; 15] = [
    [1, 1],
    [1, 2],
    [2, 1],
    [2, 2],
    [3, 1],
    [3, 2],
    [3, 3],
    [3, 4],
    [4, 2],
    [4, 3],
    [4, 4],
    [5, 4],
    [5, 5],
    [6, 5],
    [6, 6],
];

impl CieSky {
    /// The numbers of the skies 1 to 15; `None` of the traditional overcast sky, (1 + 2 cos Z)/3.
    fn coefficients(&self) -> Option<SkyCoefficients> {
        let [gradation, indicatrix] = SKIES.get(usize::from(self.number).wrapping_sub(1))?;
        let ([a, b], [c, d, e]) = (GRADATIONS[gradation - 1], INDICATRICES[indicatrix - 1]);
        Some(SkyCoefficients { a, b, c, d, e })
    }

    /// Its radiance by direction, relative to the zenith; `None` of the traditional overcast sky, (1 + 2 cos Z)/3.
    pub fn perez(&self) -> Option<Perez> {
        let k = self.coefficients()?;
        let directions = [self.up, self.sun].map(Vec3::from_array);
        Some(Perez::new(1.0, directions, k, exp_neg(-k.d * FRAC_PI_2)))
    }

    /// Whether it depends on where the sun is.
    pub fn needs_sun(&self) -> bool {
        self.coefficients().is_some_and(|k| k.c != 0.0 || k.e != 0.0)
    }
}
