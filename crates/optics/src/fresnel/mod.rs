//! Fresnel's equations for plane interfaces.

mod conductor;
mod dielectric;

pub use conductor::{ConductorFresnel, conductor};
pub use dielectric::{DielectricFresnel, dielectric, refracted_cosine};
