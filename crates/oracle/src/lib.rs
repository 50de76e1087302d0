//! Laws, closed-form truths and statistics that any renderer can be held to.
//!
//! Nothing here comes from a renderer: directions, radiances and densities cross the boundary as `f64` and `[f64; 3]`,
//! and everything an answer is compared with is derived in this crate. Every answer is a [`Verdict`]: what was measured,
//! against which threshold, how small an error would have been seen, and the evidence.

pub mod double_double;
pub mod laws;
pub mod quadrature;
mod random;
pub mod statistics;
pub mod subjects;
pub mod suite;
pub mod truths;
mod vector;
mod verdict;

pub use random::Uniform;
pub use verdict::Verdict;
