//! Laws of light as functions that return a [`Verdict`](crate::Verdict).
//!
//! A subject is handed over as a closure or a trait object over plain `f64` arrays. Every law takes `epsilon`, the machine
//! epsilon of the subject's arithmetic ([`f64::EPSILON`], or [`SINGLE`] for an f32 subject): inputs are rounded to what the
//! subject can represent, and bounds are stated in units of it. Sweeps take a seed and are the same for equal seeds.

mod fresnel;
mod refraction;

pub use fresnel::{
    FresnelPowers, fresnel_conserves_energy, fresnel_exact, fresnel_is_accurate, fresnel_obeys_brewster,
    fresnel_obeys_stokes, fresnel_reflects_totally, stokes_amplitudes,
};
pub use refraction::{Crossing, mirror_reflection, snell, snell_sweep, total_internal_reflection};

/// Machine epsilon of an f32 subject, as an `f64`.
pub const SINGLE: f64 = f32::EPSILON as f64;
