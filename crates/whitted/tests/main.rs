//! The Whitted mode: the figures of the assignment and their parts.

mod figures;
mod refraction;
mod shapes_and_cameras;
