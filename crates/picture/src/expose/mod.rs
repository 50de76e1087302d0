//! Exposing: from the radiance of a spectral picture to the digital numbers of an image sensor.
//!
//! The sensor is the linear one of EMVA Standard 1288 (European Machine Vision Association 2021, *Standard for Characterization of Image Sensors and
//! Cameras*, release 4.0 Linear).
//!
//! [`SensorExposure::new`] finds the mean number of electrons that light raises in each pixel,
//! µₑ = Σ L_b · π sin²θ · T · A · t · ∫ η(λ) λ/(hc) dλ, summed over the bands b. [`SensorExposure::frame`] makes an exposure of it:
//!
//! 1. photo response nonuniformity (PRNU), a fixed pattern: µₑ (1 + PRNU · z);
//! 2. shot noise: a Poisson number of this mean and that of the dark current;
//! 3. the full well cuts it;
//! 4. dark signal nonuniformity (DSNU), another fixed pattern, and the noise of the readout, both normal;
//! 5. the gain, the black level, rounding, and the range of the digital numbers.
//!
//! So the variance of a digital number is (µₑ + µ_d + σ_r²)/g² + 1/12 below saturation, for a gain of g e⁻/DN. This is the photon transfer curve. Its
//! slope over the mean digital number is 1/g.
//!
//! Each random number is a pure function of (seed, pixel, frame, kind), and no function of the platform's mathematics library has a part in
//! it. So an exposure has the same bytes on every machine and for any number of threads, of which it uses all that rayon has.
//!
//! ```
//! use etalon_picture::expose::{ExposureSettings, QuantumEfficiency, Sensor, SensorChannel, SensorExposure};
//! use etalon_picture::{Attributes, ExrFile, Picture};
//!
//! let mut picture = Picture::new(64, 64)?;
//! for nm in [500, 520, 540] {
//!     picture.insert(&format!("S0.{nm},000000nm"), vec![0.01; 64 * 64])?;
//! }
//! let sensor = Sensor {
//!     pixel_pitch_m: 3.45e-6,
//!     exposure_s: 0.01,
//!     numerical_aperture: Some(1.0 / 8.0), // f/4
//!     lens_transmittance: 1.0,
//!     channels: vec![SensorChannel { name: "mono".to_owned(), quantum_efficiency: QuantumEfficiency::Constant(0.6) }],
//!     mosaic: None,
//!     full_well_e: 10_500,
//!     dark_current_e_per_s: 5.0,
//!     read_noise_e: 2.3,
//!     gain_e_per_dn: 2.6,
//!     black_level_dn: 64.0,
//!     bits: 12,
//!     prnu: 0.005,
//!     dsnu_e: 0.4,
//!     pattern_seed: 0,
//! };
//! let file = ExrFile { picture, attributes: Attributes::new() };
//! let frame = SensorExposure::new(&file, &sensor)?.frame(&ExposureSettings::default())?;
//! let report = &frame.channels[0];
//! // 0.01 W/(m² sr nm) over 60 nm, π/64 sr, 11.9 µm², 10 ms, 2.62e18 photons a joule, of which 60 % raise an electron.
//! assert!((report.mean_photo_e / 5506.0 - 1.0).abs() < 1e-3, "{report:?}");
//! assert_eq!(report.saturated, 0);
//! # Ok::<(), etalon_picture::PictureError>(())
//! ```

mod exposure;
mod photons;
mod poisson;
mod random;
mod raw_file;
mod readout;
mod report;
mod sensor;
#[cfg(test)]
mod tests;

pub use exposure::{ExposureSettings, RawFrame, SensorExposure, UnusablePixels};
pub use raw_file::RawInfo;
pub use report::{ChannelReport, RenderNoise};
pub use sensor::{
    IMAGE_NUMERICAL_APERTURE, MOST_BITS, MOST_CHANNELS, MOST_FULL_WELL_E, MOST_MOSAIC, MOST_PRNU, Mosaic,
    QuantumEfficiency, Sensor, SensorChannel,
};
