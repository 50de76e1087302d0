#![doc = include_str!("../README.md")]

pub mod double_double;
pub mod generators;
pub mod laws;
pub mod quadrature;
mod random;
pub mod statistics;
pub mod subjects;
pub mod suite;
pub mod transfer;
pub mod truths;
mod vector;
mod verdict;

pub use random::Uniform;
pub use verdict::Verdict;
