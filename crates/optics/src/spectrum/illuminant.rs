//! The CIE illuminants, normalised to a luminance.

use super::blackbody::WIEN_X;
use crate::colour::{illuminant_a, illuminant_d65, luminance_of, xyz_of};
use crate::error::{OpticsError, non_negative};
use std::sync::LazyLock;

/// A CIE illuminant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Illuminant {
    /// Average daylight, correlated colour temperature 6504 K; zero outside 300 to 830 nm, where it is not defined.
    D65,
    /// Equal energy: constant.
    E,
    /// Incandescent lamp, 2856 K.
    A,
}

static D65_PER_POWER: LazyLock<f64> = LazyLock::new(|| 1.0 / luminance_of(illuminant_d65));
static A_PER_POWER: LazyLock<f64> = LazyLock::new(|| 1.0 / luminance_of(illuminant_a));

impl Illuminant {
    /// Every illuminant.
    pub const ALL: [Self; 3] = [Self::D65, Self::E, Self::A];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::D65 => "D65",
            Self::E => "E",
            Self::A => "A",
        }
    }

    /// The illuminant of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|illuminant| illuminant.name() == name)
    }

    /// Relative power at a wavelength in nm, normalised so that the luminance is that of the constant spectrum 1:
    /// Σ S·ȳ = Σ ȳ over 360 to 830 nm.
    #[inline]
    pub fn eval(self, wavelength_nm: f64) -> f64 {
        match self {
            Self::D65 => *D65_PER_POWER * illuminant_d65(wavelength_nm),
            Self::E => 1.0,
            Self::A => *A_PER_POWER * illuminant_a(wavelength_nm),
        }
    }

    /// XYZ of a surface of this reflectance under it; the perfect reflector has Y = 1.
    pub fn xyz_of_reflectance(self, reflectance: impl Fn(f64) -> f64) -> [f64; 3] {
        xyz_of(|nm| reflectance(nm) * self.eval(nm))
    }

    /// The largest value of [`Illuminant::eval`] over a closed range, nm.
    pub fn max_over(self, range_nm: [f64; 2]) -> f64 {
        let [first, last] = range_nm;
        let ends = self.eval(first).max(self.eval(last));
        match self {
            Self::E => 1.0,
            // Piecewise linear with a row every 5 nm.
            Self::D65 => (0..107)
                .map(|i| 300.0 + 5.0 * f64::from(i))
                .filter(|nm| (first..=last).contains(nm))
                .fold(ends, |max, nm| max.max(self.eval(nm))),
            // A Planck curve: it rises to a peak and falls after it (Wien's displacement law with x as for a black body).
            Self::A => {
                let peak_nm: f64 = 1.435e7 / (WIEN_X * 2848.0);
                self.eval(peak_nm.clamp(first, last))
            }
        }
    }
}

/// An illuminant of a given luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledIlluminant {
    illuminant: Illuminant,
    scale: f64,
}

impl ScaledIlluminant {
    /// An illuminant with the luminance of the constant spectrum `scale`.
    ///
    /// Fails if the scale is negative or not finite.
    pub fn new(illuminant: Illuminant, scale: f64) -> Result<Self, OpticsError> {
        Ok(Self { illuminant, scale: non_negative("an illuminant's scale", scale)? })
    }

    /// The illuminant.
    pub fn illuminant(&self) -> Illuminant {
        self.illuminant
    }

    /// The constant spectrum of the same luminance.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Value at a wavelength in nm.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        self.scale * self.illuminant.eval(wavelength_nm)
    }

    pub(super) fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        self.scale * self.illuminant.max_over(range_nm)
    }

    pub(super) fn is_constant(&self) -> bool {
        self.illuminant == Illuminant::E || self.scale == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn illuminants_have_their_published_chromaticities() {
        // CIE 15:2018, table T.3 (2° observer). The published digits come from sums of 5 nm steps from 380 to 780 nm, ours
        // from 1 nm steps from 360 to 830 nm; the two differ by up to 1.1e-5.
        for (illuminant, x, y, tolerance) in [
            (Illuminant::D65, 0.312_72, 0.329_03, 1.5e-5),
            (Illuminant::A, 0.447_58, 0.407_45, 1.5e-5),
            (Illuminant::E, 0.333_33, 0.333_33, 5e-5),
        ] {
            let v = xyz_of(|nm| illuminant.eval(nm));
            let sum = v[0] + v[1] + v[2];
            assert!((v[0] / sum - x).abs() < tolerance, "{illuminant:?} x {}", v[0] / sum);
            assert!((v[1] / sum - y).abs() < tolerance, "{illuminant:?} y {}", v[1] / sum);
        }
    }
}
