//! Refraction, reflection and indices held to published values.

mod fresnel;
mod index;
mod snell;
mod stack;
