//! Pure light physics, free of scenes, files and randomness.
//!
//! | module | what it holds |
//! |---|---|
//! | [`real`] | [`Real`]: the scalar a kernel computes in, `f32` or `f64` |
//! | [`vec3`] | [`Vec3`]: a vector over any [`Real`], and orthonormal frames |
//! | [`lanes`] | [`Lanes`]: one value for each wavelength a path carries |
//!
//! Arithmetic here uses only operations that IEEE 754 rounds correctly (+ − × ÷ √), never a fused multiply-add and
//! never the platform's mathematics library inside a path, so that a result has the same bits on every machine.

pub mod index;
pub mod lanes;
pub mod real;
pub mod spectrum;
pub mod vec3;

pub use index::{ComplexIndex, RefractiveIndex};
pub use lanes::Lanes;
pub use real::Real;
pub use spectrum::Spectrum;
pub use vec3::{Frame, Vec3};
