//! Pure light physics, free of scenes, files and randomness.
//!
//! | module | what it holds |
//! |---|---|
//! | [`real`] | [`Real`]: the scalar a kernel computes in, `f32` or `f64` |
//! | [`vec3`] | [`Vec3`]: a vector over any [`Real`], and orthonormal frames |
//! | [`lanes`] | [`Lanes`]: one value for each wavelength a path carries |
//! | [`angle`] | the angle of a vector |
//! | [`spectrum`] | [`Spectrum`]: symbolic spectra, RGB colours made into spectra, CIE illuminants |
//! | [`colour`] | the CIE 1931 2° observer, XYZ, linear Rec. 709, the sRGB transfer function |
//! | [`index`] | [`RefractiveIndex`] of glasses and [`ComplexIndex`] of metals, with the range each is known for |
//! | [`exponential`] | e⁻ˣ |
//! | [`fresnel`] | how much is reflected and transmitted, in forms that do not cancel |
//! | [`snell`] | where refracted light goes |
//! | [`error`] | [`OpticsError`]: what can be wrong with the numbers above |
//!
//! Arithmetic here uses only operations that IEEE 754 rounds correctly (+ − × ÷ √), never a fused multiply-add and
//! never the platform's mathematics library inside a path, so that a result has the same bits on every machine. Two kinds
//! of spectra need an exponential, [`spectrum::Blackbody`] and illuminant A, and so does sRGB: whoever renders tabulates
//! those before the paths start.

pub mod angle;
pub mod colour;
pub mod error;
pub mod exponential;
pub mod fresnel;
pub mod index;
pub mod lanes;
pub mod real;
pub mod snell;
pub mod spectrum;
mod table;
pub mod vec3;

pub use angle::atan2_turns;
pub use error::{INDEX_RANGE, OpticsError};
pub use exponential::exp_neg;
pub use index::{ComplexIndex, OutsideFit, RefractiveIndex};
pub use lanes::Lanes;
pub use real::Real;
pub use spectrum::{Illuminant, Spectrum};
pub use vec3::{Frame, Vec3};
