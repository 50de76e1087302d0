//! The form of scene files, version 1, and what becomes of it.
//!
//! A module for each part: first the declarations, which are both the reader and the schema, then the checks that turn
//! them into the model. Declarations hold `None` where something was wrong, so that checks go as far as they can.

mod camera;
mod compound_lens;
mod detail;
mod environment;
mod geometry;
mod group;
mod integrator;
mod light;
mod material;
mod medium;
mod mesh;
mod meter;
mod motion;
mod names;
mod photometric;
mod scene;
mod slide;
mod spectra;
mod spectrum;
mod surface;
mod uv;
mod view;

pub use material::{MOST_BLEND_PARTS, MOST_WIDTHS};
pub(crate) use scene::{SceneForm, scene};
