//! Models and scenes of other programs as scenes of ours.

mod animations;
mod foreign_scenes;
mod imports;
