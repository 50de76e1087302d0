//! Planck's law.

use crate::error::{OpticsError, non_negative, positive};

/// Planck constant, J·s (exact, SI 2019).
pub const PLANCK_J_S: f64 = 6.626_070_15e-34;
/// Boltzmann constant, J·K⁻¹ (exact, SI 2019).
const BOLTZMANN_J_K: f64 = 1.380_649e-23;
/// Speed of light in vacuum, m·s⁻¹ (exact).
pub const LIGHT_M_S: f64 = 299_792_458.0;

/// The root x of x = 5(1 − e⁻ˣ): λ_max·T = hc/(x·k) (Wien's displacement law).
pub(super) const WIEN_X: f64 = 4.965_114_231_744_276;

/// Thermal radiance of a black body (Planck's law), times a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blackbody {
    temperature_k: f64,
    scale: f64,
}

impl Blackbody {
    /// The radiance of a black body at a temperature in K, times a dimensionless scale (an emissivity, or an attenuation).
    ///
    /// Fails if the temperature is not above 0 and finite, or the scale negative or not finite.
    pub fn new(temperature_k: f64, scale: f64) -> Result<Self, OpticsError> {
        Ok(Self {
            temperature_k: positive("a black body's temperature (K)", temperature_k)?,
            scale: non_negative("a black body's scale", scale)?,
        })
    }

    /// Temperature, K.
    pub fn temperature_k(&self) -> f64 {
        self.temperature_k
    }

    /// Factor on Planck's law.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Radiance at a wavelength in nm (in vacuum), W·m⁻²·sr⁻¹·nm⁻¹: 2hc²/λ⁵ / (exp(hc/(λkT)) − 1).
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        let wavelength_m = wavelength_nm * 1e-9;
        let x = PLANCK_J_S * LIGHT_M_S / (wavelength_m * BOLTZMANN_J_K * self.temperature_k);
        let numerator = 2.0 * PLANCK_J_S * LIGHT_M_S * LIGHT_M_S / wavelength_m.powi(5);
        // 1e-9: from a metre of wavelength to a nanometre.
        self.scale * 1e-9 * numerator / x.exp_m1()
    }

    /// Wavelength of the largest radiance per wavelength, nm (Wien's displacement law).
    pub fn peak_nm(&self) -> f64 {
        1e9 * PLANCK_J_S * LIGHT_M_S / (WIEN_X * BOLTZMANN_J_K * self.temperature_k)
    }

    pub(super) fn max_over(&self, range_nm: [f64; 2]) -> f64 {
        // Rises to the peak and falls after it.
        self.eval(self.peak_nm().clamp(range_nm[0], range_nm[1]))
    }
}
