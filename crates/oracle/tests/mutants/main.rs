//! Deliberately wrong subjects: the oracle must reject every one and accept the right ones beside them.
//!
//! Right subjects and mutants are written here in plain `f64`, independent of any renderer. A mutant is a right subject with one
//! line wrong, selected by name.

mod brushed;
mod bsdf;
mod layers;
mod light;
mod pictures;
mod polarisation;
mod renderer;
mod rough_glass;
mod shapes;
mod surface;
mod trees;
mod vector;
mod world;
