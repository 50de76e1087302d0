//! Symbolic spectra: nothing is sampled until a wavelength asks.

mod basis;
mod blackbody;
mod illuminant;
mod integral;
mod rgb;
mod sigmoid;
mod tabulated;

pub use basis::RgbBasis;
pub use blackbody::{Blackbody, LIGHT_M_S, PLANCK_J_S};
pub use illuminant::{Illuminant, ScaledIlluminant};
pub use integral::{simpson, whole_nm};
pub use rgb::{RgbEmission, RgbReflectance};
pub use sigmoid::Sigmoid;
pub use tabulated::{Outside, Tabulated};

use crate::colour::{daylight_components, daylight_wavelengths_nm};
use crate::error::{OpticsError, non_negative};

/// A spectrum: reflectance (dimensionless), radiance (W·m⁻²·sr⁻¹·nm⁻¹) or another density, by where it is used.
///
/// Every kind but [`Spectrum::Constant`] can only be made by a constructor that validates; its values are finite and not
/// negative at every wavelength above 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// The same value at every wavelength; [`Spectrum::constant`] checks that it is finite and not negative.
    Constant(f64),
    /// Values at increasing wavelengths, interpolated linearly.
    Tabulated(Tabulated),
    /// Thermal radiance after Planck's law.
    Blackbody(Blackbody),
    /// A CIE illuminant of a given luminance.
    Illuminant(ScaledIlluminant),
    /// A reflectance that shows a linear Rec. 709 colour under D65.
    RgbReflectance(RgbReflectance),
    /// A light that shows a linear Rec. 709 colour.
    RgbEmission(RgbEmission),
    /// Another spectrum times a number.
    Scaled {
        /// The number.
        factor: f64,
        /// The other spectrum.
        spectrum: Box<Spectrum>,
    },
}

impl Spectrum {
    /// The spectrum that is zero everywhere.
    pub const ZERO: Self = Self::Constant(0.0);
    /// The spectrum that is one everywhere.
    pub const ONE: Self = Self::Constant(1.0);

    /// The same value at every wavelength.
    ///
    /// Fails if the value is negative or not finite.
    pub fn constant(value: f64) -> Result<Self, OpticsError> {
        non_negative("a constant spectrum", value).map(Self::Constant)
    }

    /// See [`Tabulated::new`].
    pub fn tabulated(wavelengths_nm: Vec<f64>, values: Vec<f64>, outside: Outside) -> Result<Self, OpticsError> {
        Tabulated::new(wavelengths_nm, values, outside).map(Self::Tabulated)
    }

    /// See [`Blackbody::new`].
    pub fn blackbody(temperature_k: f64, scale: f64) -> Result<Self, OpticsError> {
        Blackbody::new(temperature_k, scale).map(Self::Blackbody)
    }

    /// See [`ScaledIlluminant::new`].
    pub fn illuminant(illuminant: Illuminant, scale: f64) -> Result<Self, OpticsError> {
        ScaledIlluminant::new(illuminant, scale).map(Self::Illuminant)
    }

    /// Daylight of the weights M₁ and M₂ of its components, as the table of those has it: 100 at 560 nm; zero outside 300 to 830 nm.
    ///
    /// Fails if it is negative somewhere: far from the locus of daylight.
    pub fn daylight([m1, m2]: [f64; 2]) -> Result<Self, OpticsError> {
        let value = |[s0, s1, s2]: [f64; 3]| s0 + m1 * s1 + m2 * s2;
        let values = daylight_wavelengths_nm().map(|nm| value(daylight_components(nm))).collect();
        Self::tabulated(daylight_wavelengths_nm().collect(), values, Outside::Zero)
    }

    /// See [`RgbReflectance::new`].
    pub fn rgb_reflectance(rgb: [f64; 3]) -> Result<Self, OpticsError> {
        RgbReflectance::new(rgb).map(Self::RgbReflectance)
    }

    /// See [`RgbEmission::new`].
    pub fn rgb_emission(rgb: [f64; 3], white: Illuminant) -> Result<Self, OpticsError> {
        RgbEmission::new(rgb, white).map(Self::RgbEmission)
    }

    /// This spectrum times a number.
    ///
    /// Fails if the factor is negative or not finite.
    pub fn scaled(self, factor: f64) -> Result<Self, OpticsError> {
        let factor = non_negative("a spectrum's scale", factor)?;
        Ok(match self {
            Self::Constant(v) => Self::Constant(v * factor),
            Self::Scaled { factor: inner, spectrum } => Self::Scaled { factor: inner * factor, spectrum },
            other => Self::Scaled { factor, spectrum: Box::new(other) },
        })
    }

    /// Value at a wavelength in nm, above 0.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Constant(v) => *v,
            Self::Tabulated(t) => t.eval(wavelength_nm),
            Self::Blackbody(b) => b.eval(wavelength_nm),
            Self::Illuminant(i) => i.eval(wavelength_nm),
            Self::RgbReflectance(r) => r.eval(wavelength_nm),
            Self::RgbEmission(e) => e.eval(wavelength_nm),
            Self::Scaled { factor, spectrum } => factor * spectrum.eval(wavelength_nm),
        }
    }

    /// The largest value over the closed wavelength range in nm.
    ///
    /// Exact to rounding for every kind but [`Spectrum::RgbEmission`], where it is an upper bound: the largest, over steps of
    /// 1 nm, of the shape's maximum times the white's.
    pub fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        match self {
            Self::Constant(v) => *v,
            Self::Tabulated(t) => t.max_over(range_nm),
            Self::Blackbody(b) => b.max_over(range_nm),
            Self::Illuminant(i) => i.max_over(range_nm),
            Self::RgbReflectance(r) => r.max_over(range_nm),
            Self::RgbEmission(e) => e.max_over(range_nm),
            Self::Scaled { factor, spectrum } => factor * spectrum.max_over(range_nm),
        }
    }

    /// Whether the value is known to be the same at every wavelength (a grey RGB reflectance is).
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Tabulated(t) => t.is_constant(),
            Self::Blackbody(b) => b.scale() == 0.0,
            Self::Illuminant(i) => i.is_constant(),
            Self::RgbReflectance(r) => r.is_constant(),
            Self::RgbEmission(e) => e.is_constant(),
            Self::Scaled { factor, spectrum } => *factor == 0.0 || spectrum.is_constant(),
        }
    }

    /// Whether the value is known to be zero at every wavelength.
    pub fn is_zero(&self) -> bool {
        self.is_constant() && self.eval(560.0) == 0.0
    }
}

impl Default for Spectrum {
    fn default() -> Self {
        Self::ZERO
    }
}

#[cfg(test)]
mod tests;
