//! Symbolic spectra: nothing is sampled until a wavelength asks.

/// A spectrum: reflectance (dimensionless), radiance (W·m⁻²·sr⁻¹·nm⁻¹) or another density, by where it is used.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// The same value at every wavelength.
    Constant(f64),
}

impl Spectrum {
    /// Value at a wavelength in nm.
    pub fn eval(&self, _wavelength_nm: f64) -> f64 {
        match self {
            Self::Constant(v) => *v,
        }
    }
}
