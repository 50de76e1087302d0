//! The JSON scene description: inert, validated data.

pub mod model;

pub use model::*;
