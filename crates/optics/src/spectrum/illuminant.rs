//! The CIE illuminants, normalised to a luminance.

use super::blackbody::WIEN_X;
use crate::colour::{illuminant_a, illuminant_d65, luminance_of};
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
