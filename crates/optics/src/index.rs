//! Refractive indices of dielectrics and metals.

/// Refractive index of a transparent medium, relative to vacuum.
#[derive(Clone, Debug, PartialEq)]
pub enum RefractiveIndex {
    /// The same at every wavelength.
    Constant(f64),
}

/// Complex refractive index n + ik of a metal.
#[derive(Clone, Debug, PartialEq)]
pub struct ComplexIndex {}
